//! QEMU's mps2-an386: Arm Cortex-M4, held to 1 MiB of flash and 192 KiB of RAM by `memory.x`.

use super::{Board, NODES, pixels};
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

/// Its description.
pub const BOARD: Board = Board {
    name: "mps2-an386",
    processor: "Cortex-M4",
    largest: LARGEST,
    segments: SEGMENTS,
    matches: MATCHES,
    points: POINTS,
    raw_width: RAW_WIDTH,
    band: BAND,
    sizes: &[Dims { width: 160, height: 120 }, Dims { width: 128, height: 96 }],
};

/// Its memory.
pub type Workspace = memory::Workspace<{ pixels(LARGEST) }, RAW_WIDTH, Lists, Rectifier>;
type Lists =
    memory::CoreMemory<{ row_bytes(LARGEST.width) }, { mark_words(LARGEST) }, SEGMENTS, CANDIDATES, MATCHES, POINTS>;
type Rectifier = memory::CameraRows<NODES, { LARGEST.height as usize }, BAND>;
