//! A toolchain made of Debian's packages: the installed compiler, with `core` for boards beside its
//! own libraries.
//!
//! ```text
//! <cache>/linestereo/rustc-<version>/bin/rustc                       the installed compiler, told to look here
//!                                    lib/rustlib/<this PC>/...       its own libraries, the linker
//!                                    lib/rustlib/<target>/lib        core and alloc, one such folder per target
//! ```
//!
//! Each part is made beside it and renamed into place, under a lock of its own: what is there is
//! whole, and targets are made side by side.

use crate::output::tell;
use crate::programs;
use anyhow::{Context, Result, bail};
use core::time::Duration;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const CORE_LIMIT: Duration = Duration::from_secs(900);
/// The compiler, its library's source, and a linker that rustc calls `rust-lld`.
const PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "lld-22"];
/// Checks what is written for boards.
const CLIPPY_PACKAGE: &str = "rust-web-clippy";
const CLIPPY: &str = "/usr/bin/cargo-clippy";
const RUSTC: &str = "/usr/bin/rustc";
pub(super) const CARGO: &str = "/usr/bin/cargo";

#[cfg(unix)]
use std::os::unix::fs::symlink;

#[cfg(not(unix))]
fn symlink(_: impl AsRef<Path>, _: impl AsRef<Path>) -> std::io::Result<()> {
    Err(std::io::Error::other("Debian's packages need a Unix"))
}

/// The folder of the toolchain, made once, with this target.
pub(super) fn toolchain(target: &str) -> Result<PathBuf> {
    if source().is_none() || !Path::new(CARGO).is_file() || linker().is_none() {
        programs::install("a board build", &PACKAGES)?;
    }
    let (version, source) =
        source().context("the source of Debian's rustc is not where it should be")?;
    let linker = linker().context("Debian's lld is not where it should be")?;
    let cache = cache()?;
    fs::create_dir_all(&cache).with_context(|| format!("cannot make {}", cache.display()))?;
    let folder = cache.join(format!("rustc-{version}"));
    // Tests run side by side: one makes a part, the others wait for it.
    let lock = fs::File::create(cache.join("lock"))?;
    lock.lock()?;
    if !folder.is_dir() {
        let unfinished = tempfile::tempdir_in(&cache)?;
        assemble(unfinished.path(), &folder, &linker)?;
        fs::rename(unfinished.keep(), &folder)?;
    }
    drop(lock);
    let libraries = folder.join("lib/rustlib").join(target);
    let lock = fs::File::create(cache.join(format!("lock-{target}")))?;
    lock.lock()?;
    if !libraries.is_dir() {
        tell(&format!(
            "building core for {target} once, about a minute, into {}",
            libraries.display()
        ));
        let unfinished = tempfile::tempdir_in(&cache)?;
        build_core(unfinished.path(), &source, target)?;
        make_readable(unfinished.path())?;
        fs::rename(unfinished.keep(), &libraries)?;
    }
    Ok(folder)
}

/// The clippy of Debian's compiler, installed when it is missing.
pub(super) fn clippy() -> Result<&'static str> {
    if !Path::new(CLIPPY).is_file() {
        programs::install("clippy for boards", &[CLIPPY_PACKAGE])?;
    }
    Ok(CLIPPY)
}

/// The version of Debian's compiler, and where its library's source is, if both are there.
fn source() -> Option<(String, PathBuf)> {
    let line = programs::first_line(Command::new(RUSTC).arg("--version"))?;
    let version = line.split(' ').nth(1)?.to_owned();
    let source = PathBuf::from(format!("/usr/src/rustc-{version}/library"));
    source.is_dir().then_some((version, source))
}

/// The newest of Debian's linkers.
fn linker() -> Option<PathBuf> {
    let versions = (14..100).rev().map(|version| format!("/usr/lib/llvm-{version}/bin/lld"));
    versions.chain(["/usr/bin/lld".to_owned()]).map(PathBuf::from).find(|path| path.is_file())
}

