//! Drawn walls, upright or slanted.

use super::pair::{Background, PastedPair, between, choose};
use linestereo::Dims;
use linestereo_frames::SplitMix64;

const DIMS: Dims = Dims { width: 320, height: 240 };
/// Columns of a wall left of the left image.
const BEFORE: f64 = 100.0;
const MAX_DISPARITY: u16 = 64;

/// Draws a wall.
pub(super) fn wall(random: &mut SplitMix64, kind: Background) -> PastedPair {
    let (width, height) = (usize::from(DIMS.width), usize::from(DIMS.height));
    let distance = between(random, 3.0, 20.0);
    let steepness = between(random, -0.015, 0.015);
    let slope = choose(random, &[0.0, 0.0, steepness]);
    let paint = paint(random, kind, 2 * width, height);
    let middle = width as f64 / 2.0;
    let at = |x: f64, y: usize| {
        let column = (x + BEFORE).clamp(0.0, 2.0 * width as f64 - 2.0);
        let (whole, part) = (column as usize, column.fract());
        let row = &paint[y * 2 * width..];
        row[whole] * (1.0 - part) + row[whole + 1] * part
    };
    let image = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
        (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| at(of(x as f64), y))
            .collect()
    };
    let left = image(&|x| x);
    let right = image(&|x| (x + distance - slope * middle) / (1.0 - slope));
    let truth =
        (0..width * height).map(|i| distance + slope * ((i % width) as f64 - middle)).collect();
    PastedPair::new(
        DIMS,
        [left, right],
        truth,
        MAX_DISPARITY,
        (kind, &format!("{kind:?}").to_lowercase()),
    )
}

/// Grey levels of a wall.
fn paint(random: &mut SplitMix64, kind: Background, width: usize, height: usize) -> Vec<f64> {
    let base = between(random, 90.0, 170.0);
    let (across, down) = (between(random, -25.0, 25.0), between(random, -20.0, 20.0));
    let shading = |x: usize, y: usize| {
        base + across * (x as f64 / width as f64 - 0.5) + down * (y as f64 / height as f64 - 0.5)
    };
    let amplitude = between(random, 10.0, 22.0);
    let (tile, period) = (between(random, 14.0, 40.0) as usize, between(random, 9.0, 30.0));
    let (bright, phase, share) =
        (between(random, 15.0, 50.0), between(random, 0.0, 6.0), between(random, -0.5, 0.8));
    let scale = choose(random, &[1.0, 1.6, 2.5]);
    let texture = match kind {
        Background::Textured => Some((noise(random, width, height, scale), width)),
        Background::Wallpaper => Some((noise(random, tile, height, 1.5), tile)),
        _ => None,
    };
    let stripe = |x: f64| (core::f64::consts::TAU * x / period + phase).sin() - share;
    (0..width * height)
        .map(|i| {
            let (x, y) = (i % width, i / width);
            let own = match &texture {
                Some((noise, columns)) => {
                    amplitude * noise[y * columns + x % columns].clamp(-3.0, 3.0)
                }
                // A soft edge 1 px wide.
                None if kind == Background::Striped => {
                    bright * (stripe(x as f64) * period / 4.0).clamp(-1.0, 1.0)
                }
                None => 0.0,
            };
            shading(x, y) + own
        })
        .collect()
}

/// Noise of unit deviation, smoothed over so many pixels.
pub(super) fn noise(random: &mut SplitMix64, width: usize, height: usize, scale: f64) -> Vec<f64> {
    let white: Vec<f64> =
        (0..(width * height).div_ceil(2)).flat_map(|_| random.normal_pair()).collect();
    let reach = (3.0 * scale).ceil() as i64;
    let weights: Vec<f64> =
        (-reach..=reach).map(|k| (-0.5 * (k as f64 / scale).powi(2)).exp()).collect();
    let all: f64 = weights.iter().sum();
    let smooth =
        |values: &[f64], step: usize, count: usize, start: &dyn Fn(usize) -> usize| -> Vec<f64> {
            let mut out = vec![0.0; width * height];
            for line in 0..width * height / count.max(1) {
                for at in 0..count {
                    let sum = weights.iter().zip(-reach..).map(|(weight, by)| {
                        let other = (at as i64 + by).rem_euclid(count as i64) as usize;
                        weight * values[start(line) + other * step]
                    });
                    out[start(line) + at * step] = sum.sum::<f64>() / all;
                }
            }
            out
        };
    let rows = smooth(&white, 1, width, &|line| line * width);
    let both = smooth(&rows, width, height, &|line| line);
    both.iter().map(|v| v * scale * 3.5).collect()
}
