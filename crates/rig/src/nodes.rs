//! Nodes of a mesh, and pieces of rows between four of them.
//!
//! In: raw positions of four nodes in a line. Out: the cubic through them, at sixteenths; pieces
//! between.
//!
//! # Bounds
//! Nodes are clamped to 8192 px, 2^29 in Q16: two of them sum to 2^30. Weights in Q30 sum to 2^30
//! and their sizes to less than 2^31: upper halves of products sum to less than 2^28, which is Q14.
//!
//! # Source
//! Lagrange's interpolation. A bilinear mesh of 16 px has an error of 0.16 px on a common lens;
//! Catmull-Rom's cubic is one order worse.

use crate::kernel::{Knot, X_ROUNDING, weigh_knots};
use crate::rectification::MAX_SIDE;
use linestereo::image::Dims;

/// Distance of nodes, log2 of px.
pub(crate) const COARSE: u8 = 4;
/// Distance of nodes of a fine mesh, log2 of px.
pub(crate) const FINE: u8 = 3;
/// Limit of positions, px: beyond any image.
const FAR: f32 = 8192.0;
/// One pixel, Q16.
pub(crate) const ONE: i32 = 1 << 16;
/// Limit of positions, px in Q16.
pub(crate) const FARTHEST: i32 = FAR as i32 * ONE;

/// Number of nodes that a [`Mesh`](crate::Mesh) needs for rectified images of this size.
#[must_use]
pub const fn mesh_nodes(dims: Dims) -> usize {
    nodes_along(dims.width, COARSE) as usize * nodes_along(dims.height, COARSE) as usize
}

/// Number of nodes with which a [`Mesh`](crate::Mesh) can halve their distance, where a lens needs
/// it: very wide ones, and images below 200 px.
#[must_use]
pub const fn fine_mesh_nodes(dims: Dims) -> usize {
    nodes_along(dims.width, FINE) as usize * nodes_along(dims.height, FINE) as usize
}

/// Number of nodes along a side: one before the first pixel, two behind the start of the last
/// pixel's cell.
pub(crate) const fn nodes_along(side: u16, cell: u8) -> u16 {
    (side.saturating_sub(1) >> cell) + 4
}

/// Raw position, px in Q16.
///
/// During set-up the last bits are flags: x: outside of the camera's view; y: behind the camera.
pub(crate) type Node = Knot;

/// Node of an empty mesh.
pub(crate) const NO_NODE: Node = Node { x: 0, y: 0 };

/// Node of a raw position, px, with a flag that is true in view of the camera; `None` is behind the
/// camera.
#[expect(clippy::float_arithmetic, reason = "set-up")]
pub(crate) fn node_at(source: Option<([f32; 2], bool)>) -> Node {
    let Some(([x, y], seen)) = source else { return BEHIND };
    let nearest = |v: f32| (v.clamp(-FAR, FAR) * ONE as f32) as i32 & !1;
    Node { x: nearest(x) | i32::from(!seen), y: nearest(y) }
}

/// Node behind the camera.
pub(crate) const BEHIND: Node = Node { x: 1, y: 1 };

pub(crate) fn is_seen(node: Node) -> bool {
    node.x & 1 == 0
}

pub(crate) fn is_behind(node: Node) -> bool {
    node.y & 1 == 1
}

fn weighted(nodes: [Node; 4], weights: [i32; 4]) -> Node {
    let mut sum = [NO_NODE];
    let [a, b, c, d] = &nodes;
    weigh_knots([a, b, c, d].map(core::slice::from_ref), weights, &mut sum);
    let [sum] = sum;
    sum
}

/// Node in the middle of the inner two of four: (-1, 9, 9, -1) / 16.
#[inline]
fn middle([a, b, c, d]: [Node; 4]) -> Node {
    let of = |a: i32, b: i32, c: i32, d: i32| ((b + c) >> 1) + ((b + c - a - d) >> 4);
    Node { x: of(a.x, b.x, c.x, d.x), y: of(a.y, b.y, c.y, d.y) }
}

/// Weights, Q30, of the cubic through values at -1, 0, 1 and 2, at every sixteenth from 0 to 1.
pub(crate) const CUBIC: [[i32; 4]; 16] = {
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

/// Weights of [`CUBIC`] at a quarter.
const QUARTER: [i32; 4] = CUBIC[4];

/// Most nodes along a row: a mesh is not fine above half of the largest width.
pub(crate) const MOST_COLUMNS: usize = nodes_along(MAX_SIDE, COARSE) as usize;

/// Memory for the nodes along one row.
pub(crate) type Knots = [Node; MOST_COLUMNS];

/// A Q12 value divided by `by`, rounded, Q30.
const fn rounded(value: i32, by: i64) -> i32 {
    let value = (value as i64) << 18;
    ((value + if value < 0 { -by / 2 } else { by / 2 }) / by) as i32
}

/// Consecutive pixels: their raw columns by a polynomial of the second degree, their raw rows on a
/// straight line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// Raw column of the first pixel, px in Q16, plus half a step of the kernel's fraction.
    pub(crate) x_q16: i32,
    /// Step from the first pixel to the second, px in Q16.
    pub(crate) dx_q16: i32,
    /// Change from each step to the next, px in Q16.
    pub(crate) ddx_q16: i32,
    /// Raw row of the first pixel, px in Q14.
    pub(crate) y_q14: i32,
    /// Step from pixel to pixel, px in Q14.
    pub(crate) dy_q14: i32,
}

impl Piece {
    #[inline]
    pub(crate) fn between(from: Node, to: Node, ddx_q16: i32, shift: u8) -> Self {
        let (x_q16, y_q14) = (from.x.wrapping_add(X_ROUNDING), from.y >> 2);
        // First step: the mean one minus the mean growth of the steps.
        let growth = ddx_q16.wrapping_mul(((1 << shift) - 1) << shift >> 1);
        let dx_q16 = to.x.wrapping_sub(from.x).wrapping_sub(growth) >> shift;
        Self { x_q16, dx_q16, ddx_q16, y_q14, dy_q14: ((to.y >> 2) - y_q14) >> shift }
    }

    /// The piece from pixel `i` on.
    #[inline]
    pub(crate) fn from(self, i: i32) -> Self {
        let Self { x_q16, dx_q16, ddx_q16, y_q14, dy_q14 } = self;
        let growth = ddx_q16.wrapping_mul(i.wrapping_mul(i - 1) >> 1);
        Self {
            x_q16: x_q16.wrapping_add(dx_q16.wrapping_mul(i)).wrapping_add(growth),
            dx_q16: dx_q16.wrapping_add(ddx_q16.wrapping_mul(i)),
            y_q14: y_q14.wrapping_add(dy_q14.wrapping_mul(i)),
            ..self
        }
    }

    /// Raw position of pixel `i`: column in Q16, row in Q14.
    pub(crate) fn at(self, i: u16) -> [i32; 2] {
        let piece = self.from(i.into());
        [piece.x_q16, piece.y_q14]
    }
}

/// Ends of two or four pieces between the inner two of four nodes.
#[inline(never)]
pub(crate) fn ends_of_pieces(four: &[Node; 4], halvings: u8) -> [Option<Node>; 4] {
    let [_, _, end, _] = *four;
    let (middle, end) = (Some(middle(*four)), Some(end));
    if halvings == 1 {
        return [None, middle, None, end];
    }
    let [a, b, c, d] = QUARTER;
    [Some(weighted(*four, [a, b, c, d])), middle, Some(weighted(*four, [d, c, b, a])), end]
}
