//! Block matching as OpenCV's StereoBM does it, number for number: the rival that users know.
//!
//! In: a pair. Out: disparities in 1/16 px where texture and uniqueness allow.
//!
//! ```text
//! values  = Sobel along the row, clipped to +-cap, plus cap                   first and last column: cap; an odd last row: cap
//! cost    = sum of absolute differences of the values over a square window    inside both images at every disparity
//! best    = the lowest cost, the largest disparity of equals
//! texture = sum of abs(value - cap) over the window >= threshold
//! unique  = every cost more than 1 px from the best > best + best * ratio / 100
//! result  = best + (before - after) / (2 (max(before, after) - best cost)), in 1/256 px, plus 15 and halved four times
//! ```
//!
//! # Bounds
//! A cost is at most `side^2 * 2 cap`; up to 21 x 21 px with a cap of 31 it is 27 342 and fits `i16`.
//!
//! # Cost
//! Disparities are contiguous, columns are summed as rows slide: three additions of 16 bits a disparity and pixel.
//!
//! # Source
//! OpenCV, `calib3d/stereobm.cpp` (Konolige's block matcher); `tests/tests/opencv.rs` compares maps with those of the installed one.

use super::map::DisparityMap;
use super::search::Search;
use super::window::Window;
use core::fmt;
use linestereo_frames::GrayImage;

/// Largest sum of a window.
const LARGEST_SUM: usize = i16::MAX as usize;

/// Why a block matcher cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StereoBmError {
    /// The window's sums do not fit 16 bits, or its side is even.
    Window(usize),
    /// The cap is 0 or above 63.
    Cap(u8),
}

impl fmt::Display for StereoBmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Window(side) => write!(f, "a window of {side} px is even or too large; give an odd side of up to 21"),
            Self::Cap(cap) => write!(f, "gradients cannot be clipped to {cap}; give 1 to 63"),
        }
    }
}

impl core::error::Error for StereoBmError {}

/// The block matcher.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StereoBm {
    side: usize,
    cap: u8,
    /// Least sum of `abs(value - cap)` over a window.
    pub texture_threshold: u32,
    /// Percent by which every other cost has to be above the lowest.
    pub uniqueness_ratio: u32,
}

impl Default for StereoBm {
    /// OpenCV's defaults, with its usual window of 15 x 15 px.
    fn default() -> Self {
        Self { side: 15, cap: 31, texture_threshold: 10, uniqueness_ratio: 15 }
    }
}

impl StereoBm {
    /// A matcher with another window and cap.
    pub fn new(side: usize, cap: u8) -> Result<Self, StereoBmError> {
        if !(1..=63).contains(&cap) {
            return Err(StereoBmError::Cap(cap));
        }
        if side.is_multiple_of(2) || side * side * 2 * usize::from(cap) > LARGEST_SUM {
            return Err(StereoBmError::Window(side));
        }
        Ok(Self { side, cap, ..Self::default() })
    }

    /// Strict settings: uniqueness 90 and texture 3000.
    #[must_use]
    pub fn strict() -> Self {
        Self { texture_threshold: 3000, uniqueness_ratio: 90, ..Self::default() }
    }

    /// Matches a pair.
    #[must_use]
    pub fn run(&self, left: &GrayImage, right: &GrayImage, search: Search) -> DisparityMap {
        let mut map = DisparityMap::empty(left.dims);
        let window = Window::square(self.side);
        let (columns, rows) = (search.window_columns(&window), search.window_rows(&window));
        if columns.is_empty() || rows.is_empty() {
            return map;
        }
        let width = search.width();
        let left = prefilter(left, self.cap);
        let mirrored: Vec<u8> =
            prefilter(right, self.cap).chunks(width).flat_map(|row| row.iter().rev().copied()).collect();
        let mut sums = Columns::new(self, search, &left, &mirrored);
        for y in rows {
            sums.move_to(y);
            sums.read_row(y, self, &mut map);
        }
        map
    }
}

/// Sobel along the row, clipped, in OpenCV's order of rows.
fn prefilter(image: &GrayImage, cap: u8) -> Vec<u8> {
    let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
    let mut values = vec![cap; width * height];
    let row = |y: usize| &image.pixels[y * width..(y + 1) * width];
    let cap = i32::from(cap);
    // Rows are filtered in pairs: an odd one at the end is left alone.
    for y in 0..height & !1 {
        let above = row(if y > 0 { y - 1 } else { 1 });
        let below = row(if y + 1 < height { y + 1 } else { y - 1 });
        let (here, out) = (row(y), &mut values[y * width..(y + 1) * width]);
        for x in 1..width - 1 {
            let step = |row: &[u8]| i32::from(row[x + 1]) - i32::from(row[x - 1]);
            out[x] = ((step(above) + 2 * step(here) + step(below)).clamp(-cap, cap) + cap) as u8;
        }
    }
    values
}

