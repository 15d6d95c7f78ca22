//! `linestereo-lab eval --objects`: depth per object against ground truth.

use crate::evaluate::{
    ObjectScore, ObjectSummary, Outline, object_cases, object_table, score_objects,
};
use crate::fitting::{EvidenceLog, SceneSamples, fit, scene_samples};
use anyhow::{Context, Result, bail};
use linestereo_frames::{Perturbation, Scene, StoredPair, check_usable};
use linestereo_sim::commands::engine_with;
use linestereo_sim::commands::method::MethodArgs;
use linestereo_sim::commands::pairs::for_each_pair;
use linestereo_sim::engine::Engine;
use linestereo_sim::output::{OutputFiles, OutputPath};
use serde::Serialize;

#[derive(Serialize)]
struct JsonReport {
    /// With the models of the core.
    fitted: Vec<ObjectSummary>,
    /// Every scene by models fitted on the others; nothing with a single scene.
    leave_one_out: Option<Vec<ObjectSummary>>,
}

/// Prints the table with the core's models, and leave one scene out; scenes are loaded anew for it.
pub(crate) fn run(
    pairs: &[StoredPair],
    threads: Option<usize>,
    load: impl Fn(&StoredPair) -> Result<Scene> + Sync,
    method: &MethodArgs,
    perturbation: &Perturbation,
    json: Option<&OutputPath>,
) -> Result<()> {
    let name = |pair: &StoredPair| pair.name.clone();
    let watched = for_each_pair(pairs, threads, name, |pair| {
        let scene = load(pair)?;
        let mut watched = Watched::new(&scene, method, perturbation)?;
        let scores = score_objects(&mut watched.engine, &object_cases(&scene)?);
        Ok((scores, watched.samples(&scene)?))
    })?;
    let (fitted, samples): (Vec<_>, Vec<_>) = watched.into_iter().unzip();
    let fitted = fitted.concat();
    if fitted.is_empty() {
        bail!(
            "no scene has objects; give folders with objects.png, or with objects.json and \
             mask_objects.png"
        );
    }
    let places: Vec<usize> = (0..pairs.len()).collect();
    let unseen = for_each_pair(
        if pairs.len() > 1 { &places } else { &[] },
        threads,
        |&held| format!("leaving out {}", pairs[held].name),
        |&held| {
            let scene = load(&pairs[held])?;
            let others: Vec<_> =
                samples.iter().enumerate().filter(|(i, _)| *i != held).map(|(_, s)| s).collect();
            let mut engine = engine(&scene, method)?.with_models(fit(&others));
            run_pair(&mut engine, &scene, perturbation, &mut EvidenceLog::default())?;
            Ok(score_objects(&mut engine, &object_cases(&scene)?))
        },
    )?;
    write_results(&fitted, (pairs.len() > 1).then(|| unseen.concat()).as_deref(), json)
}

/// A pair that was run, with the evidence of its answers.
struct Watched {
    engine: Engine,
    log: EvidenceLog,
}

impl Watched {
    fn new(scene: &Scene, method: &MethodArgs, perturbation: &Perturbation) -> Result<Self> {
        let (mut engine, mut log) = (engine(scene, method)?, EvidenceLog::default());
        run_pair(&mut engine, scene, perturbation, &mut log)?;
        Ok(Self { engine, log })
    }

    fn samples(&mut self, scene: &Scene) -> Result<SceneSamples> {
        let truth = scene.truth.as_ref().context("a scene without truth")?;
        Ok(scene_samples(&scene.name, &mut self.engine, &self.log, truth))
    }
}

fn engine(scene: &Scene, method: &MethodArgs) -> Result<Engine> {
    engine_with(&method.params(scene.max_disparity, scene.rig)?, scene.left.dims)
        .map(Engine::answering_unfit)
        .with_context(|| scene.folder.display().to_string())
}

fn run_pair(
    engine: &mut Engine,
    scene: &Scene,
    perturbation: &Perturbation,
    log: &mut EvidenceLog,
) -> Result<()> {
    let (left, right) = perturbation.apply(&scene.left, &scene.right);
    check_usable(&scene.folder.join("left"), &left)?;
    check_usable(&scene.folder.join("right"), &right)?;
    engine.run_observed(left.view()?, right.view()?, log)?;
    Ok(())
}

fn write_results(
    fitted: &[ObjectScore],
    unseen: Option<&[ObjectScore]>,
    json: Option<&OutputPath>,
) -> Result<()> {
    let mut text = format!("Objects, by the models of the core\n\n{}", object_table(fitted));
    if let Some(unseen) = unseen {
        text.push_str("\nLeave one scene out: each scene by models fitted on the others\n\n");
        text.push_str(&object_table(unseen));
    }
    let pool = |scores: &[ObjectScore]| {
        let all = Outline::ALL.map(|outline| ObjectSummary::pool(outline, scores));
        all.into_iter().filter(|summary| summary.objects > 0).collect()
    };
    let report = JsonReport { fitted: pool(fitted), leave_one_out: unseen.map(pool) };
    let mut output = OutputFiles::new();
    output.add_json(json, &report)?;
    output.commit_and_say(&text)
}
