//! Two lists of images -> pairs: each image is in one at most, with the one that is nearest to it
//! in time.

use super::Stored;

/// Pairs in the order of their times, and the number of images that are in none.
pub(super) fn pairs(
    [mut left, mut right]: [Vec<Stored>; 2],
    window_ns: u64,
) -> (Vec<[Stored; 2]>, usize) {
    // Of equal times the one that was recorded first.
    left.sort_by_key(|image| image.stamp_ns);
    right.sort_by_key(|image| image.stamp_ns);
    let total = left.len() + right.len();
    let apart = |a: &Stored, b: &Stored| a.stamp_ns.abs_diff(b.stamp_ns);
    let (mut found, mut l, mut r) = (Vec::new(), 0, 0);
    while let (Some(a), Some(b)) = (left.get(l), right.get(r)) {
        let is_nearer = |other: Option<u64>| other.is_some_and(|other| other < apart(a, b));
        if is_nearer(right.get(r + 1).map(|next| apart(a, next))) {
            r += 1;
        } else if is_nearer(left.get(l + 1).map(|next| apart(next, b))) {
            l += 1;
        } else if apart(a, b) <= window_ns {
            found.push([*a, *b]);
            (l, r) = (l + 1, r + 1);
        } else if a.stamp_ns < b.stamp_ns {
            l += 1;
        } else {
            r += 1;
        }
    }
    let alone = total - 2 * found.len();
    (found, alone)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mcap::Place;
    use crate::ros::kind::{Content, Kind};

    const IMAGE: Kind = Kind { content: Content::Image, is_foxglove: false };

    fn at(times: &[i64]) -> Vec<Stored> {
        times
            .iter()
            .map(|&stamp_ns| Stored { file: 0, place: Place::default(), stamp_ns, kind: IMAGE })
            .collect()
    }

    fn paired(left: &[i64], right: &[i64], window: u64) -> (Vec<[i64; 2]>, usize) {
        let (found, alone) = pairs([at(left), at(right)], window);
        (found.into_iter().map(|pair| pair.map(|image| image.stamp_ns)).collect(), alone)
    }

    #[test]
    fn the_nearest_within_the_window_are_pairs() {
        assert_eq!(paired(&[0, 33, 66], &[1, 34, 65], 5), (vec![[0, 1], [33, 34], [66, 65]], 0));
        // One lost on each side; messages out of order.
        assert_eq!(paired(&[66, 0, 99], &[34, 65, 1], 5), (vec![[0, 1], [66, 65]], 2));
        // The first right one is within the window, the second nearer.
        assert_eq!(paired(&[10], &[6, 11], 5), (vec![[10, 11]], 1));
        assert_eq!(paired(&[6, 11], &[10], 5), (vec![[11, 10]], 1));
        // The border of the window.
        assert_eq!(paired(&[0], &[5], 5), (vec![[0, 5]], 0));
        assert_eq!(paired(&[0], &[6], 5), (vec![], 2));
        // The same twice, and the ends of time.
        assert_eq!(paired(&[7, 7], &[7], 0), (vec![[7, 7]], 1));
        assert_eq!(paired(&[i64::MIN, i64::MAX], &[i64::MAX, i64::MIN], 0).1, 0);
    }
}
