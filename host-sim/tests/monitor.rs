//! `linestereo monitor` as a user types it: a damaged file, a board behind a connection, a serial
//! port, and bad input.

use crate::support::{
    Folder, failed, json_lines, keys, linestereo, listening, refused, says, stderr, stdout, tells,
    with_file,
};
use linestereo::results::{ImagePosition, Match, Owner, Techniques};
use linestereo::units::{Confidence, Depth, Disparity, INFINITE_DEPTH, Position};
use linestereo::{Dims, Params};
use linestereo_wire::*;
use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::path::Path;
use std::process::Output;
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};

const DIMS: Dims = Dims { width: 320, height: 240 };

fn monitor(folder: &Path, args: &str) -> Output {
    linestereo(folder, &format!("monitor {args}"))
}

pub(crate) fn packet<T: Record>(record: &T) -> Vec<u8> {
    encode(record, &mut [0; MAX_PACKET]).unwrap().to_vec()
}

fn found(id: u16) -> Match {
    let point = |x: u16, y: u16| ImagePosition {
        x: Position::from_bits(32 * x),
        y: Position::from_bits(32 * y + 8),
    };
    Match {
        ends: [point(id, 10), point(id + 3, 40)],
        disparity: [Disparity::from_num(20), Disparity::from_num(20.25)],
        sigma: Disparity::from_num(0.125),
        confidence: Confidence::from_num(0.95),
        owner: Owner::Left,
        depth: Some([
            Depth::from_num(2),
            if id == 7 { INFINITE_DEPTH } else { Depth::from_num(2 + id / 2) },
        ]),
        depth_sigma: None,
        techniques: Techniques {
            feature: None,
            window: Disparity::from_num(20),
            census: Disparity::from_num(20.5),
        },
    }
}

/// The packets of a frame: its head, and its segments by tens.
pub(crate) fn frame(sequence: u32, segments: u16) -> Vec<Vec<u8>> {
    let mut core = linestereo::results::Counts::default();
    (core.segments_left, core.matched, core.segments_left_dropped) =
        (40, segments, u16::from(sequence == 1));
    let times = FrameTimes { waiting_us: 11_000, matching_us: 21_500, port_us: 300 };
    let head = FrameHead {
        times,
        ..FrameHead::new(sequence, 40_000 * u64::from(sequence), DIMS, Health::GOOD, &core)
    };
    let matches: Vec<Match> = (0..segments).map(found).collect();
    let mut packets = Vec::new();
    send_frame(&head, &matches, &mut |packet| {
        packets.push(packet.to_vec());
        Ok::<(), ()>(())
    })
    .unwrap();
    packets
}

fn hello() -> Message {
    let board = "a board".try_into().unwrap();
    Message::Hello(Hello {
        board,
        largest_width: 320,
        largest_height: 240,
        segments: 512,
        rig: RigReport::NONE,
        reset: None,
    })
}

/// The packet with one bit changed where it costs the checksum and nothing else.
fn with_a_wrong_bit(packet: &[u8]) -> Vec<u8> {
    let mut damaged = packet.to_vec();
    for place in (0..packet.len() - 1).rev() {
        damaged[place] ^= 1;
        let mut decoder: Decoder<Message, MAX_PACKET> = Decoder::new();
        let results: Vec<_> = damaged.iter().filter_map(|&byte| decoder.push(byte)).collect();
        if results == [Err(DecodeError::Checksum)] {
            return damaged;
        }
        damaged[place] ^= 1;
    }
    panic!("no bit costs only the checksum");
}

/// A payload with a right checksum.
fn enclosed(payload: &[u8]) -> Vec<u8> {
    let mut crc = !0_u32;
    for &byte in payload {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 * (crc & 1));
        }
    }
    // Nothing in it is zero, so the byte stuffing is one length in front.
    let whole = [payload, &(!crc).to_le_bytes()].concat();
    assert!(!whole.contains(&0) && whole.len() < 254);
    [&[whole.len() as u8 + 1][..], &whole, &[DELIMITER]].concat()
}

