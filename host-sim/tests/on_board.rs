//! `run --on`, as a user types it.

use crate::support::{all_refused, succeed, with_scene};
use linestereo_sim::board::{Board, qemu, toolchain::Toolchain};
use linestereo_tests::board::or_skip;

fn no_boards() -> bool {
    or_skip(Toolchain::for_board(&Board::ALL[0]).and_then(|_| qemu::find(&Board::ALL[0]))).is_none()
}

#[test]
fn run_on_a_board_writes_the_json_of_the_pc() {
    if no_boards() {
        return;
    }
    let folder = with_scene("boxes", "128x96", "out");
    // So few that no list of a board is full.
    let run = ["run", "out/left.png", "out/right.png", "--scene", "out/scene.json", "--cell", "64", "--json"];
    let with = |more: &[&str]| succeed(folder.path(), &[&run[..], more].concat());
    let pc = with(&["-"]);
    assert!(pc.contains("\"matched\":") && !pc.contains("\"segments\":[]"), "{pc}");
    for name in ["mps2-an500", "mps2-an386"] {
        assert_eq!(with(&["-", "--on", name]), pc, "{name}");
    }
    let summary = with(&["depth.json", "--on", "mps2-an386"]);
    assert!(summary.contains(" million instructions on mps2-an386\n") && !summary.contains(" ms"), "{summary}");
}

const RIG: &str = "\
version = 1
[left]
size = [160, 120]
focal_px = [140.0, 140.5]
centre_px = [80.25, 59.5]
lens = { model = \"brown-conrady\", k = [-0.2, 0.05, 0.0], p = [0.001, 0.0] }
[right]
size = [160, 120]
focal_px = [141.0, 140.0]
centre_px = [78.5, 60.0]
lens = { model = \"brown-conrady\", k = [-0.22, 0.04, 0.0], p = [0.0, -0.001] }
[pose]
rotation_rad = [0.001, 0.004, 0.015]
translation_m = [-0.07, 0.0002, 0.0]
";

#[test]
fn a_raw_pair_is_rectified_on_a_board_to_the_json_of_the_pc() {
    if no_boards() {
        return;
    }
    let folder = with_scene("boxes", "160x120", "out");
    std::fs::write(folder.path().join("rig.toml"), RIG).unwrap();
    // So few that no list of a board is full.
    let run =
        ["run", "out/left.png", "out/right.png", "--rig", "rig.toml", "--cell", "64", "--size", "128x96", "--json"];
    let with = |more: &[&str]| succeed(folder.path(), &[&run[..], more].concat());
    let pc = with(&["-"]);
    assert!(pc.contains("\"depth_m\":[") && pc.contains("\"size\":[128,96]"), "{pc}");
    for name in ["mps2-an500", "mps2-an386"] {
        assert_eq!(with(&["-", "--on", name]), pc, "{name}");
    }
    let summary = with(&["depth.json", "--on", "mps2-an386"]);
    assert!(summary.contains(" million instructions on mps2-an386 after "), "{summary}");
    let too_large = [&run[..5], &["--size", "200x150", "--on", "mps2-an386"]].concat();
    all_refused(folder.path(), &[(&too_large, "holds pairs of up to 160x120, these are 200x150; give --size 160x120")]);
}

#[test]
fn a_board_that_does_not_exist_or_is_too_small_is_one_clear_line() {
    let folder = with_scene("boxes", "200x96", "out");
    let run = ["run", "out/left.png", "out/right.png", "--on"];
    let cases: [(&[&str], &str); 2] = [
        (&[&run[..], &["arduino"]].concat(), "there is no board arduino; give mps2-an500 or mps2-an386"),
        (
            &[&run[..], &["mps2-an386"]].concat(),
            "holds pairs of up to 160x120, these are 200x96; reduce them with --width 160",
        ),
    ];
    all_refused(folder.path(), &cases);
}
