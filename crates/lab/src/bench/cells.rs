//! One hypothesis per cell: error rates of the most probable ones among all cells.
//!
//! Of each cell of 16x16 pixels the most probable point is taken. The hypotheses of all scenes
//! stand in the order of their confidence. The first N percent *of all cells* are judged, so that a
//! method that leaves cells out does not gain by it.

use super::figures::{Better, Figure, Group, Values, percent};
use super::grid::Grid;
use linestereo::results::Point;
use linestereo_frames::Truth;
use std::collections::BTreeMap;

/// Side of a cell, px.
const CELL: usize = 16;
/// Shares of all cells that are judged, in percent.
const SHARES: [usize; 10] = [30, 40, 50, 55, 60, 65, 70, 75, 80, 85];
/// Those that a short table shows.
const MAIN_SHARES: [usize; 4] = [50, 60, 70, 80];
/// Truth on a smaller share of the pixels is sparse.
const DENSE: f64 = 0.3;

/// A disparity that a method claims for a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hypothesis {
    pub(crate) x: usize,
    pub(crate) y: usize,
    /// px.
    pub(crate) disparity: f64,
    /// Larger is surer; a probability where the method has one.
    pub(crate) confidence: f64,
}

/// The best hypothesis of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CellBest {
    confidence: f64,
    /// Distance to the truth, px; not a number where it is unknown.
    error: f64,
}

/// Answers of one method in the cells of all scenes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Cells {
    best: Vec<CellBest>,
    /// Cells of all scenes, with and without a hypothesis.
    count: usize,
}

impl Cells {
    /// Adds a scene; `truth` is not a number where it is unknown, or not to be judged.
    pub(crate) fn add(&mut self, hypotheses: &[Hypothesis], truth: &Grid<f64>) {
        self.count += truth.width().div_ceil(CELL) * truth.height().div_ceil(CELL);
        self.best.extend(best_per_cell(hypotheses).map(|best| CellBest {
            confidence: best.confidence,
            error: (best.disparity - truth.at(best.x, best.y)).abs(),
        }));
    }

    /// The points of one frame.
    pub(crate) fn of_points(points: &[Point], truth: &Truth) -> Self {
        let (width, height) = (usize::from(truth.dims().width), usize::from(truth.dims().height));
        let truth = Grid::new(width, vec![(); width * height])
            .map(|x, y| truth.disparity(x as i32, y as i32).map_or(f64::NAN, f64::from));
        let hypothesis = |point: &Point| Hypothesis {
            x: point.x.into(),
            y: point.y.into(),
            disparity: point.disparity.to_num(),
            confidence: point.confidence.to_num(),
        };
        let mut cells = Self::default();
        cells.add(&points.iter().map(hypothesis).collect::<Vec<_>>(), &truth);
        cells
    }

    /// Adds the cells of other frames.
    pub(crate) fn join(&mut self, other: &Self) {
        self.best.extend_from_slice(&other.best);
        self.count += other.count;
    }

    /// Share of all cells in percent, and of the surest so many the error rates in percent.
    pub(crate) fn curve(&self) -> impl Iterator<Item = (usize, Option<[f64; 2]>)> {
        SHARES.into_iter().zip(self.error_rates())
    }

    /// Cells with a hypothesis, in percent.
    fn covered(&self) -> Option<f64> {
        (self.count > 0).then(|| percent(self.best.len(), self.count))
    }

    /// Of the surest hypotheses, for each share of all cells: how many are more than 1 px off, and
    /// more than 2 px, in percent of those with truth. `None` where fewer cells have hypotheses.
    fn error_rates(&self) -> Vec<Option<[f64; 2]>> {
        let mut sorted = self.best.clone();
        sorted.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        let rates = |share: usize| {
            let wanted = (self.count * share) as f64 / 100.0;
            let judged = sorted.get(..wanted as usize).filter(|_| sorted.len() as f64 >= wanted)?;
            let errors: Vec<f64> =
                judged.iter().map(|best| best.error).filter(|error| error.is_finite()).collect();
            let beyond = |limit: f64| errors.iter().filter(|&&error| error > limit).count();
            let rates =
                [1.0, 2.0].map(|limit| 100.0 * (beyond(limit) as f64 / errors.len() as f64));
            Some(rates).filter(|_| !errors.is_empty())
        };
        SHARES.iter().map(|&share| rates(share)).collect()
    }
}

