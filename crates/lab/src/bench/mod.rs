//! `linestereo-lab bench`: every data set of a folder, scored beside OpenCV.
//!
//! ```text
//! data_set           which sets there are, by what their folders hold
//! product, opencv    what is claimed of a pair: by the core here, by OpenCV in Python
//! cells, seen, classes, reliability, objects, sectors   one metric each
//! scoring            a set in one state of its images: all metrics, scene by scene
//! figures, against   tables, JSON, and what changed since the last run
//! ```

mod against;
mod cells;
mod classes;
pub(crate) use cells::Cells;
pub(crate) use classes::GLOSSY;
mod data_set;
mod figures;
pub(crate) use figures::number;
mod grid;
mod objects;
mod opencv;
mod product;
mod reliability;
mod scoring;
mod sectors;
mod seen;

use crate::opencv::OpenCv;
use anyhow::{Context, Result, bail};
use core::num::NonZero;
use core::sync::atomic::{AtomicUsize, Ordering};
use data_set::{DataSet, Known, SceneFolder};
use figures::{Group, Report, SetReport};
use indicatif::ProgressBar;
use linestereo_frames::untrusted;
use linestereo_sim::commands::pairs::bar;
use linestereo_sim::output::{OutputFiles, OutputPath, is_quiet, print, tell};
use opencv::Worker;
use scoring::{DAMAGES, Scores, Task};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread::{self, ScopedJoinHandle};
use std::time::Instant;

const EXAMPLES: &str = "\
Examples:
  linestereo-lab bench ../shared/frames
      every set, in a table, and what changed since the last run
  linestereo-lab bench ../shared/frames --only robot_world --full
      one set, every figure
  linestereo-lab bench ../shared/frames --json before.json
  linestereo-lab bench ../shared/frames --against before.json
      before and after a change of the method

Metrics:
  one hypothesis per cell   the most probable point of each 16x16 cell; the surest N % of all cells are judged.
                            SGBM's confidence is the largest uniqueness ratio that a pixel survives.
  seen, seen by class       cells with an answer of at least 90 %, and how many of these are wrong;
                            of SGBM and StereoBM with uniqueness 15 the median of a cell
  objects                   the depth of each object of mask_objects.png
  obstacles by direction    sectors of 5 degrees, by the truth and the camera's height, pitch and roll
  said against right        points by their probability: what was said, and the share within 1 px

A set is a folder whose subfolders are scenes: left.png, right.png, gt.png and a scene.json with \"ground_truth\".
With labels.png and visible.png they are rendered rooms; small sets of others are scored with noise, blur and an
exposure mismatch too. OpenCV and the noise need a Python with opencv-python-headless and numpy.";

/// Score every data set of a folder, beside OpenCV's SGBM and StereoBM.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Folder that holds data sets.
    frames: PathBuf,
    /// Score this set alone, or those below this folder.
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Print every figure.
    #[arg(long)]
    full: bool,
    /// Write every figure as JSON; "-" is stdout.
    #[arg(long, value_name = "FILE")]
    json: Option<OutputPath>,
    /// Say what changed since this run, written by --json [default: the last run].
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    /// Folder for the last run, and for what OpenCV found in pairs that it was given before.
    #[arg(long, value_name = "FOLDER", default_value = "target/lab")]
    store: PathBuf,
    /// Have OpenCV match every pair again.
    #[arg(long)]
    no_cache: bool,
    /// Score linestereo alone; of the last run the sets with scores of OpenCV stay.
    #[arg(long)]
    no_opencv: bool,
    /// Python with OpenCV and NumPy [default: $LINESTEREO_PYTHON, else python3].
    #[arg(long, value_name = "PROGRAM", conflicts_with = "no_opencv")]
    python: Option<PathBuf>,
    /// Sets that are scored at the same time [default: one per core].
    #[arg(long, value_name = "N")]
    jobs: Option<NonZero<usize>>,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<()> {
    let begin = Instant::now();
    let last = args.store.join("last.json");
    let stored = if last.is_file() { Some(read_report(&last)?) } else { None };
    let before = args.against.as_deref().map(read_report).transpose()?.or_else(|| stored.clone());
    let mut sets = data_set::find(&args.frames)?;
    if let Some(only) = args.only.as_deref().map(|only| only.trim_end_matches('/')) {
        let names: Vec<String> = sets.iter().map(|set| set.name.clone()).collect();
        sets.retain(|set| Path::new(&set.name).starts_with(only));
        if sets.is_empty() {
            bail!("there is no set {only}; {} holds {}", args.frames.display(), names.join(", "));
        }
    }
    let opencv = find_opencv(args)?;
    if let (Some(stored), Some(version)) = (&stored, opencv.as_ref().map(|opencv| opencv.version()))
        && let Some(other) = against::of_other_version(stored, version, |name| {
            sets.iter().any(|set| set.name == name)
        })
    {
        bail!(
            "{other} was scored with another OpenCV than {version}; score all sets, or choose \
             another --store"
        );
    }
    let tasks = tasks(&sets, opencv.is_some());
    let scored = score(&tasks, opencv.as_ref(), args)?;
    let pairs: usize = scored.iter().map(|done| done.scenes).sum();
    let report = Report {
        opencv: opencv.as_ref().map(|opencv| opencv.version().to_owned()),
        sets: sets.iter().map(|set| set_report(set, &tasks, &scored)).collect(),
    };

    let mut text = report.table(args.full);
    text.extend(before.map(|before| against::changes(&before, &report)));
    let mut output = OutputFiles::new();
    output.add_json(args.json.as_ref(), &report)?;
    let stored = serde_json::to_string_pretty(&against::merged(stored, report))? + "\n";
    fs::create_dir_all(&args.store).with_context(|| {
        format!("cannot make the folder {}; choose another one by --store", args.store.display())
    })?;
    output.add(&last, stored.as_bytes())?;
    output.commit()?;
    if !args.json.as_ref().is_some_and(OutputPath::is_stdout) {
        print(&text)?;
    }
    if !is_quiet() {
        tell(&format!("{pairs} pairs in {:.0} s", begin.elapsed().as_secs_f64()));
    }
    Ok(())
}

