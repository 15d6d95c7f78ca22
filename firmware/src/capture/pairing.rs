//! Frames of two cameras that belong together, fetched row by row.
//!
//! ```text
//! turn: of both cameras' signals, always the older one
//!     started   the other one's frame is of another time: it is left, unpaired
//!               its first rows are overwritten already: skipped; else it is in hand from now on
//!     rows      each: copied, then checked that it was not overwritten meanwhile, then given to
//!               the sink
//!     fault     the frame in hand is dropped
//!     both whole: the pair
//! ```
//! When frames of both have started since a pair was requested, that is told at once, before their
//! rows are fetched.
//!
//! A row is safe while fewer rows than the ring holds were written since: `written - row < rows`.
//! It is looked at after the copy, so a row that was overwritten during the copy is never used.

use super::tracker::{Progress, Tracker};
use super::{Fault, Limits, RowRing, RowSink, Signal};
use crate::memory::of;
use crate::ports::{CapturedPair, FrameStart};
use linestereo_rig::{CameraSide, RowError};
use linestereo_wire::CaptureReport;

/// The state of both cameras' streams.
#[derive(Clone, Debug)]
pub struct Capture {
    limits: Limits,
    start: FrameStart,
    middle_us: [i32; 2],
    cameras: [Camera; 2],
    losses: CaptureReport,
    /// When a pair was requested whose frames have not both started yet.
    requested_us: Option<u64>,
}

/// Outcome of a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Report {
    /// A frame of each camera has started since a pair was requested. Once after each
    /// [`Capture::request`].
    Started,
    /// Both frames lie in the sink, whole and of one time.
    Pair(CapturedPair),
    /// A frame is lost; counted already.
    Fault(CameraSide, Fault),
    /// The sink does not take such rows: rig and cameras do not fit. The frame is lost.
    Refused(CameraSide, RowError),
    /// Both frames are whole and the sink's are not: rig and cameras do not fit.
    Incomplete,
}

#[derive(Clone, Debug, Default)]
struct Camera {
    tracker: Tracker,
    /// Fetched and not looked at yet.
    signal: Option<Signal>,
    hand: Option<Hand>,
    /// A frame has started since a pair was requested.
    has_started: bool,
}

/// A frame that is fetched.
#[derive(Clone, Copy, Debug)]
struct Hand {
    time_us: u64,
    /// Number of the next row.
    next: u32,
    is_whole: bool,
}

impl Capture {
    /// Nothing seen yet. `start` is what the cameras were started with: a pair of free-running ones
    /// says that it is one.
    pub fn new(limits: Limits, start: FrameStart) -> Self {
        Self {
            limits,
            start,
            middle_us: [0; 2],
            cameras: Default::default(),
            losses: CaptureReport::default(),
            requested_us: None,
        }
    }

    /// From the start of a frame to the middle of its exposure, of the left and the right camera,
    /// microseconds ([`Shutter::middle_us`](crate::camera::Shutter::middle_us)): what is called the
    /// time of an image from now on.
    pub fn set_middle_us(&mut self, middle_us: [i32; 2]) {
        self.middle_us = middle_us;
    }

    /// Faults and losses so far.
    pub const fn losses(&self) -> &CaptureReport {
        &self.losses
    }

    /// After all signals of now: can this shot give no pair any more, because a triggered frame has
    /// ended early?
    pub fn has_failed(&self, now_us: u64) -> bool {
        let has_ended = |camera: &Camera| {
            camera.has_started && camera.tracker.has_ended_early(&self.limits, now_us)
        };
        self.start == FrameStart::Triggered && self.cameras.iter().any(has_ended)
    }

    /// Time after a fault at which no row of the same shot comes any more, microseconds; `None`
    /// where frames come without being triggered.
    pub fn end_of_shot(&self, now_us: u64) -> Option<u64> {
        (self.start == FrameStart::Triggered)
            .then(|| now_us.saturating_add(self.limits.readout_us.into()))
    }

    /// A pair is requested, now: frames that are half fetched are left, because their rows lie in
    /// another sink, and a camera that was silent until now had nothing to do.
    pub fn request(&mut self, now_us: u64) {
        for camera in &mut self.cameras {
            (camera.hand, camera.has_started) = (None, false);
        }
        self.requested_us = Some(now_us);
        self.shot(now_us);
    }

    /// The cameras can send from now on: a silence that is as long as it takes to make them ready
    /// is none.
    pub fn shot(&mut self, now_us: u64) {
        for camera in &mut self.cameras {
            camera.tracker.request(now_us);
        }
    }

