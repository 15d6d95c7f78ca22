//! Verdicts on what is said of a pair, with bars and without.

use super::pair::{PastedPair, Pole, percentile};
use anyhow::Result;
use linestereo::results::{Bar, Point};
use linestereo::unstable::{BarEvidence, Observer};
use linestereo::{Params, Region};
use linestereo_frames::GrayImage;
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::results::mask::Mask;
use std::collections::BTreeMap;

/// Least probability of what is said.
const SAID: f64 = 0.9;
/// Least share of a bar's truths that agree with their median, for it to be judged.
const ONE_SURFACE: f64 = 0.7;

/// Rows of a pole: those right within 1 px, those with the disparity behind it, those else wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Rows {
    pub(crate) all: usize,
    pub(crate) right: usize,
    /// Within 1 px of what is behind it.
    pub(crate) behind: usize,
    pub(crate) wrong: usize,
}

/// Verdicts on a pole.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Said {
    pub(crate) rows: Rows,
    /// Its mask as an object: right or wrong, if it has a depth.
    pub(crate) object: Option<bool>,
}

/// Pixels on what was pasted that something is said of, and how many of these are wrong.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Toll {
    /// Pixels with a disparity.
    pub(crate) said: usize,
    pub(crate) wrong: usize,
}

/// A bar that is told.
#[derive(Clone, Debug)]
pub(crate) struct Told {
    pub(crate) bar: Bar,
    /// Distance from the truth, px; none where it is unknown or has several surfaces.
    pub(crate) error: Option<f64>,
    /// Distance from the truth of each of its pixels that has one, px.
    pub(crate) errors: Vec<f32>,
    /// Its evidence; none of parts that others were grown by.
    pub(crate) evidence: Option<BarEvidence>,
}

/// Poles, pixels and bars of a pair.
#[derive(Clone, Debug, Default)]
pub(crate) struct Judged {
    pub(crate) poles: Vec<Said>,
    /// Pixels of the mask.
    pub(crate) toll: Toll,
    /// Bars at any probability, in front and level.
    pub(crate) rated: Vec<Told>,
    /// Bars that are told, grown parts included.
    pub(crate) told: Vec<Told>,
}

/// Bars with their evidence.
#[derive(Default)]
struct Log {
    evidence: BTreeMap<usize, BarEvidence>,
    bars: Vec<(Bar, BarEvidence)>,
}

impl Told {
    /// Share of its pixels with truth that are more than 1 px off.
    pub(crate) fn share_off(&self) -> f64 {
        self.errors.iter().filter(|error| **error > 1.0).count() as f64
            / self.errors.len().max(1) as f64
    }
}

