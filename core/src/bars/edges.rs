//! Segments -> bars: a second edge beside a segment, along its rows.
//!
//! In: a segment of the left image. Out: up to four bars, of which the segment is one edge.
//!
//! ```text
//! profile: of eight rows the gradients at -22 .. 22 px from the edge, summed, and their magnitudes
//! peaks:   on each side the nearest edge of either sign, and the strongest of the other sign
//! width:   vertex of the parabola through the peak's three sums
//! ```
//!
//! # Bounds
//! Eight gradients of at most 31 off flat ones of 32: sums of bytes below 2^9.
//!
//! # Cost
//! Eight rows of at most 45 gradients: 4000 instructions.

use super::keep::Found;
use super::{Bar, LEFT_RISING, RIGHT_RISING};
use crate::image::Gray;
use crate::kernel::FLAT;
use crate::lines::{Line, Segment};
use crate::matching::band::SampledRows;
use crate::matching::codes::gradients;
use crate::units::quotient;

/// Most bars beside a segment.
pub(super) const MOST_BESIDE: usize = 4;
/// Most rows of a profile.
pub(super) const MOST_ROWS: i32 = 8;
/// Fewest rows of a profile.
const LEAST_ROWS: i32 = 4;
/// Least extent of a segment, rows.
const LEAST_EXTENT: i32 = 8;
/// Largest distance of the second edge along a row, px.
const REACH: i32 = 20;
/// Largest distance of it across an upright bar, px.
const WIDEST: i32 = 14;
/// Largest slope of a segment, px per px, Q12.
const STEEPEST_Q12: i32 = 2 << 12;
/// Pixels at the border where no bar is looked for.
pub(super) const BORDER: i32 = 5;
const COLUMNS: usize = (2 * REACH as usize + 5).next_multiple_of(4);

/// Gradients beside an edge, and their sums of each column.
pub(super) struct Profile {
    gradients: [[u8; COLUMNS]; MOST_ROWS as usize],
    sums: [i16; COLUMNS],
    rows: i32,
    reach: i32,
    /// Sign of the segment's edge along a row.
    sign: i32,
    /// Sum over the rows: from the line to its nearest column, 1/32 px.
    off_q5: i32,
}

/// A second edge.
#[derive(Clone, Copy)]
struct Peak {
    /// Its distance, signed, px.
    at: i32,
    sum: i32,
    /// 1 where it has the sign of the first.
    same: i32,
}

/// About as many segments are looked at, the strongest ones.
const MOST_SEGMENTS: u32 = 64;
/// Steps of the histogram of strengths, and their size.
const STEPS: usize = 64;
const STEP: u32 = 128;

/// Rows of a segment times its contrast, as far as gradients show it; 0 where it is too short or
/// too flat to be a bar's edge.
pub(super) fn strength(segment: &Segment) -> u32 {
    let (x0, y0, x1, y1) = segment.ends_q5();
    let rows = (y1 - y0).abs() >> 5;
    let is_steep = (x1 - x0).abs() <= 2 * (y1 - y0).abs();
    if rows + 1 < LEAST_EXTENT || !is_steep {
        0
    } else {
        rows.unsigned_abs() * u32::from(segment.contrast.min(31))
    }
}

/// Strength that leaves about [`MOST_SEGMENTS`].
pub(super) fn least_strength(segments: &[Segment]) -> u32 {
    let mut histogram = [0_u16; STEPS];
    for strength in segments.iter().map(strength).filter(|&strength| strength > 0) {
        if let Some(count) = histogram.get_mut(((strength / STEP) as usize).min(STEPS - 1)) {
            *count += 1;
        }
    }
    let mut left = MOST_SEGMENTS;
    for (step, &count) in (0..STEPS as u32).zip(&histogram).rev() {
        match left.checked_sub(count.into()) {
            Some(rest) => left = rest,
            None => return (step * STEP).max(1),
        }
    }
    1
}

