//! Scores of any number of frames, pooled.

use super::frame::{FrameScore, PointScore};
use crate::bench::Cells;
use linestereo_frames::statistics::median;
use serde::Serialize;

/// Points per frame at which the error-against-yield curve is read.
pub const YIELDS: [usize; 4] = [800, 1500, 3000, 5000];
/// Borders of the bins of stated probability; a bin holds its lower border, the last one its upper
/// one too.
const PROBABILITY_EDGES: [f32; 7] = [0.0, 0.5, 0.8, 0.9, 0.95, 0.98, 1.0];
/// Fewer answers than this in a bin say little of it.
const BIN: usize = 1000;
/// Answers at least this probable have a row of their own.
const SURE: f32 = 0.9;

/// Percentages of points that are wrong; `None` where there is no point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorRates {
    /// Visible points more than 1 px off.
    pub vis_bad1: Option<f64>,
    /// Visible points more than 2 px off.
    pub vis_bad2: Option<f64>,
    /// All points with truth more than 1 px off.
    pub all_gt_bad1: Option<f64>,
    /// All points with truth more than 2 px off.
    pub all_gt_bad2: Option<f64>,
}

/// Yield and errors of a set of answers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Answers {
    /// Points per frame, with truth or without.
    pub points_per_frame: f64,
    /// Percentage of the counting 16x16 cells that hold an answer.
    pub cells_percent: Option<f64>,
    /// Percentages that are wrong.
    #[serde(flatten)]
    pub errors: ErrorRates,
}

/// One reading of the error-against-yield curve: the most confident points of all frames together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct YieldRow {
    /// Points with truth per frame asked for.
    pub points_per_frame: usize,
    /// Points with truth per frame there are; less than wanted when the frames do not hold as many.
    pub available_per_frame: f64,
    /// Least probability among them.
    pub least_probability: Option<f32>,
    /// Percentages that are wrong.
    #[serde(flatten)]
    pub errors: ErrorRates,
}

/// One answer per cell: errors of the surest of all cells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CellRow {
    /// Percent of all cells.
    pub percent: usize,
    /// Percent of those with truth that are more than 1 px off; `None` where fewer cells have an
    /// answer.
    pub bad1: Option<f64>,
    /// More than 2 px off.
    pub bad2: Option<f64>,
}

/// Stated against observed: how often answers of a range of probability were within 1 px.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BinRow {
    /// Lower border of the bin.
    pub low: f32,
    /// Upper border.
    pub high: f32,
    /// Points with truth in it.
    pub points: usize,
    /// Their mean stated probability.
    pub stated: Option<f64>,
    /// Share of them within 1 px of the truth, hidden ones included.
    pub observed: Option<f64>,
}

/// Scores of any number of frames, pooled.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Frames in it.
    pub frames: usize,
    /// Segments reported per frame.
    pub segments_per_frame: f64,
    /// Percentage of segments whose median error is at most 1 px.
    pub segprec1: Option<f64>,
    /// Percentage of segments whose median error is at most 2 px.
    pub segprec2: Option<f64>,
    /// Every answer.
    pub all: Answers,
    /// Answers with a probability of at least 0.9.
    pub sure: Answers,
    /// Errors against yield at [`YIELDS`].
    pub curve: Vec<YieldRow>,
    /// One answer per cell: errors against the share of all cells.
    pub cells: Vec<CellRow>,
    /// Stated against observed probability, by bins.
    pub calibration: Vec<BinRow>,
    /// Largest excess of stated over observed probability, percent, of the bins with at least 1000
    /// answers.
    pub overconfidence: Option<f64>,
    /// Median error of visible points in px.
    pub median_error_px: Option<f64>,
    /// Median over the frames of the time per pair in milliseconds.
    pub milliseconds: Option<f64>,
}

