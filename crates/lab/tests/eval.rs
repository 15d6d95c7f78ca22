//! `linestereo-lab eval`.

use crate::support::{json, lab, refused, scenes, succeed};
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// Calls the program with 768 MiB of address space, for at most half a minute.
fn bounded(folder: &Path, args: &[&str]) -> Output {
    let call = "ulimit -v 786432; exec timeout 30 \"$0\" \"$@\"";
    let program = env!("CARGO_BIN_EXE_linestereo-lab");
    Command::new("sh").args(["-c", call, program]).args(args).current_dir(folder).output().unwrap()
}

#[test]
fn every_scene_has_a_line_whatever_the_number_of_threads() {
    let folder = scenes();
    let eval = ["eval", ".", "--no-times", "--noise", "2"];
    let text = succeed(folder.path(), &eval);
    for name in ["a ", "b ", "pooled "] {
        assert!(text.lines().any(|line| line.starts_with(name)), "{name} is not in\n{text}");
    }
    assert_eq!(text, succeed(folder.path(), &[&eval[..], &["--threads", "1"]].concat()));
    let json = json(folder.path(), &["eval", ".", "--no-times", "--json", "-"]);
    assert_eq!(json["scenes"].as_array().map(Vec::len), Some(2));
    assert!(succeed(folder.path(), &["eval", ".", "--objects"]).contains("as given"));
    assert!(succeed(folder.path(), &["eval-pixels", ".", "--queries", "50"]).contains("visible"));
}

#[test]
fn what_is_wrong_is_one_line() {
    let folder = scenes();
    refused(&lab(folder.path(), &["eval", ".", "--gain", "nan"]), "--gain is NaN; give 0 to 16");
    refused(&lab(folder.path(), &["eval", "none"]), "none");
}

#[test]
fn an_array_is_unpacked_as_far_as_its_header_says() {
    let folder = TempDir::new().unwrap();
    let mut image = b"P5\n64 48\n255\n".to_vec();
    image.extend((0..64 * 48_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8));
    for side in ["left", "right"] {
        fs::write(folder.path().join(format!("{side}.pgm")), &image).unwrap();
    }
    let header = |shape: &str| {
        let text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
        [b"\x93NUMPY\x01\x00".as_slice(), &(text.len() as u16).to_le_bytes(), text.as_bytes()]
            .concat()
    };
    for (shape, says) in
        [("(16000, 16000)", "is not an image"), ("(48, 63)", "give two images of one size")]
    {
        let mut archive = ZipWriter::new(fs::File::create(folder.path().join("disp.npz")).unwrap());
        archive.start_file("disp.npy", SimpleFileOptions::default()).unwrap();
        archive.write_all(&header(shape)).unwrap();
        for _ in 0..640 {
            archive.write_all(&[0x3f; 1 << 20]).unwrap();
        }
        archive.finish().unwrap();
        refused(&bounded(folder.path(), &["eval", "."]), says);
    }
}
