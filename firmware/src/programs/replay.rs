//! Pairs in, results out: what a PC sends is matched as a camera's pairs would be.
//!
//! ```text
//! in   packets of commands; after a `Pair` command the pixels of the left and of the right image,
//!      as they are; after a `RawPair` command raw rows, left and right in turn: each is rectified
//!      as it is read, and no raw frame is ever held
//! out  packets of messages: for each command its answer, for each pair before that its frame,
//!      segments, points and objects
//! ```
//!
//! A pair that cannot be matched is refused by name and skipped, bytes that are no packet are
//! counted, and the next good pair is matched.

use super::bench::{self, Costs};
use crate::memory::Memory;
use crate::ports::{ByteSink, ByteSource, Clock, packets};
use crate::session::{self, Reply, Session};
use linestereo::{Dims, Matched, Matcher, Options};
use linestereo_rig::CameraSide;
use linestereo_wire::{
    Answer, Command, Counters, Decoder, FrameHead, Health, MAX_COMMAND, Message, Outcome, PairHead,
    PointStream, Refusal, send, send_frame, send_objects,
};

/// Outcome of a pair, for logs and tables.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// It was matched.
    Matched {
        /// Its number.
        sequence: u32,
        /// Cost of its rectification; 0 for a pair that came rectified.
        rectification: u64,
        /// Cost by stage.
        costs: Costs,
        /// Cost of the depths of its objects, on top.
        objects: u64,
        /// Cost of making each of its points once, on top.
        points: u64,
    },
    /// It was refused.
    Refused {
        /// Its number.
        sequence: u32,
        /// Why.
        why: Refusal,
    },
}

/// Serves the whole input, and says what packets were in it. `before` is called with each pair that
/// lies in the frames and the matcher that is to match it.
pub fn run<M: Memory>(
    memory: &mut M,
    clock: &impl Clock,
    session: &mut Session<'_>,
    input: &mut impl ByteSource,
    output: &mut impl ByteSink,
    mut before: impl FnMut(&mut M, &Matcher),
    mut report: impl FnMut(&Event),
) -> Counters {
    let mut input = Buffered { source: input, bytes: [0; 256], from: 0, to: 0 };
    let mut decoder: Decoder<Command, MAX_COMMAND> = Decoder::new();
    while let Some(byte) = input.next() {
        let Some(Ok(command)) = decoder.push(byte) else { continue }; // the decoder counts what is no command
        let answer = match session.command(&command, memory) {
            Reply::Answer(answer) => answer,
            Reply::Describe(answer) => {
                write(&Message::Hello(session.hello()), output);
                answer
            }
            Reply::Settings(answer) => {
                session.report_settings(|message| write(message, output));
                answer
            }
            Reply::Photograph { command }
            | Reply::Leave(Answer { command, .. })
            | Reply::Clock(Answer { command, .. })
            | Reply::SetClock(Answer { command, .. }, _) => {
                Answer { command, outcome: Outcome::Refused(Refusal::Unsupported) }
            }
            Reply::Pair { command, head, is_raw } => {
                let sequence = session.next_sequence();
                let outcome =
                    match pair(memory, clock, session, &mut input, &head, is_raw, &mut before) {
                        Ok(Replayed { rectification, costs, mut matched }) => {
                            let from = clock.now();
                            let found = session.objects(&mut matched);
                            let objects = clock.elapsed(from, clock.now());
                            let from = clock.now();
                            let count = matched.points().count() as u32; // at most the pixels
                            let points = clock.elapsed(from, clock.now());
                            report(&Event::Matched {
                                sequence,
                                rectification,
                                costs,
                                objects,
                                points,
                            });
                            write_results(&mut matched, count, sequence, &head, output);
                            let _ = send_objects(sequence, &found, &mut packets(output));
                            Outcome::Accepted
                        }
                        Err(why) => {
                            report(&Event::Refused { sequence, why: why.clone() });
                            Outcome::Refused(why)
                        }
                    };
                Answer { command, outcome }
            }
        };
        write(&Message::Answer(answer), output);
    }
    decoder.finish();
    decoder.counters()
}

/// A matched pair with its costs, in the unit of the clock.
struct Replayed<'m> {
    /// Cost of rectifying both images.
    rectification: u64,
    costs: Costs,
    matched: Matched<'m>,
}

