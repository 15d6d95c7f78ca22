//! Block matching on the pairs of a file: instructions, and a digest of all disparities.
//!
//! In: pairs, one after the other: width, height and number of disparities, each as two bytes,
//! lower one first, then the pixels of the left and of the right image. Out: a line for each pair
//! and method: cost, number of disparities found, digest; separated by tabs.
//!
//! The same code runs on a board, by the kernels for its processor, and on a PC, by the portable
//! ones.
#![no_std]
#![deny(missing_debug_implementations)]

use core::fmt;
use linestereo::diagnostics::Fnv;
use linestereo::{Dims, Gray};
use linestereo_block_matching::{
    DenseMemory, GridMemory, Misfit, NO_DISPARITY, Settings, dense_groups, grid_groups,
};
use linestereo_boards::Board;
use linestereo_firmware::ports::{ByteSource, Clock};

/// The board.
pub const BOARD: Board = Board::MPS2_AN500;
const WIDTH: usize = BOARD.largest.width as usize;
/// Number of disparities of a measured pair.
pub const DISPARITIES: usize = Settings::USUAL.disparities;

type Dense = DenseMemory<WIDTH, { dense_groups(WIDTH, DISPARITIES) }>;
type Grid = GridMemory<WIDTH, { grid_groups(WIDTH, DISPARITIES) }>;

/// Which pixels of a pair are matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// Every pixel.
    Dense,
    /// Every fourth pixel of every fourth row.
    Grid,
}

/// A way to match: its name, the pixels, the settings.
pub const METHODS: [(&str, Sampling, Settings); 4] = [
    ("dense", Sampling::Dense, Settings::USUAL),
    ("dense-strict", Sampling::Dense, Settings::STRICT),
    ("grid", Sampling::Grid, Settings::USUAL),
    ("grid-strict", Sampling::Grid, Settings::STRICT),
];

/// Two frames and the memory of both matchers.
#[derive(Debug)]
pub struct Matchers {
    frames: [[u8; BOARD.pixels()]; 2],
    dense: Dense,
    grid: Grid,
}

impl Matchers {
    /// Bytes of the dense matcher's memory, and of the grid's.
    pub const BYTES: [usize; 2] = [Dense::BYTES, Grid::BYTES];

    /// Cleared memory.
    #[must_use]
    #[expect(
        clippy::new_without_default,
        reason = "it is too large to be made but in a static or a box"
    )]
    pub const fn new() -> Self {
        Self { frames: [[0; BOARD.pixels()]; 2], dense: Dense::new(), grid: Grid::new() }
    }

    /// Matches every pair of a file and writes the table.
    pub fn run(
        &mut self,
        clock: &impl Clock,
        pairs: &mut impl ByteSource,
        table: &mut impl fmt::Write,
    ) -> Result<(), Misfit> {
        while let Some((dims, disparities)) = self.read(pairs) {
            for (_, sampling, settings) in METHODS {
                let line =
                    self.line(clock, dims, sampling, &Settings { disparities, ..settings })?;
                let _ = writeln!(table, "{line}");
            }
        }
        Ok(())
    }

    /// Reads the next pair into the frames. Returns its size and number of disparities; `None` at
    /// the end, or if it does not fit.
    fn read(&mut self, pairs: &mut impl ByteSource) -> Option<(Dims, usize)> {
        let mut head = [0; 6];
        if pairs.read(&mut head) < head.len() {
            return None;
        }
        let [a, b, c, d, e, f] = head;
        let [width, height, disparities] = [[a, b], [c, d], [e, f]].map(u16::from_le_bytes);
        let pixels = usize::from(width) * usize::from(height);
        for frame in &mut self.frames {
            let frame = frame.get_mut(..pixels)?;
            if pairs.read(frame) < pixels {
                return None;
            }
        }
        Some((Dims { width, height }, disparities.into()))
    }

    /// Matches the pair in the frames. Counting and the digest are left out of the cost.
    fn line(
        &mut self,
        clock: &impl Clock,
        dims: Dims,
        sampling: Sampling,
        settings: &Settings,
    ) -> Result<Line, Misfit> {
        let [left, right] = &self.frames;
        let view =
            |frame| Gray::new(frame, dims, dims.width.into()).map_err(|_| Misfit::Size(dims));
        let pair = [view(left)?, view(right)?];
        let mut line = Line { cost: 0, found: 0, digest: 0 };
        let mut digest = Fnv::EMPTY;
        let mut last = clock.now();
        let mut row = |_: usize, disparities: &[i16]| {
            line.cost += clock.elapsed(last, clock.now());
            for &disparity in disparities {
                line.found += u32::from(disparity != NO_DISPARITY);
                digest.write(&disparity.to_le_bytes());
            }
            last = clock.now();
        };
        match sampling {
            Sampling::Dense => self.dense.run(settings, pair, &mut row)?,
            Sampling::Grid => self.grid.run(settings, pair, &mut row)?,
        }
        line.cost += clock.elapsed(last, clock.now());
        line.digest = digest.value();
        Ok(line)
    }
}

/// Line of the table.
struct Line {
    cost: u64,
    found: u32,
    digest: u32,
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\t{}\t{:08x}", self.cost, self.found, self.digest)
    }
}