impl Observer for Log {
    fn on_event(&mut self, _: linestereo::unstable::StageEvent<'_>) {}

    fn bar_evidence(&mut self, index: usize, evidence: &BarEvidence) {
        self.evidence.insert(index, *evidence);
    }

    fn bar(&mut self, index: usize, bar: &Bar, nearby_q8: [i16; 4]) {
        if let Some(evidence) = self.evidence.get(&index) {
            self.bars.push((*bar, evidence.with_nearby(nearby_q8)));
        }
    }
}

/// Runs the core on a captured pair and judges what it says.
pub(crate) fn judge(
    pair: &PastedPair,
    [left, right]: &[GrayImage; 2],
    has_bars: bool,
) -> Result<Judged> {
    let params = Params { max_disparity: pair.max_disparity, ..Params::default() };
    let mut engine = Engine::new(&params, pair.dims)?;
    if !has_bars {
        engine.matcher.leave_out_bars();
    }
    let mut log = Log::default();
    let result = engine.run_observed(left.view()?, right.view()?, &mut log)?;
    let map = map_of(pair, &result);
    let objects = objects(pair, &mut engine);
    let poles = (1..).zip(&pair.poles).map(|(number, pole)| Said {
        rows: rows_of(pair, pole, &map),
        object: objects.get(&number).map(|d| is_right(pole, *d)),
    });
    let told = |(bar, evidence): (Bar, Option<BarEvidence>)| Told {
        error: error_of(pair, &bar),
        errors: errors_of(pair, &bar),
        bar,
        evidence,
    };
    Ok(Judged {
        poles: poles.collect(),
        toll: toll(pair, &map),
        told: engine.matched().bars().iter().map(|bar| told((*bar, None))).collect(),
        rated: log.bars.into_iter().map(|(bar, evidence)| told((bar, Some(evidence)))).collect(),
    })
}

/// Disparities that are said of pixels. Points count for the rows above and below as well.
fn map_of(pair: &PastedPair, result: &FrameResult) -> Vec<f64> {
    let (width, height) = (pair.width(), pair.height());
    let (mut map, mut best) = (vec![f64::NAN; width * height], vec![0.0; width * height]);
    for point in &result.points {
        let Point { x, y, disparity, confidence, .. } = *point;
        let confidence: f64 = confidence.to_num();
        if confidence < SAID {
            continue;
        }
        for (row, less) in [(y.checked_sub(1), 0.3), (Some(y), 0.0), (Some(y + 1), 0.3)] {
            let Some(row) = row.map(usize::from).filter(|&row| row < height) else { continue };
            let at = row * width + usize::from(x);
            if confidence - less > best[at] {
                (map[at], best[at]) = (disparity.to_num(), confidence - less);
            }
        }
    }
    map
}

fn rows_of(pair: &PastedPair, pole: &Pole, map: &[f64]) -> Rows {
    let mut rows = Rows { all: pole.starts.len(), ..Rows::default() };
    for (row, (&start, &d)) in pole.starts.iter().zip(&pole.disparities).enumerate() {
        let from = start.ceil().max(0.0) as usize;
        let to = ((start + pole.wide).floor() as usize + 1).max(from + 1).min(pair.width());
        let line = &map[(pole.top + row) * pair.width()..];
        let said: Vec<f64> =
            line[from.min(to)..to].iter().copied().filter(|d| d.is_finite()).collect();
        if said.is_empty() {
            continue;
        }
        let said = percentile(said, 0.5);
        let behind = pole.behind.get(row).copied().unwrap_or(f64::NAN);
        if (said - d).abs() <= 1.0 {
            rows.right += 1;
        } else if (said - behind).abs() <= 1.0 {
            rows.behind += 1;
        } else {
            rows.wrong += 1;
        }
    }
    rows
}

fn is_right(pole: &Pole, d: f64) -> bool {
    let middle = percentile(pole.disparities.clone(), 0.5);
    (d - middle).abs() <= (0.03 * middle).max(1.0)
}

/// Disparity of each mask that has one, px.
fn objects(pair: &PastedPair, engine: &mut Engine) -> BTreeMap<u16, f64> {
    let depth = |number: u16| {
        let own = pair.mask.iter().map(|&label| label == number).collect();
        let runs = Mask::new(pair.dims, own).runs(number);
        let region = Region::masked(number, &runs, pair.dims).ok()?; // a later pole may cover it
        Some((number, engine.object(&region).ok()?.disparity.to_num()))
    };
    (1..).take(pair.poles.len()).filter_map(depth).collect()
}

fn toll(pair: &PastedPair, map: &[f64]) -> Toll {
    let mut toll = Toll::default();
    for ((&said, &truth), _) in
        map.iter().zip(&pair.truth).zip(&pair.mask).filter(|(_, mask)| **mask > 0)
    {
        if said.is_finite() && truth.is_finite() {
            toll.said += 1;
            toll.wrong += usize::from((said - truth).abs() > 1.0);
        }
    }
    toll
}

/// Distances of a bar's pixels from their truths, px.
fn errors_of(pair: &PastedPair, bar: &Bar) -> Vec<f32> {
    let [first, last] = bar.rows();
    let [from, to] = bar.disparity().map(|d| d.to_num::<f64>());
    let mut errors = Vec::new();
    for y in first..=last {
        let d = from + (to - from) * f64::from(y - first) / f64::from((last - first).max(1));
        errors.extend(truths_of_row(pair, bar, y).map(|truth| (truth - d).abs() as f32));
    }
    errors
}

/// Truths of a bar's pixels in a row, px.
fn truths_of_row(pair: &PastedPair, bar: &Bar, y: u16) -> impl Iterator<Item = f64> {
    let columns = bar.columns(y);
    pair.truths(y.into(), columns.start.into(), columns.end.into())
}

/// Distance of a bar from the truth on its pixels, px.
fn error_of(pair: &PastedPair, bar: &Bar) -> Option<f64> {
    let [first, last] = bar.rows();
    let truths: Vec<f64> = (first..=last).flat_map(|y| truths_of_row(pair, bar, y)).collect();
    if truths.len() < 4 {
        return None;
    }
    let middle = percentile(truths.clone(), 0.5);
    let agree = truths.iter().filter(|d| (*d - middle).abs() < 1.5).count();
    let [from, to] = bar.disparity().map(|d| d.to_num::<f64>());
    (agree as f64 >= ONE_SURFACE * truths.len() as f64).then(|| ((from + to) / 2.0 - middle).abs())
}
