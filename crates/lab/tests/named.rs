//! Commands of the laboratory that documents and the help of the program name.

use crate::support::succeed;
use std::fs;
use std::path::{Path, PathBuf};

/// Files below a folder, or the file itself.
fn files(path: PathBuf, list: &mut Vec<PathBuf>) {
    if path.is_dir() {
        let entries = fs::read_dir(path).unwrap();
        entries.for_each(|entry| files(entry.unwrap().path(), list));
    } else {
        list.push(path);
    }
}

#[test]
fn commands_that_are_named_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let help = succeed(&root, &["--help"]);
    let mut paths = Vec::new();
    for place in ["README.md", "docs", "host-sim/src/commands"] {
        files(root.join(place), &mut paths);
    }
    let (mut unknown, mut known) = (Vec::new(), 0);
    for path in paths {
        let text = fs::read_to_string(&path).unwrap_or_default(); // pictures
        for after in text.split("linestereo-lab ").skip(1) {
            let command =
                after.split(|c: char| !c.is_ascii_lowercase() && c != '-').next().unwrap();
            if help.contains(&format!("\n  {command} ")) {
                known += 1;
            } else {
                unknown.push(format!("{}: linestereo-lab {command}", path.display()));
            }
        }
    }
    assert!(unknown.is_empty(), "{}", unknown.join("\n"));
    assert!(known > 10, "{known}");
}
