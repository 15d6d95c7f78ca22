//! Faults of a frame, as a set of flags, and the numbers behind them.
//!
//! In: what the board saw, the core's counts and its [`PairHealth`]. Out: 32 bits, of which the unnamed ones are left for later and survive
//! the journey, and a [`PairReport`].
//!
//! ```text
//! bits 0 ..= 7    the board and its port, named here
//! bits 8 ..= 31   the core's HealthFlags, moved up by 8
//! ```

use core::fmt;
use core::ops::{BitOr, BitOrAssign};
use linestereo::health::{CameraHealth, RangeCheck, Rows, Still, Tear};
use linestereo::{Counts, HealthFlags, PairHealth};
use serde::{Deserialize, Serialize};

/// Where the core's flags begin.
const CORE: u32 = 8;
/// Flags of the board.
const BOARD: [(Health, &str); 5] = [
    (Health::SIZE_MISMATCH, "size_mismatch"),
    (Health::SEGMENTS_DROPPED, "segments_dropped"),
    (Health::RESULTS_SKIPPED, "results_skipped"),
    (Health::PAIR_MISSING, "pair_missing"),
    (Health::FREE_RUNNING, "free_running"),
];

/// A set of flags; empty for a pair without a defect.
///
/// ```
/// use linestereo::HealthFlags;
/// use linestereo_wire::Health;
/// let health = Health::SEGMENTS_DROPPED | Health::from(HealthFlags::ROWS_OFF);
/// assert!(health.contains(Health::SEGMENTS_DROPPED) && !health.contains(Health::RESULTS_SKIPPED));
/// assert!(health.names().eq(["segments_dropped", "rows_off"]));
/// assert_eq!(health.of_pair(), HealthFlags::ROWS_OFF);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Health(u32);

impl Health {
    /// No flag.
    pub const GOOD: Self = Self(0);
    /// The pair was refused: its size is not the planned one.
    pub const SIZE_MISMATCH: Self = Self(1);
    /// A list of detected segments was full, or a budget of work for edges or comparisons was spent.
    pub const SEGMENTS_DROPPED: Self = Self(1 << 1);
    /// Results between the last record and this one were not sent: the port is slower than the board.
    pub const RESULTS_SKIPPED: Self = Self(1 << 4);
    /// The camera delivered no whole pair for this frame.
    pub const PAIR_MISSING: Self = Self(1 << 5);
    /// The cameras are not triggered together: how far apart a pair's images are is chance, and differs from pair to pair.
    pub const FREE_RUNNING: Self = Self(1 << 6);

    /// Every flag with its name: the board's, then the core's.
    pub const NAMES: [(Self, &'static str); BOARD.len() + HealthFlags::NAMES.len()] = {
        let mut names = [(Self::GOOD, ""); BOARD.len() + HealthFlags::NAMES.len()];
        let (boards, mut cores) = names.split_at_mut(BOARD.len());
        boards.copy_from_slice(&BOARD);
        let mut flags = HealthFlags::NAMES.as_slice();
        while let ([name, after @ ..], [(flag, text), flags_after @ ..]) = (cores, flags) {
            *name = (Self(flag.bits() << CORE), text);
            (cores, flags) = (after, flags_after);
        }
        names
    };

    /// The flags that follow from what the core counted: full lists, and work left out.
    #[must_use]
    pub fn of(counts: &Counts) -> Self {
        if counts.is_cut() { Self::SEGMENTS_DROPPED } else { Self::GOOD }
    }

    /// The core's flags among them.
    #[must_use]
    pub const fn of_pair(self) -> HealthFlags {
        HealthFlags::from_bits(self.0 >> CORE)
    }

    /// The set as bits.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// A set from bits; unnamed ones are kept.
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// True when all flags of `other` are set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The flags that are not in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
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

impl From<HealthFlags> for Health {
    fn from(flags: HealthFlags) -> Self {
        Self(flags.bits() << CORE)
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
            Self(bits) => write!(f, "{separator}{bits:#010x}"),
        }
    }
}

/// As [`Display`](fmt::Display).
#[cfg(feature = "defmt")]
impl defmt::Format for Health {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{}", defmt::Display2Format(self));
    }
}

impl fmt::Debug for Health {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Health({self})")
    }
}

/// The numbers of a [`PairHealth`]; its flags are in the [`Health`] beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PairReport {
    /// Left and right camera.
    pub cameras: [CameraReport; 2],
    /// [`PairHealth::skew_us`].
    pub skew_us: Option<u32>,
    /// [`PairHealth::rows`].
    pub rows: Option<RowsReport>,
    /// [`PairHealth::row_offset_q8`], 1/256 px.
    pub row_offset_q8: Option<i16>,
    /// [`PairHealth::row_drift_q8`], 1/256 px.
    pub row_drift_q8: Option<i16>,
    /// [`PairHealth::least_disparity_q6`], 1/64 px.
    pub least_disparity_q6: Option<i16>,
    /// [`PairHealth::range`].
    pub range: Option<RangeReport>,
    /// [`PairHealth::still`].
    pub still: Option<StillReport>,
    /// [`PairHealth::tear`].
    pub tear: Option<TearReport>,
}

/// The core's [`Still`], number for number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StillReport {
    /// Credible support points without parallax, per thousand.
    pub still_permille: u16,
    /// Likeness of both images at the same pixels, per thousand.
    pub pattern_permille: i16,
}

/// The core's [`Tear`], number for number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TearReport {
    /// The last row above it, px.
    pub row: u16,
    /// Change of the disparities below it, px.
    pub shift: i16,
}

/// The core's [`RangeCheck`], number for number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RangeReport {
    /// Windows compared with disparities beyond the range.
    pub windows: u16,
    /// Those that match better there.
    pub beyond: u16,
    /// The second largest disparity at which these match, px.
    pub disparity: u16,
}

/// The core's [`CameraHealth`], number for number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CameraReport {
    /// Mean grey level.
    pub level: u8,
    /// Mean grey step between neighbouring samples, 1/16.
    pub detail_q4: u16,
    /// Black samples per thousand.
    pub black_permille: u16,
    /// White samples per thousand.
    pub white_permille: u16,
    /// Usable pixels per thousand.
    pub view_permille: u16,
}

/// The core's [`Rows`], number for number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RowsReport {
    /// Row in the right image minus row in the left one, 1/256 px.
    pub offset_q8: i16,
    /// Spread, 1/256 px.
    pub spread_q8: u16,
    /// Matches behind it.
    pub samples: u8,
}

impl From<&PairHealth> for PairReport {
    fn from(health: &PairHealth) -> Self {
        let camera = |&CameraHealth { level, detail_q4, black_permille, white_permille, view_permille }: &_| {
            CameraReport { level, detail_q4, black_permille, white_permille, view_permille }
        };
        let range = |RangeCheck { windows, beyond, disparity, .. }| RangeReport { windows, beyond, disparity };
        let rows = |Rows { offset_q8, spread_q8, samples }| RowsReport { offset_q8, spread_q8, samples };
        Self {
            cameras: health.cameras.each_ref().map(camera),
            skew_us: health.skew_us,
            rows: health.rows.map(rows),
            row_offset_q8: health.row_offset_q8,
            row_drift_q8: health.row_drift_q8,
            least_disparity_q6: health.least_disparity_q6,
            range: health.range.map(range),
            still: health
                .still
                .map(|Still { still_permille, pattern_permille }| StillReport { still_permille, pattern_permille }),
            tear: health.tear.map(|Tear { row, shift }| TearReport { row, shift }),
        }
    }
}
