//! Scenes in which a bar has to be refused, or to get the disparity of the surface behind it.

use super::pair::{Background, PastedPair, between, choose, percentile};
use super::poles::{Wanted, coverage, paste, place, upright};
use super::walls::wall;
use linestereo_frames::SplitMix64;

/// Kinds of pairs in which a bar is wrong more easily than elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Refused {
    /// Six to thirteen equal bars at equal distances.
    Fence,
    /// Two or three equal legs: no repetition.
    Legs,
    /// Stripes printed on a surface.
    Print,
    /// Stripes of shadow.
    Shadow,
    /// Bars 75 to 90 degrees from upright.
    Cable,
    /// A wall of vertical stripes.
    StripedWall,
    /// A wall whose texture repeats.
    Wallpaper,
}

impl Refused {
    pub(crate) const ALL: [Self; 7] = [
        Self::Fence,
        Self::Legs,
        Self::Print,
        Self::Shadow,
        Self::Cable,
        Self::StripedWall,
        Self::Wallpaper,
    ];
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Fence => "fences, 6 to 13 bars",
            Self::Legs => "two or three equal legs",
            Self::Print => "printed stripes",
            Self::Shadow => "shadows",
            Self::Cable => "cables, 75 to 90 degrees",
            Self::StripedWall => "striped walls",
            Self::Wallpaper => "wallpaper that repeats",
        }
    }

    /// A pair of this kind; none where there is no place for it. The mask says where it is.
    pub(crate) fn pair(self, random: &mut SplitMix64, scenes: &[PastedPair]) -> Option<PastedPair> {
        let mut pair = match (self, random.uniform()) {
            (Self::StripedWall, _) => return Some(everywhere(wall(random, Background::Striped))),
            (Self::Wallpaper, _) => return Some(everywhere(wall(random, Background::Wallpaper))),
            (_, p) if p < 0.5 => choose(random, &scenes.iter().collect::<Vec<_>>()).clone(),
            (_, p) if p < 0.75 => wall(random, Background::Blank),
            _ => wall(random, Background::Textured),
        };
        let is_there = match self {
            Self::Fence => fence(random, &mut pair, true),
            Self::Legs => fence(random, &mut pair, false),
            Self::Print => {
                for _ in 0..2 {
                    let wanted = Wanted::print(random);
                    if let Some(pole) = place(&pair, random, wanted) {
                        paste(&mut pair, random, pole);
                    }
                }
                !pair.poles.is_empty()
            }
            Self::Shadow => shadow(random, &mut pair),
            _ => cable(random, &mut pair),
        };
        is_there.then_some(pair)
    }
}

fn everywhere(mut pair: PastedPair) -> PastedPair {
    pair.mask.fill(1);
    pair
}

/// A disparity in front of most of a pair, if it is within the range.
fn before(random: &mut SplitMix64, pair: &PastedPair) -> Option<f64> {
    let truths = pair.truth.iter().copied().filter(|d| d.is_finite()).collect();
    let d = percentile(truths, 0.9) + choose(random, &[2.0, 4.0, 8.0, 16.0]);
    (d <= f64::from(pair.max_disparity) - 4.0).then_some(d)
}

fn dark_or_bright(random: &mut SplitMix64) -> f64 {
    let (dark, bright) = (between(random, 15.0, 60.0), between(random, 190.0, 240.0));
    choose(random, &[dark, bright])
}

fn fence(random: &mut SplitMix64, pair: &mut PastedPair, is_dense: bool) -> bool {
    let width = choose(random, &[2.0, 3.0, 4.0, 6.0, 8.0]);
    let period = if is_dense {
        between(random, width + 5.0, width + 24.0)
    } else {
        between(random, 45.0, 110.0)
    };
    let Some(d) = before(random, pair) else { return false };
    let count =
        if is_dense { between(random, 6.0, 14.0) } else { between(random, 2.0, 4.0) } as usize;
    let first = between(random, d + 8.0, d + 40.0);
    let grey = dark_or_bright(random);
    let bottom = pair.height() as f64 - 10.0;
    let rows =
        (between(random, 10.0, 60.0) as usize, between(random, 150.0, bottom.max(151.0)) as usize);
    let rows = (rows.0, rows.1.min(pair.height() - 1));
    let seed = random.bits();
    for k in 0..count {
        let x = first + k as f64 * period;
        if x + width + 8.0 > pair.width() as f64 {
            break;
        }
        paste(pair, &mut SplitMix64(seed), upright((x, width), rows, d, grey));
    }
    !pair.poles.is_empty()
}

/// A stripe in which both images are darker by the same factor where the truth says so.
fn shadow(random: &mut SplitMix64, pair: &mut PastedPair) -> bool {
    for _ in 0..30 {
        let (wide, lean) = (between(random, 3.0, 14.0), between(random, -0.8, 0.8));
        let top = between(random, 5.0, pair.height() as f64 - 110.0) as usize;
        let end = top + between(random, 60.0, 100.0) as usize;
        let room = 40.0 * lean.abs();
        let middle = between(random, 60.0 + room, pair.width() as f64 - 40.0 - room);
        let start = |y: usize| middle + lean * (y as f64 - (top + end) as f64 / 2.0);
        let near: Vec<f64> = (top..end)
            .flat_map(|y| pair.truths(y, start(y) - 7.0, start(y) + wide + 8.0))
            .collect();
        let at = |share: f64| percentile(near.clone(), share);
        let d = at(0.5);
        let is_level = at(0.95) - at(0.05) <= 1.2;
        if (near.len() as f64) < 0.8 * (wide + 15.0) * (end - top) as f64
            || !is_level
            || middle - room - d < 12.0
        {
            continue;
        }
        let (factor, width) = (between(random, 0.4, 0.8), pair.width());
        for y in top..end {
            for x in 0..width {
                for (image, shift) in pair.images.iter_mut().zip([0.0, d]) {
                    let alpha = coverage(x as f64, start(y) - shift, wide);
                    image[y * width + x] *= 1.0 - alpha * (1.0 - factor);
                }
                if coverage(x as f64, start(y), wide) >= 0.5 {
                    pair.mask[y * width + x] = 1;
                }
            }
        }
        return true;
    }
    false
}

fn cable(random: &mut SplitMix64, pair: &mut PastedPair) -> bool {
    let Some(d) = before(random, pair) else { return false };
    let slope = between(random, 0.0, 15.0).to_radians().tan() * choose(random, &[-1.0, 1.0]);
    let wide = choose(random, &[2.0, 3.0, 4.0, 6.0, 8.0]);
    let row = between(random, 30.0, pair.height() as f64 - 30.0);
    let (from, to) =
        (between(random, d + 8.0, 120.0), between(random, 200.0, pair.width() as f64 - 8.0));
    let grey = dark_or_bright(random);
    let width = pair.width();
    for y in 0..pair.height() {
        for x in 0..width {
            for (image, shift) in pair.images.iter_mut().zip([0.0, d]) {
                let own = x as f64 + shift;
                let alpha = coverage(y as f64, row + slope * (own - 160.0), wide);
                if (from..=to).contains(&own) {
                    let value = &mut image[y * width + x];
                    *value = *value * (1.0 - alpha) + alpha * grey;
                    if shift == 0.0 && alpha >= 0.5 {
                        pair.mask[y * width + x] = 1;
                        pair.truth[y * width + x] = d;
                    }
                }
            }
        }
    }
    true
}
