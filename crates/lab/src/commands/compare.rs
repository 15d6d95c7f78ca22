//! `linestereo-lab compare`: the core and OpenCV's dense methods on the same frames.

use super::batch::collect;
use crate::opencv::OpenCv;
use crate::rivals::{
    MethodSummary, cell_comparison, compare_scene, comparison_table, object_comparison, summarise,
    time_scene,
};
use anyhow::{Context, Result, bail};
use core::num::NonZeroUsize;
use linestereo_calibration::rectify_raw;
use linestereo_frames::{Scene, StoredPair, check_usable};
use linestereo_sim::commands::method::MethodArgs;
use linestereo_sim::commands::pairs::{for_each_pair, timed_bar};
use linestereo_sim::commands::{asked_for, engine_with};
use linestereo_sim::engine::Engine;
use linestereo_sim::output::{OutputFiles, OutputPath, spare};
use serde::Serialize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  linestereo-lab compare frames/qvga --opencv                   with OpenCV's StereoBM and StereoSGBM
  linestereo-lab compare frames/full --width 320 --opencv --json -

Methods:
  linestereo                         the core: answers of p >= 0.9
  opencv-bm, opencv-bm-strict        StereoBM, window 15x15; strict: uniqueness 90, texture 3000
  opencv-sgbm, opencv-sgbm-strict    StereoSGBM along 5 paths; strict: uniqueness 80
  opencv-sgbm8, opencv-sgbm8-strict  the same along 8 paths; strict: uniqueness 95

Columns:
  points, cells    answers a frame; % of 16x16 cells (those at least half visible truth) with one
  vis, allGT       % of answers more than 1 / 2 px off: visible ones; all with truth
  top N            allGT of the N most confident answers a frame; OpenCV tells no confidence
  ms               median time of a pair on one thread, with nothing else running";

/// Match the same frames by the core and by OpenCV: scores and times side by side.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Folders to search for pairs, at any depth and in any layout.
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Add OpenCV's StereoBM and StereoSGBM, where a Python with OpenCV is installed.
    #[arg(long)]
    opencv: bool,
    /// The Python that has OpenCV [default: $LINESTEREO_PYTHON, else python3].
    #[arg(long, value_name = "PROGRAM", requires = "opencv")]
    python: Option<PathBuf>,
    /// Write the scores as JSON to FILE, or to stdout in place of the tables with "-".
    #[arg(long, value_name = "FILE")]
    json: Option<OutputPath>,
    /// Reduce images to this width by area averaging; truth, range and rig follow.
    #[arg(long, value_name = "PX")]
    width: Option<u16>,
    /// Search disparities 0 .. N [default: the data set's].
    #[arg(long, value_name = "N")]
    max_disparity: Option<u16>,
    /// Leave the times out. They are measured one pair after the other, when all others are done,
    /// and differ from run to run.
    #[arg(long)]
    no_times: bool,
    /// Use so many threads [default: all cores].
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    #[command(flatten)]
    method: MethodArgs,
}

#[derive(Serialize)]
struct JsonReport {
    frames: usize,
    methods: Vec<MethodSummary>,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<()> {
    let mut notes = Vec::new();
    let opencv = args.opencv(&mut notes)?;
    // Without any truth there are still yields and times.
    let found = collect(&args.folders, false)?;
    spare(asked_for([&args.json]), found.pairs.iter().flat_map(StoredPair::files))?;
    notes.splice(..0, found.notes);
    let pairs: Vec<(usize, StoredPair)> = found.pairs.into_iter().enumerate().collect();
    let name = |(_, pair): &(usize, StoredPair)| pair.name.clone();
    // A pair that cannot be loaded costs itself alone.
    let outcomes =
        for_each_pair(&pairs, args.threads.map(NonZeroUsize::get), name, |(place, pair)| {
            let scene = match args.load(pair) {
                Ok(scene) => scene,
                Err(error) => return Ok(Err(error.context(pair.name.clone()))),
            };
            let methods = compare_scene(&scene, opencv.as_ref(), |scene| args.engine(scene))?;
            Ok(Ok((*place, methods)))
        })?;
    let (mut compared, mut left_out) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        outcome.map_or_else(|error| left_out.push(error), |found| compared.push(found));
    }
    if let Some(first) = left_out.first() {
        if compared.is_empty() {
            bail!("no pair can be compared; {first:#}");
        }
        notes.push(format!("{} pairs were left out, the first: {first:#}", left_out.len()));
    }
    if !args.no_times {
        let progress = timed_bar(compared.len());
        for (place, methods) in &mut compared {
            let Some((_, pair)) = pairs.get(*place) else { continue };
            progress.set_message(format!("timing {}", pair.name));
            let scene = args.load(pair)?;
            let times = time_scene(&scene, opencv.as_ref(), |scene| args.engine(scene))?;
            for (score, milliseconds) in methods.iter_mut().zip(times) {
                score.score.milliseconds = Some(milliseconds);
            }
            progress.inc(1);
        }
        progress.finish_and_clear();
    }
    let methods = summarise(compared.iter().map(|(_, methods)| methods.as_slice()));
    args.write(compared.len(), methods, &notes)
}

impl Args {
    /// OpenCV if it is asked for; what is to be said of it joins the notes.
    fn opencv(&self, notes: &mut Vec<String>) -> Result<Option<OpenCv>> {
        if !self.opencv {
            return Ok(None);
        }
        match OpenCv::find(self.python.as_deref()) {
            Ok(opencv) => {
                notes.push(format!("OpenCV {}", opencv.version()));
                Ok(Some(opencv))
            }
            Err(error) => {
                notes.push(format!("without OpenCV: {error}"));
                Ok(None)
            }
        }
    }

    fn engine(&self, scene: &Scene) -> Result<Engine> {
        engine_with(&self.method.params(scene.max_disparity, scene.rig)?, scene.left.dims)
            .map(Engine::answering_unfit)
            .with_context(|| scene.name.clone())
    }

    /// The scene as it is to be matched.
    fn load(&self, pair: &StoredPair) -> Result<Scene> {
        let mut scene = pair.load(self.width, &rectify_raw)?;
        check_usable(&scene.folder.join("left"), &scene.left)?;
        check_usable(&scene.folder.join("right"), &scene.right)?;
        let (range, dims) = (self.max_disparity.unwrap_or(scene.max_disparity), scene.left.dims);
        if range == 0 || range >= dims.width {
            bail!(
                "a disparity range of {range} does not fit an image of {dims}; change \
                 --max-disparity"
            );
        }
        scene.max_disparity = range;
        Ok(scene)
    }

    fn write(&self, frames: usize, methods: Vec<MethodSummary>, notes: &[String]) -> Result<()> {
        let mut text = format!(
            "{frames} {}\n\n{}",
            if frames == 1 { "pair" } else { "pairs" },
            comparison_table(&methods)
        );
        text.push('\n');
        text.push_str(&cell_comparison(&methods));
        let objects = object_comparison(&methods);
        if !objects.is_empty() {
            text.push_str(&format!("\n{objects}"));
        }
        for note in notes {
            text.push_str(&format!("\n{note}\n"));
        }
        let mut output = OutputFiles::new();
        output.add_json(self.json.as_ref(), &JsonReport { frames, methods })?;
        output.commit_and_say(&text)
    }
}
