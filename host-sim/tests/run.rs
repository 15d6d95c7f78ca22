//! `linestereo run` as a user types it: its files, and every kind of bad input.

use crate::support::{all_refused, json, refused, succeed, with_scene};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// A folder with the scene `cards` in it.
fn cards() -> TempDir {
    let folder = with_scene("cards", "160x120", "cards");
    let scene = folder.path().join("cards");
    assert!(scene.is_dir(), "the scene has a folder of its own");
    folder
}

const PAIR: [&str; 5] = ["run", "cards/left.png", "cards/right.png", "--scene", "cards/scene.json"];

fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

#[test]
fn json_has_the_promised_keys_and_shapes() {
    let folder = cards();
    let json = json(folder.path(), &[&PAIR[..], &["--json", "-"]].concat());
    assert_eq!(keys(&json), ["counts", "health", "points", "segments", "size"]);
    assert_eq!(json["size"], serde_json::json!([160, 120]));
    let segments = json["segments"].as_array().unwrap();
    assert!(!segments.is_empty());
    for (id, segment) in segments.iter().enumerate() {
        let expected = ["confidence", "depth_m", "disparity_px", "id", "left", "owner", "sigma_px", "techniques"];
        assert_eq!(keys(segment), expected);
        assert_eq!(segment["id"], id);
        assert_eq!(keys(&segment["techniques"]), ["census", "feature", "window"]);
        assert!(["left", "right", "both"].contains(&segment["owner"].as_str().unwrap()));
        for end in [0, 1] {
            assert!(segment["left"][end][0].is_f64() && segment["left"][end][1].is_f64(), "{segment}");
            assert!(segment["disparity_px"][end].is_f64() && segment["depth_m"][end].is_f64(), "{segment}");
        }
        assert!((0.0..=1.0).contains(&segment["confidence"].as_f64().unwrap()));
    }
    for point in json["points"].as_array().unwrap() {
        assert!(point[0].is_u64() && point[1].is_u64() && point[2].is_f64() && point[3].is_f64(), "{point}");
    }
    let count = |name: &str| json["counts"][name].as_u64().unwrap_or_else(|| panic!("{name} is not counted"));
    let rejected: u64 = linestereo::Rejection::ALL.iter().map(|reason| count(reason.name())).sum();
    assert_eq!(count("segments_left"), count("matched") + rejected);
    assert_eq!(count("matched") as usize, segments.len());
    assert!(count("segments_right") > 0);
    let health = &json["health"];
    let named = [
        "flags",
        "least_disparity_px",
        "left",
        "range",
        "right",
        "row_drift_px",
        "row_offset_px",
        "rows",
        "skew_us",
        "still",
        "tear",
    ];
    assert_eq!(keys(health), named);
    assert_eq!(health["flags"], serde_json::json!([]));
    assert!(health["skew_us"].is_null() && health["row_drift_px"].is_null(), "a single file has neither: {health}");
    assert_eq!(keys(&health["left"]), ["black", "detail", "level", "view", "white"]);
    let rows = |name: &str| health["rows"][name].as_f64().unwrap();
    let is_level = || rows("spread_px") < 0.1 && rows("offset_px").abs() <= 0.2;
    assert!(health["rows"].is_null() || is_level(), "{health}");
}

#[test]
fn without_a_rig_there_are_no_metres() {
    let folder = cards();
    let json = json(folder.path(), &["run", "cards/left.png", "cards/right.png", "--json", "-"]);
    assert!(json["segments"].as_array().unwrap().iter().all(|segment| segment["depth_m"].is_null()));
}

#[test]
fn files_are_written_and_named() {
    let folder = cards();
    let files = ["--json", "a.json", "--csv", "a.csv", "--overlay", "a.png"];
    let text = succeed(folder.path(), &[&PAIR[..], &files].concat());
    for file in ["a.json", "a.csv", "a.png"] {
        assert!(text.contains(&format!("wrote {file}")), "{text}");
        assert!(fs::metadata(folder.path().join(file)).unwrap().len() > 100, "{file}");
    }
    assert!(image::open(folder.path().join("a.png")).unwrap().width() >= 160);
}

