//! The boards under QEMU: the PC's bits, and an end for everything that must not happen.

use core::time::Duration;
use linestereo::{Dims, Matcher, Params, image::Span, units::Confidence};
use linestereo_boards::built_in::Case;
use linestereo_boards::{Board, Exit};
use linestereo_calibration::rectify::PairRectifier;
use linestereo_firmware::boards::mps2_an500;
use linestereo_firmware::ports::NoClock;
use linestereo_firmware::programs::kernels::{Kernels, MEMORY_FUNCTIONS};
use linestereo_firmware::programs::pixels;
use linestereo_frames::GrayImage;
use linestereo_rig::{Calibration, Camera, CameraSide, Lens, RigImage, View};
use linestereo_sim::board::{self, BoardResult, Machine, push, qemu};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::results::listing::{self, Answers};
use linestereo_sim::scene::Kind;
use linestereo_tests::board::{Twin, image, machine, measured, on_every_board, or_skip};
use linestereo_tests::drawn::rendered;
use linestereo_wire::*;
use object::{Object, ObjectSymbol};
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::sync::{Arc, Mutex};

const LIMIT: Duration = Duration::from_secs(600);

fn boxes(width: u16, height: u16) -> (GrayImage, GrayImage) {
    let rendering = rendered(Kind::Boxes, Dims { width, height }, 1.0, 3);
    (rendering.left, rendering.right)
}

fn json(dims: Dims, result: &FrameResult) -> String {
    listing::json(dims, result, &Answers::default()).unwrap()
}

/// The only pair's result.
fn run_one(
    machine: &Machine,
    update: &ParamUpdate,
    (left, right): &(GrayImage, GrayImage),
) -> BoardResult {
    let mut replayed = machine.run_pairs(update, &[(left, right)]).unwrap();
    assert_eq!((replayed.pairs.len(), replayed.bad_packets), (1, 0));
    replayed.pairs.remove(0).unwrap()
}

/// Runs a program on a board, or none where there is no board.
fn end_of(board: &Board, elf: &Path, arguments: &[&str]) -> Option<qemu::Ended> {
    or_skip(qemu::run(board, elf, arguments, Path::new("."), LIMIT))
}

/// The log of a program that has ended well.
fn good_log(board: &Board, elf: &Path) -> Option<Vec<linestereo_firmware_log::Line>> {
    let ended = end_of(board, elf, &[])?;
    let log = linestereo_firmware_log::decode(elf, &ended.log).unwrap();
    let different: Vec<_> = log.iter().filter(|line| line.level != "INFO").collect();
    let why = format!("{}: {different:?}; {}", board.name, ended.errors);
    assert_eq!(ended.exit, Some(Exit::Success), "{why}");
    Some(log)
}

#[test]
fn every_stage_of_the_built_in_pairs_gives_the_digest_of_the_pc() {
    on_every_board(|board| {
        let Some(elf) = image(&board, "selftest") else { return };
        let Some(log) = good_log(&board, &elf) else { return };
        // A size as the core's own `defmt::Format` says it.
        let expected = Case::all(&board).map(|Case { scene, dims, worst_case }| {
            format!(
                "{} {dims}{}: equal",
                scene.name(),
                if worst_case { ", worst case" } else { "" }
            )
        });
        assert_eq!(
            log.iter().map(|line| line.text.clone()).collect::<Vec<_>>(),
            expected.collect::<Vec<_>>()
        );
    });
}

/// The most instructions of one pixel, and of the mean of a pair's: what `Matched::pixel` promises
/// for 64 disparities.
const WORST_PIXEL: u64 = 70_000;
const MEAN_PIXEL: u64 = 56_000;

