//! Surfaces that are not parallel to the images: a disparity belongs to the place where it is told.
//!
//! A plane with a smooth random texture is drawn into both images exactly; the bias is the median
//! of told minus true disparities, at the pixels that the points stand on.

use linestereo::{Dims, Params, params::Parts, results::Source};
use linestereo_frames::statistics::upper_median;
use linestereo_sim::engine::FrameResult;
use linestereo_tests::drawn::surface;
use linestereo_tests::matched;

const DIMS: Dims = Dims { width: 320, height: 240 };
/// Disparity in the middle of the image, px.
const MIDDLE: f64 = 40.0;
/// Change of disparity per row or column, px.
const SLOPES: [f64; 6] = [-0.3, -0.2, -0.1, 0.05, 0.15, 0.3];
/// Fewest points that a bias is taken of.
const FEWEST: usize = 300;
/// Largest bias of support points, px.
const LARGEST: f64 = 0.03;

/// A plane whose disparity changes by `[across, down]` px per column and row.
struct Plane([f64; 2]);

impl Plane {
    fn disparity(&self, x: f64, y: f64) -> f64 {
        let [across, down] = self.0;
        MIDDLE + across * (x - 160.0) + down * (y - 120.0)
    }

    fn run(&self, seed: u64, parts: Parts) -> FrameResult {
        let pair = surface(DIMS, seed, |y| self.disparity(0.0, y), self.0[0]);
        let params = Params { max_disparity: 112, parts, ..Params::default() };
        matched(&params, pair.each_ref()).1
    }
}

/// The median of errors, px, and their number.
fn median(errors: Vec<f64>) -> (f64, usize) {
    let count = errors.len();
    (upper_median(errors, f64::total_cmp).unwrap_or(f64::NAN), count)
}

/// Median of told minus true disparities of these points.
fn bias(plane: &Plane, seed: u64, parts: Parts, is_counted: fn(Source) -> bool) -> (f64, usize) {
    let found = plane.run(seed, parts);
    let counted = found.points.iter().filter(|point| is_counted(point.source));
    let errors = counted
        .map(|point| {
            point.disparity.to_num::<f64>() - plane.disparity(point.x.into(), point.y.into())
        })
        .filter(|error| error.abs() < 1.5);
    median(errors.collect())
}

/// The bias for every slope, down the rows and along the columns; the largest one, in units of the
/// largest allowed: [`LARGEST`], or twice as much where the eight columns of a window span more
/// than two disparities.
fn table(seed: u64, parts: Parts, is_counted: fn(Source) -> bool) -> (f64, String) {
    let (mut worst, mut table) = (0.0_f64, String::new());
    for slope in SLOPES {
        for (name, plane) in
            [("down the rows", Plane([0.0, slope])), ("along the columns", Plane([slope, 0.0]))]
        {
            let (bias, count) = bias(&plane, seed, parts, is_counted);
            table += &format!("{slope:5.2} px {name}: {bias:6.3} px of {count}\n");
            let spans_two = slope.abs() > 0.25 && name == "along the columns";
            if count >= FEWEST {
                worst = worst.max(bias.abs() / if spans_two { 2.0 * LARGEST } else { LARGEST });
            }
            assert!(count >= FEWEST || spans_two, "{table}");
        }
    }
    (worst, table)
}

#[test]
fn support_points_on_slopes_have_no_bias() {
    let (worst, table) = table(1, Parts::Support, |source| source == Source::Support);
    assert!(worst < 1.0, "{table}");
}

/// A side's pixels have one disparity across the edge, which its window took some columns beside
/// it: that is what is left here.
#[test]
fn pixels_of_segments_on_slopes_have_a_bias_of_one_slope_at_most() {
    let (worst, table) = table(2, Parts::Both, |source| source != Source::Support);
    assert!(worst * LARGEST < 0.35, "{table}");
}

/// Median errors of matched segments at their middle, near-vertical ones and near-horizontal ones,
/// with their numbers.
fn bias_of_segments(plane: &Plane) -> [(f64, usize); 2] {
    let found = plane.run(3, Parts::Both);
    let mut errors = [Vec::new(), Vec::new()];
    for segment in &found.matches {
        let [a, b] = segment.ends.map(|end| [end.x.to_num::<f64>(), end.y.to_num::<f64>()]);
        let [x, y] = [0, 1].map(|axis| (a[axis] + b[axis]) / 2.0);
        let told = segment.disparity.iter().map(|d| d.to_num::<f64>()).sum::<f64>() / 2.0;
        let is_near_horizontal = (b[0] - a[0]).abs() > (b[1] - a[1]).abs();
        errors[usize::from(is_near_horizontal)].push(told - plane.disparity(x, y));
    }
    errors.map(median)
}

/// Of a ground, of any slope; of a ceiling up to 0.2 px a row, since beyond it both sides of a
/// segment along the columns are taken for two surfaces.
#[test]
fn segments_on_slopes_down_the_rows_have_no_bias() {
    for down in [-0.2, -0.1, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.6] {
        let found = bias_of_segments(&Plane([0.0, down]));
        for (bias, count) in found {
            assert!(bias.abs() < LARGEST || count < 25, "{down}: {found:.3?}");
        }
        let [_, (_, near_horizontal)] = found;
        assert!(near_horizontal >= 50, "{down}: {found:.3?}");
    }
}

/// Windows beside an edge lie 5 px off it: what owns the edge alone tells the disparity there.
#[test]
fn segments_on_slopes_along_the_columns_are_biased_by_their_windows() {
    for across in [-0.2, -0.1, 0.05, 0.1, 0.15, 0.2_f64] {
        let found = bias_of_segments(&Plane([across, 0.0]));
        for (bias, count) in found {
            assert!(bias.abs() < 2.5 * across.abs() && count >= 25, "{across}: {found:.3?}");
        }
    }
}
