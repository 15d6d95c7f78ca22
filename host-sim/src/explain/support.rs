//! A support point: the window's own costs, the sum of the paths, its neighbours, its probability.

use super::curve::{Curve, Mark, Plot, words};
use super::log::CurveLog;
use super::{Account, Step};
use linestereo::results::{Support, SupportPoint};
use linestereo::{Params, unstable::SUPPORT_PITCH};

/// Largest difference between the disparities of neighbours that agree, px.
const AGREES: f64 = 1.5;

/// Index of the point next to a pixel.
pub(super) fn nearest((x, y): (u16, u16), points: &Support<'_>) -> Option<usize> {
    let away = |(px, py): (u16, u16)| {
        (i32::from(px) - i32::from(x)).pow(2) + (i32::from(py) - i32::from(y)).pow(2)
    };
    points
        .iter()
        .map(|(pixel, _)| away(pixel))
        .enumerate()
        .min_by_key(|&(_, away)| away)
        .map(|(index, _)| index)
}

/// Pixel of the point, and the reasons for its disparity, or for the lack of it.
pub(super) fn account(
    index: usize,
    log: &CurveLog,
    points: &Support<'_>,
    params: &Params,
) -> ((u16, u16), Account) {
    let list: Vec<((u16, u16), &SupportPoint)> = points.iter().collect();
    let (pixel, point) = list[index];
    let mut account = Account {
        subject: format!("support point at {},{}", pixel.0, pixel.1),
        steps: Vec::new(),
        accepted: point.is_matched() && point.confidence() >= params.min_confidence,
        verdict: String::new(),
        plots: Vec::new(),
    };
    let Some(costs) = log.support.get(&index) else {
        account.verdict = "too close to the border to compare enough disparities".to_owned();
        return (pixel, account);
    };
    let beside_ground = points.plane().filter(|_| point.is_beside_ground());
    let failed = if let Some(plane) = beside_ground {
        let at = f64::from(plane.at_q6(pixel.0.into(), pixel.1.into())) / 64.0;
        let range = "up to 7 px beside the ground plane, as well as all disparities";
        let plane = format!("{at:.2} px: the window was moved along it row by row");
        account.steps.push(Step::note("search", range));
        account.steps.push(Step::note("ground plane", plane));
        ""
    } else {
        add_tests(
            (&costs.window, &costs.paths),
            (point.is_matched(), point.repeats()),
            params,
            &mut account,
        )
    };
    let plot = |title, name, curve: &Curve| Plot::new(title, vec![(name, curve.clone())]);
    account.plots = vec![
        plot("support point: window alone, before aggregation", "window", &costs.window),
        plot("support point: sum of the paths, after aggregation", "paths", &costs.paths),
    ];
    if !point.is_matched() {
        account.verdict = failed.to_owned();
        return (pixel, account);
    }
    let disparity: f64 = point.disparity().to_num();
    let mark = Mark { name: "answer", at: disparity };
    account.plots.iter_mut().for_each(|plot| plot.marks.push(mark.clone()));
    account.steps.push(neighbours(pixel, disparity, &list));
    let (p, least) = (point.confidence().to_num::<f64>(), params.min_confidence.to_num::<f64>());
    let words = format!("{p:.3}, asked for {least:.2}");
    account.steps.push(Step::test("probability", account.accepted, words));
    account.verdict = format!("{disparity:.2} px, p {p:.3}");
    if !account.accepted {
        account.verdict += ": not probable enough; it only guides the search of segments";
    }
    (pixel, account)
}

/// The tests of its costs; returns the words for the one that failed, if it has no disparity.
fn add_tests(
    (window, paths): (&Curve, &Curve),
    (is_matched, repeats): (bool, bool),
    params: &Params,
    account: &mut Account,
) -> &'static str {
    let (Some((best, second)), Some(window_best)) =
        (paths.best_and_second(), window.best_and_second())
    else {
        return "too few disparities to compare";
    };
    let range = format!("disparities {} to {} px", paths.first, paths.last());
    account.steps.push(Step::note("search", range));
    account.steps.push(Step::note("window", words(window, window_best.0, window_best.1)));
    let is_last = best.at == i32::from(params.max_disparity) - 1;
    let is_unique = is_matched || is_last || repeats;
    account.steps.push(Step::test("paths", is_unique && !is_last, words(paths, best, second)));
    if is_last {
        return "its best is the largest disparity of the range: the true one may lie beyond; search more";
    }
    if !is_unique {
        return "two disparities fit nearly as well after aggregation: no texture, or one that repeats";
    }
    let here = window.near(best.at, 0).map_or(0, |low| low.cost);
    let elsewhere = window.second(best.at).map_or(0, |low| low.cost);
    let text = format!("at {} px the window costs {here}, elsewhere at least {elsewhere}", best.at);
    account.steps.push(Step::test("no repetition", is_matched, text));
    "the pattern repeats: it fits at another disparity as well, or at another place of the left \
     image where the border cuts off disparities"
}

fn neighbours((x, y): (u16, u16), disparity: f64, list: &[((u16, u16), &SupportPoint)]) -> Step {
    // Columns are twice as far apart where the range is wide.
    let pitch = list.get(1).map_or(SUPPORT_PITCH, |((second, _), _)| second.abs_diff(list[0].0.0));
    let near = list
        .iter()
        .filter(|((px, py), _)| px.abs_diff(x) <= pitch && py.abs_diff(y) <= SUPPORT_PITCH);
    let near: Vec<f64> = near
        .filter(|(pixel, point)| *pixel != (x, y) && point.is_matched())
        .map(|(_, point)| point.disparity().to_num::<f64>() - disparity)
        .collect();
    let agree = near.iter().filter(|gap| gap.abs() <= AGREES).count();
    let farther = near.iter().filter(|gap| **gap < -AGREES).count();
    let nearer = near.len() - agree - farther;
    let words = format!("{agree} points agree, {farther} are farther, {nearer} are nearer");
    Step::note("support around it", words)
}