#[test]
fn pixels_of_the_built_in_pairs_have_the_depth_of_the_pc() {
    let board = mps2_an500::BOARD;
    let Some(elf) = image(&board, "pixels") else { return };
    let folder = tempfile::tempdir().unwrap();
    let Some(ended) = or_skip(qemu::run(&board, &elf, &["table"], folder.path(), LIMIT)) else {
        return;
    };
    ended.success("pixels", &board).unwrap();
    let table = std::fs::read_to_string(folder.path().join("table")).unwrap();
    let mut memory = Box::new(mps2_an500::BoardMemory::CLEARED);
    assert_eq!(table.lines().count(), Case::all(&board).count(), "{table}");
    for (line, case) in table.lines().zip(Case::all(&board)) {
        let expected = pixels::measure(&mut *memory, &NoClock, &case).unwrap();
        let fields: Vec<&str> = line.split('\t').collect();
        let [_, name, queried, answered, mean, worst_case, digest] = fields[..] else {
            panic!("{line}")
        };
        let found = (name.to_owned(), queried.parse(), answered.parse(), digest.to_owned());
        let digest = format!("{:08x}", expected.digest);
        assert_eq!(found, (case.to_string(), Ok(expected.queried), Ok(expected.answered), digest));
        let costs: [u64; 2] = [mean, worst_case].map(|cost| cost.parse().unwrap());
        assert!(costs[0] <= MEAN_PIXEL && costs[1] <= WORST_PIXEL, "{line}");
    }
}

/// Takes a minute or two: every length and alignment of every kernel on five processors.
#[test]
fn every_kernel_equals_the_portable_one_between_fences() {
    on_every_board(|board| {
        let Some(elf) = image(&board, "kernels") else { return };
        let Some(log) = good_log(&board, &elf) else { return };
        assert_eq!(log.len(), Kernels::COUNT + MEMORY_FUNCTIONS, "{log:?}");

        // Control: a kernel that reads a byte too far is stopped. That those which give other bits
        // are found is shown on a PC (`programs::kernels`), by the same comparison.
        let Some(ended) = end_of(&board, &elf, &["beyond"]) else { return };
        assert_eq!(ended.exit, Some(Exit::Fault), "{}: {}", board.name, ended.errors);
        assert!(
            ended.errors.contains("fault: pc ") && ended.errors.contains(" address "),
            "{}",
            ended.errors
        );
    });
}

#[test]
fn a_rendered_scene_gives_the_json_of_the_pc() {
    for board in measured() {
        let Some(machine) = machine(board) else { return };
        for (width, height) in [(320, 240), (160, 120), (128, 96)] {
            let pair = boxes(width, height);
            let dims = pair.0.dims;
            if !board.fits(dims) {
                let refused =
                    machine.run_pairs(&ParamUpdate::default(), &[(&pair.0, &pair.1)]).unwrap();
                assert!(refused.pairs[0].is_err());
                continue;
            }
            let rig = RigUpdate { focal_px: 300.5, baseline_m: 0.07, offset_px: 1.25 };
            let params =
                Params { max_disparity: 48, rig: Some(rig.rig().unwrap()), ..Params::default() };
            let found = run_one(&machine, &board::update(&params, Some(rig)), &pair);
            let twin = Twin::of(&board).run(&params, &pair.0, &pair.1).unwrap();
            assert_eq!(json(dims, &found.result), json(dims, &twin), "{} {dims}", board.name);
            assert_eq!(found.result.points, twin.points);
            assert!(found.result.matches.len() > 5 && found.costs.iter().sum::<u64>() > 100_000);

            // Where no list is full, the capacities do not matter: the PC's own command gives the
            // same.
            let sparse = Params {
                cell: 32,
                reach: 1,
                min_confidence: Confidence::from_num(0.985),
                ..params
            };
            let found = run_one(&machine, &board::update(&sparse, Some(rig)), &pair).result;
            let mut engine = Engine::new(&sparse, dims).unwrap();
            let pc = engine.run(pair.0.view().unwrap(), pair.1.view().unwrap()).unwrap();
            let counts = found.counts;
            if [counts.segments_left_dropped, counts.segments_right_dropped] == [0; 2] {
                assert_eq!(json(dims, &found), json(dims, &pc), "{} {dims}", board.name);
            } else {
                assert!(width > 128, "the smallest scene fills a list: {counts:?}");
            }
        }
    }
}

