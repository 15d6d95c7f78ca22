//! `linestereo run`: segments with depth from one rectified pair.

use super::method::MethodArgs;
use super::{engine_with, machine_for, print};
use crate::board::{self, Machine};
use crate::draw;
use crate::engine::{FrameResult, GrayImage};
use crate::frames::{
    SceneInfo, area_average, check_same_size, check_size, check_usable, load_gray, scaled_max_disparity,
};
use crate::health;
use crate::listing;
use crate::output::OutputFiles;
use anyhow::{Context, Result, anyhow};
use core::fmt::Write;
use linestereo::{Dims, Rejection, Rig, RigError};
use linestereo_wire::{ParamUpdate, RigUpdate};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Disparity range where neither an option nor a scene file gives one.
const DEFAULT_MAX_DISPARITY: u16 = 64;

const EXAMPLES: &str = "\
Examples:
  linestereo run left.png right.png --overlay depth.png
      disparities only, and a picture of them
  linestereo run left.png right.png --focal-px 451 --baseline-m 0.075 --json -
      with depth in metres, everything as JSON on stdout
  linestereo run left.png right.png --scene scene.json --width 320 --csv segments.csv
      range and rig from a scene file, images reduced to 320 px
  linestereo run left.png right.png --width 320 --on mps2-an500
      the same on an emulated Cortex-M7, with its instructions counted

The pair has to be rectified: a point lies on one row in both images.
Choose --max-disparity above focal_px * baseline_m / (nearest distance in m).

JSON:
  {\"size\":[w,h],
   \"segments\":[{\"id\":0, \"left\":[[x0,y0],[x1,y1]], \"disparity_px\":[d0,d1], \"sigma_px\":s,
                \"confidence\":c, \"owner\":\"left|right|both\", \"depth_m\":[z0,z1],
                \"techniques\":{\"feature\":d, \"window\":d, \"census\":d}}],
   \"points\":[[x,y,disparity_px,confidence]],
   \"counts\":{...},
   \"health\":{\"flags\":[\"...\"],
             \"left\":{\"level\":l, \"detail\":e, \"black\":b, \"white\":w, \"view\":v}, \"right\":{...},
             \"skew_us\":t, \"rows\":{\"offset_px\":r, \"spread_px\":s, \"witnesses\":n},
             \"row_offset_px\":r, \"row_drift_px\":r, \"least_disparity_px\":d}}
  confidence  probability of being within 1 px
  owner       side whose surface has this depth; left is above on a near-horizontal segment
  depth_m     null without a rig; a z of null is infinite
  feature     null when no segment of the right image is alike
  health      what is wrong with the pair, and the numbers behind it; null is not known
  level       mean grey level; black and white: shares of the pixels at 0..2 and at 253..255;
              detail: mean grey step between samples; view: share of the usable pixels
  skew_us     between the captures: null here, files have no capture times
  rows        row in the right image minus row in the left one, by the matches: its median, spread and
              the number of matches that could say; row_offset_px smooths it over pairs";

/// Match one rectified pair: segments and points with disparity, depth and a probability each.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Left image, the reference: PNG, JPEG, PGM or PPM, 8 or 16 bit, grey or colour.
    left: PathBuf,
    /// Right image of the same size.
    right: PathBuf,
    /// Search disparities 0 .. N px, in the images as matched (after --width) [default: the scene file's, else 64].
    #[arg(long, value_name = "N")]
    max_disparity: Option<u16>,
    /// Focal length of the rectified images as given (before --width).
    #[arg(long, value_name = "PX", requires = "baseline_m")]
    focal_px: Option<f64>,
    /// Distance between the cameras.
    #[arg(long, value_name = "M", requires = "focal_px")]
    baseline_m: Option<f64>,
    /// Added to every disparity before it becomes a depth: x_centre_right - x_centre_left, 0 for most rigs.
    #[arg(long, value_name = "PX", requires = "focal_px", allow_negative_numbers = true)]
    disparity_offset_px: Option<f64>,
    /// Take disparity range and rig from a scene.json; options given here come first.
    #[arg(long, value_name = "scene.json")]
    scene: Option<PathBuf>,
    /// Reduce both images to this width by area averaging; the rig follows.
    #[arg(long, value_name = "PX")]
    width: Option<u16>,
    /// Write segments, points and counts as JSON; "-" is stdout.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the segments as CSV.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw the segments over the left image, red near to blue far, as PNG.
    #[arg(long, value_name = "FILE.png")]
    overlay: Option<PathBuf>,
    /// Match on this board, emulated by QEMU: mps2-an500 (Cortex-M7, up to 320x240) or mps2-an386 (Cortex-M4, up to 160x120).
    #[arg(long, value_name = "BOARD")]
    on: Option<String>,
    #[command(flatten)]
    method: MethodArgs,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let (left, full) = load(&args.left, args.width)?;
    let (right, right_full) = load(&args.right, args.width)?;
    check_same_size((&args.left, full), (&args.right, right_full))?;
    for (path, image) in [(&args.left, &left), (&args.right, &right)] {
        check_size(path, image)?;
        check_usable(path, image)?;
    }
    let scale = f64::from(left.dims.width) / f64::from(full.width);
    let (max_disparity, rig, rig_numbers) = range_and_rig(args, scale)?;
    let params = args.method.params(max_disparity, rig)?;
    let mut engine = engine_with(&params, left.dims)?;
    let (result, cost) = if let Some(board) = &args.on {
        let machine = machine_for(board, left.dims)?;
        on_board(&machine, &board::update(&params, rig_numbers), &left, &right)?
    } else {
        let start = Instant::now();
        let result = engine.run(left.view()?, right.view()?)?;
        (result, format!("{:.1} ms", 1e3 * start.elapsed().as_secs_f64()))
    };

    let mut output = OutputFiles::new();
    let json_to_stdout = args.json.as_deref() == Some(Path::new("-"));
    if let Some(path) = args.json.as_deref().filter(|_| !json_to_stdout) {
        output.add(path, listing::json(left.dims, &result)?.as_bytes())?;
    }
    if let Some(path) = &args.csv {
        output.add(path, listing::csv(&result).as_bytes())?;
    }
    if let Some(path) = &args.overlay {
        output.add(path, &draw::png(&draw::overlay(&left, &result, rig.as_ref(), max_disparity))?)?;
    }
    output.commit()?;
    if json_to_stdout {
        return print(&listing::json(left.dims, &result)?);
    }
    print(&summary(left.dims, max_disparity, &result, &cost))?;
    for path in [&args.json, &args.csv, &args.overlay].into_iter().flatten() {
        print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}

/// The image, reduced if asked, and its size before that.
fn load(path: &Path, width: Option<u16>) -> Result<(GrayImage, Dims)> {
    let image = load_gray(path)?;
    let full = image.dims;
    Ok((width.map_or(Ok(image.clone()), |width| area_average(&image, width))?, full))
}

/// The result of a board, and its instructions in words.
fn on_board(
    machine: &Machine,
    update: &ParamUpdate,
    left: &GrayImage,
    right: &GrayImage,
) -> Result<(FrameResult, String)> {
    let name = machine.board().name;
    let pair = machine.run_pairs(update, &[(left, right)])?.pairs.pop();
    let found = pair.with_context(|| format!("{name} gives no result"))?;
    let found = found.map_err(|why| anyhow!("{name} refuses the pair: {why}"))?;
    let instructions = found.costs.iter().sum::<u64>() as f64 / 1e6;
    Ok((found.result, format!("{instructions:.2} million instructions on {name}")))
}

/// Disparity range, rig, and the numbers it is made from.
fn range_and_rig(args: &Args, scale: f64) -> Result<(u16, Option<Rig>, Option<RigUpdate>)> {
    let (mut range, mut rig, mut numbers) = (None, None, None);
    if let Some(path) = &args.scene {
        let info = SceneInfo::load(path)?;
        range =
            info.max_disparity.map(|range| if scale < 1.0 { scaled_max_disparity(range, scale) } else { range as u16 });
        rig = info.rig(path, scale)?;
        numbers = info.rig_numbers(scale);
    }
    if let (Some(focal), Some(baseline)) = (args.focal_px, args.baseline_m) {
        let offset = args.disparity_offset_px.unwrap_or(0.0);
        let given = Rig::new(focal * scale, baseline, offset * scale);
        rig = Some(given.map_err(|error| anyhow!("{error}; correct {}", option_behind(&error)))?);
        numbers = Some(RigUpdate { focal_px: focal * scale, baseline_m: baseline, offset_px: offset * scale });
    }
    Ok((args.max_disparity.or(range).unwrap_or(DEFAULT_MAX_DISPARITY), rig, numbers))
}

fn option_behind(error: &RigError) -> &'static str {
    match error {
        RigError::Focal(_) => "--focal-px",
        RigError::Baseline(_) => "--baseline-m",
        RigError::Offset(_) => "--disparity-offset-px",
    }
}

