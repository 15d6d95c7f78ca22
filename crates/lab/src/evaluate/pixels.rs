//! The depth of pixels that nobody chose: how many are answered, and how wrong.
//!
//! Pixels with truth are drawn at random until so many of them are visible in the right image; the
//! hidden ones drawn meanwhile are queried too, because a robot does not know which are which.

use linestereo::unstable::{Model, PIXEL_EVIDENCE, PixelEvidence};
use linestereo::{results::PixelRejection, units::Confidence};
use linestereo_frames::{SplitMix64, Truth};
use linestereo_sim::engine::Engine;

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
    error: f64,
}

/// Visible pixels, rated.
#[derive(Clone, Debug, Default)]
pub struct PixelScore {
    /// Those with any answer.
    rated: Vec<Rated>,
    visible: usize,
}

impl PixelScore {
    /// Rates what was queried of a scene.
    pub fn new(queried: &[QueriedPixel], model: &Model<PIXEL_EVIDENCE>) -> Self {
        let visible = || queried.iter().filter(|pixel| pixel.is_visible);
        let rate = |pixel: &QueriedPixel| {
            let (disparity, evidence) = pixel.found.as_ref().ok()?;
            let score_q8 = model.score_q8(&evidence.0);
            Some(Rated {
                probability: f64::from(model.probability_q16(score_q8)) / 65536.0,
                error: f64::from((disparity - pixel.truth).abs()),
            })
        };
        Self { rated: visible().filter_map(rate).collect(), visible: visible().count() }
    }

    /// All scenes together.
    pub fn pool(scores: &[Self]) -> Self {
        Self {
            rated: scores.iter().flat_map(|score| score.rated.iter().copied()).collect(),
            visible: scores.iter().map(|score| score.visible).sum(),
        }
    }

    /// Visible pixels answered with at least this probability, %, and how many of them are more
    /// than 1 and 2 px off, %.
    pub fn answered(&self, least: Confidence) -> Option<(f64, [f64; 2])> {
        let least: f64 = least.to_num();
        let answers = || self.rated.iter().filter(|rated| rated.probability >= least);
        let count = answers().count();
        let bad =
            |limit: f64| percent(answers().filter(|rated| rated.error > limit).count(), count);
        Some((percent(count, self.visible)?, [bad(1.0)?, bad(2.0)?]))
    }
}

fn percent(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| 100.0 * part as f64 / whole as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_of_four_pixels() {
        let rated = [(0.95, 0.4), (0.9, 1.5), (0.2, 9.0)]
            .map(|(probability, error)| Rated { probability, error });
        let score = PixelScore { rated: rated.into(), visible: 4 };
        let pooled = PixelScore::pool(&[score.clone(), score]);
        assert_eq!(pooled.answered(Confidence::from_num(0.5)), Some((50.0, [50.0, 0.0])));
        assert_eq!(PixelScore::default().answered(Confidence::ZERO), None);
    }
}
