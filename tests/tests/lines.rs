//! The detector on drawn images: single edges of every direction, and images made to hurt it.

use core::mem::MaybeUninit;
use linestereo::unstable::lines::{LineParams, LineScratch, Segment, detect, mark_words};
use linestereo::{Dims, Gray, unstable::List};
use linestereo_frames::GrayImage;
use linestereo_tests::drawn::{Random, hard_images, painted};
use linestereo_tests::reference::{fit_line, sobel};

const PARAMS: LineParams =
    LineParams { anchor: 40, edge: 24, min_extent: 6, row_scan: Some(6), column_scan: Some(6) };

fn segments<const N: usize>(image: Gray<'_>) -> (Vec<Segment>, u16) {
    let mut marks = vec![0xdead_beef; mark_words(image.dims())];
    let mut chain = vec![0xbeef; 1280];
    let mut strengths = [0; 640];
    let mut slots = [const { MaybeUninit::uninit() }; N];
    let mut list = List::<Segment>::new(&mut slots);
    let scratch = LineScratch { marks: &mut marks, chain: &mut chain, strengths: &mut strengths };
    let found = detect(image, None, &PARAMS, scratch, &mut list);
    (list.to_vec(), found.segments)
}

/// A straight edge through the middle (plus `shift`), anti-aliased over one pixel; `theta` in
/// degrees, clockwise from +x.
fn edge(theta: f64, shift: f64, dark: f64, bright: f64) -> GrayImage {
    let normal = normal(theta);
    painted(64, 64, |x, y| {
        let distance =
            (f64::from(x) - 31.5) * normal[0] + (f64::from(y) - 31.5) * normal[1] - shift;
        (dark + (bright - dark) * (distance + 0.5).clamp(0.0, 1.0)).round() as u8
    })
}

fn normal(theta: f64) -> [f64; 2] {
    let (sin, cos) = theta.to_radians().sin_cos();
    [-sin, cos]
}

fn ends(segment: &Segment) -> [[f64; 2]; 2] {
    segment.ends.map(|end| [end.x.to_num(), end.y.to_num()])
}

#[test]
fn one_edge_of_any_direction_is_found_where_it_is() {
    for theta in (0..360).step_by(5).map(f64::from) {
        for shift in [-0.4, -0.1, 0.25, 0.5] {
            let image = edge(theta, shift, 60.0, 180.0);
            let (found, _) = segments::<64>(image.view().unwrap());
            let normal = normal(theta);
            let mut covered = 0.0;
            for segment in &found {
                let [start, end] = ends(segment);
                for at in [start, end] {
                    let off = (at[0] - 31.5) * normal[0] + (at[1] - 31.5) * normal[1] - shift;
                    // The ridge of a one-pixel ramp under a 3x3 Sobel, in steps of 1/32 px.
                    assert!(
                        off.abs() <= 0.15,
                        "{theta} degrees, shift {shift}: {segment:?} is {off:.3} px off"
                    );
                }
                let along = if segment.near_horizontal { normal[1] } else { normal[0] };
                assert_eq!(segment.rising, along > 0.0, "{theta} degrees: polarity of {segment:?}");
                assert!(
                    segment.contrast.abs_diff(90) <= 45,
                    "{theta} degrees: contrast of {segment:?}"
                );
                covered += (end[0] - start[0]).hypot(end[1] - start[1]);
            }
            // The border of 4 px holds no edge; 56 px at least lie inside it. More than the chord
            // would be a duplicate.
            let chord = 56.0 / normal[0].abs().max(normal[1].abs());
            assert!(
                (0.75..=1.05).contains(&(covered / chord)),
                "{theta} degrees, {shift}: {covered:.1} of {chord:.1} px"
            );
        }
    }
}

/// Where a row crosses the edge next to column `near`: vertex of the parabola through the three
/// largest Sobel gradients.
fn crossing(image: &GrayImage, near: f64, y: i32) -> f64 {
    let gradient = |x: i32| f64::from(sobel(image, x, y).0.abs());
    let around = near.round() as i32 - 3..=near.round() as i32 + 3;
    let top = around.max_by(|&a, &b| gradient(a).total_cmp(&gradient(b))).unwrap();
    let (low, mid, high) = (gradient(top - 1), gradient(top), gradient(top + 1));
    f64::from(top) + 0.5 * (high - low) / (2.0 * mid - low - high)
}

