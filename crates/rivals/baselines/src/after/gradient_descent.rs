//! Fractions by gradient descent: each disparity moves to where the right window, interpolated, differs least from the left one.
//!
//! ```text
//! e(u) = L(u) - mean L - (R(u - d) - mean R)           over a window, R between pixels by a straight line
//! d   -= sum e R' / sum (R' - mean R')^2               R' = slope of R along the row; Gauss-Newton on sum e^2
//! ```
//! until a step is below 0.02 px, at most [`STEPS`] times. A disparity that moves by more than 1 px, or whose differences grow, keeps its
//! first value.
//!
//! # Source
//! Lucas and Kanade, "An iterative image registration technique with an application to stereo vision" (1981).

use crate::map::DisparityMap;
use linestereo_frames::GrayImage;

/// Most steps of a pixel.
const STEPS: usize = 6;
/// Shorter steps end the descent, px.
const SMALL_STEP: f32 = 0.02;
/// Farthest from where it began, px.
const FARTHEST: f32 = 1.0;

/// Refines every disparity whose window of `half` px to each side lies inside both images.
pub fn descend(map: &mut DisparityMap, left: &GrayImage, right: &GrayImage, half: usize) {
    let (width, height) = (usize::from(map.dims().width), usize::from(map.dims().height));
    let mut window = WindowPair { width, half, left, right, values: Vec::new() };
    for y in half..height.saturating_sub(half) {
        for x in half..width.saturating_sub(half) {
            let Some(first) = map.at(x, y) else { continue };
            if let Some(better) = window.descend((x, y), first) {
                let confidence = map.confidence(x, y);
                map.set(x, y, better, confidence);
            }
        }
    }
}

struct WindowPair<'a> {
    width: usize,
    half: usize,
    left: &'a GrayImage,
    right: &'a GrayImage,
    /// Left value, right value, right slope.
    values: Vec<[f32; 3]>,
}

impl WindowPair<'_> {
    fn descend(&mut self, at: (usize, usize), first: f32) -> Option<f32> {
        let (start, mut step) = self.look(at, first)?;
        let (mut d, mut least) = (first, start);
        for _ in 0..STEPS {
            let next = d + step.clamp(-0.5, 0.5);
            let (squares, further) = self.look(at, next)?;
            if squares >= least {
                break;
            }
            let small = (next - d).abs() < SMALL_STEP;
            (d, least, step) = (next, squares, further);
            if small {
                break;
            }
        }
        ((d - first).abs() <= FARTHEST && d >= 0.0 && least < start).then_some(d)
    }

    /// Sum of squared differences at a disparity, and the step that should lower it.
    fn look(&mut self, (x, y): (usize, usize), d: f32) -> Option<(f32, f32)> {
        // The slope needs a column more on both sides.
        let position = (x as f32) - d - (self.half as f32);
        let column = position.floor();
        if column < 1.0 || column as usize + 2 * self.half + 2 >= self.width {
            return None;
        }
        let (column, t) = (column as usize, position - column);
        self.values.clear();
        for row in y - self.half..=y + self.half {
            let left = &self.left.pixels[row * self.width + x - self.half..][..=2 * self.half];
            let right = &self.right.pixels[row * self.width + column..][..2 * self.half + 2];
            for (&l, r) in left.iter().zip(right.windows(2)) {
                let (r0, r1) = (f32::from(r[0]), f32::from(r[1]));
                self.values.push([f32::from(l), r0 + t * (r1 - r0), r1 - r0]);
            }
        }
        let count = self.values.len() as f32;
        let mean = |i: usize| self.values.iter().map(|v| v[i]).sum::<f32>() / count;
        let bias = mean(0) - mean(1);
        // Means move with the window, so that a slope that all pixels share says nothing.
        let common = mean(2);
        let (mut squares, mut numerator, mut denominator) = (0.0, 0.0, 0.0);
        for [l, r, slope] in &self.values {
            let e = l - r - bias;
            squares += e * e;
            // The right window moves left as the disparity grows: its value falls by the slope.
            numerator -= e * slope;
            denominator += (slope - common).powi(2);
        }
        (denominator > 0.0).then(|| (squares, numerator / denominator))
    }
}
