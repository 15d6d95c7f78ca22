//! Nearest obstacle and nearest drop-off in each direction, by matched segments and support points,
//! as autopilots take it.
//!
//! In: an [`ObstaclePlan`] (the view as sectors, computed once), the matches, bars and support
//! points of a pair, its health and time of capture. Out: [`Obstacles`], the state of each
//! [`Sector`] of a full turn around the vehicle: an obstacle at a distance, free, unknown, or
//! outside the view; and the nearest [`DropOff`] in it.
//!
//! ```text
//! per match, in each sector that it crosses, per bar or side of a segment beside those that agree
//!     with it, and per support point (with a probability of at most 0.8: errors of neighbours are
//!     correlated; of at most 0.6 up to 2 px before the ground, where more points around it lie on
//!     that; of images wider than 450 px two count as one):
//!   within the range and the height band     one of the nearest hypotheses of the sector
//!   behind them                              a hypothesis that the sector is free
//!   2 px and more behind the ground plane    a hypothesis of a drop-off, where the plane is seen
//!       at the lower end of the point, and would be by the right camera
//! per sector, from the nearest hypothesis on:
//!   product of the error probabilities, 1 - confidence, of the hypotheses that agree with it
//!       (up to 1 px and 1/16 of the nearness behind it), from near to far; the obstacle is where
//!       the product falls to the limit: something is at least so near, but for that probability
//!   where it does not fall so far, but to 1/16: also of the support points of both sectors beside
//!       it that agree; the obstacle is where its own product falls to 1/16
//!   none is within the range, no credible one up to 5/4 of it, and the error probabilities of
//!   credible hypotheses behind it, in each half of the sector at the rows that count, have a
//!   product below the limit: free
//!   otherwise no result
//!   drop-off: the product falls to the limit over hypotheses up to a quarter of the nearness
//!       behind the nearest of them, which is told
//! a result replaces the state of the sector, unless that is an obstacle nearer by more than
//!     1/8, which stays until it is too old
//! ```
//!
//! # Terms
//! - **Distance** and **direction**: along the ground, from the camera to the obstacle (not the
//!   depth along the optical axis). With the ground plane of the pair
//!   ([`ObstaclePlan::on_ground`]) they are right whatever pitch and roll are; without it sectors
//!   tilt with the camera.
//! - **Height band**: above and below the camera. With the plane it is parallel to the ground; what
//!   lies at most 0.75 px or a twentieth of its disparity before the plane
//!   ([`ground_tolerance`]) is the ground and no obstacle, and what lies behind it is neither free
//!   nor one. Without the plane the band tilts with the camera.
//! - **Free**: credible segments or support points lie *behind* the range in this sector, none
//!   within it, and the whole sector is seen by both cameras from the near limit on. With a ground
//!   plane they lie in each half of the sector at all rows in which something within the range
//!   would stand, without two neighbouring rows of support points between them that have none, and
//!   without one that has only doubtful ones. Points that their neighbours alone put on the ground
//!   are doubtful: the side of a blank box is like this. Without a plane, one in each half above
//!   and one below the camera's own height: of what is lower nothing is known. Obstacles are
//!   possible all the same: a wall without texture, a wire along the rows and anything nearer than
//!   the near limit ([`Params::largest_disparity`](crate::Params::largest_disparity)) give no
//!   credible hypothesis. A sector without hypotheses is unknown, not free.
//! - **Unknown**: too few hypotheses, or too old ones.
//! - **Outside**: never in view of this camera. Sectors partly in view can have obstacles, but are
//!   never free; nor are those near the left border,
//!   where near points are outside the right camera's view.
//!
//! - **Drop-off**: the floor is missing from this distance on: a step down, stairs, the edge of a
//!   table. A ray that goes on through the ground plane proves it, so the lower floor has to be
//!   seen; a dark or blank pit has no hypotheses, and its sector is unknown. A sector with a
//!   drop-off within the range is never free. Without a ground plane nothing is said.
//!
//! # Bounds
//! At most [`MAX_IN_VIEW`] sectors are in view (less than half a turn), 72 in a turn. Nearness
//! (disparity plus offset, by the distance along the ground per depth) is below 2^22 in 1/64 px;
//! f*B in Q16 times 6400 below 2^53; a height in Q16 times a disparity below 2^46.
//!
//! # Cost
//! 600 bytes of state, 4.6 KB of stack. Instructions: `xtask/board-numbers.toml`.

