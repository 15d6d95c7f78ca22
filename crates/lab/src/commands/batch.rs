//! The pairs of every command that scores.

use anyhow::{Result, bail};
use linestereo_frames::{Dataset, StoredPair, layouts};
use std::path::PathBuf;

/// The pairs with ground truth, and what a report says of the others.
pub(crate) struct Collected {
    pub(crate) pairs: Vec<StoredPair>,
    /// Which layouts were taken, what was left out: a sentence each.
    pub(crate) notes: Vec<String>,
}

/// Finds the pairs with ground truth. Where there is none at all, it is an error if truth is
/// needed, and every pair is taken if not.
pub(crate) fn collect(folders: &[PathBuf], needs_truth: bool) -> Result<Collected> {
    let (mut pairs, mut without, mut notes, mut alone) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for folder in folders {
        let strict = Dataset::find(folder);
        // A folder that is no scene, or a broken one, is left out; the others are scored.
        let found = if needs_truth {
            strict?
        } else {
            strict.or_else(|_| Dataset::sequence(folder, false))?
        };
        for (layout, count) in layouts(&found.pairs) {
            let name = folder
                .file_name()
                .map_or_else(String::new, |name| format!("{}: ", name.to_string_lossy()));
            notes.push(format!("{name}{count} pairs, layout: {layout}"));
        }
        let (scored, rest): (Vec<_>, Vec<_>) =
            found.pairs.into_iter().partition(StoredPair::has_truth);
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
