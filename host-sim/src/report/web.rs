//! The page of `bindings/web`, built: style, scripts and both modules in one file that needs no server and no network.
//!
//! ```text
//! bindings/c     the core for wasm32 with simd128   matcher
//! bindings/web   images to grey, as the PC does     images
//! both           gzip, base64                       into the page, with its drawing, and what to do about each flag of health
//! ```

use super::{DRAWING, SHARED_STYLE};
use crate::board::toolchain::rustup;
use crate::results::health;
use anyhow::{Context, Result, bail};
use base64::{Engine as _, prelude::BASE64_STANDARD};
use flate2::{Compression, write::GzEncoder};
use std::io::Write;
use std::path::{Path, PathBuf};

const TARGET: &str = "wasm32-unknown-unknown";
/// Largest page, bytes.
pub const MOST_BYTES: usize = 200 << 10;

/// The page and its modules in a folder.
#[derive(Clone, Debug)]
pub struct WebPage {
    /// `index.html`, all that a browser needs.
    pub page: PathBuf,
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
    let html = html(&top.join("bindings/web/page"), &matcher, &images)?;
    std::fs::write(&page, html).with_context(|| format!("cannot write {}", page.display()))?;
    Ok(WebPage { page, matcher, images })
}

/// The setting of cargo with which the core has its kernels for WebAssembly.
pub fn vectors() -> String {
    format!("target.{TARGET}.rustflags=[\"-Ctarget-feature=+simd128\"]")
}

/// A module of the package in this folder, built for browsers by these arguments of cargo.
pub fn module(top: &Path, built: &Path, package: &str, name: &str, arguments: &[&str]) -> Result<PathBuf> {
    let mut cargo = rustup(top, TARGET)?.cargo();
    cargo.current_dir(top.join(package)).args(arguments).args(["--release", "--locked", "--target", TARGET]);
    cargo.arg("--target-dir").arg(built).args(["--config", "profile.release.strip=true"]);
    let output = cargo.output().context("cannot start cargo")?;
    if !output.status.success() {
        bail!("{package} is not built for {TARGET}: {}", String::from_utf8_lossy(&output.stderr));
    }
    Ok(built.join(TARGET).join("release").join(name))
}

fn html(source: &Path, matcher: &Path, images: &Path) -> Result<String> {
    let text = |name: &str| -> Result<String> {
        let path = source.join(name);
        String::from_utf8(bytes(&path)?).with_context(|| format!("{} is not text", path.display()))
    };
    // Behind what it imports it needs no imports.
    let script = text("page.js")?;
    let own: String = script.split_inclusive('\n').filter(|line| !line.starts_with("import ")).collect();
    let parts = [
        ("/*STYLE*/", lean(SHARED_STYLE)),
        ("/*ADVICE*/", serde_json::to_string(&health::ADVICE)?.replace('<', "\\u003c")),
        ("/*MATCHER*/", packed(matcher)?),
        ("/*IMAGES*/", packed(images)?),
        ("/*SCRIPT*/", lean(&[&text("linestereo.js")?, DRAWING, &own].concat())),
    ];
    let mut html = text("index.html")?;
    for (place, part) in parts {
        let (before, after) = html.split_once(place).with_context(|| format!("index.html has no {place}"))?;
        html = [before, &part, after].concat();
    }
    Ok(html)
}

/// Without indentation and lines of comments.
fn lean(text: &str) -> String {
    let lines = text.lines().map(str::trim_start).filter(|line| !line.is_empty() && !line.starts_with("//"));
    lines.flat_map(|line| [line, "\n"]).collect()
}

fn packed(module: &Path) -> Result<String> {
    let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
    gzip.write_all(&bytes(module)?)?;
    Ok(BASE64_STANDARD.encode(gzip.finish()?))
}

/// A file of the project itself.
fn bytes(path: &Path) -> Result<Vec<u8>> {
    linestereo_frames::untrusted::read(path, linestereo_frames::untrusted::SETTINGS_BYTES)
        .with_context(|| format!("cannot read {}", path.display()))
}
