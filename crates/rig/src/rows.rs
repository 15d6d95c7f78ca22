//! Rectification row by row: raw rows -> rectified rows.
//!
//! In: raw rows in the order of the camera. Out: rectified rows, in order, each as soon as the last
//! raw row that it needs is given.
//!
//! ```text
//! push(raw row):
//!     store it in the band, a ring of as many raw rows as any rectified row needs at once,
//!         over the oldest
//!     for each rectified row that can be computed now:
//!         for each piece of it (see Mesh):
//!             split where the raw row changes; bilinear_runs
//!             at the border of the raw image pixel by pixel, positions clamped
//! ```
//!
//! # Bounds
//! See [`bilinear`].

use crate::kernel::{Ring, Run, bilinear, bilinear_cells, bilinear_runs};
use crate::mesh::{Mesh, MeshPlan};
use crate::nodes::{Knots, NO_NODE, Node, Piece};
use core::ops::Range;

/// Raw rows of one camera, in the caller's memory; [`Mesh::band_bytes`] are needed.
#[derive(Clone, Debug)]
pub struct Band<const BYTES: usize> {
    bytes: Bytes<BYTES>,
    progress: Progress,
    work: Work,
}

/// Bytes aligned to 4, so that rows are copied by words.
#[derive(Clone, Debug)]
#[repr(align(4))]
struct Bytes<const BYTES: usize>([u8; BYTES]);

/// Working memory for a row.
#[derive(Clone, Debug)]
struct Work {
    knots: Knots,
    runs: [Run; RUNS],
}

/// Largest number of runs interpolated at once.
const RUNS: usize = 48;
/// Most runs of a cell of the mesh: one for each pixel.
const MOST_OF_CELL: usize = 16;

/// Progress in a frame.
#[derive(Clone, Copy, Debug, Default)]
struct Progress {
    /// Next raw row.
    raw: u16,
    /// Next rectified row.
    row: u16,
}

/// Reason why a raw row is refused. The progress in the frame does not change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RowError {
    /// The mesh is empty: build it first.
    #[error("no mesh has been built")]
    NoMesh,
    /// The band's memory is too small for this mesh.
    #[error("the band needs {needed} bytes, there are {given}")]
    Band {
        /// Bytes needed: [`Mesh::band_bytes`].
        needed: usize,
        /// Bytes given.
        given: usize,
    },
    /// The raw row does not have the width of the mesh's raw images.
    #[error("a raw row has {needed} px, {given} were given")]
    Width {
        /// Pixels of a raw row.
        needed: u16,
        /// Pixels given.
        given: usize,
    },
    /// All raw rows of this frame have been given: restart for the next one.
    #[error("the frame is complete: restart before the next one")]
    TooMany,
    /// The memory for the rectified frame is too small.
    #[error("the rectified frame needs {needed} bytes, there are {given}")]
    Frame {
        /// Bytes needed: width times height.
        needed: usize,
        /// Bytes given.
        given: usize,
    },
}

impl<const BYTES: usize> Default for Band<BYTES> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const BYTES: usize> Band<BYTES> {
    /// An empty band.
    #[must_use]
    pub const fn new() -> Self {
        const NOTHING: Run = Run {
            top: 0,
            bottom: 0,
            x_q16: 0,
            dx_q16: 0,
            ddx_q16: 0,
            fy_q14: 0,
            dfy_q14: 0,
            length: 0,
        };
        let work = Work { knots: [NO_NODE; _], runs: [NOTHING; RUNS] };
        Self { bytes: Bytes([0; BYTES]), progress: Progress { raw: 0, row: 0 }, work }
    }

    /// Starts a new frame: the next raw row is its first.
    pub fn restart(&mut self) {
        self.progress = Progress::default();
    }

    /// Stores the next raw row, writes the rectified rows that can be computed now to `frame`
    /// (row-major, as wide as the rectified image), and returns their range. Pixels outside a row's
    /// [`Mesh::spans`] become 0.
    pub fn push<const NODES: usize, const ROWS: usize>(
        &mut self,
        mesh: &Mesh<NODES, ROWS>,
        raw_row: &[u8],
        frame: &mut [u8],
    ) -> Result<Range<u16>, RowError> {
        self.progress.push(&mesh.plan(), &mut self.bytes.0, &mut self.work, raw_row, frame)
    }

    /// True when every row of the rectified frame is written.
    #[must_use]
    pub fn is_complete<const NODES: usize, const ROWS: usize>(
        &self,
        mesh: &Mesh<NODES, ROWS>,
    ) -> bool {
        self.progress.row >= mesh.dims().height
    }

    /// Number of raw rows of this frame given so far.
    #[must_use]
    pub fn raw_rows(&self) -> u16 {
        self.progress.raw
    }
}

