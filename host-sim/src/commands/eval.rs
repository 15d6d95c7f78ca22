//! `linestereo eval`: scores on frames with ground truth.

use super::method::MethodArgs;
use super::{does_not_fit, engine_with, print};
use crate::board::{self, Machine};
use crate::engine::{Engine, GrayImage};
use crate::evaluate::{FrameScore, Summary, report, scene_table};
use crate::frames::{Perturbation, Scene, check_usable, find_scenes, load_scene};
use crate::output::OutputFiles;
use anyhow::{Context, Result, anyhow, bail};
use core::time::Duration;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Timing of one pair stops after this long, or after this many runs.
const TIMING_BUDGET: Duration = Duration::from_millis(250);
const TIMING_RUNS: usize = 15;

const EXAMPLES: &str = "\
Examples:
  linestereo eval frames/qvga                           score every scene below frames/qvga
  linestereo eval frames/qvga --row-offset 1            the same with the right image 1 px too low
  linestereo eval frames/qvga --gain 0.8 --bias 8       the same with the right image darker
  linestereo eval frames/full --width 320 --json -      reduce to 320 px first, print JSON
  linestereo eval frames/qvga --on mps2-an500           on an emulated Cortex-M7
  linestereo eval frames/qvga --objects                 depth of the objects in objects.png and objects.json

Words:
  segprec@1/@2   % of segments whose median error is at most 1 / 2 px
  bad1/bad2      % of points more than 1 / 2 px off the truth
  vis, allGT     points whose true match is visible in the right image; all points with truth
  cells          % of 16x16 cells (those at least half visible truth) that hold a claim
  median, rms    error of visible points in px
  ms             time per pair on one thread, median of several runs
  Minstr         millions of instructions per pair on a board (--on); QEMU counts no cycles
  wrong          (--objects) an answer more than 1 px outside of the object's 5-95 % range of true disparities
  covered        (--objects) objects with an answer
  median error   (--objects) |answer - true median| / true median
  overlap        (--objects) pixels common with the truth / pixels of either, as told and as refined
  in 1, 2 sigma  (--objects) answers within one and two stated standard deviations of the true median

Scenes that the confidence model was fitted on flatter it: fit-confidence scores each of them by a
model that has not seen it.";