mod hypotheses;
mod low;
mod plan;
mod tilt;

use crate::health::HealthFlags;
use crate::image::Dims;
use crate::result::{ImagePosition, Match, Point, Source};
use crate::support::SUPPORT_PITCH;
use crate::units::{Confidence, Disparity, Position, quotient};
use hypotheses::{Hypotheses, POINT, Ray, STRONG_Q16, agree_q6};
pub(crate) use low::beside_ground;
use plan::Ground;
pub use plan::{MAX_IN_VIEW, ObstacleError, ObstacleParam, ObstacleParams, ObstaclePlan};
use tilt::Along;

/// Least probability of a support point for sectors. Chosen on the rooms of `robot_world`, where
/// 0.3, 0.5, 0.7 and 0.9 show 48, 46, 44 and 34 % of the obstacles, with a ghost before 0.7, 0.7,
/// 0.5 and 0.3 % of them. Drives that did not choose it, points of 0.9 and 0.5: table legs 38 and
/// 56 %, doorway 41 and 60 %; on a ramp, whose ghosts rise from 23 to 27 %, 39 and 43 %.
pub const LEAST_CONFIDENCE: Confidence = Confidence::from_bits(0x8000);

/// Largest probability for sectors of a support point that its neighbours alone put beside the
/// ground plane: too little to make a direction free. 0.875.
pub const DOUBTFUL_GROUND: Confidence = Confidence::from_bits(0xe000);

/// Largest distance before the ground plane of what may be a part of it, px, at this disparity: a
/// twentieth of it, or 0.75 px if that is more. A twentieth of the disparity is a twentieth of the
/// camera's height.
#[must_use]
pub const fn ground_tolerance(disparity: Disparity) -> Disparity {
    Disparity::from_bits(ground_tolerance_q6(disparity.to_bits() as i32) as i16)
}

const fn ground_tolerance_q6(d_q6: i32) -> i32 {
    let part = d_q6 / GROUND_PART;
    if part > GROUND_Q6 { part } else { GROUND_Q6 }
}

/// Least distance behind the ground plane of what shows a drop-off, px.
pub const BELOW_GROUND: Disparity = Disparity::from_bits(BELOW_Q6 as i16);

/// [`ground_tolerance`] of what is far away, 1/64 px.
const GROUND_Q6: i32 = 48;
/// Part of the disparity that is the tolerance of what is near. Chosen on `robot_world` and the
/// drives corridor, table legs and doorway, in directions up to 3 m at all heights, each camera's
/// pose as it is: of some 500 obstacles told 63 are nearer by a quarter than anything 2 cm high;
/// with a twentieth 32, of which a sixteenth leaves 30. With poses off by 2 %, 0.7 and 0.5 degrees
/// 257 and 118 of some 2000. Sets that did not choose it (ramp, drop-off, `robot_world_640`): 16 of
/// 40 and 5 of 38.
const GROUND_PART: i32 = 20;
/// [`BELOW_GROUND`], 1/64 px. Chosen on `robot_world` and
/// `robot_sequences`: with 1, 1.5 and 2 px 53, 50 and 51 % of the drop-offs within 2 m are told,
/// and 3.6, 1.5 and 1.1 % of the sectors without one have one. Sets that did not choose it: none in
/// 385 sectors of homes and of Middlebury at 320 px, and 56 of 425 on roads (KITTI), where the
/// laser sees ground below the plane in 52.
const BELOW_Q6: i32 = 128;

/// Least error probability of a support point, Q16: 0.2, since errors of neighbours, which share
/// paths, are correlated.
const LEAST_POINT_ERROR_Q16: u16 = 13107;

/// Most parts that the rows are divided into, 8 px high or more: with 240 rows one for each row of
/// support points. Chosen, with the rules of what is free, on blank boxes of 8 to 22 cm and kerbs
/// of 6 to 9 cm drawn on textured floors within 3 m (80 pairs): of 149 sectors that one fills 66
/// were called free by eight parts with two hypotheses in each, 7 are now, and of 600 without one
/// 262 and 187. As many pairs that chose nothing: 60 and 8 of 157, and 217 and 149 of 600. Of the
/// clear sectors of `robot_world` 5 and 3 %, of a doorway 14 and 4 %.
const PARTS_OF_ROWS: i32 = 30;

