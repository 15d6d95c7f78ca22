//! A segment: search range, window by sides, census, agreement, halves, feature, sides,
//! probability.

use super::curve::{Curve, Low, Mark, Plot, ratio, words};
use super::log::{CurveLog, TestedSegment};
use super::{Account, REACH, Step, metres};
use crate::engine::FrameResult;
use crate::results::health::is_fit;
use crate::results::listing::owner_name;
use linestereo::results::{Match, Rejection};
use linestereo::unstable::{
    Candidate, MAX_CENSUS_RATIO_Q8, MAX_SIDE_RATIO_Q8, MAX_SLANT_Q6, MAX_WINDOW_RATIO_Q8,
    NearbyEvidence, Segment,
};
use linestereo::{Params, params::Margin, units::Disparity};

/// Ends, px.
pub(super) fn ends(segment: &Segment) -> [[f64; 2]; 2] {
    segment.ends.map(|end| [end.x.to_num(), end.y.to_num()])
}

/// Position of the segment next to a pixel in the log, and how far it is away, px; matched ones
/// before those that another one stands for.
pub(super) fn nearest((x, y): (u16, u16), log: &CurveLog) -> Option<(usize, f64)> {
    let near = log
        .segments
        .iter()
        .enumerate()
        .map(|(index, tested)| (index, distance(tested, [x.into(), y.into()])));
    let is_untested =
        |index: usize| matches!(log.segments[index].outcome, Err(Rejection::LessProminent));
    let near = near.filter(|&(_, distance)| distance <= REACH);
    near.min_by(|a, b| {
        (is_untested(a.0), a.1)
            .partial_cmp(&(is_untested(b.0), b.1))
            .unwrap_or(core::cmp::Ordering::Equal)
    })
}

fn distance(tested: &TestedSegment, [x, y]: [f64; 2]) -> f64 {
    let [[x0, y0], [x1, y1]] = ends(&tested.segment);
    let (dx, dy) = (x1 - x0, y1 - y0);
    let along = ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy).max(1e-9);
    let t = along.clamp(0.0, 1.0);
    (x - x0 - t * dx).hypot(y - y0 - t * dy)
}

/// Reasons for the match of a segment, or for the lack of it.
pub(super) fn account(
    index: usize,
    distance: f64,
    log: &CurveLog,
    candidates: &[Candidate],
    params: &Params,
    result: &FrameResult,
) -> Account {
    let tested = &log.segments[index];
    let candidate =
        tested.outcome.as_ref().ok().and_then(|&(position, _)| candidates.get(position));
    let reason = match (&tested.outcome, candidate) {
        (Err(reason), _) => Some(*reason),
        (Ok(_), candidate) => candidate.and_then(Candidate::rejection),
    };
    let curves = Curves::new(tested);
    let mut steps = Vec::new();
    curves.add_tests(tested.segment.near_horizontal, params, &mut steps);
    if let Some(candidate) = candidate {
        add_hypotheses(candidate, params, &mut steps);
    }
    if let Err(reason) = &tested.outcome {
        end_at(*reason, tested.segment.near_horizontal, &mut steps);
    }
    let found = candidate.and_then(|candidate| match_of(candidate, result));
    let verdict = match (reason, found) {
        (Some(reason), _) => meaning(reason).to_owned(),
        (None, Some(found)) => answer(found),
        (None, None) if !is_fit(result.health) => {
            "it would be among the matches, but the pair is not fit to be used".to_owned()
        }
        (None, None) => "it is among the matches".to_owned(),
    };
    let mut plots = curves.plots();
    if let Some(found) = found {
        let middle = found.disparity.map(|d| d.to_num::<f64>()).iter().sum::<f64>() / 2.0;
        plots.iter_mut().for_each(|plot| plot.marks.push(Mark { name: "answer", at: middle }));
    }
    if let Some(feature) = candidate.and_then(|candidate| candidate.feature_q6) {
        let mark = Mark { name: "feature", at: f64::from(feature) / 64.0 };
        plots.iter_mut().for_each(|plot| plot.marks.push(mark.clone()));
    }
    Account {
        subject: subject(&tested.segment, distance),
        steps,
        accepted: reason.is_none(),
        verdict,
        plots,
    }
}

