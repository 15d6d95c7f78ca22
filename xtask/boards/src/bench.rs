//! Instructions by stage, from the programs `bench` (built-in pairs) and `replay` (captured ones);
//! of rectification, from `rectify`.

use anyhow::{Context, Result};
use core::fmt::Write;
use linestereo::{Dims, Params, unstable::Stage};
use linestereo_firmware::ports::NoClock;
use linestereo_firmware::programs::rectify::{self, BuiltIn};
use linestereo_frames::{GrayImage, statistics::upper_median};
use linestereo_sim::board::firmware::{self, Logs};
use linestereo_sim::board::toolchain::Toolchain;
use linestereo_sim::board::{self, Board, BoardResult, Costs, Machine, qemu};
use linestereo_wire::{Command, RegionBox, Regions, Request};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Cost of a pair's obstacles, and of telling an autopilot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Autopilot {
    /// Instructions from matches to sectors.
    pub(crate) obstacles: u64,
    /// Instructions to write a heartbeat and the distances.
    pub(crate) mavlink: u64,
    /// Bytes of both.
    pub(crate) bytes: u64,
}

impl Autopilot {
    /// The largest of each.
    pub(crate) fn largest(of: &[(String, Self)]) -> Self {
        let largest =
            |number: fn(&Self) -> u64| of.iter().map(|(_, one)| number(one)).max().unwrap_or(0);
        Self {
            obstacles: largest(|one| one.obstacles),
            mavlink: largest(|one| one.mavlink),
            bytes: largest(|one| one.bytes),
        }
    }
}

/// Results of the program `bench`.
pub(crate) struct Builtin {
    /// Name and instructions by stage of every pair.
    pub(crate) pairs: Vec<(String, Costs)>,
    /// Cost of an autopilot, by pair.
    pub(crate) autopilot: Vec<(String, Autopilot)>,
}

/// Runs the program `bench`, as it is without logs.
pub(crate) fn builtin(board: &Board) -> Result<Builtin> {
    let (mut pairs, mut autopilot) = (Vec::new(), Vec::new());
    for line in table_of(board, "bench", &[])?.lines() {
        match line.split('\t').collect::<Vec<_>>()[..] {
            ["pair", name, _, ref costs @ ..] => {
                pairs.push((name.to_owned(), numbers("bench", line, costs)?));
            }
            ["autopilot", name, ref costs @ ..] => {
                let [obstacles, mavlink, bytes] = numbers("bench", line, costs)?;
                autopilot.push((name.to_owned(), Autopilot { obstacles, mavlink, bytes }));
            }
            ["stack", _] => {}
            _ => return Err(unknown("bench", line)),
        }
    }
    Ok(Builtin { pairs, autopilot })
}

/// The table that a program without logs writes; `input` is the file that it reads, if it does.
fn table_of(board: &Board, program: &str, input: &[u8]) -> Result<String> {
    let elf = firmware::build(&Toolchain::for_board(board)?, board, program, Logs::None)?;
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("input"), input)?;
    let arguments: &[&str] = if input.is_empty() { &["table"] } else { &["input", "table"] };
    qemu::run(board, &elf, arguments, folder.path(), crate::LIMIT)?.success(program, board)?;
    Ok(std::fs::read_to_string(folder.path().join("table"))?)
}

/// The numbers of a line of a program's table.
fn numbers<const N: usize>(program: &str, line: &str, columns: &[&str]) -> Result<[u64; N]> {
    let numbers: Vec<u64> =
        columns.iter().map(|number| number.parse()).collect::<Result<_, _>>()?;
    numbers.try_into().map_err(|_| unknown(program, line))
}

fn unknown(program: &str, line: &str) -> anyhow::Error {
    anyhow::anyhow!("the table of {program} has an unknown line: {line}")
}

/// Cost of rectifying a pair with a built-in rig.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Rectified {
    /// Instructions from the rig to both meshes.
    pub(crate) set_up: u64,
    /// Instructions for both images.
    pub(crate) rows: u64,
    /// Instructions of the most expensive raw row.
    pub(crate) worst_row: u64,
    /// Raw rows held, bytes of the camera that needs more.
    pub(crate) band_bytes: u64,
}

/// Runs the program `rectify`: by rig and size, such as `moderate_320x240`.
pub(crate) fn rectified(board: &Board) -> Result<BTreeMap<String, Rectified>> {
    let mut rigs = BTreeMap::new();
    let here = rectified_here(board)?;
    for line in table_of(board, "rectify", &[])?.lines() {
        let ["rectify", name, ref costs @ .., digest] = line.split('\t').collect::<Vec<_>>()[..]
        else {
            return Err(unknown("rectify", line));
        };
        let expected =
            here.get(name).with_context(|| format!("there is no built-in rig {name}"))?;
        if digest != expected {
            anyhow::bail!(
                "{name} on {}: rectified images have the digest {digest}, on this machine \
                 {expected}",
                board.name
            );
        }
        let [set_up, rows, worst_row, band_bytes] = numbers("rectify", line, costs)?;
        rigs.insert(name.to_owned(), Rectified { set_up, rows, worst_row, band_bytes });
    }
    Ok(rigs)
}

