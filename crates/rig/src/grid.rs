//! Computation and interpolation of one camera's nodes: a mesh without its memory.
//!
//! In: a remap and memory for nodes and rows. Out: pieces of each row, the pixels that have a
//! source, the last raw row each row needs. Method and bounds: [`mesh`](crate::mesh).

use crate::calibration::CameraSide;
use crate::kernel::{X_ROUNDING, columns, weigh_knots};
use crate::nodes::{
    BEHIND, COARSE, CUBIC, FARTHEST, FINE, Knots, MOST_COLUMNS, Node, ONE, Piece, ends_of_pieces,
    fine_mesh_nodes, is_behind, is_seen, node_at, nodes_along,
};
use crate::rectification::MAX_SIDE;
use crate::remap::Remap;
use linestereo::image::{Dims, Span};

/// Largest distance of a position from the outermost raw pixels, px in Q16, to count as inside:
/// 1/64 px, for the rounding of the mesh.
const TOLERANCE: i32 = ONE / 64;

/// Sizes, and parameters of interpolation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    pub(crate) dims: Dims,
    pub(crate) raw: Dims,
    pub(crate) columns: u16,
    /// Distance of nodes, log2 of px.
    pub(crate) cell: u8,
    /// Length of a piece, log2 of px.
    pub(crate) piece: u8,
    pub(crate) band_rows: u16,
    /// True when all pixels of all rows lie between four raw ones.
    pub(crate) is_inner: bool,
    pub(crate) error_q16: i32,
}

impl Grid {
    /// Size of the band, bytes: its rows, and those that the kernel may read behind the last one.
    pub(crate) fn band_bytes(&self) -> usize {
        let width = usize::from(self.raw.width);
        usize::from(self.band_rows) * width + columns(width) + 1 - width
    }

    /// A grid without rows.
    pub(crate) const EMPTY: Self = {
        const NOTHING: Dims = Dims { width: 0, height: 0 };
        let (dims, raw) = (NOTHING, NOTHING);
        let (columns, cell, piece, band_rows, error_q16) = (0, 0, 0, 0, 0);
        Self { dims, raw, columns, cell, piece, band_rows, is_inner: false, error_q16 }
    };

