//! Raw rows, one after the other -> rectified rows.
//!
//! In: raw rows as the camera delivers them. Out: rectified rows, in order, each as soon as the last raw row it needs has come.
//!
//! ```text
//! push(raw row):
//!     into the band, a ring of as many raw rows as any rectified row needs at once, over the oldest
//!     for each rectified row that is complete now:
//!         for each piece of it (see Mesh):
//!             split where the raw row changes; bilinear_run
//!             at the border of the raw image pixel by pixel, held inside
//! ```
//!
//! # Bounds
//! See [`portable::bilinear_run`](crate::kernel::portable::bilinear_run).

use super::mesh::{Mesh, MeshPlan, Piece};
use crate::kernel::{Run, bilinear, bilinear_run};
use core::fmt;
use core::ops::Range;

/// Raw rows of one camera, in the caller's memory; [`Mesh::band_bytes`] are needed.
#[derive(Clone, Debug)]
pub struct Band<const BYTES: usize> {
    bytes: [u8; BYTES],
    place: Place,
}

/// How far a frame has come.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    /// The raw row that is expected.
    raw: u16,
    /// The rectified row that is expected.
    row: u16,
}

/// Why a raw row was refused. The frame stands where it stood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowError {
    /// The mesh is empty: build it first.
    NoMesh,
    /// The band's memory is too small for this mesh.
    Band {
        /// Bytes needed: [`Mesh::band_bytes`].
        needed: usize,
        /// Bytes there are.
        given: usize,
    },
    /// The raw row is not as long as the mesh says.
    Width {
        /// Pixels of a raw row.
        needed: u16,
        /// Pixels given.
        given: usize,
    },
    /// All raw rows of this frame have come: restart for the next one.
    TooMany,
    /// The memory for the rectified frame is too small.
    Frame {
        /// Bytes needed: width times height.
        needed: usize,
        /// Bytes given.
        given: usize,
    },
}

impl fmt::Display for RowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoMesh => write!(f, "no mesh has been built"),
            Self::Band { needed, given } => write!(f, "the band needs {needed} bytes, there are {given}"),
            Self::Width { needed, given } => write!(f, "a raw row has {needed} px, {given} were given"),
            Self::TooMany => write!(f, "the frame is complete: restart before the next one"),
            Self::Frame { needed, given } => write!(f, "the rectified frame needs {needed} bytes, there are {given}"),
        }
    }
}

impl core::error::Error for RowError {}

impl<const BYTES: usize> Default for Band<BYTES> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const BYTES: usize> Band<BYTES> {
    /// An empty one.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: [0; BYTES], place: Place { raw: 0, row: 0 } }
    }

    /// Forgets the frame: the next raw row is the first of another one.
    pub fn restart(&mut self) {
        self.place = Place::default();
    }

    /// Takes the next raw row, writes the rectified rows that can be computed now to their places in `frame` (as wide as the rectified
    /// image, row after row), and says which they are. Pixels outside a row's [`Mesh::spans`] become 0.
    pub fn push<const NODES: usize, const ROWS: usize>(
        &mut self,
        mesh: &Mesh<NODES, ROWS>,
        raw_row: &[u8],
        frame: &mut [u8],
    ) -> Result<Range<u16>, RowError> {
        self.place.push(&mesh.plan(), &mut self.bytes, raw_row, frame)
    }

    /// Is every row of the rectified frame written?
    #[must_use]
    pub fn is_complete<const NODES: usize, const ROWS: usize>(&self, mesh: &Mesh<NODES, ROWS>) -> bool {
        self.place.row >= mesh.dims().height
    }

    /// Raw rows of this frame that have come.
    #[must_use]
    pub fn raw_rows(&self) -> u16 {
        self.place.raw
    }
}

impl Place {
    #[inline(never)]
    fn push(
        &mut self,
        mesh: &MeshPlan<'_>,
        bytes: &mut [u8],
        raw_row: &[u8],
        frame: &mut [u8],
    ) -> Result<Range<u16>, RowError> {
        let (raw, dims) = (mesh.grid.raw, mesh.grid.dims);
        let (width, given) = (usize::from(raw.width), bytes.len());
        if mesh.grid.band_rows == 0 {
            return Err(RowError::NoMesh);
        }
        let needed = width * usize::from(mesh.grid.band_rows);
        let Some(bytes) = bytes.get_mut(..needed) else { return Err(RowError::Band { needed, given }) };
        if raw_row.len() != width {
            return Err(RowError::Width { needed: raw.width, given: raw_row.len() });
        }
        let (needed, given) = (usize::from(dims.width) * usize::from(dims.height), frame.len());
        let Some(frame) = frame.get_mut(..needed) else { return Err(RowError::Frame { needed, given }) };
        if self.raw >= raw.height {
            return Err(RowError::TooMany);
        }
        if let Some(slot) = slot(self.raw, mesh).and_then(|start| bytes.get_mut(start..)?.get_mut(..width)) {
            slot.copy_from_slice(raw_row);
        }
        let rows = Rows { mesh: *mesh, bytes };
        let first = self.row;
        let out = frame.chunks_exact_mut(usize::from(dims.width).max(1)).skip(first.into());
        for out in out {
            if !mesh.suffices(self.raw, self.row) {
                break;
            }
            rows.rectify(self.row, out);
            self.row = self.row.saturating_add(1);
        }
        self.raw = self.raw.saturating_add(1);
        Ok(first..self.row)
    }
}

