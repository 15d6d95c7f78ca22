//! Dense block matching with any cost and window.

use super::cost::CostKind;
use super::curve::Acceptance;
use super::map::DisparityMap;
use super::search::Search;
use super::sums::for_each_row;
use super::window::Window;
use linestereo_frames::GrayImage;

/// Every pixel by the lowest cost of the window around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockMatcher {
    /// Matching cost of two windows.
    pub cost: CostKind,
    /// The window.
    pub window: Window,
    /// Acceptance tests of a disparity.
    pub acceptance: Acceptance,
}

impl BlockMatcher {
    /// Matches a pair.
    #[must_use]
    pub fn run(&self, left: &GrayImage, right: &GrayImage, search: Search) -> DisparityMap {
        let mut map = DisparityMap::empty(left.dims);
        let cost = self.cost.of(left, right, &self.window, search);
        let mut scratch = Vec::new();
        for_each_row(&*cost, search, &self.window, |row| self.acceptance.read(row, &mut scratch, &mut map));
        map
    }
}
