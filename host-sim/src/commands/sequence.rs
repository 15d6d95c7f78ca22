//! `linestereo sequence`: a recorded sequence, a line of JSON per frame.

use super::input::{InputArgs, Matcher, Pair, Setup};
use super::objects::{Asked, ObjectArgs};
use super::pairs::named_bar;
use super::print;
use crate::draw;
use crate::engine::FrameResult;
use crate::evaluate::{NearestSummary, Surveyed, nearest_disparity, surveyed};
use crate::input::{PairFiles, Sequence, SequencePair, halves, load_gray};
use crate::output::{LineFile, OutputFiles};
use crate::results::listing;
use crate::statistics::upper_median;
use anyhow::{Result, bail};
use linestereo::{Dims, Disparity};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  linestereo sequence recording --scene rig/scene.json --out results.jsonl
  linestereo sequence MH_01_easy --rig cam0.yaml --rig cam1.yaml --size 376x240 | jq -c '.health.flags'
      EuRoC's folders, rectified first; lines on stdout

Nearest obstacle against surveyed distances, where nobody knows f*B: taken from one sequence, applied to the other
  linestereo sequence take1 --truth take1/frames.csv --truth-radius-m 0.25 --no-points --out take1.jsonl
      prints the f*B that fits
  linestereo sequence take18 --fb 5.9 --truth take18/frames.csv --plot nearest.png --no-points --out take18.jsonl
      prints errors and missed frames, and draws them

Layouts: a folder per pair (0001/left.png, 0001/right.png); 0001_left.png and 0001_right.png; left1.png and
right1.png; left/ and right/, image_0/ and image_1/ (KITTI), cam0/data/ and cam1/data/ (EuRoC) with the same names
in both; with --side-by-side one file per pair. A scene.json in FOLDER is used unless --scene or --rig is given.

