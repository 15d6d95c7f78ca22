//! Weighed candidates -> the lists a user gets: matches with depth, and points, each pixel at most once.
//!
//! ```text
//! every side gets its probability; of two sides that contradict each other in the right image the less probable one is rejected
//! matches: candidates with a side that is probable enough, most probable first
//! points:  sides in the same order claim their pixels; a claimed pixel is not claimed again
//! ```

use crate::confidence::{Model, Models};
use crate::image::Dims;
use crate::matching::consistency::{Place, contradict};
use crate::matching::evidence::Kind;
use crate::matching::{Candidate, Side};
use crate::params::Params;
use crate::result::{Counts, Match, Owner, PointClaim, Rejection, Techniques};
use crate::sort::sort_by_key;
use crate::units::{Confidence, Disparity};
use heapless::vec::VecView;

/// Rejects, then fills both lists. `order` has an entry per candidate, `marks` a bit per pixel.
pub(crate) struct Report<'a> {
    pub(crate) params: &'a Params,
    pub(crate) models: &'a Models,
    pub(crate) dims: Dims,
    pub(crate) candidates: &'a mut [Candidate],
    pub(crate) places: &'a [[Place; 2]],
    pub(crate) order: &'a mut VecView<(u16, u16)>,
    pub(crate) marks: &'a mut [u32],
}

impl Report<'_> {
    pub(crate) fn run(mut self, matches: &mut VecView<Match>, points: &mut VecView<PointClaim>, counts: &mut Counts) {
        self.rate();
        self.exclude(counts);
        self.sort();
        self.list_matches(matches, counts);
        self.list_points(matches, points, counts);
    }

    fn model(&self, candidate: &Candidate) -> &Model {
        if candidate.segment.near_horizontal { &self.models.near_horizontal } else { &self.models.steep }
    }

    /// Probability of every side, at the first pixel from the edge.
    fn rate(&mut self) {
        for i in 0..self.candidates.len() {
            let Some(candidate) = self.candidates.get(i) else { continue };
            let model = self.model(candidate);
            let rated = [0, 1].map(|side| {
                candidate.sides.get(side).and_then(Option::as_ref).map(|side| {
                    let score = model.score_q8(&side.evidence) + model.coefficient_q8(Kind::Distance);
                    (score, model.probability_q16(score))
                })
            });
            if let Some(candidate) = self.candidates.get_mut(i) {
                for (side, rating) in candidate.sides.iter_mut().zip(rated) {
                    if let (Some(side), Some((score, probability))) = (side, rating) {
                        side.score_q8 = score;
                        side.probability_q16 = probability;
                    }
                }
            }
        }
    }

    /// One right position explains one left position: the less probable of two that contradict each other goes.
    fn exclude(&mut self, counts: &mut Counts) {
        for i in 0..self.candidates.len() {
            for side in 0..2 {
                let beaten = self.is_beaten(i, side);
                if let Some(candidate) = self.candidates.get_mut(i)
                    && let Some(slot) = candidate.sides.get_mut(side)
                    && let Some(claim) = slot
                    && (beaten || claim.probability_q16 < self.params.min_confidence.to_bits())
                {
                    claim.rejected = true;
                    candidate.beaten |= beaten;
                }
            }
        }
        for candidate in self.candidates.iter() {
            if candidate.best().is_none() {
                counts.reject(if candidate.beaten { Rejection::NotExclusive } else { Rejection::LowConfidence });
            }
        }
    }

    fn is_beaten(&self, index: usize, side: usize) -> bool {
        let (Some(own), Some(Some(claim))) = (
            self.places.get(index).and_then(|p| p.get(side)),
            self.candidates.get(index).and_then(|c| c.sides.get(side)).map(Option::as_ref),
        ) else {
            return false;
        };
        self.candidates.iter().zip(self.places).enumerate().any(|(i, (candidate, pair))| {
            i != index
                && candidate.sides.iter().zip(pair).any(|(other, place)| {
                    other.as_ref().is_some_and(|o| o.probability_q16 > claim.probability_q16 && contradict(*own, *place))
                })
        })
    }

    fn sort(&mut self) {
        self.order.clear();
        for (i, candidate) in self.candidates.iter().enumerate() {
            if let Some(best) = candidate.best() {
                let _ = self.order.push((u16::MAX - best.probability_q16, i as u16)); // one per candidate: fits
            }
        }
        sort_by_key(self.order, |&entry| entry);
    }

    fn list_matches(&self, matches: &mut VecView<Match>, counts: &mut Counts) {
        for &(_, i) in self.order.iter() {
            let Some(found) = self.candidates.get(usize::from(i)).and_then(|c| self.to_match(c)) else { continue };
            if matches.push(found).is_err() {
                counts.matches_dropped = counts.matches_dropped.saturating_add(1);
            }
        }
        counts.matched = u16::try_from(matches.len()).unwrap_or(u16::MAX);
    }

    fn to_match(&self, candidate: &Candidate) -> Option<Match> {
        let best = candidate.best()?;
        let disparity = best.disparity_q6.map(disparity_from_q6);
        let sigma = disparity_from_q6(self.model(candidate).sigma_q6(best.score_q8).into());
        let rig = self.params.rig;
        Some(Match {
            ends: candidate.segment.ends,
            disparity,
            sigma,
            confidence: Confidence::from_bits(best.probability_q16),
            owner: candidate.owner()?,
            depth: rig.map(|rig| disparity.map(|d| rig.depth(d))),
            depth_sigma: rig.map(|rig| disparity.map(|d| rig.depth_sigma(d, sigma))),
            techniques: Techniques {
                feature: candidate.feature_q6.map(disparity_from_q6),
                window: disparity_from_q6(candidate.window_q6),
                census: disparity_from_q6(candidate.census_q6),
            },
        })
    }

    fn list_points(&mut self, matches: &VecView<Match>, points: &mut VecView<PointClaim>, counts: &mut Counts) {
        self.marks.fill(0);
        let width = usize::from(self.dims.width);
        for (source, &(_, i)) in self.order.iter().enumerate().take(matches.len()) {
            let Some(candidate) = self.candidates.get(usize::from(i)) else { continue };
            let model =
                if candidate.segment.near_horizontal { &self.models.near_horizontal } else { &self.models.steep };
            for (side, claim) in candidate.sides.iter().enumerate() {
                let Some(claim) = claim.as_ref().filter(|c| !c.rejected) else { continue };
                for distance in 1..=self.params.reach {
                    let score = claim.score_q8 + model.coefficient_q8(Kind::Distance) * (i32::from(distance) - 1);
                    let probability = model.probability_q16(score);
                    if probability < self.params.min_confidence.to_bits() {
                        break;
                    }
                    candidate.for_each_pixel(side, distance, self.dims, |x, y, d_q6| {
                        let bit = usize::from(y) * width + usize::from(x);
                        let Some(word) = self.marks.get_mut(bit >> 5) else { return };
                        let mask = 1 << (bit & 31);
                        if *word & mask != 0 {
                            return;
                        }
                        *word |= mask;
                        let claim = PointClaim {
                            x,
                            y,
                            disparity: disparity_from_q6(d_q6),
                            confidence: Confidence::from_bits(probability),
                            source: source as u16,
                        };
                        if points.push(claim).is_err() {
                            counts.points_dropped = counts.points_dropped.saturating_add(1);
                        }
                    });
                }
            }
        }
        counts.points = u32::try_from(points.len()).unwrap_or(u32::MAX);
    }
}