impl Progress {
    #[inline(never)]
    fn push(
        &mut self,
        mesh: &MeshPlan<'_>,
        bytes: &mut [u8],
        work: &mut Work,
        raw_row: &[u8],
        frame: &mut [u8],
    ) -> Result<Range<u16>, RowError> {
        let (raw, dims) = (mesh.grid.raw, mesh.grid.dims);
        let (width, given) = (usize::from(raw.width), bytes.len());
        if mesh.grid.band_rows == 0 {
            return Err(RowError::NoMesh);
        }
        let needed = mesh.grid.band_bytes();
        let Some(bytes) = bytes.get_mut(..needed) else {
            return Err(RowError::Band { needed, given });
        };
        if raw_row.len() != width {
            return Err(RowError::Width { needed: raw.width, given: raw_row.len() });
        }
        let (needed, given) = (usize::from(dims.width) * usize::from(dims.height), frame.len());
        let Some(frame) = frame.get_mut(..needed) else {
            return Err(RowError::Frame { needed, given });
        };
        if self.raw >= raw.height {
            return Err(RowError::TooMany);
        }
        if let Some(slot) =
            slot(self.raw, mesh).and_then(|start| bytes.get_mut(start..)?.get_mut(..width))
        {
            slot.copy_from_slice(raw_row);
        }
        let rows = Rows {
            mesh: *mesh,
            bytes,
            lap: self.raw - self.raw.checked_rem(mesh.grid.band_rows).unwrap_or(0),
        };
        let first = self.row;
        let out = frame.chunks_exact_mut(usize::from(dims.width).max(1)).skip(first.into());
        for out in out {
            if !mesh.suffices(self.raw, self.row) {
                break;
            }
            rows.rectify(self.row, work, out);
            self.row = self.row.saturating_add(1);
        }
        self.raw = self.raw.saturating_add(1);
        Ok(first..self.row)
    }
}

/// Index at which a raw row starts in the ring.
fn slot(row: u16, mesh: &MeshPlan<'_>) -> Option<usize> {
    Some(usize::from(row.checked_rem(mesh.grid.band_rows)?) * usize::from(mesh.grid.raw.width))
}

/// The band during the computation of a row.
struct Rows<'a> {
    mesh: MeshPlan<'a>,
    bytes: &'a [u8],
    /// Raw row at the start of the ring: those before it lie at its end.
    lap: u16,
}

impl Rows<'_> {
    /// Indices at which raw row `y` and the next one start.
    #[inline]
    fn starts(&self, y: i32) -> (u32, u32) {
        let grid = self.mesh.grid;
        let (width, rows) = (u32::from(grid.raw.width), i32::from(grid.band_rows));
        let index = y - i32::from(self.lap);
        let index = if index < 0 { index + rows } else { index };
        let top = (index as u32).wrapping_mul(width);
        (top, if index + 1 == rows { 0 } else { top.wrapping_add(width) })
    }

    /// Raw row `y`, if it is held.
    fn raw(&self, y: i32) -> &[u8] {
        let width = usize::from(self.mesh.grid.raw.width);
        let index = y - i32::from(self.lap);
        let index = if index < 0 { index + i32::from(self.mesh.grid.band_rows) } else { index };
        let start = (index as usize).wrapping_mul(width);
        self.bytes.get(start..start.wrapping_add(width)).unwrap_or(&[])
    }

    fn rectify(&self, y: u16, work: &mut Work, out: &mut [u8]) {
        let span = self.mesh.span(y);
        if self.mesh.grid.is_inner && usize::from(span.end - span.start) == out.len() {
            return self.rectify_inner(y, work, out);
        }
        let (before, rest) = out.split_at_mut_checked(span.start.into()).unwrap_or_default();
        let (valid, behind) = rest
            .split_at_mut_checked(span.end.saturating_sub(span.start).into())
            .unwrap_or_default();
        before.fill(0);
        behind.fill(0);
        let mut list = List { rows: self, runs: &mut work.runs, count: 0, pixels: 0, left: valid };
        self.mesh.for_each_piece(y, &mut work.knots, |start, length, piece| {
            let (from, to) = (start.max(span.start), (start + length).min(span.end));
            if from < to {
                list.add(piece.from(i32::from(from - start)), to - from);
            }
        });
        list.paint();
    }

    /// Rectifies a row all of whose pixels lie between four raw ones.
    fn rectify_inner(&self, y: u16, work: &mut Work, out: &mut [u8]) {
        let width = usize::from(self.mesh.grid.raw.width);
        let mut knots = self.mesh.knots(y, &mut work.knots);
        if self.mesh.grid.has_whole_cells() {
            let rows = self.mesh.grid.band_rows.into();
            let ring = Ring { bytes: self.bytes, width, rows, first: self.lap.into() };
            return bilinear_cells(ring, knots, out);
        }
        let mut left = out;
        while knots.len() > 3 && !left.is_empty() {
            let listed = self.list(knots, left.len() as i32, &mut work.runs);
            let runs = work.runs.get(..listed.runs).unwrap_or(&[]);
            let (out, behind) = core::mem::take(&mut left)
                .split_at_mut_checked(listed.pixels as usize)
                .unwrap_or_default();
            bilinear_runs(self.bytes, width, runs, out);
            left = behind;
            knots = knots.get(listed.cells..).unwrap_or(&[]);
        }
    }

    /// Lists the runs of as many whole cells as fit, up to `most` pixels.
    fn list(&self, knots: &[Node], most: i32, runs: &mut [Run; RUNS]) -> Listed {
        let (mut left, mut cells) = (most, 0);
        let mut slots = runs.iter_mut();
        for four in knots.windows(4).filter_map(|four| four.first_chunk::<4>()) {
            if slots.len() < MOST_OF_CELL {
                break;
            }
            cells += 1;
            self.mesh.grid.pieces_of_cell(four, |piece| {
                let length = left.min(self.mesh.grid.length());
                left -= length;
                self.split(piece, length, |run| {
                    if let Some(slot) = slots.next() {
                        *slot = run;
                    }
                });
            });
        }
        let free = slots.len();
        Listed { runs: RUNS - free, pixels: most.wrapping_sub(left), cells }
    }

    /// Splits a piece where the raw row changes.
    #[inline(always)]
    fn split(&self, mut piece: Piece, mut left: i32, mut put: impl FnMut(Run)) {
        while left > 0 {
            let Piece { x_q16, dx_q16, ddx_q16, y_q14, dy_q14 } = piece;
            let (row, fy_q14) = (y_q14 >> 14, y_q14 & 0x3fff);
            let (top, bottom) = self.starts(row);
            let mut run = Run {
                top,
                bottom,
                x_q16,
                dx_q16,
                ddx_q16,
                fy_q14,
                dfy_q14: dy_q14,
                length: left as u32,
            };
            if y_q14.wrapping_add(dy_q14.wrapping_mul(left - 1)) >> 14 == row {
                return put(run);
            }
            let length = before_next_row(fy_q14, dy_q14).min(left);
            run.length = length as u32;
            put(run);
            piece = piece.from(length);
            left -= length;
        }
    }

    /// Interpolates pixel by pixel, at clamped positions.
    fn paint_border(&self, piece: Piece, out: &mut [u8]) {
        let raw = self.mesh.grid.raw;
        let (ends_x, ends_y) =
            ((i32::from(raw.width) - 1) << 16, (i32::from(raw.height) - 1) << 14);
        for (pixel, i) in out.iter_mut().zip(0..) {
            let [x, y] = piece.at(i);
            let (x, y) = (x.min(ends_x).max(0), y.min(ends_y).max(0));
            // The last column and row are interpolated from the last two, with the full fraction.
            let (column, row) =
                ((x >> 16).min(i32::from(raw.width) - 2), (y >> 14).min(i32::from(raw.height) - 2));
            let two = |row: &[u8]| {
                row.get(column as usize..).and_then(|row| row.first_chunk::<2>()).copied()
            };
            *pixel = match (two(self.raw(row)), two(self.raw(row + 1))) {
                (Some(top), Some(bottom)) => {
                    bilinear(top, bottom, (x - (column << 16)) >> 9, y - (row << 14))
                }
                _ => 0,
            };
        }
    }
}

