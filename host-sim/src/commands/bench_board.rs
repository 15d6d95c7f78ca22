//! `linestereo bench-board`: does a board compute what a PC computes, and in how many cycles?

use crate::board::numbers::BoardNumbers;
use crate::monitor::port::{Port, PortArgs, Received};
use crate::output::OutputFiles;
use anyhow::{Context, Result, bail};
use core::time::Duration;
use indicatif::{ProgressBar, ProgressStyle};
use linestereo::unstable::Fnv;
use linestereo_boards::Board;
use linestereo_boards::built_in::digests;
use linestereo_wire::{
    CaseReport, Command, DecodeError, Decoder, Hello, MAX_PACKET, MachineReport, Message, Outcome,
    Request, VERSION,
};
use std::path::PathBuf;
use std::time::Instant;

/// Measure a board that runs the program `selftest`: cycles by stage, and whether its results equal
/// those of a PC.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/bench-board.txt"))]
#[command(group(clap::ArgGroup::new("source").required(true).args(["tcp", "serial"])))]
pub struct Args {
    #[command(flatten)]
    port: PortArgs,
    /// Output file [default: BOARD.toml].
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
}

/// A board says what it is within this time,
const DESCRIBED_WITHIN: Duration = Duration::from_secs(5);
/// and is asked again so often.
const DESCRIBE_EVERY: Duration = Duration::from_secs(1);
/// A pair is matched within this time: painting one takes a slow board two seconds, an emulated one
/// ten.
const MATCHED_WITHIN: Duration = Duration::from_secs(120);
const MATCH_EVERY: Duration = Duration::from_secs(40);

pub fn run(args: &Args) -> Result<()> {
    let mut host = Host {
        port: args.port.open()?,
        decoder: Decoder::new(),
        next_id: std::process::id() as u16,
    };
    let (hello, machine) = host.describe()?;
    let bar = ProgressBar::new(machine.cases.into())
        .with_style(ProgressStyle::with_template("{bar:30} {pos} of {len} pairs  {msg}")?);
    let mut reports = Vec::new();
    for case in 0..machine.cases {
        let report =
            host.case(case).with_context(|| format!("pair {} of {}", case + 1, machine.cases))?;
        bar.set_message(report.name.to_string());
        bar.inc(1);
        reports.push(report);
    }
    bar.finish_and_clear();
    let numbers = BoardNumbers::new(&hello, &machine, &reports)?;
    let path = args.out.clone().unwrap_or_else(|| format!("{}.toml", numbers.board).into());
    let mut files = OutputFiles::new();
    files.add(&path, numbers.file()?.as_bytes())?;
    files.commit()?;
    let mut text = numbers.table();
    for doubt in numbers.doubts() {
        text += &format!("doubtful: {doubt}\n");
    }
    crate::output::print(&format!("{text}\n{} written\n", path.display()))?;
    verdict(&numbers, &machine)
}

/// An error unless every digest is the PC's.
fn verdict(numbers: &BoardNumbers, machine: &MachineReport) -> Result<()> {
    let wrong: Vec<String> =
        numbers.wrong().map(|(name, stage)| format!("{name} from {stage} on")).collect();
    if wrong.is_empty() {
        return crate::output::print(&format!(
            "equal: all {} pairs have the PC's digests\n",
            numbers.pairs.len()
        ));
    }
    let mut expected = Fnv::EMPTY;
    if let Some(board) = Board::named(&numbers.board) {
        digests::of(&board)
            .as_flattened()
            .iter()
            .for_each(|digest| expected.write(&digest.to_le_bytes()));
    }
    let why = if machine.expected == expected.value() {
        "the board's results differ from a PC's: send the file"
    } else {
        "the firmware is of another version of the method: build it and this program from one checkout"
    };
    bail!("{} of {} pairs are wrong; {why}: {}", wrong.len(), numbers.pairs.len(), wrong.join(", "))
}

/// The host's end.
struct Host {
    port: Port,
    decoder: Decoder<Message, MAX_PACKET>,
    next_id: u16,
}

impl Host {
    fn describe(&mut self) -> Result<(Hello, MachineReport)> {
        let messages = self.ask(Request::Describe, DESCRIBED_WITHIN, DESCRIBE_EVERY).context(
            "the board did not identify itself; flash its program selftest (cargo xtask build \
             --board BOARD --program selftest), close other programs that use the port, and give \
             --baud 921600 on a UART",
        )?;
        let (mut hello, mut machine) = (None, None);
        for message in messages {
            match message {
                Message::Hello(said) => hello = Some(said),
                Message::Machine(said) => machine = Some(said),
                _ => {}
            }
        }
        let hello = hello.context("the board's description was lost; try again")?;
        let machine = machine.with_context(|| {
            let board = &hello.board;
            format!(
                "{board} runs another program, such as live; flash selftest: cargo xtask build --board {board} --program selftest"
            )
        })?;
        Ok((hello, machine))
    }

    fn case(&mut self, case: u16) -> Result<CaseReport> {
        for message in self.ask(Request::RunCase(case), MATCHED_WITHIN, MATCH_EVERY)? {
            match message {
                Message::Case(report) if report.case == case => return Ok(report),
                _ => {}
            }
        }
        bail!(
            "its numbers were lost on the way; start again, or use a better cable or a lower speed"
        )
    }

    /// Records up to the answer.
    fn ask(&mut self, request: Request, within: Duration, every: Duration) -> Result<Vec<Message>> {
        self.next_id = self.next_id.wrapping_add(1);
        let command = Command { id: self.next_id, request };
        let (begin, mut sent, mut messages, mut buffer) =
            (Instant::now(), None::<Instant>, Vec::new(), [0; 4096]);
        loop {
            if begin.elapsed() > within {
                let reset = messages.iter().find_map(|message| match message {
                    Message::Hello(hello) => hello.reset,
                    _ => None,
                });
                let reset = reset.map_or(String::new(), |reset| {
                    format!("; the board was reset meanwhile: {reset}")
                });
                bail!("no answer in {} s{reset}", within.as_secs());
            }
            if sent.is_none_or(|sent| sent.elapsed() > every) {
                self.port.send(&command)?;
                sent = Some(Instant::now());
            }
            let Received::Bytes(count) = self.port.read(&mut buffer)? else { continue };
            for &byte in &buffer[..count] {
                match self.decoder.push(byte) {
                    Some(Ok(Message::Answer(answer))) if answer.command == self.next_id => {
                        match answer.outcome {
                            Outcome::Accepted => return Ok(messages),
                            Outcome::Refused(why) => bail!("the board refused: {why}"),
                        }
                    }
                    Some(Ok(message)) => messages.push(message),
                    Some(Err(DecodeError::Version { found })) if found & 0x80 == 0 => bail!(
                        "the board's records are of version {found}, this program reads version {VERSION}: build both from one checkout"
                    ),
                    _ => {}
                }
            }
        }
    }
}
