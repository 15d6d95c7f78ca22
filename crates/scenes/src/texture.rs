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

    /// The grey at `u, v` metres from the surface's origin.
    pub fn grey(&self, u: f64, v: f64) -> f64 {
        let [grey] = self.greys(&mut Cells::default(), &[[u], [v]]);
        grey
    }

    /// The greys at positions close to each other: all first coordinates, all second ones. Calls
    /// for the same texture share `cells`.
    pub(super) fn greys<const N: usize>(&self, cells: &mut Cells, at: &[[f64; N]; 2]) -> [f64; N] {
        let mut greys = self.pattern.greys(self.seed, &mut cells.pattern, at);
        if self.grain == 0.0 {
            return greys;
        }
        let coarse = at.each_ref().map(|axis| of_all(axis, |position| position / self.grain_size));
        let mut noise = [0.0; N];
        for (cell, (scale, weight, seed)) in
            cells.grain.iter_mut().zip([(1.0, 0.5, 1), (2.0, 0.3, 2), (4.0, 0.2, 3)])
        {
            let at = coarse.each_ref().map(|axis| of_all(axis, |position| position * scale));
            let values = cell.smooth_noise(self.seed ^ seed, &at);
            noise.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
        greys.iter_mut().zip(noise).for_each(|(grey, noise)| *grey += self.grain * noise);
        greys
    }
}

impl Pattern {
    fn greys<const N: usize>(&self, seed: u64, cells: &mut Patch, at: &[[f64; N]; 2]) -> [f64; N] {
        let [us, vs] = at;
        let in_cells = |size: [f64; 2]| [of_all(us, |u| u / size[0]), of_all(vs, |v| v / size[1])];
        match *self {
            Self::Blank(grey) => [grey; N],
            Self::Stripes { greys, period } => {
                of_all(us, |u| greys[usize::from(is_odd(2.0 * u / period))])
            }
            Self::Checker { greys, side } => cells.of_cells(&in_cells([side; 2]), |column, row| {
                greys[usize::from(is_odd(column) != is_odd(row))]
            }),
            Self::Mosaic { greys, cell } => cells.of_cells(&in_cells(cell), |column, row| {
                greys[0] + (greys[1] - greys[0]) * unit_from(hash(seed, column, row))
            }),
            Self::Edge(greys) => of_all(vs, |v| greys[usize::from(v >= 0.0)]),
            Self::Band { greys, width } => {
                of_all(vs, |v| greys[usize::from(v.abs() < 0.5 * width)])
            }
        }
    }
}

/// The cells around the last positions: of the pattern, and of the grain's three octaves.
#[derive(Default)]
pub(super) struct Cells {
    pattern: Patch,
    grain: [Patch; 3],
}

/// Two by two cells of a grid of numbers, and the values of these and of those behind them: a pixel
/// seldom reaches more.
struct Patch {
    /// Its first column and row; NaN, so that it holds nothing, until it is somewhere.
    first: [f64; 2],
    /// Row by row.
    values: [[f64; 3]; 3],
}

impl Default for Patch {
    fn default() -> Self {
        Self { first: [f64::NAN; 2], values: [[0.0; 3]; 3] }
    }
}

impl Patch {
    /// The value of the cell that each position lies in.
    fn of_cells<const N: usize>(
        &mut self,
        at: &[[f64; N]; 2],
        of: impl Fn(f64, f64) -> f64,
    ) -> [f64; N] {
        self.of_positions(at, &of, |values, _, is_second| {
            let [above, below, _] =
                values.map(|[left, right, _]| choose(is_second[0], right, left));
            choose(is_second[1], below, above)
        })
    }

    /// Smooth noise in -1 ..= 1 with one independent value per corner of the cells.
    fn smooth_noise<const N: usize>(&mut self, seed: u64, at: &[[f64; N]; 2]) -> [f64; N] {
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let of = |column, row| 2.0 * unit_from(hash(seed, column, row)) - 1.0;
        self.of_positions(at, &of, |values, offset, is_second| {
            let [fx, fy] = offset.map(smooth);
            let [above, middle, below] = values.map(|[left, middle, right]| {
                mix(choose(is_second[0], middle, left), choose(is_second[0], right, middle), fx)
            });
            mix(choose(is_second[1], middle, above), choose(is_second[1], below, middle), fy)
        })
    }

    /// A value for each position. `of` gives the value of a cell by its column and row; `value`
    /// gets those of the patch, the position within its cell, and for both axes if that cell is the
    /// second one.
    fn of_positions<const N: usize>(
        &mut self,
        at: &[[f64; N]; 2],
        of: &impl Fn(f64, f64) -> f64,
        value: impl Fn(&[[f64; 3]; 3], [f64; 2], [bool; 2]) -> f64 + Copy,
    ) -> [f64; N] {
        let mut found = [0.0; N];
        let [xs, ys] = at;
        let places = found.iter_mut().zip(xs.iter().zip(ys));
        if self.holds(at) || self.move_to(at, of) {
            let Self { first: [column, row], values } = *self;
            for (found, (&x, &y)) in places {
                let is_second = [x >= column + 1.0, y >= row + 1.0];
                let of_cell = [
                    choose(is_second[0], column + 1.0, column),
                    choose(is_second[1], row + 1.0, row),
                ];
                *found = value(&values, [x - of_cell[0], y - of_cell[1]], is_second);
            }
        } else {
            for (found, (&x, &y)) in places {
                [*found] = self.of_positions(&[[x], [y]], of, value);
            }
        }
        found
    }

    fn holds<const N: usize>(&self, at: &[[f64; N]; 2]) -> bool {
        let is_within = |(axis, first): (&[f64; N], f64)| {
            axis.iter().fold(true, |all, &at| all & (at >= first) & (at < first + 2.0))
        };
        at.iter().zip(self.first).all(is_within)
    }

    /// Moves to the first cells of these positions; true if it holds all of them.
    fn move_to<const N: usize>(
        &mut self,
        at: &[[f64; N]; 2],
        of: &impl Fn(f64, f64) -> f64,
    ) -> bool {
        let least = |axis: &[f64; N]| {
            axis.iter().fold(f64::INFINITY, |least, &at| choose(at < least, at, least))
        };
        let first = at.each_ref().map(|axis| floor(least(axis)));
        let ahead = [0.0, 1.0, 2.0];
        let values = ahead.map(|down| ahead.map(|right| of(first[0] + right, first[1] + down)));
        *self = Self { first, values };
        self.holds(at)
    }
}

/// One of two values without a branch, so that a compiler can do several at once.
pub(super) fn choose(is_first: bool, first: f64, second: f64) -> f64 {
    if is_first { first } else { second }
}

/// The same as `array::map`, of which a compiler makes calls where an array is long.
fn of_all<const N: usize>(values: &[f64; N], of: impl Fn(f64) -> f64) -> [f64; N] {
    let mut found = [0.0; N];
    found.iter_mut().zip(values).for_each(|(found, &value)| *found = of(value));
    found
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
