//! `linestereo quality`: depth quality on a flat wall.

use super::arguments::number_in;
use super::input::{InputArgs, Setup};
use super::pairs::{has_ended, named_bar, pairs_of, scene_note, video_note};
use super::player::Player;
use super::{asked_for, written};
use crate::draw;
use crate::output::{OutputFiles, OutputPath, spare};
use crate::quality::{Quality, Wall, WallFigures};
use crate::results::health;
use anyhow::{Context, Result, bail};
use core::fmt::Write;
use linestereo::{Area, Dims};
use linestereo_frames::StoredPair;
use linestereo_wire::Health;
use serde_json::json;
use std::path::PathBuf;

/// Measure depth quality on a flat wall, as RealSense's tool does: accuracy, noise, fill rate, with
/// advice.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/quality.txt"))]
pub struct Args {
    /// Left image or video; or a folder with a pair or a sequence, a recording (.mcap), or a video
    /// with both views side by side.
    left: PathBuf,
    /// Right image or video.
    right: Option<PathBuf>,
    /// Both images of a pair stand side by side in one file: left | right.
    #[arg(long, conflicts_with = "right")]
    side_by_side: bool,
    /// Part of the (rectified) left image that shows only the wall, px before --width [default:
    /// the middle 40 % of both sides].
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_region)]
    region: Option<[u16; 4]>,
    /// Depth of the wall in the middle of the region, from the left camera, along the direction in
    /// which the cameras look.
    #[arg(long, value_name = "M",
          value_parser = number_in(0.01..=1000.0, "give 0.01 to 1000 metres"))]
    distance: Option<f64>,
    /// Write the figures as JSON; "-" is stdout.
    #[arg(long, value_name = "FILE")]
    json: Option<OutputPath>,
    /// Draw the distance of each cell of the last pair from the plane.
    #[arg(long, value_name = "FILE.png")]
    picture: Option<OutputPath>,
    #[command(flatten)]
    input: InputArgs,
}

fn parse_region(text: &str) -> Result<[u16; 4], &'static str> {
    let numbers: Option<Vec<u16>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let region = numbers.and_then(|numbers| <[u16; 4]>::try_from(numbers).ok());
    region.ok_or("give left, top, width and height, such as 96,72,128,96")
}

pub fn run(args: &Args) -> Result<()> {
    let (found, _) = pairs_of(&args.left, args.right.as_deref(), args.side_by_side)?;
    let pairs = &found.pairs;
    spare(asked_for([&args.json, &args.picture]), pairs.iter().flat_map(StoredPair::files))?;
    let mut player = Player::new(&args.input, &args.left)?;
    let progress = named_bar(pairs.len());
    let (mut figures, mut last, mut flags) = (WallFigures::default(), None, Health::GOOD);
    let mut refusals = Vec::new();
    for pair in pairs {
        progress.set_message(pair.name.clone());
        let loaded = player.load(pair);
        if loaded.is_err() && has_ended(&found) && figures.pairs() > 0 {
            break;
        }
        let (loaded, setup, matcher) = loaded.with_context(|| pair.name.clone())?;
        let matched = matcher
            .run(setup, &loaded, pair.images.times_us())
            .with_context(|| pair.name.clone())?;
        flags |= matched.result.health;
        // A wall of which nothing is matched has a verdict.
        refusals.extend(
            setup.refusal(&matched.result).filter(|_| !health::is_fit(matched.result.health)),
        );
        figures.push(&wall(args, setup)?, &matched.result.points);
        last = Some(matched.images);
        progress.inc(1);
    }
    progress.finish_and_clear();
    let (Some([left, _]), Some(setup)) = (last, player.setup()) else {
        bail!("there are no pairs")
    };
    let pairs = figures.pairs();
    let (quality, answers) = figures.of_all(&wall(args, setup)?);
    let verdict = Verdict::of(&quality, args.distance);
    let text = text(&quality, args.distance, &verdict) + &health::remedies(flags);
    let mut output = OutputFiles::new();
    let mut value = serde_json::to_value(&quality)?;
    value["verdict"] = json!(verdict.grade.name());
    value["advice"] = json!(verdict.advice);
    value["health"] = json!(health::names(flags));
    output.add_json(args.json.as_ref(), &value)?;
    output.add_made(args.picture.as_ref(), || {
        Ok(draw::png(&draw::quality(&left, &quality, &answers, &text))?)
    })?;
    let notes = scene_note(setup) + &video_note(&found) + &written([&args.json, &args.picture]);
    output.commit_and_sum_up("", &text, &notes)?;
    match refusals.first().filter(|_| answers.is_empty() && refusals.len() == pairs) {
        Some(why) => bail!("nothing is measured; {why}"),
        None => Ok(()),
    }
}

/// The wall in the left image of pairs of this set-up.
fn wall<'a>(args: &Args, setup: &'a Setup<'_>) -> Result<Wall<'a>> {
    if args.distance.is_some() && setup.params.rig.is_none() {
        return Err(setup.lacks("--distance"));
    }
    let region = region(args.region, setup.given, |pixel| setup.as_matched(pixel))?;
    Ok(Wall { region, rig: setup.params.rig.as_ref(), distance_m: args.distance })
}

