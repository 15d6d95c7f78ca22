//! A serial line and a clock.

use core::cell::RefCell;
use linestereo_firmware::ports::{ByteSink, ByteSource, Clock, Room};
use linestereo_wire::{
    Command, Decoder, FrameHead, MAX_COMMAND, MAX_PACKET, Message, Request, encode,
};
use std::collections::VecDeque;
use std::rc::Rc;

/// Both ends of a line, and a clock that its test turns. Clones are the same line.
#[derive(Clone, Default)]
pub(crate) struct Port(Rc<RefCell<State>>);

#[derive(Default)]
struct State {
    to_board: VecDeque<u8>,
    from_board: Vec<u8>,
    /// Bytes that the board gets at once; 0 for all.
    most: usize,
    now_us: u32,
    /// Passes with every look at the clock.
    look_us: u32,
    /// Bytes from the board that wait at most; 0 for any number.
    capacity: usize,
}

impl Port {
    /// A clock that every reading moves on by `look_us` microseconds.
    pub(crate) fn with_look(look_us: u32) -> Self {
        let port = Self::default();
        port.0.borrow_mut().look_us = look_us;
        port
    }

    /// A line whose other end fetches nothing by itself: so many bytes wait.
    pub(crate) fn with_capacity(capacity: usize) -> Self {
        let port = Self::with_look(1);
        port.0.borrow_mut().capacity = capacity;
        port
    }

    /// At most `most` of the bytes that wait.
    pub(crate) fn fetch(&self, most: usize) -> Vec<u8> {
        let from_board = &mut self.0.borrow_mut().from_board;
        let count = most.min(from_board.len());
        from_board.drain(..count).collect()
    }

    /// With bytes to the board, at most so many at once.
    pub(crate) fn holding(bytes: Vec<u8>, most: usize) -> Self {
        let port = Self::with_look(1);
        (port.0.borrow_mut().to_board, port.0.borrow_mut().most) = (bytes.into(), most);
        port
    }

    pub(crate) fn send(&self, id: u16, request: Request) {
        let mut buffer = [0; MAX_COMMAND];
        self.0.borrow_mut().to_board.extend(encode(&Command { id, request }, &mut buffer).unwrap());
    }

    /// Sends bytes to the board.
    pub(crate) fn give(&self, bytes: &[u8]) {
        self.0.borrow_mut().to_board.extend(bytes);
    }

    /// Bytes written by the board since the last call.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        core::mem::take(&mut self.0.borrow_mut().from_board)
    }

    /// The same as messages.
    pub(crate) fn received(&self) -> Vec<Message> {
        let mut decoder: Decoder<Message, MAX_PACKET> = Decoder::new();
        self.bytes()
            .into_iter()
            .filter_map(|byte| decoder.push(byte))
            .collect::<Result<_, _>>()
            .unwrap()
    }

    pub(crate) fn pass(&self, us: u32) {
        self.0.borrow_mut().now_us += us;
    }
}

/// The heads of the frames among these.
pub(crate) fn heads(messages: &[Message]) -> Vec<FrameHead> {
    let head =
        |message: &Message| if let Message::Frame(head) = message { Some(*head) } else { None };
    messages.iter().filter_map(head).collect()
}

/// Id and payload of each MAVLink frame.
pub(crate) fn mavlink_frames(mut bytes: &[u8]) -> Vec<(u32, Vec<u8>)> {
    let mut frames = Vec::new();
    while let [0xfd, length, _, _, _, 1, 196, id0, id1, id2, rest @ ..] = bytes {
        let (payload, after) = rest.split_at((*length).into());
        frames.push((u32::from_le_bytes([*id0, *id1, *id2, 0]), payload.to_vec()));
        bytes = &after[2..];
    }
    assert!(bytes.is_empty(), "{bytes:?}");
    frames
}

impl ByteSource for Port {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let State { to_board, most, .. } = &mut *self.0.borrow_mut();
        let most = if *most == 0 { usize::MAX } else { *most };
        let count = bytes.len().min(most).min(to_board.len());
        bytes.iter_mut().zip(to_board.drain(..count)).for_each(|(slot, byte)| *slot = byte);
        count
    }
}

impl ByteSink for Port {
    fn write(&mut self, bytes: &[u8]) {
        self.0.borrow_mut().from_board.extend_from_slice(bytes);
    }

    fn room(&self) -> Room {
        let state = self.0.borrow();
        let all = if state.capacity == 0 { usize::MAX } else { state.capacity };
        Room { free: all.saturating_sub(state.from_board.len()), all }
    }
}

impl Clock for Port {
    const UNIT: &'static str = "microseconds";

    fn now(&self) -> u32 {
        let mut state = self.0.borrow_mut();
        state.now_us = state.now_us.wrapping_add(state.look_us);
        state.now_us
    }

    fn elapsed(&self, from: u32, to: u32) -> u64 {
        to.wrapping_sub(from).into()
    }

    fn microseconds(&self, from: u32, to: u32) -> u64 {
        self.elapsed(from, to)
    }
}
