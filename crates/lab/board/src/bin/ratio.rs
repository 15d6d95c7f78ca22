//! Block matching beside the core on an emulated Cortex-M7: instructions and memory, on the same
//! pairs.
//!
//! Every disparity of the board is compared with the PC's, also on small pairs of odd sizes with
//! each number of disparities.

use anyhow::{Context, Result, anyhow, bail, ensure};
use clap::Parser;
use core::time::Duration;
use linestereo::{Dims, Params};
use linestereo_boards::built_in::Scene;
use linestereo_firmware::boards::mps2_an500;
use linestereo_firmware::ports::{ByteSource, NoClock};
use linestereo_frames::GrayImage;
use linestereo_frames::statistics::upper_median;
use linestereo_lab_board::{BOARD, DISPARITIES, METHODS, Matchers};
use linestereo_sim::board::firmware::{Images, Logs};
use linestereo_sim::board::toolchain::Toolchain;
use linestereo_sim::board::{self, BoardResult, Machine, qemu};
use linestereo_wire::Refusal;
use std::collections::BTreeMap;
use std::path::PathBuf;

const LIMIT: Duration = Duration::from_secs(300);
/// Sizes of the pairs that are only compared.
const ODD: [Dims; 2] = [Dims { width: 131, height: 47 }, Dims { width: 98, height: 34 }];

/// Count the instructions of block matching and of the core on an emulated Cortex-M7.
#[derive(Debug, Parser)]
struct Args {
    /// A folder of captured scenes, cut to 320x240; without it, the built-in pairs.
    #[arg(long, value_name = "FOLDER")]
    frames: Option<PathBuf>,
}

/// A pair and its name.
type Named = (String, (GrayImage, GrayImage));

/// Result of a method for a pair.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    cost: u64,
    found: u64,
}

fn main() -> Result<()> {
    let args = Args::parse();
    let (built_in, core_stack) = bench()?;
    let (pairs, core) = match &args.frames {
        Some(folder) => {
            let pairs = board::captured(folder, BOARD.largest)?;
            let core = replay(&pairs)?;
            (pairs, core)
        }
        None => {
            let pairs = painted(BOARD.largest);
            let core = pairs.iter().map(|(name, _)| built_in.get(name).copied());
            let core: Option<Vec<u64>> = core.collect();
            (pairs, core.context("the table of bench lacks a pair")?)
        }
    };
    let (outcomes, stack) = blocks(&pairs)?;

    println!(
        "{}, pairs of {}, {DISPARITIES} disparities, thousands of instructions (disparities)",
        BOARD.name, BOARD.largest
    );
    print!("{:20} {:>8}", "", "core");
    METHODS.iter().for_each(|(method, ..)| print!(" {method:>16}"));
    let line = |name: &str, core: u64, outcomes: &[Outcome]| {
        print!("\n{name:20} {:>8}", core / 1000);
        outcomes
            .iter()
            .for_each(|Outcome { cost, found }| print!(" {:>8} ({found:>5})", cost / 1000));
    };
    for (((name, _), &core), outcomes) in pairs.iter().zip(&core).zip(&outcomes) {
        line(name, core, outcomes);
    }
    let core = median(core);
    let of_method = |place: usize| {
        let of = |number: fn(&Outcome) -> u64| {
            median(outcomes.iter().map(|of_pair| number(&of_pair[place])).collect())
        };
        Outcome { cost: of(|outcome| outcome.cost), found: of(|outcome| outcome.found) }
    };
    let medians = [0, 1, 2, 3].map(of_method);
    line("median", core, &medians);
    print!("\n{:20} {:>8}", "core = 1", "1.00");
    medians.iter().for_each(|median| print!(" {:>8.2} {:7}", median.cost as f64 / core as f64, ""));
    let [dense, grid] = Matchers::BYTES;
    println!(
        "\nbytes beside the frames: core {} + stack {core_stack}, dense {dense}, grid {grid}, + stack {stack}",
        mps2_an500::Workspace::CORE,
    );
    println!("every digest is the PC's");
    Ok(())
}

fn median(values: Vec<u64>) -> u64 {
    upper_median(values, Ord::cmp).unwrap_or(0)
}

/// Instructions of the core for each built-in pair, and the depth of the stack.
fn bench() -> Result<(BTreeMap<String, u64>, u64)> {
    let (mut pairs, mut stack) = (BTreeMap::new(), None);
    for line in run(&Images::of_firmware(&["bench"], Logs::None), &["table"], None)?.lines() {
        match line.split('\t').collect::<Vec<_>>()[..] {
            ["pair", name, _, ref costs @ ..] => {
                let costs: Vec<u64> =
                    costs.iter().map(|cost| cost.parse()).collect::<Result<_, _>>()?;
                pairs.insert(name.to_owned(), costs.iter().sum());
            }
            ["stack", depth] => stack = Some(depth.parse()?),
            _ => {}
        }
    }
    Ok((pairs, stack.context("the table of bench has no end")?))
}

