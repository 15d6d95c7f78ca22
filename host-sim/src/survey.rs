//! The nearest obstacle of a frame against its surveyed distance: for sequences whose f*B nobody knows, too.
//!
//! In: results, and a table with a distance per frame. Out: errors relative to the distance, frames without an answer, and the f*B that fits.
//!
//! ```text
//! nearest disparity = the largest that three segments reach (mean of both ends): one wrong match is no obstacle
//! f*B that fits     = median over frames of (disparity - disparity at infinity) * distance
//! ```

use crate::engine::FrameResult;
use core::fmt;
use csv::ReaderBuilder;
use linestereo_frames::statistics::{quantile, upper_median};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Number of segments that have to reach a disparity.
pub const LEAST_SUPPORT: usize = 3;

/// Why a table gives no distances.
#[derive(Debug)]
pub enum NearestError {
    /// It cannot be read.
    Read(PathBuf, String),
    /// It has no column for the number of a frame, or none for its distance.
    Columns(PathBuf),
}

impl fmt::Display for NearestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(path, what) => write!(f, "cannot read {}: {what}; give a CSV file", path.display()),
            Self::Columns(path) => write!(
                f,
                "{} has no column frame, or none whose name starts with dist; give a line of names with both",
                path.display()
            ),
        }
    }
}

impl core::error::Error for NearestError {}

/// Surveyed distances, m, by the number of the frame.
pub type Surveyed = BTreeMap<u64, f64>;

/// Reads the columns `frame` and the first whose name starts with `dist`; lines without a distance above 0 are left out.
pub fn surveyed(path: &Path) -> Result<Surveyed, NearestError> {
    let broken = |error: csv::Error| NearestError::Read(path.to_path_buf(), error.to_string());
    let mut reader = ReaderBuilder::new().flexible(true).from_path(path).map_err(broken)?;
    let head = reader.headers().map_err(broken)?;
    let columns = (head.iter().position(|name| name == "frame"), head.iter().position(|name| name.starts_with("dist")));
    let (Some(frame), Some(distance)) = columns else { return Err(NearestError::Columns(path.to_path_buf())) };
    let mut found = Surveyed::new();
    for record in reader.records() {
        let record = record.map_err(broken)?;
        let number = record.get(frame).and_then(|text| text.trim().parse().ok());
        let metres = record.get(distance).and_then(|text| text.trim().parse::<f64>().ok());
        if let (Some(number), Some(metres)) = (number, metres.filter(|metres| metres.is_finite() && *metres > 0.0)) {
            found.insert(number, metres);
        }
    }
    Ok(found)
}

/// The largest disparity, in px, that [`LEAST_SUPPORT`] segments reach.
pub fn nearest_disparity(result: &FrameResult) -> Option<f64> {
    let middle = |d: [linestereo::Disparity; 2]| 0.5 * d.iter().map(|d| d.to_num::<f64>()).sum::<f64>();
    let mut found: Vec<f64> = result.matches.iter().map(|found| middle(found.disparity)).collect();
    found.sort_by(|a, b| b.total_cmp(a));
    found.get(LEAST_SUPPORT - 1).copied()
}

/// Errors of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NearestSummary {
    /// Frames with a surveyed distance.
    pub frames: usize,
    /// Of them, frames without an answer.
    pub missed: usize,
    /// Median of the error's size over the distance.
    pub median_error: Option<f64>,
    /// 90 % of the errors are smaller.
    pub p90_error: Option<f64>,
    /// Median of answer over distance: what a wrong f*B alone would give.
    pub median_ratio: Option<f64>,
}

impl NearestSummary {
    /// Of (surveyed, measured) distances in m.
    pub fn new(distances: &[(f64, Option<f64>)]) -> Self {
        let ratios: Vec<f64> = distances.iter().filter_map(|(truth, found)| Some((*found)? / truth)).collect();
        let errors: Vec<f64> = ratios.iter().map(|ratio| (ratio - 1.0).abs()).collect();
        Self {
            frames: distances.len(),
            missed: distances.len() - ratios.len(),
            median_error: upper_median(errors.clone(), f64::total_cmp),
            p90_error: quantile(errors, 0.9, f64::total_cmp),
            median_ratio: upper_median(ratios, f64::total_cmp),
        }
    }
}

impl fmt::Display for NearestSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{:.1} %", 100.0 * value));
        write!(
            f,
            "nearest obstacle, {} frames: {} missed, error median {}, 90th percentile {}, measured / surveyed {}",
            self.frames,
            self.missed,
            percent(self.median_error),
            percent(self.p90_error),
            self.median_ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.3}"))
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_shares_of_the_distance() {
        let summary = NearestSummary::new(&[(1.0, Some(1.1)), (2.0, None), (2.0, Some(1.0)), (4.0, Some(4.0))]);
        assert_eq!((summary.frames, summary.missed), (4, 1));
        assert!((summary.median_error.unwrap() - 0.1).abs() < 1e-9);
        assert_eq!((summary.p90_error, summary.median_ratio), (Some(0.5), Some(1.0)));
        assert_eq!(NearestSummary::new(&[]).median_error, None);
    }
}
