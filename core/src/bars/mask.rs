//! Thin masks matched as bars: where no bar was found, the mask itself says where its edges are.
//!
//! In: a mask, both images, the rated support points. Out: a bar along a piece of the mask, and its
//! disparity at the mask's centre.
//!
//! ```text
//! bands:   at most twelve of up to twelve rows, evenly down the mask
//! pieces:  of the first four runs of a band's middle row what continues them up and down, at most
//!          twelve in all
//! edges:   the strongest gradients within 3 px of both sides of the piece's mean line
//! match:   as every bar
//! answer:  a piece in front of what is around it that another piece agrees with, or half of them
//!          where it is less probable than bars have to be; a piece level with what is around it,
//!          which is not all of one disparity, that two thirds agree with; none where another, as
//!          probable as bars have to be, lies 2 px off it, or 1 px off a level one
//! ```
//! One piece alone is wrong as often as its probability says. Pieces are matched one by one, so
//! that those that agree confirm each other. Legs of a chair are pieces side by side.
//!
//! # Cost
//! Up to 48 bars of some 25 000 instructions each on a Cortex-M7, as those of a pair; twelve where
//! no row of a mask has two runs. And 3000 for every second row of the mask.

use super::edges::Profile;
use super::region::{ONE_THING_Q6, WIDEST, most_pixels};
use super::{Bar, LEAST_BAR, match_bar, rate_bar};
use crate::area::Area;
use crate::image::{Gray, Span};
use crate::lines::Segment;
use crate::matching::band::Band;
use crate::matching::{MatchContext, Workspace};
use crate::result::ImagePosition;
use crate::units::{Confidence, Position, quotient};
use heapless::Vec;

/// Most bands and pieces of a mask.
const MOST_PIECES: usize = 12;
/// Most runs of a band's middle row that are followed: a chair has four legs.
const MOST_RUNS: usize = 4;
/// Most rows of a piece.
const MOST_ROWS: i32 = 12;
/// Fewest rows of a piece.
const LEAST_ROWS: i32 = 8;
/// Largest distance of an edge from the side of the mask, px.
const OFF: i32 = 3;
/// Largest difference of disparities of pieces that agree, 1/64 px.
const AGREES_Q6: i32 = 64;
/// Least probability of a piece in front of what is around it: 0.5.
const LEAST_FRONT: Confidence = Confidence::from_bits(0x8000);
/// Least probability of a piece level with it: 0.95.
const LEAST_LEVEL: Confidence = Confidence::from_bits(0xf333);
/// Share of the support points around a piece from which on its disparity is theirs, Q8: 0.78.
const THEIRS_Q8: i16 = 200;

/// A pair after its run, and working memory.
pub(crate) struct MaskMatcher<'a> {
    pub(crate) images: [Gray<'a>; 2],
    /// Row of the right image that matches row 0 of the left one.
    pub(crate) row_offset: i32,
    pub(crate) context: MatchContext<'a>,
    pub(crate) rows: &'a mut [u8],
    pub(crate) work: &'a mut Workspace,
}

/// A piece that was matched.
struct Piece {
    bar: Bar,
    is_credible: bool,
}

impl MaskMatcher<'_> {
    /// The bar that a mask in this area of so many pixels is, if it is one, and its disparity at a
    /// row, 1/64 px. `run_of` gives the mask's first run in a row that ends behind a column.
    #[inline(never)] // its variables are on the stack only while it runs
    pub(crate) fn depth_of(
        self,
        area: Area,
        pixels: u32,
        row: i32,
        run_of: impl Fn(u16, u16) -> Option<Span>,
    ) -> Option<(Bar, i32)> {
        if pixels > most_pixels(area) {
            return None;
        }
        let [top, bottom] = [area.top, area.bottom].map(i32::from);
        let [left, _] = self.images;
        let mut band = Band::new(self.images, self.row_offset, None, self.rows)?;
        let count = quotient(bottom - top + MOST_ROWS - 1, MOST_ROWS).min(MOST_PIECES as i32);
        let height = quotient(bottom - top, count).min(MOST_ROWS);
        let mut pieces = Vec::<Piece, MOST_PIECES>::new();
        let mut all = 0; // pieces that are bars
        for index in 0..count {
            let first = top + quotient((bottom - top - height) * index, (count - 1).max(1));
            let rows = [first, first + height - 1];
            let middle = u16::try_from(first + height / 2).ok()?;
            band.advance_for(&side(rows.map(|y| (0, y)))?, &mut |_| ());
            let mut from = area.left;
            for _ in 0..MOST_RUNS {
                let Some(run) = run_of(middle, from).filter(|_| !pieces.is_full()) else { break };
                from = run.end;
                let Some(mut bar) = bar_along(&run_of, middle, run, rows, left) else { continue };
                all += 1;
                let rated = match_bar(&mut bar, &self.context, &band, self.work, LEAST_FRONT)
                    .and_then(|_| rate_bar(&mut bar, self.context.support));
                let is_credible = rated.is_some_and(|[agrees, ..]| match bar.is_in_front() {
                    true => bar.confidence() >= LEAST_FRONT,
                    false => bar.confidence() >= LEAST_LEVEL && agrees < THEIRS_Q8,
                });
                if bar.is_compared() {
                    let _ = pieces.push(Piece { bar, is_credible }); // there is room
                }
            }
        }
        let (bar, d_q6) = answer(&pieces, all, row)?;
        Some((Bar { probability_q16: bar.probability_q16.max(LEAST_BAR.to_bits()), ..bar }, d_q6))
    }
}

