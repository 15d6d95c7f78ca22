//! Linker arguments of a board build, and the board's map of flash and RAM. They stand here because
//! the variable `RUSTFLAGS` would replace those of a configuration file.
//!
//! The linker runs at the top of the repository and finds `memory.x` there before any other; that
//! file includes `board.x`, which is written here: `src/boards/NAME.x` of the one board whose
//! feature is on.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../memory.x");
    println!("cargo:rerun-if-changed=src/boards");
    println!("cargo:rustc-check-cfg=cfg(armv8m)");
    if env::var("TARGET").is_ok_and(|target| target.starts_with("thumbv8m")) {
        println!("cargo:rustc-cfg=armv8m");
    }
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let map = map();
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    if let Err(error) = fs::copy(&map, out.join("board.x")) {
        panic!("{} cannot be copied: {error}", map.display());
    }
    println!("cargo:rustc-link-search={}", out.display());
    if let Some(top) =
        env::var_os("CARGO_MANIFEST_DIR").as_deref().map(Path::new).and_then(Path::parent)
    {
        println!("cargo:rustc-link-search={}", top.display());
    }
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if has("log-semihosting") || has("log-rtt") {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}

fn has(feature: &str) -> bool {
    env::var_os(format!("CARGO_FEATURE_{}", feature.to_uppercase().replace('-', "_"))).is_some()
}

/// The map of the board that is built: the features of boards are those that have one.
fn map() -> PathBuf {
    let mut maps: Vec<PathBuf> = fs::read_dir("src/boards")
        .map(|entries| entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect())
        .unwrap_or_default();
    maps.retain(|path| path.extension().is_some_and(|extension| extension == "x"));
    maps.sort();
    let name = |path: &PathBuf| {
        path.file_stem().map(|stem| stem.to_string_lossy().replace('_', "-")).unwrap_or_default()
    };
    let found: Vec<&PathBuf> = maps.iter().filter(|map| has(&name(map))).collect();
    match found[..] {
        [map] => map.clone(),
        _ => panic!(
            "give one board, for example --no-default-features --features {} (found {:?})",
            maps.iter().map(name).collect::<Vec<_>>().join(" or "),
            found.into_iter().map(name).collect::<Vec<_>>()
        ),
    }
}
