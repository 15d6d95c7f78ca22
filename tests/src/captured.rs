//! Captured frames with ground truth, which are not part of the project: `LINESTEREO_FRAMES`, or
//! `../shared/frames` beside it.

use linestereo::Params;
use linestereo_frames::{Scene, find_scenes, load_scene};
use linestereo_lab::fitting::{EvidenceLog, SceneSamples, fit, scene_samples};
use linestereo_sim::engine::{Engine, FittedModels};
use std::path::PathBuf;
use std::sync::OnceLock;

/// A folder of captured frames; without them the test that asks says so and passes.
pub fn folder(name: &str) -> Option<PathBuf> {
    let root = std::env::var_os("LINESTEREO_FRAMES").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/frames"),
        PathBuf::from,
    );
    let folder = root.join(name);
    if !folder.is_dir() {
        eprintln!(
            "SKIPPED: no captured frames; set LINESTEREO_FRAMES to a folder that holds {name}/"
        );
        return None;
    }
    Some(folder)
}

/// The scoring set: every scene of `qvga`.
///
/// # Panics
/// When one of them cannot be loaded.
pub fn qvga() -> Option<Vec<Scene>> {
    scenes("qvga")
}

/// Every scene of a set.
///
/// # Panics
/// When one of them cannot be loaded.
pub fn scenes(set: &str) -> Option<Vec<Scene>> {
    let load =
        |folder: &PathBuf| load_scene(folder, None).unwrap_or_else(|error| panic!("{error}"));
    let folders = find_scenes(&folder(set)?).unwrap_or_else(|error| panic!("{error}"));
    Some(folders.iter().map(load).collect())
}

/// The core with default parameters, as these scenes are scored.
///
/// # Panics
/// When a scene cannot be matched.
pub fn engine(scene: &Scene) -> Engine {
    Engine::new(&params(scene), scene.left.dims).unwrap()
}

/// Default parameters with the range and the rig of a scene.
pub fn params(scene: &Scene) -> Params {
    Params { max_disparity: scene.max_disparity, rig: scene.rig, ..Params::default() }
}

/// The scenes are left out a third at a time.
const FOLDS: usize = 3;

/// Models for each of the scenes of [`qvga`], fitted without it and a third of the others; made
/// once.
///
/// # Panics
/// When a scene cannot be matched.
pub fn models_left_out(scenes: &[Scene]) -> &'static [FittedModels] {
    static MODELS: OnceLock<Vec<FittedModels>> = OnceLock::new();
    MODELS.get_or_init(|| {
        let sample = |scene: &Scene| {
            let (mut engine, mut log) = (engine(scene), EvidenceLog::default());
            let [left, right] = [&scene.left, &scene.right].map(|image| image.view().unwrap());
            engine.run_observed(left, right, &mut log).unwrap();
            scene_samples(&scene.name, &mut engine, &log, scene.truth.as_ref().unwrap())
        };
        let samples: Vec<SceneSamples> = scenes.iter().map(sample).collect();
        let without = |fold: usize| -> Vec<&SceneSamples> {
            let is_left_out = |samples: &SceneSamples| {
                scenes.iter().skip(fold).step_by(FOLDS).any(|scene| samples.shows(&scene.name))
            };
            samples.iter().filter(|samples| !is_left_out(samples)).collect()
        };
        let models: Vec<FittedModels> = (0..FOLDS).map(|fold| fit(&without(fold))).collect();
        models.into_iter().cycle().take(scenes.len()).collect()
    })
}
