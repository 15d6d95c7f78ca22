//! A rig that is planned: seen from above, to scale, whole and near the cameras; error and common view by distance.

use super::sheet::{FAINT, FAIR, GOOD, GRID, INK, POOR as LOST, SEEN as SHARED, Sheet, TEXT};
use super::text::Align;
use crate::planning::{RigPlan, Wish};
use image::RgbImage;

const SIZE: [u32; 2] = [1280, 860];
/// Errors above 10 %.
const POOR: [u8; 3] = [255, 140, 20];
/// Shares of distance that the colours part at.
const SHARES: [f64; 2] = [0.05, 0.1];
/// The near view ends at this many times the near limit.
const NEAR_VIEW: f64 = 2.5;
/// Columns of a chart that are looked at.
const SAMPLES: u16 = 200;
/// Top of the chart of errors, percent.
const TOP_ERROR: f64 = 20.0;

/// The plan as a picture.
pub fn plan(plan: &RigPlan, wish: Option<&Wish>) -> RgbImage {
    let far = 1.15 * wish.map_or(0.0, |wish| wish.far).max(plan.reach(SHARES[1])).max(1.3 * plan.near_limit());
    let mut sheet = Sheet::new(SIZE);
    let title = format!(
        "focal length {:.0} px, {}, baseline {:.1} mm, disparities to {}, sigma {} px",
        plan.focal,
        plan.dims,
        1e3 * plan.baseline,
        plan.max_disparity,
        plan.sigma
    );
    sheet.label((24.0, 14.0), Align::Left, INK, title);
    let key = [(GOOD, "error below 5 %"), (FAIR, "below 10 %"), (POOR, "above"), (LOST, "nearer than the range")];
    let mut x = 24.0;
    for (rgb, text) in key {
        sheet.fill(&[(x, 44.0), (x + 14.0, 44.0), (x + 14.0, 58.0), (x, 58.0)], rgb, 0.6);
        sheet.label((x + 20.0, 43.0), Align::Left, INK, text.to_owned());
        x += 60.0 + 9.0 * text.len() as f32;
    }
    view(&mut sheet, plan, wish, [24.0, 80.0, 620.0, 840.0], ("from above, to scale", far));
    let near = (NEAR_VIEW * plan.near_limit()).min(far);
    view(&mut sheet, plan, wish, [650.0, 80.0, 1256.0, 440.0], ("near the cameras", near));
    charts(&mut sheet, plan, wish, [710.0, 486.0, 1200.0, 800.0], far);
    sheet.into_picture()
}

/// Both cameras from above: [left, top, right, bottom] of the picture, and the farthest distance.
fn view(sheet: &mut Sheet, plan: &RigPlan, wish: Option<&Wish>, frame: [f32; 4], (title, far): (&str, f64)) {
    let [left, top, right, bottom] = frame;
    let slope = 0.5 * f64::from(plan.dims.width) / plan.focal;
    let half = 0.5 * plan.baseline;
    let label_width = 80.0;
    let across = f64::from(right - left - label_width) / (2.0 * (slope * far + half));
    let scale = across.min(f64::from(bottom - top - 60.0) / far);
    let middle = left + label_width + 0.5 * (right - left - label_width);
    let place = |x: f64, z: f64| (middle + (x * scale) as f32, bottom - 20.0 - (z * scale) as f32);
    // Area seen by both between two distances: from the right camera's left border to the left one's right border.
    let mut band = |from: f64, to: f64, rgb| {
        let (from, to) = (from.clamp(plan.meeting(), far), to.clamp(plan.meeting(), far));
        let [a, b] = [from, to].map(|z| (slope * z - half).max(0.0));
        if to > from {
            sheet.fill(&[place(-a, from), place(a, from), place(b, to), place(-b, to)], rgb, 0.45);
        }
    };
    let near = plan.near_limit();
    let [good, fair] = SHARES.map(|share| plan.reach(share));
    band(0.0, near, LOST);
    band(near, good, GOOD);
    band(near.max(good), fair, FAIR);
    band(near.max(fair), far, POOR);
    for x in [-half, half] {
        for side in [-1.0, 1.0] {
            sheet.line(place(x, 0.0), place(x + side * slope * far, far), FAINT, 1.2);
        }
        let (u, v) = place(x, 0.0);
        sheet.fill(&[(u - 4.0, v + 8.0), (u + 4.0, v + 8.0), (u, v)], INK, 1.0);
    }
    let step = even_step(far / 6.0);
    for index in 0..=(far / step) as u32 {
        let z = f64::from(index) * step;
        let (u, v) = place(0.0, z);
        let reach = ((slope * far + half) * scale) as f32;
        sheet.line((u - reach, v), (u + reach, v), GRID, 1.0);
        sheet.label((left + 70.0, v - 8.0), Align::Right, FAINT, metres(z));
    }
    for (z, text) in wish.iter().flat_map(|wish| [(wish.near, "NEAR"), (wish.far, "FAR")]) {
        // In the whole view, what is near has no room.
        if z <= far && z * scale > f64::from(3.0 * TEXT) {
            let reach = slope * z + half;
            sheet.line(place(-reach, z), place(reach, z), INK, 2.0);
            let (u, v) = place(reach, z);
            sheet.label((u.min(right - 40.0) + 6.0, v - 8.0), Align::Left, INK, text.to_owned());
        }
    }
    let (_, upper) = place(0.0, far);
    sheet.label((middle, top.max(upper - 30.0)), Align::Centre, INK, title.to_owned());
    if near <= far && near * scale > f64::from(3.0 * TEXT) {
        let (u, v) = place(0.0, near);
        sheet.label((u, v - 20.0), Align::Centre, INK, format!("near limit {}", metres(near)));
    }
}

