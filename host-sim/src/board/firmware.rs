//! Builds board programs, and has clippy read them.

use super::toolchain::Toolchain;
use super::{Board, top};
use crate::output::tell;
use crate::programs;
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
/// The package whose features are the boards.
const FIRMWARE: &str = "linestereo-firmware";

/// Where a program's logs go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Logs {
    None,
    /// To the PC that runs QEMU.
    Semihosting,
    /// To a debugger, through the memory of a board.
    Rtt,
}

impl Logs {
    pub const fn of(board: &Board) -> Self {
        if board.is_emulated() { Self::Semihosting } else { Self::Rtt }
    }
}

/// Programs of a board that one call of cargo builds or has clippy read.
#[derive(Clone, Copy, Debug)]
pub struct Images<'a> {
    /// Their package: the firmware, or one that stands on it without a default board.
    pub package: &'a str,
    pub programs: &'a [&'a str],
    pub logs: Logs,
    pub features: &'a [&'a str],
}

impl<'a> Images<'a> {
    /// Programs of the firmware without further features.
    pub const fn of_firmware(programs: &'a [&'a str], logs: Logs) -> Self {
        Self { package: FIRMWARE, programs, logs, features: &[] }
    }

    /// Builds them as they are flashed; their paths are in the order of their names.
    ///
    /// All boards share one folder, so that what they have in common is built once. Calls side by
    /// side wait for each other: cargo leaves a program's file at one place for all boards, from
    /// where it is copied. What this process has built before is not looked at again.
    pub fn build(&self, toolchain: &Toolchain, board: &Board) -> Result<Vec<PathBuf>> {
        static BUILT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
        let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
        let target = target_folder(toolchain)?;
        let kind = if self.logs == Logs::None { "no-logs" } else { "logs" };
        let folder = target.join(board.name).join([&[kind], self.features].concat().join("-"));
        let elfs: Vec<PathBuf> = self.programs.iter().map(|program| folder.join(program)).collect();
        if elfs.iter().all(|elf| built.contains(elf)) {
            return Ok(elfs);
        }
        fs::create_dir_all(&folder)?;
        let lock = fs::File::create(target.join("lock"))?;
        lock.lock()?;
        let mut command = toolchain.cargo();
        command.arg("build");
        self.finish(&mut command, &target, board)?;
        run(
            &mut command,
            &format!("cannot build {} for {}", self.programs.join(", "), board.name),
        )?;
        for (program, elf) in self.programs.iter().zip(&elfs) {
            // Renamed into place: another process may be running the one before it.
            let copy = tempfile::NamedTempFile::new_in(&folder)?;
            fs::copy(target.join(board.target).join(PROFILE).join(program), copy.path())
                .with_context(|| format!("cannot write {}", elf.display()))?;
            copy.persist(elf)?;
            built.insert(elf.clone());
        }
        Ok(elfs)
    }

    /// Has clippy read them and their package's library as the board builds them: much of both is
    /// for boards only, and nothing on a PC sees it. Warnings are errors.
    pub fn lint(&self, toolchain: &Toolchain, board: &Board) -> Result<()> {
        let mut command = toolchain.clippy()?;
        self.finish(&mut command, &target_folder(toolchain)?, board)?;
        command.args(["--lib", "--", "-D", "warnings"]);
        run(&mut command, &format!("clippy for {}", board.name))
    }

    /// Arguments of every command.
    fn finish(&self, command: &mut Command, target: &Path, board: &Board) -> Result<()> {
        let logs = match self.logs {
            Logs::None => None,
            Logs::Semihosting => Some("log-semihosting"),
            Logs::Rtt => Some("log-rtt"),
        };
        let features = [board.name].into_iter().chain(logs).chain(self.features.iter().copied());
        let features: Vec<String> =
            features.map(|feature| format!("{FIRMWARE}/{feature}")).collect();
        command
            .current_dir(top()?)
            .args(["--no-default-features", "-p", self.package, "--features", &features.join(",")])
            .args(self.programs.iter().flat_map(|program| ["--bin", program]));
        as_flashed(command, target, board);
        Ok(())
    }
}

