//! A program as the boot ROM of a board takes it, so that flashing needs no probe.
//!
//! In: the ELF file of a program. Out: for an RP2350 a UF2 file, which is copied to the drive that
//! the board shows; for the others the plain bytes of the flash, which `dfu-util` writes at their
//! address.
//!
//! ```text
//! UF2 block   magic 0, magic 1, flags, address, bytes, number, count, family: 32 bits each, little
//!             endian; 476 bytes, of which 256 count; magic 2
//! ```
//!
//! # Source
//! UF2 specification (github.com/microsoft/uf2); RP2350 datasheet, 5.5.2 (UF2 family ids) and
//! RP2350-E10: of a file with one family alone the boot ROM may forget blocks, unless one of the
//! family "absolute" stands first. It is tagged to be ignored: on a flash of 4 MiB its address
//! would be the last page, where the rig is.

use anyhow::{Context, Result, bail};
use linestereo_boards::{Board, Device};
use object::Endianness;
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader as _, ProgramHeader as _};
use std::path::{Path, PathBuf};

const MAGIC: [u32; 3] = [0x0a32_4655, 0x9e5d_5157, 0x0ab1_6f30];
/// The last word of the head is a family.
const HAS_FAMILY: u32 = 0x2000;
/// Tags stand behind the bytes.
const HAS_TAGS: u32 = 0x8000;
/// RP2350, Arm, secure.
const RP2350_ARM_S: u32 = 0xe48b_ff59;
/// Family of any content, at absolute addresses.
const ABSOLUTE: u32 = 0xe48b_ff57;
/// The block is to be ignored.
const IGNORED: u32 = 0x9957_e304;
/// Bytes of a page, and of a block.
const PAGE: usize = 256;
const BLOCK: usize = 512;
/// More than any board's flash holds.
const MOST: u32 = 4 << 20;

/// Bytes of the flash from an address on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Image {
    start: u32,
    bytes: Vec<u8>,
}

impl Image {
    /// Contents of flash by an ELF file; gaps are as erased.
    fn of(elf: &[u8]) -> Result<Self> {
        let header = FileHeader32::<Endianness>::parse(elf)
            .context("the program is no ELF file of 32 bits")?;
        let endian = header.endian()?;
        let mut pieces = Vec::new();
        for segment in header.program_headers(endian, elf)? {
            let bytes =
                segment.data(endian, elf).ok().context("a segment lies outside of the ELF file")?;
            if segment.p_type(endian) == PT_LOAD && !bytes.is_empty() {
                pieces.push((segment.p_paddr(endian), bytes));
            }
        }
        let start =
            pieces.iter().map(|(at, _)| *at).min().context("the program has nothing in flash")?;
        let mut image = Vec::new();
        for (at, bytes) in pieces {
            if at - start > MOST {
                bail!("{at:#010x} and {start:#010x} lie in no flash together");
            }
            let at = (at - start) as usize;
            image.resize(image.len().max(at + bytes.len()), 0xff);
            image[at..at + bytes.len()].copy_from_slice(bytes);
        }
        Ok(Self { start, bytes: image })
    }

    /// As a UF2 file.
    fn uf2(&self) -> Vec<u8> {
        let mut ignored = [0xef; PAGE + 4];
        ignored[PAGE..].copy_from_slice(&IGNORED.to_le_bytes());
        let mut file = block(HAS_FAMILY | HAS_TAGS, 0x10ff_ff00, [0, 2], ABSOLUTE, &ignored);
        let pages = self.bytes.chunks(PAGE);
        let count = pages.len() as u32;
        for ((number, address), page) in (0..).zip((self.start..).step_by(PAGE)).zip(pages) {
            let mut whole = [0xff; PAGE];
            whole[..page.len()].copy_from_slice(page);
            file.extend(block(HAS_FAMILY, address, [number, count], RP2350_ARM_S, &whole));
        }
        file
    }
}

