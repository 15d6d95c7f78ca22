//! `cargo xtask`: results and the page for browsers are made here, which takes little to build.
//! Everything about boards is in `xtask-boards`, which is compiled when it is asked for.

use anyhow::{Context, Result};
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, ExitCode};
use xtask::{results, web};

/// A failure is one line on stderr and exit code 2.
fn main() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let done = match arguments.first().and_then(|first| first.to_str()) {
        Some("web") if arguments.len() == 1 => page(),
        Some("results") => {
            top().and_then(|top| results::run(top, &arguments[1..])).map(|()| ExitCode::SUCCESS)
        }
        _ => boards(&arguments),
    };
    done.unwrap_or_else(|error| {
        eprintln!("xtask: {error:#}");
        ExitCode::from(2)
    })
}

fn top() -> Result<&'static Path> {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("no folder above xtask")
}

fn page() -> Result<ExitCode> {
    let top = top()?;
    let folder = top.join("target/web");
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make {}", folder.display()))?;
    let page = web::build(top, &folder)?.page;
    let bytes = std::fs::metadata(&page)?.len();
    println!(
        "{}\n  {bytes} bytes, everything in it: open it, or serve it as it is",
        page.display()
    );
    Ok(ExitCode::SUCCESS)
}

fn boards(arguments: &[OsString]) -> Result<ExitCode> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    // Of all default packages, as the program is built: by `--package` features differ, and much
    // would be compiled again.
    cargo.args(["run", "--quiet", "--bin", "xtask-boards", "--manifest-path"]);
    cargo.arg(top()?.join("Cargo.toml")).arg("--").args(arguments);
    let status = cargo.status().context("cannot start cargo")?;
    Ok(status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .map_or(ExitCode::FAILURE, ExitCode::from))
}
