//! Numbers of boards that are kept in a file of the repository: read, written anew, or compared
//! with those measured now.

use anyhow::{Context, Result, bail};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::path::Path;

/// Larger differences are a loss or a gain.
const TOLERANCE_PERCENT: u64 = 1;

/// A file of numbers.
pub(crate) struct Stored {
    /// Its path in the repository.
    pub(crate) file: &'static str,
    /// The command that writes it.
    pub(crate) bless: &'static str,
    /// Meaning of its numbers, as comments of the file.
    pub(crate) head: &'static str,
}

impl Stored {
    /// Reads it; nothing where it is missing and will be written.
    pub(crate) fn read<T: DeserializeOwned + Default>(&self, top: &Path, bless: bool) -> Result<T> {
        let Self { file, bless: command, .. } = self;
        match std::fs::read_to_string(top.join(file)) {
            Ok(text) => toml::from_str(&text).with_context(|| format!("{file} cannot be read")),
            Err(_) if bless => Ok(T::default()),
            Err(error) => bail!("{file} cannot be read ({error}); write it: {command}"),
        }
    }

    /// Writes it.
    pub(crate) fn write(&self, top: &Path, numbers: &impl Serialize) -> Result<()> {
        std::fs::write(top.join(self.file), self.head.to_owned() + &toml::to_string(numbers)?)?;
        println!("{}: blessed; commit it", self.file);
        Ok(())
    }

    /// Prints a table of all numbers; refuses those that differ by more than 1 %, come or go.
    pub(crate) fn compare(
        &self,
        old: &BTreeMap<String, u64>,
        new: &BTreeMap<String, u64>,
    ) -> Result<()> {
        let Self { file, bless, .. } = self;
        let (mut losses, mut gains) = (0, 0);
        for (name, &now) in new {
            let before = old.get(name).copied();
            let change =
                before.map_or(f64::INFINITY, |before| now as f64 / before.max(1) as f64 - 1.0);
            let more_than =
                |large: u64, small: u64| 100 * large > (100 + TOLERANCE_PERCENT) * small;
            let less_than =
                |small: u64, large: u64| 100 * small < (100 - TOLERANCE_PERCENT) * large;
            let verdict = if before.is_none_or(|before| more_than(now, before)) {
                losses += 1;
                "LOSS"
            } else if before.is_some_and(|before| less_than(now, before)) {
                gains += 1;
                "gain"
            } else {
                ""
            };
            let before = before.map_or("-".to_owned(), |before| before.to_string());
            println!("{name:44} {before:>12} {now:>12} {:>8.2} % {verdict}", 100.0 * change);
        }
        let gone: Vec<&str> =
            old.keys().filter(|name| !new.contains_key(*name)).map(String::as_str).collect();
        if losses > 0 || !gone.is_empty() {
            bail!(
                "{losses} numbers are more than 1 % worse than in {file} or new, {} are gone: {}; \
                 if it was meant: {bless}",
                gone.len(),
                gone.join(", ")
            );
        }
        if gains > 0 {
            bail!(
                "{gains} numbers are more than 1 % better than in {file}; keep the gain: {bless}"
            );
        }
        println!("all within 1 % of {file}");
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STORED: Stored =
        Stored { file: "numbers.toml", bless: "cargo xtask measure --bless", head: "# Bytes.\n" };

    fn list(value: u64) -> BTreeMap<String, u64> {
        BTreeMap::from([("flash".to_owned(), value)])
    }

    #[test]
    fn one_percent_is_the_limit_both_ways() {
        let compare = |old, new| STORED.compare(&list(old), &list(new));
        assert!(compare(10_000, 10_100).is_ok());
        assert!(compare(10_000, 10_101).unwrap_err().to_string().contains("worse"));
        assert!(compare(10_000, 9_900).is_ok());
        assert!(compare(10_000, 9_899).unwrap_err().to_string().contains("--bless"));
    }

    #[test]
    fn a_number_that_comes_or_goes_is_an_error() {
        assert!(STORED.compare(&BTreeMap::new(), &list(1)).is_err());
        assert!(STORED.compare(&list(1), &BTreeMap::new()).is_err());
    }
}
