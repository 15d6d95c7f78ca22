//! Packets of pixels to a photograph: a pair as the cameras deliver it, before it is rectified.
//!
//! # Bounds
//! A photograph of more than the core's largest image is lost; at most one is held.

use core::time::Duration;
use linestereo::Dims;
use linestereo::image::{MAX_HEIGHT, MAX_WIDTH};
use linestereo_frames::GrayImage;
use linestereo_wire::{PairHead, Pixels};
use std::time::Instant;

/// Nothing more comes of a photograph, or of a board that is asked for one, after so long.
pub const PATIENCE: Duration = Duration::from_secs(5);

/// Pixels of a photograph did not arrive, or are more than there can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "pixels were lost on the way; take the photo again, or use a better cable or a lower speed"
)]
pub struct PixelsLost;

#[derive(Debug, Default)]
pub struct PhotoAssembler {
    open: Option<[GrayImage; 2]>,
    /// When the last of it arrived.
    last: Option<Instant>,
}

impl PhotoAssembler {
    /// A photograph begins; an incomplete one before it is lost.
    pub fn begin(&mut self, head: &PairHead) -> Result<(), PixelsLost> {
        let dims = Dims { width: head.width, height: head.height };
        let before = self.open.take();
        self.last = Some(Instant::now());
        if !(1..=MAX_WIDTH).contains(&dims.width) || !(1..=MAX_HEIGHT).contains(&dims.height) {
            return Err(PixelsLost);
        }
        self.open = Some([(); 2].map(|()| GrayImage { dims, pixels: Vec::new() }));
        if before.is_some() { Err(PixelsLost) } else { Ok(()) }
    }

    /// Pixels arrived: gives left and right when they are complete. One that lacks pixels is lost,
    /// and what follows of it is skipped.
    pub fn add(&mut self, pixels: &Pixels) -> Result<Option<[GrayImage; 2]>, PixelsLost> {
        let Some(pair) = &mut self.open else { return Ok(None) };
        self.last = Some(Instant::now());
        let image = &mut pair[usize::from(pixels.is_right)];
        if image.pixels.len() != pixels.first as usize
            || image.pixels.len() + pixels.list.len() > area(image.dims)
        {
            self.open = None;
            return Err(PixelsLost);
        }
        image.pixels.extend_from_slice(&pixels.list);
        let is_complete = |pair: &mut [GrayImage; 2]| {
            pair.iter().all(|image| image.pixels.len() == area(image.dims))
        };
        Ok(self.open.take_if(is_complete))
    }

    /// Has one begun that is neither complete nor lost, and does more of it come?
    pub fn is_arriving(&self) -> bool {
        self.open.is_some() && self.last.is_some_and(|last| last.elapsed() <= PATIENCE)
    }

    /// Pixels that have arrived of the open photograph, and all that it has.
    pub fn progress(&self) -> (u64, u64) {
        let [left, right] = self.open.as_ref().map_or([(0, 0); 2], |pair| {
            pair.each_ref().map(|image| (image.pixels.len() as u64, area(image.dims) as u64))
        });
        (left.0 + right.0, left.1 + right.1)
    }
}

fn area(dims: Dims) -> usize {
    usize::from(dims.width) * usize::from(dims.height)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(width: u16) -> PairHead {
        PairHead { width, height: 2, capture_time_us: 1, right_capture_time_us: None }
    }

    fn pixels(is_right: bool, first: u32, list: &[u8]) -> Pixels {
        Pixels { is_right, first, list: list.iter().copied().collect() }
    }

    #[test]
    fn a_pair_is_complete_with_its_last_pixel() {
        let mut photos = PhotoAssembler::default();
        assert_eq!(photos.add(&pixels(false, 0, &[9])), Ok(None), "joined in the middle");
        photos.begin(&head(3)).unwrap();
        assert_eq!(photos.add(&pixels(false, 0, &[1, 2, 3, 4])), Ok(None));
        assert_eq!(photos.add(&pixels(true, 0, &[5; 6])), Ok(None));
        assert!(photos.progress() == (10, 12) && photos.is_arriving());
        let [left, right] = photos.add(&pixels(false, 4, &[5, 6])).unwrap().unwrap();
        assert_eq!(
            (left.pixels, right.pixels, left.dims),
            (vec![1, 2, 3, 4, 5, 6], vec![5; 6], right.dims)
        );
        assert!(photos.progress() == (0, 0) && !photos.is_arriving());
    }

    #[test]
    fn one_that_lacks_pixels_is_lost_once() {
        let mut photos = PhotoAssembler::default();
        photos.begin(&head(3)).unwrap();
        assert_eq!(photos.add(&pixels(false, 1, &[1])), Err(PixelsLost), "the first one");
        assert_eq!(photos.add(&pixels(false, 2, &[1])), Ok(None));
        photos.begin(&head(3)).unwrap();
        assert_eq!(photos.add(&pixels(true, 0, &[0; 7])), Err(PixelsLost), "more than there are");
        photos.begin(&head(3)).unwrap();
        assert_eq!(photos.begin(&head(3)), Err(PixelsLost), "the one before");
        assert_eq!(photos.add(&pixels(true, 0, &[0; 6])), Ok(None), "of the later one");
        for width in [0, MAX_WIDTH + 1, u16::MAX] {
            assert_eq!(PhotoAssembler::default().begin(&head(width)), Err(PixelsLost), "{width}");
        }
    }
}
