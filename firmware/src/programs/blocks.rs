//! Cost of block matching, and its bytes.
//!
//! In: pairs that are painted or come from a file. Out: for dense matching and for the grid, usual and strict, instructions, disparities and a digest.
//!
//! A file holds pairs one after the other: width and height in two bytes each, the lower one first, then the pixels of the left and of the
//! right image.

use crate::ports::{ByteSource, Clock};
use core::fmt;
use linestereo::diagnostics::Fnv;
use linestereo::{Dims, Gray};
use linestereo_block_matching::{DenseMemory, GridMemory, Misfit, NO_DISPARITY, Settings, dense_groups, grid_groups};

/// Groups of both matchers' memory for images of this width: `DENSE` and `GRID` of a [`Workspace`].
#[must_use]
pub const fn groups(width: usize) -> (usize, usize) {
    let disparities = Settings::STRICT.disparities;
    (dense_groups(width, disparities), grid_groups(width, disparities))
}

/// Frames of `PIXELS` each, at most `WIDTH` px wide, and the memory of both matchers: [`groups`].
#[derive(Debug)]
pub struct Workspace<const WIDTH: usize, const PIXELS: usize, const DENSE: usize, const GRID: usize> {
    frames: [[u8; PIXELS]; 2],
    dense: DenseMemory<WIDTH, DENSE>,
    grid: GridMemory<WIDTH, GRID>,
}

/// How the pixels of a pair are matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matcher {
    /// Every pixel.
    Dense,
    /// Every fourth pixel of every fourth row.
    Grid,
}

/// A measurement: a name, the matcher, what it believes.
pub const METHODS: [(&str, Matcher, Settings); 4] = [
    ("dense", Matcher::Dense, Settings::USUAL),
    ("dense-strict", Matcher::Dense, Settings::STRICT),
    ("grid", Matcher::Grid, Settings::USUAL),
    ("grid-strict", Matcher::Grid, Settings::STRICT),
];

/// Result of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measured {
    /// Pixels with a disparity.
    pub values: u32,
    /// Of all disparities (FNV-1a).
    pub digest: u32,
    /// Cost in the unit of the clock.
    pub cost: u64,
}

impl<const WIDTH: usize, const PIXELS: usize, const DENSE: usize, const GRID: usize>
    Workspace<WIDTH, PIXELS, DENSE, GRID>
{
    /// Bytes of the dense matcher's memory, and of the grid's.
    pub const BYTES: [usize; 2] = [DenseMemory::<WIDTH, DENSE>::BYTES, GridMemory::<WIDTH, GRID>::BYTES];

    /// Cleared memory.
    #[must_use]
    #[expect(clippy::new_without_default, reason = "it is too large to be made but in a static or a box")]
    pub const fn new() -> Self {
        Self { frames: [[0; PIXELS]; 2], dense: DenseMemory::new(), grid: GridMemory::new() }
    }

    /// The memories of the left and the right frame.
    pub fn frames(&mut self) -> [&mut [u8]; 2] {
        self.frames.each_mut().map(<[u8; PIXELS]>::as_mut_slice)
    }

    /// Reads the next pair of a file into the frames; `None` at its end, or where a pair does not fit.
    pub fn read(&mut self, file: &mut impl ByteSource) -> Option<Dims> {
        let mut head = [0; 4];
        if file.read(&mut head) < head.len() {
            return None;
        }
        let [a, b, c, d] = head;
        let dims = Dims { width: u16::from_le_bytes([a, b]), height: u16::from_le_bytes([c, d]) };
        let pixels = usize::from(dims.width) * usize::from(dims.height);
        let mut is_whole = true;
        for frame in self.frames() {
            let frame = frame.get_mut(..pixels)?;
            is_whole &= file.read(frame) == pixels;
        }
        is_whole.then_some(dims)
    }

    /// Matches the pair that lies in the frames. Counting and the digest are left out of the cost.
    pub fn measure(
        &mut self,
        clock: &impl Clock,
        dims: Dims,
        matcher: Matcher,
        settings: &Settings,
    ) -> Result<Measured, Misfit> {
        let [left, right] = &self.frames;
        let view = |frame| Gray::new(frame, dims, dims.width.into()).map_err(|_| Misfit::Size(dims));
        let pair = [view(left)?, view(right)?];
        let mut measured = Measured { values: 0, digest: 0, cost: 0 };
        let mut digest = Fnv::EMPTY;
        let mut last = clock.now();
        let mut row = |_: usize, disparities: &[i16]| {
            measured.cost += clock.elapsed(last, clock.now());
            for &disparity in disparities {
                measured.values += u32::from(disparity != NO_DISPARITY);
                digest.write(&disparity.to_le_bytes());
            }
            last = clock.now();
        };
        match matcher {
            Matcher::Dense => self.dense.run(settings, pair, &mut row)?,
            Matcher::Grid => self.grid.run(settings, pair, &mut row)?,
        }
        measured.cost += clock.elapsed(last, clock.now());
        measured.digest = digest.value();
        Ok(measured)
    }
}

/// One line of the table that the PC reads: what, names of pair and method, cost, number, digest; separated by tabs.
pub fn line(out: &mut impl fmt::Write, pair: impl fmt::Display, method: &str, measured: &Measured) {
    let Measured { values, digest, cost } = measured;
    let _ = writeln!(out, "blocks\t{pair}\t{method}\t{cost}\t{values}\t{digest:08x}");
}
