//! `linestereo run` as a user types it: its files, and every kind of bad input.

use crate::support::{
    Folder, all_refused, failed, json, json_lines, json_of_any, keys, linestereo, refused, says,
    stderr, stdout, succeed, tells, with_scene,
};
use linestereo_tests::captured;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A folder with the scene `cards` in it.
fn cards() -> Folder {
    let folder = with_scene("cards", "160x120", "cards");
    let scene = folder.path().join("cards");
    assert!(scene.is_dir(), "the scene has a folder of its own");
    folder
}

const PAIR: &str = "run cards/left.png cards/right.png --scene cards/scene.json";

#[test]
fn the_summary_tells_the_depths_of_all_points_and_the_near_limit() {
    let at: &Path = &cards();
    let rig = "--focal-px 200 --baseline-m 0.05 --max-disparity 24";
    let listing = json(at, &format!("{PAIR} {rig} --json -"));
    let points = listing["points"].as_array().unwrap().iter();
    let disparities = || points.clone().map(|point| point[2].as_f64().unwrap());
    let nearest = 10.0 / disparities().fold(0.0, f64::max);
    let farthest = 10.0 / disparities().fold(f64::INFINITY, f64::min);
    let depths = format!("depths from {nearest:.2} m to {farthest:.2} m\n");
    // 10 px m / 22.5 px; not 23 px, which are 0.43 m.
    tells(at, &format!("{PAIR} {rig}"), &[&depths, "nothing nearer than 0.44 m is measured"]);
}

#[test]
fn the_scene_file_beside_a_pair_is_used_and_named() {
    let at: &Path = &cards();
    let pair = "run cards/left.png cards/right.png";
    let expected = json(at, &format!("{PAIR} --json -"));
    assert_eq!(json(at, &format!("{pair} --json -")), expected);
    let said = succeed(at, pair);
    assert!(said.starts_with("cards/scene.json lies beside the pair: disparities 0 to"), "{said}");
    // Options come before what the file says of the same, alone and in a sequence.
    let rig = "--focal-px 200 --baseline-m 0.03";
    let given = json(at, &format!("{pair} {rig} --json -"));
    assert_eq!(given, json(at, &format!("{PAIR} {rig} --json -")));
    let line = json_lines(&succeed(at, &format!("sequence cards {rig}"))).remove(0);
    assert_eq!(line["segments"], given["segments"]);
    let depth = |found: &Value| found["segments"][0]["depth_m"][0].as_f64().unwrap();
    assert!((depth(&given) / depth(&expected) - 1.0).abs() > 0.1, "the rig is that of the file");
    tells(at, &format!("{pair} {rig}"), &["beside the pair", "the rig is that of the options"]);
    let verbose = stderr(&linestereo(at, &format!("{pair} {rig} -v")));
    says(&verbose, &["by options and cards/scene.json"]);
    // A range that is none is the file's fault, unless an option comes before it.
    let text = fs::read_to_string(at.join("cards/scene.json")).unwrap();
    let mut scene: Value = serde_json::from_str(&text).unwrap();
    for range in [-4, 1000] {
        scene["max_disparity"] = range.into();
        fs::write(at.join("cards/scene.json"), scene.to_string()).unwrap();
        let words = [&*format!("cards/scene.json: max_disparity is {range}"), "8 to 159 px"];
        refused(at, pair, &words);
        succeed(at, &format!("{pair} --max-disparity 48"));
    }
    fs::write(at.join("cards/scene.json"), text).unwrap();
    // Images of another size: without depths, and why.
    for name in ["left.png", "right.png"] {
        let path = at.join("cards").join(name);
        image::open(&path).unwrap().thumbnail_exact(64, 48).save(&path).unwrap();
    }
    let reduced = format!("{pair} --max-disparity 16");
    let words = ["is not used: cards/scene.json: the calibration is for images of 160x120,"];
    let said = tells(at, &reduced, &words);
    assert!(!said.contains("depths from"), "{said}");
    let words = ["images of 160x120, but these are 64x48", "--width"];
    refused(at, &format!("{reduced} --scene cards/scene.json"), &words);
    says(&stderr(&linestereo(at, "sequence cards --max-disparity 16")), &words[..1]);
    // One of another program.
    fs::write(at.join("cards/scene.json"), "{\"nodes\": []}").unwrap();
    let said = succeed(at, &reduced);
    assert!(
        said.starts_with(
            "the scene.json beside the pair is not used: cards/scene.json is not a scene file"
        ),
        "{said}"
    );
    let unused = ["the scene.json beside the pair is not used: cards/scene.json"];
    let files = "cards/left.png cards/right.png --max-disparity 16";
    tells(at, &format!("report {files} -o r.html"), &unused);
    tells(at, &format!("quality {files} --region 0,0,64,48"), &unused);
    says(&stderr(&linestereo(at, &format!("{reduced} -q --json a.json"))), &unused);
    refused(at, &format!("{reduced} --sectors"), &["--sectors needs depths", unused[0]]);
}

