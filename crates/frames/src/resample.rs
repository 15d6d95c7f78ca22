//! Area resampling: every output pixel is the mean of the rectangle of input pixels it covers.
//!
//! # Bounds
//! A sum of weights is `width * height` of the input, below 2^32; times 255 fits `u64`.

use crate::grey::GrayImage;
use linestereo::Dims;

/// The width asked for is 0, or larger than the image's: images are only ever reduced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("--width {asked} is not between 1 and the image's {have}; images are only ever reduced")]
pub struct WidthError {
    /// Width of the image, px.
    pub have: u16,
    /// Width asked for, px.
    pub asked: u16,
}

/// Height that goes with `width` when the aspect ratio is kept, rounded, at least 1.
pub fn resampled_height(dims: Dims, width: u16) -> u16 {
    let (from_width, from_height) = (u32::from(dims.width).max(1), u32::from(dims.height));
    let height = (from_height * u32::from(width) + from_width / 2) / from_width;
    u16::try_from(height.max(1)).unwrap_or(u16::MAX)
}

/// Reduces an image to `width` by exact area averaging, rounded to nearest.
pub fn area_average(image: &GrayImage, width: u16) -> Result<GrayImage, WidthError> {
    if width == 0 || width > image.dims.width {
        return Err(WidthError { have: image.dims.width, asked: width });
    }
    let dims = Dims { width, height: resampled_height(image.dims, width) };
    if dims == image.dims {
        return Ok(image.clone());
    }
    let columns = spans(image.dims.width, dims.width);
    let rows = spans(image.dims.height, dims.height);
    let total = u64::from(image.dims.width) * u64::from(image.dims.height);
    let from_width = usize::from(image.dims.width);
    let mut pixels = Vec::with_capacity(usize::from(dims.width) * usize::from(dims.height));
    for row_span in &rows {
        // Weighted column sums of the rows this output row covers.
        let mut sums = vec![0_u64; from_width];
        for &(y, weight) in row_span {
            let row = &image.pixels[y * from_width..(y + 1) * from_width];
            for (sum, &value) in sums.iter_mut().zip(row) {
                *sum += weight * u64::from(value);
            }
        }
        for column_span in &columns {
            let sum: u64 = column_span.iter().map(|&(x, weight)| weight * sums[x]).sum();
            pixels.push(((sum + total / 2) / total) as u8);
        }
    }
    Ok(GrayImage { dims, pixels })
}

/// For each of `to` output cells the input cells it overlaps, with overlaps in units of 1/`to`
/// input cell: each sums to `from`.
fn spans(from: u16, to: u16) -> Vec<Vec<(usize, u64)>> {
    let (from, to) = (u64::from(from), u64::from(to));
    (0..to)
        .map(|cell| {
            let (start, end) = (cell * from, (cell + 1) * from);
            (start / to..end.div_ceil(to))
                .map(|input| (input as usize, end.min((input + 1) * to) - start.max(input * to)))
                .collect()
        })
        .collect()
}

/// Left and right half; a column in the middle belongs to neither.
pub fn halves(image: &GrayImage) -> [GrayImage; 2] {
    let (width, half) = (usize::from(image.dims.width), usize::from(image.dims.width / 2));
    [0, width - half].map(|from| GrayImage {
        dims: Dims { width: half as u16, height: image.dims.height },
        pixels: image
            .pixels
            .chunks_exact(width)
            .flat_map(|row| &row[from..from + half])
            .copied()
            .collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: u16, pixels: &[u8]) -> GrayImage {
        let height = (pixels.len() / usize::from(width)) as u16;
        GrayImage { dims: Dims { width, height }, pixels: pixels.to_vec() }
    }

    #[test]
    fn whole_factors_are_block_means() {
        let half = area_average(&image(4, &[0, 2, 10, 20, 4, 6, 30, 41]), 2).unwrap();
        assert_eq!(half, image(2, &[3, 25])); // (0+2+4+6)/4, (10+20+30+41)/4 = 25.25
    }

    #[test]
    fn broken_factors_weigh_by_area() {
        let reduced = area_average(&image(3, &[0, 90, 180, 0, 90, 180, 0, 90, 180]), 2).unwrap();
        assert_eq!(reduced, image(2, &[30, 150, 30, 150])); // (2*0 + 90)/3, (90 + 2*180)/3
    }

    #[test]
    fn images_are_never_enlarged() {
        assert!(area_average(&image(2, &[1, 2]), 3).is_err());
        assert!(area_average(&image(2, &[1, 2]), 0).is_err());
        assert_eq!(area_average(&image(2, &[1, 2]), 2).unwrap(), image(2, &[1, 2]));
    }
}
