//! Edge drawing: anchors on a sparse grid of rows (columns), then the gradient's ridge is followed from each, both ways.
//!
//! In: a grey image. Out: chains of one sub-pixel position per row ([`Direction::Down`]) or per column ([`Direction::Along`]).
//!
//! # Bounds
//! Sobel of 8-bit pixels: |g| <= 1020. Positions in 1/32 px below 2^16 for images up to 2047 px.
//!
//! # Source
//! Topal, Akinlar 2012. The ridge's sub-pixel position is the vertex of the parabola through three gradients across the edge.

use super::fit::Run;
use super::{Chain, LineParams};
use crate::image::Gray;
use crate::units::quotient;

/// Rows (columns) between two scans for anchors: no more than the least extent of a segment.
const SCAN_STEP: i32 = 6;
/// Pixels next to the border that hold no edge: the ridge test reads that far.
const BORDER: i32 = 4;
const STRETCH_MASK: i32 = 15;

/// Which way an edge runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// One position per row.
    Down,
    /// One position per column.
    Along,
}

/// The image seen along one direction: `t` counts steps along the edge, `u` pixels across it.
#[derive(Clone, Copy)]
pub(crate) struct Axis {
    along: usize,
    across: usize,
    steps: i32,
    breadth: i32,
    /// Which of a pixel's two mark bits.
    bit: u32,
}

/// An image with its marks: the state of the drawing.
pub(crate) struct Edges<'a> {
    pixels: &'a [u8],
    stride: usize,
    width: i32,
    height: i32,
    anchor: i32,
    edge: i32,
    marks: &'a mut [u32],
}

/// Five pixels across an edge: smoothed along it, and the difference of the rows after and before.
struct Patch {
    smoothed: [i32; 5],
    lengthwise: [i32; 5],
}

/// Where the ridge is on one row.
struct Ridge {
    u: i32,
    position_q5: i32,
    gradient: i32,
}

impl<'a> Edges<'a> {
    pub(crate) fn new(image: Gray<'a>, params: &LineParams, marks: &'a mut [u32]) -> Self {
        let dims = image.dims();
        let (pixels, stride) = image.as_slice();
        Self {
            pixels,
            stride,
            width: dims.width.into(),
            height: dims.height.into(),
            anchor: params.anchor,
            edge: params.edge,
            marks,
        }
    }

    fn axis(&self, direction: Direction) -> Axis {
        match direction {
            Direction::Down => Axis { along: self.stride, across: 1, steps: self.height, breadth: self.width, bit: 0 },
            Direction::Along => Axis { along: 1, across: self.stride, steps: self.width, breadth: self.height, bit: 1 },
        }
    }

