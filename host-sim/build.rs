//! `LINESTEREO_VERSION`: the version with the commit, by git or as `cargo package` noted it; and
//! `cfg(captured)` where captured frames are.
//!
//! Without either the version stands alone: no build fails for it.

#![allow(clippy::disallowed_methods, reason = "reads what cargo wrote")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// Digits of a commit that are shown.
const DIGITS: usize = 12;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let version = env!("CARGO_PKG_VERSION");
    let commit = packaged_commit()
        .or_else(git_commit)
        .map(|commit| format!(" ({:.DIGITS$})", commit.trim()));
    println!("cargo::rustc-env=LINESTEREO_VERSION={version}{}", commit.unwrap_or_default());
    captured();
}

/// File that `cargo package` writes beside the manifest: `{"git": {"sha1": "..."}}`.
fn packaged_commit() -> Option<String> {
    let text = fs::read_to_string(".cargo_vcs_info.json").ok()?;
    let (_, rest) = text.split_once("\"sha1\"")?;
    rest.split('"')
        .find(|part| part.len() >= DIGITS && part.bytes().all(|byte| byte.is_ascii_hexdigit()))
        .map(str::to_owned)
}

/// HEAD of this project's own repository, not of one that it was copied into.
fn git_commit() -> Option<String> {
    if !Path::new("../.git").exists() {
        return None;
    }
    let git = |args: &[&str]| {
        let output = Command::new("git")
            .args(args)
            .output()
            .ok()
            .filter(|output| output.status.success())?;
        String::from_utf8(output.stdout).ok().map(|text| text.trim().to_owned())
    };
    // Grows with each commit, and with each change of the branch.
    println!("cargo::rerun-if-changed={}", git(&["rev-parse", "--git-path", "logs/HEAD"])?);
    git(&["rev-parse", "HEAD"])
}

/// Tests that need captured frames are ignored elsewhere, and the summary says so.
fn captured() {
    let beside = || PathBuf::from("../../shared/frames");
    let root = env::var_os("LINESTEREO_FRAMES").map_or_else(beside, PathBuf::from);
    println!("cargo::rustc-check-cfg=cfg(captured)");
    println!("cargo::rerun-if-env-changed=LINESTEREO_FRAMES");
    if root.join("qvga").is_dir() {
        println!("cargo::rustc-cfg=captured");
    }
}
