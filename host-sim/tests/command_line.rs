//! The program as a user calls it: what `run --objects`, `sequence` and `report` write, and how
//! they fail.

use crate::rectify;
use crate::support::{
    Folder, all_refused, failed, json, json_lines, linestereo, program, refused, save, says,
    stderr, stdout, succeed, tells, with_drawn_pairs,
};
use linestereo::Dims;
use linestereo_sim::scene::Kind;
use linestereo_tests::drawn::rendered;
use serde_json::Value;
use std::fs;
use std::path::Path;

const DIMS: Dims = Dims { width: 320, height: 240 };

/// `0001_left.png`, `0001_right.png`, ...
fn recording(folder: &Path, frames: u64) {
    for frame in 1..=frames {
        let rendering = rendered(Kind::Boxes, DIMS, 1.0, frame);
        save(&rendering.left, &folder.join(format!("{frame:04}_left.png")));
        save(&rendering.right, &folder.join(format!("{frame:04}_right.png")));
    }
}

const SECTORS: &str = "--sectors --sector-range 4";
const RIG: &str = "--focal-px 300 --baseline-m 0.1";

#[test]
fn a_sequence_is_a_line_per_frame_and_a_broken_frame_is_one_of_them() {
    let at: &Path = &Folder::new();
    recording(at, 4);
    fs::write(at.join("0002_right.png"), b"no image").unwrap();
    fs::create_dir(at.join("boxes")).unwrap();
    fs::write(
        at.join("boxes/0001_left.csv"),
        "x0,y0,x1,y1,name\n40,30,200,200,a\n400,30,500,200,b\n",
    )
    .unwrap();
    fs::write(at.join("boxes/0003_left.json"), "{").unwrap();
    let output = linestereo(at, &format!("sequence . --objects boxes {SECTORS} {RIG}"));
    let lines = json_lines(&stdout(&output));
    assert_eq!(
        lines.iter().map(|line| line["frame"].as_u64().unwrap()).collect::<Vec<_>>(),
        [1, 2, 3, 4]
    );
    assert!(lines[1]["error"].as_str().unwrap().contains("0002_right.png"), "{}", lines[1]);
    for line in [&lines[0], &lines[2], &lines[3]] {
        assert!(
            !line["segments"].as_array().unwrap().is_empty()
                && !line["points"].as_array().unwrap().is_empty()
        );
        assert_eq!(
            line["counts"]["matched"].as_u64().unwrap() as usize,
            line["segments"].as_array().unwrap().len()
        );
    }
    assert_eq!(lines[0]["objects"].as_array().unwrap().len(), 1);
    assert_eq!(
        (&lines[0]["objects"][0]["label"], &lines[0]["objects"][0]["name"]),
        (&0.into(), &"a".into())
    );
    assert!(lines[2]["objects_error"].as_str().unwrap().contains("0003_left.json"));
    assert_eq!(
        (&lines[3]["objects"], &lines[3]["objects_error"]),
        (&Value::Array(vec![]), &Value::Null)
    );
    says(&stderr(&output), &["4 frames, 1 failed"]);

    // The first pair as `run` sees it, but for its frame and name; and lines in a file.
    let pair = "0001_left.png 0001_right.png";
    let mut alone = json(at, &format!("run {pair} --objects boxes --json - {SECTORS} {RIG}"));
    let mut first = lines[0].clone();
    for value in [&mut alone, &mut first] {
        let fields = value.as_object_mut().unwrap();
        fields.remove("frame");
        fields.remove("name");
    }
    assert_eq!(alone, first);
    assert_eq!(first["sectors"].as_array().unwrap().len(), 72);
    let some = "sequence . --frames 3..9 --no-points --out lines.jsonl";
    tells(at, some, &["2 frames, 0 failed"]);
    assert_eq!(fs::read_to_string(at.join("lines.jsonl")).unwrap().lines().count(), 2);
}

#[test]
fn broken_objects_cost_nothing_else() {
    let at: &Path = &Folder::new();
    recording(at, 1);
    fs::write(at.join("broken.json"), "{\"annotations\": [").unwrap();
    let run = "run 0001_left.png 0001_right.png --objects broken.json --json out.json";
    says(&failed(&linestereo(at, run)), &["linestereo: broken.json holds no objects"]);
    let written: Value = serde_json::from_slice(&fs::read(at.join("out.json")).unwrap()).unwrap();
    assert!(!written["segments"].as_array().unwrap().is_empty());
    assert_eq!(written["objects"], Value::Array(vec![]));
}

#[test]
fn a_report_is_one_file() {
    let folder = Folder::new();
    let at = folder.path();
    recording(at, 3);
    tells(at, "report . -o page.html --max-frames 2", &["2 of 3 pairs"]);
    let page = fs::read_to_string(at.join("page.html")).unwrap();
    assert_eq!(page.matches("data:image/jpeg;base64,").count(), 4);
    refused(at, "report nowhere -o page.html", &["is no folder"]);
}

#[test]
fn each_frame_of_a_report_has_its_own_rig() {
    let at: &Path = &with_drawn_pairs();
    let scene = at.join("rec/2/scene.json");
    let mut other: Value = serde_json::from_slice(&fs::read(&scene).unwrap()).unwrap();
    other["rectified"]["focal_px"] = 777.into();
    fs::write(&scene, other.to_string()).unwrap();
    succeed(at, "report rec -o page.html");
    let page = fs::read_to_string(at.join("page.html")).unwrap();
    let data = page.split_once("id=\"data\">").unwrap().1.split_once("</script>").unwrap().0;
    let frames: Value = serde_json::from_str(data).unwrap();
    let focal = |frame: usize| frames[frame]["pinhole"][0].as_f64().unwrap();
    assert_eq!((focal(1), focal(0)), (777.0, focal(2)));
    assert_ne!(focal(0), 777.0);
}

