//! `cargo xtask footprint`: what the program `live` takes of every board, compared with
//! `xtask/board-sizes.toml`.
//!
//! In: every board's `live`, built without logs, as it is flashed. Out: a table of flash and RAM,
//! and whether each number is within 1 % of the committed one.

use crate::measure::TOLERANCE_PERCENT;
use crate::sizes;
use anyhow::{Context, Result, bail};
use linestereo_sim::board::Board;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

const FILE: &str = "xtask/board-sizes.toml";
const PROGRAM: &str = "live";

const HEAD: &str = "\
# Flash and RAM of the program `live`, without logs, on every board. Written by `cargo xtask footprint --bless`, compared by `cargo xtask footprint`.
#
# flash: code, constants and first values, bytes. ram: variables, memory of DMA, and all that is set aside for stacks, bytes.

";

/// Of one board, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Footprint {
    flash: u64,
    ram: u64,
}

type Footprints = BTreeMap<String, Footprint>;

/// Builds for these boards, prints the table, and writes the file or compares with it.
pub(crate) fn run(top: &Path, boards: &[Board], bless: bool) -> Result<()> {
    let path = top.join(FILE);
    let read = || std::fs::read_to_string(&path).with_context(|| format!("{FILE} cannot be read"));
    let old: Footprints = match read() {
        Ok(text) => toml::from_str(&text).with_context(|| format!("{FILE} cannot be read"))?,
        Err(_) if bless => Footprints::new(),
        Err(error) => return Err(error.context("write it: cargo xtask footprint --bless")),
    };
    let mut new = Footprints::new();
    println!("{:14} {:38} {:>8} {:>8}", "board", "processor", "flash", "RAM");
    for board in boards {
        let found = sizes::of(board, PROGRAM)?;
        let footprint = Footprint { flash: found.flash, ram: found.static_ram + found.stack };
        println!(
            "{:14} {:38} {:>8} {:>8}",
            board.name, board.processor, footprint.flash, footprint.ram
        );
        new.insert(board.name.to_owned(), footprint);
    }
    if bless {
        let all: Footprints =
            old.into_iter().filter(|(name, _)| Board::named(name).is_some()).chain(new).collect();
        std::fs::write(&path, format!("{HEAD}{}", toml::to_string(&all)?))?;
        println!("{FILE}: blessed; commit it");
        return Ok(());
    }
    let differences = differences(&old, &new);
    if differences.is_empty() {
        println!("all within {TOLERANCE_PERCENT} % of {FILE}");
        return Ok(());
    }
    bail!(
        "not as in {FILE}: {}; if it was meant: cargo xtask footprint --bless",
        differences.join(", ")
    )
}

/// Sizes that have changed by more than the tolerance, in words.
fn differences(old: &Footprints, new: &Footprints) -> Vec<String> {
    let mut list = Vec::new();
    for (name, now) in new {
        let Some(before) = old.get(name) else {
            list.push(format!("{name} is new"));
            continue;
        };
        for (what, before, now) in
            [("flash", before.flash, now.flash), ("RAM", before.ram, now.ram)]
        {
            if 100 * before.abs_diff(now) > TOLERANCE_PERCENT * before {
                list.push(format!("{name} {what} {now} instead of {before}"));
            }
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(flash: u64, ram: u64) -> Footprints {
        BTreeMap::from([("board".to_owned(), Footprint { flash, ram })])
    }

    #[test]
    fn one_percent_is_the_limit_both_ways_and_a_new_board_is_told() {
        assert!(differences(&of(10_000, 500), &of(10_100, 495)).is_empty());
        assert_eq!(differences(&of(10_000, 500), &of(10_101, 494)).len(), 2);
        assert_eq!(
            differences(&of(10_000, 500), &of(9_899, 500)),
            ["board flash 9899 instead of 10000"]
        );
        assert_eq!(differences(&Footprints::new(), &of(1, 1)), ["board is new"]);
    }
}
