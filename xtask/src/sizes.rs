//! Flash and RAM of a program, read from its ELF file.

use anyhow::{Context, Result};
use linestereo_sim::board::Board;
use linestereo_sim::board::firmware::{self, Logs};
use linestereo_sim::board::toolchain::Toolchain;
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, SymbolKind, elf};
use std::path::Path;

/// The program that is measured where none is named.
pub(crate) const PROGRAM: &str = "replay";
/// Symbols listed.
const LARGEST: usize = 12;

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
    /// Name and size of everything in flash and in RAM, largest first.
    pub(crate) in_flash: Vec<(String, u64)>,
    pub(crate) in_ram: Vec<(String, u64)>,
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
    /// By its flags, not its name, which every linker script chooses; `None` for what stays on the PC.
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
    let mut sizes = Sizes { text: 0, rodata: 0, data: 0, bss: 0, stack: 0, in_flash: Vec::new(), in_ram: Vec::new() };
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
        symbol.map(|symbol| symbol.address()).with_context(|| format!("the program has no symbol {name}"))
    };
    sizes.stack = address("_stack_start")? - address("_stack_end")?;
    for symbol in file.symbols().filter(|symbol| symbol.size() > 0) {
        let name = format!("{:#}", rustc_demangle::demangle(symbol.name().unwrap_or("?")));
        let section = symbol.section_index().map(|index| file.section_by_index(index)).transpose()?;
        let in_flash = matches!(section.as_ref().and_then(Place::of), Some(Place::Code | Place::Constants));
        let place = if in_flash { &mut sizes.in_flash } else { &mut sizes.in_ram };
        if matches!(symbol.kind(), SymbolKind::Text | SymbolKind::Data) {
            place.push((name, symbol.size()));
        }
    }
    for list in [&mut sizes.in_flash, &mut sizes.in_ram] {
        list.sort_by(|a, b| (b.1, &a.0).cmp(&(a.1, &b.0)));
        list.dedup();
    }
    Ok(sizes)
}

/// Prints the sizes.
pub(crate) fn run(boards: &[Board], program: &str) -> Result<()> {
    for board in boards {
        let sizes = of(board, program)?;
        println!("{program} on {}, without logs, bytes", board.name);
        println!("  flash {}: text {}, rodata {}, data {}", sizes.flash(), sizes.text, sizes.rodata, sizes.data);
        println!(
            "  RAM {}: data {}, bss {}, stacks {}",
            sizes.static_ram() + sizes.stack,
            sizes.data,
            sizes.bss,
            sizes.stack
        );
        for (title, list) in [("largest in flash", &sizes.in_flash), ("largest in RAM", &sizes.in_ram)] {
            println!("  {title}");
            for (name, size) in list.iter().take(LARGEST) {
                println!("  {size:8} {name}");
            }
        }
    }
    Ok(())
}
