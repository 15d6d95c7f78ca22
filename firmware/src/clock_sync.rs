//! The board's time in another clock: a host's or an autopilot's.
//!
//! In: offsets that a host has measured, answers of an autopilot to TIMESYNC. Out: times of capture
//! in that clock, and whose clock it is; questions to the autopilot.
//!
//! ```text
//! an offset                            counts at once, for 10 s; then the board's own clock does
//!                                      again
//! a host's                             counts before an autopilot's
//! an answer to the last question       the autopilot's time in the middle of the way, less than
//!                                      0.3 s long
//! ```
//!
//! # Bounds
//! The clocks of boards are within 1 % (an STM32H7 runs without a crystal): times are off by at
//! most 10 ms for each second since the last offset, and by half of the round trip in which it was
//! measured. A new offset moves times by as much.

use linestereo_mavlink::Timesync;
use linestereo_wire::TimeSource;

/// Older offsets do not count, microseconds.
const STALE_US: u64 = 10_000_000;
/// Between two questions, microseconds.
const ASK_EVERY_US: u64 = 1_000_000;
/// Longest round trip of a question that counts: some turns of the program, microseconds.
const ROUND_TRIP_US: u64 = 300_000;

/// Offset to another clock. Times are those of the clock of the pairs, microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClockSync {
    source: TimeSource,
    /// The other clock less the board's.
    offset_us: i64,
    measured_us: u64,
    /// When the autopilot was asked last.
    asked_us: Option<u64>,
}

impl ClockSync {
    /// The board's clock alone.
    pub const BOARD: Self =
        Self { source: TimeSource::Board, offset_us: 0, measured_us: 0, asked_us: None };

    /// Takes an offset that was measured now: the other clock less the board's, microseconds.
    pub fn set(&mut self, source: TimeSource, offset_us: i64, now_us: u64) {
        if source == TimeSource::Host || self.at(now_us).source != TimeSource::Host {
            *self = Self { source, offset_us, measured_us: now_us, ..*self };
        }
    }

    /// A time of the board's clock in the clock that counts then, and whose that is.
    pub fn stamp(&self, time_us: u64) -> (u64, TimeSource) {
        let Self { source, offset_us, .. } = self.at(time_us);
        (time_us.saturating_add_signed(offset_us), source)
    }

    /// The question that an autopilot is to be asked now.
    pub fn question(&mut self, now_us: u64) -> Option<Timesync> {
        if self.asked_us.is_some_and(|asked_us| now_us.saturating_sub(asked_us) < ASK_EVERY_US) {
            return None;
        }
        self.asked_us = Some(now_us);
        Some(Timesync { tc1: 0, ts1: nanoseconds(now_us) })
    }

    /// Takes a TIMESYNC of an autopilot: an answer to the last question; or a question, whose
    /// answer it gives.
    pub fn receive(&mut self, Timesync { tc1, ts1 }: Timesync, now_us: u64) -> Option<Timesync> {
        if tc1 == 0 {
            return Some(Timesync { tc1: nanoseconds(now_us), ts1 });
        }
        let asked_us = self.asked_us.filter(|&asked_us| nanoseconds(asked_us) == ts1)?;
        let round_trip_us = now_us.saturating_sub(asked_us);
        if round_trip_us <= ROUND_TRIP_US {
            let middle_us = asked_us.wrapping_add(round_trip_us / 2);
            let their_us = tc1.cast_unsigned() / 1000;
            self.set(TimeSource::Autopilot, their_us.wrapping_sub(middle_us).cast_signed(), now_us);
        }
        None
    }

    fn at(&self, now_us: u64) -> Self {
        if now_us.saturating_sub(self.measured_us) < STALE_US { *self } else { Self::BOARD }
    }
}

/// Microseconds as MAVLink's nanoseconds.
const fn nanoseconds(time_us: u64) -> i64 {
    time_us.wrapping_mul(1000).cast_signed()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOST: TimeSource = TimeSource::Host;
    const AUTOPILOT: TimeSource = TimeSource::Autopilot;

    #[test]
    fn an_offset_counts_at_once_and_then_for_ten_seconds() {
        let mut sync = ClockSync::BOARD;
        assert_eq!(sync.stamp(10), (10, TimeSource::Board));
        sync.set(HOST, 1_700_000_000_000_000, 1_000_000);
        assert_eq!(
            sync.stamp(900_000),
            (1_700_000_000_900_000, HOST),
            "captured before it was measured"
        );
        assert_eq!(sync.stamp(10_999_999).1, HOST);
        assert_eq!(sync.stamp(11_000_000), (11_000_000, TimeSource::Board), "stale");
        sync.set(HOST, -500, 20_000_000);
        assert_eq!(sync.stamp(20_000_000), (19_999_500, HOST));
        assert_eq!(sync.stamp(3).0, 0, "never below zero");
    }

    #[test]
    fn a_host_counts_before_an_autopilot() {
        let mut sync = ClockSync::BOARD;
        sync.set(AUTOPILOT, 100, 0);
        assert_eq!(sync.stamp(0), (100, AUTOPILOT));
        sync.set(HOST, 7_000_000, 1000);
        sync.set(AUTOPILOT, 100, 2000);
        assert_eq!(sync.stamp(2000), (7_002_000, HOST));
        sync.set(AUTOPILOT, 100, 10_001_000);
        assert_eq!(sync.stamp(10_001_000), (10_001_100, AUTOPILOT), "when the host has gone");
    }

    #[test]
    fn an_answer_counts_if_it_is_the_last_questions_and_soon() {
        let answer = |asked_us: u64, their_us: i64| Timesync {
            tc1: 1000 * their_us,
            ts1: nanoseconds(asked_us),
        };
        let mut sync = ClockSync::BOARD;
        assert_eq!(sync.question(5_000_000), Some(Timesync { tc1: 0, ts1: 5_000_000_000 }));
        assert_eq!(sync.question(5_999_999), None);
        for (asked_us, now_us) in [(4_999_999, 5_100_000), (5_000_000, 5_300_001)] {
            assert_eq!(sync.receive(answer(asked_us, 900), now_us), None);
            assert_eq!(sync.stamp(now_us).1, TimeSource::Board, "{asked_us} at {now_us}");
        }
        // The autopilot is younger than the board: 2 s when the board has 5.1.
        sync.receive(answer(5_000_000, 2_000_000), 5_200_000);
        assert_eq!(sync.stamp(5_100_000), (2_000_000, AUTOPILOT));
        assert!(sync.question(6_000_000).is_some());
        // A question of the autopilot.
        let asked = Timesync { tc1: 0, ts1: -77 };
        assert_eq!(sync.receive(asked, 3), Some(Timesync { tc1: 3000, ts1: -77 }));
    }
}
