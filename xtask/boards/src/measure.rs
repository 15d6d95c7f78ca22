//! `cargo xtask measure`: the numbers of `xtask/board-numbers.toml`, measured again and compared.
//!
//! Compared are medians, maxima and bytes; what stands under `by_stage` and `by_pair` is for
//! reading. The built-in pairs one by one go to the program, whose `bench-board` divides by them.

use crate::bench::{self, Autopilot, Builtin, Cores, Objects, Rectified};
use crate::sizes;
use crate::stored::Stored;
use anyhow::{Context, Result};
use linestereo::{Dims, Params, unstable::Stage};
use linestereo_calibration::rectify::PairRectifier;
use linestereo_firmware::programs::rectify::BuiltIn;
use linestereo_rig::{CameraSide, RigImage, View};
use linestereo_sim::board::toolchain::Toolchain;
use linestereo_sim::board::{self, Board, Costs, Machine, update};
use linestereo_sim::scene::{self, Kind, Sensor};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The instructions of the built-in pairs, for the program.
const PAIRS_FILE: &str = "host-sim/src/board/instructions.toml";

const STORED: Stored = Stored {
    file: "xtask/board-numbers.toml",
    bless: "cargo xtask measure --bless",
    head: "\
# Cost of a pair on the boards. Written by `cargo xtask measure --bless`, compared by `cargo xtask measure`: a loss of more than 1 % is
# an error, a gain of more than 1 % asks for a new blessing.
#
# Instructions are those that QEMU executed, to match two rectified frames; QEMU models no cycles, caches or wait states. Cycles of
# real boards are in xtask/silicon, a file a board as its owner sent it.
# All pairs: default parameters, 64 disparities; \"worst_case\" ones: parameters that find and report as much as any can.
# built_in: frames painted on the board (crates/boards/src/built_in), the same everywhere; all but blocks and rows_off are worst cases.
# The boards that stand for other families of processors have what one program, bench, gives.
# captured: the folder qvga of the captured frames, which are not part of this repository; cut to the size from the middle, and measured
# again only where LINESTEREO_FRAMES names them.
# rectify: two built-in rigs (firmware/src/programs/rectify.rs), from the rig to both meshes once, and both images of every pair.
# objects: on the captured pairs, medians: the depths of eight boxes on top of a pair, and the list of all its points; all of a pair that is
# matched around three boxes with a tenth of its pixels alone, also in permille of the whole pair's, and around one such box.
# cores: the captured pairs, medians: on one core, and of the busier of two, in permille too; and how often these meet. The program for it
# (firmware/src/programs/cores.rs) does both halves of each step one after the other.
# autopilot: the most expensive of the built-in pairs: from matches to 72 sectors, to a HEARTBEAT and an OBSTACLE_DISTANCE, and bytes of both.
# Bytes: of the program that is fed by a file (replay), without logs; that for cameras is in board-sizes.toml. stack_used: the largest depth.
# ram = static_ram + stack_used.
# raw: a rendered raw pair rectified row by row (75 degrees of view, cameras turned by a degree) to the lists; band: the bytes of raw rows
# held of the camera that needs more.

",
};

#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
struct Numbers {
    compiler: String,
    boards: BTreeMap<String, BoardNumbers>,
}

#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
struct BoardNumbers {
    /// Instructions of each built-in pair: not of this file, but of the program's.
    #[serde(skip)]
    pairs: BTreeMap<String, u64>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    bytes: BTreeMap<String, u64>,
    built_in: BTreeMap<String, Instructions>,
    #[serde(default)]
    autopilot: Option<Autopilot>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    captured: BTreeMap<String, Captured>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    objects: BTreeMap<String, Objects>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    cores: BTreeMap<String, Cores>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    rectify: BTreeMap<String, Rectified>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    raw: BTreeMap<String, RawPair>,
}

/// Of a raw pair.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct RawPair {
    rectification: u64,
    matching: u64,
    band: u64,
}

/// Of the pairs of one size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Instructions {
    median: u64,
    largest: u64,
}

/// The same of captured pairs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Captured {
    #[serde(flatten)]
    all: Instructions,
    /// Medians.
    by_stage: BTreeMap<String, u64>,
    by_pair: BTreeMap<String, u64>,
}

impl Instructions {
    fn new(pairs: &[(String, Costs)]) -> Self {
        let totals = || pairs.iter().map(|(_, costs)| bench::total(costs));
        Self { median: bench::median(totals().collect()), largest: totals().max().unwrap_or(0) }
    }
}

