//! `linestereo rectify`: raw pairs to rectified ones, and a picture that shows whether rows agree.

use super::pairs::named_bar;
use super::rectified_view::ViewArgs;
use crate::draw;
use crate::output::{OutputFiles, OutputPath, say, spare};
use anyhow::{Context, Result, bail};
use linestereo::Dims;
use linestereo_calibration::rectify::{PairRectifier, RectifierError};
use linestereo_frames::{
    Dataset, GrayImage, PairFiles, RigText, StoredPair, check_same_size, load_gray, load_images,
};
use linestereo_rig::{CameraSide, Remap};
use std::path::{Path, PathBuf};

/// Fields that the rig image needs and rectification does not use.
const ANY_RANGE: (i16, u16) = (0, 8);

/// Files of each pair of a folder.
const WRITTEN: [&str; 3] = ["left.png", "right.png", "rows.png"];

/// Rectify raw pairs with a calibrated rig, by the code that boards use.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/rectify.txt"))]
pub struct Args {
    /// Raw left image; or a folder with pairs, in any layout.
    left: PathBuf,
    /// Raw right image.
    #[arg(required_unless_present = "out")]
    right: Option<PathBuf>,
    /// The rig: rig.toml, or files of OpenCV, Kalibr, ROS or EuRoC (twice where each camera has
    /// one).
    #[arg(long, value_name = "FILE", required = true)]
    rig: Vec<PathBuf>,
    /// Write the rectified left image as PNG.
    #[arg(long, value_name = "FILE.png", requires = "right")]
    out_left: Option<OutputPath>,
    /// Write the rectified right image as PNG.
    #[arg(long, value_name = "FILE.png", requires = "right")]
    out_right: Option<OutputPath>,
    /// Draw both pairs, raw above rectified, with lines along the rows, as PNG.
    #[arg(long, value_name = "FILE.png", requires = "right")]
    picture: Option<OutputPath>,
    /// Write left.png, right.png and rows.png (the picture) of every pair to a folder of its name
    /// in here.
    #[arg(long, value_name = "FOLDER", conflicts_with = "right")]
    out: Option<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
}

pub fn run(args: &Args) -> Result<()> {
    let pairs = match &args.right {
        Some(_) => Vec::new(),
        None => Dataset::sequence(&args.left, false)?.pairs,
    };
    let dims = match pairs.first() {
        Some(first) => load_images(&first.images, None)?[0].dims,
        None => load_gray(&args.left)?.dims,
    };
    let rig: Vec<RigText> = args.rig.iter().cloned().map(RigText::from).collect();
    let image = args.view.image(&rig, Some(dims), None, ANY_RANGE)?;
    let rectifier = PairRectifier::new(image.remap())?;
    let summary = summary(image.remap(), &rectifier);
    let mut raw = RawPairs { dims, view: &args.view, rectifier };
    match (&args.right, &args.out) {
        (Some(right), _) => one(args, &mut raw, right, summary),
        (None, Some(out)) => say(&(summary + &folder(args, &pairs, out, &mut raw)?)),
        (None, None) => unreachable!("clap asks for one of them"),
    }
}

fn one(args: &Args, raw: &mut RawPairs<'_>, right: &Path, summary: String) -> Result<()> {
    let written = super::written([&args.out_left, &args.out_right, &args.picture]);
    if written.is_empty() {
        bail!("nothing is asked for; give --out-left and --out-right, or --picture");
    }
    let pair = raw.load(&PairFiles::Two([args.left.clone(), right.to_path_buf()]))?;
    let mut output = OutputFiles::new();
    for (path, image) in [&args.out_left, &args.out_right].into_iter().zip(&pair.rectified) {
        output.add_made(path.as_ref(), || Ok(draw::gray_png(image)?))?;
    }
    output.add_made(args.picture.as_ref(), || pair.picture())?;
    output.commit_and_say(&(summary + &written))
}

/// Rectifies one pair; returns the names of the files written, in words.
fn folder(args: &Args, pairs: &[StoredPair], out: &Path, raw: &mut RawPairs<'_>) -> Result<String> {
    let root = args.left.as_path();
    // A single pair keeps the folder's name, which is that of OUT.
    let is_root = |pair: &StoredPair| pair.folder == root && pairs.len() == 1;
    let target =
        |pair: &StoredPair| if is_root(pair) { out.to_path_buf() } else { out.join(&pair.name) };
    let targets: Vec<PathBuf> =
        pairs.iter().flat_map(|pair| WRITTEN.map(|name| target(pair).join(name))).collect();
    spare(targets.iter().map(PathBuf::as_path), pairs.iter().flat_map(StoredPair::files))?;
    let progress = named_bar(pairs.len());
    for stored in pairs {
        progress.set_message(stored.name.clone());
        let pair = raw.load(&stored.images)?;
        let target = target(stored);
        std::fs::create_dir_all(&target).with_context(|| {
            format!("cannot make {}; choose a folder that can be written to", target.display())
        })?;
        let [left, right] = &pair.rectified;
        let contents = [draw::gray_png(left)?, draw::gray_png(right)?, pair.picture()?];
        let mut output = OutputFiles::new();
        for (name, contents) in WRITTEN.into_iter().zip(&contents) {
            output.add(&target.join(name), contents)?;
        }
        output.commit()?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(format!("{} pairs: {}\n", pairs.len(), out.display()))
}

/// Raw pairs of one rig, and the meshes that rectify them.
struct RawPairs<'a> {
    /// Size of the images before they are reduced.
    dims: Dims,
    view: &'a ViewArgs,
    rectifier: PairRectifier,
}

impl RawPairs<'_> {
    fn load(&mut self, files: &PairFiles) -> Result<Pair> {
        let ([left, right], [left_raw, right_raw]) = (files.paths(), load_images(files, None)?);
        check_same_size((left, left_raw.dims), (right, right_raw.dims))?;
        let of_pair = || left.display().to_string();
        let (needed, given) = (self.dims, left_raw.dims);
        if given != needed {
            return Err(RectifierError::Size { needed, given }).with_context(of_pair);
        }
        let raw = [self.view.raw(left_raw)?, self.view.raw(right_raw)?];
        let (left, right) = self.rectifier.pair(&raw[0], &raw[1]).with_context(of_pair)?;
        Ok(Pair { raw, rectified: [left, right] })
    }
}

/// A pair before and after.
struct Pair {
    raw: [GrayImage; 2],
    rectified: [GrayImage; 2],
}

impl Pair {
    fn picture(&self) -> Result<Vec<u8>> {
        Ok(draw::png(&draw::rows(&self.raw, &self.rectified))?)
    }
}

fn summary(remap: &Remap, rectifier: &PairRectifier) -> String {
    let dims = remap.dims();
    let [(left, left_rows, left_bytes), (right, right_rows, right_bytes)] =
        CameraSide::BOTH.map(|eye| {
            let facts = rectifier.facts(eye);
            let valid: u32 = facts.spans.iter().map(|span| u32::from(span.end - span.start)).sum();
            let share = 100.0 * f64::from(valid) / (f64::from(dims.width) * f64::from(dims.height));
            (share, facts.band_rows, facts.band_bytes)
        });
    format!(
        "{} rectified to {dims}, focal length {:.1} px, baseline {:.4} m; valid {left:.1} % and {right:.1} %; \
         raw rows held at once {left_rows} and {right_rows} ({left_bytes} and {right_bytes} bytes)\n",
        remap.raw_dims(),
        remap.focal(),
        remap.baseline()
    )
}