#[test]
fn quiet_hides_no_result() {
    let at: &Path = &Folder::new();
    recording(at, 1);
    fs::write(at.join("rig.toml"), rectify::RIG).unwrap();
    for (line, word) in [
        ("run 0001_left.png 0001_right.png --query 160,120", "160,120"),
        ("explain 0001_left.png 0001_right.png 160,120", "search"),
        ("quality 0001_left.png 0001_right.png", "wall in"),
        ("plan-rig --hfov-deg 70 --baseline-m 0.1", "focal length"),
        ("convert-rig rig.toml", "baseline"),
    ] {
        let [all, quiet] = ["", "-q "].map(|quiet| linestereo(at, &format!("{quiet}{line}")));
        let [all, quiet] = [all, quiet].map(|output| String::from_utf8(output.stdout).unwrap());
        assert!(quiet.contains(word) && all.contains(quiet.trim_end()), "{line}: {quiet}");
    }
    for (line, word) in [
        ("run 0001_left.png 0001_right.png --query 160,120 --csv a.csv", "160,120"),
        ("explain 0001_left.png 0001_right.png 160,120 --picture a.png", ""),
        ("quality 0001_left.png 0001_right.png --json a.json", ""),
        ("plan-rig --hfov-deg 70 --baseline-m 0.1 --json a.json", ""),
        ("convert-rig rig.toml --to kalibr --out a.yaml", ""),
    ] {
        let said = String::from_utf8(linestereo(at, &format!("-q {line}")).stdout).unwrap();
        assert!(said.contains(word) && said.is_empty() == word.is_empty(), "{line}: {said}");
    }
}

#[test]
fn options_without_effect_are_refused() {
    let at: &Path = &Folder::new();
    recording(at, 1);
    let (run, sectors) = ("run 0001_left.png 0001_right.png", "--sectors, --fan or --mavlink");
    let cases: [(&str, &str); 6] = [
        (&format!("{run} --camera-yaw 30"), sectors),
        (&format!("{run} --sector-range 3"), sectors),
        (&format!("{run} --sector-heights -1 1"), sectors),
        (&format!("{run} --drop-depth 0.1"), sectors),
        ("sequence . --sector-range 3", "add --sectors, or --out FILE.mcap"),
        (&format!("sequence . {RIG} --out a.mcap --camera-yaw 30"), "in the camera's frame"),
    ];
    all_refused(at, &cases);
    refused(at, "monitor x.bin --json --record -", &["both write to stdout"]);
    succeed(at, &format!("sequence . {RIG} --out a.mcap --sector-range 3 --no-points"));
    let messages = fs::read(at.join("a.mcap")).unwrap();
    let has = |topic: &[u8]| messages.windows(topic.len()).any(|bytes| bytes == topic);
    assert!(has(b"/linestereo/segments") && !has(b"/linestereo/points"));
}

#[cfg(unix)]
#[test]
fn notes_that_nobody_reads_are_dropped() {
    let folder = Folder::new();
    recording(folder.path(), 1);
    for line in
        ["run 0001_left.png 0001_right.png -v --max-disparity 64", "sequence .", "monitor --help"]
    {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = program(folder.path(), line).stderr(writer).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}");
    }
}

/// A skipped box is told with its line.
#[test]
fn lists_of_objects_come_before_label_images() {
    let at: &Path = &Folder::new();
    recording(at, 1);
    fs::create_dir(at.join("boxes")).unwrap();
    fs::copy(at.join("0001_left.png"), at.join("boxes/0001_left.png")).unwrap();
    fs::write(at.join("boxes/0001_left.txt"), "0 0.5 0.5 0.2 0.2\n0 160 120 40 40\n").unwrap();
    let run = "run 0001_left.png 0001_right.png --objects boxes";
    tells(at, run, &["object (0): ", "the first: line 2: it lies outside of the left image"]);
    let words = ["1 objects skipped", "the first: 0001: line 2: it lies outside"];
    tells(at, "report . --objects boxes -o x.html", &words);
}

#[test]
fn objects_alone_have_the_depths_of_the_whole_frame() {
    let at: &Path = &Folder::new();
    recording(at, 2);
    fs::write(at.join("boxes.csv"), "x0,y0,x1,y1,name\n40,30,120,100,a\n180,120,260,200,b\n")
        .unwrap();
    let asked = format!("sequence . --objects boxes.csv {RIG}");
    let [whole, alone] =
        [&asked, &format!("{asked} --only-objects")].map(|line| json_lines(&succeed(at, line)));
    assert_eq!(whole[0], alone[0]); // the first pair tells how far the rows are apart
    let objects = |line: &Value| line["objects"].as_array().unwrap().clone();
    let (whole_objects, alone_objects) = (objects(&whole[1]), objects(&alone[1]));
    assert_eq!((whole_objects.len(), alone_objects.len()), (2, 2));
    for (whole, alone) in whole_objects.iter().zip(&alone_objects) {
        // Paths begin at the border of what is matched: where texture is weak a point more or less
        // is matched.
        let number = |object: &Value, key: &str| object[key].as_f64().unwrap();
        let apart = (number(whole, "disparity_px") - number(alone, "disparity_px")).abs();
        assert!(apart <= 0.2 * number(whole, "sigma_px"), "{whole} {alone}");
        assert_eq!((&whole["name"], &whole["reason"]), (&alone["name"], &alone["reason"]));
    }
    let segments = |line: &Value| line["counts"]["segments_left"].as_u64().unwrap();
    assert!(segments(&alone[1]) < segments(&whole[1]));
}
