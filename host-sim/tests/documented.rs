//! Every command line of README.md, host-sim/README.md, docs/ and the examples of `--help`: run, or
//! listed here with the reason why it is not.

use crate::calibration::{Photographer, drawn_rig, in_right, photos, photos_of};
use crate::interchange::{USUAL, opencv_cameras, opencv_pose};
use crate::rectify::RIG;
use crate::support::{Folder, save, succeed};
use linestereo_calibration::boards::{Board, Dictionary};
use linestereo_frames::GrayImage;
use linestereo_rig::{Calibration, CameraSide};
use linestereo_sim::scene::{Pattern, Texture};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;

/// Parts of command lines that are not run, and why.
const NOT_RUN: [(&str, &str); 20] = [
    ("linestereo-lab", "the laboratory, which has tests of its own"),
    ("--serial", "a board at a port"),
    ("--tcp", "a board that listens"),
    ("monitor run.bin", "the recording of a board"),
    ("linestereo view", "stays until Ctrl-C: `view` tests it"),
    ("probe-rs", "a board and a probe"),
    ("dfu-util", "a board"),
    ("cargo xtask", "compilers and emulators of boards: `.ci/run` calls it"),
    ("robot.mcap", "a detector's messages: `recordings` writes some and reads them"),
    ("cargo test", "runs this test"),
    ("cargo +nightly fuzz", "hours; `fuzz` of `linestereo-tests` runs the same for seconds"),
    ("cargo install", "builds the program anew"),
    (
        "frames get",
        "brings packages over the network: `frames_get` and `registry` test it with packages of \
         their own",
    ),
    ("pip download", "network"),
    ("frames/oakd_lite", "frames of `frames get`"),
    ("pymavlink", "a package of Python"),
    ("ffmpeg", "cameras"),
    ("both.mp4", "a program that decodes it: `video` tests it where that is installed"),
    (".mkv", "a program that decodes it: `video` tests it where that is installed"),
    ("--camera /dev", "a camera: `video` tests one that a program plays"),
];

/// A command line, and where it stands.
#[derive(Clone, Debug)]
struct Documented {
    source: String,
    line: String,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

fn files(folder: &Path, extension: &str, list: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files(&path, extension, list);
        } else if path.extension().is_some_and(|found| found == extension) {
            list.push(path);
        }
    }
}

/// Lines of the blocks of shell in a page, continued ones joined, comments cut off.
fn of_page(text: &str) -> Vec<String> {
    let mut lines = Vec::new();
    for block in text.split("\n```sh\n").skip(1) {
        let block = block.split("\n```").next().unwrap().replace("\\\n", " ");
        lines.extend(block.lines().map(|line| line.split(" # ").next().unwrap().trim().to_owned()));
    }
    lines.retain(|line| !line.is_empty() && !line.starts_with('#'));
    lines
}

/// Examples in the help of a command: two spaces before, and two before what is said of it.
fn of_help(help: &str) -> Vec<String> {
    let is_command = |line: &&str| {
        let programs = ["linestereo ", "cargo ", "pip "];
        line.strip_prefix("  ")
            .is_some_and(|line| programs.iter().any(|program| line.starts_with(program)))
    };
    let commands = help
        .lines()
        .filter(is_command)
        .map(|line| line.trim().split("  ").next().unwrap().to_owned());
    commands.filter(|line| line.contains(' ')).collect()
}

fn documented() -> Vec<Documented> {
    let root = root();
    let (mut pages, mut sources) =
        (vec![root.join("README.md"), root.join("host-sim/README.md")], Vec::new());
    files(&root.join("docs"), "md", &mut pages);
    files(&root.join("host-sim/src/commands/help"), "txt", &mut sources);
    let all = pages.iter().map(|path| (path, of_page as fn(&str) -> Vec<String>));
    let all = all.chain(sources.iter().map(|path| (path, of_help as fn(&str) -> Vec<String>)));
    let mut list = Vec::new();
    for (path, of) in all {
        let source = path.strip_prefix(&root).unwrap().display().to_string();
        let lines = of(&fs::read_to_string(path).unwrap());
        list.extend(lines.into_iter().map(|line| Documented { source: source.clone(), line }));
    }
    list
}

fn copied(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(|entry| entry.unwrap().path()) {
        let to = to.join(entry.file_name().unwrap());
        if entry.is_dir() {
            copied(&entry, &to)
        } else {
            fs::copy(&entry, &to).map(|_| ()).unwrap()
        }
    }
}

const DETECTIONS: &str =
    r#"[{"image_id": 1, "category_id": 3, "bbox": [110, 70, 100, 90], "score": 0.9}]"#;
const BOXES: &str = "x0,y0,x1,y1,name\n110,70,210,160,thing\n";

/// Photos of a chessboard, `left01.png` and `right01.png` and so on, and the rig that took them.
fn photographed(folder: &Path) -> Calibration {
    let (rig, photos) = photos(&Board::new(9, 6, 0.025).unwrap(), 12, 3);
    saved(&photos, folder);
    rig
}

