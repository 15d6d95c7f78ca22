//! The depth of objects, given their masks.
//!
//! An object is judged if 60 of its pixels are visible in both images and 30 have truth. An answer
//! is wrong when it lies more than 1 px outside the middle 90 % of the object's true disparities.

use super::classes::THIN;
use super::figures::{Better, Figure, Group, Values, percent};
use super::grid::Grid;
use linestereo_frames::statistics::numpy_quantile;
use std::collections::BTreeMap;

const LEAST_VISIBLE: usize = 60;
const LEAST_KNOWN: usize = 30;
/// Ends of the true disparities, as shares.
const ENDS: [f64; 2] = [0.05, 0.95];
/// Beyond these ends by more is wrong, px.
const TOLERANCE: f64 = 1.0;

/// Ground truth of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ObjectTruth {
    /// Its value in the mask.
    pub(crate) label: u16,
    /// Most of its pixels are of something thin.
    pub(crate) is_thin: bool,
    /// Ends of its disparities, px.
    pub(crate) range: [f64; 2],
}

/// Objects of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Tally {
    objects: usize,
    answered: usize,
    wrong: usize,
}

/// Objects of all scenes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Objects {
    solid: Tally,
    thin: Tally,
}

/// The objects of a scene that are judged.
pub(crate) fn truths(
    mask: &Grid<u16>,
    truth: &Grid<f64>,
    labels: &Grid<u8>,
    visible: &Grid<bool>,
) -> Vec<ObjectTruth> {
    let mut pixels: BTreeMap<u16, Vec<(usize, usize)>> = BTreeMap::new();
    for (x, y) in mask.positions().filter(|&(x, y)| mask.at(x, y) > 0) {
        pixels.entry(mask.at(x, y)).or_default().push((x, y));
    }
    let judged = |(label, pixels): (u16, Vec<(usize, usize)>)| {
        let count = |holds: &dyn Fn(usize, usize) -> bool| {
            pixels.iter().filter(|&&(x, y)| holds(x, y)).count()
        };
        let mut known: Vec<f64> =
            pixels.iter().map(|&(x, y)| truth.at(x, y)).filter(|d| d.is_finite()).collect();
        if count(&|x, y| visible.at(x, y)) < LEAST_VISIBLE || known.len() < LEAST_KNOWN {
            return None;
        }
        known.sort_unstable_by(f64::total_cmp);
        let [low, high] = ENDS.map(|share| numpy_quantile(&known, share));
        let is_thin = 2 * count(&|x, y| labels.at(x, y) == THIN) > pixels.len();
        Some(ObjectTruth { label, is_thin, range: [low?, high?] })
    };
    pixels.into_iter().filter_map(judged).collect()
}

impl Objects {
    /// Adds a scene; `answers` has a disparity for each label that has one, px.
    pub(crate) fn add(&mut self, truths: &[ObjectTruth], answers: &BTreeMap<u16, f64>) {
        for truth in truths {
            let tally = if truth.is_thin { &mut self.thin } else { &mut self.solid };
            tally.objects += 1;
            if let Some(disparity) = answers.get(&truth.label) {
                let [low, high] = truth.range;
                tally.answered += 1;
                tally.wrong += usize::from((low - disparity).max(disparity - high) > TOLERANCE);
            }
        }
    }

    /// Figures of linestereo; OpenCV has no notion of an object.
    pub(crate) fn group(&self) -> Group {
        let of = Values::linestereo;
        let figures = [("thin", &self.thin), ("other", &self.solid)]
            .into_iter()
            .filter(|(_, tally)| tally.objects > 0);
        let figures = figures.flat_map(|(name, tally)| {
            let (answered, wrong) = (
                percent(tally.answered, tally.objects),
                percent(tally.wrong, tally.answered.max(1)),
            );
            [
                Figure::count(format!("{name}: objects"), of(tally.objects as f64)),
                Figure::new(format!("{name}: answered, %"), Better::Higher, 0, of(answered)),
                Figure::new(format!("{name}: wrong of these, %"), Better::Lower, 1, of(wrong)),
            ]
        });
        Group::new("objects by their masks", figures.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_with_enough_pixels_are_judged() {
        // Object 1 fills ten columns, 2 is thin, 3 is too small.
        let mask = Grid::new(16, vec![0_u16; 16 * 32]).map(|x, y| match x {
            0..10 => 1,
            10..12 => 2,
            12 if y < 20 => 3,
            _ => 0,
        });
        let truth = mask.map(|x, _| if x < 10 { 10.0 + x as f64 } else { 30.0 });
        let labels = mask.map(|x, _| if x < 10 { 3 } else { THIN });
        let visible = mask.map(|_, _| true);
        let truths = truths(&mask, &truth, &labels, &visible);
        let expected = [
            ObjectTruth { label: 1, is_thin: false, range: [10.0, 19.0] },
            ObjectTruth { label: 2, is_thin: true, range: [30.0, 30.0] },
        ];
        assert_eq!(truths, expected);

        let mut objects = Objects::default();
        objects.add(&truths, &BTreeMap::from([(1, 20.0), (2, 28.5)]));
        objects.add(&truths, &BTreeMap::from([(2, 31.0), (7, 1.0)]));
        assert_eq!(objects.solid, Tally { objects: 2, answered: 1, wrong: 0 });
        assert_eq!(objects.thin, Tally { objects: 2, answered: 2, wrong: 1 });
        assert_eq!(objects.group().figures.len(), 6);
    }
}
