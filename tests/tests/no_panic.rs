//! No panic is reachable from the public entry points, as compiled for release.
//!
//! A static library is linked by a linker that leaves out what no entry point reaches.
//! `tests/no-panic` has a panic handler that calls a function which does not exist: it links only
//! without the handler. The library for C has a handler of its own, which must not be among what is
//! linked.

use linestereo_firmware::boards::mps2_an500;
use linestereo_sim::board::{self, firmware, toolchain::Toolchain, top};
use linestereo_tests::board::or_skip;
use object::read::archive::ArchiveFile;
use object::{File, Object, ObjectSymbol};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder in which packages outside of this workspace are built, those of boards beside it: what
/// they have in common is built once.
pub(crate) fn packages() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("packages")
}

/// The same for a toolchain of boards: cargo does not notice another library of the same version.
pub(crate) fn packages_for(toolchain: &Toolchain) -> PathBuf {
    packages().join(format!("cargo-{}", toolchain.way))
}

/// Builds a library for this machine and returns its path. All have the same profile, and share
/// what they are made of.
pub(crate) fn build(manifest: &str, library: &str) -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join(manifest);
    let target = packages().join("cargo");
    let output = Command::new(env!("CARGO"))
        .args(["build", "--release", "--locked", "--manifest-path"])
        .arg(manifest)
        .arg("--target-dir")
        .arg(&target)
        // The proof is about the profile in its manifest, not about flags or targets of whoever
        // runs the tests.
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("CARGO_BUILD_TARGET")
        .output()
        .expect("cargo runs");
    let hint = "when core's dependencies changed: cargo update --workspace --manifest-path with this manifest";
    assert!(output.status.success(), "{}\n{hint}", String::from_utf8_lossy(&output.stderr));
    let names = [format!("lib{library}.a"), format!("{library}.lib")];
    let found =
        names.map(|name| target.join("release").join(name)).into_iter().find(|path| path.is_file());
    found.expect("cargo built a static library")
}

/// Functions of a library whose names begin with `prefix`.
fn entries(library: &Path, prefix: &str) -> Vec<String> {
    let bytes = std::fs::read(library).unwrap();
    let archive = ArchiveFile::parse(&*bytes).unwrap();
    let mut names = BTreeSet::new();
    for member in archive.members() {
        let Ok(file) = File::parse(member.unwrap().data(&*bytes).unwrap()) else { continue };
        let defined = file.symbols().filter(|symbol| symbol.is_definition() && symbol.is_global());
        let found =
            defined.filter_map(|symbol| symbol.name().ok().filter(|name| name.starts_with(prefix)));
        names.extend(found.map(str::to_owned));
    }
    names.into_iter().collect()
}

/// Functions of a C library, which a library for this machine does not hold.
#[cfg(target_os = "linux")]
const OF_C: [&str; 5] = ["memcpy", "memmove", "memset", "memcmp", "bcmp"];

/// Names of what is linked for these entry points, or the linker's errors. `elsewhere` are
/// functions that are not looked for.
fn link(
    linker: &Path,
    library: &Path,
    elsewhere: &[&str],
    entries: &[&str],
) -> Result<BTreeSet<String>, String> {
    let folder = tempfile::tempdir().unwrap();
    let linked = folder.path().join("linked");
    let output = Command::new(linker)
        .args(["-flavor", "gnu", "--gc-sections", "--entry", entries[0], "-o"])
        .arg(&linked)
        .args(entries.iter().map(|entry| format!("--undefined={entry}")))
        .args(elsewhere.iter().map(|name| format!("--defsym={name}=0")))
        .arg(library)
        .output()
        .unwrap();
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let bytes = std::fs::read(&linked).unwrap();
    let file = File::parse(&*bytes).unwrap();
    Ok(file.symbols().filter_map(|symbol| symbol.name().ok().map(str::to_owned)).collect())
}

/// Links every proof of `tests/no-panic`; a control that panics does not link.
fn assert_no_panic(linker: &Path, library: &Path, elsewhere: &[&str]) {
    let proofs = entries(library, "proof_");
    assert_eq!(proofs.len(), 46, "entry points found in the library");
    let panicking =
        proofs.iter().filter(|proof| link(linker, library, elsewhere, &[proof]).is_err());
    let panicking: Vec<_> = panicking.collect();
    assert!(panicking.is_empty(), "a panic is reachable from {panicking:?}");
    let control = link(linker, library, elsewhere, &["control_index"]);
    assert!(
        control.is_err_and(|errors| errors.contains("panic_is_reachable")),
        "the linker overlooks a panic"
    );
}

/// The linker of the compiler in use, for libraries of this machine.
#[cfg(target_os = "linux")]
fn linker() -> PathBuf {
    Toolchain::in_use().linker(&top().unwrap()).unwrap()
}

/// Of the long form where the same is shown for a board: what is compiled for this machine alone,
/// kernels of the core, is in the library for C.
#[cfg(target_os = "linux")]
#[test]
fn no_panic_is_reachable_from_the_public_entry_points() {
    if !board::is_long() && Toolchain::for_target(mps2_an500::BOARD.target).is_ok() {
        return;
    }
    assert_no_panic(&linker(), &build("no-panic/Cargo.toml", "linestereo_no_panic"), &OF_C);
}

#[cfg(target_os = "linux")]
#[test]
fn no_panic_is_reachable_from_c() {
    let library = build("../bindings/c/Cargo.toml", "linestereo_c");
    let mut functions = entries(&library, "linestereo_");
    functions.retain(|name| name != "linestereo_panic");
    assert_eq!(functions.len(), 22, "functions found in the library");
    let linked =
        link(&linker(), &library, &OF_C, &functions.iter().map(String::as_str).collect::<Vec<_>>())
            .unwrap();
    assert!(
        linked.contains("linestereo_run") && !linked.contains("linestereo_panic"),
        "{linked:?}"
    );
}

/// Builds the package of a folder for a processor of boards. Returns the folder of what is built,
/// and what cargo has printed.
pub(crate) fn build_for(
    toolchain: &Toolchain,
    target: &str,
    package: &Path,
    arguments: &[&str],
) -> (PathBuf, Vec<u8>) {
    let folder = packages_for(toolchain);
    let mut cargo = toolchain.cargo();
    cargo.args(["build", "--release", "--locked", "--target", target]).args(arguments);
    let built = cargo.arg("--target-dir").arg(&folder).current_dir(package).output().unwrap();
    assert!(built.status.success(), "{target}: {}", String::from_utf8_lossy(&built.stderr));
    (folder.join(target).join("release"), built.stdout)
}

/// The library of `tests/no-panic` for a Cortex-M7.
pub(crate) fn for_m7(toolchain: &Toolchain) -> PathBuf {
    let package = top().unwrap().join("tests/no-panic");
    let folder = firmware::build_package(toolchain, &mps2_an500::BOARD, &package).unwrap();
    folder.join("liblinestereo_no_panic.a")
}

#[test]
fn no_panic_is_reachable_on_a_board() {
    let Some(toolchain) = or_skip(Toolchain::for_target(mps2_an500::BOARD.target)) else { return };
    let linker = toolchain.linker(&top().unwrap()).unwrap();
    assert_no_panic(&linker, &for_m7(&toolchain), &[]);
}
