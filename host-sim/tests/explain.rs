//! Explanations agree with the core: its curves, its tests, its results.

use crate::support::{POLE_DIMS, all_refused, pole, tells, with_pole, with_scene};
use linestereo::unstable::{CurveKind, Observer, Segment, SegmentCurves, SegmentKind, StageEvent};
use linestereo::{Dims, Params};
use linestereo_sim::engine::Engine;
use linestereo_sim::explain::{Account, CurveLog, Explanation};
use linestereo_sim::scene::{self, Kind, Rendering};
use linestereo_tests::drawn::rendered;

const DIMS: Dims = Dims { width: 320, height: 240 };

fn room() -> (Rendering, Params) {
    let rig = scene::build(Kind::Demo, DIMS, 1).pair.rig().unwrap();
    let rendering = rendered(Kind::Demo, DIMS, 1.0, 1);
    let max_disparity = rendering.search_range();
    (rendering, Params { max_disparity, rig: Some(rig), ..Params::default() })
}

/// Uniqueness ratios of near-vertical segments, Q8: by the curves that an observer is shown, and as
/// the core's evidence has it.
#[derive(Default)]
struct Ratios {
    by_curves: Option<i32>,
    compared: Vec<(i32, i32)>,
}

fn ratio_q8(costs: &[u16]) -> i32 {
    let (best, cost) = costs.iter().enumerate().min_by_key(|(_, cost)| **cost).unwrap();
    let second = costs
        .iter()
        .enumerate()
        .filter(|(at, _)| at.abs_diff(best) > 2)
        .map(|(_, cost)| *cost)
        .min()
        .unwrap();
    (((i32::from(*cost) + 1) << 8) / (i32::from(second) + 1)).min(768)
}

impl Observer for Ratios {
    fn on_event(&mut self, step: StageEvent<'_>) {
        if let StageEvent::Segment(Ok((candidate, evidence))) = step
            && !candidate.segment.near_horizontal
        {
            // A side without a hypothesis has no evidence.
            let of_core = evidence
                .iter()
                .map(|side| side.0[SegmentKind::WindowRatio as usize])
                .max()
                .unwrap();
            self.compared.push((self.by_curves.unwrap(), of_core.into()));
        }
    }

    fn wants_curves(&self) -> bool {
        true
    }

    fn segment_curves(&mut self, curves: &SegmentCurves<'_>) {
        let of = |kind| curves.of(kind).map(|(_, costs)| costs.to_vec());
        let sum = |a: Vec<u16>, b: Vec<u16>| -> Vec<u16> {
            a.into_iter().zip(b).map(|(a, b)| a + b).collect()
        };
        let side = |side| {
            Some(sum(
                of(CurveKind::Window { side, half: 0 })?,
                of(CurveKind::Window { side, half: 1 })?,
            ))
        };
        let whole = || {
            let edge = sum(of(CurveKind::Edge { half: 0 })?, of(CurveKind::Edge { half: 1 })?);
            let lower: Vec<u16> =
                side(0)?.into_iter().zip(side(1)?).map(|(l, r)| l.min(r)).collect();
            Some(sum(lower, edge))
        };
        self.by_curves = whole().map(|costs| ratio_q8(&costs));
    }
}

#[test]
fn curves_are_those_that_the_tests_look_at() {
    let (rendering, params) = room();
    let views = || (rendering.left.view().unwrap(), rendering.right.view().unwrap());
    let mut engine = Engine::new(&params, DIMS).unwrap();
    let mut ratios = Ratios::default();
    let (left, right) = views();
    let watched = engine.run_observed(left, right, &mut ratios).unwrap();
    assert!(ratios.compared.len() > 50);
    assert!(ratios.compared.iter().all(|(shown, used)| shown == used), "{:?}", ratios.compared);
    let alone = engine.run(left, right).unwrap();
    assert_eq!(
        (watched.matches, watched.points),
        (alone.matches, alone.points),
        "nobody's looking changes anything"
    );
}

/// Middles of all segments of a pair, and what was found.
#[derive(Default)]
struct Detected(Vec<Segment>);

