//! Builds a board program.

use super::toolchain::Toolchain;
use super::{Board, process, top};
use anyhow::{Context, Result, bail};
use core::time::Duration;
use std::fs;
use std::path::PathBuf;

const LIMIT: Duration = Duration::from_secs(900);

/// Where a program's logs go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Logs {
    /// It has none.
    None,
    /// To the PC that runs QEMU.
    Semihosting,
    /// To a debugger, through the memory of a board.
    Rtt,
}

impl Logs {
    /// Where those of a board go.
    #[must_use]
    pub const fn of(board: &Board) -> Self {
        if board.is_emulated() { Self::Semihosting } else { Self::Rtt }
    }
}

/// Builds a program for a board in release and returns the path of its ELF file.
///
/// Side by side calls wait for each other: a build leaves its file at one place for all boards, from where it is copied.
pub fn build(toolchain: &Toolchain, board: &Board, program: &str, logs: Logs) -> Result<PathBuf> {
    let top = top()?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| top.join("target"), PathBuf::from);
    // Cargo does not notice another library of the same compiler version: a folder per way.
    let target = std::path::absolute(target)?.join(format!("boards-{}", toolchain.way));
    let (features, kind) = match logs {
        Logs::None => (board.name.to_owned(), "no-logs"),
        Logs::Semihosting => (format!("{},log-semihosting", board.name), "logs"),
        Logs::Rtt => (format!("{},log-rtt", board.name), "logs"),
    };
    fs::create_dir_all(target.join(board.name).join(kind))?;
    let lock = fs::File::create(target.join("lock"))?;
    lock.lock()?;
    let mut command = toolchain.cargo();
    command
        .current_dir(&top)
        .args(["build", "--quiet", "--release", "--locked", "-p", "linestereo-firmware", "--no-default-features"])
        .args(["--target", board.target, "--features", &features, "--bin", program, "--target-dir"])
        .arg(&target)
        .env("DEFMT_LOG", "info"); // at build time, or nothing is logged
    let outcome = process::run(&mut command, LIMIT)?;
    if !outcome.status.success() {
        let error = outcome.stderr.lines().find(|line| line.starts_with("error")).unwrap_or("it failed");
        eprintln!("{}", outcome.stderr);
        bail!("cannot build {program} for {}: {error}", board.name);
    }
    let folder = target.join(board.name).join(kind);
    let elf = folder.join(program);
    // Renamed into place: another call may be running the one before it.
    let copy = tempfile::NamedTempFile::new_in(&folder)?;
    fs::copy(target.join(board.target).join("release").join(program), copy.path())
        .with_context(|| format!("cannot write {}", elf.display()))?;
    copy.persist(&elf)?;
    Ok(elf)
}
