//! A line to the host, or two that carry the same records, for example USB and a UART: commands
//! come on either, records go to both.
//!
//! ```text
//! nobody listens       records are dropped
//! perhaps              what fits is sent, the rest is dropped: a line that does not know, on which
//!                      no command has come yet
//! somebody             waits for room, but not for ever: after that the line is dropped until it
//!                      has room by itself
//! ```
//! A record is sent whole or not at all: half of one would cost the next one as well.

use crate::ports::{ByteSink, ByteSource, Room};

/// Is there anybody at the other end of a line?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listener {
    /// Certainly not.
    Nobody,
    /// The line does not know.
    Perhaps,
    /// Yes.
    Somebody,
}

/// A line whose bytes are sent by interrupts, out of a buffer.
pub trait Line {
    /// Is there anybody?
    fn listener(&self) -> Listener;

    /// Bytes that it takes at once, of those of its buffer.
    fn room(&self) -> Room;

    /// Takes these bytes; there is room for them.
    fn put(&mut self, bytes: &[u8]);

    /// Puts bytes that have come at the start of `bytes` and says how many.
    fn read(&mut self, bytes: &mut [u8]) -> usize;

    /// A command has come.
    fn heard(&mut self) {}
}

/// A line as the port of a program.
#[derive(Debug)]
pub struct HostLine<L, N> {
    line: L,
    now_us: N,
    patience_us: u64,
    /// Nobody fetched anything for as long as anybody waits.
    is_stuck: bool,
}

impl<L: Line, N: Fn() -> u64> HostLine<L, N> {
    /// A line, a clock, and how long a record waits for room, microseconds.
    pub const fn new(line: L, now_us: N, patience_us: u64) -> Self {
        Self { line, now_us, patience_us, is_stuck: false }
    }

    /// Waits for so many bytes of room, as long as somebody listens.
    fn has_room(&mut self, bytes: usize) -> bool {
        let is_waited_for = !self.is_stuck && self.line.listener() == Listener::Somebody;
        let until_us =
            if is_waited_for { (self.now_us)().saturating_add(self.patience_us) } else { 0 };
        while self.line.room().free < bytes {
            if self.line.listener() == Listener::Nobody || (self.now_us)() >= until_us {
                return false;
            }
        }
        true
    }
}

impl<L: Line, N> ByteSource for HostLine<L, N> {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        self.line.read(bytes)
    }

    fn heard(&mut self) {
        self.line.heard();
    }
}

impl<L: Line, N: Fn() -> u64> ByteSink for HostLine<L, N> {
    fn write(&mut self, bytes: &[u8]) {
        if self.line.listener() == Listener::Nobody {
            self.is_stuck = false;
            return;
        }
        self.is_stuck = !self.has_room(bytes.len());
        if !self.is_stuck {
            self.line.put(bytes);
        }
    }

    fn room(&self) -> Room {
        self.line.room()
    }
}

/// Two lines as one port of a program.
#[derive(Debug)]
pub struct HostLines<A, B, N> {
    first: HostLine<A, N>,
    second: HostLine<B, N>,
    /// The last bytes came on the second.
    is_second: bool,
}

impl<A, B, N> HostLines<A, B, N> {
    /// Both lines.
    pub const fn new(first: HostLine<A, N>, second: HostLine<B, N>) -> Self {
        Self { first, second, is_second: false }
    }
}

impl<A: Line, B: Line, N> ByteSource for HostLines<A, B, N> {
    /// Bytes of one line, so that two commands do not mix as long as the two hosts do not send at
    /// once.
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let count = self.first.read(bytes);
        self.is_second = count == 0;
        if self.is_second { self.second.read(bytes) } else { count }
    }

    fn heard(&mut self) {
        if self.is_second { self.second.heard() } else { self.first.heard() }
    }
}

impl<A: Line, B: Line, N: Fn() -> u64> ByteSink for HostLines<A, B, N> {
    fn write(&mut self, bytes: &[u8]) {
        self.first.write(bytes);
        self.second.write(bytes);
    }

    /// Of the lines on which somebody listens, else of those that do not know, the one with less.
    fn room(&self) -> Room {
        let lines = [
            (self.first.line.listener(), self.first.room()),
            (self.second.line.listener(), self.second.room()),
        ];
        let of = |wanted: Listener| {
            lines.iter().filter(move |(listener, _)| *listener == wanted).map(|(_, room)| *room)
        };
        let least = |rooms: &mut dyn Iterator<Item = Room>| rooms.min_by_key(|room| room.free);
        least(&mut of(Listener::Somebody))
            .or_else(|| least(&mut of(Listener::Perhaps)))
            .unwrap_or(Room { free: usize::MAX, all: usize::MAX })
    }
}