/// Every kind of damage once or more, and the bytes that it costs.
pub(crate) fn damaged_recording() -> (Vec<u8>, usize) {
    let mut bytes = packet(&hello());
    bytes.extend(frame(1, 25).concat());
    let mut second = frame(2, 25);
    second[2] = with_a_wrong_bit(&second[2]);
    bytes.extend(second.concat());
    // Frame 3 is missing; of frame 4 the head is damaged.
    let mut fourth = frame(4, 3);
    fourth[0] = with_a_wrong_bit(&fourth[0]);
    bytes.extend(fourth.concat());
    let garbage = [&[0x55; 2000][..], &[DELIMITER], &[9, 1, 2, DELIMITER]].concat(); // too long; cut short
    let version = enclosed(&[1, 77, 66, 55]);
    let malformed = enclosed(&[VERSION, 9, 9]);
    bytes.extend([&garbage[..], &version, &malformed].concat());
    bytes.extend(frame(5, 0).concat());
    let last = frame(6, 12);
    bytes.extend([&last[0][..], &last[1], &last[2][..20]].concat());
    let skipped =
        second[2].len() + fourth[0].len() + garbage.len() + version.len() + malformed.len() + 20;
    (bytes, skipped)
}

#[test]
fn a_damaged_file_is_shown_and_counted_exactly() {
    let (bytes, skipped) = damaged_recording();
    let folder = with_file("run.bin", &bytes);
    let output = monitor(folder.path(), "run.bin --record copy.bin");
    assert!(output.stderr.is_empty(), "{output:?}");
    let expected = format!(
        "    frame      time s  since ms  wait ms  match ms  port ms  segments  nearest m  farthest m  health\n\
         board: a board, images up to 320x240, up to 512 segments; rig: none; no flash to keep one\n\
        \x20       1       0.040         -     11.0      21.5      0.3        25       2.00    infinite  segments_dropped\n\
         health: segments_dropped: more segments than there is memory or time for: those that fit are used\n\
        \x20       2       0.080      40.0     11.0      21.5      0.3     15/25       2.00    infinite  good\n\
        \x20       5       0.200     120.0     11.0      21.5      0.3         0          -           -  good\n\
        \x20       6       0.240      40.0     11.0      21.5      0.3     10/12       2.00    infinite  good\n\
         frames: 2 complete, 2 incomplete (12 segments missing), 2 lost\n\
         packets: 12 good, 2 framing damaged, 2 checksum wrong, 1 too long, 1 malformed, 1 of another version\n\
         another version: version 1, this program reads version 8\n\
         bytes: {} received, {skipped} skipped\n",
        bytes.len()
    );
    assert_eq!(stdout(&output), expected);
    let copy = fs::read(folder.path().join("copy.bin")).unwrap();
    assert_eq!(copy, bytes, "the record is what was read");
}

#[test]
fn json_has_one_line_per_complete_frame() {
    let folder = with_file("run.bin", damaged_recording().0);
    let output = monitor(folder.path(), "run.bin --json");
    let lines = json_lines(&stdout(&output));
    let words = ["frames: 2 complete, 2 incomplete (12 segments missing), 2 lost\n"];
    says(&stderr(&output), &words);
    assert_eq!(
        lines.iter().map(|line| line["sequence"].as_u64().unwrap()).collect::<Vec<_>>(),
        [1, 5]
    );
    let first = &lines[0];
    let named = "capture_time_us clock counts health segments sequence size times_us";
    assert_eq!(keys(first), named);
    assert_eq!(first["capture_time_us"], 40_000);
    assert_eq!(first["size"], serde_json::json!([320, 240]));
    assert_eq!(
        first["times_us"],
        serde_json::json!({"waiting": 11_000, "matching": 21_500, "port": 300})
    );
    assert_eq!(first["health"], serde_json::json!({"flags": ["segments_dropped"]}));
    let expected = serde_json::json!({
        "id": 7, "left": [[7.0, 10.25], [10.0, 40.25]], "disparity_px": [20.0, 20.25], "sigma_px": 0.125,
        "confidence": 0.95, "owner": "left", "depth_m": [2.0, null],
        "techniques": {"feature": null, "window": 20.0, "census": 20.5},
    });
    assert_eq!(first["segments"][7], expected);
    assert_eq!(first["segments"].as_array().unwrap().len(), 25);
    let counts = first["counts"].as_object().unwrap();
    let names = linestereo_sim::results::listing::counts(&linestereo_wire::Counts::default());
    assert_eq!(counts.len(), names.len());
    assert!(names.iter().all(|(name, _)| counts.contains_key(*name)), "{counts:?}");
    assert_eq!((&counts["segments_left"], &counts["matched"]), (&40.into(), &25.into()));
    assert_eq!((&counts["segments_left_dropped"], &counts["slant"]), (&1.into(), &0.into()));
}

