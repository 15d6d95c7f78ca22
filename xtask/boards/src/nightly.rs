//! `cargo xtask nightly`: the long forms of what `.ci/run` checks on every change.
//!
//! Every board instead of one of each family, tests that take minutes, each published package built
//! from its own files, and the oldest compiler that the manifests promise. A step that fails does
//! not end the others; the table at the end names it.

use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Seconds for each function of `tests/src/fuzz.rs`.
const FUZZ_S: &str = "60";

/// Tests of the Python package, in an environment of its own, against the program that tests build.
const PYTHON: [&str; 3] = [
    "python3 -m venv target/python",
    "target/python/bin/python -m pip install --quiet ./bindings/python[test] mypy",
    "target/python/bin/python -m pytest bindings/python",
];

/// Runs every step and prints a table of them.
pub(crate) fn run(top: &Path) -> Result<()> {
    let oldest = oldest_compiler(top)?;
    let install = format!("rustup toolchain install {oldest} --profile minimal --no-self-update");
    let check = format!(
        "cargo +{oldest} check --target-dir target/oldest -p linestereo-sim -p linestereo-mavlink"
    );
    let mut steps = vec![
        "cargo xtask images",
        "cargo test --workspace --no-fail-fast -- --include-ignored",
        // The digests of the built-in pairs without debug assertions.
        "cargo run --release --bin xtask-boards -- bless --check",
        "cargo xtask measure",
        "cargo xtask footprint",
        "cargo xtask lint",
        "cargo publish --workspace --dry-run --allow-dirty",
        &install,
        &check,
    ];
    let mut table = String::new();
    let mut failed = Vec::new();
    if has_python() {
        steps.extend(PYTHON);
    } else {
        table.push_str("SKIPPED   Python's tests: install python3 and its module venv\n");
    }
    for &step in &steps {
        println!("\n== {step}");
        let started = Instant::now();
        let mut words = step.split(' ');
        let status = Command::new(words.next().unwrap_or_default())
            .args(words)
            .current_dir(top)
            .env("LINESTEREO_LONG", "1")
            .env("LINESTEREO_FUZZ_S", FUZZ_S)
            .env("LINESTEREO_PROGRAM", top.join("target/debug/linestereo"))
            // Of this program's own build: `cargo +1.93.0` has to choose again.
            .env_remove("CARGO")
            .env_remove("RUSTUP_TOOLCHAIN")
            .status()
            .with_context(|| format!("cannot start {step}"))?;
        let outcome = if status.success() { "" } else { "  FAILED" };
        table.push_str(&format!("{:6.0} s  {step}{outcome}\n", started.elapsed().as_secs_f64()));
        if !status.success() {
            failed.push(step);
        }
    }
    println!("\n{table}");
    if !failed.is_empty() {
        bail!("{} of {} steps failed: {}", failed.len(), steps.len(), failed.join("; "));
    }
    Ok(())
}

/// True where an environment with pip can be made.
fn has_python() -> bool {
    let modules = Command::new("python3").args(["-c", "import ensurepip, venv"]).output();
    modules.is_ok_and(|output| output.status.success())
}

/// The version of the compiler that `rust-version` of the workspace names.
fn oldest_compiler(top: &Path) -> Result<String> {
    let manifest =
        std::fs::read_to_string(top.join("Cargo.toml")).context("cannot read Cargo.toml")?;
    let version =
        manifest.lines().find_map(|line| line.strip_prefix("rust-version = \"")?.strip_suffix('"'));
    Ok(format!("{}.0", version.context("Cargo.toml has no rust-version")?))
}
