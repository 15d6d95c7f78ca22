//! `linestereo-lab compare`.

use crate::support::{bounded, lab, refused, scenes, succeed};
use serde_json::Value;
use std::fs;
use std::io::Write as _;
use tempfile::TempDir;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

#[test]
fn scores_a_table_and_json_whatever_the_number_of_threads() {
    let folder = scenes();
    let at = folder.path();
    let call = ["compare", ".", "--no-times", "--json", "scores.json"];
    let text = succeed(at, &call);
    assert!(text.starts_with("2 pairs\n"), "{text}");
    // One line for points, one for cells, one for objects.
    let is_ours = |line: &&str| line.split_whitespace().next() == Some("linestereo");
    assert_eq!(text.lines().filter(is_ours).count(), 3, "{text}");
    let scores = fs::read(at.join("scores.json")).unwrap();
    let json: Value = serde_json::from_slice(&scores).unwrap();
    assert_eq!(json["frames"].as_u64(), Some(2));
    assert_eq!(json["methods"][0]["method"].as_str(), Some("linestereo"));
    assert_eq!(text, succeed(at, &[&call[..], &["--threads", "1"]].concat()));
    assert_eq!(scores, fs::read(at.join("scores.json")).unwrap());
}

#[test]
fn pairs_need_no_truth_and_no_opencv() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let drawn = scenes();
    for side in ["left.png", "right.png"] {
        fs::copy(drawn.path().join("a").join(side), at.join(side)).unwrap();
    }
    let text = succeed(at, &["compare", ".", "--opencv", "--python", "no-such-python"]);
    assert!(
        text.contains("without OpenCV: cannot run no-such-python") && text.contains("--python"),
        "{text}"
    );
    // A yield, and nothing to be right or wrong against.
    let ours = text.lines().find(|line| line.starts_with("linestereo")).unwrap();
    assert!(ours.contains("-/-"), "{text}");
    assert!(ours.split_whitespace().nth(1).unwrap().parse::<u32>().unwrap() > 1000, "{text}");
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
    let text = succeed(at, &["compare", ".", "--no-times"]);
    assert!(text.starts_with("1 pair\n"), "{text}");
    assert!(text.contains("pairs were left out, the first: b: "), "{text}");
    // Nothing that can be compared is an error.
    fs::write(at.join("a/left.png"), "no image").unwrap();
    refused(&lab(at, &["compare", "."]), "no pair can be compared; a: ");
}

#[test]
fn what_is_wrong_is_one_line() {
    let folder = scenes();
    let at = folder.path();
    let range = "does not fit an image of 160x120; change --max-disparity";
    refused(&lab(at, &["compare", "a", "--max-disparity", "200"]), range);
    refused(&lab(at, &["compare", "none"]), "none");
}

#[test]
fn scenes_are_scored_by_models_of_the_others() {
    let folder = scenes();
    let text = succeed(folder.path(), &["fit-confidence", ".", "--undamaged"]);
    assert!(
        text.contains("one answer per cell") && text.contains("Single pixels that are visible"),
        "{text}"
    );
}

#[test]
fn an_array_is_unpacked_as_far_as_its_header_says() {
    let folder = TempDir::new().unwrap();
    let mut image = b"P5\n64 48\n255\n".to_vec();
    image.extend((0..64 * 48_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8));
    for side in ["left", "right"] {
        fs::write(folder.path().join(format!("{side}.pgm")), &image).unwrap();
    }
    let header = |shape: &str| {
        let text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
        [b"\x93NUMPY\x01\x00".as_slice(), &(text.len() as u16).to_le_bytes(), text.as_bytes()]
            .concat()
    };
    for (shape, says) in
        [("(16000, 16000)", "is not an image"), ("(48, 63)", "give two images of one size")]
    {
        let mut archive = ZipWriter::new(fs::File::create(folder.path().join("disp.npz")).unwrap());
        archive.start_file("disp.npy", SimpleFileOptions::default()).unwrap();
        archive.write_all(&header(shape)).unwrap();
        for _ in 0..640 {
            archive.write_all(&[0x3f; 1 << 20]).unwrap();
        }
        archive.finish().unwrap();
        refused(&bounded(folder.path(), &["faults", "."]), says);
    }
}
