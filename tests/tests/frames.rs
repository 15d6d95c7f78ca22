//! Accuracy on captured frames with ground truth: what the project promises, held on every run that
//! has the frames.
//!
//! They are not part of the project: `LINESTEREO_FRAMES`, or `../shared/frames` beside it. Without
//! them these tests say so and pass. The bounds are the promises of the README with room for other
//! machines' frames, not the figures reached.

use linestereo::{Params, params::Parts, units::Confidence};
use linestereo_frames::{Perturbation, Scene};
use linestereo_lab::evaluate::{FrameScore, Summary};
use linestereo_sim::engine::{Engine, FittedModels};
use linestereo_tests::captured;

fn score(
    scene: &Scene,
    params: Params,
    models: Option<FittedModels>,
    perturbation: &Perturbation,
) -> FrameScore {
    let (left, right) = perturbation.apply(&scene.left, &scene.right);
    let params = Params { max_disparity: scene.max_disparity, rig: scene.rig, ..params };
    let mut engine = Engine::new(&params, scene.left.dims).unwrap();
    if let Some(models) = models {
        engine = engine.with_models(models);
    }
    let result = engine.run(left.view().unwrap(), right.view().unwrap()).unwrap();
    FrameScore::new(scene.truth.as_ref().unwrap(), &result)
}

fn left_out(scenes: &[Scene], params: Params) -> Summary {
    let models = captured::models_left_out(scenes);
    let score = |(scene, models): (&Scene, &FittedModels)| {
        score(scene, params, Some(*models), &Perturbation::NONE)
    };
    Summary::pool(&scenes.iter().zip(models).map(score).collect::<Vec<_>>())
}

fn pooled(scenes: &[Scene], perturbation: &Perturbation) -> Summary {
    Summary::pool(
        &scenes
            .iter()
            .map(|scene| score(scene, Params::default(), None, perturbation))
            .collect::<Vec<_>>(),
    )
}

#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn scenes_that_the_model_has_not_seen() {
    let Some(scenes) = captured::qvga() else { return };
    let summary = left_out(&scenes, Params::default());
    assert!(summary.segments_per_frame >= 90.0, "{summary:?}");
    assert!(summary.segprec1 >= Some(98.0) && summary.segprec2 >= Some(99.0), "{summary:?}");
    for (row, (bad1, bad2)) in
        summary.curve.iter().zip([(0.3, 0.1), (0.35, 0.1), (0.4, 0.12), (0.6, 0.25)])
    {
        assert!(
            row.errors.all_gt_bad1 <= Some(bad1) && row.errors.all_gt_bad2 <= Some(bad2),
            "{row:?}"
        );
    }
    assert!(summary.sure.cells_percent >= Some(80.0), "{:?}", summary.sure);
    assert!(summary.sure.errors.all_gt_bad2 <= Some(1.2), "{:?}", summary.sure);
    for bin in summary.calibration.iter().filter(|bin| bin.points >= 1000) {
        assert!((bin.stated.unwrap() - bin.observed.unwrap()).abs() <= 0.02, "{bin:?}");
    }
}

#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn one_claim_per_cell_of_scenes_that_the_models_have_not_seen() {
    let Some(scenes) = captured::qvga() else { return };
    let least = Params { min_confidence: Confidence::from_num(0.2), ..Params::default() };
    let summary = left_out(&scenes, least);
    let promised =
        [(50, 0.6, 0.25), (60, 0.9, 0.4), (70, 1.4, 0.6), (75, 2.0, 0.9), (80, 2.8, 1.6)];
    for (percent, bad1, bad2) in promised {
        let row = summary.cells.iter().find(|row| row.percent == percent).unwrap();
        assert!(row.bad1 <= Some(bad1) && row.bad2 <= Some(bad2) && row.bad1.is_some(), "{row:?}");
    }
    // Support points alone are worse.
    let support = left_out(&scenes, Params { parts: Parts::Support, ..least });
    let at = |summary: &Summary, percent: usize| {
        *summary.cells.iter().find(|row| row.percent == percent).unwrap()
    };
    assert!(at(&support, 80).bad1 > at(&summary, 80).bad1, "{:?}", at(&support, 80));
}

#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn rows_exposure_and_noise() {
    let Some(scenes) = captured::qvga() else { return };
    let clean = pooled(&scenes, &Perturbation::default());
    let moved = pooled(&scenes, &Perturbation { row_offset: 1.0, ..Perturbation::default() });
    assert!(moved.segprec1.unwrap() >= clean.segprec1.unwrap() - 1.0, "{moved:?}");
    let darker = pooled(&scenes, &Perturbation { gain: 0.8, bias: 8.0, ..Perturbation::default() });
    assert!(
        darker.curve[1].errors.vis_bad1 <= clean.curve[1].errors.vis_bad1.map(|bad| bad + 0.3),
        "{darker:?}"
    );
    let noisy = pooled(&scenes, &Perturbation { noise: 5.0, ..Perturbation::default() });
    assert!(
        noisy.curve[0].errors.vis_bad2 <= clean.curve[0].errors.vis_bad2.map(|bad| bad + 0.3),
        "{noisy:?}"
    );
}