impl Summary {
    /// Pools the scores of frames: points with points, segments with segments, cells with cells.
    pub fn pool<'a>(scores: impl IntoIterator<Item = &'a FrameScore>) -> Self {
        let scores: Vec<&FrameScore> = scores.into_iter().collect();
        let frames = scores.len();
        let mut points: Vec<PointScore> =
            scores.iter().flat_map(|score| score.scored_points.iter().copied()).collect();
        points.sort_by(|a, b| b.confidence.total_cmp(&a.confidence)); // stable: ties stay in scene order
        let segments: Vec<f32> =
            scores.iter().flat_map(|score| score.segment_errors.iter().copied()).collect();
        let segments_within = |limit: f32| percent(&segments, |&error| error <= limit);
        let visible: Vec<f32> =
            points.iter().filter(|point| point.visible).map(|point| point.error).collect();
        let times: Vec<f32> =
            scores.iter().filter_map(|score| score.milliseconds.map(|ms| ms as f32)).collect();
        let calibration: Vec<BinRow> = PROBABILITY_EDGES
            .windows(2)
            .map(|edges| bin_row(&points, edges[0], edges[1]))
            .collect();
        Self {
            frames,
            segments_per_frame: scores.iter().map(|score| score.segments).sum::<usize>() as f64
                / frames.max(1) as f64,
            segprec1: segments_within(1.0),
            segprec2: segments_within(2.0),
            all: answers(&scores, &points, 0.0),
            sure: answers(&scores, &points, SURE),
            curve: YIELDS.iter().map(|&wanted| yield_row(&points, frames, wanted)).collect(),
            cells: cell_rows(&scores),
            overconfidence: overconfidence(&calibration),
            calibration,
            median_error_px: median(visible, f32::total_cmp).map(f64::from),
            milliseconds: median(times, f32::total_cmp).map(f64::from),
        }
    }
}

fn percent<T>(items: &[T], is: impl Fn(&T) -> bool) -> Option<f64> {
    (!items.is_empty())
        .then(|| 100.0 * items.iter().filter(|item| is(item)).count() as f64 / items.len() as f64)
}

fn error_rates(points: &[PointScore]) -> ErrorRates {
    let visible: Vec<PointScore> = points.iter().copied().filter(|point| point.visible).collect();
    ErrorRates {
        vis_bad1: percent(&visible, |point| point.error > 1.0),
        vis_bad2: percent(&visible, |point| point.error > 2.0),
        all_gt_bad1: percent(points, |point| point.error > 1.0),
        all_gt_bad2: percent(points, |point| point.error > 2.0),
    }
}

fn cell_rows(scores: &[&FrameScore]) -> Vec<CellRow> {
    let mut cells = Cells::default();
    scores.iter().for_each(|score| cells.join(&score.cell_answers));
    let row = |(percent, rates): (usize, Option<[f64; 2]>)| CellRow {
        percent,
        bad1: rates.map(|[bad1, _]| bad1),
        bad2: rates.map(|[_, bad2]| bad2),
    };
    cells.curve().map(row).collect()
}

/// `points` are the most confident first.
fn answers(scores: &[&FrameScore], points: &[PointScore], least: f32) -> Answers {
    let reported: usize =
        scores.iter().map(|score| score.confidences.iter().filter(|&&p| p >= least).count()).sum();
    let cells: Vec<Option<f32>> =
        scores.iter().flat_map(|score| score.cells.iter().copied()).collect();
    Answers {
        points_per_frame: reported as f64 / scores.len().max(1) as f64,
        cells_percent: percent(&cells, |best| best.is_some_and(|p| p >= least)),
        errors: error_rates(&points[..points.partition_point(|point| point.confidence >= least)]),
    }
}

fn yield_row(points: &[PointScore], frames: usize, wanted: usize) -> YieldRow {
    let top = &points[..points.len().min(wanted * frames)];
    YieldRow {
        points_per_frame: wanted,
        available_per_frame: top.len() as f64 / frames.max(1) as f64,
        least_probability: top.last().map(|point| point.confidence),
        errors: error_rates(top),
    }
}

fn overconfidence(bins: &[BinRow]) -> Option<f64> {
    let excess = |bin: &BinRow| Some(100.0 * (bin.stated? - bin.observed?));
    bins.iter().filter(|bin| bin.points >= BIN).filter_map(excess).reduce(f64::max)
}

