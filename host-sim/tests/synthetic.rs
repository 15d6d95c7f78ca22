//! The commands around synthetic scenes, as a user types them.

use crate::support::{linestereo, stdout};
use std::fs;
use tempfile::TempDir;

/// Fails with exit code 2 and one line on stderr, and leaves nothing behind.
fn assert_refused(args: &[&str], says: &str) {
    let folder = TempDir::new().unwrap();
    let output = linestereo(folder.path(), args);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), error.lines().count()), (Some(2), 1), "{args:?}: {error}");
    assert!(error.starts_with("linestereo: ") && error.contains(says), "{args:?}: {error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{args:?}");
}

#[test]
fn without_arguments_it_shows_a_room_and_writes_a_picture() {
    let folder = TempDir::new().unwrap();
    let text = stdout(&linestereo(folder.path(), &[]));
    for word in ["probability", "near card", "Segments: ", "Points: ", "Picture: linestereo-demo.png"] {
        assert!(text.contains(word), "{word:?} is not in\n{text}");
    }
    assert!(image::open(folder.path().join("linestereo-demo.png")).unwrap().width() >= 320);
    assert_eq!(text, stdout(&linestereo(folder.path(), &["demo"])), "the same again, by its name");
}

#[test]
fn rendered_scenes_can_be_scored_and_matched() {
    let folder = TempDir::new().unwrap();
    let list = stdout(&linestereo(folder.path(), &["scene", "--list"]));
    stdout(&linestereo(folder.path(), &["scene", "--kind", "all", "--size", "160x120", "--noise", "2", "out"]));
    let scores = stdout(&linestereo(folder.path(), &["eval", "out"]));
    for line in list.lines() {
        let name = line.split_whitespace().next().unwrap();
        assert!(scores.contains(name), "{name} is not in\n{scores}");
        for file in ["left.png", "right.png", "gt.png", "visible.png", "objects.png", "scene.json"] {
            assert!(folder.path().join("out").join(name).join(file).is_file(), "{name}/{file}");
        }
    }
    let pair = ["run", "out/cards/left.png", "out/cards/right.png", "--scene", "out/cards/scene.json"];
    assert!(!stdout(&linestereo(folder.path(), &pair)).is_empty());
}

#[test]
fn the_seed_decides_every_byte() {
    let folder = TempDir::new().unwrap();
    for (name, seed) in [("a", "3"), ("b", "3"), ("c", "4")] {
        stdout(&linestereo(folder.path(), &["scene", "--size", "64x48", "--seed", seed, name]));
    }
    let file = |name: &str| fs::read(folder.path().join(name).join("right.png")).unwrap();
    assert!(file("a") == file("b") && file("a") != file("c"));
}

#[test]
fn bad_requests_are_refused_in_one_line() {
    assert_refused(&["scene"], "FOLDER");
    assert_refused(&["scene", "--kind", "castle", "out"], "castle");
    assert_refused(&["scene", "--size", "15x15", "out"], "16x16");
    assert_refused(&["scene", "--size", "320", "out"], "320x240");
    assert_refused(&["scene", "--noise", "-1", "out"], "0 to 255");
    assert_refused(&["scene", "--gain", "nan", "out"], "0 to 16");
    assert_refused(&["demo", "--out", "missing/picture.png"], "missing/picture.png");
    assert_refused(&["demo", "--out", "."], "write");
}
