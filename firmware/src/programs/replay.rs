//! Pairs in, results out: what a PC sends is matched as a camera's pairs would be.
//!
//! ```text
//! in   packets of commands; after a `Pair` command the pixels of the left and of the right image, as they are
//! out  packets of messages: for each command its answer, for each pair before that its frame, segments and points
//! ```
//!
//! A pair that cannot be matched is refused by name and skipped, bytes that are no packet are counted, and the next good pair is matched.

use super::bench::{self, Costs};
use crate::memory::Memory;
use crate::ports::{ByteSink, ByteSource, CapturedPair, Clock};
use crate::session::{self, Reply, Session};
use linestereo::{Dims, PairHealth};
use linestereo_wire::{
    Answer, Command, Counters, Decoder, FrameHead, Health, MAX_COMMAND, Message, Outcome, PairHead, PointStream,
    Refusal, send, send_frame,
};

/// What happened to a pair, for logs and tables.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// It was matched.
    Matched {
        /// Its number.
        sequence: u32,
        /// What its stages cost.
        costs: Costs,
    },
    /// It was refused.
    Refused {
        /// Its number.
        sequence: u32,
        /// Why.
        why: Refusal,
    },
}

/// Serves the whole input, and says what packets were in it.
pub fn run(
    memory: &mut impl Memory,
    clock: &impl Clock,
    session: &mut Session,
    input: &mut impl ByteSource,
    output: &mut impl ByteSink,
    mut tell: impl FnMut(&Event),
) -> Counters {
    let mut input = Buffered { source: input, bytes: [0; 256], from: 0, to: 0 };
    let mut decoder: Decoder<Command, MAX_COMMAND> = Decoder::new();
    while let Some(byte) = input.next() {
        let Some(Ok(command)) = decoder.push(byte) else { continue }; // the decoder counts what is no command
        match session.command(&command) {
            Reply::Answer(answer) => write(&Message::Answer(answer), output),
            Reply::Describe(answer) => {
                write(&Message::Hello(session.hello()), output);
                write(&Message::Answer(answer), output);
            }
            Reply::Pair { command, head } => {
                let sequence = session.next_sequence();
                let outcome = match pair(memory, clock, session, &mut input, &head) {
                    Ok((costs, health)) => {
                        tell(&Event::Matched { sequence, costs });
                        write_results(memory, session, (sequence, &health), &head, output);
                        Outcome::Accepted
                    }
                    Err(why) => {
                        tell(&Event::Refused { sequence, why: why.clone() });
                        Outcome::Refused(why)
                    }
                };
                write(&Message::Answer(Answer { command, outcome }), output);
            }
        }
    }
    decoder.finish();
    decoder.counters()
}

/// Reads the pixels of a pair, or skips them, and matches it.
fn pair<S: ByteSource>(
    memory: &mut impl Memory,
    clock: &impl Clock,
    session: &mut Session,
    input: &mut Buffered<'_, S>,
    head: &PairHead,
) -> Result<(Costs, PairHealth), Refusal> {
    let dims = Dims { width: head.width, height: head.height };
    let pixels = usize::from(dims.width).saturating_mul(dims.height.into());
    if let Err(refusal) = session.check_size(dims) {
        input.skip(pixels);
        input.skip(pixels);
        return Err(refusal);
    }
    let mut given = 0;
    for frame in memory.frames() {
        given += input.read(frame.get_mut(..pixels).unwrap_or_default());
    }
    if given < 2 * pixels {
        return Err(Refusal::Truncated { needed: 2 * pixels as u32, given: given as u32 });
    }
    let times_us = head.right_capture_time_us.map(|right| [head.capture_time_us, right]);
    let pair = CapturedPair { dims, times_us };
    let found = bench::measure(memory, clock, &mut session.watch, &session.params, &pair);
    let (costs, health) = found.map_err(session::refusal)?;
    if let Some(Err(skewed)) = times_us.map(|times| session.watch.limits.skew_us(times)) {
        return Err(skewed.into());
    }
    Ok((costs, health))
}

/// Points are made twice, to count them and to send them: no board has the memory to list them.
fn write_results(
    memory: &mut impl Memory,
    session: &Session,
    (sequence, health): (u32, &PairHealth),
    pair: &PairHead,
    output: &mut impl ByteSink,
) {
    let dims = Dims { width: pair.width, height: pair.height };
    let mut points = 0;
    memory.for_each_point(&session.params, dims, |_| points += 1);
    let results = memory.results();
    let mut head = FrameHead::new(sequence, pair.capture_time_us, dims, Health::GOOD, results.counts).with_pair(health);
    head.counts.points = points;
    let mut write = |packet: &[u8]| {
        output.write(packet);
        Ok::<(), core::convert::Infallible>(())
    };
    // Neither the packets nor this port can fail.
    let _ = send_frame(&head, results.matches, &mut write);
    let mut stream = PointStream::new(sequence);
    memory.for_each_point(&session.params, dims, |point| {
        let _ = stream.push(&point, &mut write);
    });
    let _ = stream.finish(&mut write);
}

fn write(message: &Message, output: &mut impl ByteSink) {
    let _ = send(message, &mut |packet: &[u8]| {
        output.write(packet);
        Ok::<(), core::convert::Infallible>(())
    });
}

/// Bytes one by one, without asking the source for each.
struct Buffered<'a, S> {
    source: &'a mut S,
    bytes: [u8; 256],
    from: usize,
    to: usize,
}

impl<S: ByteSource> Buffered<'_, S> {
    /// The next byte; `None` at the end.
    fn next(&mut self) -> Option<u8> {
        if self.from >= self.to {
            (self.from, self.to) = (0, self.source.read(&mut self.bytes));
        }
        let byte = self.bytes.get(..self.to)?.get(self.from).copied()?;
        self.from += 1;
        Some(byte)
    }

    /// Reads until `bytes` is full or the source ends, and says how many bytes came.
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let buffered = self.bytes.get(self.from..self.to).unwrap_or_default();
        let mut filled = buffered.len().min(bytes.len());
        for (place, &byte) in bytes.iter_mut().zip(buffered) {
            *place = byte;
        }
        self.from += filled;
        while let Some(rest) = bytes.get_mut(filled..).filter(|rest| !rest.is_empty()) {
            match self.source.read(rest) {
                0 => break,
                more => filled += more,
            }
        }
        filled
    }

    fn skip(&mut self, count: usize) {
        for _ in 0..count {
            if self.next().is_none() {
                return;
            }
        }
    }
}
