//! A board at work: pairs from a camera, results to a port, commands from it; obstacles to an
//! autopilot on a port of its own.

use crate::autopilot::Autopilot;
use crate::clock_sync::ClockSync;
use crate::indicator::{self, Status};
use crate::memory::Memory;
use crate::ports::{
    ByteSink, ByteSource, CapturedPair, Clock, FrameStart, NoPort, PairSource, Room, packets,
};
use crate::session::{Reply, Session, failed_frame};
use linestereo::{Cores, Dims, Options, health::HealthLimits, results::Match};
use linestereo_mavlink::{ParamId, Received};
use linestereo_wire::{
    Answer, CaptureReport, Command, DELIMITER, Decoder, FrameHead, FrameTimes, Health, MAX_COMMAND,
    MAX_PACKET, Message, ObjectRecord, Outcome, PIXELS_PER_PACKET, PairHead, Pixels, Refusal,
    Request, SEGMENTS_PER_PACKET, SendError, Setting, TimeSource, send, send_frame, send_objects,
};

/// A program that takes turns: commands that have come, then a pair if the host wants results, or
/// an autopilot obstacles.
#[derive(Debug)]
pub struct Live<'a, C, P, A = NoPort> {
    session: Session<'a>,
    clock: C,
    port: P,
    decoder: Decoder<Command, MAX_COMMAND>,
    /// The clock when it was last looked at, and microseconds since the start.
    last: u32,
    time_us: u64,
    autopilot: Autopilot,
    autopilot_port: Option<A>,
    /// Losses of the cameras in the last report to the host, and when that was.
    lost: CaptureReport,
    reported_us: Option<u64>,
    photo: Option<Photo>,
    /// The last frame was not sent: the port had no room for it.
    has_skipped: bool,
    /// Of the frame that is worked on.
    times: FrameTimes,
    /// When an autopilot last set a parameter that is not yet in the flash.
    unkept_us: Option<u64>,
    sync: ClockSync,
    leaves: bool,
    status: Status,
}

/// A photo that lies in the frames, and pixels of it that are sent.
#[derive(Clone, Copy, Debug)]
struct Photo {
    dims: Dims,
    sent: usize,
}

/// Packets of a photo that are sent in one turn: between them commands are served, and a slow port
/// does not starve a watchdog.
const PHOTO_PACKETS: usize = 8;

/// Work done in a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Nobody wants results.
    Idle,
    /// A pair came, and its frame is finished: matched, or refused by name.
    Finished,
    /// No pair came.
    Missing,
    /// The host wants the boot loader: the program is to end.
    Leave,
}

impl Turn {
    /// Does the board do its work? What a watchdog is fed by: cameras that deliver nothing for long
    /// are to be reset.
    #[must_use]
    pub const fn is_work(self) -> bool {
        matches!(self, Self::Idle | Self::Finished | Self::Leave)
    }
}

/// Shortest time between two reports of losses, microseconds.
const LOSSES_US: u64 = 1_000_000;

/// Most answers to a host, and to an autopilot, in one turn, but for those of the last few bytes.
const ANSWERS: usize = 4;
/// Most reads of an autopilot's port in one turn: what a line of 57600 baud carries in 0.2 s.
const AUTOPILOT_READS: usize = 64;
/// Parameters that an autopilot has set go into the flash when it has set no other for so long,
/// microseconds: erasing takes up to seconds.
const KEEP_AFTER_US: u64 = 1_000_000;

impl<'a, C: Clock, P: ByteSource + ByteSink> Live<'a, C, P> {
    /// Starts with a [`Message::Hello`].
    pub fn start(session: Session<'a>, clock: C, port: P) -> Self {
        let mut live = Self::new(session, clock, port, None);
        live.last = live.clock.now();
        live.port.write(&[DELIMITER]); // what was on the line before is no part of the first packet
        let hello = live.session.hello();
        live.write(&Message::Hello(hello));
        live
    }

    /// With an autopilot at this port, before the first turn: as soon as there is a rig it gets
    /// obstacles, whether a host asks for results or not.
    pub fn with_autopilot<A>(self, port: A) -> Live<'a, C, P, A> {
        let Self { session, clock, port: host, last, time_us, times, .. } = self;
        Live { last, time_us, times, ..Live::new(session, clock, host, Some(port)) }
    }
}

