//! The depth of thin masks: that of the bars in them.
//!
//! In: the pixels of a mask, the bars that are told. Out: the bar that the mask shows, if there is
//! one, and its disparity at the mask's centre.
//!
//! # Bounds
//! Pixels of a bar: at most 81 rows of 24 columns.
//!
//! # Cost
//! The rows and columns of the bars in the mask's rows: some 15 instructions a pixel.

use super::Bar;
use crate::area::Area;

/// Widest mask, px a row on average, that bars answer for before all else.
pub(super) const WIDEST: u32 = 16;
/// Fewest pixels of a mask on bars.
const LEAST_PIXELS: u32 = 6;
/// Share of a mask's pixels that has to lie on bars of one disparity: an eighth.
const LEAST_SHARE: u32 = 8;
/// Largest difference of disparities of bars that are one thing, 1/64 px.
pub(super) const ONE_THING_Q6: i32 = 128;

/// Most pixels of a thin mask in this area.
pub(crate) fn most_pixels(area: Area) -> u32 {
    WIDEST * u32::from(area.bottom.saturating_sub(area.top))
}

/// The bar of a mask in this area of so many pixels, and its disparity at a row, 1/64 px: that with
/// most of its pixels inside, where bars of its disparity have enough of all pixels, and others
/// fewer.
pub(crate) fn depth_of(
    bars: &[Bar],
    area: Area,
    pixels: u32,
    row: i32,
    contains: impl Fn(i32, i32) -> bool,
) -> Option<(Bar, i32)> {
    if pixels > most_pixels(area) {
        return None;
    }
    let inside = |bar: &Bar| count_inside(bar, area, &contains);
    let at_q6 = |bar: &Bar| bar.disparity_nearest_q6(row);
    let most =
        bars.iter().map(|bar| (inside(bar), bar)).reduce(|a, b| if b.0 > a.0 { b } else { a });
    let (most, bar) = most?;
    let d_q6 = at_q6(bar);
    let (mut on, mut off) = (0, 0);
    for other in bars {
        let count = inside(other);
        *if (at_q6(other) - d_q6).abs() <= ONE_THING_Q6 { &mut on } else { &mut off } += count;
    }
    (most >= LEAST_PIXELS && LEAST_SHARE * on >= pixels && off < on).then_some((*bar, d_q6))
}

/// Number of pixels of a bar in a mask; none where most of them are outside: it crosses the mask,
/// and is another thing.
fn count_inside(bar: &Bar, area: Area, contains: &impl Fn(i32, i32) -> bool) -> u32 {
    let (mut inside, mut all) = (0, 0);
    let [first, last] = bar.rows;
    for y in first.max(area.top)..(last + 1).min(area.bottom) {
        let columns = bar.columns(y);
        all += u32::from(columns.end.saturating_sub(columns.start));
        inside += columns.filter(|&x| contains(x.into(), y.into())).count() as u32;
    }
    if 2 * inside >= all { inside } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bars::{FRONT, MATCHED, keep};

    /// A bar at this column, 6 px wide, over rows 10 to 49, at a disparity.
    fn bar(x: u16, d: i16, flags: u8) -> Bar {
        Bar {
            disparity_q6: [d << 6; 2],
            probability_q16: u16::MAX,
            flags: flags | MATCHED,
            ..keep::tests::bar(x, 6, [10, 49], 80)
        }
    }

    /// Disparity of a mask of these columns, px.
    fn of_mask(bars: &[Bar], columns: core::ops::Range<i32>) -> Option<i32> {
        let area =
            Area { left: columns.start as u16, top: 10, right: columns.end as u16, bottom: 50 };
        depth_of(bars, area, area.pixels(), 30, |x, _| columns.contains(&x))
            .map(|(_, d_q6)| d_q6 >> 6)
    }

    #[test]
    fn a_thin_mask_has_the_depth_of_its_bar() {
        assert_eq!(of_mask(&[bar(100, 20, FRONT)], 100..107), Some(20));
        assert_eq!(of_mask(&[bar(100, 20, 0)], 100..107), Some(20), "level with what is around it");
        assert_eq!(of_mask(&[bar(100, 20, FRONT)], 110..117), None);
        assert_eq!(of_mask(&[bar(100, 20, FRONT)], 80..120), None, "no thin mask");
        assert_eq!(of_mask(&[bar(100, 20, FRONT)], 106..122), None, "it fills too little");
        assert_eq!(
            of_mask(&[bar(100, 20, FRONT), bar(108, 9, FRONT)], 100..115),
            None,
            "two things"
        );
    }
}
