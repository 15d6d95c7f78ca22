//! `linestereo-lab fit-confidence`: the confidence model's constants from frames with truth.

use super::batch::collect;
use crate::bench::number;
use crate::evaluate::{
    FrameScore, PixelScore, QueriedPixel, Summary, calibration_table, cell_table, query_pixels,
};
use crate::fitting::{
    EvidenceLog, SceneSamples, add_ground_samples, fit, fit_pixels, pixel_source_text,
    scene_samples, source_text, support_source_text, without_gloss,
};
use anyhow::{Context, Result, bail};
use linestereo::{Params, units::Confidence};
use linestereo_calibration::rectify_raw;
use linestereo_frames::{Perturbation, Scene};
use linestereo_sim::commands::engine_with;
use linestereo_sim::commands::method::MethodArgs;
use linestereo_sim::commands::pairs::for_each_pair;
use linestereo_sim::engine::FittedModels;
use linestereo_sim::output::{OutputFiles, print, say};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  linestereo-lab fit-confidence frames/qvga --also frames/third --out core/src     write the constants that the core uses
  linestereo-lab fit-confidence frames/qvga                                        only print the leave-one-scene-out scores
  linestereo-lab fit-confidence frames/qvga --min-confidence 0.2                   the same with the less probable answers";

/// Widest pair that is damaged, px.
const WIDEST_DAMAGED: u16 = 450;
/// Files of constants below core/src.
const SEGMENTS: &str = "confidence/fitted.rs";
const SUPPORT: &str = "support/fitted.rs";
const PIXELS: &str = "query/fitted.rs";
/// Visible pixels of each scene whose depth is queried, and the seed of their choice.
const QUERIES: (usize, u64) = (2000, 1);

/// Fit the confidence models on frames with truth, and score them on scenes that they have not
/// seen.
///
/// Every scene is scored by models fitted on the other scenes ("leave one out"): the tables say
/// what to expect of new scenes. Models see every pair as it is and damaged: with noise, blurred,
/// darker on the right, with its rows off. The constants written are fitted on all scenes, and
/// depend on the frames alone. The model of single pixels is fitted on the first folders' pairs as
/// they are.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Folders to search for scenes with truth, at any depth.
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// More folders to fit on; what is in them is not scored, and not used where the same scene is
    /// scored at another size.
    #[arg(long, value_name = "FOLDER", num_args = 1..)]
    also: Vec<PathBuf>,
    /// Fit on pairs as they are, and score these alone.
    #[arg(long)]
    undamaged: bool,
    /// Write the constants as Rust source, below the folder core/src.
    #[arg(long, value_name = "CORE")]
    out: Option<PathBuf>,
    /// Do not score: only fit.
    #[arg(long)]
    no_scores: bool,
    #[command(flatten)]
    method: MethodArgs,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<()> {
    let scenes = load(&args.folders)?;
    let also = if args.also.is_empty() { Vec::new() } else { load(&args.also)? };
    let damages = if args.undamaged { &Perturbation::DAMAGES[..1] } else { &Perturbation::DAMAGES };
    let halves = halves_of(&[&args.folders[..], &args.also].concat())?;
    let all: Vec<&Scene> = scenes.iter().chain(&also).collect();
    let damaged = all.iter().map(|&scene| (scene, damages_of(scene, damages)));
    let damaged: Vec<_> =
        damaged.chain(halves.iter().map(|scene| (scene, &Perturbation::DAMAGES[..1]))).collect();
    let name = |(scene, _): &(&Scene, _)| scene.name.clone();
    let samples = for_each_pair(&damaged, None, name, |(scene, damages)| {
        let samples = damages.iter().map(|(_, damage)| sample(scene, damage, &args.method));
        samples.collect::<Result<Vec<_>>>()
    })?;
    let samples: Vec<SceneSamples> = samples.into_iter().flatten().collect();
    let name = |scene: &Scene| scene.name.clone();
    let queried = for_each_pair(&scenes, None, name, |scene| query(scene, &args.method))?;
    if !args.no_scores {
        leave_one_out(&scenes, damages, &samples, &args.method)?;
        leave_pixels_out(&queried, args.method.params(64, None)?.min_confidence)?;
    }
    write_constants(args, &all, damages.len(), &samples, &queried)
}

