//! `linestereo view`: pairs as they are matched, or a board's results as they arrive, on a page in
//! the browser.

mod boards;
mod pairs;
mod space;

use super::arguments::number_in;
use super::input::InputArgs;
use super::player::SourceArgs;
use super::sector_options::SectorPlanArgs;
use crate::interruption;
use crate::monitor::port::PortArgs;
use crate::output::{print, say};
use crate::report::live_page;
use crate::serve::{AskedBox, Event, Server};
use anyhow::Result;
use base64::{Engine as _, prelude::BASE64_STANDARD};
use core::time::Duration;
use linestereo_frames::GrayImage;
use linestereo_recordings::{is_recording, is_video};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Wait between two looks for what happened meanwhile.
const LOOK: Duration = Duration::from_millis(5);

/// Show pairs as they are matched, or a board's results as they arrive, on a page in the browser.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("../help/view.txt"))]
#[command(group(clap::ArgGroup::new("shown").required(true).args(["path", "tcp", "serial", "camera"])))]
pub struct Args {
    /// Folder of pairs, recording of ROS 2 (.mcap), or video; or bytes that a board sent, "-" is
    /// stdin.
    #[arg(conflicts_with = "baud")]
    path: Option<PathBuf>,
    #[command(flatten)]
    source: SourceArgs,
    /// Port of 127.0.0.1 to serve the page at; 0 is a free one.
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
    /// Pairs a second of what is recorded [default: at its own times, else 10].
    #[arg(long, value_name = "N", conflicts_with_all = ["tcp", "serial", "camera"],
          value_parser = number_in(0.01..=1000.0, "give pairs a second, 0.01 to 1000"))]
    rate: Option<f64>,
    /// Begin anew after the last pair.
    #[arg(long, conflicts_with_all = ["tcp", "serial", "camera"])]
    repeat: bool,
    #[command(flatten)]
    board: PortArgs,
    /// Send a command to the board, as linestereo monitor --send does; may be given several times.
    #[arg(long, value_name = "COMMAND", conflicts_with_all = ["path", "camera"])]
    send: Vec<String>,
    /// Ask the board for a photograph so long after the last one has arrived.
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..=3600), conflicts_with_all = ["path", "camera"])]
    photograph: Option<u32>,
    #[command(flatten)]
    sectors: SectorPlanArgs,
    #[command(flatten)]
    input: InputArgs,
}

pub fn run(args: &Args) -> Result<()> {
    interruption::watch();
    let is_of_board = |path: &Path| !path.is_dir() && !is_recording(path) && !is_video(path);
    let has_board = args.board.tcp.is_some() || args.board.serial.is_some();
    let summary = if has_board || args.path.as_deref().is_some_and(is_of_board) {
        boards::show(args)?
    } else {
        pairs::show(args)?
    };
    say(&summary)
}

impl Args {
    /// Serves the page, and says where.
    fn serve(&self) -> Result<Server> {
        let PortArgs { tcp, serial, .. } = &self.board;
        let path = self.path.as_ref().map(|path| path.display().to_string());
        let source = path
            .or_else(|| tcp.clone())
            .or_else(|| serial.clone())
            .unwrap_or_else(|| "camera".to_owned());
        let server = Server::start(self.port, |nonce| live_page(&source, nonce))?;
        // Wanted even by who wants no notes.
        print(&format!("{}\n", server.address()))?;
        Ok(server)
    }
}

/// Boxes that the visitors ask for, as they were last answered.
#[derive(Default)]
struct Asked {
    boxes: Vec<AskedBox>,
}

impl Asked {
    /// Takes the visitors' list, and tells all of them; true where it is another one.
    fn changed(&mut self, server: &Server) -> bool {
        let boxes = server.boxes();
        let is_new = boxes != self.boxes;
        if is_new {
            server.send("boxes", &[("boxes", json!(boxes).to_string())]);
            self.boxes = boxes;
        }
        is_new
    }
}

/// Times of recorded pairs.
struct Pace {
    rate: Option<f64>,
    last: Option<(Instant, Option<u64>)>,
}

impl Pace {
    /// Between pairs without times, and the longest that is waited for the next one.
    const STEP: Duration = Duration::from_millis(100);
    const LONGEST: Duration = Duration::from_secs(2);

    fn new(args: &Args) -> Self {
        Self { rate: args.rate, last: None }
    }

    /// Time to show a pair that was captured at this time.
    fn due(&mut self, captured_us: Option<u64>) -> Instant {
        let now = Instant::now();
        let due = self.last.map_or(now, |(last, before_us)| {
            let since_us =
                captured_us.zip(before_us).and_then(|(this, before)| this.checked_sub(before));
            let recorded = since_us
                .map(Duration::from_micros)
                .filter(|since| !since.is_zero() && *since <= Self::LONGEST);
            let step = self.rate.map(|rate| Duration::from_secs_f64(1.0 / rate)).or(recorded);
            now.max(last + step.unwrap_or(Self::STEP))
        });
        self.last = Some((due, captured_us));
        due
    }
}

/// The picture under the segments.
fn picture(image: &GrayImage) -> Event {
    let size = [image.dims.width, image.dims.height];
    ("picture", json!({"size": size, "grey": BASE64_STANDARD.encode(&image.pixels)}).to_string())
}

/// Tells the visitors how it ended.
fn end(server: &Server, summary: &str) {
    server.send("end", &[("end", json!(summary).to_string())]);
}
