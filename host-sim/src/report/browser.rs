//! A browser without a window: what a page is after its script has run. For tests of pages.

use crate::programs;
use anyhow::{Context, Result, bail};
use core::time::Duration;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Names another browser of the Chromium family.
pub const VARIABLE: &str = "LINESTEREO_BROWSER";
const PROGRAMS: [&str; 4] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
const PACKAGE: &str = "chromium";
const LIMIT: Duration = Duration::from_secs(120);
/// Time of the page, not of the clock: it ends as soon as nothing is left to do.
const PAGE_TIME: &str = "--virtual-time-budget=10000";
const FLAGS: [&str; 10] = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars", "--window-size=1280,1400",
];

#[derive(Clone, Debug)]
pub struct Browser(PathBuf);

impl Browser {
    pub fn find() -> Option<Self> {
        let named = std::env::var_os(VARIABLE).map(PathBuf::from);
        let programs =
            named.map_or_else(|| PROGRAMS.map(PathBuf::from).to_vec(), |named| vec![named]);
        let runs = |program: &PathBuf| {
            programs::first_line(Command::new(program).arg("--version")).is_some()
        };
        programs.into_iter().find(runs).map(Self)
    }

    /// The one that is there, or Debian's.
    pub fn install() -> Result<Self> {
        if Self::find().is_none() {
            programs::install("testing pages", &[PACKAGE])?;
        }
        Self::find().context("no browser runs; install chromium, or name one in LINESTEREO_BROWSER")
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    /// The document of this file after its script has run, as HTML. More flags may follow.
    pub fn document(&self, page: &Path, flags: &[&str]) -> Result<String> {
        let profile = tempfile::tempdir()?;
        let mut command = Command::new(&self.0);
        command.args(FLAGS).args(flags).args([PAGE_TIME, "--dump-dom"]);
        command.arg(format!("--user-data-dir={}", profile.path().display()));
        command.arg(format!("file://{}", page.canonicalize()?.display()));
        let outcome = programs::run(&mut command, LIMIT)?;
        if !outcome.status.success() {
            bail!(
                "the browser failed: {}",
                outcome.stderr.lines().last().unwrap_or("it says nothing")
            );
        }
        Ok(String::from_utf8_lossy(&outcome.stdout).into_owned())
    }
}
