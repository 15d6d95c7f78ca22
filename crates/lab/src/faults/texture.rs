//! Periodic texture painted on objects at their true disparity.

use linestereo_frames::{GrayImage, Scene};
use linestereo_sim::results::mask::Mask;

/// Part of an object's own texture that remains.
const REMAINING: f64 = 0.15;
/// Contrast of the painted one, grey levels above and below the middle.
const AMPLITUDE: f64 = 60.0;
/// Largest difference of disparity between neighbours on one surface, px.
const CONTINUOUS: f64 = 1.0;

/// Vertical bars, a sine.
pub(super) fn bars(x: f64, _: f64, period: f64) -> f64 {
    (core::f64::consts::TAU * x / period).sin()
}

/// A checkerboard with soft edges.
pub(super) fn checker(x: f64, y: f64, period: f64) -> f64 {
    let wave = |v: f64| (core::f64::consts::TAU * v / period).sin();
    (4.0 * wave(x) * wave(y)).clamp(-1.0, 1.0)
}

/// Courses of bricks with joints of 2 px.
pub(super) fn bricks(x: f64, y: f64, length: f64) -> f64 {
    let height = 0.5 * length;
    let course = (y / height).floor();
    let along = (x + 0.5 * length * course).rem_euclid(length);
    let joint = |distance: f64| (1.0 - (distance - 1.0).abs()).max(0.0);
    0.6 - 1.6 * joint(along).max(joint(y.rem_euclid(height)))
}

/// Paints the objects, pixels of the left image, in both images.
pub(super) fn paint(
    scene: &Scene,
    objects: &Mask,
    pattern: impl Fn(f64, f64) -> f64,
) -> [GrayImage; 2] {
    let [mut left, mut right] = [scene.left.clone(), scene.right.clone()];
    let Some(truth) = &scene.truth else { return [left, right] };
    let (width, height) = (i32::from(left.dims.width), i32::from(left.dims.height));
    let painted = |own: u8, x: f64, y: i32| {
        let value =
            128.0 + REMAINING * (f64::from(own) - 128.0) + AMPLITUDE * pattern(x, f64::from(y));
        value.round() as u8
    };
    let surface =
        |x: i32, y: i32| truth.disparity(x, y).filter(|_| objects.contains(x, y)).map(f64::from);
    for y in 0..height {
        for x in 0..width {
            let index = |x: i32| (y * width + x) as usize;
            if !objects.contains(x, y) {
                continue;
            }
            left.pixels[index(x)] = painted(left.pixels[index(x)], f64::from(x), y);
            let (Some(d0), Some(d1)) = (surface(x, y), surface(x + 1, y)) else { continue };
            let [from, to] = [f64::from(x) - d0, f64::from(x + 1) - d1];
            if !truth.is_visible(x, y) || (d1 - d0).abs() > CONTINUOUS || to <= from {
                continue;
            }
            // Columns of the right image between those of the two pixels.
            for u in from.ceil() as i32..=to.floor() as i32 {
                if (0..width).contains(&u) {
                    let own = scene.right.pixels[index(u)];
                    right.pixels[index(u)] =
                        painted(own, f64::from(x) + (f64::from(u) - from) / (to - from), y);
                }
            }
        }
    }
    [left, right]
}
