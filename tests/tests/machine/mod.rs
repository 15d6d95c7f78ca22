//! The program `live` as it is flashed, in models of the chips (`tests/machine`): from reset to the
//! bytes that the host and an autopilot get.

mod pico2;
mod portenta_h7;
mod stm32h743;

use linestereo::{Dims, results::Match};
use linestereo_rig::{Calibration, Camera, CameraSide, Lens, RigImage, View};
use linestereo_wire::{
    Answer, CaptureReport, Command as HostCommand, Decoder, FrameHead, Health, Hello, MAX_COMMAND,
    MAX_PACKET, Message, ObjectRecord, Outcome, Request, ResetCause, RigBytes, encode,
};
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// A Python that has Unicorn: the system's, or one of a folder of its own.
fn python() -> Option<PathBuf> {
    let has_unicorn = |python: &Path| {
        Command::new(python)
            .args(["-c", "import unicorn"])
            .output()
            .is_ok_and(|out| out.status.success())
    };
    let system = PathBuf::from("python3");
    if has_unicorn(&system) {
        return Some(system);
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("unicorn");
    let own = folder.join("bin/python");
    if !has_unicorn(&own) {
        let done = |command: &mut Command| command.output().is_ok_and(|out| out.status.success());
        let _ = done(Command::new("python3").args(["-m", "venv"]).arg(&folder))
            && done(Command::new(&own).args(["-m", "pip", "install", "--quiet", "unicorn==2.1.4"]));
    }
    has_unicorn(&own).then_some(own)
}

/// The Python that runs models; none, which it says, where there is none.
fn python_or_skip() -> Option<&'static Path> {
    static PYTHON: OnceLock<Option<PathBuf>> = OnceLock::new();
    let found = PYTHON.get_or_init(|| {
        let found = python();
        if found.is_none() {
            // Not by a macro: those are silent in tests that pass.
            let _ = writeln!(
                std::io::stderr(),
                "\nSKIPPED, no machine model here: pip install unicorn==2.1.4\n"
            );
        }
        found
    });
    found.as_deref()
}

/// Result of a run: see `execute` in `tests/machine/cortex_m.py`.
struct Run {
    result: Value,
    /// Records that the host got, with the time of their last byte, us.
    records: Vec<(u64, Message)>,
    damaged: usize,
}

impl Run {
    /// A scenario of the model of this name; the image is built where it can be run.
    fn of(model: &str, image: impl FnOnce() -> Option<PathBuf>, scenario: &Value) -> Option<Self> {
        let python = python_or_skip()?;
        let image = image()?;
        let folder = tempfile::tempdir().unwrap();
        let [asked, given] = ["scenario.json", "result.json"].map(|name| folder.path().join(name));
        std::fs::write(&asked, scenario.to_string()).unwrap();
        let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("machine").join(model);
        let run =
            Command::new(python).arg(model).arg(image).arg(asked).arg(&given).output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let result: Value = serde_json::from_slice(&std::fs::read(given).unwrap()).unwrap();
        let (records, damaged) = records(&result["host"], &result["host_us"]);
        Some(Self { result, records, damaged })
    }

    /// Nothing ended the run, and no packet was damaged.
    fn assert_whole(&self) {
        assert_eq!(
            (self.damaged, &self.result["ending"]),
            (0, &Value::Null),
            "{}",
            self.result["at"]
        );
    }

    /// The host has enumerated a board of this name and serial number; nothing happened that USB
    /// forbids, and a program at the host has all bytes.
    fn assert_usb(&self, product: &str, serial: &str, is_fast: bool) {
        let expected = json!({
            "faults": [], "ids": [0x16c0, 0x27dd], "manufacturer": "linestereo", "product": product, "serial": serial,
            "is_fast": is_fast, "unread": 0,
        });
        assert_eq!(self.result["usb"], expected);
    }

    /// The contents of all records of one kind.
    fn all<'a, T>(
        &'a self,
        kind: impl Fn(&'a Message) -> Option<T> + Clone,
    ) -> impl DoubleEndedIterator<Item = T> + Clone {
        self.records.iter().filter_map(move |(_, record)| kind(record))
    }

