//! Linker arguments of a board build. They stand here because the variable `RUSTFLAGS` would replace those of a configuration file.
//!
//! The map of flash and RAM is `memory.x` at the top of the repository, which the script of cortex-m-rt includes by that name. The
//! linker runs there and finds that file before any other, so there is one file for all boards: the symbol `board_...` given here picks
//! the board inside it.

use std::env;
use std::path::Path;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../memory.x");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let has = |feature: &str| env::var_os(format!("CARGO_FEATURE_{feature}")).is_some();
    let boards = ["MPS2_AN500", "MPS2_AN386"].into_iter().filter(|board| has(board)).collect::<Vec<_>>();
    let [board] = boards[..] else {
        panic!("give one board: --no-default-features --features mps2-an500 or mps2-an386 (found {boards:?})");
    };
    if let Some(top) = env::var_os("CARGO_MANIFEST_DIR").as_deref().map(Path::new).and_then(Path::parent) {
        println!("cargo:rustc-link-search={}", top.display());
    }
    println!("cargo:rustc-link-arg-bins=--defsym=board_{}=1", board.to_lowercase());
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if has("LOG_SEMIHOSTING") || has("LOG_RTT") {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}
