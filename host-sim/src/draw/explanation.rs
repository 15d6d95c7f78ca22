//! An explanation as a picture: the pixel's surroundings in the left image, cost curves beside, the
//! words below.

use super::sheet::{FAINT, FAIR as SEGMENT, GOOD, GRID, INK, SEEN as SUPPORT, Sheet};
use super::text::Align;
use crate::explain::{Explanation, Plot};
use image::RgbImage;
use linestereo_frames::GrayImage;

const WIDTH: u32 = 1400;
const MARGIN: f32 = 24.0;
/// Surroundings that are shown, px of the image, and how much they are enlarged.
const SHOWN: [u32; 2] = [104, 72];
const ENLARGED: u32 = 5;
/// Of a plot with its title and its axis.
const PLOT: [f32; 2] = [780.0, 176.0];
const LINE: f32 = 19.0;
const CURVES: [[u8; 3]; 3] = [[255, 225, 40], [90, 150, 255], [70, 200, 90]];
const ASKED: [u8; 3] = [255, 80, 60];
const BAR: [u8; 3] = [200, 130, 255];

/// The explanation of a pixel of this left image.
pub fn explanation(left: &GrayImage, explanation: &Explanation) -> RgbImage {
    let plots: Vec<&Plot> = explanation.accounts().flat_map(|account| &account.plots).collect();
    let text = explanation.to_string();
    let above =
        (MARGIN + 30.0 + (SHOWN[1] * ENLARGED) as f32).max(MARGIN + PLOT[1] * plots.len() as f32);
    let height = above + 2.0 * MARGIN + LINE * text.lines().count() as f32;
    let mut sheet = Sheet::new([WIDTH, height.ceil() as u32]);
    surroundings(&mut sheet, left, explanation);
    let x = MARGIN + (SHOWN[0] * ENLARGED) as f32 + 2.0 * MARGIN;
    for (place, plot) in plots.into_iter().enumerate() {
        curves(&mut sheet, [x, MARGIN + PLOT[1] * place as f32], plot);
    }
    for (place, line) in text.lines().enumerate() {
        let rgb = if line.contains("FAILED") || line.trim_start().starts_with("rejected:") {
            ASKED
        } else if line.trim_start().starts_with("accepted:") {
            GOOD
        } else {
            INK
        };
        // A line that is too long for the picture is whole in the text.
        sheet.label((MARGIN, above + MARGIN + LINE * place as f32), Align::Left, rgb, line);
    }
    sheet.into_picture()
}

/// The image around the pixel with segment, bar, support point and pixel marked.
fn surroundings(sheet: &mut Sheet, left: &GrayImage, explanation: &Explanation) {
    let (width, height) = (u32::from(left.dims.width), u32::from(left.dims.height));
    let (x, y) = (u32::from(explanation.pixel.0), u32::from(explanation.pixel.1));
    let first =
        |at: u32, shown: u32, all: u32| at.saturating_sub(shown / 2).min(all.saturating_sub(shown));
    let (x0, y0) = (first(x, SHOWN[0], width), first(y, SHOWN[1], height));
    let top = MARGIN + 24.0;
    let part = [x0, y0, SHOWN[0].min(width), SHOWN[1].min(height)];
    sheet.image([MARGIN as u32, top as u32], left, part, ENLARGED, 1);
    let place = |at: [f64; 2]| {
        let of = |at: f64, first: u32| (at + 0.5 - f64::from(first)) as f32 * ENLARGED as f32;
        (MARGIN + of(at[0], x0), top + of(at[1], y0))
    };
    let shown = [x0, y0].map(|first| f64::from(first) - 0.5);
    let shown = [shown, [0, 1].map(|axis| shown[axis] + f64::from(part[2 + axis]))];
    let mut line = |a: [f64; 2], b: [f64; 2], rgb: [u8; 3], width: f32| {
        if let Some([a, b]) = inside([a, b], shown) {
            sheet.line(place(a), place(b), rgb, width);
        }
    };
    if let Some(([a, b], _)) = &explanation.segment {
        line(*a, *b, SEGMENT, 2.5);
    }
    if let Some((corners, _)) = &explanation.bar {
        for (index, &corner) in corners.iter().enumerate() {
            line(corner, corners[(index + 1) % corners.len()], BAR, 2.0);
        }
    }
    if let Some(((px, py), _)) = &explanation.support {
        ring(sheet, place([(*px).into(), (*py).into()]), SUPPORT);
    }
    let (u, v) = place([x.into(), y.into()]);
    for (du, dv) in [(9.0, 0.0), (0.0, 9.0)] {
        sheet.line((u - du, v - dv), (u + du, v + dv), ASKED, 2.0);
    }
    let keys = [
        (ASKED, "+ asked for"),
        (SEGMENT, "- segment"),
        (SUPPORT, "o support point"),
        (BAR, "= bar"),
    ];
    for (i, (rgb, text)) in (0_u8..).zip(keys) {
        sheet.label((MARGIN + 150.0 * f32::from(i), MARGIN - 4.0), Align::Left, rgb, text);
    }
}