impl Captured {
    fn new(pairs: &[(String, Costs)]) -> Self {
        let of_stage = |stage: Stage| {
            bench::median(pairs.iter().map(|(_, costs)| costs[stage as usize]).collect())
        };
        Self {
            all: Instructions::new(pairs),
            by_stage: Stage::ALL
                .into_iter()
                .map(|stage| (stage.name().to_owned(), of_stage(stage)))
                .collect(),
            by_pair: by_pair(pairs),
        }
    }
}

fn by_pair(pairs: &[(String, Costs)]) -> BTreeMap<String, u64> {
    pairs.iter().map(|(name, costs)| (name.clone(), bench::total(costs))).collect()
}

/// Measures, and writes the file or compares with it.
pub(crate) fn run(top: &Path, bless: bool) -> Result<()> {
    let frames =
        std::env::var_os("LINESTEREO_FRAMES").map(|folder| PathBuf::from(folder).join("qvga"));
    let frames = frames.filter(|folder| folder.is_dir());
    let mut old: Numbers = STORED.read(top, bless)?;
    let boards = if bless { Board::emulated().collect() } else { board::tested() };
    let boards: Vec<_> = boards.into_iter().filter(Board::is_emulated).collect();
    let mut new = measure(top, &boards, frames.as_deref())?;
    if bless {
        for (name, board) in &mut new.boards {
            // Numbers that cannot be measured here stay.
            if let Some(before) = old.boards.get(name).filter(|_| frames.is_none()) {
                board.captured.clone_from(&before.captured);
                board.objects.clone_from(&before.objects);
                board.cores.clone_from(&before.cores);
            }
        }
        STORED.write(top, &new)?;
        std::fs::write(top.join(PAIRS_FILE), instructions(&new)?)?;
        println!("{PAIRS_FILE}: blessed; commit it");
        return Ok(());
    }
    old.boards.retain(|name, _| boards.iter().any(|board| board.name == name));
    if old.compiler != new.compiler {
        println!("measured with {}, the file was with {}", new.compiler, old.compiler);
    }
    if frames.is_none() {
        println!("captured frames were not measured: LINESTEREO_FRAMES does not name them");
    }
    STORED.compare(&compared(&old, frames.is_some())?, &compared(&new, frames.is_some())?)
}

/// The instructions of each built-in pair on the emulated boards whose processors real boards have,
/// as the program reads them.
fn instructions(numbers: &Numbers) -> Result<String> {
    let real: Vec<&str> = Board::ALL
        .iter()
        .filter(|board| !board.is_emulated())
        .map(|board| board.processor)
        .collect();
    let mut boards = BTreeMap::new();
    for twin in Board::emulated().filter(|twin| real.contains(&twin.processor)) {
        let board = numbers.boards.get(twin.name);
        let board = board.with_context(|| format!("{} was not measured", twin.name))?;
        boards.insert(twin.name, &board.pairs);
    }
    let head = format!(
        "# Instructions of the built-in pairs: written with {} by `cargo xtask\n# measure \
         --bless`.",
        STORED.file
    );
    Ok(format!("{head}\n\n{}", toml::to_string(&boards)?))
}

fn measure(top: &Path, boards: &[Board], frames: Option<&Path>) -> Result<Numbers> {
    boards.iter().try_for_each(crate::images)?;
    let measure_board = |board: &Board| {
        let mut numbers = built_in(board)?;
        if Board::MEASURED.contains(board) {
            measure_all(board, &mut numbers, frames)?;
        }
        if let Some(folder) = frames.filter(|_| bench::ON_TWO_CORES.contains(board)) {
            let cores = bench::cores(board, folder, board.largest)?;
            numbers.cores.insert(board.largest.to_string(), cores);
        }
        eprintln!("measured {}", board.name);
        anyhow::Ok((board.name.to_owned(), numbers))
    };
    // Side by side: what QEMU counts does not depend on what else runs.
    let boards: BTreeMap<_, _> = std::thread::scope(|scope| {
        let running: Vec<_> =
            boards.iter().map(|board| scope.spawn(move || measure_board(board))).collect();
        running
            .into_iter()
            .map(|one| one.join().map_err(|_| anyhow::anyhow!("a thread panicked"))?)
            .collect::<Result<_>>()
    })?;
    Ok(Numbers { compiler: Toolchain::for_board(&Board::ALL[0])?.version(top)?, boards })
}

