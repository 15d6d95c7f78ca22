//! Settings of hosts and autopilots, and what is left of them after a reset.

use crate::support::flash::Flash;
use crate::support::live::{DIMS, Running, rig, rig_numbers, scripted};
use crate::support::port::{Port, heads, mavlink_frames};
use linestereo::obstacles::{ObstaclePlan, Obstacles, Sector};
use linestereo::{Area, Matcher, Options, Params, units::Confidence};
use linestereo_firmware::boards::mps2_an386::{BOARD, BoardMemory};
use linestereo_firmware::memory::Memory;
use linestereo_firmware::painter::Painter;
use linestereo_firmware::ports::{ByteSink as _, PairSource as _};
use linestereo_firmware::programs::live::Turn;
use linestereo_firmware::session::{Reply, Session};
use linestereo_firmware::settings::{self, KeptSettings};
use linestereo_firmware::slot_store::Keeper as _;
use linestereo_firmware::vehicle::Vehicle;
use linestereo_mavlink::{Fields, Mavlink, Policy, Sender};
use linestereo_wire::*;

fn outcome(session: &mut Session<'_>, memory: &mut BoardMemory, request: Request) -> Outcome {
    match session.command(&Command { id: 1, request }, memory) {
        Reply::Answer(answer) => answer.outcome,
        other => panic!("{other:?}"),
    }
}

fn accept(
    session: &mut Session<'_>,
    memory: &mut BoardMemory,
    requests: impl IntoIterator<Item = Request>,
) {
    for request in requests {
        assert_eq!(outcome(session, memory, request), Outcome::Accepted);
    }
}

/// Numbers of settings.
const MAX_DISPARITY: u8 = 1;
const CELL: u8 = 5;
const RANGE_M: u8 = 10;
const RATE_HZ: u8 = 14;
const POLICY: u8 = 15;
const BLOCK_CM: u8 = 16;
const SECTORS: u8 = 19;

fn set(number: u8, value: f32) -> Request {
    Request::Set(SettingValue { number, value })
}

/// The rig of a board that gets its numbers alone.
const RIG: RigUpdate = RigUpdate { focal_px: 110.0, baseline_m: 0.1, offset_px: 0.0 };

fn value(session: &Session<'_>, number: u8) -> f32 {
    session.values()[usize::from(number)]
}

fn changes() -> Vec<Request> {
    let params = ParamUpdate { cell: Some(16), ..ParamUpdate::default() };
    let of = RegionBox { label: 7, left: 1, top: 2, right: 100, bottom: 90 };
    let regions = Regions { boxes: [of].into_iter().collect(), only: true };
    vec![
        set(RANGE_M, 6.0),
        set(POLICY, 0.0),
        set(RATE_HZ, 20.0),
        set(BLOCK_CM, 250.0),
        set(MAX_DISPARITY, 48.0),
        Request::SetParams(params),
        Request::SetRegions(regions),
    ]
}

/// Everything that is said of the settings.
fn report(session: &Session<'_>) -> (SettingValues, KeptReport, usize) {
    (session.values(), session.kept(), session.areas().map_or(0, |areas| areas.len()))
}

#[test]
fn what_is_kept_outlives_a_reset_and_what_is_not_does_not() {
    let (mut store, mut memory) = (Flash::empty().store(), Box::new(BoardMemory::CLEARED));
    let mut session = Session::with_flash(BOARD, &mut store, &mut *memory);
    let built = report(&session);
    assert_eq!(
        built,
        (settings::built(), KeptReport { is_kept: true, slots: [Err(RigFault::Empty); 2] }, 0)
    );
    accept(&mut session, &mut memory, changes());
    assert_eq!(
        (session.kept().is_kept, value(&session, CELL), value(&session, MAX_DISPARITY)),
        (false, 16.0, 48.0)
    );
    assert_eq!((session.vehicle.policy, session.vehicle.block_cm), (Policy::Silent, Some(250)));

    let mut session = Session::with_flash(BOARD, &mut store, &mut *memory);
    assert_eq!(report(&session), built, "nobody has asked to keep them");
    accept(&mut session, &mut memory, changes().into_iter().chain([Request::KeepSettings]));
    let kept = report(&session);
    assert_eq!(
        (kept.1, kept.2),
        (KeptReport { is_kept: true, slots: [Ok(0), Err(RigFault::Empty)] }, 1)
    );

    let mut session = Session::with_flash(BOARD, &mut store, &mut *memory);
    assert_eq!(report(&session), kept);
    assert_eq!(
        session.vehicle,
        Vehicle {
            range_m: 6.0,
            policy: Policy::Silent,
            rate_hz: 20,
            block_cm: Some(250),
            ..Vehicle::DEFAULT
        }
    );

    accept(&mut session, &mut memory, [Request::ResetSettings]);
    assert_eq!(session.values(), built.0);
    let session = Session::with_flash(BOARD, &mut store, &mut *memory);
    assert_eq!((session.values(), session.areas()), (built.0, None));
}

