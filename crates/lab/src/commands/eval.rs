//! `linestereo-lab eval`: scores on frames with ground truth.

use super::batch::{BatchArgs, Collected, collect};
use crate::evaluate::{FrameScore, Summary, cell_table, report, scene_table};
use anyhow::{Context, Result, bail};
use core::time::Duration;
use linestereo::Params;
use linestereo_calibration::rectify_raw;
use linestereo_frames::GrayImage;
use linestereo_frames::{Perturbation, Scene, StoredPair, Truth, check_usable};
use linestereo_sim::commands::method::MethodArgs;
use linestereo_sim::commands::pairs::{for_each_pair, timed_bar};
use linestereo_sim::commands::{asked_for, engine_with};
use linestereo_sim::engine::Engine;
use linestereo_sim::output::{OutputFiles, OutputPath, spare};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// Timing of one pair stops after this long, or after this many runs.
const TIMING_BUDGET: Duration = Duration::from_millis(250);
const TIMING_RUNS: usize = 15;

/// Least probability of the answers that the curve over cells is made of.
const CURVE_PROBABILITY: f64 = 0.2;

const EXAMPLES: &str = "\
Examples:
  linestereo-lab eval frames/qvga                           score every scene below frames/qvga
  linestereo-lab eval frames/qvga --row-offset 1            the same with the right image 1 px too low
  linestereo-lab eval frames/qvga --gain 0.8 --bias 8       the same with the right image darker
  linestereo-lab eval frames/full --width 320 --json -      reduce to 320 px first, print JSON
  linestereo-lab eval frames/qvga --cells                   one answer per cell: what a robot knows of every place
  linestereo-lab eval frames/qvga --objects                 depth of the objects in objects.png and objects.json
  linestereo-lab eval kitti/training --width 640            KITTI, Middlebury, ETH3D as downloaded; PFM, PNG, NPZ truth

Words:
  segprec@1/@2   % of segments whose median error is at most 1 / 2 px
  bad1/bad2      % of points more than 1 / 2 px off the truth
  vis, allGT     points whose true match is visible in the right image; all points with truth
  cells          % of 16x16 cells (those at least half visible truth) that hold an answer
  median, rms    error of visible points in px
  one answer per cell   errors of the most probable answer of each 16x16 cell, by the share of all cells
  ms             time per pair on one thread, median of several runs
  wrong          (--objects) an answer more than 1 px outside of the object's 5-95 % range of true disparities
  covered        (--objects) objects with an answer
  median error   (--objects) |answer - true median| / true median
  in 1, 2 sigma  (--objects) answers within one and two stated standard deviations of the true median

Scenes that the confidence model was fitted on flatter it: fit-confidence scores each of them by a
model that has not seen it.";

/// Score the core on every pair with ground truth, on all cores.
///
/// Parameters are the defaults for every scene; only the disparity range and the rig come from its
/// scene.json or calibration. Folders may be of any layout: with scene.json, Middlebury, KITTI,
/// ETH3D, left and right folders, numbered pairs.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Folders to search for pairs with ground truth, at any depth and in any layout.
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Write the scores as JSON to FILE, or to stdout in place of the tables with "-".
    #[arg(long, value_name = "FILE")]
    json: Option<OutputPath>,
    /// Reduce images to this width by area averaging; truth, range and rig follow.
    #[arg(long, value_name = "PX")]
    width: Option<u16>,
    /// Search disparities 0 .. N in every scene, whatever its scene.json says.
    #[arg(long, value_name = "N")]
    max_disparity: Option<u16>,
    /// Score the depth of objects in place of points and segments: masks as given, 2 px too large,
    /// eroded by 2 px, and drawn boxes.
    #[arg(long)]
    objects: bool,
    /// Print one answer per cell alone, a line for every scene: how often the first 30 to 85 % of
    /// all 16x16 cells are wrong, each by its most probable answer, least probable 0.2 unless
    /// --min-confidence says otherwise.
    #[arg(long, conflicts_with = "objects")]
    cells: bool,
    /// Leave the times out. They are measured one pair after the other, when all others are done,
    /// and differ from run to run.
    #[arg(long)]
    no_times: bool,
    #[command(flatten)]
    batch: BatchArgs,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    perturbation: PerturbationArgs,
}

