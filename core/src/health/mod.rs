//! Health of a pair: faults of the images and the cameras, and changes of the rig since
//! calibration.
//!
//! In: the pair, its times of capture, its matches. Out: a [`PairHealth`]: a few numbers and the
//! flags that they raise.
//!
//! ```text
//! before matching: HealthMonitor::check_images          skew, levels, saturation, dead, covered and frozen cameras, valid view
//!                  PairHealth::is_refused                captured too far apart: not to be matched
//! after it:        HealthMonitor::check_matches          difference of rows (rows), few matches, matches beyond infinity and beyond the range,
//!                                                        what is at the same pixel of both
//!                                                            images (still), torn images (tear)
//! ```
//! A flag is raised by the pair that shows the fault and stays until [`HealthLimits::clear_after`]
//! pairs in a row were free of it. A pair that cannot measure rows (no edges to compare them with),
//! or was matched without segments, does not change the flags of rows and of segments: they are
//! faults of the rig. The one exception is rows that are far apart, which support points tell as
//! well. Differences of rows by edges are smoothed first:
//!
//! ```text
//! short += (offset - short) / min(pairs, 8)       rows_off    |short| above the limit
//! long  += (offset - long)  / min(pairs, 256)     rows_drift  |short - long| above the limit, after 16 pairs with a measurement
//! ```
//!
//! # Faults that a pair does not show
//! - **Yaw** (a camera turned towards the other one or away) moves every point along its row: all
//!   disparities change by about the same number of pixels, and rows do not change. Depth `f * B /
//!   d` is then wrong by `error / d`: most for far points. [`HealthFlags::BEYOND_INFINITY`] detects
//!   one direction of it, if something far is in view and negative disparities are searched.
//! - **The baseline** scales every depth and changes no image.
//! - **The focal length**, if it changes in both cameras alike, scales every depth as well.
//!
//! Remedy: measure something very far (its disparity plus the rig's offset has to be 0, within 0.2
//! px) and one known distance. Pitch (rows move), roll (rows move one way left and the other way
//! right) and a focal length that changes in one camera only (rows spread) are detected beyond the
//! limits.
//!
//! # Cost
//! Some 7 % of the instructions of a QVGA pair: a third of them for rows, by edges and by points, a
//! third for tears, the rest for the images and likeness at the same pixel. A monitor has less than
//! 100 bytes.

mod camera;
mod evenness;
mod flags;
mod limits;
pub(crate) mod rows;
mod still;
mod tear;

use crate::cores::{Cores, join};
use crate::image::{Dims, Gray};
use crate::result::{Counts, Match, Rejection};
use crate::sort::keep_largest;
use crate::support::Support;
pub use crate::support::{Noise, RangeCheck};
use crate::units::{Confidence, quotient};
pub use camera::CameraHealth;
use core::cmp::Reverse;
use evenness::Evenness;
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
    /// Difference of rows, smoothed over [`HealthLimits::row_pairs`], 1/256 px; `None` until a pair
    /// has measured it.
    pub row_offset_q8: Option<i16>,
    /// Difference between that and its long mean, 1/256 px; `None` until 16 pairs have measured it.
    pub row_drift_q8: Option<i16>,
    /// The third smallest disparity among the matches (of the larger of their ends), 1/64 px;
    /// `None` with fewer matches.
    pub least_disparity_q6: Option<i16>,
    /// Windows that match beyond the disparity range; `None` until the pair is matched.
    pub range: Option<RangeCheck>,
    /// Noise of the left and the right image; `None` until the pair is matched.
    pub noise: Option<[Noise; 2]>,
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
    /// Noise of both images.
    pub noise: [Noise; 2],
    /// Row of the right image at which row 0 of the left one was matched.
    pub row_offset: i32,
    /// Segments were matched; without them nothing is said of few matches, and of matches beyond
    /// infinity.
    pub has_segments: bool,
    /// The whole pair was matched, not areas of it: points are everywhere.
    pub is_whole: bool,
}

impl PairHealth {
    /// True when the images were captured too far apart to be matched.
    #[must_use]
    pub const fn is_refused(&self) -> bool {
        self.now.contains(HealthFlags::SKEW)
    }
}

/// Measurements of a matched pair by its support points.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OfPoints {
    evenness: Option<Evenness>,
    still: Option<Still>,
    tear: Option<Tear>,
}

