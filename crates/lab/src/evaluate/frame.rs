//! The score of one frame.

use crate::bench::Cells;
use linestereo::results::Match;
use linestereo_frames::Truth;
use linestereo_frames::statistics::median;
use linestereo_sim::engine::FrameResult;

/// Side of a coverage cell, px; those that the right and lower border cut off do not count.
const CELL: usize = 16;
/// A segment with `|dx|` above this many times `|dy|` is near-horizontal: its neighbours across the
/// edge are above and below.
const STEEP_LIMIT: f64 = 4.0;

/// A point that has ground truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointScore {
    /// Probability stated.
    pub confidence: f32,
    /// `|reported - true|` in px.
    pub error: f32,
    /// The true match is visible in the right image.
    pub visible: bool,
}

/// Score of one frame's result against its truth.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameScore {
    /// Segments reported, with truth or without.
    pub segments: usize,
    /// Confidence of every point, with truth or without.
    pub confidences: Vec<f32>,
    /// Of each segment with truth the median of its errors along it, in px.
    pub segment_errors: Vec<f32>,
    /// Points with truth.
    pub scored_points: Vec<PointScore>,
    /// Highest probability stated in each coverage cell that counts, `None` where nothing is.
    pub(super) cells: Vec<Option<f32>>,
    /// The most probable answer of each cell.
    pub(super) cell_answers: Cells,
    /// Time of the pair in milliseconds, if it was measured.
    pub milliseconds: Option<f64>,
}

impl FrameScore {
    /// Scores one result.
    pub fn new(truth: &Truth, result: &FrameResult) -> Self {
        let scored_points = result
            .points
            .iter()
            .filter_map(|point| {
                let (x, y) = (i32::from(point.x), i32::from(point.y));
                Some(PointScore {
                    confidence: point.confidence.to_num(),
                    error: (point.disparity.to_num::<f32>() - truth.disparity(x, y)?).abs(),
                    visible: truth.is_visible(x, y),
                })
            })
            .collect();
        let medians = result
            .matches
            .iter()
            .map(|segment| median(segment_errors(truth, segment), f32::total_cmp));
        Self {
            segments: result.matches.len(),
            confidences: result.points.iter().map(|point| point.confidence.to_num()).collect(),
            segment_errors: medians.flatten().collect(),
            scored_points,
            milliseconds: None,
            cell_answers: Cells::of_points(&result.points, truth),
            cells: cells(truth, result),
        }
    }
}

/// Errors at the pixels along a segment that have truth within 1 px across it.
fn segment_errors(truth: &Truth, segment: &Match) -> Vec<f32> {
    let [start, end] = segment.ends.map(|end| [end.x.to_num::<f64>(), end.y.to_num::<f64>()]);
    let [from, to] = segment.disparity.map(|d| d.to_num::<f64>());
    let steep = (end[0] - start[0]).abs() <= STEEP_LIMIT * (end[1] - start[1]).abs();
    let (along, across) = if steep { (1, 0) } else { (0, 1) };
    let (low, high) = (start[along].min(end[along]), start[along].max(end[along]));
    let length = end[along] - start[along];
    let mut errors = Vec::new();
    for step in low.round() as i32..=high.round() as i32 {
        let t = if length == 0.0 {
            0.5
        } else {
            ((f64::from(step) - start[along]) / length).clamp(0.0, 1.0)
        };
        let edge = (start[across] + t * (end[across] - start[across])).round() as i32;
        let disparity = (from + t * (to - from)) as f32;
        let nearest = (edge - 1..=edge + 1)
            .filter_map(|side| {
                if steep { truth.disparity(side, step) } else { truth.disparity(step, side) }
            })
            .map(|d| (disparity - d).abs())
            .reduce(f32::min);
        errors.extend(nearest);
    }
    errors
}

