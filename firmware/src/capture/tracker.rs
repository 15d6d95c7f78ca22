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

/// The state of one camera's stream; at first in the middle of nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tracker {
    phase: Phase,
    /// Number of the row after the last one.
    end: u32,
    /// Time of the last signal.
    last_us: Option<u64>,
    /// Before this time nothing was requested.
    requested_us: u64,
}

#[derive(Clone, Copy, Debug, Default)]
enum Phase {
    #[default]
    Lost,
    Frame {
        rows: u32,
    },
    Whole,
    Silent,
}

/// Meaning of a signal.
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
    /// Takes a signal. A fault and the start of a frame can come together.
    pub(super) fn take(&mut self, limits: &Limits, signal: Signal) -> (Option<Fault>, Progress) {
        match signal {
            Signal::FrameStart { time_us, row } => {
                let is_early = matches!(self.phase, Phase::Frame { .. });
                (self.phase, self.end, self.last_us) =
                    (Phase::Frame { rows: 0 }, row, Some(time_us));
                (is_early.then_some(Fault::EarlyVsync), Progress::Started { row, time_us })
            }
            Signal::Rows { end, bytes, time_us } => {
                let pause_us = self.last_us.map_or(0, |last| time_us.saturating_sub(last));
                let rows = end.wrapping_sub(self.end);
                (self.end, self.last_us) = (end, Some(time_us));
                match self.rows(limits, rows, bytes, pause_us > u64::from(limits.row_gap_us)) {
                    Ok(progress) => (
                        None,
                        progress
                            .map_or(Progress::None, |is_whole| Progress::Rows { end, is_whole }),
                    ),
                    Err(fault) => {
                        self.phase = Phase::Lost;
                        (Some(fault), Progress::None)
                    }
                }
            }
            Signal::Overrun { time_us } => {
                self.last_us = Some(time_us);
                self.phase = Phase::Lost;
                (Some(Fault::Overrun), Progress::None)
            }
            Signal::Lost => {
                (self.phase, self.last_us) = (Phase::Lost, None);
                (Some(Fault::TooSlow), Progress::None)
            }
        }
    }

    /// Rows of the frame: were these the last ones? `None`: they belong to no frame.
    fn rows(
        &mut self,
        limits: &Limits,
        rows: u32,
        bytes: u32,
        is_after_pause: bool,
    ) -> Result<Option<bool>, Fault> {
        match self.phase {
            Phase::Silent => Err(Fault::MissingVsync),
            Phase::Lost if is_after_pause => Err(Fault::MissingVsync),
            Phase::Lost => Ok(None),
            Phase::Whole => Err(Fault::MissingVsync),
            Phase::Frame { rows: before } if before > 0 && is_after_pause => Err(Fault::TornFrame),
            Phase::Frame { .. } if rows.checked_mul(limits.row_bytes.into()) != Some(bytes) => {
                Err(Fault::ShortLine)
            }
            Phase::Frame { rows: before } => {
                let rows = before.saturating_add(rows);
                let all = u32::from(limits.rows);
                if rows > all {
                    return Err(Fault::MissingVsync);
                }
                self.phase = if rows == all { Phase::Whole } else { Phase::Frame { rows } };
                Ok(Some(rows == all))
            }
        }
    }

    /// A frame is requested: silence before now is none of the camera's.
    pub(super) fn request(&mut self, now_us: u64) {
        self.requested_us = now_us;
    }

    /// After all signals of now: has a frame ended before its last row? The start of the next one
    /// is what tells others.
    pub(super) fn has_ended_early(&self, limits: &Limits, now_us: u64) -> bool {
        let pause_us = self.last_us.map_or(0, |last_us| now_us.saturating_sub(last_us));
        matches!(self.phase, Phase::Frame { rows: 1.. }) && pause_us > u64::from(limits.row_gap_us)
    }

    /// After all signals of now: has the camera stopped? Said once.
    pub(super) fn silence(&mut self, limits: &Limits, now_us: u64) -> Option<Fault> {
        let last_us = (*self.last_us.get_or_insert(now_us)).max(self.requested_us);
        if matches!(self.phase, Phase::Silent)
            || now_us.saturating_sub(last_us) <= u64::from(limits.silence_us)
        {
            return None;
        }
        self.phase = Phase::Silent;
        Some(Fault::Stopped)
    }
}
