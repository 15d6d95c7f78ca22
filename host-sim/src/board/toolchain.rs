//! A compiler for boards.
//!
//! ```text
//! 1. the compiler in use has the library of the target                 nothing to do
//! 2. rustup target add                                                 for ordinary users
//! 3. Debian's compiler and library source, core built once by it       where rustup cannot download
//! ```
//!
//! `LINESTEREO_TOOLCHAIN=rustup` or `=apt` takes that way or fails. The third is a folder in the
//! user's cache: the installed compiler with `core` for the boards beside its own libraries, so
//! that plain cargo builds for them. Targets come to it one by one, as they are asked for.

use super::{Board, debian, top};
use crate::output::tell;
use crate::programs;
use anyhow::{Context, Result, bail};
use core::time::Duration;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Forces a way.
pub const VARIABLE: &str = "LINESTEREO_TOOLCHAIN";

const RUSTUP_LIMIT: Duration = Duration::from_secs(90);

/// A cargo that builds for boards.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Toolchain {
    /// The way: `rustup` or `apt`.
    pub way: &'static str,
    /// A folder made of Debian's compiler, or none: then cargo is the one in use.
    folder: Option<PathBuf>,
}

impl Toolchain {
    /// Finds or makes one that builds for this board.
    pub fn for_board(board: &Board) -> Result<Self> {
        Self::for_target(board.target)
    }

    /// Finds or makes one that builds for this target.
    pub fn for_target(target: &str) -> Result<Self> {
        let top = &top()?;
        match std::env::var(VARIABLE).as_deref() {
            Err(_) | Ok("") => match rustup(top, target) {
                Ok(toolchain) => Ok(toolchain),
                Err(rustup) => Self::debian(target).with_context(|| {
                    format!("no compiler for boards: {rustup:#}; by Debian's packages")
                }),
            },
            Ok("rustup") => rustup(top, target),
            Ok("apt") => Self::debian(target),
            Ok(other) => bail!("{VARIABLE} is {other}; give rustup or apt, or leave it unset"),
        }
    }

    /// The one in use, for this machine.
    pub const fn in_use() -> Self {
        Self { way: "rustup", folder: None }
    }

    fn debian(target: &str) -> Result<Self> {
        Ok(Self { way: "apt", folder: Some(debian::toolchain(target)?) })
    }

    /// A cargo command without what other builds left in the environment.
    pub fn cargo(&self) -> Command {
        self.for_boards(Command::new(if self.folder.is_some() { debian::CARGO } else { "cargo" }))
    }

    /// The same of clippy: an unfinished `cargo clippy`.
    pub fn clippy(&self) -> Result<Command> {
        let mut command = match &self.folder {
            Some(folder) => {
                let mut command = Command::new(debian::clippy()?);
                command.env("CARGO", debian::CARGO).env("SYSROOT", folder);
                command
            }
            None => Command::new("cargo"),
        };
        command.arg("clippy");
        Ok(self.for_boards(command))
    }

    /// With this compiler, and without profiles and flags that are of the PC's build.
    fn for_boards(&self, mut command: Command) -> Command {
        for (name, _) in std::env::vars_os() {
            let text = name.to_string_lossy();
            let changes_the_build = text.starts_with("CARGO_PROFILE_")
                || text.starts_with("CARGO_TARGET_")
                || ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_TARGET"].contains(&&*text);
            if changes_the_build {
                command.env_remove(name);
            }
        }
        if let Some(folder) = &self.folder {
            command.env_remove("RUSTUP_TOOLCHAIN").env("RUSTC", folder.join("bin/rustc"));
        }
        command
    }

    pub fn linker(&self, top: &Path) -> Result<PathBuf> {
        let sysroot = match &self.folder {
            Some(folder) => folder.clone(),
            None => {
                sysroot(Command::new("rustc").current_dir(top)).context("rustc does not run")?
            }
        };
        Ok(sysroot.join("lib/rustlib").join(host()?).join("bin/rust-lld"))
    }

    /// Name and version of the compiler.
    pub fn version(&self, top: &Path) -> Result<String> {
        let rustc = self
            .folder
            .as_ref()
            .map_or_else(|| PathBuf::from("rustc"), |folder| folder.join("bin/rustc"));
        programs::first_line(Command::new(rustc).arg("--version").current_dir(top))
            .context("rustc does not run")
    }
}

fn sysroot(rustc: &mut Command) -> Option<PathBuf> {
    programs::first_line(rustc.args(["--print", "sysroot"])).map(PathBuf::from)
}

fn host() -> Result<String> {
    programs::first_line(Command::new("rustc").args(["--print", "host-tuple"]))
        .context("rustc does not run")
}

/// The compiler in use, with the target added if need be. `top` is the top of the repository, whose
/// `rust-toolchain.toml` counts.
fn rustup(top: &Path, target: &str) -> Result<Toolchain> {
    let toolchain = Toolchain::in_use();
    let has_target = || {
        let sysroot = sysroot(Command::new("rustc").current_dir(top))?;
        sysroot.join("lib/rustlib").join(target).join("lib").is_dir().then_some(())
    };
    if has_target().is_some() {
        return Ok(toolchain);
    }
    tell(&format!("rustup target add {target}"));
    let added = programs::run(
        Command::new("rustup").args(["target", "add", target]).current_dir(top),
        RUSTUP_LIMIT,
    );
    let reason = match added {
        Ok(_) if has_target().is_some() => return Ok(toolchain),
        Ok(outcome) => outcome
            .stderr
            .lines()
            .rfind(|line| line.contains("error"))
            .unwrap_or("it failed")
            .to_owned(),
        Err(error) => format!("{error:#}"),
    };
    bail!("`rustup target add {target}` does not work here ({reason})")
}
