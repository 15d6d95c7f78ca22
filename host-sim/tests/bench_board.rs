//! `linestereo bench-board` as a user types it: the board's own program behind a connection, with
//! clocks that count looks at them, and the same program in QEMU.

use crate::support::{
    Folder, failed, linestereo, listening, refused, says, stdout, succeed, tells,
};
use core::cell::Cell;
use linestereo::unstable::Stage;
use linestereo_boards::Board;
use linestereo_boards::built_in::{Case, digests};
use linestereo_firmware::boards::mps2_an500::BoardMemory;
use linestereo_firmware::ports::{BarePeripherals, ByteSink, ByteSource, Clock, NoWatchdog};
use linestereo_firmware::programs::case_server::CaseServer;
use linestereo_sim::board::numbers::{BoardNumbers, PerInstruction, SiliconNumbers};
use linestereo_sim::board::{qemu, toolchain::Toolchain};
use linestereo_tests::board::{image, or_skip};
use linestereo_wire::*;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::Stdio;
use std::rc::Rc;
use std::thread::{self, JoinHandle};

/// 400 MHz, of which every look at the counter costs as many.
const CORE_HZ: u32 = 400_000_000;
const LOOK: u64 = 20_000;

/// Cycles so far; clones are the same counter.
#[derive(Clone, Default)]
struct Cycles(Rc<Cell<u64>>);

impl Clock for Cycles {
    const UNIT: &'static str = "cycles";

    fn now(&self) -> u32 {
        self.0.set(self.0.get() + LOOK);
        self.0.get() as u32
    }

    fn elapsed(&self, from: u32, to: u32) -> u64 {
        to.wrapping_sub(from).into()
    }

    fn microseconds(&self, _: u32, _: u32) -> u64 {
        unreachable!("time is the other clock's")
    }
}

/// Microseconds of the same.
struct Time(Cycles);

impl Clock for Time {
    const UNIT: &'static str = "microseconds";

    fn now(&self) -> u32 {
        (self.0.0.get() / 400) as u32
    }

    fn elapsed(&self, from: u32, to: u32) -> u64 {
        to.wrapping_sub(from).into()
    }

    fn microseconds(&self, from: u32, to: u32) -> u64 {
        self.elapsed(from, to)
    }
}

/// A connection that changes what the board says, or loses it.
struct Line<F> {
    stream: TcpStream,
    change: F,
    is_open: Rc<Cell<bool>>,
}

impl<F> ByteSource for Line<F> {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let count = self.stream.read(bytes).unwrap_or(0);
        self.is_open.set(count > 0);
        count
    }
}

impl<F: FnMut(Message) -> Option<Message>> ByteSink for Line<F> {
    fn write(&mut self, bytes: &[u8]) {
        let mut decoder: Decoder<Message, MAX_PACKET> = Decoder::new();
        for message in bytes.iter().filter_map(|&byte| decoder.push(byte)) {
            let Some(message) = (self.change)(message.unwrap()) else { continue };
            let _ = self.stream.write_all(encode(&message, &mut [0; MAX_PACKET]).unwrap()); // the host may have left
        }
    }
}

const SILICON: Silicon = Silicon {
    processor_id: 0x411f_c271,
    chip_id: 0x2003_6450,
    core_hz: CORE_HZ,
    flash_wait: 2,
    instruction_cache: true,
    data_cache: true,
};

/// The address of a board that serves one host, and its thread.
fn board(
    change: impl FnMut(Message) -> Option<Message> + Send + 'static,
) -> (String, JoinHandle<()>) {
    let (listener, address) = listening();
    let thread = thread::spawn(move || {
        let (stream, is_open) = (listener.accept().unwrap().0, Rc::new(Cell::new(true)));
        let (counter, mut memory) = (Cycles::default(), Box::new(BoardMemory::CLEARED));
        let parts = BarePeripherals {
            clock: Time(counter.clone()),
            counter,
            host: Line { stream, change, is_open: is_open.clone() },
            watchdog: NoWatchdog,
            rest: || {},
            reset: Some(Reset::of(ResetCause::Pin)),
            silicon: Some(SILICON),
        };
        let (mut server, _) =
            CaseServer::start(Board::STM32H743, digests::of(&Board::STM32H743), parts);
        while is_open.get() {
            server.turn(&mut *memory);
        }
    });
    (address, thread)
}

