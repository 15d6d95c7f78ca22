//! Rank, census and gradient transforms of an image. Outside of it its nearest pixel counts.
//!
//! # Source
//! Rank and census: Zabih and Woodfill, "Non-parametric local transforms for computing visual correspondence" (1994).

use linestereo_frames::GrayImage;

/// Half the side of the window of a rank: 7x7, 0 to 48.
const RANK_HALF: isize = 3;
/// Half the side of the window of a census code: 5x5, 24 bits.
const CENSUS_HALF: isize = 2;
/// Largest step of a gradient, in quarters of a Sobel sum.
const LARGEST_STEP: i32 = 31;

/// Neighbours that are darker than the pixel.
pub(super) fn ranks(image: &GrayImage) -> Vec<u8> {
    map(image, |padded, x, y| {
        let centre = padded.at(x, y);
        padded.around(x, y, RANK_HALF).filter(|&grey| grey < centre).count() as u8
    })
}

/// One bit per neighbour, row by row: darker than the pixel or not.
pub(super) fn census_codes(image: &GrayImage) -> Vec<u32> {
    map(image, |padded, x, y| {
        let centre = padded.at(x, y);
        padded.around(x, y, CENSUS_HALF).fold(0, |code, grey| code << 1 | u32::from(grey < centre))
    })
}

/// Sobel steps to the right, a quarter, clipped, plus the clip: 0 to 62.
pub(super) fn gradients(image: &GrayImage) -> Vec<u8> {
    map(image, |padded, x, y| {
        let step = |dy: isize| i32::from(padded.at(x + 1, y + dy)) - i32::from(padded.at(x - 1, y + dy));
        let sum = step(-1) + 2 * step(0) + step(1);
        ((sum / 4).clamp(-LARGEST_STEP, LARGEST_STEP) + LARGEST_STEP) as u8
    })
}

/// The image with its border pixels repeated around it.
struct Padded {
    pixels: Vec<u8>,
    width: isize,
}

/// Pixels added on every side.
const MARGIN: isize = 3;

impl Padded {
    fn new(image: &GrayImage) -> Self {
        let (width, height) = (image.dims.width as isize, image.dims.height as isize);
        let row = |y: isize| {
            let row = &image.pixels[y.clamp(0, height - 1) as usize * width as usize..][..width as usize];
            (-MARGIN..width + MARGIN).map(move |x| row[x.clamp(0, width - 1) as usize])
        };
        let pixels = (-MARGIN..height + MARGIN).flat_map(row).collect();
        Self { pixels, width: width + 2 * MARGIN }
    }

    fn at(&self, x: isize, y: isize) -> u8 {
        self.pixels[((y + MARGIN) * self.width + x + MARGIN) as usize]
    }

    /// The neighbours, row by row, without the pixel itself.
    fn around(&self, x: isize, y: isize, half: isize) -> impl Iterator<Item = u8> {
        let offsets = (-half..=half).flat_map(move |dy| (-half..=half).map(move |dx| (dx, dy)));
        offsets.filter(|&offset| offset != (0, 0)).map(move |(dx, dy)| self.at(x + dx, y + dy))
    }
}

fn map<T>(image: &GrayImage, value: impl Fn(&Padded, isize, isize) -> T) -> Vec<T> {
    let padded = Padded::new(image);
    let (width, height) = (image.dims.width as isize, image.dims.height as isize);
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(&padded, x, y)).collect()
}
