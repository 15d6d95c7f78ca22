//! `linestereo-lab faults`: damaged pairs, and what is answered of them.

use super::batch::collect;
use crate::evaluate::object_cases;
use crate::faults::{Damage, Family, FaultReport, Source, Tally, is_asked, score};
use anyhow::{Context, Result, bail};
use core::num::NonZeroUsize;
use linestereo::health::HealthFlags;
use linestereo_calibration::rectify_raw;
use linestereo_frames::{Scene, StoredPair};
use linestereo_sim::commands::engine_with;
use linestereo_sim::commands::method::MethodArgs;
use linestereo_sim::commands::pairs::for_each_pair;
use linestereo_sim::commands::{asked_for, written};
use linestereo_sim::output::{OutputFiles, OutputPath, spare};
use linestereo_sim::results::mask::Mask;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  linestereo-lab faults frames/qvga
      every damage on every pair with ground truth
  linestereo-lab faults frames/qvga --only 'column noise' --json faults.json
      damages whose name or family contains these words

Columns:
  refused     pairs that are not called healthy: nothing of them is answered
  answers     depths of objects (masks, drawn boxes) while the pair is called healthy
  wrong       answers more than 1 px outside of the object's own range of true disparities
  far off     wrong answers whose depth differs by more than 20 % from the true median
  points off  points more than 1 px off; stated: how many should be, by their own probabilities
  flags       flags of health, and on how many pairs each was raised";

/// Damage every pair with ground truth in about a hundred ways, and count what is answered wrongly
/// while the pair is called healthy.
///
/// Objects are those of objects.png or objects.json; scenes without them count by their points. The
/// same seed gives the same damages on every machine.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Folders to search for pairs with ground truth, at any depth and in any layout.
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Do damages alone whose name or family contains these words.
    #[arg(long, value_name = "WORDS")]
    only: Option<String>,
    /// Reduce images to this width by area averaging; truth, range and rig follow.
    #[arg(long, value_name = "PX")]
    width: Option<u16>,
    /// Seed of everything random.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write the table as JSON to FILE, or to stdout in place of it with "-".
    #[arg(long, value_name = "FILE")]
    json: Option<OutputPath>,
    /// Use so many threads [default: all cores].
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    #[command(flatten)]
    method: MethodArgs,
}

type Outcome = (Family, Damage, HealthFlags, Tally);

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<()> {
    let damages = damages(args)?;
    let found = collect(&args.folders, true)?;
    spare(asked_for([&args.json]), found.pairs.iter().flat_map(StoredPair::files))?;
    let places: Vec<usize> = (0..found.pairs.len()).collect();
    let threads = args.threads.map(NonZeroUsize::get);
    let name = |&place: &usize| found.pairs[place].name.clone();
    let outcomes = for_each_pair(&places, threads, name, |&place| {
        let scene = found.pairs[place].load(args.width, &rectify_raw)?;
        let other = found.pairs[(place + 1) % found.pairs.len()].load(args.width, &rectify_raw)?;
        damaged(args, &scene, &other, &damages)
    })?;
    let report = FaultReport::new(&outcomes.concat());
    let mut output = OutputFiles::new();
    output.add_json(args.json.as_ref(), &report)?;
    let files = written([&args.json]);
    output.commit_and_say(&format!("{}\n{}\n{files}", report.table(), found.notes.join("\n")))
}

fn damages(args: &Args) -> Result<Vec<(Family, Damage)>> {
    let mut damages = Damage::all();
    if let Some(words) = &args.only {
        damages.retain(|(family, damage)| {
            damage.to_string().contains(words) || family.name().contains(words)
        });
        if damages.is_empty() {
            bail!("no damage contains {words:?}; without --only the table names them all");
        }
    }
    Ok(damages)
}

/// All damages of one pair.
fn damaged(
    args: &Args,
    scene: &Scene,
    other: &Scene,
    damages: &[(Family, Damage)],
) -> Result<Vec<Outcome>> {
    let truth =
        scene.truth.as_ref().with_context(|| format!("{} has no truth", scene.folder.display()))?;
    let mut engine =
        engine_with(&args.method.params(scene.max_disparity, scene.rig)?, scene.left.dims)
            .with_context(|| scene.folder.display().to_string())?;
    let mut cases = object_cases(scene)?;
    cases.retain(is_asked);
    let mut objects = Mask::new(scene.left.dims, vec![false; scene.left.pixels.len()]);
    cases.iter().for_each(|case| objects.join(case.mask()));
    let other = [&other.left, &other.right];
    let source = Source { scene, other, objects: &objects, seed: args.seed };
    let mut outcomes = Vec::with_capacity(damages.len());
    for &(family, damage) in damages {
        let [left, right] = damage.apply(&source);
        let result = engine.run(left.view()?, right.view()?)?;
        let tally = score(&mut engine, &result, &cases, truth);
        outcomes.push((family, damage, result.health.of_pair(), tally));
    }
    Ok(outcomes)
}
