//! Measurements as they are stored: scores of data sets, times, numbers and sizes of boards.

use super::page::SETS;
use super::{read, write};
use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

const SCORES: &str = "xtask/scores.json";
/// Files that other tasks write, by what they hold.
pub(super) const BOARD_FILES: [&str; 2] = ["xtask/board-numbers.toml", "xtask/board-sizes.toml"];

/// Everything that pages are made from.
#[derive(Debug)]
pub(super) struct Stored {
    pub(super) scores: Scores,
    pub(super) numbers: toml::Table,
    pub(super) sizes: toml::Table,
    /// By file, a digest of its bytes.
    digests: BTreeMap<String, String>,
}

/// `xtask/scores.json`.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Scores {
    pub(super) bench: Bench,
    pub(super) compare: Compare,
    /// When numbers of boards were last taken over, by file.
    pub(super) boards: BTreeMap<String, Taken>,
}

#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Taken {
    digest: String,
    pub(super) date: String,
}

/// Scores of `linestereo-lab bench`.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Bench {
    /// Of all sets.
    pub(super) opencv: Option<String>,
    pub(super) sets: BTreeMap<String, DataSet>,
}

/// A data set: metric, figure, and its values for linestereo, SGBM and StereoBM.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct DataSet {
    pub(super) date: String,
    pub(super) scenes: u64,
    pub(super) metrics: BTreeMap<String, BTreeMap<String, [Option<f64>; 3]>>,
}

impl Bench {
    /// Replaces the sets of the page that this report has. All of them have to be there then, with
    /// all their scenes and scores of one version of OpenCV.
    fn merge(&mut self, report: &Value) -> Result<()> {
        let opencv = report["opencv"].as_str();
        let opencv = opencv.context("it has no scores of OpenCV; set LINESTEREO_PYTHON")?;
        let (mut old, mut sets) = (core::mem::take(&mut self.sets), BTreeMap::new());
        let is_shown = |set: &&Value| SETS.iter().any(|(shown, _)| set["name"] == *shown);
        for set in list(&report["sets"]).iter().filter(is_shown) {
            if let [note, ..] = list(&set["notes"]) {
                bail!("a scene of {} was not scored: {note}; mend it, and score again", name(set));
            }
            let scenes = set["scenes"].as_u64().unwrap_or(0);
            let mut kept = DataSet { date: today(), scenes, metrics: BTreeMap::new() };
            for group in list(&set["groups"]) {
                let shown = list(&group["figures"]).iter().filter(|figure| figure["main"] == true);
                let figures: BTreeMap<_, _> =
                    shown.map(|figure| (name(figure), values(figure))).collect();
                kept.metrics.insert(metric(&name(group)), figures);
            }
            old.remove(&name(set));
            sets.insert(name(set), kept);
        }
        if let Some((set, _)) =
            old.first_key_value().filter(|_| self.opencv.as_deref() != Some(opencv))
        {
            bail!(
                "it has OpenCV {opencv}, the stored set {set} has another version; score all sets"
            );
        }
        sets.extend(old);
        if let Some((missing, _)) = SETS.iter().find(|(set, _)| !sets.contains_key(*set)) {
            bail!("the set {missing} is missing; score all sets of the page");
        }
        *self = Self { opencv: Some(opencv.to_owned()), sets };
        Ok(())
    }
}

impl DataSet {
    /// A figure of the metric whose name starts so.
    pub(super) fn figure(&self, metric: &str, figure: &str) -> [Option<f64>; 3] {
        let metric = self.metrics.get(metric);
        metric.and_then(|figures| figures.get(figure)).copied().unwrap_or_default()
    }
}

/// Scores and times of `linestereo-lab compare`.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Compare {
    pub(super) date: String,
    pub(super) machine: String,
    pub(super) pairs: u64,
    pub(super) methods: Vec<Method>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Method {
    pub(super) name: String,
    pub(super) points: f64,
    pub(super) cells_percent: f64,
    /// More than 1 and 2 px off, %: visible pixels, and all with truth.
    pub(super) visible: [f64; 2],
    pub(super) all: [f64; 2],
    pub(super) milliseconds: f64,
    /// By outline: objects, answered, wrong.
    pub(super) objects: BTreeMap<String, [u64; 3]>,
}

impl Stored {
    /// The measurements of this repository.
    pub(super) fn read(top: &Path) -> Result<Self> {
        let scores = serde_json::from_str(&read(&top.join(SCORES))?)
            .with_context(|| format!("{SCORES} is not read"))?;
        let mut tables = Vec::new();
        let mut digests = BTreeMap::new();
        for file in BOARD_FILES {
            let text = read(&top.join(file))?;
            digests.insert(file.to_owned(), format!("{:016x}", fnv(text.as_bytes())));
            tables.push(text.parse().with_context(|| format!("{file} is not read"))?);
        }
        let [numbers, sizes] = tables.try_into().ok().context("two files of boards")?;
        Ok(Self { scores, numbers, sizes, digests })
    }

    /// Writes the scores.
    pub(super) fn write(&self, top: &Path) -> Result<()> {
        write(&top.join(SCORES), &(serde_json::to_string_pretty(&self.scores)? + "\n"))
    }

    /// Gives files of boards that have changed today's date.
    pub(super) fn date_boards(&mut self) {
        for (file, digest) in &self.digests {
            let taken = self.scores.boards.entry(file.clone()).or_default();
            if taken.digest != *digest {
                *taken = Taken { digest: digest.clone(), date: today() };
            }
        }
    }