/// Score the core on every folder with a scene.json and ground truth.
///
/// Parameters are the defaults for every scene; only the disparity range and the rig come from its scene.json.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Folders to search for scene.json, at any depth.
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Write the scores as JSON to FILE, or to stdout in place of the tables with "-".
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Reduce images to this width by area averaging; truth, range and rig follow.
    #[arg(long, value_name = "PX")]
    width: Option<u16>,
    /// Search disparities 0 .. N in every scene, whatever its scene.json says.
    #[arg(long, value_name = "N")]
    max_disparity: Option<u16>,
    /// Match on this board, emulated by QEMU: mps2-an500 or mps2-an386. Scenes that it cannot hold are left out.
    #[arg(long, value_name = "BOARD")]
    on: Option<String>,
    /// Score the depth of objects in place of points and segments: masks as given, 2 px too large, eroded by 2 px, and drawn boxes.
    #[arg(long, conflicts_with = "on")]
    objects: bool,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    perturbation: PerturbationArgs,
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
    /// Swap left and right: every true disparity is then negative, and the honest answer is next to nothing.
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
    let mut folders = Vec::new();
    for root in &args.folders {
        folders.extend(find_scenes(root)?.into_iter().map(|folder| (root, folder)));
    }
    if args.objects {
        let scenes = scenes_with_truth(&folders, args)?;
        return super::eval_objects::run(&scenes, &args.method, &perturbation, args.json.as_deref());
    }
    let machine = args.on.as_deref().map(|name| Machine::new(board::named(name)?)).transpose()?;
    let progress = progress_bar(folders.len());
    let mut scores = Vec::new();
    let (mut too_large, mut advice) = (Vec::new(), None);
    for (root, folder) in &folders {
        progress.set_message(folder.strip_prefix(root).unwrap_or(folder).display().to_string());
        if crate::frames::has_truth(folder)? {
            let scene = load(root, folder, args)?;
            match &machine {
                Some(machine) if !machine.board().fits(scene.left.dims) => {
                    too_large.push(format!("{} ({})", scene.name, scene.left.dims));
                    advice = Some(does_not_fit(machine.board(), scene.left.dims));
                }
                Some(machine) => scores.push(score_on(machine, &scene, &args.method, &perturbation)?),
                None => scores.push(score(&scene, &args.method, &perturbation)?),
            }
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    if let Some(advice) = advice.filter(|_| scores.is_empty()) {
        bail!("{}: {advice}", too_large.join(", "));
    }
    if scores.is_empty() {
        bail!("no folder with a scene.json and ground truth below {}; see --help", list(&args.folders));
    }
    write_results(args, &scores, folders.len() - scores.len() - too_large.len(), &too_large)
}

/// The scene as it is to be matched.
fn load(root: &Path, folder: &Path, args: &Args) -> Result<Scene> {
    let mut scene = load_scene(folder, args.width)?;
    // Sets hold scenes of the same name: the path below the given folder tells them apart.
    let below_root = folder.strip_prefix(root).unwrap_or(folder).display().to_string();
    if !below_root.is_empty() {
        scene.name = below_root;
    }
    scene.max_disparity = args.max_disparity.unwrap_or(scene.max_disparity);
    Ok(scene)
}

fn scenes_with_truth(folders: &[(&PathBuf, PathBuf)], args: &Args) -> Result<Vec<Scene>> {
    let mut scenes = Vec::new();
    for (root, folder) in folders {
        if crate::frames::has_truth(folder)? {
            scenes.push(load(root, folder, args)?);
        }
    }
    Ok(scenes)
}

/// Runs one scene several times for its time and scores its result.
fn score(scene: &Scene, method: &MethodArgs, perturbation: &Perturbation) -> Result<FrameScore> {
    let name = || scene.folder.display().to_string();
    let truth = scene.truth.as_ref().with_context(|| format!("{} has no truth", name()))?;
    let (left, right) = perturbation.apply(&scene.left, &scene.right);
    check_usable(&scene.folder.join("left"), &left)?;
    check_usable(&scene.folder.join("right"), &right)?;
    let mut engine = engine_with(&method.params(scene.max_disparity, scene.rig)?, left.dims).with_context(name)?;
    let milliseconds = time(&mut engine, &left, &right)?;
    let result = engine.run(left.view()?, right.view()?)?;
    let truth = if perturbation.swap { &truth.swapped() } else { truth };
    let mut score = FrameScore::new(&scene.name, truth, &result);
    score.milliseconds = Some(milliseconds);
    Ok(score)
}

/// Runs one scene on a board and scores its result.
fn score_on(machine: &Machine, scene: &Scene, method: &MethodArgs, perturbation: &Perturbation) -> Result<FrameScore> {
    let name = || scene.folder.display().to_string();
    let truth = scene.truth.as_ref().with_context(|| format!("{} has no truth", name()))?;
    let (left, right) = perturbation.apply(&scene.left, &scene.right);
    check_usable(&scene.folder.join("left"), &left)?;
    check_usable(&scene.folder.join("right"), &right)?;
    let params = method.params(scene.max_disparity, scene.rig)?;
    engine_with(&params, left.dims).with_context(name)?; // says what is wrong in terms of options
    let update = board::update(&params, scene.rig_numbers);
    let pair = machine.run_pairs(&update, &[(&left, &right)]).with_context(name)?.pairs.pop();
    let found = pair.with_context(name)?.map_err(|why| anyhow!("{}: {why}", name()))?;
    let truth = if perturbation.swap { &truth.swapped() } else { truth };
    let mut score = FrameScore::new(&scene.name, truth, &found.result);
    score.instructions = Some(found.costs.iter().sum());
    Ok(score)
}

/// Median time of a run in milliseconds.
fn time(engine: &mut Engine, left: &GrayImage, right: &GrayImage) -> Result<f64> {
    let (left, right) = (left.view()?, right.view()?);
    let begin = Instant::now();
    let mut times = Vec::new();
    while times.is_empty() || (times.len() < TIMING_RUNS && begin.elapsed() < TIMING_BUDGET) {
        let start = Instant::now();
        engine.run_in_place(left, right)?;
        times.push(start.elapsed());
    }
    times.sort();
    Ok(1e3 * times[times.len() / 2].as_secs_f64())
}

fn write_results(args: &Args, scores: &[FrameScore], without_truth: usize, too_large: &[String]) -> Result<()> {
    let pooled = Summary::pool(scores);
    let to_stdout = args.json.as_deref() == Some(Path::new("-"));
    let mut text = format!("{}\n{}", scene_table(scores), report(&pooled));
    if without_truth > 0 {
        text.push_str(&format!("\n{without_truth} folders without ground truth were left out\n"));
    }
    if !too_large.is_empty() {
        let (count, list) = (too_large.len(), too_large.join(", "));
        text.push_str(&format!("\n{count} scenes do not fit the board and were left out: {list}\n"));
    }
    if args.perturbation.swap {
        text.push_str("\nthe images were swapped: every true disparity is negative, so every claim above is wrong\n");
    }
    if let Some(path) = &args.json {
        let scenes = scores
            .iter()
            .map(|score| JsonScene { scene: score.name.clone(), summary: Summary::pool([score]) })
            .collect();
        let mut json = serde_json::to_string_pretty(&JsonReport { pooled, scenes })?;
        json.push('\n');
        if to_stdout {
            return print(&json);
        }
        let mut output = OutputFiles::new();
        output.add(path, json.as_bytes())?;
        output.commit()?;
    }
    print(&text)
}

/// On stderr, and only when that is a terminal.
fn progress_bar(length: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}");
    ProgressBar::new(length as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

fn list(folders: &[PathBuf]) -> String {
    folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(", ")
}
