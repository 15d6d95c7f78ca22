//! `cargo xtask footprint`: what the program `live` takes of every board, compared with
//! `xtask/board-sizes.toml`.
//!
//! In: every board's `live`, built without logs, as it is flashed. Out: a table of flash and RAM,
//! and whether each number is within 1 % of the committed one.

use crate::sizes;
use crate::stored::Stored;
use anyhow::Result;
use linestereo_sim::board::Board;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

const PROGRAM: &str = "live";

const STORED: Stored = Stored {
    file: "xtask/board-sizes.toml",
    bless: "cargo xtask footprint --bless",
    head: "\
# Flash and RAM of the program `live`, without logs, on every board. Written by `cargo xtask footprint --bless`, compared by `cargo xtask footprint`.
#
# flash: code, constants and first values, bytes. ram: variables, memory of DMA, and all that is set aside for stacks, bytes.

",
};

/// Of one board, bytes.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Footprint {
    flash: u64,
    ram: u64,
}

type Footprints = BTreeMap<String, Footprint>;

/// Builds for these boards, prints the table, and writes the file or compares with it.
pub(crate) fn run(top: &Path, boards: &[Board], bless: bool) -> Result<()> {
    let mut old: Footprints = STORED.read(top, bless)?;
    let mut new = Footprints::new();
    for board in boards {
        let found = sizes::of(board, PROGRAM)?;
        let footprint = Footprint { flash: found.flash, ram: found.static_ram + found.stack };
        new.insert(board.name.to_owned(), footprint);
    }
    if bless {
        for (board, Footprint { flash, ram }) in &new {
            println!("{board:14} flash {flash:>8} RAM {ram:>8}");
        }
        old.retain(|name, _| Board::named(name).is_some());
        old.append(&mut new);
        return STORED.write(top, &old);
    }
    old.retain(|name, _| new.contains_key(name));
    STORED.compare(&listed(&old), &listed(&new))
}

fn listed(footprints: &Footprints) -> BTreeMap<String, u64> {
    let of = |(board, size): (&String, &Footprint)| {
        [("flash", size.flash), ("RAM", size.ram)]
            .map(|(what, size)| (format!("{board} {what}"), size))
    };
    footprints.iter().flat_map(of).collect()
}
