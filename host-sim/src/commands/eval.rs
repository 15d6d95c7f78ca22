//! `linestereo eval`: scores on frames with ground truth.

/// Score the core on every folder with a `scene.json` and ground truth.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs the command.
pub fn run(_args: &Args) -> anyhow::Result<()> {
    anyhow::bail!("eval is not there yet")
}