fn saved(photos: &[[GrayImage; 2]], folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    for ([left, right], number) in photos.iter().zip(1..) {
        save(left, &folder.join(format!("left{number:02}.png")));
        save(right, &folder.join(format!("right{number:02}.png")));
    }
}

/// Files of the names that the documentation uses: drawn pairs, recordings, rigs, photos, regions.
fn prepared() -> Folder {
    let folder = Folder::new();
    let at = folder.path();
    let path = |name: &str| at.join(name);
    let scene = |kind: &str, size: &str, name: &str| {
        succeed(at, &format!("scene --kind {kind} --size {size} {name}"));
    };
    scene("demo", "320x240", ".");
    for side in ["left", "right"] {
        fs::copy(path(&format!("{side}.png")), path(&format!("raw_{side}.png"))).unwrap();
    }
    scene("cards", "640x480", "SET/cards");
    for kind in ["boxes", "poles"] {
        copied(&path("SET/cards"), &path("SET").join(kind));
    }
    for kind in ["cards", "boxes", "poles"] {
        scene(kind, "320x240", &format!("FRAMES/qvga/{kind}"));
    }
    for name in ["frames/qvga", "frames/full"] {
        copied(&path("FRAMES/qvga"), &path(name));
    }
    for name in ["sets", "kitti/training"] {
        copied(&path("SET"), &path(name));
    }
    copied(&path("FRAMES/qvga"), &path("FOLDER"));
    copied(&path("FRAMES/qvga/cards"), &path("frames/desk"));
    for name in ["recording", "recordings"] {
        fs::create_dir(path(name)).unwrap();
        for (kind, number) in ["boxes", "cards", "poles"].into_iter().zip(1..) {
            for side in ["left", "right"] {
                let from = path(&format!("FRAMES/qvga/{kind}/{side}.png"));
                fs::copy(from, path(name).join(format!("{number:04}_{side}.png"))).unwrap();
            }
        }
    }
    let rig = "--focal-px 288 --baseline-m 0.12";
    succeed(at, &format!("sequence recording --out recording.mcap --with images {rig}"));
    fs::create_dir(path("rig")).unwrap();
    fs::copy(path("scene.json"), path("rig/scene.json")).unwrap();
    for (camera, side) in [("cam0", "left"), ("cam1", "right")] {
        let data = path("MH_01_easy").join(camera).join("data");
        fs::create_dir_all(&data).unwrap();
        fs::copy(path(&format!("{side}.png")), data.join("1403636579763555584.png")).unwrap();
        fs::create_dir(path(camera)).unwrap();
    }
    fs::write(path("rig.toml"), RIG).unwrap();
    for format in [
        "opencv-xml --out calib.xml", "opencv-yaml --out stereo.yml", "kalibr --out camchain.yaml",
        "ros --out left.yaml --out right.yaml", "euroc --out cam0.yaml --out cam1.yaml",
    ] {
        succeed(at, &format!("convert-rig rig.toml --to {format}"));
    }
    for camera in ["cam0", "cam1"] {
        fs::copy(path(&format!("{camera}.yaml")), path(camera).join("sensor.yaml")).unwrap();
        fs::copy(path(&format!("{camera}.yaml")), path(&format!("{camera}_sensor.yaml"))).unwrap();
    }
    fs::write(path("intrinsics.yml"), opencv_cameras(USUAL)).unwrap();
    fs::write(path("extrinsics.yml"), opencv_pose(false)).unwrap();
    fs::write(path("detections.json"), DETECTIONS).unwrap();
    fs::write(path("boxes.csv"), BOXES).unwrap();
    for folder in [".local/share/bash-completion/completions", ".zfunc", ".config/fish/completions"]
    {
        fs::create_dir_all(path(folder)).unwrap();
    }
    photographed(&path("photos"));
    let charuco =
        Board::charuco([8, 6], 0.028, 0.021, Dictionary::named("DICT_5X5_100").unwrap(), false)
            .unwrap();
    let marked: Vec<[GrayImage; 2]> = photos_of(&drawn_rig(2), &charuco, 8, 5, 0.5)
        .into_iter()
        .map(|(_, photos)| photos)
        .collect();
    saved(&marked, &path("marked"));
    folder
}

/// Message of a command that fails. Pipes into other programs are cut off.
fn failure(folder: &Path, line: &str) -> Option<String> {
    let line = line.replace("cargo run -- ", "linestereo ").replace("cargo run", "linestereo");
    let line = line.split(" | jq").next().unwrap();
    let programs = Path::new(env!("CARGO_BIN_EXE_linestereo")).parent().unwrap();
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap_or_default());
    let shell = Command::new("sh")
        .args(["-e", "-c", line])
        .current_dir(folder)
        .env("PATH", path)
        .env("HOME", folder)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&shell.stderr).into_owned();
    // Rigs of the documentation are not those of the drawn pairs: that is seen, and right.
    let is_unfit = said.contains("not fit to be used");
    (!shell.status.success() && !is_unfit).then(|| format!("{line}\n    {said}"))
}

