//! First commands of a new user, and natural mistakes: files that would be lost, failures that look
//! like success, input that means something else.

use crate::rectify::RIG;
use crate::support::{
    all_refused, json, json_of_any, linestereo, refused, stderr, stdout, succeed,
};
use core::time::Duration;
use linestereo::Dims;
use linestereo_frames::GrayImage;
use linestereo_sim::scene::{self, Kind, Sensor};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;
use tempfile::TempDir;

const DIMS: Dims = Dims { width: 320, height: 240 };
const PAIR: [&str; 3] = ["run", "l.png", "r.png"];

fn buffer(image: &GrayImage) -> image::GrayImage {
    image::GrayImage::from_raw(
        image.dims.width.into(),
        image.dims.height.into(),
        image.pixels.clone(),
    )
    .unwrap()
}

/// The images of a pair of boxes.
fn boxes() -> [image::GrayImage; 2] {
    let sensor = Sensor { noise: 1.0, seed: 1, ..Sensor::default() };
    let rendering = scene::render(&scene::build(Kind::Boxes, DIMS, 1), DIMS, &sensor);
    [buffer(&rendering.left), buffer(&rendering.right)]
}

/// A folder with `l.png` and `r.png`.
fn pair() -> TempDir {
    let folder = TempDir::new().unwrap();
    for (image, name) in boxes().iter().zip(["l.png", "r.png"]) {
        image.save(folder.path().join(name)).unwrap();
    }
    folder
}

/// A folder with one pair by many names: `0001_left.png`, `0001_right.png` and so on.
fn recording(frames: u32) -> TempDir {
    let folder = pair();
    for frame in 1..=frames {
        for (image, side) in [("l.png", "left"), ("r.png", "right")] {
            let to = folder.path().join(format!("{frame:04}_{side}.png"));
            fs::hard_link(folder.path().join(image), to).unwrap();
        }
    }
    for image in ["l.png", "r.png"] {
        fs::remove_file(folder.path().join(image)).unwrap();
    }
    folder
}

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&PAIR[..], more].concat()
}

#[test]
fn no_output_replaces_an_input_or_another_output() {
    let folder = pair();
    let at = folder.path();
    fs::create_dir(at.join("sub")).unwrap();
    fs::write(at.join("boxes.csv"), "10,10,90,90\n").unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("l.png", at.join("link.png")).unwrap();
    let before = fs::read(at.join("l.png")).unwrap();
    let cases: [&[&str]; 7] = [
        &["--overlay", "l.png"],
        &["--disparity-png", "sub/../r.png"],
        &["--objects", "boxes.csv", "--csv", "boxes.csv"],
        &["--overlay", "a.png", "--disparity-png", "./a.png"],
        &["--json", "-", "--csv", "-"],
        &["--json", "sub/../x", "--csv", "x"],
        if cfg!(unix) { &["--overlay", "link.png"] } else { &["--overlay", "l.png"] },
    ];
    for more in cases {
        let line = refused(at, &with(more));
        assert!(line.contains("are the same; write to another file"), "{line}");
    }
    assert_eq!(fs::read(at.join("l.png")).unwrap(), before);
    // A file that is not there yet and another link are written; a link stays one.
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("new.json", at.join("link.json")).unwrap();
        succeed(at, &with(&["--json", "link.json"]));
        assert!(at.join("link.json").is_symlink() && at.join("new.json").is_file());
        succeed(at, &with(&["--json", "/dev/null", "--csv", "/dev/null"]));
    }
}