/// Digests of what this machine rectifies with the built-in rigs in a board's sizes.
fn rectified_here(board: &Board) -> Result<BTreeMap<String, String>> {
    let mut workspace = Box::new(rectify::RectifyMemory::new());
    let rigs = board.sizes.iter().flat_map(|&dims| BuiltIn::ALL.map(|rig| (rig, dims)));
    let digest = |(rig, dims): (BuiltIn, Dims)| {
        let measured = rectify::measure(&mut workspace, &NoClock, rig, dims);
        let digest =
            measured.with_context(|| format!("{} {dims} cannot be rectified", rig.name()))?.digest;
        Ok((format!("{}_{dims}", rig.name()), format!("{digest:08x}")))
    };
    rigs.map(digest).collect()
}

/// Built-in pairs by their size and kind, such as `128x96` and `128x96_worst_case`, without these
/// in their names.
pub(crate) fn by_size(
    board: &Board,
    pairs: Vec<(String, Costs)>,
) -> Result<BTreeMap<String, Vec<(String, Costs)>>> {
    let mut groups: BTreeMap<String, Vec<(String, Costs)>> = BTreeMap::new();
    for (name, costs) in pairs {
        // Such as bricks_128x96_worst_case.
        let parts =
            board.sizes.iter().find_map(|dims| Some((dims, name.split_once(&format!("_{dims}"))?)));
        let (dims, (scene, kind)) =
            parts.with_context(|| format!("the pair {name} has no size"))?;
        groups.entry(format!("{dims}{kind}")).or_default().push((scene.to_owned(), costs));
    }
    Ok(groups)
}

/// Prints the tables.
pub(crate) fn run(boards: &[Board], frames: Option<&Path>) -> Result<()> {
    for board in boards {
        println!(
            "{}, rectification of a pair, thousands of instructions (band: bytes of a camera)",
            board.name
        );
        for (name, Rectified { set_up, rows, worst_row, band_bytes }) in rectified(board)? {
            let [set_up, rows, worst_row] = [set_up, rows, worst_row].map(|count| count / 1000);
            println!(
                "{name:30} set-up {set_up:>7} both images {rows:>6} most expensive row \
                 {worst_row:>4} band {band_bytes:>6}"
            );
        }
        let Builtin { pairs, autopilot } = builtin(board)?;
        println!("{}, an autopilot, instructions and bytes", board.name);
        for (name, Autopilot { obstacles, mavlink, bytes }) in autopilot {
            println!("{name:30} obstacles {obstacles:>6} MAVLink {mavlink:>6} bytes {bytes:>4}");
        }
        for (size, pairs) in by_size(board, pairs)? {
            println!(
                "{}, built-in pairs of {size}, thousands of instructions\n{}",
                board.name,
                table(&pairs)
            );
        }
        for &dims in board.sizes.iter().filter(|_| frames.is_some()) {
            let folder = frames.unwrap_or(Path::new("."));
            let pairs = captured(board, folder, dims)?;
            let (name, folder) = (board.name, folder.display());
            println!(
                "{name}, pairs of {folder} cut to {dims}, thousands of instructions\n{}",
                table(&pairs)
            );
        }
        if let Some(frames) = frames {
            print_objects(board, frames)?;
            if ON_TWO_CORES.contains(board) {
                print_cores(board, frames)?;
            }
        }
    }
    Ok(())
}

/// Prints what objects cost, and pairs that are matched around them alone.
fn print_objects(board: &Board, frames: &Path) -> Result<()> {
    for &dims in board.sizes {
        let pairs = object_pairs(board, frames, dims)?;
        let Objects { eight: cost, points, tenth_permille, one_box_permille, .. } =
            Objects::new(&pairs);
        println!("{}, {dims}: eight objects {cost} instructions, all points {points}", board.name);
        for (boxes, permille, parts) in [
            ("three boxes", tenth_permille, pairs.tenth),
            ("one box", one_box_permille, pairs.one_box),
        ] {
            let costs: Vec<_> =
                pairs.names.iter().cloned().zip(parts.iter().map(|part| part.costs)).collect();
            println!(
                "{boxes} with a tenth of the pixels: {permille} permille of a pair, thousands of \
                 instructions"
            );
            println!("{}", table(&costs));
        }
    }
    Ok(())
}

