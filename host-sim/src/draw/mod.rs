//! Pictures of results.
//!
//! In: a left image and its result. Out: the image, stretched where it is dark, dimmed and
//! enlarged, with every segment in the colour of its disparity (red near, blue far), ticks on the
//! owning side, the outlines of bars, the points as tinted pixels, support points as discs, and a
//! legend in px and metres below. What is less probable is fainter; below p = 0.9 it is dashed.
//! With a ground plane the floor is pale and what lies below it magenta.

mod calibration;
mod colour;
mod explanation;
mod fan;
mod floor;
mod legend;
mod levels;
mod quality;
mod rows;
pub mod sheet;
mod space;
pub mod text;

pub use calibration::calibration;
pub use colour::{Range as ColourRange, colour};
pub use explanation::explanation;
pub use fan::fan;
pub use levels::shown;
pub use quality::quality;
pub use space::{pcd, ply};

use crate::engine::FrameResult;
use crate::output::png_file;
use colour::Range;
use image::{ExtendedColorType, ImageResult, RgbImage};
use linestereo::Rig;
use linestereo::results::{Bar, Match, Owner, Point, Source};
use linestereo_frames::GrayImage;
pub use rows::rows;
use tiny_skia::{
    Color, FillRule, LineCap, Paint, PathBuilder, Pixmap, PremultipliedColorU8, Rect, Stroke,
    StrokeDash, Transform,
};

/// Segments at least this probable are drawn solid, the others dashed.
const SURE: f64 = 0.9;
/// Small images are enlarged by a whole factor to about this width.
const TARGET_WIDTH: f32 = 1280.0;
const LARGEST_FACTOR: f32 = 6.0;
/// Share of its brightness that the background keeps.
const DIMMED: f32 = 0.5;
/// A segment with `|dx|` above this many times `|dy|` is near-horizontal: its owner `Left` is the
/// side above.
const STEEP_LIMIT: f32 = 4.0;
/// Radius of a support point's disc, px of the image.
const SUPPORT_RADIUS: f32 = 2.0;
/// Strength of a point's colour: its segment has to stand out from it.
const TINT: f32 = 0.35;
/// Least width of a segment's line in px of the picture.
const LEAST_LINE: f32 = 1.6;
/// Distance between the ticks of the owning side and their length, in px of the image.
const TICK_STEP: f32 = 5.0;
const TICK_LENGTH: f32 = 2.0;

/// The result drawn over its left image, with a legend; depths need the rig.
pub fn overlay(
    left: &GrayImage,
    result: &FrameResult,
    rig: Option<&Rig>,
    max_disparity: u16,
) -> RgbImage {
    let factor = (TARGET_WIDTH / f32::from(left.dims.width)).round().clamp(1.0, LARGEST_FACTOR);
    let range = Range::of(result, max_disparity);
    let mut canvas = Canvas::new(&shown(left), factor as u32);
    for point in &result.points {
        let rgb = floor::of_point(result.ground, point)
            .unwrap_or_else(|| colour(&range, point.disparity.to_num()));
        canvas.point(point, rgb);
    }
    // The most confident come first in the list and have to end on top.
    for found in result.matches.iter().rev() {
        let disparities = found.disparity.map(|d| d.to_num::<f32>());
        let rgb = floor::of_segment(result.ground, found)
            .unwrap_or_else(|| colour(&range, 0.5 * (disparities[0] + disparities[1])));
        canvas.segment(found, rgb);
    }
    for bar in &result.bars {
        canvas.bar(bar, &range);
    }
    legend::below(&opaque(&canvas.pixmap), result, rig, &range)
}

/// An image as the bytes of a PNG file of grey levels.
pub fn gray_png(image: &GrayImage) -> ImageResult<Vec<u8>> {
    png_file(
        &image.pixels,
        [image.dims.width.into(), image.dims.height.into()],
        ExtendedColorType::L8,
    )
}

/// A picture as the bytes of a PNG file.
pub fn png(picture: &RgbImage) -> ImageResult<Vec<u8>> {
    png_file(picture.as_raw(), [picture.width(), picture.height()], ExtendedColorType::Rgb8)
}

