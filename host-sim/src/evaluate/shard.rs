//! An evaluation in parts: shard k of n takes every n-th pair, and the parts together are the whole to the last byte.
//!
//! ```text
//! part   head (command, options, pairs of the whole data set) and the result of each pair with its place among all
//! merge  equal heads, every shard once, every place once -> results in order, as one run over everything has them
//! ```
//!
//! Which pairs there are is found anew by every part, so that no part waits for another: the head holds a digest of their names.

use core::fmt;
use core::str::FromStr;
use linestereo_frames::untrusted::{self, RESULT_BYTES};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Written first into every part; another number is another format.
const FORMAT: u32 = 1;

/// Part `index` of `count`, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    /// 1 ..= count.
    pub index: u32,
    /// Parts in all.
    pub count: u32,
}

impl Shard {
    /// Everything.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// The pair at this place, from 0, is in it.
    #[must_use]
    pub fn holds(self, place: usize) -> bool {
        place % self.count as usize == self.index as usize - 1
    }
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        let shard = numbers.map(|(index, count)| Self { index, count });
        shard.filter(|shard| (1..=shard.count).contains(&shard.index)).ok_or("give K/N with K from 1 to N: 3/16")
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// Settings common to the parts of one evaluation.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardHead {
    format: u32,
    /// The command that wrote it, and its version.
    command: String,
    /// Every option that changes a result, in words.
    options: String,
    /// SHA-256 of the names of all pairs.
    names: String,
    /// Pairs in all parts.
    pairs: usize,
    /// Further data of the data set in a report, in any form.
    pub notes: Vec<String>,
}

impl ShardHead {
    /// The head of an evaluation of these pairs.
    #[must_use]
    pub fn new<'a>(
        command: &str,
        options: String,
        names: impl IntoIterator<Item = &'a str>,
        notes: Vec<String>,
    ) -> Self {
        let (mut digest, mut pairs) = (Sha256::new(), 0);
        for name in names {
            digest.update((name.len() as u64).to_le_bytes());
            digest.update(name);
            pairs += 1;
        }
        let names = digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        let command = format!("{command} {}", env!("CARGO_PKG_VERSION"));
        Self { format: FORMAT, command, options, names, pairs, notes }
    }
}

/// A part, or everything: the result of each pair with its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShardFile<R> {
    #[serde(rename = "linestereo_shard")]
    head: ShardHead,
    shard: Shard,
    results: Vec<(usize, R)>,
}

/// Why parts are not one whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ShardError {
    /// A part cannot be read.
    Read(PathBuf, std::io::ErrorKind),
    /// It is no part, of another format, or damaged.
    NoShard(PathBuf, String),
    /// It is of another command, version, options or data set than the first one.
    Differs {
        /// The part.
        path: PathBuf,
        /// The setting that differs.
        what: &'static str,
    },
    /// Parts that are not there.
    Missing(Vec<Shard>),
    /// The same part twice.
    Twice(PathBuf, Shard),
    /// A part lacks results, or has those of another one.
    Incomplete(PathBuf),
}

impl fmt::Display for ShardError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(path, kind) => write!(f, "cannot read {}: {kind}; check the path", path.display()),
            Self::NoShard(path, what) => {
                write!(f, "{} is no part of an evaluation ({what}); write it with --shard K/N --json", path.display())
            }
            Self::Differs { path, what } => {
                write!(f, "{} has another {what} than the first part; merge parts of one evaluation", path.display())
            }
            Self::Missing(shards) => {
                let list: Vec<String> = shards.iter().take(20).map(Shard::to_string).collect();
                write!(f, "{} parts are missing: {}; run them, then merge all", shards.len(), list.join(", "))
            }
            Self::Twice(path, shard) => write!(f, "{} is part {shard} again; give each part once", path.display()),
            Self::Incomplete(path) => {
                write!(f, "{} does not hold the results of its part; run the part again", path.display())
            }
        }
    }
}

impl core::error::Error for ShardError {}

impl<R: Serialize + DeserializeOwned> ShardFile<R> {
    /// The results of one part with their places, in order.
    #[must_use]
    pub fn new(head: ShardHead, shard: Shard, results: Vec<(usize, R)>) -> Self {
        Self { head, shard, results }
    }

    /// As it is stored.
    pub fn to_json(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Reads a part.
    pub fn read(path: &Path) -> Result<Self, ShardError> {
        let bytes =
            untrusted::read(path, RESULT_BYTES).map_err(|error| ShardError::Read(path.to_path_buf(), error.kind()))?;
        let broken = |what: String| ShardError::NoShard(path.to_path_buf(), what);
        let part: Self = serde_json::from_slice(&bytes).map_err(|error| broken(error.to_string()))?;
        if part.head.format != FORMAT {
            return Err(broken(format!("its format is {}, not {FORMAT}", part.head.format)));
        }
        let Shard { index, count } = part.shard;
        if !(1..=count).contains(&index) {
            return Err(broken(format!("it calls itself {}", part.shard)));
        }
        Ok(part)
    }

    /// Reads parts and puts them together.
    pub fn merge(paths: &[PathBuf]) -> Result<(ShardHead, Vec<R>), ShardError> {
        let (mut first, mut seen, mut all): (Option<(ShardHead, u32)>, _, _) = (None, BTreeMap::new(), BTreeMap::new());
        for path in paths {
            let part = Self::read(path)?;
            let (head, count) = first.get_or_insert_with(|| (part.head.clone(), part.shard.count));
            if let Some(what) =
                head.difference(&part.head).or((*count != part.shard.count).then_some("number of parts"))
            {
                return Err(ShardError::Differs { path: path.clone(), what });
            }
            if seen.insert(part.shard, ()).is_some() {
                return Err(ShardError::Twice(path.clone(), part.shard));
            }
            let places = part.results.iter().map(|(place, _)| *place);
            if !places.eq((0..head.pairs).filter(|&place| part.shard.holds(place))) {
                return Err(ShardError::Incomplete(path.clone()));
            }
            all.extend(part.results);
        }
        let Some((head, count)) = first else { return Err(ShardError::Missing(vec![Shard::WHOLE])) };
        let missing = (1..=count).map(|index| Shard { index, count }).filter(|shard| !seen.contains_key(shard));
        let missing: Vec<Shard> = missing.collect();
        if missing.is_empty() { Ok((head, all.into_values().collect())) } else { Err(ShardError::Missing(missing)) }
    }
}

impl ShardHead {
    fn difference(&self, other: &Self) -> Option<&'static str> {
        let parts = [
            (self.command == other.command, "command or version"),
            (self.options == other.options, "set of options"),
            (
                self.names == other.names && self.pairs == other.pairs && self.notes == other.notes,
                "data set (or OpenCV)",
            ),
        ];
        parts.into_iter().find(|(same, _)| !same).map(|(_, what)| what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_is_in_one_shard() {
        for count in [1, 2, 5, 16] {
            for place in 0..40 {
                let holding = (1..=count).filter(|&index| Shard { index, count }.holds(place)).count();
                assert_eq!(holding, 1, "{place} of {count}");
            }
        }
        assert_eq!("3/16".parse(), Ok(Shard { index: 3, count: 16 }));
        for text in ["0/4", "5/4", "1/0", "x/4", "3", "-1/4", "1/4/2"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
