//! Rank codes of the rows that a row of support points looks at.
//!
//! In: both images. Out: the windows of a point in the left image and at rising columns of the right one.

use crate::image::Gray;
use crate::kernel::{RANK_FLAT, RANK_ROWS, rank_row};
use crate::units::quotient;

/// Columns of a window.
pub(super) const WINDOW_COLUMNS: usize = 8;
/// Pixels at both ends of a row whose neighbours lie outside of it.
pub(super) const BORDER: i32 = 2;
/// Rows of a window, every second one of the image.
pub(super) const WINDOW_ROWS: usize = RANK_ROWS;
/// Rows from one to the next.
const ROW_STEP: i32 = 2;

/// Bytes of the codes held for images of this width.
pub(super) const fn bytes(width: u16) -> usize {
    2 * WINDOW_ROWS * width as usize
}

/// Codes of the last [`WINDOW_ROWS`] even rows of both images.
pub(super) struct RankRows<'a> {
    images: [Gray<'a>; 2],
    row_offset: i32,
    codes: [&'a mut [u8]; 2],
    width: usize,
    /// The next row of the left image to be coded.
    next: i32,
    /// The last even row.
    last: i32,
    /// Where the codes of the rows of the window begin.
    starts: [usize; WINDOW_ROWS],
}

impl<'a> RankRows<'a> {
    pub(super) fn new(images: [Gray<'a>; 2], row_offset: i32, memory: &'a mut [u8]) -> Option<Self> {
        let [left, _] = images;
        let dims = left.dims();
        let width = usize::from(dims.width);
        let (a, b) = memory.get_mut(..bytes(dims.width))?.split_at_mut_checked(WINDOW_ROWS * width)?;
        let last = (i32::from(dims.height) - 1) & !1;
        Some(Self { images, row_offset, codes: [a, b], width, next: -1, last, starts: [0; WINDOW_ROWS] })
    }

    /// Codes the rows of windows around row `y`; rows come from the top down.
    pub(super) fn advance(&mut self, y: i32) {
        let (above, below) = (4, 2);
        let top = y - above;
        self.next = self.next.max(top);
        while self.next <= (y + below).min(self.last) {
            let [left, right] = self.images;
            let [ours, theirs] = &mut self.codes;
            let start = Self::start(self.next, self.width);
            for (image, row, codes) in [(left, self.next, ours), (right, self.next + self.row_offset, theirs)] {
                if let Some(codes) = codes.get_mut(start..start + self.width) {
                    code(image, row, codes);
                }
            }
            self.next += ROW_STEP;
        }
        for (start, k) in self.starts.iter_mut().zip(0..) {
            *start = Self::start((top + ROW_STEP * k).min(self.last), self.width);
        }
    }

    /// Where the codes of a row begin.
    fn start(y: i32, width: usize) -> usize {
        let row = quotient(y, ROW_STEP);
        let slot = row.checked_rem(WINDOW_ROWS as i32).unwrap_or(0);
        usize::try_from(slot).unwrap_or(0) * width
    }

    /// Hands `compare` the window that begins at column `x` of the left image, and the rows of the right one from column `first` on.
    pub(super) fn windows(
        &self,
        x: i32,
        first: i32,
        compare: impl FnOnce(&[[u8; WINDOW_COLUMNS]; WINDOW_ROWS], &[&[u8]; WINDOW_ROWS]),
    ) {
        let (Ok(x), Ok(first)) = (usize::try_from(x), usize::try_from(first)) else { return };
        let [left, right] = &self.codes;
        let (mut ours, mut theirs) = ([[0; WINDOW_COLUMNS]; WINDOW_ROWS], [[].as_slice(); WINDOW_ROWS]);
        for ((ours, theirs), &start) in ours.iter_mut().zip(&mut theirs).zip(&self.starts) {
            if let Some(window) = left.get(start + x..).and_then(|codes| codes.first_chunk()) {
                *ours = *window;
            }
            *theirs = right.get(start + first..start + self.width).unwrap_or(&[]);
        }
        compare(&ours, &theirs);
    }
}

/// Ranks of a row; the nearest one of the image where it lies outside. What is not usable is flat.
fn code(image: Gray<'_>, y: i32, out: &mut [u8]) {
    let last = i32::from(image.dims().height) - 1;
    let rows = [y - 2, y, y + 2].map(|y| image.row(y.max(0).min(last) as usize).unwrap_or(&[]));
    rank_row(rows, out);
    let usable = image.usable_columns(y);
    let (start, end) = (usize::from(usable.start), usize::from(usable.end));
    if let Some(before) = out.get_mut(..start) {
        before.fill(RANK_FLAT);
    }
    if let Some(after) = out.get_mut(end..) {
        after.fill(RANK_FLAT);
    }
}
