//! Depth quality on a flat wall, by the definitions of Intel's RealSense Depth Quality Tool.
//!
//! In: answers of one or more pairs, a region of the left image, the rig and the wall's distance
//! where they are known. Out:
//!
//! ```text
//! fill rate        share of the region's cells of the support grid that hold an answer                  (RealSense: share of its pixels)
//! plane            the plane d = a x + b y + c, robustly: a plane in space is one in disparity
//! sub-pixel RMS    of d_i - d_plane, px
//! plane-fit RMS    of Z_i - Z_plane, m and share of the distance
//! Z accuracy       median of Z_i - Z_true, signed; the true plane is the fitted one, moved in
//!                  parallel to the known distance
//! temporal noise   standard deviation of a pixel's answer over the pairs, median over the pixels
//! ```
//! Figures of several pairs are the medians of the pairs. One answer a cell counts, its most
//! probable one: segments give many along an edge. Z_plane is taken along the ray of the pixel, so
//! no focal length is needed. Answers more than [`OFF_PLANE`] off are counted by themselves and
//! left out of the rest; RealSense leaves out the nearest and farthest 0.5 %.
//!
//! # Source
//! Intel, "RealSense Camera Depth Testing Methodology", revision 1.0, 2018; librealsense,
//! tools/depth-quality/rs-depth-quality.cpp (its texts on Z accuracy, plane fit RMS error, subpixel
//! RMS error and fill rate).

use linestereo::{Area, Rig, results::Point, unstable::SUPPORT_PITCH};
use linestereo_frames::statistics::upper_median;
use serde::Serialize;
use std::collections::HashMap;

/// Distance from the plane above which an answer is wrong, px.
pub const OFF_PLANE: f64 = 1.0;
/// Least number of answers for a plane.
const LEAST_ANSWERS: usize = 12;
/// Planes through three answers that are tried.
const TRIALS: u64 = 300;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallAnswer {
    pub at: [f64; 2],
    pub disparity: f64,
    /// Distance from the plane, px; `None` without a plane.
    pub off: Option<f64>,
}

/// Disparity over the image: `a x + b y + c`, px.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plane([f64; 3]);

impl Plane {
    fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let Self([a, b, c]) = self;
        a * x + b * y + c
    }
}

/// Figures of a wall; those that nobody can know are missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Quality {
    pub pairs: usize,
    /// Left, top, width, height of the region, px of the images as matched.
    pub region: [u16; 4],
    pub cells: usize,
    /// Share of them with an answer.
    pub fill_rate: f64,
    /// Share of the answers that are more than [`OFF_PLANE`] off the plane.
    pub off_plane: Option<f64>,
    pub sub_pixel_rms_px: Option<f64>,
    /// Depth of the plane in the middle of the region, m.
    pub distance_m: Option<f64>,
    pub tilt_deg: Option<f64>,
    pub plane_fit_rms_m: Option<f64>,
    /// Share of the distance.
    pub plane_fit_rms: Option<f64>,
    /// Signed, m: above 0 is too far.
    pub z_accuracy_m: Option<f64>,
    /// Signed, share of the known distance.
    pub z_accuracy: Option<f64>,
    /// Disparity that would have to be added for the known distance, px.
    pub disparity_error_px: Option<f64>,
    /// Pixels with an answer in at least half of the pairs.
    pub repeated_pixels: Option<usize>,
    pub temporal_noise_px: Option<f64>,
    pub temporal_noise_m: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
pub struct Wall<'a> {
    /// Part of the left image that shows nothing but the wall.
    pub region: Area,
    pub rig: Option<&'a Rig>,
    /// Depth of the wall in the middle of the region, if it is known, m.
    pub distance_m: Option<f64>,
}