/// Keeps every bar that this segment is an edge of, as far as it is one of the strongest.
pub(super) fn keep_beside(image: Gray<'_>, segment: &Segment, kept: &mut dyn Found) {
    let line = Line::upright(segment);
    let (first, last) = line.extent();
    let slope_q12 = line.slope_q12();
    if last - first + 1 < LEAST_EXTENT || slope_q12.abs() > STEEPEST_Q12 {
        return;
    }
    let along = (1 << 24) + slope_q12 * slope_q12; // below 2^27
    let wide_q12 = along.unsigned_abs().isqrt() as i32;
    let reach = (((WIDEST * wide_q12) >> 12) + 1).min(REACH);
    let rows = SampledRows::new((first, last), MOST_ROWS);
    let Some(profile) = Profile::of(image, &line, rows, reach, sign_of(segment, slope_q12)) else {
        return;
    };
    // A bar is as strong as its weaker edge.
    let rows = (last - first + 1).unsigned_abs();
    if !kept.may_keep(rows * u32::from(profile.mean_q3(profile.own()))) {
        return;
    }
    for side in [-1, 1] {
        for peak in profile.peaks(side).into_iter().flatten() {
            let at_q5 = profile.vertex_q5(&peak);
            if at_q5.abs() > (31 * wide_q12) >> 8 {
                continue; // 15.5 px
            }
            let x_q5 = line.at_q5(first << 5) + at_q5.min(0);
            let (own, second) = (profile.sign, peak.same * profile.sign);
            let [left, right] = if side < 0 { [second, own] } else { [own, second] };
            let bar = Bar {
                x_q5: u16::try_from(x_q5).unwrap_or(0),
                rows: [first, last].map(|row| u16::try_from(row).unwrap_or(0)),
                slope_q12: crate::units::narrow(slope_q12),
                width_q5: at_q5.unsigned_abs() as u16,
                disparity_q6: [0; 2],
                scores_q8: [i16::MIN; 2],
                probability_q16: 0,
                strengths_q3: [profile.own(), peak.sum].map(|sum| profile.mean_q3(sum)),
                coherence_q8: profile.coherence_q8(&peak),
                flags: sign_flags([left, right]),
            };
            let (from, to) = bar.reach();
            if from >= BORDER
                && to + i32::from(bar.width_q5 >> 5) + BORDER < i32::from(image.dims().width)
            {
                kept.insert(bar);
            }
        }
    }
}

/// Bits of a bar's flags for the signs of its edges.
fn sign_flags([left, right]: [i32; 2]) -> u8 {
    let bit = |sign: i32, bit: u8| if sign > 0 { bit } else { 0 };
    bit(left, LEFT_RISING) | bit(right, RIGHT_RISING)
}

/// Sign of a segment's gradient along a row. Right of a line that falls to the right lies what is
/// above it.
fn sign_of(segment: &Segment, slope_q12: i32) -> i32 {
    let is_turned = segment.near_horizontal && slope_q12 > 0;
    if segment.rising == is_turned { -1 } else { 1 }
}

impl Profile {
    /// The profile beside the line of a segment, as far as a bar may be wide.
    pub(super) fn beside(image: Gray<'_>, segment: &Segment) -> Option<Self> {
        let line = Line::upright(segment);
        let rows = SampledRows::new(line.extent(), MOST_ROWS);
        (line.slope_q12().abs() <= STEEPEST_Q12)
            .then(|| Self::of(image, &line, rows, REACH, 1))
            .flatten()
    }

