//! `cfg(captured)` where captured frames are: tests that need them are ignored elsewhere, and the
//! summary says so. For this package and the laboratory.

use std::path::PathBuf;

fn main() {
    let package = std::env::current_dir().unwrap_or_default();
    let beside = || {
        let top = package.ancestors().find(|at| at.join("Cargo.lock").is_file());
        top.map_or_else(PathBuf::new, |top| top.join("../shared/frames"))
    };
    let root = std::env::var_os("LINESTEREO_FRAMES").map_or_else(beside, PathBuf::from);
    println!("cargo::rustc-check-cfg=cfg(captured)");
    println!("cargo::rerun-if-env-changed=LINESTEREO_FRAMES");
    if root.join("qvga").is_dir() {
        println!("cargo::rustc-cfg=captured");
    }
}
