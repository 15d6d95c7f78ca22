//! Size of the memory for rows: costs and paths of support points, then the band of rows that
//! windows cover.

/// Number of rows held, every second one of the image: those of the tallest segment (33) that
/// starts at the same row as the current one, and the reach of the current one's window above it.
pub(crate) const BAND_ROWS: usize = 22;
/// Number of planes: gradients of both images, census of the right one.
pub(crate) const PLANES: usize = 3;
/// Padding on both sides of a row, px: half of a window, the shift of a slant, and the tail of a
/// block of disparities.
pub(crate) const PAD: usize = 44;

/// Size of one padded row, bytes.
#[must_use]
pub(crate) const fn row_bytes(width: u16) -> usize {
    width as usize + 2 * PAD
}
