//! Gaps: values for pixels that matching has left without one. They are guesses, and have confidence 0.

use super::speckle::neighbours;
use crate::map::DisparityMap;

/// Each gap of a row takes the farther (smaller) of the disparities at its two ends: what is hidden belongs to the surface behind.
/// A gap at the border of the image takes the one end that there is; a row without any disparity stays empty.
pub fn fill_from_neighbours(map: &mut DisparityMap) {
    let (width, height) = (usize::from(map.dims().width), usize::from(map.dims().height));
    for y in 0..height {
        let row = map.values()[y * width..(y + 1) * width].to_vec();
        let mut x = 0;
        while x < width {
            if row[x].is_finite() {
                x += 1;
                continue;
            }
            let end = (x..width).find(|&x| row[x].is_finite());
            let before = x.checked_sub(1).map(|before| row[before]);
            let value = match (before, end.map(|end| row[end])) {
                (Some(one), Some(other)) => one.min(other),
                (Some(one), None) | (None, Some(one)) => one,
                (None, None) => break,
            };
            let end = end.unwrap_or(width);
            (x..end).for_each(|x| map.set(x, y, value, 0.0));
            x = end;
        }
    }
}

/// Least pixels around a gap for a plane.
const LEAST_AROUND: usize = 8;
/// Rounds of the fit; after each, pixels more than [`SAME_SURFACE_PX`] from the plane are left out.
const ROUNDS: usize = 3;
/// Pixels nearer to the plane than this, px, are of its surface.
const SAME_SURFACE_PX: f64 = 1.0;
/// The first plane is fitted to this farther share of what surrounds the gap.
const FARTHER_SHARE: f64 = 0.5;

/// Each connected gap takes the plane through what surrounds it within `reach` px: of the farther half first, then of those within
/// 1 px of the plane. Its values stay within what surrounds the gap; gaps with less than 8 px around them, or at the border of the
/// image, stay.
pub fn fill_surfaces(map: &mut DisparityMap, reach: usize) {
    let (width, height) = (usize::from(map.dims().width), usize::from(map.dims().height));
    let before = map.values().to_vec();
    let mut visited = vec![false; before.len()];
    for start in 0..before.len() {
        if visited[start] || before[start].is_finite() {
            continue;
        }
        let gap = connected_gap(start, &before, width, &mut visited);
        let at_border = |&index: &usize| {
            let (x, y) = (index % width, index / width);
            x == 0 || y == 0 || x + 1 == width || y + 1 == height
        };
        if gap.iter().any(at_border) {
            continue;
        }
        let around = surroundings(&gap, &before, (width, height), reach);
        let Some(plane) = Plane::fit(&around) else { continue };
        let low = around.iter().map(|p| p.2).fold(f64::INFINITY, f64::min);
        let high = around.iter().map(|p| p.2).fold(f64::NEG_INFINITY, f64::max);
        for index in gap {
            let (x, y) = (index % width, index / width);
            map.set(x, y, plane.at(x as f64, y as f64).clamp(low, high) as f32, 0.0);
        }
    }
}

fn connected_gap(start: usize, values: &[f32], width: usize, visited: &mut [bool]) -> Vec<usize> {
    let mut gap = vec![start];
    visited[start] = true;
    let mut next = 0;
    while let Some(&index) = gap.get(next) {
        next += 1;
        for neighbour in neighbours(index, width, values.len()) {
            if !visited[neighbour] && values[neighbour].is_nan() {
                visited[neighbour] = true;
                gap.push(neighbour);
            }
        }
    }
    gap
}

/// Column, row and disparity of the known pixels within `reach` px of the gap.
fn surroundings(gap: &[usize], values: &[f32], (width, height): (usize, usize), reach: usize) -> Vec<(f64, f64, f64)> {
    let mut found = Vec::new();
    for &index in gap {
        let (x, y) = (index % width, index / width);
        for row in y.saturating_sub(reach)..=(y + reach).min(height - 1) {
            let columns = x.saturating_sub(reach)..=(x + reach).min(width - 1);
            found.extend(columns.map(|x| row * width + x).filter(|&i| values[i].is_finite()));
        }
    }
    found.sort_unstable();
    found.dedup();
    found.into_iter().map(|i| ((i % width) as f64, (i / width) as f64, values[i].into())).collect()
}

/// `d = a x + b y + c`.
struct Plane([f64; 3]);

impl Plane {
    fn at(&self, x: f64, y: f64) -> f64 {
        self.0[0] * x + self.0[1] * y + self.0[2]
    }

    /// `None` where there is too little, or all on one line.
    fn fit(around: &[(f64, f64, f64)]) -> Option<Self> {
        let mut farther: Vec<_> = around.to_vec();
        farther.sort_by(|a, b| a.2.total_cmp(&b.2));
        farther.truncate((FARTHER_SHARE * around.len() as f64).ceil() as usize);
        let mut plane = Self::least_squares(&farther)?;
        for _ in 1..ROUNDS {
            let near = |p: &&(f64, f64, f64)| (plane.at(p.0, p.1) - p.2).abs() <= SAME_SURFACE_PX;
            let same: Vec<_> = around.iter().filter(near).copied().collect();
            let Some(better) = Self::least_squares(&same) else { break };
            plane = better;
        }
        Some(plane)
    }

    fn least_squares(points: &[(f64, f64, f64)]) -> Option<Self> {
        if points.len() < LEAST_AROUND {
            return None;
        }
        let mut normal = nalgebra::Matrix3::<f64>::zeros();
        let mut right = nalgebra::Vector3::<f64>::zeros();
        // Coordinates relative to the first pixel keep the sums small.
        let (x0, y0, _) = points[0];
        for &(x, y, d) in points {
            let row = nalgebra::Vector3::new(x - x0, y - y0, 1.0);
            normal += row * row.transpose();
            right += row * d;
        }
        let [a, b, c] = normal.cholesky()?.solve(&right).into();
        Some(Self([a, b, c - a * x0 - b * y0]))
    }
}