/// The product of focal length and baseline gives depths, but no pose, and that of the scene file
/// says nothing of the ground then.
#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn the_product_alone_gives_no_pose() {
    let Some(scene) = captured::folder("robot_world/24_office") else { return };
    let ground = |options: &str| {
        json(&scene, &format!("run left.png right.png --json - {options}"))["ground"].clone()
    };
    let (known, product) = (ground(""), ground("--fb 16.076"));
    assert!((known["camera_height_m"].as_f64().unwrap() - 0.2876).abs() < 0.01, "{known}");
    for name in ["camera_height_m", "pitch_deg", "roll_deg"] {
        assert!(product[name].is_null(), "{product}");
    }
    let slope = |ground: &Value| ground["down_px_per_row"].as_f64().unwrap();
    assert!((slope(&product) - slope(&known)).abs() < 0.01, "{product} {known}");
}

#[test]
fn what_is_infinitely_far_has_minus_the_offset_as_its_disparity() {
    let at: &Path = &cards();
    // Exchanged images: every disparity is negative.
    fs::remove_file(at.join("cards/scene.json")).unwrap(); // it would be used
    let flags = |options: &str| {
        let range = "--min-disparity=-30 --max-disparity 16";
        let run = format!("run cards/right.png cards/left.png {range} --json - {options}");
        json_of_any(at, &run)["health"]["flags"].to_string()
    };
    let rig = "--focal-px 150 --baseline-m 0.06";
    says(&flags(""), &["beyond_infinity"]);
    says(&flags(rig), &["beyond_infinity"]);
    let squinting = flags(&format!("{rig} --disparity-offset-px 32"));
    assert!(!squinting.contains("beyond_infinity"), "{squinting}");
    fs::write(at.join("squint.json"), "{\"disparity_zero_px\": -32}").unwrap();
    let squinting = flags("--scene squint.json");
    assert!(!squinting.contains("beyond_infinity"), "{squinting}");
}