/// Builds a package outside of this workspace as programs are built, and in their folder, so that
/// what it has in common with them is built once: its manifest repeats their profile. Returns the
/// folder of what is built.
pub fn build_package(toolchain: &Toolchain, board: &Board, package: &Path) -> Result<PathBuf> {
    let target = target_folder(toolchain)?;
    let mut command = toolchain.cargo();
    command.arg("build").current_dir(package);
    as_flashed(&mut command, &target, board);
    run(&mut command, &format!("cannot build {} for {}", package.display(), board.name))?;
    Ok(target.join(board.target).join(PROFILE))
}

/// Arguments that a package outside of this workspace has, too.
fn as_flashed(command: &mut Command, target: &Path, board: &Board) {
    command
        .args(["--quiet", "--locked", "--profile", PROFILE, "--config", INLINING])
        .args(["--target", board.target, "--target-dir"])
        .arg(target)
        .env("DEFMT_LOG", "info"); // at build time, or nothing is logged
}

/// Builds a program of the firmware for a board and returns the path of its ELF file.
pub fn build(toolchain: &Toolchain, board: &Board, program: &str, logs: Logs) -> Result<PathBuf> {
    let programs = [program];
    let images = Images { features: features(board), ..Images::of_firmware(&programs, logs) };
    let mut built = images.build(toolchain, board)?;
    built.pop().with_context(|| format!("{program} was not built"))
}

/// Features with which a board is flashed, as its page says.
fn features(board: &Board) -> &'static [&'static str] {
    if *board == Board::STM32H743 { &["still-scene"] } else { &[] }
}

/// The programs of a board that tests, `cargo xtask measure` and `cargo xtask footprint` use.
///
/// Emulated boards report by log what they check themselves; the rest is measured, and so without
/// logs.
pub fn images(board: &Board) -> Vec<Images<'static>> {
    let of = |programs, logs| Images {
        features: features(board),
        ..Images::of_firmware(programs, logs)
    };
    let live = of(&["live"], Logs::None);
    if *board == Board::STM32H743 {
        return vec![of(&["live", "selftest"], Logs::None)];
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
    vec![of(&["kernels", "selftest"], Logs::Semihosting), of(without_logs, Logs::None)]
}

/// One of [`images`], built in one call of cargo with all that stand beside it there.
pub fn image(board: &Board, program: &str) -> Result<PathBuf> {
    let toolchain = Toolchain::for_board(board)?;
    for images in images(board) {
        if let Some(place) = images.programs.iter().position(|&one| one == program) {
            return Ok(images.build(&toolchain, board)?.swap_remove(place));
        }
    }
    bail!("{program} is no image of {}", board.name)
}

/// Cargo does not notice another library of the same compiler version: a folder per way.
fn target_folder(toolchain: &Toolchain) -> Result<PathBuf> {
    let target = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| Ok(top()?.join("target")), |path| anyhow::Ok(path.into()))?;
    Ok(std::path::absolute(target)?.join(format!("boards-{}", toolchain.way)))
}

/// LLVM copies less code into its callers: functions marked `#[inline]` up to a cost of 30,
/// where its default is 325, others up to 120 (225; at "s" 50). Less flash for under 1 % of
/// instructions (docs/design.md); what is hot and small says `#[inline(always)]`. Added to the
/// flags of `.cargo/config.toml`.
const INLINING: &str = "target.'cfg(target_os = \"none\")'.rustflags = \
    [\"-Cllvm-args=-inlinehint-threshold=30\", \"-Cllvm-args=-inlinedefault-threshold=120\"]";

fn run(command: &mut Command, what: &str) -> Result<()> {
    let outcome = programs::run(command, LIMIT)?;
    if !outcome.status.success() {
        let error =
            outcome.stderr.lines().find(|line| line.starts_with("error")).unwrap_or("it failed");
        tell(&outcome.stderr);
        bail!("{what}: {error}");
    }
    Ok(())
}
