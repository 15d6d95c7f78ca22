//! The command line: one thin file per command.
//!
//! Convention: every command is a `pub struct Args` (`clap::Args`) and a `pub fn run(args: &Args) -> anyhow::Result<()>`.
//! An error becomes one line on stderr, `linestereo: what is wrong; what to do`, and exit code 2. Text for stdout goes through
//! [`crate::output`] as files do, so that a failed command leaves no partial file, and a closed pipe ends it without failure.

mod arguments;
mod batch;
pub mod bench_board;
mod board_options;
pub mod calibrate;
pub mod compare;
pub mod convert_rig;
pub mod demo;
pub mod eval;
mod eval_objects;
pub mod eval_pixels;
pub mod explain;
pub mod faults;
pub mod fit_confidence;
pub mod flash_image;
pub mod frames;
mod input;
mod method;
pub mod monitor;
mod objects;
mod pairs;
pub mod photograph;
pub mod plan_rig;
mod player;
pub mod print_board;
pub mod quality;
mod recording;
mod rectified_view;
pub mod rectify;
pub mod report;
pub mod run;
pub mod scene;
mod sector_options;
pub mod sequence;
mod shell;
mod video;
pub mod view;

use crate::board::{self, Board, Machine};
use crate::engine::Engine;
use crate::interruption::{self, Interrupted};
use crate::output::{self, ClosedPipe, OutputPath, print};
use anyhow::{Result, bail};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand, error::ErrorKind};
use linestereo::image::MIN_SIDE;
use linestereo::{Dims, ParamError, Params, Rig};
use linestereo_frames::resampled_height;
use linestereo_frames::untrusted::printable;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

/// Exit code of every failure.
const FAILURE: u8 = 2;

const AFTER_HELP: &str = "\
Exit codes:
  0    done; also where a reader of stdout closed it, and where some frames of many failed and the summary says so
  2    a file, an option or a pair is wrong, nothing could be matched, or not everything asked for could be given:
       one line on stderr says what and what to do
  130  interrupted; what was finished is kept

Files: \"-\" is stdout for every output; what is printed for people is then left out. No output may be an input.";

/// Sparse stereo depth from line segments: credible depths, each with a probability, from a rectified stereo pair.
#[derive(Debug, Parser)]
#[command(name = "linestereo", version = env!("LINESTEREO_VERSION"), max_term_width = 104, after_help = AFTER_HELP)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Print what was asked for alone: no summary, no notes, no progress.
    #[arg(long, short, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Tell on stderr what is taken: sizes, rig and range and where they are from, files.
    #[arg(long, short, global = true)]
    verbose: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Args),
    Run(Box<run::Args>),
    Eval(Box<eval::Args>),
    EvalPixels(eval_pixels::Args),
    Explain(Box<explain::Args>),
    Faults(faults::Args),
    Compare(Box<compare::Args>),
    FitConfidence(fit_confidence::Args),
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
    Completions(shell::CompletionsArgs),
    Man(shell::ManArgs),
}

/// Parses the command line, runs the command and reports a failure in one line.
#[must_use]
pub fn main() -> ExitCode {
    let command = arguments::prepared(Cli::command());
    let parsed = command.clone().try_get_matches().and_then(|matches| Ok((Cli::from_arg_matches(&matches)?, matches)));
    let (cli, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => return report_usage(&error),
    };
    output::set_verbosity(cli.quiet, cli.verbose);
    match arguments::check(&command, &matches).and_then(|()| run_command(&cli)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is::<ClosedPipe>() => ExitCode::SUCCESS,
        Err(error) => {
            report(&format!("{error:#}"));
            ExitCode::from(if error.is::<Interrupted>() { interruption::EXIT_CODE } else { FAILURE })
        }
    }
}

fn run_command(cli: &Cli) -> Result<()> {
    match &cli.command {
        Some(Command::Demo(args)) => demo::run(args),
        Some(Command::Run(args)) => run::run(args),
        Some(Command::Eval(args)) => eval::run(args),
        Some(Command::EvalPixels(args)) => eval_pixels::run(args),
        Some(Command::Explain(args)) => explain::run(args),
        Some(Command::Faults(args)) => faults::run(args),
        Some(Command::Compare(args)) => compare::run(args),
        Some(Command::FitConfidence(args)) => fit_confidence::run(args),
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
        Some(Command::Completions(args)) => shell::completions(args, arguments::prepared(Cli::command())),
        Some(Command::Man(args)) => shell::man(args, arguments::prepared(Cli::command())),
        None => demo::run(&demo::Args::default()),
    }
}

/// Help and version are answers, not failures; of a usage error its first line says what is wrong.
fn report_usage(error: &clap::Error) -> ExitCode {
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
    let lines = text.lines().take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    // No argument here is of the kind that "--" is for.
    let what: Vec<&str> = lines.filter(|line| !line.trim_start().starts_with("tip: to pass")).collect();
    report(&format!("{}; see --help", what.join(" ").trim_start_matches("error: ").trim()));
    ExitCode::from(FAILURE)
}

fn report(message: &str) {
    let line = message.split_whitespace().collect::<Vec<_>>().join(" ");
    let _ = writeln!(io::stderr(), "linestereo: {}", printable(&line)); // nowhere else to say it
}

/// The core with default parameters for one disparity range, rig and image size.
fn engine_for(max_disparity: u16, rig: Option<Rig>, dims: Dims) -> Result<Engine> {
    engine_with(&Params { max_disparity, rig, ..Params::default() }, dims)
}

/// The core with these parameters.
fn engine_with(params: &Params, dims: Dims) -> Result<Engine> {
    if params.max_disparity >= dims.width {
        let range = params.max_disparity;
        bail!("a disparity range of {range} does not fit an image of {dims}; give a smaller --max-disparity");
    }
    Engine::new(params, dims).map_err(|error| match error {
        ParamError::OutOfRange { name, .. } => {
            anyhow::anyhow!("{error}; change --{}", name.split(' ').next().unwrap_or(name).replace('_', "-"))
        }
        ParamError::MarginNeedsRig => anyhow::anyhow!("{error}; give --focal-px and --baseline-m, or use --margin-px"),
    })
}

/// The board of this name with its firmware built, if it holds images of this size.
fn machine_for(name: &str, dims: Dims) -> Result<Machine> {
    let board = board::named(name)?;
    if !board.fits(dims) {
        bail!("{}", does_not_fit(&board, dims));
    }
    Machine::new(board)
}

/// Error text for a size that the board has no memory for, with the widest reduction that fits.
fn does_not_fit(board: &Board, dims: Dims) -> String {
    let Board { name, largest, .. } = board;
    let fits = |&width: &u16| board.fits(Dims { width, height: resampled_height(dims, width) });
    let width = (MIN_SIDE..=largest.width.min(dims.width)).rev().find(fits).unwrap_or(MIN_SIDE);
    format!("{name} holds pairs of up to {largest}, these are {dims}; reduce them with --width {width}")
}

/// The outputs that are asked for.
fn asked_for<'a>(paths: impl IntoIterator<Item = &'a Option<OutputPath>>) -> impl Iterator<Item = &'a Path> {
    paths.into_iter().flatten().map(|path| &**path)
}

/// A line for each file that was written.
fn written<'a>(paths: impl IntoIterator<Item = &'a Option<OutputPath>>) -> String {
    paths.into_iter().flatten().map(|path| format!("wrote {}\n", path.display())).collect()
}
