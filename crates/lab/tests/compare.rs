//! `linestereo-lab compare`.

use crate::support::{json, lab, refused, scenes, succeed};
use serde_json::Value;
use std::fs;

#[test]
fn scores_a_table_a_picture_and_json() {
    let folder = scenes();
    let at = folder.path();
    let methods = ["compare", ".", "--methods", "linestereo,bm,census,sgm8"];
    let text =
        succeed(at, &[&methods[..], &["--picture", "maps.png", "--json", "scores.json"]].concat());
    assert!(text.starts_with("2 pairs\n"), "{text}");
    for method in ["linestereo", "bm", "census", "sgm8"] {
        // One for points, one for cells, one for objects.
        assert_eq!(
            text.lines().filter(|line| line.split_whitespace().next() == Some(method)).count(),
            3,
            "{text}"
        );
    }
    let json: Value = serde_json::from_slice(&fs::read(at.join("scores.json")).unwrap()).unwrap();
    assert_eq!(
        (json["frames"].as_u64(), json["scenes"].as_array().map(Vec::len)),
        (Some(2), Some(2))
    );
    let census = &json["methods"][2];
    assert_eq!(
        (census["method"].as_str(), census["has_confidence"].as_bool()),
        (Some("census"), Some(true))
    );
    assert!(census["all"]["points_per_frame"].as_f64().unwrap() > 1000.0, "{census}");
    let picture = image::open(at.join("maps.png")).unwrap();
    assert_eq!(picture.width(), 5 * 164); // a row per scene: its image and four maps, 4 px between them
    assert_eq!(picture.height(), 2 * 140);
}

#[test]
fn the_same_scores_whatever_the_number_of_threads_and_runs() {
    let folder = scenes();
    let at = folder.path();
    let scores = || {
        let json = json(at, &["compare", ".", "--methods", "bm,census,sgm8-strict", "--json", "-"]);
        let methods = json["methods"].as_array().unwrap().clone();
        methods
            .into_iter()
            .map(|m| (m["method"].clone(), m["all"].clone(), m["curve"].clone()))
            .collect::<Vec<_>>()
    };
    assert_eq!(scores(), scores());
}

#[test]
fn two_images_need_no_truth() {
    let folder = scenes();
    let at = folder.path();
    let text = succeed(
        at,
        &[
            "compare",
            "a/left.png",
            "a/right.png",
            "--methods",
            "linestereo,census",
            "--max-disparity",
            "48",
        ],
    );
    let census = text.lines().find(|line| line.starts_with("census")).unwrap();
    assert!(census.contains("-/-"), "{text}"); // a yield, and nothing to be right or wrong against
    assert!(census.split_whitespace().nth(1).unwrap().parse::<u32>().unwrap() > 1000, "{text}");
}

#[test]
fn without_opencv_it_says_so() {
    let folder = scenes();
    let at = folder.path();
    let text =
        succeed(at, &["compare", "a", "--methods", "bm", "--opencv", "--python", "no-such-python"]);
    assert!(
        text.contains("without OpenCV: cannot run no-such-python") && text.contains("--python"),
        "{text}"
    );
    assert!(text.lines().any(|line| line.starts_with("bm ")), "{text}");
}

#[test]
fn what_is_no_scene_costs_itself_alone() {
    let folder = scenes();
    let at = folder.path();
    for (name, scene) in [("broken", "{"), ("calibration", "{\"name\": \"photos\"}")] {
        fs::create_dir(at.join(name)).unwrap();
        fs::write(at.join(name).join("scene.json"), scene).unwrap();
    }
    for side in ["left.png", "right.png"] {
        fs::copy(at.join("a").join(side), at.join("broken").join(side)).unwrap();
        fs::write(at.join("b").join(side), "no image").unwrap();
    }
    let text = succeed(at, &["compare", ".", "--methods", "census", "--no-times"]);
    assert!(text.starts_with("1 pair\n"), "{text}");
    assert!(text.contains("pairs were left out, the first: b: "), "{text}");
    // Nothing that can be compared is an error.
    fs::write(at.join("a/left.png"), "no image").unwrap();
    refused(&lab(at, &["compare", ".", "--methods", "census"]), "no pair can be compared; a: ");
}

#[test]
fn what_is_wrong_is_one_line() {
    let folder = scenes();
    let at = folder.path();
    let cases: [(&[&str], &str); 3] = [
        (&["compare", "a", "--methods", "bmm"], "there is no method bmm; give linestereo, bm"),
        (
            &["compare", "a", "--max-disparity", "200"],
            "does not fit an image of 160x120; change --max-disparity",
        ),
        (&["compare", "none"], "none"),
    ];
    for (args, says) in cases {
        refused(&lab(at, args), says);
    }
}
