//! The core beside block matching on the same pairs: instructions and memory. Every digest of a board is compared with the PC's.

use crate::bench;
use anyhow::{Context, Result, bail};
use linestereo::Dims;
use linestereo_firmware::boards::{mps2_an386, mps2_an500};
use linestereo_firmware::cases::Case;
use linestereo_firmware::ports::NoClock;
use linestereo_firmware::programs::blocks::{self, METHODS, Measured, groups};
use linestereo_frames::GrayImage;
use linestereo_sim::board::firmware::{self, Logs};
use linestereo_sim::board::toolchain::Toolchain;
use linestereo_sim::board::{Board, qemu};
use std::collections::BTreeMap;
use std::path::Path;

/// Width of the largest pair of any board, px.
const WIDTH: usize = Board::MPS2_AN500.largest.width as usize;
type Workspace = blocks::Workspace<WIDTH, { Board::MPS2_AN500.pixels() }, { groups(WIDTH).0 }, { groups(WIDTH).1 }>;

/// Result of one method for one pair.
type ByMethod = BTreeMap<String, Measured>;

/// Results of the program `blocks`.
struct Blocks {
    /// By pair, in its order.
    pairs: Vec<ByMethod>,
    /// Bytes of the dense matcher's memory, of the grid's, and the largest depth of the stack.
    bytes: [u64; 3],
}

/// Runs the program `blocks` on these pairs, or on the built-in ones.
fn blocks(board: &Board, pairs: Option<&[(GrayImage, GrayImage)]>) -> Result<Blocks> {
    let toolchain = Toolchain::for_board(board)?;
    let elf = firmware::build(&toolchain, board, "blocks", Logs::None)?;
    let folder = tempfile::tempdir()?;
    let mut arguments = vec!["table"];
    if let Some(pairs) = pairs {
        std::fs::write(folder.path().join("pairs"), pairs.iter().flat_map(bytes).collect::<Vec<u8>>())?;
        arguments.push("pairs");
    }
    qemu::run(board, &elf, &arguments, folder.path(), crate::LIMIT)?.success("blocks", board)?;
    let table = std::fs::read_to_string(folder.path().join("table"))?;
    parse(&table)
}

/// A pair as the program reads it.
fn bytes((left, right): &(GrayImage, GrayImage)) -> Vec<u8> {
    let Dims { width, height } = left.dims;
    [&width.to_le_bytes()[..], &height.to_le_bytes(), &left.pixels, &right.pixels].concat()
}

fn parse(table: &str) -> Result<Blocks> {
    let mut blocks = Blocks { pairs: Vec::new(), bytes: [0; 3] };
    let mut last = None;
    for line in table.lines() {
        match line.split('\t').collect::<Vec<_>>()[..] {
            ["blocks", pair, method, cost, values, digest] => {
                if last != Some(pair) {
                    blocks.pairs.push(ByMethod::new());
                    last = Some(pair);
                }
                let digest = u32::from_str_radix(digest, 16)?;
                let measured = Measured { cost: cost.parse()?, values: values.parse()?, digest };
                blocks.pairs.last_mut().context("no pair")?.insert(method.to_owned(), measured);
            }
            ["bytes", dense, grid] => [blocks.bytes[0], blocks.bytes[1]] = [dense.parse()?, grid.parse()?],
            ["stack", bytes] => blocks.bytes[2] = bytes.parse()?,
            _ => bail!("the table of blocks has an unknown line: {line}"),
        }
    }
    Ok(blocks)
}

/// Is what the board gave for a pair what the PC gives?
fn check(name: &str, (left, right): &(GrayImage, GrayImage), found: &ByMethod) -> Result<()> {
    let mut memory = Box::new(Workspace::new());
    for (frame, image) in memory.frames().into_iter().zip([left, right]) {
        frame.get_mut(..image.pixels.len()).context("the pair is too large")?.copy_from_slice(&image.pixels);
    }
    for (method, matcher, settings) in METHODS {
        let here = memory.measure(&NoClock, left.dims, matcher, &settings)?;
        let there = found.get(method).with_context(|| format!("{name}: the board has no {method}"))?;
        if (there.digest, there.values) != (here.digest, here.values) {
            bail!("{name}, {method}: the board gives {there:?}, the PC {here:?}");
        }
    }
    Ok(())
}

