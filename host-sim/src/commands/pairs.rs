//! Many pairs on every core: results in the order of the pairs, whoever was first.
//!
//! Each thread takes the next pair that nobody has; memory is that of one pair for each thread, and of the results.

use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

/// An engine's memory may pass over the stack on its way to the heap.
const STACK_BYTES: usize = 64 << 20;

/// Does `work` for every item on so many threads (all cores without a number), under a progress bar that says each one's name. The first error
/// to appear ends it.
pub(super) fn for_each_pair<I: Sync, T: Send>(
    items: &[I],
    threads: Option<usize>,
    name: impl Fn(&I) -> String + Sync,
    work: impl Fn(&I) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let progress = progress_bar(items.len());
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
    // One item at a time: neighbours in a list differ in size, and a late large one would leave the others idle.
    let results = pool.install(|| items.par_iter().with_max_len(1).map(one).collect());
    progress.finish_and_clear();
    results
}

/// On stderr, and only when that is a terminal.
#[must_use]
pub(super) fn progress_bar(length: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} of about {duration} {msg}");
    ProgressBar::new(length as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
