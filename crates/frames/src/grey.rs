//! Grey images of 8 bits, and grey values as files store them.
//!
//! Colour becomes `0.299 R + 0.587 G + 0.114 B` (BT.601, what a JPEG's own grey channel is). 16 bits become 8 by `round(v / 257)`; sensors of 10 and
//! 12 bits store their values as they are: where all values of a pair lie below 1024 or 4096, that is white.

use linestereo::image::ViewError;
use linestereo::{Dims, Gray};

/// An owned 8-bit grey image without padding.
#[derive(Clone, Debug, PartialEq, Eq)]
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
const SENSOR_BITS: [u32; 2] = [10, 12];

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
    #[must_use]
    pub fn bits(&self) -> u32 {
        let Values::Sixteen(values) = &self.values else { return 8 };
        let largest = values.iter().copied().max().unwrap_or(0);
        SENSOR_BITS.into_iter().find(|&bits| u32::from(largest) < 1 << bits).unwrap_or(16)
    }

    /// As grey of 8 bits, where values have so many bits.
    #[must_use]
    pub fn into_8_bit(self, bits: u32) -> GrayImage {
        let pixels = match self.values {
            Values::Eight(pixels) => pixels,
            Values::Sixteen(values) => values.into_iter().map(|value| to_8_bit(value, bits)).collect(),
        };
        GrayImage { dims: self.dims, pixels }
    }
}

/// BT.601 in thousandths, rounded; for 8 or 16-bit channels alike.
#[must_use]
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
            assert_eq!(f64::from(to_8_bit(value, 16)), (f64::from(value) / 257.0).round(), "{value}");
        }
    }
}
