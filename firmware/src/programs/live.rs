//! A board at work: pairs from a camera, results to a port, commands from it; obstacles to an autopilot on a port of its own.

use crate::autopilot::Autopilot;
use crate::camera::FrameStart;
use crate::memory::Memory;
use crate::ports::{ByteSink, ByteSource, CapturedPair, Clock, PairSource};
use crate::session::{Reply, Session, failed_frame};
use core::convert::Infallible;
use linestereo::{Dims, Match, ObjectDepth};
use linestereo_wire::{
    CaptureReport, Command, DELIMITER, Decoder, FrameHead, Health, MAX_COMMAND, Message, send, send_frame, send_objects,
};

/// A program that takes turns: commands that have come, then a pair if the host wants results, or an autopilot can be told of obstacles.
#[derive(Debug)]
pub struct Live<'a, C, P, A = NoAutopilot> {
    session: Session<'a>,
    clock: C,
    port: P,
    decoder: Decoder<Command, MAX_COMMAND>,
    /// The clock when it was last looked at, and microseconds since the start.
    last: u32,
    time_us: u64,
    autopilot: Autopilot,
    autopilot_port: Option<A>,
    /// What the cameras lost, as the host was told, and when.
    lost: CaptureReport,
    told_us: Option<u64>,
}

/// What a turn has done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Nobody wants results.
    Idle,
    /// A pair came, and its frame is finished: matched, or refused by name.
    Finished,
    /// No pair came.
    Missing,
}

impl Turn {
    /// Does the board do its work? What a watchdog is fed by: cameras that deliver nothing for long are to be reset.
    #[must_use]
    pub const fn is_work(self) -> bool {
        matches!(self, Self::Idle | Self::Finished)
    }
}

/// The host is told of losses at most so often, microseconds.
const LOSSES_US: u64 = 1_000_000;

/// Nobody at the second port.
#[derive(Debug)]
pub enum NoAutopilot {}

impl ByteSink for NoAutopilot {
    fn write(&mut self, _: &[u8]) {}
}

impl<'a, C: Clock, P: ByteSource + ByteSink> Live<'a, C, P> {
    /// Says hello.
    pub fn start(session: Session<'a>, clock: C, port: P) -> Self {
        let last = clock.now();
        let mut live = Self {
            session,
            clock,
            port,
            decoder: Decoder::new(),
            last,
            time_us: 0,
            autopilot: Autopilot::new(),
            autopilot_port: None,
            lost: CaptureReport::default(),
            told_us: None,
        };
        live.port.write(&[DELIMITER]); // what was on the line before is no part of the first packet
        let hello = live.session.hello();
        live.write(&Message::Hello(hello));
        live
    }

    /// With an autopilot at this port: as soon as there is a rig it is told of obstacles, whether a host asks for results or not.
    pub fn with_autopilot<A>(self, port: A) -> Live<'a, C, P, A> {
        let Self { session, clock, port: host, decoder, last, time_us, autopilot, lost, told_us, .. } = self;
        let autopilot_port = Some(port);
        Live { session, clock, port: host, decoder, last, time_us, autopilot, autopilot_port, lost, told_us }
    }
}

impl<C: Clock, P: ByteSource + ByteSink, A: ByteSink> Live<'_, C, P, A> {
    /// Takes one turn, and says what it has done.
    pub fn turn(&mut self, memory: &mut impl Memory, camera: &mut impl PairSource) -> Turn {
        self.serve_commands(memory);
        let is_told = self.autopilot_port.is_some() && self.session.has_rig();
        let turn = if self.session.running || is_told { self.match_pair(memory, camera) } else { Turn::Idle };
        let now_us = self.time();
        if let Some(port) = &mut self.autopilot_port {
            self.autopilot.turn(now_us, port);
        }
        if let Some(losses) = camera.losses() {
            self.tell_losses(losses.into(), now_us);
        }
        turn
    }

    /// Tells a host that wants results what the cameras lost, when that has changed.
    fn tell_losses(&mut self, lost: CaptureReport, now_us: u64) {
        let is_due = self.told_us.is_none_or(|told| now_us.saturating_sub(told) >= LOSSES_US);
        if self.session.running && lost != self.lost && is_due {
            (self.lost, self.told_us) = (lost, Some(now_us));
            self.write(&Message::Capture(lost));
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

    fn match_pair(&mut self, memory: &mut impl Memory, camera: &mut impl PairSource) -> Turn {
        let captured = camera.next_pair(memory, self.session.rig_dims());
        let now_us = self.time();
        let time_us = captured.and_then(|pair| pair.times_us).map_or(now_us, |[left, _]| left);
        self.autopilot.miss(); // until its matches say otherwise
        if let (false, Some(dims)) = (self.autopilot.has_view(), self.session.rig_dims()) {
            self.autopilot.set_view(self.session.directions(dims)); // a camera that never delivers is told of as well
        }
        let dims = captured.map_or(Dims { width: 0, height: 0 }, |pair| pair.dims);
        let is_free = captured.and_then(|pair| pair.frame_start) == Some(FrameStart::Free);
        let good = if is_free { Health::FREE_RUNNING } else { Health::GOOD };
        let failed = |health| failed_frame(0, time_us, dims, good | health);
        let Some(pair) = captured else {
            self.write_frame(failed(Health::PAIR_MISSING), None);
            return Turn::Missing;
        };
        let Ok(plan) = self.session.plan(dims) else {
            self.write_frame(failed(Health::SIZE_MISMATCH), None);
            return Turn::Finished;
        };
        let areas = self.session.areas();
        let Ok(health) = self.session.watch.run(memory, &plan, areas.as_deref(), pair.times_us, &mut ()) else {
            self.write_frame(failed(Health::SIZE_MISMATCH), None);
            return Turn::Finished;
        };
        if health.is_refused() {
            self.write_frame(failed(good).with_pair(&health), None);
            return Turn::Finished;
        }
        let objects = self.session.objects(memory, &plan, &health);
        let results = memory.results();
        self.autopilot.set_view(self.session.directions(dims));
        self.autopilot.see(results.matches, health.flags, now_us); // of the clock of its turns
        let head = FrameHead::new(0, time_us, dims, good, results.counts).with_pair(&health);
        self.write_frame(head, Some((results.matches, &objects)));
        Turn::Finished
    }

    /// Numbers a frame and sends it, if the host wants results.
    fn write_frame(&mut self, head: FrameHead, found: Option<(&[Match], &[ObjectDepth])>) {
        if !self.session.running {
            return;
        }
        let head = FrameHead { sequence: self.session.next_sequence(), ..head };
        let Some((matches, objects)) = found else { return self.write(&Message::Frame(head)) };
        let mut write = |packet: &[u8]| {
            self.port.write(packet);
            Ok::<(), Infallible>(())
        };
        let _ = send_frame(&head, matches, &mut write);
        let _ = send_objects(head.sequence, objects, &mut write);
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
    fn next_pair(&mut self, memory: &mut impl Memory, _: Option<Dims>) -> Option<CapturedPair> {
        let [left, right] = memory.frames();
        let scene = crate::painter::Scene::ALL.get(self.next)?;
        self.next = (self.next + 1) % crate::painter::Scene::ALL.len();
        scene.paint(self.dims, left, right);
        Some(CapturedPair::of(self.dims))
    }
}
