//! Distances of the nearest obstacle over a sequence: surveyed, measured, missed.

use super::plan::{even_step, metres};
use super::sheet::{FAINT, GRID, INK, Sheet};
use super::text::Align;
use image::RgbImage;

const SIZE: [u32; 2] = [1280, 560];
const FRAME: [f32; 4] = [90.0, 70.0, 1250.0, 500.0];
const SURVEYED: [u8; 3] = [0, 200, 255];
const MEASURED: [u8; 3] = [255, 225, 40];
const MISSED: [u8; 3] = [255, 45, 45];

/// A chart of (number of the frame, surveyed m, measured m) with a title; frames without an answer are marked at the lower border.
pub fn nearest(title: &str, frames: &[(u64, f64, Option<f64>)]) -> RgbImage {
    let mut sheet = Sheet::new(SIZE);
    let [left, top, right, bottom] = FRAME;
    sheet.label((left, 12.0), Align::Left, INK, title.to_owned());
    let keys = [(SURVEYED, "surveyed"), (MEASURED, "measured"), (MISSED, "missed")];
    for (x, (rgb, text)) in (0_u8..).map(|i| left + 130.0 * f32::from(i)).zip(keys) {
        sheet.fill(&square((x + 6.0, 46.0), 5.0), rgb, 1.0);
        sheet.label((x + 18.0, 38.0), Align::Left, INK, text.to_owned());
    }
    let (first, last) = (frames.first().map_or(0, |f| f.0), frames.last().map_or(1, |f| f.0));
    // One wild answer should not flatten the rest.
    let far = 1.3 * frames.iter().map(|frame| frame.1).fold(0.1, f64::max);
    let place = |number: u64, z: f64| {
        let t = (number - first) as f32 / (last - first).max(1) as f32;
        (left + t * (right - left), bottom - (z.clamp(0.0, far) / far) as f32 * (bottom - top))
    };
    let step = even_step(far / 6.0);
    for index in 0..=(far / step) as u32 {
        let (_, v) = place(first, f64::from(index) * step);
        sheet.line((left, v), (right, v), GRID, 1.0);
        sheet.label((left - 8.0, v - 8.0), Align::Right, FAINT, metres(f64::from(index) * step));
    }
    let every = (frames.len() / 12).max(1);
    for frame in frames.iter().step_by(every) {
        sheet.label((place(frame.0, 0.0).0, bottom + 10.0), Align::Centre, FAINT, frame.0.to_string());
    }
    sheet.label((0.5 * (left + right), bottom + 32.0), Align::Centre, FAINT, "frame".to_owned());
    for pair in frames.windows(2) {
        sheet.line(place(pair[0].0, pair[0].1), place(pair[1].0, pair[1].1), SURVEYED, 2.0);
    }
    for &(number, _, measured) in frames {
        match measured {
            Some(z) => sheet.fill(&square(place(number, z), 4.0), MEASURED, 1.0),
            None => sheet.fill(&square(place(number, 0.0), 4.0), MISSED, 1.0),
        }
    }
    sheet.into_picture()
}

fn square((x, y): (f32, f32), half: f32) -> [(f32, f32); 4] {
    [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)]
}