/// The cells that count; what is cut off at the right and lower border does not.
fn cells(truth: &Truth, result: &FrameResult) -> Vec<Option<f32>> {
    let dims = truth.dims();
    let (columns, rows) = (usize::from(dims.width) / CELL, usize::from(dims.height) / CELL);
    let mut best: Vec<Option<f32>> = vec![None; columns * rows];
    for point in &result.points {
        let (column, row) = (usize::from(point.x) / CELL, usize::from(point.y) / CELL);
        if column < columns && row < rows {
            let confidence = point.confidence.to_num::<f32>();
            let cell = &mut best[row * columns + column];
            *cell = Some(cell.map_or(confidence, |other| other.max(confidence)));
        }
    }
    let counts = |cell: usize| {
        let (left, top) = (cell % columns * CELL, cell / columns * CELL);
        let visible = (0..CELL * CELL)
            .filter(|i| truth.is_visible((left + i % CELL) as i32, (top + i / CELL) as i32))
            .count();
        2 * visible >= CELL * CELL
    };
    (0..columns * rows).filter(|&cell| counts(cell)).map(|cell| best[cell]).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use linestereo::Dims;
    use linestereo::results::{ImagePosition, Owner, Point, Techniques};
    use linestereo::units::{Confidence, Disparity, Position};

    pub(in crate::evaluate) fn segment(ends: [[f64; 2]; 2], disparity: [f64; 2]) -> Match {
        let point =
            |[x, y]: [f64; 2]| ImagePosition { x: Position::from_num(x), y: Position::from_num(y) };
        let disparity = disparity.map(Disparity::from_num);
        Match {
            ends: ends.map(point),
            disparity,
            sigma: Disparity::from_num(0.25),
            confidence: Confidence::from_num(0.9375),
            owner: Owner::Both,
            depth: None,
            depth_sigma: None,
            techniques: Techniques { feature: None, window: disparity[0], census: disparity[0] },
        }
    }

    pub(in crate::evaluate) fn answer(x: u16, y: u16, disparity: f64, confidence: f64) -> Point {
        let (disparity, confidence) =
            (Disparity::from_num(disparity), Confidence::from_num(confidence));
        Point { x, y, disparity, confidence, source: linestereo::results::Source::Segment(0) }
    }

    pub(in crate::evaluate) fn result(matches: Vec<Match>, points: Vec<Point>) -> FrameResult {
        FrameResult { matches, ..FrameResult::of_points(points) }
    }

    /// 40 x 33 px; disparity 8 left of column 20 and 12 from there on, unknown in the first column,
    /// hidden below row 16.
    pub(in crate::evaluate) fn truth() -> Truth {
        let dims = Dims { width: 40, height: 33 };
        let pixels = || (0..33).flat_map(|y| (0..40).map(move |x| (x, y)));
        let disparity = |(x, _)| match x {
            0 => f32::NAN,
            1..20 => 8.0,
            _ => 12.0,
        };
        Truth::new(dims, pixels().map(disparity).collect(), pixels().map(|(_, y)| y < 16).collect())
    }

    #[test]
    fn steep_segments_are_scored_against_the_nearest_side() {
        // On the edge: the right surface is 1 px across, so 12.5 is 0.5 off and not 4.5.
        let errors = segment_errors(&truth(), &segment([[19.0, 2.0], [19.0, 9.0]], [12.5, 12.5]));
        assert_eq!(errors, [0.5; 8]);
        // Two px away it is not.
        let errors = segment_errors(&truth(), &segment([[18.0, 2.0], [18.0, 9.0]], [12.5, 12.5]));
        assert_eq!(errors, [4.5; 8]);
        // Without truth within 1 px: nothing to say.
        let mut dark = segment_errors(&truth(), &segment([[0.0, 2.0], [0.0, 4.0]], [8.0, 8.0]));
        dark.dedup();
        assert_eq!(dark, [0.0]); // column 1 is known
    }

    #[test]
    fn near_horizontal_segments_look_above_and_below() {
        let errors = segment_errors(&truth(), &segment([[17.0, 5.0], [20.0, 5.0]], [8.0, 8.0]));
        assert_eq!(errors, [0.0, 0.0, 0.0, 4.0]); // horizontal neighbours would have made the last one 0
    }

    #[test]
    fn disparity_is_linear_along_the_segment() {
        let errors = segment_errors(&truth(), &segment([[5.0, 0.0], [5.0, 8.0]], [8.0, 12.0]));
        assert_eq!(errors, [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0]);
        assert_eq!(median(errors, f32::total_cmp), Some(2.0));
    }

    #[test]
    fn points_without_truth_are_in_the_yield_only() {
        let points =
            vec![answer(0, 3, 8.0, 0.5), answer(5, 3, 8.25, 0.75), answer(5, 20, 10.0, 0.25)];
        let score = FrameScore::new(&truth(), &result(vec![], points));
        assert_eq!(score.confidences, [0.5, 0.75, 0.25]);
        let expected = [
            PointScore { confidence: 0.75, error: 0.25, visible: true },
            PointScore { confidence: 0.25, error: 2.0, visible: false },
        ];
        assert_eq!(score.scored_points, expected);
    }

    #[test]
    fn cells_count_by_visible_truth() {
        // 2 x 2 whole cells; the lower two are hidden, so two count. Column 39 lies outside every
        // whole cell.
        let points = vec![
            answer(3, 3, 8.0, 0.25),
            answer(4, 3, 8.0, 0.5),
            answer(39, 3, 8.0, 0.5),
            answer(3, 20, 8.0, 0.5),
        ];
        let score = FrameScore::new(&truth(), &result(vec![], points));
        assert_eq!(score.cells, [Some(0.5), None]);
    }
}
