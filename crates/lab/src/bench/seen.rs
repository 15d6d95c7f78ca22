//! Seen: the share of cells that are answered with at least 90 %, and how many answers are wrong.
//!
//! A cell of 16x16 pixels counts where a third of it has truth. The answer of linestereo is its
//! most probable point there; that of a dense matcher the median of its pixels.

use super::cells::Hypothesis;
use super::figures::{Better, Figure, Group, Values, percent};
use super::grid::Grid;
use core::hash::Hash;
use linestereo_frames::statistics::median;
use std::collections::HashMap;

/// Side of a cell, px.
const CELL: usize = 16;
/// Least share of the pixels of a cell that have truth.
const LEAST_KNOWN: f64 = 0.33;
/// Least probability of an answer.
const SURE: f64 = 0.9;
/// Fewest pixels of a dense matcher that are an answer.
const LEAST_PIXELS: usize = 16;

/// Cells, and what is answered in them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Seen {
    pub(crate) cells: usize,
    pub(crate) answered: usize,
    /// More than 1 px off, and more than 2 px.
    pub(crate) off: [usize; 2],
}

impl Seen {
    /// One more cell, with the error of its answer if it has one, px.
    pub(crate) fn count(&mut self, error: Option<f64>) {
        self.cells += 1;
        if let Some(error) = error {
            self.answered += 1;
            for (off, limit) in self.off.iter_mut().zip([1.0, 2.0]) {
                *off += usize::from(error > limit);
            }
        }
    }

    /// Answered cells, in percent.
    pub(crate) fn answered_percent(&self) -> f64 {
        percent(self.answered, self.cells)
    }

    /// Answers that are more than 1 px off, and more than 2 px, in percent.
    pub(crate) fn off_percent(&self) -> [f64; 2] {
        self.off.map(|off| percent(off, self.answered.max(1)))
    }

    fn joined(scenes: &[Self]) -> Self {
        scenes.iter().fold(Self::default(), |sum, scene| Self {
            cells: sum.cells + scene.cells,
            answered: sum.answered + scene.answered,
            off: [sum.off[0] + scene.off[0], sum.off[1] + scene.off[1]],
        })
    }
}

/// Upper left pixels of the cells that count.
pub(crate) fn cells(truth: &Grid<f64>) -> Vec<(usize, usize)> {
    let starts = |side: usize| (0..(side + 1).saturating_sub(CELL)).step_by(CELL);
    let known = |&(x0, y0): &(usize, usize)| {
        let known = pixels((x0, y0), CELL).filter(|&(x, y)| truth.at(x, y).is_finite()).count();
        known as f64 / (CELL * CELL) as f64 >= LEAST_KNOWN
    };
    let all = starts(truth.height()).flat_map(|y| starts(truth.width()).map(move |x| (x, y)));
    all.filter(known).collect()
}

/// Pixels of a square.
pub(super) fn pixels(
    (x0, y0): (usize, usize),
    side: usize,
) -> impl Iterator<Item = (usize, usize)> {
    (y0..y0 + side).flat_map(move |y| (x0..x0 + side).map(move |x| (x, y)))
}

/// A scene by the points of linestereo: truth counts at a point, or one pixel beside it.
pub(crate) fn of_points(
    cells: &[(usize, usize)],
    points: &[Hypothesis],
    truth: &Grid<f64>,
) -> Seen {
    let errors = surest(points, |point| {
        let cell = (point.x / CELL * CELL, point.y / CELL * CELL);
        Some((cell, truth_near(truth, (point.x, point.y))?))
    });
    let mut seen = Seen::default();
    cells.iter().for_each(|cell| seen.count(errors.get(cell).copied()));
    seen
}

/// The error of the surest point of each cell, px, if it has at least [`SURE`]; `place` says the
/// cell of a point and the truth there.
pub(super) fn surest<C: Eq + Hash>(
    points: &[Hypothesis],
    place: impl Fn(&Hypothesis) -> Option<(C, f64)>,
) -> HashMap<C, f64> {
    let mut best: HashMap<C, (f64, f64)> = HashMap::new();
    for point in points.iter().filter(|point| point.confidence >= SURE) {
        let Some((cell, truth)) = place(point) else { continue };
        let found = (point.confidence, (point.disparity - truth).abs());
        let kept = best.entry(cell).or_insert(found);
        if found.0 > kept.0 {
            *kept = found;
        }
    }
    best.into_iter().map(|(cell, (_, error))| (cell, error)).collect()
}

/// Median error of a map at these pixels, px, if so many have a disparity and a truth.
pub(super) fn median_error(
    pixels: impl Iterator<Item = (usize, usize)>,
    [map, truth]: [&Grid<f64>; 2],
    least: usize,
) -> Option<f64> {
    let errors = pixels.map(|(x, y)| (map.at(x, y) - truth.at(x, y)).abs());
    let errors: Vec<f64> = errors.filter(|error| error.is_finite()).collect();
    if errors.len() >= least { median(errors, f64::total_cmp) } else { None }
}

