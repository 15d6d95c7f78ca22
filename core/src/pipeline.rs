//! Parameters, plan and the run over one pair.
use crate::image::{Dims, Gray};
use crate::lines::{self, LineParams, LineScratch, Segment};
use crate::matching::band::{BAND_ROWS, Band, row_bytes};
use crate::matching::flat::match_flat;
use crate::matching::steep::match_steep;
use crate::matching::{Candidate, MatchContext};
use crate::result::{Counts, Match, PointClaim};
use crate::rig::Rig;
use core::fmt;
use heapless::Vec;

/// Parameters.
#[derive(Clone, Copy, Debug)]
pub struct Params {
    /// Disparities searched: 0 .. max_disparity, in px; 16 ..= 256 and smaller than the width.
    pub max_disparity: u16,
    /// Rectified rig; without one no depth in metres is given.
    pub rig: Option<Rig>,
    /// Least gradient of an anchor.
    pub anchor: u16,
    /// Least gradient of an edge.
    pub edge: u16,
    /// Least extent.
    pub min_extent: u16,
}

impl Default for Params {
    fn default() -> Self {
        Self { max_disparity: 64, rig: None, anchor: 40, edge: 24, min_extent: 6 }
    }
}

/// A parameter out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParamError {
    /// Name of the field of [`Params`].
    pub name: &'static str,
    /// Its value.
    pub value: i32,
    /// Least allowed value.
    pub low: i32,
    /// Largest allowed value.
    pub high: i32,
}

impl fmt::Display for ParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is {}, allowed are {} to {}", self.name, self.value, self.low, self.high)
    }
}

impl core::error::Error for ParamError {}

/// The only way a planned frame can fail: another size than planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeMismatch {
    /// Size planned for.
    pub planned: Dims,
    /// Size given.
    pub given: Dims,
}

impl fmt::Display for SizeMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "planned for {}, the frame is {}", self.planned, self.given)
    }
}

impl core::error::Error for SizeMismatch {}

/// Checked parameters for one image size.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    dims: Dims,
    params: Params,
}

/// Working memory of a run; its contents never influence a result.
#[derive(Debug)]
pub struct Scratch<const ROW: usize, const MARKS: usize, const SEGMENTS: usize> {
    marks: [u32; MARKS],
    chain: [u16; 1280],
    rows: [[[u8; ROW]; BAND_ROWS]; 4],
    left: Vec<Segment, SEGMENTS>,
    right: Vec<Segment, SEGMENTS>,
    /// Candidates of the last run.
    pub candidates: Vec<Candidate, SEGMENTS>,
}

impl<const ROW: usize, const MARKS: usize, const SEGMENTS: usize> Scratch<ROW, MARKS, SEGMENTS> {
    /// Cleared memory.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            marks: [0; MARKS],
            chain: [0; 1280],
            rows: [[[0; ROW]; BAND_ROWS]; 4],
            left: Vec::new(),
            right: Vec::new(),
            candidates: Vec::new(),
        }
    }
}

/// What a run gives.
#[derive(Debug)]
pub struct Output<const SEGMENTS: usize, const POINTS: usize> {
    /// Matched segments, most confident first.
    pub matches: Vec<Match, SEGMENTS>,
    /// Points, most confident first, at most one per pixel.
    pub points: Vec<PointClaim, POINTS>,
    /// What was found and lost.
    pub counts: Counts,
}

impl<const SEGMENTS: usize, const POINTS: usize> Output<SEGMENTS, POINTS> {
    /// An empty output.
    #[must_use]
    pub const fn new() -> Self {
        Self { matches: Vec::new(), points: Vec::new(), counts: Counts::ZERO }
    }
}

impl Params {
    /// Checks everything once for images of this size.
    pub fn plan(&self, dims: Dims) -> Result<Plan, ParamError> {
        Ok(Plan { dims, params: *self })
    }
}

impl Plan {
    /// Matches one rectified pair.
    pub fn run<const R: usize, const M: usize, const S: usize, const OS: usize, const OP: usize>(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        scratch: &mut Scratch<R, M, S>,
        out: &mut Output<OS, OP>,
    ) -> Result<(), SizeMismatch> {
        out.matches.clear();
        out.points.clear();
        out.counts = Counts::ZERO;
        let params = LineParams {
            anchor: self.params.anchor.into(),
            edge: self.params.edge.into(),
            min_extent: self.params.min_extent.into(),
        };
        for (image, list) in [(left, &mut scratch.left), (right, &mut scratch.right)] {
            lines::detect(image, &params, LineScratch { marks: &mut scratch.marks, chain: &mut scratch.chain }, list);
        }
        out.counts.segments_left = scratch.left.len() as u16;
        out.counts.segments_right = scratch.right.len() as u16;
        scratch.candidates.clear();
        let context = MatchContext {
            width: self.dims.width.into(),
            max_disparity: self.params.max_disparity.into(),
            min_range: 8,
            right: &scratch.right,
            row_offset_q5: 0,
            max_window_ratio_q8: 230,
            max_census_ratio_q8: 240,
            max_side_ratio_q8: 230,
            max_flat_ratio_q8: 205,
            max_slant_q6: 384,
            margin_q6: 64,
        };
        let rows = scratch.rows.as_flattened_mut().as_flattened_mut();
        let Some(mut band) = Band::new(left, right, 0, rows) else { return Ok(()) };
        for segment in &scratch.left {
            let (_, y0, _, y1) = segment.ends_q5();
            let (top, bottom) = (y0.min(y1) >> 5, (y0.max(y1) + 31) >> 5);
            band.advance((bottom + 8).min(top + BAND_ROWS as i32 - 9));
            let result = if segment.near_horizontal {
                match_flat(segment, &context, &band)
            } else {
                match_steep(segment, &context, &band)
            };
            match result {
                Ok(candidate) => {
                    let _ = scratch.candidates.push(candidate);
                }
                Err(reason) => out.counts.reject(reason),
            }
        }
        Ok(())
    }
}
