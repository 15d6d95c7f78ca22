//! A calibration as a picture: where corners were seen, how far each is off, each view's error, and
//! a rectified pair.

use super::sheet::{BACKGROUND, FAIR, GOOD, INK, POOR, SEEN, Sheet};
use super::text::Align;
use image::RgbImage;
use linestereo_calibration::boards::{Assessment, CornerError, Estimate, Verdict};
use linestereo_frames::GrayImage;
use linestereo_rig::{CameraSide, Rectification};

const WIDTH: u32 = 1280;
const FAINT: [u8; 3] = [90, 90, 96];
const MARGIN: f32 = 24.0;
/// Width of one camera's field.
const FIELD: f32 = 604.0;
/// An arrow is this many times as long as its error, in px of the field.
const ENLARGED: f32 = 40.0;
/// Height of the bars, and the error that fills it, as a multiple of the median view's.
const BARS: (f32, f64) = (140.0, 3.0);
/// Lines across the rectified pair.
const LINES: u32 = 12;

/// The estimate with the pair of photos that is shown rectified.
pub fn calibration(
    estimate: &Estimate,
    assessment: &Assessment,
    photos: Option<&[GrayImage; 2]>,
) -> RgbImage {
    let dims = estimate.calibration.camera(CameraSide::Left).dims();
    let scale = FIELD / f32::from(dims.width);
    let field = scale * f32::from(dims.height);
    let bars = MARGIN + 60.0 + field + 50.0;
    let pair = bars + BARS.0 + 60.0;
    let shown = photos.zip(assessment.rectified.as_ref());
    let height = if let Some((_, rectified)) = &shown {
        let dims = rectified.rectification.dims();
        pair + 20.0 + FIELD * f32::from(dims.height) / f32::from(dims.width) + MARGIN
    } else {
        pair - 30.0
    };
    let mut sheet = Sheet::new([WIDTH, height.ceil() as u32]);
    let verdict = match assessment.verdict {
        Verdict::Good => GOOD,
        Verdict::Usable => FAIR,
        Verdict::Repeat => POOR,
    };
    let mut title = format!(
        "{}: stereo RMS {:.3} px, baseline {:.2} +- {:.2} mm",
        assessment.verdict,
        estimate.rms,
        1e3 * estimate.calibration.baseline(),
        1e3 * estimate.baseline_sigma,
    );
    if let Some(rectified) = &assessment.rectified {
        title += &format!(", vertical residual {:.3} px", rectified.vertical);
    }
    sheet.label((MARGIN, 14.0), Align::Left, verdict, title);
    for (eye, side) in ["left", "right"].into_iter().enumerate() {
        let left = MARGIN + eye as f32 * (FIELD + MARGIN);
        let text = format!(
            "{side}: RMS {:.3} px, corners in {:.0} % of cells, errors {ENLARGED:.0} times as long",
            estimate.camera_rms[eye],
            100.0 * assessment.coverage[eye].share
        );
        sheet.label((left, 50.0), Align::Left, INK, text);
        let frame = [left, MARGIN + 54.0, FIELD, field];
        cells(&mut sheet, frame, &assessment.coverage[eye].cells);
        arrows(&mut sheet, frame, scale, &estimate.errors[eye]);
    }
    views(&mut sheet, estimate, bars);
    if let Some((photos, rectified)) = shown {
        sheet.label(
            (MARGIN, pair - 8.0),
            Align::Left,
            INK,
            "rectified: the same corner on the same line",
        );
        rectified_pair(&mut sheet, &rectified.rectification, photos, pair + 16.0);
    }
    sheet.into_picture()
}

/// Cells without corners are empty.
fn cells(sheet: &mut Sheet, [left, top, width, height]: [f32; 4], counts: &[u32]) {
    let (across, down) = (8, counts.len() / 8);
    for (index, &count) in counts.iter().enumerate() {
        let (w, h) = (width / across as f32, height / down as f32);
        let at = [left + w * (index % across) as f32, top + h * (index / across) as f32, w, h];
        if count > 0 {
            fill(sheet, at, SEEN, 0.08 + 0.25 * (count as f32 / 40.0).min(1.0));
        }
        outline(sheet, at, FAINT);
    }
}

