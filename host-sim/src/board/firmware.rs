//! Builds a board program, and has clippy read it.

use super::toolchain::Toolchain;
use super::{Board, top};
use crate::programs::process;
use anyhow::{Context, Result, bail};
use core::time::Duration;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

const LIMIT: Duration = Duration::from_secs(900);
/// Of boards alone, in the workspace's `Cargo.toml`.
const PROFILE: &str = "board";

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

/// Builds a program for a board as it is flashed and returns the path of its ELF file.
pub fn build(toolchain: &Toolchain, board: &Board, program: &str, logs: Logs) -> Result<PathBuf> {
    let mut built = build_all(toolchain, board, &[program], logs, &[])?;
    built.pop().with_context(|| format!("{program} was not built"))
}

/// Programs of a board that one call of cargo builds.
#[derive(Clone, Copy, Debug)]
pub struct Images {
    /// Their names.
    pub programs: &'static [&'static str],
    /// Where their logs go.
    pub logs: Logs,
    /// More features of the firmware.
    pub features: &'static [&'static str],
}

impl Images {
    /// Builds them; their paths are in the order of their names.
    pub fn build(&self, toolchain: &Toolchain, board: &Board) -> Result<Vec<PathBuf>> {
        let features: Vec<String> = self.features.iter().copied().map(str::to_owned).collect();
        build_all(toolchain, board, self.programs, self.logs, &features)
    }
}

/// The programs of a board that tests, `cargo xtask measure` and `cargo xtask footprint` use.
///
/// Emulated boards report by log what they check themselves; the rest is measured, and so without
/// logs.
#[must_use]
pub fn images(board: &Board) -> Vec<Images> {
    let of = |programs, logs, features| Images { programs, logs, features };
    let live = of(&["live"], Logs::None, &[]);
    if *board == Board::STM32H743 {
        return vec![live, of(&["live", "selftest"], Logs::None, &["still-scene"])];
    }
    if *board == Board::PORTENTA_H7 {
        return vec![live, of(&["live"], Logs::None, &["ahead"])];
    }
    if !board.is_emulated() {
        return vec![live];
    }
    let without_logs: &[&str] = if *board == Board::MPS2_AN500 {
        &["bench", "faults", "live", "pixels", "rectify", "replay"]
    } else if Board::MEASURED.contains(board) {
        &["bench", "faults", "live", "rectify", "replay"]
    } else {
        &["bench", "faults", "live"]
    };
    vec![of(&["kernels", "selftest"], Logs::Semihosting, &[]), of(without_logs, Logs::None, &[])]
}

/// One of [`images`], built in one call of cargo with all that stand beside it there.
pub fn image(board: &Board, program: &str, features: &[&str]) -> Result<PathBuf> {
    let toolchain = Toolchain::for_board(board)?;
    for images in images(board).into_iter().filter(|images| images.features == features) {
        if let Some(place) = images.programs.iter().position(|&one| one == program) {
            return Ok(images.build(&toolchain, board)?.swap_remove(place));
        }
    }
    bail!("{program} is no image of {}", board.name)
}

/// The same of several programs in one call of cargo, with more features of the firmware; their paths are in the order of their names.
///
/// All boards share one folder, so that what they have in common is built once. Calls side by side wait for each other: cargo leaves a
/// program's file at one place for all boards, from where it is copied. What this process has built before is not looked at again.
pub fn build_all(
    toolchain: &Toolchain,
    board: &Board,
    programs: &[&str],
    logs: Logs,
    features: &[String],
) -> Result<Vec<PathBuf>> {
    static BUILT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let target = target_folder(toolchain)?;
    let kind = if logs == Logs::None { "no-logs" } else { "logs" };
    let kind = [&[kind.to_owned()], features].concat().join("-");
    let folder = target.join(board.name).join(kind);
    let elfs: Vec<PathBuf> = programs.iter().map(|program| folder.join(program)).collect();
    if elfs.iter().all(|elf| built.contains(elf)) {
        return Ok(elfs);
    }
    fs::create_dir_all(&folder)?;
    let lock = fs::File::create(target.join("lock"))?;
    lock.lock()?;
    let mut command = toolchain.cargo();
    command.arg("build");
    finish(&mut command, &target, board, logs, features)?;
    command.args(programs.iter().flat_map(|program| ["--bin", program]));
    run(&mut command, &format!("cannot build {} for {}", programs.join(", "), board.name))?;
    for (program, elf) in programs.iter().zip(&elfs) {
        // Renamed into place: another process may be running the one before it.
        let copy = tempfile::NamedTempFile::new_in(&folder)?;
        fs::copy(target.join(board.target).join(PROFILE).join(program), copy.path())
            .with_context(|| format!("cannot write {}", elf.display()))?;
        copy.persist(elf)?;
        built.insert(elf.clone());
    }
    Ok(elfs)
}

/// Has clippy read the library and these programs as a board builds them with these features: much of both is for boards only, and nothing on a PC sees it.
/// Warnings are errors.
pub fn lint(toolchain: &Toolchain, board: &Board, programs: &[String], logs: Logs, features: &[String]) -> Result<()> {
    let mut command = toolchain.clippy()?;
    finish(&mut command, &target_folder(toolchain)?, board, logs, features)?;
    command.arg("--lib");
    for program in programs {
        command.args(["--bin", program]);
    }
    command.args(["--", "-D", "warnings"]);
    run(&mut command, &format!("clippy for {}", board.name))
}

/// Cargo does not notice another library of the same compiler version: a folder per way.
fn target_folder(toolchain: &Toolchain) -> Result<PathBuf> {
    let target = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| Ok(top()?.join("target")), |path| anyhow::Ok(path.into()))?;
    Ok(std::path::absolute(target)?.join(format!("boards-{}", toolchain.way)))
}

/// LLVM copies less code into its callers: functions marked `#[inline]` up to a cost of 30 instead of 325, others up to 120 instead of 225 (at "s" 50, as
/// ever). Less flash for under 1 % of instructions (docs/design.md); what is hot and small says `#[inline(always)]`. Added to the flags of
/// `.cargo/config.toml`.
const INLINING: &str = "target.'cfg(target_os = \"none\")'.rustflags = \
    [\"-Cllvm-args=-inlinehint-threshold=30\", \"-Cllvm-args=-inlinedefault-threshold=120\"]";

/// Arguments of every command about a board's programs.
fn finish(command: &mut Command, target: &Path, board: &Board, logs: Logs, features: &[String]) -> Result<()> {
    let logs: &[&str] = match logs {
        Logs::None => &[],
        Logs::Semihosting => &["log-semihosting"],
        Logs::Rtt => &["log-rtt"],
    };
    let features: Vec<&str> =
        [board.name].into_iter().chain(logs.iter().copied()).chain(features.iter().map(String::as_str)).collect();
    command
        .current_dir(top()?)
        .args(["--quiet", "--profile", PROFILE, "--locked", "-p", "linestereo-firmware", "--no-default-features"])
        .args(["--config", INLINING])
        .args(["--target", board.target, "--features", &features.join(","), "--target-dir"])
        .arg(target)
        .env("DEFMT_LOG", "info"); // at build time, or nothing is logged
    Ok(())
}

fn run(command: &mut Command, what: &str) -> Result<()> {
    let outcome = process::run(command, LIMIT)?;
    if !outcome.status.success() {
        let error = outcome.stderr.lines().find(|line| line.starts_with("error")).unwrap_or("it failed");
        eprintln!("{}", outcome.stderr);
        bail!("{what}: {error}");
    }
    Ok(())
}