/// Instructions of every one of these [scenes](board::captured) with default parameters, 64
/// disparities.
pub(crate) fn captured(board: &Board, folder: &Path, dims: Dims) -> Result<Vec<(String, Costs)>> {
    let (names, images): (Vec<_>, Vec<_>) = board::captured(folder, dims)?.into_iter().unzip();
    let pairs: Vec<_> = images.iter().map(|(left, right)| (left, right)).collect();
    let replayed =
        Machine::new(*board)?.run_pairs(&board::update(&Params::DEFAULT, None), &pairs)?;
    let found = names.into_iter().zip(replayed.pairs);
    found
        .map(|(name, pair)| Ok((name, pair.map_err(|why| anyhow::anyhow!("{why}"))?.costs)))
        .collect()
}

/// Boards on which pairs are matched on two cores as well: the Cortex-M7 whose other numbers are
/// known, and the processor of the RP2350.
pub(crate) const ON_TWO_CORES: [Board; 2] = [Board::MPS2_AN500, Board::MPS2_AN505];

/// A pair on one core, and on two, instructions: medians over captured scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Cores {
    /// On one core.
    pub(crate) one: u64,
    /// Of the busier one of two.
    pub(crate) busier: u64,
    /// The same in permille of the former.
    pub(crate) permille: u64,
    /// How often the cores meet.
    pub(crate) joins: u64,
}

/// The input of a program that matches scenes of [`board::captured`]: default parameters, then
/// every pair.
pub(crate) fn input(scenes: &[(String, (GrayImage, GrayImage))]) -> Result<Vec<u8>> {
    let mut input = Vec::new();
    let update = board::update(&Params::DEFAULT, None);
    board::push(&mut input, &Command { id: 0, request: Request::SetParams(update) })?;
    for (_, (left, right)) in scenes {
        board::push_pair(&mut input, 0, left, right)?;
    }
    Ok(input)
}

/// Costs of every scene of [`captured`] on one core and on two.
fn core_pairs(board: &Board, folder: &Path, dims: Dims) -> Result<Vec<(String, Cores)>> {
    let scenes = board::captured(folder, dims)?;
    let input = input(&scenes)?;
    let mut costs = Vec::new();
    for (line, (name, _)) in table_of(board, "cores", &input)?.lines().zip(scenes) {
        let ["cores", columns @ ..] = &line.split('\t').collect::<Vec<_>>()[..] else {
            return Err(unknown("cores", line));
        };
        let [one, busier, joins] = numbers("cores", line, columns)?;
        costs.push((name, Cores { one, busier, permille: busier * 1000 / one, joins }));
    }
    Ok(costs)
}

/// Measures on the scenes of [`captured`].
pub(crate) fn cores(board: &Board, folder: &Path, dims: Dims) -> Result<Cores> {
    let costs = core_pairs(board, folder, dims)?;
    let of =
        |number: fn(&Cores) -> u64| median(costs.iter().map(|(_, costs)| number(costs)).collect());
    Ok(Cores {
        one: of(|costs| costs.one),
        busier: of(|costs| costs.busier),
        permille: of(|costs| costs.permille),
        joins: of(|costs| costs.joins),
    })
}

/// Prints what pairs cost on one core, and on two.
fn print_cores(board: &Board, folder: &Path) -> Result<()> {
    let dims = board.largest;
    println!("{}, {dims}, instructions on one core and of the busier of two", board.name);
    for (name, Cores { one, busier, permille, joins }) in core_pairs(board, folder, dims)? {
        println!("{name:30} {one:>9} {busier:>9} permille {permille:>4} joins {joins:>4}");
    }
    Ok(())
}

/// Depths of objects, the list of points, and matching where objects are alone: medians over
/// captured scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Objects {
    /// Instructions for the depths of eight boxes, on top of the pair.
    pub(crate) eight: u64,
    /// Instructions for the list of all points, on top of the pair.
    pub(crate) points: u64,
    /// Instructions of a pair that is matched in and around three boxes with a tenth of its pixels.
    pub(crate) tenth: u64,
    /// The same in permille of the whole pair's.
    pub(crate) tenth_permille: u64,
    /// The same when the tenth is one box.
    pub(crate) one_box_permille: u64,
}

/// Eight boxes in two rows.
fn eight(dims: Dims) -> Regions {
    let Dims { width, height } = dims;
    let of = |i: u16| {
        let (left, top) = (i % 4 * width / 4 + width / 40, i / 4 * height / 2 + height / 12);
        RegionBox { label: i, left, top, right: left + width / 5, bottom: top + height / 3 }
    };
    Regions { boxes: (0..8).map(of).collect(), only: false }
}

