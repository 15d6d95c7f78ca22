//! `linestereo flash-image`: the rig as bytes for a board, and what such bytes say.

use super::rectified_view::ViewArgs;
use crate::output::{OutputFiles, OutputPath, print};
use anyhow::{Context, Result, anyhow};
use core::fmt::Write;
use linestereo::Params;
use linestereo_frames::untrusted::{self, SETTINGS_BYTES};
use linestereo_rig::{CameraSide, Lens, RemapCamera, RigImage, RigImageHead};
use nalgebra::{Matrix3, Vector3};
use std::path::{Path, PathBuf};

/// Write the rig image for a board's flash, or explain one.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/flash-image.txt"))]
pub struct Args {
    /// The rig: rig.toml, or one file of OpenCV or Kalibr.
    #[arg(value_name = "rig.toml", required_unless_present = "check", requires = "out")]
    rig: Option<PathBuf>,
    /// The image to write.
    #[arg(value_name = "OUT.bin")]
    out: Option<OutputPath>,
    /// Explain an image: its content, or which number a board would refuse and why.
    #[arg(long, value_name = "FILE.bin", conflicts_with_all = ["rig", "size", "alpha", "raw_width", "focal_px", "max_disparity"])]
    check: Option<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
    /// Focal length of the rectified images, around the middle of the common view.
    #[arg(long, value_name = "PX", conflicts_with = "alpha", help_heading = "Rectified view")]
    focal_px: Option<f64>,
    /// Search disparities 0 .. N px in the rectified images [default: 64].
    #[arg(long, value_name = "N")]
    max_disparity: Option<u16>,
}

pub fn run(args: &Args) -> Result<()> {
    if let Some(path) = &args.check {
        return print(&explain(path)?);
    }
    let (Some(rig), Some(out)) = (&args.rig, &args.out) else { unreachable!("clap asks for both") };
    let range = (0, args.max_disparity.unwrap_or(Params::DEFAULT.max_disparity));
    let image = args.view.image(&[rig.clone().into()], None, args.focal_px, range)?;
    let bytes = image.encode(0);
    let mut output = OutputFiles::new();
    output.add(out, &bytes)?;
    let text = description(&image, &RigImageHead::check(&bytes)?) + &super::written([&args.out]);
    output.commit_and_say(&text)
}

/// Contents of a file, or the reason why it is no image.
fn explain(path: &Path) -> Result<String> {
    let bytes = untrusted::read(path, SETTINGS_BYTES)
        .with_context(|| format!("{} cannot be read", path.display()))?;
    let head = RigImageHead::read(&bytes);
    match (RigImage::decode(&bytes), head) {
        (Ok(image), Ok(head)) => Ok(description(&image, &head)),
        (Err(error), head) => {
            let says =
                head.map_or_else(|_| String::new(), |head| format!(" ({})", in_words(&head)));
            Err(anyhow!(
                "{}: {error}{says}; no board takes it: make it anew with flash-image",
                path.display()
            ))
        }
        (Ok(_), Err(error)) => Err(error.into()),
    }
}

fn in_words(RigImageHead { version, length, sequence, is_whole }: &RigImageHead) -> String {
    let checksum = if *is_whole { "right" } else { "wrong" };
    format!("version {version}, {length} bytes, sequence {sequence}, checksum {checksum}")
}

fn description(image: &RigImage, head: &RigImageHead) -> String {
    let remap = image.remap();
    let mut text = format!("rig image     {}\n", in_words(head));
    for (name, side) in [("left camera ", CameraSide::Left), ("right camera", CameraSide::Right)] {
        let _ = writeln!(text, "{name}  {}, {}", remap.raw_dims(), camera(remap.camera(side)));
    }
    let _ = writeln!(
        text,
        "pose          baseline {:.2} mm, cameras turned by {:.3} degrees",
        1e3 * remap.baseline(),
        angle_deg(CameraSide::BOTH.map(|side| remap.camera(side).rotation))
    );
    let (focal, [cx, cy]) = (remap.focal(), remap.centre());
    let _ = writeln!(
        text,
        "rectified     {}, focal length {focal:.2} px, centre ({cx:.2}, {cy:.2})",
        remap.dims()
    );
    let (first, end) = image.disparities();
    let nearest = focal * remap.baseline() / Params::largest_disparity(end).to_num::<f32>();
    let _ = writeln!(text, "disparities   {first} .. {end} px: depths from {nearest:.3} m");
    text
}

fn camera(camera: &RemapCamera) -> String {
    let RemapCamera { focal: [fx, fy], centre: [cx, cy], skew, lens, .. } = camera;
    let lens = match lens {
        Lens::BrownConrady { k, p } => format!("Brown-Conrady k {k:?} p {p:?}"),
        Lens::Rational { k, p } => format!("rational k {k:?} p {p:?}"),
        Lens::Fisheye { k } => format!("fisheye k {k:?}"),
    };
    format!("focal length {fx:.2} {fy:.2} px, centre ({cx:.2}, {cy:.2}), skew {skew} px, {lens}")
}

/// Angle between two cameras, degrees, from their rotations.
fn angle_deg(rotations: [[[f32; 3]; 3]; 2]) -> f64 {
    let [left, right] = rotations.map(|rows| Matrix3::from(rows.map(|row| row.map(f64::from))));
    let turn = left.tr_mul(&right);
    let axis = Vector3::new(turn.m32 - turn.m23, turn.m13 - turn.m31, turn.m21 - turn.m12);
    axis.norm().atan2(turn.trace() - 1.0).to_degrees()
}