impl Args {
    /// For a long curve, what is less probable as well.
    fn method(&self) -> MethodArgs {
        if self.cells { self.method.down_to(CURVE_PROBABILITY) } else { self.method.clone() }
    }
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Perturbations of the input")]
struct PerturbationArgs {
    /// Move the right image down by this much (fractions are interpolated).
    #[arg(long, value_name = "PX", default_value_t = 0.0, allow_negative_numbers = true)]
    row_offset: f64,
    /// Multiply the right image.
    #[arg(long, value_name = "G", default_value_t = 1.0, allow_negative_numbers = true)]
    gain: f64,
    /// Add to the right image (grey levels).
    #[arg(long, value_name = "B", default_value_t = 0.0, allow_negative_numbers = true)]
    bias: f64,
    /// Add Gaussian noise of this standard deviation to both images.
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0, allow_negative_numbers = true)]
    noise: f64,
    /// Seed of the noise.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Blur both images by a Gaussian of this standard deviation.
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0, allow_negative_numbers = true)]
    blur: f64,
    /// Swap left and right: every true disparity is then negative, and the honest answer is next to
    /// nothing.
    #[arg(long)]
    swap: bool,
}

impl PerturbationArgs {
    fn checked(&self) -> Result<Perturbation> {
        let ranges = [
            ("--row-offset", self.row_offset, -64.0, 64.0),
            ("--gain", self.gain, 0.0, 16.0),
            ("--bias", self.bias, -255.0, 255.0),
            ("--noise", self.noise, 0.0, 255.0),
            ("--blur", self.blur, 0.0, 32.0),
        ];
        for (name, value, low, high) in ranges {
            if !(low..=high).contains(&value) {
                bail!("{name} is {value}; give {low} to {high}");
            }
        }
        Ok(Perturbation {
            blur: self.blur,
            row_offset: self.row_offset,
            gain: self.gain,
            bias: self.bias,
            noise: self.noise,
            seed: self.seed,
            swap: self.swap,
        })
    }
}

#[derive(Serialize)]
struct JsonReport {
    pooled: Summary,
    scenes: Vec<JsonScene>,
}

#[derive(Serialize)]
struct JsonScene {
    scene: String,
    #[serde(flatten)]
    summary: Summary,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let perturbation = args.perturbation.checked()?;
    let Collected { pairs, notes } = collect(&args.folders, true)?;
    spare(asked_for([&args.json]), pairs.iter().flat_map(StoredPair::files))?;
    if args.objects {
        let load = |pair: &StoredPair| load(pair, args);
        let (method, json) = (&args.method, args.json.as_ref());
        return super::eval_objects::run(
            &pairs,
            args.batch.threads(),
            load,
            method,
            &perturbation,
            json,
        );
    }
    let name = |pair: &StoredPair| pair.name.clone();
    let mut scores = for_each_pair(&pairs, args.batch.threads(), name, |pair| {
        scored(&load(pair, args)?, &args.method(), &perturbation)
    })?;
    if !args.no_times && !args.cells {
        measure(args, &pairs, &mut scores, &perturbation)?;
    }
    write_results(args, &notes, &scores)
}

/// The scene as it is to be matched.
fn load(pair: &StoredPair, args: &Args) -> Result<Scene> {
    let mut scene = pair.load(args.width, &rectify_raw)?;
    scene.max_disparity = args.max_disparity.unwrap_or(scene.max_disparity);
    Ok(scene)
}

/// A scene as it is matched and scored, whoever matches it.
struct Prepared<'a> {
    scene: &'a Scene,
    images: (GrayImage, GrayImage),
    params: Params,
    truth: Truth,
}

