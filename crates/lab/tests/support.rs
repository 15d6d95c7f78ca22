//! The program as it is called, for every test.

use linestereo_sim::scene::{self, Kind, Sensor};
use linestereo_sim::scene_folder;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// Calls the program in a folder.
pub(crate) fn lab(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_linestereo-lab"))
        .current_dir(folder)
        .args(args)
        .output()
        .unwrap()
}

/// Calls it with 768 MiB of address space, for at most half a minute.
pub(crate) fn bounded(folder: &Path, args: &[&str]) -> Output {
    let call = "ulimit -v 786432; exec timeout 30 \"$0\" \"$@\"";
    let program = env!("CARGO_BIN_EXE_linestereo-lab");
    Command::new("sh").args(["-c", call, program]).args(args).current_dir(folder).output().unwrap()
}

/// Calls it, has it succeed, and gives what it printed.
#[track_caller]
pub(crate) fn succeed(folder: &Path, args: &[&str]) -> String {
    let output = lab(folder, args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Has it fail as it promises: exit code 2, nothing on stdout, one line on stderr that contains
/// these words.
#[track_caller]
pub(crate) fn refused(output: &Output, says: &str) {
    let line = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), line.lines().count()), (Some(2), 1), "{line}");
    assert!(line.starts_with("linestereo-lab: ") && output.stdout.is_empty(), "{line}");
    assert!(line.contains(says), "{line:?} does not say {says}");
}

/// Calls it, has it succeed, and gives the JSON it printed.
#[track_caller]
pub(crate) fn json(folder: &Path, args: &[&str]) -> serde_json::Value {
    serde_json::from_str(&succeed(folder, args)).unwrap()
}

/// A folder with two rendered scenes, `a` and `b`, and their truth.
pub(crate) fn scenes() -> TempDir {
    let folder = TempDir::new().unwrap();
    let dims = linestereo::Dims { width: 160, height: 120 };
    for (name, seed) in [("a", 1), ("b", 2)] {
        let built = scene::build(Kind::Boxes, dims, seed);
        let rendering = scene::render(&built, dims, &Sensor { seed, ..Sensor::default() });
        fs::create_dir(folder.path().join(name)).unwrap();
        for (file, contents) in scene_folder::files(name, &built.pair, &rendering).unwrap() {
            fs::write(folder.path().join(name).join(file), contents).unwrap();
        }
    }
    folder
}
