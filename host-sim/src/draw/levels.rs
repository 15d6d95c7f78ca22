//! Grey levels as they are shown: dark images are stretched, so that what is matched in them is
//! seen.

use linestereo_frames::GrayImage;
use std::borrow::Cow;

/// Images are stretched in which all but one pixel in a hundred are darker than this.
const DARK: usize = 128;
/// Least grey level that is stretched to white: below it there is noise alone.
const LEAST_WHITE: usize = 8;

/// The image, or a brighter one where it is dark.
pub fn shown(image: &GrayImage) -> Cow<'_, GrayImage> {
    let mut counts = [0_usize; 256];
    image.pixels.iter().for_each(|&value| counts[usize::from(value)] += 1);
    let mut left = image.pixels.len() / 100;
    let above = |&level: &usize| {
        let is_below = counts[level] <= left;
        left = left.saturating_sub(counts[level]);
        is_below
    };
    let white = 255 - (0..256).rev().take_while(above).count().min(255);
    if white >= DARK {
        return Cow::Borrowed(image);
    }
    let white = white.max(LEAST_WHITE);
    let stretched = |&value: &u8| (usize::from(value) * 255 / white).min(255) as u8;
    Cow::Owned(GrayImage { dims: image.dims, pixels: image.pixels.iter().map(stretched).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::Dims;

    #[test]
    fn only_dark_images_are_stretched() {
        let image = |values: &[(u8, usize)]| {
            let pixels: Vec<u8> =
                values.iter().flat_map(|&(value, count)| vec![value; count]).collect();
            GrayImage { dims: Dims { width: pixels.len() as u16, height: 1 }, pixels }
        };
        let bright = image(&[(10, 900), (128, 100)]);
        assert!(matches!(shown(&bright), Cow::Borrowed(_)));
        // A lamp of less than a hundredth does not make it bright.
        let dark = image(&[(0, 100), (15, 700), (30, 195), (255, 5)]);
        let found = shown(&dark);
        assert_eq!([0, 100, 800, 995].map(|i| found.pixels[i]), [0, 127, 255, 255]);
        assert_eq!(shown(&image(&[(1, 50)])).pixels[0], 31);
        assert_eq!(shown(&image(&[(0, 50)])).pixels[0], 0);
    }
}
