//! `linestereo view` as a browser meets it: who is let in, events against the lines of `sequence`
//! and `monitor`, boxes, a board's link, the end.

use crate::monitor::{damaged_recording, frame, next_command, packet, sectors};
use crate::rectify::RIG;
use crate::support::{
    Folder, all_refused, json, json_lines, linestereo, listening, program, says, signal, stderr,
    succeed, with_drawn_pairs, with_file, with_pole, with_rig,
};
use base64::{Engine as _, prelude::BASE64_STANDARD};
use core::time::Duration;
use linestereo::Dims;
use linestereo_tests::browser::{Visit, browser, has};
use linestereo_wire::{
    Answer, Command as BoardCommand, Decoder, FrameHead, Health, MAX_COMMAND, Message,
    ObjectRecord, Objects, Outcome, PairHead, Pixels, Refusal, Regions, Request, send_objects,
};
use serde_json::{Value, json};
use std::env::temp_dir;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStdout, Stdio};
use std::thread;
use std::time::Instant;

/// The program, serving.
struct View {
    child: Child,
    stdout: BufReader<ChildStdout>,
    port: u16,
    token: String,
}

impl View {
    fn start(folder: &Path, args: &str) -> Self {
        let mut program = program(folder, &format!("view {args}"));
        let mut child = program.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut address = String::new();
        stdout.read_line(&mut address).unwrap();
        let told = address
            .trim()
            .strip_prefix("http://127.0.0.1:")
            .and_then(|rest| rest.split_once("/?token="));
        let Some((port, token)) = told else {
            panic!("{address:?} {}", stderr(&child.wait_with_output().unwrap()));
        };
        Self { child, stdout, port: port.parse().unwrap(), token: token.to_owned() }
    }

    fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.token)
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        stream
    }

    /// Sends bytes; the status and all that comes back.
    fn answer(&self, request: &[u8]) -> (u16, String) {
        let (mut stream, mut text) = (self.connect(), String::new());
        stream.write_all(request).unwrap();
        stream.read_to_string(&mut text).unwrap();
        let status = text.split(' ').nth(1).and_then(|status| status.parse().ok());
        (status.unwrap_or_else(|| panic!("{text:?}")), text)
    }

    fn head(&self, method: &str, path: &str, fields: &str) -> String {
        format!("{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{fields}\r\n", self.port)
    }

    fn post(&self, body: &str) -> u16 {
        let path = format!("/boxes?token={}", self.token);
        self.answer(
            (self.head("POST", &path, &format!("Content-Length: {}\r\n", body.len())) + body)
                .as_bytes(),
        )
        .0
    }

    fn events(&self) -> Events {
        let mut stream = self.connect();
        let path = format!("/events?token={}", self.token);
        stream.write_all(self.head("GET", &path, "").as_bytes()).unwrap();
        let mut events = Events(BufReader::new(stream));
        let head: Vec<String> =
            core::iter::from_fn(|| events.line()).take_while(|line| !line.is_empty()).collect();
        assert!(head[0] == "HTTP/1.1 200 OK" && head[1].contains("text/event-stream"), "{head:?}");
        events
    }

    /// Waits until all frames are shown, as the program says.
    fn shown(&mut self) {
        let mut line = String::new();
        self.stdout.read_line(&mut line).unwrap();
        assert_eq!(line, "all frames are shown; the page stays until Ctrl-C\n");
    }

    /// Ctrl-C; exit code, the rest of stdout, and stderr.
    fn interrupt(mut self) -> (Option<i32>, String, String) {
        signal(&self.child, "-INT");
        self.end()
    }

    fn end(&mut self) -> (Option<i32>, String, String) {
        let (mut said, mut errors) = (String::new(), String::new());
        self.stdout.read_to_string(&mut said).unwrap();
        self.child.stderr.take().unwrap().read_to_string(&mut errors).unwrap();
        (self.child.wait().unwrap().code(), said, errors)
    }
}

