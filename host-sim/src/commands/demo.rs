//! `linestereo demo`: the core on a synthetic room with exact truth. Also what the program does
//! without arguments.

use super::engine_with;
use crate::draw;
use crate::engine::{Engine, FrameResult};
use crate::output::{OutputFiles, OutputPath};
use crate::results::mask::Mask;
use crate::scene::{self, Kind, Rendering, Scene, Sensor};
use anyhow::Result;
use core::fmt::Write;
use linestereo::{Dims, Params, Region, Rig, objects::Reason, results::Rejection};
use linestereo_frames::statistics::{interpolated_quantile, median};
use linestereo_frames::{GrayImage, Truth};
use std::ffi::OsString;

const DIMS: Dims = Dims { width: 320, height: 240 };
const PICTURE: &str = "linestereo-demo.png";
const SEED: u64 = 1;
/// Noise of an ordinary sensor, in grey levels.
const NOISE: f64 = 1.0;

/// Render a small room with exact ground truth, match it, and show how good the depths are.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Where to write the picture of the segments.
    #[arg(long, value_name = "FILE.png", default_value = PICTURE)]
    out: OutputPath,
    /// Seed of textures and noise.
    #[arg(long, value_name = "N", default_value_t = SEED)]
    seed: u64,
}

impl Default for Args {
    fn default() -> Self {
        Self { out: OsString::from(PICTURE).into(), seed: SEED }
    }
}

pub fn run(args: &Args) -> Result<()> {
    let shown = Demonstration::new(args.seed)?;
    let picture = shown.picture()?;
    let mut text = shown.text;
    let mut output = OutputFiles::new();
    output.add(&args.out, &picture)?;
    let _ = writeln!(text, "\nPicture: {} (red near, blue far)", args.out.display());
    text.push_str(
        "Your own rectified pair: linestereo run LEFT RIGHT --overlay depth.png; everything else: linestereo --help\n",
    );
    output.commit_and_say(&text)
}

/// An object of the room: the answer about it, and the truth.
#[derive(Clone, Debug)]
pub struct RoomObject {
    pub name: String,
    /// Its disparity, px, and the probability that this is right; or why there is none.
    pub answer: Result<(f32, f32), Reason>,
    /// True disparity of the pixel with truth that is nearest to its centre, px.
    pub true_at_centre: f32,
    /// 5 % and 95 % of its true disparities, px.
    pub range: [f32; 2],
}

impl RoomObject {
    /// True for an answer more than 1 px off at the object's centre, or outside of its range by as
    /// much.
    pub fn is_wrong(&self) -> bool {
        let [low, high] = self.range;
        self.answer.is_ok_and(|(disparity, _)| {
            (disparity - self.true_at_centre).abs() > 1.0
                || low - disparity > 1.0
                || disparity - high > 1.0
        })
    }
}

/// The room, matched and scored.
#[derive(Clone, Debug)]
pub struct Demonstration {
    /// The table of objects, and the summary.
    pub text: String,
    /// The answer about each object in view, in the order of the table.
    pub objects: Vec<RoomObject>,
    left: GrayImage,
    result: FrameResult,
    rig: Rig,
    max_disparity: u16,
}

impl Demonstration {
    /// Renders the room of a seed, and matches it.
    pub fn new(seed: u64) -> Result<Self> {
        let room = scene::build(Kind::Demo, DIMS, seed);
        let sensor = Sensor { noise: NOISE, seed, ..Sensor::default() };
        let rendering = scene::render(&room, DIMS, &sensor);
        let max_disparity = rendering.search_range();
        let rig = room.pair.rig()?;
        let params = Params { max_disparity, rig: Some(rig), ..Params::default() };
        let mut engine = engine_with(&params, DIMS)?;
        let result = engine.run(rendering.left.view()?, rendering.right.view()?)?;

        let truth = Truth::new(DIMS, rendering.disparity.clone(), rendering.visible.clone());
        let objects = objects(&room, &rendering, &truth, &mut engine);
        let mut text = format!(
            "A synthetic room with exact truth, {DIMS}, f = {} px, B = {} m, disparities 0 to {} px.\n\
             The depth of each object, from its pixels, as a detector would give them:\n\n",
            room.pair.focal_px,
            room.pair.baseline_m,
            max_disparity - 1,
        );
        text.push_str(&object_table(&room, &objects));
        text.push_str(&summary(&objects, &truth, &result));
        Ok(Self { text, objects, left: rendering.left, result, rig, max_disparity })
    }

    /// The segments over the left image, as a PNG.
    fn picture(&self) -> Result<Vec<u8>> {
        Ok(draw::png(&draw::overlay(
            &self.left,
            &self.result,
            Some(&self.rig),
            self.max_disparity,
        ))?)
    }
}

