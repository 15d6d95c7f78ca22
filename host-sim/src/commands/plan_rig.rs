//! `linestereo plan-rig`: what two cameras will see, before they are bought.

use super::arguments::{both, number_in};
use super::written;
use crate::output::{OutputFiles, OutputPath};
use crate::planning::{Focal, RigPlan, Suggestion, USUAL_SIGMA, Wish, suggest};
use anyhow::{Result, bail};
use core::fmt::Write;
use linestereo::Dims;
use serde::Serialize;

/// Plan a rig: near limit, depth error and common view by distance, and the baseline for a wanted
/// range.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/plan-rig.txt"))]
#[command(group = clap::ArgGroup::new("focal").required(true).args(["focal_px", "focal_mm", "hfov_deg"]))]
pub struct Args {
    /// Focal length in px of the images as matched.
    #[arg(long, value_name = "PX")]
    focal_px: Option<f64>,
    /// Focal length of the lens, with --pixel-um.
    #[arg(long, value_name = "MM", requires = "pixel_um")]
    focal_mm: Option<f64>,
    /// Side of a pixel of the images as matched: after binning or reduction, a multiple of the
    /// sensor's.
    #[arg(long, value_name = "UM", requires = "focal_mm")]
    pixel_um: Option<f64>,
    /// Horizontal field of view.
    #[arg(long, value_name = "DEGREES",
          value_parser = number_in(1.0..=150.0, "give degrees from 1 to 150"))]
    hfov_deg: Option<f64>,
    /// Width and height of the images as matched.
    #[arg(long, value_name = "WxH", default_value = "320x240", value_parser = super::convert_rig::parse_size)]
    size: Dims,
    /// Distance between the cameras [default: the one suggested for --range].
    #[arg(long, value_name = "M", required_unless_present = "range", value_parser = super::input::baseline)]
    baseline_m: Option<f64>,
    /// Search disparities 0 .. N px.
    #[arg(long, value_name = "N", default_value_t = 64)]
    max_disparity: u16,
    /// Standard deviation of a disparity.
    #[arg(long, value_name = "PX", default_value_t = USUAL_SIGMA,
          value_parser = number_in(0.001..=16.0, "give 0.001 to 16 px"))]
    sigma_px: f64,
    /// Distances to measure, in metres; suggests a baseline.
    #[arg(long, value_name = "NEAR..FAR", value_parser = parse_range)]
    range: Option<[f64; 2]>,
    /// Largest error at FAR.
    #[arg(long, value_name = "PERCENT", default_value_t = 5.0, requires = "range")]
    error: f64,
    /// Write everything as JSON; "-" is stdout.
    #[arg(long, value_name = "FILE")]
    json: Option<OutputPath>,
}

pub fn run(args: &Args) -> Result<()> {
    let focal = match (args.focal_px, args.focal_mm, args.pixel_um, args.hfov_deg) {
        (Some(focal), ..) => Focal::Pixels(focal),
        (_, Some(focal), Some(pixel), _) => Focal::Millimetres { focal, pixel },
        (.., Some(degrees)) => Focal::FieldOfView(degrees),
        _ => bail!(
            "there is no focal length; give --focal-px, --focal-mm with --pixel-um, or --hfov-deg"
        ),
    };
    let (focal, error) = (focal.pixels(args.size), args.error / 100.0);
    let wish = args.range.map(|[near, far]| Wish { near, far, error });
    let suggestion = wish
        .map(|wish| suggest(focal, args.size, args.max_disparity, args.sigma_px, &wish))
        .transpose()?;
    let baseline =
        args.baseline_m.or(suggestion.as_ref().map(|found| found.baseline_m)).unwrap_or(0.0);
    let plan = RigPlan::new(focal, args.size, baseline, args.max_disparity, args.sigma_px)?;
    let mut output = OutputFiles::new();
    output.add_json(args.json.as_ref(), &listing(&plan, wish.as_ref(), suggestion.as_ref()))?;
    let text = text(&plan, wish.as_ref(), suggestion.as_ref(), args.baseline_m.is_some());
    output.commit_and_sum_up("", &text, &written([&args.json]))
}

