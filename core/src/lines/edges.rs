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

/// Rows (columns) between two scans for anchors.
const SCAN_STEP: i32 = 4;
/// Pixels next to the border that hold no edge: the ridge test reads that far.
const BORDER: i32 = 4;

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
            Direction::Down => {
                Axis { along: self.stride, across: 1, steps: self.height, breadth: self.width, bit: 0 }
            }
            Direction::Along => {
                Axis { along: 1, across: self.stride, steps: self.width, breadth: self.height, bit: 1 }
            }
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
            let mut before = 0;
            let mut here = self.across(axis, t, BORDER);
            for u in BORDER..axis.breadth - BORDER {
                let after = self.across(axis, t, u + 1);
                let size = here.abs();
                if size >= self.anchor && size >= before && size > after.abs() && self.is_anchor(axis, t, u, size) {
                    let sign = here.signum();
                    if let Some(chain) = self.draw(axis, t, u, sign, positions) {
                        emit(self, axis, chain);
                    }
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
                if step < 0 { first = at } else { last = at }
                at += step;
            }
        }
        let range = usize::try_from(first).ok()?..usize::try_from(last + 1).ok()?;
        let mean = sum / (last - first + 1);
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
        let mut sums = [0_i32; 7];
        for (sum, k) in sums.iter_mut().zip(-3..) {
            *sum = self.smoothed(axis, t, u + k);
        }
        let [a, b, c, d, e, f, g] = sums;
        let gradients = [(c - a) * sign, (d - b) * sign, (e - c) * sign, (f - d) * sign, (g - e) * sign];
        let [g0, g1, g2, g3, g4] = gradients;
        let (shift, low, mid, high) = if g2 >= g1 && g2 >= g3 {
            (0, g1, g2, g3)
        } else if g1 >= g3 {
            (-1, g0, g1, g2)
        } else {
            (1, g2, g3, g4)
        };
        let u = u + shift;
        if mid < self.edge || self.lengthwise(axis, t, u).abs() > 2 * mid || self.marked(axis, t, u) {
            return None;
        }
        // Vertex of the parabola through (-1, low), (0, mid), (1, high), in 1/32 px.
        let curvature = 2 * mid - low - high;
        let offset_q5 = if curvature > 0 { (((high - low) << 4) / curvature).clamp(-16, 16) } else { 0 };
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
        let index = (t as usize).wrapping_mul(axis.along).wrapping_add((u as usize).wrapping_mul(axis.across));
        self.pixels.get(index).copied().unwrap_or(0).into()
    }

    /// [1 2 1] along the edge.
    #[inline]
    fn smoothed(&self, axis: Axis, t: i32, u: i32) -> i32 {
        self.pixel(axis, t - 1, u) + 2 * self.pixel(axis, t, u) + self.pixel(axis, t + 1, u)
    }

    /// Sobel gradient across the edge.
    #[inline]
    fn across(&self, axis: Axis, t: i32, u: i32) -> i32 {
        self.smoothed(axis, t, u + 1) - self.smoothed(axis, t, u - 1)
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
