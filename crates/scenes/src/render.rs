//! From surfaces to two images and the truth, by ray casting.
//!
//! A pixel is the mean over its area, taken at the points of a Fibonacci lattice: an edge of any
//! direction sweeps over them one at a time, so its position shows in steps of 1/55 px (a square
//! grid of as many points would give 1/7).

use super::Scene;
use super::geometry::{Facing, Surface, Vector, along};
use super::texture::{Cells, choose, hash, unit_from};
use linestereo::Dims;
use linestereo_frames::GrayImage;

/// Points per pixel, a Fibonacci number, and the second one before it.
const LATTICE: (u32, u32) = (55, 21);

/// Disturbances that the cameras add to the light: nothing by default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Standard deviation of the noise of either image in grey levels.
    pub noise: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// The right image's brightness is multiplied by this.
    pub gain: f64,
    /// Grey levels then added to the right image.
    pub bias: f64,
    /// Rows by which the right image's content lies lower than it should.
    pub row_offset: f64,
}

impl Default for Sensor {
    fn default() -> Self {
        Self { noise: 0.0, seed: 0, gain: 1.0, bias: 0.0, row_offset: 0.0 }
    }
}

/// A rendered pair and what is true of every pixel centre of its left image, row by row.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Left image, the reference.
    pub left: GrayImage,
    /// Right image.
    pub right: GrayImage,
    /// Disparity in pixels; NaN where no surface is.
    pub disparity: Vec<f32>,
    /// True where the right image shows the same point of the same surface.
    pub visible: Vec<bool>,
    /// Label of the surface; 0 where none is.
    pub labels: Vec<u8>,
}

impl Rendering {
    /// Label of the surface at this pixel of the left image; `None` outside.
    pub fn label(&self, (x, y): (i32, i32)) -> Option<u8> {
        let (width, x) = (usize::from(self.left.dims.width), usize::try_from(x).ok()?);
        self.labels.get(usize::try_from(y).ok()? * width + x).filter(|_| x < width).copied()
    }

    /// Disparities to search, for [`linestereo::Params::max_disparity`]: above everything in the
    /// scene, in steps of 16, within the core's limits.
    pub fn search_range(&self) -> u16 {
        // NaN loses against any number.
        let largest = self.disparity.iter().copied().fold(0.0_f32, f32::max);
        let range = (largest as u16 + 2).next_multiple_of(16);
        range.min(256).min(self.left.dims.width - 1)
    }

    /// The truth of the next pixel.
    fn push(&mut self, disparity: f32, visible: bool, label: u8) {
        self.disparity.push(disparity);
        self.visible.push(visible);
        self.labels.push(label);
    }
}

/// One camera's pixels as rays, and the surfaces as it sees them.
struct Camera {
    focal: f64,
    centre: [f64; 2],
    facings: Vec<Facing>,
}

impl Camera {
    fn new(focal: f64, centre: [f64; 2], eye: Vector, surfaces: &[Surface]) -> Self {
        let facings = surfaces.iter().map(|surface| Facing::new(surface, eye)).collect();
        Self { focal, centre, facings }
    }

    fn ray(&self, x: f64, y: f64) -> [f64; 2] {
        [(x - self.centre[0]) / self.focal, (y - self.centre[1]) / self.focal]
    }

    /// The surfaces nearest to the camera along rays.
    fn nearest<const N: usize>(&self, candidates: &[usize], rays: &[[f64; N]; 2]) -> Nearest<N> {
        let mut best = Nearest { surfaces: [0; N], depths: [f64::INFINITY; N], at: [[0.0; N]; 2] };
        for &number in candidates {
            let (depths, at) = self.facings[number].hits(rays);
            for i in 0..N {
                let is_nearer = depths[i] < best.depths[i];
                best.surfaces[i] = if is_nearer { number } else { best.surfaces[i] };
                best.depths[i] = choose(is_nearer, depths[i], best.depths[i]);
                best.at[0][i] = choose(is_nearer, at[0][i], best.at[0][i]);
                best.at[1][i] = choose(is_nearer, at[1][i], best.at[1][i]);
            }
        }
        best
    }

    /// Surfaces that may be seen between two slopes on one axis.
    fn between(&self, candidates: &[usize], axis: usize, low: f64, high: f64) -> Vec<usize> {
        let meets = |&number: &usize| {
            let [first, last] = self.facings[number].bounds[axis];
            first <= high && last >= low
        };
        candidates.iter().copied().filter(meets).collect()
    }

    /// Calls `visit(column, row, candidates)` for every pixel with the surfaces that may be seen in
    /// it.
    fn for_each_pixel(&self, dims: Dims, mut visit: impl FnMut(f64, f64, &[usize])) {
        let all: Vec<usize> = (0..self.facings.len()).collect();
        for row in 0..dims.height {
            let y = f64::from(row);
            let in_row =
                self.between(&all, 1, self.ray(0.0, y - 0.5)[1], self.ray(0.0, y + 0.5)[1]);
            for column in 0..dims.width {
                let x = f64::from(column);
                visit(
                    x,
                    y,
                    &self.between(&in_row, 0, self.ray(x - 0.5, 0.0)[0], self.ray(x + 0.5, 0.0)[0]),
                );
            }
        }
    }

