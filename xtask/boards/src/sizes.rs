//! Flash and RAM of a program, read from its ELF file.

use anyhow::{Context, Result};
use linestereo_sim::board::Board;
use linestereo_sim::board::firmware::{self, Logs};
use linestereo_sim::board::toolchain::Toolchain;
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, elf};
use std::path::Path;

/// Bytes of a program.
pub(crate) struct Sizes {
    /// Code.
    pub(crate) text: u64,
    /// Constants and the vector table.
    pub(crate) rodata: u64,
    /// Variables that begin with a value: in flash and in RAM.
    pub(crate) data: u64,
    /// Variables that begin as zero.
    pub(crate) bss: u64,
    /// The memory set aside for stacks.
    pub(crate) stack: u64,
}

impl Sizes {
    /// Bytes in flash.
    pub(crate) fn flash(&self) -> u64 {
        self.text + self.rodata + self.data
    }

    /// Bytes of variables in RAM.
    pub(crate) fn static_ram(&self) -> u64 {
        self.data + self.bss
    }
}

/// Builds a program without logs and reads its sizes.
pub(crate) fn of(board: &Board, program: &str) -> Result<Sizes> {
    let toolchain = Toolchain::for_board(board)?;
    read(&firmware::build(&toolchain, board, program, Logs::None)?)
}

/// Size of a section.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Code,
    Constants,
    /// In flash and in RAM.
    Data,
    Ram,
}

impl Place {
    /// By its flags, not its name, which every linker script chooses; `None` for what stays on the
    /// PC.
    fn of<'data>(section: &impl ObjectSection<'data>) -> Option<Self> {
        let SectionFlags::Elf { sh_flags, .. } = section.flags() else { return None };
        match section.kind() {
            _ if !sh_flags.contains(elf::SHF_ALLOC) => None,
            SectionKind::UninitializedData => Some(Self::Ram),
            _ if sh_flags.contains(elf::SHF_WRITE) => Some(Self::Data),
            _ if sh_flags.contains(elf::SHF_EXECINSTR) => Some(Self::Code),
            _ => Some(Self::Constants),
        }
    }
}

/// Reads the sizes of an ELF file.
pub(crate) fn read(elf: &Path) -> Result<Sizes> {
    let elf = std::fs::read(elf)?;
    let file = object::File::parse(&*elf).context("the program is no ELF file")?;
    let mut sizes = Sizes { text: 0, rodata: 0, data: 0, bss: 0, stack: 0 };
    for section in file.sections() {
        let counter = match Place::of(&section) {
            Some(Place::Code) => &mut sizes.text,
            Some(Place::Constants) => &mut sizes.rodata,
            Some(Place::Data) => &mut sizes.data,
            Some(Place::Ram) => &mut sizes.bss,
            None => continue,
        };
        *counter += section.size();
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
