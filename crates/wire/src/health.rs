//! Faults of a frame, as a set of flags, and the numbers behind them.
//!
//! In: what the board saw, the core's counts and its [`PairHealth`]. Out: 32 bits, of which the
//! unnamed ones are left for later and survive the journey, and a [`PairReport`].
//!
//! ```text
//! bits 0 ..= 7    the board and its port, named here
//! bits 8 ..= 31   the core's HealthFlags, moved up by 8
//! ```

use core::fmt;
use linestereo::health::{
    CameraHealth, HealthFlags, Noise, PairHealth, RangeCheck, Rows, Still, Tear,
};
use linestereo::results::Counts;
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

bitflags::bitflags! {
    /// A set of flags; empty for a pair without a defect.
    ///
    /// ```
    /// use linestereo::health::HealthFlags;
    /// use linestereo_wire::Health;
    /// let health = Health::SEGMENTS_DROPPED | Health::from(HealthFlags::ROWS_OFF);
    /// assert!(health.contains(Health::SEGMENTS_DROPPED) && !health.contains(Health::RESULTS_SKIPPED));
    /// assert!(health.names().eq(["segments_dropped", "rows_off"]));
    /// assert_eq!(health.of_pair(), HealthFlags::ROWS_OFF);
    /// ```
    #[derive(Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    pub struct Health: u32 {
        /// The pair was refused: its size is not the planned one.
        const SIZE_MISMATCH = 1;
        /// A list of detected segments was full, or a budget of work for edges or comparisons was
        /// spent.
        const SEGMENTS_DROPPED = 1 << 1;
        /// Results between the last record and this one were not sent: the port is slower than the
        /// board.
        const RESULTS_SKIPPED = 1 << 4;
        /// The camera delivered no whole pair for this frame.
        const PAIR_MISSING = 1 << 5;
        /// The cameras are not triggered together: how far apart a pair's images are is chance, and
        /// differs from pair to pair.
        const FREE_RUNNING = 1 << 6;
        // The core's flags, and those of later versions.
        const _ = !0;
    }
}

impl Health {
    /// No flag.
    pub const GOOD: Self = Self::empty();

    /// Every flag with its name: the board's, then the core's.
    pub const NAMES: [(Self, &'static str); BOARD.len() + HealthFlags::NAMES.len()] = {
        let mut names = [(Self::GOOD, ""); BOARD.len() + HealthFlags::NAMES.len()];
        let (boards, mut cores) = names.split_at_mut(BOARD.len());
        boards.copy_from_slice(&BOARD);
        let mut flags = HealthFlags::NAMES.as_slice();
        while let ([name, after @ ..], [(flag, text), flags_after @ ..]) = (cores, flags) {
            *name = (Self::of_core(*flag), text);
            (cores, flags) = (after, flags_after);
        }
        names
    };

    /// Name and remedy of each flag, in the order of [`Health::NAMES`].
    pub const ADVICE: [(&'static str, &'static str); Self::NAMES.len()] = [
        ("size_mismatch", "the pair has another size than planned: check the cameras' settings"),
        (
            "segments_dropped",
            "more segments than there is memory or time for: those that fit are used",
        ),
        ("results_skipped", "the port is slower than the board: raise its speed"),
        ("pair_missing", "a camera gave no picture: check its cable and power"),
        (
            "free_running",
            "the cameras are not triggered together: wire one trigger to both, or trust only \
             what stands still",
        ),
        (
            "left_exposure",
            "left image too dark or too bright: set its exposure or change the light",
        ),
        (
            "right_exposure",
            "right image too dark or too bright: set its exposure or change the light",
        ),
        ("left_saturated", "much of the left image is black or white: change its exposure"),
        ("right_saturated", "much of the right image is black or white: change its exposure"),
        ("left_dead", "left image has one grey level: check the camera's cable and power"),
        ("right_dead", "right image has one grey level: check the camera's cable and power"),
        (
            "left_covered",
            "left camera sees next to nothing of what the right one sees: free and clean its lens",
        ),
        (
            "right_covered",
            "right camera sees next to nothing of what the left one sees: free and clean its lens",
        ),
        (
            "left_frozen",
            "left image does not change: restart the camera, check the buffers of its driver",
        ),
        (
            "right_frozen",
            "right image does not change: restart the camera, check the buffers of its driver",
        ),
        (
            "left_view",
            "the left camera sees little of its rectified image: rectify with a smaller --alpha, \
             or calibrate again",
        ),
        (
            "right_view",
            "the right camera sees little of its rectified image: rectify with a smaller --alpha, \
             or calibrate again",
        ),
        (
            "exposures_differ",
            "one image is much brighter: give both cameras the same exposure and gain",
        ),
        (
            "skew",
            "the images were captured too far apart, so they are not matched: trigger both cameras \
             together",
        ),
        (
            "rows_off",
            "one image is shifted up or down, which is corrected: rectify the images; if they are \
             rectified, the rig has moved: calibrate again",
        ),
        (
            "rows_drift",
            "rows are moving against each other: tighten the mount, then calibrate again",
        ),
        (
            "rows_uneven",
            "rows match in one part of the image only: rectify the images; if they are rectified, \
             calibrate again",
        ),
        (
            "few_matches",
            "few edges have a match: check that left and right are not swapped, that the images \
             are rectified, and that the disparity range is large enough",
        ),
        (
            "beyond_infinity",
            "several disparities are below that of infinity: a camera has turned left or right: \
             calibrate again",
        ),
        (
            "range_small",
            "something is nearer than the disparity range: search more disparities, or keep it \
             away",
        ),
        (
            "no_parallax",
            "most of the picture is at the same pixels of both images: check that they come from \
             two cameras; a scene that is far away looks the same",
        ),
        (
            "same_pixel",
            "something is at the same pixels of both images: remove dirt on a window or lens, or \
             overlaid text; subtract the fixed noise of the sensors",
        ),
        (
            "torn",
            "the lower part of one image is shifted sideways: bytes were lost; check the camera's \
             cable and buffers",
        ),
        (
            "rows_far",
            "one image is shifted up or down by more than can be corrected: calibrate again",
        ),
    ];

    /// The flags that follow from what the core counted: full lists, and work left out.
    #[must_use]
    pub fn of(counts: &Counts) -> Self {
        if counts.is_cut() { Self::SEGMENTS_DROPPED } else { Self::GOOD }
    }

    /// The core's flags among them.
    #[must_use]
    pub const fn of_pair(self) -> HealthFlags {
        HealthFlags::from_bits_retain(self.bits() >> CORE)
    }

    /// The names of the flags that are set, in the order of [`Health::NAMES`].
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::NAMES.into_iter().filter(move |&(flag, _)| self.contains(flag)).map(|(_, name)| name)
    }

