//! Where each rectified pixel comes from, as a coarse mesh of integers.
//!
//! In: a [`Rectification`], once. Out: raw positions along every rectified row, and what a [`Band`](super::Band) has to hold for it.
//!
//! ```text
//! set-up, floating point:
//!     nodes:  raw position of every 16th pixel of every 16th row, and one more on each side; every 8th, if the cubic through those would
//!             err by more than 1/64 px by their fourth differences, and the memory is given
//!     pieces: how many pixels may be joined: 16, 8 or 4, their raw columns by a parabola, their raw rows by a line
//!     nodes' rows -= their second difference along the row, scaled, so that lines err to both sides equally and half as much
//!     rows:   the pixels that have a source, the last raw row they need; the most raw rows that are needed at once
//! per row, integers:
//!     four rows of nodes -> one, four nodes of that -> ends of pieces: the cubic through four points, twice
//! ```
//!
//! # Bounds
//! Nodes are clamped to 8192 px, 2^29 in Q16: two of them sum to 2^30. Weights in Q30 sum to 2^30 and their sizes to less than 2^31: upper
//! halves of products sum to less than 2^28, which is Q14.
//!
//! # Cost
//! 8 bytes for a node, 6 for a row: 4.8 KiB for a camera at QVGA.
//!
//! # Source
//! Lagrange's interpolation. A bilinear mesh of 16 px errs by 0.16 px on a common lens, Catmull-Rom's cubic is one order worse.

use super::calibration::Eye;
use super::rectification::Rectification;
use crate::image::{Dims, MAX_WIDTH, Span, shrink_to_usable};
use crate::kernel::{Knot, X_ROUNDING, columns, weigh_knots};
use core::fmt;

/// log2 of the distance of nodes in pixels.
const COARSE: u8 = 4;
/// The same of a fine mesh.
const FINE: u8 = 3;
/// Positions further outside are not told apart: they are outside of any image.
const FAR: f64 = 8192.0;
/// One pixel.
pub(super) const ONE: i32 = 1 << 16;
/// How far outside the outermost raw pixels a position may lie and counts as there: 1/64 px, for what the mesh rounds.
const TOLERANCE: i32 = ONE / 64;

/// Nodes that a [`Mesh`] needs for rectified images of this size.
#[must_use]
pub const fn mesh_nodes(dims: Dims) -> usize {
    nodes_along(dims.width, COARSE) as usize * nodes_along(dims.height, COARSE) as usize
}

/// Nodes with which a [`Mesh`] can halve their distance, where a lens asks for it: very wide ones, and images below 200 px.
#[must_use]
pub const fn fine_mesh_nodes(dims: Dims) -> usize {
    nodes_along(dims.width, FINE) as usize * nodes_along(dims.height, FINE) as usize
}

/// One before the first pixel, and two from the last one's cell on.
const fn nodes_along(side: u16, cell: u8) -> u16 {
    (side.saturating_sub(1) >> cell) + 4
}

/// Raw position, px in Q16.
///
/// The last bits hold, until the rows are known: x: the camera cannot see this; y: it is behind the camera.
pub(super) type Node = Knot;

impl Node {
    pub(super) const ZERO: Self = Self { x: 0, y: 0 };

    #[expect(clippy::float_arithmetic, reason = "set-up")]
    fn new(source: Option<([f64; 2], bool)>) -> Self {
        let Some(([x, y], seen)) = source else { return Self { x: 1, y: 1 } };
        let nearest = |v: f64| (v.clamp(-FAR, FAR) * f64::from(ONE)) as i32 & !1;
        Self { x: nearest(x) | i32::from(!seen), y: nearest(y) }
    }

    fn is_seen(self) -> bool {
        self.x & 1 == 0
    }

    fn is_behind(self) -> bool {
        self.y & 1 == 1
    }