impl Drop for View {
    /// A test that fails leaves no program behind.
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Events as they come.
struct Events(BufReader<TcpStream>);

impl Events {
    fn line(&mut self) -> Option<String> {
        let mut line = String::new();
        (self.0.read_line(&mut line).unwrap() > 0).then(|| line.trim_end().to_owned())
    }

    /// Name and data of the next one; nothing at the end.
    fn next(&mut self) -> Option<(String, String)> {
        loop {
            let line = self.line()?;
            if let Some(name) = line.strip_prefix("event: ") {
                let data = self.line().unwrap();
                return Some((name.to_owned(), data.strip_prefix("data: ").unwrap().to_owned()));
            }
            assert!(line.is_empty() || line == ":", "{line}");
        }
    }

    /// The next one of this name.
    #[track_caller]
    fn of(&mut self, name: &str) -> String {
        loop {
            let (found, data) = self.next().expect("the events ended");
            if found == name {
                return data;
            }
        }
    }

    fn json(&mut self, name: &str) -> Value {
        serde_json::from_str(&self.of(name)).unwrap()
    }
}

#[test]
fn the_page_is_for_this_computer_and_its_token_alone() {
    let folder = with_drawn_pairs();
    let view = View::start(folder.path(), "rec");
    let (token, port) = (&view.token, view.port);
    assert_eq!(token.len(), 32);
    let page = format!("/?token={token}");
    let (status, text) = view.answer(view.head("GET", &page, "").as_bytes());
    assert!(
        status == 200
            && text.contains("<title>linestereo</title>")
            && text.contains("new EventSource"),
        "{text}"
    );
    for field in [
        "default-src 'none'", "connect-src 'self'", "Cache-Control: no-store",
        "Referrer-Policy: no-referrer",
    ] {
        assert!(text.contains(field), "{field}");
    }
    // Whatever it fetches is from here, and nothing in it is code of somebody else.
    assert!(
        !text.contains("https://")
            && !text.replace(&format!("http://127.0.0.1:{port}"), "").contains("http://")
    );
    let of_host = |host: &str| format!("GET {page} HTTP/1.1\r\nHost: {host}\r\n\r\n");
    let own = format!("127.0.0.1:{port}");
    let cases = [
        (of_host(&format!("localhost:{port}")), 200),
        (of_host("127.0.0.1"), 403),
        (of_host(&format!("attacker.example:{port}")), 403),
        (format!("GET {page} HTTP/1.1\r\n\r\n"), 403),
        (format!("GET {page} HTTP/1.1\r\nHost: {own}\r\nHost: {own}\r\n\r\n"), 400),
        (view.head("GET", &page, "Origin: http://attacker.example\r\n"), 403),
        (view.head("GET", &page, "Origin: null\r\n"), 403),
        (view.head("GET", &page, &format!("Origin: http://{own}\r\n")), 200),
        (view.head("GET", "/", ""), 403),
        (view.head("GET", "/events", ""), 403),
        (view.head("GET", "/?token=", ""), 403),
        (view.head("GET", &format!("/?token={}0", &token[1..]), ""), 403),
        (view.head("GET", &format!("/?token={}", &token[1..]), ""), 403),
        (view.head("GET", &format!("/../etc/passwd?token={token}"), ""), 404),
        (view.head("POST", &page, ""), 405),
        (view.head("GET", &format!("/boxes?token={token}"), ""), 405),
        (view.head("GET", &page, &format!("X: {}\r\n", "y".repeat(9000))), 431),
        (view.head("GET", &page, &"X: y\r\n".repeat(100)), 431),
        (view.head("POST", &format!("/boxes?token={token}"), "Content-Length: 5000\r\n"), 413),
        (view.head("POST", &format!("/boxes?token={token}"), "Content-Length: -1\r\n"), 400),
        (
            view.head("POST", &format!("/boxes?token={token}"), "Transfer-Encoding: chunked\r\n"),
            400,
        ),
        ("\x16\x03\x01\x02 hello\r\n\r\n".to_owned(), 400),
    ];
    for (request, status) in cases {
        assert_eq!(view.answer(request.as_bytes()).0, status, "{request}");
    }
    for body in [
        "",
        "x",
        "[[1,2,3]]",
        "[[9,2,3,4]]",
        "[[1,2,3,70000]]",
        &format!("[{}[1,1,2,2]]", "[1,1,2,2],".repeat(16)),
    ] {
        assert_eq!(view.post(body), 400, "{body}");
    }
    // Who says nothing is not waited for; another one is served meanwhile.
    let silent = view.connect();
    assert_eq!(view.answer(view.head("GET", &page, "").as_bytes()).0, 200);
    let (mut text, begin) = (String::new(), Instant::now());
    BufReader::new(&silent).read_to_string(&mut text).unwrap();
    assert!(
        text.starts_with("HTTP/1.1 408 ") && begin.elapsed() < Duration::from_secs(15),
        "{text}"
    );
    let visitors: Vec<Events> = (0..8).map(|_| view.events()).collect();
    let path = format!("/events?token={token}");
    assert_eq!(view.answer(view.head("GET", &path, "").as_bytes()).0, 503);
    drop(visitors);
    assert_eq!(view.interrupt().0, Some(0));
}

#[test]
fn events_of_pairs_are_the_lines_of_a_sequence() {
    let at: &Path = &with_drawn_pairs();
    let expected = succeed(at, "sequence rec");
    // The first pair is there for who comes before the second one.
    let view = View::start(at, "rec --rate 0.5");
    let mut events = view.events();
    let picture = events.json("picture");
    assert_eq!(picture["size"], json!([320, 240]));
    assert_eq!(picture["grey"].as_str().unwrap().len(), (320 * 240_usize).div_ceil(3) * 4);
    for line in expected.lines() {
        assert_eq!(events.of("frame"), line);
        assert!(!events.json("above")["points"].as_array().unwrap().is_empty());
        assert_eq!(events.json("sectors").as_array().unwrap().len(), 72);
    }
    // A box is answered after the last pair, too: by the depth that `sequence` gives.
    fs::write(at.join("box.csv"), "50,50,150,150\n").unwrap();
    let mut answered = json_lines(&succeed(at, "sequence rec --objects box.csv")).remove(2);
    assert_eq!(view.post("[[50,50,150,150],[400,300,500,400]]"), 200);
    assert_eq!(events.json("boxes"), json!([[50, 50, 150, 150], [400, 300, 500, 400]]));
    let mut found = events.json("objects");
    assert_eq!(
        (&found["boxes"], &found["rig"]),
        (&json!([[50, 50, 150, 150]]), &json!(true)),
        "one lies outside"
    );
    let [found, answered] = [&mut found, &mut answered].map(|of| of["objects"][0].take());
    assert!(found["depth_m"].is_number(), "{found}");
    for field in [
        "disparity_px", "sigma_px", "depth_m", "sigma_m", "nearest_m", "support", "confidence",
        "reason",
    ] {
        assert_eq!(found[field], answered[field], "{field}");
    }
    // Another visitor sees the same.
    let mut other = view.events();
    assert_eq!(other.json("boxes").as_array().unwrap().len(), 2);
    assert_eq!(other.json("objects")["objects"][0]["depth_m"], found["depth_m"]);
    let (code, said, errors) = view.interrupt();
    assert_eq!((code, errors), (Some(0), String::new()));
    assert_eq!(said, "all pairs are shown; the page stays until Ctrl-C\n3 pairs shown, 0 failed\n");
    assert_eq!(other.of("end"), "\"3 pairs shown, 0 failed\\n\"");
    assert_eq!(other.next(), None);
}

#[test]
fn events_of_a_board_are_the_lines_of_monitor() {
    let folder = with_file("run.bin", damaged_recording().0);
    let monitored = linestereo(folder.path(), "monitor run.bin --json");
    let expected = String::from_utf8(monitored.stdout).unwrap();
    let mut view = View::start(folder.path(), "run.bin --rate 0.5 --focal-px 300 --baseline-m 0.1");
    let mut events = view.events();
    for line in expected.lines() {
        assert_eq!(events.of("frame"), line);
        assert_eq!(events.json("sectors").as_array().unwrap().len(), 72);
    }
    let link = loop {
        let link = events.json("link");
        if link["incomplete"] == 2 {
            break link;
        }
    };
    let counted = ["complete", "incomplete", "lost", "missing_segments", "damaged"]
        .map(|name| link[name].clone());
    assert_eq!(counted, [2, 2, 2, 12, 6].map(Value::from));
    view.shown();
    let (code, summary, _) = view.interrupt();
    assert_eq!(code, Some(0));
    // The same as of `monitor`.
    assert_eq!(summary, String::from_utf8(monitored.stderr).unwrap().split_once('\n').unwrap().1);
}

/// A board behind the program's connection.
struct Board(TcpStream, Decoder<BoardCommand, MAX_COMMAND>);

impl Board {
    /// One that the program, called in this folder with these options besides, has connected to.
    fn shown(folder: &Path, args: &str) -> (View, Self) {
        let (listener, address) = listening();
        let view = View::start(folder, &format!("--tcp {address} {args}"));
        let board = listener.accept().unwrap().0;
        board.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        (view, Self(board, Decoder::new()))
    }

