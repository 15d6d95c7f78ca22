//! Boards, driven from a PC: the firmware built, run in QEMU, fed with pairs.
//!
//! ```text
//! toolchain   a compiler for boards: rustup's target, or Debian's packages (debian)
//! firmware    programs of the firmware, or of another package for boards, as ELF files
//! qemu        a run of it: files in a folder, log, exit code
//! pairs       pairs to the program replay, results back
//! numbers     what built-in pairs cost on a board, as the program selftest says: a table, and a
//!             file to send
//! ```

mod debian;
pub mod firmware;
pub mod numbers;
mod pairs;
pub mod qemu;
pub mod toolchain;

use anyhow::{Context, Result, bail};
pub use linestereo_boards::Board;
pub use pairs::{
    BoardResult, Costs, Machine, Replayed, captured, push, push_pair, push_raw_pair, update,
};
use std::path::{Path, PathBuf};

/// The top of the repository: the firmware is built from its source.
pub fn top() -> Result<PathBuf> {
    let top =
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_path_buf).unwrap_or_default();
    if !top.join("firmware/Cargo.toml").is_file() {
        bail!(
            "the firmware's source is not at {}; run this from a checkout of the \
             repository",
            top.display()
        );
    }
    Ok(top)
}

/// True when long forms of tests run and every board is built: `cargo xtask nightly` sets
/// `LINESTEREO_LONG`.
pub fn is_long() -> bool {
    std::env::var_os("LINESTEREO_LONG").is_some()
}

/// Boards that are built, tested and measured: an emulated one and one of each family of chips, or
/// all of them in the long form. The Cortex-M4 runs the same code as the Cortex-M7.
pub fn tested() -> Vec<Board> {
    let on_every_change = [Board::MPS2_AN500, Board::PICO2, Board::STM32H743];
    if is_long() { Board::ALL.into() } else { on_every_change.into() }
}

/// The emulated board of this name.
pub fn named(name: &str) -> Result<Board> {
    let names = || Board::emulated().map(|board| board.name).collect::<Vec<_>>().join(" or ");
    let board = Board::named(name)
        .with_context(|| format!("there is no board {name}; give {}", names()))?;
    if !board.is_emulated() {
        bail!("{name} is hardware, which no PC runs; give {}", names());
    }
    Ok(board)
}
