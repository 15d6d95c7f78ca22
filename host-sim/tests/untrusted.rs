//! Files that are broken, huge or endless: each ends itself, within the memory and time that
//! `docs/security.md` states.

use crate::support::{
    Folder, failed, json_lines, says, stderr, stdout, with_drawn_pairs, with_scene,
};
use core::fmt::Write as _;
use serde_json::{Value, json};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Output};

/// Address space of a call, KiB; the program alone takes a tenth.
const MEMORY: usize = 768 << 10;
/// 16x16 px, with a palette of 4 bytes.
const PALETTE: &str = "89504e470d0a1a0a0000000d4948445200000010000000100803000000282d0f5300000004504c5445090909c882072bb4\
    000000114944415478da636060646246c1235b0000cbd00181a4d4a4350000000049454e44ae426082";
/// The header of 11585x11585 px of 8 bytes, and ten bytes of them.
const HUGE: &str = "89504e470d0a1a0a0000000d4948445200002d4100002d4110060000003d058f8a\
    0000000b4944415478da6360800100000a0001ec2403b9";

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).unwrap()).collect()
}

/// Calls the program within the bounds.
fn bounded(folder: &Path, line: &str) -> Output {
    within(MEMORY, folder, line)
}

/// Calls the program within this address space, KiB, and 30 s: tests share two cores, and run what
/// is not optimized.
pub(crate) fn within(memory: usize, folder: &Path, line: &str) -> Output {
    let call = format!("ulimit -v {memory}; exec timeout 30 \"$0\" \"$@\"");
    Command::new("sh")
        .args(["-c", &call, env!("CARGO_BIN_EXE_linestereo")])
        .args(line.split(' '))
        .current_dir(folder)
        .output()
        .unwrap()
}

/// The same, refused in one line.
#[track_caller]
fn refused(folder: &Path, line: &str, word: &str) {
    says(&failed(&bounded(folder, line)), &[word]);
}

fn write_noise(path: &Path, (width, height): (usize, usize), first: usize) {
    let mut image = format!("P5\n{width} {height}\n255\n").into_bytes();
    image.extend((first..first + width * height).map(|i| {
        // One product alone nearly repeats, 8, 13, 21, .. px further along a row.
        let mixed = (i as u32).wrapping_mul(2_654_435_761);
        ((mixed ^ mixed >> 15).wrapping_mul(2_246_822_519) >> 24) as u8
    }));
    fs::write(path, image).unwrap();
}

/// Frames of `sequence` with their errors, or null.
fn frames(folder: &Path) -> Vec<(String, Value)> {
    let lines = json_lines(&stdout(&bounded(folder, "sequence rec --no-points")));
    let named = |line: &Value| (line["name"].as_str().unwrap().to_owned(), line["error"].clone());
    lines.iter().map(named).collect()
}

#[test]
fn a_bad_file_ends_its_frame_alone() {
    let folder = with_drawn_pairs();
    let at = |name: &str| folder.path().join("rec").join(name);
    let left = fs::read(at("2/left.png")).unwrap();
    let text = fs::read(at("2/scene.json")).unwrap();
    for (file, content, says) in [
        ("2/left.png", bytes(PALETTE), "its decoder failed"),
        ("2/left.png", bytes(HUGE), "more than 33 million pixels or 128 MiB of pixels"),
        ("2/scene.json", b"{".to_vec(), "is not a scene file"),
        ("2/scene.json", vec![b' '; 2 << 20], "larger than 1 MiB"),
    ] {
        fs::write(at(file), content).unwrap();
        let found = frames(folder.path());
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["1", "2", "3"], "{file}");
        let errors: Vec<bool> = found.iter().map(|(_, error)| !error.is_null()).collect();
        assert_eq!(errors, [false, true, false], "{file}");
        assert!(found[1].1.as_str().unwrap().contains(says), "{file}: {}", found[1].1);
        fs::write(at("2/left.png"), &left).unwrap();
        fs::write(at("2/scene.json"), &text).unwrap();
    }
    // A pipe that nobody writes to is no image.
    fs::remove_file(at("2/left.png")).unwrap();
    assert!(Command::new("mkfifo").arg(at("2/left.png")).status().unwrap().success());
    assert_eq!(frames(folder.path()).len(), 2);
}

