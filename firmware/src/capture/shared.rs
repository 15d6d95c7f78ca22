//! One stream of rows that serves both eyes.
//!
//! In: a [`Stream`] of rows of one camera interface. Out: two [`RowRing`]s for
//! [`Capture`](super::Capture).
//!
//! ```text
//! SideBySide   a row is a left row, then a right row: both eyes see every signal, and copy their
//!              half
//! InTurn       a frame is the left eye's, the next one the right eye's: when the left one is whole
//!              and has ended, the right camera is connected and triggered; signals go to the eye
//!              that is connected
//! ```
//! Side by side, a fault is both eyes', because it is: they are counted for each.
//!
//! **In turn the two images are a frame apart.** Both times go with the pair, so that the health
//! check refuses it ([`skew_us`](linestereo::health::HealthLimits::skew_us)) unless its limit is
//! wider, which is right only where nothing moves.
//!
//! # Cost
//! Side by side: up to 8 signals of which one eye is ahead of the other. In turn: up to 32 signals
//! that nobody has fetched.

use super::{RowRing, Signal};
use crate::memory::of;
use crate::ports::Cameras;
use core::cell::RefCell;
use heapless::Deque;
use linestereo_rig::CameraSide;

/// [`RowRing`] for rows of which parts are fetched.
pub trait Stream {
    /// Rows that the ring holds: a power of two.
    fn rows(&self) -> u32;

    /// Events of the interrupts since the last call, oldest first.
    fn next_signal(&mut self) -> Option<Signal>;

    /// Rows that are complete now: the hardware is writing row number `written`.
    fn written(&self) -> u32;

    /// Has a frame started that has not ended?
    fn is_in_frame(&self) -> bool;

    /// Copies bytes of a row from this one on out of the ring, whatever lies there by now.
    fn copy(&self, row: u32, from: usize, into: &mut [u8]);

    /// The clock of the signals, microseconds.
    fn now_us(&self) -> u64;

    /// Sleeps until there may be a signal, for at most some milliseconds.
    fn rest(&self) {}
}

/// Signals that an eye may be ahead of the other one.
const AHEAD: usize = 8;

/// A stream whose rows are a left row, then a right row.
#[derive(Debug)]
pub struct SideBySide<S>(RefCell<Both<S>>);

#[derive(Debug)]
struct Both<S> {
    stream: S,
    /// Signals that one eye has fetched and the other has not.
    ahead: Deque<Signal, AHEAD>,
    leader: CameraSide,
}

impl<S: Stream> SideBySide<S> {
    /// Both eyes of a stream.
    pub const fn new(stream: S) -> Self {
        Self(RefCell::new(Both { stream, ahead: Deque::new(), leader: CameraSide::Left }))
    }

    /// The left and the right ring. `row_bytes` of their [`Limits`](super::Limits) are those of the
    /// stream: both halves.
    pub fn eyes(&self, width: u16) -> [Half<'_, S>; 2] {
        CameraSide::BOTH.map(|eye| Half { both: &self.0, eye, width })
    }
}

/// One eye's half of the rows of a stream.
#[derive(Debug)]
pub struct Half<'a, S> {
    both: &'a RefCell<Both<S>>,
    eye: CameraSide,
    width: u16,
}

impl<S: Stream> RowRing for Half<'_, S> {
    fn rows(&self) -> u32 {
        self.both.borrow().stream.rows()
    }

    fn next_signal(&mut self) -> Option<Signal> {
        let mut both = self.both.borrow_mut();
        if self.eye != both.leader && !both.ahead.is_empty() {
            return both.ahead.pop_front();
        }
        if both.ahead.is_full() {
            return None; // after the other eye
        }
        let signal = both.stream.next_signal()?;
        let _ = both.ahead.push_back(signal); // there is room
        both.leader = self.eye;
        Some(signal)
    }

    fn written(&self) -> u32 {
        self.both.borrow().stream.written()
    }

    fn copy(&self, row: u32, into: &mut [u8]) {
        let from = if self.eye == CameraSide::Left { 0 } else { self.width.into() };
        self.both.borrow().stream.copy(row, from, into);
    }

    fn now_us(&self) -> u64 {
        self.both.borrow().stream.now_us()
    }

    fn rest(&self) {
        self.both.borrow().stream.rest();
    }
}

/// Connection of one of two cameras to the stream.
pub trait Switch {
    /// Connects this camera, and makes it take a frame. `false` when it cannot.
    fn shoot(&mut self, eye: CameraSide) -> bool;
}

/// Signals of an eye that nobody has fetched.
const WAITING: usize = 32;

/// A stream to which one of two cameras is connected at a time.
#[derive(Debug)]
pub struct InTurn<S, W>(RefCell<Connected<S, W>>);