    /// Computes the nodes and rows of one camera; `None` when no rectified pixel has a source.
    pub(crate) fn build<'a>(
        remap: &Remap,
        eye: CameraSide,
        nodes: &mut [Node],
        rows: impl Iterator<Item = (&'a mut Span, &'a mut u16)>,
    ) -> Option<Self> {
        let mut grid = Self::with_nodes(remap, eye, COARSE, nodes);
        let mut cubic = grid.cubic_error(nodes);
        if cubic > ONE / 64
            && fine_mesh_nodes(grid.dims) <= nodes.len()
            && grid.dims.width <= MAX_SIDE / 2
        {
            grid = Self::with_nodes(remap, eye, FINE, nodes);
            cubic = grid.cubic_error(nodes);
        }
        grid.choose_pieces(nodes, cubic);
        grid.centre_pieces(nodes);
        grid.plan_rows(remap, eye, nodes, rows);
        (grid.band_rows > 0).then_some(grid)
    }

    /// Computes nodes at this distance, log2 of px.
    fn with_nodes(remap: &Remap, eye: CameraSide, cell: u8, nodes: &mut [Node]) -> Self {
        let (dims, raw) = (remap.dims(), remap.raw_dims());
        let columns = nodes_along(dims.width, cell);
        let rows = usize::from(nodes_along(dims.height, cell));
        for (row, v) in nodes.chunks_exact_mut(usize::from(columns).max(1)).take(rows).zip(-1..) {
            for (node, u) in row.iter_mut().zip(-1..) {
                let [x, y] = [u, v].map(|i: i32| (i << cell) as f32);
                *node = node_at(remap.source(eye, [x, y]));
            }
        }
        Self { dims, raw, columns, cell, piece: cell, ..Self::EMPTY }
    }

    fn node_rows<'a>(&self, nodes: &'a [Node]) -> impl Iterator<Item = &'a [Node]> + use<'a> {
        let rows = usize::from(nodes_along(self.dims.height, self.cell));
        nodes.chunks_exact(usize::from(self.columns).max(1)).take(rows)
    }

    /// True when this node is in view and at most a cell outside of the raw image.
    fn is_near(&self, node: Node) -> bool {
        let around = ONE << self.cell;
        let inside = |v: i32, side: u16| (-around..(i32::from(side) << 16) + around).contains(&v);
        is_seen(node) && inside(node.x, self.raw.width) && inside(node.y, self.raw.height)
    }

    /// Largest error of a cubic through four nodes in their middle, px in Q16: 3/128 of the fourth
    /// difference, summed over both directions.
    fn cubic_error(&self, nodes: &[Node]) -> i32 {
        let fourth = |at: [Node; 5]| {
            if !at.iter().all(|node| self.is_near(*node)) {
                return 0;
            }
            let of = |v: fn(&Node) -> i32| {
                let [a, b, c, d, e] = at.each_ref().map(|node| i64::from(v(node)));
                i32::try_from((a + e - 4 * (b + d) + 6 * c).abs()).unwrap_or(i32::MAX)
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
            let mut five = [BEHIND; 5];
            for row in self.node_rows(nodes) {
                let [_, b, c, d, e] = five;
                five = [b, c, d, e, row.get(column).copied().unwrap_or(e)];
                down = fourth(five).max(down);
            }
        }
        across.saturating_add(down) / 128 * 3
    }

    /// Second difference of raw rows, along the row, at the middle one of three nodes; limited,
    /// where a lens of wild coefficients puts nodes at both limits.
    fn bend_of_rows([a, b, c]: [Node; 3]) -> i32 {
        (a.y + c.y).saturating_sub(2 * b.y)
    }

    /// Shift from the second difference of nodes to h^2/16 times the second derivative, where h is
    /// the length of a piece.
    fn bend_shift(&self, piece: u8) -> u8 {
        4 + 2 * (self.cell - piece)
    }

    /// Chooses the longest pieces with an error of at most 1/32 px: that of rows in the middle of a
    /// piece, h^2/8 times the second derivative, half of that once centred; that of columns, at
    /// most h^3/31 times the third one; and that of cubics.
    fn choose_pieces(&mut self, nodes: &[Node], cubic: i32) {
        let (mut second, mut third) = (0, 0);
        for row in self.node_rows(nodes) {
            for four in row.windows(4).filter_map(|four| four.first_chunk::<4>()) {
                if four.iter().all(|node| self.is_near(*node)) {
                    let [a, b, c, d] = *four;
                    second = Self::bend_of_rows([a, b, c])
                        .abs()
                        .max(Self::bend_of_rows([b, c, d]).abs())
                        .max(second);
                    third = (d.x - a.x + 3 * (b.x - c.x)).abs().max(third);
                }
            }
        }
        let error = |piece: u8| {
            let columns = third >> (5 + 3 * (self.cell - piece));
            (second >> self.bend_shift(piece)).saturating_add(columns).saturating_add(cubic)
        };
        let piece = [4, 3]
            .into_iter()
            .find(|piece| *piece <= self.cell && error(*piece) <= ONE / 32)
            .unwrap_or(2);
        (self.piece, self.error_q16) = (piece, error(piece));
    }

    /// Moves the nodes against the curvature of their rows by half of the error of a line between
    /// knots in its middle.
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
                if ![a, middle, c].iter().any(|node| is_behind(*node)) {
                    moved.y -= Self::bend_of_rows([a, middle, c]) >> shift & !1;
                    moved.y = moved.y.clamp(-FARTHEST, FARTHEST);
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
        remap: &Remap,
        eye: CameraSide,
        nodes: &[Node],
        rows: impl Iterator<Item = (&'a mut Span, &'a mut u16)>,
    ) {
        let (mut last, mut is_inner) = (0, true);
        for ((row_span, row_last), y) in rows.zip(0..) {
            let span = self.longest_run(remap, eye, nodes, y);
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
    }

    /// The largest run of pixels of row `y` that have a source.
    fn longest_run(&self, remap: &Remap, eye: CameraSide, nodes: &[Node], y: u16) -> Span {
        let (mut longest, mut run) = (Span::default(), Span::default());
        self.for_each_piece(nodes, y, |start, length, piece| {
            let visibility = self.visibility(nodes, start >> self.cell, y >> self.cell);
            for (i, x) in (0..length).zip(start..) {
                let seen = match visibility {
                    Visibility::Whole => true,
                    Visibility::Part => remap
                        .source(eye, [f32::from(x), f32::from(y)])
                        .is_some_and(|(_, seen)| seen),
                    Visibility::Nothing => false,
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
        let inside =
            |v: i32, side: u16| (-TOLERANCE..=(i32::from(side) - 1) * ONE + TOLERANCE).contains(&v);
        inside(x_q16 - X_ROUNDING, self.raw.width) && inside(y_q14 << 2, self.raw.height)
    }

    /// True when a position, with the rounding of pieces, lies between four raw pixels.
    #[inline]
    pub(crate) fn is_between(&self, [x_q16, y_q14]: [i32; 2]) -> bool {
        let end = |side: u16| i32::from(side.saturating_sub(1));
        (0..end(self.raw.width) << 16).contains(&x_q16)
            && (0..end(self.raw.height) << 14).contains(&y_q14)
    }

    /// Visibility of one cell to the camera.
    fn visibility(&self, nodes: &[Node], column: u16, row: u16) -> Visibility {
        let columns = usize::from(self.columns);
        let first = usize::from(row) * columns + usize::from(column);
        let (mut seen, mut behind) = (0, false);
        for v in 0..4 {
            for u in 0..4 {
                let node = nodes.get(first + v * columns + u).copied().unwrap_or(BEHIND);
                behind |= is_behind(node);
                seen += u32::from(is_seen(node) && (1..3).contains(&u) && (1..3).contains(&v));
            }
        }
        match seen {
            _ if behind => Visibility::Nothing,
            0 => Visibility::Nothing,
            4 => Visibility::Whole,
            _ => Visibility::Part,
        }
    }

    /// Nodes along row `y`: one before the first pixel, one at the end of each cell, one more.
    #[inline]
    pub(crate) fn knots<'a>(&self, nodes: &[Node], y: u16, memory: &'a mut Knots) -> &'a [Node] {
        let columns = usize::from(self.columns);
        let first = usize::from(y >> self.cell) * columns;
        let Some(weights) = CUBIC.get(usize::from(y << (4 - self.cell) & 15)) else { return &[] };
        let row = |v: usize| {
            nodes.get(first + v * columns..).and_then(|row| row.get(..columns)).unwrap_or(&[])
        };
        weigh_knots([row(0), row(1), row(2), row(3)], *weights, memory);
        memory.get(..columns).unwrap_or(&[])
    }

    /// Calls `each` with first pixel, length and positions of every piece of row `y`.
    #[inline(always)]
    pub(crate) fn for_each_piece(&self, nodes: &[Node], y: u16, each: impl FnMut(u16, u16, Piece)) {
        let mut memory = [Node::default(); MOST_COLUMNS];
        self.pieces_between(self.knots(nodes, y, &mut memory), each);
    }

    #[inline(always)]
    pub(crate) fn pieces_between(&self, knots: &[Node], mut each: impl FnMut(u16, u16, Piece)) {
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
    pub(crate) fn pieces_of_cell(&self, four: &[Node; 4], mut each: impl FnMut(Piece)) {
        let length = self.piece & 15;
        let [before, mut from, to, behind] = *four;
        // Second derivative in the middle: the mean of those at both ends.
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

    /// True when a piece is a whole cell of the kernel's size.
    pub(crate) fn has_whole_cells(&self) -> bool {
        self.piece == COARSE
    }

    /// Number of pixels of a piece.
    pub(crate) fn length(&self) -> i32 {
        1 << (self.piece & 15)
    }
}

enum Visibility {
    Whole,
    Part,
    Nothing,
}