/// Reads a pair, rectifies it if it is raw, and matches it.
fn pair<'m, M: Memory, S: ByteSource>(
    memory: &'m mut M,
    clock: &impl Clock,
    session: &mut Session<'_>,
    input: &mut Buffered<'_, S>,
    head: &PairHead,
    is_raw: bool,
    before: &mut impl FnMut(&mut M, &Matcher),
) -> Result<Replayed<'m>, Refusal> {
    let (dims, rectification) = if is_raw {
        read_raw(memory, clock, session, input, head)?
    } else {
        (read_rectified(memory, session, input, head)?, 0)
    };
    let times_us = head.right_capture_time_us.map(|right| [head.capture_time_us, right]);
    let areas = session.areas();
    let matcher = session.matcher(dims)?;
    before(memory, matcher);
    let options = Options { areas: areas.as_deref(), times_us, ..Options::default() };
    let (costs, matched) =
        bench::measure(memory, clock, matcher, options).map_err(session::refusal)?;
    if let Some(Err(skewed)) = times_us.map(|times| session.limits.skew_us(times)) {
        return Err(skewed.into());
    }
    Ok(Replayed { rectification, costs, matched })
}

/// Reads the pixels of a rectified pair, or skips them.
fn read_rectified<S: ByteSource>(
    memory: &mut impl Memory,
    session: &mut Session<'_>,
    input: &mut Buffered<'_, S>,
    head: &PairHead,
) -> Result<Dims, Refusal> {
    let dims = Dims { width: head.width, height: head.height };
    let pixels = usize::from(dims.width) * usize::from(dims.height);
    session.matcher(dims).inspect_err(|_| input.skip_images(pixels))?;
    let mut given = 0;
    for frame in memory.frames() {
        given += input.read(frame.get_mut(..pixels).unwrap_or_default());
    }
    if given < 2 * pixels { Err(truncated(pixels, given)) } else { Ok(dims) }
}

/// Reads the rows of a raw pair and rectifies each, or skips them. Gives what rectifying costs,
/// without the reading.
fn read_raw<S: ByteSource>(
    memory: &mut impl Memory,
    clock: &impl Clock,
    session: &mut Session<'_>,
    input: &mut Buffered<'_, S>,
    head: &PairHead,
) -> Result<(Dims, u64), Refusal> {
    let raw = Dims { width: head.width, height: head.height };
    let pixels = usize::from(raw.width) * usize::from(raw.height);
    let dims = session.rectified(raw).and_then(|dims| session.matcher(dims).map(|_| dims));
    let dims = dims.inspect_err(|_| input.skip_images(pixels))?;
    memory.restart();
    let (mut given, mut cost) = (0, 0);
    for _ in 0..raw.height {
        for eye in CameraSide::BOTH {
            given += input.read(memory.raw_row());
            let from = clock.now();
            let _ = memory.push_row(eye); // rows of the right width, as many as there are: the frames tell below
            cost += clock.elapsed(from, clock.now());
        }
    }
    if given < 2 * pixels {
        return Err(truncated(pixels, given));
    }
    if memory.is_rectified() { Ok((dims, cost)) } else { Err(Refusal::NoRig) }
}

fn truncated(pixels: usize, given: usize) -> Refusal {
    Refusal::Truncated { needed: 2 * pixels as u32, given: given as u32 }
}

/// Points were made once to count them, and are made again: no board has the memory to list them.
#[inline(never)] // its head and points are on the stack only while it sends
fn write_results(
    matched: &mut Matched<'_>,
    points: u32,
    sequence: u32,
    pair: &PairHead,
    output: &mut impl ByteSink,
) {
    let head = FrameHead::new(
        sequence,
        pair.capture_time_us,
        matched.dims(),
        Health::GOOD,
        matched.counts(),
    );
    let mut head = head.with_pair(matched.health());
    head.counts.points = points;
    let mut write = packets(output);
    // Neither the packets nor this port can fail.
    let _ = send_frame(&head, matched.segments(), &mut write);
    let mut stream = PointStream::new(sequence);
    matched.points().for_each(|point| {
        let _ = stream.push(&point, &mut write);
    });
    let _ = stream.finish(&mut write);
}

fn write(message: &Message, output: &mut impl ByteSink) {
    let _ = send(message, &mut packets(output));
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
        for (slot, &byte) in bytes.iter_mut().zip(buffered) {
            *slot = byte;
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

    /// Skips a pair of images of so many pixels each.
    fn skip_images(&mut self, pixels: usize) {
        self.skip(pixels);
        self.skip(pixels);
    }

    fn skip(&mut self, count: usize) {
        for _ in 0..count {
            if self.next().is_none() {
                return;
            }
        }
    }
}