fn region(
    given: Option<[u16; 4]>,
    size: Dims,
    as_matched: impl Fn((u16, u16)) -> (u16, u16),
) -> Result<Area> {
    let [x, y, w, h] = given.unwrap_or_else(|| {
        let (w, h) = (size.width * 2 / 5, size.height * 2 / 5);
        [(size.width - w) / 2, (size.height - h) / 2, w, h]
    });
    if w == 0
        || h == 0
        || u32::from(x) + u32::from(w) > u32::from(size.width)
        || u32::from(y) + u32::from(h) > u32::from(size.height)
    {
        bail!("--region {x},{y},{w},{h} does not lie in the left image, which is {size}");
    }
    let ((left, top), (last, bottom)) = (as_matched((x, y)), as_matched((x + w - 1, y + h - 1)));
    let area = Area { left, top, right: last + 1, bottom: bottom + 1 };
    if area.right - area.left < 32 || area.bottom - area.top < 32 {
        bail!(
            "--region {x},{y},{w},{h} is less than 32 px wide or high as matched; give a larger one"
        );
    }
    Ok(area)
}

/// Class of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Grade {
    Good,
    Usable,
    Poor,
}

impl Grade {
    /// Of a figure that is the better the lower it is.
    fn of(value: f64, good: f64, usable: f64) -> Self {
        if value <= good {
            Self::Good
        } else if value <= usable {
            Self::Usable
        } else {
            Self::Poor
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Usable => "usable",
            Self::Poor => "poor",
        }
    }
}

/// The worst grade, and what to do about each figure that is not good.
struct Verdict {
    grade: Grade,
    advice: Vec<String>,
}

impl Verdict {
    fn of(quality: &Quality, distance: Option<f64>) -> Self {
        let mut verdict = Self { grade: Grade::Good, advice: Vec::new() };
        let empty = 1.0 - quality.fill_rate;
        verdict.weigh(Some(empty), [0.2, 0.5], || {
            "little of the wall has an answer: more texture (a newspaper, a random pattern), more light, sharper focus".into()
        });
        if quality.sub_pixel_rms_px.is_none() {
            verdict.grade = Grade::Poor;
            verdict.advice.push("too few answers for a plane: nothing else can be said".into());
        }
        verdict.weigh(quality.off_plane, [0.01, 0.03], || {
            "answers far off the plane: something else is in the region, or the texture repeats"
                .into()
        });
        verdict.weigh(quality.sub_pixel_rms_px, [0.25, 0.5], || {
            "disparities scatter about the plane: focus, noise, rows (health above), a lens that is not calibrated up to here".into()
        });
        verdict.weigh(quality.temporal_noise_px, [0.15, 0.3], || {
            "answers change from pair to pair: more light, less gain; or cameras and wall did not stand still".into()
        });
        let error = quality.z_accuracy.map(f64::abs);
        verdict.weigh(error, [0.02, 0.05], || accuracy_advice(quality, distance));
        verdict
    }

    fn weigh(
        &mut self,
        figure: Option<f64>,
        [good, usable]: [f64; 2],
        advice: impl FnOnce() -> String,
    ) {
        let grade = figure.map_or(Grade::Good, |figure| Grade::of(figure, good, usable));
        if grade > Grade::Good {
            self.grade = self.grade.max(grade);
            self.advice.push(advice());
        }
    }
}

fn accuracy_advice(quality: &Quality, distance: Option<f64>) -> String {
    let (share, px) =
        (quality.z_accuracy.unwrap_or(0.0), quality.disparity_error_px.unwrap_or(0.0));
    format!(
        "depths are {:.1} % too {} at {} m, which is {:.2} px of disparity too {}. Measure at a \
         second distance. If the error in % is the same, focal length or baseline is wrong \
         (calibrate again, check --square-mm). If it grows with distance, a camera has turned, or \
         --disparity-offset-px is missing",
        100.0 * share.abs(),
        if share > 0.0 { "far" } else { "near" },
        distance.unwrap_or(0.0),
        px.abs(),
        if px > 0.0 { "little" } else { "much" }
    )
}

fn text(quality: &Quality, distance: Option<f64>, verdict: &Verdict) -> String {
    let mut text = String::new();
    let [x, y, w, h] = quality.region;
    let _ = writeln!(text, "wall in {w}x{h} px at {x},{y}, {} pair(s)", quality.pairs);
    let mut line = |name: &str, words: Option<String>| {
        if let Some(words) = words {
            let _ = writeln!(text, "  {name:<15} {words}");
        }
    };
    line(
        "fill rate",
        Some(format!("{:.1} % of {} cells", 100.0 * quality.fill_rate, quality.cells)),
    );
    let tilt =
        quality.tilt_deg.map_or(String::new(), |tilt| format!(", tilted by {tilt:.1} degrees"));
    line(
        "distance",
        quality.distance_m.map(|distance| format!("{distance:.4} m in the middle{tilt}")),
    );
    let z = quality.z_accuracy_m.zip(quality.z_accuracy).zip(distance);
    let z = z.map(|((m, share), known)| {
        format!("{:+.1} mm, {:+.2} % of {known} m", 1e3 * m, 100.0 * share)
    });
    line("Z accuracy", z);
    let rms = quality.plane_fit_rms_m.zip(quality.plane_fit_rms);
    line(
        "plane-fit RMS",
        rms.map(|(m, share)| format!("{:.1} mm, {:.2} % of the distance", 1e3 * m, 100.0 * share)),
    );
    line("sub-pixel RMS", quality.sub_pixel_rms_px.map(|px| format!("{px:.3} px")));
    line(
        "off the plane",
        quality
            .off_plane
            .map(|share| format!("{:.1} % of the answers by more than 1 px", 100.0 * share)),
    );
    let noise = quality.temporal_noise_px.zip(quality.repeated_pixels).map(|(px, pixels)| {
        let metres =
            quality.temporal_noise_m.map_or(String::new(), |m| format!(", {:.1} mm", 1e3 * m));
        format!("{px:.3} px{metres}, median of {pixels} pixels")
    });
    line("temporal noise", noise);
    let _ = writeln!(text, "verdict: {}", verdict.grade.name());
    verdict.advice.iter().for_each(|advice| text.push_str(&format!("  {advice}\n")));
    text
}
