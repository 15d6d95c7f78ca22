//! State of a board beside its results: why it was reset, and what its cameras lost.

use core::fmt;
use serde::{Deserialize, Serialize};

/// Why a board was reset, as far as it knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reset {
    /// Why.
    pub cause: ResetCause,
    /// Of a fault, the address of the instruction, for `addr2line`; of a panic, the line in its
    /// source file; 0 when it is not known.
    pub location: u32,
}

/// Cause of a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ResetCause {
    /// Power came.
    PowerOn,
    /// The supply was too low for a while.
    BrownOut,
    /// The reset pin, or a debugger.
    Pin,
    /// No frame was finished for longer than the watchdog allows.
    Watchdog,
    /// The program's own reset.
    Software,
    /// The program panicked.
    Panic,
    /// The processor refused an instruction or an address.
    Fault,
    /// The stack grew out of its memory.
    StackOverflow,
    /// The board does not say.
    Unknown,
}

impl Reset {
    /// For this cause, nowhere in particular.
    #[must_use]
    pub const fn of(cause: ResetCause) -> Self {
        Self { cause, location: 0 }
    }
}

impl fmt::Display for Reset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.cause {
            ResetCause::PowerOn => "power on",
            ResetCause::BrownOut => "brown-out: the supply was too low",
            ResetCause::Pin => "the reset pin or a debugger",
            ResetCause::Watchdog => "the watchdog: no frame was finished in time",
            ResetCause::Software => "the program asked for it",
            ResetCause::Panic => "the program panicked",
            ResetCause::Fault => "the processor refused an instruction or an address",
            ResetCause::StackOverflow => "the stack grew out of its memory",
            ResetCause::Unknown => "unknown",
        })?;
        match (self.cause, self.location) {
            (_, 0) => Ok(()),
            (ResetCause::Panic, line) => write!(f, " in line {line} of a source file"),
            (_, address) => write!(f, " at address {address:#010x}"),
        }
    }
}

/// Clock of a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TimeSource {
    /// The board's: microseconds since it started.
    Board,
    /// The host's, by the offset that it has set in the last 10 s.
    Host,
    /// The autopilot's, by TIMESYNC in the last 10 s.
    Autopilot,
}

impl TimeSource {
    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Board => "board",
            Self::Host => "host",
            Self::Autopilot => "autopilot",
        }
    }
}

/// Kinds of faults of a camera's frame.
const KINDS: usize = 7;

/// Losses of the cameras since the board was reset. Every number stays at its largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CaptureReport {
    /// Faulty frames of the left and the right camera, in the order of [`CaptureReport::KINDS`].
    pub faults: [[u32; KINDS]; 2],
    /// Whole frames whose partner was missing.
    pub unpaired: u32,
    /// Frames that came while the last pair was still worked on.
    pub skipped: u32,
    /// How often the left and the right sensor did not do what was written to it.
    pub sensors: [u32; 2],
}

impl CaptureReport {
    /// The kinds of faults.
    pub const KINDS: [&str; KINDS] = [
        "overrun", "missing_vsync", "early_vsync", "short_line", "torn_frame", "stopped",
        "too_slow",
    ];

    /// Has nothing been lost?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Such as `left: torn_frame 2; right: stopped 1; unpaired 3`; `nothing` when nothing was.
impl fmt::Display for CaptureReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("nothing");
        }
        let mut separator = "";
        for (name, (faults, sensor)) in
            ["left", "right"].into_iter().zip(self.faults.iter().zip(self.sensors))
        {
            let all = Self::KINDS.into_iter().zip(*faults).chain([("sensor", sensor)]);
            let mut before = (separator, name, ": ");
            for (kind, count) in all.filter(|&(_, count)| count > 0) {
                write!(f, "{}{}{}{kind} {count}", before.0, before.1, before.2)?;
                before = (", ", "", "");
                separator = "; ";
            }
        }
        for (name, count) in [("unpaired", self.unpaired), ("skipped", self.skipped)]
            .into_iter()
            .filter(|of| of.1 > 0)
        {
            write!(f, "{separator}{name} {count}")?;
            separator = "; ";
        }
        Ok(())
    }
}