struct Canvas {
    pixmap: Pixmap,
    factor: f32,
}

impl Canvas {
    fn new(left: &GrayImage, factor: u32) -> Self {
        let (width, height) = (u32::from(left.dims.width), u32::from(left.dims.height));
        let mut pixmap =
            Pixmap::new(width * factor, height * factor).expect("image sides are above 0");
        let columns = width as usize * factor as usize;
        for (index, pixel) in pixmap.pixels_mut().iter_mut().enumerate() {
            let (x, y) = (index % columns / factor as usize, index / columns / factor as usize);
            let grey = (DIMMED * f32::from(left.pixels[y * width as usize + x])) as u8;
            *pixel = PremultipliedColorU8::from_rgba(grey, grey, grey, u8::MAX)
                .expect("opaque colours are premultiplied");
        }
        Self { pixmap, factor: factor as f32 }
    }

    /// Tints one pixel, or a disc around a support point: what is known between the edges.
    fn point(&mut self, point: &Point, rgb: [u8; 3]) {
        let (side, still) = (self.factor, Transform::identity());
        let [left, top] = [point.x, point.y].map(|at| f32::from(at) * side);
        let paint = paint(rgb, TINT * opacity(point.confidence.to_num()));
        if point.source == Source::Support {
            let [x, y] = [point.x, point.y].map(|at| (f32::from(at) + 0.5) * side);
            if let Some(disc) = PathBuilder::from_circle(x, y, SUPPORT_RADIUS * side) {
                self.pixmap.fill_path(&disc, &paint, FillRule::Winding, still, None);
            }
        } else if let Some(square) = Rect::from_xywh(left, top, side, side) {
            self.pixmap.fill_rect(square, &paint, still, None);
        }
    }

    fn segment(&mut self, found: &Match, rgb: [u8; 3]) {
        // Integer positions are pixel centres.
        let centre = |value: f32| (value + 0.5) * self.factor;
        let [start, end] = found.ends.map(|end| (centre(end.x.to_num()), centre(end.y.to_num())));
        let confidence = found.confidence.to_num::<f32>();
        let sure = f64::from(confidence) >= SURE;
        let width = (0.6 * self.factor).max(LEAST_LINE);
        let dash = if sure { None } else { StrokeDash::new(vec![3.0 * width, 3.0 * width], 0.0) };
        self.line(start, end, [0; 3], 0.6 * opacity(confidence), width + 1.5, dash.clone());
        self.line(start, end, rgb, opacity(confidence), width, dash);
        for tick in ticks(found, start, end, self.factor) {
            self.line(tick.0, tick.1, rgb, opacity(confidence), 0.6 * width, None);
        }
    }

    /// Both edges of a bar, joined at its ends.
    fn bar(&mut self, bar: &Bar, range: &Range) {
        let centre = |value: f32| (value + 0.5) * self.factor;
        let wide = bar.width().to_num::<f32>();
        let [top, end] = bar.ends().map(|end| (end.x.to_num::<f32>(), end.y.to_num::<f32>()));
        let right = |(x, y): Position| (x + wide, y);
        let corners = [top, end, right(end), right(top)].map(|(x, y)| (centre(x), centre(y)));
        let [from, to] = bar.disparity().map(|d| d.to_num::<f32>());
        let (rgb, alpha) = (colour(range, 0.5 * (from + to)), opacity(bar.confidence().to_num()));
        let width = (0.6 * self.factor).max(LEAST_LINE);
        for (index, &corner) in corners.iter().enumerate() {
            let next = corners[(index + 1) % corners.len()];
            self.line(corner, next, [0; 3], 0.6 * alpha, width + 1.5, None);
            self.line(corner, next, rgb, alpha, width, None);
        }
    }

    fn line(
        &mut self,
        from: Position,
        to: Position,
        rgb: [u8; 3],
        alpha: f32,
        width: f32,
        dash: Option<StrokeDash>,
    ) {
        let style = Stroke { width, line_cap: LineCap::Butt, dash, ..Stroke::default() };
        stroke(&mut self.pixmap, [from, to], &paint(rgb, alpha), &style);
    }
}