/// Directions of frame 1: an obstacle to the left, seen 40 ms before, a drop-off ahead, and a free
/// one.
pub(crate) fn sectors() -> Message {
    let seen = |distance_cm, age_ms| Some(Sighting { distance_cm, confidence_q16: 0xfd71, age_ms });
    let list = [
        SectorRecord { index: 0, nearest: None, drop_off: seen(80, 0) },
        SectorRecord { index: 1, nearest: seen(0, 0), drop_off: None },
        SectorRecord { index: 70, nearest: seen(125, 40), drop_off: seen(95, 0) },
    ];
    Message::Sectors(Sectors { sequence: 1, turn: 72, list: list.into_iter().collect() })
}

#[test]
fn directions_are_a_line_behind_their_frame() {
    let none = Sectors { sequence: 2, turn: 72, list: heapless::Vec::new() };
    let of_second = packet(&Message::Sectors(none));
    let bytes = [frame(1, 3).concat(), packet(&sectors()), frame(2, 0).concat(), of_second];
    let folder = with_file("run.bin", bytes.concat());
    let output = stdout(&monitor(folder.path(), "run.bin"));
    let lines: Vec<&str> = output.lines().collect();
    assert_eq!(
        (lines[3], lines[5]),
        (
            "sectors: obstacle 1.25 m at -10 degrees, drop-off 0.80 m at 0 degrees, 1 free",
            "sectors: unknown"
        )
    );
    let lines = json_lines(&stdout(&monitor(folder.path(), "run.bin --json")));
    assert_eq!(lines.len(), 4);
    let none = serde_json::json!({"sequence": 2, "turn": 72, "sectors": []});
    assert_eq!(
        (&lines[1]["sequence"], &lines[1]["turn"], &lines[3]),
        (&1.into(), &72.into(), &none)
    );
    let expected = serde_json::json!({
        "index": 70, "direction_deg": -10.0, "state": "obstacle", "distance_m": 1.25,
        "confidence": 0.99001, "age_ms": 40, "drop_off_m": 0.95, "drop_off_confidence": 0.99001,
    });
    assert_eq!(lines[1]["sectors"][2], expected);
    let states: Vec<_> = (0..3).map(|index| &lines[1]["sectors"][index]["state"]).collect();
    assert_eq!(states, ["unknown", "free", "obstacle"]);
}