    /// Draws every edge of one direction and hands each chain to `emit`.
    pub(crate) fn for_each_chain(
        &mut self,
        direction: Direction,
        positions: &mut [u16],
        mut emit: impl FnMut(&mut Self, Axis, Chain<'_>),
    ) {
        let axis = self.axis(direction);
        let mut t = BORDER;
        while t < axis.steps - BORDER {
            // One new column sum per pixel: the gradient at u is the sum at u + 1 minus the sum at u - 1.
            let [mut sum_here, mut sum_next] = [BORDER, BORDER + 1].map(|u| self.smoothed(axis, t, u));
            let mut here = sum_next - self.smoothed(axis, t, BORDER - 1);
            let mut before = 0;
            let mut best = (0, 0, 0);
            let mut index = self.index(axis, t, BORDER + 2);
            for u in BORDER..axis.breadth - BORDER {
                let sum_after = self.smoothed_at(axis, index);
                index = index.wrapping_add(axis.across);
                let after = sum_after - sum_here;
                (sum_here, sum_next) = (sum_next, sum_after);
                let size = here.abs();
                if size >= self.anchor.max(best.0 + 1) && size >= before && size > after.abs() && self.is_anchor(axis, t, u, size) {
                    best = (size, u, here.signum());
                }
                if u & STRETCH_MASK == STRETCH_MASK || u + 1 == axis.breadth - BORDER {
                    if best.0 > 0 && let Some(chain) = self.draw(axis, t, best.1, best.2, positions) {
                        emit(self, axis, chain);
                    }
                    best = (0, 0, 0);
                }
                before = size;
                here = after;
            }
            t += SCAN_STEP;
        }
    }

    fn is_anchor(&self, axis: Axis, t: i32, u: i32, size: i32) -> bool {
        self.lengthwise(axis, t, u).abs() <= size && !self.marked(axis, t, u)
    }

    /// Follows the ridge from an anchor in both ways; the positions of rows `first..` end up in `positions[first..]`.
    fn draw<'p>(&mut self, axis: Axis, t: i32, u: i32, sign: i32, positions: &'p mut [u16]) -> Option<Chain<'p>> {
        let anchor = self.ridge(axis, t, u, sign)?;
        self.keep(axis, t, &anchor, positions);
        let (mut sum, mut first, mut last) = (anchor.gradient, t, t);
        for step in [-1, 1] {
            let (mut at, mut ridge_u) = (t + step, anchor.u);
            while (BORDER..axis.steps - BORDER).contains(&at) {
                let Some(ridge) = self.ridge(axis, at, ridge_u, sign) else { break };
                self.keep(axis, at, &ridge, positions);
                sum += ridge.gradient;
                ridge_u = ridge.u;
                if step < 0 {
                    first = at
                } else {
                    last = at
                }
                at += step;
            }
        }
        let range = usize::try_from(first).ok()?..usize::try_from(last + 1).ok()?;
        let mean = quotient(sum, last - first + 1);
        Some(Chain {
            first,
            positions: positions.get(range)?,
            rising: sign > 0,
            contrast: u8::try_from(mean >> 2).unwrap_or(u8::MAX),
        })
    }

    fn keep(&mut self, axis: Axis, t: i32, ridge: &Ridge, positions: &mut [u16]) {
        self.mark(axis, t, ridge.u);
        if let Some(slot) = usize::try_from(t).ok().and_then(|t| positions.get_mut(t)) {
            *slot = u16::try_from(ridge.position_q5).unwrap_or(u16::MAX);
        }
    }

    /// The ridge at row `t` next to column `u`: the largest of three gradients of the right sign, unless it is too small, lies
    /// along the other direction, or was drawn before.
    fn ridge(&self, axis: Axis, t: i32, u: i32, sign: i32) -> Option<Ridge> {
        if !(BORDER..axis.breadth - BORDER).contains(&u) {
            return None;
        }
        let patch = self.patch(axis, t, u)?;
        let [b, c, d, e, f] = patch.smoothed;
        let [g1, g2, g3] = [(d - b) * sign, (e - c) * sign, (f - d) * sign];
        let [d1, d2, d3, d4, d5] = patch.lengthwise;
        let (shift, low, mid, high, lengthwise) = if g2 >= g1 && g2 >= g3 {
            (0, g1, g2, g3, d2 + 2 * d3 + d4)
        } else if g1 >= g3 {
            (-1, (c - self.smoothed(axis, t, u - 3)) * sign, g1, g2, d1 + 2 * d2 + d3)
        } else {
            (1, g2, g3, (self.smoothed(axis, t, u + 3) - e) * sign, d3 + 2 * d4 + d5)
        };
        let u = u + shift;
        if mid < self.edge || lengthwise.abs() > 2 * mid || self.marked(axis, t, u) {
            return None;
        }
        // Vertex of the parabola through (-1, low), (0, mid), (1, high), in 1/32 px.
        let curvature = 2 * mid - low - high;
        let offset_q5 = if curvature > 0 { quotient((high - low) << 4, curvature).clamp(-16, 16) } else { 0 };
        Some(Ridge { u, position_q5: (u << 5) + offset_q5, gradient: mid })
    }

    /// Marks the pixels of a run for the other direction as well, so that no edge near 45 degrees is listed twice.
    pub(crate) fn claim(&mut self, axis: Axis, chain: Chain<'_>, run: &Run) {
        let other = Axis { bit: axis.bit ^ 1, ..axis };
        for t in run.first..=run.last {
            let u = (run.at_q5(t) + 16) >> 5;
            for k in -1..=1 {
                self.mark(other, chain.first + t, u + k);
            }
        }
    }

    #[inline]
    fn pixel(&self, axis: Axis, t: i32, u: i32) -> i32 {
        // A negative position wraps to an index beyond the slice: reads as 0, and callers keep BORDER away.
        self.pixels.get(self.index(axis, t, u)).copied().unwrap_or(0).into()
    }

    /// [1 2 1] along the edge.
    #[inline]
    fn smoothed(&self, axis: Axis, t: i32, u: i32) -> i32 {
        self.smoothed_at(axis, self.index(axis, t, u))
    }

    #[inline]
    fn smoothed_at(&self, axis: Axis, index: usize) -> i32 {
        let pixel = |index: usize| i32::from(self.pixels.get(index).copied().unwrap_or(0));
        pixel(index.wrapping_sub(axis.along)) + 2 * pixel(index) + pixel(index.wrapping_add(axis.along))
    }

    /// Three rows by five pixels around `(t, u)`.
    #[inline]
    fn patch(&self, axis: Axis, t: i32, u: i32) -> Option<Patch> {
        let first = self.index(axis, t - 1, u - 2);
        let mut patch = Patch { smoothed: [0; 5], lengthwise: [0; 5] };
        let out = patch.smoothed.iter_mut().zip(&mut patch.lengthwise);
        let both = |a: u8, b: u8, c: u8| {
            let (a, b, c) = (i32::from(a), i32::from(b), i32::from(c));
            (a + 2 * b + c, c - a)
        };
        if axis.across == 1 {
            let row = |start: usize| self.pixels.get(start..).and_then(|row| row.first_chunk::<5>());
            let second = first.wrapping_add(axis.along);
            let (above, here, below) = (row(first)?, row(second)?, row(second.wrapping_add(axis.along))?);
            for ((((s, l), &a), &b), &c) in out.zip(above).zip(here).zip(below) {
                (*s, *l) = both(a, b, c);
            }
        } else {
            let mut start = first;
            for (s, l) in out {
                let &[a, b, c] = self.pixels.get(start..)?.first_chunk::<3>()?;
                (*s, *l) = both(a, b, c);
                start = start.wrapping_add(axis.across);
            }
        }
        Some(patch)
    }

    #[inline]
    fn index(&self, axis: Axis, t: i32, u: i32) -> usize {
        (t as usize).wrapping_mul(axis.along).wrapping_add((u as usize).wrapping_mul(axis.across))
    }

    /// Sobel gradient along the edge.
    #[inline]
    fn lengthwise(&self, axis: Axis, t: i32, u: i32) -> i32 {
        let side = |t: i32| self.pixel(axis, t, u - 1) + 2 * self.pixel(axis, t, u) + self.pixel(axis, t, u + 1);
        side(t + 1) - side(t - 1)
    }

    /// Word and bit of a mark. A pixel has the same two bits whichever direction looks at it.
    fn mark_at(&self, axis: Axis, t: i32, u: i32) -> (usize, u32) {
        let (x, y) = if axis.across == 1 { (u, t) } else { (t, u) };
        let bit = (y.wrapping_mul(self.width).wrapping_add(x) as usize).wrapping_mul(2);
        (bit >> 5, 1 << ((bit as u32 & 31) | axis.bit))
    }

    fn marked(&self, axis: Axis, t: i32, u: i32) -> bool {
        let (word, bit) = self.mark_at(axis, t, u);
        self.marks.get(word).is_none_or(|w| w & bit != 0)
    }

    fn mark(&mut self, axis: Axis, t: i32, u: i32) {
        let (word, bit) = self.mark_at(axis, t, u);
        if let Some(w) = self.marks.get_mut(word) {
            *w |= bit;
        }
    }
}
