//! Census codes, their costs, and block matching on them.
//!
//! ```text
//! code = a bit for each pixel of 5 x 5: darker than the centre or not
//! cost = sum over a window of the Hamming distances of the codes
//! ```
//! Outside of an image its nearest pixel counts.
//!
//! # Source
//! Zabih and Woodfill, "Non-parametric local transforms for computing visual correspondence"
//! (1994).

use crate::curve::Acceptance;
use crate::windows::{BLOCK_HALF, Windows};
use crate::{DisparityMap, Search};
use linestereo::Dims;
use linestereo_frames::GrayImage;

/// Half the side of a code's window.
const CODE_HALF: usize = 2;

/// Every pixel by the lowest cost of the block around it, with OpenCV's usual uniqueness of 15.
pub(crate) fn match_blocks(pair: [&GrayImage; 2], search: Search) -> DisparityMap {
    let mut map = DisparityMap::empty(search.dims);
    let acceptance = Acceptance { least_confidence: 15.0 / 115.0, left_right: false };
    windows(pair, search, BLOCK_HALF).for_each_row(hamming, |row| acceptance.fill(row, &mut map));
    map
}

/// Windows of `half` px to each side over the codes of a pair.
pub(crate) fn windows(pair: [&GrayImage; 2], search: Search, half: usize) -> Windows<u32> {
    Windows::new(search, half, pair.map(codes))
}

/// Bits that differ, at most 24.
pub(crate) fn hamming(left: u32, right: u32) -> u8 {
    (left ^ right).count_ones() as u8
}

/// The code of each pixel.
fn codes(image: &GrayImage) -> Vec<u32> {
    let padded = padded(image, CODE_HALF);
    let (width, stride) = (usize::from(image.dims.width), usize::from(padded.dims.width));
    let code = |top_left: usize| {
        let centre = padded.pixels[top_left + CODE_HALF * (stride + 1)];
        let rows = (0..=2 * CODE_HALF)
            .map(|row| &padded.pixels[top_left + row * stride..][..=2 * CODE_HALF]);
        rows.flatten().fold(0, |code, &grey| code << 1 | u32::from(grey < centre))
    };
    (0..usize::from(image.dims.height))
        .flat_map(|y| (0..width).map(move |x| y * stride + x))
        .map(code)
        .collect()
}

/// The image with its border pixels repeated `margin` times on every side.
pub(crate) fn padded(image: &GrayImage, margin: usize) -> GrayImage {
    let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
    let nearest = |at: usize, size: usize| at.clamp(margin, margin + size - 1) - margin;
    let row = |y: usize| {
        let row = &image.pixels[nearest(y, height) * width..][..width];
        (0..width + 2 * margin).map(move |x| row[nearest(x, width)])
    };
    let pixels = (0..height + 2 * margin).flat_map(row).collect();
    let dims = Dims { width: (width + 2 * margin) as u16, height: (height + 2 * margin) as u16 };
    GrayImage { dims, pixels }
}
