//! Nodes of a mesh, and what is made of four of them: pieces of rows.
//!
//! In: raw positions of four nodes in a line. Out: the cubic through them, at sixteenths; pieces between.
//!
//! # Bounds
//! Nodes are clamped to 8192 px, 2^29 in Q16: two of them sum to 2^30. Weights in Q30 sum to 2^30 and their sizes to less than 2^31: upper
//! halves of products sum to less than 2^28, which is Q14.
//!
//! # Source
//! Lagrange's interpolation. A bilinear mesh of 16 px errs by 0.16 px on a common lens, Catmull-Rom's cubic is one order worse.

use crate::image::{Dims, MAX_WIDTH};
use crate::kernel::{Knot, X_ROUNDING, weigh_knots};

/// log2 of the distance of nodes in pixels.
pub(super) const COARSE: u8 = 4;
/// The same of a fine mesh.
pub(super) const FINE: u8 = 3;
/// Positions further outside are not told apart: they are outside of any image.
const FAR: f64 = 8192.0;
/// One pixel.
pub(super) const ONE: i32 = 1 << 16;
/// Nodes that a [`Mesh`](super::Mesh) needs for rectified images of this size.
#[must_use]
pub const fn mesh_nodes(dims: Dims) -> usize {
    nodes_along(dims.width, COARSE) as usize * nodes_along(dims.height, COARSE) as usize
}

/// Nodes with which a [`Mesh`](super::Mesh) can halve their distance, where a lens asks for it: very wide ones, and images below 200 px.
#[must_use]
pub const fn fine_mesh_nodes(dims: Dims) -> usize {
    nodes_along(dims.width, FINE) as usize * nodes_along(dims.height, FINE) as usize
}

/// One before the first pixel, and two from the last one's cell on.
pub(super) const fn nodes_along(side: u16, cell: u8) -> u16 {
    (side.saturating_sub(1) >> cell) + 4
}

/// Raw position, px in Q16.
///
/// The last bits hold, until the rows are known: x: the camera cannot see this; y: it is behind the camera.
pub(super) type Node = Knot;

impl Node {
    pub(super) const ZERO: Self = Self { x: 0, y: 0 };

    #[expect(clippy::float_arithmetic, reason = "set-up")]
    pub(super) fn new(source: Option<([f64; 2], bool)>) -> Self {
        let Some(([x, y], seen)) = source else { return Self { x: 1, y: 1 } };
        let nearest = |v: f64| (v.clamp(-FAR, FAR) * f64::from(ONE)) as i32 & !1;
        Self { x: nearest(x) | i32::from(!seen), y: nearest(y) }
    }

    pub(super) fn is_seen(self) -> bool {
        self.x & 1 == 0
    }

    pub(super) fn is_behind(self) -> bool {
        self.y & 1 == 1
    }

    pub(super) fn weighted(nodes: [Self; 4], weights: [i32; 4]) -> Self {
        let mut sum = [Self::ZERO];
        let [a, b, c, d] = &nodes;
        weigh_knots([a, b, c, d].map(core::slice::from_ref), weights, &mut sum);
        let [sum] = sum;
        sum
    }

    /// Of four nodes, in the middle of the inner two: (-1, 9, 9, -1) / 16.
    #[inline]
    pub(super) fn middle([a, b, c, d]: [Self; 4]) -> Self {
        let of = |a: i32, b: i32, c: i32, d: i32| ((b + c) >> 1) + ((b + c - a - d) >> 4);
        Self { x: of(a.x, b.x, c.x, d.x), y: of(a.y, b.y, c.y, d.y) }
    }
}

/// Of the cubic through values at -1, 0, 1 and 2, at every sixteenth from 0 to 1: Q30.
pub(super) const CUBIC: [[i32; 4]; 16] = {
    let mut table = [[0; 4]; 16];
    let mut t = 0;
    while t < 16 {
        // Products of three distances in sixteenths, Q12, to Q30.
        let [a, b, c] = [
            rounded(-t * (t - 16) * (t - 32), 6),
            rounded((t + 16) * (t - 16) * (t - 32), 2),
            rounded((t + 16) * t * (t - 16), 6),
        ];
        #[expect(clippy::indexing_slicing, reason = "evaluated by the compiler")]
        {
            table[t as usize] = [a, b, (1 << 30) - a - b - c, c];
        }
        t += 1;
    }
    table
};

/// The one at a quarter.
const QUARTER: [i32; 4] = CUBIC[4];

/// Most nodes along a row: a mesh is not fine above half of the largest width.
pub(super) const MOST_COLUMNS: usize = nodes_along(MAX_WIDTH, COARSE) as usize;

/// Memory for the nodes along one row.
pub(super) type Knots = [Node; MOST_COLUMNS];

/// Q12 divided, as Q30.
const fn rounded(value: i32, by: i64) -> i32 {
    let value = (value as i64) << 18;
    ((value + if value < 0 { -by / 2 } else { by / 2 }) / by) as i32
}

/// Pixels that follow each other: their raw columns by a polynomial of the second degree, their raw rows on a straight line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// Position of the first pixel, px in Q16, half a step of the kernel's fraction added.
    pub(super) x_q16: i32,
    /// From the first pixel to the second.
    pub(super) dx_q16: i32,
    /// What each step is longer than the one before.
    pub(super) ddx_q16: i32,
    /// Position of the first pixel, px in Q14.
    pub(super) y_q14: i32,
    /// From pixel to pixel.
    pub(super) dy_q14: i32,
}

impl Piece {
    #[inline]
    pub(super) fn between(from: Node, to: Node, ddx_q16: i32, shift: u8) -> Self {
        let (x_q16, y_q14) = (from.x.wrapping_add(X_ROUNDING), from.y >> 2);
        // The first step is as much shorter than the mean one as the sum of what the steps grow.
        let growth = ddx_q16.wrapping_mul(((1 << shift) - 1) << shift >> 1);
        let dx_q16 = to.x.wrapping_sub(from.x).wrapping_sub(growth) >> shift;
        Self { x_q16, dx_q16, ddx_q16, y_q14, dy_q14: ((to.y >> 2) - y_q14) >> shift }
    }

    /// The same from a later pixel on.
    #[inline]
    pub(super) fn from(self, i: i32) -> Self {
        let Self { x_q16, dx_q16, ddx_q16, y_q14, dy_q14 } = self;
        let growth = ddx_q16.wrapping_mul(i.wrapping_mul(i - 1) >> 1);
        Self {
            x_q16: x_q16.wrapping_add(dx_q16.wrapping_mul(i)).wrapping_add(growth),
            dx_q16: dx_q16.wrapping_add(ddx_q16.wrapping_mul(i)),
            y_q14: y_q14.wrapping_add(dy_q14.wrapping_mul(i)),
            ..self
        }
    }

    /// Position of a pixel of it.
    pub(super) fn at(self, i: u16) -> [i32; 2] {
        let piece = self.from(i.into());
        [piece.x_q16, piece.y_q14]
    }
}

/// Ends of two or four pieces between the inner two of four nodes.
#[inline(never)]
pub(super) fn ends_of_pieces(four: &[Node; 4], halvings: u8) -> [Option<Node>; 4] {
    let [_, _, end, _] = *four;
    let (middle, end) = (Some(Node::middle(*four)), Some(end));
    if halvings == 1 {
        return [None, middle, None, end];
    }
    let [a, b, c, d] = QUARTER;
    [Some(Node::weighted(*four, [a, b, c, d])), middle, Some(Node::weighted(*four, [d, c, b, a])), end]
}