#[test]
fn json_has_the_promised_keys_and_shapes() {
    let folder = cards();
    let json = json(folder.path(), &format!("{PAIR} --json -"));
    assert_eq!(keys(&json), "bars counts health points segments size");
    assert_eq!(json["size"], serde_json::json!([160, 120]));
    let segments = json["segments"].as_array().unwrap();
    assert!(!segments.is_empty());
    for (id, segment) in segments.iter().enumerate() {
        let expected = "confidence depth_m disparity_px id left owner sigma_px techniques";
        assert_eq!(keys(segment), expected);
        assert_eq!(segment["id"], id);
        assert_eq!(keys(&segment["techniques"]), "census feature window");
        assert!(["left", "right", "both"].contains(&segment["owner"].as_str().unwrap()));
        for end in [0, 1] {
            let [x, y] = [0, 1].map(|axis| &segment["left"][end][axis]);
            let numbers = [x, y, &segment["disparity_px"][end], &segment["depth_m"][end]];
            assert!(numbers.iter().all(|number| number.is_f64()), "{segment}");
        }
        assert!((0.0..=1.0).contains(&segment["confidence"].as_f64().unwrap()));
    }
    for point in json["points"].as_array().unwrap() {
        assert!(
            point[0].is_u64() && point[1].is_u64() && point[2].is_f64() && point[3].is_f64(),
            "{point}"
        );
    }
    let count = |name: &str| {
        json["counts"][name].as_u64().unwrap_or_else(|| panic!("{name} is not counted"))
    };
    let rejected: u64 =
        linestereo::results::Rejection::ALL.iter().map(|reason| count(reason.name())).sum();
    assert_eq!(count("segments_left"), count("matched") + rejected);
    assert_eq!(count("matched") as usize, segments.len());
    assert!(count("segments_right") > 0);
    let health = &json["health"];
    let named = "flags least_disparity_px left noise range right row_drift_px row_offset_px rows \
                 skew_us still tear";
    assert_eq!(keys(health), named);
    assert_eq!(health["flags"], serde_json::json!([]));
    assert!(
        health["skew_us"].is_null() && health["row_drift_px"].is_null(),
        "a single file has neither: {health}"
    );
    assert_eq!(keys(&health["left"]), "black detail level view white");
    // The rows are level: known as well as the samples say themselves, who are few.
    let rows = |name: &str| health["rows"][name].as_f64().unwrap();
    let is_level = || rows("spread_px") < 0.1 && rows("offset_px").abs() <= 2.0 * rows("spread_px");
    assert!(health["rows"].is_null() || is_level(), "{health}");
}

#[test]
fn files_are_written_and_named() {
    let folder = cards();
    let files = "--json a.json --csv a.csv --overlay a.png";
    let words = ["wrote a.json", "wrote a.csv", "wrote a.png"];
    tells(folder.path(), &format!("{PAIR} {files}"), &words);
    for file in ["a.json", "a.csv", "a.png"] {
        assert!(fs::metadata(folder.path().join(file)).unwrap().len() > 100, "{file}");
    }
    assert!(image::open(folder.path().join("a.png")).unwrap().width() >= 160);
}

#[test]
fn bad_input_gets_one_line_and_leaves_no_file() {
    let folder = cards();
    let write = |name: &str, width: u32, height: u32, grey: u8| {
        image::GrayImage::from_pixel(width, height, image::Luma([grey]))
            .save(folder.path().join(name))
            .unwrap();
    };
    write("tiny.png", 1, 1, 9);
    write("flat.png", 160, 120, 90);
    write("white.png", 160, 120, 255);
    write("other.png", 100, 120, 90);
    fs::write(folder.path().join("text.png"), "no image").unwrap();
    fs::copy(folder.path().join("cards/left.png"), folder.path().join("left.png")).unwrap();
    let before = fs::read_dir(folder.path()).unwrap().count();
    for (run, word) in [
        ("run left.png left.png --on BOARD", "unexpected argument '--on'"),
        ("run left.png missing.png", "missing.png"),
        ("run left.png other.png", "size"),
        ("run left.png text.png", "text.png"),
        ("run tiny.png tiny.png", "tiny.png"),
        ("run flat.png flat.png", "flat.png"),
        ("run white.png white.png", "white.png"),
        ("run left.png left.png --max-disparity 160", "--max-disparity"),
        ("run left.png left.png --max-disparity 3", "--max-disparity"),
        ("run left.png left.png --min-disparity 5", "--min-disparity"),
        ("run left.png left.png --min-confidence 2", "--min-confidence"),
        ("run left.png left.png --margin-m 0.1 0.1", "--focal-px"),
        ("run left.png left.png --focal-px 0 --baseline-m 0.1", "focal"),
    ] {
        refused(folder.path(), &format!("{run} --json out.json --overlay out.png"), &[word]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), before, "{run} left a file");
    }
    let unwritten = format!("{PAIR} --json a.json --csv no/such/folder/a.csv");
    refused(folder.path(), &unwritten, &["no/such/folder"]);
    assert!(!folder.path().join("a.json").exists(), "one file could not be written, so none is");
}

