//! `cargo xtask`: builds, runs, tests and measures the board programs.
//!
//! Counts are instructions that QEMU executed, never cycles or times: it models neither caches nor
//! wait states.

mod bench;
mod bless;
mod footprint;
mod functions;
mod image;
mod measure;
mod nightly;
mod sizes;
mod stored;

use anyhow::{Context, Result, bail};
use clap::{Parser, Subcommand};
use core::time::Duration;
use linestereo_boards::Device;
use linestereo_sim::board::firmware::{self, Images, Logs};
use linestereo_sim::board::qemu::{self, Ended};
use linestereo_sim::board::toolchain::Toolchain;
use linestereo_sim::board::{self, Board};
use linestereo_sim::report::browser::Browser;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Longest run of one program.
const LIMIT: Duration = Duration::from_secs(300);

/// Builds, runs, tests and measures the board programs.
///
/// Numbers are instructions that QEMU executed, never cycles. LINESTEREO_TOOLCHAIN=rustup or apt
/// forces a way to the compiler; LINESTEREO_FRAMES names the folder of captured frames, whose
/// folder qvga is measured when it is there.
#[derive(Debug, Parser)]
#[command(
    name = "cargo xtask",
    max_term_width = 104,
    after_help = "cargo xtask web builds the page for browsers, bindings/web, into target/web/index.html.\n\
                  cargo xtask results writes docs/results.md from stored measurements."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Args)]
struct Boards {
    /// The board; without it, the two that everything is measured on, and for selftest, kernels and
    /// bench all that QEMU runs.
    #[arg(long, value_name = "BOARD")]
    board: Option<String>,
}

impl Boards {
    /// The one that is named, else all that QEMU runs: one of each family of processors.
    fn emulated(&self) -> Result<Vec<Board>> {
        match &self.board {
            Some(name) => Ok(vec![board::named(name)?]),
            None => Ok(Board::emulated().collect()),
        }
    }

    /// The one that is named, whether a PC can run it or not, else these.
    fn any_or(&self, boards: Vec<Board>) -> Result<Vec<Board>> {
        match &self.board {
            None => Ok(boards),
            Some(name) => Ok(vec![Board::named(name).with_context(|| {
                let names = Board::ALL.map(|board| board.name);
                format!("there is no board {name}; give {}", names.join(" or "))
            })?]),
        }
    }
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Find or install what board builds need, a compiler and QEMU, and a browser for tests of
    /// pages.
    ///
    /// Compilers for the boards of `images`; that of another board is made with its first build.
    Setup,
    /// Build a program and print where its ELF file is, what it takes of flash and RAM, and on
    /// hardware how it is flashed without a probe.
    Build {
        #[command(flatten)]
        boards: Boards,
        /// The program; without it, every program that the board can run.
        #[arg(long)]
        program: Option<String>,
        /// Without log code.
        #[arg(long)]
        no_logs: bool,
        /// More features of the firmware: still-scene.
        #[arg(long, value_name = "FEATURE,...", value_delimiter = ',')]
        features: Vec<String>,
    },
    /// Build what tests, measure and footprint run or read, two calls of cargo for each board.
    ///
    /// They build it by themselves where it is missing. Without --board: an emulated board
    /// and one of each family of chips; all with LINESTEREO_LONG=1.
    Images(Boards),
    /// Have clippy read the firmware as boards build it; warnings are errors.
    ///
    /// Without --board: the two whose code nothing else compiles, of Helium and of RISC-V; all with
    /// LINESTEREO_LONG=1.
    Lint(Boards),
    /// Run a program in QEMU: its log on stdout, its files in the current folder.
    ///
    /// A live board that can be watched: cargo xtask run --program live --serial
    /// tcp:127.0.0.1:5555,server=on
    Run {
        #[command(flatten)]
        boards: Boards,
        /// The program.
        #[arg(long)]
        program: String,
        /// Connect its serial port, in QEMU's words; it runs, without logs, until it is stopped.
        #[arg(long, value_name = "PORT")]
        serial: Option<String>,
        /// Its arguments.
        arguments: Vec<String>,
    },
    /// Compare what the boards compute with what the PC computes, stage by stage.
    Selftest(Boards),
    /// Compare the boards' kernels with the portable ones: every length and alignment, between
    /// fences of forbidden memory.
    Kernels(Boards),
    /// Count instructions by stage: built-in pairs, and captured ones when they are given.
    Bench {
        #[command(flatten)]
        boards: Boards,
        /// A folder of captured scenes.
        #[arg(long, value_name = "FOLDER")]
        frames: Option<PathBuf>,
    },
    /// Count instructions by function, of the built-in pairs or of captured ones.
    ///
    /// A pair takes seconds. What is inlined counts for the function around it.
    Functions {
        #[command(flatten)]
        boards: Boards,
        /// A folder of captured scenes.
        #[arg(long, value_name = "FOLDER")]
        frames: Option<PathBuf>,
        /// Print so many functions.
        #[arg(long, value_name = "N", default_value_t = 40)]
        count: usize,
    },
    /// Flash and RAM of `live`, compared with xtask/board-sizes.toml: fails on a change of more
    /// than 1 %.
    ///
    /// Without --board: of the boards that `images` builds.
    Footprint {
        #[command(flatten)]
        boards: Boards,
        /// Write the file instead.
        #[arg(long)]
        bless: bool,
    },
    /// Compare instructions, RAM, stack and flash with xtask/board-numbers.toml: fails on a loss or
    /// a gain of more than 1 %.
    Measure {
        /// Write the file instead.
        #[arg(long)]
        bless: bool,
        /// Compare; what happens without --bless.
        #[arg(long, conflicts_with = "bless")]
        check: bool,
    },
    /// Long forms of what .ci/run checks: every board, tests of minutes, packages, the oldest
    /// compiler.
    Nightly,
    /// Compute the digests that the boards are compared with.
    Bless {
        /// Compare with those that are there instead of writing them.
        #[arg(long)]
        check: bool,
    },
}