/// Random pixels of a scene, with what is found there.
fn query(scene: &Scene, method: &MethodArgs) -> Result<Vec<QueriedPixel>> {
    let truth = scene.truth.as_ref().context("a scene without truth")?;
    let params = method.params(scene.max_disparity, scene.rig)?;
    let mut engine = engine_with(&params, scene.left.dims)?.answering_unfit();
    engine.run(scene.left.view()?, scene.right.view()?)?;
    Ok(query_pixels(&mut engine, truth, QUERIES))
}

/// Scores the pixels of every scene by a model that was fitted without it.
fn leave_pixels_out(queried: &[Vec<QueriedPixel>], least: Confidence) -> Result<()> {
    let score = |(held, pixels): (usize, &Vec<QueriedPixel>)| {
        let others = queried.iter().enumerate().filter(|(i, _)| *i != held);
        let others: Vec<&[QueriedPixel]> = others.map(|(_, pixels)| pixels.as_slice()).collect();
        PixelScore::new(pixels, &fit_pixels(&others).model)
    };
    let scores: Vec<PixelScore> = queried.iter().enumerate().map(score).collect();
    let Some((answered, [bad1, bad2])) = PixelScore::pool(&scores).answered(least) else {
        return Ok(());
    };
    print(&format!(
        "Single pixels that are visible: {answered:.1} % answered with p >= {least:.2}, \
         bad1/bad2 {bad1:.2}/{bad2:.2}\n"
    ))
}

fn write_constants(
    args: &Args,
    scenes: &[&Scene],
    damages: usize,
    samples: &[SceneSamples],
    queried: &[Vec<QueriedPixel>],
) -> Result<()> {
    let Some(folder) = &args.out else { return Ok(()) };
    let fitted = fit(&samples.iter().collect::<Vec<_>>());
    let folders =
        args.folders.iter().chain(&args.also).filter_map(|folder| folder.file_name()?.to_str());
    let origin = format!(
        "{} pairs of {}, small ones under {damages} damages",
        scenes.len(),
        folders.collect::<Vec<_>>().join(", ")
    );
    let names: Vec<&str> =
        scenes.iter().take(queried.len()).map(|scene| scene.name.as_str()).collect();
    let of_pixels =
        format!("{} pixels each of {} scenes ({})", QUERIES.0, names.len(), names.join(", "));
    let pixels = fit_pixels(&queried.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let texts = [
        (folder.join(SEGMENTS), source_text(&fitted.segments, &origin)),
        (folder.join(SUPPORT), support_source_text(&fitted.support, &origin)),
        (folder.join(PIXELS), pixel_source_text(&pixels, &of_pixels)),
    ];
    let mut files = OutputFiles::default();
    for (path, text) in &texts {
        files.add(path, text.as_bytes())?;
    }
    files.commit()?;
    texts.iter().try_for_each(|(path, _)| say(&format!("wrote {}\n", path.display())))
}

fn load(folders: &[PathBuf]) -> Result<Vec<Scene>> {
    let pairs = collect(folders, true)?.pairs;
    if pairs.len() < 2 {
        bail!("one scene with truth alone: none can be left out; give more");
    }
    let scenes: Vec<Scene> =
        pairs.iter().map(|pair| pair.load(None, &rectify_raw)).collect::<Result<_, _>>()?;
    scenes.into_iter().map(without_gloss).collect()
}

/// Large captured pairs at half of their size, at which they are matched first.
fn halves_of(folders: &[PathBuf]) -> Result<Vec<Scene>> {
    let mut halves = Vec::new();
    for pair in collect(folders, true)?.pairs {
        let scene = pair.load(None, &rectify_raw)?;
        let width = scene.left.dims.width;
        if width > WIDEST_DAMAGED && !is_rendered(&scene) {
            halves.push(pair.load(Some(width / 2), &rectify_raw)?);
        }
    }
    Ok(halves)
}

/// Damages of a scene before it is sampled: small captured pairs are damaged, rendered rooms
/// have noise of their own, and large pairs show what small ones do.
fn damages_of<'d>(
    scene: &Scene,
    damages: &'d [(&'static str, Perturbation)],
) -> &'d [(&'static str, Perturbation)] {
    let is_damaged = scene.left.dims.width <= WIDEST_DAMAGED && !is_rendered(scene);
    if is_damaged { damages } else { damages.get(..1).unwrap_or(damages) }
}