impl OfPoints {
    pub(crate) fn new(
        images: [Gray<'_>; 2],
        support: Support<'_>,
        row_offset: i32,
        is_whole: bool,
    ) -> Self {
        Self {
            evenness: evenness::measure(images, support, row_offset),
            still: still::measure(images, support),
            tear: tear::find(images, support, is_whole),
        }
    }

    /// True when most samples agree about the rows: of images of other rows they do not, or points
    /// are few.
    pub(crate) fn agree_on_rows(&self) -> bool {
        self.evenness.is_some_and(Evenness::mostly_agrees)
    }
}

/// Measurements of a matched pair.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Measured {
    pub(crate) of_points: OfPoints,
    /// Difference of rows by the edges of matches.
    pub(crate) by_edges: Option<Rows>,
}

impl Measured {
    pub(crate) fn new(images: [Gray<'_>; 2], found: &Findings<'_>) -> Self {
        let [left, right] = images;
        Self {
            of_points: OfPoints::new(images, found.support, found.row_offset, found.is_whole),
            by_edges: rows::measure(left, right, credible(found.matches)),
        }
    }
}

/// State of health over consecutive pairs.
///
/// ```
/// use linestereo::{Dims, Gray};
/// use linestereo::health::{HealthFlags, HealthLimits};
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
        Self {
            last: [None; 2],
            same: [0; 2],
            held: [0; FLAGS],
            short_q16: 0,
            long_q16: 0,
            pairs: 0,
        }
    }

    /// Checks a pair before it is matched. `times_us` holds the times of capture of the left and
    /// the right image, us of one clock; without them no pair is refused.
    pub fn check_images(
        &mut self,
        limits: &HealthLimits,
        left: Gray<'_>,
        right: Gray<'_>,
        times_us: Option<[u64; 2]>,
    ) -> PairHealth {
        self.check_images_on(None, limits, [left, right], times_us)
    }

    /// As [`HealthMonitor::check_images`], on two cores.
    #[inline] // into the one above, where there is one core
    pub(crate) fn check_images_on(
        &mut self,
        cores: Option<&mut dyn Cores>,
        limits: &HealthLimits,
        images: [Gray<'_>; 2],
        times_us: Option<[u64; 2]>,
    ) -> PairHealth {
        let mut checks = [camera::CameraCheck::default(); 2];
        let [of_left, of_right] = &mut checks;
        let [left, right] = images.map(|image| move || camera::check(image, limits.dead_range));
        join(cores, || *of_left = left(), || *of_right = right());
        let [left, right] = &checks;
        let mut now = self.fault(limits, left, right, 0) | self.fault(limits, right, left, 1);
        // Without times nothing is known of their difference.
        let tested = CAMERA_FLAGS | HealthFlags::SKEW;
        let levels = checks.each_ref().map(|check| u32::from(check.health.level).max(1));
        let (low, high) = (levels[0].min(levels[1]), levels[0].max(levels[1]));
        now |= HealthFlags::EXPOSURES_DIFFER
            .when(high << 8 > low * u32::from(limits.exposure_ratio_q8));
        let skew = times_us.map(|times| limits.skew_us(times));
        now |= HealthFlags::SKEW.when(skew.is_some_and(|skew| skew.is_err()));
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
        let measured = Measured::new(images, found);
        self.judge(limits, images[0], found, measured, health);
    }

    /// Checks what was measured of the pair, and adds to its health.
    #[inline] // into the one above, where there is one core
    pub(crate) fn judge(
        &mut self,
        limits: &HealthLimits,
        left: Gray<'_>,
        found: &Findings<'_>,
        measured: Measured,
        health: &mut PairHealth,
    ) {
        let Measured { of_points: OfPoints { evenness: by_points, still, tear }, by_edges } =
            measured;
        (health.still, health.tear) = (still, tear);
        let (mut now, mut tested) =
            self.check_rows(limits, left.dims(), found, by_points, by_edges, health);
        if found.has_segments {
            tested |= HealthFlags::FEW_MATCHES | HealthFlags::BEYOND_INFINITY;
            let rows_are_known =
                health.rows.is_some() || by_points.is_some_and(Evenness::is_witness);
            let are_few = are_few(found.counts, limits, rows_are_known)
                && !are_credible(found.support, by_points, limits);
            now |= HealthFlags::FEW_MATCHES.when(are_few);
            health.least_disparity_q6 = third_least_q6(found.matches);
            let beyond = health.least_disparity_q6.is_some_and(|d| d < limits.least_disparity_q6);
            now |= HealthFlags::BEYOND_INFINITY.when(beyond);
        }

        (health.range, health.noise) = (Some(found.range), Some(found.noise));
        // A fault of a camera leaves windows without a match as well.
        if !health.now.intersects(CAMERA_FLAGS.intersection(HealthFlags::UNFIT)) {
            tested |= HealthFlags::RANGE_SMALL;
            now |= HealthFlags::RANGE_SMALL.when(is_small(&found.range, limits));
        }
        tested |= HealthFlags::NO_PARALLAX | HealthFlags::SAME_PIXEL | HealthFlags::TORN;
        if let Some(still) = health.still {
            now |= HealthFlags::NO_PARALLAX.when(still.still_permille > limits.still_permille);
            // Text and dirt that windows match are no parallax there, and what is alike elsewhere
            // is less.
            let most = limits.pattern_permille
                >> if still.still_permille > SOME_STILL_PERMILLE { 2 } else { 0 };
            now |= HealthFlags::SAME_PIXEL.when(still.pattern_permille > most);
        }
        now |= HealthFlags::TORN.when(health.tear.is_some());
        health.now |= now;
        health.flags = self.hold(limits, now, tested);
    }

    /// Measures the difference of rows and adds it to the health; returns the flags raised and
    /// those tested.
    fn check_rows(
        &mut self,
        limits: &HealthLimits,
        Dims { width, .. }: Dims,
        found: &Findings<'_>,
        by_points: Option<Evenness>,
        by_edges: Option<Rows>,
        health: &mut PairHealth,
    ) -> (HealthFlags, HealthFlags) {
        let (mut now, mut tested) = (HealthFlags::GOOD, HealthFlags::GOOD);
        let most_q8 = at_width(limits.row_region_q8.into(), width);
        let spread_q8 = by_points.map(|even| i32::from(even.spread_q8));
        let mut is_uneven = spread_q8.map(|spread| spread > most_q8);
        // Edges are few and each of them may be wrong: points have to be in doubt as well.
        let are_even = spread_q8.is_some_and(|spread| spread <= most_q8 / 2);
        if let Some(rows) = by_edges
            && let Some(by_edges) = are_uneven(&rows, limits, width)
        {
            // Nor do points decide by little against edges that are even.
            let most_q8 = if by_edges { most_q8 } else { 2 * most_q8 };
            is_uneven =
                Some(spread_q8.is_some_and(|spread| spread > most_q8) || by_edges && !are_even);
            let offset_q8 =
                by_points.filter(|_| by_edges && are_even).map_or(rows.offset_q8, |even| {
                    // Edges are in doubt.
                    even.offset_q8.saturating_add((found.row_offset << 8) as i16)
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
        if self.pairs > 0 {
            let offset_q8 = (self.short_q16 + 128) >> 8;
            health.row_offset_q8 = i16::try_from(offset_q8).ok();
            let is_beyond = |limit_q8: u16| offset_q8.unsigned_abs() > u32::from(limit_q8);
            now |= tested.intersection(HealthFlags::ROWS_OFF).when(is_beyond(limits.row_offset_q8));
            now |= tested.intersection(HealthFlags::ROWS_FAR).when(is_beyond(limits.row_limit_q8));
        }
        // Edges that agree know it better.
        if let Some(even) = by_points.filter(|_| !tested.contains(HealthFlags::ROWS_FAR)) {
            let offset_q8 = i32::from(even.offset_q8) + (found.row_offset << 8);
            let is_far = offset_q8.unsigned_abs() > u32::from(limits.row_limit_q8);
            now |= HealthFlags::ROWS_FAR.when(is_far);
            tested |= HealthFlags::ROWS_FAR.when(even.is_witness());
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

    /// Faults of one camera's image; `camera` is 0 or 1: its flags are those of the left one,
    /// shifted by it.
    fn fault(
        &mut self,
        limits: &HealthLimits,
        own: &camera::CameraCheck,
        other: &camera::CameraCheck,
        camera: usize,
    ) -> HealthFlags {
        let health = &own.health;
        let is_saturated =
            health.black_permille + health.white_permille > limits.saturated_permille;
        let is_black =
            health.level < limits.covered_level && other.health.level / 4 >= health.level.max(1);
        // detail / level, compared by cross products; an overexposed image loses its detail as
        // well, and is not covered.
        let relative =
            |a: &CameraHealth, b: &CameraHealth| u32::from(a.detail_q4) * u32::from(b.level.max(1));
        let is_plain = u32::from(other.health.detail_q4) >= MIN_DETAIL_Q4
            && relative(health, &other.health) * u32::from(limits.covered_ratio)
                < relative(&other.health, health)
            && health.white_permille <= limits.saturated_permille;
        let is_same = self.is_same(own.digest, camera, limits);
        let (darkest, brightest) = limits.level;
        let left = HealthFlags::LEFT_EXPOSURE
            .when(health.level < darkest || health.level > brightest)
            | HealthFlags::LEFT_SATURATED.when(is_saturated)
            | HealthFlags::LEFT_DEAD.when(own.is_flat)
            | HealthFlags::LEFT_COVERED.when((is_black || is_plain) && !own.is_flat)
            | HealthFlags::LEFT_FROZEN.when(is_same && !own.is_flat)
            | HealthFlags::LEFT_VIEW.when(health.view_permille < limits.view_permille);
        HealthFlags::from_bits_retain(left.bits() << camera)
    }

    /// True when this camera's image has been the same for more than [`HealthLimits::frozen_pairs`]
    /// pairs.
    fn is_same(&mut self, digest: u32, camera: usize, limits: &HealthLimits) -> bool {
        let (Some(last), Some(same)) = (self.last.get_mut(camera), self.same.get_mut(camera))
        else {
            return false;
        };
        *same = if last.replace(digest) == Some(digest) { same.saturating_add(1) } else { 0 };
        *same > limits.frozen_pairs
    }

    /// Raises and clears flags, and returns those that are set. Only `tested` flags are cleared.
    #[inline(never)]
    fn hold(
        &mut self,
        limits: &HealthLimits,
        now: HealthFlags,
        tested: HealthFlags,
    ) -> HealthFlags {
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
const CAMERA_FLAGS: HealthFlags =
    HealthFlags::from_bits_retain((HealthFlags::EXPOSURES_DIFFER.bits() << 1) - 1);

/// True when few of the segments compared are matched.
fn are_few(counts: &Counts, limits: &HealthLimits, rows_are_known: bool) -> bool {
    let compared = counts.segments_left.saturating_sub(counts.rejected(Rejection::LessProminent));
    let least = if rows_are_known { limits.matched_permille } else { limits.unwitnessed_permille };
    compared >= MIN_COMPARED
        && u32::from(counts.matched) * 1000 < u32::from(compared) * u32::from(least)
}

/// True when support points show that the images are a pair, whatever segments say: enough are
/// credible, and most of a sample agree about the rows, or enough lie on the ground.
fn are_credible(support: Support<'_>, by_points: Option<Evenness>, limits: &HealthLimits) -> bool {
    let (mut credible, mut on_ground) = (0_u32, 0_u32);
    for (_, point) in support.iter().filter(|(_, point)| point.confidence() >= CREDIBLE) {
        credible += u32::from(point.is_matched());
        on_ground += u32::from(point.is_beside_ground());
    }
    let is_share =
        |points: u32, permille: u16| points * 1000 > support.len() as u32 * u32::from(permille);
    is_share(credible, limits.credible_permille)
        && (by_points.is_some_and(Evenness::mostly_agrees)
            || is_share(on_ground, limits.credible_ground_permille))
}

/// Width of the images that limits in pixels are said for, px.
const QVGA_WIDTH: u16 = 320;

/// A limit of QVGA images in images of this width: the same cameras have twice the spread, and the
/// same scene twice the parallax, in images of twice the size.
fn at_width(limit: i32, width: u16) -> i32 {
    quotient(limit * i32::from(width.max(QVGA_WIDTH)), QVGA_WIDTH.into())
}

/// Probability of a credible support point or match.
const CREDIBLE: Confidence = Confidence::from_bits(58982);

/// The credible matches, which come first: a pair is as healthy whatever is listed of it.
fn credible(matches: &[Match]) -> &[Match] {
    let count = matches.partition_point(|found| found.confidence >= CREDIBLE);
    matches.get(..count).unwrap_or(&[])
}

/// Least number of matches whose differences of rows can be uneven.
const LEAST_SAMPLES: u8 = 4;

/// True when the rows of a pair are uneven, false when they are even; `None` where too few matches
/// tell neither.
fn are_uneven(rows: &Rows, limits: &HealthLimits, width: u16) -> Option<bool> {
    let most = at_width(limits.row_spread_q8.into(), width);
    if rows.samples >= limits.min_row_samples {
        return Some(i32::from(rows.spread_q8) > most);
    }
    // The spread of few is known less well: it takes twice as much, and an even one is no
    // measurement.
    (rows.samples >= LEAST_SAMPLES && i32::from(rows.spread_q8 / 2) > most).then_some(true)
}

/// True when enough windows match beyond the range.
fn is_small(range: &RangeCheck, limits: &HealthLimits) -> bool {
    let share = u32::from(range.windows) * u32::from(limits.beyond_range_permille);
    range.beyond >= limits.min_beyond_range && u32::from(range.beyond) * 1000 >= share
}

/// The third smallest disparity of the matches, of the larger of their ends, 1/64 px.
fn third_least_q6(matches: &[Match]) -> Option<i16> {
    let mut least = [Reverse(i16::MAX); BEYOND];
    for found in matches {
        let [d0, d1] = found.disparity.map(crate::units::Disparity::to_bits);
        keep_largest(&mut least, Reverse(d0.max(d1)));
    }
    let [.., Reverse(third)] = least;
    (third < i16::MAX).then_some(third)
}

#[cfg(test)]
mod tests;
