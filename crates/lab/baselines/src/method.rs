//! The methods by name.

use crate::stereo_bm::StereoBm;
use crate::{DisparityMap, Search, census, semi_global};
use linestereo_frames::GrayImage;

/// How the pixels of a pair are matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// OpenCV's block matcher.
    Bm,
    /// The same with uniqueness 90 and texture 3000.
    BmStrict,
    /// Block matching on census codes.
    Census,
    /// Semi-global matching on census codes.
    Sgm8,
    /// The same with uniqueness 80.
    Sgm8Strict,
}

impl Method {
    /// Every method, in the order of tables.
    pub const ALL: [Self; 5] =
        [Self::Bm, Self::BmStrict, Self::Census, Self::Sgm8, Self::Sgm8Strict];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bm => "bm",
            Self::BmStrict => "bm-strict",
            Self::Census => "census",
            Self::Sgm8 => "sgm8",
            Self::Sgm8Strict => "sgm8-strict",
        }
    }

    /// Matches a pair with disparities up to `max_disparity`.
    ///
    /// # Panics
    /// When the images differ in size.
    #[must_use]
    pub fn run(self, left: &GrayImage, right: &GrayImage, max_disparity: u16) -> DisparityMap {
        let search = Search::up_to(left.dims, max_disparity);
        match self {
            Self::Bm => StereoBm::default().run(left, right, search),
            Self::BmStrict => StereoBm::strict().run(left, right, search),
            Self::Census => census::match_blocks([left, right], search),
            Self::Sgm8 => semi_global::match_paths([left, right], search, 0.0),
            Self::Sgm8Strict => semi_global::match_paths([left, right], search, 0.8),
        }
    }
}