/// Result of a task.
#[derive(Debug)]
struct Done {
    scenes: usize,
    groups: Vec<Group>,
    notes: Vec<String>,
}

fn read_report(path: &Path) -> Result<Report> {
    let advice =
        || format!("{} is no run of this program; delete it, or give another file", path.display());
    let text = untrusted::read(path, untrusted::RESULT_BYTES)
        .with_context(|| format!("cannot read {}; check the path", path.display()))?;
    serde_json::from_slice(&text).with_context(advice)
}

/// OpenCV, unless nobody wants it; where none was named, it may be missing.
fn find_opencv(args: &Args) -> Result<Option<OpenCv>> {
    if args.no_opencv {
        return Ok(None);
    }
    match OpenCv::find(args.python.as_deref()) {
        Ok(opencv) => Ok(Some(opencv)),
        Err(error) if args.python.is_some() => Err(error),
        Err(error) => {
            tell(&format!("linestereo alone is scored, and no damaged images: {error}"));
            Ok(None)
        }
    }
}

/// The slowest first, so that none is left over at the end.
fn tasks(sets: &[DataSet], has_opencv: bool) -> Vec<Task<'_>> {
    let mut tasks = Vec::new();
    for set in sets {
        let all = has_opencv && set.is_damaged_too();
        let damages = if all { &DAMAGES[..] } else { &DAMAGES[..1] };
        tasks.extend(damages.iter().map(|&damage| Task { set, damage }));
    }
    tasks.sort_by_cached_key(|task| core::cmp::Reverse(task.cost()));
    tasks
}

/// The results of all tasks, in their order.
fn score(tasks: &[Task<'_>], opencv: Option<&OpenCv>, args: &Args) -> Result<Vec<Done>> {
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let jobs = args.jobs.map_or(cores, NonZero::get).min(tasks.len());
    let cache = (!args.no_cache).then(|| args.store.join("opencv"));
    let cache = cache.as_deref().map(std::path::absolute).transpose()?;
    let pairs: usize = tasks.iter().map(|task| task.set.scenes.len()).sum();
    let progress = bar(pairs, "{bar:30} {pos} of {len} pairs, {msg}, {eta} left");
    let next = AtomicUsize::new(0);
    let work = || -> Result<Vec<(usize, Done)>> {
        let mut worker = opencv.map(Worker::start).transpose()?;
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(task) = tasks.get(index) else { return Ok(done) };
            progress.set_message(format!("{} ({})", task.set.name, task.damage));
            let scored = score_task(task, worker.as_mut(), cache.as_deref(), &progress)
                .with_context(|| format!("{} is not scored", task.set.name))?;
            done.push((index, scored));
        }
    };
    let done: Vec<Vec<(usize, Done)>> = thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        let join = |thread: ScopedJoinHandle<'_, _>| {
            thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        };
        threads.into_iter().map(join).collect::<Result<_>>()
    })?;
    progress.finish_and_clear();
    let done: BTreeMap<usize, Done> = done.into_iter().flatten().collect();
    Ok(done.into_values().collect())
}

