//! Frames, rectifiers and working memory of a board, with its capacities in the type.
//!
//! ```text
//! raw row -> raw_row -> rectifier of its camera (mesh, band of raw rows) -> frame
//! both frames, the core's memory -> matched pair
//! ```

mod rectifier;

pub use rectifier::{CameraRows, NoRoom, Rectifier};

use core::ops::DerefMut;
use linestereo::image::{MAX_WIDTH, ViewError};
use linestereo::{Capacity, Cores, Dims, Gray, Matched, Matcher, MemorySlice, Options};
use linestereo_boards::Board;
use linestereo_rig::{CameraSide, Remap, RowError};

/// Capacity of the core's memory on a board.
pub const fn capacity(board: &Board) -> Capacity {
    assert!(board.largest.width <= MAX_WIDTH, "wide frames need the feature `linestereo/wide`");
    Capacity {
        segments: board.segments as u16,
        two_cores: board.two_cores,
        ..Capacity::new(board.largest)
    }
}

/// All memory of one board that depends on the size of frames: `C` is the core's, `R` rectifies a
/// camera's rows. All zero when new, so that it takes no flash.
#[derive(Debug)]
pub struct BoardMemory<const PIXELS: usize, const RAW_ROW: usize, C, R> {
    frames: [[u8; PIXELS]; 2],
    core: C,
    rectifiers: [R; 2],
    /// A raw row between its camera and the band; as wide as the rig's raw images.
    raw_row: [u8; RAW_ROW],
    raw_width: u16,
    /// The frames come from the rectifiers.
    is_raw: bool,
}

/// A [`BoardMemory`] without its capacities.
pub trait Memory {
    /// Do rectified frames of this size fit?
    fn fits(&self, dims: Dims) -> bool;

    /// The memories of the left and the right frame.
    fn frames(&mut self) -> [&mut [u8]; 2];

    /// The pair that lies in the frames.
    fn views(&self, dims: Dims) -> Result<[Gray<'_>; 2], PairError>;

    /// Matches the pair that lies in the frames, or the areas of the options once a whole pair has
    /// said how far the rows are apart; on two cores where they are lent.
    fn run(
        &mut self,
        cores: Option<&mut dyn Cores>,
        matcher: &mut Matcher,
        options: Options<'_>,
    ) -> Result<Matched<'_>, PairError>;

    /// Makes ready to rectify raw pairs. After an error no raw row is taken.
    fn set_rig(&mut self, remap: &Remap) -> Result<(), NoRoom>;

    /// The next raw rows are the first ones of a pair.
    fn restart(&mut self);

    /// The next raw row of this camera is the first one of a frame; the other camera goes on.
    fn restart_camera(&mut self, eye: CameraSide);

    /// Where the next raw row has to be put; empty without a rig.
    fn raw_row(&mut self) -> &mut [u8];

    /// Rectifies the raw row that was put there, the next one of this camera.
    fn push_row(&mut self, eye: CameraSide) -> Result<(), RowError>;

    /// Are both frames rectified?
    fn is_rectified(&self) -> bool;
}

/// Why a pair that lies in the frames cannot be matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairError {
    /// The core or this board has no frames of this size.
    Size(Dims),
    /// A memory is too small for it, or its usable pixels are those of another rig.
    NoRoom(NoRoom),
}

impl From<ViewError> for PairError {
    fn from(error: ViewError) -> Self {
        match error {
            ViewError::Dims(dims) => Self::Size(dims),
            ViewError::TooShort { needed, given } => {
                Self::NoRoom(NoRoom::Small { name: "frame", needed, given })
            }
            _ => Self::NoRoom(NoRoom::NothingSeen),
        }
    }
}

impl From<linestereo::RunError> for PairError {
    fn from(error: linestereo::RunError) -> Self {
        match error {
            linestereo::RunError::SizeMismatch { given, .. } => Self::Size(given),
            linestereo::RunError::MemoryTooSmall { needed, given } => {
                Self::NoRoom(NoRoom::Small { name: "words", needed, given })
            }
            _ => Self::NoRoom(NoRoom::NothingSeen),
        }
    }
}

impl<
    const PIXELS: usize,
    const RAW_ROW: usize,
    const WORDS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    R: Rectifier,
> BoardMemory<PIXELS, RAW_ROW, linestereo::Memory<WORDS, SEGMENTS, CANDIDATES>, R>
{
    /// Bytes of one.
    pub const BYTES: usize = size_of::<Self>();
    /// Of these, bytes that the core works in.
    pub const CORE: usize = linestereo::Memory::<WORDS, SEGMENTS, CANDIDATES>::BYTES;

    /// Cleared memory.
    pub const CLEARED: Self = Self {
        frames: [[0; PIXELS]; 2],
        core: linestereo::Memory::new(),
        rectifiers: [R::CLEARED, R::CLEARED],
        raw_row: [0; RAW_ROW],
        raw_width: 0,
        is_raw: false,
    };
}

