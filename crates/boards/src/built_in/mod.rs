//! Built-in pairs: every scene in a board's sizes, with the default parameters, and some with those
//! that cost most; and what a PC computes of them.

pub mod digests;
mod scene;

use crate::Board;
use core::fmt;
use digests::Digests;
use linestereo::{Dims, Params, units::Confidence, unstable::Stage};
pub use scene::Scene;

/// A built-in pair and how to match it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Scene that is painted.
    pub scene: Scene,
    /// Size of both images.
    pub dims: Dims,
    /// Are all parameters such that they cost most?
    pub worst_case: bool,
}

/// Parameters that find, try and report as much as any can, at 64 disparities.
const WORST_CASE: Params = Params {
    anchor_gradient: 4,
    edge_gradient: 4,
    min_extent: 6,
    cell: 8,
    min_confidence: Confidence::from_bits(0x1a00),
    reach: 6,
    ..Params::DEFAULT
};

impl Case {
    /// The cases of a board, in a fixed order.
    pub fn all(board: &Board) -> impl Iterator<Item = Self> {
        let of = move |dims| {
            let usual = Scene::ALL.map(|scene| Self { scene, dims, worst_case: false });
            let worst_case =
                [Scene::Bricks, Scene::Noise].map(|scene| Self { scene, dims, worst_case: true });
            usual.into_iter().chain(worst_case)
        };
        board.sizes.iter().copied().flat_map(of)
    }

    /// How it is matched.
    pub const fn params(&self) -> Params {
        if self.worst_case { WORST_CASE } else { Params::DEFAULT }
    }
}

/// Digest behind those of the stages: of sectors and the bytes of MAVLink.
pub const AUTOPILOT: &str = "autopilot";

/// The name of the first stage whose digest differs, or [`AUTOPILOT`].
pub fn first_difference(found: &Digests, expected: &Digests) -> Option<&'static str> {
    let names = Stage::ALL.into_iter().map(Stage::name).chain([AUTOPILOT]);
    let mut pairs = names.zip(found.iter().zip(expected));
    pairs.find(|(_, (found, expected))| found != expected).map(|(name, _)| name)
}

/// Such as `bricks_160x120` and `bricks_160x120_worst_case`.
impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let worst_case = if self.worst_case { "_worst_case" } else { "" };
        write!(f, "{}_{}x{}{worst_case}", self.scene.name(), self.dims.width, self.dims.height)
    }
}