fn is_rendered(scene: &Scene) -> bool {
    scene.folder.join("labels.png").is_file()
}

/// The answers of one scene, whatever their confidence.
fn sample(scene: &Scene, damage: &Perturbation, method: &MethodArgs) -> Result<SceneSamples> {
    let truth = scene.truth.as_ref().context("a scene without truth")?;
    let (left, right) = damage.apply(&scene.left, &scene.right);
    let run = |ground: bool| {
        let params = Params { ground, ..method.params(scene.max_disparity, scene.rig)? };
        let (mut engine, mut log) =
            (engine_with(&params, scene.left.dims)?.answering_unfit(), EvidenceLog::default());
        engine.run_observed(left.view()?, right.view()?, &mut log)?;
        anyhow::Ok((engine, log))
    };
    let (mut engine, log) = run(false)?;
    let mut samples = scene_samples(&scene.name, &mut engine, &log, truth);
    let (mut engine, log) = run(true)?;
    add_ground_samples(&mut samples, &mut engine, &log, truth);
    Ok(samples)
}

/// Scores every scene by models that were fitted without it.
fn leave_one_out(
    scenes: &[Scene],
    damages: &[(&str, Perturbation)],
    samples: &[SceneSamples],
    method: &MethodArgs,
) -> Result<()> {
    let name = |scene: &Scene| format!("leaving out {}", scene.name);
    let scores = for_each_pair(scenes, None, name, |scene| {
        let others: Vec<&SceneSamples> =
            samples.iter().filter(|samples| !samples.shows(&scene.name)).collect();
        let models = fit(&others);
        damages
            .iter()
            .map(|(_, damage)| score(scene, damage, models, method))
            .collect::<Result<Vec<_>>>()
    })?;
    let of_damage = |i: usize| scores.iter().map(move |scene| &scene[i]);
    let pooled: Vec<Summary> = (0..damages.len()).map(|i| Summary::pool(of_damage(i))).collect();
    let excess = pooled.iter().zip(damages).map(|(summary, (name, _))| {
        format!("{name:16} {:>8}\n", number(summary.overconfidence, 1))
    });
    print(&format!(
        "Leave one scene out: each scene by models fitted on the others\n\n{}\n{}\n{}{}\n",
        calibration_table(&pooled[0]),
        cell_table(damages.iter().map(|&(name, _)| name).zip(&pooled)),
        "largest excess of stated over observed probability, bins of 1000 answers and more, percent\n",
        excess.collect::<String>(),
    ))
}

fn score(
    scene: &Scene,
    damage: &Perturbation,
    models: FittedModels,
    method: &MethodArgs,
) -> Result<FrameScore> {
    let truth = scene.truth.as_ref().context("a scene without truth")?;
    let params = method.params(scene.max_disparity, scene.rig)?;
    let mut engine = engine_with(&params, scene.left.dims)?.answering_unfit().with_models(models);
    let (left, right) = damage.apply(&scene.left, &scene.right);
    let result = engine.run(left.view()?, right.view()?)?;
    Ok(FrameScore::new(truth, &result))
}
