//! `linestereo monitor`: a board's results as they arrive, and commands to it.

use crate::interruption;
use crate::monitor::frames::{Assembler, Frame};
use crate::monitor::port::{Port, PortArgs, Received};
use crate::monitor::requests::{self, Wanted};
use crate::monitor::text;
use crate::output::OutputPath;
use crate::results::health;
use crate::untrusted::printable;
use anyhow::{Result, anyhow, bail};
use core::time::Duration;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use linestereo_wire::{
    Command, DELIMITER, DecodeError, Decoder, Health, Hello, MAX_COMMAND, MAX_PACKET, Message, Outcome, Request,
    SettingValue, encode,
};
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Has the board give times in this computer's clock, anew after so long: the board forgets it after 10 s.
const SYNC: &str = "sync";
const SYNC_EVERY: Duration = Duration::from_secs(2);
/// A command is sent again after this long without an answer,
const ANSWER_WITHIN: Duration = Duration::from_secs(1);
/// this many times in all.
const ATTEMPTS: u32 = 5;

const EXAMPLES: &str = "\
Examples:
  linestereo monitor --serial /dev/ttyACM0 --baud 921600
      a table of the frames as they come, until Ctrl-C
  linestereo monitor --tcp localhost:4444 --send max_disparity=96 --send start --count 100
      a board in QEMU: set a parameter, start, show 100 frames
  linestereo monitor --tcp localhost:4444 --record run.bin --json > run.jsonl
      everything as JSON, and the bytes as they came
  linestereo monitor --serial /dev/ttyACM0 --send rig=rig.bin --send start
      keep a rig in the board's flash (linestereo flash-image makes it), then start
  linestereo monitor --serial /dev/ttyACM0 --send box=1:80,60,160,180 --send start
      the depth of an object in every frame, in px of the rectified left image; only_box= matches around the
      boxes alone, box=none asks no more
  linestereo monitor --serial /dev/ttyACM0 --count 0 --send range_m=6 --send policy=silent --send keep
      change settings and keep them over a reset
  linestereo monitor --serial /dev/ttyACM0 --count 0 --send settings
      every setting as it is, and whether it is kept; --send defaults goes back to those the board was built with
  linestereo monitor run.bin
      the same bytes again

