//! Semi-global matching: costs gathered along 4 or 8 straight paths, a small penalty for steps and a larger one for jumps.
//!
//! In: a pair. Out: disparities of all pixels that have every disparity in the right image.
//!
//! ```text
//! L_r(p, d) = C(p, d) + min( L_r(p-r, d), L_r(p-r, d-1) + P1, L_r(p-r, d+1) + P1, min_e L_r(p-r, e) + P2 ) - min_e L_r(p-r, e)
//! S(p, d)   = sum of L_r(p, d) over the directions r
//! ```
//! Half of the directions come from above in a pass over the rows downwards, half from below in a pass upwards. Images are continued by
//! their border pixels, so that windows at the border have a cost.
//!
//! # Bounds
//! Costs are limited to [`LARGEST_COST`], penalties to 4095: a path's value stays below 8192 and the sum of eight below 2^16.
//!
//! # Cost
//! `4 * width * height * disparities` bytes; about ten operations of 16 bits a path, pixel and disparity.
//!
//! # Source
//! Hirschmueller, "Stereo processing by semiglobal matching and mutual information" (2008), Eqs. 13 and 14.

use super::cost::CostKind;
use super::curve::Acceptance;
use super::map::DisparityMap;
use super::search::Search;
use super::sums::{CurveRow, for_each_row};
use super::window::Window;
use linestereo::Dims;
use linestereo_frames::GrayImage;

/// A window's cost never counts more.
const LARGEST_COST: u32 = 4095;
/// Beyond the first and the last disparity: more than any path's value, and small enough for a penalty on top.
const GUARD: i16 = 1 << 14;

/// Directions from which costs are gathered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Paths {
    /// Along the row and the column.
    Four,
    /// Along the diagonals too.
    Eight,
}

/// The matcher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SemiGlobalMatcher {
    /// Matching cost of two windows.
    pub cost: CostKind,
    /// The window that a pixel's own cost is summed over.
    pub window: Window,
    /// Directions.
    pub paths: Paths,
    /// Penalty of a step by 1 px, at most 4095.
    pub step: u16,
    /// Penalty of a jump, at most 4095.
    pub jump: u16,
    /// Acceptance tests of a disparity.
    pub acceptance: Acceptance,
}

impl SemiGlobalMatcher {
    /// Census, summed over 5x5 px.
    #[must_use]
    pub fn new(paths: Paths, acceptance: Acceptance) -> Self {
        Self { cost: CostKind::Census, window: Window::square(5), paths, step: 60, jump: 240, acceptance }
    }

    /// Matches a pair.
    #[must_use]
    pub fn run(&self, left: &GrayImage, right: &GrayImage, search: Search) -> DisparityMap {
        let mut map = DisparityMap::empty(left.dims);
        if search.columns() == 0 {
            return map;
        }
        let costs = self.pixel_costs(left, right, search);
        let mut sums = vec![0_u16; costs.len()];
        let stride = search.columns() * search.count;
        let mut pass = Pass::new(self, search, true);
        for (costs, sums) in costs.chunks_exact(stride).zip(sums.chunks_exact_mut(stride)) {
            pass.row(costs, sums);
        }
        let mut pass = Pass::new(self, search, false);
        let mut row = vec![0_u32; stride];
        let mut scratch = Vec::new();
        let rows = costs.chunks_exact(stride).zip(sums.chunks_exact_mut(stride));
        for (y, (costs, sums)) in rows.enumerate().rev() {
            pass.row(costs, sums);
            for (wide, &sum) in row.iter_mut().zip(&*sums) {
                *wide = sum.into();
            }
            let curves = CurveRow { y, first: search.first(), count: search.count, costs: &row };
            self.acceptance.read(curves, &mut scratch, &mut map);
        }
        map
    }

    /// Cost of each pixel and disparity, row by row.
    fn pixel_costs(&self, left: &GrayImage, right: &GrayImage, search: Search) -> Vec<u16> {
        let margin = (self.window.half_columns(), self.window.half_rows());
        let (left, right) = (continued(left, margin), continued(right, margin));
        let wide = Search { dims: left.dims, count: search.count };
        let cost = self.cost.of(&left, &right, &self.window, wide);
        let mut costs = Vec::with_capacity(search.height() * search.columns() * search.count);
        for_each_row(&*cost, wide, &self.window, |row| {
            // The margin on the left has given the windows of the first columns room: they begin where the image's own begin.
            costs.extend(row.costs.iter().map(|&cost| cost.min(LARGEST_COST) as u16));
        });
        costs
    }
}

