//! Matched segments and support points -> how far the nearest obstacle is in each direction: what an autopilot asks for.
//!
//! In: an [`ObstaclePlan`] (the view as sectors, made once), the matches and support points of a pair, its health, when it was captured. Out: an [`Obstacles`],
//! which says of each [`Sector`] of the full turn around the vehicle: an obstacle at this distance, free, unknown, or outside the view.
//!
//! ```text
//! per match, in each sector that it crosses, and per support point (at most 0.8 probable: neighbours share paths, and are wrong together):
//!   within the range and the height band     joins the nearest hypotheses of the sector
//!   behind them                              speaks for free
//! per sector, from the nearest hypothesis on:
//!   hypotheses that agree with it (1 px and 1/16 of the nearness behind it) multiply their error probabilities, 1 - confidence, from near to far;
//!   where the product falls to the limit is the obstacle: something is at least so near, but for that probability
//!   no hypothesis up to 5/4 of the range, and hypotheses behind it in a quarter of the rows whose error probabilities multiply to the limit: free
//!   otherwise nothing
//! an obstacle takes the place of what was known, unless that is an obstacle nearer by more than 1/8: it stays until it is too old
//! ```
//!
//! # What the words mean
//! - **Distance**: along the ground, from the camera to the obstacle in that direction (not the depth along the optical axis), for a camera
//!   that looks horizontally. What tilts the camera tilts sectors and height band with it.
//! - **Free**: credible segments or support points were seen *behind* the range through this sector, none within it, and the whole sector is seen by both
//!   cameras from the near limit on. It does not mean that nothing is there: a wall without texture, a wire along the rows and whatever is
//!   nearer than the near limit `f*B/max_disparity` have nothing credible. Nothing is free because nothing was seen: that is unknown.
//! - **Unknown**: too little was seen, or it is too old.
//! - **Outside**: never in view of this camera. Sectors seen in part show obstacles, but are never free; nor are those near the left border,
//!   where the right camera does not see what is near.
//!
//! # Measured
//! 14 captured scenes as if seen by a camera of 56 degrees, 154 sectors with truth: 153 show an obstacle (segments alone: 149), none of them nearer
//! than all that is there by 10 %; 15 (37) are farther than the nearest tenth of the sector's pixels by 25 %, whose surface has nothing credible.
//! With ranges that most of the scene lies behind, 18 (48) are free, and in 4 (26) of these at least a hundredth of the pixels is within the range.
//!
//! # Bounds
//! At most [`MAX_IN_VIEW`] sectors are in view (less than half a turn), 72 in a turn. Nearness (disparity plus offset, times the cosine of the
//! direction) is below 2^19 in 1/64 px; f*B in Q16 times 6400 below 2^53; a height in Q16 times a disparity below 2^46.
//!
//! # Cost
//! 300 bytes of state, 2 KB of stack. Instructions: `docs/board-numbers.toml`.

mod plan;

use crate::health::HealthFlags;
use crate::result::{Match, Point, Source};
use crate::support::SUPPORT_PITCH;
use crate::units::{Confidence, Disparity, Position, quotient};
use plan::PARTS;
pub use plan::{MAX_IN_VIEW, ObstacleError, ObstacleParams, ObstaclePlan};

/// Hypotheses kept of a sector, the nearest ones.
const KEPT: usize = 6;
/// Hypotheses agree within this and a sixteenth of their nearness, 1/64 px.
const AGREE_Q6: i32 = 64;

/// Least error probability of a support point, Q16: neighbours share paths and are wrong together.
const LEAST_POINT_ERROR_Q16: u16 = 13107;

/// Parts of the rows, and those of them in which something behind has to be seen for a sector to be free.
const PARTS_OF_ROWS: i32 = 8;
const CLEAR_PARTS: u32 = 2;

/// State of one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sector {
    /// Not in view: nothing will ever be known of it.
    Outside,
    /// In view, but nothing credible was seen, or it is too old.
    Unknown,
    /// Credible segments or support points behind the range, none within it. What has none is not seen: a blank wall may stand there.
    Free {
        /// Probability that they are right.
        confidence: Confidence,
        /// Since they were seen, ms.
        age_ms: u32,
    },
    /// Something is there.
    Obstacle {
        /// Along the ground, cm; 1 or more, below the range.
        distance_cm: u16,
        /// Probability that something is at least so near.
        confidence: Confidence,
        /// Since it was seen, ms.
        age_ms: u32,
    },
}

/// State of one direction, in eight bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Known {
    /// [`NOTHING`], [`FREE`] or an obstacle's distance.
    distance_cm: u16,
    confidence_q16: u16,
    /// When it was seen, ms, wrapping.
    seen_ms: u32,
}

