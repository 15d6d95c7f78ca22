//! Health of a pair: faults of the images and the cameras, and changes of the rig since calibration.
//!
//! In: the pair, its times of capture, its matches. Out: a [`PairHealth`]: a few numbers and the flags that they raise.
//!
//! ```text
//! before matching: HealthMonitor::check_images          skew, levels, saturation, dead, covered and frozen cameras, valid view
//!                  PairHealth::is_refused                captured too far apart: not to be matched
//! after it:        HealthMonitor::check_matches          difference of rows (rows), few matches, matches beyond infinity and beyond the range,
//!                                                        what is at the same pixel of both images (still), torn images (tear)
//! ```
//! A flag is raised by the pair that shows the fault and stays until [`HealthLimits::clear_after`] pairs in a row were free of it; a pair in
//! which the quantity cannot be measured (no edges to compare rows with) does not change it. Differences of rows are smoothed first:
//!
//! ```text
//! short += (offset - short) / min(pairs, 8)       rows_off    |short| above the limit
//! long  += (offset - long)  / min(pairs, 256)     rows_drift  |short - long| above the limit, after 16 pairs with a measurement
//! ```
//!
//! # Faults that a pair does not show
//! - **Yaw** (a camera turned towards the other one or away) moves every point along its row: all disparities change by about the same
//!   number of pixels, and rows do not change. Depth `f * B / d` is then wrong by `error / d`: most for far points.
//!   [`HealthFlags::BEYOND_INFINITY`] detects one direction of it, if something far is in view and negative disparities are searched.
//! - **The baseline** scales every depth and changes no image.
//! - **The focal length**, if it changes in both cameras alike, scales every depth as well.
//!
//! Remedy: measure something very far (its disparity plus the rig's offset has to be 0, within 0.2 px) and one known distance. Pitch (rows
//! move), roll (rows move one way left and the other way right) and a focal length that changes in one camera only (rows spread) are detected
//! beyond the limits.
//!
//! # Cost
//! 1.1 M instructions of the 13.2 M of a QVGA pair (median of 13 captured ones, Cortex-M7 in QEMU):
//! images 0.07 M, rows by edges 0.14 M and by points 0.7 M, likeness at the same pixel 0.10 M,
//! tears 0.12 M. A monitor has less than 100 bytes.

mod camera;
mod evenness;
mod flags;
mod limits;
mod rows;
mod still;
mod tear;

use crate::image::Gray;
use crate::result::{Counts, Match, Rejection};
pub use crate::support::RangeCheck;
use crate::support::Support;
use crate::units::quotient;
pub use camera::CameraHealth;
pub use flags::HealthFlags;
pub use limits::{HealthLimits, Skewed};
pub use rows::Rows;
pub use still::Still;
pub use tear::Tear;

/// Least number of pairs with a measured difference of rows before a drift is computed.
const SETTLED: u16 = 16;
/// Least number of segments compared for their matched share to be tested.
const MIN_COMPARED: u16 = 24;
/// Least detail, 1/16 grey level, of the other image for a camera to be reported covered.
const MIN_DETAIL_Q4: u32 = 32;
/// Number of matches that must lie beyond infinity, so that single wrong ones do not count.
const BEYOND: usize = 3;
/// Number of flags.
const FLAGS: usize = HealthFlags::NAMES.len();

