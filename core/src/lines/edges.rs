//! Edge drawing: anchors on a sparse grid of rows (columns), then the gradient's ridge is followed from each, both ways.
//!
//! In: a grey image. Out: chains of one sub-pixel position per row ([`Direction::Down`]) or per column ([`Direction::Along`]).
//!
//! # Bounds
//! Sobel of 8-bit pixels: |g| <= 1020. Positions in 1/32 px below 2^16 for images up to 2047 px.
//!
//! # Source
//! Topal, Akinlar 2012. The ridge's sub-pixel position is the vertex of the parabola through three gradients across the edge.

use super::{Chain, LineParams};
use crate::image::Gray;
use crate::units::quotient;

/// Rows (columns) from one position of a chain to the next: neighbouring ones say nearly the same.
pub(crate) const STEP: i32 = 2;
/// Rows (columns) between two scans for anchors: a multiple of [`STEP`], no more than the least extent of a segment.
const SCAN_STEP: i32 = 6;
/// A scan starts at most one edge, the strongest, per stretch of this many pixels: what bounds the work on texture and noise.
const STRETCH: i32 = 16;
/// Pixels next to the border that hold no edge: the ridge test reads that far.
const BORDER: i32 = 4;

/// Which way an edge runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// One position per step of rows.
    Down,
    /// One position per step of columns.
    Along,
}

/// The image seen along one direction: `t` counts rows or columns along the edge, `u` pixels across it.
#[derive(Clone, Copy)]
pub(crate) struct Axis {
    direction: Direction,
    along: usize,
    across: usize,
    steps: i32,
    breadth: i32,
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

/// The strongest edge of a stretch.
#[derive(Clone, Copy)]
struct Anchor {
    u: i32,
    sign: i32,
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
        let (width, height) = (self.width, self.height);
        match direction {
            Direction::Down => Axis { direction, along: self.stride, across: 1, steps: height, breadth: width },
            Direction::Along => Axis { direction, along: 1, across: self.stride, steps: width, breadth: height },
        }
    }

