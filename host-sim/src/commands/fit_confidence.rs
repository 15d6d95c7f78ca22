//! `linestereo fit-confidence`: the confidence model's constants from frames with truth.

use super::batch::collect;
use super::method::MethodArgs;
use super::{engine_with, print};
use crate::evaluate::{FrameScore, Summary, report, scene_table};
use crate::fitting::{EvidenceLog, SceneSamples, fit, scene_samples, source_text};
use crate::frames::Scene;
use crate::output::OutputFiles;
use anyhow::{Context, Result, bail};
use indicatif::{ProgressBar, ProgressStyle};
use linestereo::Models;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  linestereo fit-confidence frames/qvga --out core/src/confidence/fitted.rs    write the constants that the core uses
  linestereo fit-confidence frames/qvga --check core/src/confidence/fitted.rs  fail if they are not what the frames give
  linestereo fit-confidence frames/qvga                                        only print the leave-one-scene-out scores
  linestereo fit-confidence frames/qvga --min-confidence 0.5                   the same with the less probable claims";

/// Fit the confidence model on frames with truth, and score it on scenes that it has not seen.
///
/// Every scene is scored by a model fitted on the other scenes (\"leave one out\"): the tables say what to expect of new scenes. The constants
/// written are fitted on all of them, and depend on the frames alone.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Folders to search for scenes with truth, at any depth.
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Write the constants as Rust source.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Compare the constants with this file and fail when they differ.
    #[arg(long, value_name = "FILE", conflicts_with = "out")]
    check: Option<PathBuf>,
    /// Do not score: only fit.
    #[arg(long)]
    no_scores: bool,
    #[command(flatten)]
    method: MethodArgs,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let scenes = load(&args.folders)?;
    let samples = scenes.iter().map(|scene| sample(scene, &args.method)).collect::<Result<Vec<_>>>()?;
    if !args.no_scores {
        leave_one_out(&scenes, &samples, &args.method)?;
    }
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    let text = source_text(
        &fit(&samples.iter().collect::<Vec<_>>()),
        &format!("{} scenes ({})", names.len(), names.join(", ")),
    );
    if let Some(path) = &args.check {
        let there = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        if there != text {
            bail!("{} is not what these frames give; write it again with --out", path.display());
        }
        print(&format!("{} is what these frames give\n", path.display()))?;
    }
    if let Some(path) = &args.out {
        let mut files = OutputFiles::default();
        files.add(path, text.as_bytes())?;
        files.commit()?;
        print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}

fn load(folders: &[PathBuf]) -> Result<Vec<Scene>> {
    let pairs = collect(folders, true)?.pairs;
    if pairs.len() < 2 {
        bail!("one scene with truth alone: none can be left out; give more");
    }
    Ok(pairs.iter().map(|pair| pair.load(None)).collect::<Result<_, _>>()?)
}

/// The claims of one scene, whatever their confidence.
fn sample(scene: &Scene, method: &MethodArgs) -> Result<SceneSamples> {
    let truth = scene.truth.as_ref().context("a scene without truth")?;
    let mut engine = engine_with(&method.params(scene.max_disparity, scene.rig)?, scene.left.dims)?;
    let mut log = EvidenceLog::default();
    engine.run_observed(scene.left.view()?, scene.right.view()?, &mut log)?;
    Ok(scene_samples(engine.candidates(), &log, truth, scene.left.dims))
}

/// Scores every scene by models that were fitted without it.
fn leave_one_out(scenes: &[Scene], samples: &[SceneSamples], method: &MethodArgs) -> Result<()> {
    let bar = ProgressBar::new(scenes.len() as u64);
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos}/{len} leaving out {msg}")?);
    let mut scores = Vec::new();
    for (i, scene) in scenes.iter().enumerate() {
        bar.set_message(scene.name.clone());
        let others: Vec<&SceneSamples> = samples.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, s)| s).collect();
        scores.push(score(scene, &fit(&others), method)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    print(&format!(
        "Leave one scene out: each scene by a model fitted on the others\n\n{}\n{}\n",
        scene_table(&scores),
        report(&Summary::pool(&scores))
    ))
}

fn score(scene: &Scene, models: &Models, method: &MethodArgs) -> Result<FrameScore> {
    let truth = scene.truth.as_ref().context("a scene without truth")?;
    let mut engine =
        engine_with(&method.params(scene.max_disparity, scene.rig)?, scene.left.dims)?.with_models(*models);
    let result = engine.run(scene.left.view()?, scene.right.view()?)?;
    Ok(FrameScore::new(&scene.name, truth, &result))
}
