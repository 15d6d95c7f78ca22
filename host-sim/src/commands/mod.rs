//! The command line: one thin file per command.
//!
//! Convention: every command is a `pub struct Args` (`clap::Args`) and a `pub fn run(args: &Args) -> anyhow::Result<()>`.
//! An error becomes one line on stderr, `linestereo: what is wrong; what to do`, and exit code 2. Text for stdout goes through
//! [`print()`], files through [`crate::output`], so that a failed command leaves no partial file and a closed pipe is no failure.

mod batch;
pub mod bench_board;
pub mod calibrate;
pub mod compare;
pub mod convert_rig;
pub mod demo;
pub mod eval;
mod eval_objects;
pub mod eval_pixels;
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
pub mod rectify;
pub mod report;
pub mod run;
pub mod scene;
mod sector_options;
pub mod sequence;
mod view;

use crate::board::{self, Board, Machine};
use crate::engine::Engine;
use crate::input::resampled_height;
use anyhow::{Result, bail};
use clap::{Parser, Subcommand, error::ErrorKind};
use linestereo::image::MIN_SIDE;
use linestereo::{Dims, ParamError, Params, Rig};
use std::io::{self, Write};
use std::process::ExitCode;

/// Exit code of every failure.
const FAILURE: u8 = 2;

/// Sparse stereo depth from line segments: credible depths, each with a probability, from a rectified stereo pair.
#[derive(Debug, Parser)]
#[command(name = "linestereo", version, max_term_width = 104)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Args),
    Run(Box<run::Args>),
    Eval(Box<eval::Args>),
    EvalPixels(eval_pixels::Args),
    Compare(Box<compare::Args>),
    FitConfidence(fit_confidence::Args),
    FlashImage(flash_image::Args),
    Frames(frames::Args),
    Rectify(rectify::Args),
    Report(Box<report::Args>),
    Scene(scene::Args),
    Sequence(Box<sequence::Args>),
    Calibrate(calibrate::Args),
    Monitor(monitor::Args),
    BenchBoard(bench_board::Args),
    Photograph(photograph::Args),
    ConvertRig(convert_rig::Args),
    PlanRig(plan_rig::Args),
}

/// Parses the command line, runs the command and reports a failure in one line.
#[must_use]
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return report_usage(&error),
    };
    let outcome = match &cli.command {
        Some(Command::Demo(args)) => demo::run(args),
        Some(Command::Run(args)) => run::run(args),
        Some(Command::Eval(args)) => eval::run(args),
        Some(Command::EvalPixels(args)) => eval_pixels::run(args),
        Some(Command::Compare(args)) => compare::run(args),
        Some(Command::FitConfidence(args)) => fit_confidence::run(args),
        Some(Command::FlashImage(args)) => flash_image::run(args),
        Some(Command::Frames(args)) => frames::run(args),
        Some(Command::Rectify(args)) => rectify::run(args),
        Some(Command::Report(args)) => report::run(args),
        Some(Command::Scene(args)) => scene::run(args),
        Some(Command::Sequence(args)) => sequence::run(args),
        Some(Command::Calibrate(args)) => calibrate::run(args),
        Some(Command::Monitor(args)) => monitor::run(args),
        Some(Command::BenchBoard(args)) => bench_board::run(args),
        Some(Command::Photograph(args)) => photograph::run(args),
        Some(Command::ConvertRig(args)) => convert_rig::run(args),
        Some(Command::PlanRig(args)) => plan_rig::run(args),
        None => demo::run(&demo::Args::default()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            report(&format!("{error:#}"));
            ExitCode::from(FAILURE)
        }
    }
}

/// Help and version are answers, not failures; of a usage error its first line says what is wrong.
fn report_usage(error: &clap::Error) -> ExitCode {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        let _ = error.print(); // a closed pipe is no failure
        return ExitCode::SUCCESS;
    }
    let text = error.to_string();
    let what: Vec<&str> =
        text.lines().take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more")).collect();
    report(&format!("{}; see --help", what.join(" ").trim_start_matches("error: ").trim()));
    ExitCode::from(FAILURE)
}

fn report(message: &str) {
    let line = message.split_whitespace().collect::<Vec<_>>().join(" ");
    let _ = writeln!(io::stderr(), "linestereo: {line}"); // nowhere else to say it
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

/// What is wrong, and the widest reduction that fits.
fn does_not_fit(board: &Board, dims: Dims) -> String {
    let Board { name, largest, .. } = board;
    let fits = |&width: &u16| board.fits(Dims { width, height: resampled_height(dims, width) });
    let width = (MIN_SIDE..=largest.width.min(dims.width)).rev().find(fits).unwrap_or(MIN_SIDE);
    format!("{name} holds pairs of up to {largest}, these are {dims}; reduce them with --width {width}")
}

/// Writes text to stdout; a reader that closed the pipe (`| head`) has seen enough and is no error.
pub fn print(text: &str) -> anyhow::Result<()> {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