A line: {\"frame\":i, \"name\":\"...\", and the fields of `run --json`}; a frame that fails gives
{\"frame\":i, \"name\":\"...\", \"error\":\"...\"} and does not stop the others. Objects that cannot be read are an
\"objects_error\" in their frame's line.";

/// Match every pair of a recorded sequence: one line of JSON per frame.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Folder with the sequence.
    folder: PathBuf,
    /// Write the lines to this file, in place of stdout.
    #[arg(long, value_name = "FILE.jsonl")]
    out: Option<PathBuf>,
    /// Both images of a pair stand side by side in one file: left | right.
    #[arg(long)]
    side_by_side: bool,
    /// Only frames whose number is in this range (the position, where names have no number).
    #[arg(long, value_name = "FIRST..LAST", value_parser = parse_range)]
    frames: Option<(u64, u64)>,
    /// Leave the points out: short lines.
    #[arg(long)]
    no_points: bool,
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    objects: ObjectArgs,
    #[command(flatten)]
    truth: TruthArgs,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Nearest obstacle")]
struct TruthArgs {
    /// Compare the nearest obstacle with a table: columns `frame` and `dist...`, in m. Without --fb or a rig, f*B is fitted.
    #[arg(long, value_name = "FILE.csv")]
    truth: Option<PathBuf>,
    /// The surveyed distances are to the centre of a round obstacle: its surface is so much nearer.
    #[arg(long, value_name = "M", requires = "truth", default_value_t = 0.0)]
    truth_radius_m: f64,
    /// Draw both distances over the sequence.
    #[arg(long, value_name = "FILE.png", requires = "truth")]
    plot: Option<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let sequence = Sequence::find(&args.folder, args.side_by_side)?;
    let frames = chosen(&sequence, args.frames);
    if frames.is_empty() {
        bail!("{} holds no pairs; see --help for the layouts", args.folder.display());
    }
    let surveyed = args.truth.truth.as_deref().map(surveyed).transpose()?;
    let mut lines = args.out.as_deref().map(LineFile::new).transpose()?;
    let mut player = Player::new(&args.input, &args.folder);
    let (mut failed, mut skipped, mut unread, mut nearest) = (0, 0, 0, Vec::new());
    let progress = named_bar(frames.len());
    for &(number, pair) in &frames {
        progress.set_message(pair.name.clone());
        let (line, disparity) = match player.next(pair, &args.objects) {
            Ok((dims, result, objects)) => {
                let answers = Asked::answers(objects.as_ref());
                if let Some(objects) = &objects {
                    skipped += objects.skipped.objects();
                    unread += usize::from(objects.error.is_some());
                }
                let line = listing::json(dims, &result.without_points(args.no_points), &answers)?;
                (with_name(number, &pair.name, &line), nearest_disparity(&result))
            }
            Err(error) => {
                failed += 1;
                let error = format!("{error:#}").split_whitespace().collect::<Vec<_>>().join(" ");
                (format!("{}\n", json!({"frame": number, "name": pair.name, "error": error})), None)
            }
        };
        nearest.push((number, disparity));
        match &mut lines {
            Some(file) => file.push(&line)?,
            None => print(&line)?,
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    let mut notes = format!("{} frames, {failed} failed, {} images without a partner\n", frames.len(), sequence.alone);
    if args.objects.is_given() {
        notes.push_str(&format!("{skipped} objects skipped, {unread} frames whose objects cannot be read\n"));
    }
    if let Some(surveyed) = &surveyed {
        notes.push_str(&compare(args, player.setup.as_ref(), surveyed, &nearest)?);
    }
    match lines {
        Some(file) => {
            file.commit()?;
            print(&notes)
        }
        None => {
            eprint!("{notes}");
            Ok(())
        }
    }
}

/// Pairs in the range, each with its number.
fn chosen(sequence: &Sequence, range: Option<(u64, u64)>) -> Vec<(u64, &SequencePair)> {
    let numbered = sequence.pairs.iter().zip(0..).map(|(pair, position)| (pair.number.unwrap_or(position), pair));
    numbered.filter(|(number, _)| range.is_none_or(|(first, last)| (first..=last).contains(number))).collect()
}

fn parse_range(text: &str) -> Result<(u64, u64), String> {
    let range = text.split_once("..").and_then(|(first, last)| Some((first.parse().ok()?, last.parse().ok()?)));
    range.filter(|(first, last)| first <= last).ok_or_else(|| "give two numbers: 10..200".to_owned())
}

/// Pairs of a folder, matched one after the other.
pub(super) struct Player<'a> {
    args: &'a InputArgs,
    scene: Option<PathBuf>,
    pub(super) setup: Option<Setup<'a>>,
    pub(super) matcher: Option<Matcher>,
}

impl<'a> Player<'a> {
    pub(super) fn new(args: &'a InputArgs, folder: &Path) -> Self {
        let scene =
            Some(folder.join("scene.json")).filter(|path| path.is_file() && !args.has_scene() && !args.is_raw());
        Self { args, scene, setup: None, matcher: None }
    }

    /// Loads a pair and, the first time, sets up what it is matched with.
    pub(super) fn load(&mut self, pair: &SequencePair) -> Result<Pair> {
        let loaded = match &pair.files {
            PairFiles::Two([left, right]) => self.args.load(left, right)?,
            PairFiles::SideBySide(path) => {
                let [left, right] = halves(&load_gray(path)?);
                self.args.checked((path, left), (path, right))?
            }
        };
        if self.setup.is_none() {
            let setup = match &self.scene {
                Some(scene) => self.args.setup_with(&loaded, Some(scene))?,
                None => self.args.setup(&loaded)?,
            };
            self.matcher = Some(Matcher::new(&setup)?);
            self.setup = Some(setup);
        }
        Ok(loaded)
    }

    fn next(&mut self, pair: &SequencePair, asked: &ObjectArgs) -> Result<(Dims, FrameResult, Option<Asked>)> {
        let loaded = self.load(pair)?;
        let (Some(setup), Some(matcher)) = (&self.setup, &mut self.matcher) else { bail!("nothing is set up") };
        let times = pair.time_us().map(|time| [time; 2]);
        if matcher.engine.knows_rows() {
            matcher.engine.focus(asked.areas(setup, pair.left()));
        }
        let result = matcher.run(setup, &loaded, times)?.result;
        let objects = asked.depths(setup, pair.left(), &mut matcher.engine, &result);
        Ok((setup.dims(), result, objects))
    }
}

/// The object of a line with the frame's number and name before its own fields.
fn with_name(number: u64, name: &str, line: &str) -> String {
    let name = Value::from(name);
    format!("{{\"frame\":{number},\"name\":{name},{}", line.trim_start_matches('{'))
}

/// Nearest disparities against surveyed distances, in words; with a picture if asked.
fn compare(
    args: &Args,
    setup: Option<&Setup<'_>>,
    surveyed: &Surveyed,
    nearest: &[(u64, Option<f64>)],
) -> Result<String> {
    let known = nearest.iter().filter_map(|(number, disparity)| {
        let distance = surveyed.get(number)? - args.truth.truth_radius_m;
        (distance > 0.0).then_some((*number, distance, *disparity))
    });
    let known: Vec<(u64, f64, Option<f64>)> = known.collect();
    let zero = setup.map_or(0.0, |setup| setup.zero);
    let products = known.iter().filter_map(|(_, z, d)| Some(((*d)? - zero) * z));
    let fitted = upper_median(products.collect(), f64::total_cmp);
    let rig = setup.and_then(|setup| setup.params.rig);
    let metres = |disparity: f64| match (rig, fitted) {
        (Some(rig), _) => listing::finite_metres(rig.depth(Disparity::saturating_from_num(disparity))),
        (None, Some(fb)) => Some(fb / (disparity - zero)).filter(|z| z.is_finite() && *z > 0.0),
        (None, None) => None,
    };
    let frames: Vec<_> = known.iter().map(|(number, z, d)| (*number, *z, d.and_then(metres))).collect();
    let summary = NearestSummary::new(&frames.iter().map(|frame| (frame.1, frame.2)).collect::<Vec<_>>());
    let fitted = fitted.map_or(String::new(), |fb| {
        format!("f*B that fits: {fb:.3} px*m{}\n", if rig.is_none() { ", used here" } else { ", not used" })
    });
    if let Some(path) = &args.truth.plot {
        let mut output = OutputFiles::new();
        output.add(path, &draw::png(&draw::nearest(&summary.to_string(), &frames))?)?;
        output.commit()?;
    }
    Ok(format!("{fitted}{summary}\n"))
}
