//! The program `live` as it is flashed, in a model of the STM32H743 (`tests/machine`): from reset to the bytes on both UARTs.
//!
//! Not in the model, and so not shown here: caches, MPU faults, USB, the ADC, the time of anything within a few tens of percent.

use linestereo_sim::board::{firmware, toolchain::Toolchain};
use linestereo_tests::board::or_skip;
use linestereo_wire::{Command as HostCommand, Decoder, MAX_COMMAND, MAX_PACKET, Message, Request, encode};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// A Python that has Unicorn: the system's, or one of a folder of its own.
fn python() -> Option<PathBuf> {
    let has_unicorn = |python: &Path| {
        Command::new(python).args(["-c", "import unicorn"]).output().is_ok_and(|out| out.status.success())
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

/// The image, and what runs it; none where either cannot be had.
fn machine() -> Option<&'static (PathBuf, PathBuf)> {
    static MACHINE: OnceLock<Option<(PathBuf, PathBuf)>> = OnceLock::new();
    let made = MACHINE.get_or_init(|| {
        let Some(python) = python() else {
            eprintln!("\nSKIPPED, no machine model here: pip install unicorn==2.1.4\n");
            return None;
        };
        let board = linestereo_boards::Board::STM32H743;
        let toolchain = or_skip(Toolchain::for_board(&board))?;
        let features = ["still-scene".to_owned()];
        let built = firmware::build_all(&toolchain, &board, &["live"], firmware::Logs::None, &features);
        Some((python, or_skip(built)?.swap_remove(0)))
    });
    made.as_ref()
}

/// What a run left: see `tests/machine/stm32h743.py`.
struct Run {
    result: Value,
    /// Records that the host got, with the time of their last byte, us.
    records: Vec<(u64, Message)>,
    damaged: usize,
}

impl Run {
    fn of(scenario: &Value) -> Option<Self> {
        let (python, image) = machine()?;
        let folder = tempfile::tempdir().unwrap();
        let [asked, given] = ["scenario.json", "result.json"].map(|name| folder.path().join(name));
        std::fs::write(&asked, scenario.to_string()).unwrap();
        let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("machine/stm32h743.py");
        let run = Command::new(python).arg(model).arg(image).arg(asked).arg(&given).output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let result: Value = serde_json::from_slice(&std::fs::read(given).unwrap()).unwrap();
        let (mut decoder, mut records, mut damaged) = (Decoder::<Message, MAX_PACKET>::new(), Vec::new(), 0);
        for (byte, time) in bytes(&result["host"]).into_iter().zip(result["host_us"].as_array().unwrap()) {
            match decoder.push(byte) {
                Some(Ok(record)) => records.push((time.as_u64().unwrap(), record)),
                Some(Err(_)) => damaged += 1,
                None => {}
            }
        }
        Some(Self { result, records, damaged })
    }

    fn frames(&self) -> Vec<&linestereo_wire::FrameHead> {
        self.records
            .iter()
            .filter_map(|(_, record)| if let Message::Frame(head) = record { Some(head) } else { None })
            .collect()
    }
}

fn bytes(hex: &Value) -> Vec<u8> {
    let hex = hex.as_str().unwrap().as_bytes();
    hex.chunks(2).map(|pair| u8::from_str_radix(core::str::from_utf8(pair).unwrap(), 16).unwrap()).collect()
}

/// Commands of a host, each at its time, us.
fn host(requests: &[(u64, Request)]) -> Value {
    let commands = (1..).zip(requests).map(|(id, (time, request))| {
        let mut buffer = [0; MAX_COMMAND];
        let packet = encode(&HostCommand { id, request: request.clone() }, &mut buffer).unwrap();
        json!([time, packet.iter().map(|byte| format!("{byte:02x}")).collect::<String>()])
    });
    commands.collect()
}

#[test]
fn live_runs() {
    let Some(run) = Run::of(&json!({ "until_us": 1_500_000, "host": host(&[(100_000, Request::Start)]) })) else {
        return;
    };
    let kinds: Vec<String> =
        run.records.iter().map(|(t, record)| format!("{t} {record:?}").chars().take(150).collect()).collect();
    println!("{}", kinds.join("\n"));
    let mut short = run.result.clone();
    for key in ["host", "host_us", "autopilot", "autopilot_us", "flash", "never"] {
        short[key] = Value::Null;
    }
    println!("{short}");
    panic!("{} {}", run.damaged, run.frames().len());
}