/// Three boxes with a tenth of the pixels, apart from each other.
fn tenth(dims: Dims) -> Regions {
    let Dims { width, height } = dims;
    let (w, h) = (width * 4 / 25, height * 5 / 24); // a thirtieth
    let of = |(label, (x, y)): (u16, (u16, u16))| {
        let (left, top) = (width * x / 16, height * y / 12);
        RegionBox { label, left, top, right: left + w, bottom: top + h }
    };
    Regions { boxes: (0..).zip([(2, 2), (10, 4), (5, 8)]).map(of).collect(), only: true }
}

/// A tenth of the pixels in the middle.
fn one_box(dims: Dims) -> Regions {
    let Dims { width, height } = dims;
    let (w, h) = (width * 6 / 19, height * 6 / 19);
    let (left, top) = ((width - w) / 2, (height - h) / 2);
    let of = RegionBox { label: 0, left, top, right: left + w, bottom: top + h };
    Regions { boxes: [of].into_iter().collect(), only: true }
}

/// Pairs of captured scenes with boxes.
struct ObjectPairs {
    names: Vec<String>,
    /// Whole pairs with eight boxes.
    eight: Vec<BoardResult>,
    /// Matched around three boxes with a tenth of the pixels, and around one.
    tenth: Vec<BoardResult>,
    one_box: Vec<BoardResult>,
}

impl Objects {
    fn new(ObjectPairs { eight, tenth, one_box, .. }: &ObjectPairs) -> Self {
        let all = |part: &BoardResult| total(&part.costs) + part.objects_cost;
        let permille =
            |(whole, part): (&BoardResult, &BoardResult)| all(part) * 1000 / total(&whole.costs);
        Self {
            eight: median(eight.iter().map(|whole| whole.objects_cost).collect()),
            points: median(eight.iter().map(|whole| whole.points_cost).collect()),
            tenth: median(tenth.iter().map(all).collect()),
            tenth_permille: median(eight.iter().zip(tenth).map(permille).collect()),
            one_box_permille: median(eight.iter().zip(one_box).map(permille).collect()),
        }
    }
}

/// Measures on the scenes of [`captured`].
pub(crate) fn objects(board: &Board, folder: &Path, dims: Dims) -> Result<Objects> {
    Ok(Objects::new(&object_pairs(board, folder, dims)?))
}

fn object_pairs(board: &Board, folder: &Path, dims: Dims) -> Result<ObjectPairs> {
    let (names, images): (Vec<_>, Vec<_>) = board::captured(folder, dims)?.into_iter().unzip();
    // One after the other: a camera that shows the same twice is taken for a frozen one.
    let ask =
        |regions: Regions| images.iter().map(move |(left, right)| (left, right, regions.clone()));
    let pairs: Vec<_> =
        ask(eight(dims)).chain(ask(tenth(dims))).chain(ask(one_box(dims))).collect();
    let replayed = Machine::new(*board)?
        .run_pairs_with_objects(&board::update(&Params::DEFAULT, None), &pairs)?;
    let found: Vec<_> = replayed
        .pairs
        .into_iter()
        .collect::<Result<_, _>>()
        .map_err(|why| anyhow::anyhow!("{why}"))?;
    let mut groups = found.into_iter();
    let mut group = || groups.by_ref().take(names.len()).collect();
    let (eight, tenth, one_box) = (group(), group(), group());
    Ok(ObjectPairs { names, eight, tenth, one_box })
}

/// Median of the totals, or of one stage.
pub(crate) fn median(values: Vec<u64>) -> u64 {
    upper_median(values, Ord::cmp).unwrap_or(0)
}

/// Instructions of a pair.
pub(crate) fn total(costs: &Costs) -> u64 {
    costs.iter().sum()
}

fn table(pairs: &[(String, Costs)]) -> String {
    let mut text = format!("{:30} {:>9}", "", "total");
    for stage in Stage::ALL {
        let _ = write!(text, " {:>11}", stage.name());
    }
    let mut line = |name: &str, total: u64, stages: &[u64]| {
        let _ = write!(text, "\n{name:30} {:>9}", total / 1000);
        for cost in stages {
            let _ = write!(text, " {:>11}", cost / 1000);
        }
    };
    for (name, costs) in pairs {
        line(name, total(costs), costs);
    }
    let over = |fold: fn(Vec<u64>) -> u64| {
        let stages = Stage::ALL
            .map(|stage| fold(pairs.iter().map(|(_, costs)| costs[stage as usize]).collect()));
        (fold(pairs.iter().map(|(_, costs)| total(costs)).collect()), stages)
    };
    let (of_totals, of_stages) = over(median);
    line("median", of_totals, &of_stages);
    let (of_totals, of_stages) = over(|values| values.into_iter().max().unwrap_or(0));
    line("largest", of_totals, &of_stages);
    text.push('\n');
    text
}