const NOTHING: u16 = 0;
const FREE: u16 = u16::MAX;

impl Known {
    const NONE: Self = Self { distance_cm: NOTHING, confidence_q16: 0, seen_ms: 0 };
}

/// State of every direction, kept between pairs.
///
/// ```
/// use linestereo::{Dims, HealthFlags, Params, Rig};
/// use linestereo::obstacles::{ObstacleParams, Obstacles, Sector};
/// let dims = Dims { width: 320, height: 240 };
/// let params = Params { rig: Some(Rig::new(300.0, 0.1, 0.0)?), ..Params::default() };
/// let plan = ObstacleParams::DEFAULT.plan(&params, dims)?;
/// let mut obstacles = Obstacles::new();
/// obstacles.update(&plan, &[], None, HealthFlags::GOOD, 0); // no segment: nothing is known, and nothing is free
/// assert_eq!(obstacles.sector(&plan, 0, 0), Sector::Unknown); // ahead
/// assert_eq!(obstacles.sector(&plan, 36, 0), Sector::Outside); // behind
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Obstacles {
    known: [Known; MAX_IN_VIEW],
    is_fit: bool,
}

impl Default for Obstacles {
    fn default() -> Self {
        Self::new()
    }
}

impl Obstacles {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { known: [Known::NONE; MAX_IN_VIEW], is_fit: false }
    }

    /// Takes the matches of a pair, and its support points among `points`, that was captured at this time (microseconds of a clock that does not run backwards) and has these
    /// [flags](crate::PairHealth::flags). Of a pair that is not fit to be used no sector gets anything.
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
        self.is_fit = (health.bits() & plan.unfit.bits()) == 0;
        let mut found = [Hypotheses::NONE; MAX_IN_VIEW];
        if self.is_fit {
            for one in matches {
                let error_q16 = u16::MAX - one.confidence.to_bits();
                plan.for_each_sector(one, |sector, ray| {
                    if let Some(hypotheses) = found.get_mut(sector) {
                        hypotheses.add(ray, error_q16);
                    }
                });
            }
            for point in points.into_iter().filter(|point| point.source == Source::Support) {
                let (sector, ray) = plan.ray_of(&point);
                if let (Some(hypotheses), Some(ray)) = (found.get_mut(sector), ray) {
                    hypotheses.add(ray, (u16::MAX - point.confidence.to_bits()).max(LEAST_POINT_ERROR_Q16));
                }
            }
        }
        for ((known, hypotheses), sector) in self.known.iter_mut().zip(&found).zip(0_u32..) {
            let can_be_free = plan.complete >> sector & 1 == 1;
            let age_ms = now_ms.wrapping_sub(known.seen_ms);
            if known.distance_cm != NOTHING && age_ms > plan.keep_ms {
                *known = Known::NONE;
            }
            let Some((nearness_q6, error_q16)) = hypotheses.judge(plan, can_be_free) else { continue };
            let distance_cm = nearness_q6.map_or(FREE, |nearness_q6| plan.distance_cm(nearness_q6));
            if !keeps_previous(known.distance_cm, distance_cm) {
                *known = Known { distance_cm, confidence_q16: u16::MAX - error_q16, seen_ms: now_ms };
            }
        }
    }

    /// There was no pair, or it was refused: what is known grows old, and the source is not fit to be used.
    pub fn mark_missing(&mut self) {
        self.is_fit = false;
    }

    /// Was the last pair fit to be used? False before the first.
    #[must_use]
    pub fn is_fit(&self) -> bool {
        self.is_fit
    }

    /// State of a direction: 0 is ahead of the vehicle, then clockwise, seen from above.
    #[must_use]
    pub fn sector(&self, plan: &ObstaclePlan, index: u8, time_us: u64) -> Sector {
        let Some(known) = plan.in_view(index).and_then(|place| self.known.get(place)) else { return Sector::Outside };
        let age_ms = milliseconds(time_us).wrapping_sub(known.seen_ms);
        let confidence = Confidence::from_bits(known.confidence_q16);
        match known.distance_cm {
            NOTHING => Sector::Unknown,
            _ if age_ms > plan.keep_ms => Sector::Unknown,
            FREE => Sector::Free { confidence, age_ms },
            distance_cm => Sector::Obstacle { distance_cm, confidence, age_ms },
        }
    }

    /// Every direction of the turn, from ahead on, clockwise.
    pub fn sectors<'a>(&'a self, plan: &'a ObstaclePlan, time_us: u64) -> impl Iterator<Item = Sector> + 'a {
        (0..plan.sectors()).map(move |index| self.sector(plan, index, time_us))
    }
}

