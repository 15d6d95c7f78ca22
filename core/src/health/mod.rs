//! Can this pair be believed, and is the rig still the calibrated one?
//!
//! In: the pair, when it was captured, its matches. Out: a [`PairHealth`]: a few numbers and the flags that they raise.
//!
//! ```text
//! before matching: HealthMonitor::check_images          skew, levels, saturation, dead, covered and frozen cameras, valid view
//!                  PairHealth::is_refused       captured too far apart: not to be matched
//! after it:        HealthMonitor::check_matches   difference of rows (rows), few matches, matches beyond infinity
//! ```
//! A flag is raised by the pair that shows the fault and stays until [`HealthLimits::clear_after`] pairs in a row were free of it; a pair
//! that cannot tell (no edges to compare rows with) leaves it as it is. Differences of rows are smoothed before they are judged:
//!
//! ```text
//! short += (offset - short) / min(pairs, 8)       rows_off    |short| above the limit
//! long  += (offset - long)  / min(pairs, 256)     rows_drift  |short - long| above the limit, once 16 pairs have spoken
//! ```
//!
//! # What stereo cannot see of itself
//! - **Yaw** (a camera turned towards the other one or away) moves every point along its row: all disparities change by about the same
//!   number of pixels, and no row shows it. Depth `f * B / d` is then wrong by `error / d`: most for far points.
//!   [`HealthFlags::BEYOND_INFINITY`] catches one direction of it, if there is something far to see and negative disparities are searched.
//! - **The baseline** scales every depth. No picture shows it.
//! - **The focal length**, if it changes in both cameras alike, scales every depth as well.
//!
//! What helps: look at something very far (its disparity plus the rig's offset has to be 0, within 0.2 px), and measure one known distance.
//! Pitch (rows move), roll (rows move one way left and the other way right) and a focal length that changes in one camera only (rows spread)
//! are seen, as soon as they amount to the limits.
//!
//! # Cost
//! 0.30 M instructions of the 9.85 M of a QVGA pair (median of 13 captured ones, Cortex-M7 in QEMU); a monitor has less than 100 bytes.

mod camera;
mod flags;
mod limits;
mod rows;

use crate::image::Gray;
use crate::result::{Counts, Match, Rejection};
use crate::units::quotient;
pub use camera::CameraHealth;
pub use flags::HealthFlags;
pub use limits::{HealthLimits, Skewed};
pub use rows::Rows;

/// Pairs that have to speak of rows before a drift can be seen.
const SETTLED: u16 = 16;
/// Least segments compared of which a share means something.
const MIN_COMPARED: u16 = 24;
/// Least detail (1/16) of an image next to which another can look covered.
const MIN_DETAIL_Q4: u32 = 32;
/// Matches that must lie beyond infinity, so that a single wrong one does not count.
const BEYOND: usize = 3;
/// Bits of the flags.
const FLAGS: usize = HealthFlags::NAMES.len();

/// The state of one pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct PairHealth {
    /// What is wrong, with this pair or one shortly before.
    pub flags: HealthFlags,
    /// What is wrong with this pair.
    pub now: HealthFlags,
    /// Left and right camera.
    pub cameras: [CameraHealth; 2],
    /// Between the captures, microseconds; `None` when the times are unknown.
    pub skew_us: Option<u32>,
    /// Difference of rows in this pair; `None` when its matches cannot say.
    pub rows: Option<Rows>,
    /// The same, smoothed over [`HealthLimits::row_pairs`], 1/256 px; `None` until a pair has said it.
    pub row_offset_q8: Option<i16>,
    /// How far that is from its long mean, 1/256 px; `None` until 16 pairs have said it.
    pub row_drift_q8: Option<i16>,
    /// The third smallest disparity among the matches (of the larger of their ends), 1/64 px; `None` with fewer matches.
    pub least_disparity_q6: Option<i16>,
}

impl PairHealth {
    /// The images were captured too far apart: whatever is matched would be wrong.
    #[must_use]
    pub const fn is_refused(&self) -> bool {
        self.now.contains(HealthFlags::SKEW)
    }
}