/// State of one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Sector {
    /// Not in view of the camera.
    Outside,
    /// In view, but without a credible hypothesis, or with too old ones.
    Unknown,
    /// Credible segments or support points behind the range, none within it. Obstacles without
    /// texture, such as a blank wall, are not detected.
    Free {
        /// Probability that not all of the hypotheses behind the range are wrong.
        confidence: Confidence,
        /// Time since they were seen, ms.
        age_ms: u32,
    },
    /// An obstacle within the range.
    Obstacle {
        /// Distance along the ground, cm; 1 or more, below the range.
        distance_cm: u16,
        /// Probability that something is at least so near.
        confidence: Confidence,
        /// Time since it was seen, ms.
        age_ms: u32,
    },
}

/// The floor ends: a step down, stairs, the edge of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DropOff {
    /// Distance along the ground to its edge, cm; 1 or more, below the range.
    pub distance_cm: u16,
    /// Probability that not all hypotheses of it are wrong.
    pub confidence: Confidence,
    /// Time since it was seen, ms.
    pub age_ms: u32,
}

/// Stored state of one direction, eight bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Known {
    /// [`NOTHING`], [`FREE`] or an obstacle's distance.
    distance_cm: u16,
    confidence_q16: u16,
    /// Time at which it was seen, ms, wrapping.
    seen_ms: u32,
}

const NOTHING: u16 = 0;
const FREE: u16 = u16::MAX;

impl Known {
    const NONE: Self = Self { distance_cm: NOTHING, confidence_q16: 0, seen_ms: 0 };

    /// Takes the result of a pair: a nearness (1/64 px, `None`: free) and its error probability.
    fn update(&mut self, plan: &ObstaclePlan, now_ms: u32, result: Option<(Option<i32>, u16)>) {
        if self.distance_cm != NOTHING && now_ms.wrapping_sub(self.seen_ms) > plan.keep_ms {
            *self = Self::NONE;
        }
        let Some((nearness_q6, error_q16)) = result else { return };
        let distance_cm = nearness_q6.map_or(FREE, |nearness_q6| plan.distance_cm(nearness_q6));
        if !keeps_previous(self.distance_cm, distance_cm) {
            *self = Self { distance_cm, confidence_q16: u16::MAX - error_q16, seen_ms: now_ms };
        }
    }
}

/// State of every direction, kept between pairs.
///
/// ```
/// use linestereo::{Dims, Params, Rig};
/// use linestereo::health::HealthFlags;
/// use linestereo::obstacles::{ObstacleParams, Obstacles, Sector};
/// let dims = Dims { width: 320, height: 240 };
/// let params = Params { rig: Some(Rig::new(300.0, 0.1, 0.0)?), ..Params::default() };
/// let plan = ObstacleParams::DEFAULT.plan(&params, dims)?;
/// let mut obstacles = Obstacles::new();
/// obstacles.update(&plan, &[], None, HealthFlags::GOOD, 0); // no segment: unknown, not free
/// assert_eq!(obstacles.sector(&plan, 0, 0), Sector::Unknown); // ahead
/// assert_eq!(obstacles.sector(&plan, 36, 0), Sector::Outside); // behind
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Obstacles {
    known: [Known; MAX_IN_VIEW],
    drop_offs: [Known; MAX_IN_VIEW],
    is_fit: bool,
}

impl Default for Obstacles {
    fn default() -> Self {
        Self::new()
    }
}

impl Obstacles {
    /// All sectors unknown.
    #[must_use]
    pub const fn new() -> Self {
        let none = [Known::NONE; MAX_IN_VIEW];
        Self { known: none, drop_offs: none, is_fit: false }
    }