/// Does what is known of a sector stay although something else is seen there? A nearer obstacle does: that it was not seen again is no
/// proof that it is gone.
fn keeps_previous(known_cm: u16, seen_cm: u16) -> bool {
    let is_obstacle = known_cm != NOTHING && known_cm != FREE;
    is_obstacle && u32::from(known_cm) + u32::from(known_cm) / 8 < u32::from(seen_cm)
}

/// Milliseconds, wrapping.
fn milliseconds(time_us: u64) -> u32 {
    (time_us / 1000) as u32
}

/// A match or a support point in one sector: its nearness, or the rows that are clear before it.
#[derive(Clone, Copy)]
enum Ray {
    /// Something within the range and the height band; nearness, 1/64 px.
    Ends(i32),
    /// Something behind both: what is seen in these parts of the rows is clear.
    Passes(u8),
}

/// The nearest hypotheses of one sector, and the probability that all behind the range are wrong.
#[derive(Clone, Copy)]
struct Hypotheses {
    /// Nearness (1/64 px, 0 = none) and error probability of the nearest hypotheses, nearest first.
    near: [(i32, u16); KEPT],
    /// All hypotheses behind are wrong with this probability.
    clear_error_q16: u16,
    /// Parts of the rows in which something behind is seen.
    clear_parts: u8,
}

impl Hypotheses {
    const NONE: Self = Self { near: [(0, 0); KEPT], clear_error_q16: u16::MAX, clear_parts: 0 };

    fn add(&mut self, ray: Ray, error_q16: u16) {
        match ray {
            Ray::Ends(nearness_q6) => {
                let mut hypothesis = (nearness_q6, error_q16);
                if self.near.last().is_some_and(|last| hypothesis.0 <= last.0) {
                    return; // most are not among the nearest
                }
                for place in &mut self.near {
                    if hypothesis.0 > place.0 {
                        core::mem::swap(place, &mut hypothesis);
                    }
                }
            }
            Ray::Passes(parts) => {
                self.clear_error_q16 = both(self.clear_error_q16, error_q16);
                self.clear_parts |= parts;
            }
        }
    }

    /// The nearness of the obstacle, `None` for free, and the error probability; nothing where too little was seen.
    fn judge(&self, plan: &ObstaclePlan, can_be_free: bool) -> Option<(Option<i32>, u16)> {
        for (first, &(nearest_q6, _)) in self.near.iter().enumerate().take_while(|(_, hypothesis)| hypothesis.0 > 0) {
            let agree_q6 = nearest_q6 - (AGREE_Q6 + nearest_q6 / 16);
            let (mut error_q16, mut found) = (u16::MAX, None);
            for &(nearness_q6, its_error_q16) in
                self.near.iter().skip(first).take_while(|hypothesis| hypothesis.0 >= agree_q6.max(1))
            {
                error_q16 = both(error_q16, its_error_q16);
                if found.is_none() && error_q16 <= plan.error_q16 {
                    found = Some(nearness_q6);
                }
            }
            if let Some(nearness_q6) = found {
                return (nearness_q6 >= plan.far_q6).then_some((found, error_q16));
            }
        }
        let is_clear = self.near.first().is_some_and(|hypothesis| hypothesis.0 == 0);
        let is_covered = self.clear_parts.count_ones() >= CLEAR_PARTS;
        (is_clear && is_covered && can_be_free && self.clear_error_q16 <= plan.error_q16)
            .then_some((None, self.clear_error_q16))
    }
}

/// The probability that both are wrong.
fn both(one: u16, other: u16) -> u16 {
    ((u32::from(one) * u32::from(other)) >> 16) as u16
}

impl ObstaclePlan {
    /// Calls `each` with the sectors in view that a match crosses, and how near it is there.
    fn for_each_sector(&self, one: &Match, mut each: impl FnMut(usize, Ray)) {
        let bits = |p: Position| i32::from(p.to_bits());
        let [a, b] = one.ends.map(|end| (bits(end.x), bits(end.y)));
        let [da, db] = one.disparity.map(|d: Disparity| i32::from(d.to_bits()) + self.offset_q6);
        let ((x0, y0, d0), (x1, y1, d1)) =
            if a.0 <= b.0 { ((a.0, a.1, da), (b.0, b.1, db)) } else { ((b.0, b.1, db), (a.0, a.1, da)) };
        let (from, to) = (self.sector_of(x0), self.sector_of(x1));
        // Along the segment: what is linear in x.
        let at = |v0: i32, v1: i32, x: i32| v0.wrapping_add(quotient((v1 - v0).wrapping_mul(x - x0), x1 - x0));
        for place in from..=to {
            let Some(&[left, right]) = self.edges_q5.get(place..place + 2).and_then(|edges| edges.first_chunk()) else {
                return;
            };
            let (xa, xb) = (x0.max(left.into()), x1.min(right.into()));
            let ends = [
                if xa == x0 { (x0, y0, d0) } else { (xa, at(y0, y1, xa), at(d0, d1, xa)) },
                if xb == x1 { (x1, y1, d1) } else { (xb, at(y0, y1, xb), at(d0, d1, xb)) },
            ];
            let [na, nb] = ends.map(|(x, _, d)| self.nearness_q6(x, d));
            if let Some(ray) = self.ray(na.max(nb), ends.map(|(_, y, d)| (y, d))) {
                each(place, ray);
            }
        }
    }