impl<'a> Prepared<'a> {
    fn new(scene: &'a Scene, method: &MethodArgs, perturbation: &Perturbation) -> Result<Self> {
        let truth = scene
            .truth
            .as_ref()
            .with_context(|| format!("{} has no truth", scene.folder.display()))?;
        let (left, right) = perturbation.apply(&scene.left, &scene.right);
        check_usable(&scene.folder.join("left"), &left)?;
        check_usable(&scene.folder.join("right"), &right)?;
        let truth = if perturbation.swap { truth.swapped() } else { truth.clone() };
        let params = method.params(scene.max_disparity, scene.rig)?;
        Ok(Self { scene, images: (left, right), params, truth })
    }

    fn name(&self) -> String {
        format!("{}: {}", self.scene.folder.display(), self.scene.name)
    }

    /// The core; says what is wrong in terms of options.
    fn engine(&self) -> Result<Engine> {
        engine_with(&self.params, self.images.0.dims)
            .map(Engine::answering_unfit)
            .with_context(|| self.name())
    }
}

/// Matches one scene, and scores its result.
fn scored(scene: &Scene, method: &MethodArgs, perturbation: &Perturbation) -> Result<FrameScore> {
    let prepared = Prepared::new(scene, method, perturbation)?;
    let (left, right) = &prepared.images;
    let result = prepared.engine()?.run(left.view()?, right.view()?)?;
    Ok(FrameScore::new(&scene.name, &prepared.truth, &result))
}

/// Times every pair alone, on one thread.
fn measure(
    args: &Args,
    pairs: &[StoredPair],
    scores: &mut [FrameScore],
    perturbation: &Perturbation,
) -> Result<()> {
    let progress = timed_bar(pairs.len());
    for (pair, score) in pairs.iter().zip(scores) {
        progress.set_message(format!("timing {}", pair.name));
        let scene = load(pair, args)?;
        let prepared = Prepared::new(&scene, &args.method, perturbation)?;
        let (left, right) = &prepared.images;
        score.milliseconds = Some(time(&mut prepared.engine()?, left, right)?);
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(())
}

/// Median time of a run in milliseconds.
fn time(engine: &mut Engine, left: &GrayImage, right: &GrayImage) -> Result<f64> {
    let (left, right) = (left.view()?, right.view()?);
    let begin = Instant::now();
    let mut times = Vec::new();
    while times.is_empty() || (times.len() < TIMING_RUNS && begin.elapsed() < TIMING_BUDGET) {
        let start = Instant::now();
        engine.run_in_place(left, right)?.points(|point| _ = core::hint::black_box(point));
        times.push(start.elapsed());
    }
    times.sort();
    Ok(1e3 * times[times.len() / 2].as_secs_f64())
}

/// Tables and JSON.
fn write_results(args: &Args, notes: &[String], scores: &[FrameScore]) -> Result<()> {
    let pooled = Summary::pool(scores);
    let mut text = if args.cells {
        let scenes: Vec<(&str, Summary)> =
            scores.iter().map(|score| (score.name.as_str(), Summary::pool([score]))).collect();
        let rows =
            scenes.iter().map(|(name, summary)| (*name, summary)).chain([("pooled", &pooled)]);
        cell_table(rows)
    } else {
        format!("{}\n{}", scene_table(scores), report(&pooled))
    };
    for note in notes {
        text.push_str(&format!("\n{note}\n"));
    }
    if args.perturbation.swap {
        text.push_str("\nthe images were swapped: every true disparity is negative, so every answer above is wrong\n");
    }
    let scene = |score: &FrameScore| JsonScene {
        scene: score.name.clone(),
        summary: Summary::pool([score]),
    };
    let report = JsonReport { pooled, scenes: scores.iter().map(scene).collect() };
    let mut output = OutputFiles::new();
    output.add_json(args.json.as_ref(), &report)?;
    output.commit_and_say(&text)
}