#[test]
fn bad_input_gets_one_line_and_leaves_no_file() {
    let folder = cards();
    let write = |name: &str, width: u32, height: u32, grey: u8| {
        image::GrayImage::from_pixel(width, height, image::Luma([grey])).save(folder.path().join(name)).unwrap();
    };
    write("tiny.png", 1, 1, 9);
    write("flat.png", 160, 120, 90);
    write("white.png", 160, 120, 255);
    write("other.png", 100, 120, 90);
    fs::write(folder.path().join("text.png"), "no image").unwrap();
    let before = fs::read_dir(folder.path()).unwrap().count();
    let left = "cards/left.png";
    let cases: [(&[&str], &str); 12] = [
        (&["run", left, "missing.png"], "missing.png"),
        (&["run", left, "other.png"], "size"),
        (&["run", left, "text.png"], "text.png"),
        (&["run", "tiny.png", "tiny.png"], "tiny.png"),
        (&["run", "flat.png", "flat.png"], "flat.png"),
        (&["run", "white.png", "white.png"], "white.png"),
        (&["run", left, left, "--max-disparity", "160"], "--max-disparity"),
        (&["run", left, left, "--max-disparity", "3"], "--max-disparity"),
        (&["run", left, left, "--min-disparity", "5"], "--min-disparity"),
        (&["run", left, left, "--min-confidence", "2"], "--min-confidence"),
        (&["run", left, left, "--margin-m", "0.1", "0.1"], "--focal-px"),
        (&["run", left, left, "--focal-px", "0", "--baseline-m", "0.1"], "focal"),
    ];
    for (args, says) in cases {
        let args = [args, &["--json", "out.json", "--overlay", "out.png"]].concat();
        all_refused(folder.path(), &[(&args, says)]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), before, "{args:?} left a file");
    }
    refused(folder.path(), &[&PAIR[..], &["--json", "a.json", "--csv", "no/such/folder/a.csv"]].concat());
    assert!(!folder.path().join("a.json").exists(), "one file could not be written, so none is");
}

#[test]
fn sectors_are_listed_drawn_and_told() {
    let folder = cards();
    let extra = ["--sectors", "--fan", "fan.png", "--mavlink", "told.bin"];
    let text = succeed(folder.path(), &[&PAIR[..], &extra].concat());
    assert!(text.contains("sectors of 5 degrees, up to 10 m\n") && text.contains("wrote told.bin\n"), "{text}");
    let json = json(folder.path(), &[&PAIR[..], &["--sectors", "--json", "-"]].concat());
    let sectors = json["sectors"].as_array().unwrap();
    assert_eq!(sectors.len(), 72);
    let state = |index: usize| sectors[index]["state"].as_str().unwrap();
    assert!((10..63).all(|index| state(index) == "outside"));
    assert!((0..72).any(|index| state(index) == "obstacle"), "{json}");
    let told = fs::read(folder.path().join("told.bin")).unwrap();
    // HEARTBEAT, then OBSTACLE_DISTANCE with the same distances.
    assert_eq!((told.len(), told[0], told[7], told[21], told[28]), (21 + 179, 0xfd, 0, 0xfd, 330_u16.to_le_bytes()[0]));
    for (index, sector) in sectors.iter().enumerate() {
        let at = 21 + 10 + 8 + 2 * index;
        let cm = u16::from_le_bytes([told[at], told[at + 1]]);
        if let Some(metres) = sector["distance_m"].as_f64() {
            assert!(f64::from(cm) <= (100.0 * metres).round(), "{sector}: {cm} cm"); // widened: a neighbour may be nearer
        }
        assert!(cm != u16::MAX || state(index) != "obstacle", "{sector}");
        assert!(state(index) != "outside" || cm == u16::MAX);
    }
    assert!(fs::metadata(folder.path().join("fan.png")).unwrap().len() > 1000);
}

#[test]
fn sectors_without_sense_are_refused() {
    let folder = cards();
    let with = |more: &[&'static str]| [&PAIR[..], more].concat();
    let cases: [(&[&str], &str); 4] = [
        (&["run", "cards/left.png", "cards/right.png", "--sectors"], "--focal-px and --baseline-m"),
        (
            &with(&["--sectors", "--sector-range", "1000"]),
            "linestereo: range (m) is 1000, allowed are 0.1 to 600; change --sector-range\n",
        ),
        (&with(&["--sectors", "--sector-heights", "2", "1"]), "change --sector-heights\n"),
        (&with(&["--policy", "silent"]), "--mavlink"),
    ];
    all_refused(folder.path(), &cases);
}
