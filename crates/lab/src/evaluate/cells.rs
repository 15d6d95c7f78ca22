//! One answer per cell: the most probable one of each 16x16 cell, and how often the first so many
//! percent of all cells are wrong.
//!
//! "The most confident points" flatter a method that lists many on easy texture and none where it
//! is hard. A robot needs the depth of every place: every method gives one number a cell, however
//! many points it lists. Cells are taken in the order of their probability, those of all frames
//! together; a cell whose answer has no truth takes its place and is neither right nor wrong.

use linestereo::results::Point;
use linestereo_frames::Truth;
use serde::Serialize;

/// Side of a cell, px; those at the right and lower border may be cut off.
pub(super) const CELL: usize = 16;
/// Percent of all cells at which the curve is read.
pub const SHARES: [u32; 8] = [30, 40, 50, 60, 70, 75, 80, 85];

/// The most probable answer of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellAnswer {
    /// Probability stated.
    pub confidence: f32,
    /// `|reported - true|` in px, where there is truth.
    pub error: Option<f32>,
}

/// The answers of a frame, and how many cells it has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellAnswers {
    /// Of the cells with an answer, row by row.
    pub answers: Vec<CellAnswer>,
    /// All cells.
    pub cells: usize,
}

/// One reading of the curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CellRow {
    /// Percent of all cells.
    pub percent: u32,
    /// Least probability among them; `None` where fewer cells have an answer.
    pub least_probability: Option<f32>,
    /// Percent of those with truth that are more than 1 px off.
    pub bad1: Option<f64>,
    /// More than 2 px off.
    pub bad2: Option<f64>,
}

impl CellAnswers {
    pub(super) fn new(truth: &Truth, points: &[Point]) -> Self {
        let dims = truth.dims();
        let (columns, rows) =
            (usize::from(dims.width).div_ceil(CELL), usize::from(dims.height).div_ceil(CELL));
        let mut best: Vec<Option<&Point>> = vec![None; columns * rows];
        for point in points {
            let cell = usize::from(point.y) / CELL * columns + usize::from(point.x) / CELL;
            // Of equal ones the first: lists are in the order of their probability.
            if let Some(best) = best.get_mut(cell)
                && best.is_none_or(|best| point.confidence > best.confidence)
            {
                *best = Some(point);
            }
        }
        let answer = |point: &Point| CellAnswer {
            confidence: point.confidence.to_num(),
            error: truth
                .disparity(point.x.into(), point.y.into())
                .map(|truth| (point.disparity.to_num::<f32>() - truth).abs()),
        };
        Self { answers: best.into_iter().flatten().map(answer).collect(), cells: columns * rows }
    }
}

/// The curve of frames together.
pub(super) fn curve<'a>(frames: impl Iterator<Item = &'a CellAnswers>) -> Vec<CellRow> {
    let (mut answers, mut cells) = (Vec::new(), 0);
    for frame in frames {
        answers.extend_from_slice(&frame.answers);
        cells += frame.cells;
    }
    answers.sort_by(|a, b| b.confidence.total_cmp(&a.confidence)); // stable: ties stay in scene order
    let row = |percent: u32| {
        let wanted = cells * percent as usize / 100;
        let enough = 100 * answers.len() >= cells * percent as usize;
        let first = answers.get(..wanted).filter(|first| enough && !first.is_empty());
        let errors: Vec<f32> =
            first.unwrap_or(&[]).iter().filter_map(|answer| answer.error).collect();
        let bad = |limit: f32| {
            let wrong = errors.iter().filter(|&&error| error > limit).count();
            (!errors.is_empty()).then(|| 100.0 * wrong as f64 / errors.len() as f64)
        };
        let least_probability =
            first.and_then(<[CellAnswer]>::last).map(|answer| answer.confidence);
        CellRow { percent, least_probability, bad1: bad(1.0), bad2: bad(2.0) }
    };
    SHARES.into_iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::super::frame::tests::{answer, truth};
    use super::*;

    #[test]
    fn the_most_probable_claim_of_a_cell_is_its_only_one() {
        // 40 x 33 px are 3 x 3 cells, those at two borders cut off.
        let points = [
            answer(3, 3, 8.0, 0.5),
            answer(4, 3, 10.5, 0.75),
            answer(39, 32, 13.5, 0.25),
            answer(0, 20, 8.0, 0.9),
        ];
        let found = CellAnswers::new(&truth(), &points);
        assert_eq!(found.cells, 9);
        let errors: Vec<_> = found.answers.iter().map(|answer| answer.error).collect();
        assert_eq!(errors, [Some(2.5), None, Some(1.5)]);
    }

    #[test]
    fn the_curve_is_read_at_shares_of_all_cells() {
        let answers = (0..7_u8).map(|i| CellAnswer {
            confidence: 1.0 - f32::from(i) / 16.0,
            error: (i != 2).then_some(if i < 4 { 0.5 } else { 1.5 }),
        });
        let frame = CellAnswers { answers: answers.collect(), cells: 10 };
        let rows = curve([&frame].into_iter());
        let bad: Vec<_> = rows.iter().map(|row| (row.percent, row.bad1, row.bad2)).collect();
        assert_eq!(bad[..2], [(30, Some(0.0), Some(0.0)), (40, Some(0.0), Some(0.0))]);
        assert_eq!(bad[4], (70, Some(50.0), Some(0.0))); // three of six; the one without truth does not count
        assert_eq!(bad[5], (75, None, None)); // seven have an answer
    }
}