#[test]
fn every_setting_is_the_one_that_is_set() {
    let mut session = Session::new(BOARD);
    let sets = [
        -1.0, 60.0, 50.0, 22.0, 8.0, 16.0, 3.0, 0.5, 1.0, -90.0, 5.0, -2.0, 2.0, 7.0, 12.0, 2.0,
        300.0, 1.0, 0.1, 1.0,
    ];
    let mut expected = settings::built();
    for (number, (expected_value, value)) in (0..).zip(expected.clone().iter().zip(sets)) {
        assert_ne!(*expected_value, value, "{number}");
        session.set(number, value).unwrap();
        expected[usize::from(number)] = value;
        assert_eq!(session.values(), expected, "{number}");
    }
    // All confidences come back as they were.
    for bits in (6554..=u16::MAX).step_by(97) {
        let update = ParamUpdate {
            min_confidence: Some(Confidence::from_bits(bits)),
            ..ParamUpdate::default()
        };
        let mut memory = Box::new(BoardMemory::CLEARED);
        accept(&mut session, &mut memory, [Request::SetParams(update)]);
        let before = session.values();
        session.set(RATE_HZ, 11.0).unwrap();
        session.set(RATE_HZ, 12.0).unwrap();
        assert_eq!((before, f32::from(bits) / 65_536.0), (session.values(), before[7]));
    }
}

#[test]
fn what_is_built_is_within_the_ranges_and_what_is_beyond_them_is_refused() {
    for (number, (setting, built)) in (0..).zip(Setting::ALL.iter().zip(settings::built())) {
        assert!(setting.takes(built) && setting.name.len() <= 16, "{setting:?}");
        for value in [setting.least - 1.0, setting.largest + 1.0] {
            assert!(Session::new(BOARD).set(number, value).is_err(), "{setting:?}");
        }
    }
}

#[test]
fn what_is_refused_is_named_and_changes_nothing() {
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut session = Session::new(BOARD);
    session.set(11, 0.5).unwrap();
    let before = report(&session);
    let cases = [
        (set(RANGE_M, 0.05), "range_m is 0.05 but must be 0.1 to 600"),
        (set(9, f32::NAN), "yaw_deg is NaN but must be -180 to 180"),
        (set(12, 0.25), "highest_m is 0.25 but must be 0.5 to 1000"),
        (set(RATE_HZ, 21.0), "rate_hz is 21 but must be a whole number from 10 to 20"),
        (set(RATE_HZ, 12.5), "rate_hz is 12.5 but must be a whole number from 10 to 20"),
        (set(BLOCK_CM, 1000.0), "block_cm is 1000 but must be a whole number from 0 to 1000"),
        (set(3, 1000.0), "edge_gradient is 1000 but must be 4 to 48"),
        (set(SETTINGS as u8, 1.0), "this board cannot do that"),
        (Request::KeepSettings, "the board cannot keep it in flash"),
    ];
    for (request, says) in cases {
        let Outcome::Refused(refusal) = outcome(&mut session, &mut memory, request) else {
            panic!("{says}")
        };
        assert_eq!(refusal.to_string(), says);
    }
    assert_eq!(report(&session), before);
}

