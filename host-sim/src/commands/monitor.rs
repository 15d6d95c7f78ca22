//! `linestereo monitor`: a board's results as they arrive, and commands to it.

use crate::interruption;
use crate::monitor::frames::Frame;
use crate::monitor::link::{Event, Link};
use crate::monitor::port::{Port, PortArgs, Received};
use crate::monitor::requests::{self, Wanted};
use crate::monitor::text;
use crate::output::{ClosedPipe, OutputPath, check_unread, print, tell};
use crate::results::health;
use anyhow::{Result, anyhow, bail};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use linestereo_wire::{Health, Sectors};
use std::fs::File;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};

/// Show a board's results as they arrive, over a serial port, a connection or from a file; send
/// commands to it.
///
/// Damaged and lost records are counted and skipped.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/monitor.txt"))]
#[command(group(clap::ArgGroup::new("source").required(true).args(["file", "tcp", "serial"])))]
pub struct Args {
    /// Read recorded bytes; "-" is stdin.
    #[arg(conflicts_with = "baud")]
    file: Option<PathBuf>,
    #[command(flatten)]
    port: PortArgs,
    /// Save the received bytes; "-" is stdout, without the table.
    #[arg(long, value_name = "FILE")]
    record: Option<OutputPath>,
    /// Print each complete frame as a line of JSON, without the table.
    #[arg(long)]
    json: bool,
    /// Stop after N complete frames; 0 only sends the commands.
    #[arg(long, value_name = "N")]
    count: Option<u64>,
    /// Send start, stop, describe, photograph, sync, settings, keep, defaults, bootloader,
    /// rig=FILE, box= or only_box=LABEL:LEFT,TOP,RIGHT,BOTTOM, or NAME=VALUE, and wait for the
    /// answer; may be given several times.
    #[arg(long, value_name = "COMMAND", conflicts_with = "file")]
    send: Vec<String>,
}

pub fn run(args: &Args) -> Result<()> {
    if args.json && args.record.as_ref().is_some_and(OutputPath::is_stdout) {
        bail!("--json and --record - both write to stdout; record to a file");
    }
    let wanted = requests::parse(&args.send)?;
    let mut port = args.port.open_or(args.file.as_deref())?;
    let mut record = args.record.as_ref().map(Record::create).transpose()?;
    let mut monitor = Monitor::new(args, wanted);
    let outcome = monitor.follow(&mut port, &mut record);
    if let (Ok(()), Some(path)) = (&outcome, args.file.as_ref().filter(|_| monitor.has_nothing())) {
        bail!(
            "{} holds nothing that a board sent, in {} bytes; give a file of linestereo monitor --record",
            path.display(),
            monitor.link.bytes()
        );
    }
    let summary = monitor.end();
    outcome.and(summary)
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
            check_unread(path)?;
            Box::new(File::create(&**path).map_err(|error| cannot_record(path, &error))?)
        };
        Ok(Self { path: path.to_path_buf(), file })
    }
}

fn cannot_record(path: &Path, error: &io::Error) -> anyhow::Error {
    anyhow!(
        "cannot write {}: {error}; choose a file in a folder that exists and is writable",
        path.display()
    )
}

/// A link whose frames are shown.
struct Monitor {
    link: Link,
    /// Complete frames still to come.
    left: Option<u64>,
    last_capture: Option<u64>,
    health: Health,
    has_summary: bool,
    screen: Screen,
}

impl Monitor {
    fn new(args: &Args, wanted: Vec<Wanted>) -> Self {
        Self {
            link: Link::new(wanted),
            left: args.count,
            last_capture: None,
            health: Health::GOOD,
            has_summary: args.count != Some(0),
            screen: Screen::new(args, args.count != Some(0)),
        }
    }