/// Health of one pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PairHealth {
    /// Faults of this pair or one shortly before.
    pub flags: HealthFlags,
    /// Faults of this pair.
    pub now: HealthFlags,
    /// Left and right camera.
    pub cameras: [CameraHealth; 2],
    /// Time between the captures, us; `None` when the times are unknown.
    pub skew_us: Option<u32>,
    /// Difference of rows in this pair; `None` with too few matches that measure it.
    pub rows: Option<Rows>,
    /// Difference of rows, smoothed over [`HealthLimits::row_pairs`], 1/256 px; `None` until a pair has measured it.
    pub row_offset_q8: Option<i16>,
    /// Difference between that and its long mean, 1/256 px; `None` until 16 pairs have measured it.
    pub row_drift_q8: Option<i16>,
    /// The third smallest disparity among the matches (of the larger of their ends), 1/64 px; `None` with fewer matches.
    pub least_disparity_q6: Option<i16>,
    /// Windows that match beyond the disparity range; `None` until the pair is matched.
    pub range: Option<RangeCheck>,
    /// Likeness of both images at the same pixels; `None` with too few credible support points.
    pub still: Option<Still>,
    /// A row at which an image is torn.
    pub tear: Option<Tear>,
}

/// Results of a pair that its health is checked by.
#[derive(Clone, Copy, Debug)]
pub struct Findings<'a> {
    /// Matched segments, most confident first.
    pub matches: &'a [Match],
    /// Numbers of segments found, matched and rejected.
    pub counts: &'a Counts,
    /// Support points.
    pub support: Support<'a>,
    /// Windows that match beyond the disparity range.
    pub range: RangeCheck,
    /// Row of the right image at which row 0 of the left one was matched.
    pub row_offset: i32,
}

impl PairHealth {
    /// True when the images were captured too far apart to be matched.
    #[must_use]
    pub const fn is_refused(&self) -> bool {
        self.now.contains(HealthFlags::SKEW)
    }
}

/// State of health over consecutive pairs.
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
    /// Digest of the last image of each camera.
    last: [Option<u32>; 2],
    /// Number of pairs since each camera's image changed.
    same: [u8; 2],
    /// Number of pairs for which each flag stays.
    held: [u8; FLAGS],
    /// Smoothed differences of rows, 1/65536 px.
    short_q16: i32,
    long_q16: i32,
    /// Number of pairs with a measured difference of rows.
    pairs: u16,
}

