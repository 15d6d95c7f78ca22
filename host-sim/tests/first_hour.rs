//! First commands of a new user, and natural mistakes: files that would be lost, failures that look
//! like success, input that means something else.

use crate::calibrate::with_exif;
use crate::rectify::RIG;
use crate::support::{
    Folder, all_refused, failed, json, json_lines, json_of_any, linestereo, program, refused, save,
    says, signal, stderr, succeed, tells,
};
use core::time::Duration;
use linestereo::Dims;
use linestereo_sim::scene::Kind;
use linestereo_tests::drawn::rendered;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Instant;

const DIMS: Dims = Dims { width: 320, height: 240 };

/// A folder with a pair of boxes, `l.png` and `r.png`.
fn pair() -> Folder {
    let folder = Folder::new();
    let rendering = rendered(Kind::Boxes, DIMS, 1.0, 1);
    save(&rendering.left, &folder.path().join("l.png"));
    save(&rendering.right, &folder.path().join("r.png"));
    folder
}

/// The images of such a folder.
fn images(at: &Path) -> [image::GrayImage; 2] {
    ["l.png", "r.png"].map(|name| image::open(at.join(name)).unwrap().into_luma8())
}

/// A folder with one pair by many names: `0001_left.png`, `0001_right.png` and so on.
fn recording(frames: u32) -> Folder {
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

#[test]
fn no_output_replaces_an_input_or_another_output() {
    let at: &Path = &pair();
    fs::create_dir(at.join("sub")).unwrap();
    fs::write(at.join("boxes.csv"), "10,10,90,90\n").unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("l.png", at.join("link.png")).unwrap();
    let before = fs::read(at.join("l.png")).unwrap();
    for more in [
        "--overlay l.png",
        "--disparity-png sub/../r.png",
        "--objects boxes.csv --csv boxes.csv",
        "--overlay a.png --disparity-png ./a.png",
        "--json - --csv -",
        "--json sub/../x --csv x",
        if cfg!(unix) { "--overlay link.png" } else { "--overlay l.png" },
    ] {
        let words = ["are the same; write to another file"];
        refused(at, &format!("run l.png r.png {more}"), &words);
    }
    assert_eq!(fs::read(at.join("l.png")).unwrap(), before);
    // A file that is not there yet and another link are written; a link stays one.
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("new.json", at.join("link.json")).unwrap();
        succeed(at, "run l.png r.png --json link.json");
        assert!(at.join("link.json").is_symlink() && at.join("new.json").is_file());
        succeed(at, "run l.png r.png --json /dev/null --csv /dev/null");
    }
}

