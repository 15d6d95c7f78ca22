//! Pairs that a command is given, and many pairs on every core: results in the order of the pairs,
//! whoever was first.
//!
//! Each thread takes the next pair that nobody has; memory is that of one pair for each thread, and
//! of the results.

use super::input::Setup;
use crate::interruption;
use crate::output::is_quiet;
use anyhow::{Context, Result, bail};
use indicatif::{ProgressBar, ProgressStyle};
use linestereo_frames::untrusted::printable;
use linestereo_frames::{PairFiles, StoredPair};
use linestereo_recordings::{Footage, Video, is_recording, is_video};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use std::path::Path;

/// An engine's memory may pass over the stack on its way to the heap.
const STACK_BYTES: usize = 64 << 20;

/// Pairs of a command line's paths, with a title: one of two images or of one file, those of a
/// folder, of a recording or of videos.
pub(super) fn pairs_of(
    left: &Path,
    right: Option<&Path>,
    side_by_side: bool,
) -> Result<(Footage, String)> {
    let name = |path: &Path| {
        let path = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        path.file_name()
            .map_or_else(String::new, |name| printable(&name.to_string_lossy()).into_owned())
    };
    let alone = |title: String, files: PairFiles| Footage::of_pair(StoredPair::alone(title, files));
    let is_film = |path: &Path| is_video(path) && !path.is_dir();
    if let Some(right) = right {
        let title = format!("{} and {}", name(left), name(right));
        if is_film(left) || is_film(right) {
            return Ok((super::player::videos(left, Some(right), side_by_side)?, title));
        }
        let files = PairFiles::Two([left.to_path_buf(), right.to_path_buf()]);
        return Ok((alone(name(left), files), title));
    }
    if side_by_side && left.is_file() && !is_film(left) {
        return Ok((alone(name(left), PairFiles::SideBySide(left.to_path_buf())), name(left)));
    }
    if !left.is_dir() && !is_recording(left) && !is_video(left) {
        bail!(
            "{} is no folder; give a left and a right image, a folder, an .mcap file, or videos",
            left.display()
        );
    }
    Ok((Footage::open(left, side_by_side, interruption::requested)?, name(left)))
}

/// No more pairs come of a video, though there should be.
pub(super) fn has_ended(found: &Footage) -> bool {
    found.of_video().is_some_and(|video| video.ended().is_some())
}

/// A line about the scene.json beside a pair; empty where there is none.
pub(super) fn scene_note(setup: &Setup<'_>) -> String {
    setup.note.as_ref().map_or(String::new(), |note| format!("{note}\n"))
}

/// Warnings about videos, a line each; empty where there are none.
pub(super) fn video_note(found: &Footage) -> String {
    let mut text = found
        .of_video()
        .and_then(Video::summary)
        .map_or(String::new(), |note| format!("video: {note}\n"));
    if found.of_video().is_some() && found.alone > 0 {
        text.push_str(&format!("{} frames of the longer video have no partner\n", found.alone));
    }
    text
}

/// Does `work` for every item on so many threads (all cores without a number), under a progress bar
/// that says each one's name. The first error to appear ends it.
pub fn for_each_pair<I: Sync, T: Send>(
    items: &[I],
    threads: Option<usize>,
    name: impl Fn(&I) -> String + Sync,
    work: impl Fn(&I) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let progress = timed_bar(items.len());
    let one = |item: &I| {
        progress.set_message(name(item));
        let result = work(item);
        progress.inc(1);
        result
    };
    let mut builder = ThreadPoolBuilder::new().stack_size(STACK_BYTES);
    if let Some(threads) = threads {
        builder = builder.num_threads(threads);
    }
    let pool = builder.build().context("cannot start threads; give fewer with --threads")?;
    // One item at a time: neighbours in a list differ in size, and a late large one would leave the
    // others idle.
    let results = pool.install(|| items.par_iter().with_max_len(1).map(one).collect());
    progress.finish_and_clear();
    results
}

/// The bar of a long evaluation, with the time it takes.
pub fn timed_bar(length: usize) -> ProgressBar {
    bar(length, "{bar:30} {pos}/{len} {elapsed} of about {duration} {msg}")
}

/// The bar of one pair after the other, with the name of the one at hand.
pub fn named_bar(length: usize) -> ProgressBar {
    bar(length, "{bar:30} {pos}/{len} {msg}")
}

/// On stderr, and only when that is a terminal.
pub fn bar(length: usize, template: &str) -> ProgressBar {
    if is_quiet() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(template);
    ProgressBar::new(length as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