    fn weighted(nodes: [Self; 4], weights: [i32; 4]) -> Self {
        let mut sum = [Self::ZERO];
        let [a, b, c, d] = &nodes;
        weigh_knots([a, b, c, d].map(core::slice::from_ref), weights, &mut sum);
        let [sum] = sum;
        sum
    }

    /// Of four nodes, in the middle of the inner two: (-1, 9, 9, -1) / 16.
    #[inline]
    fn middle([a, b, c, d]: [Self; 4]) -> Self {
        let of = |a: i32, b: i32, c: i32, d: i32| ((b + c) >> 1) + ((b + c - a - d) >> 4);
        Self { x: of(a.x, b.x, c.x, d.x), y: of(a.y, b.y, c.y, d.y) }
    }
}

/// Of the cubic through values at -1, 0, 1 and 2, at every sixteenth from 0 to 1: Q30.
const CUBIC: [[i32; 4]; 16] = {
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
const MOST_COLUMNS: usize = nodes_along(MAX_WIDTH, COARSE) as usize;

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
    fn between(from: Node, to: Node, ddx_q16: i32, shift: u8) -> Self {
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

/// Sizes, and how the nodes are to be joined.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) dims: Dims,
    pub(super) raw: Dims,
    columns: u16,
    /// log2 of the distance of nodes in pixels.
    cell: u8,
    /// log2 of the pixels of a piece.
    piece: u8,
    pub(super) band_rows: u16,
    /// Do all pixels of all rows lie between four raw ones?
    pub(super) is_inner: bool,
    error_q16: i32,
}

/// The mesh of one camera, in the caller's memory: [`mesh_nodes`] and as many rows as the rectified image has. `new` is empty, `build`
/// fills it.
///
/// ```
/// use linestereo::{Band, Calibration, Camera, Dims, Eye, Lens, Mesh, View, mesh_nodes};
///
/// const DIMS: Dims = Dims { width: 64, height: 48 };
/// let lens = Lens::BrownConrady { k: [-0.2, 0.0, 0.0], p: [0.0; 2] };
/// let camera = Camera::new(DIMS, [60.0, 60.0], [31.5, 23.5], 0.0, lens)?;
/// let rig = Calibration::new(camera, camera, [1.0, 0.0, 0.0, 0.0], [-0.06, 0.0, 0.0])?;
/// let rectification = rig.rectify(DIMS, View::default())?;
///
/// // In statics on a board.
/// let mut mesh: Mesh<{ mesh_nodes(DIMS) }, { DIMS.height as usize }> = Mesh::new();
/// let mut band: Band<{ 64 * 12 }> = Band::new();
/// let mut frame = [0; 64 * 48];
///
/// mesh.build(&rectification, Eye::Left)?;
/// assert!(mesh.band_bytes() <= 64 * 12);
/// for _ in 0..DIMS.height {
///     let raw_row = [100; 64]; // as the camera delivers it
///     let finished = band.push(&mesh, &raw_row, &mut frame)?;
///     assert!(finished.end <= DIMS.height);
/// }
/// assert!(band.is_complete(&mesh) && frame == [100; 64 * 48]);
/// band.restart(); // for the next frame
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Mesh<const NODES: usize, const ROWS: usize> {
    grid: Grid,
    nodes: [Node; NODES],
    spans: [Span; ROWS],
    /// Per row: the raw row with which it, and all above, can be computed.
    last: [u16; ROWS],
}

/// Why a mesh cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshError {
    /// The memory holds too few nodes.
    Nodes {
        /// Nodes needed: see [`mesh_nodes`].
        needed: usize,
        /// Nodes there is memory for.
        given: usize,
    },
    /// The memory holds too few rows.
    Rows {
        /// Rows of the rectified image.
        needed: usize,
        /// Rows there is memory for.
        given: usize,
    },
    /// No rectified pixel has a source in the raw image.
    NothingSeen,
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Nodes { needed, given } => write!(f, "the mesh needs {needed} nodes, there is memory for {given}"),
            Self::Rows { needed, given } => {
                write!(f, "the rectified images have {needed} rows, there is memory for {given}")
            }
            Self::NothingSeen => write!(f, "no rectified pixel lies inside the raw image"),
        }
    }
}

