//! Evaluations over many pairs, the same for every command that scores: which pairs, on how many threads, in how many parts.

use crate::evaluate::{Shard, ShardFile};
use crate::output::{OutputFiles, OutputPath};
use anyhow::{Context, Result, bail};
use core::num::NonZeroUsize;
use linestereo_frames::{Dataset, StoredPair, layouts};
use serde::{Serialize, de::DeserializeOwned};
use std::path::PathBuf;

/// On how many threads, and which part of the pairs.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Many pairs")]
pub(super) struct BatchArgs {
    /// Use so many threads [default: all cores].
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Do only every N-th pair, from the K-th on, and write their results to --json FILE, to be merged.
    #[arg(long, value_name = "K/N", requires = "json")]
    pub(super) shard: Option<Shard>,
    /// Put the parts of an evaluation together, which --shard wrote.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["shard", "threads"])]
    pub(super) merge: Vec<PathBuf>,
}

/// The pairs with ground truth, and what a report says of the others.
pub(super) struct Collected {
    pub(super) pairs: Vec<StoredPair>,
    /// Which layouts were taken, what was left out: a sentence each.
    pub(super) notes: Vec<String>,
}

impl BatchArgs {
    pub(super) fn threads(&self) -> Option<usize> {
        self.threads.map(NonZeroUsize::get)
    }

    /// The items of this part with their places among all.
    pub(super) fn part<T>(&self, items: Vec<T>) -> (Vec<usize>, Vec<T>) {
        let shard = self.shard.unwrap_or(Shard::WHOLE);
        items.into_iter().enumerate().filter(|(place, _)| shard.holds(*place)).unzip()
    }
}

/// Finds the pairs with ground truth. Where there is none at all, it is an error if truth is needed, and every pair is taken if not.
pub(super) fn collect(folders: &[PathBuf], needs_truth: bool) -> Result<Collected> {
    let (mut pairs, mut without, mut notes, mut alone) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for folder in folders {
        let found = Dataset::find(folder)?;
        for (layout, count) in layouts(&found.pairs) {
            // Paths differ between the machines of a cluster; names do not.
            let name = folder.file_name().map_or_else(String::new, |name| format!("{}: ", name.to_string_lossy()));
            notes.push(format!("{name}{count} pairs, layout: {layout}"));
        }
        let (scored, rest): (Vec<_>, Vec<_>) = found.pairs.into_iter().partition(StoredPair::has_truth);
        pairs.extend(scored);
        without.extend(rest);
        alone += found.alone;
    }
    if pairs.is_empty() && !needs_truth {
        core::mem::swap(&mut pairs, &mut without);
    }
    if pairs.is_empty() {
        let list: Vec<String> = folders.iter().map(|folder| folder.display().to_string()).collect();
        bail!("no pair with ground truth below {}; see --help", list.join(", "));
    }
    if !without.is_empty() {
        let without = without.len();
        notes.push(format!("{without} pairs without ground truth were left out"));
    }
    if alone > 0 {
        notes.push(format!("{alone} images have no partner"));
    }
    Ok(Collected { pairs, notes })
}

/// Writes the results of a part.
pub(super) fn write_part<R: Serialize + DeserializeOwned>(
    file: &ShardFile<R>,
    path: Option<&OutputPath>,
    shard: Shard,
    count: usize,
) -> Result<()> {
    let path = path.context("a part needs a file; give --json FILE")?;
    let json = file.to_json()?;
    let mut output = OutputFiles::new();
    output.add(path, json.as_bytes())?;
    output.commit_and_say(&format!(
        "part {shard}: {count} pairs in {}; put all parts together with --merge\n",
        path.display()
    ))
}