/// Marks the test that the core rejected it by. Of a near-vertical segment nothing comes after it;
/// of another one the other side may.
fn end_at(reason: Rejection, near_horizontal: bool, steps: &mut Vec<Step>) {
    let passed =
        |name: &str| steps.iter().any(|step| step.name == name && step.passed == Some(true));
    let name = match reason {
        Rejection::WindowNotUnique if !near_horizontal && passed("window") => {
            let words = "the left image shows it at four or more places at equal distances";
            return steps.push(Step::test("repetition", false, words));
        }
        Rejection::WindowNotUnique => "window",
        Rejection::CensusNotUnique => "census",
        Rejection::TechniquesDisagree => "agreement",
        Rejection::Slant => "halves",
        Rejection::NoOwner => "owner",
        _ => return,
    };
    let Some(place) = steps.iter().rposition(|step| step.name == name) else { return };
    steps[place].passed = Some(false);
    if !near_horizontal {
        steps.truncate(place + 1);
    }
}

fn subject(segment: &Segment, distance: f64) -> String {
    let [[x0, y0], [x1, y1]] = ends(segment);
    let direction = if segment.near_horizontal { "near-horizontal" } else { "near-vertical" };
    let brighter = match (segment.near_horizontal, segment.rising) {
        (false, true) => "right",
        (false, false) => "left",
        (true, true) => "below",
        (true, false) => "above",
    };
    format!(
        "segment ({x0:.1}, {y0:.1}) to ({x1:.1}, {y1:.1}), {direction}, {distance:.1} px away; grey step {}, brighter {brighter}",
        segment.contrast
    )
}

/// The costs that its tests look at.
struct Curves {
    /// Name, window and census, of the whole segment or of each side.
    searched: Vec<(&'static str, Option<Curve>, Option<Curve>)>,
    /// Each side's own window, edge left out.
    sides: [Option<Curve>; 2],
    /// Disparity of each half by the window of the better side, px.
    halves: Option<[f64; 2]>,
}

impl Curves {
    fn new(tested: &TestedSegment) -> Self {
        let both = |a: &Option<Curve>, b: &Option<Curve>, combine: fn(&Curve, &Curve) -> Curve| {
            a.as_ref().zip(b.as_ref()).map(|(a, b)| combine(a, b))
        };
        let sides =
            tested.windows.each_ref().map(|[first, second]| both(first, second, Curve::sum));
        if tested.segment.near_horizontal {
            let [above, below] = sides.clone();
            let [census_above, census_below] = tested.census.clone();
            let searched = vec![("above", above, census_above), ("below", below, census_below)];
            return Self { searched, sides, halves: None };
        }
        let edge = both(&tested.edges[0], &tested.edges[1], Curve::sum);
        let window = both(&both(&sides[0], &sides[1], Curve::lower), &edge, Curve::sum);
        let census = both(&tested.census[0], &tested.census[1], Curve::lower);
        let halves = window.as_ref().and_then(Curve::best_and_second).and_then(|(best, _)| {
            let cost = |side: usize| Some(sides[side].as_ref()?.near(best.at, 0)?.cost);
            let side = usize::from(cost(0)? > cost(1)?);
            let half = |half: usize| {
                let curve = both(&tested.windows[side][half], &tested.edges[half], Curve::sum)?;
                Some(curve.subpixel(curve.near(best.at, 4)?.at))
            };
            Some([half(0)?, half(1)?])
        });
        Self { searched: vec![("", window, census)], sides, halves }
    }

    /// The tests that were made, in their order.
    fn add_tests(&self, near_horizontal: bool, params: &Params, steps: &mut Vec<Step>) {
        let range = self.searched.iter().find_map(|(_, window, _)| window.as_ref());
        let Some(range) = range else { return };
        let whole = range.costs.len() + 8 >= usize::from(params.max_disparity);
        let why = if whole {
            "no support points guide it"
        } else {
            "limited by support points around it, or by the border"
        };
        let words = format!("disparities {} to {} px: {why}", range.first, range.last());
        steps.push(Step::note("search", words));
        for (side, window, census) in &self.searched {
            add_techniques(side, window.as_ref(), census.as_ref(), params, steps);
        }
        if near_horizontal || self.searched.iter().any(|(_, _, census)| census.is_none()) {
            return;
        }
        if let Some([upper, lower]) = self.halves {
            let (gap, allowed) = ((upper - lower).abs(), f64::from(MAX_SLANT_Q6) / 128.0);
            let words = format!(
                "upper {upper:.2} px, lower {lower:.2} px: {gap:.2} px apart, allowed {allowed} px"
            );
            steps.push(Step::test("halves", gap <= allowed, words));
        }
        let best = self.searched[0].1.as_ref().and_then(Curve::best_and_second);
        if let Some((best, _)) = best {
            steps.push(self.owners(best.at));
        }
    }