/// The truth of a pixel, else of the one to the left, to the right, above, below.
fn truth_near(truth: &Grid<f64>, at: (usize, usize)) -> Option<f64> {
    let places = [[0, 0], [-1, 0], [1, 0], [0, -1], [0, 1]];
    places.into_iter().map(|by| truth.around(at, by)).find(|value| value.is_finite())
}

/// A scene by a map of disparities, not a number where there is none.
pub(crate) fn of_map(cells: &[(usize, usize)], map: &Grid<f64>, truth: &Grid<f64>) -> Seen {
    let mut seen = Seen::default();
    for &cell in cells {
        seen.count(median_error(pixels(cell, CELL), [map, truth], LEAST_PIXELS));
    }
    seen
}

/// Figures of the scenes of linestereo, SGBM and StereoBM.
pub(crate) fn group(methods: &[Vec<Seen>; 3]) -> Group {
    let of = |value: &dyn Fn(&[Seen]) -> f64| {
        Values::new(methods.each_ref().map(|scenes| (!scenes.is_empty()).then(|| value(scenes))))
    };
    let all = |value: &dyn Fn(Seen) -> f64| of(&|scenes| value(Seen::joined(scenes)));
    let worst = |scenes: &[Seen]| {
        let shares = scenes.iter().map(|scene| scene.answered as f64 / scene.cells as f64);
        100.0 * shares.reduce(|a, b| if a.is_nan() || a < b { a } else { b }).unwrap_or(f64::NAN)
    };
    let [off_1, off_2] = [0, 1].map(|limit: usize| all(&|seen| seen.off_percent()[limit]));
    let answered = all(&|seen| seen.answered_percent());
    Group::new(
        "seen: 16x16 cells with an answer of p >= 0.9",
        vec![
            Figure::count("cells", all(&|seen| seen.cells as f64)),
            Figure::new("answered, %", Better::Higher, 0, answered),
            Figure::new("answered in the worst scene, %", Better::Higher, 0, of(&worst)).minor(),
            Figure::new("answers off by > 1 px, %", Better::Lower, 2, off_1),
            Figure::new("answers off by > 2 px, %", Better::Lower, 2, off_2).minor(),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: usize, y: usize, disparity: f64, confidence: f64) -> Hypothesis {
        Hypothesis { x, y, disparity, confidence }
    }

    #[test]
    fn cells_with_little_truth_do_not_count() {
        // A third of the first cell, less of the second; the rest is no whole cell.
        let truth = Grid::new(40, vec![0.0; 40 * 20]).map(|x, y| {
            let known = (x < 16 && y < 6) || ((16..32).contains(&x) && y < 5) || x >= 32;
            if known { 9.0 } else { f64::NAN }
        });
        assert_eq!(cells(&truth), [(0, 0)]);
    }

    #[test]
    fn the_most_probable_point_with_truth_beside_it_answers() {
        let truth =
            Grid::new(48, vec![0.0; 48 * 16]).map(|x, _| if x % 16 < 8 { 9.0 } else { f64::NAN });
        let all = cells(&truth);
        assert_eq!(all.len(), 3);
        let points = [
            point(0, 0, 9.5, 0.91),
            point(8, 0, 11.5, 0.95),  // truth is one pixel to the left
            point(10, 0, 30.0, 0.99), // none near
            point(16, 0, 30.0, 0.89), // not sure enough
            point(34, 3, 10.5, 0.9),
        ];
        assert_eq!(of_points(&all, &points, &truth), Seen { cells: 3, answered: 2, off: [2, 1] });
    }

    #[test]
    fn a_map_answers_by_the_median_of_enough_pixels() {
        let truth = Grid::new(32, vec![9.0; 32 * 16]);
        let map = truth.map(|x, y| match (x < 16, y) {
            (true, _) => 10.5,
            (false, 0) if x < 31 => 9.0,
            _ => f64::NAN,
        });
        assert_eq!(
            of_map(&cells(&truth), &map, &truth),
            Seen { cells: 2, answered: 1, off: [1, 0] }
        );
    }

    #[test]
    fn scenes_are_pooled_and_the_worst_is_named() {
        let scenes = vec![
            Seen { cells: 10, answered: 9, off: [3, 1] },
            Seen { cells: 30, answered: 3, off: [0, 0] },
        ];
        let group = group(&[Vec::new(), scenes, Vec::new()]);
        let values: Vec<Option<f64>> =
            group.figures.iter().map(|figure| figure.values.sgbm).collect();
        assert_eq!(values, [Some(40.0), Some(30.0), Some(10.0), Some(25.0), Some(100.0 / 12.0)]);
    }
}
