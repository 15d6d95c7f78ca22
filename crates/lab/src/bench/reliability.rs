//! Said against right: is what linestereo calls 90 % probable right in 90 %?
//!
//! Of all points with truth at their pixel, in bins of probability: the mean of what was said, and
//! the share that is within 1 px.

use super::cells::Hypothesis;
use super::figures::{Better, Figure, Group, Values};
use super::grid::Grid;

/// Lower end of each bin, percent; the last one ends at certainty.
const BINS: [u32; 10] = [50, 55, 60, 65, 70, 75, 80, 85, 90, 95];

/// Bins of a short table: the probabilities that are reported by default.
const SURE_PERCENT: u32 = 90;

/// Points of one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Bin {
    points: usize,
    right: usize,
    said: f64,
}

/// Points of all scenes, by what was said of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reliability([Bin; BINS.len()]);

impl Bin {
    fn said_percent(&self) -> f64 {
        100.0 * self.said / self.points as f64
    }

    fn right_percent(&self) -> f64 {
        100.0 * self.right as f64 / self.points as f64
    }
}

impl Reliability {
    /// Adds a scene; `truth` is not a number where it is unknown, or not to be judged.
    pub(crate) fn add(&mut self, points: &[Hypothesis], truth: &Grid<f64>) {
        for point in points {
            let error = (point.disparity - truth.at(point.x, point.y)).abs();
            let bin = BINS.iter().rposition(|&from| point.confidence >= f64::from(from) / 100.0);
            if let Some(bin) = bin.filter(|_| error.is_finite()) {
                let bin = &mut self.0[bin];
                bin.points += 1;
                bin.right += usize::from(error <= 1.0);
                bin.said += point.confidence;
            }
        }
    }

    /// Mean distance between said and right over all points, in percent: the expected calibration
    /// error.
    fn mean_gap(&self) -> f64 {
        let used = || self.0.iter().filter(|bin| bin.points > 0);
        let gaps: f64 = used()
            .map(|bin| bin.points as f64 * (bin.said_percent() - bin.right_percent()).abs())
            .sum();
        gaps / used().map(|bin| bin.points).sum::<usize>() as f64
    }

    /// Figures of linestereo; other methods state no probability.
    pub(crate) fn group(&self, name: &str) -> Group {
        let of = Values::linestereo;
        let mut figures =
            vec![Figure::new("mean |said - right|, %", Better::Lower, 2, of(self.mean_gap()))];
        for (from, bin) in BINS.into_iter().zip(&self.0).filter(|(_, bin)| bin.points > 0) {
            let range =
                format!("p {:.2} to {:.2}", f64::from(from) / 100.0, f64::from(from + 5) / 100.0);
            let main = from >= SURE_PERCENT;
            let of_bin = |what: &str, value: f64| Figure {
                main,
                ..Figure::new(format!("{range}: {what}"), Better::Neither, 1, of(value))
            };
            figures.push(of_bin("said, %", bin.said_percent()));
            figures.push(of_bin("right, %", bin.right_percent()));
            figures.push(Figure::count(format!("{range}: points"), of(bin.points as f64)));
        }
        Group::new(name, figures)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_with_truth_fall_into_bins() {
        let truth = Grid::new(4, vec![10.0, 10.0, 10.0, f64::NAN]);
        let point = |x, disparity, confidence| Hypothesis { x, y: 0, disparity, confidence };
        let mut reliability = Reliability::default();
        reliability.add(
            &[point(0, 11.0, 0.9), point(1, 11.5, 0.92), point(2, 10.0, 0.49), point(3, 10.0, 0.9)],
            &truth,
        );
        assert_eq!(reliability.0[8], Bin { points: 2, right: 1, said: 1.82 });
        assert_eq!(reliability.0.iter().map(|bin| bin.points).sum::<usize>(), 2);
        assert!((reliability.mean_gap() - 41.0).abs() < 1e-9);
        let group = reliability.group("said against right");
        assert_eq!(group.figures.len(), 4);
        assert_eq!(group.figures[1].name, "p 0.90 to 0.95: said, %");
    }
}
