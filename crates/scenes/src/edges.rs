//! One straight edge with everything about it known: position, direction, disparity along it,
//! slant, owner.

use super::geometry::{Pair, Surface, Vector, along, cross, length, unit};
use super::{Pattern, Scene, Texture};
use linestereo::{Dims, results::Owner};

/// A plane in space by what it looks like: its disparity is linear in the left image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisparityPlane {
    /// A pixel position,
    pub at: [f64; 2],
    /// the disparity there,
    pub disparity: f64,
    /// and its change per pixel to the right and per pixel down: the slant.
    pub slope: [f64; 2],
}

impl DisparityPlane {
    /// Disparity at any pixel position.
    pub fn disparity_at(&self, x: f64, y: f64) -> f64 {
        self.disparity + self.slope[0] * (x - self.at[0]) + self.slope[1] * (y - self.at[1])
    }

    /// The plane as an unbounded surface whose first axis is seen along `direction` through
    /// [`Self::at`] and whose second one points to the right of that direction, as seen in the
    /// image.
    pub fn surface(
        &self,
        pair: &Pair,
        direction: [f64; 2],
        texture: Texture,
        label: u8,
    ) -> Surface {
        let [x, y] = self.at;
        let point =
            |x: f64, y: f64| -> Vector { pair.point(x, y, pair.depth(self.disparity_at(x, y))) };
        let origin = point(x, y);
        // A small step keeps the depth positive on any plane; the direction in space does not
        // depend on it.
        let toward =
            |dx: f64, dy: f64| unit(along(point(x + 1e-3 * dx, y + 1e-3 * dy), -1.0, origin));
        let u = toward(direction[0], direction[1]);
        let normal = unit(cross(u, toward(-direction[1], direction[0])));
        let unbounded = [f64::NEG_INFINITY, f64::INFINITY];
        Surface { origin, u, v: cross(normal, u), extent: [unbounded; 2], texture, label }
    }
}

/// A single edge through an image: the border between two greys on one surface, or the border of a
/// surface before another.
#[derive(Clone, Copy, Debug)]
pub struct EdgeCase {
    /// The plane the edge lies on; the edge passes through its `at`.
    pub plane: DisparityPlane,
    /// Direction of the edge in the image, any length. Orders the sides: see [`Self::side`].
    pub direction: [f64; 2],
    /// Both where the plane reaches to both sides of the edge, else the side at which it ends.
    pub owner: Owner,
    /// Disparity of the wall behind a plane that ends at the edge.
    pub background: f64,
    /// Greys of the left (upper) and of the right (lower) side.
    pub greys: [f64; 2],
    /// Largest deviation of the grain from these greys.
    pub grain: f64,
    /// Seed of the grain and of the sensor's noise.
    pub seed: u64,
}

impl EdgeCase {
    /// True where the core treats the direction as near-horizontal: more than four columns per row.
    pub fn is_near_horizontal(&self) -> bool {
        self.direction[0].abs() > 4.0 * self.direction[1].abs()
    }

    /// The direction turned so that the right (lower) side of the edge is on its right.
    fn ordered_direction(&self) -> [f64; 2] {
        let [dx, dy] = self.direction;
        let forward = if self.is_near_horizontal() { dx > 0.0 } else { dy < 0.0 };
        if forward { [dx, dy] } else { [-dx, -dy] }
    }

    /// Distance of a pixel position from the edge in pixels: negative on the left (upper) side,
    /// positive on the right (lower) one.
    pub fn side(&self, x: f64, y: f64) -> f64 {
        let [dx, dy] = self.ordered_direction();
        let norm = length([dx, dy, 0.0]);
        ((y - self.plane.at[1]) * dx - (x - self.plane.at[0]) * dy) / norm
    }

    /// The case as a scene for images of this size: labels are 1 for the plane and 2 for the wall
    /// behind.
    pub fn scene(&self, dims: Dims) -> Scene {
        let pair = Pair::centred(dims, f64::from(dims.width), 0.1);
        let texture = |pattern: Pattern, disparity: f64, seed: u64| {
            let metres_per_pixel = pair.depth(disparity) / pair.focal_px;
            Texture::grained(pattern, self.grain, 6.0 * metres_per_pixel, seed)
        };
        let direction = self.ordered_direction();
        let [left, right] = self.greys;
        let (pattern, rear_grey, reach) = match self.owner {
            Owner::Both => (Pattern::Edge(self.greys), left, None),
            Owner::Left => (Pattern::Blank(left), right, Some([f64::NEG_INFINITY, 0.0])),
            Owner::Right => (Pattern::Blank(right), left, Some([0.0, f64::INFINITY])),
        };
        let mut front = self.plane.surface(
            &pair,
            direction,
            texture(pattern, self.plane.disparity, self.seed),
            1,
        );
        let Some(reach) = reach else {
            return Scene { pair, surfaces: vec![front], objects: vec!["plane"] };
        };
        front.extent[1] = reach;
        let wall = DisparityPlane { disparity: self.background, slope: [0.0; 2], ..self.plane };
        let rear_texture =
            texture(Pattern::Blank(rear_grey), self.background, self.seed.wrapping_add(1));
        let surfaces = vec![front, wall.surface(&pair, direction, rear_texture, 2)];
        Scene { pair, surfaces, objects: vec!["plane", "wall behind"] }
    }

    /// Cases over directions (every 15 degrees or so, and near-horizontal ones), slants, sub-pixel
    /// shifts and owners, the edges passing near the middle of images of this size at a disparity
    /// near `disparity`, in front of a wall at half of it.
    pub fn grid(dims: Dims, disparity: f64) -> Vec<Self> {
        const DIRECTIONS: [[f64; 2]; 10] = [
            [0.0, 1.0],
            [1.0, 4.0],
            [-1.0, 4.0],
            [3.0, 5.0],
            [-1.0, 1.0],
            [5.0, 3.0],
            [-2.0, 1.0],
            [6.0, 1.0],
            [-12.0, 1.0],
            [1.0, 0.0],
        ];
        const SLOPES: [[f64; 2]; 4] = [[0.0, 0.0], [0.06, 0.0], [0.0, -0.06], [-0.05, 0.05]];
        const SHIFTS: [f64; 4] = [0.0, 0.25, 0.4, 0.75];
        let mut cases = Vec::new();
        for direction in DIRECTIONS {
            for slope in SLOPES {
                for shift in SHIFTS {
                    for owner in [Owner::Left, Owner::Right, Owner::Both] {
                        let seed = cases.len() as u64;
                        // The edge's column and its disparity shift by different fractions, so that
                        // they do not cancel.
                        let at = [f64::from(dims.width / 2) + shift, f64::from(dims.height / 2)];
                        let plane =
                            DisparityPlane { at, disparity: disparity + 1.5 * shift, slope };
                        let greys =
                            if seed.is_multiple_of(2) { [80.0, 160.0] } else { [150.0, 70.0] };
                        let (background, grain) = (0.5 * disparity, 25.0);
                        cases.push(Self {
                            plane,
                            direction,
                            owner,
                            background,
                            greys,
                            grain,
                            seed,
                        });
                    }
                }
            }
        }
        cases
    }
}