/// The credible piece nearest to a row with which enough of `all` pieces agree, and that no other
/// contradicts; its disparity at that row, or at its end, 1/64 px.
fn answer(pieces: &[Piece], all: i32, row: i32) -> Option<(Bar, i32)> {
    let off_q6 = |a: &Bar, b: &Bar| (a.middle_q6() - b.middle_q6()).abs();
    let is_confirmed = |piece: &&Piece| {
        let bar = &piece.bar;
        let agree =
            pieces.iter().filter(|other| off_q6(&other.bar, bar) <= AGREES_Q6).count() as i32;
        let is_enough = match bar.is_in_front() {
            true if bar.confidence() >= LEAST_BAR => agree >= 2,
            true => agree >= 2 && 2 * agree >= all,
            false => agree >= 3 && 3 * agree >= 2 * all,
        };
        piece.is_credible && is_enough
    };
    let nearest = pieces
        .iter()
        .filter(is_confirmed)
        .min_by_key(|piece| (piece.bar.middle_row() - row).abs())?;
    let most_q6 = if nearest.bar.is_in_front() { ONE_THING_Q6 } else { AGREES_Q6 };
    let contradicts = |other: &Piece| {
        other.bar.confidence() >= LEAST_BAR && off_q6(&other.bar, &nearest.bar) > most_q6
    };
    let d_q6 = nearest.bar.disparity_nearest_q6(row);
    (!pieces.iter().any(contradicts)).then_some((nearest.bar, d_q6))
}

/// A bar along the mean line of a mask's run in a row and what continues it up and down, within
/// these rows, first and last, between the strongest edges near its sides.
fn bar_along(
    run_of: &impl Fn(u16, u16) -> Option<Span>,
    row: u16,
    run: Span,
    [first, last]: [i32; 2],
    image: Gray<'_>,
) -> Option<Bar> {
    let is_thin = |run: &Span| u32::from(run.end - run.start) <= WIDEST;
    // The run of the next row that has a column in common.
    let next = |y: i32, run: Span| {
        run_of(u16::try_from(y).ok()?, run.start)
            .filter(|next| next.start < run.end && is_thin(next))
    };
    let end_of = |step: i32, end: i32| {
        let (mut y, mut of) = (i32::from(row), run);
        while y != end
            && let Some(run) = next(y + step, of)
        {
            (y, of) = (y + step, run);
        }
        (y, of)
    };
    let ((first, mut run), (last, _)) =
        is_thin(&run).then(|| (end_of(-1, first), end_of(1, last)))?;
    let rows = last - first + 1;
    if rows < LEAST_ROWS {
        return None;
    }
    let half = rows / 2;
    // Sums over the rows: widths, and twice the middles of the upper and of the lower half.
    let (mut widths, mut middles) = (0, [0; 2]);
    for y in first..=last {
        run = next(y, run)?;
        let [start, end] = [run.start, run.end].map(i32::from);
        widths += end - start;
        let [upper, lower] = &mut middles;
        *upper += if y - first < half { start + end - 1 } else { 0 };
        *lower += if last - y < half { start + end - 1 } else { 0 };
    }
    let width_q5 = quotient(widths << 5, rows);
    let [upper_q5, lower_q5] = middles.map(|sum| quotient(sum << 4, half));
    // The mean rows of both halves lie `rows - half` rows apart.
    let beyond_q5 = quotient((lower_q5 - upper_q5) * (half - 1), 2 * (rows - half));
    let left_q5 = |x_q5: i32| x_q5 - (width_q5 >> 1);
    let ends = [(left_q5(upper_q5 - beyond_q5), first), (left_q5(lower_q5 + beyond_q5), last)];
    let side = side(ends)?;
    Profile::beside(image, &side)?.bar_between(&side, (width_q5 + 16) >> 5, OFF)
}

/// The side of a mask between these columns, 1/32 px, and rows.
fn side(ends: [(i32, i32); 2]) -> Option<Segment> {
    let end = |(x_q5, y): (i32, i32)| {
        Some(ImagePosition {
            x: Position::from_bits(u16::try_from(x_q5).ok()?),
            y: Position::from_bits(u16::try_from(y << 5).ok()?),
        })
    };
    let [first, last] = ends;
    let ends = [end(first)?, end(last)?];
    Some(Segment { ends, rising: true, contrast: 0, near_horizontal: false })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bars::keep::tests::bar;
    use crate::bars::{FRONT, MATCHED};

    /// Pieces of twelve rows at these disparities, px, and whether each is credible.
    fn pieces(of: &[(i16, bool)], flags: u8) -> Vec<Piece, MOST_PIECES> {
        of.iter()
            .zip(0..)
            .map(|(&(d, is_credible), index)| Piece {
                bar: Bar {
                    disparity_q6: [d << 6; 2],
                    probability_q16: if is_credible { u16::MAX } else { 0 },
                    flags: flags | MATCHED,
                    ..bar(100, 6, [12 * index, 12 * index + 11], 80)
                },
                is_credible,
            })
            .collect()
    }

    fn said(of: &[(i16, bool)], flags: u8) -> Option<i32> {
        answer(&pieces(of, flags), 6, 30).map(|(_, d_q6)| d_q6 >> 6)
    }

    #[test]
    fn pieces_that_agree_confirm_each_other() {
        let of = [(20, false), (21, true), (20, false), (7, false)];
        assert_eq!(said(&of[1..], FRONT), Some(21), "one other");
        assert_eq!(said(&of[1..2], FRONT), None, "alone");
        assert_eq!(said(&of, 0), None, "level: two thirds of six");
        let more = [of[0], of[1], of[2], (20, false)];
        assert_eq!(said(&more, 0), Some(21));
        assert_eq!(said(&[of[0], of[2], of[0], of[2]], FRONT), None, "none is credible");
        let two = [(20, true), (20, false), (20, false), (9, true)];
        assert_eq!(said(&two, FRONT), None, "two things");
    }
}
