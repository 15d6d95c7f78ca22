//! Poles in front of what is there: drawn into both images and into the truth.

use super::pair::{Background, PastedPair, Pattern, Pole, between, choose, percentile};
use super::walls::{noise, wall};
use linestereo_frames::SplitMix64;

const WIDTHS: [f64; 7] = [2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 14.0];
const CONTRASTS: [f64; 4] = [15.0, 30.0, 60.0, 120.0];
const NEARER: [f64; 5] = [2.0, 4.0, 8.0, 16.0, 32.0];
const LEANS_DEG: [f64; 5] = [0.0, 10.0, 25.0, 40.0, 60.0];
/// Tries to place a pole.
const TRIES: usize = 40;
/// Least distance between the middles of two poles, px.
const APART: f64 = 45.0;

/// Brightness of a pole before what is behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Polarity {
    Brighter,
    Darker,
    /// As bright as that on average.
    Mixed,
}

/// A pole to be placed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) width: f64,
    pub(super) contrast: f64,
    /// Distance in front of what is behind it, px; 0 for a print.
    pub(super) nearer: f64,
    pub(super) lean_deg: f64,
    polarity: Polarity,
    pattern: Pattern,
}

impl Wanted {
    fn any(random: &mut SplitMix64) -> Self {
        let polarity = match random.uniform() {
            p if p < 0.4 => Polarity::Brighter,
            p if p < 0.8 => Polarity::Darker,
            _ => Polarity::Mixed,
        };
        Self {
            width: choose(random, &WIDTHS),
            contrast: choose(random, &CONTRASTS),
            nearer: choose(random, &NEARER),
            lean_deg: choose(random, &LEANS_DEG),
            polarity,
            pattern: choose(random, &[Pattern::Plain, Pattern::Striped, Pattern::Textured]),
        }
    }

    /// A stripe printed on what is there.
    pub(super) fn print(random: &mut SplitMix64) -> Self {
        let polarity = choose(random, &[Polarity::Brighter, Polarity::Darker]);
        Self { nearer: 0.0, polarity, pattern: Pattern::Plain, ..Self::any(random) }
    }
}

/// A pair with one to three poles, in one of these scenes or before a wall; none where there is no
/// place for one.
pub(crate) fn composite(random: &mut SplitMix64, scenes: &[PastedPair]) -> Option<PastedPair> {
    let (mut pair, most) = match random.uniform() {
        p if p < 0.6 => (choose(random, &scenes.iter().collect::<Vec<_>>()).clone(), 2),
        p if p < 0.8 => (wall(random, Background::Blank), 3),
        _ => (wall(random, Background::Textured), 3),
    };
    for _ in 0..most {
        let wanted = Wanted::any(random);
        if let Some(pole) = place(&pair, random, wanted) {
            paste(&mut pair, random, pole);
        }
    }
    (!pair.poles.is_empty()).then_some(pair)
}

/// A place for a pole, away from others.
pub(super) fn place(pair: &PastedPair, random: &mut SplitMix64, wanted: Wanted) -> Option<Pole> {
    (0..TRIES).find_map(|_| place_once(pair, random, wanted))
}

fn place_once(pair: &PastedPair, random: &mut SplitMix64, wanted: Wanted) -> Option<Pole> {
    let (width, height) = (pair.width() as f64, pair.height() as f64);
    let lean = wanted.lean_deg.to_radians().tan() * choose(random, &[-1.0, 1.0]);
    let wide = wanted.width * lean.hypot(1.0);
    let rows = if wanted.lean_deg < 50.0 {
        between(random, 60.0, 130.0)
    } else {
        between(random, 40.0, 80.0)
    };
    let top = between(random, 4.0, (height - rows - 4.0).max(5.0)) as usize;
    let end = (pair.height() - 4).min(top + rows as usize);
    let (half, centre) = (lean.abs() * (end - top) as f64 / 2.0, (top + end) as f64 / 2.0);
    if width - 8.0 - wide - half <= 8.0 + half {
        return None;
    }
    let middle = between(random, 8.0 + half, width - 8.0 - wide - half);
    if pair.poles.iter().any(|pole| (middle - pole.middle).abs() < APART + half + pole.half) {
        return None;
    }
    let starts: Vec<f64> = (top..end).map(|y| middle + lean * (y as f64 - centre)).collect();
    let near: Vec<f64> = starts
        .iter()
        .zip(top..)
        .flat_map(|(s, y)| pair.truths(y, s - 9.0, s + wide + 10.0))
        .collect();
    if (near.len() as f64) < 0.6 * (wide + 19.0) * starts.len() as f64 {
        return None;
    }
    let disparities = disparities(random, wanted, near, &starts)?;
    let most = disparities.iter().copied().fold(f64::NAN, f64::max);
    let leaves = starts.iter().zip(&disparities).any(|(s, d)| s - d < 5.0 || *d < 1.0);
    if most > f64::from(pair.max_disparity) - 3.0 || leaves {
        return None;
    }
    let grey = grey(pair, wanted, &starts, top, wide)?;
    let (contrast, pattern) = (wanted.contrast, wanted.pattern);
    let behind = Vec::new();
    Some(Pole {
        width: wanted.width,
        contrast,
        top,
        starts,
        wide,
        disparities,
        behind,
        grey,
        middle,
        half,
        pattern,
    })
}