/// The part of a line inside a rectangle.
fn inside([a, b]: [[f64; 2]; 2], [low, high]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let along = b[axis] - a[axis];
        let [first, last] = [low, high].map(|limit| limit[axis] - a[axis]);
        if along == 0.0 {
            if first > 0.0 || last < 0.0 {
                return None;
            }
            continue;
        }
        let (enter, leave) = (first / along, last / along);
        (from, to) = (from.max(enter.min(leave)), to.min(enter.max(leave)));
    }
    let at = |t: f64| [0, 1].map(|axis| a[axis] + t * (b[axis] - a[axis]));
    (from <= to).then(|| [at(from), at(to)])
}

fn ring(sheet: &mut Sheet, (u, v): (f32, f32), rgb: [u8; 3]) {
    let at = |step: u8| {
        let angle = f32::from(step) * core::f32::consts::TAU / 16.0;
        (u + 9.0 * angle.cos(), v + 9.0 * angle.sin())
    };
    for step in 0..16 {
        sheet.line(at(step), at(step + 1), rgb, 2.0);
    }
}

/// The 1, 2 or 5 times a power of ten next above.
fn even_step(least: f64) -> f64 {
    let power = 10_f64.powi(least.log10().floor() as i32);
    let step = [1.0, 2.0, 5.0].into_iter().find(|step| step * power >= least);
    step.unwrap_or(10.0) * power
}

/// Costs over disparity with marks at best, second-best and answer.
fn curves(sheet: &mut Sheet, [left, top]: [f32; 2], plot: &Plot) {
    let (right, bottom) = (left + PLOT[0] - 60.0, top + PLOT[1] - 34.0);
    let top = top + 22.0;
    sheet.label((left, top - 22.0), Align::Left, INK, &plot.title);
    let Some((_, decisive)) = plot.curves.first() else { return };
    let (first, last) = (decisive.first, decisive.first + decisive.costs.len() as i32 - 1);
    let largest =
        plot.curves.iter().flat_map(|(_, curve)| &curve.costs).max().copied().unwrap_or(1).max(1);
    let across = |d: f64| {
        left + ((d - f64::from(first)) / f64::from((last - first).max(1))) as f32 * (right - left)
    };
    let down = |cost: u16| bottom - f32::from(cost) / f32::from(largest) * (bottom - top);
    sheet.line((left, bottom), (right, bottom), GRID, 1.0);
    sheet.line((left, top), (left, bottom), GRID, 1.0);
    sheet.label((right + 8.0, top - 8.0), Align::Left, FAINT, format!("{largest}"));
    sheet.label((right + 8.0, bottom - 8.0), Align::Left, FAINT, "0");
    let step = even_step(f64::from(last - first) / 10.0).max(1.0);
    let mut at = (f64::from(first) / step).ceil() * step;
    while at <= f64::from(last) {
        sheet.line((across(at), bottom), (across(at), bottom + 4.0), FAINT, 1.0);
        sheet.label((across(at), bottom + 5.0), Align::Centre, FAINT, format!("{at} px"));
        at += step;
    }
    for (place, mark) in (0_u8..).zip(&plot.marks) {
        let rgb = if mark.name == "answer" { GOOD } else { FAINT };
        let u = across(mark.at);
        if (left..=right).contains(&u) {
            sheet.line((u, top), (u, bottom), rgb, 1.5);
            sheet.label((u + 4.0, top + 15.0 * f32::from(place)), Align::Left, rgb, mark.name);
        }
    }
    for (place, ((name, curve), rgb)) in (0_u8..).zip(plot.curves.iter().zip(CURVES)) {
        let points: Vec<(f32, f32)> = (curve.first..)
            .zip(&curve.costs)
            .map(|(d, &cost)| (across(d.into()), down(cost)))
            .collect();
        for pair in points.windows(2) {
            sheet.line(pair[0], pair[1], rgb, if place == 0 { 2.5 } else { 1.2 });
        }
        sheet.label((right - 110.0 * f32::from(place), top - 22.0), Align::Right, rgb, *name);
    }
}

#[cfg(test)]
mod tests {
    use super::inside;

    #[test]
    fn lines_end_where_the_picture_does() {
        let of = |line| inside(line, [[0.0, 0.0], [10.0, 20.0]]);
        assert_eq!(of([[5.0, -30.0], [5.0, 30.0]]), Some([[5.0, 0.0], [5.0, 20.0]]));
        assert_eq!(of([[20.0, 10.0], [0.0, 10.0]]), Some([[10.0, 10.0], [0.0, 10.0]]));
        assert_eq!(of([[1.0, 2.0], [3.0, 4.0]]), Some([[1.0, 2.0], [3.0, 4.0]]));
        assert_eq!((of([[11.0, 0.0], [11.0, 5.0]]), of([[-5.0, 1.0], [-1.0, 9.0]])), (None, None));
    }
}
