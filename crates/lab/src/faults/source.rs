//! A pair as it is before it is damaged.

use linestereo_frames::GrayImage;
use linestereo_frames::Scene;
use linestereo_sim::results::mask::Mask;

/// A pair to be damaged, and what the damages take from elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Another pair.
    pub other: [&'a GrayImage; 2],
    /// Pixels of objects in the left image.
    pub objects: &'a Mask,
    /// Seed of everything random.
    pub seed: u64,
}
