//! Kernels for cores of 32 bits without vectors or packed instructions, such as RV32IMAC and
//! Cortex-M3: two to four values in an ordinary register, kept apart by bits that are never used.
//!
//! In and out as the [`portable`](super::portable) versions, the same bits for every input.
//!
//! ```text
//! rows    gradient
//! curves  sums of strips and points over disparity
//! codes   codes of texture
//! support costs of windows of codes, paths
//! ```
//!
//! # Cost
//! In the modules, as instructions of RV32IMAC under QEMU, with the portable version's behind them.
//! Half words of bytes are seldom faster than good code for one byte; with the seven bits of
//! gradients, four bytes are.
//!
//! # Source
//! H. Warren, Hacker's Delight, 2nd ed., 2-18 and 5-1.

mod codes;
mod curves;
mod rows;
mod support;

pub use codes::code_columns;
pub use curves::{hamming_curve, sad_curve};
pub use rows::gradient_row;
pub use support::{
    code_costs, code_costs_in, lowest_byte, path_step, spread_bytes, spread_codes, sum_paths,
};

/// A byte in each half word.
const HALVES: u32 = 0x00ff_00ff;

/// The highest bit of each byte.
const HIGH: u32 = four(0x80);

/// Four bytes alike.
const fn four(byte: u8) -> u32 {
    0x0101_0101 * byte as u32
}

/// Product of a word and of `factor` / 2^32: one instruction, where a mask of the bits below some
/// bits takes two otherwise.
#[inline(always)]
fn scaled(word: u32, factor: u32) -> u32 {
    ((u64::from(word) * u64::from(factor)) >> 32) as u32
}

/// The whole words among bytes, and the bytes before and behind them.
#[inline(always)]
fn whole_words(bytes: &[u8]) -> (&[u8], &[u32], &[u8]) {
    // SAFETY: any four bytes are a word.
    unsafe { bytes.align_to() }
}

/// The same of bytes that are written.
#[inline(always)]
fn whole_words_mut(bytes: &mut [u8]) -> (&mut [u8], &mut [u32], &mut [u8]) {
    // SAFETY: any four bytes are a word, and any word four bytes.
    unsafe { bytes.align_to_mut() }
}

/// The same bytes as words from the first one on, filled up with zeros; as many as there are both
/// of.
#[inline(always)]
fn copy_words(bytes: &[u8], out: &mut [u32]) {
    let (head, words, tail) = whole_words(bytes);
    let shift = 8 * (head.len() as u32 & 3);
    let mut carry = word_of_few(head);
    let mut rest = out.iter_mut();
    for (&word, out) in words.iter().zip(&mut rest) {
        let word = u32::from_le(word);
        *out = carry | word << shift;
        carry = word >> 1 >> (31 - shift);
    }
    // Up to six bytes.
    let tail = word_of_few(tail);
    for (out, last) in rest.zip([carry | tail << shift, tail >> 1 >> (31 - shift)]) {
        *out = last;
    }
}

/// Up to four bytes, the first one lowest.
#[inline(always)]
fn word_of_few(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte))
}
