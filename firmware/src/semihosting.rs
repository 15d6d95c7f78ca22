//! Arm's semihosting ("Semihosting for AArch32 and AArch64", 2.0), which RISC-V has too: files,
//! command line and exit code of the PC that runs QEMU or a probe.

use crate::arch::semihosting_call as call;
use crate::ports::{ByteSink, ByteSource};
use core::fmt;

/// Operation numbers.
mod operation {
    pub(super) const OPEN: u32 = 0x01;
    pub(super) const CLOSE: u32 = 0x02;
    pub(super) const WRITE0: u32 = 0x04;
    pub(super) const WRITE: u32 = 0x05;
    pub(super) const READ: u32 = 0x06;
    pub(super) const SEEK: u32 = 0x0a;
    pub(super) const FLEN: u32 = 0x0c;
    pub(super) const GET_CMDLINE: u32 = 0x15;
    pub(super) const EXIT_EXTENDED: u32 = 0x20;
}

/// How the PC is to open a file.
#[derive(Clone, Copy, Debug)]
#[repr(u32)]
pub enum Mode {
    /// An existing file, from its start.
    Read = 1,
    /// An existing file, to read and to change.
    Change = 3,
    /// A new file, in place of an old one.
    Write = 5,
}

/// The file cannot be opened.
#[derive(Clone, Copy, Debug)]
pub struct CannotOpen;

/// Longest name of a file, and longest command line.
const LONGEST: usize = 256;

/// A file of the PC.
#[derive(Debug)]
pub struct File(u32);

impl File {
    /// Opens a file by its name, relative to the folder that the PC's side runs in.
    pub fn open(name: &[u8], mode: Mode) -> Result<Self, CannotOpen> {
        let mut text = [0_u8; LONGEST];
        text.get_mut(..name.len())
            .filter(|text| text.len() < LONGEST)
            .ok_or(CannotOpen)?
            .copy_from_slice(name);
        let block = [text.as_ptr().expose_provenance() as u32, mode as u32, name.len() as u32];
        // SAFETY: a name that ends in 0, the mode, the length of the name; all alive until the
        // answer.
        let handle = unsafe { call(operation::OPEN, block.as_ptr()) };
        if handle == u32::MAX { Err(CannotOpen) } else { Ok(Self(handle)) }
    }

    /// Goes to an offset, bytes from the start; not beyond the end.
    pub fn seek(&mut self, offset: u32) -> bool {
        let block = [self.0, offset];
        // SAFETY: handle and offset.
        unsafe { call(operation::SEEK, block.as_ptr()) == 0 }
    }

    /// Bytes in it; 0 when the PC does not know.
    pub fn length(&self) -> u32 {
        // SAFETY: a handle of an open file.
        let length = unsafe { call(operation::FLEN, [self.0].as_ptr()) };
        if length == u32::MAX { 0 } else { length }
    }
}

impl ByteSource for File {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let block = [self.0, bytes.as_mut_ptr().expose_provenance() as u32, bytes.len() as u32];
        // SAFETY: handle, memory, length; the memory is borrowed until the answer. The answer is
        // what was not read.
        let missing = unsafe { call(operation::READ, block.as_ptr()) };
        bytes.len().saturating_sub(missing as usize)
    }
}

/// Bytes that the PC cannot write (a full disk) are lost.
impl ByteSink for File {
    fn write(&mut self, bytes: &[u8]) {
        let block = [self.0, bytes.as_ptr().expose_provenance() as u32, bytes.len() as u32];
        // SAFETY: handle, memory, length; the memory is borrowed until the answer.
        unsafe { call(operation::WRITE, block.as_ptr()) };
    }
}

impl fmt::Write for File {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.write(text.as_bytes());
        Ok(())
    }
}

impl Drop for File {
    fn drop(&mut self) {
        // SAFETY: a handle of an open file.
        unsafe { call(operation::CLOSE, [self.0].as_ptr()) };
    }
}

/// The words after the program's name on the command line.
#[derive(Debug)]
pub struct Arguments {
    text: [u8; LONGEST],
    length: usize,
}

impl Arguments {
    /// The PC's command line; no words when it has none or more than fit.
    pub fn read() -> Self {
        let mut text = [0_u8; LONGEST];
        let mut block = [text.as_mut_ptr().expose_provenance() as u32, text.len() as u32];
        // SAFETY: memory and its length; the PC writes the text there and its length into the
        // block.
        let failed = unsafe { call(operation::GET_CMDLINE, block.as_mut_ptr()) } != 0;
        Self { text, length: if failed { 0 } else { block[1] as usize } }
    }

    /// Word number `n`, counted from 0.
    pub fn get(&self, n: usize) -> Option<&[u8]> {
        let text = self.text.get(..self.length).unwrap_or(&[]);
        let words = text.split(|&byte| byte == b' ' || byte == 0).filter(|word| !word.is_empty());
        words.skip(1).nth(n)
    }

    /// The file that word number `n` names; `None` when it cannot be opened.
    pub fn open(&self, n: usize, mode: Mode) -> Option<File> {
        File::open(self.get(n)?, mode).ok()
    }
}

/// Writes text to the PC's error output.
pub fn report(text: &str) {
    report_bytes(text.as_bytes());
}

fn report_bytes(text: &[u8]) {
    let mut buffer = [0_u8; 64];
    for chunk in text.chunks(buffer.len() - 1) {
        buffer.fill(0);
        for (slot, &byte) in buffer.iter_mut().zip(chunk) {
            *slot = byte;
        }
        // SAFETY: text that ends in 0; `chunks` leaves at least one byte of the buffer.
        unsafe { call(operation::WRITE0, buffer.as_ptr().cast()) };
    }
}

/// Writes a number in hexadecimal to the PC's error output: without the formatting machinery, which
/// needs stack and flash.
pub fn report_hex(number: u32) {
    let mut digits = [0_u8; 8];
    for (slot, shift) in digits.iter_mut().zip((0..8).rev()) {
        let digit = (number >> (4 * shift) & 15) as u8;
        *slot = if digit < 10 { b'0' + digit } else { b'a' + digit - 10 };
    }
    report_bytes(&digits);
}

/// The same in decimal.
pub fn report_decimal(number: u32) {
    let mut digits = [b'0'; 10];
    let mut rest = number;
    let mut first = digits.len() - 1;
    for (index, slot) in digits.iter_mut().enumerate().rev() {
        *slot += (rest % 10) as u8;
        if rest > 0 {
            first = index;
        }
        rest /= 10;
    }
    report_bytes(digits.get(first..).unwrap_or(&[]));
}

/// Ends the program with this exit code.
pub fn exit(code: u32) -> ! {
    /// `ADP_Stopped_ApplicationExit`: the second word is an exit code.
    const APPLICATION_EXIT: u32 = 0x2_0026;
    loop {
        // SAFETY: reason and exit code. Should the PC let the program go on, it asks again.
        unsafe { call(operation::EXIT_EXTENDED, [APPLICATION_EXIT, code].as_ptr()) };
    }
}
