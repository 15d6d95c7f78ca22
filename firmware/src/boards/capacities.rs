//! What boards can hold: memory for pairs of two sizes. A board takes one of them, or has a size of its own here.
//!
//! Nodes of a mesh are the same on every board: every 16 px of 320x240, and as many every 8 px of 160x120, where lenses may ask for it. A
//! mesh depends on the memory for its nodes, and so do the rectified bytes: who wants a board's bytes takes as many.

use linestereo::Dims;
use linestereo_rig::mesh_nodes;

/// Nodes of a camera's mesh.
pub const NODES: usize = mesh_nodes(Dims { width: 320, height: 240 });

/// A module with the description and the memory of boards of one size.
macro_rules! capacities {
    (
        $(#[$about:meta])*
        $name:ident: $width:literal x $height:literal, segments $segments:literal, raw width $raw_width:literal, band $band:expr
    ) => {
        $(#[$about])*
        pub mod $name {
            use super::NODES;
            use crate::boards::{Board, Device, pixels};
            use crate::memory;
            use linestereo::{Dims, Params, Scratch, mark_words, most_candidates, most_support_points, row_bytes};

            const LARGEST: Dims = Dims { width: $width, height: $height };
            const SEGMENTS: usize = $segments;
            /// One per square of the default size.
            const CANDIDATES: usize = most_candidates(LARGEST, Params::DEFAULT.cell);
            /// Widest raw image, px.
            const RAW_WIDTH: usize = $raw_width;
            /// Bytes of raw rows of one camera.
            const BAND: usize = $band;

            /// A board with this memory.
            #[must_use]
            pub const fn board(
                name: &'static str,
                processor: &'static str,
                target: &'static str,
                device: Device,
            ) -> Board {
                Board {
                    name,
                    processor,
                    target,
                    device,
                    largest: LARGEST,
                    segments: SEGMENTS,
                    raw_width: RAW_WIDTH,
                    band: BAND,
                    sizes: &[LARGEST, Dims { width: 128, height: 96 }],
                }
            }

            /// The memory.
            pub type Workspace = memory::Workspace<{ pixels(LARGEST) }, RAW_WIDTH, Core, Rectifier>;
            type Core = Scratch<
                { row_bytes(LARGEST.width) },
                { mark_words(LARGEST) },
                SEGMENTS,
                CANDIDATES,
                { most_support_points(LARGEST) },
            >;
            type Rectifier = memory::CameraRows<NODES, { LARGEST.height as usize }, BAND>;
        }
    };
}

capacities! {
    /// Pairs of 320x240: 308 KiB with frames and rectifiers, beside the stack.
    qvga: 320 x 240, segments 640, raw width 1024, band 19 * 1024
}

capacities! {
    /// Pairs of 160x120: 144 KiB with frames and rectifiers, beside the stack.
    qqvga: 160 x 120, segments 256, raw width 640, band 24 * 1024
}
