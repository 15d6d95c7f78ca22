//! What a frame suffered, as a set of flags.
//!
//! In: what the board saw, and the core's counts. Out: 16 bits, of which the unnamed ones are left for later and survive the journey.

use core::fmt;
use core::ops::{BitOr, BitOrAssign};
use linestereo::Counts;
use serde::{Deserialize, Serialize};

/// A set of flags; empty when there is nothing to say.
///
/// ```
/// use linestereo_wire::Health;
/// let health = Health::SEGMENTS_DROPPED | Health::RESULTS_SKIPPED;
/// assert!(health.contains(Health::RESULTS_SKIPPED) && !health.contains(Health::POINTS_DROPPED));
/// assert!(health.names().eq(["segments_dropped", "results_skipped"]));
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Health(u16);

impl Health {
    /// Nothing to say.
    pub const GOOD: Self = Self(0);
    /// The pair was refused: its size is not the planned one.
    pub const SIZE_MISMATCH: Self = Self(1);
    /// A list of detected segments was full.
    pub const SEGMENTS_DROPPED: Self = Self(1 << 1);
    /// The list of matches was full.
    pub const MATCHES_DROPPED: Self = Self(1 << 2);
    /// The list of points was full.
    pub const POINTS_DROPPED: Self = Self(1 << 3);
    /// Results between the last record and this one were not sent: the port is slower than the board.
    pub const RESULTS_SKIPPED: Self = Self(1 << 4);
    /// The camera delivered no whole pair for this frame.
    pub const PAIR_MISSING: Self = Self(1 << 5);

    /// Every flag with its name.
    pub const NAMES: [(Self, &'static str); 6] = [
        (Self::SIZE_MISMATCH, "size_mismatch"),
        (Self::SEGMENTS_DROPPED, "segments_dropped"),
        (Self::MATCHES_DROPPED, "matches_dropped"),
        (Self::POINTS_DROPPED, "points_dropped"),
        (Self::RESULTS_SKIPPED, "results_skipped"),
        (Self::PAIR_MISSING, "pair_missing"),
    ];

    /// The flags that follow from what the core counted: its full lists.
    #[must_use]
    pub fn of(counts: &Counts) -> Self {
        let flag = |is_set: bool, flag: Self| if is_set { flag } else { Self::GOOD };
        flag(counts.segments_left_dropped > 0 || counts.segments_right_dropped > 0, Self::SEGMENTS_DROPPED)
            | flag(counts.matches_dropped > 0, Self::MATCHES_DROPPED)
            | flag(counts.points_dropped > 0, Self::POINTS_DROPPED)
    }

    /// The set as bits.
    #[must_use]
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// A set from bits; unnamed ones are kept.
    #[must_use]
    pub const fn from_bits(bits: u16) -> Self {
        Self(bits)
    }

    /// Whether all flags of `other` are set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The names of the flags that are set, in the order of [`Health::NAMES`].
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::NAMES.into_iter().filter(move |&(flag, _)| self.contains(flag)).map(|(_, name)| name)
    }

    /// The flags that have no name in this version.
    #[must_use]
    pub fn unnamed(self) -> Self {
        Self(Self::NAMES.iter().fold(self.0, |bits, (flag, _)| bits & !flag.0))
    }
}

impl BitOr for Health {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Health {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

/// The names with `+` between them, unnamed flags as a number, `good` when empty.
impl fmt::Display for Health {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::GOOD {
            return f.write_str("good");
        }
        let mut separator = "";
        for name in self.names() {
            write!(f, "{separator}{name}")?;
            separator = "+";
        }
        match self.unnamed() {
            Self::GOOD => Ok(()),
            Self(bits) => write!(f, "{separator}{bits:#06x}"),
        }
    }
}

impl fmt::Debug for Health {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Health({self})")
    }
}