/// A built-in pair.
fn painted(case: &Case) -> (GrayImage, GrayImage) {
    let dims = case.dims;
    let blank = || vec![0; usize::from(dims.width) * usize::from(dims.height)];
    let (mut left, mut right) = (blank(), blank());
    case.scene.paint(dims, &mut left, &mut right);
    (GrayImage { dims, pixels: left }, GrayImage { dims, pixels: right })
}

/// Prints the table of a board: its largest built-in pairs, or captured ones cut to their size.
pub(crate) fn run(board: &Board, frames: Option<&Path>) -> Result<()> {
    let dims = *board.sizes.first().context("the board has no pairs")?;
    let builtin = bench::builtin(board)?;
    let (names, images, ours): (Vec<String>, Vec<_>, Vec<u64>) = match frames {
        Some(folder) => {
            let (names, images): (Vec<_>, Vec<_>) = bench::scenes(folder, dims)?.into_iter().unzip();
            let ours = bench::captured(board, folder, dims)?;
            (names, images, ours.iter().map(|(_, costs)| bench::total(costs)).collect())
        }
        None => {
            let cases: Vec<_> = Case::all(board).filter(|case| !case.worst_case && case.dims == dims).collect();
            let costs: BTreeMap<_, _> = builtin.pairs.iter().map(|(name, costs)| (name, bench::total(costs))).collect();
            let names: Vec<_> = cases.iter().map(Case::to_string).collect();
            let ours = names.iter().map(|name| costs.get(name).copied().unwrap_or(0)).collect();
            (names, cases.iter().map(painted).collect(), ours)
        }
    };
    let Blocks { pairs, bytes: [dense, grid, stack] } = blocks(board, Some(&images))?;
    for ((name, images), found) in names.iter().zip(&images).zip(&pairs) {
        check(name, images, found)?;
    }
    println!("{}, pairs of {dims}, 64 disparities, thousands of instructions (disparities)", board.name);
    print!("{:20} {:>8}", "", "core");
    METHODS.iter().for_each(|(method, ..)| print!(" {method:>16}"));
    println!();
    let line = |name: &str, core: u64, of: &dyn Fn(&str) -> (u64, u64)| {
        print!("{name:20} {:>8}", core / 1000);
        for (method, ..) in METHODS {
            let (cost, values) = of(method);
            print!(" {:>8} ({values:>5})", cost / 1000);
        }
        println!();
    };
    for ((name, found), core) in names.iter().zip(&pairs).zip(&ours) {
        line(name, *core, &|method| found.get(method).map_or((0, 0), |of| (of.cost, of.values.into())));
    }
    let core = bench::median(ours.clone());
    let medians = |method: &str| {
        let of = |number: fn(&Measured) -> u64| {
            bench::median(pairs.iter().filter_map(|found| found.get(method)).map(number).collect())
        };
        (of(|measured| measured.cost), of(|measured| measured.values.into()))
    };
    line("median", core, &medians);
    print!("{:20} {:>8}", "core = 1", "1.00");
    METHODS.iter().for_each(|(method, ..)| print!(" {:>8.2} {:7}", medians(method).0 as f64 / core as f64, ""));
    println!(
        "\nbytes beside the frames: core {} + stack {}, dense {dense}, grid {grid}, + stack {stack}",
        lists(board),
        builtin.stack
    );
    println!("every digest is the PC's");
    Ok(())
}

/// Bytes of the core's memory.
fn lists(board: &Board) -> usize {
    if *board == mps2_an386::BOARD { mps2_an386::Workspace::CORE } else { mps2_an500::Workspace::CORE }
}