#[test]
fn files_that_a_command_finds_are_not_replaced_either() {
    let folder = recording(2);
    let at = folder.path();
    let before = fs::read(at.join("0001_left.png")).unwrap();
    fs::write(at.join("scene.json"), r#"{"rectified": {"focal_px": 300, "baseline_m": 0.1}}"#)
        .unwrap();
    let cases: [(&[&str], &str); 2] = [
        (&["sequence", ".", "--out", "scene.json"], "one of the files that are read"),
        (&["report", ".", "-o", "scene.json"], "one of the files that are read"),
    ];
    all_refused(at, &cases);
    fs::create_dir(at.join("raw")).unwrap();
    fs::write(at.join("rig.toml"), RIG).unwrap();
    for side in ["left", "right"] {
        fs::copy(at.join(format!("0001_{side}.png")), at.join(format!("raw/{side}.png"))).unwrap();
    }
    let line = refused(at, &["rectify", "raw", "--rig", "rig.toml", "--out", "raw"]);
    assert!(line.contains("one of the files that are read"), "{line}");
    for file in ["0001_left.png", "raw/left.png"] {
        assert_eq!(fs::read(at.join(file)).unwrap(), before, "{file}");
    }
}

#[test]
fn a_dash_is_stdout_for_every_output() {
    let folder = recording(2);
    let at = folder.path();
    let run = ["run", "0001_left.png", "0001_right.png"];
    let bytes = |args: &[&str]| {
        let output = linestereo(at, args);
        assert!(output.status.success(), "{}", stderr(&output));
        output.stdout
    };
    assert!(bytes(&[&run[..], &["--csv", "-"]].concat()).starts_with(b"id,"));
    assert!(bytes(&[&run[..], &["--overlay", "-"]].concat()).starts_with(b"\x89PNG"));
    assert_eq!(
        lines(&String::from_utf8(bytes(&["sequence", ".", "--out", "-"])).unwrap()).len(),
        2
    );
    assert!(bytes(&["report", ".", "-o", "-"]).starts_with(b"<!"));
    assert!(bytes(&["demo", "--out", "-"]).starts_with(b"\x89PNG"));
    assert!(!at.join("-").exists());
}

#[test]
fn pictures_are_called_what_they_are() {
    let folder = pair();
    let cases: [(&[&str], &str); 3] = [
        (&with(&["--overlay", "x.jpg"]), "written as PNG; call it x.png"),
        (&with(&["--pfm", "x.png"]), "written as PFM; call it x.pfm"),
        (&with(&["--overlay", "no/such/x.png"]), "its folder does not exist"),
    ];
    all_refused(folder.path(), &cases);
}

#[cfg(unix)]
#[test]
fn what_is_finished_when_a_sequence_is_interrupted_stays() {
    let folder = recording(400);
    let at = folder.path();
    for signal in ["-INT", "-TERM"] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_linestereo"))
            .current_dir(at)
            .args(["sequence", ".", "--out", "results.jsonl"])
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let hidden = || {
            let names = fs::read_dir(at).unwrap().map(|entry| entry.unwrap());
            names
                .filter(|entry| entry.file_name().to_string_lossy().starts_with(".linestereo"))
                .collect::<Vec<_>>()
        };
        let begin = Instant::now();
        while !hidden().iter().any(|entry| entry.metadata().is_ok_and(|data| data.len() > 0)) {
            assert!(begin.elapsed() < Duration::from_secs(60), "no line is written");
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(
            Command::new("kill")
                .args([signal, &child.id().to_string()])
                .status()
                .unwrap()
                .success()
        );
        let status = child.wait().unwrap();
        let mut said = String::new();
        std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut said).unwrap();
        assert_eq!(status.code(), Some(130), "{said}");
        let finished = lines(&fs::read_to_string(at.join("results.jsonl")).unwrap()).len();
        assert!((1..400).contains(&finished), "{finished}");
        let says =
            format!("interrupted after {finished} of 400 frames; their lines are in results.jsonl");
        assert!(said.contains(&says), "{said}");
        assert!(hidden().is_empty());
        fs::remove_file(at.join("results.jsonl")).unwrap();
    }
}

#[test]
fn a_sequence_stops_when_its_reader_does() {
    let folder = recording(60);
    let mut command = Command::new(env!("CARGO_BIN_EXE_linestereo"));
    command
        .current_dir(folder.path())
        .args(["sequence", "."])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut first = String::new();
    std::io::BufRead::read_line(
        &mut std::io::BufReader::new(child.stdout.take().unwrap()),
        &mut first,
    )
    .unwrap();
    assert!(first.starts_with("{\"frame\":1,"), "{first}");
    // Who comes to the end of a sequence sums it up.
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{}", stderr(&output));
}