    /// Updates the sectors by the matches of a pair and by the support points, bars and sides
    /// among `points` ([`Matched::obstacle_points`](crate::Matched::obstacle_points));
    /// `time_us` is its time of capture, us of a monotonic clock, `health` its
    /// [flags](crate::health::PairHealth::flags). A pair that is not fit to be used changes no
    /// sector but by age. The whole pair has to be matched: what stands outside of
    /// [areas](crate::Options::areas) is not seen.
    /// [`Matched::update_obstacles`](crate::Matched::update_obstacles) takes all of it from a pair.
    #[inline(never)]
    pub fn update(
        &mut self,
        plan: &ObstaclePlan,
        matches: &[Match],
        points: impl IntoIterator<Item = Point>,
        health: HealthFlags,
        time_us: u64,
    ) {
        let now_ms = milliseconds(time_us);
        self.is_fit = !health.intersects(plan.unfit);
        // With a sector on each side of the view, where nothing is seen.
        let mut found = [Hypotheses::NONE; MAX_IN_VIEW + 2];
        if self.is_fit
            && let Some(found) = found.get_mut(1..)
        {
            for one in matches {
                let error_q16 = (u16::MAX - one.confidence.to_bits()) & !POINT;
                plan.for_each_sector(one, |sector, ray| {
                    if let Some(hypotheses) = found.get_mut(sector) {
                        hypotheses.add(ray, error_q16);
                    }
                });
            }
            plan.add_points(points, found);
        }
        let states = self.known.iter_mut().zip(&mut self.drop_offs);
        for (((known, drop_off), near), sector) in states.zip(found.windows(3)).zip(0_u32..) {
            let [before, hypotheses, after] = near else { return };
            let can_be_free = plan.complete >> sector & 1 == 1;
            let obstacle = hypotheses.obstacle(plan, can_be_free, [before, after]);
            known.update(plan, now_ms, obstacle);
            let below = hypotheses.drop_off(plan.error_q16);
            drop_off.update(
                plan,
                now_ms,
                below.map(|group| (Some(group.nearest_q6), group.error_q16)),
            );
        }
    }

    /// Records that there was no pair, or a refused one: sectors age, and [`Obstacles::is_fit`] is
    /// false.
    pub fn mark_missing(&mut self) {
        self.is_fit = false;
    }

    /// True when the last pair was fit to be used; false before the first.
    #[must_use]
    pub fn is_fit(&self) -> bool {
        self.is_fit
    }

    /// State of a direction: 0 is ahead of the vehicle, then clockwise, seen from above.
    #[must_use]
    pub fn sector(&self, plan: &ObstaclePlan, index: u8, time_us: u64) -> Sector {
        let Some(known) = plan.in_view(index).and_then(|index| self.known.get(index)) else {
            return Sector::Outside;
        };
        let age_ms = milliseconds(time_us).wrapping_sub(known.seen_ms);
        let confidence = Confidence::from_bits(known.confidence_q16);
        match known.distance_cm {
            NOTHING => Sector::Unknown,
            _ if age_ms > plan.keep_ms => Sector::Unknown,
            FREE if self.drop_off(plan, index, time_us).is_some() => Sector::Unknown,
            FREE => Sector::Free { confidence, age_ms },
            distance_cm => Sector::Obstacle { distance_cm, confidence, age_ms },
        }
    }

    /// The nearest drop-off in a direction, counted as for [`Obstacles::sector`]; `None` where none
    /// is known.
    #[must_use]
    pub fn drop_off(&self, plan: &ObstaclePlan, index: u8, time_us: u64) -> Option<DropOff> {
        let known = self.drop_offs.get(plan.in_view(index)?)?;
        let age_ms = milliseconds(time_us).wrapping_sub(known.seen_ms);
        let is_known = known.distance_cm != NOTHING && age_ms <= plan.keep_ms;
        let confidence = Confidence::from_bits(known.confidence_q16);
        is_known.then_some(DropOff { distance_cm: known.distance_cm, confidence, age_ms })
    }

    /// Every direction of the turn, from ahead on, clockwise.
    pub fn sectors<'a>(
        &'a self,
        plan: &'a ObstaclePlan,
        time_us: u64,
    ) -> impl Iterator<Item = Sector> + 'a {
        (0..plan.sectors()).map(move |index| self.sector(plan, index, time_us))
    }
}

/// True when the stored state of a sector stays: an obstacle that is nearer than the new result by
/// more than 1/8. That it was not seen again does not prove that it is gone.
fn keeps_previous(known_cm: u16, seen_cm: u16) -> bool {
    let is_obstacle = known_cm != NOTHING && known_cm != FREE;
    is_obstacle && u32::from(known_cm) + u32::from(known_cm) / 8 < u32::from(seen_cm)
}

/// Milliseconds, wrapping.
fn milliseconds(time_us: u64) -> u32 {
    (time_us / 1000) as u32
}