fn score_task(
    task: &Task<'_>,
    mut worker: Option<&mut Worker>,
    cache: Option<&Path>,
    progress: &ProgressBar,
) -> Result<Done> {
    let (mut scenes, mut notes) = (Vec::<(&SceneFolder, Known)>::new(), Vec::new());
    let left_out =
        |scene: &SceneFolder, why: &anyhow::Error| format!("{} is left out: {why:#}", scene.name());
    for scene in &task.set.scenes {
        match scene.known() {
            Ok(known) => scenes.push((scene, known)),
            Err(error) => notes.push(left_out(scene, &error)),
        }
    }
    if let Some(worker) = &mut worker {
        worker.ask(&task.request(&scenes, cache))?;
    }
    let mut scores = Scores::default();
    for (scene, known) in &scenes {
        let answer = worker.as_mut().map(|worker| worker.answer()).transpose()?;
        if let Err(error) = scores.add(task, scene, known, answer.as_ref()) {
            notes.push(left_out(scene, &error));
        }
        progress.inc(1);
    }
    Ok(Done { scenes: scores.scenes(), groups: scores.groups(task), notes })
}

/// Figures of a set in all states of its images.
fn set_report(set: &DataSet, tasks: &[Task<'_>], scored: &[Done]) -> SetReport {
    let of_set = |damage: &str| {
        let mut all = tasks.iter().zip(scored);
        all.find(|(task, _)| task.set.name == set.name && task.damage == damage)
            .map(|(_, done)| done)
    };
    let done: Vec<&Done> = DAMAGES.iter().filter_map(|damage| of_set(damage)).collect();
    SetReport {
        name: set.name.clone(),
        scenes: done.first().map_or(0, |done| done.scenes),
        notes: done.iter().flat_map(|done| done.notes.iter().cloned()).collect(),
        groups: done.iter().flat_map(|done| done.groups.iter().cloned()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Two scenes of a set of captured frames, by linestereo alone.
    fn first_two(set: &str) -> (DataSet, Done) {
        let beside = || PathBuf::from("../../../shared/frames");
        let frames = std::env::var_os("LINESTEREO_FRAMES").map_or_else(beside, PathBuf::from);
        let mut set =
            data_set::find(&frames).unwrap().into_iter().find(|found| found.name == set).unwrap();
        set.scenes.truncate(2);
        let task = Task { set: &set, damage: DAMAGES[0] };
        let done = score_task(&task, None, None, &ProgressBar::hidden()).unwrap();
        (set, done)
    }

    fn value(done: &Done, group: &str, figure: &str) -> f64 {
        let group = done.groups.iter().find(|found| found.name.starts_with(group)).unwrap();
        let figure = group.figures.iter().find(|found| found.name == figure).unwrap();
        assert_eq!((figure.values.sgbm, figure.values.bm), (None, None), "OpenCV was not asked");
        figure.values.linestereo.unwrap()
    }

    #[test]
    #[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
    fn real_scenes_are_scored() {
        let (set, done) = first_two("qvga");
        assert_eq!((done.scenes, done.notes.len()), (2, 0));
        let (mut cells, mut all) = (0, 0);
        for scene in &set.scenes {
            let Known { pair, max_disparity, .. } = scene.known().unwrap();
            let points = pair.points(max_disparity).unwrap();
            cells += points
                .iter()
                .map(|point| (point.x / 16, point.y / 16))
                .collect::<HashSet<_>>()
                .len();
            all += pair.left.width().div_ceil(16) * pair.left.height().div_ceil(16);
        }
        let covered = value(&done, "one hypothesis per", "cells with a hypothesis, %");
        assert_eq!(covered, 100.0 * cells as f64 / all as f64);
        assert!(
            value(&done, "one hypothesis per", "first 50 % of all cells: off by > 1 px, %") < 5.0
        );
        assert!(value(&done, "seen", "answered, %") > 50.0);
        assert!(value(&done, "said against right", "mean |said - right|, %") < 10.0);
    }

    #[test]
    #[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
    fn rendered_rooms_are_scored_by_class() {
        let (set, done) = first_two("robot_world");
        assert!(set.is_rooms && done.notes.is_empty());
        let names: Vec<&str> =
            done.groups.iter().filter_map(|group| group.name.split([':', ' ']).next()).collect();
        assert_eq!(names, ["one", "seen", "objects", "obstacles", "said"]);
        assert!(value(&done, "seen by class", "floor: cells") > 500.0);
        assert!(value(&done, "obstacles", "sectors with an obstacle") > 10.0);
    }
}