fn text(
    plan: &RigPlan,
    wish: Option<&Wish>,
    suggestion: Option<&Suggestion>,
    is_given: bool,
) -> String {
    let [horizontal, vertical] = plan.fields_of_view();
    let mut text = format!(
        "focal length {:.1} px, {} ({horizontal:.0} x {vertical:.0} degrees), baseline {:.1} mm, disparities to {}, \
         sigma {} px\n",
        plan.focal,
        plan.dims,
        1e3 * plan.baseline,
        plan.max_disparity,
        plan.sigma
    );
    if let (Some(wish), Some(found)) = (wish, suggestion) {
        let Wish { near, far, error } = wish;
        let _ = writeln!(
            text,
            "for {near} to {far} m and {:.1} % at {far} m: a baseline of {:.1} mm at least",
            100.0 * error,
            // Rounded to the side on which it is enough.
            (1e4 * found.baseline_m - 1e-6).ceil() / 10.0
        );
        if is_given {
            let (percent, limit) = (plan.row(*far).error_percent, plan.near_limit());
            let reached = |is_reached: bool| if is_reached { "reached" } else { "not reached" };
            let _ = writeln!(
                text,
                "  with the one given, {percent:.1} % at {far} m: {}; {near} m: {}",
                reached(percent <= 100.0 * error * (1.0 + 1e-9)),
                reached(limit <= near * (1.0 + 1e-9))
            );
        }
        for sentence in &found.advice {
            let _ = writeln!(text, "  {sentence}");
        }
    }
    let _ = write!(
        text,
        "near limit {}; nearer than {} the cameras see nothing in common\n\
         error below 5 % up to {}, below 10 % up to {}\n\n\
         distance  disparity     error             seen by both\n",
        metres(plan.near_limit()),
        metres(plan.meeting()),
        metres(plan.reach(0.05)),
        metres(plan.reach(0.1)),
    );
    for row in plan.table(wish) {
        let _ = writeln!(
            text,
            "{:>8} {:>7.1} px {:>9}  {:>5.1} %  {:>9.0} %",
            metres(row.distance_m),
            row.disparity_px,
            metres(row.error_m),
            row.error_percent,
            row.overlap_percent
        );
    }
    text
}

/// With as many decimals as matter.
fn metres(value: f64) -> String {
    let decimals = if value < 0.1 {
        4
    } else if value < 1.0 {
        3
    } else {
        usize::from(value < 100.0) + usize::from(value < 10.0)
    };
    format!("{value:.decimals$} m")
}

#[derive(Serialize)]
struct Listing<'a> {
    size: [u16; 2],
    focal_px: f64,
    horizontal_fov_deg: f64,
    vertical_fov_deg: f64,
    baseline_m: f64,
    max_disparity: u16,
    sigma_px: f64,
    near_limit_m: f64,
    views_meet_m: f64,
    reach_5_percent_m: f64,
    reach_10_percent_m: f64,
    table: Vec<crate::planning::Row>,
    suggestion: Option<&'a Suggestion>,
}

fn listing<'a>(
    plan: &RigPlan,
    wish: Option<&Wish>,
    suggestion: Option<&'a Suggestion>,
) -> Listing<'a> {
    let [horizontal_fov_deg, vertical_fov_deg] = plan.fields_of_view();
    Listing {
        size: [plan.dims.width, plan.dims.height],
        focal_px: plan.focal,
        horizontal_fov_deg,
        vertical_fov_deg,
        baseline_m: plan.baseline,
        max_disparity: plan.max_disparity,
        sigma_px: plan.sigma,
        near_limit_m: plan.near_limit(),
        views_meet_m: plan.meeting(),
        reach_5_percent_m: plan.reach(0.05),
        reach_10_percent_m: plan.reach(0.1),
        table: plan.table(wish),
        suggestion,
    }
}

fn parse_range(text: &str) -> Result<[f64; 2], &'static str> {
    let ends = text.split_once("..").and_then(both);
    ends.filter(|&[near, far]| 0.0 < near && near < far && far <= 1e5)
        .ok_or("give two rising distances in metres, for example 0.5..4")
}
