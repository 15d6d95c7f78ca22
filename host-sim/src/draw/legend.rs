//! The strip below a picture: colours in px and metres, line styles, counts.

use super::colour::{Range, colour};
use super::floor::{DROP, FLOOR};
use super::sheet::{BACKGROUND, INK, TEXT};
use super::text::{Align, width, write};
use crate::engine::FrameResult;
use crate::results::listing::finite_metres;
use image::{Rgb, RgbImage, imageops};
use linestereo::{Rig, units::Disparity};

const HEIGHT: u32 = 96;
/// More of it where there is a ground plane.
const GROUND_HEIGHT: u32 = 22;
const MARGIN: f32 = 14.0;
const BAR_HEIGHT: f32 = 14.0;
/// Labels of the bar stand at least this far apart, in px of the picture.
const LABEL_DISTANCE: f32 = 80.0;

pub(super) fn below(
    picture: &RgbImage,
    result: &FrameResult,
    rig: Option<&Rig>,
    range: &Range,
) -> RgbImage {
    let height = HEIGHT + if result.ground.is_some() { GROUND_HEIGHT } else { 0 };
    let mut whole =
        RgbImage::from_pixel(picture.width(), picture.height() + height, Rgb(BACKGROUND));
    imageops::replace(&mut whole, picture, 0, 0);
    let top = picture.height() as f32 + 8.0;
    bar(&mut whole, top, range);
    labels(&mut whole, top + BAR_HEIGHT + 3.0, range, rig);
    let key = "solid: p >= 0.9   dashed: less   ticks: owning side   tint: points";
    let mut found = format!("{} segments, {} points", result.matches.len(), result.points.len());
    let beyond = range.beyond(result);
    if beyond > 0 {
        found.push_str(&format!(", {beyond} beyond these colours"));
    }
    let line = whole.height() as f32 - TEXT - 8.0;
    let right = whole.width() as f32 - MARGIN;
    write(&mut whole, (MARGIN, line), Align::Left, TEXT, INK, &found);
    if MARGIN + width(TEXT, &found) + 2.0 * MARGIN + width(TEXT, key) < right {
        write(&mut whole, (right, line), Align::Right, TEXT, INK, key);
    }
    if result.ground.is_some() {
        ground(&mut whole, line - GROUND_HEIGHT as f32);
    }
    whole
}

/// Colours of the floor and of what lies below it.
fn ground(picture: &mut RgbImage, top: f32) {
    let mut x = MARGIN;
    for (rgb, word) in [(FLOOR, "floor"), (DROP, "below the floor: a drop-off")] {
        if x + TEXT + width(TEXT, word) + MARGIN > picture.width() as f32 {
            return;
        }
        for y in top as u32 + 2..(top + TEXT) as u32 {
            (x as u32..(x + TEXT) as u32).for_each(|x| picture.put_pixel(x, y, Rgb(rgb)));
        }
        x += TEXT + 6.0;
        write(picture, (x, top), Align::Left, TEXT, INK, word);
        x += width(TEXT, word) + MARGIN;
    }
}

/// Far on the left, near on the right.
fn bar(picture: &mut RgbImage, top: f32, range: &Range) {
    let (start, end) = (MARGIN as u32, picture.width().saturating_sub(MARGIN as u32));
    for x in start..end {
        let t = (x - start) as f32 / (end - start) as f32;
        let rgb = Rgb(colour(range, range.far + t * (range.near - range.far)));
        for y in top as u32..(top + BAR_HEIGHT) as u32 {
            picture.put_pixel(x, y, rgb);
        }
    }
}

/// Disparity in px and below it the depth in metres.
fn labels(picture: &mut RgbImage, top: f32, range: &Range, rig: Option<&Rig>) {
    let length = picture.width() as f32 - 2.0 * MARGIN;
    let span = range.near - range.far;
    let steps = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0];
    let step =
        steps.into_iter().find(|step| length * step / span >= LABEL_DISTANCE).unwrap_or(256.0);
    let mut disparity = (range.far / step).ceil() * step;
    while disparity <= range.near {
        let x = MARGIN + length * (disparity - range.far) / span;
        let metres = rig.map(|rig| {
            let depth = finite_metres(rig.depth(Disparity::saturating_from_num(disparity)));
            depth.map_or("infinity".to_owned(), |metres| {
                format!("{metres:.*} m", if metres < 10.0 { 2 } else { 1 })
            })
        });
        let (anchor, align) = if x - MARGIN < 0.5 * LABEL_DISTANCE {
            (x, Align::Left)
        } else if length + MARGIN - x < 0.5 * LABEL_DISTANCE {
            (x, Align::Right)
        } else {
            (x, Align::Centre)
        };
        write(picture, (anchor, top), align, TEXT, INK, &format!("{disparity} px"));
        if let Some(metres) = metres {
            write(picture, (anchor, top + TEXT + 1.0), align, TEXT, INK, &metres);
        }
        disparity += step;
    }
}
