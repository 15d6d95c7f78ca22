//! `linestereo convert-rig`: calibrations of other programs to `rig.toml` and back.

use super::arguments::both;
use crate::output::{OutputFiles, OutputPath};
use anyhow::{Result, anyhow, bail};
use core::fmt::Write;
use linestereo::Dims;
use linestereo_calibration::interchange::{
    Exported, Format, Imported, LensModel, Options, TranslationUnit, export, load_rig,
};
use linestereo_calibration::rig_file::rotation_vector;
use linestereo_rig::{Camera, CameraSide, Lens};
use std::path::PathBuf;

/// Convert a calibrated rig between rig.toml, OpenCV, Kalibr, ROS and EuRoC files.
///
/// The input format is recognised by its content. Without --out nothing is written.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/convert-rig.txt"))]
pub struct Args {
    /// Files of one rig.
    #[arg(value_name = "INPUT", required = true, num_args = 1..=3)]
    inputs: Vec<PathBuf>,
    /// File to write; twice, left first, for ros and euroc.
    #[arg(long, value_name = "FILE")]
    out: Vec<OutputPath>,
    /// Format to write.
    #[arg(long, value_name = "FORMAT", default_value = "rig-toml")]
    to: Format,
    #[command(flatten)]
    import: ImportArgs,
}

/// Data that files may lack.
#[derive(Debug, Default, clap::Args)]
pub(super) struct ImportArgs {
    /// Format of the input, if its content does not show it.
    #[arg(long, value_name = "FORMAT")]
    from: Option<Format>,
    /// Size of the raw images, if an OpenCV file lacks it.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<Dims>,
    /// Unit of OpenCV's T: m, mm, or the side of the board's squares in mm [default: by square_size
    /// in the file, else m if T is shorter than 5, else mm].
    #[arg(long, value_name = "m|mm|SQUARE_MM", value_parser = parse_unit)]
    translation_unit: Option<TranslationUnit>,
    /// Meaning of OpenCV's distortion coefficients, where the file does not say it [default:
    /// brown-conrady].
    #[arg(long, value_name = "MODEL")]
    lens: Option<LensModel>,
    /// The second camera of the files is the left one.
    #[arg(long)]
    swap: bool,
}

impl ImportArgs {
    pub(super) fn options(&self) -> Options {
        let Self { from, size, translation_unit, lens, swap } = *self;
        Options { from, size, translation_unit, lens, swap, images: None }
    }
}

pub fn run(args: &Args) -> Result<()> {
    let imported = load_rig(&args.inputs, &args.import.options())?;
    let (mut text, mut output) = (summary(&imported), OutputFiles::new());
    if !args.out.is_empty() {
        if args.out.len() != args.to.files() {
            let (format, count) = (args.to, args.to.files());
            let files = if count == 1 {
                "one file; give --out once"
            } else {
                "two files; give --out twice, left first"
            };
            bail!("{format} is {files}");
        }
        let Exported { texts, notes } =
            export(&imported.rig, args.to).map_err(|problem| anyhow!("{problem}"))?;
        for (path, text) in args.out.iter().zip(&texts) {
            output.add(path, text.as_bytes())?;
        }
        for note in notes {
            let _ = writeln!(text, "note: {note}");
        }
        for path in &args.out {
            let _ = writeln!(text, "{}: {}", args.to, path.display());
        }
    }
    output.commit_and_sum_up("", &text, "")
}

fn summary(imported: &Imported) -> String {
    let calibration = &imported.rig.calibration;
    let dims = calibration.camera(CameraSide::Left).dims();
    let [x, y, z] = calibration.translation().map(|t| 1e3 * t);
    let mut text =
        format!("{}: {dims}, baseline {:.4} m\n", imported.format, calibration.baseline());
    for (name, eye) in [("left", CameraSide::Left), ("right", CameraSide::Right)] {
        let _ = writeln!(text, "  {name:<6} {}", camera(calibration.camera(eye)));
    }
    let [rx, ry, rz] = rotation_vector(calibration.rotation()).map(f64::to_degrees);
    let _ = writeln!(
        text,
        "  pose   turned by {rx:.3} {ry:.3} {rz:.3} degrees about x y z, moved by {x:.2} {y:.2} {z:.2} mm"
    );
    if imported.stored.is_some() {
        text.push_str("  its own rectification fits this pose\n");
    }
    for note in &imported.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

fn camera(camera: &Camera) -> String {
    let ([fx, fy], [cx, cy]) = (camera.focal(), camera.centre());
    let lens = match camera.lens() {
        Lens::NONE => "no distortion".to_owned(),
        Lens::BrownConrady { k, p } => format!("brown-conrady k {} p {}", numbers(&k), numbers(&p)),
        Lens::Rational { k, p } => format!("rational k {} p {}", numbers(&k), numbers(&p)),
        Lens::Fisheye { k } => format!("fisheye k {}", numbers(&k)),
    };
    let skew =
        if camera.skew() == 0.0 { String::new() } else { format!("skew {:.2}, ", camera.skew()) };
    format!("focal {fx:.2} {fy:.2} px, centre {cx:.2} {cy:.2}, {skew}{lens}")
}

fn numbers(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:.4}")).collect::<Vec<_>>().join(" ")
}

/// Width and height in px; what they may be is checked where they are used.
pub(super) fn parse_size(text: &str) -> Result<Dims, &'static str> {
    let sides = text.split_once('x').and_then(both);
    let [width, height] = sides.ok_or("give width and height in px, for example 640x480")?;
    Ok(Dims { width, height })
}

fn parse_unit(text: &str) -> Result<TranslationUnit, &'static str> {
    match text {
        "m" => Ok(TranslationUnit::Metres),
        "mm" => Ok(TranslationUnit::Millimetres),
        _ => {
            let side = text.parse().ok().filter(|side| (0.1..=10_000.0).contains(side));
            let millimetres =
                side.ok_or("give m, mm, or the side of a square in mm, for example 25")?;
            Ok(TranslationUnit::Squares { millimetres })
        }
    }
}
