//! The built-in scenes in place of cameras.

use crate::memory::Memory;
use crate::ports::{CapturedPair, PairSource};
use linestereo::Dims;
use linestereo_boards::built_in::Scene;

/// A [`PairSource`] in place of cameras: one scene after the other.
#[derive(Debug)]
pub struct Painter {
    dims: Dims,
    next: usize,
}

impl Painter {
    /// A camera of this size.
    pub const fn new(dims: Dims) -> Self {
        Self { dims, next: 0 }
    }
}

impl PairSource for Painter {
    fn next_pair(&mut self, memory: &mut impl Memory, _: Option<Dims>) -> Option<CapturedPair> {
        let [left, right] = memory.frames();
        let scene = Scene::ALL.get(self.next)?;
        self.next = (self.next + 1) % Scene::ALL.len();
        scene.paint(self.dims, left, right);
        Some(CapturedPair::of(self.dims))
    }
}
