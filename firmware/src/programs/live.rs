//! A board at work: pairs from a camera, results to a port, commands from it.

use crate::memory::Memory;
use crate::ports::{ByteSink, ByteSource, CapturedPair, Clock, PairSource};
use crate::session::{Reply, Session, failed_frame};
use core::convert::Infallible;
use linestereo::Dims;
use linestereo_wire::{Command, DELIMITER, Decoder, FrameHead, Health, MAX_COMMAND, Message, send, send_frame};

/// A program that takes turns: commands that have come, then a pair if the host wants results.
#[derive(Debug)]
pub struct Live<'a, C, P> {
    session: Session<'a>,
    clock: C,
    port: P,
    decoder: Decoder<Command, MAX_COMMAND>,
    /// The clock when it was last looked at, and microseconds since the start.
    last: u32,
    time_us: u64,
}

impl<'a, C: Clock, P: ByteSource + ByteSink> Live<'a, C, P> {
    /// Says hello.
    pub fn start(session: Session<'a>, clock: C, port: P) -> Self {
        let last = clock.now();
        let mut live = Self { session, clock, port, decoder: Decoder::new(), last, time_us: 0 };
        live.port.write(&[DELIMITER]); // what was on the line before is no part of the first packet
        let hello = live.session.hello();
        live.write(&Message::Hello(hello));
        live
    }

    /// Takes one turn.
    pub fn turn(&mut self, memory: &mut impl Memory, camera: &mut impl PairSource) {
        self.serve_commands(memory);
        if self.session.running {
            self.match_pair(memory, camera);
        }
    }

    fn serve_commands(&mut self, memory: &mut impl Memory) {
        let mut bytes = [0; 16];
        // A host that never pauses does not stop the pairs.
        for _ in 0..MAX_COMMAND {
            let count = self.port.read(&mut bytes);
            if count == 0 {
                return;
            }
            for &byte in bytes.iter().take(count) {
                let Some(Ok(command)) = self.decoder.push(byte) else { continue };
                match self.session.command(&command, memory) {
                    Reply::Answer(answer) => self.write(&Message::Answer(answer)),
                    Reply::Describe(answer) => {
                        let hello = self.session.hello();
                        self.write(&Message::Hello(hello));
                        self.write(&Message::Answer(answer));
                    }
                    // Pixels come from the camera here; what follows is garbage to the decoder.
                    Reply::Pair { command, .. } => self.write(&Message::Answer(linestereo_wire::Answer {
                        command,
                        outcome: linestereo_wire::Outcome::Refused(linestereo_wire::Refusal::Unsupported),
                    })),
                }
            }
        }
    }

    fn match_pair(&mut self, memory: &mut impl Memory, camera: &mut impl PairSource) {
        let sequence = self.session.next_sequence();
        let captured = camera.next_pair(memory.frames());
        let now_us = self.time();
        let time_us = captured.and_then(|pair| pair.times_us).map_or(now_us, |[left, _]| left);
        let Some(pair) = captured else {
            let none = Dims { width: 0, height: 0 };
            return self.write(&Message::Frame(failed_frame(sequence, time_us, none, Health::PAIR_MISSING)));
        };
        let dims = pair.dims;
        let Ok(plan) = self.session.plan(dims) else {
            return self.write(&Message::Frame(failed_frame(sequence, time_us, dims, Health::SIZE_MISMATCH)));
        };
        let Ok(health) = self.session.watch.run(memory, &plan, pair.times_us, &mut ()) else {
            return self.write(&Message::Frame(failed_frame(sequence, time_us, dims, Health::SIZE_MISMATCH)));
        };
        if health.is_refused() {
            let refused = failed_frame(sequence, time_us, dims, Health::GOOD).with_pair(&health);
            return self.write(&Message::Frame(refused));
        }
        let results = memory.results();
        let head = FrameHead::new(sequence, time_us, dims, Health::GOOD, results.counts).with_pair(&health);
        let _ = send_frame(&head, results.matches, &mut |packet| {
            self.port.write(packet);
            Ok::<(), Infallible>(())
        });
    }

    /// Microseconds since the start. Right as long as the clock does not wrap between two questions.
    fn time(&mut self) -> u64 {
        let now = self.clock.now();
        self.time_us += self.clock.microseconds(self.last, now);
        self.last = now;
        self.time_us
    }

    fn write(&mut self, message: &Message) {
        let _ = send(message, &mut |packet: &[u8]| {
            self.port.write(packet);
            Ok::<(), Infallible>(())
        });
    }
}

/// Stands for a camera: paints one scene after the other.
#[derive(Debug)]
pub struct Painter {
    dims: Dims,
    next: usize,
}

impl Painter {
    /// A camera of this size.
    #[must_use]
    pub const fn new(dims: Dims) -> Self {
        Self { dims, next: 0 }
    }
}

impl PairSource for Painter {
    fn next_pair(&mut self, [left, right]: [&mut [u8]; 2]) -> Option<CapturedPair> {
        let scene = crate::painter::Scene::ALL.get(self.next)?;
        self.next = (self.next + 1) % crate::painter::Scene::ALL.len();
        scene.paint(self.dims, left, right);
        Some(CapturedPair::of(self.dims))
    }
}