/// A point of a hypothesis.
#[derive(Clone, Copy)]
struct Seen {
    /// Its column as a level camera sees it, 1/32 px.
    column_q5: i32,
    /// Part of its depth that is forward along the ground, Q12.
    forward_q12: i32,
    /// Its nearness along the ground, 1/64 px.
    nearness_q6: i32,
    /// Its pixel, 1/32 px.
    x_q5: i32,
    y_q5: i32,
    /// Its row in the image of a level camera, 1/32 px.
    level_q5: i32,
    /// Its disparity plus offset, 1/64 px.
    d_q6: i32,
    /// Its disparity less that of the ground at its pixel, 1/64 px, where that is known.
    above_q6: Option<i32>,
}

impl ObstaclePlan {
    /// Calls `each` with the index of every sector in view that a match crosses, and its ray there.
    fn for_each_sector(&self, one: &Match, mut each: impl FnMut(usize, Ray)) {
        let bits = |p: Position| i32::from(p.to_bits());
        let seen = |end: ImagePosition, d: Disparity| {
            self.seen(bits(end.x), bits(end.y), i32::from(d.to_bits()) + self.offset_q6)
        };
        let ([end, other], [d, other_d]) = (one.ends, one.disparity);
        let (Some(end), Some(other)) = (seen(end, d), seen(other, other_d)) else { return };
        let (a, b) = if end.column_q5 <= other.column_q5 { (end, other) } else { (other, end) };
        // Between both, where a level camera sees it in this column: weights of a projection.
        let between = |column_q5: i32| {
            let of_a = i64::from(b.column_q5 - column_q5) * i64::from(b.forward_q12);
            let of_b = i64::from(column_q5 - a.column_q5) * i64::from(a.forward_q12);
            let share_q16 = (of_b << 16).checked_div(of_a + of_b).unwrap_or(0);
            let at = |from: i32, to: i32| {
                from + (((i64::from(to) - i64::from(from)) * share_q16) >> 16) as i32
            };
            self.seen(at(a.x_q5, b.x_q5), at(a.y_q5, b.y_q5), at(a.d_q6, b.d_q6))
        };
        let sectors = self.sectors_q5().zip(0..);
        for ([left, right], sector) in sectors.skip(self.sector_from(a.column_q5)) {
            if left > b.column_q5 {
                return;
            }
            let ends = [
                if left <= a.column_q5 { Some(a) } else { between(left) },
                if right >= b.column_q5 { Some(b) } else { between(right) },
            ];
            if let [Some(a), Some(b)] = ends
                && let Some(ray) = self.ray([a, b], [a.y_q5, b.y_q5])
            {
                each(sector, ray);
            }
        }
    }

    /// Adds support points, bars and sides of segments to the hypotheses of their sectors.
    fn add_points(&self, points: impl IntoIterator<Item = Point>, found: &mut [Hypotheses]) {
        // Nearness of the last bar or side in each sector; 0 = none.
        let mut sides = [0_u16; MAX_IN_VIEW];
        for point in points {
            let Some((sector, ray)) = self.ray_of(&point) else { continue };
            let (Some(hypotheses), Some(side)) = (found.get_mut(sector), sides.get_mut(sector))
            else {
                continue;
            };
            let error_q16 = (u16::MAX - point.confidence.to_bits()) & !POINT;
            match (point.source, ray) {
                // Doubtful points may be an obstacle, but make nothing free.
                (Source::Support, Ray::Passes(parts)) if error_q16 > STRONG_Q16 => {
                    hypotheses.doubt(parts);
                }
                (Source::Support, _) => {
                    hypotheses.add(ray, self.error_of_point_q16(error_q16) | POINT);
                }
                (Source::Side, Ray::Ends(nearness_q6) | Ray::Falls(nearness_q6))
                    if nearness_q6 >= self.far_q6 =>
                {
                    // Points of one thing follow each other, and are one witness.
                    let nearness_q6 = nearness_q6.min(u16::MAX.into());
                    let before = i32::from(core::mem::replace(side, nearness_q6 as u16));
                    let is_same = (before - nearness_q6).abs() <= agree_q6(before.max(nearness_q6));
                    if before == 0 || !is_same {
                        hypotheses.add(ray, error_q16);
                    }
                }
                (Source::Side | Source::Segment(_), _) => {}
            }
        }
    }