Commands are sent first, one after the other, each answered before the next; before start comes describe,
so that what the board is, which rig it has and why it was reset stands above its frames. Neighbouring NAME=VALUE
go in one command: all of them are accepted, or none is. A refusal names the parameter and its range.
NAME is min_disparity, max_disparity, anchor_gradient, edge_gradient, min_extent, cell, reach, parts,
min_confidence, margin_px, margin_nearer_m with margin_farther_m, or focal_px with baseline_m
(and offset_px); of the vehicle yaw_deg, range_m, lowest_m, highest_m, system, rate_hz, policy (silent,
block, unknown), block_cm (0: the rig's near limit), distance_sensor (on, off). What is not kept is lost with
the next reset; keep erases flash, which takes up to 4 s, in which nothing is sent to an autopilot. Margins
and focal_px with its others are not kept.
sync has times of frames in this computer's clock (since 1970) as long as monitor runs, else they count from
the board's start; with --json the field clock says which. bootloader ends the program for the boot
loader, to be flashed over USB.

Columns:
  frame, time    number and capture time of the pair, since ms after the one before
  wait, match    ms that the board waited for the pair (its rows are rectified meanwhile), and matched it
  port           ms that it wrote to this port since the frame before
  segments       matched; 12/20 when 8 of 20 were lost on the way
  nearest, farthest   - without a rig
  health         what the frame suffered: full lists, a covered or frozen camera, rows that are off, ...
                 a flag that was not set before is explained on a line of its own

At the end: frames complete, incomplete, lost; packets by kind of damage; bytes that were skipped.
With --json that summary goes to stderr, and each complete frame is one line on stdout:
  {\"sequence\":n, \"capture_time_us\":t, \"clock\":\"board\", \"size\":[w,h], \"health\":{...},
   \"times_us\":{\"waiting\":t, \"matching\":t, \"port\":t}, \"segments\":[...], \"counts\":{...}}
health, segments and counts as in linestereo run --json.";

/// Show a board's results as they arrive, over a serial port, a connection or from a file; send commands to it.
///
/// Damaged and lost records are counted and skipped.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
#[command(group(clap::ArgGroup::new("source").required(true).args(["file", "tcp", "serial"])))]
pub struct Args {
    /// Read recorded bytes; "-" is stdin.
    #[arg(conflicts_with = "baud")]
    file: Option<PathBuf>,
    #[command(flatten)]
    port: PortArgs,
    /// Save the bytes as they come; "-" is stdout, in place of the table.
    #[arg(long, value_name = "FILE")]
    record: Option<OutputPath>,
    /// Print each complete frame as one line of JSON in place of the table.
    #[arg(long)]
    json: bool,
    /// Stop after N complete frames; 0 only sends the commands.
    #[arg(long, value_name = "N")]
    count: Option<u64>,
    /// Send start, stop, describe, sync, settings, keep, defaults, bootloader, rig=FILE, box= or only_box=LABEL:LEFT,TOP,RIGHT,BOTTOM, or NAME=VALUE, and wait for the answer; may be given
    /// several times.
    #[arg(long, value_name = "COMMAND", conflicts_with = "file")]
    send: Vec<String>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let wanted = described(requests::parse(&args.send)?);
    let mut record = match &args.record {
        Some(path) => Some(Record::create(path)?),
        None => None,
    };
    let mut port = match &args.file {
        Some(path) => Port::file(path)?,
        None => args.port.open()?,
    };
    let mut monitor = Monitor::new(args, wanted);
    let outcome = monitor.follow(&mut port, &mut record);
    if let (Ok(()), Some(path)) = (&outcome, args.file.as_ref().filter(|_| monitor.has_nothing())) {
        bail!(
            "{} holds nothing that a board sent, in {} bytes; give a file of linestereo monitor --record",
            path.display(),
            monitor.bytes
        );
    }
    let summary = monitor.end();
    match outcome.and_then(|()| summary.map_err(Stop::from)) {
        Err(Stop::ClosedPipe) | Ok(()) => Ok(()), // who closed it has seen enough
        Err(Stop::Failed(error)) => Err(error),
    }
}

/// Why following ends early.
enum Stop {
    /// Nobody reads stdout any more.
    ClosedPipe,
    Failed(anyhow::Error),
}

impl From<anyhow::Error> for Stop {
    fn from(error: anyhow::Error) -> Self {
        Self::Failed(error)
    }
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        if error.kind() == ErrorKind::BrokenPipe { Self::ClosedPipe } else { Self::Failed(error.into()) }
    }
}

/// Before a start, a board says what it is and why it was reset: when it began to run, nobody may have listened.
fn described(mut wanted: Vec<Wanted>) -> Vec<Wanted> {
    let place = |request: &Request| wanted.iter().position(|wanted| wanted.request == *request);
    if let (Some(start), None) = (place(&Request::Start), place(&Request::Describe)) {
        wanted.insert(start, Wanted { request: Request::Describe, words: "describe".to_owned() });
    }
    wanted
}

/// The bytes as they come, for another time.
struct Record {
    path: PathBuf,
    file: Box<dyn Write>,
}

impl Record {
    fn create(path: &OutputPath) -> Result<Self> {
        let file: Box<dyn Write> = if path.is_stdout() {
            Box::new(io::stdout())
        } else {
            Box::new(File::create(&**path).map_err(|error| cannot_record(path, &error))?)
        };
        Ok(Self { path: path.to_path_buf(), file })
    }
}

fn cannot_record(path: &Path, error: &io::Error) -> anyhow::Error {
    anyhow!("cannot write {}: {error}; choose a file in a folder that exists and is writable", path.display())
}

/// A command that was sent, and has no answer yet.
struct Waiting {
    command: Command,
    words: String,
    since: Instant,
    attempts: u32,
}

/// State of the link and of the board as far as it is known.
struct Monitor {
    decoder: Decoder<Message, MAX_PACKET>,
    frames: Assembler,
    bytes: u64,
    other_version: Option<u8>,
    /// Complete frames still to come.
    left: Option<u64>,
    wanted: VecDeque<Wanted>,
    /// When the board's clock was last asked for, if it is to follow the host's.
    synced: Option<Instant>,
    waiting: Option<Waiting>,
    next_id: u16,
    last_capture: Option<u64>,
    last_hello: Option<Hello>,
    /// Those of a list that is not complete yet.
    settings: Vec<SettingValue>,
    /// Flags of the last frame.
    health: Health,
    has_summary: bool,
    screen: Screen,
}

impl Monitor {
    fn new(args: &Args, wanted: Vec<Wanted>) -> Self {
        Self {
            decoder: Decoder::new(),
            frames: Assembler::default(),
            bytes: 0,
            other_version: None,
            left: args.count,
            wanted: wanted.into(),
            synced: None,
            waiting: None,
            next_id: std::process::id() as u16, // a late answer to an earlier program is not taken for one to this
            last_capture: None,
            last_hello: None,
            settings: Vec::new(),
            health: Health::GOOD,
            has_summary: args.count != Some(0),
            screen: Screen::new(args, args.count != Some(0)),
        }
    }

    /// Until the file ends, all frames are there, the user interrupts or the port fails.
    fn follow(&mut self, port: &mut Port, record: &mut Option<Record>) -> Result<(), Stop> {
        interruption::watch();
        let mut buffer = [0; 4096];
        loop {
            self.command(port)?;
            if self.is_done() || interruption::requested() {
                return Ok(());
            }
            match port.read(&mut buffer)? {
                Received::Silence => {}
                Received::End => return Ok(()),
                Received::Bytes(length) => {
                    let received = &buffer[..length];
                    if let Some(Record { path, file }) = record {
                        file.write_all(received).map_err(|error| match error.kind() {
                            ErrorKind::BrokenPipe => Stop::ClosedPipe,
                            _ => cannot_record(path, &error).into(),
                        })?;
                    }
                    for &byte in received {
                        self.push(byte)?;
                        if self.is_done() {
                            break;
                        }
                    }
                }
            }
        }
    }

    /// True when no packet of a board, of this version or another one, was among the bytes.
    fn has_nothing(&self) -> bool {
        let packets = self.decoder.counters();
        packets.good == 0 && packets.other_version == 0 && self.left != Some(0) && !interruption::requested()
    }

    fn is_done(&self) -> bool {
        self.left == Some(0) && self.waiting.is_none() && self.wanted.is_empty()
    }

    /// Sends the next command, or the last one again.
    fn command(&mut self, port: &mut Port) -> Result<()> {
        match &mut self.waiting {
            None => {
                if self.wanted.is_empty() && self.synced.is_some_and(|since| since.elapsed() >= SYNC_EVERY) {
                    self.wanted.push_back(Wanted { request: Request::ReadClock, words: SYNC.to_owned() });
                }
                let Some(Wanted { request, words }) = self.wanted.pop_front() else { return Ok(()) };
                if request == Request::ReadClock {
                    self.synced = Some(Instant::now());
                }
                self.next_id = self.next_id.wrapping_add(1);
                let command = Command { id: self.next_id, request };
                self.waiting = Some(Waiting { command, words, since: Instant::now(), attempts: 0 });
            }
            Some(waiting) if waiting.since.elapsed() < ANSWER_WITHIN => return Ok(()),
            Some(waiting) if waiting.attempts == ATTEMPTS => {
                bail!("no answer to {} in {ATTEMPTS} s; does the board run, and is the speed right?", waiting.words)
            }
            Some(_) => {}
        }
        let Some(waiting) = &mut self.waiting else { return Ok(()) };
        waiting.attempts += 1;
        waiting.since = Instant::now();
        // The delimiter ends whatever noise stands before the command.
        let mut packet = [DELIMITER; 1 + MAX_COMMAND];
        let length = encode(&waiting.command, &mut packet[1..])?.len();
        port.write(&packet[..=length])
    }

    fn push(&mut self, byte: u8) -> Result<(), Stop> {
        self.bytes += 1;
        match self.decoder.push(byte) {
            None => Ok(()),
            Some(Ok(Message::Frame(head))) => self.frames.begin(head).try_for_each(|frame| self.show(&frame)),
            Some(Ok(Message::Segments(segments))) => match self.frames.add(&segments) {
                Some(frame) => self.show(&frame),
                None => Ok(()),
            },
            Some(Ok(Message::Objects(objects))) => {
                let mut lines = objects.list.iter().map(|record| text::object(&record.into()));
                lines.try_for_each(|line| self.screen.note(&line)).map_err(Stop::from)
            }
            // Points come only from programs that are fed by a file; the others are for `photograph` and `bench-board`.
            Some(Ok(
                Message::Points(_) | Message::Photo(_) | Message::Pixels(_) | Message::Machine(_) | Message::Case(_),
            )) => Ok(()),
            Some(Ok(Message::Setting(value))) => {
                self.settings.push(value);
                Ok(())
            }
            Some(Ok(Message::Kept(report))) => {
                let settings = core::mem::take(&mut self.settings);
                Ok(self.screen.note(&requests::listing(&settings, &report))?)
            }
            Some(Ok(Message::Clock(board_us))) => {
                self.set_clock(board_us);
                Ok(())
            }
            Some(Ok(Message::Capture(lost))) => Ok(self.screen.note(&format!("cameras lost: {lost}"))?),
            Some(Ok(Message::Hello(hello))) => {
                let is_news = self.last_hello.as_ref() != Some(&hello);
                let text = introduction(&hello);
                self.last_hello = Some(hello);
                if is_news { Ok(self.screen.note(&text)?) } else { Ok(()) }
            }
            Some(Ok(Message::Answer(answer))) => {
                let Some(waiting) = self.waiting.take_if(|waiting| waiting.command.id == answer.command) else {
                    return Ok(()); // answered twice
                };
                match answer.outcome {
                    Outcome::Accepted if waiting.words == SYNC => Ok(()), // every few seconds; frames name the clock
                    Outcome::Accepted => Ok(self.screen.note(&format!("accepted: {}", waiting.words))?),
                    Outcome::Refused(refusal) => Err(anyhow!("the board refused {}: {refusal}", waiting.words).into()),
                }
            }
            Some(Err(DecodeError::Version { found })) => {
                self.other_version = Some(found);
                Ok(())
            }
            Some(Err(_)) => Ok(()), // counted
        }
    }

    /// Has the board give times in this computer's clock: its time in the middle of the question and the answer less the board's.
    fn set_clock(&mut self, board_us: u64) {
        let is_asked = |waiting: &&Waiting| waiting.command.request == Request::ReadClock && waiting.attempts == 1;
        let Some(waiting) = self.waiting.as_ref().filter(is_asked) else { return };
        let middle = SystemTime::now() - waiting.since.elapsed() / 2;
        let now_us = middle.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_micros() as u64);
        let offset_us = now_us.saturating_sub(board_us);
        self.wanted.push_front(Wanted { request: Request::SetClock(offset_us), words: SYNC.to_owned() });
    }

    fn show(&mut self, frame: &Frame) -> Result<(), Stop> {
        if self.left == Some(0) {
            return Ok(()); // came while a command is waited for
        }
        if frame.missing() == 0 {
            self.left = self.left.map(|left| left - 1);
        }
        self.screen.frame(frame, self.last_capture)?;
        self.last_capture = Some(frame.head.capture_time_us);
        let news = frame.head.health.without(self.health);
        self.health = frame.head.health;
        for (name, what) in health::advice(news) {
            self.screen.explain(&format!("health: {name}: {what}"))?;
        }
        Ok(())
    }

    /// Counts what is left unfinished, and says what arrived.
    fn end(&mut self) -> io::Result<()> {
        let mut outcome = Ok(());
        if self.left != Some(0) {
            self.decoder.finish();
            if let Some(frame) = self.frames.finish() {
                outcome = self.screen.frame(&frame, self.last_capture);
            }
        }
        if !self.has_summary {
            return outcome;
        }
        let summary = text::summary(&self.frames.counts(), &self.decoder.counters(), self.bytes, self.other_version);
        outcome.and(self.screen.close(&summary))
    }
}

