//! The command line: one thin file per command.
//!
//! Convention: every command is a `pub struct Args` (`clap::Args`) and a `pub fn run(args: &Args)
//! -> anyhow::Result<()>`. An error becomes one line on stderr, `linestereo: what is wrong; what to
//! do`, and exit code 2. Text for stdout goes through [`crate::output`] as files do, so that a
//! failed command leaves no partial file, and a closed pipe ends it without failure.

mod arguments;
pub mod bench_board;
mod board_options;
pub mod calibrate;
pub mod convert_rig;
pub mod demo;
pub mod explain;
pub mod flash_image;
pub mod frames;
mod input;
mod known;
pub mod method;
pub mod monitor;
mod objects;
pub mod pairs;
pub mod photograph;
pub mod plan_rig;
mod player;
mod pose;
pub mod print_board;
pub mod program;
pub mod quality;
mod range;
mod recording;
mod rectified_view;
pub mod rectify;
pub mod report;
pub mod run;
pub mod scene;
mod sector_options;
pub mod sequence;
pub mod view;

use crate::engine::Engine;
use crate::output::{self, OutputPath, print, say};
use anyhow::{Context, Result, bail};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use clap_complete::{Shell, generate};
use linestereo::params::{Param, ParamError};
use linestereo::{Dims, Params};
use program::Verbosity;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const NAME: &str = "linestereo";

const AFTER_HELP: &str = "\
Exit codes:
  0    done; some frames of many may have failed, and the summary says so
  2    a file, an option or a pair is wrong, nothing could be matched, or an output could not be given:
       one line on stderr says what to do
  130  interrupted; finished results are kept

Files: \"-\" is stdout for every output, without the summary. No output may replace an input.";

/// Commands by what somebody wants to do, in the order of the help.
const TASKS: [(&str, &[&str]); 5] = [
    ("See what it does", &["demo", "scene", "frames"]),
    ("Match pairs", &["run", "sequence", "view", "report"]),
    ("Understand a result", &["explain", "quality"]),
    (
        "Build and calibrate a rig",
        &["plan-rig", "print-board", "calibrate", "rectify", "convert-rig"],
    ),
    ("Use a board", &["flash-image", "monitor", "photograph", "bench-board"]),
];

/// Sparse stereo depth from a rectified pair: line segments and points, each with the probability
/// that its depth is right.
///
/// Without a command it runs the demo.
#[derive(Debug, Parser)]
#[command(name = NAME, version = env!("LINESTEREO_VERSION"), max_term_width = 104, after_help = AFTER_HELP)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    verbosity: Verbosity,
    /// Print a script that completes commands and options in a shell.
    #[arg(long, value_name = "SHELL", exclusive = true)]
    completions: Option<Shell>,
    /// Write manual pages to this folder, to be read by `man -l FOLDER/linestereo-run.1`.
    #[arg(long, value_name = "FOLDER", exclusive = true)]
    man: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Args),
    Run(Box<run::Args>),
    Explain(Box<explain::Args>),
    FlashImage(flash_image::Args),
    Frames(frames::Args),
    Rectify(rectify::Args),
    Report(Box<report::Args>),
    Scene(scene::Args),
    Sequence(Box<sequence::Args>),
    View(Box<view::Args>),
    Calibrate(calibrate::Args),
    Monitor(monitor::Args),
    BenchBoard(bench_board::Args),
    Photograph(photograph::Args),
    ConvertRig(convert_rig::Args),
    PlanRig(plan_rig::Args),
    PrintBoard(print_board::Args),
    Quality(Box<quality::Args>),
}

/// Parses the command line, runs the command and reports a failure in one line.
pub fn main() -> ExitCode {
    program::run(NAME, command(), |matches| {
        let cli = Cli::from_arg_matches(matches)?;
        cli.verbosity.set();
        output::remember_inputs();
        run_command(&cli)
    })
}

/// The command line, whose help lists commands by [`TASKS`].
fn command() -> clap::Command {
    let command = Cli::command();
    let mut help = String::from("{about-with-newline}\n{usage-heading} {usage}\n\n");
    for (task, names) in TASKS {
        help.push_str(&format!("{task}:\n"));
        for name in names {
            let about = command.find_subcommand(name).and_then(clap::Command::get_about);
            help.push_str(&format!(
                "  {name:12}  {}\n",
                about.map(ToString::to_string).unwrap_or_default()
            ));
        }
        help.push('\n');
    }
    command.help_template(help + "Options:\n{options}{after-help}")
}