#[derive(Debug)]
struct Connected<S, W> {
    stream: S,
    switch: W,
    eye: CameraSide,
    /// Rows of a frame, and those that have come of this one since its start; `None` before it.
    rows: u32,
    come: Option<u32>,
    /// Number of the row after the last one.
    end: u32,
    /// Signals of the left and the right eye.
    waiting: [Deque<Signal, WAITING>; 2],
}

impl<S: Stream, W: Switch> InTurn<S, W> {
    /// Frames of so many rows.
    pub const fn new(stream: S, switch: W, rows: u16) -> Self {
        Self(RefCell::new(Connected {
            stream,
            switch,
            eye: CameraSide::Left,
            rows: rows as u32,
            come: None,
            end: 0,
            waiting: [Deque::new(), Deque::new()],
        }))
    }

    /// The left and the right ring.
    pub fn eyes(&self) -> [Turn<'_, S, W>; 2] {
        CameraSide::BOTH.map(|eye| Turn { connected: &self.0, eye })
    }

    /// Cameras that are started as a pair and triggered here, one after the other.
    pub const fn cameras<C>(&self, cameras: C) -> CamerasInTurn<'_, C, S, W> {
        CamerasInTurn { cameras, connected: &self.0 }
    }
}

impl<S: Stream, W: Switch> Connected<S, W> {
    /// Connects a camera and triggers it. What came before is of the other one, and of no use any
    /// more if this is the left one.
    fn shoot(&mut self, eye: CameraSide) -> bool {
        while self.take() {}
        if eye == CameraSide::Left {
            self.waiting.iter_mut().for_each(Deque::clear);
        }
        (self.eye, self.come) = (eye, None);
        self.switch.shoot(eye)
    }

    /// Gives a signal of the stream to the eye that is connected.
    fn take(&mut self) -> bool {
        let Some(signal) = self.stream.next_signal() else { return false };
        match signal {
            Signal::FrameStart { row, .. } => (self.come, self.end) = (Some(0), row),
            Signal::Rows { end, .. } => {
                let rows = end.wrapping_sub(self.end);
                (self.come, self.end) = (self.come.map(|come| come.saturating_add(rows)), end);
            }
            Signal::Overrun { .. } | Signal::Lost => self.come = None,
        }
        let waiting = of(self.eye, &mut self.waiting);
        if waiting.push_back(signal).is_err() {
            waiting.clear();
            let _ = waiting.push_back(Signal::Lost); // there is room
            self.come = None;
        }
        true
    }

    fn next_signal(&mut self, eye: CameraSide) -> Option<Signal> {
        while self.waiting.iter().all(|waiting| !waiting.is_full()) && self.take() {}
        if self.eye == CameraSide::Left
            && self.come == Some(self.rows)
            && !self.stream.is_in_frame()
        {
            self.shoot(CameraSide::Right); // a switch that fails is a silent camera, and that is reported
        }
        of(eye, &mut self.waiting).pop_front()
    }
}

/// The frames of one of two cameras that are connected in turn.
#[derive(Debug)]
pub struct Turn<'a, S, W> {
    connected: &'a RefCell<Connected<S, W>>,
    eye: CameraSide,
}

impl<S: Stream, W: Switch> RowRing for Turn<'_, S, W> {
    fn rows(&self) -> u32 {
        self.connected.borrow().stream.rows()
    }

    fn next_signal(&mut self) -> Option<Signal> {
        self.connected.borrow_mut().next_signal(self.eye)
    }

    fn written(&self) -> u32 {
        self.connected.borrow().stream.written()
    }

    fn copy(&self, row: u32, into: &mut [u8]) {
        self.connected.borrow().stream.copy(row, 0, into);
    }

    fn now_us(&self) -> u64 {
        self.connected.borrow().stream.now_us()
    }

    fn rest(&self) {
        self.connected.borrow().stream.rest();
    }
}

/// Two cameras that are connected in turn, triggered by the switch.
#[derive(Debug)]
pub struct CamerasInTurn<'a, C, S, W> {
    cameras: C,
    connected: &'a RefCell<Connected<S, W>>,
}

impl<C: Cameras, S: Stream, W: Switch> Cameras for CamerasInTurn<'_, C, S, W> {
    fn shoot(&mut self) -> bool {
        self.cameras.shoot() && self.connected.borrow_mut().shoot(CameraSide::Left)
    }

    fn let_go(&mut self) {
        self.cameras.let_go();
    }

    fn follow(&mut self) -> Option<[i32; 2]> {
        self.cameras.follow()
    }

    fn stopped(&mut self) {
        self.cameras.stopped();
    }

    fn failures(&self) -> [u32; 2] {
        self.cameras.failures()
    }
}
