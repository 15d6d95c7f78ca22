//! The signals of one camera, held against what frames have to be like.
//!
//! ```text
//! Lost     rows belong to no frame                     a pause between rows without a start: MissingVsync
//! Frame    rows are counted                            start before the last row: EarlyVsync   a pause: TornFrame   wrong length: ShortLine
//! Whole    all rows have come                          more rows: MissingVsync
//! Silent   nothing has come for long (Stopped)         rows: MissingVsync
//! any      FrameStart -> Frame                         Overrun, Lost signals -> Lost
//! ```
//! It goes on whether frames are used or not, so that every fault counts.

use super::{Fault, Limits, Signal};

/// The state of one camera's stream.
#[derive(Clone, Copy, Debug)]
pub struct Tracker {
    place: Place,
    /// Number of the row after the last one.
    end: u32,
    /// Time of the last signal.
    last_us: Option<u64>,
    /// Before this time nothing was asked for.
    asked_us: u64,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Lost,
    Frame { rows: u32 },
    Whole,
    Silent,
}

/// What a signal means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    None,
    /// A frame starts with this row.
    Started {
        row: u32,
        time_us: u64,
    },
    /// Its rows up to this one are complete; these were all, or not.
    Rows {
        end: u32,
        is_whole: bool,
    },
}

impl Tracker {
    /// In the middle of nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { place: Place::Lost, end: 0, last_us: None, asked_us: 0 }
    }

    /// Takes a signal. A fault and the start of a frame can come together.
    pub(super) fn take(&mut self, limits: &Limits, signal: Signal) -> (Option<Fault>, Progress) {
        match signal {
            Signal::FrameStart { time_us, row } => {
                let is_early = matches!(self.place, Place::Frame { .. });
                (self.place, self.end, self.last_us) = (Place::Frame { rows: 0 }, row, Some(time_us));
                (is_early.then_some(Fault::EarlyVsync), Progress::Started { row, time_us })
            }
            Signal::Rows { end, bytes, time_us } => {
                let pause_us = self.last_us.map_or(0, |last| time_us.saturating_sub(last));
                let rows = end.wrapping_sub(self.end);
                (self.end, self.last_us) = (end, Some(time_us));
                match self.rows(limits, rows, bytes, pause_us > u64::from(limits.row_gap_us)) {
                    Ok(progress) => {
                        (None, progress.map_or(Progress::None, |is_whole| Progress::Rows { end, is_whole }))
                    }
                    Err(fault) => {
                        self.place = Place::Lost;
                        (Some(fault), Progress::None)
                    }
                }
            }
            Signal::Overrun { time_us } => {
                self.last_us = Some(time_us);
                self.place = Place::Lost;
                (Some(Fault::Overrun), Progress::None)
            }
            Signal::Lost => {
                (self.place, self.last_us) = (Place::Lost, None);
                (Some(Fault::TooSlow), Progress::None)
            }
        }
    }

    /// Rows of the frame: were these the last ones? `None`: they belong to no frame.
    fn rows(&mut self, limits: &Limits, rows: u32, bytes: u32, is_after_pause: bool) -> Result<Option<bool>, Fault> {
        match self.place {
            Place::Silent => Err(Fault::MissingVsync),
            Place::Lost if is_after_pause => Err(Fault::MissingVsync),
            Place::Lost => Ok(None),
            Place::Whole => Err(Fault::MissingVsync),
            Place::Frame { rows: before } if before > 0 && is_after_pause => Err(Fault::TornFrame),
            Place::Frame { .. } if rows.checked_mul(limits.row_bytes.into()) != Some(bytes) => Err(Fault::ShortLine),
            Place::Frame { rows: before } => {
                let rows = before.saturating_add(rows);
                let all = u32::from(limits.rows);
                if rows > all {
                    return Err(Fault::MissingVsync);
                }
                self.place = if rows == all { Place::Whole } else { Place::Frame { rows } };
                Ok(Some(rows == all))
            }
        }
    }

    /// A frame is asked for: silence before now is none of the camera's.
    pub(super) fn ask(&mut self, now_us: u64) {
        self.asked_us = now_us;
    }

    /// After all signals of now: has the camera stopped? Said once.
    pub(super) fn silence(&mut self, limits: &Limits, now_us: u64) -> Option<Fault> {
        let last_us = (*self.last_us.get_or_insert(now_us)).max(self.asked_us);
        if matches!(self.place, Place::Silent) || now_us.saturating_sub(last_us) <= u64::from(limits.silence_us) {
            return None;
        }
        self.place = Place::Silent;
        Some(Fault::Stopped)
    }
}

impl Default for Tracker {
    fn default() -> Self {
        Self::new()
    }
}