impl Wall<'_> {
    fn columns(&self) -> (usize, usize) {
        centres(self.region.left, self.region.right)
    }

    fn rows(&self) -> (usize, usize) {
        centres(self.region.top, self.region.bottom)
    }

    fn cells(&self) -> usize {
        let ((left, right), (top, bottom)) = (self.columns(), self.rows());
        (right - left) * (bottom - top)
    }

    /// The most probable answer of each cell.
    fn answers(&self, points: &[Point]) -> Vec<WallAnswer> {
        let ((left, right), (top, bottom)) = (self.columns(), self.rows());
        let mut best: HashMap<(usize, usize), &Point> = HashMap::new();
        for point in points {
            let cell = (usize::from(point.x / SUPPORT_PITCH), usize::from(point.y / SUPPORT_PITCH));
            if (left..right).contains(&cell.0) && (top..bottom).contains(&cell.1) {
                let best = best.entry(cell).or_insert(point);
                if point.confidence > best.confidence {
                    *best = point;
                }
            }
        }
        let mut cells: Vec<_> = best.into_iter().collect();
        cells.sort_by_key(|(cell, _)| *cell);
        let answer = |point: &Point| WallAnswer {
            at: [point.x.into(), point.y.into()],
            disparity: point.disparity.to_num(),
            off: None,
        };
        cells.into_iter().map(|(_, point)| answer(point)).collect()
    }

    /// Disparity with the rig's offset, of which depth is the inverse, and f*B in px*m.
    fn stereo(&self) -> Option<(f64, f64)> {
        let rig = self.rig?;
        Some((rig.focal_baseline_q16() as f64 / 65536.0, rig.offset_q6() as f64 / 64.0))
    }

    fn middle(&self) -> [f64; 2] {
        let Area { left, top, right, bottom } = self.region;
        let middle = |a: u16, b: u16| 0.5 * (f64::from(a) + f64::from(b) - 1.0);
        [middle(left, right), middle(top, bottom)]
    }

    fn of_pair(&self, answers: &mut [WallAnswer]) -> Quality {
        let fill_rate = answers.len() as f64 / self.cells().max(1) as f64;
        let mut quality = Quality { fill_rate, ..Quality::default() };
        let Some(plane) = fitted(answers) else { return quality };
        answers
            .iter_mut()
            .for_each(|answer| answer.off = Some(answer.disparity - plane.at(answer.at)));
        let on: Vec<&WallAnswer> = answers.iter().filter(|answer| is_on(answer)).collect();
        quality.off_plane = Some(1.0 - on.len() as f64 / answers.len() as f64);
        quality.sub_pixel_rms_px = rms(on.iter().filter_map(|answer| answer.off));
        let Some((fb, offset)) = self.stereo() else { return quality };
        let depth = |disparity: f64| fb / (disparity + offset);
        let distance = depth(plane.at(self.middle()));
        if distance <= 0.0 {
            return quality;
        }
        quality.distance_m = Some(distance);
        quality.tilt_deg = self.rig.and_then(|rig| tilt_deg(&plane, rig, offset));
        let off = on.iter().map(|answer| depth(answer.disparity) - depth(plane.at(answer.at)));
        quality.plane_fit_rms_m = rms(off);
        quality.plane_fit_rms = quality.plane_fit_rms_m.map(|rms| rms / distance);
        if let Some(known) = self.distance_m {
            // Planes in parallel have depths, along every ray, in the same proportion.
            let errors =
                on.iter().map(|a| depth(a.disparity) - depth(plane.at(a.at)) * known / distance);
            let error = median(errors);
            quality.z_accuracy_m = error;
            quality.z_accuracy = error.map(|error| error / known);
            quality.disparity_error_px = Some(fb / known - fb / distance);
        }
        quality
    }
}

/// Figures of pairs, one after the other: of each pixel only its mean and spread are kept.
#[derive(Debug, Default)]
pub struct WallFigures {
    each: Vec<Quality>,
    pixels: HashMap<(u16, u16), Pixel>,
    /// Of the last pair.
    answers: Vec<WallAnswer>,
}

/// Answers of a pixel over the pairs.
#[derive(Clone, Copy, Debug, Default)]
struct Pixel {
    disparity: Spread,
    depth: Spread,
}

impl WallFigures {
    pub fn push(&mut self, wall: &Wall<'_>, points: &[Point]) {
        self.answers = wall.answers(points);
        self.each.push(wall.of_pair(&mut self.answers));
        let stereo = wall.stereo();
        for point in points.iter().filter(|p| wall.region.contains(p.x.into(), p.y.into())) {
            let pixel = self.pixels.entry((point.x, point.y)).or_default();
            let disparity = point.disparity.to_num();
            pixel.disparity.add(disparity);
            if let Some((fb, offset)) = stereo {
                pixel.depth.add(fb / (disparity + offset));
            }
        }
    }

    /// Number of pairs.
    pub fn pairs(&self) -> usize {
        self.each.len()
    }

