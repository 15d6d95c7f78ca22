//! Where exactly a corner is: the point to which all gradients around it are perpendicular.
//!
//! In: an image, a corner to about a pixel, the reach of the window. Out: the corner to a few
//! hundredths of a pixel.
//!
//! ```text
//! repeat:  solve  sum w(p) g(p) g(p)' (q - p) = 0  over the window around q     w: Gaussian, g: gradient
//! until q moves less than 0.001 px
//! ```
//!
//! # Source
//! Förstner and Gülch, 1987; what OpenCV calls `cornerSubPix`. The window follows the size of the
//! squares, so that no other corner is inside.

use linestereo_frames::GrayImage;

/// Half sides of the window, px.
const REACH: (f64, f64) = (2.0, 10.0);
/// Share of the distance to the next corner that the window reaches; and of one in the board's
/// outermost lines, beyond which a printed board may end within half a square.
const SHARES: (f64, f64) = (0.42, 0.25);
/// A corner further from the detector's place than this, px, was pulled by something else inside
/// the window: a smaller one is tried.
const PULLED: f64 = 1.0;
const ROUNDS: usize = 40;
const MOVED: f64 = 1e-3;

/// The corner near `start` whose next corner is `spacing` px away; `None` where the image shows
/// none.
pub(super) fn refine(
    image: &GrayImage,
    start: [f64; 2],
    spacing: f64,
    outermost: bool,
) -> Option<[f64; 2]> {
    refine_within(image, start, spacing * if outermost { SHARES.1 } else { SHARES.0 })
}

/// The corner near `start` from a window that reaches so many px; `None` where the image shows
/// none.
pub(super) fn refine_within(image: &GrayImage, start: [f64; 2], reach: f64) -> Option<[f64; 2]> {
    let widest = reach.clamp(REACH.0, REACH.1);
    let reaches = [1.0, 0.6, 0.4].map(|part| (part * widest).max(REACH.0));
    reaches.into_iter().find_map(|reach| settled(image, start, reach))
}

fn settled(image: &GrayImage, start: [f64; 2], reach: f64) -> Option<[f64; 2]> {
    let mut at = start;
    for _ in 0..ROUNDS {
        let next = step(image, at, reach)?;
        let moved = (next[0] - at[0]).hypot(next[1] - at[1]);
        at = next;
        if (at[0] - start[0]).hypot(at[1] - start[1]) > PULLED {
            return None;
        }
        if moved < MOVED {
            return Some(at);
        }
    }
    None
}

fn step(image: &GrayImage, [x, y]: [f64; 2], reach: f64) -> Option<[f64; 2]> {
    let window = reach.ceil() as i32;
    let (mut a, mut b, mut c, mut bx, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for j in -window..=window {
        for i in -window..=window {
            let (dx, dy) = (f64::from(i), f64::from(j));
            let weight = (-(dx * dx + dy * dy) / (reach * reach)).exp();
            let sample = |dx: f64, dy: f64| bilinear(image, x + dx, y + dy);
            let gx = (sample(dx + 1.0, dy)? - sample(dx - 1.0, dy)?) / 2.0;
            let gy = (sample(dx, dy + 1.0)? - sample(dx, dy - 1.0)?) / 2.0;
            let (xx, xy, yy) = (weight * gx * gx, weight * gx * gy, weight * gy * gy);
            a += xx;
            b += xy;
            c += yy;
            bx += xx * dx + xy * dy;
            by += xy * dx + yy * dy;
        }
    }
    let determinant = a * c - b * b;
    // An edge alone places nothing along itself.
    if determinant < 1e-3 * (a + c) * (a + c) {
        return None;
    }
    Some([x + (c * bx - b * by) / determinant, y + (a * by - b * bx) / determinant])
}

fn bilinear(image: &GrayImage, x: f64, y: f64) -> Option<f64> {
    let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
    if !(x >= 0.0 && y >= 0.0) {
        return None;
    }
    let (column, row) = (x as usize, y as usize);
    if column + 1 >= width || row + 1 >= height {
        return None;
    }
    let (tx, ty) = (x - column as f64, y - row as f64);
    let at = |column: usize, row: usize| f64::from(image.pixels[row * width + column]);
    let top = at(column, row) * (1.0 - tx) + at(column + 1, row) * tx;
    let bottom = at(column, row + 1) * (1.0 - tx) + at(column + 1, row + 1) * tx;
    Some(top * (1.0 - ty) + bottom * ty)
}