#[test]
fn lines_are_those_of_least_squares() {
    let mut random = Random(8);
    for theta in (60..=120).step_by(5).map(f64::from) {
        let mut image = edge(theta, 0.2, 60.0, 180.0);
        for pixel in &mut image.pixels {
            *pixel = pixel.saturating_add_signed(random.below(13) as i8 - 6);
        }
        let (mut found, _) = segments::<64>(image.view().unwrap());
        found.retain(|s| s.contrast > 30); // the edge, and not the noise beside it
        found.sort_by_key(|s| s.ends[0].y);
        let rows: i32 =
            found.iter().map(|s| s.ends[1].y.to_num::<i32>() - s.ends[0].y.to_num::<i32>()).sum();
        assert!(rows >= 40, "{theta} degrees: only {rows} rows are covered");
        // Long runs are cut after the fit: the line is that of all rows together.
        let near =
            |y: i32| 31.5 + (0.2 - (f64::from(y) - 31.5) * normal(theta)[1]) / normal(theta)[0];
        let (top, bottom) =
            (found[0].ends[0].y.to_num::<i32>(), found.last().unwrap().ends[1].y.to_num::<i32>());
        let points: Vec<[f64; 2]> =
            (top..=bottom).map(|y| [crossing(&image, near(y), y), f64::from(y)]).collect();
        let line = fit_line(&points);
        for [x, y] in found.iter().flat_map(ends) {
            let off =
                (x - line.centre[0]) * line.direction[1] - (y - line.centre[1]) * line.direction[0];
            // Outliers beyond 0.7 px are left out of a run, and a run may end early: a tenth of a
            // pixel.
            assert!(
                off.abs() <= 0.1,
                "{theta} degrees: {off:.3} px off the line of least squares at {x}, {y}"
            );
        }
    }
}

/// Size of what is hard on a detector, and how wide its patterns are.
const DIMS: Dims = Dims { width: 160, height: 120 };
const WIDTHS: [u16; 5] = [1, 2, 3, 4, 8];

#[test]
fn hard_images_give_segments_inside_the_image() {
    for (name, image) in hard_images(DIMS, &WIDTHS) {
        let (found, dropped) = segments::<4096>(image.view().unwrap());
        assert_eq!(dropped, 0, "{name}");
        for segment in &found {
            let [[x0, y0], [x1, y1]] = ends(segment);
            assert!(x0.max(x1) < 160.0 && y0.max(y1) < 120.0, "{name}: {segment:?}");
            assert!((x1 - x0).abs().max((y1 - y0).abs()) >= 2.9, "{name}: {segment:?} is short");
        }
        if name == "grey" || name == "white" {
            assert!(found.is_empty(), "{name}: {found:?}");
        }
    }
}

#[test]
fn a_full_list_keeps_the_longest_and_counts_the_others() {
    let mut random = Random(5);
    let blocks: Vec<u8> = (0..20 * 15).map(|_| random.grey()).collect();
    let image = painted(160, 120, |x, y| blocks[usize::from(y / 8 * 20 + x / 8)]);
    let extent = |s: &Segment| {
        let [a, b] = s.ends;
        if s.near_horizontal { a.x.abs_diff(b.x) } else { a.y.abs_diff(b.y) }
    };
    let (all, _) = segments::<4096>(image.view().unwrap());
    let (kept, dropped) = segments::<16>(image.view().unwrap());
    assert!(all.len() > 40, "too few to test with: {}", all.len());
    assert_eq!((kept.len(), usize::from(dropped)), (16, all.len() - 16));
    let mut longest: Vec<_> = all.iter().map(extent).collect();
    longest.sort();
    let mut of_kept: Vec<_> = kept.iter().map(extent).collect();
    of_kept.sort();
    assert_eq!(of_kept, longest[longest.len() - 16..]);
}

#[test]
fn the_smallest_image_is_no_problem() {
    let dims = Dims { width: 16, height: 16 };
    let pixels: Vec<u8> = (0..256).map(|i| if i % 16 < 8 { 20 } else { 200 }).collect();
    let (found, _) = segments::<8>(Gray::new(&pixels, dims, 16).unwrap());
    assert_eq!(found.len(), 1, "{found:?}");
}
