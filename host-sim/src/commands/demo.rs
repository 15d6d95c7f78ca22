//! `linestereo demo`: the core on a synthetic room with exact truth. Also what the program does without arguments.

use super::engine_for;
use super::scene::parse_noise;
use crate::draw;
use crate::engine::FrameResult;
use crate::evaluate::{
    FrameScore, ObjectCase, ObjectScore, ObjectSummary, Outline, OwnedMiddle, Summary, score_objects,
};
use crate::input::Truth;
use crate::output::{OutputFiles, OutputPath};
use crate::scene::{self, Kind, Rendering, Scene, Sensor};
use anyhow::Result;
use core::fmt::Write;
use linestereo::{Dims, Match, Rejection, Rig};
use linestereo_baselines::GrayImage;
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

/// The room, matched and scored.
#[derive(Clone, Debug)]
pub struct Demonstration {
    /// The table of objects, and the summary.
    pub text: String,
    /// The answer about each object in view, in the order of the table.
    pub objects: Vec<ObjectScore>,
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
        let objects = score_objects(&mut engine, &object_cases(&room, &rendering, &truth));
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

/// A line an object. True is the range of its pixels without the 5 % at either end, by which answers are scored.
fn object_table(room: &Scene, objects: &[ObjectScore]) -> String {
    let mut text =
        "object         disparity          true, 5 to 95 %       depth            true   probability\n".to_owned();
    for object in objects {
        let _ = write!(text, "{:<14}", object.name);
        if let Some(reason) = object.refused {
            let _ = writeln!(text, "   no depth: {reason}");
            continue;
        }
        let (low, high) = object.range;
        let [depth, near, far] = [object.disparity, high, low].map(|disparity| room.pair.depth(disparity.into()));
        let _ = writeln!(
            text,
            " {:6.2} px   {low:6.2} to {high:5.2} px{}   {depth:6.2} m   {near:5.2} to {far:.2} m {:13.3}",
            object.disparity,
            if object.wrong { ", wrong" } else { "       " },
            object.confidence,
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

fn summary(objects: &[ObjectScore], truth: &Truth, result: &FrameResult) -> String {
    let of_objects = ObjectSummary::pool(Outline::Given, objects);
    let summary = Summary::pool([&FrameScore::new("demo", truth, result)]);
    let number = |value: Option<f64>, unit: &str| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.2}{unit}"));
    let counts = &result.counts;
    let mut text = String::from("\n");
    let _ = writeln!(
        text,
        "Objects:  {} of {} have a depth; {} of them more than 1 px outside of what is true of the object",
        of_objects.covered, of_objects.objects, of_objects.wrong,
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
