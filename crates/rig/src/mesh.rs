//! Raw positions of rectified pixels as a coarse mesh of integers.
//!
//! In: a [`Remap`], once. Out: raw positions along every rectified row, and the raw rows that a
//! [`Band`](crate::Band) has to hold.
//!
//! ```text
//! set-up, floating point:
//!     nodes:  raw position of every 16th pixel of every 16th row, and one more on each side; every
//!             8th, if the error of the cubic through them, by their fourth differences, is above
//!             1/64 px and the memory suffices
//!     pieces: 16, 8 or 4 consecutive pixels, their raw columns by a parabola, their raw rows by a
//!             line
//!     nodes' rows -= their second difference along the row, scaled, so that the errors of
//!         lines are centred and halved
//!     rows:   the pixels that have a source, the last raw row they need; the most raw rows that
//!             are needed at once
//! per row, integers:
//!     four rows of nodes -> one, four nodes of that -> ends of pieces: the cubic through four
//!         points, twice
//! ```
//!
//! # Cost
//! 8 bytes for a node, 6 for a row: 4.8 KiB for a camera at QVGA.

use crate::calibration::CameraSide;
use crate::grid::Grid;
use crate::kernel::X_ROUNDING;
use crate::nodes::{Knots, MOST_COLUMNS, Node, ONE, Piece, mesh_nodes};
use crate::remap::Remap;
use linestereo::image::{Dims, Span, shrink_to_valid};

/// The mesh of one camera, in the caller's memory: [`mesh_nodes`] and as many rows as the rectified
/// image has. `new` is empty, `build` fills it.
///
/// ```
/// use linestereo::Dims;
/// use linestereo_rig::{Band, Calibration, Camera, CameraSide, Lens, Mesh, View, mesh_nodes};
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
/// mesh.build(&rectification.remap(), CameraSide::Left)?;
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
    /// Last raw row needed for each row and all above it.
    last: [u16; ROWS],
}

/// Reason why a mesh cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// The memory holds too few nodes.
    #[error("the mesh needs {needed} nodes, there is memory for {given}")]
    Nodes {
        /// Nodes needed: see [`mesh_nodes`].
        needed: usize,
        /// Nodes there is memory for.
        given: usize,
    },
    /// The memory holds too few rows.
    #[error("the rectified images have {needed} rows, there is memory for {given}")]
    Rows {
        /// Rows of the rectified image.
        needed: usize,
        /// Rows there is memory for.
        given: usize,
    },
    /// No rectified pixel has a source in the raw image.
    #[error("no rectified pixel lies inside the raw image")]
    NothingSeen,
}

impl<const NODES: usize, const ROWS: usize> Default for Mesh<NODES, ROWS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const NODES: usize, const ROWS: usize> Mesh<NODES, ROWS> {
    /// Size, bytes.
    pub const BYTES: usize = size_of::<Self>();

    /// An empty mesh, with which every raw row is refused. All zero, so that a static of it takes
    /// no flash.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            grid: Grid::EMPTY,
            nodes: [Node { x: 0, y: 0 }; NODES],
            spans: [Span { start: 0, end: 0 }; ROWS],
            last: [0; ROWS],
        }
    }

    /// Computes the mesh of one camera. After an error it is empty.
    pub fn build(&mut self, remap: &Remap, eye: CameraSide) -> Result<(), MeshError> {
        self.grid = Grid::EMPTY;
        let dims = remap.dims();
        let (needed, given) = (mesh_nodes(dims), NODES);
        if given < needed {
            return Err(MeshError::Nodes { needed, given });
        }
        let (needed, given) = (usize::from(dims.height), ROWS);
        if given < needed {
            return Err(MeshError::Rows { needed, given });
        }
        let rows = self.spans.iter_mut().zip(&mut self.last).take(needed);
        self.grid = Grid::build(remap, eye, &mut self.nodes, rows).ok_or(MeshError::NothingSeen)?;
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

    /// Number of raw rows that have to be held at once.
    #[must_use]
    pub fn band_rows(&self) -> u16 {
        self.grid.band_rows
    }

    /// Size of a [`Band`](crate::Band) for this mesh, bytes.
    #[must_use]
    pub fn band_bytes(&self) -> usize {
        self.grid.band_bytes()
    }

    /// Pixels of each rectified row that have a source (the largest run of them); all others become
    /// 0. For [`Gray::with_valid`](linestereo::Gray::with_valid) after
    /// [`shrink_to_valid`](linestereo::image::shrink_to_valid).
    #[must_use]
    pub fn spans(&self) -> &[Span] {
        self.spans.get(..usize::from(self.grid.dims.height)).unwrap_or(&[])
    }

    /// Spans of valid pixels for [`Gray::with_valid`](linestereo::Gray::with_valid), in the
    /// caller's memory of as many spans as the rectified image has rows; empty when every pixel has
    /// a source.
    pub fn valid<'a>(&self, memory: &'a mut [Span]) -> &'a [Span] {
        let width = self.grid.dims.width;
        let whole = Span { start: 0, end: width };
        if self.spans().iter().all(|span| *span == whole) {
            return &[];
        }
        for (valid, span) in memory.iter_mut().zip(self.spans()) {
            *valid = *span;
        }
        let valid = memory.get_mut(..self.spans().len()).unwrap_or_default();
        shrink_to_valid(valid, width);
        valid
    }

    /// Raw position of a rectified pixel as the rows are interpolated, px in Q16; `None` outside
    /// its row's [`Mesh::spans`].
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

    /// Largest error of the positions of pixels, px: an estimate from the differences of nodes.
    #[must_use]
    #[expect(clippy::float_arithmetic, reason = "set-up")]
    pub fn error(&self) -> f32 {
        self.grid.error_q16 as f32 / ONE as f32
    }

    pub(crate) fn plan(&self) -> MeshPlan<'_> {
        MeshPlan { grid: &self.grid, nodes: &self.nodes, spans: self.spans(), last: &self.last }
    }
}

/// A mesh without its capacity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshPlan<'a> {
    pub(crate) grid: &'a Grid,
    nodes: &'a [Node],
    spans: &'a [Span],
    last: &'a [u16],
}

impl MeshPlan<'_> {
    /// Nodes along row `y`: see [`Grid::knots`].
    pub(crate) fn knots<'k>(&self, y: u16, memory: &'k mut Knots) -> &'k [Node] {
        self.grid.knots(self.nodes, y, memory)
    }

    /// The pixels of row `y` that have a source.
    pub(crate) fn span(&self, y: u16) -> Span {
        self.spans.get(usize::from(y)).copied().unwrap_or_default()
    }

    /// True when row `y` can be computed with the raw rows up to `raw`.
    pub(crate) fn suffices(&self, raw: u16, y: u16) -> bool {
        self.last.get(usize::from(y)).is_some_and(|last| *last <= raw)
    }

    /// Calls `each` with first pixel, length and positions of every piece of row `y`.
    #[inline(always)]
    pub(crate) fn for_each_piece(
        &self,
        y: u16,
        memory: &mut Knots,
        each: impl FnMut(u16, u16, Piece),
    ) {
        self.grid.pieces_between(self.grid.knots(self.nodes, y, memory), each);
    }
}
