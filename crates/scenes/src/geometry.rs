//! Vectors, the pair of cameras, and flat surfaces.

use super::texture::Texture;
use linestereo::{Dims, Rig, params::RigError};

/// Metres: x right, y down, z forward from the left camera.
pub type Vector = [f64; 3];

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a + t * b`.
pub(super) fn along(a: Vector, t: f64, b: Vector) -> Vector {
    [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]]
}

pub(super) fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn unit(a: Vector) -> Vector {
    let scale = 1.0 / length(a);
    a.map(|component| component * scale)
}

/// Two equal pinhole cameras side by side, rectified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Focal length in pixels.
    pub focal_px: f64,
    /// Distance of the right camera from the left one in metres.
    pub baseline_m: f64,
    /// Optical centre of the left image in pixels.
    pub centre: [f64; 2],
    /// Added to a disparity before it becomes a depth: the right optical centre lies this many
    /// pixels further right.
    pub disparity_offset_px: f64,
}

impl Pair {
    /// A pair with its optical centre in the middle of the image and no offset.
    pub fn centred(dims: Dims, focal_px: f64, baseline_m: f64) -> Self {
        let centre = [0.5 * (f64::from(dims.width) - 1.0), 0.5 * (f64::from(dims.height) - 1.0)];
        Self { focal_px, baseline_m, centre, disparity_offset_px: 0.0 }
    }

    /// Disparity in pixels at a depth in metres.
    pub fn disparity(&self, depth: f64) -> f64 {
        self.focal_px * self.baseline_m / depth - self.disparity_offset_px
    }

    /// Depth in metres at a disparity in pixels.
    pub fn depth(&self, disparity: f64) -> f64 {
        self.focal_px * self.baseline_m / (disparity + self.disparity_offset_px)
    }

    /// The point seen at pixel `x, y` of the left image, `depth` metres away.
    pub fn point(&self, x: f64, y: f64, depth: f64) -> Vector {
        let scale = depth / self.focal_px;
        [(x - self.centre[0]) * scale, (y - self.centre[1]) * scale, depth]
    }

    /// The same pair as the core's rig.
    pub fn rig(&self) -> Result<Rig, RigError> {
        Rig::new(self.focal_px as f32, self.baseline_m as f32, self.disparity_offset_px as f32)
    }
}

/// A rectangle in space, possibly unbounded on some sides. `u` and `v` are its axes: unit vectors,
/// perpendicular.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where the texture's coordinates start.
    pub origin: Vector,
    /// First axis.
    pub u: Vector,
    /// Second axis.
    pub v: Vector,
    /// First and last coordinate along `u` and along `v` in metres.
    pub extent: [[f64; 2]; 2],
    /// Its greys.
    pub texture: Texture,
    /// Object it belongs to, from 1.
    pub label: u8,
}

impl Surface {
    /// The rectangle from `corner` along `across` and, as far as that is perpendicular to `across`,
    /// along `down`.
    pub fn rectangle(
        corner: Vector,
        across: Vector,
        down: Vector,
        texture: Texture,
        label: u8,
    ) -> Self {
        let u = unit(across);
        let down = along(down, -dot(down, u), u);
        let extent = [[0.0, length(across)], [0.0, length(down)]];
        Self { origin: corner, u, v: unit(down), extent, texture, label }
    }

    /// The six faces of a box: its centre, its three edges (perpendicular to each other), one
    /// texture per pair of faces.
    pub fn cuboid(
        centre: Vector,
        edges: [Vector; 3],
        textures: [Texture; 3],
        label: u8,
    ) -> [Self; 6] {
        core::array::from_fn(|face| {
            let (axis, side) = (face / 2, if face % 2 == 0 { -0.5 } else { 0.5 });
            let (across, down) = (edges[(axis + 1) % 3], edges[(axis + 2) % 3]);
            let corner = along(along(along(centre, side, edges[axis]), -0.5, across), -0.5, down);
            let texture =
                Texture { seed: textures[axis].seed.wrapping_add(face as u64), ..textures[axis] };
            Self::rectangle(corner, across, down, texture, label)
        })
    }
}

/// A surface as one camera sees it: every quantity that does not depend on the ray, worked out
/// once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    normal: Vector,
    /// Distance of the plane from the eye along `normal`.
    height: f64,
    axes: [Vector; 2],
    /// Surface coordinates of the eye's foot.
    foot: [f64; 2],
    extent: [[f64; 2]; 2],
    /// Slopes `x/z` and `y/z` between which the surface lies.
    pub(super) bounds: [[f64; 2]; 2],
}

impl Facing {
    pub(super) fn new(surface: &Surface, eye: Vector) -> Self {
        let to_origin = along(surface.origin, -1.0, eye);
        let normal = cross(surface.u, surface.v);
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for (u, v) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let [across, down] = [surface.extent[0][u], surface.extent[1][v]];
            let corner = along(along(to_origin, across, surface.u), down, surface.v);
            // A corner behind the eye or at infinity has no useful projection: such a surface may
            // be anywhere.
            let in_front = across.is_finite() && down.is_finite() && corner[2] > 1e-6;
            for (axis, bound) in bounds.iter_mut().enumerate() {
                let slope = corner[axis] / corner[2];
                bound[0] = if in_front { bound[0].min(slope) } else { f64::NEG_INFINITY };
                bound[1] = if in_front { bound[1].max(slope) } else { f64::INFINITY };
            }
        }
        Self {
            normal,
            height: dot(normal, to_origin),
            axes: [surface.u, surface.v],
            foot: [-dot(to_origin, surface.u), -dot(to_origin, surface.v)],
            extent: surface.extent,
            bounds,
        }
    }

    /// Depths and surface coordinates where rays of slopes `x/z` and `y/z` meet the surface in
    /// front of the eye; infinite depths where they do not.
    #[inline]
    pub(super) fn hits<const N: usize>(&self, rays: &[[f64; N]; 2]) -> ([f64; N], [[f64; N]; 2]) {
        let (mut depths, mut at) = ([f64::INFINITY; N], [[0.0; N]; 2]);
        let [us, vs] = &mut at;
        let rays = rays[0].iter().zip(&rays[1]);
        for (((&x, &y), depth), (u, v)) in rays.zip(&mut depths).zip(us.iter_mut().zip(vs)) {
            let direction = [x, y, 1.0];
            let along_ray = self.height / dot(self.normal, direction);
            [*u, *v] =
                [0, 1].map(|axis| self.foot[axis] + along_ray * dot(self.axes[axis], direction));
            let inside = |value: f64, [low, high]: [f64; 2]| (value >= low) & (value <= high);
            // Parallel or behind it is infinite, no number, or negative.
            let is_hit =
                (along_ray > 0.0) & inside(*u, self.extent[0]) & inside(*v, self.extent[1]);
            *depth = if is_hit { along_ray } else { f64::INFINITY };
        }
        (depths, at)
    }
}