impl Observer for Detected {
    fn on_event(&mut self, step: StageEvent<'_>) {
        if let StageEvent::Selection(_, segments) = step {
            self.0 = segments.to_vec();
        }
    }
}

fn failed(account: &Account) -> Vec<&'static str> {
    account.steps.iter().filter(|step| step.passed == Some(false)).map(|step| step.name).collect()
}

#[test]
fn what_is_accepted_passed_and_what_is_rejected_failed_at_its_last_test() {
    let (rendering, params) = room();
    let (left, right) = (rendering.left.view().unwrap(), rendering.right.view().unwrap());
    let mut engine = Engine::new(&params, DIMS).unwrap();
    let (mut detected, mut log) = (Detected::default(), CurveLog::default());
    engine.run_observed(left, right, &mut detected).unwrap();
    let result = engine.run_observed(left, right, &mut log).unwrap();
    let (mut accepted, mut by_test, mut near_vertical) = (0, 0, 0);
    for segment in &detected.0 {
        let middle = |a: linestereo::units::Position, b: linestereo::units::Position| {
            (0.5 * (a.to_num::<f64>() + b.to_num::<f64>())) as u16
        };
        let [a, b] = segment.ends;
        let pixel = (middle(a.x, b.x), middle(a.y, b.y));
        let explanation = Explanation::new(pixel, &log, &mut engine, &params, &result);
        let (ends, account) = explanation.segment.expect("it lies on it");
        let is_listed = result.matches.iter().any(|found| {
            let listed = found.ends.map(|end| [end.x.to_num::<f64>(), end.y.to_num::<f64>()]);
            listed == ends || [listed[1], listed[0]] == ends
        });
        assert_eq!(account.accepted, is_listed, "{account}");
        let tests = ["window", "census", "agreement", "halves", "owner", "repetition"];
        let failed: Vec<&str> =
            failed(&account).into_iter().filter(|name| tests.contains(name)).collect();
        if account.subject.contains("near-vertical") {
            near_vertical += 1;
            let is_test = account
                .steps
                .last()
                .is_some_and(|step| step.passed == Some(false) && tests.contains(&step.name));
            by_test += usize::from(is_test);
            assert!(failed.len() <= usize::from(is_test), "only the last one fails: {account}");
        }
        accepted += usize::from(account.accepted);
        assert!(
            !account.verdict.is_empty() && (!account.accepted || !account.plots.is_empty()),
            "{account}"
        );
    }
    assert!(
        accepted > 80 && by_test > 10 && near_vertical > 60,
        "{accepted} {by_test} {near_vertical}"
    );
}

#[test]
fn support_points_are_explained_as_they_are() {
    let (rendering, params) = room();
    let (left, right) = (rendering.left.view().unwrap(), rendering.right.view().unwrap());
    let mut engine = Engine::new(&params, DIMS).unwrap();
    let mut log = CurveLog::default();
    let result = engine.run_observed(left, right, &mut log).unwrap();
    let credible: Vec<(u16, u16)> =
        engine.matched().support_points().map(|point| (point.x, point.y)).collect();
    let mut verdicts = std::collections::BTreeMap::<String, u32>::new();
    for y in (4..DIMS.height).step_by(8) {
        for x in (4..DIMS.width).step_by(8) {
            let (pixel, account) =
                Explanation::new((x, y), &log, &mut engine, &params, &result).support.unwrap();
            // A point stands where its texture is.
            assert!(pixel.0.abs_diff(x) <= 8 && pixel.1.abs_diff(y) <= 8, "{pixel:?}");
            assert_eq!(account.accepted, credible.contains(&pixel), "{account}");
            assert_eq!(
                account.accepted,
                account.steps.len() > 3 && failed(&account).is_empty(),
                "{account}"
            );
            let kind = account.verdict.split([':', ',']).next_back().unwrap_or_default().to_owned();
            *verdicts
                .entry(if account.accepted { "accepted".into() } else { kind })
                .or_default() += 1;
        }
    }
    assert!(verdicts.len() >= 4 && verdicts["accepted"] > 500, "{verdicts:?}");
}

