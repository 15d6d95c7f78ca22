//! Procedural greys on a surface, as functions of the position on it in metres.

/// The regular part of a texture. Greys are 0 to 255.
#[derive(Clone, Copy, Debug)]
pub enum Pattern {
    /// One grey everywhere.
    Blank(f64),
    /// Two greys in turn across the first surface axis.
    Stripes {
        /// Both greys.
        greys: [f64; 2],
        /// Width of a pair of stripes in metres.
        period: f64,
    },
    /// Squares of two greys.
    Checker {
        /// Both greys.
        greys: [f64; 2],
        /// Side of a square in metres.
        side: f64,
    },
    /// Rectangles of a random grey each: straight edges everywhere, no two places alike.
    Mosaic {
        /// Darkest and brightest grey.
        greys: [f64; 2],
        /// Width and height of a rectangle in metres.
        cell: [f64; 2],
    },
    /// One straight edge along the first surface axis: the first grey where the second coordinate
    /// is negative.
    Edge([f64; 2]),
    /// A band around the first surface axis: the first grey outside, the second inside.
    Band {
        /// Outside and inside.
        greys: [f64; 2],
        /// Width of the band in metres.
        width: f64,
    },
}

/// A pattern with grain on top.
#[derive(Clone, Copy, Debug)]
pub struct Texture {
    /// The regular part.
    pub pattern: Pattern,
    /// Largest deviation of the grain from the pattern, in grey levels; 0 for none.
    pub grain: f64,
    /// Size of the coarsest grain in metres; two finer octaves are added.
    pub grain_size: f64,
    /// Seed of the grain and of a mosaic.
    pub seed: u64,
}

impl Texture {
    /// A pattern without grain.
    pub fn plain(pattern: Pattern) -> Self {
        Self { pattern, grain: 0.0, grain_size: 1.0, seed: 0 }
    }

    /// A pattern with grain: its largest deviation in grey levels and its size in metres.
    pub fn grained(pattern: Pattern, grain: f64, grain_size: f64, seed: u64) -> Self {
        Self { pattern, grain, grain_size, seed }
    }

    /// The grey at `u, v` metres from the surface's origin. Positions close to each other share
    /// what they have in common where they are asked for one after the other with the same `grain`.
    pub(super) fn grey_near(&self, grain: &mut Grain, u: f64, v: f64) -> f64 {
        let base = match self.pattern {
            Pattern::Blank(grey) => grey,
            Pattern::Stripes { greys, period } => greys[usize::from(is_odd(2.0 * u / period))],
            Pattern::Checker { greys, side } => {
                greys[usize::from(is_odd(u / side) != is_odd(v / side))]
            }
            Pattern::Mosaic { greys, cell } => {
                let unit = unit_from(hash(self.seed, floor(u / cell[0]), floor(v / cell[1])));
                greys[0] + (greys[1] - greys[0]) * unit
            }
            Pattern::Edge(greys) => greys[usize::from(v >= 0.0)],
            Pattern::Band { greys, width } => greys[usize::from(v.abs() < 0.5 * width)],
        };
        if self.grain == 0.0 {
            return base;
        }
        let [coarse, middle, fine] = &mut grain.0;
        let octave = |cell: &mut NoiseCell, scale: f64, seed: u64| {
            cell.value(seed, u * scale / self.grain_size, v * scale / self.grain_size)
        };
        let noise = 0.5 * octave(coarse, 1.0, self.seed ^ 1)
            + 0.3 * octave(middle, 2.0, self.seed ^ 2)
            + 0.2 * octave(fine, 4.0, self.seed ^ 3);
        base + self.grain * noise
    }

    /// The grey at `u, v` metres from the surface's origin.
    pub fn grey(&self, u: f64, v: f64) -> f64 {
        self.grey_near(&mut Grain::default(), u, v)
    }
}

/// The cells of the grain's three octaves in which the last grey lay.
#[derive(Default)]
pub(super) struct Grain([NoiseCell; 3]);

/// A unit square of smooth noise.
#[derive(Default)]
struct NoiseCell {
    /// Seed, column and row, once it is known.
    place: Option<(u64, f64, f64)>,
    /// Values at its corners, -1 ..= 1: two above, two below.
    corners: [f64; 4],
}

impl NoiseCell {
    /// Smooth noise in -1 ..= 1 with one independent value per unit square.
    fn value(&mut self, seed: u64, x: f64, y: f64) -> f64 {
        let (column, row) = (floor(x), floor(y));
        if self.place != Some((seed, column, row)) {
            let at = |dx: f64, dy: f64| 2.0 * unit_from(hash(seed, column + dx, row + dy)) - 1.0;
            *self = Self {
                place: Some((seed, column, row)),
                corners: [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)],
            };
        }
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let (fx, fy) = (smooth(x - column), smooth(y - row));
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let [a, b, c, d] = self.corners;
        mix(mix(a, b, fx), mix(c, d, fx), fy)
    }
}

/// The same as `f64::floor`, which is a call of a library for the oldest processors of a PC.
fn floor(value: f64) -> f64 {
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let toward_zero = value as i64 as f64;
    if value.abs() >= WHOLE || value.is_nan() {
        value
    } else if toward_zero > value {
        toward_zero - 1.0
    } else {
        toward_zero
    }
}

fn is_odd(value: f64) -> bool {
    (floor(value) as i64) & 1 != 0
}

/// 64 well mixed bits for one cell of an integer grid (the finalizer of SplitMix64, once per
/// coordinate).
pub(super) fn hash(seed: u64, column: f64, row: f64) -> u64 {
    let mix = |value: u64| {
        let value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        value ^ (value >> 31)
    };
    let step = 0x9e37_79b9_7f4a_7c15_u64;
    mix(mix(seed.wrapping_add(step) ^ (column as i64 as u64)).wrapping_add(step)
        ^ (row as i64 as u64))
}

/// The hash as a number in 0 .. 1.
pub(super) fn unit_from(hash: u64) -> f64 {
    (hash >> 11) as f64 / (1_u64 << 53) as f64
}
