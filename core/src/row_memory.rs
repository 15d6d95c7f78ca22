//! Size of the memory for rows: costs and paths of support points first, then the band of rows that windows look at.

/// Rows held, every second one of the image: those of the tallest segment (33) that starts as high as the current one, and the reach of
/// the current one's window above it.
pub(crate) const BAND_ROWS: usize = 22;
/// Gradients of both images, census of the right one.
pub(crate) const PLANES: usize = 3;
/// Pixels without content on both sides of a row: a window's half, a slant's shift, and the tail of a block of disparities.
pub(crate) const PAD: usize = 44;

/// Bytes of one padded row.
#[must_use]
pub const fn row_bytes(width: u16) -> usize {
    width as usize + 2 * PAD
}
