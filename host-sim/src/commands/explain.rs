//! `linestereo explain`: why a pixel, the segment, the bar and the support point next to it have a
//! depth, or none.

use super::input::{InputArgs, PairMatcher};
use super::pairs::scene_note;
use super::run::pixel;
use super::written;
use crate::draw;
use crate::explain::{CurveLog, Explanation};
use crate::output::{OutputFiles, OutputPath};
use crate::results::health;
use anyhow::{Result, bail};
use linestereo_frames::{PairFiles, StoredPair};
use std::path::PathBuf;

/// Explain one pixel: cost curves of each technique, best and second-best, and the test that
/// accepted or rejected it.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/explain.txt"))]
pub struct Args {
    /// Left image, the reference.
    left: PathBuf,
    /// Right image of the same size.
    right: PathBuf,
    /// Pixel of the (rectified) left image before --width.
    #[arg(value_name = "X,Y", value_parser = pixel)]
    pixel: (u16, u16),
    /// Draw the surroundings and the cost curves.
    #[arg(long, value_name = "FILE.png")]
    picture: Option<OutputPath>,
    #[command(flatten)]
    input: InputArgs,
}

pub fn run(args: &Args) -> Result<()> {
    let given =
        StoredPair::alone(String::new(), PairFiles::Two([args.left.clone(), args.right.clone()]));
    let known = args.input.known_of(&given)?;
    let pair = args.input.load_as(&given.images, &known)?;
    let setup = args.input.setup_as(&pair, &known)?;
    let ((x, y), size) = (args.pixel, setup.given);
    if x >= size.width || y >= size.height {
        bail!("pixel {x},{y} lies outside of the left image, which is {size}; give one inside");
    }
    let (mut matcher, mut log) = (PairMatcher::new(&setup)?, CurveLog::default());
    let matched = matcher.run_observed(&setup, &pair, None, &mut log)?;
    let pixel = setup.as_matched(args.pixel);
    let explanation =
        Explanation::new(pixel, &log, &mut matcher.engine, &setup.params, &matched.result);
    let mut output = OutputFiles::new();
    let picture = || draw::explanation(&matched.images[0], &explanation);
    output.add_made(args.picture.as_ref(), || Ok(draw::png(&picture())?))?;
    let mut before = scene_note(&setup);
    if pixel != args.pixel {
        before.push_str(&format!(
            "pixel {x},{y} is {},{} of the images as matched\n",
            pixel.0, pixel.1
        ));
    }
    let after = health::summary(&matched.result) + &written([&args.picture]);
    output.commit_and_sum_up(&before, &explanation.to_string(), &after)
}
