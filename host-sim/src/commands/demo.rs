//! `linestereo demo`: the core on a synthetic room with exact truth. Also what the program does without arguments.

use super::engine_for;
use super::scene::parse_noise;
use crate::draw;
use crate::engine::FrameResult;
use crate::evaluate::{FrameScore, ObjectCase, ObjectScore, OwnedMiddle, Summary, score_objects};
use crate::output::{OutputFiles, OutputPath};
use crate::scene::{self, Kind, Rendering, Scene, Sensor};
use anyhow::Result;
use core::fmt::Write;
use linestereo::{Dims, Match, Rejection, Rig};
use linestereo_frames::GrayImage;
use linestereo_frames::Truth;
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
    /// Standard deviation of the noise in both images, in grey levels.
    #[arg(long, value_name = "SIGMA", default_value_t = NOISE, allow_negative_numbers = true, value_parser = parse_noise)]
    noise: f64,
}

impl Default for Args {
    fn default() -> Self {
        Self { out: OsString::from(PICTURE).into(), seed: SEED, noise: NOISE }
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let shown = Demonstration::new(args.seed, args.noise)?;
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

/// The answer about an object, and what is true where it is said to hold.
#[derive(Clone, Debug)]
pub struct RoomObject {
    /// The answer, scored by the range of the object's disparities.
    pub score: ObjectScore,
    /// True disparity at the object's centre, px.
    pub true_at_centre: f32,
}

impl RoomObject {
    /// True for an answer more than 1 px off at the object's centre, or outside of its range.
    #[must_use]
    pub fn is_wrong(&self) -> bool {
        self.score.wrong || (self.score.disparity - self.true_at_centre).abs() > 1.0
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
    /// Renders the room of a seed with noise of this standard deviation in grey levels, and matches it.
    pub fn new(seed: u64, noise: f64) -> Result<Self> {
        let room = scene::build(Kind::Demo, DIMS, seed);
        let sensor = Sensor { noise, seed, ..Sensor::default() };
        let rendering = scene::render(&room, DIMS, &sensor);
        let max_disparity = scene::search_range(&rendering);
        let rig = room.pair.rig()?;
        let mut engine = engine_for(max_disparity, Some(rig), DIMS)?;
        let result = engine.run(rendering.left.view()?, rendering.right.view()?)?;

        let truth = Truth::new(DIMS, rendering.disparity.clone(), rendering.visible.clone());
        let cases = object_cases(&room, &rendering, &truth);
        let scored = score_objects(&mut engine, &cases).into_iter().zip(&cases);
        let objects: Vec<RoomObject> =
            scored.map(|(score, case)| RoomObject { score, true_at_centre: case.true_at_centre() }).collect();
        let mut text = format!(
            "A synthetic room with exact truth, {DIMS}, f = {} px, B = {} m, disparities 0 to {} px.\n\
             The depth of each object, told its pixels as by a detector:\n\n",
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
        Ok(draw::png(&draw::overlay(&self.left, &self.result, Some(&self.rig), self.max_disparity))?)
    }
}

/// Every object in view, told the core by its pixels.
fn object_cases(room: &Scene, rendering: &Rendering, truth: &Truth) -> Vec<ObjectCase> {
    let of_label = |(name, label): (&&str, u8)| {
        let pixels = rendering.labels.iter().map(|&at| at == label).collect();
        ObjectCase::of_mask(name, label.into(), pixels, DIMS, truth)
    };
    room.objects.iter().zip(1_u8..).filter_map(of_label).collect()
}

/// A line an object: its depth at its centre, and the truth there; beside it the range of its pixels without the 5 % at either end.
fn object_table(room: &Scene, objects: &[RoomObject]) -> String {
    let mut text =
        "object         disparity   true at centre        5 to 95 %              depth     true   probability\n"
            .to_owned();
    for object in objects {
        let RoomObject { score, true_at_centre } = object;
        let _ = write!(text, "{:<14}", score.name);
        if let Some(reason) = score.refused {
            let _ = writeln!(text, "   no depth: {reason}");
            continue;
        }
        let (low, high) = score.range;
        let [depth, truth] = [score.disparity, *true_at_centre].map(|disparity| room.pair.depth(disparity.into()));
        let _ = writeln!(
            text,
            " {:6.2} px   {true_at_centre:6.2} px{}   {low:6.2} to {high:5.2} px {depth:12.2} m {truth:6.2} m {:13.3}",
            score.disparity,
            if object.is_wrong() { ", wrong" } else { "       " },
            score.confidence,
        );
    }
    text
}

/// Share of the segments with truth whose owner's surface is at most this far from their disparity, percent.
fn share_within(limit: f64, truth: &Truth, segments: &[Match]) -> Option<f64> {
    let errors: Vec<f64> = segments.iter().filter_map(|segment| OwnedMiddle::new(segment).error(truth)).collect();
    let within = errors.iter().filter(|error| error.abs() <= limit).count();
    (!errors.is_empty()).then(|| 100.0 * within as f64 / errors.len() as f64)
}

fn summary(objects: &[RoomObject], truth: &Truth, result: &FrameResult) -> String {
    let count = |is: &dyn Fn(&RoomObject) -> bool| objects.iter().filter(|object| is(object)).count();
    let summary = Summary::pool([&FrameScore::new("demo", truth, result)]);
    let number = |value: Option<f64>, unit: &str| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.2}{unit}"));
    let counts = &result.counts;
    let mut text = String::from("\n");
    let _ = writeln!(
        text,
        "Objects:  {} of {} have a depth; {} of them more than 1 px off at the object's centre, or outside of its range",
        count(&|object| object.score.refused.is_none()),
        objects.len(),
        count(&RoomObject::is_wrong),
    );
    let _ = writeln!(
        text,
        "Segments: {} matched of {}; {} within 1 px of the surface that they are of, {} within 2 px",
        counts.matched,
        counts.segments_left,
        number(share_within(1.0, truth, &result.matches), " %"),
        number(share_within(2.0, truth, &result.matches), " %"),
    );
    let _ = writeln!(
        text,
        "Points:   {}; median error {}, RMS {}; more than 1 px off: {} of those visible in both images, {} of all",
        counts.points,
        number(summary.median_error_px, " px"),
        number(summary.rms_error_px, " px"),
        number(summary.all.errors.vis_bad1, " %"),
        number(summary.all.errors.all_gt_bad1, " %"),
    );
    let reasons: Vec<String> = Rejection::ALL
        .into_iter()
        .filter(|&reason| counts.rejected(reason) > 0)
        .map(|reason| format!("{} {}", counts.rejected(reason), reason.name().replace('_', " ")))
        .collect();
    let _ = writeln!(text, "Rejected: {}", if reasons.is_empty() { "none".to_owned() } else { reasons.join(", ") });
    text
}