    /// Error probability of a support point, Q16, as it counts beside others.
    fn error_of_point_q16(&self, error_q16: u16) -> u16 {
        let error_q16 = error_q16.max(LEAST_POINT_ERROR_Q16);
        // Of large images four points are around one that was matched at half of the size, and
        // wrong with it: two of them count as one.
        if self.is_large() { (u32::from(error_q16) << 16).isqrt() as u16 } else { error_q16 }
    }

    /// True for images that are matched at half of their size first.
    pub(super) fn is_large(&self) -> bool {
        Dims { width: self.width, height: self.height }.is_large()
    }

    /// The sector of a support point, and its ray there. It reaches half way to the next points
    /// above and below, but makes its own row alone free: something low may stand between.
    fn ray_of(&self, point: &Point) -> Option<(usize, Ray)> {
        let half = i32::from(SUPPORT_PITCH / 2);
        let (x_q5, y) = (i32::from(point.x) << 5, i32::from(point.y));
        let d_q6 = i32::from(point.disparity.to_bits()) + self.offset_q6;
        // Above the ground by what the point itself is.
        let own = self.seen(x_q5, y << 5, d_q6)?;
        let ends = [y - half, y + half - 1].map(|y| Seen {
            y_q5: y << 5,
            level_q5: if self.ground.is_some() { own.level_q5 } else { y << 5 },
            ..own
        });
        Some((self.sector_of(own.column_q5)?, self.ray(ends, [own.y_q5; 2])?))
    }

    /// A point (column and row in 1/32 px, disparity plus offset in 1/64 px) as a level camera sees
    /// it.
    #[inline(never)] // in four places
    fn seen(&self, x_q5: i32, y_q5: i32, d_q6: i32) -> Option<Seen> {
        let along = self.tilt.along(x_q5, y_q5)?;
        let (level_q5, above_q6) = match self.ground {
            None => (y_q5, None),
            Some(Ground { plane, per_row_q16, .. }) => {
                let ground_q6 = plane.at_q6(x_q5 >> 5, y_q5 >> 5) + self.offset_q6;
                // Rows below the horizon, at which a level camera sees the ground at this
                // disparity.
                let below = quotient(ground_q6.clamp(-(1 << 15), 1 << 15) << 15, per_row_q16);
                (self.row_q5 + below, Some(d_q6 - ground_q6))
            }
        };
        let Along { column_q5, forward_q12, .. } = along;
        let nearness_q6 = along.nearness_q6(d_q6);
        Some(Seen { column_q5, forward_q12, nearness_q6, x_q5, y_q5, level_q5, d_q6, above_q6 })
    }

    /// The ray of a hypothesis between two points, seen in these rows (1/32 px).
    fn ray(&self, points: [Seen; 2], rows_q5: [i32; 2]) -> Option<Ray> {
        let [a, b] = points;
        let nearness_q6 = a.nearness_q6.max(b.nearness_q6);
        let clear_q6 = self.far_q6 - self.far_q6 / 5;
        let is_ground = |point: &Seen| {
            point.above_q6.is_some_and(|above_q6| above_q6 <= ground_tolerance_q6(point.d_q6))
        };
        if points.iter().all(is_ground) {
            // The ground, or a hole in it: no obstacle, and nothing stands before ground that is
            // seen.
            let is_hole = points
                .iter()
                .any(|point| point.above_q6.is_some_and(|above_q6| above_q6 < -GROUND_Q6));
            return if is_hole { self.fall(points) } else { self.passes(points, rows_q5) };
        }
        if nearness_q6 >= clear_q6 && self.band_meets(points) {
            Some(Ray::Ends(nearness_q6))
        } else if nearness_q6 < clear_q6 || self.band_has_camera() {
            self.passes(points, rows_q5)
        } else {
            None
        }
    }

    /// The ray of a hypothesis behind the range, between two points of one sector, seen in these
    /// rows (1/32 px).
    fn passes(&self, points: [Seen; 2], rows_q5: [i32; 2]) -> Option<Ray> {
        let parts = self.parts(rows_q5);
        let [a, b] = points.map(|point| point.column_q5);
        let (from, to) = (a.min(b), a.max(b));
        let sector = self.sector_of(i32::midpoint(from, to))?;
        let [left, right] = self.sectors_q5().nth(sector)?;
        let middle = i32::midpoint(left, right);
        Some(Ray::Passes([from < middle, to >= middle].map(|is| if is { parts } else { 0 })))
    }