#[test]
fn worst_cases_are_the_same_to_the_last_byte() {
    for board in measured() {
        let Some(machine) = machine(board) else { return };
        let mut twin = Twin::of(&board);
        for worst_case in [false, true] {
            let cases: Vec<Case> =
                Case::all(&board).filter(|case| case.worst_case == worst_case).collect();
            let params = cases[0].params();
            let painted: Vec<(GrayImage, GrayImage)> = cases.iter().map(paint).collect();
            let pairs: Vec<_> = painted.iter().map(|(left, right)| (left, right)).collect();
            let replayed = machine.run_pairs(&board::update(&params, None), &pairs).unwrap();
            // Faults of a pair are held over the next ones.
            let mut matcher = Matcher::new(params, cases[0].dims).unwrap();
            for ((case, found), (left, right)) in cases.iter().zip(&replayed.pairs).zip(&painted) {
                let found = &found.as_ref().unwrap().result;
                matcher.set_params(params, case.dims).unwrap();
                let (expected, _) = twin.run_next(&mut matcher, [left, right], &[]).unwrap();
                assert_eq!(found.matches, expected.matches, "{case}");
                assert_eq!(found.points, expected.points, "{case}");
                assert_eq!(found.counts, expected.counts, "{case}");
            }
        }
    }
}

fn paint(case: &Case) -> (GrayImage, GrayImage) {
    let pixels = usize::from(case.dims.width) * usize::from(case.dims.height);
    let image = || GrayImage { dims: case.dims, pixels: vec![0; pixels] };
    let (mut left, mut right) = (image(), image());
    case.scene.paint(case.dims, &mut left.pixels, &mut right.pixels);
    (left, right)
}

#[test]
fn faults_end_in_exit_codes() {
    on_every_board(|board| {
        let Some(elf) = image(&board, "faults") else { return };
        for (fault, exit, report) in [
            ("panic", Exit::Panic, "panic: firmware/src/bin/faults.rs:"),
            ("stack", Exit::StackOverflow, "stack overflow:"),
            ("large-stack", Exit::StackOverflow, "stack overflow:"),
            ("guard", Exit::StackOverflow, "fffff0\n"),
            ("bus", Exit::Fault, "address f0000000"),
            ("undefined", Exit::Fault, "fault: pc "),
            ("nonsense", Exit::Usage, ""),
            // Where the program was is not where the handler failed.
            (
                "handler",
                if board.target.starts_with("thumb") { Exit::Fault } else { Exit::Usage },
                "",
            ),
            // Armv7-M; later processors have limits of their stacks instead.
            (
                "between",
                if board.target.starts_with("thumbv7") { Exit::Fault } else { Exit::Usage },
                "",
            ),
        ] {
            let Some(ended) = end_of(&board, &elf, &[fault]) else { return };
            assert_eq!(ended.exit, Some(exit), "{fault} on {}: {}", board.name, ended.errors);
            assert!(ended.errors.contains(report), "{fault} on {}: {}", board.name, ended.errors);
            assert!(
                fault != "handler" || !ended.errors.contains(" pc "),
                "{}: {}",
                board.name,
                ended.errors
            );
        }
    });
}

/// A rig with barrel distortion, whose right camera is turned by a fraction of a degree.
fn raw_rig(raw: Dims, rectified: Dims, view: View) -> RigImage {
    let scale = f64::from(raw.width);
    let lens = Lens::BrownConrady { k: [-0.05, 0.01, 0.0], p: [1e-3, -5e-4] };
    let centre = [0.5 * scale - 1.25, 0.5 * f64::from(raw.height) + 0.5];
    let camera = |focal: [f64; 2], skew: f64| {
        Camera::new(raw, focal.map(|share| share * scale), centre, skew, lens).unwrap()
    };
    let (left, right) = (camera([0.85, 0.851], 0.0), camera([0.849, 0.85], 0.1));
    let calibration =
        Calibration::new(left, right, [0.999_997, 0.0005, 0.002, 0.0005], [-0.07, 0.0004, 0.0])
            .unwrap();
    RigImage::new(calibration, rectified, view, (0, 48)).unwrap()
}

