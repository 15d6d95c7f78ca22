//! `linestereo rectify` and `run --rig` as a user types them.

use crate::support::{all_refused, json_of_any, linestereo, refused, succeed, with_rig};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Two equal cameras of which the right one is rolled by 2 degrees, at which rows differ by up to 6
/// px.
pub(crate) const RIG: &str = "\
version = 1
[left]
size = [320, 240]
focal_px = [280.0, 280.0]
centre_px = [159.5, 119.5]
lens = { model = \"brown-conrady\", k = [-0.1, 0.0, 0.0], p = [0.0, 0.0] }
[right]
size = [320, 240]
focal_px = [280.0, 280.0]
centre_px = [159.5, 119.5]
lens = { model = \"brown-conrady\", k = [-0.1, 0.0, 0.0], p = [0.0, 0.0] }
[pose]
rotation_rad = [0.0, 0.0, 0.0349]
translation_m = [-0.07, 0.0, 0.0]
";

/// A folder with a rig and two scenes, whose images stand for raw ones.
fn folder() -> TempDir {
    let folder = with_rig(RIG);
    for kind in ["boxes", "cards"] {
        succeed(
            folder.path(),
            &["scene", "--kind", kind, "--size", "320x240", &format!("raw/{kind}")],
        );
    }
    folder
}

fn size(path: &Path) -> (u32, u32) {
    image::image_dimensions(path).unwrap()
}

#[test]
fn a_pair_becomes_two_images_and_a_picture() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let pair = [
        "rectify",
        "raw/boxes/left.png",
        "raw/boxes/right.png",
        "--rig",
        "rig.toml",
        "--size",
        "160x120",
    ];
    let out = ["--out-left", "l.png", "--out-right", "r.png", "--picture", "rows.png"];
    let text = succeed(folder.path(), &[&pair[..], &out].concat());
    assert!(text.starts_with("320x240 rectified to 160x120, focal length "), "{text}");
    assert!(
        text.contains("valid 100.0 % and 100.0 %; raw rows held at once ")
            && text.contains("wrote rows.png"),
        "{text}"
    );
    assert_eq!([size(&at("l.png")), size(&at("r.png"))], [(160, 120); 2]);
    assert_eq!(size(&at("rows.png")), (2 * 160 + 4, 2 * 120 + 4));

    // All of the view: corners without a source are black, and less of the rows is valid.
    let text =
        succeed(folder.path(), &[&pair[..], &["--out-left", "all.png", "--alpha", "1"]].concat());
    assert!(!text.contains("valid 100"), "{text}");
    let all = image::open(at("all.png")).unwrap().into_luma8();
    assert_eq!(all.get_pixel(0, 0).0, [0]);
    assert!(all.get_pixel(80, 60).0[0] > 0);
}

#[test]
fn folders_keep_their_names_and_run_gives_what_rectify_gives() {
    let folder = folder();
    let text = succeed(folder.path(), &["rectify", "raw", "--rig", "rig.toml", "--out", "done"]);
    assert!(text.ends_with("2 pairs: done\n"), "{text}");
    for kind in ["boxes", "cards"] {
        for name in ["left.png", "right.png", "rows.png"] {
            assert!(folder.path().join("done").join(kind).join(name).is_file(), "{kind}/{name}");
        }
    }
    // Drawn without a lens: by this rig their rows do not match.
    let json =
        |args: &[&str]| json_of_any(folder.path(), &[&["run"], args, &["--json", "-"]].concat());
    let raw = json(&["raw/boxes/left.png", "raw/boxes/right.png", "--rig", "rig.toml"]);
    let rectified = json(&["done/boxes/left.png", "done/boxes/right.png"]);
    assert!(raw["counts"]["matched"].as_u64() > Some(10), "{}", raw["counts"]);
    assert_eq!((&raw["counts"], &raw["points"]), (&rectified["counts"], &rectified["points"]));
    // Half of the size, by a rig as the pair is drawn: without lenses, not rolled.
    let even = RIG.replace("-0.1", "0.0").replace("0.0349", "0.0");
    fs::write(folder.path().join("even.toml"), even).unwrap();
    let half = json(&[
        "raw/boxes/left.png",
        "raw/boxes/right.png",
        "--rig",
        "even.toml",
        "--raw-width",
        "160",
    ]);
    assert_eq!(half["size"], serde_json::json!([160, 120]));
    assert!(half["segments"][0]["depth_m"][0].is_f64());
    assert!(
        raw["segments"][0]["depth_m"][0].is_f64() && rectified["segments"][0]["depth_m"].is_null()
    );
}

#[test]
fn images_say_the_size_that_a_file_of_opencv_does_not() {
    let folder = folder();
    let matrix = |name: &str, rows: u8, cols: u8, data: &str| {
        format!("{name}: !!opencv-matrix {{rows: {rows}, cols: {cols}, dt: d, data: [{data}]}}\n")
    };
    let camera = "280., 0., 159.5, 0., 280., 119.5, 0., 0., 1.";
    let text = [
        "%YAML:1.0\n".to_owned(),
        matrix("M1", 3, 3, camera),
        matrix("D1", 1, 5, "-0.1, 0., 0., 0., 0."),
        matrix("M2", 3, 3, camera),
        matrix("D2", 1, 5, "-0.1, 0., 0., 0., 0."),
        matrix("R", 3, 1, "0., 0., 0.0349"),
        matrix("T", 3, 1, "-0.07, 0., 0."),
    ];
    fs::write(folder.path().join("rig.yml"), text.concat()).unwrap();
    let pair = ["raw/boxes/left.png", "raw/boxes/right.png"];
    let points = |rig: &str, more: &[&str]| {
        json_of_any(
            folder.path(),
            &[&["run"], &pair[..], &["--rig", rig, "--json", "-"], more].concat(),
        )["points"]
            .clone()
    };
    assert_eq!(points("rig.yml", &[]), points("rig.toml", &[]));
    assert_eq!(
        points("rig.yml", &["--size", "160x120"]),
        points("rig.toml", &["--size", "160x120"])
    );
    let rectify = [&["rectify"], &pair[..], &["--rig", "rig.yml", "--picture", "p.png"]].concat();
    assert!(succeed(folder.path(), &rectify).starts_with("320x240 rectified to 320x240"));
    succeed(folder.path(), &["rectify", "raw", "--rig", "rig.yml", "--out", "done"]);
    // Drawn without a lens: not fit to be used with one.
    let output = linestereo(folder.path(), &["sequence", "raw", "--rig", "rig.yml", "--no-points"]);
    let lines = String::from_utf8_lossy(&output.stdout);
    assert!(lines.contains("\"segments\"") && !lines.contains("\"error\""), "{lines}");
    // Images of another size, and a command without images.
    succeed(folder.path(), &["scene", "--kind", "boxes", "--size", "160x120", "small"]);
    let small = ["run", "small/left.png", "small/right.png", "--rig", "rig.yml"];
    let error = refused(folder.path(), &small);
    assert!(error.contains("of about 320x240") && error.contains("another image size"), "{error}");
    let error = refused(folder.path(), &["flash-image", "rig.yml", "rig.bin"]);
    assert!(
        error.contains("linestereo convert-rig FILES --size 320x240 --out rig.toml"),
        "{error}"
    );
    succeed(folder.path(), &["convert-rig", "rig.yml", "--size", "320x240", "--out", "said.toml"]);
    succeed(folder.path(), &["flash-image", "said.toml", "rig.bin"]);
}

#[test]
fn what_cannot_be_rectified_is_one_clear_line() {
    let folder = folder();
    let left = "raw/boxes/left.png";
    succeed(folder.path(), &["scene", "--kind", "boxes", "--size", "160x120", "small"]);
    fs::create_dir(folder.path().join("empty")).unwrap();
    fs::write(folder.path().join("none.toml"), "version = 1").unwrap();
    let rig = ["--rig", "rig.toml"];
    let cases: [(&[&str], &[&str], &str); 10] = [
        (
            &["rectify", left, left, "--picture", "p.png", "--raw-width", "320"],
            &rig,
            "give 16 to less than the 320",
        ),
        (&["rectify", left, left], &[], "--rig"),
        (&["rectify", left], &rig, "RIGHT"),
        (&["rectify", left, left], &rig, "give --out-left and --out-right, or --picture"),
        (&["rectify", left, left, "--picture", "p.png"], &["--rig", "none.toml"], "none.toml"),
        (&["rectify", left, left, "--picture", "p.png", "--alpha", "2"], &rig, "correct --alpha"),
        (
            &["rectify", left, "small/left.png", "--picture", "p.png"],
            &rig,
            "give two images of one size",
        ),
        (
            &["rectify", "small/left.png", "small/right.png", "--picture", "p.png"],
            &rig,
            "raw images of 320x240",
        ),
        (&["rectify", "empty", "--out", "p"], &rig, "no pair was found in any known layout"),
        (&["run", left, left, "--size", "160x120"], &[], "--rig"),
    ];
    for (args, rig, says) in cases {
        let error = refused(folder.path(), &[args, rig].concat());
        assert!(error.contains(says), "{args:?} does not say {says}: {error}");
        assert!(!folder.path().join("p.png").exists() && !folder.path().join("p").exists());
    }
    let run = ["run", left, "raw/boxes/right.png", "--rig", "rig.toml"];
    let cases: [(&[&str], &str); 2] = [
        (&[&run[..], &["--width", "160"]].concat(), "cannot be used with"),
        (&[&run[..], &["--max-disparity", "320"]].concat(), "correct --max-disparity"),
    ];
    all_refused(folder.path(), &cases);
}