    /// The ray of a hypothesis below the ground; `None` where it is not far enough below it, or
    /// meets the plane behind the range.
    fn fall(&self, points: [Seen; 2]) -> Option<Ray> {
        let (Ground { plane, per_row_q16, .. }, least_q16) = (self.ground?, self.drop_q16?);
        let is_below = |point: &Seen| {
            // depth = height * (ground - d) / d, height = baseline / per_row
            let below_q6 = -point.above_q6.unwrap_or(0);
            let least = least_q16
                .saturating_mul(point.d_q6.max(1).into())
                .saturating_mul(per_row_q16.into());
            // Where the right image would not show the ground, chance decides what matches.
            let is_seen = point.x_q5 << 1 >= plane.at_q6(point.x_q5 >> 5, point.y_q5 >> 5);
            is_seen
                && below_q6 >= BELOW_Q6
                && (self.baseline_q16 * i64::from(below_q6)) << 16 >= least
        };
        // Where their rays meet the ground.
        let [a, b] = points.map(|point| {
            let ground_q6 = plane.at_q6(point.x_q5 >> 5, point.y_q5 >> 5) + self.offset_q6;
            self.tilt.along(point.x_q5, point.y_q5).map_or(0, |ray| ray.nearness_q6(ground_q6))
        });
        let nearness_q6 = a.max(b);
        (points.iter().all(is_below) && nearness_q6 >= self.far_q6)
            .then_some(Ray::Falls(nearness_q6))
    }

    /// Index, among the sectors in view, of that of a column (1/32 px); `None` outside of them.
    fn sector_of(&self, column_q5: i32) -> Option<usize> {
        let sector = self.sector_from(column_q5);
        let is_in_view = self.edges_q4.first().is_some_and(|&q4| i32::from(q4) << 1 <= column_q5);
        (is_in_view && sector < usize::from(self.in_view)).then_some(sector)
    }

    /// Number of sectors in view that end before a column, 1/32 px.
    fn sector_from(&self, column_q5: i32) -> usize {
        let ends_q4 = self.edges_q4.get(1..=self.in_view.into()).unwrap_or(&[]);
        ends_q4.partition_point(|&q4| i32::from(q4) << 1 <= column_q5)
    }

    /// True when the line between two points meets the height band.
    fn band_meets(&self, points: [Seen; 2]) -> bool {
        let [a, b] = points.map(|Seen { level_q5, d_q6, .. }| {
            // height = rise * B / (d + offset), compared without the division.
            let rise = i64::from(self.row_q5 - level_q5) * 2 * self.baseline_q16;
            let [low, high] =
                self.heights_q16.map(|height_q16| height_q16 * i64::from(d_q6.max(1)));
            (rise < low, rise > high)
        });
        !(a.0 && b.0 || a.1 && b.1)
    }

    /// True when the camera lies in the height band: then every ray starts in the band, and points
    /// outside of it lie behind it.
    fn band_has_camera(&self) -> bool {
        let [low, high] = self.heights_q16;
        low <= 0 && high >= 0
    }

    /// Parts of the eighth of the rows above the camera's own height, and of the eighth below it,
    /// without the part that it lies in.
    fn level_parts(&self) -> [u32; 2] {
        let (row_q5, eighth_q5) = (self.row_q5, i32::from(self.height) * 4);
        let own = self.parts([row_q5; 2]);
        let around = self.parts([row_q5 - eighth_q5, row_q5 + eighth_q5]);
        [around & own.wrapping_sub(1), around & !own & !own.wrapping_sub(1)]
    }

    /// Parts of the rows from one row to another, 1/32 px, a bit each.
    pub(super) fn parts(&self, rows_q5: [i32; 2]) -> u32 {
        let [a, b] = rows_q5.map(|y_q5| quotient(y_q5, self.part_q5).clamp(0, PARTS_OF_ROWS));
        (2_u32 << a.max(b)) - (1 << a.min(b))
    }

    /// Distance of a nearness (1/64 px), cm, 1 or more, below the range.
    fn distance_cm(&self, nearness_q6: i32) -> u16 {
        let cm = (self.focal_baseline_q16 * 6400)
            .checked_div(i64::from(nearness_q6) << 16)
            .unwrap_or(i64::MAX);
        cm.min(i64::from(self.range_cm) - 1).max(1) as u16 // clamp may panic
    }
}
