//! The page of `bindings/web`, built: style, scripts and both modules in one file that needs no
//! server and no network.
//!
//! ```text
//! bindings/c     the core for wasm32 with simd128   matcher
//! bindings/web   images to grey, as the PC does     images
//! both           gzip, base64                       into the page, with its drawing, and what to do about each flag of health
//! ```

use anyhow::{Context, Result, bail};
use base64::{Engine as _, prelude::BASE64_STANDARD};
use linestereo_wire::Health;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
/// Largest page, bytes. It takes about 253 KiB.
pub const MOST_BYTES: usize = 264 << 10;

/// The page and its modules in a folder.
#[derive(Clone, Debug)]
pub struct WebPage {
    /// `index.html`, all that a browser needs.
    pub page: PathBuf,
    /// The core.
    pub matcher: PathBuf,
    /// The reader of images.
    pub images: PathBuf,
}

/// Builds the page into `folder`. `top` is the top of the repository.
pub fn build(top: &Path, folder: &Path) -> Result<WebPage> {
    let (built, vectors) = (folder.join("cargo"), vectors());
    let matcher = ["rustc", "--crate-type", "cdylib", "--config", &vectors];
    let matcher = module(top, &built, "bindings/c", "linestereo_c.wasm", &matcher)?;
    let images = module(top, &built, "bindings/web", "linestereo_web.wasm", &["build"])?;
    let page = folder.join("index.html");
    let html = html(top, &matcher, &images)?;
    fs::write(&page, html).with_context(|| format!("cannot write {}", page.display()))?;
    Ok(WebPage { page, matcher, images })
}

/// The setting of cargo with which the core has its kernels for WebAssembly.
pub fn vectors() -> String {
    format!("target.{TARGET}.rustflags=[\"-Ctarget-feature=+simd128\"]")
}

/// A module of the package in this folder, built for browsers by these arguments of cargo.
pub fn module(
    top: &Path,
    built: &Path,
    package: &str,
    name: &str,
    arguments: &[&str],
) -> Result<PathBuf> {
    let mut cargo = cargo(top)?;
    cargo
        .current_dir(top.join(package))
        .args(arguments)
        .args(["--release", "--locked", "--target", TARGET]);
    cargo.arg("--target-dir").arg(built).args(["--config", "profile.release.strip=true"]);
    let output = cargo.output().context("cannot start cargo")?;
    if !output.status.success() {
        bail!("{package} is not built for {TARGET}: {}", String::from_utf8_lossy(&output.stderr));
    }
    Ok(built.join(TARGET).join("release").join(name))
}

/// A cargo for this target, without what the builds of a PC or a board set.
fn cargo(top: &Path) -> Result<Command> {
    let rustc =
        |arguments: &[&str]| Command::new("rustc").args(arguments).current_dir(top).output();
    let has_target = || {
        let found = rustc(&["--print", "target-libdir", "--target", TARGET]).ok()?;
        let folder = String::from_utf8(found.stdout).ok()?;
        Path::new(folder.trim()).is_dir().then_some(())
    };
    if has_target().is_none() {
        eprintln!("rustup target add {TARGET}");
        let added =
            Command::new("rustup").args(["target", "add", TARGET]).current_dir(top).status();
        if has_target().is_none() {
            let why = added.map_or_else(|error| error.to_string(), |status| status.to_string());
            bail!("`rustup target add {TARGET}` does not work here ({why})");
        }
    }
    let mut cargo = Command::new("cargo");
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        if text.starts_with("CARGO_PROFILE_")
            || text.starts_with("CARGO_TARGET_")
            || text.contains("RUSTFLAGS")
        {
            cargo.env_remove(name);
        }
    }
    Ok(cargo)
}

fn html(top: &Path, matcher: &Path, images: &Path) -> Result<String> {
    let read = |path: &Path| {
        fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
    };
    let text = |name: &str| read(&top.join("bindings/web/page").join(name));
    let shared = |name: &str| read(&top.join("host-sim/src/report").join(name));
    // Behind what it imports it needs no imports.
    let script = text("page.js")?;
    let own: String =
        script.split_inclusive('\n').filter(|line| !line.starts_with("import ")).collect();
    let parts = [
        ("/*STYLE*/", lean(&(shared("base.css")? + &shared("shared.css")?))),
        ("/*ADVICE*/", serde_json::to_string(&Health::ADVICE)?.replace('<', "\\u003c")),
        ("/*MATCHER*/", packed(matcher)?),
        ("/*IMAGES*/", packed(images)?),
        ("/*SCRIPT*/", lean(&(text("linestereo.js")? + &shared("drawing.js")? + &own))),
    ];
    let mut html = text("index.html")?;
    for (place, part) in parts {
        let (before, after) =
            html.split_once(place).with_context(|| format!("index.html has no {place}"))?;
        html = [before, &part, after].concat();
    }
    Ok(html)
}

/// Without indentation and lines of comments.
fn lean(text: &str) -> String {
    let lines = text
        .lines()
        .map(str::trim_start)
        .filter(|line| !line.is_empty() && !line.starts_with("//"));
    lines.flat_map(|line| [line, "\n"]).collect()
}

fn packed(module: &Path) -> Result<String> {
    let bytes = fs::read(module).with_context(|| format!("cannot read {}", module.display()))?;
    let mut gzip = Vec::new();
    zopfli::compress(zopfli::Options::default(), zopfli::Format::Gzip, &*bytes, &mut gzip)?;
    Ok(BASE64_STANDARD.encode(gzip))
}
