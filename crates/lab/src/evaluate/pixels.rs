//! The depth of pixels that nobody chose: how many are answered, and how wrong.
//!
//! Pixels with truth are drawn at random until so many of them are visible in the right image; the
//! hidden ones drawn meanwhile are queried too, because a robot does not know which are which.

use core::fmt::Write;
use linestereo::unstable::{Model, PIXEL_EVIDENCE, PixelEvidence};
use linestereo::{results::PixelRejection, units::Confidence};
use linestereo_frames::statistics::upper_median;
use linestereo_frames::{SplitMix64, Truth};
use linestereo_sim::engine::Engine;

/// Shares of the visible pixels at which the curve of error against answers is read.
const SHARES: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Bins of stated against observed probability.
const BINS: [f64; 8] = [0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 1.0];

/// A pixel with truth that the core was asked for.
#[derive(Clone, Debug)]
pub struct QueriedPixel {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
    /// True disparity, px.
    pub truth: f32,
    /// The true match is visible in the right image.
    pub is_visible: bool,
    /// Disparity in px and its evidence, whatever its probability.
    pub found: Result<(f32, PixelEvidence), PixelRejection>,
}

/// Asks an engine that has just run on this pair for random pixels, `count` of them visible (fewer
/// where the truth has fewer).
#[must_use]
pub fn query_pixels(
    engine: &mut Engine,
    truth: &Truth,
    (count, seed): (usize, u64),
) -> Vec<QueriedPixel> {
    let dims = truth.dims();
    let pixels = (0..dims.height).flat_map(|y| (0..dims.width).map(move |x| (x, y)));
    let mut pixels: Vec<(u16, u16, f32)> = pixels
        .filter_map(|(x, y)| truth.disparity(x.into(), y.into()).map(|disparity| (x, y, disparity)))
        .collect();
    let (mut random, mut queried, mut visible) = (SplitMix64(seed), Vec::new(), 0);
    while visible < count && !pixels.is_empty() {
        let (x, y, disparity) = pixels.swap_remove((random.bits() % pixels.len() as u64) as usize);
        let is_visible = truth.is_visible(x.into(), y.into());
        visible += usize::from(is_visible);
        let found = engine.ask(|matched| matched.pixel_evidence((x, y)));
        let found = found.map(|(d_q6, evidence)| (d_q6 as f32 / 64.0, evidence));
        queried.push(QueriedPixel { x, y, truth: disparity, is_visible, found });
    }
    queried
}

/// An answer as a model rates it.
#[derive(Clone, Copy, Debug)]
struct Rated {
    probability: f64,
    sigma: f64,
    error: f64,
    is_visible: bool,
}

/// The pixels of one scene, rated.
#[derive(Clone, Debug, Default)]
pub struct PixelScore {
    name: String,
    /// Those with any answer.
    rated: Vec<Rated>,
    visible: usize,
    hidden: usize,
}

/// Answers of at least some probability.
struct Answered {
    /// Of the visible and of the hidden pixels, %.
    visible_percent: Option<f64>,
    hidden_percent: Option<f64>,
    /// More than 1 and 2 px off, of those visible and of all, %.
    visible_bad: [Option<f64>; 2],
    all_bad: [Option<f64>; 2],
    /// Median error of the visible, px.
    median: Option<f64>,
    /// Within one and two of the stated standard deviations, %.
    within_sigma: [Option<f64>; 2],
}

impl PixelScore {
    /// Rates what was queried of a scene.
    #[must_use]
    pub fn new(name: &str, queried: &[QueriedPixel], model: &Model<PIXEL_EVIDENCE>) -> Self {
        let rate = |pixel: &QueriedPixel| {
            let (disparity, evidence) = pixel.found.as_ref().ok()?;
            let score_q8 = model.score_q8(&evidence.0);
            Some(Rated {
                probability: f64::from(model.probability_q16(score_q8)) / 65536.0,
                sigma: f64::from(model.sigma_q6(score_q8)) / 64.0,
                error: f64::from((disparity - pixel.truth).abs()),
                is_visible: pixel.is_visible,
            })
        };
        let visible = queried.iter().filter(|pixel| pixel.is_visible).count();
        let rated = queried.iter().filter_map(rate).collect();
        Self { name: name.to_owned(), rated, visible, hidden: queried.len() - visible }
    }

    /// All scenes together.
    #[must_use]
    pub fn pool(scores: &[Self]) -> Self {
        Self {
            name: "pooled".to_owned(),
            rated: scores.iter().flat_map(|score| score.rated.iter().copied()).collect(),
            visible: scores.iter().map(|score| score.visible).sum(),
            hidden: scores.iter().map(|score| score.hidden).sum(),
        }
    }

    /// Visible pixels answered with at least this probability, %, and how many of them are more
    /// than 1 and 2 px off, %.
    #[must_use]
    pub fn answered(&self, least: Confidence) -> Option<(f64, [f64; 2])> {
        let answered = self.at(least.to_num());
        let [bad1, bad2] = answered.visible_bad;
        Some((answered.visible_percent?, [bad1?, bad2?]))
    }