    fn frames(&self) -> Vec<&FrameHead> {
        self.all(|record| if let Message::Frame(head) = record { Some(head) } else { None })
            .collect()
    }

    /// Frames with numbers that follow each other, none lost without a word.
    fn frames_in_order(&self) -> Vec<&FrameHead> {
        self.frames_in_order_but(&[]).into_iter().map(|(_, head)| head).collect()
    }

    /// The same with their times, us, but for what the host itself cut off at these times.
    fn frames_in_order_but(&self, cuts_us: &[u64]) -> Vec<(u64, &FrameHead)> {
        let frames = self.records.iter().filter_map(|(time_us, record)| match record {
            Message::Frame(head) => Some((*time_us, head)),
            _ => None,
        });
        let frames: Vec<_> = frames.collect();
        for (&(time_us, before), &(next_us, after)) in frames.iter().zip(frames.iter().skip(1)) {
            let gap = after.sequence - before.sequence;
            let is_told = after.health.contains(Health::RESULTS_SKIPPED);
            let is_cut = cuts_us.iter().any(|cut_us| (time_us..next_us).contains(cut_us));
            assert!(gap == 1 || is_told || is_cut, "{after:?} follows {before:?}");
            assert!(after.capture_time_us > before.capture_time_us, "{after:?} follows {before:?}");
        }
        frames
    }

    /// These frames of the left or the right camera, each with its number in
    /// `CaptureReport::KINDS`, were bad, and no others; each cost one pair, and the next one came
    /// in time.
    fn assert_bad_frames(
        &self,
        frames: &[&FrameHead],
        bad: &[(CameraSide, usize)],
        pairs: usize,
        within_us: u64,
    ) {
        let missing: Vec<_> =
            frames.iter().filter(|head| head.health.contains(Health::PAIR_MISSING)).collect();
        assert_eq!(missing.len(), pairs, "{missing:?}");
        for head in missing {
            let next = frames.iter().find(|next| next.sequence == head.sequence + 1).unwrap();
            let lost_us = next.capture_time_us - head.capture_time_us;
            assert!(
                !next.health.contains(Health::PAIR_MISSING) && lost_us < within_us,
                "{lost_us} us: {next:?}"
            );
        }
        let (losses, mut expected) = (self.losses(), CaptureReport::default().faults);
        bad.iter().for_each(|&(eye, kind)| expected[eye as usize][kind] += 1);
        assert_eq!((losses.faults, losses.sensors), (expected, [0; 2]), "{losses:?}");
    }

    /// The DMA writes to memory that is not cached: normal memory, TEX 1, neither C nor B.
    fn assert_uncached_dma(&self) {
        let number = |value: &Value, at: usize| value[at].as_u64().unwrap();
        let targets = self.result["dma"].as_array().unwrap();
        assert!(!targets.is_empty());
        for target in targets {
            let (start, end) = (number(target, 0), number(target, 0) + number(target, 1));
            let regions = self.result["regions"].as_array().unwrap().iter();
            let holding = regions.filter(|region| {
                (number(region, 0)..=number(region, 0) + number(region, 1)).contains(&end)
                    && number(region, 0) <= start
            });
            assert!(
                holding.clone().any(|region| number(region, 2) & 0x3b == 0x08),
                "{:?}",
                holding.collect::<Vec<_>>()
            );
        }
    }

    /// The photograph is what both sensors sent, of one picture.
    fn assert_photograph(&self) {
        let mut photo = [vec![0; 320 * 240], vec![0; 320 * 240]];
        let mut pixels = 0;
        let parts =
            self.all(|record| if let Message::Pixels(part) = record { Some(part) } else { None });
        for part in parts {
            let first = part.first as usize;
            photo[usize::from(part.is_right)][first..][..part.list.len()]
                .copy_from_slice(&part.list);
            pixels += part.list.len();
        }
        assert_eq!(pixels, 2 * 320 * 240);
        let equals = |is_right: bool, frame: u64| {
            let pixel = |i: usize| sensor_pixel(is_right, frame, i as u64 % 320, i as u64 / 320);
            photo[usize::from(is_right)].iter().enumerate().all(|(i, found)| *found == pixel(i))
        };
        assert!(
            (0..300).any(|frame| equals(false, frame) && equals(true, frame)),
            "a photograph of no frame"
        );
    }

