//! Runs a board program in QEMU.
//!
//! Time in the machine is counted in instructions: with `-icount shift=6` each takes 64 ns, and
//! every run is the same.

use super::Board;
use crate::programs;
use anyhow::{Context, Result, bail};
use core::time::Duration;
use linestereo_boards::{Device, Exit};
use std::path::{Path, PathBuf};
use std::process::Command;

/// How a program ended.
#[derive(Clone, Debug)]
pub struct Ended {
    /// The way, `None` for an exit code that no program gives.
    pub exit: Option<Exit>,
    /// Its log: bytes of `defmt` frames, which `linestereo-firmware-log` decodes.
    pub log: Vec<u8>,
    /// Error output of it and of QEMU: reports of faults.
    pub errors: String,
}

impl Ended {
    /// An error unless all is well, with what the program reported.
    pub fn success(&self, program: &str, board: &Board) -> Result<()> {
        if self.exit == Some(Exit::Success) {
            return Ok(());
        }
        let why = self.exit.map_or("QEMU failed", Exit::meaning);
        let reported = self.errors.trim();
        let colon = if reported.is_empty() { "" } else { ": " };
        bail!("{program} on {}: {why}{colon}{reported}", board.name)
    }
}

/// The QEMU of a board, and the arguments that choose the machine. Makes sure that it is there.
pub fn find(board: &Board) -> Result<(PathBuf, &'static [&'static str])> {
    let Device::Qemu { program, arguments } = board.device else {
        bail!("{} is no machine of QEMU: build its program, and flash it", board.name)
    };
    let there = || programs::first_line(Command::new(program).arg("--version")).is_some();
    if !there() {
        // Arm has a package of its own, most others share one.
        let package = if program == "qemu-system-arm" { program } else { "qemu-system-misc" };
        programs::install("running a board", &[package])?;
    }
    if there() {
        Ok((program.into(), arguments))
    } else {
        bail!("{program} does not run; install QEMU for it")
    }
}

/// The command that runs a program with these arguments, reading and writing files in `folder`.
pub fn command(board: &Board, elf: &Path, arguments: &[&str], folder: &Path) -> Result<Command> {
    let mut semihosting = String::from("enable=on,target=native,arg=program");
    for argument in arguments {
        if argument.contains([',', ' ']) {
            bail!("a board program takes no argument with a comma or a space: {argument}");
        }
        semihosting.push_str(&format!(",arg={argument}"));
    }
    let (program, machine) = find(board)?;
    let mut command = Command::new(program);
    command
        .current_dir(folder)
        .args(machine)
        .args(["-display", "none", "-monitor", "none", "-icount", "shift=6"])
        .args(["-semihosting-config", &semihosting])
        .arg("-kernel")
        .arg(std::path::absolute(elf)?);
    Ok(command)
}

pub fn run(
    board: &Board,
    elf: &Path,
    arguments: &[&str],
    folder: &Path,
    limit: Duration,
) -> Result<Ended> {
    let mut command = command(board, elf, arguments, folder)?;
    let outcome =
        programs::run(command.args(["-serial", "none"]), limit).context("a board program hangs")?;
    let code = outcome.status.code().and_then(|code| u32::try_from(code).ok());
    Ok(Ended {
        exit: Exit::ALL.into_iter().find(|&exit| Some(exit as u32) == code),
        log: outcome.stdout,
        errors: outcome.stderr,
    })
}