    fn owners(&self, at: i32) -> Step {
        let allowed = f64::from(MAX_SIDE_RATIO_Q8) / 256.0;
        let ratios: Vec<f64> =
            self.sides.iter().flatten().filter_map(|side| side_ratio(side, at)).collect();
        let sides = ["left", "right"].iter().zip(&ratios);
        let sides: Vec<String> = sides.map(|(name, ratio)| format!("{name} {ratio:.2}")).collect();
        let is_owned = ratios.iter().any(|&ratio| ratio <= allowed);
        let words =
            format!("window of each side alone, ratio: {}; allowed {allowed:.2}", sides.join(", "));
        Step::test("owner", is_owned, words)
    }

    fn plots(&self) -> Vec<Plot> {
        let mut plots = Vec::new();
        let mut census_plots = Vec::new();
        for (side, window, census) in &self.searched {
            let title =
                |technique: &str| format!("segment: {technique} {side}").trim_end().to_owned();
            if let Some(window) = window {
                let mut curves = vec![("window", window.clone())];
                if side.is_empty() {
                    let sides = ["left side", "right side"].into_iter().zip(&self.sides);
                    curves.extend(sides.filter_map(|(name, side)| Some((name, side.clone()?))));
                }
                plots.push(Plot::new(&title("window shaped by it"), curves));
            }
            if let Some(census) = census {
                census_plots
                    .push(Plot::new(&title("census along it"), vec![("census", census.clone())]));
            }
        }
        plots.extend(census_plots);
        plots
    }
}

/// Uniqueness of a side's own window at a disparity.
fn side_ratio(side: &Curve, at: i32) -> Option<f64> {
    Some(ratio(side.near(at, 1)?, side.second(at)?))
}

/// Window, census and the gap between them, of the whole segment or of a side.
fn add_techniques(
    side: &str,
    window: Option<&Curve>,
    census: Option<&Curve>,
    params: &Params,
    steps: &mut Vec<Step>,
) {
    let Some((window, (best, second))) =
        window.and_then(|curve| Some((curve, curve.best_and_second()?)))
    else {
        return;
    };
    let name = |technique: &'static str| {
        if side.is_empty() { String::new() } else { format!("{side} {technique}: ") }
    };
    let limit = |q8: i32| f64::from(q8) / 256.0;
    let is_last = best.at == i32::from(params.max_disparity) - 1;
    let passes = ratio(best, second) <= limit(MAX_WINDOW_RATIO_Q8) && !is_last;
    let end =
        if is_last { "; the last disparity of the range: the true one may lie beyond" } else { "" };
    let words_of = |curve: &Curve, best: Low, second: Low, allowed: f64, technique| {
        format!("{}{}, allowed {allowed:.2}", name(technique), words(curve, best, second))
    };
    let text = words_of(window, best, second, limit(MAX_WINDOW_RATIO_Q8), "window") + end;
    steps.push(Step::test("window", passes && census.is_some(), text));
    let Some((census, (low, next))) =
        census.and_then(|curve| Some((curve, curve.best_and_second()?)))
    else {
        return;
    };
    let overall = low;
    // Beside a near-horizontal edge census is looked at where the window's best is.
    let here = census.near(best.at, 1).zip(census.second(best.at));
    let (low, next) = here.filter(|_| !side.is_empty()).unwrap_or((low, next));
    let allowed = limit(MAX_CENSUS_RATIO_Q8);
    let text = words_of(census, low, next, allowed, "census");
    steps.push(Step::test("census", ratio(low, next) <= allowed, text));
    if ratio(low, next) > allowed {
        return;
    }
    let (at, other) = (window.subpixel(best.at), census.subpixel(overall.at));
    let (agrees, allowed) = match (params.margin, params.rig) {
        (Margin::Metres { nearer, farther }, Some(rig)) => {
            let at = Disparity::saturating_from_num(at);
            let (from, to) = rig.disparity_interval(at, nearer, farther);
            let is_in = (from.to_num::<f64>()..=to.to_num()).contains(&other);
            (is_in, format!("{from:.2} to {to:.2} px"))
        }
        (Margin::Pixels(margin), _) => {
            ((at - other).abs() <= margin.to_num::<f64>(), format!("{margin:.2} px"))
        }
        (Margin::Metres { .. }, None) => (false, "unknown without a rig".to_owned()),
    };
    let (name, gap) = (name("both"), (at - other).abs());
    let text = format!("{name}window and census {gap:.2} px apart, allowed {allowed}");
    steps.push(Step::test("agreement", agrees, text));
}