/// The image with its border pixels repeated around it.
fn continued(image: &GrayImage, (columns, rows): (usize, usize)) -> GrayImage {
    let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
    let row = |y: usize| {
        let start = (y.clamp(rows, rows + height - 1) - rows) * width;
        let row = &image.pixels[start..start + width];
        (0..width + 2 * columns).map(move |x| row[x.clamp(columns, columns + width - 1) - columns])
    };
    let pixels = (0..height + 2 * rows).flat_map(row).collect();
    let dims = Dims { width: (width + 2 * columns) as u16, height: (height + 2 * rows) as u16 };
    GrayImage { dims, pixels }
}

/// The values of one direction's paths in a row: a guard, the disparities, a guard; and the lowest of each column.
#[derive(Clone)]
struct PathRow {
    values: Vec<i16>,
    lowest: Vec<i16>,
}

impl PathRow {
    /// Paths that have not begun: of value 0.
    fn new(columns: usize, count: usize) -> Self {
        let mut values = vec![0; columns * (count + 2)];
        for column in values.chunks_exact_mut(count + 2) {
            column[0] = GUARD;
            column[count + 1] = GUARD;
        }
        Self { values, lowest: vec![0; columns] }
    }
}

/// Half of the directions: those from the row before, and the one along the row.
struct Pass {
    count: usize,
    columns: usize,
    /// To the right; else to the left.
    rightwards: bool,
    penalties: [i16; 2],
    /// Of each direction the column it comes from, relative to this one, and its paths before and in this row.
    above: Vec<(isize, PathRow, PathRow)>,
    /// A path that begins.
    fresh: PathRow,
}

impl Pass {
    fn new(matcher: &SemiGlobalMatcher, search: Search, rightwards: bool) -> Self {
        let (columns, count) = (search.columns(), search.count);
        let offsets: &[isize] = match matcher.paths {
            Paths::Four => &[0],
            Paths::Eight => &[-1, 0, 1],
        };
        let empty = PathRow::new(columns, count);
        Self {
            count,
            columns,
            rightwards,
            penalties: [matcher.step, matcher.jump].map(|penalty| penalty.min(LARGEST_COST as u16) as i16),
            above: offsets.iter().map(|&offset| (offset, empty.clone(), empty.clone())).collect(),
            fresh: PathRow::new(1, count),
        }
    }

    /// Adds the paths in the next row to its sums.
    fn row(&mut self, costs: &[u16], sums: &mut [u16]) {
        let (columns, count) = (self.columns, self.count);
        for (offset, before, here) in &mut self.above {
            for x in 0..columns {
                let (from, at) = match x.checked_add_signed(*offset).filter(|&from| from < columns) {
                    Some(from) => (&*before, from),
                    None => (&self.fresh, 0),
                };
                let previous = (&from.values[at * (count + 2)..][..count + 2], from.lowest[at]);
                let disparities = x * count..(x + 1) * count;
                here.lowest[x] = extend(
                    previous,
                    &costs[disparities.clone()],
                    self.penalties,
                    &mut here.values[x * (count + 2) + 1..][..count],
                    &mut sums[disparities],
                );
            }
            core::mem::swap(before, here);
        }
        let [mut before, mut here] = [PathRow::new(1, count), PathRow::new(1, count)];
        for i in 0..columns {
            let x = if self.rightwards { i } else { columns - 1 - i };
            let disparities = x * count..(x + 1) * count;
            here.lowest[0] = extend(
                (&before.values, before.lowest[0]),
                &costs[disparities.clone()],
                self.penalties,
                &mut here.values[1..=count],
                &mut sums[disparities],
            );
            core::mem::swap(&mut before, &mut here);
        }
    }
}

/// One step of a path: its values at a pixel from those at the one before. Gives the lowest.
fn extend(
    (before, lowest): (&[i16], i16),
    costs: &[u16],
    [step, jump]: [i16; 2],
    values: &mut [i16],
    sums: &mut [u16],
) -> i16 {
    let count = costs.len();
    let (below, same, above) = (&before[..count], &before[1..=count], &before[2..count + 2]);
    let jump = lowest + jump;
    let mut least = i16::MAX;
    for d in 0..count {
        let stepped = below[d].min(above[d]) + step;
        let value = costs[d] as i16 + same[d].min(stepped).min(jump) - lowest;
        values[d] = value;
        sums[d] = sums[d].wrapping_add(value as u16);
        least = least.min(value);
    }
    least
}