#[test]
fn a_file_of_garbage_alone_or_of_nothing_is_refused() {
    let folder = Folder::new();
    let image: Vec<u8> =
        (0..50_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    fs::write(folder.path().join("image.png"), &image).unwrap();
    fs::write(folder.path().join("empty"), []).unwrap();
    for (file, bytes) in [("image.png", 50_000), ("empty", 0)] {
        let says = format!("linestereo: {file} holds nothing that a board sent, in {bytes} bytes");
        let error = failed(&monitor(folder.path(), file));
        assert!(error.starts_with(&says), "{error}");
    }
}

#[test]
fn count_stops_after_so_many_complete_frames() {
    let bytes = [frame(1, 3).concat(), frame(2, 0).concat(), frame(3, 0).concat()].concat();
    let folder = with_file("run.bin", bytes);
    let output = monitor(folder.path(), "run.bin --json --count 2");
    assert_eq!(stdout(&output).lines().count(), 2);
    assert!(stderr(&output).starts_with("frames: 2 complete, 0 incomplete, 0 lost\n"));
}

/// A board: answers commands as a firmware would, and sends frames while it is started.
struct Board<P> {
    port: P,
    decoder: Decoder<Command, MAX_COMMAND>,
    params: Params,
    /// Commands to leave without an answer, as if they were lost.
    deaf: usize,
    last_id: Option<u16>,
    log: Vec<Request>,
}

/// The next command at a board's port, or `None` when the host is gone or silent for as long as the
/// port waits.
pub(crate) fn next_command(
    port: &mut impl Read,
    decoder: &mut Decoder<Command, MAX_COMMAND>,
) -> Option<Command> {
    let mut byte = [0];
    loop {
        match port.read(&mut byte) {
            Ok(1) => {
                if let Some(command) = decoder.push(byte[0]) {
                    return Some(command.unwrap());
                }
            }
            Err(error) if error.kind() == ErrorKind::TimedOut => {} // as serial ports say it
            _ => return None,
        }
    }
}

impl<P: Read + Write> Board<P> {
    fn new(port: P, deaf: usize) -> Self {
        Self {
            port,
            decoder: Decoder::new(),
            params: Params::default(),
            deaf,
            last_id: None,
            log: Vec::new(),
        }
    }

    /// Sends what was asked for.
    fn accepted(&mut self, messages: &[Message]) -> Outcome {
        messages.iter().for_each(|message| self.port.write_all(&packet(message)).unwrap());
        Outcome::Accepted
    }

    /// Serves until the host is gone or a start was answered; gives what was asked.
    fn serve_until_start(&mut self) {
        self.port.write_all(b"boot: hello\r\n\0").unwrap(); // what a boot loader says first
        while let Some(Command { id, request }) = next_command(&mut self.port, &mut self.decoder) {
            if self.deaf > 0 {
                self.deaf -= 1;
                continue;
            }
            if self.last_id.replace(id) != Some(id) {
                self.log.push(request.clone()); // a slow answer makes the host ask again
            }
            let outcome = match &request {
                Request::SetParams(update) => {
                    update.checked(self.params, DIMS).map(|params| self.params = params).into()
                }
                Request::Describe => self.accepted(&[hello()]),
                Request::ReadClock => self.accepted(&[Message::Clock(BOARD_US)]),
                Request::Settings => {
                    let slots = [Ok(4), Err(RigFault::Empty)];
                    self.accepted(&[
                        Message::Setting(SettingValue { number: 5, value: 16.0 }),
                        Message::Setting(SettingValue { number: 15, value: 1.0 }),
                        Message::Kept(KeptReport { is_kept: true, slots }),
                    ])
                }
                Request::Start
                | Request::Stop
                | Request::SetRegions(_)
                | Request::SetClock(_)
                | Request::Set(_) => Outcome::Accepted,
                _ => Outcome::Refused(linestereo_wire::Refusal::Unsupported),
            };
            // An answer to somebody else, then the answer.
            for command in [id.wrapping_add(100), id] {
                let answer = Message::Answer(Answer { command, outcome: outcome.clone() });
                if self.port.write_all(&packet(&answer)).is_err() {
                    return;
                }
            }
            if request == Request::Start {
                return;
            }
        }
    }
}

/// Requests that a board was sent, its parameters after them, and the commands it would still leave
/// without an answer.
type Memory = (Vec<Request>, Params, usize);

/// A board behind a connection, which it closes in the end: its address, and its thread.
fn board(deaf: usize, frames: u32) -> (String, thread::JoinHandle<Memory>) {
    let (listener, address) = listening();
    let thread = thread::spawn(move || {
        let mut board = Board::new(listener.accept().unwrap().0, deaf);
        board.serve_until_start();
        for sequence in 0..frames {
            if board.port.write_all(&frame(sequence, 12).concat()).is_err() {
                break; // the host has enough
            }
        }
        (board.log, board.params, board.deaf)
    });
    (address, thread)
}

#[test]
fn a_board_is_described_set_started_and_watched() {
    let folder = Folder::new();
    let (address, thread) = board(0, 3);
    let send = "--send describe --send max_disparity=96 --send cell=24 --send start";
    let shown = stdout(&monitor(folder.path(), &format!("--tcp {address} --count 3 {send}")));
    let lines: Vec<&str> = shown.lines().collect();
    let expected = [
        "board: a board, images up to 320x240, up to 512 segments; rig: none; no flash to keep one",
        "accepted: describe",
        "accepted: max_disparity=96 cell=24",
        "accepted: start",
    ];
    assert_eq!(lines[1..5], expected);
    assert!(lines[7].starts_with("health: segments_dropped: "), "{shown}");
    assert_eq!(lines[9], "frames: 3 complete, 0 incomplete, 0 lost");
    assert!(
        lines[10].contains(" good, 1 framing damaged, 0 checksum wrong"),
        "the boot loader's line: {shown}"
    );
    let (log, params, _) = thread.join().unwrap();
    let update = ParamUpdate { max_disparity: Some(96), cell: Some(24), ..ParamUpdate::default() };
    assert_eq!(log, [Request::Describe, Request::SetParams(update), Request::Start]);
    assert_eq!(params, Params { max_disparity: 96, cell: 24, ..Params::default() });
}

/// Time of a board's clock.
const BOARD_US: u64 = 3_000_000;

#[test]
fn settings_are_shown_and_the_board_follows_this_computers_clock() {
    let folder = Folder::new();
    let (address, thread) = board(0, 1);
    let send = "--send range_m=6 --send settings --send sync --send start";
    let before = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_micros() as u64;
    let words =
        ["accepted: range_m=6\n", "settings (kept; slots: image 4, empty): cell=16 policy=block\n"];
    tells(folder.path(), &format!("monitor --tcp {address} --count 1 {send}"), &words);
    let after = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_micros() as u64;
    let (log, ..) = thread.join().unwrap();
    let [
        set,
        Request::Settings,
        Request::ReadClock,
        Request::SetClock(offset_us),
        Request::Describe,
        Request::Start,
    ] = &log[..]
    else {
        panic!("{log:?}")
    };
    assert_eq!(*set, Request::Set(SettingValue { number: 10, value: 6.0 }));
    assert!((before..after).contains(&(offset_us + BOARD_US)), "{offset_us}");
}

#[test]
fn a_refused_parameter_is_named_and_changes_nothing() {
    let folder = Folder::new();
    let cases = [
        ("max_disparity=320", "max_disparity is 320 but must be 8 to 256"),
        ("min_confidence=0.05", "min_confidence (percent) is 5 but must be 10 to 99"),
        ("reach=0", "reach is 0 but must be 1 to 6"),
    ];
    for (word, says) in cases {
        let (address, thread) = board(0, 0);
        let args = format!("--tcp {address} --count 0 --send cell=24 --send {word} --send start");
        let error = failed(&monitor(folder.path(), &args));
        assert_eq!(error, format!("linestereo: the board refused cell=24 {word}: {says}\n"));
        let (log, params, _) = thread.join().unwrap();
        assert_eq!((log.len(), params), (1, Params::default()), "no start after a refusal");
    }
    let (address, thread) = board(0, 0);
    let args = format!("--tcp {address} --count 0 --send focal_px=0.5 --send baseline_m=0.1");
    says(&failed(&monitor(folder.path(), &args)), &["focal length 0.5 px is outside"]);
    thread.join().unwrap();
}

#[test]
fn a_lost_command_is_sent_again() {
    let folder = Folder::new();
    let (address, thread) = board(2, 0);
    let output = monitor(folder.path(), &format!("--tcp {address} --count 0 --send start"));
    let board = "board: a board, images up to 320x240, up to 512 segments; rig: none; no flash to keep one\n";
    assert_eq!(
        stdout(&output),
        format!("{board}accepted: describe\naccepted: start\n"),
        "described once, unasked"
    );
    assert_eq!(thread.join().unwrap().0, [Request::Describe, Request::Start]);
}

#[test]
fn a_board_that_never_answers_is_an_error() {
    let folder = Folder::new();
    let (address, thread) = board(usize::MAX, 0);
    let output = monitor(folder.path(), &format!("--tcp {address} --count 0 --send stop"));
    says(&failed(&output), &["linestereo: no answer to stop in 5 s"]);
    assert_eq!(usize::MAX - thread.join().unwrap().2, 5, "it was sent five times");
}

#[test]
fn a_closed_connection_is_one_line_after_the_summary() {
    let folder = Folder::new();
    let (address, thread) = board(0, 2);
    let output = monitor(folder.path(), &format!("--tcp {address} --send start"));
    thread.join().unwrap();
    let closed = format!("linestereo: the connection to {address} was closed");
    says(&failed(&output), &[&closed]);
    let shown = String::from_utf8_lossy(&output.stdout);
    says(&shown, &["frames: 2 complete, 0 incomplete, 0 lost\n"]);
}

#[cfg(unix)]
#[test]
fn a_board_on_a_serial_port_is_watched() {
    use serialport::{SerialPort, TTYPort};
    let folder = Folder::new();
    let (master, slave) = TTYPort::pair().unwrap();
    let name = slave.name().unwrap();
    let thread = thread::spawn(move || {
        let mut board = Board::new(master, 0);
        board.serve_until_start();
        board.port.write_all(&[frame(0, 12), frame(1, 12)].concat().concat()).unwrap();
        board // a port that is closed forgets what it holds
    });
    let line = format!("monitor --serial {name} --baud 921600 --send start --count 2");
    let words =
        ["accepted: describe\naccepted: start\n", "frames: 2 complete, 0 incomplete, 0 lost\n"];
    tells(folder.path(), &line, &words);
    assert_eq!(thread.join().unwrap().log, [Request::Describe, Request::Start]);
    drop(slave);
}

#[test]
fn bad_input_gets_one_line() {
    let folder = with_file("run.bin", frame(1, 1).concat());
    let (_, unused) = listening();
    let cases: [(&str, &str); 14] = [
        ("", "<FILE|--tcp <HOST:PORT>|--serial <PORT>>"),
        ("missing.bin", "cannot read missing.bin"),
        (".", "cannot read ."),
        ("run.bin --tcp localhost:1", "--tcp"),
        ("run.bin --send start", "--send"),
        ("run.bin --baud 9600", "--baud"),
        ("run.bin --record run.bin", "--record run.bin and run.bin are the same"),
        ("run.bin --record no/such/folder", "no/such/folder"),
        ("--tcp nowhere", "cannot resolve nowhere"),
        (&format!("--tcp {unused}"), "cannot connect"),
        ("--serial no-such-port", "cannot open the serial port no-such-port"),
        (&format!("--tcp {unused} --send begin"), "--send begin is unknown"),
        (&format!("--tcp {unused} --send cell=many"), "cell=many"),
        ("run.bin --count -1", "-1"),
    ];
    for (args, word) in cases {
        refused(folder.path(), &format!("monitor {args}"), &[word]);
    }
    let input = fs::read(folder.path().join("run.bin")).unwrap();
    assert_eq!(input, frame(1, 1).concat(), "the input is as it was");
}

#[test]
fn help_shows_examples_and_names_every_parameter() {
    let folder = Folder::new();
    let shown =
        tells(folder.path(), "monitor --help", &["linestereo monitor --tcp localhost:4444"]);
    says(&shown, &linestereo_sim::monitor::requests::NAMES);
}
