//! Work that the edges of an image may take, in units, so that no picture takes much longer than a
//! scene.
//!
//! In: the size of the image or of the areas searched, what is done. Out: leave to draw another
//! edge, and the number of those left out.
//!
//! ```text
//! a budget per image and direction; a unit is some 50 instructions of a Cortex-M7: a test of
//!     the ridge takes 3, a position kept 1
//! what edges down the rows take beyond two thirds of their budget, those along the columns
//!     have less: no scene has as many of both
//! a part of it from the start, for what lies within REACH of the pixels searched; the rest
//!     with the pixels, as they are searched, so that
//!     neither the bottom nor the right is starved
//! an edge is started while there is something left, and drawn as a whole: what it takes beyond
//!     is paid before the next one starts
//! ```
//!
//! # Bounds
//! 1320 * 1320 px at 270 / 1024 units and [`FIXED`]: 4.8e8 in Q10. Areas are inside the image, at
//! most sixteen: sums below 2.8e7. An edge takes at most 640 * 4 + 7 units: 2.7e6.
//!
//! # Cost
//! Some 20 instructions a stretch. All edges of an image: the budgets and an edge more in each
//! direction. At QVGA that is 16 k units down, 21 k along, 32 k of both, and, in the right image,
//! 11 k: 2.2 M instructions. Captured pairs take up to 0.9 of a budget, and are not cut.

use super::Direction;
use crate::area::Area;
use crate::image::Dims;
use crate::units::quotient;

/// Units of a test of the ridge.
const TEST: i32 = 3;
/// Units of a position kept, for the fit.
const POSITION: i32 = 1;
/// Units from the start whatever the size: in small images and areas edges are long for the pixels.
const FIXED: i32 = 700;
/// Distance from an area up to which pixels count, be they in the image or not: its edges are drawn
/// beyond it, and followed to their start before.
const REACH: i32 = 19;

/// More than is lost by rounding where a budget is made smaller, times 4: up to a unit of Q10 in
/// each of 2^15 stretches.
const ROUNDING_Q10: i32 = 1 << 18;

/// Units per pixel, Q10.
struct Rate {
    start_q10: i32,
    searched_q10: i32,
}

/// Edges down the rows. Captured pairs take up to 0.15 units a pixel at 320 px, 0.19 at 128 px.
const DOWN: Rate = Rate { start_q10: 86, searched_q10: 124 };
/// Edges along the columns. Captured pairs take up to 0.25.
const ALONG: Rate = Rate { start_q10: 70, searched_q10: 200 };
/// Edges along the columns where scans are further apart (`is_sparse`). Captured pairs take up to
/// 0.12.
const ALONG_SPARSE: Rate = Rate { start_q10: 40, searched_q10: 104 };

/// Work of the edges of one direction.
#[derive(Default)]
pub(crate) struct Taken {
    /// Units taken.
    pub(crate) units: u32,
    /// Those beyond two thirds of the budget.
    pub(crate) beyond_share: u32,
    /// Edges that were not allowed.
    pub(crate) cut: u16,
    /// Units that may be taken from the budget before the next edge is cut, evenly over the image;
    /// as far as known.
    pub(crate) to_spare: u32,
}

/// Budget of the edges of one direction.
pub(super) struct Budget {
    /// All of it, Q10.
    total_q10: i32,
    left_q10: i32,
    /// Units that a stretch adds, Q10.
    stretch_q10: i32,
    taken: u32,
    cut: u16,
    /// The least that was left when an edge started, of three quarters of the budget, times 4, Q10.
    least_q10: i32,
}

impl Budget {
    /// The budget of an image, or of areas of it, whose stretches stand for so many pixels each.
    pub(super) fn new(
        dims: Dims,
        areas: Option<&[Area]>,
        direction: Direction,
        is_sparse: bool,
        stretch: i32,
    ) -> Self {
        let Rate { start_q10, searched_q10 } = match direction {
            Direction::Down => DOWN,
            Direction::Along if is_sparse => ALONG_SPARSE,
            Direction::Along => ALONG,
        };
        let grown = |area: Area, by: i32| {
            let length = |from: u16, to: u16| i32::from(to) - i32::from(from) + 2 * by;
            length(area.left, area.right) * length(area.top, area.bottom)
        };
        let whole = Area::of(dims);
        let sum = |by: i32| {
            areas
                .unwrap_or(&[])
                .iter()
                .map(|&area| grown(area, by))
                .sum::<i32>()
                .min(grown(whole, by))
        };
        let (searched, reached) =
            if areas.is_some() { (sum(0), sum(REACH)) } else { (grown(whole, 0), grown(whole, 0)) };
        let left_q10 = (FIXED << 10) + reached * start_q10 + (reached - searched) * searched_q10;
        let total_q10 = left_q10 + searched * searched_q10;
        Self {
            total_q10,
            left_q10,
            stretch_q10: stretch * searched_q10,
            taken: 0,
            cut: 0,
            least_q10: i32::MAX,
        }
    }

    /// The budget without so many units, evenly over the image.
    pub(super) fn without(self, units: u32) -> Self {
        let kept_q8 = 256 - quotient((units as i32) << 10, self.total_q10 >> 8).min(256);
        Self {
            left_q10: (self.left_q10 >> 8) * kept_q8,
            stretch_q10: (self.stretch_q10 * kept_q8) >> 8,
            ..self
        }
    }

    /// Units taken and edges cut so far.
    pub(super) fn taken(&self) -> Taken {
        let share = (self.total_q10 >> 10).unsigned_abs() * 2 / 3;
        let quarter = if self.least_q10 > ROUNDING_Q10 { self.total_q10 >> 12 } else { 0 };
        Taken {
            units: self.taken,
            beyond_share: self.taken.saturating_sub(share),
            cut: self.cut,
            to_spare: quarter.unsigned_abs(),
        }
    }

    /// Adds what a stretch that is searched brings, pixels between its scan and the next one
    /// included.
    #[inline]
    pub(super) fn search(&mut self) {
        self.left_q10 += self.stretch_q10;
    }

    /// True when another edge may start; else it is counted as cut.
    pub(super) fn allows_edge(&mut self) -> bool {
        let allowed = self.left_q10 > 0;
        // Of three quarters 3 (left + taken) - 4 taken is left.
        self.least_q10 = self.least_q10.min(3 * self.left_q10 - ((self.taken as i32) << 10));
        self.cut = self.cut.saturating_add(u16::from(!allowed));
        allowed
    }

    /// Takes the units of tests of the ridge and of positions kept.
    pub(super) fn take(&mut self, tests: i32, positions: i32) {
        let units = tests * TEST + positions * POSITION;
        self.left_q10 -= units << 10;
        self.taken = self.taken.saturating_add(units.unsigned_abs());
    }
}
