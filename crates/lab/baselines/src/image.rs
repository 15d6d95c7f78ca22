//! Grey images that own their pixels.

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