fn block(
    flags: u32,
    address: u32,
    [number, count]: [u32; 2],
    family: u32,
    content: &[u8],
) -> Vec<u8> {
    let head = [MAGIC[0], MAGIC[1], flags, address, PAGE as u32, number, count, family];
    let mut block: Vec<u8> = head.into_iter().flat_map(u32::to_le_bytes).collect();
    block.extend(content);
    block.resize(BLOCK - 4, 0);
    block.extend(MAGIC[2].to_le_bytes());
    block
}

/// Writes the file for a board's boot ROM beside its ELF file, and says how it is flashed.
pub(crate) fn write(board: &Board, elf: &Path) -> Result<(PathBuf, String)> {
    let image = Image::of(&std::fs::read(elf)?)?;
    let Device::Chip(chip) = board.device else { bail!("{} is no hardware", board.name) };
    if image.start % PAGE as u32 != 0 {
        bail!("the program starts at {:#010x}, in the middle of a page", image.start);
    }
    let is_rp = chip.starts_with("RP");
    let path = elf.with_extension(if is_rp { "uf2" } else { "bin" });
    std::fs::write(&path, if is_rp { image.uf2() } else { image.bytes })
        .with_context(|| format!("cannot write {}", path.display()))?;
    let how = if is_rp {
        "copy it to the drive RP2350, which the board shows when it is plugged in with BOOTSEL held"
            .to_owned()
    } else {
        format!("dfu-util -a 0 -s {:#010x}:leave -D {}", image.start, path.display())
    };
    Ok((path, how))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn word(block: &[u8], at: usize) -> u32 {
        u32::from_le_bytes(block[at..at + 4].try_into().unwrap())
    }

    /// Pages that a boot ROM would write, by the specification alone.
    fn decoded(file: &[u8], family: u32) -> Vec<(u32, Vec<u8>)> {
        assert!(file.len().is_multiple_of(512));
        let mut pages = Vec::new();
        for block in file.chunks(512) {
            assert_eq!(
                [word(block, 0), word(block, 4), word(block, 508)],
                [0x0a32_4655, 0x9e5d_5157, 0x0ab1_6f30]
            );
            let (flags, address, bytes) =
                (word(block, 8), word(block, 12), word(block, 16) as usize);
            let is_ignored = flags & 0x8000 != 0 && word(block, 32 + bytes) == 0x9957_e304;
            if flags & 0x2000 != 0 && word(block, 28) == family && !is_ignored {
                assert_eq!(word(block, 20) as usize, pages.len(), "numbered from 0");
                pages.push((address, block[32..32 + bytes].to_vec()));
            }
        }
        let count = file.chunks(512).last().map(|block| word(block, 24) as usize);
        assert_eq!(count, Some(pages.len()));
        pages
    }

    #[test]
    fn a_uf2_file_holds_the_image_page_by_page() {
        for length in [1_usize, 255, 256, 257, 70_001] {
            let image = Image {
                start: 0x1000_0000,
                bytes: (0..length).map(|at| ((at * 31) >> 3) as u8).collect(),
            };
            let pages = decoded(&image.uf2(), 0xe48b_ff59);
            assert_eq!(pages.len(), length.div_ceil(256));
            for ((address, _), at) in pages.iter().zip((0x1000_0000..).step_by(256)) {
                assert_eq!(*address, at);
            }
            let written = pages.iter().flat_map(|(_, page)| page.clone()).collect::<Vec<u8>>();
            assert_eq!(written[..length], image.bytes);
            assert!(written[length..].iter().all(|&byte| byte == 0xff));
        }
    }

    /// Not what is ignored by its tag: on 4 MiB of flash its address is the last page, which is the
    /// rig's.
    #[test]
    fn the_first_block_is_of_the_absolute_family_and_ignored() {
        let file = Image { start: 0x1000_0000, bytes: vec![1; 512] }.uf2();
        assert_eq!(
            [8, 12, 16, 20, 24, 28].map(|at| word(&file, at)),
            [0xa000, 0x10ff_ff00, 256, 0, 2, 0xe48b_ff57]
        );
        assert!(file[32..288].iter().all(|&byte| byte == 0xef));
        assert_eq!(word(&file, 288), 0x9957_e304);
    }
}