/// Disparity of each row, in front of most of what is near or on it.
fn disparities(
    random: &mut SplitMix64,
    wanted: Wanted,
    near: Vec<f64>,
    starts: &[f64],
) -> Option<Vec<f64>> {
    let at = |share: f64| percentile(near.clone(), share);
    if wanted.nearer == 0.0 {
        return (at(0.9) - at(0.1) <= 0.8).then(|| vec![at(0.5); starts.len()]);
    }
    let front = at(0.9);
    if at(0.5) < front - 6.0 {
        return None;
    }
    let steepness = between(random, -0.03, 0.03);
    let slant = choose(random, &[0.0, steepness]);
    let middle = starts.len() as f64 / 2.0;
    let line: Vec<f64> =
        (0..starts.len()).map(|k| wanted.nearer + slant * (k as f64 - middle)).collect();
    let least = line.iter().copied().fold(f64::INFINITY, f64::min) - 0.75 * wanted.nearer;
    Some(line.iter().map(|d| front + d - least.min(0.0)).collect())
}

fn grey(pair: &PastedPair, wanted: Wanted, starts: &[f64], top: usize, wide: f64) -> Option<f64> {
    let left = &pair.images[0];
    let behind: Vec<f64> = starts
        .iter()
        .zip(top..)
        .flat_map(|(s, y)| {
            let [from, to] =
                [s - 9.0, s + wide + 10.0].map(|x| x.clamp(0.0, pair.width() as f64) as usize);
            left[y * pair.width() + from..y * pair.width() + to].iter().copied()
        })
        .collect();
    let mean = behind.iter().sum::<f64>() / behind.len() as f64;
    let grey = match wanted.polarity {
        Polarity::Brighter => mean + wanted.contrast,
        Polarity::Darker => mean - wanted.contrast,
        Polarity::Mixed => percentile(behind, 0.5),
    };
    (4.0..=250.0).contains(&grey).then_some(grey)
}

/// A plain upright pole at a place.
pub(super) fn upright(
    (x, width): (f64, f64),
    (top, end): (usize, usize),
    d: f64,
    grey: f64,
) -> Pole {
    let rows = end - top;
    Pole {
        width,
        contrast: 0.0,
        top,
        starts: vec![x; rows],
        wide: width,
        disparities: vec![d; rows],
        behind: Vec::new(),
        grey,
        middle: x,
        half: 0.0,
        pattern: Pattern::Plain,
    }
}

/// Draws a pole, its edges blended.
pub(super) fn paste(pair: &mut PastedPair, random: &mut SplitMix64, mut pole: Pole) {
    let width = pair.width();
    let texture = Texture::new(random, &pole);
    let number = u16::try_from(pair.poles.len() + 1).unwrap_or(u16::MAX);
    let mut behind = Vec::with_capacity(pole.starts.len());
    for (row, (&start, &d)) in pole.starts.iter().zip(&pole.disparities).enumerate() {
        let y = pole.top + row;
        behind
            .push(percentile(pair.truths(y, start - 7.0, start + pole.wide + 8.0).collect(), 0.5));
        for (image, shift) in pair.images.iter_mut().zip([0.0, d]) {
            for x in 0..width {
                let alpha = coverage(x as f64, start - shift, pole.wide);
                if alpha > 0.0 {
                    let value = &mut image[y * width + x];
                    *value =
                        *value * (1.0 - alpha) + alpha * texture.at(x as f64 - start + shift, row);
                }
            }
        }
        for x in 0..width {
            if coverage(x as f64, start, pole.wide) >= 0.5 {
                pair.truth[y * width + x] = d;
                pair.mask[y * width + x] = number;
            }
        }
    }
    pole.behind = behind;
    pair.poles.push(pole);
}

/// Share of a pixel that a strip covers.
pub(super) fn coverage(x: f64, start: f64, width: f64) -> f64 {
    ((x + 0.5).min(start + width) - (x - 0.5).max(start)).clamp(0.0, 1.0)
}

/// Grey levels of a pole, four columns a pixel.
struct Texture {
    base: f64,
    shading: f64,
    wide: f64,
    stripes: Option<(f64, f64, f64)>,
    noise: Option<(Vec<f64>, f64)>,
}

impl Texture {
    const COLUMNS: usize = 64;
    const ROWS: usize = 300;

    fn new(random: &mut SplitMix64, pole: &Pole) -> Self {
        let shading = between(random, 0.0, 8.0);
        let stripes = (pole.pattern == Pattern::Striped).then(|| {
            let step = between(random, 20.0, 50.0) * choose(random, &[-1.0, 1.0]);
            (between(random, 6.0, 24.0), between(random, 0.0, 6.0), step)
        });
        let noise = (pole.pattern == Pattern::Textured)
            .then(|| (noise(random, Self::COLUMNS, Self::ROWS, 1.2), between(random, 8.0, 16.0)));
        Self { base: pole.grey, shading, wide: pole.wide.max(1.0), stripes, noise }
    }

    /// The grey level `u` px from the left edge.
    fn at(&self, u: f64, row: usize) -> f64 {
        let round = (2.0 * u / self.wide - 1.0).clamp(-1.0, 1.0);
        let stripe = self.stripes.map_or(0.0, |(period, phase, step)| {
            if (core::f64::consts::TAU * row as f64 / period + phase).sin() > 0.3 {
                step
            } else {
                0.0
            }
        });
        let speckle = self.noise.as_ref().map_or(0.0, |(noise, amplitude)| {
            let at = (u + 4.0).clamp(0.0, Self::COLUMNS as f64 - 2.0);
            let line = &noise[(row % Self::ROWS) * Self::COLUMNS..];
            let value = line[at as usize] * (1.0 - at.fract()) + line[at as usize + 1] * at.fract();
            amplitude * value.clamp(-3.0, 3.0)
        });
        (self.base - self.shading * round + stripe + speckle).clamp(2.0, 253.0)
    }
}
