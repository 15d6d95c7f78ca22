//! Places along the rows that look like one of them, and whether they stand at equal distances.
//!
//! Equal distances are what tells a fence from a second leg or from chance: the right image cannot
//! tell which of such places is which.

/// A bit for each distance of a place on both sides, up to 127 px.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Places {
    before: u128,
    after: u128,
}

impl Places {
    /// Adds one this far away; those farther than 127 px are left out.
    pub(crate) fn add(&mut self, offset: i32) {
        let side = if offset < 0 { &mut self.before } else { &mut self.after };
        *side |= 1_u128.checked_shl(offset.unsigned_abs()).unwrap_or(0);
    }

    /// True where there is a place this far away, to within `tolerance`, which is not farther.
    fn has(self, offset: i32, tolerance: i32) -> bool {
        let side = if offset < 0 { self.before } else { self.after };
        let around = ((1_u128 << (2 * tolerance + 1)) - 1)
            .checked_shl((offset.abs() - tolerance).unsigned_abs())
            .unwrap_or(0);
        side & around != 0
    }

    /// The least distance, px, at which the place itself is one of so many in a row, each to within
    /// `tolerance` of a multiple. No place is nearer than that.
    #[inline(never)] // two calls; 128-bit shifts are long
    pub(crate) fn distance(self, run: i32, tolerance: i32) -> Option<i32> {
        // Most have hardly any.
        let count = (self.before.count_ones() + self.after.count_ones()) as i32;
        let mut left = if count < run - 1 { 0 } else { self.before | self.after };
        while left != 0 {
            let distance = left.trailing_zeros() as i32;
            left &= left - 1;
            let has = |times: i32| self.has(times * distance, tolerance);
            let length = |sign: i32| (1..run).take_while(|k| has(sign * k)).count() as i32;
            if length(1) + length(-1) + 1 >= run {
                return Some(distance);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(at: &[i32], run: i32) -> Option<i32> {
        let mut places = Places::default();
        at.iter().for_each(|&offset| places.add(offset));
        places.distance(run, 2)
    }

    #[test]
    fn four_places_at_equal_distances_repeat() {
        for (at, least) in [([8, 16, 24], 8), ([-9, 10, 19], 9), ([-24, -16, -8], 8)] {
            assert_eq!(distance(&at, 4), Some(least), "{at:?}");
        }
        for at in [&[8, 16][..], &[-8, 8], &[-20, 8, 25], &[8, 16, 200]] {
            assert_eq!(distance(at, 4), None, "{at:?}");
        }
        assert_eq!(distance(&[8, 16], 3), Some(8));
    }
}
