//! Frames, scratch memory and output of a board, with its capacities in the type.

use crate::ports::Results;
use linestereo::{Dims, Gray, Observer, Output, Params, PointClaim, Scratch, ViewError, Views, mark_words, row_bytes};
use linestereo::{ParamError, SizeMismatch};

/// All memory of one board that depends on the size of frames. All zero when new, so that it takes no flash.
#[derive(Debug)]
pub struct Workspace<
    const PIXELS: usize,
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const MATCHES: usize,
    const POINTS: usize,
> {
    left: [u8; PIXELS],
    right: [u8; PIXELS],
    scratch: Scratch<ROW, MARKS, SEGMENTS, CANDIDATES>,
    output: Output<MATCHES, POINTS>,
}

/// A [`Workspace`] without its capacities.
pub trait Memory {
    /// Do frames of this size fit?
    fn fits(&self, dims: Dims) -> bool;

    /// The memories of the left and the right frame.
    fn frames(&mut self) -> [&mut [u8]; 2];

    /// The pair that lies in the frames.
    fn views(&self, dims: Dims) -> Result<[Gray<'_>; 2], RunError>;

    /// Matches the pair that lies in the frames.
    fn run(&mut self, params: &Params, dims: Dims, observer: &mut impl Observer) -> Result<(), RunError>;

    /// What the last run gave.
    fn results(&self) -> Results<'_>;

    /// Every point of the last run, which had these parameters and this size.
    fn for_each_point(&mut self, params: &Params, dims: Dims, claim: impl FnMut(PointClaim));
}

/// Why a pair that lies in the frames cannot be matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunError {
    /// The core or this board has no frames of this size.
    Size(Dims),
    /// A parameter is unusable.
    Params(ParamError),
}

impl From<ViewError> for RunError {
    fn from(error: ViewError) -> Self {
        match error {
            ViewError::Dims(dims) => Self::Size(dims),
            _ => Self::Size(Dims { width: 0, height: 0 }),
        }
    }
}

impl<
    const PIXELS: usize,
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const MATCHES: usize,
    const POINTS: usize,
> Workspace<PIXELS, ROW, MARKS, SEGMENTS, CANDIDATES, MATCHES, POINTS>
{
    /// Bytes of one.
    pub const BYTES: usize = size_of::<Self>();

    /// Cleared memory.
    #[must_use]
    pub const fn new() -> Self {
        Self { left: [0; PIXELS], right: [0; PIXELS], scratch: Scratch::new(), output: Output::new() }
    }
}

impl<
    const PIXELS: usize,
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const MATCHES: usize,
    const POINTS: usize,
> Default for Workspace<PIXELS, ROW, MARKS, SEGMENTS, CANDIDATES, MATCHES, POINTS>
{
    fn default() -> Self {
        Self::new()
    }
}

impl<
    const PIXELS: usize,
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const MATCHES: usize,
    const POINTS: usize,
> Memory for Workspace<PIXELS, ROW, MARKS, SEGMENTS, CANDIDATES, MATCHES, POINTS>
{
    fn fits(&self, dims: Dims) -> bool {
        row_bytes(dims.width) <= ROW
            && mark_words(dims) <= MARKS
            && usize::from(dims.width) * usize::from(dims.height) <= PIXELS
    }

    fn frames(&mut self) -> [&mut [u8]; 2] {
        [&mut self.left, &mut self.right]
    }

    fn views(&self, dims: Dims) -> Result<[Gray<'_>; 2], RunError> {
        if !self.fits(dims) {
            return Err(RunError::Size(dims));
        }
        let stride = usize::from(dims.width);
        Ok([Gray::new(&self.left, dims, stride)?, Gray::new(&self.right, dims, stride)?])
    }

    fn run(&mut self, params: &Params, dims: Dims, observer: &mut impl Observer) -> Result<(), RunError> {
        if !self.fits(dims) {
            return Err(RunError::Size(dims));
        }
        let plan = params.plan(dims).map_err(RunError::Params)?;
        let stride = usize::from(dims.width);
        let (left, right) = (Gray::new(&self.left, dims, stride)?, Gray::new(&self.right, dims, stride)?);
        plan.run_observed(left, right, &mut self.scratch, &mut self.output, observer)
            .map_err(|SizeMismatch { given, .. }| RunError::Size(given))
    }

    fn for_each_point(&mut self, params: &Params, dims: Dims, claim: impl FnMut(PointClaim)) {
        if let Ok(plan) = params.plan(dims) {
            plan.for_each_point(Views::whole(dims), &mut self.scratch, claim);
        }
    }

    fn results(&self) -> Results<'_> {
        Results { matches: &self.output.matches, points: &self.output.points, counts: &self.output.counts }
    }
}

#[cfg(target_os = "none")]
mod taken {
    //! The one workspace of the board that is built.

    use crate::boards::Selected;
    use core::cell::UnsafeCell;
    use core::sync::atomic::{AtomicBool, Ordering};

    struct Cell(UnsafeCell<Selected>);

    // SAFETY: only `take` reaches the content, and hands it out once.
    unsafe impl Sync for Cell {}

    static WORKSPACE: Cell = Cell(UnsafeCell::new(Selected::new()));
    static TAKEN: AtomicBool = AtomicBool::new(false);

    /// The board's memory; `None` when it was taken before.
    pub fn take() -> Option<&'static mut Selected> {
        if TAKEN.swap(true, Ordering::Relaxed) {
            return None;
        }
        // SAFETY: `TAKEN` was false until now, so this is the only reference there will ever be.
        Some(unsafe { &mut *WORKSPACE.0.get() })
    }
}
#[cfg(target_os = "none")]
pub use taken::take;
