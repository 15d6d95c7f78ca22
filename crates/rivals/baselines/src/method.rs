//! A method with its after-steps: what a command line names.

use super::{
    Acceptance, AfterStep, BlockMatcher, CostKind, DisparityMap, Fraction, Paths, PushbroomMatcher, ScanLineMatcher,
    Search, SemiGlobalMatcher, SparseBlockMatcher, StereoBm, Window,
};
use linestereo_frames::GrayImage;

/// How the pixels of a pair are matched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Matcher {
    /// OpenCV's block matcher.
    StereoBm(StereoBm),
    /// Block matching with any cost.
    Block(BlockMatcher),
    /// Dynamic programming along scan lines.
    ScanLine(ScanLineMatcher),
    /// Costs along paths.
    SemiGlobal(SemiGlobalMatcher),
    /// One disparity; `None` takes half of the range.
    Pushbroom(Option<u16>),
    /// Peaks of the gradient.
    SparseBlock(SparseBlockMatcher),
}

/// A matcher and what is done with its map.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Its name.
    pub name: String,
    /// Matcher.
    pub matcher: Matcher,
    /// Post-processing, in this order.
    pub after: Vec<AfterStep>,
}

/// Confidence of StereoSGBM's uniqueness ratio 80.
const STRICT_SEMI_GLOBAL: f32 = 0.8;
/// Confidence of OpenCV's usual ratios: 15 of block matching.
const USUAL: f32 = 15.0 / 115.0;
/// Window of block matching, px.
const BLOCK: Window = Window::square(15);

impl Method {
    /// Every method by its name, in the order of tables.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let usual = Acceptance { least_confidence: USUAL, left_right: None, fraction: Fraction::Equiangular };
        let semi_global = |paths, least_confidence| {
            let acceptance = Acceptance { least_confidence, left_right: Some(1), fraction: Fraction::Equiangular };
            Matcher::SemiGlobal(SemiGlobalMatcher::new(paths, acceptance))
        };
        let mut methods =
            vec![("bm", Matcher::StereoBm(StereoBm::default())), ("bm-strict", Matcher::StereoBm(StereoBm::strict()))];
        let block =
            |cost: CostKind| (cost.name(), Matcher::Block(BlockMatcher { cost, window: BLOCK, acceptance: usual }));
        methods.extend(CostKind::ALL.map(block));
        methods.extend([
            ("scan-line", Matcher::ScanLine(ScanLineMatcher::default())),
            ("sgm4", semi_global(Paths::Four, 0.0)),
            ("sgm8", semi_global(Paths::Eight, 0.0)),
            ("sgm8-strict", semi_global(Paths::Eight, STRICT_SEMI_GLOBAL)),
            ("sparse-block", Matcher::SparseBlock(SparseBlockMatcher::default())),
            ("pushbroom", Matcher::Pushbroom(None)),
        ]);
        let method = |(name, matcher): (&str, Matcher)| Self { name: name.to_owned(), matcher, after: Vec::new() };
        methods.into_iter().map(method).collect()
    }

    /// The method of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|method| method.name == name)
    }

    /// The same with another window, where the method has one of free size.
    #[must_use]
    pub fn with_window(mut self, window: Window) -> Self {
        match &mut self.matcher {
            Matcher::Block(matcher) => matcher.window = window,
            Matcher::ScanLine(matcher) => matcher.window = window,
            Matcher::SemiGlobal(matcher) => matcher.window = window,
            Matcher::StereoBm(_) | Matcher::Pushbroom(_) | Matcher::SparseBlock(_) => {}
        }
        self
    }

    /// Matches a pair with disparities up to `max_disparity`.
    #[must_use]
    pub fn run(&self, left: &GrayImage, right: &GrayImage, max_disparity: u16) -> DisparityMap {
        let search = Search::up_to(left.dims, max_disparity);
        let mut map = match self.matcher {
            Matcher::StereoBm(matcher) => matcher.run(left, right, search),
            Matcher::Block(matcher) => matcher.run(left, right, search),
            Matcher::ScanLine(matcher) => matcher.run(left, right, search),
            Matcher::SemiGlobal(matcher) => matcher.run(left, right, search),
            Matcher::Pushbroom(disparity) => {
                PushbroomMatcher::new(disparity.unwrap_or(max_disparity / 2)).run(left, right)
            }
            Matcher::SparseBlock(matcher) => matcher.run(left, right, search),
        };
        for step in &self.after {
            step.apply(&mut map, left, right);
        }
        map
    }
}