#[test]
fn what_is_wrong_with_frames_is_counted() {
    let folder = recording(2);
    let at = folder.path();
    for frame in 1..=2 {
        let name = |side| at.join(format!("{frame:04}_{side}.png"));
        fs::rename(name("left"), at.join("x.png")).unwrap();
        fs::rename(name("right"), name("left")).unwrap();
        fs::rename(at.join("x.png"), name("right")).unwrap();
    }
    let output = linestereo(at, &["sequence", "."]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("2 frames, 0 failed"), "{said}");
    assert!(said.contains("health: few_matches in 2 frames: few edges have a match"), "{said}");
}

#[test]
fn nothing_that_was_asked_for_is_passed_over() {
    let folder = recording(2);
    let at = folder.path();
    fs::create_dir(at.join("empty")).unwrap();
    let run = ["run", "0001_left.png", "0001_right.png"];
    let cases: [(&[&str], &str); 5] = [
        (&["sequence", ".", "--objects", "nosuch"], "cannot read nosuch"),
        (&["sequence", ".", "--objects", "empty"], "no file that is called like a left image"),
        (
            &["report", ".", "--objects", "empty", "-o", "x.html"],
            "no file that is called like a left image",
        ),
        (&[&run[..], &["--objects", "empty"]].concat(), "no file that is called like a left image"),
        (&["sequence", "nosuch"], "nosuch"),
    ];
    all_refused(at, &cases);
    // A folder that has a file for some of the frames alone says so.
    fs::write(at.join("empty/0001_left.csv"), "10,10,90,90\n").unwrap();
    let said = stderr(&linestereo(at, &["sequence", ".", "--objects", "empty"]));
    assert!(said.contains("1 frames without a file or a message of objects"), "{said}");
    for frame in 1..=2 {
        fs::write(at.join(format!("{frame:04}_left.png")), b"no image").unwrap();
    }
    let output = linestereo(at, &["sequence", "."]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("no frame can be matched; 0001: ./0001_left.png"),
        "{}",
        stderr(&output)
    );
    let help = succeed(at, &["--help"]);
    assert!(help.contains("Exit codes:") && help.contains("130 "), "{help}");
}

