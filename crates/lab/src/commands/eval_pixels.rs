//! `linestereo-lab eval-pixels`: depth at random pixels against ground truth, and the constants of
//! its confidence model.

use super::batch::collect;
use crate::evaluate::{PixelScore, QueriedPixel, pixel_report, query_pixels};
use crate::fitting::{
    EvidenceLog, SceneSamples, fit, fit_pixels, pixel_source_text, scene_samples,
};
use anyhow::{Context, Result, bail};
use linestereo::unstable::FITTED_PIXEL;
use linestereo_calibration::rectify_raw;
use linestereo_frames::untrusted::{self, SETTINGS_BYTES};
use linestereo_frames::{Scene, StoredPair};
use linestereo_sim::commands::method::MethodArgs;
use linestereo_sim::commands::pairs::{bar, named_bar};
use linestereo_sim::commands::{asked_for, engine_with};
use linestereo_sim::engine::{Engine, FittedModels};
use linestereo_sim::output::{OutputFiles, OutputPath, say, spare};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  linestereo-lab eval-pixels frames/qvga                                    how many are answered, how many of them wrong
  linestereo-lab eval-pixels frames/full --width 320                        images reduced to 320 px first
  linestereo-lab eval-pixels frames/qvga --leave-one-out                    each scene by models fitted on the others
  linestereo-lab eval-pixels frames/qvga --out core/src/query/fitted.rs     write the constants that the core uses
  linestereo-lab eval-pixels frames/qvga --check core/src/query/fitted.rs   fail if they are not what the frames give

Words:
  visible      pixels whose true match is visible in the right image: so many % of them are answered
  hidden       the others with truth: whatever is answered for them is wrong more often than not
  bad1/bad2    % of answers more than 1 / 2 px off the truth; vis: of visible pixels, all: of both
  sigma        standard deviation as stated with the answer";