#[test]
fn raw_pairs_give_the_json_of_the_pc() {
    for (board, raws) in measured().zip([[(320, 240), (480, 360)], [(160, 120), (400, 300)]]) {
        let Some(machine) = machine(board) else { return };
        for (width, height) in raws {
            let (left, right) = boxes(width, height);
            let rig = raw_rig(left.dims, board.largest, View::default());
            let params = rig.params(Params::default()).unwrap();
            let mut replayed = machine
                .run_raw_pairs(&rig, &board::update(&params, None), &[(&left, &right)])
                .unwrap();
            assert_eq!((replayed.pairs.len(), replayed.bad_packets), (1, 0));
            let found = replayed.pairs.remove(0).unwrap();
            let (left, right) =
                PairRectifier::new(rig.remap()).unwrap().pair(&left, &right).unwrap();
            let twin = Twin::of(&board).run(&params, &left, &right).unwrap();
            let dims = board.largest;
            assert_eq!(
                json(dims, &found.result),
                json(dims, &twin),
                "{} {width}x{height}",
                board.name
            );
            assert_eq!(found.result.points, twin.points);
            assert!(
                twin.matches.len() > 5 && twin.matches.iter().all(|found| found.depth.is_some())
            );
            assert!(found.rectification > 100_000, "{}", found.rectification);
            assert!(replayed.stack < 16 * 1024, "{} bytes of stack", replayed.stack);
        }
    }
}

#[test]
fn pixels_without_source_are_not_used_on_a_board() {
    let board = Board::MPS2_AN500;
    let Some(machine) = machine(board) else { return };
    let (left, right) = boxes(160, 120);
    let rig = raw_rig(left.dims, board.largest, View::Alpha(1.0));
    let params = rig.params(Params::default()).unwrap();
    let mut replayed =
        machine.run_raw_pairs(&rig, &board::update(&params, None), &[(&left, &right)]).unwrap();
    let found = replayed.pairs.remove(0).unwrap().result;
    assert_eq!((found.counts.segments_left_dropped, found.counts.segments_right_dropped), (0, 0));

    let mut rectifier = PairRectifier::new(rig.remap()).unwrap();
    let usable = CameraSide::BOTH.map(|eye| rectifier.facts(eye).usable);
    let (left, right) = rectifier.pair(&left, &right).unwrap();
    let view = |image: &'static GrayImage, spans: &'static [Span]| {
        image.view().unwrap().with_valid(spans).unwrap()
    };
    let [left_spans, right_spans] = usable.map(|spans| &*Box::leak(spans.into_boxed_slice()));
    let [left, right] = [left, right].map(|image| &*Box::leak(Box::new(image)));
    let mut engine = Engine::new(&params, board.largest).unwrap();
    let expected = engine.run(view(left, left_spans), view(right, right_spans)).unwrap();
    assert_eq!((&found.matches, &found.points), (&expected.matches, &expected.points));
    assert!(found.matches.len() > 5, "{} matches", found.matches.len());

    // With all pixels used, the border of what the cameras see gives edges of its own.
    let all = engine.run(left.view().unwrap(), right.view().unwrap()).unwrap();
    assert_ne!(all.points, found.points);
    for point in &found.points {
        let span = left_spans[usize::from(point.y)];
        assert!((span.start..span.end).contains(&point.x), "a point at {}, {}", point.x, point.y);
    }
}