type Position = (f32, f32);

/// The colours of an opaque picture.
fn opaque(pixmap: &Pixmap) -> RgbImage {
    let bytes = pixmap.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
    RgbImage::from_raw(pixmap.width(), pixmap.height(), bytes).expect("three bytes for each pixel")
}

fn stroke(pixmap: &mut Pixmap, [from, to]: [Position; 2], paint: &Paint<'_>, stroke: &Stroke) {
    let mut path = PathBuilder::new();
    path.move_to(from.0, from.1);
    path.line_to(to.0, to.1);
    if let Some(path) = path.finish() {
        pixmap.stroke_path(&path, paint, stroke, Transform::identity(), None);
    }
}

/// Short strokes from the segment towards the side or sides that own its disparity.
fn ticks(found: &Match, start: Position, end: Position, factor: f32) -> Vec<(Position, Position)> {
    let (dx, dy) = (end.0 - start.0, end.1 - start.1);
    let length = dx.hypot(dy);
    if length == 0.0 {
        return Vec::new();
    }
    // The normal that points left, or up where the segment is near-horizontal.
    let mut normal = (-dy / length, dx / length);
    let away = if dx.abs() > STEEP_LIMIT * dy.abs() { normal.1 > 0.0 } else { normal.0 > 0.0 };
    if away {
        normal = (-normal.0, -normal.1);
    }
    let sides: &[f32] = match found.owner {
        Owner::Left => &[1.0],
        Owner::Right => &[-1.0],
        Owner::Both => &[1.0, -1.0],
    };
    let count = (length / (TICK_STEP * factor)).round().max(1.0);
    (0..count as usize)
        .flat_map(|i| {
            let t = (i as f32 + 0.5) / count;
            let from = (start.0 + t * dx, start.1 + t * dy);
            sides.iter().map(move |side| {
                let reach = side * TICK_LENGTH * factor;
                (from, (from.0 + reach * normal.0, from.1 + reach * normal.1))
            })
        })
        .collect()
}

/// Half transparent at a probability of 0.5 and less, opaque at 1.
fn opacity(confidence: f32) -> f32 {
    confidence.clamp(0.4, 1.0)
}

