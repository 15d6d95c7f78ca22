//! A bar: cost, halves, edges in the right image, repetition, support points, probability.

use super::log::{CurveLog, RatedBar};
use super::{Account, REACH, Step, metres};
use crate::engine::FrameResult;
use crate::results::health::is_fit;
use linestereo::unstable::{BarEvidence, BarKind, LEAST_BAR};
use linestereo::{Params, results::Bar, units::Confidence};

/// Largest costs that evidence holds, as shares of the bar's own gradients.
const LARGEST: f64 = 307.0 / 256.0;

/// Ends of the left edge, px.
fn left_edge(bar: &Bar) -> [[f64; 2]; 2] {
    bar.ends().map(|end| [end.x.to_num(), end.y.to_num()])
}

/// Corners in their order around it, px.
pub(super) fn corners(bar: &Bar) -> [[f64; 2]; 4] {
    let ([top, end], width) = (left_edge(bar), bar.width().to_num::<f64>());
    let right = |[x, y]: [f64; 2]| [x + width, y];
    [top, end, right(end), right(top)]
}

/// The bar next to a pixel, within [`REACH`], and how far it is away, px; those among the results
/// before others.
pub(super) fn nearest(
    (x, y): (u16, u16),
    log: &CurveLog,
    result: &FrameResult,
) -> Option<(Bar, f64)> {
    let others = log.bars.iter().map(|rated| rated.bar).filter(|bar| !result.bars.contains(bar));
    let all = result.bars.iter().map(|bar| (false, *bar)).chain(others.map(|bar| (true, bar)));
    let near = all.map(|(is_other, bar)| (is_other, distance(&bar, [x.into(), y.into()]), bar));
    let near = near.filter(|&(_, distance, _)| distance <= REACH);
    let rank = |&(is_other, distance, bar): &(bool, f64, Bar)| {
        (is_other, distance, Confidence::MAX - bar.confidence())
    };
    let nearest =
        near.min_by(|a, b| rank(a).partial_cmp(&rank(b)).unwrap_or(core::cmp::Ordering::Equal));
    nearest.map(|(_, distance, bar)| (bar, distance))
}

/// From the nearer edge along the row; 0 between the edges.
fn distance(bar: &Bar, [x, y]: [f64; 2]) -> f64 {
    let [[x0, y0], [x1, y1]] = left_edge(bar);
    let t = ((y - y0) / (y1 - y0).max(1.0)).clamp(0.0, 1.0);
    let left = x0 + t * (x1 - x0);
    let right = left + bar.width().to_num::<f64>();
    (left - x).max(x - right).max(0.0).hypot(y - y0 - t * (y1 - y0))
}

/// Reasons for a bar, or for the lack of it among the results.
pub(super) fn account(
    bar: &Bar,
    distance: f64,
    log: &CurveLog,
    params: &Params,
    result: &FrameResult,
) -> Account {
    let mut steps = Vec::new();
    match log.bars.iter().find(|rated| rated.bar == *bar) {
        Some(RatedBar { evidence, .. }) => add_evidence(bar, evidence, &mut steps),
        None => steps.push(Step::note("continued", continued(bar, log))),
    }
    let least = params.min_confidence.max(LEAST_BAR);
    let is_probable = bar.confidence() >= least;
    let (p, least) = (bar.confidence().to_num::<f64>(), least.to_num::<f64>());
    steps.push(Step::test("probability", is_probable, format!("{p:.3}, asked for {least:.2}")));
    let verdict = match (bar.is_in_front(), is_probable) {
        (true, true) if result.bars.contains(bar) => answer(bar, params),
        (true, true) if !is_fit(result.health) => {
            "it would be among the bars, but the pair is not fit to be used".to_owned()
        }
        (true, true) => "it is among the bars".to_owned(),
        (true, false) => "not probable enough for a bar".to_owned(),
        (false, true) => "level with what is around it: only masks that it fills by a third take \
                          its disparity"
            .to_owned(),
        (false, false) => "level with what is around it, and not probable enough".to_owned(),
    };
    Account {
        subject: subject(bar, distance),
        steps,
        accepted: bar.is_in_front() && is_probable,
        verdict,
        plots: Vec::new(),
    }
}