#[test]
fn a_board_is_measured_and_its_file_holds_everything() {
    let folder = Folder::new();
    let (address, thread) = board(Some);
    let said = succeed(folder.path(), &format!("bench-board --tcp {address}"));
    thread.join().unwrap();
    assert!(said.starts_with("stm32h743 (Cortex-M7), firmware "), "{said}");
    says(
        &said,
        &[
            "\nprocessor 0x411fc271, chip 0x20036450, 400.0 MHz (measured 400.0), flash wait 2, ",
            "; assumed 0.7 to 1.1 (instructions of mps2-an500)\n",
        ],
    );
    assert!(
        said.ends_with("\nstm32h743.toml written\nequal: all 22 pairs have the PC's digests\n"),
        "{said}"
    );
    assert!(!said.contains("doubtful"), "{said}");

    let text = std::fs::read_to_string(folder.path().join("stm32h743.toml")).unwrap();
    let numbers = BoardNumbers::parse(&text).unwrap();
    assert_eq!(numbers.file().unwrap(), text, "what was read is what was written");
    assert!(numbers.equal && numbers.unit == "cycles" && numbers.board == "stm32h743");
    let SiliconNumbers { core_hz, measured_hz, flash_wait, instruction_cache, data_cache, .. } =
        numbers.silicon.unwrap();
    assert_eq!((core_hz, flash_wait, instruction_cache, data_cache), (CORE_HZ, 2, true, true));
    assert!(measured_hz.abs_diff(CORE_HZ.into()) < 400_000, "{measured_hz}");
    assert_eq!(numbers.pairs.len(), 22);
    for (case, expected) in Case::all(&Board::STM32H743).zip(&digests::QVGA) {
        let pair = &numbers.pairs[&case.to_string()];
        let digests: Vec<String> = expected.iter().map(|digest| format!("{digest:08x}")).collect();
        assert_eq!((&pair.digests, &pair.differs_in), (&digests, &None), "{case}");
        assert_eq!(pair.by_stage.values().sum::<u64>(), pair.total);
        assert_eq!(pair.by_stage.len(), Stage::ALL.len());
        assert!(
            pair.by_stage.values().all(|cost| cost % LOOK == 0)
                && pair.total > 0
                && pair.time_us > 0
        );
        assert!(pair.cycles_per_instruction.unwrap() > 0.0, "{case}");
    }
    let PerInstruction { median, range: [low, high], .. } = numbers.cycles_per_instruction.unwrap();
    assert!(0.0 < low && low < median && median < high, "{low} {median} {high}");
}

/// Of the third pair the matches, or something else, are another board's.
fn with_wrong_pair(message: Message, expected: u32) -> Option<Message> {
    Some(match message {
        Message::Case(mut report) if report.case == 2 => {
            report.digests[Stage::Matching as usize] ^= 1;
            report.digests[DIGESTS - 1] ^= 1;
            Message::Case(report)
        }
        Message::Machine(machine) => {
            Message::Machine(MachineReport { expected: machine.expected ^ expected, ..machine })
        }
        other => other,
    })
}

#[test]
fn wrong_digests_are_named_and_the_file_is_there() {
    for (version, says) in
        [(0, "results differ from a PC's: send the file"), (1, "is of another version")]
    {
        let folder = Folder::new();
        let (address, _) = board(move |message| with_wrong_pair(message, version));
        let output =
            linestereo(folder.path(), &format!("bench-board --tcp {address} --out mine.toml"));
        let error = failed(&output);
        assert!(
            error.starts_with("linestereo: 1 of 22 pairs are wrong; ") && error.contains(says),
            "{error}"
        );
        assert!(error.ends_with(": bricks_320x240 from matching on\n"), "{error}");
        let numbers =
            BoardNumbers::parse(&std::fs::read_to_string(folder.path().join("mine.toml")).unwrap())
                .unwrap();
        assert!(!numbers.equal);
        assert_eq!(numbers.wrong().collect::<Vec<_>>(), [("bricks_320x240", "matching")]);
    }
}