fn paint([red, green, blue]: [u8; 3], alpha: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    let mut color = Color::from_rgba8(red, green, blue, u8::MAX);
    color.set_alpha(alpha.clamp(0.0, 1.0));
    paint.set_color(color);
    paint
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::results::{ImagePosition, Techniques};
    use linestereo::units::{Confidence, Disparity};
    use linestereo::{Dims, ground::GroundPlane};

    fn vertical(owner: Owner, x: f64, disparity: i16) -> Match {
        let point = |y: f64| ImagePosition {
            x: linestereo::units::Position::from_num(x),
            y: linestereo::units::Position::from_num(y),
        };
        let disparity = Disparity::from_num(disparity);
        Match {
            ends: [point(5.0), point(25.0)],
            disparity: [disparity; 2],
            sigma: Disparity::ZERO,
            confidence: Confidence::MAX,
            owner,
            depth: None,
            depth_sigma: None,
            techniques: Techniques { feature: None, window: disparity, census: disparity },
        }
    }

    #[test]
    fn ticks_point_to_the_owner() {
        let (start, end) = ((10.0, 5.0), (12.0, 25.0));
        let reaches = |owner, to: Position| {
            let found = vertical(owner, 10.0, 8);
            ticks(&found, start, to, 1.0)
                .into_iter()
                .map(|(from, to)| (to.0 - from.0, to.1 - from.1))
                .collect::<Vec<_>>()
        };
        assert!(reaches(Owner::Left, end).iter().all(|reach| reach.0 < 0.0));
        assert!(reaches(Owner::Right, end).iter().all(|reach| reach.0 > 0.0));
        assert_eq!(reaches(Owner::Both, end).len(), 2 * reaches(Owner::Left, end).len());
        let flat_end = (30.0, 8.0); // near-horizontal: above is up
        assert!(reaches(Owner::Left, flat_end).iter().all(|reach| reach.1 < 0.0));
        assert!(ticks(&vertical(Owner::Left, 10.0, 8), start, start, 1.0).is_empty());
    }

    #[test]
    fn near_is_red_far_is_blue_and_the_rest_is_dimmed() {
        let left = GrayImage { dims: Dims { width: 320, height: 32 }, pixels: vec![200; 320 * 32] };
        let (disparity, source) = (Disparity::from_num(40), Source::Segment(0));
        let point = Point { x: 200, y: 9, disparity, confidence: Confidence::MAX, source };
        let result = FrameResult {
            matches: vec![vertical(Owner::Both, 50.0, 40), vertical(Owner::Left, 100.0, 4)],
            ..FrameResult::of_points(vec![point])
        };
        let picture = overlay(&left, &result, None, 64);
        assert_eq!(picture.width(), 4 * 320);
        let at = |x: u32, y: u32| picture.get_pixel(4 * x + 2, 4 * y + 1).0;
        assert_eq!(at(5, 5), [100; 3]);
        assert!(at(50, 12)[0] > 200 && at(50, 12)[2] < 80, "{:?}", at(50, 12));
        assert!(at(100, 12)[2] > 200 && at(100, 12)[0] < 100, "{:?}", at(100, 12));
        assert!(at(200, 9)[0] > 150 && at(201, 9) == [100; 3], "{:?}", at(200, 9));
    }

    #[test]
    fn the_floor_is_pale_and_what_lies_below_it_magenta() {
        let left = GrayImage { dims: Dims { width: 320, height: 32 }, pixels: vec![0; 320 * 32] };
        // 1 px of disparity a row.
        let plane = GroundPlane { down_q16: 1 << 16, across_q16: 0, origin_q16: 0 };
        let point = |x: u16, disparity: f64| Point {
            x,
            y: 20,
            disparity: Disparity::from_num(disparity),
            confidence: Confidence::MAX,
            source: Source::Side,
        };
        let points: Vec<_> = [19.25, 21.0, 21.1, 18.9, 18.0]
            .iter()
            .zip([40, 80, 120, 160, 200])
            .map(|(&d, x)| point(x, d))
            .collect();
        let along = |disparity: [f64; 2]| Match {
            disparity: disparity.map(Disparity::from_num),
            ..vertical(Owner::Both, 250.0, 0)
        };
        assert_eq!(floor::of_segment(Some(plane), &along([5.5, 24.5])), Some(floor::FLOOR));
        assert_eq!(floor::of_segment(Some(plane), &along([2.0, 20.0])), Some(floor::DROP));
        assert_eq!(floor::of_segment(Some(plane), &along([5.0, 20.0])), None, "one end is below");
        let standing = along([25.0, 25.0]);
        assert_eq!(floor::of_segment(Some(plane), &standing), None);
        assert_eq!(floor::of_segment(None, &along([5.0, 25.0])), None);

        let result = |ground| FrameResult {
            matches: vec![standing],
            ground,
            ..FrameResult::of_points(points.clone())
        };
        let [without, with] =
            [None, Some(plane)].map(|ground| overlay(&left, &result(ground), None, 64));
        let tinted = |rgb: [u8; 3]| rgb.map(|value| (TINT * f32::from(value)).round() as i32);
        for (x, rgb) in [(40, Some(floor::FLOOR)), (80, Some(floor::FLOOR)), (120, None)]
            .into_iter()
            .chain([(160, None), (200, Some(floor::DROP)), (250, None)])
        {
            let at = |picture: &RgbImage| picture.get_pixel(4 * x + 2, 4 * 20 + 2).0;
            match rgb {
                None => assert_eq!(at(&with), at(&without), "{x}"),
                Some(rgb) => {
                    let found = at(&with).map(i32::from);
                    let near = found.iter().zip(tinted(rgb)).all(|(a, b)| (a - b).abs() <= 1);
                    assert!(near && at(&without) != at(&with), "{x}: {found:?}");
                }
            }
        }
        assert_ne!(with, without);
    }
}
