//! Programs for boards that no PC runs: what can be proved of them without silicon. `live` of every
//! one is built, and its ELF file held against the board's map of flash and RAM.

use core::ops::Range;
use linestereo_boards::Board;
use linestereo_sim::board::{tested, top};
use linestereo_tests::board::image;
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader as _, ProgramHeader as _};
use object::{
    Endianness, Object as _, ObjectSection as _, ObjectSymbol as _, SectionFlags, SectionKind,
};
use std::collections::BTreeMap;

/// A named part of the memory map.
type Regions = BTreeMap<String, Range<u64>>;

/// Numbers of a linker script: `0x20000000 + 24K`, `4096K - 8K`.
fn number(text: &str) -> u64 {
    let term = |text: &str| {
        let text = text.trim();
        let (digits, unit) = match text.strip_suffix('K') {
            Some(digits) => (digits, 1 << 10),
            None => text.strip_suffix('M').map_or((text, 1), |digits| (digits, 1 << 20)),
        };
        let parsed = digits
            .strip_prefix("0x")
            .map_or_else(|| digits.parse(), |hex| u64::from_str_radix(hex, 16));
        unit * parsed.unwrap_or_else(|_| panic!("{text} is no number of a map"))
    };
    if let Some((first, second)) = text.split_once('+') {
        return term(first) + term(second);
    }
    text.split_once('-').map_or_else(|| term(text), |(first, second)| term(first) - term(second))
}

/// The regions of a board's map.
fn regions(board: &Board) -> Regions {
    let path =
        top().unwrap().join(format!("firmware/src/boards/{}.x", board.name.replace('-', "_")));
    let text = std::fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let block = text
        .split("MEMORY")
        .nth(1)
        .and_then(|rest| rest.split('{').nth(1)?.split('}').next())
        .unwrap();
    let line = |line: &str| {
        let (name, rest) = line.split_once(':')?;
        let (origin, length) = rest.split_once(',')?;
        let [origin, length] = [origin, length].map(|part| number(part.split('=').nth(1).unwrap()));
        Some((name.trim().to_owned(), origin..origin + length))
    };
    block.lines().filter_map(line).collect()
}

/// `live` of a board as it is flashed.
fn live(board: &Board) -> Option<Vec<u8>> {
    image(board, "live").map(|elf| std::fs::read(elf).unwrap())
}

#[test]
fn what_is_flashed_and_what_lies_in_ram_is_where_the_map_says() {
    for board in tested().into_iter().filter(|board| !board.is_emulated()) {
        let Some(elf) = live(&board) else { return };
        let name = board.name;
        let regions = regions(&board);
        let [flash, ram, stack] = ["FLASH", "RAM", "STACK"].map(|region| regions[region].clone());
        let file = object::File::parse(&*elf).unwrap();
        let contains = |range: &Range<u64>, inner: &Range<u64>| {
            range.start <= inner.start && inner.end <= range.end
        };

        // Nothing is written to flash outside of the program's part: the rig's sectors are not in
        // it.
        let header = FileHeader32::<Endianness>::parse(&*elf).unwrap();
        let endian = header.endian().unwrap();
        let mut flashed = 0;
        for segment in header.program_headers(endian, &*elf).unwrap() {
            let (start, bytes) =
                (u64::from(segment.p_paddr(endian)), u64::from(segment.p_filesz(endian)));
            if segment.p_type(endian) == PT_LOAD && bytes > 0 {
                assert!(
                    contains(&flash, &(start..start + bytes)),
                    "{name}: {start:#x}, {bytes} bytes are not in {flash:x?}"
                );
                flashed += bytes;
            }
        }
        assert!(flashed > 100_000, "{name}: {flashed} bytes are no program");

        // Every section that takes memory lies in one region, and what only takes room takes no
        // flash.
        for section in file.sections().filter(|section| section.size() > 0) {
            let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
                panic!("{name} is no ELF file")
            };
            if !sh_flags.contains(object::elf::SHF_ALLOC) {
                continue;
            }
            let range = section.address()..section.address() + section.size();
            let home = regions.iter().find(|(_, region)| contains(region, &range));
            assert!(home.is_some(), "{name}: {:?} {range:x?} lies in no region", section.name());
        }
        let symbol = |wanted: &str| {
            let found =
                file.symbols().find(|symbol| symbol.name().is_ok_and(|name| name.contains(wanted)));
            found.map(|symbol| {
                (symbol.address()..symbol.address() + symbol.size(), symbol.section_index())
            })
        };
        let (workspace, section) =
            symbol("6boards6MEMORY").unwrap_or_else(|| panic!("{name} has no workspace"));
        assert!(
            contains(&ram, &workspace) && workspace.end - workspace.start > 250_000,
            "{name}: {workspace:x?}"
        );
        let kind = file.section_by_index(section.unwrap()).unwrap().kind();
        assert_eq!(kind, SectionKind::UninitializedData, "{name}: the workspace takes flash");

        // The processor starts with the stack of the map and with code of the flash.
        let vectors = file.section_by_name(".vector_table").unwrap();
        let word = |place: usize| {
            u64::from(u32::from_le_bytes(
                vectors.data().unwrap()[4 * place..][..4].try_into().unwrap(),
            ))
        };
        assert_eq!(word(0), stack.end, "{name}: the first stack");
        assert!(
            flash.contains(&(word(1) & !1)) && word(1) & 1 == 1,
            "{name}: reset goes to {:#x}",
            word(1)
        );
        assert!(
            vectors.address() >= flash.start && vectors.address().is_multiple_of(1 << 9),
            "{name}: vectors"
        );
        assert_eq!(
            symbol("_program_stack_start").unwrap().0.start % 8,
            0,
            "{name}: AAPCS, 6.2.1.2"
        );
    }
}

/// Limit of the part's class, bytes.
#[test]
fn the_h7_keeps_to_its_budget() {
    let board = Board::named("stm32h743").unwrap();
    let Some(elf) = live(&board) else { return };
    let file = object::File::parse(&*elf).unwrap();
    let (mut flash, mut ram) = (0, 0);
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags, .. } = section.flags() else { panic!("no ELF file") };
        if !sh_flags.contains(object::elf::SHF_ALLOC) {
            continue;
        }
        let is_stored = section.kind() != SectionKind::UninitializedData;
        let is_variable = sh_flags.contains(object::elf::SHF_WRITE);
        flash += if is_stored { section.size() } else { 0 };
        ram += if is_variable { section.size() } else { 0 };
    }
    let stack = &regions(&board)["STACK"];
    ram += stack.end - stack.start;
    assert!(flash <= 256 << 10, "flash {flash}");
    assert!(ram <= 512 << 10, "RAM {ram}");
}

#[test]
fn maps_are_read_as_the_linker_reads_them() {
    assert_eq!(
        [number("0x20000000 + 24K"), number(" 4096K - 8K "), number("1M"), number("7")],
        [0x2000_6000, 4088 << 10, 1 << 20, 7]
    );
    for board in Board::ALL {
        let regions = regions(&board);
        let mut last: Option<(&str, &Range<u64>)> = None;
        let mut by_address: Vec<_> =
            regions.iter().map(|(name, range)| (name.as_str(), range)).collect();
        by_address.sort_by_key(|(_, range)| range.start);
        for (name, range) in by_address {
            assert!(
                last.is_none_or(|(_, before)| before.end <= range.start),
                "{}: {name} and {last:?}",
                board.name
            );
            last = Some((name, range));
        }
        let [stack, ram] = ["STACK", "RAM"].map(|region| &regions[region]);
        assert!(stack.end <= ram.start, "{}: the stack lies below everything else", board.name);
    }
}