impl HealthMonitor {
    /// A monitor before the first pair.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: [None; 2], same: [0; 2], held: [0; FLAGS], short_q16: 0, long_q16: 0, pairs: 0 }
    }

    /// Checks a pair before it is matched. `times_us` holds the times of capture of the left and the right image, us of one clock; without them no
    /// pair is refused.
    pub fn check_images(
        &mut self,
        limits: &HealthLimits,
        left: Gray<'_>,
        right: Gray<'_>,
        times_us: Option<[u64; 2]>,
    ) -> PairHealth {
        let checks = [left, right].map(|image| camera::check(image, limits.dead_range));
        let [left, right] = &checks;
        let mut now = self.fault(limits, left, right, 0) | self.fault(limits, right, left, 1);
        let mut tested = CAMERA_FLAGS;
        let levels = checks.each_ref().map(|check| u32::from(check.health.level).max(1));
        let (low, high) = (levels[0].min(levels[1]), levels[0].max(levels[1]));
        now |= HealthFlags::EXPOSURES_DIFFER.when(high << 8 > low * u32::from(limits.exposure_ratio_q8));
        let skew = times_us.map(|times| limits.skew_us(times));
        if let Some(skew) = skew {
            tested |= HealthFlags::SKEW;
            now |= HealthFlags::SKEW.when(skew.is_err());
        }
        let flags = self.hold(limits, now, tested);
        PairHealth {
            flags,
            now,
            cameras: checks.map(|check| check.health),
            skew_us: skew.map(|skew| skew.unwrap_or_else(|skewed| skewed.skew_us)),
            ..PairHealth::default()
        }
    }

    /// Checks the results of the pair, and adds to its health.
    pub fn check_matches(
        &mut self,
        limits: &HealthLimits,
        images: [Gray<'_>; 2],
        found: &Findings<'_>,
        health: &mut PairHealth,
    ) {
        let (mut now, mut tested) = self.check_rows(limits, images, found, health);
        tested |= HealthFlags::FEW_MATCHES | HealthFlags::BEYOND_INFINITY | HealthFlags::TORN;
        now |= HealthFlags::FEW_MATCHES.when(are_few(found.counts, limits, health.rows.is_some()));

        health.least_disparity_q6 = third_least_q6(found.matches);
        let beyond = health.least_disparity_q6.is_some_and(|d| d < limits.least_disparity_q6);
        now |= HealthFlags::BEYOND_INFINITY.when(beyond);

        health.range = Some(found.range);
        // A fault of a camera leaves windows without a match as well.
        if !health.now.intersects(CAMERA_FLAGS) {
            tested |= HealthFlags::RANGE_SMALL;
            now |= HealthFlags::RANGE_SMALL.when(is_small(&found.range, limits));
        }
        health.still = still::measure(images, found.support);
        if let Some(still) = health.still {
            tested |= HealthFlags::NO_PARALLAX | HealthFlags::SAME_PIXEL;
            now |= HealthFlags::NO_PARALLAX.when(still.still_permille > limits.still_permille);
            // Text and dirt that windows match are no parallax there, and what is alike elsewhere
            // is less.
            let most = limits.pattern_permille >> if still.still_permille > SOME_STILL_PERMILLE { 2 } else { 0 };
            now |= HealthFlags::SAME_PIXEL.when(still.pattern_permille > most);
        }
        health.tear = tear::find(images, found.support);
        now |= HealthFlags::TORN.when(health.tear.is_some());
        health.now |= now;
        health.flags = self.hold(limits, now, tested);
    }

    /// Measures the difference of rows and adds it to the health; returns the flags raised and those tested.
    fn check_rows(
        &mut self,
        limits: &HealthLimits,
        [left, right]: [Gray<'_>; 2],
        found: &Findings<'_>,
        health: &mut PairHealth,
    ) -> (HealthFlags, HealthFlags) {
        let (mut now, mut tested) = (HealthFlags::GOOD, HealthFlags::GOOD);
        let by_points = evenness::measure([left, right], found.support, found.row_offset);
        let mut is_uneven = by_points.map(|even| even.spread_q8 > limits.row_region_q8);
        // Edges are few and each of them may be wrong: points have to be in doubt as well.
        let are_even = by_points.is_some_and(|even| even.spread_q8 <= limits.row_region_q8 / 2);
        if let Some(rows) = rows::measure(left, right, found.matches)
            && let Some(by_edges) = are_uneven(&rows, limits)
        {
            is_uneven = Some(is_uneven == Some(true) || by_edges && !are_even);
            let offset_q8 = by_points.filter(|_| by_edges && are_even).map_or(rows.offset_q8, |even| {
                even.offset_q8.saturating_add((found.row_offset << 8) as i16) // edges are in doubt
            });
            let rows = Rows { offset_q8, ..rows };
            health.rows = Some(rows);
            if is_uneven == Some(false) {
                self.smooth(limits, rows.offset_q8);
                tested |= HealthFlags::ROWS_OFF | HealthFlags::ROWS_FAR | HealthFlags::ROWS_DRIFT;
            }
        }
        if let Some(is_uneven) = is_uneven {
            tested |= HealthFlags::ROWS_UNEVEN;
            now |= HealthFlags::ROWS_UNEVEN.when(is_uneven);
        }
        // Edges that agree know it better.
        if let Some(even) = by_points.filter(|_| !tested.contains(HealthFlags::ROWS_FAR)) {
            let offset_q8 = i32::from(even.offset_q8) + (found.row_offset << 8);
            now |= HealthFlags::ROWS_FAR.when(offset_q8.unsigned_abs() > u32::from(limits.row_limit_q8));
        }
        if self.pairs > 0 {
            let offset_q8 = (self.short_q16 + 128) >> 8;
            health.row_offset_q8 = i16::try_from(offset_q8).ok();
            let is_beyond = |limit_q8: u16| offset_q8.unsigned_abs() > u32::from(limit_q8);
            now |= tested.intersection(HealthFlags::ROWS_OFF).when(is_beyond(limits.row_offset_q8));
            now |= tested.intersection(HealthFlags::ROWS_FAR).when(is_beyond(limits.row_limit_q8));
        }
        if self.pairs >= SETTLED {
            let drift_q8 = (self.short_q16 - self.long_q16 + 128) >> 8;
            health.row_drift_q8 = i16::try_from(drift_q8).ok();
            now |= tested
                .intersection(HealthFlags::ROWS_DRIFT)
                .when(drift_q8.unsigned_abs() > u32::from(limits.row_drift_q8));
        }
        (now, tested)
    }

    /// Faults of one camera's image; `camera` is 0 or 1: its flags are those of the left one, shifted by it.
    fn fault(
        &mut self,
        limits: &HealthLimits,
        own: &camera::CameraCheck,
        other: &camera::CameraCheck,
        camera: usize,
    ) -> HealthFlags {
        let health = &own.health;
        let is_saturated = health.black_permille + health.white_permille > limits.saturated_permille;
        let is_black = health.level < limits.covered_level && other.health.level / 4 >= health.level.max(1);
        // detail / level, compared by cross products; an overexposed image loses its detail as well, and is not covered.
        let relative = |a: &CameraHealth, b: &CameraHealth| u32::from(a.detail_q4) * u32::from(b.level.max(1));
        let is_plain = u32::from(other.health.detail_q4) >= MIN_DETAIL_Q4
            && relative(health, &other.health) * u32::from(limits.covered_ratio) < relative(&other.health, health)
            && health.white_permille <= limits.saturated_permille;
        let is_same = self.is_same(own.digest, camera, limits);
        let (darkest, brightest) = limits.level;
        let left = HealthFlags::LEFT_EXPOSURE.when(health.level < darkest || health.level > brightest)
            | HealthFlags::LEFT_SATURATED.when(is_saturated)
            | HealthFlags::LEFT_DEAD.when(own.is_flat)
            | HealthFlags::LEFT_COVERED.when((is_black || is_plain) && !own.is_flat)
            | HealthFlags::LEFT_FROZEN.when(is_same && !own.is_flat)
            | HealthFlags::LEFT_VIEW.when(health.view_permille < limits.view_permille);
        HealthFlags::from_bits_retain(left.bits() << camera)
    }

    /// True when this camera's image has been the same for more than [`HealthLimits::frozen_pairs`] pairs.
    fn is_same(&mut self, digest: u32, camera: usize, limits: &HealthLimits) -> bool {
        let (Some(last), Some(same)) = (self.last.get_mut(camera), self.same.get_mut(camera)) else { return false };
        *same = if last.replace(digest) == Some(digest) { same.saturating_add(1) } else { 0 };
        *same > limits.frozen_pairs
    }

    /// Raises and clears flags, and returns those that are set. Only `tested` flags are cleared.
    #[inline(never)]
    fn hold(&mut self, limits: &HealthLimits, now: HealthFlags, tested: HealthFlags) -> HealthFlags {
        let mut flags = HealthFlags::GOOD;
        for (held, (flag, _)) in self.held.iter_mut().zip(HealthFlags::NAMES) {
            if now.contains(flag) {
                *held = limits.clear_after.max(1);
            } else if tested.contains(flag) {
                *held = held.saturating_sub(1);
            }
            flags |= flag.when(*held > 0);
        }
        flags
    }

    /// Adds a difference of rows, 1/256 px: an exact mean at first, exponential later.
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

/// Share of points without parallax, per thousand, with which a quarter of
/// [`HealthLimits::pattern_permille`] is enough. Of 181 undamaged pairs the largest is 15.
const SOME_STILL_PERMILLE: u16 = 150;

/// Flags that are tested before matching, without [`HealthFlags::SKEW`].
const CAMERA_FLAGS: HealthFlags = HealthFlags::from_bits_retain((HealthFlags::EXPOSURES_DIFFER.bits() << 1) - 1);

/// True when few of the segments compared are matched.
fn are_few(counts: &Counts, limits: &HealthLimits, rows_are_known: bool) -> bool {
    let compared = counts.segments_left.saturating_sub(counts.rejected(Rejection::LessProminent));
    let least = if rows_are_known { limits.matched_permille } else { limits.unwitnessed_permille };
    compared >= MIN_COMPARED && u32::from(counts.matched) * 1000 < u32::from(compared) * u32::from(least)
}

/// Least number of matches whose differences of rows can be uneven.
const LEAST_SAMPLES: u8 = 4;

/// True when the rows of a pair are uneven, false when they are even; `None` where too few matches tell neither.
fn are_uneven(rows: &Rows, limits: &HealthLimits) -> Option<bool> {
    if rows.samples >= limits.min_row_samples {
        return Some(rows.spread_q8 > limits.row_spread_q8);
    }
    // The spread of few is known less well: it takes twice as much, and an even one is no measurement.
    (rows.samples >= LEAST_SAMPLES && rows.spread_q8 / 2 > limits.row_spread_q8).then_some(true)
}

/// True when enough windows match beyond the range.
fn is_small(range: &RangeCheck, limits: &HealthLimits) -> bool {
    let share = u32::from(range.windows) * u32::from(limits.beyond_range_permille);
    range.beyond >= limits.min_beyond_range && u32::from(range.beyond) * 1000 >= share
}

/// The third smallest disparity of the matches, of the larger of their ends, 1/64 px.
fn third_least_q6(matches: &[Match]) -> Option<i16> {
    let mut least = [i16::MAX; BEYOND];
    for found in matches {
        let [d0, d1] = found.disparity.map(crate::units::Disparity::to_bits);
        let mut value = d0.max(d1);
        for slot in &mut least {
            if value < *slot {
                core::mem::swap(slot, &mut value);
            }
        }
    }
    let [.., third] = least;
    (third < i16::MAX).then_some(third)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::SupportPoint;

    #[test]
    fn few_matches_tell_rows_that_are_very_uneven_alone() {
        let limits = HealthLimits::DEFAULT;
        let told = |samples, spread_q8| are_uneven(&Rows { offset_q8: 0, spread_q8, samples }, &limits);
        let HealthLimits { row_spread_q8: most, min_row_samples: enough, .. } = limits;
        assert_eq!([most, most + 1].map(|spread| told(enough, spread)), [Some(false), Some(true)]);
        assert_eq!([2 * most + 1, 2 * most + 2].map(|spread| told(enough - 1, spread)), [None, Some(true)]);
        assert_eq!(told(LEAST_SAMPLES - 1, u16::MAX), None);
    }

    #[test]
    fn few_are_matched_below_a_share_of_those_compared() {
        let limits = HealthLimits { matched_permille: 100, unwitnessed_permille: 200, ..HealthLimits::DEFAULT };
        let few = |segments: u16, less_prominent: u16, matched: u16, rows_are_known| {
            let mut counts = Counts::default();
            (counts.segments_left, counts.matched) = (segments, matched);
            counts.reject_many(Rejection::LessProminent, less_prominent);
            are_few(&counts, &limits, rows_are_known)
        };
        assert_eq!([3, 4].map(|matched| few(50, 10, matched, true)), [true, false]);
        assert_eq!([7, 8].map(|matched| few(50, 10, matched, false)), [true, false]);
        assert_eq!([23, 24].map(|compared| few(compared, 0, 0, true)), [false, true], "of fewer nothing is said");
    }

    #[test]
    fn the_range_is_small_with_enough_windows_beyond_it() {
        let limits = HealthLimits { min_beyond_range: 3, beyond_range_permille: 20, ..HealthLimits::DEFAULT };
        let small = |beyond, windows| {
            let mut range = RangeCheck::default();
            (range.beyond, range.windows) = (beyond, windows);
            is_small(&range, &limits)
        };
        assert_eq!([small(2, 10), small(3, 10), small(3, 150), small(3, 151)], [false, true, true, false]);
    }

    #[test]
    fn the_third_smallest_disparity_is_that_of_the_larger_end() {
        let matches = [[5, -7], [1, 9], [-3, -8], [2, 2], [-4, 70]].map(|d| rows::tests::matched([(0, 0); 2], d));
        assert_eq!([2, 3, 4, 5].map(|count| third_least_q6(&matches[..count])), [None, Some(9), Some(5), Some(5)]);
    }

    #[test]
    fn a_flag_stays_until_pairs_were_free_of_it() {
        let (limits, mut monitor) = (HealthLimits { clear_after: 2, ..HealthLimits::DEFAULT }, HealthMonitor::new());
        let (torn, none) = (HealthFlags::TORN, HealthFlags::GOOD);
        // Raised, free of it, not tested, free of it, not tested.
        let flags = [(torn, torn), (none, torn), (none, none), (none, torn), (none, none)]
            .map(|(now, tested)| monitor.hold(&limits, now, tested));
        assert_eq!(flags, [torn, torn, torn, none, none]);
    }

    #[test]
    fn differences_of_rows_are_a_mean_at_first_and_exponential_later() {
        let (limits, mut monitor) = (HealthLimits { row_pairs: (2, 4), ..HealthLimits::DEFAULT }, HealthMonitor::new());
        let means = [256, 0, 64, 64, 64].map(|offset_q8| {
            monitor.smooth(&limits, offset_q8);
            [monitor.short_q16 >> 8, monitor.long_q16 >> 8]
        });
        assert_eq!(means, [[256, 256], [128, 128], [96, 106], [80, 96], [72, 88]]);
    }

    const DIMS: crate::Dims = crate::Dims { width: 16, height: 16 };

    /// Matches, without support points.
    fn findings<'a>(matches: &'a [Match], counts: &'a Counts) -> Findings<'a> {
        let support = Support::new(&crate::Params::DEFAULT, DIMS, &[], 0);
        Findings { matches, counts, support, range: RangeCheck::default(), row_offset: 0 }
    }

    #[test]
    fn rows_are_reported_rounded_and_flagged_where_they_were_measured_alone() {
        let pixels = [0; 256];
        let images = [Gray::new(&pixels, DIMS, 16).unwrap(); 2];
        let mut monitor = HealthMonitor { short_q16: 100 * 256 + 128, long_q16: 40 * 256, ..HealthMonitor::new() };
        let mut reported = |pairs| {
            let mut health = PairHealth::default();
            monitor.pairs = pairs;
            let flags =
                monitor.check_rows(&HealthLimits::DEFAULT, images, &findings(&[], &Counts::default()), &mut health);
            assert_eq!(flags, (HealthFlags::GOOD, HealthFlags::GOOD), "no match measures them");
            (health.row_offset_q8, health.row_drift_q8)
        };
        assert_eq!([0, 1, SETTLED - 1].map(&mut reported), [(None, None), (Some(101), None), (Some(101), None)]);
        assert_eq!(reported(SETTLED), (Some(101), Some(61)));
    }

    #[test]
    fn even_rows_are_smoothed_and_uneven_ones_flagged() {
        let limits = HealthLimits { min_row_samples: 4, ..HealthLimits::DEFAULT };
        let of = |moved, from| {
            let (mut monitor, mut health) = (HealthMonitor::new(), PairHealth::default());
            let ([left, right], edges) = rows::tests::falling(moved, from);
            let images = [rows::tests::view(&left), rows::tests::view(&right)];
            let (now, _) = monitor.check_rows(&limits, images, &findings(&edges, &Counts::default()), &mut health);
            (now, health.row_offset_q8)
        };
        let (off, far) = (HealthFlags::ROWS_OFF, HealthFlags::ROWS_OFF | HealthFlags::ROWS_FAR);
        assert_eq!(
            [0, 1, -2].map(|moved| of(moved, -100)),
            [(HealthFlags::GOOD, Some(0)), (off, Some(256)), (far, Some(-512))]
        );
        assert_eq!(of(2, 45), (HealthFlags::ROWS_UNEVEN, None), "the lower two of four edges");
    }

    #[test]
    fn rows_drift_beyond_a_difference_from_their_long_mean() {
        // Sixteen pairs with rows at this difference, 1/256 px, then one at none: both means are those of all pairs.
        let limits = HealthLimits { min_row_samples: 4, row_pairs: (1, 1024), ..HealthLimits::DEFAULT };
        let drifts = |before_q8: i16| {
            let mut monitor = HealthMonitor::new();
            (0..SETTLED).for_each(|_| monitor.smooth(&limits, before_q8));
            let ([left, right], edges) = rows::tests::falling(0, 0);
            let images = [rows::tests::view(&left), rows::tests::view(&right)];
            let mut health = PairHealth::default();
            let (now, _) = monitor.check_rows(&limits, images, &findings(&edges, &Counts::default()), &mut health);
            (now.contains(HealthFlags::ROWS_DRIFT), health.row_drift_q8)
        };
        // Of the long mean a seventeenth is new: 40 * 16 / 17 is 37.6, 41 * 16 / 17 is 38.6, and 38 the limit.
        assert_eq!(
            [40, 41, -40, -41].map(drifts),
            [(false, Some(-38)), (true, Some(-39)), (false, Some(38)), (true, Some(39))]
        );
    }

    #[test]
    fn exposures_differ_beyond_their_ratio() {
        let differ = |left: u8, right: u8| {
            let pixels =
                [left, right].map(|level| -> [u8; 256] { core::array::from_fn(|i| level + (i % 2 * 8) as u8 - 4) });
            let images = pixels.each_ref().map(|pixels| Gray::new(pixels, DIMS, 16).unwrap());
            HealthMonitor::new().check_images(&HealthLimits::DEFAULT, images[0], images[1], None).now
        };
        let flag = HealthFlags::EXPOSURES_DIFFER;
        let found = [differ(100, 100), differ(100, 175), differ(100, 176), differ(176, 100)];
        assert_eq!(found, [HealthFlags::GOOD, HealthFlags::GOOD, flag, flag]);
    }

    #[test]
    fn what_is_matched_has_limits_that_raise_flags_beyond_them() {
        let noise = still::tests::noise(1);
        let image = Gray::new(&noise, still::tests::DIMS, 128).unwrap();
        // An eighth without parallax, the others at 10 px; both images are one.
        let points: [_; still::tests::GRID] = core::array::from_fn(|i| SupportPoint {
            disparity_q6: if i % 8 == 0 { 0 } else { 640 },
            score_q8: 0,
            probability_q16: 0xffff,
            ..SupportPoint::none()
        });
        let matches = [rows::tests::matched([(0, 0); 2], [-64; 2]); 3];
        let mut counts = Counts::default();
        (counts.segments_left, counts.matched) = (100, 3);
        let mut range = RangeCheck::default();
        (range.beyond, range.windows) = (5, 100);
        let support = Support::new(&crate::Params::default(), still::tests::DIMS, &points, 0);
        let findings = Findings { matches: &matches, counts: &counts, support, range, row_offset: 0 };
        let raised = |limits: &HealthLimits, before| {
            let mut health = PairHealth { now: before, ..PairHealth::default() };
            HealthMonitor::new().check_matches(limits, [image; 2], &findings, &mut health);
            (health.now, health.still.unwrap().pattern_permille)
        };
        let (_, pattern_permille) = raised(&HealthLimits::DEFAULT, HealthFlags::GOOD);
        let limits = HealthLimits {
            still_permille: 125,
            pattern_permille,
            least_disparity_q6: -64,
            unwitnessed_permille: 30,
            beyond_range_permille: 51,
            // Both images are one: no match is one.
            row_region_q8: u16::MAX,
            row_limit_q8: u16::MAX,
            ..HealthLimits::DEFAULT
        };
        let now = |limits| raised(&limits, HealthFlags::GOOD).0;
        assert_eq!(now(limits), HealthFlags::GOOD);
        assert_eq!(now(HealthLimits { still_permille: 124, ..limits }), HealthFlags::NO_PARALLAX);
        assert_eq!(now(HealthLimits { pattern_permille: pattern_permille - 1, ..limits }), HealthFlags::SAME_PIXEL);
        assert_eq!(now(HealthLimits { least_disparity_q6: -63, ..limits }), HealthFlags::BEYOND_INFINITY);
        assert_eq!(now(HealthLimits { unwitnessed_permille: 31, ..limits }), HealthFlags::FEW_MATCHES);
        let small = HealthLimits { beyond_range_permille: 50, ..limits };
        assert_eq!(now(small), HealthFlags::RANGE_SMALL);
        assert_eq!(
            raised(&small, HealthFlags::LEFT_DEAD).0,
            HealthFlags::LEFT_DEAD,
            "a fault of a camera does the same"
        );
    }

    /// Faults of the left camera beside a right one of level 100 and detail 10.
    fn faults(health: CameraHealth, is_flat: bool) -> HealthFlags {
        let check = |health, is_flat| camera::CameraCheck { health, is_flat, digest: 1 };
        let usual = CameraHealth { level: 100, detail_q4: 160, view_permille: 1000, ..CameraHealth::default() };
        HealthMonitor::new().fault(&HealthLimits::DEFAULT, &check(health, is_flat), &check(usual, false), 0)
    }

    #[test]
    fn a_camera_is_covered_when_it_is_black_or_plain_beside_the_other() {
        let camera =
            |level, detail_q4| CameraHealth { level, detail_q4, view_permille: 1000, ..CameraHealth::default() };
        let is_covered = |health| faults(health, false).contains(HealthFlags::LEFT_COVERED);
        assert_eq!([11, 12].map(|level| is_covered(camera(level, 160))), [true, false], "black");
        // A third of the other's detail, at half its level a sixth.
        assert_eq!([53, 54].map(|detail_q4| is_covered(camera(100, detail_q4))), [true, false]);
        assert_eq!(
            [79, 80].map(|detail_q4| is_covered(camera(150, detail_q4))),
            [true, false],
            "the limit itself is none"
        );
        assert_eq!([26, 27].map(|detail_q4| is_covered(camera(50, detail_q4))), [true, false]);
        let overexposed = CameraHealth { white_permille: 251, ..camera(100, 0) };
        assert_eq!(
            [250, 251].map(|white_permille| is_covered(CameraHealth { white_permille, ..overexposed })),
            [true, false]
        );
        assert_eq!(faults(camera(100, 0), true), HealthFlags::LEFT_DEAD, "flat is dead, not covered");
    }

    #[test]
    fn levels_saturation_and_view_have_limits() {
        let usual = CameraHealth { level: 100, detail_q4: 160, view_permille: 1000, ..CameraHealth::default() };
        assert_eq!(faults(usual, false), HealthFlags::GOOD);
        for (level, is_good) in [(19, false), (20, true), (235, true), (236, false)] {
            assert_eq!(faults(CameraHealth { level, ..usual }, false) == HealthFlags::GOOD, is_good, "{level}");
        }
        for (black_permille, white_permille, flag) in
            [(150, 100, HealthFlags::GOOD), (150, 101, HealthFlags::LEFT_SATURATED)]
        {
            assert_eq!(faults(CameraHealth { black_permille, white_permille, ..usual }, false), flag);
        }
        assert_eq!(faults(CameraHealth { view_permille: 500, ..usual }, false), HealthFlags::GOOD);
        assert_eq!(faults(CameraHealth { view_permille: 499, ..usual }, false), HealthFlags::LEFT_VIEW);
    }
}