    /// The flags that have no name in this version.
    #[must_use]
    pub fn unnamed(self) -> Self {
        Self::NAMES.into_iter().fold(self, |rest, (flag, _)| rest.difference(flag))
    }

    const fn of_core(flags: HealthFlags) -> Self {
        Self::from_bits_retain(flags.bits() << CORE)
    }
}

impl From<HealthFlags> for Health {
    fn from(flags: HealthFlags) -> Self {
        Self::of_core(flags)
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
            unnamed => write!(f, "{separator}{:#010x}", unnamed.bits()),
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

/// The numbers of a [`PairHealth`]. Its flags are in the [`Health`] beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PairReport {
    /// Left and right camera.
    pub cameras: [CameraHealth; 2],
    /// [`PairHealth::skew_us`].
    pub skew_us: Option<u32>,
    /// [`PairHealth::rows`].
    pub rows: Option<Rows>,
    /// [`PairHealth::row_offset_q8`], 1/256 px.
    pub row_offset_q8: Option<i16>,
    /// [`PairHealth::row_drift_q8`], 1/256 px.
    pub row_drift_q8: Option<i16>,
    /// [`PairHealth::least_disparity_q6`], 1/64 px.
    pub least_disparity_q6: Option<i16>,
    /// [`PairHealth::range`].
    pub range: Option<RangeReport>,
    /// [`PairHealth::noise`].
    pub noise: Option<[Noise; 2]>,
    /// [`PairHealth::still`].
    pub still: Option<Still>,
    /// [`PairHealth::tear`].
    pub tear: Option<Tear>,
}

/// The public numbers of the core's [`RangeCheck`].
///
/// Not the core's own type, which also has the largest disparity.
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

impl From<&PairHealth> for PairReport {
    fn from(health: &PairHealth) -> Self {
        let range = |RangeCheck { windows, beyond, disparity, .. }| RangeReport {
            windows,
            beyond,
            disparity,
        };
        Self {
            cameras: health.cameras,
            skew_us: health.skew_us,
            rows: health.rows,
            row_offset_q8: health.row_offset_q8,
            row_drift_q8: health.row_drift_q8,
            least_disparity_q6: health.least_disparity_q6,
            range: health.range.map(range),
            noise: health.noise,
            still: health.still,
            tear: health.tear,
        }
    }
}
