//! Grey images of 8 bits, and grey values as files store them.
//!
//! Colour becomes `0.299 R + 0.587 G + 0.114 B` (BT.601, what a JPEG's own grey channel is). 16
//! bits become 8 by `round(v / 257)`; sensors of 8, 10 and 12 bits store their values as they are:
//! where all values of a pair lie below 256, 1024 or 4096, that is white.

use linestereo::{Dims, Gray, image::ViewError};

/// An owned 8-bit grey image without padding.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GrayImage {
    /// Width and height.
    pub dims: Dims,
    /// Row-major pixels.
    pub pixels: Vec<u8>,
}

impl GrayImage {
    /// The core's view of it; the core's limits of size apply.
    pub fn view(&self) -> Result<Gray<'_>, ViewError> {
        Gray::new(&self.pixels, self.dims, usize::from(self.dims.width))
    }
}

/// Bits of sensors whose values are stored in 16.
const SENSOR_BITS: [u32; 3] = [8, 10, 12];

/// Grey values as a file has them.
#[derive(Clone, Debug)]
pub struct StoredGray {
    /// Width and height.
    pub dims: Dims,
    /// Row by row.
    pub values: Values,
}

/// Values of pixels.
#[derive(Clone, Debug)]
pub enum Values {
    /// 8 bits each.
    Eight(Vec<u8>),
    /// 16 bits each, of which a sensor may use fewer.
    Sixteen(Vec<u16>),
}

impl StoredGray {
    /// Bits of a value, told from the largest one: 8, 10, 12 or 16.
    pub fn bits(&self) -> u32 {
        let largest = self.largest();
        SENSOR_BITS.into_iter().find(|&bits| u32::from(largest) < 1 << bits).unwrap_or(16)
    }

    /// The largest value.
    pub(crate) fn largest(&self) -> u16 {
        match &self.values {
            Values::Eight(values) => values.iter().copied().max().unwrap_or(0).into(),
            Values::Sixteen(values) => values.iter().copied().max().unwrap_or(0),
        }
    }

    /// Grey of a mosaic of colours, whatever their order: `(R + 2 G + B) / 4` around each pixel.
    /// Weights of 1, 2, 1 along rows and columns give every colour the same share at every pixel,
    /// and move nothing; borders are mirrored.
    #[must_use]
    pub fn of_mosaic(self) -> Self {
        let values = match self.values {
            Values::Eight(values) => Values::Eight(smoothed(&values, self.dims, |sum| sum as u8)),
            Values::Sixteen(values) => {
                Values::Sixteen(smoothed(&values, self.dims, |sum| sum as u16))
            }
        };
        Self { values, ..self }
    }

    /// As grey of 8 bits, where values have so many bits.
    #[must_use]
    pub fn into_8_bit(self, bits: u32) -> GrayImage {
        let pixels = match self.values {
            Values::Eight(pixels) => pixels,
            Values::Sixteen(values) => {
                values.into_iter().map(|value| to_8_bit(value, bits)).collect()
            }
        };
        GrayImage { dims: self.dims, pixels }
    }
}

/// Weights 1, 2, 1 along rows and columns; `value` takes what fits.
fn smoothed<T: Copy + Into<u32>>(values: &[T], dims: Dims, value: impl Fn(u32) -> T) -> Vec<T> {
    let [width, height] = [dims.width, dims.height].map(usize::from);
    // A mirrored neighbour has the colour of the other one.
    let around = |at: usize, count: usize| match at {
        _ if count < 2 => [at; 2],
        0 => [1; 2],
        at if at + 1 == count => [at - 1; 2],
        at => [at - 1, at + 1],
    };
    let along = |row: usize, x: usize| -> u32 {
        let at = |x: usize| -> u32 { values[row * width + x].into() };
        let [before, after] = around(x, width);
        at(before) + 2 * at(x) + at(after)
    };
    let pixel = |i: usize| {
        let (x, y) = (i % width, i / width);
        let [above, below] = around(y, height);
        value((along(above, x) + 2 * along(y, x) + along(below, x) + 8) / 16)
    };
    (0..values.len()).map(pixel).collect()
}

/// BT.601 in thousandths, rounded; for 8 or 16-bit channels alike.
pub fn luma(rgb: [u32; 3]) -> u16 {
    let [red, green, blue] = rgb;
    ((299 * red + 587 * green + 114 * blue + 500) / 1000) as u16
}

/// A value of so many bits, 8 to 16; larger ones are white.
fn to_8_bit(value: u16, bits: u32) -> u8 {
    let white = (1_u32 << bits) - 1;
    ((u32::from(value).min(white) * 255 + white / 2) / white) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_bits_are_rounded_to_eight() {
        for value in 0..=u16::MAX {
            assert_eq!(
                f64::from(to_8_bit(value, 16)),
                (f64::from(value) / 257.0).round(),
                "{value}"
            );
        }
    }
}