    fn answers(&self) -> impl Iterator<Item = &Answer> + Clone {
        self.all(|record| if let Message::Answer(answer) = record { Some(answer) } else { None })
    }

    /// Every command was taken.
    fn assert_all_accepted(&self) {
        let answers = self.answers();
        assert!(
            answers.clone().all(|answer| answer.outcome == Outcome::Accepted),
            "{:?}",
            answers.collect::<Vec<_>>()
        );
    }

    /// Code that ran.
    fn code(&self) -> Code {
        let functions = self.result["code"].as_array().unwrap().iter();
        let functions = functions
            .map(|of| (of[0].as_str().unwrap().to_owned(), of[1].as_str().unwrap().into()));
        Code { functions: functions.collect() }
    }

    /// Of the program's stack at least a quarter was never used.
    fn assert_stack(&self) {
        let [used, all] = [0, 1].map(|i| self.result["stack"][i].as_u64().unwrap());
        println!("{used} of {all} bytes of the program's stack");
        assert!(used > 0 && used <= all / 4 * 3, "{used} of {all} bytes of the program's stack");
    }

    /// The last report of what cameras lost.
    fn losses(&self) -> CaptureReport {
        self.all(|record| if let Message::Capture(lost) = record { Some(*lost) } else { None })
            .next_back()
            .unwrap()
    }

    /// Why the board was reset, as each start said.
    fn reset_causes(&self) -> Vec<Option<ResetCause>> {
        let hellos = self.hellos();
        hellos.map(|hello| hello.reset.as_ref().map(|reset| reset.cause)).collect()
    }

    fn hellos(&self) -> impl Iterator<Item = &Hello> {
        self.all(|record| if let Message::Hello(hello) = record { Some(hello) } else { None })
    }

    /// A rig for QVGA images is in use from the start.
    fn assert_rig_is_used(&self) -> &Hello {
        let hello = self.hellos().next().unwrap();
        assert_eq!(hello.rig.in_use.map(|rig| rig.rectified), Some([320, 240]));
        hello
    }

    /// The autopilot got its heartbeats and obstacles, in whole messages.
    fn assert_autopilot(&self) {
        let messages = mavlink_ids(&bytes_of(&self.result["autopilot"]));
        assert!(messages.contains(&0) && messages.contains(&330), "{messages:?}");
    }
}

/// A frame and what came with it.
struct Frame<'a> {
    head: &'a FrameHead,
    segments: Vec<Match>,
    objects: Vec<ObjectRecord>,
}

fn frames_of(run: &Run) -> Vec<Frame<'_>> {
    let mut frames: Vec<Frame<'_>> = Vec::new();
    for (_, record) in &run.records {
        match (record, frames.last_mut()) {
            (Message::Frame(head), _) => {
                frames.push(Frame { head, segments: Vec::new(), objects: Vec::new() })
            }
            (Message::Segments(of), Some(frame)) => frame.segments.extend(of.list.iter().copied()),
            (Message::Objects(of), Some(frame)) => frame.objects.extend(of.list.iter().copied()),
            _ => {}
        }
    }
    frames
}

/// Records of bytes and their times, us, and how many packets are damaged.
fn records(bytes: &Value, times: &Value) -> (Vec<(u64, Message)>, usize) {
    let (mut decoder, mut records, mut damaged) =
        (Decoder::<Message, MAX_PACKET>::new(), Vec::new(), 0);
    for (byte, time) in bytes_of(bytes).into_iter().zip(times.as_array().unwrap()) {
        match decoder.push(byte) {
            Some(Ok(record)) => records.push((time.as_u64().unwrap(), record)),
            Some(Err(_)) => damaged += 1,
            None => {}
        }
    }
    (records, damaged)
}

/// Which code of an image ran, in one run or several.
struct Code {
    /// Name, and for every two bytes a digit, 1 where they were executed.
    functions: Vec<(String, Vec<u8>)>,
}

impl Code {
    /// Adds what ran in another run of the same image.
    fn and(mut self, other: Self) -> Self {
        assert_eq!(self.functions.len(), other.functions.len());
        for ((name, code), (other_name, more)) in self.functions.iter_mut().zip(other.functions) {
            assert_eq!((&*name, code.len()), (&other_name, more.len()));
            code.iter_mut().zip(more).for_each(|(digit, more)| *digit = more.max(*digit));
        }
        self
    }

