//! `linestereo-lab bench`: every data set of a folder, scored.

use anyhow::Result;
use std::path::PathBuf;

/// Score every data set of a folder, beside OpenCV.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Folder that holds data sets.
    frames: PathBuf,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<()> {
    anyhow::bail!("{} is not scored yet", args.frames.display())
}
