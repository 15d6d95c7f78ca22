//! `linestereo run`: segments with depth from one rectified pair.

use super::method::MethodArgs;
use super::view::ViewArgs;
use super::{engine_with, machine_for, print};
use crate::board;
use crate::draw;
use crate::engine::{FrameResult, GrayImage};
use crate::frames::{
    SceneInfo, area_average, check_same_size, check_size, check_usable, load_gray, scaled_max_disparity,
};
use crate::health;
use crate::listing;
use crate::output::OutputFiles;
use crate::rectify::PairRectifier;
use anyhow::{Context, Result, anyhow, bail};
use core::fmt::Write;
use linestereo::{Dims, Eye, Params, Rejection, Rig, RigError};
use linestereo_wire::{RigImage, RigUpdate};
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
  linestereo run raw_left.png raw_right.png --rig rig.toml --size 320x240 --overlay depth.png
      a raw pair of a calibrated rig, rectified first; with --on the board rectifies it
      (where its memory for raw rows is too small: --raw-width)

Without --rig the pair has to be rectified: a point lies on one row in both images.
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
    /// Rectify the pair first: it is raw, of this rig. rig.toml, or files of OpenCV, Kalibr, ROS or EuRoC (twice where each camera has one).
    #[arg(long, value_name = "FILE", conflicts_with_all = ["focal_px", "scene", "width"])]
    rig: Vec<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
    /// Match on this board, emulated by QEMU: mps2-an500 (Cortex-M7, up to 320x240) or mps2-an386 (Cortex-M4, up to 160x120).
    #[arg(long, value_name = "BOARD")]
    on: Option<String>,
    #[command(flatten)]
    method: MethodArgs,
}

/// A pair as the core gets it, and what it is matched with.
struct Input {
    /// Rectified, or raw if there is a rig.
    images: [GrayImage; 2],
    params: Params,
    rig_numbers: Option<RigUpdate>,
    rig: Option<RigImage>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let input = if args.rig.is_empty() { rectified(args)? } else { raw(args)? };
    let (max_disparity, rig) = (input.params.max_disparity, input.params.rig);
    let (left, result, cost) = match &args.on {
        Some(board) => on_board(&input, board)?,
        None => here(&input)?,
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

fn rectified(args: &Args) -> Result<Input> {
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
    Ok(Input { images: [left, right], params, rig_numbers, rig: None })
}

fn raw(args: &Args) -> Result<Input> {
    let (left, right) = (load_gray(&args.left)?, load_gray(&args.right)?);
    check_same_size((&args.left, left.dims), (&args.right, right.dims))?;
    for (path, image) in [(&args.left, &left), (&args.right, &right)] {
        check_usable(path, image)?;
    }
    let params = args.method.params(args.max_disparity.unwrap_or(DEFAULT_MAX_DISPARITY), None)?;
    let image = args.view.image(&args.rig, None, (params.min_disparity, params.max_disparity))?;
    let params = image.params(params)?;
    let (left, right) = (args.view.raw(left)?, args.view.raw(right)?);
    Ok(Input { images: [left, right], params, rig_numbers: None, rig: Some(image) })
}

/// The left image as it was matched, the result, and the time in words.
fn here(input: &Input) -> Result<(GrayImage, FrameResult, String)> {
    let [left, right] = &input.images;
    let (left, right, usable) = match &input.rig {
        Some(rig) => {
            let mut rectifier = PairRectifier::new(rig.rectification())?;
            let (left, right) = rectifier.pair(left, right)?;
            (left, right, Eye::BOTH.map(|eye| rectifier.facts(eye).usable))
        }
        None => (left.clone(), right.clone(), [Vec::new(), Vec::new()]),
    };
    let mut engine = engine_with(&input.params, left.dims)?;
    let start = Instant::now();
    let [left_view, right_view] = [(&left, &usable[0]), (&right, &usable[1])].map(|(image, usable)| {
        let view = image.view()?;
        if usable.is_empty() { Ok(view) } else { view.with_usable(usable) }
    });
    let result = engine.run(left_view?, right_view?)?;
    Ok((left, result, format!("{:.1} ms", 1e3 * start.elapsed().as_secs_f64())))
}

/// The left image as it was matched, the result of a board, and its instructions in words.
fn on_board(input: &Input, board: &str) -> Result<(GrayImage, FrameResult, String)> {
    let [left, right] = &input.images;
    let update = board::update(&input.params, input.rig_numbers);
    let dims = input.rig.as_ref().map_or(left.dims, |rig| rig.rectification().dims());
    engine_with(&input.params, dims)?; // what is wrong with the parameters is said in the PC's words
    let largest = board::named(board)?.largest;
    if input.rig.is_some() && !board::named(board)?.fits(dims) {
        bail!("{board} holds pairs of up to {largest}, these are {dims}; give --size {largest}");
    }
    let machine = machine_for(board, dims)?;
    let name = machine.board().name;
    let pairs = [(left, right)];
    let (left, replayed) = match &input.rig {
        Some(rig) => {
            let rectified = PairRectifier::new(rig.rectification())?.image(Eye::Left, left)?;
            (rectified, machine.run_raw_pairs(rig, &update, &pairs)?)
        }
        None => (left.clone(), machine.run_pairs(&update, &pairs)?),
    };
    let pair = replayed.pairs.into_iter().next_back();
    let found = pair.with_context(|| format!("{name} gives no result"))?;
    let found = found.map_err(|why| anyhow!("{name} refuses the pair: {why}"))?;
    let millions = |instructions: u64| instructions as f64 / 1e6;
    let mut cost = format!("{:.2} million instructions on {name}", millions(found.costs.iter().sum()));
    if found.rectification > 0 {
        let _ = write!(cost, " after {:.2} million to rectify", millions(found.rectification));
    }
    Ok((left, found.result, cost))
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
