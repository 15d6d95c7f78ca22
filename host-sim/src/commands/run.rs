//! `linestereo run`: segments with depth from one rectified pair.

use super::arguments::position;
use super::input::{InputArgs, PairMatcher, Setup, TimedResult};
use super::objects::{Asked, ObjectArgs};
use super::pairs::scene_note;
use super::sector_options::SectorArgs;
use super::written;
use crate::draw::{self, ColourRange};
use crate::engine::FrameResult;
use crate::output::{OutputFiles, OutputPath};
use crate::results::directions::Directions;
use crate::results::ground::Ground;
use crate::results::health;
use crate::results::listing::{self, Answers, Query};
use crate::results::{self, PngMap};
use anyhow::{Result, anyhow, bail};
use core::fmt::Write;
use linestereo::{Params, results::Rejection};
use linestereo_frames::{PairFiles, StoredPair};
use linestereo_recordings::Footage;
use std::path::PathBuf;

/// Match one rectified pair: segments and points with disparity, depth and a probability each.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/run.txt"))]
pub struct Args {
    /// Left image, the reference: PNG, JPEG, PGM, PPM, TIFF, BMP or WebP, 8 or 16 bit, grey or
    /// colour.
    left: PathBuf,
    /// Right image of the same size.
    #[arg(required_unless_present = "side_by_side")]
    right: Option<PathBuf>,
    /// The file holds both images side by side: left | right.
    #[arg(long, conflicts_with = "right")]
    side_by_side: bool,
    /// Print the depth of this pixel of the (rectified) left image before --width; may be given
    /// several times.
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    query: Vec<(u16, u16)>,
    /// Write segments, points and counts as JSON; "-" is stdout.
    #[arg(long, value_name = "FILE")]
    json: Option<OutputPath>,
    /// Write the segments as CSV.
    #[arg(long, value_name = "FILE")]
    csv: Option<OutputPath>,
    /// Write points and segments in metres as PLY, coloured by disparity (MeshLab, CloudCompare);
    /// needs a rig.
    #[arg(long, value_name = "FILE.ply")]
    ply: Option<OutputPath>,
    /// The same without the segments' lines as PCD (PCL, ROS, Open3D).
    #[arg(long, value_name = "FILE.pcd")]
    pcd: Option<OutputPath>,
    /// Write the points as a depth image: 16-bit PNG, mm, 0 = none (RealSense, ROS, Open3D); needs
    /// a rig.
    #[arg(long, value_name = "FILE.png")]
    depth_png: Option<OutputPath>,
    /// Write the points as a depth image: NumPy array of 32-bit floats, m, not a number = none;
    /// needs a rig.
    #[arg(long, value_name = "FILE.npy")]
    depth_npy: Option<OutputPath>,
    /// Write the points as a disparity map of KITTI: 16-bit PNG, px * 256, 0 = none.
    #[arg(long, value_name = "FILE.png")]
    disparity_png: Option<OutputPath>,
    /// Write the points as a disparity map of Middlebury: PFM, px, infinity = none.
    #[arg(long, value_name = "FILE.pfm")]
    pfm: Option<OutputPath>,
    /// Draw the segments over the left image, red near to blue far, as PNG; where a floor is found,
    /// it is pale and what lies below it magenta.
    #[arg(long, value_name = "FILE.png")]
    overlay: Option<OutputPath>,
    /// Write the objects as CSV.
    #[arg(long, value_name = "FILE", requires = "objects")]
    objects_csv: Option<OutputPath>,
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    objects: ObjectArgs,
    #[command(flatten)]
    sectors: SectorArgs,
}

pub(super) fn pixel(text: &str) -> Result<(u16, u16), &'static str> {
    position(text).map(<[u16; 2]>::into).ok_or("give a column and a row, such as 160,120")
}

pub fn run(args: &Args) -> Result<()> {
    args.sectors.check()?;
    let left = args.left.clone();
    let files = args
        .right
        .clone()
        .map_or(PairFiles::SideBySide(left.clone()), |right| PairFiles::Two([left, right]));
    let given = StoredPair::alone(String::new(), files);
    let asked = args.objects.open(&args.left, &Footage::of_pair(given.clone()))?;
    let known = args.input.known_of(&given)?;
    let pair = args.input.load_as(&given.images, &known)?;
    let setup = args.input.setup_as(&pair, &known)?;
    let (max_disparity, rig) = (setup.params.max_disparity, setup.params.rig);
    let mut matcher = PairMatcher::new(&setup)?;
    matcher.engine.areas = asked.areas(&setup, &given);
    let TimedResult { images: [left, _], result, seconds } = matcher.run(&setup, &pair, None)?;
    let objects = asked.depths(&setup, &given, &mut matcher.engine);
    let queries = (!args.query.is_empty()).then(|| matcher.ask(&setup, &args.query));
    let directions = args.sectors.directions(&setup, &result)?;
    let sectors = directions.as_ref().filter(|_| args.sectors.sectors);
    let ground = result.ground.map(|plane| Ground::new(plane, setup.geometry(), left.dims));
    let answers = Answers {
        queries,
        ground,
        sectors: sectors.map(Directions::list),
        ..Asked::answers(objects.as_ref())
    };
    let mut output = OutputFiles::new();
    output.add_made(args.json.as_ref(), || Ok(listing::json(left.dims, &result, &answers)?))?;
    output.add_made(args.csv.as_ref(), || Ok(listing::csv(&result)))?;
    let overlay = || draw::overlay(&left, &result, rig.as_ref(), max_disparity);
    output.add_made(args.overlay.as_ref(), || Ok(draw::png(&overlay())?))?;
    if let Some(list) = &answers.objects {
        output.add_made(args.objects_csv.as_ref(), || Ok(listing::objects_csv(list)))?;
    }
    if let Some(directions) = &directions {
        output.add_made(args.sectors.fan.as_ref(), || Ok(draw::png(&draw::fan(directions))?))?;
        output.add_made(args.sectors.mavlink.as_ref(), || {
            Ok(directions.mavlink(args.sectors.policy.into()))
        })?;
    }
    let notes = export_files(args, &setup, &result, &mut output)?;
    let before = scene_note(&setup) + &summary(&setup, &result, seconds);
    let mut results = objects.as_ref().map_or(String::new(), Asked::summary);
    results.extend(answers.queries.iter().flatten().map(Query::summary));
    results.push_str(&sectors.map(Directions::table).unwrap_or_default());
    let lists = [&args.json, &args.csv, &args.objects_csv, &args.ply, &args.pcd];
    let maps = [&args.depth_png, &args.depth_npy, &args.disparity_png, &args.pfm, &args.overlay];
    let sectors = [&args.sectors.fan, &args.sectors.mavlink];
    let after = notes + &written(lists.into_iter().chain(maps).chain(sectors));
    output.commit_and_tell(&before, &results, &after)?;
    // The other results are written by now.
    if let Some(error) = objects.and_then(|objects| objects.error) {
        bail!("{error}");
    }
    // In and around objects there may be nothing.
    let refusal = setup
        .refusal(&result)
        .filter(|_| !args.objects.is_only() || !health::is_fit(result.health));
    refusal.map_or(Ok(()), |why| Err(anyhow!("{why}")))
}

