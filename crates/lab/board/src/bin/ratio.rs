//! Block matching beside the core on an emulated Cortex-M7: instructions and memory, on the same
//! pairs.
//!
//! Every disparity of the board is compared with the PC's, also on small pairs of odd sizes with
//! each number of disparities: the kernels for its processor with the portable ones.

use anyhow::{Context, Result, anyhow, bail, ensure};
use clap::Parser;
use core::time::Duration;
use linestereo::{Dims, Params};
use linestereo_boards::built_in::Scene;
use linestereo_firmware::boards::mps2_an500;
use linestereo_firmware::ports::{ByteSource, NoClock};
use linestereo_frames::GrayImage;
use linestereo_frames::statistics::upper_median;
use linestereo_lab_board::{BOARD, METHODS, Matcher, Settings};
use linestereo_sim::board::firmware::{Images, Logs};
use linestereo_sim::board::toolchain::Toolchain;
use linestereo_sim::board::{self, Machine, qemu};
use std::path::PathBuf;

const LIMIT: Duration = Duration::from_secs(300);
/// Sizes of the pairs that are only compared.
const ODD: [Dims; 3] = [
    Dims { width: 131, height: 47 },
    Dims { width: 98, height: 34 },
    Dims { width: 132, height: 24 },
];

/// Count the instructions of block matching and of the core on an emulated Cortex-M7.
#[derive(Debug, Parser)]
struct Args {
    /// A folder of captured scenes, cut to 320x240; without it, the built-in pairs.
    #[arg(long, value_name = "FOLDER")]
    frames: Option<PathBuf>,
}

/// A pair and its name.
type Named = (String, (GrayImage, GrayImage));
/// Instructions and number of disparities of each method.
type Outcomes = [(u64, u32); METHODS.len()];

fn main() -> Result<()> {
    let pairs = match Args::parse().frames {
        Some(folder) => board::captured(&folder, BOARD.largest)?,
        None => painted(BOARD.largest),
    };
    let (core, core_stack) = core(&pairs)?;
    let (blocks, stack) = blocks(&pairs)?;

    println!("{}, thousands of instructions (disparities), the ratio of medians", BOARD.name);
    let [usual, strict] = METHODS.map(|(name, _)| name);
    println!("{:20} {:>8} {usual:>16} {strict:>16}", "", "core");
    for (((name, _), cost), [usual, strict]) in pairs.iter().zip(&core).zip(&blocks) {
        let of = |(cost, found): (u64, u32)| format!("{} ({found})", cost / 1000);
        println!("{name:20} {:>8} {:>16} {:>16}", cost / 1000, of(*usual), of(*strict));
    }
    let median = |costs: Vec<u64>| upper_median(costs, Ord::cmp).unwrap_or(0) as f64;
    let [usual, strict] = [0, 1].map(|method| {
        median(blocks.iter().map(|pair| pair[method].0).collect()) / median(core.clone())
    });
    println!("{:20} {:>8} {usual:>16.2} {strict:>16.2}", "core = 1", "1.00");
    println!(
        "bytes beside the frames: core {} + stack {core_stack}, blocks {} + stack {stack}",
        mps2_an500::BoardMemory::CORE,
        Matcher::BYTES
    );
    println!("every digest is the PC's");
    Ok(())
}

/// Instructions of the core for each of these pairs, and the depth of its stack.
fn core(pairs: &[Named]) -> Result<(Vec<u64>, u64)> {
    let images: Vec<_> = pairs.iter().map(|(_, (left, right))| (left, right)).collect();
    let replayed =
        Machine::new(BOARD)?.run_pairs(&board::update(&Params::DEFAULT, None), &images)?;
    let costs: Result<Vec<u64>> = replayed
        .pairs
        .into_iter()
        .map(|pair| Ok(pair.map_err(|why| anyhow!("{why}"))?.costs.iter().sum()))
        .collect();
    Ok((costs?, replayed.stack))
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

/// Runs the board program on these pairs, compares it with this machine, and returns instructions
/// and number of disparities of each pair and method, and the depth of the stack.
fn blocks(pairs: &[Named]) -> Result<(Vec<Outcomes>, u64)> {
    let mut file = Vec::new();
    pairs.iter().for_each(|(_, pair)| push(&mut file, pair, Settings::USUAL.disparities));
    for (_, pair) in ODD.into_iter().flat_map(painted) {
        [16, 32, 48, 64].into_iter().for_each(|disparities| push(&mut file, &pair, disparities));
    }
    let mut here = String::new();
    let mut matcher = Box::new(Matcher::new());
    matcher.run(&NoClock, &mut Bytes(&file), &mut here)?;

    let images =
        Images { package: "linestereo-lab-board", ..Images::of_firmware(&["blocks"], Logs::None) };
    let elf =
        images.build(&Toolchain::for_board(&BOARD)?, &BOARD)?.pop().context("nothing was built")?;
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("pairs"), file)?;
    qemu::run(&BOARD, &elf, &["pairs", "table"], folder.path(), LIMIT)?
        .success("blocks", &BOARD)?;
    let there = std::fs::read_to_string(folder.path().join("table"))?;

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
                outcomes.push((cost.parse()?, found.parse()?));
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
