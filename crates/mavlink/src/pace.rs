//! When is the next message due? Time is an argument.

/// Lets one message pass per interval, without bursts after a pause.
///
/// ```
/// use linestereo_mavlink::Pace;
/// let mut pace = Pace::per_second(10);
/// assert!(pace.is_due(0) && !pace.is_due(99_999) && pace.is_due(100_000));
/// assert!(pace.is_due(5_000_000) && !pace.is_due(5_000_001)); // what was missed is not made up for
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    interval_us: u32,
    next_us: u64,
}

impl Pace {
    /// A rate of `messages` a second, at least one.
    #[must_use]
    pub const fn per_second(rate_hz: u8) -> Self {
        let interval_us = match rate_hz {
            0 => 1_000_000,
            rate_hz => 1_000_000 / rate_hz as u32,
        };
        Self { interval_us, next_us: 0 }
    }

    /// Is it time? If so, the next one is due an interval after this one was.
    #[must_use]
    pub fn is_due(&mut self, now_us: u64) -> bool {
        if now_us < self.next_us {
            return false;
        }
        let interval = u64::from(self.interval_us);
        let late = now_us.saturating_sub(self.next_us);
        // Little late: the rhythm is kept. Much too late: a new rhythm.
        let due = if late < interval { self.next_us } else { now_us };
        self.next_us = due.saturating_add(interval);
        true
    }
}