/// Instructions of the core for each of these pairs.
fn replay(pairs: &[Named]) -> Result<Vec<u64>> {
    let images: Vec<_> = pairs.iter().map(|(_, (left, right))| (left, right)).collect();
    let replayed =
        Machine::new(BOARD)?.run_pairs(&board::update(&Params::DEFAULT, None), &images)?;
    let costs = |pair: Result<BoardResult, Refusal>| pair.map(|pair| pair.costs.iter().sum());
    replayed.pairs.into_iter().map(|pair| costs(pair).map_err(|why| anyhow!("{why}"))).collect()
}

/// Runs a board program with these arguments, beside a file of pairs, and returns the file `table`.
fn run(images: &Images<'_>, arguments: &[&str], pairs: Option<&[u8]>) -> Result<String> {
    let elf =
        images.build(&Toolchain::for_board(&BOARD)?, &BOARD)?.pop().context("nothing was built")?;
    let folder = tempfile::tempdir()?;
    if let Some(pairs) = pairs {
        std::fs::write(folder.path().join("pairs"), pairs)?;
    }
    qemu::run(&BOARD, &elf, arguments, folder.path(), LIMIT)?
        .success(images.programs[0], &BOARD)?;
    Ok(std::fs::read_to_string(folder.path().join("table"))?)
}

/// The built-in pairs of a size.
fn painted(dims: Dims) -> Vec<Named> {
    let of = |scene: Scene| {
        let blank = || vec![0; usize::from(dims.width) * usize::from(dims.height)];
        let (mut left, mut right) = (blank(), blank());
        scene.paint(dims, &mut left, &mut right);
        let [left, right] = [left, right].map(|pixels| GrayImage { dims, pixels });
        (format!("{}_{dims}", scene.name()), (left, right))
    };
    Scene::ALL.map(of).into()
}

/// Runs the board program on these pairs, compares it with this machine, and returns for each pair
/// what each method gave, and the depth of the stack.
fn blocks(pairs: &[Named]) -> Result<(Vec<[Outcome; METHODS.len()]>, u64)> {
    let mut file = Vec::new();
    pairs.iter().for_each(|(_, pair)| push(&mut file, pair, DISPARITIES));
    for (_, pair) in ODD.into_iter().flat_map(painted) {
        [16, 32, 48, 64].into_iter().for_each(|disparities| push(&mut file, &pair, disparities));
    }
    let mut here = String::new();
    let mut matchers = Box::new(Matchers::new());
    matchers.run(&NoClock, &mut Bytes(&file), &mut here)?;

    let images =
        Images { package: "linestereo-lab-board", ..Images::of_firmware(&["blocks"], Logs::None) };
    let there = run(&images, &["pairs", "table"], Some(&file))?;

    let (mut outcomes, mut stack) = (Vec::new(), None);
    let mut expected = here.lines();
    for line in there.lines() {
        match line.split('\t').collect::<Vec<_>>()[..] {
            ["stack", depth] => stack = Some(depth.parse()?),
            [cost, found, digest] => {
                let same = expected.next().and_then(|line| line.split_once('\t'));
                ensure!(
                    same == Some(("0", &format!("{found}\t{digest}"))),
                    "{line} on the board, {same:?} on this machine"
                );
                outcomes.push(Outcome { cost: cost.parse()?, found: found.parse()? });
            }
            _ => bail!("the table of blocks has an unknown line: {line}"),
        }
    }
    ensure!(expected.next().is_none(), "the board matched fewer pairs than this machine");
    let outcomes = outcomes.as_chunks().0.iter().take(pairs.len()).copied().collect();
    Ok((outcomes, stack.context("the table of blocks has no end")?))
}

/// Puts a pair behind those of a file.
fn push(file: &mut Vec<u8>, (left, right): &(GrayImage, GrayImage), disparities: usize) {
    let Dims { width, height } = left.dims;
    file.extend([width, height, disparities as u16].into_iter().flat_map(u16::to_le_bytes));
    file.extend_from_slice(&left.pixels);
    file.extend_from_slice(&right.pixels);
}

/// A file in memory.
struct Bytes<'a>(&'a [u8]);

impl ByteSource for Bytes<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let count = bytes.len().min(self.0.len());
        let (now, later) = self.0.split_at(count);
        bytes[..count].copy_from_slice(now);
        self.0 = later;
        count
    }
}
