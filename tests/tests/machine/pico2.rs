//! A Pico 2 with two HM01B0 on one trigger: the host on USB, an autopilot on a UART. The image is
//! the shipped one, and what it has written to the PIO's instruction memory is what takes the
//! pixels.
//!
//! Not in the model, and so not shown here: levels and edges of wires, timing of the flash and its
//! cache, power, contention of both cores for memory, USB below its packets, what HM01B0 do that
//! nobody has written down; the time of anything within a few tens of percent.

use super::{Frame, Run, bad_frames, frames_of, host, rig_bytes, sensor_pixel};
use linestereo::results::Match;
use linestereo::{Dims, Options};
use linestereo_firmware::boards::pico2::BoardMemory;
use linestereo_firmware::memory::Memory;
use linestereo_firmware::session::Session;
use linestereo_rig::CameraSide;
use linestereo_tests::board::image;
use linestereo_wire::{FrameHead, Health, PairReport, Request, ResetCause};
use serde_json::{Value, json};

fn execute(scenario: &Value) -> Option<Run> {
    let image = || image(&linestereo_boards::Board::PICO2, "live");
    let run = Run::of("rp2350.py", image, scenario)?;
    // Nothing that the model lacks, and nothing that USB forbids.
    run.assert_whole();
    assert_eq!(run.result["usb"]["faults"], json!([]));
    Some(run)
}

/// Pairs, a row that is too short, a row that is missing, a VSYNC that is stuck, a photograph, a
/// rig that is erased and written, an autopilot. Then power is lost, and comes back.
#[test]
fn seconds_of_a_pico_2() {
    // Number of each in `CaptureReport::KINDS`.
    const FAULTS: [(CameraSide, u64, &str, usize); 3] = [
        (CameraSide::Left, 3, "short", 3),
        (CameraSide::Right, 6, "few", 2),
        (CameraSide::Left, 9, "stuck", 1),
    ];
    let requests = [
        (150_000, Request::Describe),
        (160_000, Request::Start),
        (2_000_000, Request::Photograph),
        (2_700_000, Request::SetRig(rig_bytes())),
    ];
    let faults = bad_frames(&FAULTS);
    let scenario = json!({ "until_us": 4_500_000, "host": host(&requests), "faults": faults });
    let Some(run) = execute(&scenario) else { return };

    // Clocks, by the registers that were written.
    assert_eq!((&run.result["sys_mhz"], &run.result["mclk_mhz"]), (&json!(150.0), &json!(6.0)));
    let baud = run.result["autopilot_baud"].as_f64().unwrap();
    assert!((baud - 57_600.0).abs() < 100.0, "{baud}");
    // Its serial number is the first four rows of the one-time memory, two a word.
    run.assert_usb("pico2", "0000123800001234", false);
    assert_eq!(run.reset_causes(), [Some(ResetCause::PowerOn)]);

    // Each bad frame by its name, and it costs that frame alone.
    let frames = run.frames_in_order();
    assert!(frames.len() > 24, "{}", frames.len());
    run.assert_bad_frames(
        &frames,
        &FAULTS.map(|(eye, _, _, kind)| (eye, kind)),
        FAULTS.len(),
        u64::MAX,
    );
    assert!(
        frames.iter().filter_map(|head| head.pair?.skew_us).all(|skew_us| skew_us < 50),
        "one trigger"
    );
    run.assert_photograph();

    // The rig was erased, written, and is used: pairs are rectified as their rows come.
    run.assert_all_accepted();
    assert_eq!(run.result["erases"], 1);
    let rectified = frames.iter().filter(|head| head.capture_time_us > 3_200_000);
    // Raw rows match some 13 segments, since they are not those of one point; edges of this dense
    // pattern have a budget. The scene stands still, which a camera's noise does not: such pairs
    // answer nothing.
    assert!(
        rectified.clone().count() > 8 && rectified.clone().all(|head| head.counts.matched > 65),
        "{frames:?}"
    );
    run.assert_autopilot();

    // Memory: of the program's stack a quarter is left, and the DMA writes behind the stacks.
    run.assert_stack();
    let used = run.result["handler_stack"].as_u64().unwrap();
    assert!((100..6144).contains(&used), "{used} bytes of the handlers' stack");
    let (stacks, dma) = (run.result["stack"][1].as_u64().unwrap() + 6144, &run.result["dma"]);
    assert!(
        dma[0].as_u64().unwrap() >= 0x2000_0000 + stacks && dma[1].as_u64().unwrap() <= 0x2008_0000,
        "{dma}"
    );
    let unfed_us = run.result["longest_unfed_us"].as_f64().unwrap();
    assert!(unfed_us < 0.5 * 8e6, "{unfed_us} us");
    run.code().assert_executed(100_000); // 108 878 when this was written
    // The rig was written while core 1 was up.
    let core1 = &run.result["core1"];
    assert_eq!((&core1["starts"], &core1["cpacr"]), (&json!(1), &json!(0xf << 20)), "one FPU each");
    let [used, all] = [0, 1].map(|i| core1["stack"][i].as_u64().unwrap());
    assert!(used > 1000 && used <= all / 4 * 3, "{used} of {all} bytes of core 1's stack");

    // Power is lost and comes back: the rig is there.
    let commands = host(&[(100_000, Request::Describe)]);
    let again =
        execute(&json!({ "until_us": 1_500_000, "flash": run.result["flash"], "host": commands }))
            .unwrap();
    assert_eq!(again.assert_rig_is_used().rig.slots[0], Ok(0));
}

