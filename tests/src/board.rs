//! Boards for tests: emulated where a compiler and QEMU can be had.

use core::any::Any;
use linestereo::Matcher;
use linestereo_baselines::GrayImage;
use linestereo_boards::Board;
use linestereo_firmware::boards::{mps2_an386, mps2_an500};
use linestereo_firmware::memory::{Memory, RunError};
use linestereo_sim::board::{Machine, firmware};
use linestereo_sim::engine::FrameResult;
use linestereo_wire::Health;
use std::io::Write;
use std::path::PathBuf;

/// Value of `made`. Where boards cannot be built it says so and the test is skipped, unless somebody counts on it: then it fails.
///
/// # Panics
/// When it failed, and `CI` or `LINESTEREO_TOOLCHAIN` is set.
pub fn or_skip<T>(made: anyhow::Result<T>) -> Option<T> {
    match made {
        Ok(made) => Some(made),
        Err(error) => {
            let counted_on = ["CI", "LINESTEREO_TOOLCHAIN"].iter().any(|name| std::env::var_os(name).is_some());
            assert!(!counted_on, "{error:#}");
            // Not by a macro: those are silent in tests that pass.
            let _ = writeln!(std::io::stderr(), "\nSKIPPED, no boards here: {error:#}\n");
            None
        }
    }
}

/// True when everything is tested on every board (`LINESTEREO_LONG` is set, as in CI), false for some of each kind.
#[must_use]
pub fn on_all() -> bool {
    std::env::var_os("LINESTEREO_LONG").is_some()
}

/// Runs a test on every emulated board, side by side: each QEMU takes one core. Without [`on_all`], on those that are measured.
pub fn on_every_board(test: impl Fn(Board) + Sync) {
    let test = &test;
    std::thread::scope(|scope| {
        for board in Board::emulated().filter(|board| on_all() || Board::MEASURED.contains(board)) {
            scope.spawn(move || test(board));
        }
    });
}

/// The ELF file of a program that boards are tested with, or none where boards cannot be built.
#[must_use]
pub fn image(board: &Board, program: &str) -> Option<PathBuf> {
    or_skip(firmware::image(board, program))
}

/// A board's program `replay`, or none where boards cannot be built.
#[must_use]
pub fn machine(board: Board) -> Option<Machine> {
    image(&board, "replay")?;
    or_skip(Machine::new(board))
}

/// The core on this machine, with the memory of a board.
pub struct Twin(Box<dyn Any>);

impl Twin {
    /// Of this board.
    ///
    /// # Panics
    /// When the board has no memory known here.
    #[must_use]
    pub fn of(board: &Board) -> Self {
        if *board == mps2_an500::BOARD {
            return Self(Box::new(mps2_an500::Workspace::new()));
        }
        assert_eq!(*board, mps2_an386::BOARD);
        Self(Box::new(mps2_an386::Workspace::new()))
    }

    /// Matches a pair.
    pub fn run(
        &mut self,
        params: &linestereo::Params,
        left: &GrayImage,
        right: &GrayImage,
    ) -> Result<FrameResult, RunError> {
        match self.0.downcast_mut::<mps2_an500::Workspace>() {
            Some(large) => run(large, params, left, right),
            None => match self.0.downcast_mut::<mps2_an386::Workspace>() {
                Some(small) => run(small, params, left, right),
                None => Err(RunError::Size(left.dims)),
            },
        }
    }
}

fn run(
    memory: &mut impl Memory,
    params: &linestereo::Params,
    left: &GrayImage,
    right: &GrayImage,
) -> Result<FrameResult, RunError> {
    if !memory.fits(left.dims) {
        return Err(RunError::Size(left.dims));
    }
    for (frame, image) in memory.frames().into_iter().zip([left, right]) {
        frame[..image.pixels.len()].copy_from_slice(&image.pixels);
    }
    let plan = params.plan(left.dims).map_err(|_| RunError::Size(left.dims))?;
    let mut matched = memory.run(&mut Matcher::new(plan), None, None, &mut ())?;
    let mut points = Vec::new();
    matched.points(|point| points.push(point));
    let health = matched.health();
    let mut result = FrameResult {
        matches: matched.segments().to_vec(),
        points,
        counts: matched.counts().into(),
        health: Health::of(matched.counts()) | health.flags.into(),
        pair: Some(health.into()),
    };
    result.counts.points = result.points.len() as u32;
    Ok(result)
}
