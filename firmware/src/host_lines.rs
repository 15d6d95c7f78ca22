//! Two lines to the host that carry the same records, for example USB and a UART: commands come on either, records go to both.
//!
//! ```text
//! nobody listens       records are dropped
//! perhaps              what fits is sent, the rest is dropped: a line that cannot tell, on which nobody has spoken yet
//! somebody             waits for room, but not for ever: after that the line is dropped until it has room by itself
//! ```
//! A record is sent whole or not at all: half of one would cost the next one as well.

use crate::ports::{ByteSink, ByteSource};

/// Is there anybody at the other end of a line?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listener {
    /// Certainly not.
    Nobody,
    /// The line cannot tell.
    Perhaps,
    /// Yes.
    Somebody,
}

/// A line whose bytes are sent by interrupts, out of a buffer.
pub trait Line {
    /// Is there anybody?
    fn listener(&self) -> Listener;

    /// Bytes that it takes at once.
    fn room(&self) -> usize;

    /// Takes these bytes; there is room for them.
    fn put(&mut self, bytes: &[u8]);

    /// Puts bytes that have come at the start of `bytes` and says how many.
    fn read(&mut self, bytes: &mut [u8]) -> usize;
}

/// Two lines as one port of a program.
#[derive(Debug)]
pub struct HostLines<A, B, N> {
    first: Way<A>,
    second: Way<B>,
    now_us: N,
    patience_us: u64,
}

#[derive(Debug)]
struct Way<L> {
    line: L,
    /// Nobody fetched anything for as long as anybody waits.
    is_stuck: bool,
}

impl<A: Line, B: Line, N: Fn() -> u64> HostLines<A, B, N> {
    /// Lines, a clock, and how long a record waits for room, microseconds.
    pub const fn new(first: A, second: B, now_us: N, patience_us: u64) -> Self {
        let first = Way { line: first, is_stuck: false };
        let second = Way { line: second, is_stuck: false };
        Self { first, second, now_us, patience_us }
    }
}

impl<L: Line> Way<L> {
    fn write(&mut self, bytes: &[u8], now_us: &impl Fn() -> u64, patience_us: u64) {
        let has_room = |line: &L| line.room() >= bytes.len();
        let until_us = match self.line.listener() {
            Listener::Nobody => return self.is_stuck = false,
            Listener::Somebody if !self.is_stuck => now_us().saturating_add(patience_us),
            _ => 0,
        };
        while !has_room(&self.line) {
            if now_us() >= until_us {
                self.is_stuck = true;
                return;
            }
        }
        self.is_stuck = false;
        self.line.put(bytes);
    }
}

impl<A: Line, B: Line, N> ByteSource for HostLines<A, B, N> {
    /// Bytes of one line, so that two commands do not mix as long as the two hosts do not speak at once.
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        match self.first.line.read(bytes) {
            0 => self.second.line.read(bytes),
            count => count,
        }
    }
}

impl<A: Line, B: Line, N: Fn() -> u64> ByteSink for HostLines<A, B, N> {
    fn write(&mut self, bytes: &[u8]) {
        self.first.write(bytes, &self.now_us, self.patience_us);
        self.second.write(bytes, &self.now_us, self.patience_us);
    }
}