/// The surest hypothesis of each cell, the first of equals, in the order of the cells.
fn best_per_cell(hypotheses: &[Hypothesis]) -> impl Iterator<Item = &Hypothesis> {
    let mut best: BTreeMap<(usize, usize), &Hypothesis> = BTreeMap::new();
    for hypothesis in hypotheses {
        let kept = best.entry((hypothesis.y / CELL, hypothesis.x / CELL)).or_insert(hypothesis);
        if hypothesis.confidence > kept.confidence {
            *kept = hypothesis;
        }
    }
    best.into_values()
}

/// Sparse truth, also of the pixels beside those that have it.
pub(crate) fn spread(truth: &Grid<f64>) -> Grid<f64> {
    let known = truth.values().iter().filter(|value| value.is_finite()).count();
    if known as f64 / truth.values().len() as f64 >= DENSE {
        return truth.clone();
    }
    // The pixel's own first, then from the lower right on.
    let around = || [1, 0, -1].into_iter().flat_map(|down| [1, 0, -1].map(|right| [right, down]));
    truth.map(|x, y| {
        let own = truth.at(x, y);
        let beside = || around().map(|by| truth.around((x, y), by)).find(|value| value.is_finite());
        if own.is_finite() { own } else { beside().unwrap_or(f64::NAN) }
    })
}

/// Figures of linestereo and SGBM, which have hypotheses with a confidence.
pub(crate) fn group(name: &str, linestereo: &Cells, sgbm: &Cells) -> Group {
    let covered = Values::new([linestereo.covered(), sgbm.covered(), None]);
    let mut figures = vec![Figure::new("cells with a hypothesis, %", Better::Higher, 1, covered)];
    let rates = [linestereo, sgbm].map(Cells::error_rates);
    for (limit, px) in [1, 2].into_iter().enumerate() {
        for (row, share) in SHARES.into_iter().enumerate() {
            let [ours, theirs] = [0, 1].map(|of: usize| rates[of][row].map(|rates| rates[limit]));
            let name = format!("first {share} % of all cells: off by > {px} px, %");
            let main = px == 1 && MAIN_SHARES.contains(&share);
            let values = Values::new([ours, theirs, None]);
            figures.push(Figure { main, ..Figure::new(name, Better::Lower, 2, values) });
        }
    }
    Group::new(name, figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hypothesis(x: usize, y: usize, disparity: f64, confidence: f64) -> Hypothesis {
        Hypothesis { x, y, disparity, confidence }
    }

    #[test]
    fn a_cell_has_its_surest_hypothesis_and_the_first_of_equals() {
        let all = [
            hypothesis(20, 1, 5.0, 0.5),
            hypothesis(1, 1, 1.0, 0.7),
            hypothesis(2, 2, 2.0, 0.9),
            hypothesis(3, 3, 3.0, 0.9),
            hypothesis(1, 16, 4.0, 0.1),
        ];
        let best: Vec<f64> = best_per_cell(&all).map(|best| best.disparity).collect();
        assert_eq!(best, [2.0, 5.0, 4.0]);
    }

    /// Ten cells: the surest is right, the second 1.5 px off, the third without truth.
    #[test]
    fn shares_are_of_all_cells() {
        let mut cells = Cells::default();
        let truth =
            Grid::new(160, vec![10.0; 160 * 16]).map(|x, _| if x == 32 { f64::NAN } else { 10.0 });
        let found = [
            hypothesis(0, 0, 10.0, 0.9),
            hypothesis(16, 0, 11.5, 0.8),
            hypothesis(32, 0, 99.0, 0.7),
        ];
        cells.add(&found, &truth);
        assert_eq!(cells.covered(), Some(30.0));
        let rates = cells.error_rates();
        assert_eq!(rates[0], Some([50.0, 0.0]), "two of three have truth");
        assert_eq!(rates[1], None, "only 30 % of the cells have a hypothesis");
        let group = group("cells", &cells, &Cells::default());
        assert_eq!(group.figures.len(), 3);
    }

    #[test]
    fn sparse_truth_counts_beside_its_pixel() {
        let truth = Grid::new(5, vec![f64::NAN; 25])
            .map(|x, y| if (x, y) == (2, 2) { 7.0 } else { f64::NAN });
        let spread = spread(&truth);
        assert_eq!(spread.values().iter().filter(|value| **value == 7.0).count(), 9);
        assert!(spread.at(0, 2).is_nan());
        let dense = truth.map(|x, y| (x + y) as f64);
        assert_eq!(super::spread(&dense), dense);
    }
}
