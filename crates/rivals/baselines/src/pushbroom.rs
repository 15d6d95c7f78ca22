//! Pushbroom stereo: one disparity alone, for a vehicle that flies into what it has not seen yet and remembers the rest.
//!
//! In: a pair and a disparity. Out: the blocks that match at it.
//!
//! ```text
//! for each block on a grid of its own size:
//!     edges = sum of abs(Laplace) over the block in both images                      at least least_edges: something to match
//!     score = 256 * sum of abs(L(x, y) - R(x - d, y)) / edges                        at most largest_score
//!     the block in the right image, moved by 1.5 to 2 blocks along the row           alike: a horizontal line or repetition, dropped
//! ```
//!
//! # Cost
//! A block is looked at once: `4 + 8` operations a pixel, whatever the range. That is the idea.
//!
//! # Source
//! Barry and Tedrake, "Pushbroom stereo for high-speed navigation in cluttered environments" (2015), whose check along
//! horizontal lines moves the block in the same way.

use super::map::DisparityMap;
use linestereo_frames::GrayImage;

/// The matcher.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PushbroomMatcher {
    /// The one disparity, px.
    pub disparity: u16,
    /// Side of a block, px.
    pub block: usize,
    /// Least sum of edges in both blocks.
    pub least_edges: u32,
    /// Largest difference for each 256 of edges.
    pub largest_score: u32,
}

impl PushbroomMatcher {
    /// Blocks of 5 x 5 px.
    #[must_use]
    pub const fn new(disparity: u16) -> Self {
        Self { disparity, block: 5, least_edges: 800, largest_score: 16 }
    }

    /// Matches a pair; a block that matches speaks for the pixels of its middle third.
    #[must_use]
    pub fn run(&self, left: &GrayImage, right: &GrayImage) -> DisparityMap {
        let mut map = DisparityMap::empty(left.dims);
        let (width, height) = (usize::from(left.dims.width), usize::from(left.dims.height));
        let (block, shift) = (self.block, usize::from(self.disparity));
        let edges = [left, right].map(laplacians);
        let third = block / 3..block - block / 3;
        for top in (1..height.saturating_sub(block)).step_by(block) {
            for x in (shift + 1..width.saturating_sub(block)).step_by(block) {
                let sum =
                    block_sum(&edges[0], width, (x, top), block) + block_sum(&edges[1], width, (x - shift, top), block);
                if sum < self.least_edges {
                    continue;
                }
                let alike = |image: &GrayImage, other: usize| {
                    256 * difference(left, image, [(x, top), (other, top)], block) / sum
                };
                let score = alike(right, x - shift);
                if score > self.largest_score || self.repeats(x - shift, width, |other| alike(right, other)) {
                    continue;
                }
                let confidence = 1.0 - score as f32 / (self.largest_score + 1) as f32;
                for (dy, dx) in third.clone().flat_map(|dy| third.clone().map(move |dx| (dy, dx))) {
                    map.set(x + dx, top + dy, self.disparity.into(), confidence);
                }
            }
        }
        map
    }

    /// Something beside the block's match looks like it, too.
    fn repeats(&self, x: usize, width: usize, alike: impl Fn(usize) -> u32) -> bool {
        let distances = 3 * self.block / 2..=2 * self.block;
        distances
            .flat_map(|distance| [x.checked_sub(distance), Some(x + distance)])
            .flatten()
            .filter(|other| other + self.block < width)
            .any(|other| alike(other) <= self.largest_score)
    }
}

/// `abs(4 I(x, y) - its four neighbours)`; 0 at the border.
fn laplacians(image: &GrayImage) -> Vec<u16> {
    let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
    let mut edges = vec![0; width * height];
    let grey = |i: usize| i32::from(image.pixels[i]);
    for y in 1..height.saturating_sub(1) {
        let row = y * width + 1..(y + 1) * width - 1;
        for (i, edge) in row.clone().zip(&mut edges[row]) {
            let around = grey(i - 1) + grey(i + 1) + grey(i - width) + grey(i + width);
            *edge = (4 * grey(i) - around).unsigned_abs() as u16;
        }
    }
    edges
}

fn block_sum(values: &[u16], width: usize, (x, y): (usize, usize), block: usize) -> u32 {
    let row = |dy: usize| &values[(y + dy) * width + x..][..block];
    (0..block).flat_map(row).map(|&value| u32::from(value)).sum()
}

fn difference(one: &GrayImage, other: &GrayImage, [at, other_at]: [(usize, usize); 2], block: usize) -> u32 {
    let row = |image: &GrayImage, (x, y): (usize, usize), dy: usize| {
        let start = (y + dy) * usize::from(image.dims.width) + x;
        start..start + block
    };
    let of_row = |dy: usize| {
        let (one, other) = (&one.pixels[row(one, at, dy)], &other.pixels[row(other, other_at, dy)]);
        one.iter().zip(other).map(|(a, b)| u32::from(a.abs_diff(*b))).sum::<u32>()
    };
    (0..block).map(of_row).sum()
}
