//! A program of subcommands: its arguments are parsed and checked, and a failure becomes one line
//! and an exit code.

use super::arguments;
use crate::interruption::{self, Interrupted};
use crate::output::{self, ClosedPipe, print};
use anyhow::Result;
use clap::error::ErrorKind;
use clap::{ArgMatches, Command};
use linestereo_frames::untrusted::printable;
use std::io::{self, Write};
use std::process::ExitCode;

/// Exit code of every failure.
const FAILURE: u8 = 2;

/// Amount of printed text.
#[derive(Debug, clap::Args)]
pub struct Verbosity {
    /// Print only the results that were asked for: no summary, notes or progress.
    #[arg(long, short, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Print to stderr which sizes, rig, range and files are used.
    #[arg(long, short, global = true)]
    verbose: bool,
}

impl Verbosity {
    /// Applies it to all output from now on.
    pub fn set(&self) {
        output::set_verbosity(self.quiet, self.verbose);
    }
}

/// Parses the command line, does the work, and reports a failure of either in one line that begins
/// with the program's name.
pub fn run(name: &str, command: Command, work: impl FnOnce(&ArgMatches) -> Result<()>) -> ExitCode {
    let command = arguments::prepared(command);
    let matches = match command
        .clone()
        .try_get_matches_from(arguments::separated(&command, std::env::args_os()))
    {
        Ok(matches) => matches,
        Err(error) => return report_usage(name, &error),
    };
    match arguments::check(&command, &matches).and_then(|()| work(&matches)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is::<ClosedPipe>() => ExitCode::SUCCESS,
        Err(error) => match error.downcast_ref::<clap::Error>() {
            Some(usage) => report_usage(name, usage),
            None => {
                report(name, &format!("{error:#}"));
                ExitCode::from(if error.is::<Interrupted>() {
                    interruption::EXIT_CODE
                } else {
                    FAILURE
                })
            }
        },
    }
}

/// Help and version are answers, not failures; of a usage error its first line says what is wrong.
fn report_usage(name: &str, error: &clap::Error) -> ExitCode {
    // A closed pipe is no failure.
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = print(&error.to_string());
            return ExitCode::SUCCESS;
        }
        _ => {}
    }
    let text = error.to_string();
    let lines = text
        .lines()
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    // No argument here is of the kind that "--" is for.
    let what: Vec<&str> =
        lines.filter(|line| !line.trim_start().starts_with("tip: to pass")).collect();
    report(name, &format!("{}; see --help", what.join(" ").trim_start_matches("error: ").trim()));
    ExitCode::from(FAILURE)
}

fn report(name: &str, message: &str) {
    let line = message.split_whitespace().collect::<Vec<_>>().join(" ");
    let _ = writeln!(io::stderr(), "{name}: {}", printable(&line)); // nowhere else to say it
}
