//! `linestereo completions` and `linestereo man`: what a shell and a manual want to know of the command line.

use crate::output::{print, say};
use anyhow::{Context, Result};
use clap::Command;
use clap_complete::{Shell, generate};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  linestereo completions bash > ~/.local/share/bash-completion/completions/linestereo
  linestereo completions zsh > ~/.zfunc/_linestereo
  linestereo completions fish > ~/.config/fish/completions/linestereo.fish";

/// Print a script that completes commands and options in a shell.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct CompletionsArgs {
    /// The shell.
    shell: Shell,
}

/// Write manual pages, one for the program and one for each command: `man -l FOLDER/linestereo-run.1`.
#[derive(Debug, clap::Args)]
pub(super) struct ManArgs {
    /// Folder to write to; made if it is not there.
    folder: PathBuf,
}

pub(super) fn completions(args: &CompletionsArgs, mut command: Command) -> Result<()> {
    let mut script = Vec::new();
    generate(args.shell, &mut command, "linestereo", &mut script);
    print(&String::from_utf8(script)?)
}

pub(super) fn man(args: &ManArgs, command: Command) -> Result<()> {
    let folder = args.folder.display();
    std::fs::create_dir_all(&args.folder)
        .and_then(|()| clap_mangen::generate_to(command, &args.folder))
        .with_context(|| format!("cannot write to {folder}; choose a folder that can be written to"))?;
    say(&format!("manual pages in {folder}\n"))
}
