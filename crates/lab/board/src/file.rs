//! Block matching on the pairs of a file: instructions, and a digest of all disparities.
//!
//! In: pairs, one after the other: width, height and number of disparities, each as two bytes,
//! lower one first, then the pixels of the left and of the right image. Out: a line for each pair
//! and method: cost, number of disparities found, digest; separated by tabs.
//!
//! The same code runs on a board, by the kernels for its processor, and on a PC, by the portable
//! ones.

use crate::{GridMemory, Misfit, NO_DISPARITY, Settings, grid_groups};
use core::fmt;
use linestereo::unstable::Fnv;
use linestereo::{Dims, Gray};
use linestereo_boards::Board;
use linestereo_firmware::ports::{ByteSource, Clock};

/// The board.
pub const BOARD: Board = Board::MPS2_AN500;
const WIDTH: usize = BOARD.largest.width as usize;

type Grid = GridMemory<WIDTH, { grid_groups(WIDTH, Settings::USUAL.disparities) }>;

/// Names and settings.
pub const METHODS: [(&str, Settings); 2] =
    [("usual", Settings::USUAL), ("strict", Settings::STRICT)];

/// Two frames and the memory of the matcher.
#[derive(Debug)]
pub struct Matcher {
    frames: [[u8; BOARD.pixels()]; 2],
    grid: Grid,
}

impl Matcher {
    /// Bytes beside the frames.
    pub const BYTES: usize = size_of::<Grid>();

    /// Cleared memory.
    #[expect(
        clippy::new_without_default,
        reason = "it is too large to be made but in a static or a box"
    )]
    pub const fn new() -> Self {
        Self { frames: [[0; BOARD.pixels()]; 2], grid: Grid::new() }
    }

    /// Matches every pair of a file and writes the table.
    pub fn run(
        &mut self,
        clock: &impl Clock,
        pairs: &mut impl ByteSource,
        table: &mut impl fmt::Write,
    ) -> Result<(), Misfit> {
        while let Some((dims, disparities)) = self.read(pairs) {
            for (_, settings) in METHODS {
                self.line(clock, dims, &Settings { disparities, ..settings }, table)?;
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
        settings: &Settings,
        table: &mut impl fmt::Write,
    ) -> Result<(), Misfit> {
        let [left, right] = &self.frames;
        let view = |frame| Gray::new(frame, dims, dims.width.into()).map_err(|_| Misfit);
        let pair = [view(left)?, view(right)?];
        let (mut cost, mut found, mut digest) = (0, 0_u32, Fnv::EMPTY);
        let mut last = clock.now();
        self.grid.run(settings, pair, &mut |_, disparities| {
            cost += clock.elapsed(last, clock.now());
            for &disparity in disparities {
                found += u32::from(disparity != NO_DISPARITY);
                digest.write(&disparity.to_le_bytes());
            }
            last = clock.now();
        })?;
        cost += clock.elapsed(last, clock.now());
        let _ = writeln!(table, "{cost}\t{found}\t{:08x}", digest.value());
        Ok(())
    }
}