impl<'a, C, P, A> Live<'a, C, P, A> {
    fn new(session: Session<'a>, clock: C, port: P, autopilot_port: Option<A>) -> Self {
        Self {
            autopilot: Autopilot::new(session.vehicle),
            session,
            clock,
            port,
            decoder: Decoder::new(),
            last: 0,
            time_us: 0,
            autopilot_port,
            lost: CaptureReport::default(),
            reported_us: None,
            photo: None,
            has_skipped: false,
            times: FrameTimes::default(),
            unkept_us: None,
            sync: ClockSync::BOARD,
            leaves: false,
            status: Status::Waiting,
        }
    }
}

impl<C: Clock, P: ByteSource + ByteSink, A: ByteSource + ByteSink> Live<'_, C, P, A> {
    /// Takes one turn, and says what it has done.
    pub fn turn(&mut self, memory: &mut impl Memory, camera: &mut impl PairSource) -> Turn {
        self.turn_with(None, memory, camera)
    }

    /// [`Live::turn`], on two cores where they are lent.
    pub fn turn_with(
        &mut self,
        cores: Option<&mut dyn Cores>,
        memory: &mut impl Memory,
        camera: &mut impl PairSource,
    ) -> Turn {
        self.serve_commands(memory, camera);
        if self.leaves {
            return Turn::Leave;
        }
        self.serve_autopilot(camera);
        let has_listener = self.autopilot_port.is_some() && self.session.has_rig();
        let turn = match self.photo.take() {
            Some(photo) => self.send_photo(photo, memory),
            None if self.session.running || has_listener => self.match_pair(cores, memory, camera),
            None => {
                self.status = Status::Waiting;
                Turn::Idle
            }
        };
        let now_us = self.time();
        if let Some(port) = &mut self.autopilot_port {
            self.autopilot.turn(now_us, port);
        }
        if let Some(losses) = camera.losses() {
            self.report_losses(losses, now_us);
        }
        turn
    }

    /// Is the board's light on?
    pub fn is_lit(&self) -> bool {
        indicator::is_lit(
            self.session.reset.map(|reset| reset.cause),
            self.status,
            (self.time_us / 1000) as u32,
        )
    }

    /// Reports to a host that wants results what the cameras lost, when that has changed.
    fn report_losses(&mut self, lost: CaptureReport, now_us: u64) {
        let is_due = self
            .reported_us
            .is_none_or(|reported_us| now_us.saturating_sub(reported_us) >= LOSSES_US);
        if self.session.running && lost != self.lost && is_due {
            (self.lost, self.reported_us) = (lost, Some(now_us));
            self.write(&Message::Capture(lost));
        }
    }

    fn serve_commands(&mut self, memory: &mut impl Memory, camera: &mut impl PairSource) {
        let mut bytes = [0; 16];
        let mut answers = 0;
        // A host that never pauses does not stop the pairs.
        for _ in 0..MAX_COMMAND {
            let count = self.port.read(&mut bytes);
            let mut took_long = false;
            for &byte in bytes.iter().take(count) {
                if let Some(Ok(command)) = self.decoder.push(byte) {
                    self.port.heard();
                    answers += 1;
                    took_long |= matches!(
                        command.request,
                        Request::SetRig(_)
                            | Request::Photograph
                            | Request::KeepSettings
                            | Request::ResetSettings
                    );
                    self.serve(&command, memory, camera);
                    self.autopilot.set_vehicle(self.session.vehicle);
                }
            }
            // One a turn: the watchdog is fed in between.
            if count == 0 || took_long || answers >= ANSWERS {
                return;
            }
        }
    }

    fn serve(&mut self, command: &Command, memory: &mut impl Memory, camera: &mut impl PairSource) {
        let mut photo = None;
        let answer = match self.session.command(command, memory) {
            Reply::Answer(answer) => answer,
            Reply::Leave(answer) => {
                self.leaves = true;
                answer
            }
            Reply::Clock(answer) => {
                let board_us = self.capture_clock(camera);
                self.write(&Message::Clock(board_us));
                answer
            }
            Reply::SetClock(answer, offset_us) => {
                let now_us = self.capture_clock(camera);
                self.sync.set(TimeSource::Host, offset_us.cast_signed(), now_us);
                answer
            }
            Reply::Describe(answer) => {
                let hello = self.session.hello();
                self.write(&Message::Hello(hello));
                answer
            }
            Reply::Settings(answer) => {
                self.write_by(|port, session, _| {
                    session.report_settings(|message| {
                        let _ = send(message, &mut packets(port));
                    });
                });
                answer
            }
            Reply::Photograph { command } => {
                let taken = self.photograph(memory, camera);
                photo = taken.as_ref().ok().copied();
                Answer { command, outcome: taken.map(drop).into() }
            }
            // Pixels come from the camera here; what follows is garbage to the decoder.
            Reply::Pair { command, .. } => {
                Answer { command, outcome: Outcome::Refused(Refusal::Unsupported) }
            }
        };
        self.write(&Message::Answer(answer));
        if let Some(head) = photo {
            self.write(&Message::Photo(head));
        }
    }

    /// Answers what the autopilot asks, and keeps what it has set.
    #[inline(never)]
    fn serve_autopilot(&mut self, camera: &impl PairSource) {
        let Some(mut port) = self.autopilot_port.take() else { return };
        let mut bytes = [0; 16];
        let mut answers = 0;
        for _ in 0..AUTOPILOT_READS {
            let count = port.read(&mut bytes);
            for &byte in bytes.iter().take(count) {
                if let Some(message) = self.autopilot.receive(byte) {
                    answers += 1;
                    self.answer_autopilot(message, camera, &mut port);
                }
            }
            if count == 0 || answers >= ANSWERS {
                break;
            }
        }
        for _ in 0..ANSWERS {
            let Some(number) = self.autopilot.listed else { break };
            let is_one = self.autopilot.send_parameter(&self.session.values(), number, &mut port);
            self.autopilot.listed = is_one.then_some(number.wrapping_add(1));
        }
        if self.autopilot.has_view() {
            let now_us = camera.clock_us().unwrap_or(self.time_us);
            if let Some(question) = self.sync.question(now_us) {
                self.autopilot.send(&question, &mut port);
            }
        }
        self.autopilot_port = Some(port);
        let now_us = self.time_us; // of the last look
        if self
            .unkept_us
            .take_if(|since_us| now_us.saturating_sub(*since_us) >= KEEP_AFTER_US)
            .is_some()
        {
            let _ = self.session.keep_settings(); // without flash they last until the next reset
        }
    }

    fn answer_autopilot(&mut self, message: Received, camera: &impl PairSource, port: &mut A) {
        let number = match message {
            Received::ParamList => {
                self.autopilot.listed = Some(0);
                return;
            }
            Received::ParamRead { index, id } => u8::try_from(index).ok().or_else(|| number(&id)),
            Received::ParamSet { id, value } => {
                let number = number(&id);
                if number.is_some_and(|number| self.session.set(number, value).is_ok()) {
                    self.unkept_us = Some(self.time_us);
                    self.autopilot.set_vehicle(self.session.vehicle);
                }
                number
            }
            Received::Timesync(times) => {
                let now_us = camera.clock_us().unwrap_or(self.time_us); // of the last look
                if let Some(answer) = self.sync.receive(times, now_us) {
                    self.autopilot.send(&answer, port);
                }
                return;
            }
        };
        if let Some(number) = number {
            self.autopilot.send_parameter(&self.session.values(), number, port);
        }
    }

    /// Takes a pair as it comes, to be sent in the turns that follow. A photo that is not sent yet
    /// ends here: its pixels are overwritten.
    fn photograph(
        &mut self,
        memory: &mut impl Memory,
        camera: &mut impl PairSource,
    ) -> Result<PairHead, Refusal> {
        self.photo = None;
        self.autopilot.miss(); // nothing is matched until it is sent
        let pair = camera.next_pair(memory, None).ok_or(Refusal::NoPair)?;
        let Dims { width, height } = pair.dims;
        self.photo = Some(Photo { dims: pair.dims, sent: 0 });
        let times_us = pair.times_us.map(|[left, right]| (left, Some(right)));
        let (capture_time_us, right_capture_time_us) =
            times_us.unwrap_or((self.capture_clock(camera), None));
        Ok(PairHead { width, height, capture_time_us, right_capture_time_us })
    }

    /// Sends some pixels of a photo: the left image first.
    fn send_photo(&mut self, photo: Photo, memory: &mut impl Memory) -> Turn {
        let Photo { dims, mut sent } = photo;
        let pixels = usize::from(dims.width) * usize::from(dims.height);
        for _ in 0..PHOTO_PACKETS {
            let (is_right, first) =
                if sent < pixels { (false, sent) } else { (true, sent - pixels) };
            let [left, right] = memory.frames();
            let frame =
                (if is_right { right } else { left }).get(first..pixels).unwrap_or_default();
            let Some(piece) = frame.chunks(PIXELS_PER_PACKET).next() else { return Turn::Finished }; // the last ones are sent
            let mut list = heapless::Vec::new();
            let _ = list.extend_from_slice(piece); // a piece fits
            sent += piece.len();
            self.write(&Message::Pixels(Pixels { is_right, first: first as u32, list }));
        }
        self.photo = Some(Photo { dims, sent });
        Turn::Finished
    }

    /// Fetches a pair and sends host and autopilot what it gave, or why it gave nothing.
    fn match_pair(
        &mut self,
        cores: Option<&mut dyn Cores>,
        memory: &mut impl Memory,
        camera: &mut impl PairSource,
    ) -> Turn {
        let rectified = match camera.raw_dims().filter(|_| self.session.rig_dims().is_some()) {
            None => Ok(None),
            Some(raw) => self.session.rectified(raw).map(Some),
        };
        let asked_us = self.time();
        // With a rig of other cameras it comes as it is, to be refused at the cameras' pace.
        let captured = camera.next_pair(memory, rectified.as_ref().map_or(None, |&dims| dims));
        let now_us = self.time();
        (self.times.waiting_us, self.times.matching_us) = (saturated(now_us - asked_us), 0);
        self.autopilot.miss(); // until its matches say otherwise
        if let (false, Some(dims)) = (self.autopilot.has_view(), self.session.rig_dims()) {
            self.autopilot.set_view(self.session.directions(dims)); // a camera that never delivers is reported as well
        }
        let Some(pair) = captured else {
            let nothing = Dims { width: 0, height: 0 };
            let missed_us = self.capture_clock(camera);
            self.write_frame(failed_frame(0, missed_us, nothing, Health::PAIR_MISSING), None);
            return Turn::Missing;
        };
        if let Some(skew_us) = camera.still_us() {
            self.session.limits.skew_us = skew_us;
        }
        if rectified.is_err() || self.match_captured(cores, memory, pair, now_us).is_none() {
            let health = captured_health(pair) | Health::SIZE_MISMATCH;
            self.write_frame(failed_frame(0, captured_us(pair, now_us), pair.dims, health), None);
        }
        Turn::Finished
    }

    /// Matches the pair that lies in the frames, and sends the result; `None` when images of its
    /// size cannot be matched.
    fn match_captured(
        &mut self,
        cores: Option<&mut dyn Cores>,
        memory: &mut impl Memory,
        pair: CapturedPair,
        now_us: u64,
    ) -> Option<()> {
        let (time_us, captured) = (captured_us(pair, now_us), captured_health(pair));
        let areas = self.session.areas();
        let options =
            Options { areas: areas.as_deref(), times_us: pair.times_us, ..Options::default() };
        let matcher = self.session.matcher(pair.dims).ok()?;
        let mut matched = memory.run(cores, matcher, options).ok()?;
        let health = *matched.health();
        let objects = self.session.objects(&mut matched);
        self.times.matching_us = saturated(self.time() - now_us);
        if !health.is_refused() {
            self.autopilot.set_view(self.session.directions(pair.dims));
        }
        // A vehicle moves, whatever the build allows of the times of a still scene.
        if health.skew_us.is_none_or(|skew_us| skew_us <= HealthLimits::DEFAULT.skew_us) {
            self.autopilot.see(&matched, now_us); // of the clock of its turns
        }
        let head =
            FrameHead::new(0, time_us, pair.dims, captured, matched.counts()).with_pair(&health);
        let found = Found { matches: matched.segments(), objects: &objects, seen_us: now_us };
        self.write_frame(head, Some(found));
        Some(())
    }

    /// Numbers a frame and sends it, if the host wants results.
    fn write_frame(&mut self, head: FrameHead, found: Option<Found<'_>>) {
        self.status = Status::of(head.health);
        if !self.session.running {
            return;
        }
        let sequence = self.session.next_sequence();
        let skipped = if self.has_skipped { Health::RESULTS_SKIPPED } else { Health::GOOD };
        let times = core::mem::take(&mut self.times);
        let (capture_time_us, clock) = self.sync.stamp(head.capture_time_us);
        let head = FrameHead {
            sequence,
            health: head.health | skipped,
            times,
            capture_time_us,
            clock,
            ..head
        };
        self.has_skipped = !self.has_room(&head, found);
        if self.has_skipped {
            return;
        }
        self.write_by(|port, _, autopilot| {
            let _ = send_found(&head, found, autopilot, &mut packets(port));
        });
    }

    /// Time of the clock of captured pairs, microseconds.
    fn capture_clock(&mut self, camera: &impl PairSource) -> u64 {
        camera.clock_us().unwrap_or_else(|| self.time())
    }

    /// Does the port take a frame as a whole without waiting, or hold nothing? A slow host is not
    /// to slow the cameras down.
    fn has_room(&self, head: &FrameHead, found: Option<Found<'_>>) -> bool {
        let Room { free, all } = self.port.room();
        let segments = found.map_or(0, |found| found.matches.len());
        // Head, objects and sectors.
        if free >= all || free >= (5 + segments.div_ceil(SEGMENTS_PER_PACKET)) * MAX_PACKET {
            return true;
        }
        let mut bytes = 0;
        let mut count = |packet: &[u8]| {
            bytes += packet.len();
            Ok::<(), core::convert::Infallible>(())
        };
        let _ = send_found(head, found, &self.autopilot, &mut count);
        free >= bytes
    }

    /// Microseconds since the start. Right as long as the clock does not wrap between two
    /// questions.
    #[inline(never)]
    fn time(&mut self) -> u64 {
        let now = self.clock.now();
        self.time_us += self.clock.microseconds(self.last, now);
        self.last = now;
        self.time_us
    }

    fn write(&mut self, message: &Message) {
        self.write_by(|port, _, _| {
            let _ = send(message, &mut packets(port));
        });
    }

    /// Writes, and counts the time that it takes.
    fn write_by(&mut self, write: impl FnOnce(&mut P, &Session<'_>, &Autopilot)) {
        let before_us = self.time();
        write(&mut self.port, &self.session, &self.autopilot);
        let took_us = saturated(self.time() - before_us);
        self.times.port_us = self.times.port_us.saturating_add(took_us);
    }
}

