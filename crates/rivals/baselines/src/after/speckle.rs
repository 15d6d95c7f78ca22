//! Speckles: small patches of disparities that agree with nothing around them.

use crate::map::DisparityMap;

/// Takes away every patch of at most `largest` px; a patch goes on where neighbours along the axes differ by at most `difference` px.
pub fn remove_speckles(map: &mut DisparityMap, largest: usize, difference: f32) {
    let width = usize::from(map.dims().width);
    let before = map.values().to_vec();
    let mut visited = vec![false; before.len()];
    let mut patch = Vec::new();
    for start in 0..before.len() {
        if visited[start] || before[start].is_nan() {
            continue;
        }
        patch.clear();
        patch.push(start);
        visited[start] = true;
        let mut next = 0;
        while let Some(&index) = patch.get(next) {
            next += 1;
            for neighbour in neighbours(index, width, before.len()) {
                // False for gaps.
                if !visited[neighbour] && (before[neighbour] - before[index]).abs() <= difference {
                    visited[neighbour] = true;
                    patch.push(neighbour);
                }
            }
        }
        if patch.len() <= largest {
            for &index in &patch {
                map.clear(index % width, index / width);
            }
        }
    }
}

/// Pixels beside, above and below.
pub(super) fn neighbours(index: usize, width: usize, count: usize) -> impl Iterator<Item = usize> {
    let x = index % width;
    let beside = [(x > 0).then(|| index - 1), (x + 1 < width).then(|| index + 1)];
    let others = [index.checked_sub(width), Some(index + width).filter(|&below| below < count)];
    beside.into_iter().chain(others).flatten()
}