#[test]
fn links_to_a_folder_above_end() {
    let folder = with_drawn_pairs();
    for name in ["rec/a", "rec/b"] {
        symlink(".", folder.path().join(name)).unwrap();
    }
    assert_eq!(frames(folder.path()).len(), 3);
    let empty = Folder::new();
    for name in ["a", "b"] {
        symlink(".", empty.path().join(name)).unwrap();
    }
    refused(empty.path(), "sequence .", "no pair was found in any known layout");
}

#[test]
fn masks_and_outlines_cost_what_they_show() {
    let folder = Folder::new();
    let (width, height) = (1280, 960);
    // 16 px of disparity: the same image twice is not fit to be used.
    for (side, first) in [("left.pgm", 0), ("right.pgm", 16)] {
        write_noise(&folder.path().join(side), (width, height), first);
    }
    let full = json!({"segmentation": {"size": [height, width], "counts": [0, width * height]}, "image_id": 1});
    // Each edge crosses every row.
    let corners: Vec<usize> = (0..3000).flat_map(|i| [i * 7 % width, i % 2 * height]).collect();
    let zigzag = json!({"segmentation": [corners], "image_id": 1});
    for (objects, listed, skipped) in
        [(vec![full; 1024], 1024, ""), (vec![zigzag; 300], 1, "objects skipped: 299 beyond")]
    {
        fs::write(folder.path().join("objects.json"), serde_json::to_vec(&objects).unwrap())
            .unwrap();
        let args = "run left.pgm right.pgm --objects objects.json --objects-csv objects.csv";
        says(&stdout(&bounded(folder.path(), args)), &[skipped]);
        assert_eq!(
            fs::read_to_string(folder.path().join("objects.csv")).unwrap().lines().count(),
            1 + listed
        );
    }
}

#[test]
fn what_has_no_end_is_refused() {
    let folder = with_scene("demo", "320x240", ".");
    for name in ["zero.json", "zero.csv", "zero.txt", "zero.png", "zero.toml"] {
        symlink("/dev/zero", folder.path().join(name)).unwrap();
    }
    let run = "run left.png right.png";
    for name in ["zero.json", "zero.csv", "zero.txt"] {
        let output = bounded(folder.path(), &format!("{run} --objects {name}"));
        says(&stderr(&output), &["larger than 32 MiB"]);
    }
    refused(folder.path(), &format!("{run} --scene zero.json"), "larger than 1 MiB");
    refused(folder.path(), &format!("{run} --rig zero.toml"), "larger than 1 MiB");
    refused(folder.path(), "flash-image --check /dev/zero", "larger than 1 MiB");
    refused(folder.path(), "run zero.png zero.png", "no plain file");
}

#[test]
fn names_give_a_terminal_no_orders() {
    let folder = with_scene("demo", "320x240", ".");
    let name = "\u{1b}[2J\u{202e}evil";
    fs::copy(folder.path().join("left.png"), folder.path().join(format!("{name}left.png")))
        .unwrap();
    fs::copy(folder.path().join("right.png"), folder.path().join(format!("{name}right.png")))
        .unwrap();
    let mut objects = String::from("x0,y0,x1,y1,label,name\n");
    writeln!(objects, "10,10,100,100,1,{name}").unwrap();
    fs::write(folder.path().join("objects.csv"), objects).unwrap();
    let [left, right] = ["left", "right"].map(|side| format!("{name}{side}.png"));
    let run = format!("run {left} {right} --objects objects.csv");
    let written = format!("{run} --json o.json --objects-csv o.csv --verbose");
    let told = format!("{run} --objects-csv -");
    let report = format!("report {left} {right} --objects objects.csv -o report.html");
    let missing = format!("{name}.png");
    for args in [&written[..], &told, &report, "sequence .", &format!("run {missing} {missing}")] {
        let output = bounded(folder.path(), args);
        for text in [output.stdout, output.stderr] {
            assert!(!String::from_utf8_lossy(&text).contains(['\u{1b}', '\u{202e}']), "{args:?}");
        }
    }
    for file in ["o.json", "o.csv", "report.html"] {
        let text = fs::read_to_string(folder.path().join(file)).unwrap();
        assert!(text.contains("evil") && !text.contains(['\u{1b}', '\u{202e}']), "{file}");
    }
}
