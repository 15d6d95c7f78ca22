//! The command line: one thin file per command, with `Args` and a `run` that is given them.

mod batch;
mod compare;
mod faults;
mod fit_confidence;
mod thin;

use crate::bench;
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use linestereo_sim::commands::program;
use std::process::ExitCode;

/// Name of the program in messages.
const NAME: &str = "linestereo-lab";

/// Scores of the method on data sets, beside other matchers.
#[derive(Debug, Parser)]
#[command(name = NAME, version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    verbosity: program::Verbosity,
}

#[derive(Debug, Subcommand)]
enum Command {
    Bench(bench::Args),
    Compare(Box<compare::Args>),
    Faults(faults::Args),
    FitConfidence(fit_confidence::Args),
    Thin(thin::Args),
}

/// Parses the command line, runs the command and reports a failure in one line.
pub fn main() -> ExitCode {
    program::run(NAME, Cli::command(), |matches| {
        let cli = Cli::from_arg_matches(matches)?;
        cli.verbosity.set();
        match &cli.command {
            Command::Bench(args) => bench::run(args),
            Command::Compare(args) => compare::run(args),
            Command::Faults(args) => faults::run(args),
            Command::FitConfidence(args) => fit_confidence::run(args),
            Command::Thin(args) => thin::run(args),
        }
    })
}
