//! Codes of a board's light: cause of the reset, state of the pairs.
//!
//! In: why the board was reset, how its pairs are, the time. Out: lit or dark. Driven once a turn:
//! a light that does not change any more is a program that does not either.
//!
//! ```text
//! n flashes, pause    in the first 8 s after a reset by the watchdog (2), a panic (3), a fault
//!                     (4), a stack overflow (5), a brown-out (6)
//! short flash         every 3 s: nobody wants pairs
//! on, short gap       every 3 s: pairs come and are fit
//! 1 s on, 1 s off     pairs come, and are not fit or refused: look at their health
//! 1/4 s on, 1/4 s off no pair comes
//! ```
//! The shortest part is longer than the longest turn, 150 ms while a camera is waited for.

use linestereo_wire::{Health, ResetCause};

/// How pairs are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Nobody wants any.
    Waiting,
    /// None comes.
    Missing,
    /// They are not fit to be used, or refused.
    Unfit,
    /// They are fit.
    Fit,
}

impl Status {
    /// Of a frame with this health.
    pub fn of(health: Health) -> Self {
        if health.contains(Health::PAIR_MISSING) {
            Self::Missing
        } else if health.contains(Health::SIZE_MISMATCH) || !health.of_pair().is_fit() {
            Self::Unfit
        } else {
            Self::Fit
        }
    }
}

/// For so long after a start the light tells the cause of the reset, ms.
const CAUSE_MS: u32 = 8000;
/// Half of a flash and its pause, ms.
const FLASH_MS: u32 = 250;

/// True when the light is on, so many milliseconds after the start. They may wrap: the cause is
/// told again after 49 days.
pub fn is_lit(reset: Option<ResetCause>, status: Status, time_ms: u32) -> bool {
    let flashes = reset.map_or(0, flashes);
    if flashes > 0 && time_ms < CAUSE_MS {
        let step = time_ms % (CAUSE_MS / 2) / FLASH_MS; // twice: 16 steps hold 6 flashes and a pause
        return step < 2 * flashes && step.is_multiple_of(2);
    }
    let is_start = time_ms % 3000 < FLASH_MS;
    match status {
        Status::Waiting => is_start,
        Status::Fit => !is_start,
        Status::Unfit => (time_ms / 1000).is_multiple_of(2),
        Status::Missing => (time_ms / FLASH_MS).is_multiple_of(2),
    }
}

/// Flashes for a cause; 0 for what is no fault.
const fn flashes(cause: ResetCause) -> u32 {
    match cause {
        ResetCause::Watchdog => 2,
        ResetCause::Panic => 3,
        ResetCause::Fault => 4,
        ResetCause::StackOverflow => 5,
        ResetCause::BrownOut => 6,
        ResetCause::PowerOn | ResetCause::Pin | ResetCause::Software | ResetCause::Unknown => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::health::HealthFlags;

    /// Starts and lengths of light in ms, over some time.
    fn lights(
        reset: Option<ResetCause>,
        status: Status,
        times: core::ops::Range<u32>,
    ) -> Vec<(u32, u32)> {
        let mut found: Vec<(u32, u32)> = Vec::new();
        for ms in times.filter(|&ms| is_lit(reset, status, ms)) {
            match found.last_mut() {
                Some((start, length)) if *start + *length == ms => *length += 1,
                _ => found.push((ms, 1)),
            }
        }
        found
    }

    #[test]
    fn every_status_has_its_own_light() {
        assert_eq!(lights(None, Status::Waiting, 0..6000), [(0, 250), (3000, 250)]);
        assert_eq!(lights(None, Status::Fit, 0..6000), [(250, 2750), (3250, 2750)]);
        assert_eq!(lights(None, Status::Unfit, 0..4000), [(0, 1000), (2000, 1000)]);
        assert_eq!(lights(None, Status::Missing, 0..1000), [(0, 250), (500, 250)]);
    }

    #[test]
    fn a_fault_is_told_twice_and_then_never_again() {
        use ResetCause::*;
        for (cause, flashes) in
            [(Watchdog, 2), (Panic, 3), (Fault, 4), (StackOverflow, 5), (BrownOut, 6)]
        {
            for start in [0, 4000] {
                let expected: Vec<_> =
                    (0..flashes).map(|flash| (start + 500 * flash, 250)).collect();
                assert_eq!(
                    lights(Some(cause), Status::Fit, start..start + 4000),
                    expected,
                    "{cause:?}"
                );
            }
            let times = 8000..20_000;
            assert_eq!(
                lights(Some(cause), Status::Fit, times.clone()),
                lights(None, Status::Fit, times)
            );
        }
        for cause in [PowerOn, Pin, Software, Unknown] {
            assert_eq!(
                lights(Some(cause), Status::Fit, 0..9000),
                lights(None, Status::Fit, 0..9000),
                "{cause:?}"
            );
        }
    }

    #[test]
    fn the_status_is_that_of_the_frame() {
        let unfit = Health::from(HealthFlags::LEFT_COVERED);
        let warned = Health::from(HealthFlags::ROWS_DRIFT) | Health::RESULTS_SKIPPED;
        let cases = [
            (Health::GOOD, Status::Fit),
            (warned, Status::Fit),
            (unfit, Status::Unfit),
            (Health::SIZE_MISMATCH, Status::Unfit),
            (unfit | Health::PAIR_MISSING, Status::Missing),
        ];
        for (health, status) in cases {
            assert_eq!(Status::of(health), status, "{health}");
        }
    }
}