impl core::error::Error for MeshError {}

impl<const NODES: usize, const ROWS: usize> Default for Mesh<NODES, ROWS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const NODES: usize, const ROWS: usize> Mesh<NODES, ROWS> {
    /// Bytes of memory.
    pub const BYTES: usize = size_of::<Self>();

    /// Without nodes: every raw row is refused. All zero, so that a static of it takes no flash.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            grid: Grid::EMPTY,
            nodes: [Node { x: 0, y: 0 }; NODES],
            spans: [Span { start: 0, end: 0 }; ROWS],
            last: [0; ROWS],
        }
    }

    /// Fills it for one camera. After an error it is empty.
    pub fn build(&mut self, rectification: &Rectification, eye: Eye) -> Result<(), MeshError> {
        self.grid = Grid::EMPTY;
        let dims = rectification.dims();
        let (needed, given) = (mesh_nodes(dims), NODES);
        if given < needed {
            return Err(MeshError::Nodes { needed, given });
        }
        let (needed, given) = (usize::from(dims.height), ROWS);
        if given < needed {
            return Err(MeshError::Rows { needed, given });
        }
        let rows = self.spans.iter_mut().zip(&mut self.last).take(needed);
        self.grid = Grid::build(rectification, eye, &mut self.nodes, rows)?;
        Ok(())
    }

    /// Size of the rectified images.
    #[must_use]
    pub fn dims(&self) -> Dims {
        self.grid.dims
    }

    /// Size of the raw images.
    #[must_use]
    pub fn raw_dims(&self) -> Dims {
        self.grid.raw
    }

    /// Raw rows that have to be held at once.
    #[must_use]
    pub fn band_rows(&self) -> u16 {
        self.grid.band_rows
    }

    /// Bytes that a [`Band`](super::Band) for this mesh needs.
    #[must_use]
    pub fn band_bytes(&self) -> usize {
        self.grid.band_bytes()
    }

    /// Of each rectified row the pixels that have a source (the largest run of them); all others are written 0. For
    /// [`Gray::with_usable`](crate::Gray::with_usable) after [`shrink_to_usable`](crate::shrink_to_usable).
    #[must_use]
    pub fn spans(&self) -> &[Span] {
        self.spans.get(..usize::from(self.grid.dims.height)).unwrap_or(&[])
    }

    /// Spans of usable pixels for [`Gray::with_usable`](crate::Gray::with_usable), in the caller's memory of as many spans as the rectified
    /// image has rows; none when every pixel has a source.
    pub fn usable<'a>(&self, memory: &'a mut [Span]) -> &'a [Span] {
        let width = self.grid.dims.width;
        let whole = Span { start: 0, end: width };
        if self.spans().iter().all(|span| *span == whole) {
            return &[];
        }
        for (usable, span) in memory.iter_mut().zip(self.spans()) {
            *usable = *span;
        }
        let usable = memory.get_mut(..self.spans().len()).unwrap_or_default();
        shrink_to_usable(usable, width);
        usable
    }

    /// Raw position of a rectified pixel as the rows are interpolated, px in Q16; `None` outside its row's [`Mesh::spans`].
    #[must_use]
    pub fn source(&self, x: u16, y: u16) -> Option<[i32; 2]> {
        let plan = self.plan();
        if !self.spans().get(usize::from(y))?.contains(x.into()) {
            return None;
        }
        let mut found = None;
        plan.for_each_piece(y, &mut [Node::default(); MOST_COLUMNS], |start, length, piece| {
            if let Some(i) = x.checked_sub(start).filter(|i| *i < length) {
                let [x_q16, y_q14] = piece.at(i);
                found = Some([x_q16.wrapping_sub(X_ROUNDING), y_q14 << 2]);
            }
        });
        found
    }

    /// How far the positions of pixels are off at most, px: an estimate from the differences of nodes.
    #[must_use]
    #[expect(clippy::float_arithmetic, reason = "set-up")]
    pub fn error(&self) -> f64 {
        f64::from(self.grid.error_q16) / f64::from(ONE)
    }

    pub(super) fn plan(&self) -> MeshPlan<'_> {
        MeshPlan { grid: &self.grid, nodes: &self.nodes, spans: self.spans(), last: &self.last }
    }
}

