//! Edge drawing: anchors on every sixth row (column), from each of which the gradient's ridge is
//! followed both ways.
//!
//! In: a grey image. Out: chains of one sub-pixel position per row ([`Direction::Down`]) or per
//! column ([`Direction::Along`]).
//!
//! # Bounds
//! Sobel of 8-bit pixels: |g| <= 1020. Positions in 1/32 px below 2^16 for images up to 2047 px.
//!
//! # Cost
//! A scan: 2 instructions for each of its pixels, some 60 a stretch. An edge: some 150 a test of
//! the ridge, one for each position and two more; an edge that enters areas is passed once more on
//! the way to its start, at each position once in all. What edges may take in all: [`Budget`].
//!
//! # Source
//! Topal, Akinlar 2012. The ridge's sub-pixel position is the vertex of the parabola through three
//! gradients across the edge.

use super::budget::{Budget, Taken};
use super::{Chain, LineParams, Room};
use crate::area::Area;
use crate::image::{Gray, Span};
use crate::kernel::{Crossing, Crossings, crossing, largest_step};
use crate::units::quotient;
use core::num::NonZeroU32;

/// Rows (columns) from one position of a chain to the next; those of adjacent rows are nearly
/// redundant.
pub(crate) const STEP: i32 = 2;
/// Rows (columns) between two scans for anchors: a multiple of [`STEP`], no more than the least
/// extent of a segment.
pub(crate) const SCAN_STEP: i32 = 6;
/// Pixels of a stretch. A scan starts at most one edge, the strongest, in each, which bounds the
/// work on texture and noise.
const STRETCH: i32 = 16;
/// Pixels next to the border that hold no edge: reach of the ridge test.
const BORDER: i32 = 4;

/// Direction of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// One position per step of rows.
    Down,
    /// One position per step of columns.
    Along,
}

/// An image and its marks in one direction: the state of the drawing. `t` counts rows (columns,
/// unless `down`) along the edge, `u` pixels across it. The direction is no constant of the type:
/// two copies of the code would be 3 KB more of flash for 0.3 % of a pair.
pub(crate) struct Edges<'a> {
    down: bool,
    crossings: Crossings<'a>,
    /// Bytes from one `t` to the next, and from one `u`.
    along: usize,
    across: usize,
    steps: i32,
    breadth: i32,
    /// Pixels across between the borders.
    inner: u32,
    /// Rows (columns) between two scans for anchors.
    scan: i32,
    anchor: i32,
    edge: i32,
    /// Valid columns of each row; empty when all are.
    valid: &'a [Span],
    /// Areas in which edges start; everywhere without.
    areas: Option<&'a [Area]>,
    /// Two rows of bits for each step: positions drawn, and positions that [`Edges::first_anchor`]
    /// has passed.
    marks: &'a mut [u32],
    budget: Budget,
}

/// Position of the ridge on one row (column), in two words: what a test returns, or `None`, stays
/// in registers.
#[derive(Clone, Copy)]
struct Ridge {
    /// Upper half: position across the edge, 1/32 px. Lower half: gradient across it, positive for
    /// the edge's sign.
    across: NonZeroU32,
    /// Upper half: whole pixel. Lower half: gradient along the edge.
    along: u32,
}

impl Ridge {
    fn new(u: i32, offset_q5: i32, gradient: i32, along: i32) -> Option<Self> {
        let halves = |above: i32, below: i32| (above as u32) << 16 | (below as u32) & 0xffff;
        Some(Self {
            across: NonZeroU32::new(halves((u << 5) + offset_q5, gradient))?,
            along: halves(u, along),
        })
    }

    /// Sub-pixel position, 1/32 px.
    fn position_q5(self) -> i32 {
        (self.across.get() >> 16) as i32
    }

    /// Whole pixel.
    fn u(self) -> i32 {
        (self.along >> 16) as i32
    }

    /// Gradient across the edge.
    fn gradient(self) -> i32 {
        (self.across.get() & 0xffff) as i32
    }

    /// Shift across per step of an edge at right angles to the gradient, 1/32 px.
    fn lean_q5(self, sign: i32) -> i32 {
        let along = i32::from(self.along as i16);
        quotient((-along * sign * STEP) << 5, self.gradient())
    }
}

/// Strongest edge of a stretch: its pixel and sign.
#[derive(Clone, Copy)]
struct Anchor {
    u: i32,
    sign: i32,
}