/// Feature, and each side's hypothesis with its probability.
fn add_hypotheses(candidate: &Candidate, params: &Params, steps: &mut Vec<Step>) {
    let feature = match candidate.feature_q6 {
        Some(q6) => format!("an edge alike in the right image at {:.2} px", f64::from(q6) / 64.0),
        None if candidate.segment.near_horizontal => {
            "not searched: an edge along the rows has no disparity".to_owned()
        }
        None => "no edge alike in the right image there".to_owned(),
    };
    steps.push(Step::note("feature", feature));
    let least = params.min_confidence;
    let names =
        if candidate.segment.near_horizontal { ["above", "below"] } else { ["left", "right"] };
    for (name, side) in names.into_iter().zip(&candidate.sides) {
        let Some(side) = side else {
            steps.push(Step::note("side", format!("{name}: does not have this disparity")));
            continue;
        };
        let NearbyEvidence { agreeing, farther, nearer, segments } = side.nearby;
        let [agreeing, farther, nearer, segments] =
            [agreeing, farther, nearer, segments].map(|q8| f64::from(q8) / 256.0);
        let [first, last] = side.disparity_q6.map(|q6| f64::from(q6) / 64.0);
        let words = format!(
            "{name}: {first:.2} to {last:.2} px, p {:.3}, asked for {:.2}; support points that agree {:.1} \
             (share farther {farther:.2}, nearer {nearer:.2}), segments that agree {:.1}",
            side.confidence().to_num::<f64>(),
            least.to_num::<f64>(),
            agreeing.exp2() - 1.0,
            segments.exp2() - 1.0,
        );
        steps.push(Step::test("side", side.confidence() >= least, words));
    }
}

/// The match of a candidate: ends may have been put in another order.
fn match_of<'a>(candidate: &Candidate, result: &'a FrameResult) -> Option<&'a Match> {
    let [a, b] = candidate.segment.ends;
    result.matches.iter().find(|found| found.ends == [a, b] || found.ends == [b, a])
}

fn answer(found: &Match) -> String {
    let [first, last] = found.disparity.map(|d| d.to_num::<f64>());
    let depth = found.depth.map(|ends| ends.map(metres));
    format!(
        "{first:.2} to {last:.2} px +- {:.2}, p {:.3}, owned by {}{}",
        found.sigma.to_num::<f64>(),
        found.confidence.to_num::<f64>(),
        owner_name(found.owner),
        depth.map_or(String::new(), |[from, to]| format!(", {from} to {to}"))
    )
}

/// Meaning of a reason, in a sentence.
pub fn meaning(reason: Rejection) -> &'static str {
    match reason {
        Rejection::LessProminent => {
            "another segment in the same square has more extent and contrast, or the time for searches of the whole range was used up; this one was not matched (--cell)"
        }
        Rejection::NearBorder => {
            "too close to the left or right border to compare enough disparities"
        }
        Rejection::WindowNotUnique => {
            "a second place in the right image looks nearly as much like its window, or the \
             left image repeats it, or bars around it, at equal distances"
        }
        Rejection::CensusNotUnique => {
            "a second place in the right image has nearly the same order of grey levels"
        }
        Rejection::TechniquesDisagree => {
            "window and census lie further apart than the margin (--margin-px)"
        }
        Rejection::Slant => "its two halves lie too far apart to be one straight edge",
        Rejection::NoOwner => "neither side of it has this disparity on its own",
        Rejection::NotUnique => {
            "a more probable segment explains the same place in the right image"
        }
        Rejection::LowConfidence => "its probability is below the limit (--min-confidence)",
        Rejection::EdgeUnclear => {
            "its points are credible and listed, but the edge itself may belong to the surface on the other side"
        }
        _ => "for a reason of a later version",
    }
}