fn run_command(cli: &Cli) -> Result<()> {
    if let Some(shell) = cli.completions {
        let mut script = Vec::new();
        generate(shell, &mut arguments::prepared(command()), NAME, &mut script);
        return print(&String::from_utf8(script)?);
    }
    if let Some(folder) = &cli.man {
        return manual(folder);
    }
    match &cli.command {
        Some(Command::Demo(args)) => demo::run(args),
        Some(Command::Run(args)) => run::run(args),
        Some(Command::Explain(args)) => explain::run(args),
        Some(Command::FlashImage(args)) => flash_image::run(args),
        Some(Command::Frames(args)) => frames::run(args),
        Some(Command::Rectify(args)) => rectify::run(args),
        Some(Command::Report(args)) => report::run(args),
        Some(Command::Scene(args)) => scene::run(args),
        Some(Command::Sequence(args)) => sequence::run(args),
        Some(Command::View(args)) => view::run(args),
        Some(Command::Calibrate(args)) => calibrate::run(args),
        Some(Command::Monitor(args)) => monitor::run(args),
        Some(Command::BenchBoard(args)) => bench_board::run(args),
        Some(Command::Photograph(args)) => photograph::run(args),
        Some(Command::ConvertRig(args)) => convert_rig::run(args),
        Some(Command::PlanRig(args)) => plan_rig::run(args),
        Some(Command::PrintBoard(args)) => print_board::run(args),
        Some(Command::Quality(args)) => quality::run(args),
        None => demo::run(&demo::Args::default()),
    }
}

/// Writes manual pages, one for the program and one for each command.
fn manual(folder: &Path) -> Result<()> {
    let name = folder.display();
    std::fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(arguments::prepared(command()), folder))
        .with_context(|| {
            format!("cannot write to {name}; choose a folder that can be written to")
        })?;
    say(&format!("manual pages in {name}\n"))
}

pub fn engine_with(params: &Params, dims: Dims) -> Result<Engine> {
    if params.max_disparity >= dims.width {
        let range = params.max_disparity;
        bail!(
            "a disparity range of {range} does not fit an image of {dims}; give a smaller \
             --max-disparity"
        );
    }
    Engine::new(params, dims).map_err(|error| match error {
        ParamError::OutOfRange { param, .. } => {
            anyhow::anyhow!("{error}; change {}", option_of(param))
        }
        _ => anyhow::anyhow!("{error}; give --focal-px and --baseline-m, or use --margin-px"),
    })
}

/// The option that sets a parameter.
fn option_of(param: Param) -> &'static str {
    match param {
        Param::MinDisparity => "--min-disparity",
        Param::MaxDisparity => "--max-disparity",
        Param::MinExtent => "--min-extent",
        Param::Cell => "--cell",
        Param::MinConfidence => "--min-confidence",
        Param::Margin => "--margin-px",
        Param::MarginNearer | Param::MarginFarther => "--margin-m",
        _ => "the parameters",
    }
}

pub fn asked_for<'a>(
    paths: impl IntoIterator<Item = &'a Option<OutputPath>>,
) -> impl Iterator<Item = &'a Path> {
    paths.into_iter().flatten().map(|path| &**path)
}

/// A line for each file that was written.
pub fn written<'a>(paths: impl IntoIterator<Item = &'a Option<OutputPath>>) -> String {
    paths.into_iter().flatten().map(|path| format!("wrote {}\n", path.display())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_command_stands_in_the_help_once() {
        let mut listed: Vec<&str> = TASKS.iter().flat_map(|(_, names)| *names).copied().collect();
        let cli = Cli::command();
        let mut known: Vec<&str> = cli.get_subcommands().map(clap::Command::get_name).collect();
        listed.sort_unstable();
        known.sort_unstable();
        assert_eq!(listed, known);
        let help = arguments::prepared(command()).render_help().to_string();
        assert!(
            help.contains("Match pairs:\n  run ")
                && help.contains("--quiet")
                && help.contains("Exit codes:"),
            "{help}"
        );
    }

    #[test]
    fn no_help_names_the_laboratory_which_users_do_not_have() {
        let mut commands = vec![arguments::prepared(command())];
        while let Some(mut command) = commands.pop() {
            let help = command.render_long_help().to_string();
            assert!(!help.contains("linestereo-lab"), "{help}");
            commands.extend(command.get_subcommands().cloned());
        }
    }
}
