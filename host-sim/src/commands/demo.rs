//! `linestereo demo`: the core on a synthetic room with exact truth. Also what the program does without arguments.

use super::engine_for;
use super::scene::parse_noise;
use crate::draw;
use crate::engine::FrameResult;
use crate::evaluate::{FrameScore, Summary};
use crate::input::Truth;
use crate::output::{OutputFiles, OutputPath};
use crate::scene::{self, Kind, Rendering, Scene, Sensor};
use anyhow::Result;
use core::fmt::Write;
use linestereo::{Depth, Dims, INFINITE_DEPTH, Match, Owner, Rejection};
use std::ffi::OsString;

const DIMS: Dims = Dims { width: 320, height: 240 };
const PICTURE: &str = "linestereo-demo.png";
const SEED: u64 = 1;
/// Noise of an ordinary sensor, in grey levels.
const NOISE: f64 = 1.0;
/// A segment with `|dx|` above this many times `|dy|` is near-horizontal.
const STEEP_LIMIT: f64 = 4.0;
/// How far from the edge, in px, the owning side's surface is looked up: beyond the pixels that hold both surfaces.
const BESIDE: f64 = 1.5;

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
    text.push_str(&object_table(&room, &rendering, &result));
    text.push_str(&summary(&rendering, &result));
    let _ = writeln!(text, "\nPicture: {} (red near, blue far)", args.out.display());
    text.push_str(
        "Your own rectified pair: linestereo run LEFT RIGHT --overlay depth.png; everything else: linestereo --help\n",
    );
    output.commit_and_say(&text)
}

/// A segment at its middle, beside what is true of the surface it is said to belong to.
struct Sample {
    label: u8,
    disparity: f64,
    true_disparity: f64,
}

impl Sample {
    /// `None` where the owning side's pixel is outside the image.
    fn new(rendering: &Rendering, segment: &Match) -> Option<Self> {
        let [[x0, y0], [x1, y1]] = segment.ends.map(|end| [end.x.to_num::<f64>(), end.y.to_num::<f64>()]);
        let [d0, d1] = segment.disparity.map(|disparity| disparity.to_num::<f64>());
        let beside = if segment.owner == Owner::Right { BESIDE } else { -BESIDE };
        let near_horizontal = (x1 - x0).abs() > STEEP_LIMIT * (y1 - y0).abs();
        let (dx, dy) = if near_horizontal { (0.0, beside) } else { (beside, 0.0) };
        let (x, y) = ((0.5 * (x0 + x1) + dx).round(), (0.5 * (y0 + y1) + dy).round());
        let Dims { width, height } = rendering.left.dims;
        if !(0.0..f64::from(width)).contains(&x) || !(0.0..f64::from(height)).contains(&y) {
            return None;
        }
        let index = y as usize * usize::from(width) + x as usize;
        let true_disparity = f64::from(rendering.disparity[index]);
        Some(Self { label: rendering.labels[index], disparity: 0.5 * (d0 + d1), true_disparity })
    }
}

fn object_table(room: &Scene, rendering: &Rendering, result: &FrameResult) -> String {
    let samples: Vec<(&Match, Sample)> =
        result.matches.iter().filter_map(|segment| Some((segment, Sample::new(rendering, segment)?))).collect();
    let mut text =
        "object         segments   disparity     true    error      depth      true   probability\n".to_owned();
    for (object, label) in room.objects.iter().zip(1_u8..) {
        let of_object = || samples.iter().filter(|(_, sample)| sample.label == label);
        let _ = write!(text, "{object:<14} {:8}", of_object().count());
        // Matches are listed the most confident first.
        let Some((segment, sample)) = of_object().next() else {
            text.push_str("   none that is credible\n");
            continue;
        };
        let _ = writeln!(
            text,
            "{:9.2} px {:5.2} px {:+8.2} {:>10} {:7.2} m {:13.3}",
            sample.disparity,
            sample.true_disparity,
            sample.disparity - sample.true_disparity,
            segment.depth.map_or_else(|| "-".to_owned(), |[near, far]| middle_depth(near, far)),
            room.pair.depth(sample.true_disparity),
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

fn summary(rendering: &Rendering, result: &FrameResult) -> String {
    let truth = Truth::new(rendering.left.dims, rendering.disparity.clone(), rendering.visible.clone());
    let summary = Summary::pool([&FrameScore::new("demo", &truth, result)]);
    let number = |value: Option<f64>, unit: &str| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.2}{unit}"));
    let counts = &result.counts;
    let mut text = String::from("\n");
    let _ = writeln!(
        text,
        "Segments: {} matched of {}; {} within 1 px of the truth, {} within 2 px",
        counts.matched,
        counts.segments_left,
        number(summary.segprec1, " %"),
        number(summary.segprec2, " %"),
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
