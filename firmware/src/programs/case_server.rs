//! Built-in pairs at the request of a host: the digests of each, and what its stages cost.
//!
//! ```text
//! Describe    Hello, Machine, answer
//! RunCase(n)  painted; matched once for its digests, which leaves code and tables in the caches;
//!             matched again against the counter; Case, answer
//! others      refused
//! ```
//! A host asks for one pair after the other: what was lost on the way it asks for again, and a
//! watchdog is fed in between.

use super::{bench, selftest};
use crate::memory::Memory;
use crate::ports::{BarePeripherals, ByteSink, ByteSource, Clock, packets};
use crate::session::{Session, out_of_range};
use linestereo::{Matcher, Options, unstable::Fnv};
use linestereo_boards::Board;
use linestereo_boards::built_in::Case;
use linestereo_boards::built_in::digests::Digests;
use linestereo_wire::{
    Answer, CaseReport, Command, DELIMITER, Decoder, MAX_COMMAND, MachineReport, Message, Refusal,
    Request, Reset, Silicon, send,
};

/// A board without cameras that serves a host.
#[derive(Debug)]
pub struct CaseServer<C, T, P> {
    board: Board,
    expected: &'static [Digests],
    counter: C,
    clock: T,
    port: P,
    reset: Option<Reset>,
    silicon: Option<Silicon>,
    decoder: Decoder<Command, MAX_COMMAND>,
}

impl<C: Clock, T: Clock, P: ByteSource + ByteSink> CaseServer<C, T, P> {
    /// Starts with a [`Message::Hello`].
    pub fn start<W>(
        board: Board,
        expected: &'static [Digests],
        parts: BarePeripherals<C, T, P, W>,
    ) -> (Self, W) {
        let BarePeripherals { counter, clock, host: port, watchdog, reset, silicon, .. } = parts;
        let mut server =
            Self { board, expected, counter, clock, port, reset, silicon, decoder: Decoder::new() };
        server.port.write(&[DELIMITER]); // what was on the line before is no part of the first packet
        server.describe();
        (server, watchdog)
    }

    /// Serves the commands that have come; `false` when there was none.
    pub fn turn(&mut self, memory: &mut impl Memory) -> bool {
        let mut bytes = [0; 16];
        let count = self.port.read(&mut bytes);
        for &byte in bytes.iter().take(count) {
            if let Some(Ok(command)) = self.decoder.push(byte) {
                let outcome = self.serve(&command.request, memory).into();
                self.write(&Message::Answer(Answer { command: command.id, outcome }));
            }
        }
        count > 0
    }

    fn serve(&mut self, request: &Request, memory: &mut impl Memory) -> Result<(), Refusal> {
        match *request {
            Request::Describe => self.describe(),
            Request::RunCase(number) => {
                let last = Case::all(&self.board).count() as i64 - 1;
                let report = self.run_case(number, memory);
                let report = report.ok_or_else(|| out_of_range("case", number.into(), 0, last))?;
                self.write(&Message::Case(report));
            }
            _ => return Err(Refusal::Unsupported),
        }
        Ok(())
    }

    fn describe(&mut self) {
        let mut session = Session::new(self.board);
        session.reset = self.reset;
        self.write(&Message::Hello(session.hello()));
        let mut expected = Fnv::EMPTY;
        self.expected
            .as_flattened()
            .iter()
            .for_each(|digest| expected.write(&digest.to_le_bytes()));
        let (mut firmware, mut unit) = (heapless::String::new(), heapless::String::new());
        let _ = (firmware.push_str(env!("CARGO_PKG_VERSION")), unit.push_str(C::UNIT)); // both are short
        self.write(&Message::Machine(MachineReport {
            firmware,
            unit,
            cases: Case::all(&self.board).count() as u16,
            expected: expected.value(),
            silicon: self.silicon,
        }));
    }

    /// Runs a pair; `None` when there is none of this number, or the board has no memory for it.
    #[inline(never)]
    fn run_case(&self, number: u16, memory: &mut impl Memory) -> Option<CaseReport> {
        let case = Case::all(&self.board).nth(number.into())?;
        let digests = selftest::digests(memory, &case)?;
        let mut matcher = Matcher::new(case.params(), case.dims).ok()?;
        let [start, start_us] = [self.counter.now(), self.clock.now()];
        let (costs, matched) =
            bench::measure(memory, &self.counter, &mut matcher, Options::default()).ok()?;
        let [end, end_us] = [self.counter.now(), self.clock.now()];
        let mut name = heapless::String::new();
        let _ = core::fmt::write(&mut name, format_args!("{case}")); // it fits
        Some(CaseReport {
            case: number,
            name,
            segments: matched.counts().segments_left,
            costs,
            total: self.counter.elapsed(start, end),
            time_us: u32::try_from(self.clock.microseconds(start_us, end_us)).unwrap_or(u32::MAX),
            digests,
        })
    }

    fn write(&mut self, message: &Message) {
        let _ = send(message, &mut packets(&mut self.port));
    }
}
