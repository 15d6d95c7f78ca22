//! `linestereo --completions` and `linestereo --man`: what a shell and a manual want to know of the
//! command line.

use crate::output::{print, say};
use anyhow::{Context, Result};
use clap::Command;
use clap_complete::{Shell, generate};
use std::path::Path;

/// Prints a script that completes commands and options in a shell.
pub(super) fn completions(shell: Shell, mut command: Command) -> Result<()> {
    let mut script = Vec::new();
    generate(shell, &mut command, "linestereo", &mut script);
    print(&String::from_utf8(script)?)
}

/// Writes manual pages, one for the program and one for each command.
pub(super) fn man(folder: &Path, command: Command) -> Result<()> {
    let name = folder.display();
    std::fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(command, folder))
        .with_context(|| {
            format!("cannot write to {name}; choose a folder that can be written to")
        })?;
    say(&format!("manual pages in {name}\n"))
}
