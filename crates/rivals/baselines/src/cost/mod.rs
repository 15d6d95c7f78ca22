//! Costs of two pixels and of two windows (Eqs. 1-4 and the text around them): the lower, the more alike.
//!
//! In: both images. Out: a term per pixel of the left image and disparity; summed over a window and finished, they are its cost.
//!
//! | cost | term of a pixel | cost of a window |
//! |---|---|---|
//! | SSD (Eq. 1) | `(L - R)^2` | the sum |
//! | SAD (Eq. 2) | `abs(L - R)` | the sum |
//! | NCC (Eqs. 3, 4) | `L R` | `1 - NCC` with zero means, in steps of 2^-15 |
//! | SSD of normalised patches | `L R` | `sum (L^ - R^)^2 = 2 - 2 NCC`, in steps of 2^-15: the order of NCC |
//! | SAD of normalised patches | none | `sum abs(L^ - R^)`, in steps of 2^-12: every window has a mean and a norm of its own, so no sum slides |
//! | rank | `abs` of the difference of ranks, window 7x7 | the sum |
//! | census | Hamming distance of the codes, window 5x5 | the sum |
//! | gradient | `abs` of the difference of Sobel steps along the row, a quarter, clipped to +-31 | the sum |
//!
//! `I^ = (I - mean) / norm` over the window. A window of one grey level has no norm: it correlates with nothing, NCC = 0.

mod correlation;
mod transform;

use super::search::Search;
use super::window::Window;
use correlation::{Correlation, NormalisedAbsolute};
use linestereo_frames::GrayImage;
use transform::{census_codes, gradients, ranks};

/// Terms of pixels, and what the cost of a window is made of their sum.
pub trait Cost: Send + Sync {
    /// The terms of a row: curve after curve, from the first left column that has all disparities in the right image.
    fn terms(&self, y: usize, out: &mut [u16]);

    /// Makes the costs of windows with their centres on row `y`, from column `first`, of the sums of their terms, in place.
    fn costs(&self, y: usize, first: usize, sums: &mut [u32]) {
        let _ = (y, first, sums);
    }
}

/// The costs there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CostKind {
    /// Squared differences.
    Ssd,
    /// Absolute differences.
    Sad,
    /// Correlation with zero means and unit norms.
    Ncc,
    /// Squared differences of normalised patches.
    NormalisedSsd,
    /// Absolute differences of normalised patches.
    NormalisedSad,
    /// Differences of ranks.
    Rank,
    /// Hamming distances of census codes.
    Census,
    /// Absolute differences of horizontal gradients.
    Gradient,
}

impl CostKind {
    /// Every one.
    pub const ALL: [Self; 8] = [
        Self::Ssd,
        Self::Sad,
        Self::Ncc,
        Self::NormalisedSsd,
        Self::NormalisedSad,
        Self::Rank,
        Self::Census,
        Self::Gradient,
    ];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ssd => "ssd",
            Self::Sad => "sad",
            Self::Ncc => "ncc",
            Self::NormalisedSsd => "normalised-ssd",
            Self::NormalisedSad => "normalised-sad",
            Self::Rank => "rank",
            Self::Census => "census",
            Self::Gradient => "gradient",
        }
    }

    /// The cost of this pair, to be summed over this window.
    ///
    /// # Panics
    /// When the images differ in size.
    #[must_use]
    pub fn of(self, left: &GrayImage, right: &GrayImage, window: &Window, search: Search) -> Box<dyn Cost> {
        assert!(left.dims == right.dims && left.dims == search.dims, "images of one size");
        let absolute = |l: u8, r: u8| u16::from(l.abs_diff(r));
        match self {
            Self::Ssd => {
                terms(search, left.pixels.clone(), &right.pixels, |l: u8, r: u8| u16::from(l.abs_diff(r)).pow(2))
            }
            Self::Sad => terms(search, left.pixels.clone(), &right.pixels, absolute),
            Self::Rank => terms(search, ranks(left), &ranks(right), absolute),
            Self::Gradient => terms(search, gradients(left), &gradients(right), absolute),
            Self::Census => {
                terms(search, census_codes(left), &census_codes(right), |l: u32, r: u32| (l ^ r).count_ones() as u16)
            }
            Self::Ncc => Box::new(Correlation::new(left, right, window, search, 1.0)),
            Self::NormalisedSsd => Box::new(Correlation::new(left, right, window, search, 2.0)),
            Self::NormalisedSad => Box::new(NormalisedAbsolute::new(left, right, window, search)),
        }
    }
}

/// A term of two values, one per pixel of each image.
pub(super) struct Pairwise<T, F> {
    search: Search,
    left: Vec<T>,
    /// Rows from right to left: a curve over disparities reads upwards.
    mirrored: Vec<T>,
    term: F,
}

fn terms<T, F>(search: Search, left: Vec<T>, right: &[T], term: F) -> Box<dyn Cost>
where
    T: Copy + Send + Sync + 'static,
    F: Fn(T, T) -> u16 + Send + Sync + 'static,
{
    Box::new(Pairwise { search, left, mirrored: mirrored(right, search.width()), term })
}

/// Every row from right to left.
pub(super) fn mirrored<T: Copy>(image: &[T], width: usize) -> Vec<T> {
    image.chunks(width).flat_map(|row| row.iter().rev().copied()).collect()
}

impl<T: Copy + Send + Sync, F: Fn(T, T) -> u16 + Send + Sync> Cost for Pairwise<T, F> {
    fn terms(&self, y: usize, out: &mut [u16]) {
        let (width, count) = (self.search.width(), self.search.count);
        let row = y * width..(y + 1) * width;
        let (left, mirrored) = (&self.left[row.clone()], &self.mirrored[row]);
        for (x, curve) in (self.search.first()..).zip(out.chunks_exact_mut(count)) {
            let (value, others) = (left[x], &mirrored[width - 1 - x..][..count]);
            for (term, &other) in curve.iter_mut().zip(others) {
                *term = (self.term)(value, other);
            }
        }
    }
}