    /// Says that no file of boards has changed since.
    pub(super) fn is_dated(&self) -> bool {
        let taken = |file| self.scores.boards.get(file).map(|taken| &taken.digest);
        self.digests.iter().all(|(file, digest)| taken(file) == Some(digest))
    }

    /// A number of a board, by its path in `board-numbers.toml`.
    pub(super) fn number(&self, path: &[&str]) -> Option<u64> {
        number(&self.numbers, path)
    }

    /// Takes the scores of a run of `linestereo-lab bench --json`; sets that were not run keep
    /// theirs.
    pub(super) fn take_bench(&mut self, file: &Path) -> Result<()> {
        let report: Value = serde_json::from_str(&read(file)?)?;
        self.scores.bench.merge(&report).with_context(|| format!("{} is not taken", file.display()))
    }

    /// Takes the scores of a run of `linestereo-lab compare --json`.
    pub(super) fn take_compare(&mut self, file: &Path) -> Result<()> {
        let report: Value = serde_json::from_str(&read(file)?)?;
        let number = |value: &Value| rounded(value.as_f64().unwrap_or(f64::NAN));
        let method = |method: &Value| {
            let all = &method["all"];
            let both =
                |kind: &str| ["bad1", "bad2"].map(|bad| number(&all[format!("{kind}_{bad}")]));
            let count = |object: &Value, name: &str| object[name].as_u64().unwrap_or(0);
            let objects = list(&method["objects"]).iter().map(|object| {
                let outline = object["outline"].as_str().unwrap_or_default().to_owned();
                (outline, ["objects", "covered", "wrong"].map(|name| count(object, name)))
            });
            Method {
                name: method["method"].as_str().unwrap_or_default().to_owned(),
                points: number(&all["points_per_frame"]),
                cells_percent: number(&all["cells_percent"]),
                visible: both("vis"),
                all: both("all_gt"),
                milliseconds: number(&method["milliseconds"]),
                objects: objects.collect(),
            }
        };
        self.scores.compare = Compare {
            date: today(),
            machine: machine(),
            pairs: report["frames"].as_u64().unwrap_or(0),
            methods: list(&report["methods"]).iter().map(method).collect(),
        };
        Ok(())
    }
}

/// A number by its path.
pub(super) fn number(table: &toml::Table, path: &[&str]) -> Option<u64> {
    let (last, tables) = path.split_last()?;
    let table = tables.iter().try_fold(table, |table, name| table.get(*name)?.as_table())?;
    table.get(*last)?.as_integer()?.try_into().ok()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn name(value: &Value) -> String {
    value["name"].as_str().unwrap_or_default().to_owned()
}

/// A metric's name without its parameters: `cells`, `seen`, `cells, noise5`.
fn metric(name: &str) -> String {
    let damage =
        ["noise2", "noise5", "blur1", "gain"].into_iter().find(|damage| name.ends_with(damage));
    let kinds = [
        ("one hypothesis", "cells"),
        ("seen by class", "classes"),
        ("seen", "seen"),
        ("objects", "objects"),
        ("obstacles", "obstacles"),
        ("said against", "stated"),
    ];
    let kind = kinds.into_iter().find(|(start, _)| name.starts_with(start));
    let kind = kind.map_or(name, |(_, kind)| kind);
    damage.map_or_else(|| kind.to_owned(), |damage| format!("{kind}, {damage}"))
}

fn values(figure: &Value) -> [Option<f64>; 3] {
    ["linestereo", "sgbm", "bm"].map(|method| figure["values"][method].as_f64().map(rounded))
}

/// To 1/1000, more than any table shows.
fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// The processor, as Linux names it.
fn machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let named = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    named.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned())
}

/// Today's date, as 2026-01-31.
fn today() -> String {
    chrono::Utc::now().date_naive().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn sets_of_a_run_join_those_that_are_stored() {
        let top = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let stored = || Stored::read(top).unwrap().scores.bench;
        let (first, mut bench) = (stored(), stored());
        let set = |notes: &[&str]| {
            // One that the page does not show may lack scenes.
            let other = json!({"name": "other", "scenes": 0, "notes": ["too large"], "groups": []});
            let set = json!({"name": "qvga", "scenes": 2, "notes": notes, "groups": []});
            json!({"opencv": "5.0.0", "sets": [other, set]})
        };
        bench.merge(&set(&[])).unwrap();
        assert_eq!((bench.sets.len(), bench.sets["qvga"].scenes), (first.sets.len(), 2));
        let [kept, was] = [&bench, &first].map(|bench| &bench.sets["robot_world"]);
        assert_eq!((kept.scenes, &kept.date), (was.scenes, &was.date));
        let mut newer = set(&[]);
        newer["opencv"] = json!("5.0.1");
        let error = stored().merge(&newer).unwrap_err();
        assert!(error.to_string().contains("another version; score all sets"), "{error}");
        let error = stored().merge(&set(&["room is left out: no image"])).unwrap_err();
        assert!(error.to_string().contains("room is left out"), "{error}");
        let error = Bench::default().merge(&set(&[])).unwrap_err();
        assert!(error.to_string().contains("the set robot_world is missing"), "{error}");
    }

    #[test]
    fn metrics_have_short_names() {
        let names = [
            "one hypothesis per 16x16 cell, noise5", "seen by class: 8x8 cells",
            "said against right",
        ];
        assert_eq!(names.map(metric), ["cells, noise5", "classes", "stated"]);
    }
}
