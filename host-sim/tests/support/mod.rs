//! The program as a user calls it, for every test of the command line.

use core::ops::Deref;
use linestereo::Dims;
use linestereo_frames::GrayImage;
use linestereo_tests::drawn::{Random, painted};
use serde_json::Value;
use std::fs;
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Output};

/// An empty folder, which is removed in the end.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Deref for Folder {
    type Target = Path;

    fn deref(&self) -> &Path {
        self.path()
    }
}

/// The program with the arguments of a command line, which spaces divide.
pub(crate) fn program(folder: &Path, line: &str) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_linestereo"));
    program.current_dir(folder).args(line.split_whitespace());
    program
}

/// Calls the program in a folder.
pub(crate) fn linestereo(folder: &Path, line: &str) -> Output {
    program(folder, line).output().unwrap()
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

/// A text contains all of these.
#[track_caller]
pub(crate) fn says(text: &str, words: &[&str]) {
    words.iter().for_each(|word| assert!(text.contains(word), "it does not say {word}:\n{text}"));
}

/// Calls it, has it succeed, and gives what it printed.
#[track_caller]
pub(crate) fn succeed(folder: &Path, line: &str) -> String {
    stdout(&linestereo(folder, line))
}

/// The same, of which all of these are part.
#[track_caller]
pub(crate) fn tells(folder: &Path, line: &str, words: &[&str]) -> String {
    let text = succeed(folder, line);
    says(&text, words);
    text
}

/// It failed as it promises: exit code 2 and one line on stderr, which is given.
#[track_caller]
pub(crate) fn failed(output: &Output) -> String {
    let line = stderr(output);
    assert_eq!((output.status.code(), line.lines().count()), (Some(2), 1), "{line}");
    assert!(line.starts_with("linestereo: "), "{line}");
    line
}

/// Calls it and has it fail as it promises, with nothing on stdout, in words that contain all of
/// these.
#[track_caller]
pub(crate) fn refused(folder: &Path, line: &str, words: &[&str]) {
    let output = linestereo(folder, line);
    assert!(output.stdout.is_empty(), "{line}: {output:?}");
    let said = failed(&output);
    for word in words {
        assert!(said.contains(word), "{line} does not say {word}: {said}");
    }
}

/// Calls it once for each command line, and has each fail as it promises, in words that contain the
/// second of the pair.
#[track_caller]
pub(crate) fn all_refused(folder: &Path, cases: &[(&str, &str)]) {
    cases.iter().for_each(|(line, word)| refused(folder, line, &[word]));
}

/// Calls it, has it succeed, and gives the JSON it printed.
#[track_caller]
pub(crate) fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&succeed(folder, line)).unwrap()
}

/// The same of a pair that need not be fit to be used.
#[track_caller]
pub(crate) fn json_of_any(folder: &Path, line: &str) -> Value {
    let output = linestereo(folder, line);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", stderr(&output)))
}

/// The values of lines of JSON.
#[track_caller]
pub(crate) fn json_lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// The names of a JSON object's fields, by the alphabet.
pub(crate) fn keys(value: &Value) -> String {
    let mut keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys.join(" ")
}

/// Sends a signal to a program, such as `-INT`.
#[cfg(unix)]
pub(crate) fn signal(child: &Child, signal: &str) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// A port that a board listens at, and its address.
pub(crate) fn listening() -> (TcpListener, String) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    (listener, address)
}

/// Saves an image as PNG.
pub(crate) fn save(image: &GrayImage, path: &Path) {
    fs::write(path, linestereo_sim::draw::gray_png(image).unwrap()).unwrap();
}

/// A folder with a rendered scene in the folder `name`.
pub(crate) fn with_scene(kind: &str, size: &str, name: &str) -> Folder {
    let folder = Folder::new();
    succeed(folder.path(), &format!("scene --kind {kind} --size {size} {name}"));
    folder
}

/// A folder with three drawn pairs, `rec/1` to `rec/3`.
pub(crate) fn with_drawn_pairs() -> Folder {
    let folder = with_scene("demo", "320x240", "rec/1");
    for seed in [2, 3] {
        let scene = format!("scene --kind demo --size 320x240 --seed {seed} rec/{seed}");
        succeed(folder.path(), &scene);
    }
    folder
}

/// A folder with this file.
pub(crate) fn with_file(name: &str, contents: impl AsRef<[u8]>) -> Folder {
    let folder = Folder::new();
    fs::write(folder.path().join(name), contents).unwrap();
    folder
}

/// A folder with a `rig.toml`.
pub(crate) fn with_rig(rig: &str) -> Folder {
    with_file("rig.toml", rig)
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
pub(crate) fn with_pole() -> Folder {
    let folder = Folder::new();
    let at = folder.path().join("rec/1");
    fs::create_dir_all(&at).unwrap();
    let [left, right] = pole(5, 24, 2);
    save(&left, &at.join("left.png"));
    save(&right, &at.join("right.png"));
    folder
}
