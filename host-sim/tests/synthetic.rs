//! The commands around synthetic scenes, as a user types them.

use crate::support::{Folder, all_refused, succeed, tells};
use std::fs;

#[test]
fn without_arguments_it_shows_a_room_and_writes_a_picture() {
    let folder = Folder::new();
    let words =
        ["probability", "near card", "Segments: ", "Points: ", "Picture: linestereo-demo.png"];
    let text = tells(folder.path(), "", &words);
    assert!(image::open(folder.path().join("linestereo-demo.png")).unwrap().width() >= 320);
    assert_eq!(text, succeed(folder.path(), "demo"), "the same again, by its name");
}

#[test]
fn every_kind_of_scene_is_rendered() {
    let folder = Folder::new();
    let list = succeed(folder.path(), "scene --list");
    succeed(folder.path(), "scene --kind all --size 160x120 --noise 2 out");
    for line in list.lines() {
        let name = line.split_whitespace().next().unwrap();
        for file in ["left.png", "right.png", "gt.png", "visible.png", "objects.png", "scene.json"]
        {
            assert!(folder.path().join("out").join(name).join(file).is_file(), "{name}/{file}");
        }
    }
}

#[test]
fn the_seed_decides_every_byte() {
    let folder = Folder::new();
    for (name, seed) in [("a", "3"), ("b", "3"), ("c", "4")] {
        succeed(folder.path(), &format!("scene --size 64x48 --seed {seed} {name}"));
    }
    let file = |name: &str| fs::read(folder.path().join(name).join("right.png")).unwrap();
    assert!(file("a") == file("b") && file("a") != file("c"));
}

#[test]
fn bad_requests_are_refused_in_one_line() {
    let folder = Folder::new();
    let cases: [(&str, &str); 7] = [
        ("scene", "FOLDER"),
        ("scene --kind castle out", "castle"),
        ("scene --size 15x15 out", "16x16"),
        ("scene --size 320 out", "320x240"),
        ("scene --noise -1 out", "0 to 255"),
        ("demo --out missing/picture.png", "missing/picture.png"),
        ("demo --out .", "write"),
    ];
    all_refused(folder.path(), &cases);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