/// Results of a matched pair.
#[derive(Clone, Copy)]
struct Found<'m> {
    matches: &'m [Match],
    objects: &'m [ObjectRecord],
    /// When the autopilot saw it, microseconds.
    seen_us: u64,
}

/// Sends a frame with all that was found in it.
fn send_found<E>(
    head: &FrameHead,
    found: Option<Found<'_>>,
    autopilot: &Autopilot,
    write: &mut impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<(), SendError<E>> {
    let Some(Found { matches, objects, seen_us }) = found else {
        return send_frame(head, &[], write);
    };
    send_frame(head, matches, write)?;
    send_objects(head.sequence, objects, write)?;
    autopilot.send_sectors(head.sequence, seen_us, write)
}

/// Number of the setting that a parameter is.
fn number(id: &ParamId) -> Option<u8> {
    Setting::number(id.split(|&byte| byte == 0).next()?)
}

fn saturated(us: u64) -> u32 {
    u32::try_from(us).unwrap_or(u32::MAX)
}

/// When a pair was captured, or else when it came.
fn captured_us(pair: CapturedPair, now_us: u64) -> u64 {
    pair.times_us.map_or(now_us, |[left, _]| left)
}

/// Health of a captured pair before it is matched.
fn captured_health(pair: CapturedPair) -> Health {
    if pair.frame_start == Some(FrameStart::Free) { Health::FREE_RUNNING } else { Health::GOOD }
}