fn bin_row(points: &[PointScore], low: f32, high: f32) -> BinRow {
    let inside = |p: f32| p >= low && (p < high || high >= 1.0);
    let bin: Vec<PointScore> =
        points.iter().copied().filter(|point| inside(point.confidence)).collect();
    let stated: f64 = bin.iter().map(|point| f64::from(point.confidence)).sum();
    BinRow {
        low,
        high,
        points: bin.len(),
        stated: (!bin.is_empty()).then(|| stated / bin.len() as f64),
        observed: percent(&bin, |point| point.error <= 1.0).map(|percent| percent / 100.0),
    }
}

#[cfg(test)]
mod tests {
    use super::super::frame::tests::{answer, result, segment, truth};
    use super::*;

    #[test]
    fn frames_are_pooled_point_by_point() {
        let truth = truth();
        let first = result(
            vec![
                segment([[5.0, 1.0], [5.0, 9.0]], [8.5, 8.5]),
                segment([[5.0, 1.0], [5.0, 9.0]], [9.5, 9.5]),
            ],
            vec![
                answer(5, 3, 8.0, 0.96875),
                answer(6, 3, 9.5, 0.9375),
                answer(7, 20, 10.5, 0.75),
                answer(0, 3, 1.0, 0.5),
            ],
        );
        let second = result(
            vec![segment([[5.0, 1.0], [5.0, 9.0]], [12.0, 12.0])],
            vec![answer(25, 3, 12.0, 0.25)],
        );
        let scores = [first, second].map(|result| FrameScore::new(&truth, &result));
        let summary = Summary::pool(&scores);

        assert_eq!((summary.frames, summary.segments_per_frame), (2, 1.5));
        assert_eq!((summary.segprec1, summary.segprec2), (Some(100.0 / 3.0), Some(200.0 / 3.0)));
        assert_eq!((summary.all.points_per_frame, summary.sure.points_per_frame), (2.5, 1.0));
        assert_eq!(
            (summary.all.cells_percent, summary.sure.cells_percent),
            (Some(50.0), Some(25.0))
        );
        let errors = ErrorRates {
            vis_bad1: Some(100.0 / 3.0),
            vis_bad2: Some(0.0),
            all_gt_bad1: Some(50.0),
            all_gt_bad2: Some(25.0),
        };
        assert_eq!(summary.all.errors, errors);
        assert_eq!(summary.sure.errors.all_gt_bad1, Some(50.0));
        assert_eq!(summary.median_error_px, Some(0.0));
        assert_eq!(summary.curve[0].available_per_frame, 2.0);
        let bins: Vec<usize> = summary.calibration.iter().map(|bin| bin.points).collect();
        assert_eq!(bins, [1, 1, 0, 1, 1, 0]);
        assert_eq!(
            (summary.calibration[1].stated, summary.calibration[1].observed),
            (Some(0.75), Some(0.0))
        );
    }

    #[test]
    fn the_curve_takes_the_most_confident_first() {
        let points: Vec<PointScore> = (0..2000)
            .map(|i| PointScore {
                confidence: 1.0 - i as f32 / 4096.0,
                error: if i < 800 { 0.0 } else { 3.0 },
                visible: true,
            })
            .collect();
        assert_eq!(yield_row(&points, 1, 800).errors.vis_bad1, Some(0.0));
        assert_eq!(yield_row(&points, 1, 1500).errors.vis_bad2, Some(100.0 * 700.0 / 1500.0));
        assert_eq!(yield_row(&points, 1, 5000).available_per_frame, 2000.0);
        assert_eq!(yield_row(&points, 2, 800).errors.vis_bad1, Some(50.0));
    }

    #[test]
    fn nothing_gives_no_numbers() {
        let summary = Summary::pool([]);
        assert_eq!(
            (summary.segprec1, summary.all.cells_percent, summary.median_error_px),
            (None, None, None)
        );
    }
}
