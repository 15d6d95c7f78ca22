//! Flash and RAM of a program, read from its ELF file.

use anyhow::{Context, Result};
use linestereo_sim::board::Board;
use linestereo_sim::board::firmware::{self, Logs};
use linestereo_sim::board::toolchain::Toolchain;
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, elf};
use std::path::Path;

/// Bytes of a program.
#[derive(Default)]
pub(crate) struct Sizes {
    /// Code, constants and first values of variables.
    pub(crate) flash: u64,
    /// Variables.
    pub(crate) static_ram: u64,
    /// The memory set aside for stacks.
    pub(crate) stack: u64,
}

/// Builds a program without logs and reads its sizes.
pub(crate) fn of(board: &Board, program: &str) -> Result<Sizes> {
    let toolchain = Toolchain::for_board(board)?;
    read(&firmware::build(&toolchain, board, program, Logs::None)?)
}

/// Reads the sizes of an ELF file.
pub(crate) fn read(elf: &Path) -> Result<Sizes> {
    let elf = std::fs::read(elf)?;
    let file = object::File::parse(&*elf).context("the program is no ELF file")?;
    let mut sizes = Sizes::default();
    // By flags: every linker script chooses names of its own.
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags, .. } = section.flags() else { continue };
        if !sh_flags.contains(elf::SHF_ALLOC) {
            continue; // stays on the PC
        }
        let is_stored = section.kind() != SectionKind::UninitializedData;
        if is_stored {
            sizes.flash += section.size();
        }
        if !is_stored || sh_flags.contains(elf::SHF_WRITE) {
            sizes.static_ram += section.size();
        }
    }
    let address = |name: &str| {
        let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name));
        symbol
            .map(|symbol| symbol.address())
            .with_context(|| format!("the program has no symbol {name}"))
    };
    sizes.stack = address("_stack_start")? - address("_stack_end")?;
    Ok(sizes)
}