#[test]
fn a_live_board_answers_on_its_port() {
    let board = Board::MPS2_AN500;
    let Some(elf) = image(&board, "live") else { return };
    let Some(mut qemu) = or_skip(qemu::command(&board, &elf, &[], Path::new("."))) else { return };
    let child = qemu
        .args(["-serial", "stdio"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut running = Running::new(child);
    assert!(matches!(running.message(), Message::Hello(hello) if hello.board == board.name));
    running.command(1, Request::Describe);
    assert!(matches!(running.message(), Message::Hello(_)));
    assert_eq!(running.answer(1), Outcome::Accepted);
    let narrow = ParamUpdate { max_disparity: Some(4), ..ParamUpdate::default() };
    running.command(2, Request::SetParams(narrow));
    assert!(matches!(running.answer(2), Outcome::Refused(Refusal::OutOfRange { .. })));
    running.stdin.write_all(b"garbage\xff\x03\x02\0").unwrap();
    running.command(3, Request::Start);
    assert_eq!(running.answer(3), Outcome::Accepted);
    let mut twin = Twin::of(&board);
    let mut matcher = Matcher::new(Params::default(), board.largest).unwrap();
    for (sequence, case) in (0..3).zip(Case::all(&board)) {
        let (left, right) = paint(&case);
        let (mut expected, _) = twin.run_next(&mut matcher, [&left, &right], &[]).unwrap();
        expected.counts.points = 0; // a live board sends segments alone
        let Message::Frame(head) = running.message() else { panic!("a frame was expected") };
        assert_eq!((head.sequence, head.counts), (sequence, expected.counts));
        let mut matches = Vec::new();
        while matches.len() < usize::from(head.segments) {
            let Message::Segments(segments) = running.message() else {
                panic!("segments were expected")
            };
            matches.extend(segments.list);
        }
        assert_eq!(matches, expected.matches);
    }
    running.command(4, Request::Stop);
    assert_eq!(running.answer(4), Outcome::Accepted);
}

/// A program in QEMU whose UART is QEMU's stdin and stdout. It is ended with the test, or when the
/// test waits too long.
struct Running {
    child: Arc<Mutex<Child>>,
    stdin: ChildStdin,
    stdout: ChildStdout,
    decoder: Decoder<Message, MAX_PACKET>,
}

impl Running {
    fn new(mut child: Child) -> Self {
        let (stdin, stdout) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        let child = Arc::new(Mutex::new(child));
        let late = Arc::downgrade(&child);
        std::thread::spawn(move || {
            std::thread::sleep(LIMIT);
            if let Some(child) = late.upgrade() {
                let _ = child.lock().unwrap().kill(); // the test then meets the end of its output
            }
        });
        Self { child, stdin, stdout, decoder: Decoder::new() }
    }

    fn command(&mut self, id: u16, request: Request) {
        let mut bytes = Vec::new();
        push(&mut bytes, &Command { id, request }).unwrap();
        self.stdin.write_all(&bytes).unwrap();
        self.stdin.flush().unwrap();
    }

    fn message(&mut self) -> Message {
        loop {
            let mut byte = [0];
            self.stdout.read_exact(&mut byte).unwrap();
            if let Some(message) = self.decoder.push(byte[0]) {
                return message.unwrap();
            }
        }
    }

    /// The next answer; frames that were on the way are skipped.
    fn answer(&mut self, id: u16) -> Outcome {
        loop {
            if let Message::Answer(answer) = self.message() {
                assert_eq!(answer.command, id);
                return answer.outcome;
            }
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Ok(mut child) = self.child.lock() {
            let _ = child.kill(); // it has no end of its own
            let _ = child.wait();
        }
    }
}

/// Not the core alone, which `no_panic` has: whole programs, as they are shipped. Their panic
/// handler is gone, because nothing calls it.
#[test]
fn programs_without_logs_hold_no_panic_handler() {
    for board in measured() {
        // The last one does panic, on purpose: what is searched for is there to be found.
        for (program, panics) in
            [("live", false), ("replay", false), ("bench", false), ("faults", true)]
        {
            let Some(elf) = image(&board, program) else { return };
            let elf = std::fs::read(elf).unwrap();
            let file = object::File::parse(&*elf).unwrap();
            let mut names = file.symbols().filter_map(|symbol| symbol.name().ok());
            let found = names.any(|name| name.contains("rust_begin_unwind"));
            assert_eq!(found, panics, "{program} on {}", board.name);
        }
    }
}