/// A mesh, whatever its capacity.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshPlan<'a> {
    pub(super) grid: &'a Grid,
    nodes: &'a [Node],
    spans: &'a [Span],
    last: &'a [u16],
}

impl MeshPlan<'_> {
    /// Nodes along row `y`: see [`Grid::knots`].
    pub(super) fn knots<'k>(&self, y: u16, memory: &'k mut Knots) -> &'k [Node] {
        self.grid.knots(self.nodes, y, memory)
    }

    /// The pixels of row `y` that have a source.
    pub(super) fn span(&self, y: u16) -> Span {
        self.spans.get(usize::from(y)).copied().unwrap_or_default()
    }

    /// Is raw row `raw` enough to compute row `y`?
    pub(super) fn suffices(&self, raw: u16, y: u16) -> bool {
        self.last.get(usize::from(y)).is_some_and(|last| *last <= raw)
    }

    /// Calls `each` with first pixel, length and positions of every piece of row `y`.
    #[inline(always)]
    pub(super) fn for_each_piece(&self, y: u16, memory: &mut Knots, each: impl FnMut(u16, u16, Piece)) {
        self.grid.pieces_between(self.grid.knots(self.nodes, y, memory), each);
    }
}

impl Grid {
    /// The rows, and what the kernel may read behind the last one.
    pub(super) fn band_bytes(&self) -> usize {
        let width = usize::from(self.raw.width);
        usize::from(self.band_rows) * width + columns(width) + 1 - width
    }

    /// Of no rows.
    const EMPTY: Self = {
        const NOTHING: Dims = Dims { width: 0, height: 0 };
        let (columns, band_rows, error_q16) = (0, 0, 0);
        Self { dims: NOTHING, raw: NOTHING, columns, cell: 0, piece: 0, band_rows, is_inner: false, error_q16 }
    };