#[test]
fn every_pair_has_the_scene_file_beside_it() {
    let folder = pair();
    let at = folder.path();
    for (name, focal) in [("rec/1", 300), ("rec/2", 600)] {
        fs::create_dir_all(at.join(name)).unwrap();
        for (from, to) in [("l.png", "left.png"), ("r.png", "right.png")] {
            fs::copy(at.join(from), at.join(name).join(to)).unwrap();
        }
        let scene = format!(r#"{{"rectified": {{"focal_px": {focal}, "baseline_m": 0.1}}}}"#);
        fs::write(at.join(name).join("scene.json"), scene).unwrap();
    }
    let found = lines(&succeed(at, &["sequence", "rec"]));
    let depth = |line: &Value| line["segments"][0]["depth_m"][0].as_f64().unwrap();
    assert!(
        (depth(&found[1]) / depth(&found[0]) - 2.0).abs() < 0.01,
        "{} {}",
        depth(&found[0]),
        depth(&found[1])
    );
}

#[test]
fn one_set_of_layouts_for_all_commands() {
    let folder = pair();
    let at = folder.path();
    let calib = "cam0=[300 0 160; 0 300 120; 0 0 1]\n\
                 cam1=[300 0 160; 0 300 120; 0 0 1]\ndoffs=0\nbaseline=100\nndisp=64\n";
    let stamps = [
        ["1403715273262142976.png", "1403715273262542976.png"],
        ["1403715273312142976.png", "1403715273312542976.png"],
    ];
    let layouts: [(&str, Vec<[String; 2]>); 5] = [
        ("middlebury", vec![["im0.png".into(), "im1.png".into()]]),
        ("capitals", vec![["Left/1.png".into(), "Right/1.png".into()]]),
        (
            "letters",
            vec![["L/1.png".into(), "R/1.png".into()], ["L/2.png".into(), "R/2.png".into()]],
        ),
        ("realsense", vec![["infra1/1.png".into(), "infra2/1.png".into()]]),
        (
            "times",
            stamps.map(|[left, right]| [format!("left/{left}"), format!("right/{right}")]).to_vec(),
        ),
    ];
    for (name, pairs) in &layouts {
        for files in pairs {
            for (file, image) in files.iter().zip(["l.png", "r.png"]) {
                let to = at.join(name).join(file);
                fs::create_dir_all(to.parent().unwrap()).unwrap();
                fs::copy(at.join(image), to).unwrap();
            }
        }
        fs::write(at.join("middlebury/calib.txt"), calib).unwrap();
        let found = lines(&succeed(at, &["sequence", name]));
        assert_eq!(found.len(), pairs.len(), "{name}");
        assert!(!found[0]["points"].as_array().unwrap().is_empty(), "{name}");
        assert_eq!(
            found[0]["segments"][0]["depth_m"][0].is_number(),
            *name == "middlebury",
            "{name}"
        );
        let skew = if *name == "times" { Value::from(400) } else { Value::Null };
        assert_eq!(found[0]["health"]["skew_us"], skew, "{name}");
        if *name == "times" {
            let left = at.join("times/left");
            fs::rename(left.join("1403715273262142976.png"), left.join("1403715273258142976.png"))
                .unwrap();
            let output = linestereo(at, &["sequence", name]);
            assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
            let found = lines(&String::from_utf8(output.stdout).unwrap());
            assert!(
                found[0]["health"]["flags"].as_array().unwrap().contains(&"skew".into()),
                "{}",
                found[0]["health"]
            );
            let found = lines(&succeed(at, &["sequence", name, "--max-skew-ms", "5"]));
            assert!(!found[0]["points"].as_array().unwrap().is_empty(), "{}", found[0]["health"]);
        }
        // All pairs of this one are captured too far apart by now.
        let code = if *name == "times" { Some(2) } else { Some(0) };
        assert_eq!(
            linestereo(at, &["report", name, "-o", "page.html"]).status.code(),
            code,
            "{name}"
        );
    }
}

#[test]
fn units_are_asked_about() {
    let folder = pair();
    let at = folder.path();
    fs::write(at.join("mm.json"), r#"{"rectified": {"focal_px": 451, "baseline_m": 75}}"#).unwrap();
    let cases: [(&[&str], &str); 3] = [
        (
            &with(&["--focal-px", "451", "--baseline-m", "75"]),
            "75 m: did you mean mm? then give 0.075",
        ),
        (&with(&["--scene", "mm.json"]), "75 m: did you mean mm?"),
        (&["plan-rig", "--focal-px", "451", "--baseline-m", "75"], "75 m: did you mean mm?"),
    ];
    all_refused(at, &cases);
}

#[test]
fn keys_of_a_scene_that_mean_nothing_are_refused() {
    let folder = pair();
    let at = folder.path();
    let cases = [
        (r#"{"focal_px": 451}"#, "\"focal_px\" is misplaced; move it into \"rectified\""),
        (
            r#"{"max_disparty": 64}"#,
            "\"max_disparty\" is unknown; did you mean max_disparity? The known keys are scene, \
             size, max_disparity",
        ),
        (
            r#"{"rectified": {"focal_px": 451, "baseline": 0.1}}"#,
            "\"baseline\" in \"rectified\" is unknown",
        ),
        (r#"{"rectified": {"focal_px": 451}}"#, "missing field `baseline_m`"),
    ];
    for (content, says) in cases {
        fs::write(at.join("scene.json"), content).unwrap();
        let line = refused(at, &with(&["--scene", "scene.json"]));
        assert!(line.contains(says), "{line}");
    }
    // What other programs note is none of these.
    fs::write(
        at.join("scene.json"),
        r#"{"scene": "a", "camera": {"height_m": 0.1}, "accepted": "ok", "seed": [1], "shares": {}}"#,
    )
    .unwrap();
    succeed(at, &with(&["--scene", "scene.json"]));
    // The help's own example is one.
    let help = succeed(at, &["run", "--help"]);
    let example = help.lines().skip_while(|line| !line.starts_with("scene.json")).nth(1).unwrap();
    fs::write(at.join("scene.json"), example).unwrap();
    let found = json(at, &with(&["--scene", "scene.json", "--json", "-"]));
    assert!(found["segments"][0]["depth_m"][0].is_number());
    fs::write(at.join("scene.json"), r#"{"note": "a desk", "terms": "none", "rectified_note": 1}"#)
        .unwrap();
    succeed(at, &with(&["--scene", "scene.json"]));
}

/// A JPEG whose EXIF says that it is shown turned.
fn turned(image: &image::GrayImage, orientation: u8) -> Vec<u8> {
    let mut jpeg = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut jpeg, 95).encode_image(image).unwrap();
    let exif = [
        &b"Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"[..],
        &[orientation, 0, 0, 0],
        &[0; 4],
    ]
    .concat();
    let head = [&[0xff, 0xe1][..], &(exif.len() as u16 + 2).to_be_bytes(), &exif].concat();
    [&jpeg[..2], &head, &jpeg[2..]].concat()
}

#[test]
fn photos_are_read_as_they_are_meant() {
    let folder = pair();
    let at = folder.path();
    let images = boxes();
    for (image, name) in images.iter().zip(["l", "r"]) {
        // Held upside down: the pixels lie turned by 180 degrees, and the tag says so.
        fs::write(
            at.join(format!("{name}_turned.jpg")),
            turned(&image::imageops::rotate180(image), 3),
        )
        .unwrap();
        fs::write(at.join(format!("{name}_plain.jpg")), turned(image, 1)).unwrap();
        for ending in ["tiff", "bmp", "webp"] {
            image.save(at.join(format!("{name}.{ending}"))).unwrap();
        }
    }
    let matched = |left: &str, right: &str| {
        json(at, &["run", left, right, "--json", "-"])["counts"]["matched"].as_u64()
    };
    let plain = matched("l_plain.jpg", "r_plain.jpg").unwrap();
    let turned = matched("l_turned.jpg", "r_turned.jpg").unwrap();
    assert!(plain > 10 && turned.abs_diff(plain) <= plain / 5, "{turned} {plain}");
    for ending in ["tiff", "bmp", "webp"] {
        let [left, right] = ["l", "r"].map(|name| format!("{name}.{ending}"));
        assert_eq!(matched(&left, &right), matched("l.png", "r.png"), "{ending}");
    }
    let whole = fs::read(at.join("l_plain.jpg")).unwrap();
    for length in [whole.len() / 2, whole.len() - 2] {
        fs::write(at.join("half.jpg"), &whole[..length]).unwrap();
        let line = refused(at, &["run", "half.jpg", "r_plain.jpg"]);
        assert!(
            line.contains("half.jpg is not a readable image (a JPEG that ends too early)"),
            "{line}"
        );
    }
    // Something behind the end is no fault: phones write a second picture there.
    fs::write(at.join("more.jpg"), [&whole[..], b"more"].concat()).unwrap();
    assert_eq!(matched("more.jpg", "r_plain.jpg"), Some(plain));
}

#[test]
fn sixteen_bit_files_hold_what_the_sensor_has() {
    let folder = pair();
    let at = folder.path();
    let expected = json(at, &with(&["--json", "-"]));
    for bits in [10_u32, 12, 16] {
        let white = (1_u32 << bits) - 1;
        for (image, name) in boxes().iter().zip(["l16.png", "r16.png"]) {
            let wide = |grey: &image::Luma<u8>| {
                image::Luma([((u32::from(grey.0[0]) * white + 127) / 255) as u16])
            };
            let wide = image::ImageBuffer::from_fn(image.width(), image.height(), |x, y| {
                wide(image.get_pixel(x, y))
            });
            wide.save(at.join(name)).unwrap();
        }
        let found = json(at, &["run", "l16.png", "r16.png", "--json", "-"]);
        assert_eq!(found["points"], expected["points"], "{bits}");
    }
    // Both images have one scale: a dark right one is not made brighter than the left one.
    let [left, right] = boxes();
    let stored = |image: &image::GrayImage, times: u16| {
        image::ImageBuffer::from_fn(image.width(), image.height(), |x, y| {
            image::Luma([u16::from(image.get_pixel(x, y).0[0]) * times])
        })
    };
    stored(&left, 16).save(at.join("l16.png")).unwrap();
    stored(&right, 4).save(at.join("r16.png")).unwrap();
    let unfit = |more: &[&str]| {
        json_of_any(at, &[&["run", "l16.png", "r16.png", "--json", "-"], more].concat())
    };
    let found = unfit(&[]);
    let level = |side: &str| found["health"][side]["level"].as_f64().unwrap();
    assert!(level("right") < 0.4 * level("left"), "{} {}", level("right"), level("left"));
    let found = unfit(&["--bits", "16"]);
    assert!(found["health"]["left"]["level"].as_f64().unwrap() < 16.0);
}

#[test]
fn pixels_are_counted_before_the_width_as_objects_are() {
    let folder = pair();
    let asked = json(
        folder.path(),
        &with(&["--width", "160", "--query", "300,200", "--query", "320,0", "--json", "-"]),
    );
    let queries = asked["queries"].as_array().unwrap();
    assert_eq!((&queries[0]["x"], &queries[0]["y"]), (&300.into(), &200.into()));
    assert_ne!(queries[0]["reason"], "outside");
    assert_eq!(queries[1]["reason"], "outside");
}

#[test]
fn boxes_need_no_header() {
    let folder = pair();
    let at = folder.path();
    fs::write(at.join("plain.csv"), "40,30,200,200,7,cat\n10,10,50,50\n").unwrap();
    fs::write(at.join("named.csv"), "x0,y0,x1,y1,label,name\n40,30,200,200,7,cat\n10,10,50,50\n")
        .unwrap();
    let of = |file: &str| json(at, &with(&["--objects", file, "--json", "-"]))["objects"].clone();
    assert_eq!(of("plain.csv"), of("named.csv"));
    assert_eq!(
        (&of("plain.csv")[0]["label"], &of("plain.csv")[0]["name"]),
        (&7.into(), &"cat".into())
    );
}

#[test]
fn both_views_in_one_file() {
    let folder = pair();
    let at = folder.path();
    let [left, right] = boxes();
    let mut both = image::GrayImage::new(640, 240);
    image::imageops::replace(&mut both, &left, 0, 0);
    image::imageops::replace(&mut both, &right, 320, 0);
    both.save(at.join("both.png")).unwrap();
    let of = |args: &[&str]| json(at, &[args, &["--json", "-"]].concat())["points"].clone();
    assert_eq!(of(&["run", "both.png", "--side-by-side"]), of(&PAIR));
}

#[test]
fn depths_as_others_store_them() {
    let folder = pair();
    let at = folder.path();
    let rig = ["--focal-px", "300", "--baseline-m", "0.1", "--principal-point", "150,110"];
    let files = [
        "--json",
        "a.json",
        "--depth-png",
        "d.png",
        "--depth-npy",
        "d.npy",
        "--pcd",
        "p.pcd",
        "--ply",
        "p.ply",
    ];
    succeed(at, &[&PAIR[..], &rig, &files].concat());
    let found: Value = serde_json::from_slice(&fs::read(at.join("a.json")).unwrap()).unwrap();
    let image::DynamicImage::ImageLuma16(png) = image::open(at.join("d.png")).unwrap() else {
        panic!("16-bit grey")
    };
    let (dims, npy) = linestereo_frames::load_disparities(&at.join("d.npy")).unwrap();
    assert_eq!((dims, png.dimensions()), (DIMS, (320, 240)));
    let points = found["points"].as_array().unwrap();
    for point in points {
        let number = |i: usize| point[i].as_f64().unwrap();
        let (x, y, z) = (number(0) as u32, number(1) as u32, 30.0 / number(2));
        assert!(
            (f64::from(png.get_pixel(x, y).0[0]) / 1000.0 - z).abs() < 0.001 + 0.001 * z,
            "{point}"
        );
        assert!((f64::from(npy[(y * 320 + x) as usize]) - z).abs() < 0.001 + 0.001 * z, "{point}");
    }
    assert_eq!(png.pixels().filter(|pixel| pixel.0[0] > 0).count(), points.len());
    assert_eq!(npy.iter().filter(|z| z.is_finite()).count(), points.len());
    let pcd = fs::read_to_string(at.join("p.pcd")).unwrap();
    let (head, data) = pcd.split_once("DATA ascii\n").unwrap();
    assert!(head.contains(&format!("POINTS {}\n", data.lines().count())), "{head}");
    // The first point, seen from the principal point that was given.
    let first: Vec<f64> =
        data.lines().next().unwrap().split(' ').map(|value| value.parse().unwrap()).collect();
    let expected = points[0][0].as_f64().unwrap() - 150.0;
    assert!((first[0] / first[2] * 300.0 - expected).abs() < 0.2, "{first:?} {}", points[0]);
    let ply = fs::read_to_string(at.join("p.ply")).unwrap();
    assert!(
        ply.contains(
            &data.lines().next().unwrap().split(' ').take(3).collect::<Vec<_>>().join(" ")
        )
    );
    let cases: [(&[&str], &str); 3] = [
        (&with(&["--depth-png", "x.png"]), "--depth-png needs depths"),
        (&with(&["--depth-npy", "x.npy"]), "--depth-npy needs depths"),
        (&with(&["--principal-point", "1,2"]), "--principal-point alone gives no depths"),
    ];
    all_refused(at, &cases);
}

#[test]
fn quiet_verbose_and_what_shells_want() {
    let folder = pair();
    let at = folder.path();
    let output = linestereo(at, &with(&["--quiet", "--csv", "a.csv"]));
    assert!(output.stdout.is_empty() && output.stderr.is_empty() && at.join("a.csv").is_file());
    let output = linestereo(at, &["-q", "run", "l.png", "r.png", "--json", "-"]);
    assert!(output.stdout.starts_with(b"{") && output.stderr.is_empty());
    let said = stderr(&linestereo(
        at,
        &with(&["-v", "--focal-px", "300", "--baseline-m", "0.1", "--csv", "a.csv"]),
    ));
    assert!(
        said.contains("320x240")
            && said.contains("depths from 0.469 m")
            && said.contains("a.csv: "),
        "{said}"
    );
    assert!(succeed(at, &["--completions", "bash"]).contains("plan-rig"));
    succeed(at, &["--man", "pages"]);
    assert!(fs::read_to_string(at.join("pages/linestereo-run.1")).unwrap().contains("depth"));
    let version = succeed(at, &["--version"]);
    let commit = version
        .trim()
        .strip_prefix(concat!("linestereo ", env!("CARGO_PKG_VERSION")))
        .unwrap()
        .to_owned();
    let is_commit =
        |text: &str| text.len() == 12 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
    let has_git = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.git")).exists();
    let commit = commit.trim().trim_start_matches('(').trim_end_matches(')');
    assert!(is_commit(commit) || (!has_git && commit.is_empty()), "{version}");
}

#[test]
fn small_things_say_what_to_do() {
    let folder = pair();
    let at = folder.path();
    // A third radial coefficient, which Kalibr has no place for.
    fs::write(at.join("rig.toml"), RIG.replace("k = [-0.1, 0.0, 0.0]", "k = [-0.1, 0.0, 0.01]"))
        .unwrap();
    let line = refused(at, &["convert-rig", "rig.toml", "--to", "kalibr", "--out", "chain.yaml"]);
    assert!(line.contains("k3") && line.contains("calibrate --fix-k3"), "{line}");
    let line = refused(at, &with(&["--focal-px", "-1", "--baseline-m", "0.1"]));
    assert!(line.contains("focal") && !line.contains("'--"), "{line}");
    let line = refused(at, &with(&["--width", "-1"]));
    assert!(!line.contains("tip:"), "{line}");
    let line = refused(at, &with(&["--json", "no/a.json"]));
    assert!(line.contains("no/a.json: its folder does not exist"), "{line}");
    assert!(succeed(at, &["frames"]).contains("get"));
    let help = succeed(at, &["run", "--help"]);
    let heading = |option: &str| {
        let before = &help[..help.find(&format!("      {option} ")).unwrap()];
        before
            .lines()
            .rev()
            .find(|line| line.ends_with(':') && !line.starts_with(' '))
            .unwrap()
            .to_owned()
    };
    for option in ["--json", "--csv", "--overlay", "--ply", "--fan"] {
        assert_eq!(heading(option), "Outputs:", "{option}");
    }
    assert_eq!(heading("--query"), "Options:");
    assert_eq!(heading("--cell"), "Parameters of the method:");
    assert!(stdout(&linestereo(at, &["sequence", "--help"])).contains("infra1"));
}
