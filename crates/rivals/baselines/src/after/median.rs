//! The median of a square: single wrong values go, edges stay.

use crate::map::DisparityMap;

/// Every disparity becomes the median of those known within `half` px along both axes. Gaps stay gaps.
pub fn median(map: &mut DisparityMap, half: usize) {
    let (width, height) = (usize::from(map.dims().width), usize::from(map.dims().height));
    let before = map.values().to_vec();
    let mut near = Vec::with_capacity((2 * half + 1) * (2 * half + 1));
    for (index, value) in map.values_mut().iter_mut().enumerate().filter(|(_, value)| value.is_finite()) {
        let (x, y) = (index % width, index / width);
        near.clear();
        for row in y.saturating_sub(half)..=(y + half).min(height - 1) {
            let columns = x.saturating_sub(half)..=(x + half).min(width - 1);
            near.extend(before[row * width..][columns].iter().filter(|d| d.is_finite()));
        }
        let middle = near.len() / 2;
        *value = *near.select_nth_unstable_by(middle, f32::total_cmp).1;
    }
}