#[test]
fn a_new_rig_brings_its_own_range_over_a_reset_as_well() {
    let (mut store, mut memory) = (Flash::empty().store(), Box::new(BoardMemory::CLEARED));
    let mut session = Session::with_flash(BOARD, &mut store, &mut *memory);
    accept(&mut session, &mut memory, [rig(40)]);
    accept(&mut session, &mut memory, changes().into_iter().chain([Request::KeepSettings]));
    let of = |session: &Session<'_>| (value(session, MAX_DISPARITY), value(session, CELL));
    let mut session = Session::with_flash(BOARD, &mut store, &mut *memory);
    assert_eq!(of(&session), (48.0, 16.0), "as they were kept");
    accept(&mut session, &mut memory, [rig(32)]);
    assert_eq!(of(&session), (32.0, 16.0));
    let mut session = Session::with_flash(BOARD, &mut store, &mut *memory);
    assert_eq!(of(&session), (32.0, 16.0), "as before the reset");
    accept(&mut session, &mut memory, [Request::ResetSettings]);
    assert_eq!(of(&session), (32.0, 20.0), "the rig's");
}

#[test]
fn kept_settings_that_this_program_does_not_take_are_named() {
    let (mut store, mut memory) = (Flash::empty().store(), Box::new(BoardMemory::CLEARED));
    let mut values = [None; SETTINGS];
    (values[5], values[10]) = (Some(16.0), Some(0.0));
    store.store_settings(&KeptSettings { rig: None, values, regions: Regions::default() }).unwrap();
    let session = Session::with_flash(BOARD, &mut store, &mut *memory);
    assert_eq!(session.kept().slots, [Err(RigFault::OutOfRange), Err(RigFault::Empty)]);
    assert_eq!(session.values(), settings::built());
}