    fn send(&mut self, bytes: &[u8]) {
        self.0.write_all(bytes).unwrap();
    }

    fn say(&mut self, message: &Message) {
        self.send(&packet(message));
    }

    /// The next command, which is accepted.
    fn command(&mut self) -> Request {
        self.answered(Outcome::Accepted)
    }

    /// The next command, which has this outcome.
    fn answered(&mut self, outcome: Outcome) -> Request {
        let BoardCommand { id, request } =
            next_command(&mut self.0, &mut self.1).expect("no command in 20 s");
        self.say(&Message::Answer(Answer { command: id, outcome }));
        request
    }
}

fn record(label: u16) -> ObjectRecord {
    ObjectRecord {
        label,
        disparity_q6: Ok(64 * 12),
        sigma_q6: 16,
        slope_q10: [0; 2],
        spread_q6: 0,
        confidence_q16: 65_000,
        support: 9,
        depth_q16: Some([163_840, 6554, 160_000]),
    }
}

#[test]
fn boxes_of_the_page_are_asked_of_the_board() {
    let (mut view, mut board) = Board::shown(&temp_dir(), "--send start");
    assert_eq!(board.command(), Request::Describe);
    assert_eq!(board.command(), Request::Start);
    board.send(&frame(1, 3).concat());
    let mut events = view.events();
    assert_eq!(events.json("frame")["sequence"], 1);
    assert_eq!(view.post("[[10,20,30,40]]"), 200);
    let Request::SetRegions(Regions { boxes, only: false }) = board.command() else { panic!() };
    assert_eq!((boxes.len(), boxes[0].label, boxes[0].left, boxes[0].bottom), (1, 0, 10, 40));
    let list = [record(0)].into_iter().collect();
    board.say(&Message::Objects(Objects { sequence: 1, list }));
    let found = events.json("objects");
    assert_eq!(
        (&found["boxes"], &found["objects"][0]["depth_m"]),
        (&json!([[10, 20, 30, 40]]), &json!(2.5))
    );
    // Directions that it sends are drawn among all of the turn.
    board.say(&sectors());
    let found = events.json("sectors");
    assert_eq!((found.as_array().unwrap().len(), &found[70]["distance_m"]), (72, &json!(1.25)));
    assert_eq!((&found[0]["drop_off_m"], &found[2]["state"]), (&json!(0.8), &json!("unknown")));
    // The board is pulled out: the page is told, and the program says so.
    drop(board);
    assert!(events.of("end").contains("was closed"));
    let (code, _, errors) = view.end();
    assert!(
        code == Some(2) && errors.contains("was closed") && errors.lines().count() == 1,
        "{errors}"
    );
}

#[test]
fn a_board_that_matches_boxes_alone_sees_no_directions() {
    let box_alone = "--send only_box=3:1,2,30,40 --focal-px 300 --baseline-m 0.1";
    let (view, mut board) = Board::shown(&temp_dir(), box_alone);
    while !matches!(board.command(), Request::SetRegions(_)) {}
    let mut events = view.events();
    events.of("note");
    board.send(&frame(1, 3).concat());
    events.of("frame");
    let is_next = |(name, _): &(String, String)| name != "link";
    let names: Vec<String> =
        core::iter::from_fn(|| events.next()).take_while(is_next).map(|(name, _)| name).collect();
    assert!(
        names.contains(&"above".to_owned()) && !names.contains(&"sectors".to_owned()),
        "{names:?}"
    );
}

#[test]
fn depths_are_of_the_boxes_that_the_board_last_accepted() {
    let (view, mut board) = Board::shown(&temp_dir(), "");
    let mut events = view.events();
    let nine: Vec<[u16; 4]> = (0..9).map(|at| [at, 0, at + 9, 9]).collect();
    let records: Vec<ObjectRecord> = (0..10).map(record).collect();
    let refused = Outcome::Refused(Refusal::Region(0));
    // What is refused changes nothing, and ends nothing.
    for (sequence, boxes, outcome) in
        [(1, json!(nine), Outcome::Accepted), (2, json!([[0, 0, 9999, 9999]]), refused)]
    {
        let is_refused = outcome != Outcome::Accepted;
        assert_eq!(view.post(&boxes.to_string()), 200);
        board.answered(outcome);
        let note = events.of("note");
        assert!(note.contains("refused the boxes of the page: ") == is_refused, "{note}");
        // Two packets: of nine boxes and of one that nobody drew.
        send_objects(sequence, &records, &mut |packet| board.0.write_all(packet)).unwrap();
        assert_eq!(events.json("objects")["objects"].as_array().unwrap().len(), 8);
        let found = events.json("objects");
        assert_eq!(found["boxes"], json!(nine));
        let labels = found["objects"].as_array().unwrap().iter().map(|of| of["label"].as_u64());
        assert_eq!(labels.collect::<Vec<_>>(), (0..10).map(Some).collect::<Vec<_>>());
    }
    assert_eq!(view.interrupt().0, Some(0));
}

#[test]
fn boxes_over_a_recording_are_not_those_that_its_board_answered() {
    let list = [record(0)].into_iter().collect();
    let objects = packet(&Message::Objects(Objects { sequence: 1, list }));
    let folder = with_file("run.bin", [frame(1, 3).concat(), objects].concat());
    let view = View::start(folder.path(), "run.bin --repeat --rate 50");
    assert_eq!(view.post("[[10,20,30,40]]"), 200);
    let mut events = view.events();
    events.of("boxes");
    let found = events.json("objects");
    assert_eq!((&found["boxes"], &found["objects"][0]["label"]), (&json!([]), &json!(0)));
    // A pass of the recording after the other one is no restart of the board.
    let mut link = events.json("link");
    while link["complete"].as_u64().unwrap() < 3 {
        link = events.json("link");
    }
    assert_eq!((&link["restarts"], &link["lost"]), (&json!(0), &json!(0)));
    assert_eq!(view.interrupt().0, Some(0));
}

#[test]
fn a_pair_that_the_board_missed_is_told_and_ends_nothing() {
    let folder = with_rig(RIG);
    let missed = packet(&Message::Frame(FrameHead::new(
        1,
        5,
        Dims { width: 0, height: 0 },
        Health::PAIR_MISSING,
        &linestereo::results::Counts::default(),
    )));
    let bytes = [missed, frame(2, 3).concat()].concat();
    fs::write(folder.path().join("run.bin"), bytes).unwrap();
    for options in ["--focal-px 300 --baseline-m 0.1", "--rig rig.toml"] {
        let mut view = View::start(folder.path(), &format!("run.bin --rate 20 {options}"));
        let mut events = view.events();
        assert_eq!(events.json("frame")["size"], json!([0, 0]));
        assert_eq!(events.json("frame")["sequence"], 2, "{options:?}");
        assert_eq!(events.json("sectors").as_array().unwrap().len(), 72);
        view.shown();
        let (code, _, errors) = view.interrupt();
        assert_eq!(code, Some(0), "{errors}");
    }
}

/// Sends a photograph of 64x2 pixels whose left image has this grey; the first of its pixels that
/// are not lost.
fn photo(board: &mut Board, grey: u8, first: u32) {
    let head = PairHead { width: 64, height: 2, capture_time_us: 1, right_capture_time_us: None };
    board.say(&Message::Photo(head));
    for (is_right, grey) in [(false, grey), (true, 0)] {
        let list = [grey; 128].into_iter().collect();
        board.say(&Message::Pixels(Pixels { is_right, first, list }));
    }
}

#[test]
fn photographs_of_a_board_lie_under_its_segments() {
    let (view, mut board) = Board::shown(&temp_dir(), "--photograph 1");
    let mut events = view.events();
    // None, since the cameras delivered no pair: another one is asked for a second later.
    let none = Outcome::Refused(Refusal::NoPair);
    assert_eq!(board.answered(none), Request::Photograph);
    assert!(events.of("note").contains("refused photograph"));
    assert_eq!(board.command(), Request::Photograph);
    photo(&mut board, 77, 0);
    let expected = json!({"size": [64, 2], "grey": BASE64_STANDARD.encode([77; 128])});
    assert_eq!(events.json("picture"), expected);
    // Another one is asked for a second later. One that lacks pixels is said, and not shown.
    assert_eq!(board.command(), Request::Photograph);
    photo(&mut board, 78, 5);
    assert!(events.of("note").contains("accepted: photograph"));
    assert!(events.of("note").contains("pixels were lost"));
    assert_eq!(view.interrupt().0, Some(0));
}

#[test]
fn a_photograph_that_takes_longer_than_the_interval_is_not_begun_anew() {
    let (_view, mut board) = Board::shown(&temp_dir(), "--photograph 1");
    assert_eq!(board.command(), Request::Photograph);
    let head = PairHead { width: 64, height: 2, capture_time_us: 1, right_capture_time_us: None };
    board.say(&Message::Photo(head));
    board.0.set_read_timeout(Some(Duration::from_millis(300))).unwrap();
    for place in 0..8 {
        let list = [5; 16].into_iter().collect();
        let pixels = Pixels { is_right: false, first: 16 * place, list };
        board.say(&Message::Pixels(pixels));
        let asked = board.0.read(&mut [0]).unwrap_or(0);
        assert_eq!(asked, 0, "asked for another one at piece {place}");
    }
    let (is_right, first) = (true, 0);
    let list = [5; 128].into_iter().collect();
    board.say(&Message::Pixels(Pixels { is_right, first, list }));
    board.0.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    assert_eq!(board.command(), Request::Photograph);
}

#[test]
fn a_photograph_of_another_size_than_the_rig_is_left_out() {
    let folder = with_rig(RIG);
    let (view, mut board) = Board::shown(folder.path(), "--photograph 1 --rig rig.toml");
    let mut events = view.events();
    // The second one is asked for by a program that goes on.
    for _ in 0..2 {
        assert_eq!(board.command(), Request::Photograph);
        photo(&mut board, 77, 0);
        let mut note = events.of("note");
        while note.contains("accepted") {
            note = events.of("note");
        }
        assert!(
            note.contains("left out: the rig is for raw images of 320x240, but these are 64x2"),
            "{note}"
        );
    }
    assert_eq!(view.interrupt().0, Some(0));
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let at: &Path = &Folder::new();
    fs::write(at.join("image.png"), [7; 3000]).unwrap();
    fs::create_dir(at.join("empty")).unwrap();
    let (_taken, address) = listening();
    let port = address.rsplit(':').next().unwrap();
    fs::write(at.join("run.bin"), frame(1, 0).concat()).unwrap();
    let cases: [(&str, &str); 8] = [
        ("view", "--tcp"),
        ("view missing", "missing"),
        ("view empty", "empty"),
        (&format!("view run.bin --port {port}"), "give another --port, or 0"),
        ("view run.bin --rate 0", "give pairs a second"),
        ("view run.bin --send start", "--send"),
        ("view --tcp 127.0.0.1:1 --repeat", "--repeat"),
        ("view --tcp 127.0.0.1:1", "is something listening there?"),
    ];
    all_refused(at, &cases);
    // The page stands by then: what is wrong is said all the same.
    let output = linestereo(at, "view image.png");
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    says(&stderr(&output), &["image.png holds nothing that a board sent, in 3000 bytes"]);
}

/// Visits its page; `None` without browser or Node.
fn visit(view: &View, steps: &Value) -> Option<Visit> {
    let browser = browser().filter(|_| has("node"))?;
    Some(linestereo_tests::browser::visit(&browser, view.address().as_ref(), &[], steps))
}

#[test]
fn a_visitor_sees_the_pair_its_health_and_the_depth_of_a_box() {
    let at: &Path = &with_drawn_pairs();
    // One image twice: an object on the lens, or a camera that is delivered twice.
    fs::create_dir_all(at.join("same/1")).unwrap();
    let _ = ["left.png", "right.png"]
        .map(|name| fs::copy(at.join("rec/1/left.png"), at.join("same/1").join(name)).unwrap());
    fs::write(at.join("box.csv"), "50,50,150,150\n").unwrap();
    let answered = json_lines(&succeed(at, "sequence rec --objects box.csv")).remove(2);
    let [d, sigma, z, z_sigma, nearest, p] =
        ["disparity_px", "sigma_px", "depth_m", "sigma_m", "nearest_m", "confidence"]
            .map(|name| answered["objects"][0][name].as_f64().unwrap());
    let (view, same) = (View::start(at, "rec --rate 100"), View::start(at, "same"));
    let is_answered = "/ m ± /.test(document.getElementById('objects').innerText)";
    let steps = json!([
        {"until": "linestereo.line().name === '3'"},
        {"box": [50, 50, 150, 150]},
        {"until": is_answered},
    ]);
    let Some(Visit { found, logged }) = visit(&view, &steps) else { return };
    let expected = format!(
        "{z:.3} m ± {z_sigma:.3} m, nearest {nearest:.3} m; {d:.2} ± {sigma:.2} px, within 1 px \
         with {:.1} %",
        100.0 * p
    );
    assert_eq!(found[2]["objects"], json!([expected]));
    assert!(found[2]["summary"].as_str().unwrap().starts_with("3: 320x240, "), "{found:?}");
    assert_eq!(
        (&found[2]["error"], &found[2]["health"], &found[2]["wide"]),
        (&json!(""), &json!(""), &json!(false))
    );
    // The page, its events and the box are all that is fetched, and no script fails.
    let places: Vec<&str> =
        logged.iter().map(|url| url.split(['?', 'd']).next().unwrap()).collect();
    let own = |path: &str| format!("http://127.0.0.1:{}{path}", view.port);
    assert_eq!(logged.iter().filter(|url| !url.starts_with("data:")).count(), 3, "{logged:?}");
    assert!(
        places[0] == own("/") && logged.iter().any(|url| url.starts_with(&own("/boxes"))),
        "{logged:?}"
    );
    let Visit { found, .. } =
        visit(&same, &json!([{"until": "linestereo.line().name === '1'"}, {"until": "true"}]))
            .unwrap();
    let health = found[1]["health"].as_str().unwrap();
    assert!(health.contains("check that they come from two cameras"), "{found:?}");
}

#[test]
fn a_visitor_sees_bars() {
    let folder = with_pole();
    let line = json(folder.path(), "sequence rec");
    let bars = line["bars"].as_array().unwrap();
    let ends = bars[0]["left"].as_array().unwrap();
    let middle =
        |axis: usize| ends.iter().map(|end| end[axis].as_f64().unwrap()).sum::<f64>() / 2.0 + 0.5;
    let coloured = format!(
        "(() => {{ const canvas = document.getElementById('left'), scale = canvas.width / 320; \
         const [r, g, b] = canvas.getContext('2d').getImageData({} * scale, {} * scale, 1, 1).data; \
         return Math.max(r, g, b) - Math.min(r, g, b) > 100; }})()",
        middle(0),
        middle(1)
    );
    let click = |what: &str| {
        let done = format!("(document.getElementById('show-{what}').click(), true)");
        json!({"until": done})
    };
    let steps = json!([
        {"until": "linestereo.line().name === '1'"}, click("segments"), click("points"),
        {"until": coloured}, click("bars"), {"until": format!("!{coloured}")}
    ]);
    let view = View::start(folder.path(), "rec");
    let Some(Visit { found, logged }) = visit(&view, &steps) else { return };
    let summary = found[3]["summary"].as_str().unwrap();
    assert!(summary.contains(&format!(" points, {} bars", bars.len())), "{summary}");
    assert!(logged.iter().all(|line| !line.starts_with("exception")), "{logged:?}");
}

#[test]
fn a_visitor_sees_obstacles_without_points_and_asks_for_sixteen_boxes_at_most() {
    let folder = with_file("run.bin", [frame(1, 0).concat(), packet(&sectors())].concat());
    let mut view = View::start(folder.path(), "run.bin --focal-px 300 --baseline-m 0.1");
    view.shown();
    let boxes: Vec<[u16; 4]> = (0..16).map(|at| [at, 0, at + 9, 9]).collect();
    assert_eq!(view.post(&json!(boxes).to_string()), 200);
    let has_obstacle = "document.getElementById('top').getContext('2d') \
                        .getImageData(0, 0, 640, 480).data.some(value => value > 0)";
    let steps = json!([
        {"until": "linestereo.line().sequence === 1"},
        {"until": has_obstacle},
        {"until": "document.querySelectorAll('#objects li').length === 16"},
        {"box": [50, 50, 150, 150]},
        {"until": "document.getElementById('notes').innerText.includes('at most 16 boxes')"},
    ]);
    let Some(Visit { found, logged }) = visit(&view, &steps) else { return };
    assert_eq!(found[4]["objects"].as_array().unwrap().len(), 16, "{found:?}");
    assert!(logged.iter().all(|line| !line.starts_with("exception")), "{logged:?}");
}

/// Resident memory of a process, KiB.
fn resident(process: u32) -> u64 {
    let text = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse().unwrap()
}

/// A board sends thirty frames a second, 60 segments each: all of them arrive, in their order, and
/// memory stays.
#[test]
fn thirty_frames_a_second_arrive_whole() {
    let frames = 120;
    let (view, mut board) = Board::shown(&temp_dir(), "--focal-px 300 --baseline-m 0.1");
    let mut events = view.events();
    let sending = thread::spawn(move || {
        let begin = Instant::now();
        for sequence in 0..frames {
            let due = Duration::from_secs(sequence.into()) / 30;
            thread::sleep(due.saturating_sub(begin.elapsed()));
            board.send(&frame(sequence, 60).concat());
        }
        board
    });
    let mut early = 0;
    for sequence in 0..frames {
        let line = events.json("frame");
        assert_eq!(
            (line["sequence"].as_u64(), line["segments"].as_array().unwrap().len()),
            (Some(sequence.into()), 60)
        );
        if sequence == frames / 4 {
            early = resident(view.child.id());
        }
    }
    let late = resident(view.child.id());
    assert!(late <= early + 2048, "memory grew from {early} to {late} KiB");
    drop(sending.join().unwrap());
}
