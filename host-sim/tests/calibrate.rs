//! `linestereo calibrate` as a user meets it: files, messages, exit codes.

use crate::support::{self, Folder, tells};
use linestereo_tests::captured;
use std::fs;
use std::path::Path;

fn empty_photo(path: &Path, width: u32, height: u32) {
    image::GrayImage::from_pixel(width, height, image::Luma([128])).save(path).unwrap();
}

const BOARD: &str = "--board 9x6 --square-mm 25";

fn refused(prepare: impl Fn(&Path), words: &[&str]) {
    let folder = Folder::new();
    let photos = folder.path().join("photos");
    fs::create_dir(&photos).unwrap();
    prepare(&photos);
    let line = format!("calibrate photos --out rig.toml {BOARD}");
    support::refused(folder.path(), &line, words);
    assert!(!folder.path().join("rig.toml").exists());
}

#[test]
fn folders_without_usable_pairs() {
    refused(|_| {}, &["holds no photos", "left01.png"]);
    refused(
        |photos| empty_photo(&photos.join("left1.png"), 64, 48),
        &["left photos but no right ones"],
    );
    let pairs = |photos: &Path, left: u32, right: u32| {
        (0..left).for_each(|i| empty_photo(&photos.join(format!("left{i:02}.png")), 64, 48));
        (0..right).for_each(|i| empty_photo(&photos.join(format!("right{i:02}.png")), 64, 48));
    };
    refused(|photos| pairs(photos, 7, 6), &["7 left and 6 right", "left06.png", "--skip-unpaired"]);
    refused(|photos| pairs(photos, 6, 6), &["0 pairs only", "5 are needed", "--board"]);
    refused(
        |photos| {
            pairs(photos, 6, 6);
            empty_photo(&photos.join("right03.png"), 32, 48);
        },
        &["right03.png is 32x48", "one size"],
    );
    refused(
        |photos| {
            for side in ["left", "right"] {
                empty_photo(&photos.join(format!("{side}1.png")), 4112, 64);
            }
        },
        &["1.png: a raw image of 4112x64", "4096x4096; give all photos another size"],
    );
    refused(
        |photos| {
            pairs(photos, 6, 6);
            fs::write(photos.join("left02.png"), b"no image").unwrap();
        },
        &["left02.png", "not a readable image"],
    );
    refused(
        |photos| {
            pairs(photos, 6, 6);
            empty_photo(&photos.join("left2.png"), 64, 48);
        },
        &["left02.png", "left2.png", "the same number"],
    );
}

/// Gives a JPEG this EXIF orientation.
pub(crate) fn with_exif(path: &Path, orientation: u8) {
    let jpeg = fs::read(path).unwrap();
    let tiff = [
        b"II*\0",
        &8_u32.to_le_bytes()[..],
        &[1, 0, 0x12, 1, 3, 0, 1, 0, 0, 0, orientation, 0, 0, 0, 0, 0, 0, 0],
    ]
    .concat();
    let exif = [b"Exif\0\0", &tiff[..]].concat();
    let length = (exif.len() as u16 + 2).to_be_bytes();
    fs::write(path, [&jpeg[..2], &[0xff, 0xe1], &length, &exif, &jpeg[2..]].concat()).unwrap();
}

#[test]
fn exif_in_some_of_the_photos_is_named() {
    let photos = |photos: &Path, turned: &[&str], orientation: u8| {
        for name in (0..6).flat_map(|i| [format!("left{i:02}.jpg"), format!("right{i:02}.jpg")]) {
            let path = photos.join(&name);
            empty_photo(&path, 64, 48);
            if turned.contains(&name.as_str()) || turned.is_empty() {
                with_exif(&path, orientation);
            }
        }
    };
    let words =
        ["EXIF turns", "left03.jpg by 180 degrees", "2 of 12 photos", "exiftool", "-auto-orient"];
    refused(|at| photos(at, &["left03.jpg", "right05.jpg"], 3), &words);
    refused(
        |at| photos(at, &["right02.jpg"], 6),
        &["EXIF turns", "right02.jpg by 90 degrees", "1 of 12"],
    );
    refused(|at| photos(at, &["left01.jpg"], 2), &["left01.jpg into its mirror image"]);
    // In all of them: whatever fails may be by that.
    for orientation in [3, 6] {
        refused(|at| photos(at, &[], orientation), &["0 pairs only", "EXIF turns all photos"]);
    }
    // 1 turns nothing.
    refused(|at| photos(at, &["left03.jpg"], 1), &["0 pairs only", "take sharp photos"]);
}

