//! `linestereo demo`: the core on a synthetic room with exact truth. Also what the program does without arguments.

use super::engine_for;
use super::scene::parse_noise;
use crate::draw;
use crate::engine::FrameResult;
use crate::evaluate::{FrameScore, OwnedMiddle, Summary};
use crate::input::Truth;
use crate::output::{OutputFiles, OutputPath};
use crate::scene::{self, Kind, Rendering, Scene, Sensor};
use anyhow::Result;
use core::fmt::Write;
use linestereo::{Depth, Dims, INFINITE_DEPTH, Match, Rejection};
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
    let room = scene::build(Kind::Demo, DIMS, args.seed);
    let sensor = Sensor { noise: args.noise, seed: args.seed, ..Sensor::default() };
    let rendering = scene::render(&room, DIMS, &sensor);
    let max_disparity = scene::search_range(&rendering);
    let rig = room.pair.rig()?;
    let mut engine = engine_for(max_disparity, Some(rig), DIMS)?;
    let result = engine.run(rendering.left.view()?, rendering.right.view()?)?;

    let picture = draw::png(&draw::overlay(&rendering.left, &result, Some(&rig), max_disparity))?;
    let mut output = OutputFiles::new();
    output.add(&args.out, &picture)?;

    let mut text = format!(
        "A synthetic room with exact truth, {DIMS}, f = {} px, B = {} m, disparities 0 to {} px.\n\
         The most probable segment of each object, at its middle:\n\n",
        room.pair.focal_px,
        room.pair.baseline_m,
        max_disparity - 1,
    );
    let truth = truth_of(&rendering);
    text.push_str(&object_table(&room, &rendering, &truth, &result));
    text.push_str(&summary(&truth, &result));
    let _ = writeln!(text, "\nPicture: {} (red near, blue far)", args.out.display());
    text.push_str(
        "Your own rectified pair: linestereo run LEFT RIGHT --overlay depth.png; everything else: linestereo --help\n",
    );
    output.commit_and_say(&text)
}

/// The truth of a rendering.
fn truth_of(rendering: &Rendering) -> Truth {
    Truth::new(rendering.left.dims, rendering.disparity.clone(), rendering.visible.clone())
}

fn object_table(room: &Scene, rendering: &Rendering, truth: &Truth, result: &FrameResult) -> String {
    let mut text =
        "object         segments   disparity     true    error      depth      true   probability\n".to_owned();
    for (object, label) in room.objects.iter().zip(1_u8..) {
        // Matches are listed the most confident first.
        let of_object = result.matches.iter().filter_map(|segment| {
            let middle = OwnedMiddle::new(segment);
            (rendering.label(middle.pixel) == Some(label)).then_some((segment, middle.disparity, middle.error(truth)?))
        });
        let mut of_object = of_object.peekable();
        let first = of_object.peek().copied();
        let _ = write!(text, "{object:<14} {:8}", of_object.count());
        let Some((segment, disparity, error)) = first else {
            text.push_str("   none that is credible\n");
            continue;
        };
        let _ = writeln!(
            text,
            "{disparity:9.2} px {:5.2} px {error:+8.2} {:>10} {:7.2} m {:13.3}",
            disparity - error,
            segment.depth.map_or_else(|| "-".to_owned(), |[near, far]| middle_depth(near, far)),
            room.pair.depth(disparity - error),
            segment.confidence.to_num::<f64>(),
        );
    }
    text
}

/// Depth in the middle of a straight segment: 1/z is linear along its image.
fn middle_depth(first: Depth, last: Depth) -> String {
    if first == INFINITE_DEPTH || last == INFINITE_DEPTH {
        return "infinite".to_owned();
    }
    let [first, last] = [first, last].map(|depth| depth.to_num::<f64>());
    format!("{:.2} m", 2.0 / (1.0 / first + 1.0 / last))
}

/// Share of the segments with truth whose owner's surface is at most this far from their disparity, percent.
fn share_within(limit: f64, truth: &Truth, segments: &[Match]) -> Option<f64> {
    let errors: Vec<f64> = segments.iter().filter_map(|segment| OwnedMiddle::new(segment).error(truth)).collect();
    let within = errors.iter().filter(|error| error.abs() <= limit).count();
    (!errors.is_empty()).then(|| 100.0 * within as f64 / errors.len() as f64)
}

fn summary(truth: &Truth, result: &FrameResult) -> String {
    let summary = Summary::pool([&FrameScore::new("demo", truth, result)]);
    let number = |value: Option<f64>, unit: &str| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.2}{unit}"));
    let counts = &result.counts;
    let mut text = String::from("\n");
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