fn introduction(hello: &Hello) -> String {
    let Hello { board, largest_width, largest_height, segments, rig, reset } = hello;
    let reset = reset.map_or_else(String::new, |reset| format!("; reset by {reset}"));
    format!("board: {board}, images up to {largest_width}x{largest_height}, up to {segments} segments; {rig}{reset}")
}

/// Where the frames are shown.
enum Screen {
    /// One line that changes, on a terminal.
    Live(ProgressBar),
    /// A line per frame.
    Lines,
    /// A line of JSON per frame; notes on stderr.
    Json,
    /// Notes on stderr alone: stdout has the bytes.
    Notes,
}

impl Screen {
    fn new(args: &Args, has_table: bool) -> Self {
        if args.record.as_ref().is_some_and(OutputPath::is_stdout) {
            return Self::Notes;
        }
        if args.json {
            return Self::Json;
        }
        let screen = if io::stdout().is_terminal() {
            let style = ProgressStyle::with_template("{msg}").unwrap_or_else(|_| ProgressStyle::default_spinner());
            Self::Live(ProgressBar::with_draw_target(None, ProgressDrawTarget::stdout()).with_style(style))
        } else {
            Self::Lines
        };
        if has_table {
            let _ = screen.note(text::HEAD); // a closed pipe shows at the first frame
        }
        screen
    }

