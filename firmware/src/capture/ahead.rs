//! Two cameras as the source of pairs that are captured while the ones before them are worked on.
//!
//! ```text
//! call       rows of the pair that is on its way, as in [`CameraSource`]; follow; the trigger of
//!            the next pair is set to a time; the pair is handed on
//! work on it meanwhile the sensors are triggered and expose, and if the work takes longer than
//!     expected DMA fills the ring
//! when       so that the next frame starts when the work ends: as long after its trigger as this
//!            one's; of work as long as the shorter of the last two
//! ```
//! Rows then come when somebody rectifies them, and a pair is no older than one whose trigger waits
//! for the work before it. In the model of the Portenta (matching 28 ms, exposure 6, readout 7,
//! rectifying 11) pairs follow each other in 40.0 ms, without it in 46.0 ms; their results are with
//! a host on USB 43.1 ms after the exposure in both. Triggered at once they come 0.6 ms sooner,
//! each 26 ms older. A frame that starts late costs time, one that starts early only age: hence the
//! shorter of two works, so that a rig that is stored meanwhile delays nothing.
//!
//! Sensors see the same order as without this: trigger, frame, exposure, trigger. No row is fetched
//! outside of a call, so that its rig and its sink are those of the call. After a pair that is
//! missing nothing is triggered ahead: there is no work, and perhaps a sensor to start.
//!
//! # Bounds
//! A ring that holds more rows than a frame has loses nothing, however long the work takes. With a
//! smaller one such pairs are missing, by name.

use super::{CameraSource, FrameRows, MemoryRows, RowRing, RowSink};
use crate::memory::Memory;
use crate::ports::{CapturedPair, PairSource, TimedCameras};
use linestereo::Dims;
use linestereo_wire::CaptureReport;

/// Waits for the pair that is on its way, for a while, and sets the trigger of the next one.
#[derive(Debug)]
pub struct AheadSource<R, C> {
    source: CameraSource<R, C>,
    /// The pair that nobody has asked for yet.
    next: Option<Shot>,
    /// Times that the last two works took of which it is known, microseconds.
    work_us: [u64; 2],
}

/// Times of a pair, microseconds.
#[derive(Clone, Copy, Debug)]
struct Shot {
    /// When the one before it was handed on.
    handed_us: u64,
    trigger_us: u64,
}

impl<R: RowRing, C: TimedCameras> AheadSource<R, C> {
    /// Nothing is triggered before the first call.
    pub const fn new(source: CameraSource<R, C>) -> Self {
        Self { source, next: None, work_us: [0; 2] }
    }

    /// The next pair, into this sink.
    fn fetch(&mut self, rows: &mut impl RowSink) -> Option<CapturedPair> {
        let Self { source, next, work_us } = self;
        let asked_us = source.now_us();
        // For a call that did not come, because nobody wanted pairs or the flash was written: what
        // it shows is past, and its rows leave the ring.
        let patience_us = u64::from(source.patience_us);
        if let Some(past) =
            next.take_if(|shot| asked_us.saturating_sub(shot.trigger_us) > patience_us)
        {
            let _ = source.receive(true, past.trigger_us, rows);
            source.follow(true);
        }
        let (is_shot, trigger_us) = match next.take() {
            Some(Shot { handed_us, trigger_us }) => {
                *work_us = [work_us[1], asked_us.saturating_sub(handed_us)];
                (true, trigger_us)
            }
            None => (source.shoot(), source.now_us()),
        };
        let pair = source.receive(is_shot, trigger_us, rows);
        let start_us = pair.and_then(|pair| source.capture.start_us(&pair));
        source.follow(is_shot);

        let until_start_us = start_us?.saturating_sub(trigger_us);
        let handed_us = source.now_us();
        let [before_us, last_us] = *work_us;
        let trigger_us =
            handed_us.saturating_add(before_us.min(last_us).saturating_sub(until_start_us));
        source.capture.request(handed_us);
        *next = source.cameras.shoot_at(trigger_us).then_some(Shot { handed_us, trigger_us });
        pair
    }
}

impl<R: RowRing, C: TimedCameras> PairSource for AheadSource<R, C> {
    fn next_pair(
        &mut self,
        memory: &mut impl Memory,
        rectified: Option<Dims>,
    ) -> Option<CapturedPair> {
        match rectified {
            Some(dims) => self.fetch(&mut MemoryRows::new(memory, dims)),
            None => {
                let dims = self.source.dims;
                self.fetch(&mut FrameRows::new(memory.frames(), dims))
            }
        }
    }

    fn raw_dims(&self) -> Option<Dims> {
        self.source.raw_dims()
    }

    fn clock_us(&self) -> Option<u64> {
        self.source.clock_us()
    }

    fn still_us(&self) -> Option<u32> {
        self.source.still_us()
    }

    fn losses(&self) -> Option<CaptureReport> {
        self.source.losses()
    }
}