/// Content of a list of runs.
struct Listed {
    runs: usize,
    pixels: i32,
    cells: usize,
}

/// Runs to be interpolated, and their target.
struct List<'a> {
    rows: &'a Rows<'a>,
    runs: &'a mut [Run; RUNS],
    count: usize,
    /// Number of pixels of all runs.
    pixels: usize,
    left: &'a mut [u8],
}

impl List<'_> {
    #[inline]
    fn add(&mut self, piece: Piece, length: u16) {
        let grid = self.rows.mesh.grid;
        let last = piece.from(i32::from(length) - 1);
        // Monotonic columns lie between the first and the last one.
        let is_straight = piece.dx_q16 >= 0 && last.dx_q16 >= 0;
        if is_straight && grid.is_between(piece.at(0)) && grid.is_between(last.at(0)) {
            if self.count + MOST_OF_CELL > RUNS {
                self.paint();
            }
            let Self { rows, runs, count, pixels, .. } = self;
            rows.split(piece, length.into(), |run| {
                if let Some(slot) = runs.get_mut(*count) {
                    *slot = run;
                    *count += 1;
                }
            });
            *pixels += usize::from(length);
            return;
        }
        self.paint();
        if let Some((out, behind)) =
            core::mem::take(&mut self.left).split_at_mut_checked(length.into())
        {
            self.rows.paint_border(piece, out);
            self.left = behind;
        }
    }

    #[inline(never)]
    fn paint(&mut self) {
        let width = usize::from(self.rows.mesh.grid.raw.width);
        let (runs, pixels) = (self.runs.get(..self.count).unwrap_or(&[]), self.pixels);
        if let Some((out, behind)) = core::mem::take(&mut self.left).split_at_mut_checked(pixels) {
            bilinear_runs(self.rows.bytes, width, runs, out);
            self.left = behind;
        }
        (self.count, self.pixels) = (0, 0);
    }
}

/// Number of pixels, at least one, before a position that starts at a fraction of a row and moves
/// by `step` leaves the row.
fn before_next_row(fraction: i32, step: i32) -> i32 {
    let distance = if step < 0 { fraction } else { (1 << 14) - 1 - fraction };
    distance.checked_div(step.wrapping_abs()).map_or(i32::MAX, |steps| steps.wrapping_add(1))
}
