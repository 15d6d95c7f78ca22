//! Accuracy on captured frames with ground truth: what the project promises, held on every run that has the frames.
//!
//! They are not part of the project: `LINESTEREO_FRAMES`, or `../shared/frames` beside it. Without them these tests say so and pass.
//! The bounds are the promises of the README with room for other machines' frames, not the figures reached.

use linestereo::{Models, Params};
use linestereo_sim::engine::Engine;
use linestereo_sim::evaluate::{FrameScore, Summary};
use linestereo_sim::fitting::{EvidenceLog, SceneSamples, fit, scene_samples, source_text};
use linestereo_sim::frames::{Perturbation, Scene};
use linestereo_tests::captured;
use std::path::PathBuf;

fn engine(scene: &Scene) -> Engine {
    let params = Params { max_disparity: scene.max_disparity, rig: scene.rig, ..Params::default() };
    Engine::new(&params, scene.left.dims).unwrap()
}

fn score(scene: &Scene, models: Option<&Models>, perturbation: &Perturbation) -> FrameScore {
    let (left, right) = perturbation.apply(&scene.left, &scene.right);
    let mut engine = engine(scene);
    if let Some(models) = models {
        engine = engine.with_models(*models);
    }
    let result = engine.run(left.view().unwrap(), right.view().unwrap()).unwrap();
    FrameScore::new(&scene.name, scene.truth.as_ref().unwrap(), &result)
}

fn pooled(scenes: &[Scene], perturbation: &Perturbation) -> Summary {
    Summary::pool(&scenes.iter().map(|scene| score(scene, None, perturbation)).collect::<Vec<_>>())
}

fn samples(scenes: &[Scene]) -> Vec<SceneSamples> {
    let sample = |scene: &Scene| {
        let mut engine = engine(scene);
        let mut log = EvidenceLog::default();
        engine.run_observed(scene.left.view().unwrap(), scene.right.view().unwrap(), &mut log).unwrap();
        scene_samples(engine.candidates(), &log, scene.truth.as_ref().unwrap(), scene.left.dims)
    };
    scenes.iter().map(sample).collect()
}

#[test]
fn scenes_that_the_model_has_not_seen() {
    let Some(scenes) = captured::qvga() else { return };
    let samples = samples(&scenes);
    let scores: Vec<FrameScore> = (0..scenes.len())
        .map(|held| {
            let others: Vec<_> = samples.iter().enumerate().filter(|(i, _)| *i != held).map(|(_, s)| s).collect();
            score(&scenes[held], Some(&fit(&others)), &Perturbation::default())
        })
        .collect();
    let summary = Summary::pool(&scores);
    assert!(summary.segments_per_frame >= 150.0, "{summary:?}");
    assert!(summary.segprec1 >= Some(98.0) && summary.segprec2 >= Some(99.0), "{summary:?}");
    for (row, (bad1, bad2)) in summary.curve.iter().zip([(0.3, 0.1), (0.5, 0.2), (0.8, 0.3), (1.2, 0.5)]) {
        assert!(row.errors.all_gt_bad1 <= Some(bad1) && row.errors.all_gt_bad2 <= Some(bad2), "{row:?}");
    }
    assert!(summary.sure.cells_percent >= Some(75.0), "{:?}", summary.sure);
    assert!(summary.sure.errors.all_gt_bad2 <= Some(1.2), "{:?}", summary.sure);
    for bin in summary.calibration.iter().filter(|bin| bin.points >= 1000) {
        assert!((bin.said.unwrap() - bin.observed.unwrap()).abs() <= 0.02, "{bin:?}");
    }
}

#[test]
fn the_committed_model_is_what_the_frames_give() {
    let Some(scenes) = captured::qvga() else { return };
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    if names.len() != 14 {
        eprintln!("SKIPPED: the model was fitted on 14 scenes, here are {}", names.len());
        return;
    }
    let origin = format!("{} scenes ({})", names.len(), names.join(", "));
    let text = source_text(&fit(&samples(&scenes).iter().collect::<Vec<_>>()), &origin);
    let committed = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../core/src/confidence/fitted.rs");
    assert_eq!(text, std::fs::read_to_string(committed).unwrap());
}

#[test]
fn rows_exposure_and_noise() {
    let Some(scenes) = captured::qvga() else { return };
    let clean = pooled(&scenes, &Perturbation::default());
    let moved = pooled(&scenes, &Perturbation { row_offset: 1.0, ..Perturbation::default() });
    assert!(moved.segprec1.unwrap() >= clean.segprec1.unwrap() - 1.0, "{moved:?}");
    let darker = pooled(&scenes, &Perturbation { gain: 0.8, bias: 8.0, ..Perturbation::default() });
    assert!(darker.curve[1].errors.vis_bad1 <= clean.curve[1].errors.vis_bad1.map(|bad| bad + 0.3), "{darker:?}");
    let noisy = pooled(&scenes, &Perturbation { noise: 5.0, ..Perturbation::default() });
    assert!(noisy.curve[0].errors.vis_bad2 <= clean.curve[0].errors.vis_bad2.map(|bad| bad + 0.3), "{noisy:?}");
}