#[test]
fn a_pair_of_which_exif_turns_one_image_is_refused() {
    let folder = Folder::new();
    for name in ["left.jpg", "right.jpg"] {
        image::GrayImage::from_fn(64, 64, |x, y| image::Luma([(x * y % 251) as u8]))
            .save(folder.path().join(name))
            .unwrap();
    }
    with_exif(&folder.path().join("right.jpg"), 3);
    let words = ["EXIF turns", "right.jpg by 180 degrees", "exiftool"];
    support::refused(folder.path(), "run left.jpg right.jpg", &words);
}

#[test]
fn options_that_are_slips() {
    let folder = Folder::new();
    let cases = [
        ("calibrate . --board 9 --square-mm 25", "COLSxROWS"),
        ("calibrate . --board 2x6 --square-mm 25", "3 to 60 inner corners"),
        ("calibrate . --board 9x6 --square-mm 0", "0 mm"),
        ("calibrate . --board 9x6", "--square-mm"),
    ];
    support::all_refused(folder.path(), &cases);
}

/// Copies photos under other names.
fn copied(from: &Path, to: &Path, name: impl Fn(&str) -> Option<String>) {
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "jpg")
            && let Some(name) = name(path.file_name().unwrap().to_str().unwrap())
        {
            fs::create_dir_all(to.join(&name).parent().unwrap()).unwrap();
            fs::copy(&path, to.join(name)).unwrap();
        }
    }
}

#[test]
fn photos_become_a_rig() {
    let Some(photos) = captured::folder("calibration_boards/sourishg_2") else { return };
    let folder = Folder::new();
    copied(&photos, &folder.path().join("photos"), |name| Some(name.to_owned()));
    let line = "calibrate photos --board 9x6 --square-mm 24.23 --out rig.toml --json rig.json \
                --report rig.png";
    let words =
        ["baseline 93.", "vertical residual", "coverage left", "field of view", "verdict: "];
    let text = tells(folder.path(), line, &words);
    let rms = text
        .lines()
        .find_map(|line| line.strip_prefix("stereo RMS ")?.strip_suffix(" px"))
        .unwrap();
    assert!(rms.parse::<f64>().unwrap() <= 0.22 && rms.len() == 5, "{rms}");
    let rig =
        linestereo_calibration::rig_file::RigFile::load(&folder.path().join("rig.toml")).unwrap();
    assert!((rig.calibration.baseline() - 0.0939).abs() < 5e-4);
    assert!(rig.quality.unwrap().views >= 27);
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("rig.json")).unwrap()).unwrap();
    assert!(json["parameters"]["left.fx"]["sigma"].as_f64().unwrap() > 0.0);
    assert!(image::open(folder.path().join("rig.png")).unwrap().width() > 600);
}

#[test]
fn photos_in_folders_swapped_and_of_another_board() {
    let Some(photos) = captured::folder("calibration_boards/opencv_chessboard") else { return };
    let folder = Folder::new();
    let side =
        |name: &str| name.strip_prefix("left").map_or(("right", "left"), |_| ("left", "right"));
    let number =
        |name: &str| name.trim_start_matches("left").trim_start_matches("right").to_owned();
    copied(&photos, &folder.path().join("folders"), |name| {
        Some(format!("{}/{}", side(name).0, number(name)))
    });
    copied(&photos, &folder.path().join("swapped"), |name| {
        let few = number(name).as_str() < "08.jpg";
        few.then(|| format!("{}{}", side(name).1, number(name)))
    });
    let run = |name, board| format!("calibrate {name} --board {board} --square-mm 25");
    let said = tells(folder.path(), &run("folders", "9x6"), &["13 of 13 pairs"]);
    for (name, range) in [
        ("stereo RMS ", 0.0..=0.23),
        ("baseline ", 82.9..=83.5),
        ("vertical residual ", 0.0..=0.15),
    ] {
        let value = said
            .lines()
            .find_map(|line| line.strip_prefix(name)?.split(' ').next()?.parse::<f64>().ok());
        assert!(range.contains(&value.unwrap()), "{name}{value:?}");
    }
    let fails =
        |name, board, words: &[&str]| support::refused(folder.path(), &run(name, board), words);
    fails("swapped", "9x6", &["the cameras are swapped"]);
    copied(&photos, &folder.path().join("few"), |name| {
        (number(name).as_str() < "05.jpg").then(|| name.to_owned())
    });
    fails("few", "10x7", &["the board is not 10x7", "give --board 9x6"]);
    fails("few", "9x6", &["4 pairs only", "5 are needed"]);
}
