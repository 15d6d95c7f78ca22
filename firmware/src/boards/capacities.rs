//! What boards can hold: memory for pairs of two sizes. A board takes one of them, or has a size of its own here.
//!
//! Nodes of a mesh are the same on every board: every 16 px of 320x240, and as many every 8 px of 160x120, where lenses may ask for it. A
//! mesh depends on the memory for its nodes, and so do the rectified bytes: who wants a board's bytes takes as many.

use linestereo::{Dims, mesh_nodes};

/// Nodes of a camera's mesh.
pub const NODES: usize = mesh_nodes(Dims { width: 320, height: 240 });

/// Pairs of 320x240: some 320 KiB with frames, rectifiers and stack.
pub mod qvga {
    use super::NODES;
    use crate::boards::{Board, Device, pixels};
    use crate::memory;
    use linestereo::{Dims, Params, mark_words, most_candidates, row_bytes};

    const LARGEST: Dims = Dims { width: 320, height: 240 };
    const SEGMENTS: usize = 640;
    /// One per square of the default size: a list of matches is never full.
    const CANDIDATES: usize = most_candidates(LARGEST, Params::DEFAULT.cell);
    const MATCHES: usize = CANDIDATES;
    /// No list: points are sent as they are made.
    const POINTS: usize = 0;
    /// Widest raw image, px.
    const RAW_WIDTH: usize = 1024;
    /// Bytes of raw rows of one camera.
    const BAND: usize = 19 * 1024;

    /// A board with this memory.
    #[must_use]
    pub const fn board(name: &'static str, processor: &'static str, target: &'static str, device: Device) -> Board {
        Board {
            name,
            processor,
            target,
            device,
            largest: LARGEST,
            segments: SEGMENTS,
            matches: MATCHES,
            points: POINTS,
            raw_width: RAW_WIDTH,
            band: BAND,
            sizes: &[LARGEST, Dims { width: 128, height: 96 }],
        }
    }

    /// The memory.
    pub type Workspace = memory::Workspace<{ pixels(LARGEST) }, RAW_WIDTH, Lists, Rectifier>;
    type Lists = memory::CoreMemory<
        { row_bytes(LARGEST.width) },
        { mark_words(LARGEST) },
        SEGMENTS,
        CANDIDATES,
        MATCHES,
        POINTS,
    >;
    type Rectifier = memory::CameraRows<NODES, { LARGEST.height as usize }, BAND>;
}

/// Pairs of 160x120: some 156 KiB with frames, rectifiers and stack.
pub mod qqvga {
    use super::NODES;
    use crate::boards::{Board, Device, pixels};
    use crate::memory;
    use linestereo::{Dims, Params, mark_words, most_candidates, row_bytes};

    const LARGEST: Dims = Dims { width: 160, height: 120 };
    const SEGMENTS: usize = 256;
    /// One per square of the default size: a list of matches is never full.
    const CANDIDATES: usize = most_candidates(LARGEST, Params::DEFAULT.cell);
    const MATCHES: usize = CANDIDATES;
    /// No list: points are sent as they are made.
    const POINTS: usize = 0;
    /// Widest raw image, px.
    const RAW_WIDTH: usize = 640;
    /// Bytes of raw rows of one camera.
    const BAND: usize = 24 * 1024;

    /// A board with this memory.
    #[must_use]
    pub const fn board(name: &'static str, processor: &'static str, target: &'static str, device: Device) -> Board {
        Board {
            name,
            processor,
            target,
            device,
            largest: LARGEST,
            segments: SEGMENTS,
            matches: MATCHES,
            points: POINTS,
            raw_width: RAW_WIDTH,
            band: BAND,
            sizes: &[LARGEST, Dims { width: 128, height: 96 }],
        }
    }

    /// The memory.
    pub type Workspace = memory::Workspace<{ pixels(LARGEST) }, RAW_WIDTH, Lists, Rectifier>;
    type Lists = memory::CoreMemory<
        { row_bytes(LARGEST.width) },
        { mark_words(LARGEST) },
        SEGMENTS,
        CANDIDATES,
        MATCHES,
        POINTS,
    >;
    type Rectifier = memory::CameraRows<NODES, { LARGEST.height as usize }, BAND>;
}