    /// Figures of all pairs, and the answers of the last one, of this wall.
    pub fn of_all(self, wall: &Wall<'_>) -> (Quality, Vec<WallAnswer>) {
        let middle = |of: fn(&Quality) -> Option<f64>| median(self.each.iter().filter_map(of));
        let Area { left, top, right, bottom } = wall.region;
        let mut all = Quality {
            pairs: self.pairs(),
            region: [left, top, right - left, bottom - top],
            cells: wall.cells(),
            fill_rate: middle(|one| Some(one.fill_rate)).unwrap_or(0.0),
            off_plane: middle(|one| one.off_plane),
            sub_pixel_rms_px: middle(|one| one.sub_pixel_rms_px),
            distance_m: middle(|one| one.distance_m),
            tilt_deg: middle(|one| one.tilt_deg),
            plane_fit_rms_m: middle(|one| one.plane_fit_rms_m),
            plane_fit_rms: middle(|one| one.plane_fit_rms),
            z_accuracy_m: middle(|one| one.z_accuracy_m),
            z_accuracy: middle(|one| one.z_accuracy),
            disparity_error_px: middle(|one| one.disparity_error_px),
            ..Quality::default()
        };
        if self.pairs() > 1 {
            let least = self.pairs().div_ceil(2).max(2);
            let is_repeated = |pixel: &&Pixel| pixel.disparity.count >= least;
            let repeated: Vec<&Pixel> = self.pixels.values().filter(is_repeated).collect();
            all.repeated_pixels = Some(repeated.len());
            all.temporal_noise_px = median(repeated.iter().map(|p| p.disparity.deviation()));
            let depths = repeated.iter().filter(|_| wall.rig.is_some());
            all.temporal_noise_m = median(depths.map(|pixel| pixel.depth.deviation()));
        }
        (all, self.answers)
    }
}

/// Mean and squares of distances from it, value by value (Welford, 1962).
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    count: usize,
    mean: f64,
    squares: f64,
}

impl Spread {
    fn add(&mut self, value: f64) {
        self.count += 1;
        let from_old = value - self.mean;
        self.mean += from_old / self.count as f64;
        self.squares += from_old * (value - self.mean);
    }

    fn deviation(&self) -> f64 {
        (self.squares / (self.count as f64 - 1.0).max(1.0)).sqrt()
    }
}

/// First cell whose centre lies in this span of pixels, and the one after the last.
fn centres(from: u16, to: u16) -> (usize, usize) {
    let cell = |at: u16| usize::from((at + SUPPORT_PITCH / 2 - 1) / SUPPORT_PITCH);
    (cell(from), cell(to).max(cell(from)))
}

fn is_on(answer: &WallAnswer) -> bool {
    answer.off.is_some_and(|off| off.abs() <= OFF_PLANE)
}

fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) =
        values.fold((0_u32, 0.0), |(count, sum), value| (count + 1, sum + value * value));
    (count > 0).then(|| (sum / f64::from(count)).sqrt())
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    upper_median(values.collect(), f64::total_cmp)
}

/// Angle between the plane and the image; needs focal length and principal point.
fn tilt_deg(plane: &Plane, rig: &Rig, offset: f64) -> Option<f64> {
    let centre = rig.principal_point_q16()?.map(|v| f64::from(v) / 65536.0);
    let focal = rig.focal_q16() as f64 / 65536.0;
    let Plane([a, b, _]) = plane;
    Some((a * focal).hypot(b * focal).atan2(plane.at(centre) + offset).to_degrees())
}

/// The plane with the least median distance of those through three answers, then by least squares
/// over what lies on it.
fn fitted(answers: &[WallAnswer]) -> Option<Plane> {
    let count = answers.len() as u64;
    if answers.len() < LEAST_ANSWERS {
        return None;
    }
    let mut state = 1_u64;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        answers[((state >> 33) % count) as usize]
    };
    let median_off = |plane: &Plane| {
        let off = answers.iter().map(|answer| (answer.disparity - plane.at(answer.at)).abs());
        median(off).unwrap_or(f64::MAX)
    };
    let trials = (0..TRIALS).filter_map(|_| through([next(), next(), next()].iter()));
    let mut plane = trials.min_by(|a, b| median_off(a).total_cmp(&median_off(b)))?;
    for _ in 0..3 {
        let on = answers
            .iter()
            .filter(|answer| (answer.disparity - plane.at(answer.at)).abs() <= OFF_PLANE);
        plane = through(on)?;
    }
    Some(plane)
}

/// Least squares; `None` where the answers lie on a line.
fn through<'a>(answers: impl Iterator<Item = &'a WallAnswer>) -> Option<Plane> {
    let (mut squares, mut sums) = (nalgebra::Matrix3::<f64>::zeros(), nalgebra::Vector3::zeros());
    for answer in answers {
        let row = nalgebra::Vector3::new(answer.at[0], answer.at[1], 1.0);
        squares += row * row.transpose();
        sums += row * answer.disparity;
    }
    // Three pixels on a line, or next to one.
    if squares.determinant().abs() < 1e3 {
        return None;
    }
    squares.try_inverse().map(|inverse| Plane((inverse * sums).into()))
}
