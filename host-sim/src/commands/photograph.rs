//! `linestereo photograph`: what a board's cameras see, as files.

use crate::draw;
use crate::monitor::photo::{PATIENCE, PhotoAssembler};
use crate::monitor::port::{Port, PortArgs, Received};
use crate::output::OutputFiles;
use anyhow::{Context, Result, bail};
use core::time::Duration;
use indicatif::{ProgressBar, ProgressStyle};
use linestereo_frames::GrayImage;
use linestereo_wire::{Answer, Command, Decoder, MAX_PACKET, Message, Outcome, Request};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Save raw pairs of photos from a board's cameras, for calibration.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/photograph.txt"))]
#[command(group(clap::ArgGroup::new("source").required(true).args(["tcp", "serial"])))]
pub struct Args {
    /// Folder of the photos; created if missing.
    folder: PathBuf,
    #[command(flatten)]
    port: PortArgs,
    /// Pairs to take.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=999))]
    count: u32,
    /// Time between pairs.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    every: f64,
}

pub fn run(args: &Args) -> Result<()> {
    let every = Duration::try_from_secs_f64(args.every)
        .context("--every is no time; give seconds, as in --every 3")?;
    let mut camera = Camera { port: args.port.open()?, decoder: Decoder::new(), next_id: 0 };
    fs::create_dir_all(&args.folder)
        .with_context(|| format!("cannot make the folder {}", args.folder.display()))?;
    let before = taken(&args.folder)?;
    for number in 1..=args.count {
        let begin = Instant::now();
        let bar = progress();
        let pair =
            camera.photograph(&bar).with_context(|| format!("photo {number} of {}", args.count))?;
        bar.finish_and_clear();
        let name = before + number;
        let mut files = OutputFiles::new();
        for (side, image) in ["left", "right"].into_iter().zip(&pair) {
            files
                .add(&args.folder.join(format!("{side}{name:02}.png")), &draw::gray_png(image)?)?;
        }
        files.commit()?;
        crate::output::say(&format!("photo {name:02}: {}\n", described(&pair)))?;
        if number < args.count {
            std::thread::sleep(every.saturating_sub(begin.elapsed()));
        }
    }
    Ok(())
}

/// The highest number of a photo that lies there.
fn taken(folder: &Path) -> Result<u32> {
    let mut highest = 0;
    for entry in
        fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?
    {
        let name = entry?.file_name().to_string_lossy().into_owned();
        let number =
            ["left", "right"].iter().find_map(|side| name.strip_prefix(side)?.strip_suffix(".png"));
        highest = highest.max(number.and_then(|number| number.parse().ok()).unwrap_or(0));
    }
    Ok(highest)
}

/// Size and mean grey levels: what a look at the picture would ask first.
fn described([left, right]: &[GrayImage; 2]) -> String {
    let mean = |image: &GrayImage| {
        image.pixels.iter().map(|&grey| u64::from(grey)).sum::<u64>()
            / image.pixels.len().max(1) as u64
    };
    format!("{}, mean grey level {} left, {} right", left.dims, mean(left), mean(right))
}

fn progress() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {bytes} of {total_bytes}");
    ProgressBar::no_length().with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// A board at the other end of a port.
struct Camera {
    port: Port,
    decoder: Decoder<Message, MAX_PACKET>,
    next_id: u16,
}

impl Camera {
    /// One pair. A packet that is lost on the way costs the photo: a calibration wants whole ones.
    fn photograph(&mut self, bar: &ProgressBar) -> Result<[GrayImage; 2]> {
        self.next_id = self.next_id.wrapping_add(1);
        let command = Command { id: self.next_id, request: Request::Photograph };
        self.port.send(&command)?;
        let (mut buffer, mut photos, mut last) =
            ([0; 4096], PhotoAssembler::default(), Instant::now());
        let mut is_silent = true;
        loop {
            if last.elapsed() > PATIENCE {
                let seconds = PATIENCE.as_secs();
                if is_silent {
                    bail!("no answer in {seconds} s; does the board run, and is the speed right?");
                }
                bail!(
                    "no photograph in {seconds} s, though bytes came; check --baud, the cable, and \
                     that the board has linestereo's firmware"
                );
            }
            let count = match self.port.read(&mut buffer)? {
                Received::Bytes(count) => count,
                Received::End => bail!("the port has ended"),
                Received::Silence => continue,
            };
            is_silent = false;
            for &byte in &buffer[..count] {
                let Some(Ok(message)) = self.decoder.push(byte) else { continue };
                if matches!(message, Message::Photo(_) | Message::Pixels(_)) {
                    last = Instant::now();
                }
                if let Some(pair) = take(message, command.id, &mut photos, bar)? {
                    return Ok(pair);
                }
            }
        }
    }
}

/// Takes a message; gives the pair when it is whole.
fn take(
    message: Message,
    id: u16,
    photos: &mut PhotoAssembler,
    bar: &ProgressBar,
) -> Result<Option<[GrayImage; 2]>> {
    let whole = match message {
        Message::Answer(Answer { command, outcome: Outcome::Refused(why) }) if command == id => {
            bail!("the board refused: {why}")
        }
        Message::Photo(head) => {
            photos.begin(&head)?;
            None
        }
        Message::Pixels(pixels) => photos.add(&pixels)?,
        _ => None, // results, if the board sends them
    };
    let (arrived, all) = photos.progress();
    bar.set_length(all);
    bar.set_position(arrived);
    Ok(whole)
}
