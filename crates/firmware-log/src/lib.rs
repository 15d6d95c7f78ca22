//! Log lines of a board: `defmt` frames in, text out.

use anyhow::{Context, Result};
use defmt_decoder::{DecodeError, Table};
use std::path::Path;

/// One line of a program's log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// The level in capitals, empty when the line has none.
    pub level: String,
    /// The text.
    pub text: String,
}

/// Decodes what a program wrote to its log, by the format strings in its ELF file. A program
/// without logs has none.
pub fn decode(elf: &Path, bytes: &[u8]) -> Result<Vec<Line>> {
    let elf = std::fs::read(elf).with_context(|| format!("cannot read {}", elf.display()))?;
    let Some(table) = Table::parse(&elf)? else { return Ok(Vec::new()) };
    let mut decoder = table.new_stream_decoder();
    decoder.received(bytes);
    let mut lines = Vec::new();
    loop {
        match decoder.decode() {
            Ok(frame) => lines.push(Line {
                level: frame
                    .level()
                    .map_or_else(String::new, |level| level.as_str().to_uppercase()),
                text: frame.display_message().to_string(),
            }),
            Err(DecodeError::UnexpectedEof) => return Ok(lines),
            // The next frame begins at the next delimiter, which the decoder finds by itself.
            Err(DecodeError::Malformed) if table.encoding().can_recover() => {}
            Err(DecodeError::Malformed) => return Ok(lines),
        }
    }
}
