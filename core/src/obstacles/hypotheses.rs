//! Hypotheses of one sector, and what they say together.
//!
//! In: rays with their error probabilities. Out: the nearest obstacle, or that the sector is free,
//! and the nearest drop-off.

use super::plan::{Ground, ObstaclePlan};
use crate::sort::keep_largest;

/// Number of hypotheses kept of a sector, the nearest ones.
const KEPT: usize = 16;
/// The same of drop-offs.
const KEPT_BELOW: usize = 8;
/// Bit of the error probability of a support point, which stands in one sector alone.
pub(super) const POINT: u16 = 1;
/// Tolerance of agreement, 1/64 px, in addition to a sixteenth of the nearness.
const AGREE_Q6: i32 = 64;
/// Largest error probability of a support point that is seen behind the range, and of a hypothesis
/// between the range and 5/4 of it that forbids a free sector, Q16: 0.1. Surfaces behind the range
/// are there as well.
pub(super) const STRONG_Q16: u16 = 6554;

/// Largest probability that all hypotheses of a sector itself are wrong for the support points
/// beside it to count, Q16: 1/16. Chosen on `robot_world`, where those beside raise the obstacles
/// told from 57 to 64 %, ghosts before them from 0.8 to 1.5 %, and ghosts in clear sectors from 7
/// to 8 %; 1/8 tells no more. Drives that did not choose it: table legs 62 and 67 %, corridor 56
/// and 60 %, doorway 60 and 66 %; on a flight 50 and 51 %, with ghosts before 4 and 15 % of them
/// and in 10 and 35 % of its clear sectors, most of them just above the band of heights.
const OWN_Q16: u16 = 1 << 12;

/// Result of a match or a support point for one sector: its nearness, or the rows that are free
/// before it.
#[derive(Clone, Copy)]
pub(super) enum Ray {
    /// Within the range and the height band; nearness, 1/64 px.
    Ends(i32),
    /// Behind both: the range is free in these parts of the rows, a bit each, of the left and of
    /// the right half of the sector.
    Passes([u32; 2]),
    /// Through the ground plane, which it meets at this nearness, 1/64 px, within the range.
    Falls(i32),
}

/// The nearest of many hypotheses, nearest first: nearness (1/64 px, 0 = none) and error
/// probability (Q16, with the bit [`POINT`]).
#[derive(Clone, Copy)]
pub(super) struct Nearest<const KEPT: usize>([(u16, u16); KEPT]);

/// Hypotheses that agree.
pub(super) struct Group {
    /// Nearness of the first of them, 1/64 px.
    pub(super) nearest_q6: i32,
    /// Nearness at which the product of the error probabilities falls to the limit, or with those
    /// beside it to [`OWN_Q16`], 1/64 px.
    nearness_q6: i32,
    /// Product of all, Q16.
    pub(super) error_q16: u16,
}

impl<const KEPT: usize> Nearest<KEPT> {
    pub(super) const NONE: Self = Self([(0, 0); KEPT]);

    pub(super) fn add(&mut self, nearness_q6: i32, error_q16: u16) {
        let hypothesis = (u16::try_from(nearness_q6).unwrap_or(u16::MAX), error_q16);
        // Most are not among the nearest.
        if self.0.last().is_some_and(|last| hypothesis > *last) {
            keep_largest(&mut self.0, hypothesis);
        }
    }
}

fn iter(list: &[(u16, u16)]) -> impl Iterator<Item = (i32, u16)> + Clone {
    let all = list.iter().map(|&(nearness_q6, error)| (i32::from(nearness_q6), error));
    all.take_while(|&(nearness_q6, _)| nearness_q6 > 0)
}

/// The nearest group whose error probabilities have a product of at most `limit_q16`, with those of
/// the support points `beside` it where its own are small enough; `agree_q6` says how far behind
/// its nearest one hypotheses agree.
#[inline(never)] // once for lists of each length
fn group(
    list: &[(u16, u16)],
    limit_q16: u16,
    agree_q6: fn(i32) -> i32,
    beside: &[&[(u16, u16)]],
) -> Option<Group> {
    iter(list).enumerate().find_map(|(first, (nearest_q6, _))| {
        let least_q6 = nearest_q6 - agree_q6(nearest_q6);
        let (mut error_q16, mut found, mut with_beside) = (u16::MAX, None, None);
        for (nearness_q6, one_error_q16) in
            iter(list).skip(first).take_while(|hypothesis| hypothesis.0 >= least_q6)
        {
            error_q16 = both(error_q16, one_error_q16);
            if found.is_none() && error_q16 <= limit_q16 {
                found = Some(nearness_q6);
            }
            if with_beside.is_none() && error_q16 <= OWN_Q16 {
                with_beside = Some(nearness_q6);
            }
        }
        if found.is_none() && with_beside.is_some() {
            for (nearness_q6, one_error_q16) in beside.iter().flat_map(|list| iter(list)) {
                let agrees = nearness_q6 >= least_q6 && nearness_q6 <= nearest_q6 + AGREE_Q6;
                if agrees && one_error_q16 & POINT != 0 {
                    error_q16 = both(error_q16, one_error_q16);
                }
            }
            found = with_beside.filter(|_| error_q16 <= limit_q16);
        }
        found.map(|nearness_q6| Group { nearest_q6, nearness_q6, error_q16 })
    })
}

