//! Instructions by function, of a program in QEMU.
//!
//! QEMU logs each block of instructions when it translates it (`in_asm`), and each block that it
//! executes with the symbol that it lies in (`exec`). A block at the same address may be translated
//! again and be shorter, where one ended at an access to a device: the place of its translation
//! tells them apart.

use crate::bench;
use anyhow::{Context, Result, bail};
use linestereo::Dims;
use linestereo_boards::Exit;
use linestereo_sim::board::firmware::{self, Logs};
use linestereo_sim::board::toolchain::Toolchain;
use linestereo_sim::board::{self, Board, qemu};
use std::collections::HashMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

/// Captured pairs are cut to this size.
const DIMS: Dims = Dims { width: 320, height: 240 };

/// Prints the functions that took most: of `bench`, which matches the built-in pairs, or of
/// `replay`, which is fed with captured pairs.
pub(crate) fn run(boards: &[Board], frames: Option<&Path>, count: usize) -> Result<()> {
    for board in boards {
        let program = if frames.is_some() { "replay" } else { "bench" };
        let elf = firmware::build(&Toolchain::for_board(board)?, board, program, Logs::None)?;
        let folder = tempfile::tempdir()?;
        let arguments: &[&str] = match frames {
            None => &["table"],
            Some(frames) => {
                std::fs::write(folder.path().join("input"), input(frames)?)?;
                &["input", "output", "table"]
            }
        };
        let mut child = qemu::command(board, &elf, arguments, folder.path())?
            .args(["-serial", "none", "-d", "exec,nochain,in_asm", "-D", "/dev/stdout"])
            .stdout(Stdio::piped())
            .spawn()?;
        let mut counted = Counted::default();
        for line in BufReader::new(child.stdout.take().context("no pipe")?).split(b'\n') {
            counted.add(&String::from_utf8_lossy(&line?));
        }
        if child.wait()?.code() != Some(Exit::Success as i32) {
            bail!("{program} on {} failed", board.name); // it has said why
        }
        println!("{}, {program}:\n{}", board.name, counted.table(count));
    }
    Ok(())
}

/// The input of `replay`.
fn input(frames: &Path) -> Result<Vec<u8>> {
    let scenes = board::captured(frames, DIMS)?;
    if scenes.is_empty() {
        bail!("no scene of {DIMS} or more below {}", frames.display());
    }
    bench::input(&scenes)
}

/// A block as it was translated.
struct Block {
    symbol: String,
    /// Number of instructions.
    length: u64,
    /// Number of executions.
    times: u64,
}

/// Instructions of the blocks of a log, each times its executions.
#[derive(Default)]
struct Counted {
    /// Blocks by the places of their translations.
    blocks: HashMap<u64, Block>,
    /// Instructions by symbol, of blocks whose places others took.
    replaced: HashMap<String, u64>,
    /// Number of instructions of the block that was logged last, until it is executed.
    logged: u64,
}

impl Counted {
    /// Adds a line of the log.
    fn add(&mut self, line: &str) {
        if let Some(block) = line.strip_prefix("Trace ") {
            // Trace 0: 0x7fc684000100 [flags/address/...] symbol
            let place = block.split_once("0x").and_then(|(_, rest)| rest.split_once(' '));
            let place = place.and_then(|(place, _)| u64::from_str_radix(place, 16).ok());
            let (Some(place), Some((_, symbol))) = (place, block.rsplit_once("] ")) else { return };
            // A block is executed once it is translated.
            if self.logged > 0 {
                let length = core::mem::take(&mut self.logged);
                let block = Block { symbol: symbol.to_owned(), length, times: 0 };
                if let Some(before) = self.blocks.insert(place, block) {
                    *self.replaced.entry(before.symbol).or_default() +=
                        before.length * before.times;
                }
            }
            if let Some(block) = self.blocks.get_mut(&place) {
                block.times += 1;
            }
        } else if line.starts_with("0x") {
            self.logged += 1;
        } else if line.starts_with("IN:") {
            self.logged = 0;
        }
    }

    /// The `count` functions with most instructions.
    fn table(&self, count: usize) -> String {
        let replaced = self.replaced.iter().map(|(symbol, &own)| (&**symbol, own));
        let mut functions: HashMap<&str, u64> = replaced.collect();
        for Block { symbol, length, times } in self.blocks.values() {
            *functions.entry(symbol).or_default() += length * times;
        }
        let all: u64 = functions.values().sum();
        let mut functions: Vec<_> = functions.into_iter().collect();
        functions.sort_unstable_by_key(|&(symbol, own)| (u64::MAX - own, symbol));
        let line = |name: &str, own: u64| {
            format!("{own:>11} {:5.1} %  {name}\n", 100.0 * own as f64 / all.max(1) as f64)
        };
        let named = functions
            .iter()
            .take(count)
            .map(|&(symbol, own)| line(&format!("{:#}", rustc_demangle::demangle(symbol)), own));
        line("all", all) + &named.collect::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "\
----------------
IN: start
0x00000400:  f003 fe76  bl       #0x40f0

Trace 0: 0x7fc684000100 [00800408/00000400/00000110/ff020200] start
----------------
IN: _ZN4core3fmt5write17h0123456789abcdefE
0x000040f0:  b580       push     {r7, lr}
0x000040f2:  466f       mov      r7, sp
Trace 0: 0x7fc684000240 [00800408/000040f0/00000110/ff020200] _ZN4core3fmt5write17h0123456789abcdefE
Trace 0: 0x7fc684000240 [00800408/000040f0/00000110/ff020200] _ZN4core3fmt5write17h0123456789abcdefE
";

    fn table(log: &str, count: usize) -> Vec<String> {
        let mut counted = Counted::default();
        log.lines().for_each(|line| counted.add(line));
        counted.table(count).lines().map(|line| line.trim().to_owned()).collect()
    }

    #[test]
    fn blocks_count_by_their_length_and_how_often_they_ran() {
        let expected = ["5 100.0 %  all", "4  80.0 %  core::fmt::write", "1  20.0 %  start"];
        assert_eq!(table(LOG, 2), expected);
        assert_eq!(table(LOG, 1), expected[..2]);
    }

    #[test]
    fn a_block_that_is_translated_again_counts_by_both_lengths() {
        // Elsewhere, and then at the same place.
        let shorter = LOG.lines().filter(|line| !line.starts_with("0x000040f2"));
        let shorter: String = shorter.map(|line| format!("{line}\n")).collect();
        for again in [shorter.replace("7fc684000240", "7fc684000360"), shorter] {
            let expected = ["8 100.0 %  all", "6  75.0 %  core::fmt::write", "2  25.0 %  start"];
            assert_eq!(table(&format!("{LOG}{again}"), 2), expected);
        }
    }
}
