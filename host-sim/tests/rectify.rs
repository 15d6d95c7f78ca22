//! `linestereo rectify` and `run --rig` as a user types them.

use crate::support::{
    Folder, all_refused, json_of_any, linestereo, refused, says, succeed, with_rig,
};
use std::fs;
use std::path::Path;

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
fn folder() -> Folder {
    let folder = with_rig(RIG);
    for kind in ["boxes", "cards"] {
        succeed(folder.path(), &format!("scene --kind {kind} --size 320x240 raw/{kind}"));
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
    let pair = "rectify raw/boxes/left.png raw/boxes/right.png --rig rig.toml --size 160x120";
    let out = "--out-left l.png --out-right r.png --picture rows.png";
    let text = succeed(folder.path(), &format!("{pair} {out}"));
    assert!(text.starts_with("320x240 rectified to 160x120, focal length "), "{text}");
    let words = ["valid 100.0 % and 100.0 %; raw rows held at once ", "wrote rows.png"];
    says(&text, &words);
    assert_eq!([size(&at("l.png")), size(&at("r.png"))], [(160, 120); 2]);
    assert_eq!(size(&at("rows.png")), (2 * 160 + 4, 2 * 120 + 4));

    // All of the view: corners without a source are black, and less of the rows is valid.
    let text = succeed(folder.path(), &format!("{pair} --out-left all.png --alpha 1"));
    assert!(!text.contains("valid 100"), "{text}");
    let all = image::open(at("all.png")).unwrap().into_luma8();
    assert_eq!(all.get_pixel(0, 0).0, [0]);
    assert!(all.get_pixel(80, 60).0[0] > 0);
}

#[test]
fn folders_keep_their_names_and_run_gives_what_rectify_gives() {
    let folder = folder();
    let text = succeed(folder.path(), "rectify raw --rig rig.toml --out done");
    assert!(text.ends_with("2 pairs: done\n"), "{text}");
    for kind in ["boxes", "cards"] {
        for name in ["left.png", "right.png", "rows.png"] {
            assert!(folder.path().join("done").join(kind).join(name).is_file(), "{kind}/{name}");
        }
    }
    // The same pairs as one image each.
    fs::create_dir(folder.path().join("joined")).unwrap();
    for kind in ["boxes", "cards"] {
        let [left, right] = ["left", "right"].map(|side| {
            let path = folder.path().join(format!("raw/{kind}/{side}.png"));
            image::open(path).unwrap().into_luma8()
        });
        let both = image::GrayImage::from_fn(640, 240, |x, y| {
            *if x < 320 { left.get_pixel(x, y) } else { right.get_pixel(x - 320, y) }
        });
        both.save(folder.path().join(format!("joined/{kind}.png"))).unwrap();
    }
    succeed(folder.path(), "rectify joined --rig rig.toml --out halves");
    for name in ["boxes/left.png", "cards/right.png"] {
        let of = |out: &str| fs::read(folder.path().join(out).join(name)).unwrap();
        assert_eq!(of("halves"), of("done"), "{name}");
    }
    // Drawn without a lens: by this rig their rows do not match.
    let json = |args: &str| json_of_any(folder.path(), &format!("run {args} --json -"));
    let raw = json("raw/boxes/left.png raw/boxes/right.png --rig rig.toml");
    let rectified = json("done/boxes/left.png done/boxes/right.png");
    assert!(raw["counts"]["matched"].as_u64() > Some(10), "{}", raw["counts"]);
    assert_eq!((&raw["counts"], &raw["points"]), (&rectified["counts"], &rectified["points"]));
    // Half of the size, by a rig as the pair is drawn: without lenses, not rolled.
    let even = RIG.replace("-0.1", "0.0").replace("0.0349", "0.0");
    fs::write(folder.path().join("even.toml"), even).unwrap();
    let half = json("raw/boxes/left.png raw/boxes/right.png --rig even.toml --raw-width 160");
    assert_eq!(half["size"], serde_json::json!([160, 120]));
    assert!(half["segments"][0]["depth_m"][0].is_f64());
    assert!(raw["segments"][0]["depth_m"][0].is_f64());
    // Without a rig there are no depths.
    let segments = rectified["segments"].as_array().unwrap();
    assert!(!segments.is_empty() && segments.iter().all(|segment| segment["depth_m"].is_null()));
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
    let pair = "raw/boxes/left.png raw/boxes/right.png";
    let points = |options: &str| {
        json_of_any(folder.path(), &format!("run {pair} --json - {options}"))["points"].take()
    };
    for size in ["", "--size 160x120"] {
        let [yml, toml] = ["yml", "toml"].map(|kind| points(&format!("--rig rig.{kind} {size}")));
        assert_eq!(yml, toml, "{size}");
    }
    let rectify = format!("rectify {pair} --rig rig.yml --picture p.png");
    assert!(succeed(folder.path(), &rectify).starts_with("320x240 rectified to 320x240"));
    succeed(folder.path(), "rectify raw --rig rig.yml --out done");
    // Drawn without a lens: not fit to be used with one.
    let output = linestereo(folder.path(), "sequence raw --rig rig.yml --no-points");
    let lines = String::from_utf8_lossy(&output.stdout);
    assert!(lines.contains("\"segments\"") && !lines.contains("\"error\""), "{lines}");
    // Images of another size, and a command without images.
    succeed(folder.path(), "scene --kind boxes --size 160x120 small");
    let small = "run small/left.png small/right.png --rig rig.yml";
    refused(folder.path(), small, &["of about 320x240", "another image size"]);
    let words = ["convert-rig FILES --size WxH --out rig.toml", "your photos, about 320x240"];
    refused(folder.path(), "flash-image rig.yml rig.bin", &words);
    succeed(folder.path(), "convert-rig rig.yml --size 320x240 --out said.toml");
    succeed(folder.path(), "flash-image said.toml rig.bin");
}

#[test]
fn what_cannot_be_rectified_is_one_clear_line() {
    let folder = folder();
    for side in ["left.png", "right.png"] {
        fs::copy(folder.path().join("raw/boxes").join(side), folder.path().join(side)).unwrap();
    }
    succeed(folder.path(), "scene --kind boxes --size 160x120 small");
    succeed(folder.path(), "scene --kind boxes --size 320x240 mixed/a");
    succeed(folder.path(), "scene --kind boxes --size 640x480 mixed/b");
    fs::create_dir(folder.path().join("empty")).unwrap();
    fs::write(folder.path().join("none.toml"), "version = 1").unwrap();
    let rectify = "rectify --rig rig.toml --picture p.png";
    let run = "run left.png right.png";
    let cases: [(&str, &str); 13] = [
        (&format!("{rectify} left.png left.png --raw-width 320"), "give 16 to less than the 320"),
        ("rectify left.png left.png", "--rig"),
        ("rectify --rig rig.toml left.png", "RIGHT"),
        (
            "rectify --rig rig.toml left.png left.png",
            "give --out-left and --out-right, or --picture",
        ),
        ("rectify left.png left.png --picture p.png --rig none.toml", "none.toml"),
        (&format!("{rectify} left.png left.png --alpha 2"), "correct --alpha"),
        (&format!("{rectify} left.png small/left.png"), "give two images of one size"),
        (&format!("{rectify} small/left.png small/right.png"), "raw images of 320x240"),
        (
            "rectify --rig rig.toml mixed --out m --raw-width 160",
            "b/left.png: the rig is for raw images of 320x240, but these are 640x480",
        ),
        ("rectify --rig rig.toml empty --out p", "no pair was found in any known layout"),
        (&format!("{run} --size 160x120"), "--rig"),
        (&format!("{run} --rig rig.toml --width 160"), "give --raw-width in place of --width"),
        (&format!("{run} --rig rig.toml --max-disparity 320"), "correct --max-disparity"),
    ];
    all_refused(folder.path(), &cases);
    assert!(!folder.path().join("p.png").exists() && !folder.path().join("p").exists());
}