/// Where a raw row lies in the ring.
fn slot(row: u16, mesh: &MeshPlan<'_>) -> Option<usize> {
    Some(usize::from(row.checked_rem(mesh.grid.band_rows)?) * usize::from(mesh.grid.raw.width))
}

/// The band as it is while a row is computed.
struct Rows<'a> {
    mesh: MeshPlan<'a>,
    bytes: &'a [u8],
}

impl Rows<'_> {
    /// Raw row `y`, if it is one.
    fn raw(&self, y: i32) -> &[u8] {
        let row = u16::try_from(y).ok().and_then(|y| slot(y, &self.mesh)).and_then(|start| self.bytes.get(start..));
        row.and_then(|row| row.get(..usize::from(self.mesh.grid.raw.width))).unwrap_or(&[])
    }

    fn rectify(&self, y: u16, out: &mut [u8]) {
        let span = self.mesh.span(y);
        let (before, rest) = out.split_at_mut_checked(span.start.into()).unwrap_or_default();
        let (valid, behind) = rest.split_at_mut_checked(span.end.saturating_sub(span.start).into()).unwrap_or_default();
        before.fill(0);
        behind.fill(0);
        let mut left = valid;
        self.mesh.for_each_piece(y, |start, length, piece| {
            let (from, to) = (start.max(span.start), (start + length).min(span.end));
            if from >= to {
                return;
            }
            let (out, behind) = core::mem::take(&mut left).split_at_mut_checked((to - from).into()).unwrap_or_default();
            left = behind;
            let [x_q16, y_q14] = piece.at(from - start);
            self.paint(Piece { x_q16, y_q14, ..piece }, out);
        });
    }

    /// Pixels that lie on one line.
    fn paint(&self, piece: Piece, out: &mut [u8]) {
        let raw = self.mesh.grid.raw;
        let (ends_x, ends_y) = ((i32::from(raw.width) - 1) << 16, (i32::from(raw.height) - 1) << 14);
        let inside = |[x, y]: [i32; 2]| (0..ends_x).contains(&x) && (0..ends_y).contains(&y);
        let last = piece.at((out.len() as u16).saturating_sub(1));
        if inside(piece.at(0)) && inside(last) {
            return self.paint_inside(piece, out);
        }
        for (pixel, i) in out.iter_mut().zip(0..) {
            let [x, y] = piece.at(i);
            let (x, y) = (x.clamp(0, ends_x), y.clamp(0, ends_y));
            // The last pixel is one to the right of the last but one.
            let (column, row) = ((x >> 16).min(i32::from(raw.width) - 2), (y >> 14).min(i32::from(raw.height) - 2));
            let two = |row: &[u8]| row.get(column as usize..).and_then(|row| row.first_chunk::<2>()).copied();
            *pixel = match (two(self.raw(row)), two(self.raw(row + 1))) {
                (Some(top), Some(bottom)) => bilinear(top, bottom, (x - (column << 16)) >> 9, y - (row << 14)),
                _ => 0,
            };
        }
    }

    /// The same where all neighbours of all pixels exist.
    fn paint_inside(&self, piece: Piece, out: &mut [u8]) {
        let Piece { mut x_q16, dx_q16, mut y_q14, dy_q14 } = piece;
        let mut left = out;
        while !left.is_empty() {
            let row = y_q14 >> 14;
            let fraction = y_q14 - (row << 14);
            let length = before_next_row(fraction, dy_q14).min(left.len() as u32);
            let (out, behind) = core::mem::take(&mut left).split_at_mut_checked(length as usize).unwrap_or_default();
            left = behind;
            bilinear_run(
                self.raw(row),
                self.raw(row + 1),
                out,
                Run { x_q16, dx_q16, fy_q14: fraction, dfy_q14: dy_q14 },
            );
            x_q16 = x_q16.wrapping_add(dx_q16.wrapping_mul(length as i32));
            y_q14 = y_q14.wrapping_add(dy_q14.wrapping_mul(length as i32));
        }
    }
}

/// Pixels, at least one, before a position that starts at a fraction of a row and moves by `step` leaves the row.
fn before_next_row(fraction: i32, step: i32) -> u32 {
    let distance = if step < 0 { fraction } else { (1 << 14) - 1 - fraction };
    (distance as u32).checked_div(step.unsigned_abs()).map_or(u32::MAX, |steps| steps.saturating_add(1))
}
