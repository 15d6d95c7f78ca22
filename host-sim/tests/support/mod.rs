//! The program as a user calls it, for every test of the command line.

use linestereo::Dims;
use linestereo_frames::GrayImage;
use linestereo_tests::drawn::{Random, painted};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// Calls the program in a folder.
pub(crate) fn linestereo(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_linestereo")).current_dir(folder).args(args).output().unwrap()
}

/// Its output; it has to succeed.
#[track_caller]
pub(crate) fn stdout(output: &Output) -> String {
    assert!(output.status.success(), "{}", stderr(output));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Its error output.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Calls it, has it succeed, and gives what it printed.
#[track_caller]
pub(crate) fn succeed(folder: &Path, args: &[&str]) -> String {
    stdout(&linestereo(folder, args))
}

/// Calls it and has it fail as it promises: exit code 2, nothing on stdout, one line on stderr,
/// which is given.
#[track_caller]
pub(crate) fn refused(folder: &Path, args: &[&str]) -> String {
    let output = linestereo(folder, args);
    let line = stderr(&output);
    assert_eq!((output.status.code(), line.lines().count()), (Some(2), 1), "{args:?}: {line}");
    assert!(line.starts_with("linestereo: ") && output.stdout.is_empty(), "{args:?}: {line}");
    line
}

/// Calls it once for each list of arguments, and has each fail as it promises, in words that
/// contain the second of the pair.
#[track_caller]
pub(crate) fn all_refused(folder: &Path, cases: &[(&[&str], &str)]) {
    cases.iter().for_each(|(args, says)| refused_with(folder, args, &[*says]));
}

/// Calls it and has it fail as it promises, in words that contain all of these.
#[track_caller]
pub(crate) fn refused_with(folder: &Path, args: &[&str], words: &[&str]) {
    let line = refused(folder, args);
    words
        .iter()
        .for_each(|word| assert!(line.contains(word), "{args:?} does not say {word}: {line}"));
}

/// Calls it, has it succeed, and gives the JSON it printed.
#[track_caller]
pub(crate) fn json(folder: &Path, args: &[&str]) -> serde_json::Value {
    serde_json::from_str(&succeed(folder, args)).unwrap()
}

/// The same of a pair that need not be fit to be used.
#[track_caller]
pub(crate) fn json_of_any(folder: &Path, args: &[&str]) -> serde_json::Value {
    let output = linestereo(folder, args);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", stderr(&output)))
}

/// Saves an image as PNG.
pub(crate) fn save(image: &GrayImage, path: &Path) {
    fs::write(path, linestereo_sim::draw::gray_png(image).unwrap()).unwrap();
}

/// A folder with a rendered scene in the folder `name`.
pub(crate) fn with_scene(kind: &str, size: &str, name: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    succeed(folder.path(), &["scene", "--kind", kind, "--size", size, name]);
    folder
}

/// A folder with three drawn pairs, `rec/1` to `rec/3`.
pub(crate) fn with_drawn_pairs() -> TempDir {
    let folder = with_scene("demo", "320x240", "rec/1");
    for seed in ["2", "3"] {
        let name = format!("rec/{seed}");
        succeed(
            folder.path(),
            &["scene", "--kind", "demo", "--size", "320x240", "--seed", seed, &name],
        );
    }
    folder
}

/// A folder with a `rig.toml`.
pub(crate) fn with_rig(rig: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("rig.toml"), rig).unwrap();
    folder
}

/// Size of [`pole`].
pub(crate) const POLE_DIMS: Dims = Dims { width: 320, height: 240 };

/// A wall with a random grain at 8 px, and before it, from column 150 on in the rows 30 to 209, a
/// pole of so many columns.
pub(crate) fn pole(columns: i32, disparity: i32, seed: u64) -> [GrayImage; 2] {
    let bits = |key: u64, count: u32| (Random(seed ^ key).bits() >> (64 - count)) as i32;
    let cell = |x: i32, y: i32| bits(((x / 2) as u64 * 7919) ^ ((y / 2) as u64 * 104_729), 5);
    let grain = |x: i32, y: i32| cell(x, y) + cell(x + 1, y) + cell(x, y + 1);
    [0, 1].map(|eye: i32| {
        painted(POLE_DIMS.width, POLE_DIMS.height, |x, y| {
            let (x, y) = (i32::from(x), i32::from(y));
            let is_pole = (150..150 + columns).contains(&(x + eye * disparity));
            let grey =
                if is_pole && (30..210).contains(&y) { 50 } else { 90 + grain(x + eye * 8, y) };
            (grey + bits(eye as u64 ^ (x as u64 * 31 + y as u64 * 65_537), 2)) as u8
        })
    })
}

/// A folder with a pole of 5 columns at 24 px, `rec/1`.
pub(crate) fn with_pole() -> TempDir {
    let folder = TempDir::new().unwrap();
    let at = folder.path().join("rec/1");
    fs::create_dir_all(&at).unwrap();
    let [left, right] = pole(5, 24, 2);
    save(&left, &at.join("left.png"));
    save(&right, &at.join("right.png"));
    folder
}