/// Column sums of a row of windows, costs and texture.
struct Columns<'a> {
    search: Search,
    half: usize,
    cap: u8,
    left: &'a [u8],
    mirrored: &'a [u8],
    costs: Vec<i16>,
    texture: Vec<i32>,
    window: Vec<i16>,
    filled: bool,
}

impl<'a> Columns<'a> {
    fn new(matcher: &StereoBm, search: Search, left: &'a [u8], mirrored: &'a [u8]) -> Self {
        let columns = search.columns();
        Self {
            search,
            half: matcher.side / 2,
            cap: matcher.cap,
            left,
            mirrored,
            costs: vec![0; columns * search.count],
            texture: vec![0; columns],
            window: vec![0; search.count],
            filled: false,
        }
    }

    /// The values of a row and, from right to left, those of the right image.
    fn rows(&self, y: usize) -> (&'a [u8], &'a [u8]) {
        let row = y * self.search.width()..(y + 1) * self.search.width();
        (&self.left[row.clone()], &self.mirrored[row])
    }

    fn move_to(&mut self, y: usize) {
        let (width, first, count, cap) = (self.search.width(), self.search.first(), self.search.count, self.cap);
        if !self.filled {
            for row in y - self.half..=y + self.half {
                let (left, mirrored) = self.rows(row);
                for (x, (costs, texture)) in (first..).zip(self.costs.chunks_exact_mut(count).zip(&mut self.texture)) {
                    *texture += i32::from(left[x].abs_diff(cap));
                    for (cost, &other) in costs.iter_mut().zip(&mirrored[width - 1 - x..][..count]) {
                        *cost += i16::from(left[x].abs_diff(other));
                    }
                }
            }
            self.filled = true;
            return;
        }
        let ((enter, enter_right), (leave, leave_right)) = (self.rows(y + self.half), self.rows(y - self.half - 1));
        for (x, (costs, texture)) in (first..).zip(self.costs.chunks_exact_mut(count).zip(&mut self.texture)) {
            let (new, old) = (enter[x], leave[x]);
            *texture += i32::from(new.abs_diff(cap)) - i32::from(old.abs_diff(cap));
            let (new_right, old_right) =
                (&enter_right[width - 1 - x..][..count], &leave_right[width - 1 - x..][..count]);
            for ((cost, &new_other), &old_other) in costs.iter_mut().zip(new_right).zip(old_right) {
                *cost += i16::from(new.abs_diff(new_other)) - i16::from(old.abs_diff(old_other));
            }
        }
    }

    fn read_row(&mut self, y: usize, matcher: &StereoBm, map: &mut DisparityMap) {
        let (count, half, first) = (self.search.count, self.half, self.search.first());
        let column = |x: usize| x * count..(x + 1) * count;
        self.window.fill(0);
        let mut texture = 0;
        for x in 0..2 * half {
            slide(&mut self.window, &self.costs[column(x)], None);
            texture += self.texture[x];
        }
        for x in half..self.search.columns() - half {
            let leaves = (x > half).then(|| &self.costs[column(x - half - 1)]);
            slide(&mut self.window, &self.costs[column(x + half)], leaves);
            texture += self.texture[x + half] - if x > half { self.texture[x - half - 1] } else { 0 };
            if texture >= matcher.texture_threshold as i32
                && let Some((sixteenths, confidence)) = best(&self.window, matcher.uniqueness_ratio)
            {
                map.set(first + x, y, sixteenths as f32 / 16.0, confidence);
            }
        }
    }
}

fn slide(window: &mut [i16], enters: &[i16], leaves: Option<&[i16]>) {
    match leaves {
        Some(leaves) => {
            for ((sum, &new), &old) in window.iter_mut().zip(enters).zip(leaves) {
                *sum = sum.wrapping_add(new).wrapping_sub(old);
            }
        }
        None => window.iter_mut().zip(enters).for_each(|(sum, &new)| *sum += new),
    }
}

/// The disparity in 1/16 px and its confidence, if it is unique.
fn best(costs: &[i16], uniqueness_ratio: u32) -> Option<(i32, f32)> {
    let cost = lowest(costs);
    let d = costs.iter().rposition(|&other| other == cost)?;
    let second = i32::from(lowest(&costs[..d.saturating_sub(1)]).min(lowest(costs.get(d + 2..).unwrap_or(&[]))));
    let cost = i32::from(cost);
    if uniqueness_ratio > 0 && second <= cost + cost * uniqueness_ratio as i32 / 100 {
        return None;
    }
    let fraction = if d > 0 && d + 1 < costs.len() {
        let (before, after) = (i32::from(costs[d - 1]), i32::from(costs[d + 1]));
        let width = 2 * (before.max(after) - cost);
        if width == 0 { 0 } else { (before - after) * 256 / width }
    } else {
        0
    };
    let confidence = if second == 0 { 0.0 } else { 1.0 - cost as f32 / second as f32 };
    Some(((d as i32 * 256 + fraction + 15) >> 4, confidence))
}

/// `i16::MAX` of nothing.
fn lowest(costs: &[i16]) -> i16 {
    costs.iter().copied().fold(i16::MAX, i16::min)
}