/// A failure is one line on stderr and exit code 2.
fn main() -> ExitCode {
    match execute(Cli::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn execute(command: Command) -> Result<()> {
    let top = board::top()?;
    match command {
        Command::Setup => setup(),
        Command::Build { boards, program, no_logs, features } => {
            build(&boards, program.as_deref(), no_logs, &features)
        }
        Command::Images(boards) => boards.any_or(board::tested())?.iter().try_for_each(images),
        Command::Lint(boards) => lint(&boards.any_or(linted())?),
        Command::Run { boards, program, serial, arguments } => {
            run(&boards, &program, serial.as_deref(), &arguments)
        }
        Command::Selftest(boards) => {
            let advice = "; when the output was meant to change: cargo xtask bless";
            agree(&boards, "selftest", ["not as on the PC", advice])
        }
        Command::Kernels(boards) => agree(&boards, "kernels", ["not as the portable kernels", ""]),
        Command::Bench { boards, frames } => bench::run(&boards.emulated()?, frames.as_deref()),
        Command::Functions { boards, frames, count } => {
            functions::run(&boards.emulated()?, frames.as_deref(), count)
        }
        Command::Footprint { boards, bless } => {
            footprint::run(&top, &boards.any_or(board::tested())?, bless)
        }
        Command::Measure { bless, check: _ } => measure::run(&top, bless),
        Command::Nightly => nightly::run(&top),
        Command::Bless { check } => bless::run(&top, check),
    }
}

fn setup() -> Result<()> {
    let top = board::top()?;
    let boards = board::tested();
    let mut targets: Vec<_> = boards.iter().map(|board| board.target).collect();
    targets.sort_unstable();
    targets.dedup();
    // Side by side: each is mostly the work of one core.
    std::thread::scope(|scope| {
        let made: Vec<_> =
            targets.iter().map(|target| scope.spawn(|| Toolchain::for_target(target))).collect();
        made.into_iter().try_for_each(|made| {
            made.join().map_err(|_| anyhow::anyhow!("a thread panicked"))?.map(drop)
        })
    })?;
    for board in &boards {
        let toolchain = Toolchain::for_board(board)?;
        println!(
            "{}: compiler for {}, by {}: {}",
            board.name,
            board.target,
            toolchain.way,
            toolchain.version(&top)?
        );
        if let Device::Qemu { program, .. } = board.device {
            qemu::find(board)?;
            println!("{}: {program}", board.name);
        }
    }
    // Only the tests of report pages need one, and they say when they are skipped.
    match Browser::install() {
        Ok(browser) => println!("browser: {}", browser.path().display()),
        Err(error) => println!("browser: none; {error:#}"),
    }
    Ok(())
}

fn build(boards: &Boards, program: Option<&str>, no_logs: bool, features: &[String]) -> Result<()> {
    let boards = boards.any_or(Board::MEASURED.into())?;
    let features: Vec<&str> = features.iter().map(String::as_str).collect();
    for board in boards {
        let programs =
            program.map_or_else(|| programs(&board), |program| Ok(vec![program.to_owned()]))?;
        let programs: Vec<&str> = programs.iter().map(String::as_str).collect();
        let toolchain = Toolchain::for_board(&board)?;
        let logs = if no_logs { Logs::None } else { Logs::of(&board) };
        let images = Images { features: &features, ..Images::of_firmware(&programs, logs) };
        for elf in images.build(&toolchain, &board)? {
            let found = sizes::read(&elf)?;
            let ram = found.static_ram + found.stack;
            println!("{}\n  flash {} bytes, RAM {ram} bytes", elf.display(), found.flash);
            if !board.is_emulated() {
                let (file, how) = image::write(&board, &elf)?;
                println!("{}\n  {how}", file.display());
            }
        }
    }
    Ok(())
}

/// Builds the programs of a board that tests, `measure` and `footprint` use.
fn images(board: &Board) -> Result<()> {
    let toolchain = Toolchain::for_board(board)?;
    let laboratory = (*board == Board::MPS2_AN500).then_some(LABORATORY);
    for images in firmware::images(board).into_iter().chain(laboratory) {
        let started = Instant::now();
        images.build(&toolchain, board)?;
        let programs = [images.programs, images.features].concat().join(" ");
        println!("{:14} {:4.0} s  {programs}", board.name, started.elapsed().as_secs_f64());
    }
    Ok(())
}

/// Boards whose code nothing else compiles on every change, Helium's and RISC-V's, or all in the
/// long form. That of the others is compiled for their images.
fn linted() -> Vec<Board> {
    let not_built = [Board::MPS3_AN547, Board::RISCV_VIRT];
    if board::is_long() { Board::ALL.into() } else { not_built.into() }
}

fn lint(boards: &[Board]) -> Result<()> {
    for (number, board) in boards.iter().enumerate() {
        let toolchain = Toolchain::for_board(board)?;
        let names = programs(board)?;
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let logged = Images::of_firmware(&names, Logs::of(board));
        let mut all = vec![logged];
        // With and without logs differ in two macros alone, which use their values either way: one
        // board without them stands for all.
        if number == 0 && board::is_long() {
            all.push(Images { logs: Logs::None, ..logged });
        }
        if *board == Board::MPS2_AN500 && board::is_long() {
            all.push(LABORATORY);
        }
        for images in all {
            let Images { package, logs, features, .. } = images;
            let logs = if logs == Logs::None { "without logs" } else { "with logs" };
            println!("clippy: {}, {package} {logs} {}", board.name, features.join(" "));
            images.lint(&toolchain, board)?;
        }
    }
    Ok(())
}

/// The laboratory's program for a board.
const LABORATORY: Images<'static> =
    Images { package: "linestereo-lab-board", ..Images::of_firmware(&["blocks"], Logs::None) };

/// On hardware; the others read and write files of a PC.
const HARDWARE_PROGRAMS: [&str; 2] = ["live", "selftest"];

/// Programs that a board can run.
fn programs(board: &Board) -> Result<Vec<String>> {
    if !board.is_emulated() {
        return Ok(HARDWARE_PROGRAMS.map(str::to_owned).into());
    }
    let folder = board::top()?.join("firmware/src/bin");
    let mut names = Vec::new();
    for entry in
        std::fs::read_dir(&folder).with_context(|| format!("cannot read {}", folder.display()))?
    {
        let path = entry?.path();
        names.extend(path.file_stem().map(|name| name.to_string_lossy().into_owned()));
    }
    names.sort();
    Ok(names)
}

/// Builds and runs a program, prints its log and gives its end.
fn run_program(board: &Board, program: &str, arguments: &[&str]) -> Result<Ended> {
    let toolchain = Toolchain::for_board(board)?;
    let elf = firmware::build(&toolchain, board, program, Logs::Semihosting)?;
    let ended = qemu::run(board, &elf, arguments, &std::env::current_dir()?, LIMIT)?;
    for line in linestereo_firmware_log::decode(&elf, &ended.log)? {
        println!("{:5} {}", line.level, line.text);
    }
    eprint!("{}", ended.errors);
    Ok(ended)
}

fn run(boards: &Boards, program: &str, serial: Option<&str>, arguments: &[String]) -> Result<()> {
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    // Files of one run would overwrite those of the other: by default one board.
    let board = match &boards.board {
        Some(name) => board::named(name)?,
        None => Board::MEASURED[0],
    };
    let Some(port) = serial else {
        return run_program(&board, program, &arguments)?.success(program, &board);
    };
    let elf = firmware::build(&Toolchain::for_board(&board)?, &board, program, Logs::None)?;
    let mut qemu = qemu::command(&board, &elf, &arguments, &std::env::current_dir()?)?;
    let status = qemu.args(["-serial", port]).status()?;
    if !status.success() {
        bail!("{program} on {} ended with {status}", board.name);
    }
    Ok(())
}

/// Has the boards run a program; those on which it finds a difference are an error in these words.
fn agree(boards: &Boards, program: &str, [difference, advice]: [&str; 2]) -> Result<()> {
    let mut different = Vec::new();
    for board in boards.emulated()? {
        println!("{}", board.name);
        if run_program(&board, program, &[])?.success(program, &board).is_err() {
            different.push(board.name);
        }
    }
    if !different.is_empty() {
        bail!("{difference}: {}{advice}", different.join(", "));
    }
    Ok(())
}
