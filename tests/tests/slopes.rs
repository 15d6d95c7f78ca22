//! Surfaces that are not parallel to the images: a disparity belongs to the place where it is told.
//!
//! A plane with a smooth random texture is drawn into both images exactly; the bias is the median
//! of told minus true disparities, at the pixels that the points stand on.

use linestereo::{Dims, Params, params::Parts, results::Source};
use linestereo_frames::GrayImage;
use linestereo_sim::engine::Engine;
use linestereo_tests::drawn::Random;

const DIMS: Dims = Dims { width: 320, height: 240 };
/// Cells of the texture, px.
const CELL: f64 = 3.0;
/// Disparity in the middle of the image, px.
const MIDDLE: f64 = 40.0;
/// Change of disparity per row or column, px.
const SLOPES: [f64; 6] = [-0.3, -0.2, -0.1, 0.05, 0.15, 0.3];
/// Fewest points that a bias is taken of.
const FEWEST: usize = 300;
/// Largest bias of support points, px.
const LARGEST: f64 = 0.03;

/// Random grey levels at the corners of cells, smooth between them.
pub(crate) struct Texture(Vec<f64>);

impl Texture {
    const SIDE: usize = 256;

    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        Self((0..Self::SIDE * Self::SIDE).map(|_| f64::from(random.grey())).collect())
    }

    pub(crate) fn at(&self, x: f64, y: f64) -> f64 {
        let (u, v) = (x / CELL + 40.0, y / CELL + 40.0);
        let (i, j) = (u.floor(), v.floor());
        // The cubic whose slope is zero at the corners.
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let (fu, fv) = (smooth(u - i), smooth(v - j));
        let corner =
            |i: f64, j: f64| self.0[j as usize % Self::SIDE * Self::SIDE + i as usize % Self::SIDE];
        let row = |j: f64| corner(i, j) * (1.0 - fu) + corner(i + 1.0, j) * fu;
        row(j) * (1.0 - fv) + row(j + 1.0) * fv
    }
}

/// A plane whose disparity changes by `[across, down]` px per column and row.
struct Plane([f64; 2]);

impl Plane {
    fn disparity(&self, x: f64, y: f64) -> f64 {
        let [across, down] = self.0;
        MIDDLE + across * (x - 160.0) + down * (y - 120.0)
    }

    /// Both images: what the right one shows at a pixel is where the plane's disparity leads there.
    fn draw(&self, texture: &Texture) -> [GrayImage; 2] {
        let [across, _] = self.0;
        let paint = |column: &dyn Fn(f64, f64) -> f64| {
            linestereo_tests::drawn::painted(DIMS.width, DIMS.height, |x, y| {
                let (x, y) = (f64::from(x), f64::from(y));
                texture.at(column(x, y), y).round() as u8
            })
        };
        let seen_from_right = |x: f64, y: f64| (x + self.disparity(0.0, y)) / (1.0 - across);
        [paint(&|x, _| x), paint(&seen_from_right)]
    }
}

/// Median of told minus true disparities of these points.
fn bias(
    plane: &Plane,
    texture: &Texture,
    parts: Parts,
    is_counted: fn(Source) -> bool,
) -> (f64, usize) {
    let [left, right] = plane.draw(texture);
    let params = Params { max_disparity: 112, parts, ..Params::default() };
    let mut engine = Engine::new(&params, DIMS).unwrap();
    let found = engine.run(left.view().unwrap(), right.view().unwrap()).unwrap();
    let counted = found.points.iter().filter(|point| is_counted(point.source));
    let mut errors: Vec<f64> = counted
        .map(|point| {
            point.disparity.to_num::<f64>() - plane.disparity(point.x.into(), point.y.into())
        })
        .filter(|error| error.abs() < 1.5)
        .collect();
    errors.sort_by(f64::total_cmp);
    (errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN), errors.len())
}

/// The bias for every slope, down the rows and along the columns; the largest one, in units of the
/// largest allowed: [`LARGEST`], or twice as much where the eight columns of a window span more
/// than two disparities.
fn table(texture: &Texture, parts: Parts, is_counted: fn(Source) -> bool) -> (f64, String) {
    let (mut worst, mut table) = (0.0_f64, String::new());
    for slope in SLOPES {
        for (name, plane) in
            [("down the rows", Plane([0.0, slope])), ("along the columns", Plane([slope, 0.0]))]
        {
            let (bias, count) = bias(&plane, texture, parts, is_counted);
            table += &format!("{slope:5.2} px {name}: {bias:6.3} px of {count}\n");
            let spans_two = slope.abs() > 0.25 && name == "along the columns";
            if count >= FEWEST {
                worst = worst.max(bias.abs() / if spans_two { 2.0 * LARGEST } else { LARGEST });
            }
            assert!(count >= FEWEST || spans_two, "{table}");
        }
    }
    println!("{table}");
    (worst, table)
}

#[test]
fn support_points_on_slopes_have_no_bias() {
    let (worst, table) =
        table(&Texture::new(1), Parts::Support, |source| source == Source::Support);
    assert!(worst < 1.0, "{table}");
}

/// A side's pixels have one disparity across the edge, which its window took some columns beside
/// it: that is what is left here.
#[test]
fn pixels_of_segments_on_slopes_have_a_bias_of_one_slope_at_most() {
    let (worst, table) = table(&Texture::new(2), Parts::Both, |source| source != Source::Support);
    assert!(worst * LARGEST < 0.35, "{table}");
}

/// Median errors of matched segments at their middle, near-vertical ones and near-horizontal ones,
/// with their numbers.
fn bias_of_segments(plane: &Plane, texture: &Texture) -> [(f64, usize); 2] {
    let [left, right] = plane.draw(texture);
    let params = Params { max_disparity: 112, ..Params::default() };
    let mut engine = Engine::new(&params, DIMS).unwrap();
    let found = engine.run(left.view().unwrap(), right.view().unwrap()).unwrap();
    let mut errors = [Vec::new(), Vec::new()];
    for segment in &found.matches {
        let [a, b] = segment.ends.map(|end| [end.x.to_num::<f64>(), end.y.to_num::<f64>()]);
        let [x, y] = [0, 1].map(|axis| (a[axis] + b[axis]) / 2.0);
        let told = segment.disparity.iter().map(|d| d.to_num::<f64>()).sum::<f64>() / 2.0;
        let is_near_horizontal = (b[0] - a[0]).abs() > (b[1] - a[1]).abs();
        errors[usize::from(is_near_horizontal)].push(told - plane.disparity(x, y));
    }
    errors.map(|mut errors| {
        errors.sort_by(f64::total_cmp);
        (errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN), errors.len())
    })
}

/// Of a ground, of any slope; of a ceiling up to 0.2 px a row, since beyond it both sides of a
/// segment along the columns are taken for two surfaces.
#[test]
fn segments_on_slopes_down_the_rows_have_no_bias() {
    for down in [-0.2, -0.1, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.6] {
        let found = bias_of_segments(&Plane([0.0, down]), &Texture::new(3));
        println!("{down:5.2} px a row, near-vertical, near-horizontal: {found:.3?}");
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
        let found = bias_of_segments(&Plane([across, 0.0]), &Texture::new(3));
        println!("{across:5.2} px a column, near-vertical, near-horizontal: {found:.3?}");
        for (bias, count) in found {
            assert!(bias.abs() < 2.5 * across.abs() && count >= 25, "{across}: {found:.3?}");
        }
    }
}