/// Every object in view, told the core by its pixels.
fn objects(
    room: &Scene,
    rendering: &Rendering,
    truth: &Truth,
    engine: &mut Engine,
) -> Vec<RoomObject> {
    let width = usize::from(DIMS.width);
    let mut found = Vec::new();
    for (name, label) in room.objects.iter().zip(1_u8..) {
        let mask = Mask::new(DIMS, rendering.labels.iter().map(|&at| at == label).collect());
        let own = mask.pixels().iter().enumerate().filter(|(_, is_own)| **is_own);
        let own: Vec<[i32; 2]> =
            own.map(|(i, _)| [i % width, i / width].map(|at| at as i32)).collect();
        let known = || own.iter().filter_map(|&[x, y]| Some(([x, y], truth.disparity(x, y)?)));
        let [x0, y0] =
            [0, 1].map(|axis| own.iter().map(|at| at[axis]).sum::<i32>() / own.len().max(1) as i32);
        let Some((_, true_at_centre)) =
            known().min_by_key(|([x, y], _)| (x - x0).pow(2) + (y - y0).pow(2))
        else {
            continue;
        };
        let mut values: Vec<f32> = known().map(|(_, disparity)| disparity).collect();
        values.sort_by(f32::total_cmp);
        let range = [0.05, 0.95]
            .map(|share| interpolated_quantile(&values, share).unwrap_or(true_at_centre));
        let runs = mask.runs(label.into());
        let region = Region::masked(label.into(), &runs, DIMS).ok();
        let answer = match region.map(|region| engine.object(&region)) {
            Some(Ok(object)) => Ok((object.disparity.to_num(), object.confidence.to_num())),
            Some(Err(why)) => Err(why.reason),
            None => Err(Reason::LittleSupport),
        };
        found.push(RoomObject { name: (*name).to_owned(), answer, true_at_centre, range });
    }
    found
}

/// A line an object: its depth at its centre, and the truth there; beside it the range of its
/// pixels without the 5 % at either end.
fn object_table(room: &Scene, objects: &[RoomObject]) -> String {
    let mut text =
        "object         disparity   true at centre        5 to 95 %              depth     true   probability\n"
            .to_owned();
    for object in objects {
        let RoomObject { name, answer, true_at_centre, range: [low, high] } = object;
        let _ = write!(text, "{name:<14}");
        let (disparity, probability) = match answer {
            Ok(answer) => *answer,
            Err(reason) => {
                let _ = writeln!(text, "   no depth: {reason}");
                continue;
            }
        };
        let [depth, truth] =
            [disparity, *true_at_centre].map(|disparity| room.pair.depth(disparity.into()));
        let _ = writeln!(
            text,
            " {disparity:6.2} px   {true_at_centre:6.2} px{}   {low:6.2} to {high:5.2} px {depth:12.2} m {truth:6.2} m {probability:13.3}",
            if object.is_wrong() { ", wrong" } else { "       " },
        );
    }
    text
}

fn summary(objects: &[RoomObject], truth: &Truth, result: &FrameResult) -> String {
    let count =
        |is: &dyn Fn(&RoomObject) -> bool| objects.iter().filter(|object| is(object)).count();
    let number = |value: Option<f64>, unit: &str| {
        value.map_or_else(|| "-".to_owned(), |v| format!("{v:.2}{unit}"))
    };
    let errors = |only_visible: bool| -> Vec<f32> {
        let pixels =
            result.points.iter().map(|point| (i32::from(point.x), i32::from(point.y), point));
        let pixels = pixels.filter(|&(x, y, _)| !only_visible || truth.is_visible(x, y));
        pixels
            .filter_map(|(x, y, point)| {
                Some((point.disparity.to_num::<f32>() - truth.disparity(x, y)?).abs())
            })
            .collect()
    };
    let off = |errors: &[f32]| {
        let count = errors.iter().filter(|&&error| error > 1.0).count();
        (!errors.is_empty()).then(|| 100.0 * count as f64 / errors.len() as f64)
    };
    let (visible, all) = (errors(true), errors(false));
    let counts = &result.counts;
    let mut text = String::from("\n");
    let _ = writeln!(
        text,
        "Objects:  {} of {} have a depth; {} of them more than 1 px off at the object's centre, or outside of its range",
        count(&|object| object.answer.is_ok()),
        objects.len(),
        count(&RoomObject::is_wrong),
    );
    let _ = writeln!(text, "Segments: {} matched of {}", counts.matched, counts.segments_left);
    let _ = writeln!(
        text,
        "Points:   {}; median error {}; more than 1 px off: {} of those visible in both images, {} of all",
        counts.points,
        number(median(visible.clone(), f32::total_cmp).map(f64::from), " px"),
        number(off(&visible), " %"),
        number(off(&all), " %"),
    );
    let reasons: Vec<String> = Rejection::ALL
        .into_iter()
        .filter(|&reason| counts.rejected(reason) > 0)
        .map(|reason| format!("{} {}", counts.rejected(reason), reason.name().replace('_', " ")))
        .collect();
    let reasons = if reasons.is_empty() { "none".to_owned() } else { reasons.join(", ") };
    let _ = writeln!(text, "Rejected: {reasons}");
    text
}