/// The nearest hypotheses of one sector, and those behind the range.
#[derive(Clone, Copy)]
pub(super) struct Hypotheses {
    /// Obstacles: those within the range and all behind it.
    near: Nearest<KEPT>,
    /// Drop-offs, by the nearness of the ground that is missing.
    below: Nearest<KEPT_BELOW>,
    /// Probability that all hypotheses behind the range are wrong, Q16.
    clear_error_q16: u16,
    /// Parts of the rows with a hypothesis behind the range, a bit each, by halves of the sector.
    seen: [u32; 2],
    /// Those with a support point that would be behind it, but is doubtful.
    doubted: u32,
}

impl Hypotheses {
    pub(super) const NONE: Self = Self {
        near: Nearest::NONE,
        below: Nearest::NONE,
        clear_error_q16: u16::MAX,
        seen: [0; 2],
        doubted: 0,
    };

    pub(super) fn add(&mut self, ray: Ray, error_q16: u16) {
        match ray {
            Ray::Ends(nearness_q6) => self.near.add(nearness_q6, error_q16),
            Ray::Falls(nearness_q6) => self.below.add(nearness_q6, error_q16),
            Ray::Passes(parts) => {
                self.clear_error_q16 = both(self.clear_error_q16, error_q16);
                self.seen.iter_mut().zip(parts).for_each(|(seen, parts)| *seen |= parts);
            }
        }
    }

    /// Adds a support point behind the range that is too doubtful to make it free.
    pub(super) fn doubt(&mut self, [left, right]: [u32; 2]) {
        self.doubted |= left | right;
    }

    /// The nearest drop-off.
    pub(super) fn drop_off(&self, limit_q16: u16) -> Option<Group> {
        group(&self.below.0, limit_q16, drop_agree_q6, &[])
    }

    /// Nearness of the obstacle, 1/64 px, `None` for free, and the error probability, Q16; `None`
    /// where hypotheses are too few. Those of the sectors `beside` it help.
    pub(super) fn obstacle(
        &self,
        plan: &ObstaclePlan,
        can_be_free: bool,
        beside: [&Self; 2],
    ) -> Option<(Option<i32>, u16)> {
        let beside = beside.map(|sector| sector.near.0.as_slice());
        if let Some(Group { nearness_q6, error_q16, .. }) =
            group(&self.near.0, plan.error_q16, agree_q6, &beside)
        {
            return (nearness_q6 >= plan.far_q6).then_some((Some(nearness_q6), error_q16));
        }
        let is_free = iter(&self.near.0)
            .all(|(nearness_q6, error_q16)| nearness_q6 < plan.far_q6 && error_q16 > STRONG_Q16);
        // In each half: something may stand in the other half.
        let is_covered = match plan.ground {
            // All rows in which something within the range would stand, and none that only doubtful
            // points show.
            Some(Ground { parts, .. }) => {
                let [left, right] = self.seen;
                let is_doubted = parts & !left & !right & self.doubted != 0;
                !has_gap(left, parts) && !has_gap(right, parts) && !is_doubted
            }
            // The rows above and below the camera's own height. Of the sectors of `robot_world`
            // matched without a plane, with an obstacle and without, none and none of 161 are free;
            // by any two eighths of the rows 2.3 and 13.5 %. Of those of six drives that did not
            // choose it none and none of 318; 0 and 4 %.
            None => self.seen.iter().all(|seen| plan.level.iter().all(|parts| seen & parts != 0)),
        };
        (is_free && is_covered && can_be_free && self.clear_error_q16 <= plan.error_q16)
            .then_some((None, self.clear_error_q16))
    }
}

/// True where of the parts of the rows that are `needed` two neighbouring ones or all are not seen.
/// One may be: support points stand up to half of their distance higher or lower.
fn has_gap(seen: u32, needed: u32) -> bool {
    let unseen = needed & !seen;
    unseen == needed || unseen & (unseen << 1) != 0
}

/// Hypotheses up to so much behind another one agree with it, 1/64 px.
pub(super) fn agree_q6(nearness_q6: i32) -> i32 {
    AGREE_Q6 + nearness_q6 / 16
}

/// The same for drop-offs: the lower floor begins at the edge or behind it.
fn drop_agree_q6(nearness_q6: i32) -> i32 {
    AGREE_Q6 + nearness_q6 / 4
}

/// Probability that both are wrong, Q16, of independent hypotheses.
pub(super) fn both(one: u16, other: u16) -> u16 {
    ((u32::from(one) * u32::from(other)) >> 16) as u16
}
