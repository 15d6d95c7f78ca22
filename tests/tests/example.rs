//! The firmware example of the README, built for a Cortex-M7 as a package outside of this workspace.

use linestereo_sim::board::toolchain::Toolchain;
use linestereo_tests::board::or_skip;
use std::path::Path;

const TARGET: &str = "thumbv7em-none-eabihf";

#[test]
fn the_readme_shows_firmware_that_builds() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let source = std::fs::read_to_string(top.join("docs/firmware-example/src/lib.rs")).unwrap();
    let readme = std::fs::read_to_string(top.join("README.md")).unwrap();
    assert!(readme.contains(&format!("```rust\n{source}```\n")), "docs/firmware-example/src/lib.rs is shown as it is");

    let Some(toolchain) = or_skip(Toolchain::for_target(TARGET)) else { return };
    // A copy elsewhere: no configuration of this workspace reaches it.
    let folder = tempfile::tempdir().unwrap();
    let core = top.join("core").canonicalize().unwrap();
    let manifest = std::fs::read_to_string(top.join("docs/firmware-example/Cargo.toml")).unwrap();
    let manifest = manifest.replace("../../core", core.to_str().unwrap());
    std::fs::create_dir(folder.path().join("src")).unwrap();
    std::fs::write(folder.path().join("Cargo.toml"), manifest).unwrap();
    std::fs::write(folder.path().join("src/lib.rs"), source).unwrap();
    // The versions that the workspace has.
    std::fs::copy(top.join("docs/firmware-example/Cargo.lock"), folder.path().join("Cargo.lock")).unwrap();
    let built = toolchain
        .cargo()
        .args(["build", "--release", "--locked", "--target", TARGET, "--target-dir"])
        .arg(Path::new(env!("CARGO_TARGET_TMPDIR")).join("firmware-example"))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
}
