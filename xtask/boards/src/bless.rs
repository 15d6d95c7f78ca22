//! `cargo xtask bless`: the digests that the boards are compared with, computed on this machine.

use anyhow::{Context, Result, bail};
use core::fmt::Write;
use linestereo_boards::Board;
use linestereo_boards::built_in::Case;
use linestereo_firmware::boards::{mps2_an386, mps2_an500};
use linestereo_firmware::memory::Memory;
use linestereo_firmware::programs::selftest;
use std::path::Path;

/// Writes `crates/boards/src/built_in/digests.rs`, or compares with it.
pub(crate) fn run(top: &Path, check: bool) -> Result<()> {
    let mut text = String::from(
        "//! Digests of the built-in frames, one per stage and one of what an autopilot gets. Generated \
         on a\n//! PC by `cargo xtask bless`.\n\n\
         use crate::Board;\nuse linestereo::unstable::Stage;\n\n\
         /// One digest per stage, and one of what an autopilot gets.\n\
         pub type Digests = [u32; Stage::ALL.len() + 1];\n",
    );
    text.push_str(OF);
    write(&mut text, "QVGA", &mps2_an500::BOARD, &mut *Box::new(mps2_an500::BoardMemory::CLEARED))?;
    write(
        &mut text,
        "QQVGA",
        &mps2_an386::BOARD,
        &mut *Box::new(mps2_an386::BoardMemory::CLEARED),
    )?;
    let path = top.join("crates/boards/src/built_in/digests.rs");
    let same = std::fs::read_to_string(&path).is_ok_and(|old| old == text);
    if check {
        if !same {
            bail!(
                "{} is not what this machine computes; if the output was meant to change: cargo \
                 xtask bless",
                path.display()
            );
        }
        println!("{}: every digest is what this build computes", path.display());
        return Ok(());
    }
    std::fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
    println!("{}: {}", path.display(), if same { "unchanged" } else { "blessed; commit it" });
    Ok(())
}

/// Boards with the same capacities have the same digests.
const OF: &str = "
/// Of the cases of a board, in their order: the same on every board of these capacities, whatever
/// its processor.
pub fn of(board: &Board) -> &'static [Digests] {
    if board.largest.width == 320 { &QVGA } else { &QQVGA }
}
";

fn write(text: &mut String, constant: &str, board: &Board, memory: &mut impl Memory) -> Result<()> {
    let cases: Vec<Case> = Case::all(board).collect();
    let (name, count) = (board.name, cases.len());
    writeln!(
        text,
        "\n/// Of {name} and every board with its capacities.\n#[rustfmt::skip]\npub const \
         {constant}: [Digests; {count}] = ["
    )?;
    for case in cases {
        let digests = selftest::digests(memory, &case)
            .with_context(|| format!("{case} does not run on {name}"))?;
        let digests: Vec<String> = digests
            .iter()
            .map(|digest| format!("0x{:04x}_{:04x}", digest >> 16, digest & 0xffff))
            .collect();
        let lines: Vec<String> = digests.chunks(7).map(|line| line.join(", ")).collect();
        writeln!(text, "    [{}], // {case}", lines.join(",\n     "))?;
    }
    writeln!(text, "];")?;
    Ok(())
}