/// PARAM_REQUEST_LIST, PARAM_REQUEST_READ and PARAM_SET of a ground station.
enum Ask<'n> {
    List,
    Read(&'n str),
    Set(&'n str, f32),
}

/// A message of these fields.
struct Raw<const ID: u32, const EXTRA: u8>(Vec<u8>);

impl<const ID: u32, const EXTRA: u8> Mavlink for Raw<ID, EXTRA> {
    const ID: u32 = ID;
    const CRC_EXTRA: u8 = EXTRA;

    fn put(&self, fields: &mut Fields) {
        fields.put(&self.0);
    }
}

fn frame(ask: &Ask<'_>) -> Vec<u8> {
    let mut station = Sender { system: 255, component: 190, sequence: 0 };
    let mut bytes = Vec::new();
    let mut write = |frame: &[u8]| {
        bytes.extend_from_slice(frame);
        Ok::<(), ()>(())
    };
    let name = |name: &str| [name.as_bytes(), &vec![0; 16 - name.len()]].concat();
    let sent = match ask {
        Ask::List => station.send(&Raw::<21, 159>(vec![1, 196]), &mut write),
        Ask::Read(of) => {
            station.send(&Raw::<20, 214>([vec![0xff, 0xff, 1, 196], name(of)].concat()), &mut write)
        }
        Ask::Set(of, value) => {
            let fields = [value.to_le_bytes().to_vec(), vec![1, 196], name(of), vec![9]].concat();
            station.send(&Raw::<23, 168>(fields), &mut write)
        }
    };
    sent.unwrap();
    bytes
}

/// Name, value, number and count of each PARAM_VALUE.
fn values(bytes: &[u8]) -> Vec<(String, f32, u16, u16)> {
    let value = |(id, payload): (u32, Vec<u8>)| {
        let number = |at: usize| u16::from_le_bytes([payload[at], payload[at + 1]]);
        let name = (id == 22).then(|| core::str::from_utf8(&payload[8..24]).unwrap())?;
        let value = f32::from_le_bytes(payload[..4].try_into().unwrap());
        Some((name.trim_end_matches('\0').to_owned(), value, number(6), number(4)))
    };
    mavlink_frames(bytes).into_iter().filter_map(value).collect()
}

#[test]
fn a_ground_station_reads_and_sets_parameters_that_outlive_a_reset() {
    let (mut store, mut memory) = (Flash::empty().store(), Box::new(BoardMemory::CLEARED));
    // A turn takes two looks at the clock at least, 50 ms.
    let (host, autopilot) = (Port::with_look(25_000), Port::default());
    let session = Session::with_flash(BOARD, &mut store, &mut *memory);
    let mut board = Running::start(session, &host, Painter::new(DIMS)).with_autopilot(&autopilot);
    let mut ask = |asks: &[Ask<'_>], turns: usize| {
        asks.iter().for_each(|ask| autopilot.give(&frame(ask)));
        board.turns(turns);
        values(&autopilot.bytes())
    };
    let names = Setting::ALL.map(|of| of.name.to_uppercase());
    let all = ask(&[Ask::List], 10);
    let count = SETTINGS as u16;
    assert_eq!(
        all.iter().map(|of| (of.0.as_str(), of.2, of.3)).collect::<Vec<_>>(),
        (0..count)
            .zip(&names)
            .map(|(index, name)| (name.as_str(), index, count))
            .collect::<Vec<_>>()
    );
    assert!(ask(&[], 10).is_empty(), "once");

    let one = |name: &str, value: f32| {
        let index = names.iter().position(|of| of == name).unwrap() as u16;
        vec![(name.to_owned(), value, index, count)]
    };
    assert_eq!(ask(&[Ask::Read("RANGE_M")], 1), one("RANGE_M", 10.0));
    assert_eq!(ask(&[Ask::Read("NOTHING")], 1), []);
    assert_eq!(ask(&[Ask::Set("RANGE_M", 6.5)], 1), one("RANGE_M", 6.5));
    // Refused: the answer is the value that still counts.
    for (name, value, old) in [
        ("RANGE_M", 0.0, 6.5),
        ("CELL", 7.0, 20.0),
        ("CELL", 16.5, 20.0),
        ("POLICY", 3.0, 1.0),
        ("SYSTEM", 256.0, 1.0),
        ("SYSTEM", 0.0, 1.0),
        ("MAX_DISPARITY", f32::NAN, 64.0),
    ] {
        assert_eq!(ask(&[Ask::Set(name, value)], 1), one(name, old), "{name} {value}");
    }
    // Each that is set is the one that is read, and no other changes.
    let sets = [
        7.0, 60.0, 50.0, 22.0, 8.0, 16.0, 3.0, 0.5, 1.0, -90.0, 5.0, -2.0, 2.0, 1.0, 12.0, 2.0,
        300.0, 1.0, 0.1, 1.0,
    ];
    for (name, value) in names.iter().zip(sets).skip(1) {
        assert_eq!(ask(&[Ask::Set(name, value)], 1), one(name, value));
    }
    let listed: Vec<f32> = ask(&[Ask::List], 10).iter().map(|of| of.1).collect();
    assert_eq!(listed[1..], sets[1..]);
    ask(&[], 30); // more than a second without another one: they go into the flash
    // Many requests at once cost several turns, and none is lost.
    let many: Vec<Ask<'_>> = (0..20).map(|_| Ask::Read("CELL")).collect();
    let first = ask(&many, 1).len();
    assert!((4..=8).contains(&first), "{first}");
    assert_eq!(first + ask(&[], 10).len(), 20);

    let mut memory = Box::new(BoardMemory::CLEARED);
    let session = Session::with_flash(BOARD, &mut store, &mut *memory);
    assert_eq!(session.values()[1..], sets[1..]);
    assert!(host.room().free > 0);
}

#[test]
fn times_are_in_the_hosts_clock_as_long_as_it_says_so() {
    let mut board = Running::start(Session::new(BOARD), &Port::with_look(1000), Painter::new(DIMS));
    board.ask(9, Request::Start);
    let time =
        |messages: &[Message]| (heads(messages)[0].capture_time_us, heads(messages)[0].clock);
    let (own_us, clock) = time(&board.messages(1));
    assert_eq!(clock, TimeSource::Board);
    let asked = board.ask(9, Request::ReadClock);
    let said = asked.iter().find_map(|message| {
        if let Message::Clock(board_us) = message { Some(*board_us) } else { None }
    });
    let board_us = said.unwrap();
    assert!(board_us > own_us && board_us < own_us + 20_000, "{board_us} after {own_us}");

    let ahead = 1_700_000_000_000_000;
    let (host_us, clock) = time(&board.ask(9, Request::SetClock(ahead)));
    assert_eq!(clock, TimeSource::Host);
    assert!((ahead + board_us..ahead + board_us + 20_000).contains(&host_us), "{host_us}");
    board.port.pass(10_000_000); // the host has gone
    let (own_us, clock) = time(&board.messages(1));
    assert_eq!(clock, TimeSource::Board);
    assert!((10_000_000..10_100_000).contains(&own_us), "{own_us}");
}

#[test]
fn times_are_in_the_autopilots_clock_by_its_answers() {
    let (port, autopilot) = (Port::with_look(5000), Port::default());
    let mut board =
        Running::start(Session::new(BOARD), &port, Painter::new(DIMS)).with_autopilot(&autopilot);
    port.send(1, rig_numbers(RIG));
    port.send(2, Request::Start);
    let (mut asked, mut clocks) = (0, Vec::new());
    for _ in 0..400 {
        board.turn();
        let bytes = autopilot.bytes();
        // TIMESYNC with tc1 0: the autopilot is 5 s ahead.
        if let Some(at) =
            bytes.windows(10).position(|head| head[0] == 0xfd && head[7..] == [111, 0, 0])
        {
            let mut payload = bytes[at + 10..][..usize::from(bytes[at + 1])].to_vec();
            payload.resize(16, 0);
            assert_eq!(payload[..8], [0; 8], "a question");
            let ts1 = i64::from_le_bytes(payload[8..].try_into().unwrap());
            let answer = [(ts1 + 5_000_000_000).to_le_bytes(), ts1.to_le_bytes()].concat();
            let mut sender = Sender { system: 1, component: 1, sequence: 0 };
            let Ok(()) = sender.send(&Raw::<111, 34>(answer), &mut |frame: &[u8]| {
                autopilot.give(frame);
                Ok::<(), core::convert::Infallible>(())
            });
            asked += 1;
        }
        let heads = heads(&port.received());
        clocks.extend(heads.first().map(|head| (head.clock, head.capture_time_us)));
    }
    assert_eq!(clocks[0].0, TimeSource::Board);
    let (last, time_us) = *clocks.last().unwrap();
    assert_eq!(last, TimeSource::Autopilot);
    // Half of the round trip, a turn or two.
    let first_us = clocks.iter().find(|(clock, _)| *clock == TimeSource::Autopilot).unwrap().1;
    assert!((5_000_000..5_200_000).contains(&first_us), "{first_us}");
    assert!(
        asked >= 2 && ((time_us - 5_000_000) / 1_000_000).abs_diff(asked) <= 1,
        "asked {asked} times, {time_us} us"
    );
    assert!(clocks.windows(2).all(|two| two[0].1 < two[1].1), "times run forwards");
}

/// Pairs come between 200 commands that wait.
#[test]
fn a_burst_of_commands_does_not_stop_the_pairs() {
    let port = Port::default();
    let mut board = Running::start(Session::new(BOARD), &port, Painter::new(DIMS));
    port.send(1, rig_numbers(RIG));
    port.send(2, Request::Start);
    board.turns(2);
    port.received();
    (3..203).for_each(|id| port.send(id, Request::Settings));
    let (mut answers, mut turns) = (0, 0);
    while answers < 200 && turns < 200 {
        let messages = board.messages(1);
        let of = |kind: fn(&Message) -> bool| messages.iter().filter(|of| kind(of)).count();
        let answered = of(|message| matches!(message, Message::Answer(_)));
        let frames = of(|message| matches!(message, Message::Frame(_)));
        assert!((1..=6).contains(&answered) && frames == 1, "{answered}, {frames}");
        (answers, turns) = (answers + answered, turns + 1);
    }
    assert_eq!(answers, 200);
}

/// The first painted pair, a matcher, and the directions that its rig sees.
fn painted() -> (Box<BoardMemory>, Matcher, ObstaclePlan) {
    let mut memory = Box::new(BoardMemory::CLEARED);
    let params = Params { rig: Some(RIG.rig().unwrap()), ..Params::DEFAULT };
    let plan = Vehicle::DEFAULT.directions().plan(&params, DIMS).unwrap();
    Painter::new(DIMS).next_pair(&mut *memory, None).unwrap();
    (memory, Matcher::new(params, DIMS).unwrap(), plan)
}

/// Objects outside of the areas that are matched may stand in the way.
#[test]
fn directions_are_not_taken_from_areas_of_a_pair() {
    let (mut memory, mut matcher, plan) = painted();
    let middle = [Area { left: 40, top: 20, right: 90, bottom: 70 }];
    let seen = [None, Some(&middle[..])].map(|areas| {
        matcher.forget_health(); // the second pair is the first again
        let options = Options { areas, ..Options::default() };
        let matched = memory.run(None, &mut matcher, options).unwrap();
        assert!(matched.is_fit() && matched.obstacle_points().count() > 0);
        let mut obstacles = Obstacles::new();
        matched.update_obstacles(&plan, &mut obstacles, 0);
        let is_known = |sector| !matches!(sector, Sector::Outside | Sector::Unknown);
        (obstacles.is_fit(), obstacles.sectors(&plan, 0).any(is_known))
    });
    assert_eq!(seen, [(true, true), (false, false)]);
}

/// Directions of the first pair are those of the core; each frame has its own, until the setting is
/// off.
#[test]
fn a_host_that_wants_directions_gets_them_with_each_pair() {
    let (mut memory, mut matcher, plan) = painted();
    let matched = memory.run(None, &mut matcher, Options::default()).unwrap();
    let mut obstacles = Obstacles::new();
    matched.update_obstacles(&plan, &mut obstacles, 0);
    let record =
        |(index, sector)| SectorRecord::new(index, sector, obstacles.drop_off(&plan, index, 0));
    let expected: Vec<_> = (0..).zip(obstacles.sectors(&plan, 0)).filter_map(record).collect();
    assert!(expected.len() > 3, "{expected:?}");

    let port = Port::with_look(1000);
    let mut board = Running::start(Session::new(BOARD), &port, Painter::new(DIMS));
    port.send(1, rig_numbers(RIG));
    port.send(2, set(SECTORS, 1.0));
    port.send(3, Request::Start);
    let mut frames = |turns: usize| {
        let mut frames = Vec::new();
        for message in board.messages(turns) {
            match message {
                Message::Frame(head) => frames.push((head.sequence, None)),
                Message::Sectors(sectors) => {
                    let (sequence, found) = frames.last_mut().unwrap();
                    assert_eq!((sectors.sequence, sectors.turn), (*sequence, 72));
                    assert_eq!(found.replace(sectors.list.to_vec()), None, "once");
                }
                _ => {}
            }
        }
        frames
    };
    let found = frames(8);
    assert_eq!(found[0].1.as_ref(), Some(&expected));
    assert!(found.len() > 4 && found.iter().all(|(_, list)| list.is_some()), "{found:?}");
    // What an earlier pair showed is told with its age.
    let is_older = |record: &SectorRecord| record.nearest.is_some_and(|seen| seen.age_ms > 0);
    assert!(found.iter().any(|(_, list)| list.iter().flatten().any(is_older)));
    port.send(4, set(SECTORS, 0.0));
    let found = frames(4);
    assert!(!found.is_empty() && found.iter().all(|(_, list)| list.is_none()), "{found:?}");
}

#[test]
fn a_board_leaves_for_its_boot_loader_after_the_answer() {
    for (has_bootloader, expected) in [(false, Turn::Idle), (true, Turn::Leave)] {
        let mut session = Session::new(BOARD);
        session.has_bootloader = has_bootloader;
        let mut board = Running::start(session, &Port::with_look(1), Painter::new(DIMS));
        board.port.received();
        board.port.send(3, Request::Bootloader);
        assert_eq!(board.turn(), expected);
        let outcome =
            if has_bootloader { Outcome::Accepted } else { Outcome::Refused(Refusal::Unsupported) };
        assert_eq!(board.port.received(), [Message::Answer(Answer { command: 3, outcome })]);
    }
}

#[test]
fn the_light_follows_the_pairs() {
    let port = Port::with_look(0);
    let once = scripted(|call, paint| if call == 1 { paint() } else { None });
    let mut board = Running::start(Session::new(BOARD), &port, once);
    let mut lit_after = |ms: u32| {
        port.pass(1000 * ms);
        board.turn();
        board.live.is_lit()
    };
    assert!(lit_after(100) && !lit_after(300), "a short flash: nobody wants pairs");
    port.send(1, Request::Start);
    assert!(lit_after(0), "0.4 s: fit, between two gaps");
    assert!(!lit_after(0), "no pair comes any more");
    assert!(lit_after(250) && !lit_after(250));
}