    /// The sector of a support point, and what it says there: rows up to the next ones above and below.
    fn ray_of(&self, point: &Point) -> (usize, Option<Ray>) {
        let half = i32::from(SUPPORT_PITCH / 2);
        let (x_q5, y) = (i32::from(point.x) << 5, i32::from(point.y));
        let d_q6 = i32::from(point.disparity.to_bits()) + self.offset_q6;
        let rows = [y - half, y + half - 1].map(|y| (y << 5, d_q6));
        (self.sector_of(x_q5), self.ray(self.nearness_q6(x_q5, d_q6), rows))
    }

    /// The ray of something so near (1/64 px), between two points (row in 1/32 px, disparity plus offset in 1/64 px).
    fn ray(&self, nearness_q6: i32, points: [(i32, i32); 2]) -> Option<Ray> {
        let clear_q6 = self.far_q6 - self.far_q6 / 5;
        if nearness_q6 >= clear_q6 && self.band_meets(points) {
            Some(Ray::Ends(nearness_q6))
        } else if nearness_q6 < clear_q6 || self.band_has_camera() {
            Some(Ray::Passes(self.parts(points.map(|(y, _)| y))))
        } else {
            None
        }
    }

    /// Nearness of a disparity plus offset (1/64 px) in a column (1/32 px).
    fn nearness_q6(&self, x_q5: i32, d_q6: i32) -> i32 {
        ((i64::from(d_q6) * i64::from(self.cosine_q15(x_q5))) >> 15) as i32
    }

    /// The place among the sectors in view of a column (1/32 px).
    fn sector_of(&self, column_q5: i32) -> usize {
        let inner = self.edges_q5.get(1..usize::from(self.in_view)).unwrap_or(&[]);
        inner.partition_point(|&edge_q5| i32::from(edge_q5) <= column_q5)
    }

    /// Cosine of a column's direction (1/32 px): a line within each of 32 parts of the width.
    fn cosine_q15(&self, column_q5: i32) -> i32 {
        let width = i32::from(self.width);
        let part = quotient(column_q5, width).clamp(0, PARTS as i32 - 1);
        let along = column_q5 - part * width;
        let Some(&[from, to]) = self.cosines_q15.get(part as usize..).and_then(|rest| rest.first_chunk()) else {
            return 0;
        };
        i32::from(from) + quotient((i32::from(to) - i32::from(from)) * along, width)
    }

    /// Does anything between two points (row in 1/32 px, disparity plus offset in 1/64 px) lie in the height band?
    fn band_meets(&self, points: [(i32, i32); 2]) -> bool {
        let [a, b] = points.map(|(y_q5, d_q6)| {
            // height = rise * B / (d + offset), compared without the division.
            let rise = i64::from(self.row_q5 - y_q5) * 2 * self.baseline_q16;
            let [low, high] = self.heights_q16.map(|height_q16| height_q16 * i64::from(d_q6.max(1)));
            (rise < low, rise > high)
        });
        !(a.0 && b.0 || a.1 && b.1)
    }

    /// Then every ray starts in the band, and what is outside of it lies behind it.
    fn band_has_camera(&self) -> bool {
        let [low, high] = self.heights_q16;
        low <= 0 && high >= 0
    }

    /// The parts of the rows from one row to another, 1/32 px.
    fn parts(&self, rows_q5: [i32; 2]) -> u8 {
        let [a, b] =
            rows_q5.map(|y_q5| quotient(y_q5, i32::from(self.height) * 32 / PARTS_OF_ROWS).clamp(0, PARTS_OF_ROWS - 1));
        ((2_u32 << a.max(b)) - (1 << a.min(b))) as u8
    }

    /// Distance of a nearness, below the range.
    fn distance_cm(&self, nearness_q6: i32) -> u16 {
        let cm = (self.focal_baseline_q16 * 6400).checked_div(i64::from(nearness_q6) << 16).unwrap_or(i64::MAX);
        cm.min(i64::from(self.range_cm) - 1).max(1) as u16 // clamp may panic
    }
}