    /// The bar between the strongest edges at most `off` px from the line, and at most as far from
    /// `width` px to the right of it.
    pub(super) fn bar_between(&self, segment: &Segment, width: i32, off: i32) -> Option<Bar> {
        let line = Line::upright(segment);
        let (first, last) = line.extent();
        let strongest = |from: i32, to: i32| {
            let at =
                (from..=to.min(self.reach)).max_by_key(|&at| (self.sum(at, 1).abs(), -at.abs()))?;
            let same = if self.sum(at, 1) < 0 { -1 } else { 1 };
            Some(Peak { at, sum: self.sum(at, same), same })
        };
        let left = strongest(-off, off.min(width / 2))?;
        let right = strongest((width - off).max(left.at + 2), width + off)?;
        let [from, to] = [left, right].map(|peak| self.vertex_q5(&peak));
        let coherence = self.coherence_q8(&left).min(self.coherence_q8(&right));
        Some(Bar {
            x_q5: u16::try_from(line.at_q5(first << 5) + from).ok()?,
            rows: [first, last].map(|row| u16::try_from(row).unwrap_or(0)),
            slope_q12: crate::units::narrow(line.slope_q12()),
            width_q5: u16::try_from(to - from).ok()?,
            disparity_q6: [0; 2],
            scores_q8: [i16::MIN; 2],
            probability_q16: 0,
            strengths_q3: [left.sum, right.sum].map(|sum| self.mean_q3(sum)),
            coherence_q8: coherence,
            flags: sign_flags([left.same, right.same]),
        })
    }

    #[inline(never)] // two calls
    fn of(image: Gray<'_>, line: &Line, rows: SampledRows, reach: i32, sign: i32) -> Option<Self> {
        if rows.count() < LEAST_ROWS {
            return None;
        }
        let mut profile = Self {
            gradients: [[FLAT; COLUMNS]; MOST_ROWS as usize],
            sums: [0; COLUMNS],
            rows: rows.count(),
            reach,
            sign,
            off_q5: 0,
        };
        let columns = usize::try_from(2 * reach + 5).unwrap_or(0).min(COLUMNS);
        for (y, row) in rows.zip(&mut profile.gradients) {
            let column = line.at(y);
            profile.off_q5 += (column << 5) - line.at_q5(y << 5);
            let start = column - reach - 2;
            gradients(image, y, start..start + columns as i32, row.get_mut(..columns)?);
        }
        profile.add_up();
        Some(profile)
    }

    /// Sums the columns, four at once: every second byte of a word has room for the sum of eight.
    fn add_up(&mut self) {
        const WORDS: usize = COLUMNS / 4;
        let mut sums = [[0_u32; 2]; WORDS];
        for row in &self.gradients {
            for ([even, odd], &word) in sums.iter_mut().zip(row.as_chunks().0) {
                let word = u32::from_le_bytes(word);
                *even += word & 0x00ff_00ff;
                *odd += (word >> 8) & 0x00ff_00ff;
            }
        }
        const ALL_FLAT: i16 = MOST_ROWS as i16 * FLAT as i16;
        for (sums, [even, odd]) in self.sums.as_chunks_mut().0.iter_mut().zip(sums) {
            *sums = [even, odd, even >> 16, odd >> 16].map(|sum| sum as i16 - ALL_FLAT);
        }
    }

    /// Sum of the magnitudes at this distance.
    fn magnitude(&self, distance: i32) -> i32 {
        let index = usize::try_from(self.reach + 2 + distance).unwrap_or(COLUMNS);
        let of = |row: &[u8; COLUMNS]| row.get(index).map_or(0, |g| i32::from(g.abs_diff(FLAT)));
        self.gradients.iter().map(of).sum()
    }

    /// Sum of the gradients of one sign.
    fn sum(&self, distance: i32, sign: i32) -> i32 {
        let index = usize::try_from(self.reach + 2 + distance).unwrap_or(COLUMNS);
        self.sums.get(index).map_or(0, |&sum| i32::from(sum) * sign)
    }

    /// Sum of the segment's own edge, 1 for each row at least.
    fn own(&self) -> i32 {
        (-1..2).map(|at| self.sum(at, self.sign)).fold(self.rows, i32::max)
    }