impl<'a> Edges<'a> {
    /// Edges of an image or of areas of it; `beyond` is what those of the other direction took of
    /// their budget.
    pub(crate) fn new(
        image: Gray<'a>,
        areas: Option<&'a [Area]>,
        params: &LineParams,
        scan: i32,
        beyond: u32,
        direction: Direction,
        marks: &'a mut [u32],
    ) -> Self {
        let down = direction == Direction::Down;
        let dims = image.dims();
        let (pixels, stride) = image.as_slice();
        let (width, height) = (i32::from(dims.width), i32::from(dims.height));
        let (steps, breadth) = if down { (height, width) } else { (width, height) };
        marks.fill(0);
        let valid = image.valid();
        let budget =
            Budget::new(dims, areas, direction, scan > SCAN_STEP, scan * STRETCH).without(beyond);
        let LineParams { anchor, edge, .. } = *params;
        let (along, across) = if down { (stride, 1) } else { (1, stride) };
        let of = if down { Crossings::of_rows } else { Crossings::of_columns };
        let crossings = of(pixels, stride);
        let inner = (breadth - 2 * BORDER).max(0) as u32;
        Self {
            down,
            crossings,
            along,
            across,
            steps,
            breadth,
            inner,
            scan,
            anchor,
            edge,
            valid,
            areas,
            marks,
            budget,
        }
    }