/// Raw pairs of the size of the board's largest one and half as large again, and the largest depth
/// of the stack over them: that of the program whose RAM and flash are given.
fn raw_pairs(board: &Board) -> Result<(BTreeMap<String, RawPair>, u64)> {
    let machine = Machine::new(*board)?;
    let (mut pairs, mut stack) = (BTreeMap::new(), 0);
    for halves in [2, 3] {
        let Dims { width, height } = board.largest;
        let raw = Dims { width: halves * width / 2, height: halves * height / 2 };
        let rig = rig(raw, board.largest)?;
        let rendering = scene::render(&scene::build(Kind::Demo, raw, 1), raw, &Sensor::default());
        let params = update(&rig.params(Params::default())?, None);
        let mut replayed =
            machine.run_raw_pairs(&rig, &params, &[(&rendering.left, &rendering.right)])?;
        let found = replayed.pairs.pop().context("no pair was answered")??;
        let rectifier = PairRectifier::new(rig.remap())?;
        let band = CameraSide::BOTH.map(|eye| rectifier.facts(eye).band_bytes as u64);
        let pair = RawPair {
            rectification: found.rectification,
            matching: bench::total(&found.costs),
            band: band[0].max(band[1]),
        };
        pairs.insert(format!("{raw} to {}", board.largest), pair);
        stack = stack.max(replayed.stack);
    }
    Ok((pairs, stack))
}

/// The built-in rig of 75 degrees of view.
fn rig(raw: Dims, rectified: Dims) -> Result<RigImage> {
    let calibration = BuiltIn::Moderate.calibration(raw).context("no rig of this size")?;
    let range = (0, Params::default().max_disparity);
    Ok(RigImage::new(calibration, rectified, View::default(), range)?)
}

/// Results of the program `bench`.
fn built_in(board: &Board) -> Result<BoardNumbers> {
    let Builtin { pairs, autopilot } = bench::builtin(board)?;
    let by_pair = by_pair(&pairs);
    let groups = bench::by_size(board, pairs)?;
    Ok(BoardNumbers {
        pairs: by_pair,
        built_in: groups
            .iter()
            .map(|(size, pairs)| (size.clone(), Instructions::new(pairs)))
            .collect(),
        autopilot: Some(Autopilot::largest(&autopilot)),
        ..BoardNumbers::default()
    })
}

/// Everything else.
fn measure_all(board: &Board, numbers: &mut BoardNumbers, frames: Option<&Path>) -> Result<()> {
    let (raw, stack) = raw_pairs(board)?;
    let replay = sizes::of(board, "replay")?;
    let bytes = [
        ("flash", replay.flash),
        ("static_ram", replay.static_ram),
        ("stack_used", stack),
        ("stack_reserved", replay.stack),
        ("ram", replay.static_ram + stack),
    ];
    if let Some(folder) = frames {
        for &dims in board.sizes {
            let pairs = bench::captured(board, folder, dims)?;
            numbers.captured.insert(dims.to_string(), Captured::new(&pairs));
            numbers.objects.insert(dims.to_string(), bench::objects(board, folder, dims)?);
        }
    }
    numbers.bytes = bytes.map(|(name, value)| (name.to_owned(), value)).into();
    numbers.rectify = bench::rectified(board)?;
    numbers.raw = raw;
    Ok(())
}

/// For reading, or what follows from other numbers.
const NOT_COMPARED: [&str; 5] = ["by_stage", "by_pair", "worst_row", "permille", "joins"];
/// Of captured frames.
const CAPTURED: [&str; 3] = ["captured", "objects", "cores"];

/// The numbers that are compared, by name: the keys down to each.
fn compared(numbers: &Numbers, with_captured: bool) -> Result<BTreeMap<String, u64>> {
    let mut list = BTreeMap::new();
    let mut tables = vec![(String::new(), toml::Table::try_from(&numbers.boards)?)];
    while let Some((path, table)) = tables.pop() {
        for (key, value) in table {
            let is_left_out =
                NOT_COMPARED.contains(&&*key) || (!with_captured && CAPTURED.contains(&&*key));
            let name = match &*path {
                "" => key,
                _ if key == "bytes" && value.is_table() => path.clone(),
                _ => format!("{path} {key}"),
            };
            match value {
                _ if is_left_out => {}
                toml::Value::Table(table) => tables.push((name, table)),
                number => _ = list.insert(name, number.try_into()?),
            }
        }
    }
    Ok(list)
}
