//! Images that moved: resampled linearly, the border repeated.

use linestereo::Dims;
use linestereo_frames::GrayImage;

/// The image at positions that `at` gives for each pixel.
fn resampled(image: &GrayImage, at: impl Fn(f64, f64) -> (f64, f64)) -> GrayImage {
    let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
    let value = |x: f64, y: f64| {
        let (x, y) = (x.clamp(0.0, (width - 1) as f64), y.clamp(0.0, (height - 1) as f64));
        let (column, row) = (x as usize, y as usize);
        let (right, below) = ((column + 1).min(width - 1), (row + 1).min(height - 1));
        let (fx, fy) = (x - column as f64, y - row as f64);
        let pixel = |x: usize, y: usize| f64::from(image.pixels[y * width + x]);
        let across = |y: usize| pixel(column, y) * (1.0 - fx) + pixel(right, y) * fx;
        (across(row) * (1.0 - fy) + across(below) * fy).round() as u8
    };
    let positions = (0..height).flat_map(|y| (0..width).map(move |x| (x as f64, y as f64)));
    let pixels = positions.map(|(x, y)| at(x, y)).map(|(x, y)| value(x, y)).collect();
    GrayImage { dims: image.dims, pixels }
}

/// Cut to this size; what it lacks is its border repeated.
pub(super) fn fitted(image: &GrayImage, dims: Dims) -> GrayImage {
    let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
    let pixel = |x: u16, y: u16| {
        image.pixels[usize::from(y).min(height - 1) * width + usize::from(x).min(width - 1)]
    };
    let pixels = (0..dims.height).flat_map(|y| (0..dims.width).map(move |x| (x, y)));
    GrayImage { dims, pixels: pixels.map(|(x, y)| pixel(x, y)).collect() }
}

/// The centre of an image, px.
fn centre(image: &GrayImage) -> (f64, f64) {
    (0.5 * (f64::from(image.dims.width) - 1.0), 0.5 * (f64::from(image.dims.height) - 1.0))
}

/// Moved to the right and down.
pub(super) fn moved(image: &GrayImage, right: f64, down: f64) -> GrayImage {
    resampled(image, |x, y| (x - right, y - down))
}

/// The lower half moved to the right.
pub(super) fn torn(image: &GrayImage, by: f64) -> GrayImage {
    let half = f64::from(image.dims.height / 2);
    resampled(image, |x, y| (if y < half { x } else { x - by }, y))
}

/// Rows moved to the right in proportion to their number.
pub(super) fn sheared(image: &GrayImage, by: f64) -> GrayImage {
    let (_, middle) = centre(image);
    resampled(image, |x, y| (x - by * (y - middle) / (2.0 * middle), y))
}

/// Every fourth band of eight rows moved to the right.
pub(super) fn bands(image: &GrayImage, by: f64) -> GrayImage {
    resampled(image, |x, y| (if (y as usize / 8).is_multiple_of(4) { x - by } else { x }, y))
}

/// Larger about the centre.
pub(super) fn magnified(image: &GrayImage, factor: f64) -> GrayImage {
    let (cx, cy) = centre(image);
    resampled(image, |x, y| (cx + (x - cx) / factor, cy + (y - cy) / factor))
}

/// Rotated about the centre.
pub(super) fn rotated(image: &GrayImage, angle: f64) -> GrayImage {
    let ((cx, cy), (sin, cos)) = (centre(image), angle.sin_cos());
    resampled(image, |x, y| {
        let (dx, dy) = (x - cx, y - cy);
        (cx + cos * dx + sin * dy, cy - sin * dx + cos * dy)
    })
}

/// Radial distortion, cubic in the distance from the centre; `by` px at the corner.
pub(super) fn distorted(image: &GrayImage, by: f64) -> GrayImage {
    let (cx, cy) = centre(image);
    let corner = cx.hypot(cy);
    resampled(image, |x, y| {
        let (dx, dy) = (x - cx, y - cy);
        let factor = 1.0 + by / corner * (dx.hypot(dy) / corner).powi(2);
        (cx + dx * factor, cy + dy * factor)
    })
}