    /// At least so many bytes of code ran. Prints what did not, the most first.
    fn assert_executed(&self, least: usize) {
        let bytes = |code: &[u8], wanted| 2 * code.iter().filter(|&&digit| digit == wanted).count();
        let sum =
            |wanted| self.functions.iter().map(|(_, code)| bytes(code, wanted)).sum::<usize>();
        let mut rest: Vec<_> = self
            .functions
            .iter()
            .map(|(name, code)| (bytes(code, b'0'), 2 * code.len(), name))
            .collect();
        rest.sort_by_key(|&(missing, ..)| core::cmp::Reverse(missing));
        println!(
            "executed {} bytes of code and constants, not executed {}; the functions with most of that:",
            sum(b'1'),
            sum(b'0')
        );
        for (missing, all, name) in rest.iter().take(60) {
            println!("{missing:6} of {all:6}  {:#}", rustc_demangle::demangle(name));
        }
        assert!(sum(b'1') >= least, "{} bytes of code executed", sum(b'1'));
    }
}

fn bytes_of(hex: &Value) -> Vec<u8> {
    let hex = hex.as_str().unwrap().as_bytes();
    hex.chunks(2)
        .map(|pair| u8::from_str_radix(core::str::from_utf8(pair).unwrap(), 16).unwrap())
        .collect()
}

/// Identifiers of MAVLink 2 messages that follow each other without a gap.
fn mavlink_ids(mut bytes: &[u8]) -> Vec<u32> {
    let mut ids = Vec::new();
    while let [0xfd, length, _, _, _, _, _, a, b, c, ..] = *bytes {
        ids.push(u32::from_le_bytes([a, b, c, 0]));
        bytes = bytes.get(usize::from(length) + 12..).unwrap_or_default();
    }
    assert!(bytes.is_empty() || bytes[0] == 0xfd, "bytes between messages");
    ids
}

/// Bad frames for a scenario: camera, number of its frame, and how it is bad.
fn bad_frames(frames: &[(CameraSide, u64, &str, usize)]) -> Value {
    let side = |eye| if eye == CameraSide::Left { "left" } else { "right" };
    frames.iter().map(|&(eye, frame, kind, _)| json!([side(eye), frame, kind])).collect()
}

/// Commands of a host, each at its time, us.
fn host(requests: &[(u64, Request)]) -> Value {
    let commands = (1..).zip(requests).map(|(id, (time, request))| {
        let mut buffer = [0; MAX_COMMAND];
        let packet = encode(&HostCommand { id, request: request.clone() }, &mut buffer).unwrap();
        json!([time, hex(packet)])
    });
    commands.collect()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The rig as a host sends it.
fn rig_bytes() -> RigBytes {
    RigBytes::from_slice(&rig().encode(0)).unwrap()
}

/// A rig of the board's cameras, as `flash-image` makes one.
fn rig() -> RigImage {
    let dims = Dims { width: 320, height: 240 };
    let lens = Lens::BrownConrady { k: [-0.05, 0.0, 0.0], p: [0.0; 2] };
    let camera = Camera::new(dims, [250.0; 2], [159.5, 119.5], 0.0, lens).unwrap();
    let calibration =
        Calibration::new(camera, camera, [1.0, 0.0, 0.0, 0.0], [-0.08, 0.0, 0.0]).unwrap();
    RigImage::new(calibration, dims, View::default(), (0, 64)).unwrap()
}

/// Grey level of a pixel of a sensor's frame: see `blocks` of the models.
fn sensor_pixel(is_right: bool, frame: u64, x: u64, y: u64) -> u8 {
    let x = if is_right { x + 10 } else { x };
    let mut number = (x / 8 * 73 + y / 8 * 151 + frame / 2 * 29) as u32;
    number = (number ^ number >> 15).wrapping_mul(0x2C1B_3C6D);
    number = (number ^ number >> 12).wrapping_mul(0x297A_2D39);
    (40 + (number ^ number >> 15) % 180) as u8
}