/// Texts of `explain` on bars at these pixels of a pair, and the number of its bars.
fn of_bars(
    columns: i32,
    disparity: i32,
    seed: u64,
    pixels: &[(u16, u16)],
) -> (Vec<Option<Account>>, usize) {
    let (params, [left, right]) = (Params::default(), pole(columns, disparity, seed));
    let mut engine = Engine::new(&params, POLE_DIMS).unwrap();
    let mut log = CurveLog::default();
    let result =
        engine.run_observed(left.view().unwrap(), right.view().unwrap(), &mut log).unwrap();
    let middles = result.bars.iter().map(|bar| {
        let [first, last] = bar.rows();
        let y = first.midpoint(last);
        (bar.columns(y).start, y)
    });
    let pixels: Vec<(u16, u16)> = pixels.iter().copied().chain(middles).collect();
    let mut of = |&pixel| {
        let explanation = Explanation::new(pixel, &log, &mut engine, &params, &result);
        explanation.bar.map(|(_, account)| account)
    };
    (pixels.iter().map(&mut of).collect(), result.bars.len())
}

#[test]
fn bars_are_told_with_their_evidence() {
    let above: Vec<(u16, u16)> = (0..320).step_by(8).map(|x| (x, 15)).collect();
    let (accounts, bars) = of_bars(5, 24, 2, &[&above[..], &[(147, 120)]].concat());
    let (above, told) = accounts.split_at(above.len());
    assert!(above.iter().any(Option::is_none), "each column has a bar within 4 px");
    assert!(bars > 0 && told.len() == bars + 1);
    for account in told {
        let account = account.as_ref().unwrap();
        assert!(account.accepted && failed(account).is_empty(), "{account}");
        assert!(account.subject.starts_with("bar, left edge (1"), "{account}");
        let disparity: f64 = account.verdict.split(' ').next().unwrap().parse().unwrap();
        assert!((disparity - 24.0).abs() <= 1.0, "{account}");
        let names: Vec<&str> = account.steps.iter().map(|step| step.name).collect();
        assert_eq!(names.last(), Some(&"probability"), "{account}");
        assert!(names.contains(&"in front") || names[0] == "continued", "{account}");
    }
}

#[test]
fn a_print_is_said_to_be_level_with_its_wall() {
    let (accounts, bars) = of_bars(6, 8, 6, &[(152, 120)]);
    let account = accounts[0].as_ref().unwrap();
    assert_eq!((bars, account.accepted), (0, false));
    assert!(failed(account).contains(&"in front"), "{account}");
    assert!(account.verdict.starts_with("level with what is around it"), "{account}");
}

#[test]
fn words_and_picture_of_a_bar() {
    let folder = with_pole();
    let line = "explain rec/1/left.png rec/1/right.png 152,120 --picture why.png --focal-px 300 \
                --baseline-m 0.1";
    let words = [
        "bar, left edge (1", "second-best (cost ", "in front          passed",
        "lies on one at 24.", " m\n",
    ];
    tells(folder.path(), line, &words);
    let picture = image::open(folder.path().join("why.png")).unwrap().to_rgb8();
    let outline = picture.pixels().filter(|pixel| pixel.0 == [200, 130, 255]).count();
    assert!(outline > 500, "{outline}");
}

#[test]
fn words_and_picture() {
    let folder = with_scene("demo", "320x240", "demo");
    let pair = "explain demo/left.png demo/right.png";
    let scene = "--scene demo/scene.json";
    let words = [
        "near-horizontal", "window", "census", "second-best", "support point at",
        "left-right check", "wrote why.png",
    ];
    tells(folder.path(), &format!("{pair} 60,60 --picture why.png {scene}"), &words);
    assert!(image::open(folder.path().join("why.png")).unwrap().width() > 1000);
    // Reduced images: the pixel is that of the images as given.
    let reduced = format!("{pair} 60,60 --width 160 {scene}");
    tells(folder.path(), &reduced, &["pixel 60,60 is 30,30 of the images as matched"]);
    let cases: [(&str, &str); 2] = [
        (&format!("{pair} 320,10"), "outside of the left image"),
        (&format!("{pair} 12"), "give a column and a row"),
    ];
    all_refused(folder.path(), &cases);
}