/// A fault of the processor ends the program, and the next run names it; cameras that send nothing
/// any more let the watchdog reset the board.
#[test]
fn a_fault_and_the_watchdog_are_named_after_the_reset() {
    let requests = [
        (150_000, Request::Describe),
        (600_000, Request::Describe),
        (650_000, Request::Start),
        (9_600_000, Request::Describe),
    ];
    let scenario = json!({
        "until_us": 9_700_000, "host": host(&requests), "hard_fault_us": 300_000, "dead_us": 1_000_000, "resets": 2,
    });
    let Some(run) = execute(&scenario) else { return };
    let causes = [ResetCause::PowerOn, ResetCause::Fault, ResetCause::Watchdog].map(Some);
    assert_eq!(run.reset_causes(), causes);
    // The watchdog bites 8 s after the last pair.
    let last =
        run.frames().into_iter().rfind(|head| !head.health.contains(Health::PAIR_MISSING)).unwrap();
    let bitten_us =
        run.result["resets_us"][1].as_u64().unwrap() - run.result["resets_us"][0].as_u64().unwrap();
    assert!(
        (8_000_000..8_400_000).contains(&(bitten_us - last.capture_time_us)),
        "{bitten_us} us after {last:?}"
    );
}

/// Counts, health and segments of the first frames of both sensors, matched on this machine.
fn matched_here(pairs: usize) -> Vec<(FrameHead, Vec<Match>)> {
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut session = Session::new(linestereo_boards::Board::PICO2);
    let dims = Dims { width: 320, height: 240 };
    let found = (0..pairs as u64).map(|number| {
        for (frame, is_right) in memory.frames().into_iter().zip([false, true]) {
            for (pixel, at) in frame.iter_mut().zip(0..) {
                *pixel = sensor_pixel(is_right, number, at % 320, at / 320);
            }
        }
        let matcher = session.matcher(dims).unwrap();
        let matched = memory.run(None, matcher, Options::default()).unwrap();
        let head = FrameHead::new(number as u32, 0, dims, Health::GOOD, matched.counts());
        (head.with_pair(matched.health()), matched.segments().to_vec())
    });
    found.collect()
}

/// Both cores match pairs, with the bits of this machine, in little more than half of the time. A
/// board whose second core does not answer does it alone.
#[test]
fn pairs_are_the_same_on_two_cores_and_on_one() {
    let commands = host(&[(150_000, Request::Start)]);
    let [both, one] = ["present", "absent"].map(|core1| {
        let run =
            execute(&json!({ "until_us": 800_000, "host": commands.clone(), "core1": core1 }))?;
        let found = frames_of(&run);
        assert!(found.len() > 2 && found[0].segments.len() > 65, "{:?}", found[0].head);
        for (Frame { head, segments, .. }, (here, segments_here)) in
            found.iter().zip(matched_here(found.len()))
        {
            let pair =
                |head: &FrameHead| head.pair.map(|pair| PairReport { skew_us: None, ..pair });
            assert_eq!((head.counts, pair(head)), (here.counts, pair(&here)), "{core1}");
            assert_eq!(*segments, segments_here, "{core1}: pair {}", head.sequence);
        }
        let slowest_us = found.iter().map(|frame| frame.head.times.matching_us).max().unwrap();
        Some((run.result["core1"].clone(), slowest_us, found.len() as u64))
    });
    let (Some((core1, both_us, pairs)), Some((alone, one_us, _))) = (both, one) else { return };
    println!("{both_us} us on two cores, {one_us} us on one; {core1}");
    assert_eq!((&alone["starts"], &alone["executed"][1]), (&json!(0), &json!(0)));
    assert!(both_us * 100 < one_us * 66, "{both_us} us of {one_us} us");
    let [first, second] = [0, 1].map(|i| core1["executed"][i].as_u64().unwrap());
    assert!(second * 10 > first * 4, "core 1 executes {second} instructions, core 0 {first}");
    assert!(core1["joins"].as_u64().unwrap() > 80 * pairs, "{core1}");
}

/// A fault of core 1 and an overflow of its stack are named, as those of core 0 are. If it hangs in
/// the middle of a pair, the watchdog resets the board. After each, both cores work.
#[test]
fn a_second_core_that_fails_resets_the_board() {
    let requests = [
        (140_000, Request::Describe),
        (150_000, Request::Start),
        (650_000, Request::Describe),
        (660_000, Request::Start),
        (1_150_000, Request::Describe),
        (1_160_000, Request::Start),
        (9_700_000, Request::Describe),
        (9_710_000, Request::Start),
    ];
    let scenario = json!({
        "until_us": 10_100_000, "host": host(&requests), "resets": 3,
        "core1_fault_us": 400_000, "core1_overflow_us": 900_000, "core1_dead_us": 1_430_000,
    });
    let Some(run) = execute(&scenario) else { return };
    let causes =
        [ResetCause::PowerOn, ResetCause::Fault, ResetCause::StackOverflow, ResetCause::Watchdog];
    assert_eq!(run.reset_causes(), causes.map(Some));
    let places: Vec<_> = run.hellos().map(|hello| hello.reset.unwrap().location).collect();
    assert!((0x1000_0000..0x1040_0000).contains(&places[1]), "in the flash: {places:x?}");
    let resets_us = run.result["resets_us"].as_array().unwrap();
    let resets_us: Vec<_> = resets_us.iter().map(|us| us.as_u64().unwrap()).collect();
    // Within a pair, and at once; 8 s after the last whole one.
    assert!((400_000..500_000).contains(&resets_us[0]), "{resets_us:?}");
    assert!((900_000..1_000_000).contains(&resets_us[1]), "{resets_us:?}");
    assert!((9_300_000..9_500_000).contains(&resets_us[2]), "{resets_us:?}");
    assert_eq!(run.result["core1"]["starts"], 4);
    let last = run.frames().into_iter().next_back().unwrap();
    assert!(last.capture_time_us > 100_000 && last.sequence > 0, "{last:?}");
}
