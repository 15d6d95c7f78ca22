//! QEMU's mps2-an500: Arm Cortex-M7, held to 1 MiB of flash and 512 KiB of RAM by `memory.x`.

use super::{Board, NODES, pixels};
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

/// Its description.
pub const BOARD: Board = Board {
    name: "mps2-an500",
    processor: "Cortex-M7",
    largest: LARGEST,
    segments: SEGMENTS,
    matches: MATCHES,
    points: POINTS,
    raw_width: RAW_WIDTH,
    band: BAND,
    sizes: &[Dims { width: 320, height: 240 }, Dims { width: 128, height: 96 }],
};

/// Its memory.
pub type Workspace = memory::Workspace<{ pixels(LARGEST) }, RAW_WIDTH, Lists, Rectifier>;
type Lists =
    memory::CoreMemory<{ row_bytes(LARGEST.width) }, { mark_words(LARGEST) }, SEGMENTS, CANDIDATES, MATCHES, POINTS>;
type Rectifier = memory::CameraRows<NODES, { LARGEST.height as usize }, BAND>;
