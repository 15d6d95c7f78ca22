//! Rectifier of one camera, raw rows to a rectified frame, of any capacity.

use linestereo::image::Span;
use linestereo_rig::{Band, CameraSide, Mesh, MeshError, Remap, RowError};

/// [`Mesh`] and [`Band`] without their capacities.
pub trait Rectifier {
    /// Without a mesh, all zero: every row is refused.
    const CLEARED: Self;

    /// Makes ready for one camera of a rig. After an error every row is refused.
    fn build(&mut self, remap: &Remap, eye: CameraSide) -> Result<(), NoRoom>;

    /// The next raw row is the first of a frame.
    fn restart(&mut self);

    /// Takes the next raw row and writes the rows of the frame that are complete now.
    fn push(&mut self, raw_row: &[u8], frame: &mut [u8]) -> Result<(), RowError>;

    /// Is the frame complete?
    fn is_complete(&self) -> bool;

    /// Of each row of the frame the pixels that may be used; none when all may.
    fn valid(&self) -> &[Span];
}

/// Why a board cannot rectify for a rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRoom {
    /// The memory for this is too small.
    Small {
        /// Capacity that is too small: `mesh nodes`, `mesh rows`, `band`, `raw row`.
        name: &'static str,
        /// Nodes, rows or bytes needed.
        needed: usize,
        /// Nodes, rows or bytes there.
        given: usize,
    },
    /// No pixel lies inside the raw image.
    NothingSeen,
}

impl From<MeshError> for NoRoom {
    fn from(error: MeshError) -> Self {
        match error {
            MeshError::Nodes { needed, given } => Self::Small { name: "mesh nodes", needed, given },
            MeshError::Rows { needed, given } => Self::Small { name: "mesh rows", needed, given },
            MeshError::NothingSeen => Self::NothingSeen,
        }
    }
}

/// Mesh and raw rows of one camera with their capacities.
#[derive(Debug)]
pub struct CameraRows<const NODES: usize, const ROWS: usize, const BAND: usize> {
    mesh: Mesh<NODES, ROWS>,
    band: Band<BAND>,
    valid: [Span; ROWS],
    /// Rows of it; 0 when every pixel may be used.
    valid_rows: u16,
}

impl<const NODES: usize, const ROWS: usize, const BAND: usize> Rectifier
    for CameraRows<NODES, ROWS, BAND>
{
    const CLEARED: Self = Self {
        mesh: Mesh::new(),
        band: Band::new(),
        valid: [Span { start: 0, end: 0 }; ROWS],
        valid_rows: 0,
    };

    fn build(&mut self, remap: &Remap, eye: CameraSide) -> Result<(), NoRoom> {
        self.band.restart();
        self.mesh.build(remap, eye)?;
        self.valid_rows = self.mesh.valid(&mut self.valid).len() as u16;
        let needed = self.mesh.band_bytes();
        if needed > BAND {
            Err(NoRoom::Small { name: "band", needed, given: BAND })
        } else {
            Ok(())
        }
    }

    fn restart(&mut self) {
        self.band.restart();
    }

    fn push(&mut self, raw_row: &[u8], frame: &mut [u8]) -> Result<(), RowError> {
        self.band.push(&self.mesh, raw_row, frame).map(drop)
    }

    fn is_complete(&self) -> bool {
        self.band.is_complete(&self.mesh)
    }

    fn valid(&self) -> &[Span] {
        self.valid.get(..self.valid_rows.into()).unwrap_or_default()
    }
}
