//! `linestereo compare` as a user calls it.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn call(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_linestereo")).current_dir(folder).args(arguments).output().unwrap()
}

fn stdout(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Two scenes with truth.
fn scenes(folder: &Path) {
    for name in ["a", "b"] {
        let output = call(folder, &["scene", name, "--size", "160x120"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn scores_a_table_a_picture_and_json() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    scenes(at);
    let methods = ["compare", ".", "--methods", "linestereo,bm,census,sgm4", "--window", "5x5"];
    let text = stdout(&call(at, &[&methods[..], &["--picture", "maps.png", "--json", "scores.json"]].concat()));
    assert!(text.starts_with("2 pairs\n"), "{text}");
    for method in ["linestereo", "bm", "census", "sgm4"] {
        // One for points, one for objects.
        assert_eq!(text.lines().filter(|line| line.split_whitespace().next() == Some(method)).count(), 2, "{text}");
    }
    let json: Value = serde_json::from_slice(&std::fs::read(at.join("scores.json")).unwrap()).unwrap();
    assert_eq!((json["frames"].as_u64(), json["scenes"].as_array().map(Vec::len)), (Some(2), Some(2)));
    let census = &json["methods"][2];
    assert_eq!((census["method"].as_str(), census["has_confidence"].as_bool()), (Some("census"), Some(true)));
    assert!(census["all"]["points_per_frame"].as_f64().unwrap() > 1000.0, "{census}");
    let picture = image::open(at.join("maps.png")).unwrap();
    assert_eq!(picture.width(), 5 * 164); // a row per scene: its image and four maps, 4 px between them
    assert_eq!(picture.height(), 2 * 140);
}

#[test]
fn the_same_scores_whatever_the_number_of_threads_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    scenes(at);
    let scores = || {
        let json =
            stdout(&call(at, &["compare", ".", "--methods", "bm,scan-line,sparse-block,pushbroom", "--json", "-"]));
        let json: Value = serde_json::from_str(&json).unwrap();
        let methods = json["methods"].as_array().unwrap().clone();
        methods.into_iter().map(|m| (m["method"].clone(), m["all"].clone(), m["curve"].clone())).collect::<Vec<_>>()
    };
    assert_eq!(scores(), scores());
}

#[test]
fn two_images_need_no_truth() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    scenes(at);
    let text = stdout(&call(
        at,
        &["compare", "a/left.png", "a/right.png", "--methods", "linestereo,sad", "--max-disparity", "48"],
    ));
    let sad = text.lines().find(|line| line.starts_with("sad")).unwrap();
    assert!(sad.contains("-/-"), "{text}"); // a yield, and nothing to be right or wrong against
    assert!(sad.split_whitespace().nth(1).unwrap().parse::<u32>().unwrap() > 1000, "{text}");
}

#[test]
fn after_steps_have_a_table_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    scenes(at);
    let text = stdout(&call(at, &["compare", "a", "--after-steps"]));
    for step in
        ["parabola", "equiangular", "gradient descent", "median", "speckle", "left-right", "neighbours", "surfaces"]
    {
        assert!(text.contains(step), "{step} is missing in\n{text}");
    }
}

#[test]
fn without_opencv_it_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    scenes(at);
    let text = stdout(&call(at, &["compare", "a", "--methods", "bm", "--opencv", "--python", "no-such-python"]));
    assert!(text.contains("without OpenCV: cannot run no-such-python") && text.contains("--python"), "{text}");
    assert!(text.lines().any(|line| line.starts_with("bm ")), "{text}");
}

#[test]
fn what_is_wrong_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    scenes(at);
    for (arguments, what) in [
        (&["compare", "a", "--methods", "bmm"][..], "there is no method bmm; give linestereo, bm"),
        (&["compare", "a", "--after", "blur"], "there is no step blur; give"),
        (&["compare", "a", "--window", "4x4"], "give two odd sides"),
        (&["compare", "a", "--max-disparity", "200"], "does not fit an image of 160x120; change --max-disparity"),
        (&["compare", "a", "--least-confidence", "2"], "--least-confidence is 2; give 0 to 1"),
        (&["compare", "none"], "none"),
    ] {
        let output = call(at, arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.starts_with("linestereo: ") && error.lines().count() == 1 && error.contains(what), "{error}");
    }
}
