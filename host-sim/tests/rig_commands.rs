//! `linestereo convert-rig` and `plan-rig` as a user types them.

use crate::support::{all_refused, json, succeed, tells, with_rig};
use std::fs;
use std::path::Path;

pub(crate) const RIG: &str = "\
version = 1
[left]
size = [640, 480]
focal_px = [500.0, 501.0]
centre_px = [320.0, 240.0]
skew_px = 0.0
lens = { model = \"brown-conrady\", k = [-0.3, 0.1, 0.0], p = [0.001, 0.002] }
[right]
size = [640, 480]
focal_px = [510.0, 511.0]
centre_px = [322.0, 242.0]
skew_px = 0.0
lens = { model = \"brown-conrady\", k = [-0.2, 0.05, 0.0], p = [0.0, 0.0] }
[pose]
rotation_rad = [0.01, -0.02, 0.03]
translation_m = [-0.1, 0.001, 0.002]
";

#[test]
fn a_rig_goes_through_every_format_and_comes_back() {
    let at: &Path = &with_rig(RIG);
    let words = ["rig.toml: 640x480, baseline 0.1000 m", "focal 500.00 501.00 px"];
    tells(at, "convert-rig rig.toml", &words);
    for line in [
        "convert-rig rig.toml --to opencv-yaml --out a.yml",
        "convert-rig a.yml --to ros --out left.yaml --out right.yaml",
        "convert-rig left.yaml right.yaml --to opencv-xml --out a.xml",
        "convert-rig a.xml --to euroc --out cam0.yaml --out cam1.yaml",
        "convert-rig cam0.yaml cam1.yaml --to kalibr --out camchain.yaml",
        "convert-rig camchain.yaml --to rig-toml --out again.toml",
    ] {
        succeed(at, line);
    }
    // All but the last bits of the pose.
    let lines = |text: &str| {
        text.lines()
            .filter(|line| line.starts_with("focal") || line.starts_with("lens"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(lines(RIG), lines(&fs::read_to_string(at.join("again.toml")).unwrap()));
    let summary = |name| {
        succeed(at, &format!("convert-rig {name}"))
            .lines()
            .find(|line| line.contains("pose"))
            .map(str::to_owned)
    };
    assert_eq!(summary("rig.toml"), summary("again.toml"));
}

#[test]
fn wrong_conversions_leave_no_file_and_say_why() {
    let at: &Path = &with_rig(RIG);
    fs::write(at.join("bad.yml"), "%YAML:1.0\nM1: [1, 2\n").unwrap();
    let fisheye = "lens = { model = \"fisheye\", k = [0.0, 0.0, 0.0, 0.0] }\n[right]";
    let (left, right) = RIG.split_once("[right]").unwrap();
    let (left, _) = left.split_once("lens").unwrap();
    fs::write(at.join("mixed.toml"), format!("{left}{fisheye}{right}")).unwrap();
    fs::write(at.join("k3.toml"), RIG.replace("0.1, 0.0]", "0.1, 0.5]")).unwrap();
    let cases = [
        ("convert-rig rig.toml --to ros --out one.yaml", "give --out twice"),
        ("convert-rig rig.toml --out a --out b", "give --out once"),
        ("convert-rig rig.toml --size 320x240", "made for images of 640x480"),
        ("convert-rig none.yml", "none.yml: cannot be read"),
        ("convert-rig rig.toml --translation-unit inch", "give m, mm"),
        ("convert-rig bad.yml", "bad.yml, line "),
        ("convert-rig k3.toml --to kalibr --out k.yaml", "no place for the lens coefficient k3"),
        ("convert-rig mixed.toml --to opencv-yaml --out k.yaml", "another lens; write rig-toml\n"),
        ("convert-rig rig.toml --lens fisheye", "leave --lens out"),
    ];
    all_refused(at, &cases);
    assert_eq!(fs::read_dir(at).unwrap().count(), 4);
}

#[test]
fn a_plan_is_printed_and_listed() {
    let at: &Path = &with_rig(RIG);
    let oak = "plan-rig --focal-px 451 --size 640x480 --baseline-m 0.075 --max-disparity 96";
    tells(at, oak, &["near limit 0.358 m", "below 5 % up to 6.76 m"]);
    let json = json(at, &format!("{oak} --json -"));
    assert!((json["near_limit_m"].as_f64().unwrap() - 33.825 / 94.5).abs() < 1e-9);
    assert!(json["suggestion"].is_null() && json["table"].as_array().unwrap().len() > 5);
    // 1.93 mm / 3 um, 848 px: 643 px, 66.8 degrees.
    let lens = "plan-rig --focal-mm 1.93 --pixel-um 3 --size 848x480 --range 0.5..4";
    tells(at, lens, &["focal length 643.3 px", "a baseline of 31.1 mm at least"]);
    let words = ["with the one given, 7.8 % at 4 m: not reached; 0.5 m: reached"];
    tells(at, &format!("{lens} --baseline-m 0.02"), &words);
    tells(at, &format!("{lens} --baseline-m 0.05"), &["at 4 m: reached; 0.5 m: not reached"]);
    // What is suggested can be given.
    let narrow = "plan-rig --hfov-deg 70 --size 640x480 --range 0.2..10";
    tells(at, narrow, &["--max-disparity 256", "109.5 mm at least"]);
    let again = tells(at, &format!("{narrow} --max-disparity 256"), &["near limit 0.19"]);
    assert!(!again.contains("needs a disparity"), "{again}");
    tells(at, &format!("{narrow} --baseline-m 0.1095"), &["at 10 m: reached"]);
}

#[test]
fn wrong_plans_say_what_to_give() {
    let folder = with_rig(RIG);
    let cases = [
        ("plan-rig --baseline-m 0.1", "--focal-px"),
        ("plan-rig --focal-px 300", "--baseline-m"),
        ("plan-rig --focal-mm 3 --baseline-m 0.1", "--pixel-um"),
        ("plan-rig --focal-px 300 --range 4..1", "two rising distances"),
        ("plan-rig --focal-px 451 --baseline-m 75", "75 m: did you mean mm?"),
        ("plan-rig --hfov-deg 180 --baseline-m 0.1", "1 to 150"),
        (
            "plan-rig --focal-px 300 --baseline-m 0.1 --max-disparity 300",
            "8 to 256; change --max-disparity",
        ),
        ("plan-rig --focal-px 300 --range 1..2 --error 0", "error of 0 %"),
        ("plan-rig --focal-px 300 --range 1..2 --sigma-px -1", "give 0.001 to 16 px"),
    ];
    all_refused(folder.path(), &cases);
}