    /// Works through what has happened until there is something to report; `None` when there is no
    /// more. After a pair the sink is left alone until the next call.
    pub fn turn<R: RowRing>(
        &mut self,
        rings: &mut [R; 2],
        sink: &mut impl RowSink,
    ) -> Option<Report> {
        let [left_ring, right_ring] = rings;
        loop {
            let [left, right] = &mut self.cameras;
            if left.has_started && right.has_started && self.requested_us.take().is_some() {
                return Some(Report::Started);
            }
            // Before the signals are fetched: what comes later is no silence.
            let now_us = left_ring.now_us();
            left.signal = left.signal.or_else(|| left_ring.next_signal());
            right.signal = right.signal.or_else(|| right_ring.next_signal());
            let report = match (left.signal, right.signal) {
                (None, None) => return self.silence(now_us),
                (Some(signal), other)
                    if other.is_none_or(|other| signal.time_us() <= other.time_us()) =>
                {
                    left.signal = None;
                    self.take(CameraSide::Left, signal, left_ring, sink)
                }
                (_, Some(signal)) => {
                    right.signal = None;
                    self.take(CameraSide::Right, signal, right_ring, sink)
                }
                (Some(_), None) => None, // taken by the second arm
            };
            if report.is_some() {
                return report;
            }
        }
    }

    fn silence(&mut self, now_us: u64) -> Option<Report> {
        for eye in CameraSide::BOTH {
            let limits = self.limits;
            if let Some(fault) = self.camera(eye).tracker.silence(&limits, now_us) {
                return self.fault(eye, fault);
            }
        }
        None
    }

    fn take(
        &mut self,
        eye: CameraSide,
        signal: Signal,
        ring: &impl RowRing,
        sink: &mut impl RowSink,
    ) -> Option<Report> {
        let limits = self.limits;
        let (fault, progress) = self.camera(eye).tracker.take(&limits, signal);
        let report = fault.and_then(|fault| self.fault(eye, fault));
        match progress {
            Progress::None => report,
            Progress::Started { row, time_us } => {
                let is_requested =
                    self.requested_us.is_some_and(|requested_us| time_us >= requested_us);
                self.camera(eye).has_started |= is_requested;
                self.begin(eye, Hand { time_us, next: row, is_whole: false }, ring, sink);
                report
            }
            Progress::Rows { end, is_whole } => match self.fetch(eye, end, ring, sink) {
                Err(report) => report,
                Ok(()) if is_whole => self.end(eye, sink),
                Ok(()) => None,
            },
        }
    }

    /// Takes a frame in hand that has started.
    fn begin(&mut self, eye: CameraSide, hand: Hand, ring: &impl RowRing, sink: &mut impl RowSink) {
        let pair_us = u64::from(self.limits.pair_us);
        let is_alone = |other: &mut Hand| other.time_us.abs_diff(hand.time_us) > pair_us;
        let [left, right] = &mut self.cameras;
        let (own, other) = if eye == CameraSide::Left { (left, right) } else { (right, left) };
        let unpaired = [other.hand.take_if(is_alone), own.hand.take()];
        let count = unpaired.iter().flatten().count() as u32;
        self.losses.unpaired = self.losses.unpaired.saturating_add(count);
        if is_safe(hand.next, ring) {
            own.hand = Some(hand);
            sink.restart(eye);
        } else {
            self.losses.skipped = self.losses.skipped.saturating_add(1);
        }
    }

    /// Fetches the rows before `end` of the frame in hand, if there is one.
    fn fetch(
        &mut self,
        eye: CameraSide,
        end: u32,
        ring: &impl RowRing,
        sink: &mut impl RowSink,
    ) -> Result<(), Option<Report>> {
        let Some(Hand { mut next, .. }) = self.camera(eye).hand else { return Err(None) };
        while next != end {
            ring.copy(next, sink.row(eye));
            if !is_safe(next, ring) {
                return Err(self.fault(eye, Fault::TooSlow));
            }
            if let Err(error) = sink.push(eye) {
                self.camera(eye).hand = None;
                return Err(Some(Report::Refused(eye, error)));
            }
            next = next.wrapping_add(1);
        }
        if let Some(hand) = &mut self.camera(eye).hand {
            hand.next = next;
        }
        Ok(())
    }

    /// The frame in hand is whole; is the other one as well?
    fn end(&mut self, eye: CameraSide, sink: &impl RowSink) -> Option<Report> {
        if let Some(hand) = &mut self.camera(eye).hand {
            hand.is_whole = true;
        }
        let [left_camera, right_camera] = &mut self.cameras;
        let (left, right) = (left_camera.hand?, right_camera.hand?);
        if !left.is_whole || !right.is_whole {
            return None;
        }
        (left_camera.hand, right_camera.hand) = (None, None);
        let [left_us, right_us] = self.middle_us;
        let times_us = [
            left.time_us.saturating_add_signed(left_us.into()),
            right.time_us.saturating_add_signed(right_us.into()),
        ];
        let pair =
            |dims| CapturedPair { dims, times_us: Some(times_us), frame_start: Some(self.start) };
        Some(sink.complete().map_or(Report::Incomplete, |dims| Report::Pair(pair(dims))))
    }

    fn fault(&mut self, eye: CameraSide, fault: Fault) -> Option<Report> {
        self.camera(eye).hand = None;
        fault.count(eye, &mut self.losses);
        Some(Report::Fault(eye, fault))
    }

    fn camera(&mut self, eye: CameraSide) -> &mut Camera {
        of(eye, &mut self.cameras)
    }
}

/// Has nothing been written over this row yet, and is nothing being?
fn is_safe(row: u32, ring: &impl RowRing) -> bool {
    ring.written().wrapping_sub(row) < ring.rows()
}