    fn build<'a>(
        rectification: &Rectification,
        eye: Eye,
        nodes: &mut [Node],
        rows: impl Iterator<Item = (&'a mut Span, &'a mut u16)>,
    ) -> Result<Self, MeshError> {
        let mut grid = Self::placed(rectification, eye, COARSE, nodes);
        let mut cubic = grid.cubic_error(nodes);
        if cubic > ONE / 64 && fine_mesh_nodes(grid.dims) <= nodes.len() && grid.dims.width <= MAX_WIDTH / 2 {
            grid = Self::placed(rectification, eye, FINE, nodes);
            cubic = grid.cubic_error(nodes);
        }
        grid.choose_pieces(nodes, cubic);
        grid.centre_pieces(nodes);
        grid.plan_rows(rectification, eye, nodes, rows)?;
        Ok(grid)
    }

    /// Nodes at a distance.
    fn placed(rectification: &Rectification, eye: Eye, cell: u8, nodes: &mut [Node]) -> Self {
        let (dims, raw) = (rectification.dims(), rectification.camera(eye).dims());
        let columns = nodes_along(dims.width, cell);
        let rows = usize::from(nodes_along(dims.height, cell));
        for (row, v) in nodes.chunks_exact_mut(usize::from(columns).max(1)).take(rows).zip(-1..) {
            for (node, u) in row.iter_mut().zip(-1..) {
                let [x, y] = [u, v].map(|i: i32| f64::from(i << cell));
                *node = Node::new(rectification.extended_source(eye, [x, y]));
            }
        }
        Self { dims, raw, columns, cell, piece: cell, band_rows: 0, is_inner: false, error_q16: 0 }
    }

    /// The rows of nodes.
    fn node_rows<'a>(&self, nodes: &'a [Node]) -> impl Iterator<Item = &'a [Node]> + use<'a> {
        let rows = usize::from(nodes_along(self.dims.height, self.cell));
        nodes.chunks_exact(usize::from(self.columns).max(1)).take(rows)
    }

    /// Is this node one of a pixel that is seen, or next to one?
    fn is_near(&self, node: Node) -> bool {
        let around = ONE << self.cell;
        let inside = |v: i32, side: u16| (-around..(i32::from(side) << 16) + around).contains(&v);
        node.is_seen() && inside(node.x, self.raw.width) && inside(node.y, self.raw.height)
    }

    /// What a cubic through four nodes errs in their middle at most, 3/128 of the fourth difference, summed over both directions.
    fn cubic_error(&self, nodes: &[Node]) -> i32 {
        let fourth = |at: [Node; 5]| {
            if !at.iter().all(|node| self.is_near(*node)) {
                return 0;
            }
            let of = |v: fn(&Node) -> i32| {
                let [a, b, c, d, e] = at.each_ref().map(v);
                (a + e - 4 * (b + d) + 6 * c).abs()
            };
            of(|node| node.x).max(of(|node| node.y))
        };
        let (mut across, mut down) = (0, 0);
        for row in self.node_rows(nodes) {
            for five in row.windows(5).filter_map(|five| five.first_chunk()) {
                across = fourth(*five).max(across);
            }
        }
        for column in 0..usize::from(self.columns) {
            let mut five = [Node { x: 1, y: 1 }; 5];
            for row in self.node_rows(nodes) {
                let [_, b, c, d, e] = five;
                five = [b, c, d, e, row.get(column).copied().unwrap_or(e)];
                down = fourth(five).max(down);
            }
        }
        across.saturating_add(down) / 128 * 3
    }

    /// Second difference of raw rows, along the row, at the middle one of three nodes.
    fn bend_of_rows([a, b, c]: [Node; 3]) -> i32 {
        a.y - 2 * b.y + c.y
    }

    /// Binary digits between the second difference of nodes and h^2/16 times the second derivative, where h is the length of a piece.
    fn bend_shift(&self, piece: u8) -> u8 {
        4 + 2 * (self.cell - piece)
    }

    /// The longest pieces with which no pixel is off by more than 1/32 px: rows err by h^2/8 times the second derivative in the middle of a
    /// piece, half of that once centred; columns by h^3/31 times the third one at most; and cubics err as well.
    fn choose_pieces(&mut self, nodes: &[Node], cubic: i32) {
        let (mut second, mut third) = (0, 0);
        for row in self.node_rows(nodes) {
            for four in row.windows(4).filter_map(|four| four.first_chunk::<4>()) {
                if four.iter().all(|node| self.is_near(*node)) {
                    let [a, b, c, d] = *four;
                    second = Self::bend_of_rows([a, b, c]).abs().max(Self::bend_of_rows([b, c, d]).abs()).max(second);
                    third = (d.x - a.x + 3 * (b.x - c.x)).abs().max(third);
                }
            }
        }
        let error = |piece: u8| {
            let columns = third >> (5 + 3 * (self.cell - piece));
            (second >> self.bend_shift(piece)).saturating_add(columns).saturating_add(cubic)
        };
        let piece = [4, 3].into_iter().find(|piece| *piece <= self.cell && error(*piece) <= ONE / 32).unwrap_or(2);
        (self.piece, self.error_q16) = (piece, error(piece));
    }

    /// Moves the nodes against the bend of their rows by half of what a line between knots errs in its middle.
    fn centre_pieces(&self, nodes: &mut [Node]) {
        let shift = self.bend_shift(self.piece);
        let rows = usize::from(nodes_along(self.dims.height, self.cell));
        for row in nodes.chunks_exact_mut(usize::from(self.columns).max(1)).take(rows) {
            let mut before: Option<Node> = None;
            let mut at = 0;
            while let Some(three) = row.get(at..).and_then(|row| row.first_chunk::<3>()).copied() {
                let [a, middle, c] = three;
                let a = before.unwrap_or(a);
                let mut moved = middle;
                if ![a, middle, c].iter().any(|node| node.is_behind()) {
                    moved.y -= Self::bend_of_rows([a, middle, c]) >> shift & !1;
                }
                if let Some(node) = row.get_mut(at + 1) {
                    *node = moved;
                }
                before = Some(middle);
                at += 1;
            }
        }
    }

    /// Spans, last raw rows, and the height of the band.
    fn plan_rows<'a>(
        &mut self,
        rectification: &Rectification,
        eye: Eye,
        nodes: &[Node],
        rows: impl Iterator<Item = (&'a mut Span, &'a mut u16)>,
    ) -> Result<(), MeshError> {
        let (mut last, mut is_inner) = (0, true);
        for ((row_span, row_last), y) in rows.zip(0..) {
            let span = self.longest_run(rectification, eye, nodes, y);
            let (mut low, mut high) = (i32::MAX, 0);
            self.for_each_piece(nodes, y, |start, length, piece| {
                for i in (0..length).filter(|i| span.contains(i32::from(start + i))) {
                    let [_, y_q14] = piece.at(i);
                    is_inner &= self.is_between(piece.at(i));
                    let row = (y_q14 >> 14).min(i32::from(self.raw.height) - 2).max(0);
                    (low, high) = (low.min(row), high.max(row + 1));
                }
            });
            last = last.max(high as u16);
            (*row_span, *row_last) = (span, last);
            if span.start != span.end {
                self.band_rows = self.band_rows.max(last + 1 - low as u16);
            }
        }
        self.is_inner = is_inner;
        if self.band_rows == 0 { Err(MeshError::NothingSeen) } else { Ok(()) }
    }

    /// The largest run of pixels of row `y` that have a source.
    fn longest_run(&self, rectification: &Rectification, eye: Eye, nodes: &[Node], y: u16) -> Span {
        let (mut longest, mut run) = (Span::default(), Span::default());
        self.for_each_piece(nodes, y, |start, length, piece| {
            let sight = self.sight(nodes, start >> self.cell, y >> self.cell);
            for (i, x) in (0..length).zip(start..) {
                let seen = match sight {
                    Sight::Whole => true,
                    Sight::Part => rectification.source(eye, [f64::from(x), f64::from(y)]).is_some(),
                    Sight::Nothing => false,
                };
                if !(seen && self.is_inside(piece.at(i))) {
                    continue;
                }
                if run.end == x {
                    run.end = x + 1;
                } else {
                    run = Span { start: x, end: x + 1 };
                }
                if run.end - run.start > longest.end - longest.start {
                    longest = run;
                }
            }
        });
        longest
    }

    fn is_inside(&self, [x_q16, y_q14]: [i32; 2]) -> bool {
        let inside = |v: i32, side: u16| (-TOLERANCE..=(i32::from(side) - 1) * ONE + TOLERANCE).contains(&v);
        inside(x_q16 - X_ROUNDING, self.raw.width) && inside(y_q14 << 2, self.raw.height)
    }

    /// Does a position, with the rounding of pieces, lie between four raw pixels?
    #[inline]
    pub(super) fn is_between(&self, [x_q16, y_q14]: [i32; 2]) -> bool {
        let end = |side: u16| i32::from(side.saturating_sub(1));
        (0..end(self.raw.width) << 16).contains(&x_q16) && (0..end(self.raw.height) << 14).contains(&y_q14)
    }

    /// What the camera sees of one cell.
    fn sight(&self, nodes: &[Node], column: u16, row: u16) -> Sight {
        let columns = usize::from(self.columns);
        let first = usize::from(row) * columns + usize::from(column);
        let (mut seen, mut behind) = (0, false);
        for v in 0..4 {
            for u in 0..4 {
                let node = nodes.get(first + v * columns + u).copied().unwrap_or(Node { x: 1, y: 1 });
                behind |= node.is_behind();
                seen += u32::from(node.is_seen() && (1..3).contains(&u) && (1..3).contains(&v));
            }
        }
        match seen {
            _ if behind => Sight::Nothing,
            0 => Sight::Nothing,
            4 => Sight::Whole,
            _ => Sight::Part,
        }
    }

    /// Nodes along row `y`: one before the first pixel, one at the end of each cell, one more.
    #[inline]
    pub(super) fn knots<'a>(&self, nodes: &[Node], y: u16, memory: &'a mut Knots) -> &'a [Node] {
        let columns = usize::from(self.columns);
        let first = usize::from(y >> self.cell) * columns;
        let Some(weights) = CUBIC.get(usize::from(y << (4 - self.cell) & 15)) else { return &[] };
        let row = |v: usize| nodes.get(first + v * columns..).and_then(|row| row.get(..columns)).unwrap_or(&[]);
        weigh_knots([row(0), row(1), row(2), row(3)], *weights, memory);
        memory.get(..columns).unwrap_or(&[])
    }

    /// Calls `each` with first pixel, length and positions of every piece of row `y`.
    #[inline(always)]
    fn for_each_piece(&self, nodes: &[Node], y: u16, each: impl FnMut(u16, u16, Piece)) {
        let mut memory = [Node::default(); MOST_COLUMNS];
        self.pieces_between(self.knots(nodes, y, &mut memory), each);
    }

    #[inline(always)]
    fn pieces_between(&self, knots: &[Node], mut each: impl FnMut(u16, u16, Piece)) {
        let mut start = 0;
        for four in knots.windows(4).filter_map(|four| four.first_chunk::<4>()) {
            self.pieces_of_cell(four, |piece| {
                let left = self.dims.width.saturating_sub(start);
                if left > 0 {
                    each(start, left.min(1 << (self.piece & 15)), piece);
                }
                start = start.wrapping_add(1 << (self.piece & 15));
            });
        }
    }

    /// The pieces between the inner two of four nodes.
    #[inline(always)]
    pub(super) fn pieces_of_cell(&self, four: &[Node; 4], mut each: impl FnMut(Piece)) {
        let length = self.piece & 15;
        let [before, mut from, to, behind] = *four;
        // The second derivative in the middle: the mean of those at both ends.
        let bend = before.x.wrapping_sub(from.x).wrapping_sub(to.x).wrapping_add(behind.x);
        let ddx_q16 = bend >> ((2 * self.cell + 1) & 31);
        if self.cell == self.piece {
            return each(Piece::between(from, to, ddx_q16, length));
        }
        for end in ends_of_pieces(four, self.cell - self.piece).into_iter().flatten() {
            each(Piece::between(from, end, ddx_q16, length));
            from = end;
        }
    }

    /// Is a piece a whole cell of the kernel's size?
    pub(super) fn has_whole_cells(&self) -> bool {
        self.piece == COARSE
    }

    /// Pixels of a piece.
    pub(super) fn length(&self) -> i32 {
        1 << (self.piece & 15)
    }
}

/// Ends of two or four pieces between the inner two of four nodes.
#[inline(never)]
fn ends_of_pieces(four: &[Node; 4], halvings: u8) -> [Option<Node>; 4] {
    let [_, _, end, _] = *four;
    let (middle, end) = (Some(Node::middle(*four)), Some(end));
    if halvings == 1 {
        return [None, middle, None, end];
    }
    let [a, b, c, d] = QUARTER;
    [Some(Node::weighted(*four, [a, b, c, d])), middle, Some(Node::weighted(*four, [d, c, b, a])), end]
}

/// What a camera sees of a cell.
enum Sight {
    Whole,
    Part,
    Nothing,
}