/// What pairs leave behind for the next ones.
///
/// ```
/// use linestereo::{Dims, Gray, HealthFlags, HealthLimits};
/// use linestereo::health::HealthMonitor;
/// let dims = Dims { width: 16, height: 16 };
/// let (alive, dead): ([u8; 256], _) = (core::array::from_fn(|i| 100 + (i * i % 31) as u8), [100; 256]);
/// let (alive, dead) = (Gray::new(&alive, dims, 16)?, Gray::new(&dead, dims, 16)?);
///
/// let mut monitor = HealthMonitor::new();
/// let health = monitor.check_images(&HealthLimits::DEFAULT, alive, dead, None);
/// assert_eq!(health.flags, HealthFlags::RIGHT_DEAD);
/// # Ok::<(), linestereo::image::ViewError>(())
/// ```
#[derive(Clone, Debug)]
pub struct HealthMonitor {
    /// Digest of the last image of each camera, and pairs since it changed.
    last: [Option<u32>; 2],
    same: [u8; 2],
    /// Pairs for which each flag stays.
    held: [u8; FLAGS],
    /// Smoothed differences of rows, 1/65536 px, and how many pairs they are made of.
    short_q16: i32,
    long_q16: i32,
    pairs: u16,
}

impl HealthMonitor {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: [None; 2], same: [0; 2], held: [0; FLAGS], short_q16: 0, long_q16: 0, pairs: 0 }
    }

    /// Looks at a pair before it is matched. `times_us` is when the left and the right image were captured, microseconds of one clock;
    /// without them no pair is refused.
    pub fn check_images(
        &mut self,
        limits: &HealthLimits,
        left: Gray<'_>,
        right: Gray<'_>,
        times_us: Option<[u64; 2]>,
    ) -> PairHealth {
        let looks = [left, right].map(camera::check);
        let [left, right] = &looks;
        let mut now = self.fault(limits, left, right, 0) | self.fault(limits, right, left, 1);
        let mut judged = CAMERA_FLAGS;
        let levels = looks.each_ref().map(|look| u32::from(look.health.level).max(1));
        let (low, high) = (levels[0].min(levels[1]), levels[0].max(levels[1]));
        now |= HealthFlags::EXPOSURES_DIFFER.when(high << 8 > low * u32::from(limits.exposure_ratio_q8));
        let skew = times_us.map(|times| limits.skew_us(times));
        if let Some(skew) = skew {
            judged |= HealthFlags::SKEW;
            now |= HealthFlags::SKEW.when(skew.is_err());
        }
        let flags = self.hold(limits, now, judged);
        PairHealth {
            flags,
            now,
            cameras: looks.map(|look| look.health),
            skew_us: skew.map(|skew| skew.unwrap_or_else(|skewed| skewed.skew_us)),
            ..PairHealth::default()
        }
    }

    /// Looks at what the pair's matching gave, and adds to its health.
    pub fn check_matches(
        &mut self,
        limits: &HealthLimits,
        (left, right): (Gray<'_>, Gray<'_>),
        (matches, counts): (&[Match], &Counts),
        health: &mut PairHealth,
    ) {
        let mut now = HealthFlags::GOOD;
        let mut judged = HealthFlags::FEW_MATCHES | HealthFlags::BEYOND_INFINITY;
        let compared = counts.segments_left.saturating_sub(counts.rejected(Rejection::LessProminent));
        let matched = u32::from(counts.matched);
        let few = matched * 1000 < u32::from(compared) * u32::from(limits.matched_permille);
        now |= HealthFlags::FEW_MATCHES.when(compared >= MIN_COMPARED && few);

        health.least_disparity_q6 = third_least_q6(matches);
        let beyond = health.least_disparity_q6.is_some_and(|d| d < limits.least_disparity_q6);
        now |= HealthFlags::BEYOND_INFINITY.when(beyond);

        let found = rows::measure(left, right, matches).filter(|rows| rows.samples >= limits.min_row_samples);
        if let Some(rows) = found {
            let is_uneven = rows.spread_q8 > limits.row_spread_q8;
            judged |= HealthFlags::ROWS_UNEVEN;
            now |= HealthFlags::ROWS_UNEVEN.when(is_uneven);
            health.rows = Some(rows);
            if !is_uneven {
                self.smooth(limits, rows.offset_q8);
                judged |= HealthFlags::ROWS_OFF | HealthFlags::ROWS_DRIFT;
            }
        }
        if self.pairs > 0 {
            let offset_q8 = (self.short_q16 + 128) >> 8;
            health.row_offset_q8 = i16::try_from(offset_q8).ok();
            now |= judged.and(HealthFlags::ROWS_OFF).when(offset_q8.unsigned_abs() > u32::from(limits.row_offset_q8));
        }
        if self.pairs >= SETTLED {
            let drift_q8 = (self.short_q16 - self.long_q16 + 128) >> 8;
            health.row_drift_q8 = i16::try_from(drift_q8).ok();
            now |= judged.and(HealthFlags::ROWS_DRIFT).when(drift_q8.unsigned_abs() > u32::from(limits.row_drift_q8));
        }
        health.now |= now;
        health.flags = self.hold(limits, now, judged);
    }

    /// What is wrong with one camera's image; `eye` is 0 or 1, and its flags are those of the left one, moved by it.
    fn fault(
        &mut self,
        limits: &HealthLimits,
        own: &camera::CameraCheck,
        other: &camera::CameraCheck,
        eye: usize,
    ) -> HealthFlags {
        let health = &own.health;
        let is_dead = own.range <= limits.dead_range;
        let is_saturated = health.black_permille + health.white_permille > limits.saturated_permille;
        let is_black = health.level < limits.covered_level && other.health.level / 4 >= health.level.max(1);
        // detail / level, compared by cross products; what burns out loses its detail as well, and is not covered.
        let relative = |a: &CameraHealth, b: &CameraHealth| u32::from(a.detail_q4) * u32::from(b.level.max(1));
        let is_plain = u32::from(other.health.detail_q4) >= MIN_DETAIL_Q4
            && relative(health, &other.health) * u32::from(limits.covered_ratio) < relative(&other.health, health)
            && health.white_permille <= limits.saturated_permille;
        let is_same = self.is_same(own.digest, eye, limits);
        let (darkest, brightest) = limits.level;
        let left = HealthFlags::LEFT_EXPOSURE.when(health.level < darkest || health.level > brightest)
            | HealthFlags::LEFT_SATURATED.when(is_saturated)
            | HealthFlags::LEFT_DEAD.when(is_dead)
            | HealthFlags::LEFT_COVERED.when((is_black || is_plain) && !is_dead)
            | HealthFlags::LEFT_FROZEN.when(is_same && !is_dead)
            | HealthFlags::LEFT_VIEW.when(health.view_permille < limits.view_permille);
        HealthFlags::from_bits(left.bits() << eye)
    }

    /// Has this camera's image been the same for too long?
    fn is_same(&mut self, digest: u32, eye: usize, limits: &HealthLimits) -> bool {
        let (Some(last), Some(same)) = (self.last.get_mut(eye), self.same.get_mut(eye)) else { return false };
        *same = if last.replace(digest) == Some(digest) { same.saturating_add(1) } else { 0 };
        *same > limits.frozen_pairs
    }

    /// Raises and clears flags, and says which are up. Those that this pair could not judge stay as they are.
    fn hold(&mut self, limits: &HealthLimits, now: HealthFlags, judged: HealthFlags) -> HealthFlags {
        let mut flags = HealthFlags::GOOD;
        for (held, (flag, _)) in self.held.iter_mut().zip(HealthFlags::NAMES) {
            if now.contains(flag) {
                *held = limits.clear_after.max(1);
            } else if judged.contains(flag) {
                *held = held.saturating_sub(1);
            }
            flags |= flag.when(*held > 0);
        }
        flags
    }

    /// A difference of rows more: an exact mean at first, exponential later.
    fn smooth(&mut self, limits: &HealthLimits, offset_q8: i16) {
        self.pairs = self.pairs.saturating_add(1);
        let (short, long) = limits.row_pairs;
        let value = i32::from(offset_q8) << 8;
        for (mean, pairs) in [(&mut self.short_q16, short), (&mut self.long_q16, long)] {
            *mean += quotient(value - *mean, i32::from(self.pairs.min(pairs.clamp(1, 1024))));
        }
    }
}

impl Default for HealthMonitor {
    fn default() -> Self {
        Self::new()
    }
}

/// What every pair is judged for before matching, but for its skew.
const CAMERA_FLAGS: HealthFlags = HealthFlags::from_bits((HealthFlags::EXPOSURES_DIFFER.bits() << 1) - 1);

/// The third smallest disparity of a match: of the larger of its ends.
fn third_least_q6(matches: &[Match]) -> Option<i16> {
    let mut least = [i16::MAX; BEYOND];
    for found in matches {
        let [d0, d1] = found.disparity.map(crate::units::Disparity::to_bits);
        let mut value = d0.max(d1);
        for place in &mut least {
            if value < *place {
                core::mem::swap(place, &mut value);
            }
        }
    }
    let [.., third] = least;
    (third < i16::MAX).then_some(third)
}
