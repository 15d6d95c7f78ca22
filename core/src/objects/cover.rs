//! A region's pixels as a bit mask: membership of a pixel in constant time.
//!
//! In: a region, and words for a bit per pixel of the image. Out: membership of a pixel, the
//! region's centre, half size, and thinness.
//!
//! # Bounds
//! Sums of columns and rows over at most 2^21 pixels of at most 2^12: below 2^34, `i64`.
//!
//! # Cost
//! A box needs no words. A mask: the words of its rows, and its runs twice.

use super::region::{Region, Run, Shape};
use crate::area::Area;
use crate::matching::WINDOW_MIDDLE;

/// The pixels of one region.
pub(crate) struct Cover<'a> {
    pub(crate) area: Area,
    width: usize,
    /// `None` for a box: all pixels of the area.
    bits: Option<&'a [u32]>,
    /// Number of its pixels.
    pub(crate) pixels: u32,
    /// Mean column and row of its pixels, px.
    pub(crate) centre: [i32; 2],
    /// Half of the area's width and height, px, at least 1.
    pub(crate) half_size: [i32; 2],
    /// True for a mask of at most [`WINDOW_MIDDLE`] px a row on average: no window beside an edge
    /// lies in it.
    pub(crate) is_thin: bool,
}

impl<'a> Cover<'a> {
    /// The cover of a region in an image of this width; overwrites `marks`.
    pub(crate) fn new(region: &Region<'_>, width: u16, marks: &'a mut [u32]) -> Self {
        let area = region.area();
        let width = usize::from(width);
        let middle = |from: u16, to: u16| (i32::from(from) + i32::from(to) - 1) >> 1;
        let centre = [middle(area.left, area.right), middle(area.top, area.bottom)];
        let half = |from: u16, to: u16| ((i32::from(to) - i32::from(from) + 1) >> 1).max(1);
        let half_size = [half(area.left, area.right), half(area.top, area.bottom)];
        let Shape::Mask(runs) = region.shape() else {
            return Self {
                area,
                width,
                bits: None,
                pixels: area.pixels(),
                centre,
                half_size,
                is_thin: false,
            };
        };

        let words = (usize::from(area.top) * width) >> 5..=(usize::from(area.bottom) * width) >> 5;
        for word in marks.iter_mut().take(*words.end() + 1).skip(*words.start()) {
            *word = 0;
        }
        let (mut pixels, mut columns, mut rows) = (0_i64, 0_i64, 0_i64);
        let first = runs.partition_point(|run| run.y < area.top);
        let last = runs.partition_point(|run| run.y < area.bottom);
        for run in
            runs.get(first..last).unwrap_or(&[]).iter().filter(|run| run.label == region.label())
        {
            paint(run, width, marks);
            let [start, end] = [run.span.start, run.span.end].map(i64::from);
            pixels += end - start;
            columns += (end - start) * (start + end - 1); // twice their sum
            rows += (end - start) * i64::from(run.y);
        }
        let mean = |sum: i64, of: i64| i32::try_from(sum.checked_div(of).unwrap_or(0)).unwrap_or(0);
        let centre = [mean(columns, 2 * pixels), mean(rows, pixels)];
        let height = i64::from(area.bottom) - i64::from(area.top);
        let is_thin = pixels <= i64::from(WINDOW_MIDDLE) * height;
        let pixels = u32::try_from(pixels).unwrap_or(0);
        Self { area, width, bits: Some(marks), pixels, centre, half_size, is_thin }
    }

    /// True for a box.
    pub(crate) fn is_box(&self) -> bool {
        self.bits.is_none()
    }

    /// True when the pixel belongs to the region.
    #[inline(never)]
    pub(crate) fn contains(&self, x: i32, y: i32) -> bool {
        if !self.area.contains(x, y) {
            return false;
        }
        let Some(bits) = self.bits else { return true };
        let bit = y as usize * self.width + x as usize; // inside of the area: neither is negative
        bits.get(bit >> 5).is_some_and(|word| word >> (bit & 31) & 1 == 1)
    }
}

/// Sets the bits of a run.
fn paint(run: &Run, width: usize, marks: &mut [u32]) {
    let row = usize::from(run.y) * width;
    let (start, last) =
        (row + usize::from(run.span.start), row + usize::from(run.span.end).saturating_sub(1));
    let words = start >> 5..=last >> 5;
    for (word, index) in marks.iter_mut().skip(*words.start()).zip(words.clone()) {
        let from = if index == *words.start() { u32::MAX << (start & 31) } else { u32::MAX };
        let to = if index == *words.end() { u32::MAX >> (31 - (last & 31)) } else { u32::MAX };
        *word |= from & to;
    }
}