fn subject(bar: &Bar, distance: f64) -> String {
    let [[x0, y0], [x1, y1]] = left_edge(bar);
    format!(
        "bar, left edge ({x0:.1}, {y0:.1}) to ({x1:.1}, {y1:.1}), {:.1} px wide, {distance:.1} px \
         away",
        bar.width().to_num::<f64>()
    )
}

/// Disparity at its middle, px.
fn middle(bar: &Bar) -> f64 {
    bar.disparity().map(|d| d.to_num::<f64>()).iter().sum::<f64>() / 2.0
}

fn add_evidence(bar: &Bar, evidence: &BarEvidence, steps: &mut Vec<Step>) {
    let of = |kind: BarKind| f64::from(evidence.0[kind as usize]) / 256.0;
    let percent = |kind: BarKind| format!("{:.0} %", 100.0 * of(kind));
    let or_more = |cost: f64| if cost >= LARGEST { " or more" } else { "" };
    let (best, second, alike) = (of(BarKind::Cost), of(BarKind::Second), of(BarKind::Alike));
    let words = format!("{} disparities", count(evidence.0[BarKind::Range as usize]));
    steps.push(Step::note("search", words));
    let words = format!(
        "best {:.2} px (cost {best:.2} of the bar's own gradients), second-best (cost {second:.2}\
         {}): ratio {:.2}",
        middle(bar),
        or_more(second),
        best / second.max(1.0 / 256.0)
    );
    steps.push(Step::note("cost", words));
    let words = format!("upper and lower {:.2} px apart", of(BarKind::Slant));
    steps.push(Step::note("halves", words));
    let words = format!(
        "in the right image in {} of the rows (left), {} (right)",
        percent(BarKind::LeftEdge),
        percent(BarKind::RightEdge)
    );
    steps.push(Step::note("edges", words));
    let words =
        format!("the most similar place of the left image costs {alike:.2}{}", or_more(alike));
    steps.push(Step::note("no repetition", words));
    let has_support = of(BarKind::NoSupport) == 0.0;
    let words = if has_support {
        format!(
            "{} agree, {} are farther, {} are nearer",
            percent(BarKind::SupportAgrees),
            percent(BarKind::SupportBehind),
            percent(BarKind::SupportNearer)
        )
    } else {
        "no points".to_owned()
    };
    steps.push(Step::note("support around it", words));
    let words = match (bar.is_in_front(), has_support) {
        (true, true) => "the points beside it lie behind it",
        (true, false) => "no points are beside it",
        (false, _) => "points beside it agree with it, or are nearer",
    };
    steps.push(Step::test("in front", bar.is_in_front(), words));
}

/// The number whose log2(1 + number), Q8, is this: straight between powers of two, as in the core.
fn count(log2_q8: i16) -> u32 {
    let (whole, part) = (log2_q8.max(0) >> 8, f64::from(log2_q8.max(0) & 255) / 256.0);
    (f64::from(whole).exp2() * (1.0 + part) - 1.0).round() as u32
}

/// Why a bar without evidence of its own is one: it is the continuation of another.
fn continued(bar: &Bar, log: &CurveLog) -> String {
    let adjoins = |other: &&Bar| {
        let [[top, end], [other_top, other_end]] = [bar, other].map(Bar::ends);
        bar.width() == other.width() && (top == other_end || end == other_top)
    };
    let of = log.bars.iter().map(|rated| &rated.bar).find(adjoins);
    let of = of.map_or("a bar".to_owned(), |of| {
        let [first, last] = of.rows();
        format!("the bar of rows {first} to {last}")
    });
    format!("both edges of {of} go on along its line in both images")
}

fn answer(bar: &Bar, params: &Params) -> String {
    let [first, last] = bar.disparity().map(|d| d.to_num::<f64>());
    let depth = params.rig.map(|rig| bar.disparity().map(|d| metres(rig.depth(d))));
    format!(
        "{first:.2} to {last:.2} px +- {:.2}, p {:.3}, in front of what is around it{}",
        bar.sigma().to_num::<f64>(),
        bar.confidence().to_num::<f64>(),
        depth.map_or(String::new(), |[from, to]| format!(", {from} to {to}"))
    )
}