    fn frame(&self, frame: &Frame, last: Option<u64>) -> io::Result<()> {
        match self {
            Self::Live(bar) => {
                bar.set_message(text::line(frame, last));
                Ok(())
            }
            Self::Lines => writeln!(io::stdout(), "{}", text::line(frame, last)),
            Self::Notes => Ok(()),
            Self::Json if frame.missing() > 0 => Ok(()),
            Self::Json => writeln!(io::stdout(), "{}", text::json(frame)?),
        }
    }

    /// A note for people; lines of JSON speak for themselves.
    fn explain(&self, note: &str) -> io::Result<()> {
        if matches!(self, Self::Json) { Ok(()) } else { self.note(note) }
    }

    fn note(&self, note: &str) -> io::Result<()> {
        let note = printable(note); // a board's name is in it
        match self {
            Self::Live(bar) => bar.suspend(|| writeln!(io::stdout(), "{note}")),
            Self::Lines => writeln!(io::stdout(), "{note}"),
            Self::Json | Self::Notes => writeln!(io::stderr(), "{note}"),
        }
    }

    fn close(&self, summary: &str) -> io::Result<()> {
        match self {
            Self::Live(bar) => {
                let last = bar.message();
                bar.finish_and_clear();
                let end = if last.is_empty() { "" } else { "\n" };
                write!(io::stdout(), "{last}{end}{summary}")
            }
            Self::Lines => write!(io::stdout(), "{summary}"),
            Self::Json | Self::Notes => write!(io::stderr(), "{summary}"),
        }
    }
}