/// Ask for the depth of random pixels of every scene with ground truth.
///
/// Scenes that the confidence model was fitted on flatter it: --leave-one-out rates each by models
/// that have not seen it.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Folders to search for scenes with truth, at any depth.
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Visible pixels asked for in each scene.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    queries: u32,
    /// Seed of their choice.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Reduce images to this width by area averaging; truth, range and rig follow.
    #[arg(long, value_name = "PX")]
    width: Option<u16>,
    /// Rate every scene by models fitted on the other scenes.
    #[arg(long)]
    leave_one_out: bool,
    /// Fit the model on these pixels and write its constants as Rust source.
    #[arg(long, value_name = "FILE")]
    out: Option<OutputPath>,
    /// Compare the constants with this file and fail when they differ.
    #[arg(long, value_name = "FILE", conflicts_with = "out")]
    check: Option<PathBuf>,
    #[command(flatten)]
    method: MethodArgs,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let scenes = load(args)?;
    let bar = named_bar(scenes.len());
    let mut asked = Vec::new();
    for scene in &scenes {
        bar.set_message(scene.name.clone());
        asked.push(ask(args, scene, None)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let rated = scenes.iter().zip(&asked);
    let scores: Vec<_> = if args.leave_one_out {
        leave_one_out(args, &scenes, &asked)?
    } else {
        rated.map(|(scene, asked)| PixelScore::new(&scene.name, asked, &FITTED_PIXEL)).collect()
    };
    let least = args.method.params(scenes[0].max_disparity, None)?.min_confidence;
    let mut text = pixel_report(&scores, least);
    if args.leave_one_out {
        text.insert_str(0, "Leave one scene out: each scene by models fitted on the others\n\n");
    }
    write_constants(args, &scenes, &asked, text)
}

fn load(args: &Args) -> Result<Vec<Scene>> {
    let pairs = collect(&args.folders, true)?.pairs;
    spare(asked_for([&args.out]), pairs.iter().flat_map(StoredPair::files))?;
    if args.leave_one_out && pairs.len() < 2 {
        bail!("one scene with truth alone: none can be left out; give more");
    }
    Ok(pairs.iter().map(|pair| pair.load(args.width, &rectify_raw)).collect::<Result<_, _>>()?)
}

fn engine(args: &Args, scene: &Scene) -> Result<Engine> {
    engine_with(&args.method.params(scene.max_disparity, scene.rig)?, scene.left.dims)
        .map(Engine::answering_unfit)
        .with_context(|| scene.folder.display().to_string())
}

/// Matches a scene, by these models of segments if any, and asks for its pixels.
fn ask(args: &Args, scene: &Scene, models: Option<FittedModels>) -> Result<Vec<QueriedPixel>> {
    let truth = scene.truth.as_ref().context("a scene without truth")?;
    let mut engine = engine(args, scene)?;
    if let Some(models) = models {
        engine = engine.with_models(models);
    }
    let (left, right) = (scene.left.view()?, scene.right.view()?);
    engine.run(left, right)?;
    Ok(query_pixels(&mut engine, truth, (args.queries as usize, args.seed)))
}

/// Each scene by models of segments and of pixels that were fitted without it.
fn leave_one_out(
    args: &Args,
    scenes: &[Scene],
    asked: &[Vec<QueriedPixel>],
) -> Result<Vec<PixelScore>> {
    let samples = scenes.iter().map(|scene| sample(args, scene)).collect::<Result<Vec<_>>>()?;
    let bar = bar(scenes.len(), "{bar:30} {pos}/{len} leaving out {msg}");
    let mut scores = Vec::new();
    for (held, scene) in scenes.iter().enumerate() {
        bar.set_message(scene.name.clone());
        let others: Vec<&SceneSamples> = samples
            .iter()
            .enumerate()
            .filter(|(i, _)| *i != held)
            .map(|(_, samples)| samples)
            .collect();
        let pixels: Vec<&[QueriedPixel]> = asked
            .iter()
            .enumerate()
            .filter(|(i, _)| *i != held)
            .map(|(_, asked)| asked.as_slice())
            .collect();
        let asked = ask(args, scene, Some(fit(&others)))?;
        scores.push(PixelScore::new(&scene.name, &asked, &fit_pixels(&pixels)));
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(scores)
}

/// The answers of one scene, whatever their confidence.
fn sample(args: &Args, scene: &Scene) -> Result<SceneSamples> {
    let truth = scene.truth.as_ref().context("a scene without truth")?;
    let mut engine = engine(args, scene)?;
    let mut log = EvidenceLog::default();
    engine.run_observed(scene.left.view()?, scene.right.view()?, &mut log)?;
    Ok(scene_samples(&scene.name, &mut engine, &log, truth))
}

/// Prints the scores; the constants are written, or compared.
fn write_constants(
    args: &Args,
    scenes: &[Scene],
    asked: &[Vec<QueriedPixel>],
    mut scores: String,
) -> Result<()> {
    if args.out.is_none() && args.check.is_none() {
        return say(&scores);
    }
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    let origin =
        format!("{} pixels each of {} scenes ({})", args.queries, names.len(), names.join(", "));
    let pixels: Vec<&[QueriedPixel]> = asked.iter().map(Vec::as_slice).collect();
    let text = pixel_source_text(&fit_pixels(&pixels), &origin);
    if let Some(path) = &args.check {
        say(&scores)?;
        let there = untrusted::read_text(path, SETTINGS_BYTES)
            .with_context(|| format!("cannot read {}", path.display()))?;
        if there != text {
            bail!("{} is not what these frames give; write it again with --out", path.display());
        }
        return say(&format!("{} is what these frames give\n", path.display()));
    }
    let mut files = OutputFiles::default();
    files.add_made(args.out.as_ref(), || Ok(text))?;
    scores.push_str(&linestereo_sim::commands::written([&args.out]));
    files.commit_and_say(&scores)
}
