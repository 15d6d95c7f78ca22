//! `cargo xtask`: builds, runs, tests and measures the board programs.

mod bless;

use anyhow::Result;
use clap::{Parser, Subcommand};
use std::path::Path;

/// Builds, runs, tests and measures the board programs.
#[derive(Debug, Parser)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Compute the digests that the boards are compared with.
    Bless,
}

fn main() -> Result<()> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    match Cli::parse().command {
        Command::Bless => bless::run(top),
    }
}
