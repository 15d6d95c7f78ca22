//! Boards for tests: emulated where a compiler and QEMU can be had.

use linestereo::{Matcher, Options, Params, Region};
use linestereo_boards::Board;
use linestereo_firmware::boards::{mps2_an386, mps2_an500};
use linestereo_firmware::memory::{Memory, PairError};
use linestereo_frames::GrayImage;
use linestereo_sim::board::{Machine, firmware, tested};
use linestereo_sim::engine::FrameResult;
use linestereo_wire::{Health, ObjectRecord};
use std::io::Write;
use std::path::PathBuf;

/// Value of `made`. Where boards cannot be built it says so and the test is skipped, unless
/// somebody counts on it: then it fails.
///
/// # Panics
/// When it failed, and `CI` or `LINESTEREO_TOOLCHAIN` is set.
pub fn or_skip<T>(made: anyhow::Result<T>) -> Option<T> {
    match made {
        Ok(made) => Some(made),
        Err(error) => {
            let counted_on =
                ["CI", "LINESTEREO_TOOLCHAIN"].iter().any(|name| std::env::var_os(name).is_some());
            assert!(!counted_on, "{error:#}");
            // Not by a macro: those are silent in tests that pass.
            let _ = writeln!(std::io::stderr(), "\nSKIPPED, no boards here: {error:#}\n");
            None
        }
    }
}

/// Runs a test on every emulated board that is tested, side by side: each QEMU takes one core.
pub fn on_every_board(test: impl Fn(Board) + Sync) {
    let test = &test;
    std::thread::scope(|scope| {
        for board in tested().into_iter().filter(Board::is_emulated) {
            scope.spawn(move || test(board));
        }
    });
}

/// Of [`Board::MEASURED`], which have every program, those that are tested.
pub fn measured() -> impl Iterator<Item = Board> {
    tested().into_iter().filter(|board| Board::MEASURED.contains(board))
}

/// The ELF file of a program that boards are tested with, or none where boards cannot be built.
pub fn image(board: &Board, program: &str) -> Option<PathBuf> {
    or_skip(firmware::image(board, program))
}

/// A board's program `replay`, or none where boards cannot be built.
pub fn machine(board: Board) -> Option<Machine> {
    image(&board, "replay")?;
    or_skip(Machine::new(board))
}

/// The core on this machine, with the memory of a board.
pub enum Twin {
    /// Of the larger board.
    An500(Box<mps2_an500::BoardMemory>),
    /// Of the smaller one.
    An386(Box<mps2_an386::BoardMemory>),
}

impl Twin {
    /// Of this board.
    ///
    /// # Panics
    /// When the board has no memory known here.
    pub fn of(board: &Board) -> Self {
        if *board == mps2_an500::BOARD {
            return Self::An500(Box::new(mps2_an500::BoardMemory::CLEARED));
        }
        assert_eq!(*board, mps2_an386::BOARD);
        Self::An386(Box::new(mps2_an386::BoardMemory::CLEARED))
    }

    /// Matches a pair that stands alone.
    pub fn run(
        &mut self,
        params: &Params,
        left: &GrayImage,
        right: &GrayImage,
    ) -> Result<FrameResult, PairError> {
        let matcher = Matcher::new(*params, left.dims);
        let mut matcher = matcher.map_err(|_| PairError::Size(left.dims))?;
        self.run_next(&mut matcher, [left, right], &[]).map(|(result, _)| result)
    }

    /// Matches the next pair of a rig, and finds the depths of these objects in it.
    pub fn run_next(
        &mut self,
        matcher: &mut Matcher,
        pair: [&GrayImage; 2],
        objects: &[Region<'_>],
    ) -> Result<(FrameResult, Vec<ObjectRecord>), PairError> {
        match self {
            Self::An500(memory) => run(&mut **memory, matcher, pair, objects),
            Self::An386(memory) => run(&mut **memory, matcher, pair, objects),
        }
    }
}

fn run(
    memory: &mut impl Memory,
    matcher: &mut Matcher,
    pair: [&GrayImage; 2],
    objects: &[Region<'_>],
) -> Result<(FrameResult, Vec<ObjectRecord>), PairError> {
    let dims = matcher.dims();
    if !memory.fits(dims) {
        return Err(PairError::Size(dims));
    }
    for (frame, image) in memory.frames().into_iter().zip(pair) {
        frame[..image.pixels.len()].copy_from_slice(&image.pixels);
    }
    let mut matched = memory.run(None, matcher, Options::default())?;
    let points = matched.points().collect();
    let health = matched.health();
    let mut result = FrameResult {
        matches: matched.segments().to_vec(),
        points,
        obstacle_points: matched.obstacle_points().collect(),
        bars: matched.bars().to_vec(),
        counts: matched.counts().into(),
        health: Health::of(matched.counts()) | health.flags.into(),
        pair: Some(health.into()),
        ground: matched.ground(),
        exchanged: None,
    };
    result.counts.points = result.points.len() as u32;
    let object = |region: &Region<'_>| ObjectRecord::new(region.label(), &matched.object(region));
    Ok((result, objects.iter().map(object).collect()))
}