    fn at(&self, least: f64) -> Answered {
        let answers = || self.rated.iter().filter(|rated| rated.probability >= least);
        let visible = || answers().filter(|rated| rated.is_visible);
        let (seen, all) = (visible().count(), answers().count());
        let bad = |error: f64, limit: f64| error > limit;
        Answered {
            visible_percent: percent(seen, self.visible),
            hidden_percent: percent(all - seen, self.hidden),
            visible_bad: [1.0, 2.0]
                .map(|limit| percent(visible().filter(|r| bad(r.error, limit)).count(), seen)),
            all_bad: [1.0, 2.0]
                .map(|limit| percent(answers().filter(|r| bad(r.error, limit)).count(), all)),
            median: upper_median(visible().map(|rated| rated.error).collect(), f64::total_cmp),
            within_sigma: [1.0, 2.0]
                .map(|k| percent(answers().filter(|r| r.error <= k * r.sigma).count(), all)),
        }
    }

    /// The probability that so many % of the visible pixels reach.
    fn least_probability(&self, share: f64) -> Option<f64> {
        let visible = self.rated.iter().filter(|rated| rated.is_visible);
        let mut probabilities: Vec<f64> = visible.map(|rated| rated.probability).collect();
        probabilities.sort_by(|a, b| b.total_cmp(a));
        probabilities.get((share * self.visible as f64).ceil() as usize - 1).copied()
    }
}

fn percent(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| 100.0 * part as f64 / whole as f64)
}

fn number(value: Option<f64>, width: usize, decimals: usize) -> String {
    value.map_or_else(|| format!("{:>width$}", "-"), |value| format!("{value:width$.decimals$}"))
}

fn pair(values: [Option<f64>; 2]) -> String {
    values.map(|value| number(value, 6, 2)).join(" /")
}

/// One line per scene at this probability, the pooled curve of error against answers, and stated
/// against observed probability.
#[must_use]
pub fn pixel_report(scores: &[PixelScore], least: Confidence) -> String {
    let least: f64 = least.to_num();
    let pooled = PixelScore::pool(scores);
    let width = scores
        .iter()
        .map(|score| score.name.chars().count())
        .max()
        .unwrap_or(0)
        .max(pooled.name.len());
    let mut text = format!(
        "pixels answered with p >= {least:.2}\n\
         {:width$}  visible %  vis bad1/bad2 %  median px  hidden %  all bad1/bad2 %  within 1/2 sigma %\n",
        "scene"
    );
    for score in scores.iter().chain([&pooled]) {
        let a = score.at(least);
        let _ = writeln!(
            text,
            "{:width$} {} {:>16} {} {} {:>16} {:>18}",
            score.name,
            number(a.visible_percent, 10, 1),
            pair(a.visible_bad),
            number(a.median, 10, 2),
            number(a.hidden_percent, 9, 1),
            pair(a.all_bad),
            pair(a.within_sigma),
        );
    }
    text.push_str("\nerror against answers, all scenes together\nvisible %   least p  vis bad1/bad2 %  hidden %  all bad1/bad2 %\n");
    for share in SHARES {
        let Some(least) = pooled.least_probability(share) else { continue };
        let a = pooled.at(least);
        let _ = writeln!(
            text,
            "{:9.0} {least:9.3} {:>16} {} {:>16}",
            100.0 * share,
            pair(a.visible_bad),
            number(a.hidden_percent, 9, 1),
            pair(a.all_bad),
        );
    }
    text.push_str("\nprobability stated against observed (within 1 px, hidden pixels included)\nbin           answers  stated   observed\n");
    for edges in BINS.windows(2) {
        let inside: Vec<&Rated> = pooled
            .rated
            .iter()
            .filter(|r| r.probability >= edges[0] && r.probability < edges[1])
            .collect();
        let right = inside.iter().filter(|rated| rated.error <= 1.0).count();
        let stated =
            inside.iter().map(|rated| rated.probability).sum::<f64>() / inside.len().max(1) as f64;
        let _ = writeln!(
            text,
            "{:.2} - {:.2} {:10} {} {}",
            edges[0],
            edges[1],
            inside.len(),
            number((!inside.is_empty()).then_some(stated), 8, 3),
            number(percent(right, inside.len()).map(|p| p / 100.0), 10, 3),
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_errors_of_five_pixels() {
        let rated =
            |probability, error, is_visible| Rated { probability, sigma: 0.5, error, is_visible };
        let score = PixelScore {
            name: "five".to_owned(),
            rated: vec![
                rated(0.95, 0.4, true),
                rated(0.9, 1.5, true),
                rated(0.9, 3.0, false),
                rated(0.2, 9.0, true),
            ],
            visible: 4,
            hidden: 1,
        };
        assert_eq!(score.answered(Confidence::from_num(0.5)), Some((50.0, [50.0, 0.0])));
        assert_eq!(score.least_probability(0.25), Some(0.95));
        let a = score.at(0.5);
        assert_eq!(
            (a.hidden_percent, a.within_sigma[0].map(f64::round)),
            (Some(100.0), Some(33.0))
        );
        let text = pixel_report(&[score], Confidence::from_num(0.5));
        assert!(text.contains("pooled") && text.contains("error against answers"), "{text}");
    }
}
