//! Seen by class: what is answered of floor, walls, furniture, thin things and holes.
//!
//! A cell of 8x8 pixels counts for a class that fills two thirds of it with visible pixels; an
//! eighth is enough of what is thin. The answer of linestereo is its most probable point on that
//! class with at least 90 %; that of a dense matcher the median of its pixels on it.

use super::cells::Hypothesis;
use super::figures::{Better, Figure, Group, Values};
use super::grid::Grid;
use super::seen::{self, Seen, median_error, surest};

/// Side of a cell, px.
const CELL: usize = 8;
/// Fewest pixels of a dense matcher that are an answer.
const LEAST_PIXELS: usize = 4;
/// Label of what reflects or shines: it is never scored.
pub(crate) const GLOSSY: u8 = 5;
/// Label of what is narrower than 8 px.
pub(crate) const THIN: u8 = 4;

/// Labels with their names, and how many pixels make a cell count.
const CLASSES: [(u8, &str, usize); 5] = [
    (1, "floor", 43),
    (2, "wall", 43),
    (3, "furniture", 43),
    (THIN, "thin", 8),
    (6, "below the floor", 43),
];

/// A cell that counts for a class: column, row and label.
pub(crate) type ClassCell = (usize, usize, u8);

/// Cells of each class with their answers, in the order of [`CLASSES`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SeenByClass([Seen; CLASSES.len()]);

/// Cells that count.
pub(crate) fn cells(labels: &Grid<u8>, visible: &Grid<bool>) -> Vec<ClassCell> {
    let mut cells = Vec::new();
    for row in 0..labels.height() / CELL {
        for column in 0..labels.width() / CELL {
            for (label, _, least) in CLASSES {
                let of_class =
                    |&(x, y): &(usize, usize)| labels.at(x, y) == label && visible.at(x, y);
                if pixels(column, row).filter(of_class).count() >= least {
                    cells.push((column, row, label));
                }
            }
        }
    }
    cells
}

fn pixels(column: usize, row: usize) -> impl Iterator<Item = (usize, usize)> {
    seen::pixels((CELL * column, CELL * row), CELL)
}

impl SeenByClass {
    /// Adds a scene by the points of linestereo.
    pub(crate) fn add_points(
        &mut self,
        cells: &[ClassCell],
        points: &[Hypothesis],
        labels: &Grid<u8>,
        truth: &Grid<f64>,
    ) {
        let errors = surest(points, |&Hypothesis { x, y, .. }| {
            let cell = (x / CELL, y / CELL, labels.at(x, y));
            Some((cell, truth.at(x, y))).filter(|(_, truth)| truth.is_finite())
        });
        self.add(cells, |cell| errors.get(cell).copied());
    }

    /// Adds a scene by a map of disparities, not a number where there is none.
    pub(crate) fn add_map(
        &mut self,
        cells: &[ClassCell],
        map: &Grid<f64>,
        labels: &Grid<u8>,
        truth: &Grid<f64>,
    ) {
        self.add(cells, |&(column, row, label)| {
            let on_class = pixels(column, row).filter(|&(x, y)| labels.at(x, y) == label);
            median_error(on_class, [map, truth], LEAST_PIXELS)
        });
    }

    fn add(&mut self, cells: &[ClassCell], answer: impl Fn(&ClassCell) -> Option<f64>) {
        for cell in cells {
            for (seen, (label, ..)) in self.0.iter_mut().zip(CLASSES) {
                if label == cell.2 {
                    seen.count(answer(cell));
                }
            }
        }
    }
}

/// Figures of linestereo, SGBM and StereoBM.
pub(crate) fn group(methods: &[SeenByClass; 3]) -> Group {
    let mut figures = Vec::new();
    for (index, (_, name, _)) in CLASSES.into_iter().enumerate() {
        let of = |value: &dyn Fn(&Seen) -> f64| {
            let seen = methods.each_ref().map(|classes| &classes.0[index]);
            Values::new(seen.map(|seen| (seen.cells > 0).then(|| value(seen))))
        };
        let [off_1, off_2] = [0, 1].map(|limit: usize| of(&|seen| seen.off_percent()[limit]));
        let named = |what: &str| format!("{name}: {what}");
        figures.extend([
            Figure::count(named("cells"), of(&|seen| seen.cells as f64)),
            Figure::new(named("seen, %"), Better::Higher, 0, of(&Seen::answered_percent)),
            Figure::new(named("off by > 1 px, %"), Better::Lower, 2, off_1),
            Figure::new(named("off by > 2 px, %"), Better::Lower, 2, off_2).minor(),
        ]);
    }
    Group::new("seen by class: 8x8 cells with an answer of p >= 0.9", figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two cells: floor with a thin bar of 8 px, and floor of which too little is visible.
    fn scene() -> (Grid<u8>, Grid<bool>, Grid<f64>) {
        let labels = Grid::new(16, vec![1_u8; 16 * 8]).map(|x, _| if x == 3 { THIN } else { 1 });
        let visible = labels.map(|x, y| x < 8 || y < 5);
        let truth = labels.map(|x, _| if x == 3 { 20.0 } else { 10.0 });
        (labels, visible, truth)
    }

    #[test]
    fn a_cell_counts_for_each_class_that_has_enough_of_it() {
        let (labels, visible, _) = scene();
        assert_eq!(cells(&labels, &visible), [(0, 0, 1), (0, 0, THIN)]);
    }

    #[test]
    fn an_answer_stands_on_its_class() {
        let (labels, visible, truth) = scene();
        let cells = cells(&labels, &visible);
        let point = |x, disparity, confidence| Hypothesis { x, y: 2, disparity, confidence };
        let mut seen = SeenByClass::default();
        // The second point is surer, and on the floor; what it says of the bar does not count.
        seen.add_points(&cells, &[point(3, 21.5, 0.92), point(4, 10.0, 0.99)], &labels, &truth);
        assert_eq!(seen.0[0], Seen { cells: 1, answered: 1, off: [0, 0] });
        assert_eq!(seen.0[3], Seen { cells: 1, answered: 1, off: [1, 0] });

        let mut of_map = SeenByClass::default();
        of_map.add_map(
            &cells,
            &truth.map(|_, y| if y < 3 { 10.0 } else { f64::NAN }),
            &labels,
            &truth,
        );
        assert_eq!(of_map.0[0], Seen { cells: 1, answered: 1, off: [0, 0] });
        assert_eq!(
            of_map.0[3],
            Seen { cells: 1, answered: 0, off: [0, 0] },
            "three pixels are too few"
        );
        let group = group(&[seen, SeenByClass::default(), of_map]);
        assert_eq!(group.figures.len(), 8, "two classes occur");
    }
}
