//! Do rows agree? A raw and a rectified pair with lines across both images.

use super::shown;
use image::{Rgb, RgbImage};
use linestereo_frames::GrayImage;

/// Rows of the rectified images between lines.
const SPACING: u32 = 32;
/// Pixels between the images.
const GAP: u32 = 4;
const COLOURS: [Rgb<u8>; 3] = [Rgb([255, 80, 60]), Rgb([70, 200, 90]), Rgb([90, 150, 255])];
const BACKGROUND: Rgb<u8> = Rgb([40, 40, 40]);

/// The raw pair above, scaled to the same width, and the rectified one below, each with a line
/// every 32 px across both images.
pub fn rows(raw: &[GrayImage; 2], rectified: &[GrayImage; 2]) -> RgbImage {
    let dims = rectified[0].dims;
    let (width, height) = (u32::from(dims.width), u32::from(dims.height));
    let raw_height = (width * u32::from(raw[0].dims.height)).div_ceil(raw[0].dims.width.into());
    let mut picture = RgbImage::from_pixel(2 * width + GAP, raw_height + GAP + height, BACKGROUND);
    for (pair, top, height) in [(raw, 0, raw_height), (rectified, raw_height + GAP, height)] {
        for (image, left) in pair.iter().zip([0, width + GAP]) {
            paste(&mut picture, &shown(image), left, top, [width, height]);
        }
        for (y, colour) in
            (SPACING / 2..height).step_by(SPACING as usize).zip(COLOURS.iter().cycle())
        {
            for x in 0..picture.width() {
                picture.put_pixel(x, top + y, *colour);
            }
        }
    }
    picture
}

/// Puts an image there, scaled to this size by its nearest pixels.
fn paste(
    picture: &mut RgbImage,
    image: &GrayImage,
    left: u32,
    top: u32,
    [width, height]: [u32; 2],
) {
    let (from_width, from_height) = (u32::from(image.dims.width), u32::from(image.dims.height));
    for y in 0..height {
        for x in 0..width {
            let (from_x, from_y) =
                (x * from_width / width, (y * from_height / height).min(from_height - 1));
            let grey = image.pixels[(from_y * from_width + from_x) as usize];
            picture.put_pixel(left + x, top + y, Rgb([grey; 3]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::Dims;

    #[test]
    fn raw_above_rectified_with_lines_across_both() {
        let image = |width, height, grey| GrayImage {
            dims: Dims { width, height },
            pixels: vec![grey; usize::from(width) * usize::from(height)],
        };
        let picture = rows(
            &[image(128, 96, 150), image(128, 96, 160)],
            &[image(64, 40, 170), image(64, 40, 5)],
        );
        assert_eq!(picture.dimensions(), (2 * 64 + GAP, 48 + GAP + 40));
        let grey = |x, y| picture.get_pixel(x, y).0;
        assert_eq!([grey(3, 3), grey(100, 3)], [[150; 3], [160; 3]]);
        assert_eq!([grey(3, 60), grey(100, 60)], [[170; 3], [159; 3]]);
        assert_eq!(grey(65, 3), BACKGROUND.0);
        for y in [16, 48 + GAP + 16] {
            assert!((0..picture.width()).all(|x| grey(x, y) == COLOURS[0].0), "row {y}");
        }
    }
}
