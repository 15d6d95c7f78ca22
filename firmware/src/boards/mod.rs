//! The boards: what each can hold, and its peripherals.

pub mod mps2_an386;
pub mod mps2_an500;

#[cfg(target_os = "none")]
pub mod flash_file;
#[cfg(target_os = "none")]
pub mod mps2;

use linestereo::{Dims, mesh_nodes};

/// What a program or a PC has to know of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Its name: of the feature that builds for it, of QEMU's machine, of `--on`.
    pub name: &'static str,
    /// Its processor.
    pub processor: &'static str,
    /// The largest pair: frames may be no wider than this and have no more pixels.
    pub largest: Dims,
    /// Segments it lists per image.
    pub segments: usize,
    /// Matches it lists per pair.
    pub matches: usize,
    /// Points it lists per pair.
    pub points: usize,
    /// Widest raw image that it rectifies.
    pub raw_width: usize,
    /// Bytes of raw rows that it holds of each camera.
    pub band: usize,
    /// Sizes of the built-in frames.
    pub sizes: &'static [Dims],
}

impl Board {
    /// Every board, the default one first.
    pub const ALL: [Self; 2] = [mps2_an500::BOARD, mps2_an386::BOARD];

    /// The board of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|board| board.name == name)
    }

    /// Does it hold pairs of this size?
    #[must_use]
    pub fn fits(&self, dims: Dims) -> bool {
        dims.width <= self.largest.width && pixels(dims) <= pixels(self.largest)
    }
}

/// Nodes of a mesh, on every board: every 16 px of 320x240, and as many every 8 px of 160x120, where lenses may ask for it. A mesh depends on
/// the memory for its nodes, and so do the rectified bytes: who wants a board's bytes takes as many.
pub const NODES: usize = mesh_nodes(Dims { width: 320, height: 240 });

const fn pixels(dims: Dims) -> usize {
    dims.width as usize * dims.height as usize
}

/// The memory of the board that is built.
#[cfg(feature = "mps2-an386")]
pub type Selected = mps2_an386::Workspace;
/// The memory of the board that is built.
#[cfg(not(feature = "mps2-an386"))]
pub type Selected = mps2_an500::Workspace;

/// The board that is built.
pub const SELECTED: Board = if cfg!(feature = "mps2-an386") { mps2_an386::BOARD } else { mps2_an500::BOARD };
