//! Evaluation in parts and on several threads: the same bytes as at once, and clear words where parts do not fit.

use crate::support::{linestereo, refused, stdout, succeed};
use std::fs;
use tempfile::TempDir;

/// Five scenes in two folders, and a pair without truth.
fn scenes() -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, seed) in [("set/a", "1"), ("set/b/c", "2"), ("set/d", "3"), ("set/e", "4"), ("set/f", "5")] {
        fs::create_dir_all(folder.path().join(name).parent().unwrap()).unwrap();
        succeed(folder.path(), &["scene", "--size", "96x64", "--noise", "3", "--seed", seed, name]);
    }
    fs::create_dir(folder.path().join("set/bare")).unwrap();
    for side in ["left.png", "right.png"] {
        fs::copy(folder.path().join("set/a").join(side), folder.path().join("set/bare").join(side)).unwrap();
    }
    folder
}

#[test]
fn parts_together_are_the_whole_to_the_last_byte() {
    let folder = scenes();
    let at = folder.path();
    let options = ["eval", "set", "--no-times", "--noise", "2", "--min-confidence", "0.5"];
    let with = |more: &[&'static str]| [&options[..], more].concat();
    let whole = succeed(at, &with(&["--json", "whole.json"]));
    assert!(whole.contains("5 pairs, layout: scene.json") && whole.contains("1 pairs without ground truth"), "{whole}");
    // One thread or several: the same.
    for threads in ["1", "3"] {
        assert_eq!(succeed(at, &[&with(&["--threads"])[..], &[threads]].concat()), whole);
    }
    let json = fs::read(at.join("whole.json")).unwrap();
    // More parts than pairs: the last ones are empty.
    for count in [1_usize, 2, 3, 7] {
        let mut merge = vec!["eval".to_owned(), "--merge".to_owned()];
        // The order in which parts are given does not matter.
        for index in (1..=count).rev() {
            let file = format!("part-{index}-of-{count}.json");
            let shard = format!("{index}/{count}");
            let text = succeed(at, &[&with(&["--shard"])[..], &[&shard, "--json", &file]].concat());
            assert!(text.contains(&format!("part {shard}: ")), "{text}");
            merge.push(file);
        }
        let merge: Vec<&str> = merge.iter().map(String::as_str).collect();
        assert_eq!(succeed(at, &[&merge[..], &["--json", "merged.json"]].concat()), whole, "{count} parts");
        assert!(fs::read(at.join("merged.json")).unwrap() == json, "{count} parts");
        assert_eq!(succeed(at, &[&merge[..], &["--json", "-"]].concat()).as_bytes(), json);
    }
}

#[test]
fn parts_of_a_comparison_are_the_whole_too() {
    let folder = scenes();
    let at = folder.path();
    let options = ["compare", "set", "--methods", "linestereo,bm,census", "--no-times"];
    let whole = succeed(at, &[&options[..], &["--json", "whole.json"]].concat());
    // Refused objects have no numbers: those go through the parts as well.
    assert!(whole.contains("objects: % wrong / % covered"), "{whole}");
    for (shard, file) in [("1/2", "one"), ("2/2", "two")] {
        succeed(at, &[&options[..], &["--shard", shard, "--json", file]].concat());
    }
    assert_eq!(succeed(at, &["compare", "--merge", "one", "two", "--json", "merged.json"]), whole);
    assert!(fs::read(at.join("merged.json")).unwrap() == fs::read(at.join("whole.json")).unwrap());
    let line = refused(at, &["eval", "--merge", "one", "two"]);
    assert!(line.contains("one is no part of an evaluation"), "{line}");
    let line = refused(at, &["compare", "--merge", "one", "two", "--picture", "maps.png"]);
    assert!(line.contains("--picture"), "{line}");
}

#[test]
fn times_are_measured_unless_told_otherwise() {
    let folder = scenes();
    for (more, present) in [(None, true), (Some("--no-times"), false)] {
        let args: Vec<&str> = ["eval", "set", "--json", "-"].into_iter().chain(more).collect();
        let json: serde_json::Value = serde_json::from_str(&succeed(folder.path(), &args)).unwrap();
        for scene in json["scenes"].as_array().unwrap() {
            assert_eq!(scene["milliseconds"].as_f64().is_some_and(|ms| ms > 0.0), present, "{scene}");
        }
    }
    // Parts carry theirs.
    succeed(folder.path(), &["eval", "set", "--shard", "1/1", "--json", "part.json"]);
    let merged = succeed(folder.path(), &["eval", "--merge", "part.json", "--json", "-"]);
    assert!(serde_json::from_str::<serde_json::Value>(&merged).unwrap()["pooled"]["milliseconds"].is_f64());
}

#[test]
fn parts_that_do_not_fit_are_named() {
    let folder = scenes();
    let at = folder.path();
    let part = |shard: &str, file: &str, more: &[&str]| {
        let args = ["eval", "set", "--no-times", "--shard", shard, "--json", file];
        stdout(&linestereo(at, &[&args[..], more].concat()));
    };
    part("1/3", "one", &[]);
    part("2/3", "two", &[]);
    part("2/3", "other", &["--noise", "1"]);
    part("2/4", "four", &[]);
    let says = |args: &[&str], words: &[&str]| {
        let line = refused(at, &[&["eval"][..], args].concat());
        assert!(words.iter().all(|word| line.contains(word)), "{line}");
    };
    says(&["--merge", "one", "two"], &["1 parts are missing: 3/3"]);
    says(&["--merge", "two", "one", "two"], &["two is part 2/3 again"]);
    says(&["--merge", "one", "other"], &["other has another set of options"]);
    says(&["--merge", "one", "four"], &["four has another number of parts"]);
    says(&["--merge", "one", "missing"], &["missing", "check the path"]);
    fs::write(at.join("none"), "{}").unwrap();
    says(&["--merge", "none"], &["none is no part", "--shard"]);
    let text = fs::read_to_string(at.join("two")).unwrap();
    fs::write(at.join("cut"), text.replace("\"segments\":", "\"segment\":")).unwrap();
    says(&["--merge", "one", "cut"], &["cut is no part"]);
    fs::write(at.join("moved"), text.replace("[[1,{", "[[0,{")).unwrap();
    says(&["--merge", "one", "moved"], &["moved does not hold the results of its part"]);
    fs::remove_dir_all(at.join("set/d")).unwrap();
    part("3/3", "less", &[]);
    says(&["--merge", "one", "two", "less"], &["less has another data set"]);

    says(&["set", "--shard", "4/3", "--json", "x"], &["K/N"]);
    says(&["set", "--shard", "1/3"], &["--json"]);
    says(&["set", "--objects", "--shard", "1/3", "--json", "x"], &["--objects"]);
    says(&["--merge", "one", "--threads", "2"], &["--threads"]);
    says(&[], &["FOLDER"]);
    says(&["set/bare"], &["no pair with ground truth"]);
}