/// Files of other programs; what they could not hold, in words.
fn export_files(
    args: &Args,
    setup: &Setup<'_>,
    result: &FrameResult,
    output: &mut OutputFiles,
) -> Result<String> {
    let dims = setup.dims();
    let mut notes = String::new();
    let colours = ColourRange::of(result, setup.params.max_disparity);
    let geometry = |what: &str| setup.geometry().ok_or_else(|| setup.lacks(what));
    let rig = |what: &str| setup.params.rig.as_ref().ok_or_else(|| setup.lacks(what));
    let mut png = |map: PngMap, what: &str| {
        if map.left_out > 0 {
            let _ = writeln!(notes, "{} points are not in the {what}", map.left_out);
        }
        map.png
    };
    output.add_made(args.ply.as_ref(), || Ok(draw::ply(result, geometry("--ply")?, &colours)))?;
    output.add_made(args.pcd.as_ref(), || Ok(draw::pcd(result, geometry("--pcd")?, &colours)))?;
    output.add_made(args.depth_png.as_ref(), || {
        Ok(png(
            results::depth_png(dims, result, rig("--depth-png")?)?,
            "depth PNG: beyond 65.535 m",
        ))
    })?;
    output.add_made(args.depth_npy.as_ref(), || {
        Ok(results::depth_npy(dims, result, rig("--depth-npy")?))
    })?;
    output.add_made(args.disparity_png.as_ref(), || {
        Ok(png(results::kitti_png(dims, result)?, "disparity PNG: below 0, or 256 px and more"))
    })?;
    output.add_made(args.pfm.as_ref(), || Ok(results::pfm(dims, result)))?;
    Ok(notes)
}

/// Depth of the largest disparity that is found, m; `None` without a rig.
fn nearest_metres(params: &Params) -> Option<f64> {
    let largest = Params::largest_disparity(params.max_disparity);
    params.rig.and_then(|rig| listing::finite_metres(rig.depth(largest)))
}

fn summary(setup: &Setup<'_>, result: &FrameResult, seconds: f64) -> String {
    let (dims, params, counts) = (setup.dims(), &setup.params, &result.counts);
    let max_disparity = params.max_disparity;
    let mut text = format!(
        "{dims}, disparities below {max_disparity}: {} of {} segments matched, {} points, {:.1} ms\n",
        counts.matched,
        counts.segments_left,
        counts.points,
        1e3 * seconds
    );
    let shares = [0.98, 0.95, 0.9, 0.8].map(|least| {
        let segments =
            result.matches.iter().filter(|found| found.confidence.to_num::<f64>() >= least).count();
        let points =
            result.points.iter().filter(|point| point.confidence.to_num::<f64>() >= least).count();
        format!("  p >= {least:.2}: {segments:4} segments, {points:6} points\n")
    });
    text.push_str(&shares.concat());
    let disparities = || result.points.iter().map(|point| point.disparity);
    if let (Some(rig), Some(most), Some(least)) =
        (params.rig, disparities().max(), disparities().min())
    {
        let metres = |depth| {
            listing::finite_metres(depth).map_or("infinity".to_owned(), |m| format!("{m:.2} m"))
        };
        let [nearest, farthest] = [most, least].map(|disparity| metres(rig.depth(disparity)));
        let _ = writeln!(text, "depths from {nearest} to {farthest}");
    }
    if let Some(nearest) = nearest_metres(params) {
        let _ = writeln!(
            text,
            "nothing nearer than {nearest:.2} m is measured: --nearest or --max-disparity \
             changes that"
        );
    }
    let mut lost: Vec<_> =
        Rejection::ALL.map(|reason| (counts.rejected(reason), reason.name())).into();
    lost.retain(|&(count, _)| count > 0);
    lost.sort_by_key(|&(count, _)| core::cmp::Reverse(count));
    if !lost.is_empty() {
        let list: Vec<String> =
            lost.iter().map(|(count, name)| format!("{name} {count}")).collect();
        let _ = writeln!(text, "rejected: {}", list.join(", "));
    }
    if let Some(plane) = result.ground {
        text.push_str(&Ground::new(plane, setup.geometry(), dims).summary());
    }
    text.push_str(&health::summary(result));
    text
}