impl<const PIXELS: usize, const RAW_ROW: usize, C, R> Memory for BoardMemory<PIXELS, RAW_ROW, C, R>
where
    C: DerefMut<Target = MemorySlice>,
    R: Rectifier,
{
    fn fits(&self, dims: Dims) -> bool {
        usize::from(dims.width) * usize::from(dims.height) <= PIXELS
    }

    fn frames(&mut self) -> [&mut [u8]; 2] {
        self.is_raw = false;
        self.frames.each_mut().map(<[u8; PIXELS]>::as_mut_slice)
    }

    fn views(&self, dims: Dims) -> Result<[Gray<'_>; 2], PairError> {
        if !self.fits(dims) {
            return Err(PairError::Size(dims));
        }
        views(&self.frames, &self.rectifiers, self.is_raw, dims)
    }

    fn run(
        &mut self,
        cores: Option<&mut dyn Cores>,
        matcher: &mut Matcher,
        mut options: Options<'_>,
    ) -> Result<Matched<'_>, PairError> {
        let dims = matcher.dims();
        if !self.fits(dims) {
            return Err(PairError::Size(dims));
        }
        let [left, right] = views(&self.frames, &self.rectifiers, self.is_raw, dims)?;
        options.areas = options.areas.filter(|_| matcher.knows_rows());
        Ok(match cores {
            Some(mut cores) => matcher.run_on(&mut cores, &mut self.core, left, right, options)?,
            None => matcher.run_with(&mut self.core, left, right, options)?,
        })
    }

    fn set_rig(&mut self, remap: &Remap) -> Result<(), NoRoom> {
        self.raw_width = 0;
        let width = remap.raw_dims().width;
        if usize::from(width) > RAW_ROW {
            return Err(NoRoom::Small { name: "raw row", needed: width.into(), given: RAW_ROW });
        }
        for (rectifier, eye) in self.rectifiers.iter_mut().zip(CameraSide::BOTH) {
            rectifier.build(remap, eye)?;
        }
        self.raw_width = width;
        Ok(())
    }

    fn restart(&mut self) {
        self.is_raw = true;
        self.rectifiers.iter_mut().for_each(R::restart);
    }

    fn restart_camera(&mut self, eye: CameraSide) {
        self.is_raw = true;
        of(eye, &mut self.rectifiers).restart();
    }

    fn raw_row(&mut self) -> &mut [u8] {
        self.raw_row.get_mut(..self.raw_width.into()).unwrap_or_default()
    }

    fn push_row(&mut self, eye: CameraSide) -> Result<(), RowError> {
        let row = self.raw_row.get(..self.raw_width.into()).unwrap_or_default();
        if row.is_empty() {
            return Err(RowError::NoMesh);
        }
        let frame = of(eye, &mut self.frames);
        of(eye, &mut self.rectifiers).push(row, frame)
    }

    fn is_rectified(&self) -> bool {
        self.raw_width > 0 && self.rectifiers.iter().all(R::is_complete)
    }
}

/// The pair in the frames; of one that comes from the rectifiers, the pixels that may be used.
fn views<'a, const PIXELS: usize, R: Rectifier>(
    [left, right]: &'a [[u8; PIXELS]; 2],
    [of_left, of_right]: &'a [R; 2],
    is_raw: bool,
    dims: Dims,
) -> Result<[Gray<'a>; 2], PairError> {
    let view = |pixels: &'a [u8], rectifier: &'a R| {
        let view = Gray::new(pixels, dims, dims.width.into())?;
        let valid = if is_raw { rectifier.valid() } else { &[] };
        if valid.is_empty() { Ok(view) } else { view.with_valid(valid) }
    };
    Ok([view(left, of_left)?, view(right, of_right)?])
}

/// One of two, by the camera that it is of.
pub(crate) fn of<T>(eye: CameraSide, [left, right]: &mut [T; 2]) -> &mut T {
    match eye {
        CameraSide::Left => left,
        CameraSide::Right => right,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::refusal;
    use linestereo_wire::{Refusal, RigFault};

    #[test]
    fn every_error_is_refused_in_its_own_words() {
        let of_core = |error: linestereo::RunError| refusal(error.into()).to_string();
        let small = linestereo::RunError::MemoryTooSmall { needed: 9, given: 4 };
        assert_eq!(of_core(small), "words of the board's memory holds 4, these images need 9");
        let [planned, given] = [320, 8].map(|width| Dims { width, height: 240 });
        assert!(
            of_core(linestereo::RunError::SizeMismatch { planned, given })
                .starts_with("width is 8")
        );
        let of_view = |error: ViewError| refusal(error.into());
        let short = of_view(ViewError::TooShort { needed: 9, given: 4 }).to_string();
        assert_eq!(short, "frame of the board's memory holds 4, these images need 9");
        assert_eq!(of_view(ViewError::Spans { rows: 9, given: 4 }), Refusal::Rig(RigFault::View));
        assert!(of_view(ViewError::Dims(given)).to_string().starts_with("width is 8"));
    }
}