#[test]
fn files_that_a_command_finds_are_not_replaced_either() {
    let at: &Path = &recording(2);
    let before = fs::read(at.join("0001_left.png")).unwrap();
    fs::write(at.join("scene.json"), r#"{"rectified": {"focal_px": 300, "baseline_m": 0.1}}"#)
        .unwrap();
    fs::create_dir(at.join("raw")).unwrap();
    fs::write(at.join("rig.toml"), RIG).unwrap();
    for side in ["left", "right"] {
        fs::copy(at.join(format!("0001_{side}.png")), at.join(format!("raw/{side}.png"))).unwrap();
    }
    for line in [
        "sequence . --out scene.json", "report . -o scene.json",
        "rectify raw --rig rig.toml --out raw",
    ] {
        refused(at, line, &["one of the files that are read"]);
    }
    // Files that are read beside a pair, too.
    let scene = fs::read(at.join("scene.json")).unwrap();
    fs::create_dir_all(at.join("rec/1")).unwrap();
    fs::copy(at.join("scene.json"), at.join("rec/1/scene.json")).unwrap();
    for side in ["left", "right"] {
        let image = at.join(format!("0001_{side}.png"));
        fs::copy(&image, at.join(format!("rec/1/{side}.png"))).unwrap();
    }
    for line in [
        "run 0001_left.png 0001_right.png --json scene.json",
        "explain 0001_left.png 0001_right.png 100,100 --picture scene.json",
        "sequence rec --out rec/1/scene.json",
        "report rec -o rec/1/scene.json",
    ] {
        let path = line.rsplit(' ').next().unwrap();
        refused(at, line, &[&format!(" {path} is one of the files that are read")]);
    }
    for file in ["scene.json", "rec/1/scene.json"] {
        assert_eq!(fs::read(at.join(file)).unwrap(), scene, "{file}");
    }
    for file in ["0001_left.png", "raw/left.png"] {
        assert_eq!(fs::read(at.join(file)).unwrap(), before, "{file}");
    }
}

#[test]
fn a_dash_is_stdout_for_every_output() {
    let at: &Path = &recording(2);
    let run = "run 0001_left.png 0001_right.png";
    let cases: [(&str, &[u8]); 4] = [
        (&format!("{run} --csv -"), b"id,"),
        (&format!("{run} --overlay -"), b"\x89PNG"),
        ("report . -o -", b"<!"),
        ("demo --out -", b"\x89PNG"),
    ];
    for (line, begin) in cases {
        let output = linestereo(at, line);
        assert!(output.status.success() && output.stdout.starts_with(begin), "{line}");
    }
    assert_eq!(json_lines(&succeed(at, "sequence . --out -")).len(), 2);
    assert!(!at.join("-").exists());
}

#[test]
fn pictures_are_called_what_they_are() {
    let folder = pair();
    let cases = [
        ("run l.png r.png --overlay x.jpg", "written as PNG; call it x.png"),
        ("run l.png r.png --pfm x.png", "written as PFM; call it x.pfm"),
        ("print-board 9x6 --out b.pdf", "written as SVG; call it b.svg"),
        ("sequence . --out x.csv", "written as JSONL; call it x.jsonl"),
        ("report l.png r.png -o r.txt", "written as HTML; call it r.html"),
        ("run l.png r.png --overlay no/such/x.png", "its folder does not exist"),
    ];
    all_refused(folder.path(), &cases);
}

#[cfg(unix)]
#[test]
fn what_is_finished_when_a_sequence_is_interrupted_stays() {
    let at: &Path = &recording(400);
    for name in ["-INT", "-TERM"] {
        let child = program(at, "sequence . --out results.jsonl")
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
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{output:?}");
        let finished = json_lines(&fs::read_to_string(at.join("results.jsonl")).unwrap()).len();
        assert!((1..400).contains(&finished), "{finished}");
        let words = format!("interrupted after {finished} of 400 frames; their lines are in");
        says(&stderr(&output), &[&format!("{words} results.jsonl")]);
        assert!(hidden().is_empty());
        fs::remove_file(at.join("results.jsonl")).unwrap();
    }
}

#[test]
fn a_sequence_stops_when_its_reader_does() {
    let folder = recording(60);
    let mut command = program(folder.path(), "sequence .");
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
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
    let at: &Path = &recording(2);
    for frame in 1..=2 {
        let name = |side| at.join(format!("{frame:04}_{side}.png"));
        fs::rename(name("left"), at.join("x.png")).unwrap();
        fs::rename(name("right"), name("left")).unwrap();
        fs::rename(at.join("x.png"), name("right")).unwrap();
    }
    let output = linestereo(at, "sequence .");
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let words = ["2 frames, 0 failed", "health: few_matches in 2 frames: few edges have a match"];
    says(&stderr(&output), &words);
}

#[test]
fn nothing_that_was_asked_for_is_passed_over() {
    let folder = recording(2);
    let at = folder.path();
    fs::create_dir(at.join("empty")).unwrap();
    let unnamed = "no file that is called like a left image";
    let cases = [
        ("sequence . --objects nosuch", "cannot read nosuch"),
        ("sequence . --objects empty", unnamed),
        ("report . --objects empty -o x.html", unnamed),
        ("run 0001_left.png 0001_right.png --objects empty", unnamed),
        // The pair's own images are no labels.
        ("run 0001_left.png 0001_right.png --objects .", unnamed),
        ("run 0001_left.png 0001_right.png --objects 0001_left.png", "is an image of the pair"),
        ("sequence nosuch", "nosuch"),
    ];
    all_refused(at, &cases);
    // A folder that has a file for some of the frames alone says so.
    fs::write(at.join("empty/0001_left.csv"), "10,10,90,90\n").unwrap();
    let said = stderr(&linestereo(at, "sequence . --objects empty"));
    says(&said, &["1 frames without a file or a message of objects"]);
    for frame in 1..=2 {
        fs::write(at.join(format!("{frame:04}_left.png")), b"no image").unwrap();
    }
    let output = linestereo(at, "sequence .");
    assert_eq!(output.status.code(), Some(2));
    says(&stderr(&output), &["no frame can be matched; 0001: ./0001_left.png"]);
    tells(at, "--help", &["Exit codes:", "130 "]);
}

#[test]
fn every_pair_has_the_scene_file_beside_it() {
    let at: &Path = &pair();
    for (name, focal) in [("rec/1", 300), ("rec/2", 600)] {
        fs::create_dir_all(at.join(name)).unwrap();
        for (from, to) in [("l.png", "left.png"), ("r.png", "right.png")] {
            fs::copy(at.join(from), at.join(name).join(to)).unwrap();
        }
        let scene = format!(r#"{{"rectified": {{"focal_px": {focal}, "baseline_m": 0.1}}}}"#);
        fs::write(at.join(name).join("scene.json"), scene).unwrap();
    }
    let found = json_lines(&succeed(at, "sequence rec"));
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
    let at: &Path = &pair();
    let calib = "cam0=[300 0 160; 0 300 120; 0 0 1]\n\
                 cam1=[300 0 160; 0 300 120; 0 0 1]\ndoffs=0\nbaseline=100\nndisp=64\n";
    let stamped = [
        ["left/1403715273262142976.png", "right/1403715273262542976.png"],
        ["left/1403715273312142976.png", "right/1403715273312542976.png"],
    ];
    let layouts: [(&str, &[[&str; 2]]); 5] = [
        ("middlebury", &[["im0.png", "im1.png"]]),
        ("capitals", &[["Left/1.png", "Right/1.png"]]),
        ("letters", &[["L/1.png", "R/1.png"], ["L/2.png", "R/2.png"]]),
        ("realsense", &[["infra1/1.png", "infra2/1.png"]]),
        ("times", &stamped),
    ];
    for (name, pairs) in layouts {
        for files in pairs {
            for (file, image) in files.iter().zip(["l.png", "r.png"]) {
                let to = at.join(name).join(file);
                fs::create_dir_all(to.parent().unwrap()).unwrap();
                fs::copy(at.join(image), to).unwrap();
            }
        }
        fs::write(at.join("middlebury/calib.txt"), calib).unwrap();
        let found = json_lines(&succeed(at, &format!("sequence {name}")));
        assert_eq!(found.len(), pairs.len(), "{name}");
        assert!(!found[0]["points"].as_array().unwrap().is_empty(), "{name}");
        assert_eq!(
            found[0]["segments"][0]["depth_m"][0].is_number(),
            name == "middlebury",
            "{name}"
        );
        let skew = if name == "times" { Value::from(400) } else { Value::Null };
        assert_eq!(found[0]["health"]["skew_us"], skew, "{name}");
        if name == "times" {
            let left = at.join("times/left");
            fs::rename(left.join("1403715273262142976.png"), left.join("1403715273258142976.png"))
                .unwrap();
            let output = linestereo(at, &format!("sequence {name}"));
            assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
            let found = json_lines(&String::from_utf8(output.stdout).unwrap());
            assert!(
                found[0]["health"]["flags"].as_array().unwrap().contains(&"skew".into()),
                "{}",
                found[0]["health"]
            );
            let found = json_lines(&succeed(at, &format!("sequence {name} --max-skew-ms 5")));
            assert!(!found[0]["points"].as_array().unwrap().is_empty(), "{}", found[0]["health"]);
        }
        // All pairs of this one are captured too far apart by now.
        let code = if name == "times" { Some(2) } else { Some(0) };
        let report = linestereo(at, &format!("report {name} -o page.html"));
        assert_eq!(report.status.code(), code, "{name}");
    }
}

#[test]
fn keys_of_a_scene_that_mean_nothing_are_refused() {
    let at: &Path = &pair();
    let cases = [
        (r#"{"focal_px": 451}"#, "\"focal_px\" is misplaced; move it into \"rectified\""),
        (r#"{"scene": "a", "height_m": 0.2}"#, "move it into \"camera\""),
        (
            r#"{"camera": {"heigth_m": 0.2, "pitch_deg": 5}}"#,
            "\"heigth_m\" in \"camera\" is unknown",
        ),
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
        (r#"{"rectified": {"focal_px": 451, "baseline_m": 75}}"#, "75 m: did you mean mm?"),
    ];
    for (content, says) in cases {
        fs::write(at.join("scene.json"), content).unwrap();
        refused(at, "run l.png r.png --scene scene.json", &[says]);
    }
    // What other programs note is none of these.
    fs::write(
        at.join("scene.json"),
        r#"{"scene": "a", "camera": {"height_m": 0.1}, "accepted": "ok", "seed": [1], "shares": {}}"#,
    )
    .unwrap();
    let said = stderr(&linestereo(at, "run l.png r.png --scene scene.json"));
    assert!(said.starts_with("scene.json: \"camera\" says no pose without both"), "{said}");
    succeed(at, "run l.png r.png --scene scene.json");
    // The help's own example is one.
    let help = succeed(at, "run --help");
    let example = help.lines().skip_while(|line| !line.starts_with("scene.json")).nth(1).unwrap();
    fs::write(at.join("scene.json"), example).unwrap();
    let found = json(at, "run l.png r.png --scene scene.json --json -");
    assert!(found["segments"][0]["depth_m"][0].is_number());
    fs::write(at.join("scene.json"), r#"{"note": "a desk", "terms": "none", "rectified_note": 1}"#)
        .unwrap();
    succeed(at, "run l.png r.png --scene scene.json");
}

/// Saves a JPEG whose EXIF says that it is shown turned.
fn save_turned(image: &image::GrayImage, path: &Path, orientation: u8) {
    let file = fs::File::create(path).unwrap();
    image::codecs::jpeg::JpegEncoder::new_with_quality(file, 95).encode_image(image).unwrap();
    with_exif(path, orientation);
}

#[test]
fn photos_are_read_as_they_are_meant() {
    let at: &Path = &pair();
    for (image, name) in images(at).iter().zip(["l", "r"]) {
        // Held upside down: the pixels lie turned by 180 degrees, and the tag says so.
        let turned = image::imageops::rotate180(image);
        save_turned(&turned, &at.join(format!("{name}_turned.jpg")), 3);
        save_turned(image, &at.join(format!("{name}_plain.jpg")), 1);
        for ending in ["tiff", "bmp", "webp"] {
            image.save(at.join(format!("{name}.{ending}"))).unwrap();
        }
    }
    let matched = |left: &str, right: &str| {
        json(at, &format!("run {left} {right} --json -"))["counts"]["matched"].as_u64()
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
        let words = ["half.jpg is not a readable image (a JPEG that ends too early)"];
        refused(at, "run half.jpg r_plain.jpg", &words);
    }
    // Something behind the end is no fault: phones write a second picture there.
    fs::write(at.join("more.jpg"), [&whole[..], b"more"].concat()).unwrap();
    assert_eq!(matched("more.jpg", "r_plain.jpg"), Some(plain));
}

/// Saves an image with 16 bits a pixel.
fn save_wide(image: &image::GrayImage, path: &Path, value: impl Fn(u8) -> u16) {
    let pixels = image.pixels().map(|grey| value(grey.0[0])).collect();
    let wide: image::ImageBuffer<image::Luma<u16>, Vec<u16>> =
        image::ImageBuffer::from_raw(image.width(), image.height(), pixels).unwrap();
    wide.save(path).unwrap();
}

#[test]
fn sixteen_bit_files_hold_what_the_sensor_has() {
    let at: &Path = &pair();
    let expected = json(at, "run l.png r.png --json -");
    for bits in [8_u32, 10, 12, 16] {
        let white = (1_u32 << bits) - 1;
        for (image, name) in images(at).iter().zip(["l16.png", "r16.png"]) {
            save_wide(image, &at.join(name), |grey| ((u32::from(grey) * white + 127) / 255) as u16);
        }
        let found = json(at, "run l16.png r16.png --json -");
        assert_eq!(found["points"], expected["points"], "{bits}");
    }
    let wrong = "run l16.png r16.png --bits 10";
    refused(at, wrong, &["values of l16.png reach", "which needs --bits 16, not 10"]);
    // Both images have one scale: a dark right one is not made brighter than the left one.
    let [left, right] = images(at);
    save_wide(&left, &at.join("l16.png"), |grey| u16::from(grey) * 16);
    save_wide(&right, &at.join("r16.png"), |grey| u16::from(grey) * 4);
    let found = json_of_any(at, "run l16.png r16.png --json -");
    let level = |side: &str| found["health"][side]["level"].as_f64().unwrap();
    assert!(level("right") < 0.4 * level("left"), "{} {}", level("right"), level("left"));
    let found = json_of_any(at, "run l16.png r16.png --json - --bits 16");
    assert!(found["health"]["left"]["level"].as_f64().unwrap() < 16.0);
}

#[test]
fn pixels_are_counted_before_the_width_as_objects_are() {
    let folder = pair();
    let asked =
        json(folder.path(), "run l.png r.png --width 160 --query 300,200 --query 320,0 --json -");
    let queries = asked["queries"].as_array().unwrap();
    assert_eq!((&queries[0]["x"], &queries[0]["y"]), (&300.into(), &200.into()));
    assert_ne!(queries[0]["reason"], "outside");
    assert_eq!(queries[1]["reason"], "outside");
}

#[test]
fn both_views_in_one_file() {
    let at: &Path = &pair();
    let [left, right] = images(at);
    let mut both = image::GrayImage::new(640, 240);
    image::imageops::replace(&mut both, &left, 0, 0);
    image::imageops::replace(&mut both, &right, 320, 0);
    both.save(at.join("both.png")).unwrap();
    let [joined, two] = ["run both.png --side-by-side --json -", "run l.png r.png --json -"]
        .map(|line| json(at, line)["points"].take());
    assert_eq!(joined, two);
    // An image whose size alone is looked at is no input.
    fs::create_dir(at.join("views")).unwrap();
    fs::rename(at.join("both.png"), at.join("views/1.png")).unwrap();
    for _ in 0..2 {
        succeed(at, "quality views --picture views/q.png");
    }
}

#[test]
fn depths_as_others_store_them() {
    let at: &Path = &pair();
    let rig = "--focal-px 300 --baseline-m 0.1 --principal-point 150,110";
    let files = "--json a.json --depth-png d.png --depth-npy d.npy --pcd p.pcd --ply p.ply";
    succeed(at, &format!("run l.png r.png {rig} {files}"));
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
    let cases: [(&str, &str); 3] = [
        ("run l.png r.png --depth-png x.png", "--depth-png needs depths"),
        ("run l.png r.png --depth-npy x.npy", "--depth-npy needs depths"),
        ("run l.png r.png --principal-point 1,2", "--principal-point alone gives no depths"),
    ];
    all_refused(at, &cases);
}

#[test]
fn quiet_verbose_and_what_shells_want() {
    let at: &Path = &pair();
    let output = linestereo(at, "run l.png r.png --quiet --csv a.csv");
    assert!(output.stdout.is_empty() && output.stderr.is_empty() && at.join("a.csv").is_file());
    let output = linestereo(at, "-q run l.png r.png --json -");
    assert!(output.stdout.starts_with(b"{") && output.stderr.is_empty());
    let verbose = "run l.png r.png -v --focal-px 300 --baseline-m 0.1 --csv a.csv";
    says(&stderr(&linestereo(at, verbose)), &["320x240", "depths from 0.480 m", "a.csv: "]);
    tells(at, "--completions bash", &["plan-rig"]);
    succeed(at, "--man pages");
    assert!(fs::read_to_string(at.join("pages/linestereo-run.1")).unwrap().contains("depth"));
    let version = succeed(at, "--version");
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
    let convert = "convert-rig rig.toml --to kalibr --out chain.yaml";
    refused(at, convert, &["k3", "calibrate --fix-k3"]);
    let line = failed(&linestereo(at, "run l.png r.png --focal-px -1 --baseline-m 0.1"));
    assert!(line.contains("focal") && !line.contains("'--"), "{line}");
    let line = failed(&linestereo(at, "run l.png r.png --width -1"));
    assert!(!line.contains("tip:"), "{line}");
    refused(at, "run l.png r.png --min-extent 7", &["--min-extent is 7; give an even number"]);
    refused(at, "report l.png r.png -o r.html --max-frames 0", &["--max-frames"]);
    let rig = "run l.png r.png --rig rig.toml --width 160";
    refused(at, rig, &["give --raw-width in place of --width, or --size"]);
    refused(at, "run l.png r.png --json no/a.json", &["no/a.json: its folder does not exist"]);
    tells(at, "frames", &["get"]);
    let help = succeed(at, "run --help");
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
    tells(at, "sequence --help", &["infra1"]);
}