/// Error and common view over distance, on a logarithmic axis.
fn charts(sheet: &mut Sheet, plan: &RigPlan, wish: Option<&Wish>, [left, top, right, bottom]: [f32; 4], far: f64) {
    let nearest = 0.5 * wish.map_or(plan.near_limit(), |wish| wish.near.min(plan.near_limit()));
    let octaves = (far / nearest).ln();
    let across = |z: f64| left + (right - left) * ((z / nearest).ln() / octaves) as f32;
    let down = |share: f64| bottom - (bottom - top) * share.clamp(0.0, 1.0) as f32;
    for percent in [0.0, 5.0, 10.0, 15.0, 20.0] {
        let v = down(percent / TOP_ERROR);
        sheet.line((left, v), (right, v), GRID, 1.0);
        sheet.label((left - 8.0, v - 8.0), Align::Right, FAIR, format!("{percent} %"));
        sheet.label((right + 8.0, v - 8.0), Align::Left, SHARED, format!("{:.0} %", percent / TOP_ERROR * 100.0));
    }
    let mut last = f32::MIN;
    for power in -4..=6 {
        for z in [1.0, 2.0, 5.0].map(|step| step * 10_f64.powi(power)) {
            let u = across(z);
            if (nearest..=far).contains(&z) && u - last > 56.0 {
                sheet.line((u, top), (u, bottom), GRID, 1.0);
                sheet.label((u, bottom + 6.0), Align::Centre, FAINT, metres(z));
                last = u;
            }
        }
    }
    for (z, rgb) in core::iter::once((plan.near_limit(), LOST))
        .chain(wish.iter().flat_map(|wish| [(wish.near, INK), (wish.far, INK)]))
        .filter(|(z, _)| (nearest..=far).contains(z))
    {
        sheet.line((across(z), top), (across(z), bottom), rgb, 1.5);
    }
    let point = |index: u16| nearest * (octaves * f64::from(index) / f64::from(SAMPLES)).exp();
    for index in 0..SAMPLES {
        let [a, b] = [index, index + 1].map(|index| plan.row(point(index)));
        let between = |a: f64, b: f64, rgb, sheet: &mut Sheet| {
            let (from, to) = (across(point(index)), across(point(index + 1)));
            sheet.line((from, down(a)), (to, down(b)), rgb, 2.5);
        };
        if a.error_percent <= TOP_ERROR {
            between(a.error_percent / TOP_ERROR, b.error_percent / TOP_ERROR, FAIR, sheet);
        }
        between(a.overlap_percent / 100.0, b.overlap_percent / 100.0, SHARED, sheet);
    }
    sheet.label((left - 50.0, top - 26.0), Align::Left, FAIR, "error, share of distance".to_owned());
    sheet.label((right + 50.0, top - 26.0), Align::Right, SHARED, "seen by both, share of width".to_owned());
    sheet.label((0.5 * (left + right), bottom + 26.0), Align::Centre, FAINT, "distance".to_owned());
}

/// The 1, 2 or 5 times a power of ten next above.
pub(super) fn even_step(least: f64) -> f64 {
    let power = 10_f64.powi(least.log10().floor() as i32);
    let step = [1.0, 2.0, 5.0].into_iter().find(|step| step * power >= least);
    step.unwrap_or(10.0) * power
}

pub(super) fn metres(value: f64) -> String {
    let decimals = if value == 0.0 || value >= 10.0 { 0 } else { (1.0 - value.log10().floor()) as usize };
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} m")
}
