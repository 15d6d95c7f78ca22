//! `linestereo-lab`: what judges the method. Users need none of it; the program for them is
//! `linestereo`.

mod bench;

use clap::{Parser, Subcommand};
use linestereo_sim::output::ClosedPipe;
use std::process::ExitCode;

/// Exit code of every failure.
const FAILURE: u8 = 2;

/// Scores of the method on data sets, beside other matchers.
#[derive(Debug, Parser)]
#[command(name = "linestereo-lab", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Bench(bench::Args),
}

fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Bench(args) => bench::run(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is::<ClosedPipe>() => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("linestereo-lab: {error:#}");
            ExitCode::from(FAILURE)
        }
    }
}
