//! Costs of the built-in pairs on a board, and its digests beside the PC's: as a table, and as a
//! file that its owner sends.
//!
//! In: what the program `selftest` says. Out: cycles by pair and stage, cycles per instruction (the
//! instructions are those that QEMU counted for the same pairs on the same kind of processor), and
//! of each pair the first stage whose digest is another.

use anyhow::{Context, Result};
use core::fmt::Write;
use linestereo::unstable::Stage;
use linestereo_boards::Board;
use linestereo_boards::built_in::{Case, digests, first_difference};
use linestereo_frames::statistics::upper_median;
use linestereo_wire::{CaseReport, Hello, MachineReport, Silicon};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Instructions of each built-in pair on the emulated boards whose processors real boards have, by
/// board and pair.
const INSTRUCTIONS: &str = include_str!("instructions.toml");
/// The core's clock by its own counter may differ so much from the one it was set to: both come
/// from one oscillator.
const CLOCK_TOLERANCE: f64 = 0.01;

/// Answers of a board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoardNumbers {
    pub board: String,
    pub processor: String,
    pub firmware: String,
    /// Unit of its costs: `cycles`, or `instructions` of an emulator.
    pub unit: String,
    /// Do all pairs have the PC's digests?
    pub equal: bool,
    /// The chip and how it is set up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub silicon: Option<SiliconNumbers>,
    /// Cycles per instruction over the pairs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles_per_instruction: Option<PerInstruction>,
    pub pairs: BTreeMap<String, PairNumbers>,
}

/// A [`Silicon`] as text, and its clock as measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SiliconNumbers {
    pub processor_id: String,
    pub chip_id: String,
    pub core_hz: u32,
    /// The same by the cycles and the microseconds of all pairs.
    pub measured_hz: u64,
    pub flash_wait: u8,
    pub instruction_cache: bool,
    pub data_cache: bool,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PerInstruction {
    /// Of the pair in the middle.
    pub median: f64,
    /// Of the pairs at both ends.
    pub range: [f64; 2],
    /// Range that the boards' pages assume.
    pub assumed: [f64; 2],
    /// The emulated board whose instructions were counted.
    pub instructions: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairNumbers {
    /// Sum over the stages.
    pub total: u64,
    pub time_us: u32,
    /// Segments of the left image.
    pub segments: u16,
    /// The first stage whose digest is not the PC's, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub differs_in: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles_per_instruction: Option<f64>,
    pub by_stage: BTreeMap<String, u64>,
    /// Of the stages in their order, then of what an autopilot gets, hexadecimal.
    pub digests: Vec<String>,
}

impl BoardNumbers {
    /// Of what a board said: of every pair.
    pub fn new(hello: &Hello, machine: &MachineReport, reports: &[CaseReport]) -> Result<Self> {
        let name = &hello.board;
        let board = Board::named(name).with_context(|| {
            format!(
                "this program knows no board {name}; build it and the firmware from one checkout"
            )
        })?;
        let is_in_cycles = machine.unit == "cycles";
        let counted = instructions(&board)?.filter(|_| is_in_cycles);
        let mut pairs = BTreeMap::new();
        for (number, (case, expected)) in Case::all(&board).zip(digests::of(&board)).enumerate() {
            let name = case.to_string();
            let report = reports
                .iter()
                .find(|report| usize::from(report.case) == number && *report.name == *name);
            let report = report.with_context(|| format!("the board said nothing of {name}"))?;
            let differs_in = first_difference(&report.digests, expected);
            let counted = counted.as_ref().and_then(|(_, counted)| counted.get(&name)).copied();
            pairs.insert(name, PairNumbers::new(report, differs_in, counted));
        }
        let ratios: Vec<f64> =
            pairs.values().filter_map(|pair| pair.cycles_per_instruction).collect();
        let per_instruction =
            upper_median(ratios.clone(), f64::total_cmp).zip(counted).map(|(median, (of, _))| {
                let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
                let range = [least, ratios.iter().copied().fold(0.0, f64::max)];
                PerInstruction {
                    median,
                    range,
                    assumed: assumed(&board),
                    instructions: of.to_owned(),
                }
            });
        Ok(Self {
            board: board.name.to_owned(),
            processor: board.processor.to_owned(),
            firmware: machine.firmware.to_string(),
            unit: machine.unit.to_string(),
            equal: pairs.values().all(|pair| pair.differs_in.is_none()),
            silicon: machine.silicon.map(|silicon| SiliconNumbers::new(&silicon, reports)),
            cycles_per_instruction: per_instruction,
            pairs,
        })
    }

    /// The pairs whose digests are not the PC's, each with the first stage.
    pub fn wrong(&self) -> impl Iterator<Item = (&str, &str)> {
        self.pairs
            .iter()
            .filter_map(|(name, pair)| Some((name.as_str(), pair.differs_in.as_deref()?)))
    }

    /// Doubts about the costs, a line each.
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = Vec::new();
        if self.pairs.values().any(|pair| pair.total == 0) {
            doubts.push(format!("a pair cost no {}: the counter stands", self.unit));
        }
        if let Some(silicon) = &self.silicon {
            let measured = silicon.measured_hz as f64 / f64::from(silicon.core_hz.max(1));
            if (measured - 1.0).abs() > CLOCK_TOLERANCE {
                let [set, found] =
                    [u64::from(silicon.core_hz), silicon.measured_hz].map(|hz| hz as f64 / 1e6);
                doubts
                    .push(format!("the core was set to {set:.1} MHz and runs at {found:.1} MHz by the board's clock"));
            }
            if !(silicon.instruction_cache && silicon.data_cache) {
                doubts.push("a cache is off".to_owned());
            }
        }
        doubts
    }

    /// For people.
    pub fn table(&self) -> String {
        let mut text = format!("{} ({}), firmware {}\n", self.board, self.processor, self.firmware);
        if let Some(silicon) = &self.silicon {
            let SiliconNumbers { processor_id, chip_id, measured_hz, flash_wait, .. } = silicon;
            let on = |is_on| if is_on { "on" } else { "off" };
            let _ = writeln!(
                text,
                "processor {processor_id}, chip {chip_id}, {:.1} MHz (measured {:.1}), flash wait {flash_wait}, \
                 instruction cache {}, data cache {}",
                f64::from(silicon.core_hz) / 1e6,
                *measured_hz as f64 / 1e6,
                on(silicon.instruction_cache),
                on(silicon.data_cache),
            );
        }
        let unit = format!("thousand {}", self.unit);
        let _ = write!(text, "\n{unit:27}     total       ms    c/i");
        for stage in Stage::ALL {
            let _ = write!(text, " {:>11}", stage.name());
        }
        for (name, pair) in &self.pairs {
            let ratio =
                pair.cycles_per_instruction.map_or("-".to_owned(), |ratio| format!("{ratio:.2}"));
            let ms = f64::from(pair.time_us) / 1e3;
            let _ = write!(text, "\n{name:27} {:>9} {ms:>8.1} {ratio:>6}", pair.total / 1000);
            for stage in Stage::ALL {
                let cost = pair.by_stage.get(stage.name()).map_or(0, |cost| cost / 1000);
                let _ = write!(text, " {cost:>11}");
            }
        }
        text.push('\n');
        if let Some(PerInstruction { median, range: [low, high], assumed, instructions }) =
            &self.cycles_per_instruction
        {
            let [from, to] = assumed;
            let _ = writeln!(
                text,
                "\ncycles per instruction: median {median:.2}, {low:.2} to {high:.2}; assumed {from} to {to} (instructions of {instructions})"
            );
        }
        text
    }

    /// A file, which [`BoardNumbers::parse`] reads.
    pub fn file(&self) -> Result<String> {
        Ok(format!(
            "# Built-in pairs on a board, by `linestereo bench-board`.\n\n{}",
            toml::to_string(self)?
        ))
    }

    /// Of the text of a file.
    pub fn parse(text: &str) -> Result<Self> {
        Ok(toml::from_str(text)?)
    }
}