fn arrows(sheet: &mut Sheet, [left, top, ..]: [f32; 4], scale: f32, errors: &[CornerError]) {
    for corner in errors {
        let [x, y] = corner.at.map(|v| (v as f32 + 0.5) * scale);
        let [dx, dy] = corner.error.map(|v| v as f32 * scale * ENLARGED);
        let size = corner.error[0].hypot(corner.error[1]);
        let rgb = if size < 0.3 {
            GOOD
        } else if size < 0.6 {
            FAIR
        } else {
            POOR
        };
        sheet.line((left + x, top + y), (left + x + dx, top + y + dy), rgb, 1.2);
    }
}

/// Two bars for each view: left and right error.
fn views(sheet: &mut Sheet, estimate: &Estimate, top: f32) {
    let bottom = top + BARS.0;
    let largest = BARS.1 * estimate.rms;
    let step = (WIDTH as f32 - 2.0 * MARGIN) / estimate.views.len() as f32;
    let level = bottom - BARS.0 * (estimate.rms / largest) as f32;
    sheet.label(
        (MARGIN, top - 24.0),
        Align::Left,
        INK,
        "error of each view, left and right; line: all; x: dropped",
    );
    for (index, view) in estimate.views.iter().enumerate() {
        let left = MARGIN + step * index as f32;
        for (eye, rms) in view.rms.into_iter().enumerate() {
            let height = BARS.0 * (rms / largest).min(1.0) as f32;
            let at =
                [left + step * (0.15 + 0.35 * eye as f32), bottom - height, 0.32 * step, height];
            fill(sheet, at, if eye == 0 { SEEN } else { FAIR }, 0.8);
        }
        let middle = left + 0.5 * step;
        if view.dropped.is_some() {
            sheet.line((middle - 6.0, bottom - 14.0), (middle + 6.0, bottom - 2.0), POOR, 2.0);
            sheet.line((middle - 6.0, bottom - 2.0), (middle + 6.0, bottom - 14.0), POOR, 2.0);
        }
        // Every name where they have room.
        let every = (40.0 / step).ceil().max(1.0) as usize;
        if index % every == 0 {
            sheet.label(
                (middle, bottom + 4.0),
                Align::Centre,
                FAINT,
                view.name.chars().take(8).collect::<String>(),
            );
        }
    }
    sheet.line((MARGIN, level), (WIDTH as f32 - MARGIN, level), INK, 1.0);
}

/// Nearest pixels: for the eye only.
fn rectified_pair(
    sheet: &mut Sheet,
    rectification: &Rectification,
    photos: &[GrayImage; 2],
    top: f32,
) {
    let dims = rectification.dims();
    let scale = FIELD / f32::from(dims.width);
    let height = (scale * f32::from(dims.height)) as u32;
    for (eye, (photo, side)) in photos.iter().zip(CameraSide::BOTH).enumerate() {
        let left = MARGIN as u32 + eye as u32 * (FIELD + MARGIN) as u32;
        for y in 0..height {
            for x in 0..FIELD as u32 {
                let at = [x, y].map(|v| f64::from(v as f32 / scale));
                let grey = rectification.source(side, at).and_then(|raw| nearest(photo, raw));
                sheet.pixel([left + x, top as u32 + y], grey.map_or(BACKGROUND, |grey| [grey; 3]));
            }
        }
    }
    for line in 1..LINES {
        // The middle of a row of pixels: a row of its own, not two of half its colour.
        let y = (top as u32 + height * line / LINES) as f32 + 0.5;
        sheet.line((MARGIN, y), (WIDTH as f32 - MARGIN, y), GOOD, 1.0);
    }
}

fn nearest(photo: &GrayImage, [x, y]: [f64; 2]) -> Option<u8> {
    let (width, height) = (f64::from(photo.dims.width), f64::from(photo.dims.height));
    let (x, y) = (x.round(), y.round());
    let inside = (0.0..width).contains(&x) && (0.0..height).contains(&y);
    inside.then(|| photo.pixels[y as usize * usize::from(photo.dims.width) + x as usize])
}

fn fill(sheet: &mut Sheet, area: [f32; 4], rgb: [u8; 3], alpha: f32) {
    sheet.fill(&corners(area), rgb, alpha);
}

fn outline(sheet: &mut Sheet, area: [f32; 4], rgb: [u8; 3]) {
    let round = corners(area);
    for index in 0..4 {
        sheet.line(round[index], round[(index + 1) % 4], rgb, 0.7);
    }
}

fn corners([x, y, width, height]: [f32; 4]) -> [(f32, f32); 4] {
    [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
}
