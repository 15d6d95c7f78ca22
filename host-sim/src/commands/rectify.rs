//! `linestereo rectify`: raw pairs to rectified ones, and a picture that shows whether rows agree.

use super::pairs::named_bar;
use super::print;
use super::view::ViewArgs;
use crate::draw;
use crate::input::rectify::PairRectifier;
use crate::input::{check_same_size, find_pairs, load_gray};
use crate::output::OutputFiles;
use anyhow::{Context, Result, bail};
use linestereo_baselines::GrayImage;
use linestereo_rig::{CameraSide, Remap};
use std::path::{Path, PathBuf};

/// What the rig image needs and rectification does not use.
const ANY_RANGE: (i16, u16) = (0, 8);

const EXAMPLES: &str = "\
Examples:
  linestereo rectify left.png right.png --rig rig.toml --out-left l.png --out-right r.png
  linestereo rectify left.png right.png --rig rig.toml --size 320x240 --picture rows.png
      the picture alone: raw above, rectified below, a line every 32 rows
  linestereo rectify recordings --rig rig.toml --out rectified
      every folder below recordings that holds left.png and right.png (or .jpg, .pgm, .ppm)
  linestereo rectify left.png right.png --rig cam0_sensor.yaml --rig cam1_sensor.yaml --picture rows.png
      a rig of EuRoC; OpenCV, Kalibr and ROS files are read as well

In the picture a point has to lie on one line in both lower images. Pixels without source are black.";

/// Rectify raw pairs with a calibrated rig, by the same code as on a board.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Raw left image; or a folder with pairs, one per folder, as left and right.
    left: PathBuf,
    /// Raw right image.
    #[arg(required_unless_present = "out")]
    right: Option<PathBuf>,
    /// The rig: rig.toml, or files of OpenCV, Kalibr, ROS or EuRoC (twice where each camera has one).
    #[arg(long, value_name = "FILE", required = true)]
    rig: Vec<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
    /// Write the rectified left image as PNG.
    #[arg(long, value_name = "FILE.png", requires = "right")]
    out_left: Option<PathBuf>,
    /// Write the rectified right image as PNG.
    #[arg(long, value_name = "FILE.png", requires = "right")]
    out_right: Option<PathBuf>,
    /// Draw both pairs, raw above rectified, with lines along the rows, as PNG.
    #[arg(long, value_name = "FILE.png", requires = "right")]
    picture: Option<PathBuf>,
    /// Write left.png, right.png and rows.png (the picture) for every pair of the folder to folders of the same names in here.
    #[arg(long, value_name = "FOLDER", conflicts_with = "right")]
    out: Option<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let image = args.view.image(&args.rig, None, ANY_RANGE)?;
    let mut rectifier = PairRectifier::new(image.remap())?;
    let summary = summary(image.remap(), &rectifier);
    let written = match (&args.right, &args.out) {
        (Some(right), _) => one(args, &mut rectifier, right)?,
        (None, Some(out)) => folder(args, out, &mut rectifier)?,
        (None, None) => unreachable!("clap asks for one of them"),
    };
    print(&(summary + &written))
}

/// What was written, in words.
fn one(args: &Args, rectifier: &mut PairRectifier, right: &Path) -> Result<String> {
    let written: Vec<&PathBuf> = [&args.out_left, &args.out_right, &args.picture].into_iter().flatten().collect();
    if written.is_empty() {
        bail!("nothing is asked for; give --out-left and --out-right, or --picture");
    }
    let pair = Pair::load(&args.left, right, &args.view, rectifier)?;
    let mut output = OutputFiles::new();
    for (path, image) in [(&args.out_left, &pair.rectified[0]), (&args.out_right, &pair.rectified[1])] {
        if let Some(path) = path {
            output.add(path, &draw::gray_png(image)?)?;
        }
    }
    if let Some(path) = &args.picture {
        output.add(path, &pair.picture()?)?;
    }
    output.commit()?;
    Ok(written.into_iter().map(|path| format!("wrote {}\n", path.display())).collect())
}

fn folder(args: &Args, out: &Path, rectifier: &mut PairRectifier) -> Result<String> {
    let root = args.left.as_path();
    let pairs = find_pairs(root)?;
    if pairs.is_empty() {
        bail!("no folder at or below {} holds a left and a right image; add them", root.display());
    }
    let progress = named_bar(pairs.len());
    for (folder, [left, right]) in &pairs {
        let name = folder.strip_prefix(root).unwrap_or(folder);
        progress.set_message(name.display().to_string());
        let pair = Pair::load(left, right, &args.view, rectifier)?;
        let target = out.join(name);
        std::fs::create_dir_all(&target)
            .with_context(|| format!("cannot make {}; choose a folder that can be written to", target.display()))?;
        let mut output = OutputFiles::new();
        output.add(&target.join("left.png"), &draw::gray_png(&pair.rectified[0])?)?;
        output.add(&target.join("right.png"), &draw::gray_png(&pair.rectified[1])?)?;
        output.add(&target.join("rows.png"), &pair.picture()?)?;
        output.commit()?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(format!("{} pairs: {}\n", pairs.len(), out.display()))
}

/// A pair before and after.
struct Pair {
    raw: [GrayImage; 2],
    rectified: [GrayImage; 2],
}

impl Pair {
    fn load(left: &Path, right: &Path, view: &ViewArgs, rectifier: &mut PairRectifier) -> Result<Self> {
        let raw = [load_gray(left)?, load_gray(right)?];
        check_same_size((left, raw[0].dims), (right, raw[1].dims))?;
        let [left_raw, right_raw] = raw;
        let raw = [view.raw(left_raw)?, view.raw(right_raw)?];
        let (left_rectified, right_rectified) =
            rectifier.pair(&raw[0], &raw[1]).with_context(|| left.display().to_string())?;
        Ok(Self { raw, rectified: [left_rectified, right_rectified] })
    }

    fn picture(&self) -> Result<Vec<u8>> {
        Ok(draw::png(&draw::rows(&self.raw, &self.rectified))?)
    }
}

fn summary(remap: &Remap, rectifier: &PairRectifier) -> String {
    let dims = remap.dims();
    let [left, right] = CameraSide::BOTH.map(|eye| {
        let facts = rectifier.facts(eye);
        let valid: u32 = facts.spans.iter().map(|span| u32::from(span.end - span.start)).sum();
        let share = 100.0 * f64::from(valid) / (f64::from(dims.width) * f64::from(dims.height));
        (share, facts.band_rows, facts.band_bytes)
    });
    format!(
        "{} rectified to {dims}, focal length {:.1} px, baseline {:.4} m; valid {:.1} % and {:.1} %; \
         raw rows held at once {} and {} ({} and {} bytes)\n",
        remap.raw_dims(),
        remap.focal(),
        remap.baseline(),
        left.0,
        right.0,
        left.1,
        right.1,
        left.2,
        right.2
    )
}
