//! Disparity to colour: red near, blue far.

use crate::engine::FrameResult;

/// Blue, cyan, green, yellow, orange, red: light enough to be seen on a dimmed photograph.
const STOPS: [[f32; 3]; 6] = [
    [70.0, 110.0, 255.0],
    [0.0, 200.0, 255.0],
    [70.0, 225.0, 110.0],
    [255.0, 225.0, 40.0],
    [255.0, 140.0, 20.0],
    [255.0, 45.0, 45.0],
];
/// The range of colours starts and ends on a multiple of this, in px.
const STEP: f32 = 4.0;
/// The lowest disparity that is searched, px: behind infinity, of cameras that converge.
const LEAST: f32 = -32.0;
/// Share of the segments at each end that may lie outside: one wrong match should not spoil the
/// colours of all.
const OUTSIDE: f32 = 0.02;

/// Disparities, in px, that the colours span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Blue.
    pub far: f32,
    /// Red.
    pub near: f32,
}

impl Range {
    /// Range of the segments of a result, of its points where there are none, below
    /// `max_disparity`.
    pub fn of(result: &FrameResult, max_disparity: u16) -> Self {
        let limit = f32::from(max_disparity);
        let mut found = of_segments(result);
        if found.is_empty() {
            found = of_points(result);
        }
        found.sort_by(f32::total_cmp);
        let skip = (OUTSIDE * found.len() as f32) as usize;
        match (found.get(skip), found.iter().rev().nth(skip)) {
            (Some(far), Some(near)) => {
                let far = ((far / STEP).floor() * STEP).clamp(LEAST, limit - STEP);
                Self { far, near: ((near / STEP).ceil() * STEP).clamp(far + STEP, limit) }
            }
            _ => Self { far: 0.0, near: limit },
        }
    }

    /// Number of points and ends of segments that have the colour of an end of the range, since
    /// they lie beyond it.
    pub fn beyond(&self, result: &FrameResult) -> usize {
        let all = of_segments(result).into_iter().chain(of_points(result));
        all.filter(|disparity| !(self.far..=self.near).contains(disparity)).count()
    }
}

fn of_segments(result: &FrameResult) -> Vec<f32> {
    result.matches.iter().flat_map(|found| found.disparity.map(|d| d.to_num::<f32>())).collect()
}

fn of_points(result: &FrameResult) -> Vec<f32> {
    result.points.iter().map(|point| point.disparity.to_num()).collect()
}

/// Colour of a disparity in px; outside the range that of its end.
pub fn colour(range: &Range, disparity: f32) -> [u8; 3] {
    let last = STOPS.len() - 1;
    let position =
        ((disparity - range.far) / (range.near - range.far)).clamp(0.0, 1.0) * last as f32;
    let index = (position as usize).min(last - 1);
    let t = position - index as f32;
    core::array::from_fn(|i| (STOPS[index][i] * (1.0 - t) + STOPS[index + 1][i] * t).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::results::{Point, Source};
    use linestereo::units::{Confidence, Disparity};

    #[test]
    fn what_lies_behind_infinity_has_colours_of_its_own_and_outliers_are_counted() {
        let point = |disparity: i16| Point {
            x: 0,
            y: 0,
            disparity: Disparity::from_num(disparity),
            confidence: Confidence::MAX,
            source: Source::Support,
        };
        let mut disparities: Vec<i16> = (-20..-5).flat_map(|d| [d; 10]).collect();
        let result = |disparities: &[i16]| {
            FrameResult::of_points(disparities.iter().copied().map(point).collect())
        };
        let range = Range::of(&result(&disparities), 64);
        assert_eq!(range, Range { far: -20.0, near: -4.0 });
        assert_ne!(colour(&range, -20.0), colour(&range, -6.0));
        assert_eq!(range.beyond(&result(&disparities)), 0);
        disparities.extend([50, 60]);
        let range = Range::of(&result(&disparities), 64);
        assert_eq!(
            (range, range.beyond(&result(&disparities))),
            (Range { far: -20.0, near: -4.0 }, 2)
        );
    }

    #[test]
    fn red_is_near_and_blue_is_far() {
        let range = Range { far: 8.0, near: 32.0 };
        assert_eq!(colour(&range, 40.0), [255, 45, 45]);
        assert_eq!(colour(&range, 0.0), [70, 110, 255]);
        assert_eq!(colour(&range, 12.8), [0, 200, 255]);
    }
}
