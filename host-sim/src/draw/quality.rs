//! Depth quality as a picture: the left image, the region, and how far each cell's answer is off
//! the wall's plane.

use super::sheet::{FAINT, FAIR as REGION, INK, Sheet, TEXT};
use super::text::{Align, wrapped};
use crate::quality::{OFF_PLANE, Quality, WallAnswer};
use image::RgbImage;
use linestereo::unstable::SUPPORT_PITCH;
use linestereo_frames::GrayImage;

const MARGIN: f32 = 20.0;
const LINE: f32 = 19.0;
/// Small images are enlarged to about this width.
const TARGET_WIDTH: u32 = 1100;
const NEARER: [f32; 3] = [255.0, 60.0, 50.0];
const FARTHER: [f32; 3] = [60.0, 120.0, 255.0];
const ON_PLANE: [f32; 3] = [235.0, 235.0, 235.0];
const WRONG: [u8; 3] = [255, 0, 255];

/// The wall with its answers, red where nearer than the plane, blue where farther, and the text
/// below.
pub fn quality(
    left: &GrayImage,
    quality: &Quality,
    answers: &[WallAnswer],
    text: &str,
) -> RgbImage {
    let (width, height) = (u32::from(left.dims.width), u32::from(left.dims.height));
    let scale = (TARGET_WIDTH / width).max(1);
    let below = MARGIN + (height * scale) as f32 + 12.0;
    let columns = width * scale;
    let key = format!(
        "red: nearer than the plane, blue: farther, by {OFF_PLANE} px; magenta: more; dark: no \
         answer"
    );
    let mut lines = wrapped(&key, TEXT, columns as f32);
    let keys = lines.len();
    lines.extend(text.lines().flat_map(|line| wrapped(line, TEXT, columns as f32)));
    let mut sheet = Sheet::new([
        columns + 2 * MARGIN as u32,
        (below + LINE * (lines.len() as f32 + 1.0) + MARGIN) as u32,
    ]);
    sheet.image([MARGIN as u32; 2], left, [0, 0, width, height], scale, 2);
    let place =
        |x: f64, y: f64| (MARGIN + x as f32 * scale as f32, MARGIN + y as f32 * scale as f32);
    for answer in answers {
        let cell =
            answer.at.map(|at| (at / f64::from(SUPPORT_PITCH)).floor() * f64::from(SUPPORT_PITCH));
        let far = f64::from(SUPPORT_PITCH) - 0.6;
        let corners = [(0.0, 0.0), (far, 0.0), (far, far), (0.0, far)]
            .map(|(x, y)| place(cell[0] + x, cell[1] + y));
        sheet.fill(&corners, tone(answer.off), 0.65);
    }
    let [x, y, w, h] = quality.region.map(f64::from);
    let corners = [place(x, y), place(x + w, y), place(x + w, y + h), place(x, y + h)];
    for (from, to) in corners.into_iter().zip([corners[1], corners[2], corners[3], corners[0]]) {
        sheet.line(from, to, REGION, 2.0);
    }
    for (at, line) in lines.into_iter().enumerate() {
        let rgb = if at < keys { FAINT } else { INK };
        sheet.label((MARGIN, below + LINE * at as f32), Align::Left, rgb, line);
    }
    sheet.into_picture()
}

fn tone(off: Option<f64>) -> [u8; 3] {
    let Some(off) = off else { return ON_PLANE.map(|v| v as u8) };
    if off.abs() > OFF_PLANE {
        return WRONG;
    }
    let share = (off.abs() / OFF_PLANE) as f32;
    let end = if off > 0.0 { NEARER } else { FARTHER };
    core::array::from_fn(|i| (ON_PLANE[i] + share * (end[i] - ON_PLANE[i])) as u8)
}