    /// Mean grey over every pixel's area, unrounded.
    fn image(&self, dims: Dims, surfaces: &[Surface]) -> Vec<f64> {
        const COUNT: usize = LATTICE.0 as usize;
        let offset = |index: u32| (f64::from(index) + 0.5) / f64::from(LATTICE.0) - 0.5;
        let lattice: [[f64; 2]; COUNT] =
            core::array::from_fn(|i| [i as u32, i as u32 * LATTICE.1 % LATTICE.0].map(offset));
        let mut greys = Vec::with_capacity(usize::from(dims.width) * usize::from(dims.height));
        let mut cells: Vec<Cells> = surfaces.iter().map(|_| Cells::default()).collect();
        self.for_each_pixel(dims, |x, y, candidates| {
            let mut rays = [[0.0; COUNT]; 2];
            for (i, [dx, dy]) in lattice.iter().enumerate() {
                [rays[0][i], rays[1][i]] = self.ray(x + dx, y + dy);
            }
            let Nearest { surfaces: seen, depths, at } = self.nearest(candidates, &rays);
            let mut of_lattice = [0.0; COUNT];
            let is_hit = |i: usize| depths[i] < f64::INFINITY;
            if (0..COUNT).all(|i| is_hit(i) && seen[i] == seen[0]) {
                of_lattice = surfaces[seen[0]].texture.greys(&mut cells[seen[0]], &at);
            } else {
                for i in (0..COUNT).filter(|&i| is_hit(i)) {
                    let at = [[at[0][i]], [at[1][i]]];
                    [of_lattice[i]] = surfaces[seen[i]].texture.greys(&mut cells[seen[i]], &at);
                }
            }
            greys.push(of_lattice.iter().sum::<f64>() / f64::from(LATTICE.0));
        });
        greys
    }
}

/// The first hits of rays: numbers of the surfaces, depths in metres, infinite where there is none,
/// and both surface coordinates in metres.
struct Nearest<const N: usize> {
    surfaces: [usize; N],
    depths: [f64; N],
    at: [[f64; N]; 2],
}

/// The pair that the cameras of a scene see, and its truth.
///
/// Cost: 55 rays a pixel, some 0.2 s for 320x240; both images at the same time.
pub fn render(scene: &Scene, dims: Dims, sensor: &Sensor) -> Rendering {
    let Scene { pair, surfaces, .. } = scene;
    let eye = [pair.baseline_m, 0.0, 0.0];
    let right_centre =
        [pair.centre[0] + pair.disparity_offset_px, pair.centre[1] + sensor.row_offset];
    let left = Camera::new(pair.focal_px, pair.centre, [0.0; 3], surfaces);
    let right = Camera::new(pair.focal_px, right_centre, eye, surfaces);
    let (left_greys, right_greys) = std::thread::scope(|threads| {
        let other = threads.spawn(|| right.image(dims, surfaces));
        (left.image(dims, surfaces), other.join())
    });
    let right_greys = right_greys.unwrap_or_else(|panic| std::panic::resume_unwind(panic));

    let exposed: Vec<f64> =
        right_greys.iter().map(|grey| grey * sensor.gain + sensor.bias).collect();
    let mut rendering = Rendering {
        left: digitize(&left_greys, dims, sensor, 0),
        right: digitize(&exposed, dims, sensor, 1),
        disparity: Vec::new(),
        visible: Vec::new(),
        labels: Vec::new(),
    };
    let all: Vec<usize> = (0..surfaces.len()).collect();
    left.for_each_pixel(dims, |x, y, candidates| {
        let ray = left.ray(x, y);
        let Nearest { surfaces: [number], depths: [depth], .. } =
            left.nearest(candidates, &ray.map(|slope| [slope]));
        if depth == f64::INFINITY {
            return rendering.push(f32::NAN, false, 0);
        }
        let point = along([ray[0] * depth, ray[1] * depth, depth], -1.0, eye);
        let seen = [point[0] / depth, point[1] / depth];
        let in_image = |axis: usize, side: u16| {
            let position = seen[axis] * right.focal + right.centre[axis];
            position >= -0.5 && position <= f64::from(side) - 0.5
        };
        // Another surface hides the point only if it is nearer by more than rounding.
        let Nearest { depths: [nearest], .. } = right.nearest(&all, &seen.map(|slope| [slope]));
        let free = nearest > depth * (1.0 - 1e-9);
        let visible = in_image(0, dims.width) && in_image(1, dims.height) && free;
        rendering.push(pair.disparity(depth) as f32, visible, surfaces[number].label);
    });
    rendering
}

/// Adds the sensor's noise and rounds to 8 bits.
fn digitize(greys: &[f64], dims: Dims, sensor: &Sensor, camera: u64) -> GrayImage {
    // Four uniform numbers have a standard deviation of sqrt(4 / 12): their sum is near enough to a
    // normal distribution.
    let normal = |index: usize| {
        let uniform = |part: u64| {
            unit_from(hash(sensor.seed, index as f64, (4 * camera + part) as f64)) - 0.5
        };
        (uniform(0) + uniform(1) + uniform(2) + uniform(3)) * 3.0_f64.sqrt()
    };
    let noise = |index: usize| if sensor.noise == 0.0 { 0.0 } else { sensor.noise * normal(index) };
    let digit =
        |(index, grey): (usize, &f64)| (grey + noise(index) + 0.5).floor().clamp(0.0, 255.0) as u8;
    GrayImage { dims, pixels: greys.iter().enumerate().map(digit).collect() }
}