/// The pair of a scene as cameras deliver it that are exchanged or mirrored, of which one or both
/// hang upside down; and one with nothing in it.
fn with_bad_pairs() -> Folder {
    let folder = with_scene("demo", "320x240", "good");
    let at = folder.path();
    let open = |name: &str| image::open(at.join("good").join(name)).unwrap().into_luma8();
    let [left, right] = [open("left.png"), open("right.png")];
    let soft = image::GrayImage::from_fn(320, 240, |x, _| image::Luma([60 + (x / 2) as u8]));
    for (name, pair) in [
        ("exchanged", [right.clone(), left.clone()]),
        (
            "mirrored",
            [image::imageops::flip_horizontal(&left), image::imageops::flip_horizontal(&right)],
        ),
        ("turned", [image::imageops::rotate180(&left), image::imageops::rotate180(&right)]),
        ("upside_down", [image::imageops::rotate180(&left), right]),
        ("empty", [soft.clone(), soft]),
    ] {
        fs::create_dir(at.join(name)).unwrap();
        for (image, side) in pair.iter().zip(["left.png", "right.png"]) {
            image.save(at.join(name).join(side)).unwrap();
        }
    }
    folder
}

const BAD: [&str; 5] = ["exchanged", "mirrored", "turned", "upside_down", "empty"];

#[test]
fn a_pair_of_which_nothing_is_to_be_used_ends_with_2() {
    let at: &Path = &with_bad_pairs();
    for name in BAD {
        let pair = format!("{name}/left.png {name}/right.png");
        let output = linestereo(at, &format!("run {pair} --json out.json"));
        let (told, said) = (String::from_utf8_lossy(&output.stdout), failed(&output));
        // Results are written, and the line names the first flag that is told.
        assert!(at.join("out.json").is_file() && told.contains("wrote out.json"), "{name}: {told}");
        let first = told.lines().find_map(|line| line.strip_prefix("health: "));
        let is_told = first.is_some_and(|flag| said.contains(flag));
        assert!(is_told || said.contains("nothing is matched"), "{name}: {told} {said}");
        assert!(!first.is_some_and(|flag| flag.starts_with("segments_dropped")), "{name}: {told}");
        fs::remove_file(at.join("out.json")).unwrap();
        for (line, file, word) in [
            (format!("report {pair} -o page.html"), "page.html", "no pair can be used"),
            (format!("sequence {name} --out lines.jsonl"), "lines.jsonl", "no frame can be used"),
        ] {
            let output = linestereo(at, &line);
            assert_eq!(output.status.code(), Some(2), "{line}: {output:?}");
            assert!(at.join(file).is_file() && stderr(&output).contains(word), "{line}");
        }
    }
    // What cures it is told, not only that few edges match.
    let near = "run good/left.png good/right.png --max-disparity 10 -q";
    refused(at, near, &["range_small: ", "--max-disparity 18 or more"]);
    // Some of many are counted, and are no failure.
    let words = ["5 frames are not fit to be used, or nothing is matched in them"];
    tells(at, "sequence . --out lines.jsonl", &words);
}

