//! `cfg(captured)` where captured frames are: tests that need them are ignored elsewhere, and the
//! summary says so.

use std::path::PathBuf;

fn main() {
    let beside = || PathBuf::from("../../shared/frames");
    let root = std::env::var_os("LINESTEREO_FRAMES").map_or_else(beside, PathBuf::from);
    println!("cargo::rustc-check-cfg=cfg(captured)");
    println!("cargo::rerun-if-env-changed=LINESTEREO_FRAMES");
    if root.join("qvga").is_dir() {
        println!("cargo::rustc-cfg=captured");
    }
}
