//! What a host asked for so far, and the answers: the same for a serial port and for a file.

use crate::boards::Board;
use crate::memory::RunError;
use crate::watch::Watch;
use linestereo::{Counts, Dims, MIN_SIDE, Params};
use linestereo_wire::{Answer, Command, FrameHead, Health, Hello, Outcome, PairHead, Refusal, Request};

/// The state that commands change.
#[derive(Clone, Debug)]
pub struct Session {
    board: Board,
    /// Parameters of the method.
    pub params: Params,
    /// Limits of a pair's health, and the monitor.
    pub watch: Watch,
    /// Send results?
    pub running: bool,
    sequence: u32,
}

/// What a command leads to.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// An answer.
    Answer(Answer),
    /// A description, then the answer.
    Describe(Answer),
    /// Pixels of a pair follow; the answer when they were matched.
    Pair {
        /// The id of the command.
        command: u16,
        /// What they are.
        head: PairHead,
    },
}

impl Session {
    /// The state after a reset.
    #[must_use]
    pub const fn new(board: Board) -> Self {
        Self { board, params: Params::DEFAULT, watch: Watch::new(), running: false, sequence: 0 }
    }

    /// What the board is.
    #[must_use]
    pub fn hello(&self) -> Hello {
        let mut board = linestereo_wire::BoardName::new();
        let _ = board.push_str(self.board.name); // names are short
        let Dims { width, height } = self.board.largest;
        let segments = u16::try_from(self.board.segments).unwrap_or(u16::MAX);
        Hello { board, largest_width: width, largest_height: height, segments }
    }

    /// Takes a command. What is refused changes nothing.
    pub fn command(&mut self, command: &Command) -> Reply {
        let answer = |outcome| Answer { command: command.id, outcome };
        match &command.request {
            Request::Describe => return Reply::Describe(answer(Outcome::Accepted)),
            Request::Start => self.running = true,
            Request::Stop => self.running = false,
            // Checked for the largest pairs; a smaller one may still be too narrow for the disparities.
            Request::SetParams(update) => match update.plan(self.params, self.board.largest) {
                Ok((params, _)) => self.params = params,
                Err(refusal) => return Reply::Answer(answer(Outcome::Refused(refusal))),
            },
            Request::Pair(head) => return Reply::Pair { command: command.id, head: *head },
        }
        Reply::Answer(answer(Outcome::Accepted))
    }

    /// Can the board hold such a pair?
    pub fn check_size(&self, dims: Dims) -> Result<(), Refusal> {
        let side = |name: &str, value: u16, high: u16| {
            let fits = (MIN_SIDE..=high).contains(&value);
            if fits { Ok(()) } else { Err(out_of_range(name, value.into(), MIN_SIDE.into(), high.into())) }
        };
        side("width", dims.width, self.board.largest.width)?;
        side("height", dims.height, linestereo::MAX_HEIGHT)?;
        if self.board.fits(dims) {
            return Ok(());
        }
        let pixels = |dims: Dims| u32::from(dims.width) * u32::from(dims.height);
        let name = name("frame");
        Err(Refusal::MemoryTooSmall { name, needed: pixels(dims), given: pixels(self.board.largest) })
    }

    /// The number of the next pair: one more than the last one's.
    pub fn next_sequence(&mut self) -> u32 {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        sequence
    }
}

/// The head of a frame that could not be matched.
#[must_use]
pub fn failed_frame(sequence: u32, capture_time_us: u64, dims: Dims, health: Health) -> FrameHead {
    FrameHead::new(sequence, capture_time_us, dims, health, &Counts::default())
}

/// What the host is told of a pair that cannot be matched.
#[must_use]
pub fn refusal(error: RunError) -> Refusal {
    match error {
        RunError::Params(error) => error.into(),
        RunError::Size(dims) => out_of_range("width", dims.width.into(), MIN_SIDE.into(), linestereo::MAX_WIDTH.into()),
    }
}

fn out_of_range(text: &str, value: i64, low: i64, high: i64) -> Refusal {
    Refusal::OutOfRange { name: name(text), value, low, high }
}

fn name(text: &str) -> linestereo_wire::Name {
    let mut name = linestereo_wire::Name::new();
    let _ = name.push_str(text); // short names of this file
    name
}