fn cache() -> Result<PathBuf> {
    let base = std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from);
    let base = base.or_else(|| std::env::home_dir().map(|home| home.join(".cache")));
    Ok(base
        .context("there is no home folder for a compiler; set XDG_CACHE_HOME")?
        .join("linestereo"))
}

/// A folder that looks like an installed toolchain: the installed libraries, the linker, and a
/// compiler that looks there.
fn assemble(folder: &Path, final_folder: &Path, linker: &Path) -> Result<()> {
    let printed = |what| {
        programs::first_line(Command::new(RUSTC).args(["--print", what]))
            .context("Debian's rustc does not run")
    };
    let (host, installed) = (printed("host-tuple")?, printed("sysroot")?);
    let libraries = folder.join("lib/rustlib").join(&host);
    fs::create_dir_all(libraries.join("bin"))?;
    fs::create_dir_all(folder.join("bin"))?;
    symlink(
        Path::new(&installed).join("lib/rustlib").join(&host).join("lib"),
        libraries.join("lib"),
    )?;
    symlink(linker, libraries.join("bin/rust-lld"))?;
    let final_folder = final_folder.display();
    let script = format!("#!/bin/sh\nexec {RUSTC} --sysroot \"{final_folder}\" \"$@\"\n");
    let rustc = folder.join("bin/rustc");
    fs::write(&rustc, script)?;
    make_readable(&rustc)?;
    make_readable(folder)
}

/// For everybody, and a program can be run: what is made as a temporary folder is its maker's
/// alone.
#[cfg(unix)]
fn make_readable(path: &Path) -> Result<()> {
    use std::os::unix::fs::PermissionsExt;
    Ok(fs::set_permissions(path, fs::Permissions::from_mode(0o755))?)
}

#[cfg(not(unix))]
fn make_readable(_: &Path) -> Result<()> {
    bail!("Debian's packages need a Unix")
}

/// Builds `core` and `alloc` for a target from Debian's source by an empty package, into the folder
/// `lib` of `folder`.
fn build_core(folder: &Path, source: &Path, target: &str) -> Result<()> {
    let package = tempfile::tempdir()?;
    let at = |name: &str| package.path().join(name);
    fs::create_dir(at("src"))?;
    fs::write(at("src/lib.rs"), "#![no_std]\n")?;
    let manifest = "[package]\nname = \"empty\"\nversion = \"0.0.0\"\nedition = \"2021\"\n\n\
                    [profile.release]\nopt-level = 3\npanic = \"abort\"\n\n[workspace]\n";
    fs::write(at("Cargo.toml"), manifest)?;
    let mut command = Command::new(CARGO);
    command
        .current_dir(package.path())
        .args(["build", "--quiet", "--release", "-Zbuild-std=core,alloc", "--target", target])
        .env_clear()
        .envs(std::env::vars_os().filter(|(name, _)| {
            let name = name.to_string_lossy();
            name == "HOME" || name == "CARGO_HOME" || name.to_ascii_lowercase().ends_with("_proxy")
        }))
        .env("PATH", "/usr/bin:/bin")
        .env("RUSTC", RUSTC)
        // Building the library is an unstable option of cargo; what is built is the compiler's own
        // library.
        .env("RUSTC_BOOTSTRAP", "1")
        // For link-time optimisation through the library.
        .env("RUSTFLAGS", "-Cembed-bitcode=yes");
    let outcome = programs::run(&mut command, CORE_LIMIT)?;
    if !outcome.status.success() {
        let reason =
            outcome.stderr.lines().find(|line| line.starts_with("error")).unwrap_or("it failed");
        bail!("core cannot be built from {}: {reason}", source.display());
    }
    let libraries = folder.join("lib");
    fs::create_dir_all(&libraries)?;
    let mut found = 0;
    for entry in fs::read_dir(at("target").join(target).join("release/deps"))? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let starts = ["libcore-", "liballoc-", "libcompiler_builtins-"];
        if starts.iter().any(|start| name.starts_with(start)) && name.ends_with(".rlib") {
            fs::copy(entry.path(), libraries.join(name))?;
            found += 1;
        }
    }
    if found != 3 {
        bail!("core was built from {}, but {found} of 3 libraries were found", source.display());
    }
    Ok(())
}
