//! `linestereo report`: one page for a pair or a sequence, to be looked at.

use super::input::InputArgs;
use super::objects::{ObjectArgs, ObjectTally, Objects};
use super::pairs::{has_ended, named_bar, pairs_of, scene_note, video_note};
use super::player::Player;
use crate::explain::{CurveLog, TestTexts};
use crate::output::{OutputFiles, OutputPath, spare};
use crate::report::{Page, PageFrame, PageSetup};
use crate::results::health;
use anyhow::{Context, Result, bail};
use linestereo_frames::StoredPair;
use std::path::PathBuf;

/// Write one HTML page with the matches of a pair or a sequence, and why others were rejected.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/report.txt"))]
pub struct Args {
    /// Left image or video; or a folder with a pair or a sequence, a recording (.mcap), or a video
    /// with both views side by side.
    left: PathBuf,
    /// Right image or video.
    right: Option<PathBuf>,
    /// Output file.
    #[arg(long, short, value_name = "FILE.html")]
    out: OutputPath,
    /// Show at most this many frames, evenly spaced; all frames are matched.
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u16).range(1..))]
    max_frames: u16,
    /// Both images of a pair stand side by side in one file: left | right.
    #[arg(long, conflicts_with = "right")]
    side_by_side: bool,
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    objects: ObjectArgs,
}

pub fn run(args: &Args) -> Result<()> {
    let (found, title) = pairs_of(&args.left, args.right.as_deref(), args.side_by_side)?;
    let pairs = &found.pairs;
    spare([&*args.out], pairs.iter().flat_map(StoredPair::files))?;
    let objects = args.objects.open(&args.left, &found)?;
    let shown = shown(pairs.len(), args.max_frames.into());
    let mut player = Player::new(&args.input, &args.left)?;
    let progress = named_bar(pairs.len());
    let (mut page, mut skipped) = (None, ObjectTally::default());
    let (mut failed, mut refusals) = (Vec::new(), Vec::new());
    for (index, pair) in pairs.iter().enumerate() {
        progress.set_message(pair.name.clone());
        let title = shown.contains(&index).then_some(&*title);
        let collected = (&mut page, &mut skipped);
        match add(&objects, &mut player, pair, (title, pairs.len() > 1), collected) {
            Ok(refusal) => refusals.extend(refusal),
            Err(error) if pairs.len() == 1 => return Err(error),
            Err(_) if has_ended(&found) => break,
            Err(error) => failed.push((pair.name.clone(), format!("{error:#}"))),
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    let Some(mut page) = page else {
        let (name, error) = failed.into_iter().next().context("there are no pairs")?;
        bail!("no pair can be shown; {name}: {error}");
    };
    failed.iter().for_each(|(name, error)| page.push_error(name, error));
    let html = page.html()?;
    let mut output = OutputFiles::new();
    output.add(&args.out, html.as_bytes())?;
    let megabytes = html.len() as f64 / 1e6;
    let (shown, all, failed) = (shown.len(), pairs.len(), failed.len());
    let path = args.out.display();
    let mut note = player.setup().map_or(String::new(), scene_note) + &video_note(&found);
    if args.objects.is_given() {
        note.push_str(&skipped.summary());
    }
    output.commit_and_say(&format!(
        "{shown} of {all} pairs, {failed} failed: wrote {path} ({megabytes:.1} MB)\n{note}"
    ))?;
    // The page shows why.
    match refusals.first().filter(|_| failed + refusals.len() == all) {
        Some(why) => bail!("no pair can be used; {why}"),
        None => Ok(()),
    }
}

/// Positions of at most so many frames, evenly spaced, the first and the last among them.
fn shown(frames: usize, most: usize) -> Vec<usize> {
    if frames <= most {
        return (0..frames).collect();
    }
    (0..most).map(|i| if most > 1 { i * (frames - 1) / (most - 1) } else { 0 }).collect()
}

/// Matches a pair and, where it is shown under a title, puts it on the page, which the first one
/// begins. Gives the reason why nothing of it is to be used, if there is one.
fn add(
    objects: &Objects<'_>,
    player: &mut Player<'_>,
    pair: &StoredPair,
    (title, many): (Option<&str>, bool),
    (page, skipped): (&mut Option<Page>, &mut ObjectTally),
) -> Result<Option<String>> {
    let (loaded, setup, matcher) = player.load(pair)?;
    // The first pair of many tells how far rows are apart.
    if !many || matcher.engine.matcher.knows_rows() {
        matcher.engine.areas = objects.areas(setup, pair);
    }
    // With the tests of many pairs the page would be too large.
    let mut log = if many { CurveLog::outcomes_only() } else { CurveLog::default() };
    let matched = matcher.run_observed(setup, &loaded, pair.images.times_us(), &mut log)?;
    let is_right = objects.is_only() && health::is_fit(matched.result.health);
    let refusal = setup.refusal(&matched.result).filter(|_| !is_right);
    let refusal = refusal.map(|why| format!("{}: {why}", pair.name));
    let Some(title) = title else { return Ok(refusal) };
    let (engine, params) = (&mut matcher.engine, &setup.params);
    let setup_of_page = || PageSetup { title: title.to_owned(), many };
    let page = page.get_or_insert_with(|| Page::new(setup_of_page()));
    let objects = objects.depths(setup, pair, engine).unwrap_or_default();
    skipped.count(&pair.name, &objects);
    if let Some(error) = objects.error {
        bail!("{error}");
    }
    let tests = (!many).then(|| TestTexts::new(&log, engine, params, &matched.result));
    page.push(&PageFrame {
        name: pair.name.clone(),
        max_disparity: params.max_disparity,
        rig: params.rig,
        images: &matched.images,
        result: &matched.result,
        rejected: &log.rejected(engine.matched().candidates()),
        objects: &objects.list,
        tests: &tests.unwrap_or_default(),
    })?;
    Ok(refusal)
}
