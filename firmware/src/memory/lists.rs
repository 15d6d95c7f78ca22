//! What the core works in and writes to, whatever its capacities are.

use crate::ports::Results;
use linestereo::{
    Dims, Focus, Gray, NotKnown, ObjectDepth, Observer, Output, PixelDepth, Plan, PointClaim, Region, RunError,
    Scratch, Views, mark_words, row_bytes,
};

/// [`Scratch`] and [`Output`] without their capacities.
pub trait Lists {
    /// Cleared, all zero.
    const CLEARED: Self;

    /// Do images of this size fit?
    fn fit(&self, dims: Dims) -> bool;

    /// Matches a pair, or parts of it.
    fn run(
        &mut self,
        plan: &Plan,
        pair: [Gray<'_>; 2],
        focus: &Focus<'_>,
        observer: &mut impl Observer,
    ) -> Result<(), RunError>;

    /// Every point of the last pair.
    fn for_each_point(&mut self, plan: &Plan, views: Views<'_>, claim: impl FnMut(PointClaim));

    /// The depth of a pixel of the last pair.
    fn depth_at(&mut self, plan: &Plan, pair: [Gray<'_>; 2], pixel: (u16, u16)) -> Result<PixelDepth, NotKnown>;

    /// Depths of these regions, by the last pair.
    fn for_each_object(&mut self, plan: &Plan, regions: &[Region<'_>], is_fit: bool, found: impl FnMut(ObjectDepth));

    /// What the last pair gave.
    fn results(&self) -> Results<'_>;

    /// The support points of the last pair that are probable enough.
    fn support_points(&self, plan: &Plan) -> impl Iterator<Item = PointClaim>;
}

/// The core's memory with its capacities.
#[derive(Debug)]
pub struct CoreMemory<
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const SUPPORT: usize,
    const MATCHES: usize,
    const POINTS: usize,
> {
    scratch: Scratch<ROW, MARKS, SEGMENTS, CANDIDATES, SUPPORT>,
    output: Output<MATCHES, POINTS>,
}

impl<
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const SUPPORT: usize,
    const MATCHES: usize,
    const POINTS: usize,
> Lists for CoreMemory<ROW, MARKS, SEGMENTS, CANDIDATES, SUPPORT, MATCHES, POINTS>
{
    const CLEARED: Self = Self { scratch: Scratch::new(), output: Output::new() };

    fn fit(&self, dims: Dims) -> bool {
        row_bytes(dims.width) <= ROW && mark_words(dims) <= MARKS
    }

    fn run(
        &mut self,
        plan: &Plan,
        [left, right]: [Gray<'_>; 2],
        focus: &Focus<'_>,
        observer: &mut impl Observer,
    ) -> Result<(), RunError> {
        plan.run_on(left, right, focus, &mut self.scratch, &mut self.output, observer)
    }

    fn for_each_point(&mut self, plan: &Plan, views: Views<'_>, claim: impl FnMut(PointClaim)) {
        plan.for_each_point(views, &mut self.scratch, claim);
    }

    fn depth_at(
        &mut self,
        plan: &Plan,
        [left, right]: [Gray<'_>; 2],
        pixel: (u16, u16),
    ) -> Result<PixelDepth, NotKnown> {
        plan.depth_at(left, right, &mut self.scratch, pixel, None)
    }

    fn for_each_object(&mut self, plan: &Plan, regions: &[Region<'_>], is_fit: bool, found: impl FnMut(ObjectDepth)) {
        plan.for_each_object(&mut self.scratch, regions, is_fit, found);
    }

    fn results(&self) -> Results<'_> {
        let Output { matches, points, counts, row_offset_q5 } = &self.output;
        Results { matches, points, counts, row_offset_q5: *row_offset_q5 }
    }

    fn support_points(&self, plan: &Plan) -> impl Iterator<Item = PointClaim> {
        plan.support_points(&self.scratch)
    }
}