/// Takes a minute where the machine is busy: a hundred programs, five of which calibrate.
#[test]
#[cfg(unix)]
fn every_command_line_runs_or_is_listed() {
    let all = documented();
    assert!(all.len() > 100, "{}", all.len());
    for (part, why) in NOT_RUN {
        assert!(
            all.iter().any(|command| command.line.contains(part)),
            "no command line holds \"{part}\" ({why}): unlist it"
        );
    }
    let mut by_source: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for command in
        all.iter().filter(|command| !NOT_RUN.iter().any(|(part, _)| command.line.contains(part)))
    {
        by_source.entry(&command.source).or_default().push(&command.line);
    }
    by_source.remove(QUICKSTART); // in files of its own, below
    let run: usize = by_source.values().map(Vec::len).sum();
    let base = prepared();
    let (sources, failures) = (Mutex::new(by_source.into_iter()), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let Some((source, lines)) = sources.lock().unwrap().next() else { break };
                    let folder = Folder::new();
                    copied(base.path(), folder.path());
                    let failed = lines.iter().filter_map(|line| failure(folder.path(), line));
                    let failed: Vec<String> =
                        failed.map(|said| format!("{source}: {said}")).collect();
                    failures.lock().unwrap().extend(failed);
                }
            });
        }
    });
    let failures = failures.into_inner().unwrap();
    assert!(failures.is_empty(), "{} of {run} fail:\n{}", failures.len(), failures.join("\n"));
    assert!(run > 60, "{run}");
}

const QUICKSTART: &str = "docs/quickstart-pc.md";

/// The page from photos to objects, line by line, with nothing but what its reader has: photos of a
/// board, a raw pair, boxes.
#[test]
#[cfg(unix)]
fn the_quick_start_ends_with_the_depth_of_an_object() {
    let at: &Path = &Folder::new();
    let rig = photographed(&at.join("photos"));
    // A wall 0.6 m before the left camera, with a card 0.4 m before it.
    let texture = |size: f64, seed| {
        Texture::grained(
            Pattern::Mosaic { greys: [50.0, 210.0], cell: [1.3 * size, size] },
            20.0,
            0.2 * size,
            seed,
        )
    };
    let (wall, card) = (texture(0.05, 1), texture(0.025, 2));
    for (eye, name) in CameraSide::BOTH.into_iter().zip(["left.png", "right.png"]) {
        let photographer = Photographer::new(&rig, eye);
        let take = |depth: f64, texture: &Texture| {
            let corner = [0.0, 0.0, depth];
            let seen = |point: [f64; 3]| {
                if eye == CameraSide::Left { point } else { in_right(&rig, point) }
            };
            let first = seen(corner);
            let along = |direction: [f64; 3]| {
                let end = seen([0, 1, 2].map(|i| corner[i] + direction[i]));
                [0, 1, 2].map(|i| end[i] - first[i])
            };
            let plane = [first, along([1.0, 0.0, 0.0]), along([0.0, 1.0, 0.0])];
            (
                photographer.take_plane(plane, |[x, y]| texture.grey(x, y)),
                photographer.take_plane(plane, |[x, y]| {
                    if x.abs() < 0.07 && y.abs() < 0.06 { 255.0 } else { 0.0 }
                }),
            )
        };
        let ((mut image, _), (near, is_near)) = (take(0.6, &wall), take(0.4, &card));
        for ((pixel, near), is_near) in image.pixels.iter_mut().zip(near.pixels).zip(is_near.pixels)
        {
            if is_near > 127 {
                *pixel = near;
            }
        }
        save(&image, &at.join(name));
    }
    fs::write(
        at.join("detections.json"),
        r#"[{"image_id": 1, "category_id": 1, "bbox": [125, 90, 70, 55], "score": 0.9}]"#,
    )
    .unwrap();
    let page = documented().into_iter().filter(|command| command.source == QUICKSTART);
    let lines: Vec<String> = page.map(|command| command.line).collect();
    let is_run = |line: &&String| !NOT_RUN.iter().any(|(part, _)| line.contains(part));
    let failures: Vec<String> =
        lines.iter().filter(is_run).filter_map(|line| failure(at, line)).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    for command in
        ["calibrate photos", "--objects detections.json", "report", "rectify", "quality", "explain"]
    {
        assert!(lines.iter().any(|line| line.contains(command)), "{command} is not on the page");
    }
    let found: serde_json::Value =
        serde_json::from_slice(&fs::read(at.join("depth.json")).unwrap()).unwrap();
    let depth =
        found["objects"][0]["depth_m"].as_f64().unwrap_or_else(|| panic!("{}", found["objects"]));
    // The card's depth as the rectified left camera has it, which is turned by the rig's rotation
    // of less than 2 degrees.
    assert!((depth - 0.4).abs() < 0.012, "{depth}");
    assert!(fs::metadata(at.join("report.html")).unwrap().len() > 100_000);
}