    /// Until the file ends, all frames are there, the user interrupts or the port fails.
    fn follow(&mut self, port: &mut Port, record: &mut Option<Record>) -> Result<()> {
        interruption::watch();
        let mut buffer = [0; 4096];
        loop {
            self.link.command(port)?;
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
                            ErrorKind::BrokenPipe => ClosedPipe.into(),
                            _ => cannot_record(path, &error),
                        })?;
                    }
                    for &byte in received {
                        for event in self.link.push(byte) {
                            self.show(event)?;
                        }
                        if self.is_done() {
                            break;
                        }
                    }
                }
            }
        }
    }

    /// True when nothing of a board was among the bytes, though something should be.
    fn has_nothing(&self) -> bool {
        self.link.has_nothing() && self.left != Some(0) && !interruption::requested()
    }

    fn is_done(&self) -> bool {
        self.left == Some(0) && self.link.is_answered()
    }

    fn show(&mut self, event: Event) -> Result<()> {
        match event {
            Event::Frame(_) if self.left == Some(0) => Ok(()), // came while a command is waited for
            Event::Frame(frame) => self.show_frame(&frame),
            Event::Objects(objects) => {
                let mut list = objects.list.iter();
                list.try_for_each(|object| self.screen.note(&text::object(object)))
            }
            Event::Sectors(sectors) => self.screen.sectors(&sectors),
            Event::Photo([left, _]) => {
                let note = format!(
                    "photograph: {}; linestereo photograph saves them, linestereo view shows them",
                    left.dims
                );
                self.screen.note(&note)
            }
            Event::Answer(answered) => self.screen.note(&answered.note()?),
            Event::Note(note) => self.screen.note(&note),
        }
    }

    fn show_frame(&mut self, frame: &Frame) -> Result<()> {
        if frame.missing() == 0 {
            self.left = self.left.map(|left| left - 1);
        }
        self.screen.frame(frame, self.last_capture)?;
        self.last_capture = Some(frame.head.capture_time_us);
        let news = frame.head.health.difference(self.health);
        self.health = frame.head.health;
        for (name, what) in health::advice(news) {
            self.screen.explain(&format!("health: {name}: {what}"))?;
        }
        Ok(())
    }

    /// Counts what is left unfinished, and says what arrived.
    fn end(&mut self) -> Result<()> {
        let mut outcome = Ok(());
        if self.left != Some(0)
            && let Some(frame) = self.link.finish()
        {
            outcome = self.screen.frame(&frame, self.last_capture);
        }
        if !self.has_summary {
            return outcome;
        }
        outcome.and(self.screen.close(&self.link.summary()))
    }
}

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
            let style = ProgressStyle::with_template("{msg}")
                .unwrap_or_else(|_| ProgressStyle::default_spinner());
            Self::Live(
                ProgressBar::with_draw_target(None, ProgressDrawTarget::stdout()).with_style(style),
            )
        } else {
            Self::Lines
        };
        if has_table {
            let _ = screen.note(text::HEAD); // a closed pipe shows at the first frame
        }
        screen
    }

    fn frame(&self, frame: &Frame, last: Option<u64>) -> Result<()> {
        match self {
            Self::Live(bar) => {
                bar.set_message(text::line(frame, last));
                Ok(())
            }
            Self::Lines => print(&(text::line(frame, last) + "\n")),
            Self::Json if frame.missing() == 0 => print(&(text::json(frame)? + "\n")),
            Self::Json | Self::Notes => Ok(()),
        }
    }

    fn sectors(&self, sectors: &Sectors) -> Result<()> {
        match self {
            Self::Json => print(&(text::sectors_json(sectors)? + "\n")),
            _ => self.note(&text::sectors(sectors)),
        }
    }

    /// A note for people; lines of JSON speak for themselves.
    fn explain(&self, note: &str) -> Result<()> {
        if matches!(self, Self::Json) { Ok(()) } else { self.note(note) }
    }

    fn note(&self, note: &str) -> Result<()> {
        let print = || print(&format!("{note}\n"));
        match self {
            Self::Live(bar) => bar.suspend(print),
            Self::Lines => print(),
            Self::Json | Self::Notes => {
                tell(note);
                Ok(())
            }
        }
    }

    fn close(&self, summary: &str) -> Result<()> {
        match self {
            Self::Live(bar) => {
                let last = bar.message();
                bar.finish_and_clear();
                let end = if last.is_empty() { "" } else { "\n" };
                print(&format!("{last}{end}{summary}"))
            }
            Self::Lines => print(summary),
            Self::Json | Self::Notes => {
                tell(summary.trim_end());
                Ok(())
            }
        }
    }
}