#[test]
fn a_wrong_clock_and_a_cache_that_is_off_are_doubtful() {
    let folder = Folder::new();
    let (address, _) = board(|message| {
        Some(match message {
            Message::Machine(machine) => {
                let silicon = machine.silicon.map(|it| Silicon {
                    core_hz: 200_000_000,
                    data_cache: false,
                    ..it
                });
                Message::Machine(MachineReport { silicon, ..machine })
            }
            other => other,
        })
    });
    let words = [
        "\ndoubtful: the core was set to 200.0 MHz and runs at 400.0 MHz by the board's clock\n",
        "\ndoubtful: a cache is off\n",
    ];
    tells(folder.path(), &format!("bench-board --tcp {address}"), &words);
}

/// A change of a message on its way; `None` loses it.
type Change = fn(Message) -> Option<Message>;

#[test]
fn what_fails_says_what_to_do_and_writes_nothing() {
    let folder = Folder::new();
    let changes: [(Change, &[&str]); 4] = [
        (
            |message| Some(message).filter(|message| !matches!(message, Message::Machine(_))),
            &["stm32h743 runs another program, such as live; flash selftest: cargo xtask build"],
        ),
        (
            |message| Some(message).filter(|message| !matches!(message, Message::Answer(_))),
            &["flash its program selftest", "no answer in 5 s"],
        ),
        (
            |message| Some(message).filter(|message| !matches!(message, Message::Case(_))),
            &["pair 1 of 22: its numbers were lost on the way"],
        ),
        (
            |message| match message {
                Message::Machine(it) => Some(Message::Machine(MachineReport { cases: 23, ..it })),
                other => Some(other),
            },
            &["pair 23 of 23: the board refused: case is 22 but must be 0 to 21"],
        ),
    ];
    for (change, words) in changes {
        let (address, _) = board(change);
        refused(folder.path(), &format!("bench-board --tcp {address}"), words);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    refused(folder.path(), "bench-board", &["--tcp", "--serial"]);
}

/// The program as it is flashed, on a serial port.
#[cfg(unix)]
#[test]
#[ignore = "builds a board's program; the model of the STM32H743 serves the same cases"]
fn an_emulated_board_has_the_digests_of_the_pc() {
    let board = Board::MPS2_AN386;
    let Some(elf) = image(&board, "selftest") else { return };
    if or_skip(Toolchain::for_board(&board).and_then(|_| qemu::find(&board))).is_none() {
        return;
    }
    let folder = Folder::new();
    let mut command = qemu::command(&board, &elf, &["serve"], folder.path()).unwrap();
    let mut qemu = command.args(["-serial", "pty"]).stdout(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(qemu.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
    let port = line
        .split_whitespace()
        .find(|word| word.starts_with("/dev/"))
        .unwrap_or_else(|| panic!("{line}"));
    let output = linestereo(folder.path(), &format!("bench-board --serial {port}"));
    qemu.kill().unwrap();
    qemu.wait().unwrap();
    let said = stdout(&output);
    assert!(said.ends_with("equal: all 22 pairs have the PC's digests\n"), "{said}");
    let text = std::fs::read_to_string(folder.path().join(format!("{}.toml", board.name))).unwrap();
    let numbers = BoardNumbers::parse(&text).unwrap();
    assert_eq!(
        (&*numbers.unit, &numbers.silicon, &numbers.cycles_per_instruction),
        ("instructions", &None, &None)
    );
    assert!(
        numbers.pairs.values().all(|pair| pair.total > 500_000 && pair.time_us > 30_000),
        "{text}"
    );
}