    /// The nearest second edge on one side, and the strongest farther one of the other sign.
    fn peaks(&self, side: i32) -> [Option<Peak>; 2] {
        let own = self.own();
        let (mut nearest, mut strongest) = (None::<Peak>, None::<Peak>);
        for distance in 2..=self.reach {
            let at = side * distance;
            // Of the sign that the sum has.
            let same = if self.sum(at, self.sign) < 0 { -1 } else { 1 };
            let sign = same * self.sign;
            let sum = self.sum(at, sign);
            // 0.3 of its own edge; a step behind the bar needs 0.45, and 1.5 a row.
            let least = if same < 0 { 6 * own } else { 9 * own };
            if 20 * sum < least || 2 * sum < 3 * self.rows || same > 0 && distance < 3 {
                continue;
            }
            let is_peak = sum >= self.sum(at - 1, sign) && sum >= self.sum(at + 1, sign);
            if !is_peak || 5 * sum < 3 * self.magnitude(at) {
                continue;
            }
            let peak = Peak { at, sum, same };
            if nearest.is_none() {
                nearest = Some(peak);
            } else if same < 0 && strongest.is_none_or(|strongest| sum > strongest.sum) {
                strongest = Some(peak);
            }
        }
        [nearest, strongest]
    }

    /// Distance of a second edge from the line, 1/32 px.
    fn vertex_q5(&self, peak: &Peak) -> i32 {
        let sign = peak.same * self.sign;
        let [before, sum, after] = [peak.at - 1, peak.at, peak.at + 1].map(|at| self.sum(at, sign));
        (peak.at << 5)
            + quotient(self.off_q5, self.rows)
            + quotient((after - before) << 4, 2 * sum - before - after).clamp(-16, 16)
    }

    fn coherence_q8(&self, peak: &Peak) -> u8 {
        u8::try_from(quotient(peak.sum << 8, self.magnitude(peak.at))).unwrap_or(u8::MAX)
    }

    /// Mean gradient of a sum, 1/8.
    fn mean_q3(&self, sum: i32) -> u8 {
        u8::try_from(quotient(sum << 3, self.rows)).unwrap_or(u8::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::super::keep::Kept;
    use super::*;
    use crate::image::Dims;
    use crate::list::List;
    use crate::result::ImagePosition;
    use crate::units::Position;
    use core::mem::MaybeUninit;
    use heapless::Vec;

    const DIMS: Dims = Dims { width: 64, height: 32 };

    /// Bars beside the left edge of a strip of so many columns from column 20 on.
    fn beside(width: usize, rising: bool) -> Vec<Bar, 8> {
        let mut pixels = [90; 64 * 32];
        for row in pixels.chunks_mut(64) {
            row[20..20 + width].fill(if rising { 150 } else { 30 });
        }
        let end = |y: u16| ImagePosition { x: Position::from_num(19.5), y: Position::from_num(y) };
        let segment =
            Segment { ends: [end(6), end(26)], rising, contrast: 60, near_horizontal: false };
        let mut slots = [const { MaybeUninit::uninit() }; 8];
        let mut found = List::new(&mut slots);
        // The gradients of a sharp step are the same at two columns: doubles are one.
        let image = Gray::new(&pixels, DIMS, 64).unwrap();
        keep_beside(image, &segment, &mut Kept::new(&mut found));
        Vec::from_slice(&found).unwrap()
    }

    #[test]
    fn the_other_edge_gives_the_width() {
        for (width, rising) in [(2, true), (3, false), (6, true), (10, false), (14, true)] {
            let found = beside(width, rising);
            assert_eq!(found.len(), 1, "{width}: {found:?}");
            let apart = i32::from(found[0].width_q5) - ((width as i32) << 5);
            assert!(apart.abs() <= 2, "{width}: {found:?}");
            assert_eq!(found[0].signs(), if rising { [1, -1] } else { [-1, 1] });
            assert_eq!(found[0].rows, [6, 26]);
        }
    }

    #[test]
    fn a_wide_strip_is_no_bar() {
        assert!(beside(20, true).is_empty());
    }

    #[test]
    fn right_of_a_line_that_falls_to_the_right_is_what_lies_above() {
        let segment = |near_horizontal| Segment {
            ends: [ImagePosition::default(); 2],
            rising: true,
            contrast: 0,
            near_horizontal,
        };
        assert_eq!([sign_of(&segment(false), 900), sign_of(&segment(false), -900)], [1, 1]);
        assert_eq!([sign_of(&segment(true), 4500), sign_of(&segment(true), -4500)], [-1, 1]);
    }
}