impl Candidate {
    /// The most probable side that was not rejected.
    fn best(&self) -> Option<&Side> {
        let [left, right] = &self.sides;
        let alive = |side: &Option<Side>| side.as_ref().is_some_and(|s| !s.rejected);
        match (alive(left), alive(right)) {
            (true, true) => {
                let (l, r) = (left.as_ref()?, right.as_ref()?);
                Some(if r.probability_q16 > l.probability_q16 { r } else { l })
            }
            (true, false) => left.as_ref(),
            (false, true) => right.as_ref(),
            (false, false) => None,
        }
    }

    fn owner(&self) -> Option<Owner> {
        let [left, right] = self.sides.each_ref().map(|side| side.as_ref().filter(|s| !s.rejected));
        match (left, right) {
            (Some(l), Some(r)) => {
                // Two surfaces with a disparity each: the segment carries the more probable one.
                let apart = (l.disparity_q6.iter().sum::<i32>() - r.disparity_q6.iter().sum::<i32>()).abs();
                Some(match (apart > 2 << 6, r.probability_q16 > l.probability_q16) {
                    (false, _) => Owner::Both,
                    (true, true) => Owner::Right,
                    (true, false) => Owner::Left,
                })
            }
            (Some(_), None) => Some(Owner::Left),
            (None, Some(_)) => Some(Owner::Right),
            (None, None) => None,
        }
    }
}

fn disparity_from_q6(d_q6: i32) -> Disparity {
    Disparity::from_bits(d_q6.clamp(i16::MIN.into(), i16::MAX.into()) as i16)
}