    /// Draws every edge that the budget allows and calls `emit` with each chain. Returns the units
    /// taken.
    #[inline(never)]
    pub(crate) fn for_each_chain(
        &mut self,
        room: &mut Room<'_>,
        mut emit: impl FnMut(Chain<'_>),
    ) -> Taken {
        let mut t = BORDER;
        while t < self.steps - BORDER {
            let mut from = BORDER;
            let mut stretches = self.stretches_in_areas(t);
            while from < self.breadth - BORDER {
                let to = (from + STRETCH).min(self.breadth - BORDER);
                // Without areas no shifts of four words.
                let is_searched = stretches.as_mut().is_none_or(|stretches| {
                    let is_searched = *stretches & 1 != 0;
                    *stretches >>= 1;
                    is_searched
                });
                if is_searched {
                    self.budget.search();
                }
                if is_searched
                    && let Some((first, last)) = self.valid_part(t, from, to)
                    && let Some(anchor) = self.strongest(t, first, last)
                    && self.budget.allows_edge()
                {
                    if self.areas.is_some()
                        && let Some((before, first)) = self.first_anchor(t, anchor)
                        && let Some(chain) = self.draw(before, first, room)
                    {
                        emit(chain);
                    }
                    if let Some(chain) = self.draw(t, anchor, room) {
                        emit(chain);
                    }
                }
                from = to;
            }
            t += self.scan;
        }
        self.budget.taken()
    }

    /// A bit for each stretch of a row: set where it has pixels of the areas. `None` without areas.
    fn stretches_in_areas(&self, t: i32) -> Option<u128> {
        Some(self.areas?.iter().fold(0, |stretches, area| {
            let Area { left, top, right, bottom } = *area;
            let ((t0, t1), (u0, u1)) = if self.down {
                ((top, bottom), (left, right))
            } else {
                ((left, right), (top, bottom))
            };
            if !(i32::from(t0)..i32::from(t1)).contains(&t) || u0 >= u1 {
                return stretches;
            }
            // Stretches below 80: images are at most 1280 px wide.
            let stretch = |u: u16| ((i32::from(u) - BORDER).max(0) / STRETCH).clamp(0, 126) as u32;
            let (first, last) = (stretch(u0), stretch(u1 - 1));
            stretches | (((2_u128 << (last - first)) - 1) << first)
        }))
    }

    /// The part of a stretch that is valid, if it is in one piece.
    #[inline(always)]
    fn valid_part(&self, t: i32, mut from: i32, mut to: i32) -> Option<(i32, i32)> {
        if self.valid.is_empty() {
            return Some((from, to));
        }
        while from < to && !self.is_valid(t, from) {
            from += 1;
        }
        while to > from && !self.is_valid(t, to - 1) {
            to -= 1;
        }
        (from < to && (from..to).all(|u| self.is_valid(t, u))).then_some((from, to))
    }

    #[inline]
    fn is_valid(&self, t: i32, u: i32) -> bool {
        if self.valid.is_empty() {
            return true;
        }
        let (x, y) = if self.down { (u, t) } else { (t, u) };
        self.valid.get(y as usize).is_none_or(|span| span.contains(x))
    }

    /// The pixel with the largest grey step between its neighbours, if that reaches the anchor
    /// threshold.
    #[inline(always)] // called, a scan for anchors takes 1 % more
    fn strongest(&self, t: i32, from: i32, to: i32) -> Option<Anchor> {
        let pixels = self.crossings.pixels().get(self.index(t, from - 1)..)?;
        // An edge at any pixel changes the differences between every second one.
        let largest =
            largest_step(pixels, 2 * self.across, usize::try_from((to - from + 1) / 2 + 1).ok()?);
        let size = largest.step.abs();
        (size * 4 >= self.anchor)
            .then(|| Anchor { u: from + 2 * largest.place, sign: largest.step.signum() })
    }

    /// The anchor before `t` from which a search over the whole image would have drawn this edge:
    /// the first scan, of those that the edge passes from its start on, on which it is the
    /// strongest of its stretch. What an earlier search passed was drawn from there: each position
    /// is passed once.
    fn first_anchor(&mut self, t: i32, anchor: Anchor) -> Option<(i32, Anchor)> {
        let sign = anchor.sign;
        let start = self.ridge(t, anchor.u, sign, false)?;
        let mut found = None;
        let mut drift_q5 = -start.lean_q5(sign);
        let mut position_q5 = start.position_q5();
        let (mut at, mut next_scan) = (t - STEP, t - self.scan);
        while at >= BORDER {
            let Some(ridge) = self.ridge(at, (position_q5 + drift_q5 + 16) >> 5, sign, false)
            else {
                break;
            };
            let before_q5 = core::mem::replace(&mut position_q5, ridge.position_q5());
            drift_q5 = (drift_q5 + position_q5 - before_q5) >> 1;
            if at == next_scan {
                next_scan -= self.scan;
                let other = self.anchor_beside(at, ridge.u()).filter(|other| other.sign == sign);
                found = other.map(|other| (at, other)).or(found);
            }
            at -= STEP;
        }
        self.budget.take((t - at) / STEP + 1, 0);
        found
    }

    /// The anchor of the stretch around a pixel, if it is at most a search of the ridge away.
    fn anchor_beside(&self, t: i32, u: i32) -> Option<Anchor> {
        let from = BORDER + (u - BORDER) / STRETCH * STRETCH;
        let (first, last) =
            self.valid_part(t, from, (from + STRETCH).min(self.breadth - BORDER))?;
        self.strongest(t, first, last).filter(|anchor| (anchor.u - u).abs() <= 1)
    }

    /// Follows the ridge from an anchor both ways; positions are stored at index `t / STEP`.
    fn draw<'r>(&mut self, t: i32, anchor: Anchor, room: &'r mut Room<'_>) -> Option<Chain<'r>> {
        let sign = anchor.sign;
        self.budget.take(1, 0);
        let start = self.ridge(t, anchor.u, sign, true)?;
        keep(room, t, start);
        let lean_q5 = start.lean_q5(sign);
        let (mut first, mut last) = (t, t);
        for step in [-STEP, STEP] {
            let mut at = t + step;
            let mut position_q5 = start.position_q5();
            let mut drift_q5 = if step < 0 { -lean_q5 } else { lean_q5 };
            while at >= BORDER && at < self.steps - BORDER {
                let expected = (position_q5 + drift_q5 + 16) >> 5;
                let Some(ridge) = self.ridge(at, expected, sign, true) else { break };
                keep(room, at, ridge);
                let before_q5 = core::mem::replace(&mut position_q5, ridge.position_q5());
                drift_q5 = (drift_q5 + position_q5 - before_q5) >> 1;
                at += step;
            }
            if step < 0 {
                first = at - step;
            } else {
                last = at - step;
            }
        }
        let count = (last - first) / STEP + 1;
        self.budget.take(count + 1, count); // and two tests that ended it
        let range = usize::try_from(first / STEP).ok()?..usize::try_from(last / STEP + 1).ok()?;
        let (positions, strengths) =
            (room.positions.get(range.clone())?, room.strengths.get(range)?);
        Some(Chain { first, positions, strengths, rising: sign > 0 })
    }

    /// The ridge at row `t` next to column `u`: the largest of three gradients of the right sign,
    /// unless it is too small, lies along the other direction, or was drawn before or, unless to
    /// `draw` it, passed before. Marks it.
    fn ridge(&mut self, t: i32, u: i32, sign: i32, draw: bool) -> Option<Ridge> {
        if (u - BORDER) as u32 >= self.inner || !self.is_valid(t, u) {
            return None;
        }
        let first = self.index(t, u - 3);
        let Crossing { shift, gradients: [low, mid, high], along } =
            crossing(&self.crossings, first, sign)?;
        if mid * 2 < self.edge || along.abs() > mid + (mid >> 2) {
            return None;
        }
        let u = u + shift;
        let bit = t.wrapping_mul(self.breadth).wrapping_add(u);
        let (drawn, mask) = self.mark(bit)?;
        if *drawn & mask != 0 {
            return None;
        }
        if draw {
            *drawn |= mask;
        } else {
            // The rows (columns) between positions have marks to spare.
            let (passed, mask) = self.mark(bit.wrapping_add(self.breadth))?;
            if *passed & mask != 0 {
                return None;
            }
            *passed |= mask;
        }
        // Vertex of the parabola through (-1, low), (0, mid), (1, high), in 1/32 px.
        let curvature = 2 * mid - low - high;
        let offset_q5 =
            if curvature > 0 { quotient((high - low) << 4, curvature).clamp(-16, 16) } else { 0 };
        Ridge::new(u, offset_q5, mid, along)
    }

    /// The word of a mark, and its bit.
    #[inline]
    fn mark(&mut self, bit: i32) -> Option<(&mut u32, u32)> {
        self.marks.get_mut(bit as usize >> 5).map(|word| (word, 1 << (bit & 31)))
    }

    #[inline]
    fn index(&self, t: i32, u: i32) -> usize {
        (t as usize).wrapping_mul(self.along).wrapping_add((u as usize).wrapping_mul(self.across))
    }
}

fn keep(room: &mut Room<'_>, t: i32, ridge: Ridge) {
    let index = (t.cast_unsigned() / STEP.cast_unsigned()) as usize;
    if let (Some(position), Some(strength)) =
        (room.positions.get_mut(index), room.strengths.get_mut(index))
    {
        *position = ridge.position_q5() as u16;
        *strength = (ridge.gradient() >> 1).min(u8::MAX.into()) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Dims;

    const DIMS: Dims = Dims { width: 160, height: 120 };
    const PARAMS: LineParams = LineParams {
        anchor: 48,
        edge: 20,
        min_extent: 6,
        row_scan: Some(SCAN_STEP),
        column_scan: Some(SCAN_STEP),
    };

    /// Calls with the edges of both directions, and with (row, column) of `t` and `u`.
    fn both_ways(
        areas: Option<&[Area]>,
        spans: &[Span],
        mut look: impl FnMut(&Edges<'_>, fn((i32, i32)) -> (i32, i32)),
    ) {
        let (pixels, mut marks) = ([0; 160 * 120], [0; 2048]);
        let image = Gray::new(&pixels, DIMS, 160).unwrap().with_valid(spans).unwrap();
        look(
            &Edges::new(image, areas, &PARAMS, SCAN_STEP, 0, Direction::Down, &mut marks),
            |(t, u)| (t, u),
        );
        look(
            &Edges::new(image, areas, &PARAMS, SCAN_STEP, 0, Direction::Along, &mut marks),
            |(t, u)| (u, t),
        );
    }

    #[test]
    fn a_stretch_is_searched_where_it_has_pixels_of_an_area() {
        let area = |left, top, right, bottom| Area { left, top, right, bottom };
        // Overlapping ones, one of a single pixel, one without any, one to the last pixel.
        let areas = [
            area(10, 8, 30, 40),
            area(24, 20, 70, 60),
            area(36, 70, 37, 71),
            area(90, 10, 90, 60),
            area(132, 100, 160, 120),
        ];
        both_ways(Some(&areas), &[Span { start: 0, end: 160 }; 120], |edges, place| {
            for t in BORDER..edges.steps - BORDER {
                let stretches = edges.stretches_in_areas(t).unwrap();
                for (k, from) in
                    (0..).zip((BORDER..edges.breadth - BORDER).step_by(STRETCH as usize))
                {
                    let to = (from + STRETCH).min(edges.breadth);
                    let is_inside = |u: i32| {
                        let (y, x) = place((t, u));
                        areas.iter().any(|area| {
                            let across = i32::from(area.left)..i32::from(area.right);
                            across.contains(&x)
                                && (i32::from(area.top)..i32::from(area.bottom)).contains(&y)
                        })
                    };
                    assert_eq!(
                        stretches >> k & 1 != 0,
                        (from..to).any(is_inside),
                        "{t}: {from} .. {to}"
                    );
                }
            }
        });
        both_ways(None, &[Span { start: 0, end: 160 }; 120], |edges, _| {
            assert_eq!(edges.stretches_in_areas(50), None)
        });
    }

    #[test]
    fn a_stretch_is_cut_to_its_valid_pixels_and_left_out_in_two_pieces() {
        // Columns 20 .. 60, from row 40 on 50 .. 100; none in row 30.
        let spans = core::array::from_fn::<_, 120, _>(|y| match y {
            30 => Span::default(),
            0..40 => Span { start: 20, end: 60 },
            _ => Span { start: 50, end: 100 },
        });
        let (mut found, mut way) = ([[None; 5]; 2], 0);
        both_ways(None, &spans, |edges, _| {
            let stretches = if edges.down {
                [(10, 24, 40), (10, 4, 20), (10, 12, 28), (10, 52, 68), (30, 24, 40)]
            } else {
                [(55, 4, 20), (55, 24, 36), (25, 32, 48), (70, 36, 52), (70, 4, 20)]
            };
            found[way] = stretches.map(|(t, from, to)| edges.valid_part(t, from, to));
            way += 1;
        });
        assert_eq!(found[0], [Some((24, 40)), None, Some((20, 28)), Some((52, 60)), None]);
        assert_eq!(found[1], [Some((4, 20)), None, Some((32, 40)), Some((40, 52)), None]);
    }
}