/// What was found, in a few lines.
fn summary(dims: Dims, max_disparity: u16, result: &FrameResult, cost: &str) -> String {
    let counts = &result.counts;
    let mut text = format!(
        "{dims}, disparities below {max_disparity}: {} of {} segments matched, {} points, {cost}\n",
        counts.matched, counts.segments_left, counts.points,
    );
    let shares = [0.98, 0.95, 0.9, 0.8].map(|least| {
        let segments = result.matches.iter().filter(|found| found.confidence.to_num::<f64>() >= least).count();
        let points = result.points.iter().filter(|point| point.confidence.to_num::<f64>() >= least).count();
        format!("  p >= {least:.2}: {segments:4} segments, {points:6} points\n")
    });
    text.push_str(&shares.concat());
    let depths = || result.matches.iter().filter_map(|found| found.depth).flatten();
    if let (Some(nearest), Some(farthest)) = (depths().min(), depths().max()) {
        let metres = |depth| listing::finite_metres(depth).map_or("infinity".to_owned(), |m| format!("{m:.2} m"));
        let _ = writeln!(text, "depths from {} to {}", metres(nearest), metres(farthest));
    }
    let mut lost: Vec<_> = Rejection::ALL.map(|reason| (counts.rejected(reason), reason.name())).into();
    lost.retain(|&(count, _)| count > 0);
    lost.sort_by_key(|&(count, _)| core::cmp::Reverse(count));
    if !lost.is_empty() {
        let list: Vec<String> = lost.iter().map(|(count, name)| format!("{name} {count}")).collect();
        let _ = writeln!(text, "rejected: {}", list.join(", "));
    }
    text.push_str(&health::summary(result.health, result.pair.as_ref()));
    text
}