    /// Draws every edge of one direction and hands each chain to `emit`.
    pub(crate) fn for_each_chain(
        &mut self,
        direction: Direction,
        positions: &mut [u16],
        mut emit: impl FnMut(Chain<'_>),
    ) {
        self.marks.fill(0);
        let axis = self.axis(direction);
        let mut t = BORDER;
        while t < axis.steps - BORDER {
            let mut from = BORDER;
            while from < axis.breadth - BORDER {
                let to = (from + STRETCH).min(axis.breadth - BORDER);
                if let Some(anchor) = self.strongest(axis, t, from, to)
                    && let Some(chain) = self.draw(axis, t, anchor, positions)
                {
                    emit(chain);
                }
                from = to;
            }
            t += SCAN_STEP;
        }
    }

    /// The pixel with the largest grey step between its neighbours, if it is an anchor.
    fn strongest(&self, axis: Axis, t: i32, from: i32, to: i32) -> Option<Anchor> {
        let count = usize::try_from(to - from + 2).ok()?;
        let start = self.index(axis, t, from - 1);
        let (u, step) = match axis.direction {
            Direction::Down => largest_step(self.pixels.get(start..)?.get(..count)?.iter()),
            Direction::Along => largest_step(self.pixels.get(start..)?.iter().step_by(self.stride).take(count)),
        };
        let u = from + u;
        if step.abs() * 4 < self.anchor || self.marked(axis, t, u) {
            return None;
        }
        let sign = step.signum();
        let gradient = (self.smoothed(axis, t, u + 1) - self.smoothed(axis, t, u - 1)) * sign;
        (self.lengthwise(axis, t, u).abs() <= gradient).then_some(Anchor { u, sign })
    }

    /// Follows the ridge from an anchor in both ways; positions end up in `positions[t / STEP]`.
    fn draw<'p>(&mut self, axis: Axis, t: i32, anchor: Anchor, positions: &'p mut [u16]) -> Option<Chain<'p>> {
        let start = self.ridge(axis, t, anchor.u, anchor.sign)?;
        self.keep(axis, t, &start, positions);
        // An edge runs at right angles to its gradient: so much across per step, 1/32 px.
        let lengthwise = self.lengthwise(axis, t, start.u) * anchor.sign;
        let lean_q5 = quotient(-lengthwise * STEP << 5, start.gradient);
        let (mut sum, mut first, mut last) = (start.gradient, t, t);
        for step in [-STEP, STEP] {
            let mut at = t + step;
            let mut position_q5 = start.position_q5;
            let mut drift_q5 = if step < 0 { -lean_q5 } else { lean_q5 };
            while (BORDER..axis.steps - BORDER).contains(&at) {
                let expected = (position_q5 + drift_q5 + 16) >> 5;
                let Some(ridge) = self.ridge(axis, at, expected, anchor.sign) else { break };
                self.keep(axis, at, &ridge, positions);
                sum += ridge.gradient;
                drift_q5 = (drift_q5 + ridge.position_q5 - position_q5) >> 1;
                position_q5 = ridge.position_q5;
                if step < 0 {
                    first = at
                } else {
                    last = at
                }
                at += step;
            }
        }
        let range = usize::try_from(first / STEP).ok()?..usize::try_from(last / STEP + 1).ok()?;
        let mean = quotient(sum, (last - first) / STEP + 1);
        Some(Chain {
            first,
            positions: positions.get(range)?,
            rising: anchor.sign > 0,
            contrast: u8::try_from(mean >> 2).unwrap_or(u8::MAX),
        })
    }

    fn keep(&mut self, axis: Axis, t: i32, ridge: &Ridge, positions: &mut [u16]) {
        self.mark(axis, t, ridge.u);
        if let Some(slot) = usize::try_from(t / STEP).ok().and_then(|t| positions.get_mut(t)) {
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
        if mid < self.edge || lengthwise.abs() > mid + mid / 4 || self.marked(axis, t, u) {
            return None;
        }
        // Vertex of the parabola through (-1, low), (0, mid), (1, high), in 1/32 px.
        let curvature = 2 * mid - low - high;
        let offset_q5 = if curvature > 0 { quotient((high - low) << 4, curvature).clamp(-16, 16) } else { 0 };
        Some(Ridge { u, position_q5: (u << 5) + offset_q5, gradient: mid })
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

    /// Word and bit of a mark: a row of bits for each step.
    fn mark_at(axis: Axis, t: i32, u: i32) -> (usize, u32) {
        let bit = (t / STEP).wrapping_mul(axis.breadth).wrapping_add(u) as usize;
        (bit >> 5, 1 << (bit & 31))
    }

    fn marked(&self, axis: Axis, t: i32, u: i32) -> bool {
        let (word, bit) = Self::mark_at(axis, t, u);
        self.marks.get(word).is_none_or(|w| w & bit != 0)
    }

    fn mark(&mut self, axis: Axis, t: i32, u: i32) {
        let (word, bit) = Self::mark_at(axis, t, u);
        if let Some(w) = self.marks.get_mut(word) {
            *w |= bit;
        }
    }
}

/// Offset from the second pixel, and value, of the largest difference between a pixel's neighbours.
#[inline]
fn largest_step<'p>(mut pixels: impl Iterator<Item = &'p u8>) -> (i32, i32) {
    let mut next = || pixels.next().map(|&p| i32::from(p));
    let (Some(mut before), Some(mut here)) = (next(), next()) else { return (0, 0) };
    let (mut best, mut best_size) = ((0, 0), 0);
    let mut offset = 0;
    while let Some(after) = next() {
        let step = after - before;
        if step.abs() > best_size {
            (best, best_size) = ((offset, step), step.abs());
        }
        (before, here) = (here, after);
        offset += 1;
    }
    best
}