/// Files of points are written all the same, and hold none.
#[test]
fn files_of_points_of_exchanged_images_are_empty() {
    let at: &Path = &with_bad_pairs();
    let options = "--focal-px 288 --baseline-m 0.12 --ply cloud.ply --pcd cloud.pcd";
    // Vertices of the PLY file, points of the PCD file, and lines after the head of the latter.
    let clouds = |name: &str| {
        let output = linestereo(at, &format!("run {name}/left.png {name}/right.png {options}"));
        let text = |file: &str| fs::read_to_string(at.join(file)).unwrap();
        let number = |text: &str, key: &str| -> usize {
            let line = text.lines().find_map(|line| line.strip_prefix(key));
            line.unwrap_or_else(|| panic!("{name}: no {key}")).parse().unwrap()
        };
        let (ply, pcd) = (text("cloud.ply"), text("cloud.pcd"));
        let listed = pcd.lines().skip_while(|line| *line != "DATA ascii").skip(1).count();
        let counts = [number(&ply, "element vertex "), number(&pcd, "POINTS "), listed];
        (output.status.code(), counts)
    };
    let (code, [vertices, points, listed]) = clouds("good");
    assert!(code == Some(0) && vertices > 5000 && points > 5000 && listed == points);
    for name in ["exchanged", "mirrored", "turned", "upside_down"] {
        assert_eq!(clouds(name), (Some(2), [0; 3]), "{name}");
    }
}

#[test]
fn a_narrow_pair_is_searched_as_far_as_it_can_be_and_that_is_said() {
    let at: &Path = &with_scene("boxes", "64x48", "out");
    fs::remove_file(at.join("out/scene.json")).unwrap(); // it says how far to search
    let run = "run out/left.png out/right.png";
    let output = linestereo(at, run);
    says(&stdout(&output), &["disparities below 63: "]);
    says(&stderr(&output), &["disparities below 63 are searched, as images of 64x48"]);
    // A range that is asked for is not changed.
    let words = ["64 does not fit an image of 64x48"];
    refused(at, &format!("{run} --max-disparity 64"), &words);
    assert!(stderr(&linestereo(at, &format!("{run} --max-disparity 32"))).is_empty());
}

#[test]
fn sectors_are_listed_drawn_and_told() {
    let folder = cards();
    let extra = "--sectors --fan fan.png --mavlink told.bin";
    let words = ["sectors of 5 degrees, up to 10 m\n", "wrote told.bin\n"];
    tells(folder.path(), &format!("{PAIR} {extra}"), &words);
    let json = json(folder.path(), &format!("{PAIR} --sectors --json -"));
    let sectors = json["sectors"].as_array().unwrap();
    assert_eq!(sectors.len(), 72);
    // Both forms of an option with two values.
    let spelled = "--sectors --sector-heights=-0.5 2 --json -";
    let again = self::json(folder.path(), &format!("{PAIR} {spelled}"));
    assert_eq!(again["sectors"].as_array().unwrap().len(), 72);
    let state = |index: usize| sectors[index]["state"].as_str().unwrap();
    assert!((10..63).all(|index| state(index) == "outside"));
    assert!((0..72).any(|index| state(index) == "obstacle"), "{json}");
    let told = fs::read(folder.path().join("told.bin")).unwrap();
    // HEARTBEAT, then OBSTACLE_DISTANCE with the same distances.
    assert_eq!(
        (told.len(), told[0], told[7], told[21], told[28]),
        (21 + 179, 0xfd, 0, 0xfd, 330_u16.to_le_bytes()[0])
    );
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
    for name in ["left.png", "right.png"] {
        fs::copy(folder.path().join("cards").join(name), folder.path().join(name)).unwrap();
    }
    let cases: [(&str, &str); 4] = [
        ("run left.png right.png --sectors", "--focal-px and --baseline-m"),
        (
            &format!("{PAIR} --sectors --sector-range 1000"),
            "linestereo: range (m) is 1000 but must be 0.1 to 600; change --sector-range\n",
        ),
        (&format!("{PAIR} --sectors --sector-heights 2 1"), "change --sector-heights\n"),
        (&format!("{PAIR} --policy silent"), "--mavlink"),
    ];
    all_refused(folder.path(), &cases);
}