impl SiliconNumbers {
    fn new(silicon: &Silicon, reports: &[CaseReport]) -> Self {
        let cycles: u64 = reports.iter().map(|report| report.total).sum();
        let time_us: u64 = reports.iter().map(|report| u64::from(report.time_us)).sum();
        Self {
            processor_id: format!("{:#010x}", silicon.processor_id),
            chip_id: format!("{:#010x}", silicon.chip_id),
            core_hz: silicon.core_hz,
            measured_hz: cycles * 1_000_000 / time_us.max(1),
            flash_wait: silicon.flash_wait,
            instruction_cache: silicon.instruction_cache,
            data_cache: silicon.data_cache,
        }
    }
}

impl PairNumbers {
    fn new(report: &CaseReport, differs_in: Option<&str>, instructions: Option<u64>) -> Self {
        let total = report.costs.iter().sum();
        Self {
            total,
            time_us: report.time_us,
            segments: report.segments,
            differs_in: differs_in.map(str::to_owned),
            // Three places say more than any two runs have in common.
            cycles_per_instruction: instructions
                .map(|count| (1e3 * total as f64 / count as f64).round() / 1e3),
            by_stage: Stage::ALL
                .into_iter()
                .map(|stage| stage.name().to_owned())
                .zip(report.costs)
                .collect(),
            digests: report.digests.iter().map(|digest| format!("{digest:08x}")).collect(),
        }
    }
}

/// Cycles per instruction that the boards' pages assume: of llvm-mca for a Cortex-M7, a guess for
/// others.
fn assumed(board: &Board) -> [f64; 2] {
    if board.processor == "Cortex-M7" { [0.7, 1.1] } else { [1.0, 1.3] }
}

/// Instructions of each built-in pair on the emulated board that has this board's processor, and
/// the name of that board.
fn instructions(board: &Board) -> Result<Option<(&'static str, BTreeMap<String, u64>)>> {
    let Some(twin) = Board::emulated().find(|twin| twin.processor == board.processor) else {
        return Ok(None);
    };
    let mut boards: BTreeMap<String, BTreeMap<String, u64>> = toml::from_str(INSTRUCTIONS)?;
    Ok(boards.remove(twin.name).map(|counted| (twin.name, counted)))
}
