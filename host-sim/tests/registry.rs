//! Packages with real pairs: what is checked of a package file before anything of it is laid out.
//! The packages here are made up.

use crate::support::{Folder, says};
use linestereo_frames::SceneInfo;
use linestereo_sim::registry::{Package, packages, parsed};
use std::fs;
use std::io::Write;
use std::path::Path;

/// SHA-256 of "left image", "right image" and "another left image", by sha256sum.
const SUMS: [&str; 3] = [
    "4230803192fa7f90b73203fef848dabb7d4900bee4a5802d48b8e099bb5ea864",
    "edc3dd147f33a49cc93c009be397a22ea204c0424cdf8f95924d8c03a6a7d937",
    "d66d081728b1b68bf5fa3cbd4c45dbd06db6ef72ef7c9b26b7c9a1dadd057c13",
];

fn package() -> Package {
    let [left, right, other] = SUMS;
    let list = format!(
        r#"[[package]]
        name = "pairs"
        requirement = "pairs==1"
        folder = "set/NAME"
        files = [["data/NAME_l.png", "left.png"], ["data/r.png", "right.png"]]
        info = '{{"scene":"NAME"}}'
        scenes = {{ a = ["{left}", "{right}"], b = ["{other}", "{right}"] }}"#
    );
    parsed(&list).unwrap().remove(0)
}

const FILES: [(&str, &str); 4] = [
    ("data/a_l.png", "left image"),
    ("data/r.png", "right image"),
    ("data/b_l.png", "another left image"),
    ("code.py", "evil()"),
];

fn wheel(path: &Path, files: &[(&str, &str)]) {
    let mut archive = zip::ZipWriter::new(fs::File::create(path).unwrap());
    for (name, content) in files {
        archive.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(content.as_bytes()).unwrap();
    }
    archive.finish().unwrap();
}

fn check_laid_out(package: &Package, out: &Path) {
    assert!(package.is_laid_out(out));
    let read = |path: &str| fs::read_to_string(out.join("set").join(path)).unwrap();
    assert_eq!(
        ["a/left.png", "a/right.png", "b/left.png", "b/right.png"].map(read),
        ["left image", "right image", "another left image", "right image"]
    );
    assert_eq!(
        ["a/scene.json", "b/scene.json"].map(read),
        [r#"{"scene":"a"}"#, r#"{"scene":"b"}"#]
    );
    assert_eq!(
        fs::read_dir(out.join("set/a")).unwrap().count(),
        3,
        "what nobody asked for stays in the package"
    );
}

#[test]
fn a_wheel_is_checked_and_laid_out() {
    let folder = Folder::new();
    let (file, out) = (folder.path().join("pairs-1.whl"), folder.path().join("out"));
    let package = package();
    wheel(&file, &FILES);
    assert!(!package.is_laid_out(&out));
    package.lay_out(&file, &out).unwrap();
    check_laid_out(&package, &out);
    // A changed file is no longer laid out, and is put right again.
    fs::write(out.join("set/a/left.png"), "another image").unwrap();
    assert!(!package.is_laid_out(&out));
    package.lay_out(&file, &out).unwrap();
    check_laid_out(&package, &out);
}

#[test]
fn nothing_is_laid_out_that_is_not_what_it_should_be() {
    let folder = Folder::new();
    let (file, out) = (folder.path().join("pairs-1.whl"), folder.path().join("out"));
    let fails = |word: &str| {
        let error = package().lay_out(&file, &out).unwrap_err().to_string();
        says(&error, &["pairs-1.whl", "; ", word]);
    };
    fails("cannot read");
    fs::write(&file, "no archive").unwrap();
    fails("no readable package");
    wheel(&file, &FILES[..1]);
    fails("lacks data/r.png");
    wheel(&file, &[FILES[0], ("data/r.png", "right imagE"), FILES[2]]);
    fails("data/r.png in");
    assert!(!out.exists());
}

#[test]
fn the_list_is_whole() {
    let folder = Folder::new();
    let all = packages();
    let counts: Vec<_> =
        all.iter().map(|package| (package.name.as_str(), package.scenes.len())).collect();
    assert_eq!(counts, [("scikit-image", 1), ("stereodemo", 12)]);
    for (file, name) in [
        ("scikit_image-0.26.0-cp311-cp311-manylinux_2_28_x86_64.whl", "scikit-image"),
        ("a/stereodemo-0.7-py3-none-any.whl", "stereodemo"),
    ] {
        assert_eq!(Package::of_file(Path::new(file)).unwrap().name, name);
    }
    for file in ["numpy-2.0.whl", "stereodemos-1.whl", ""] {
        let error = Package::of_file(Path::new(file)).unwrap_err();
        says(&error.to_string(), &["none of the packages"]);
    }
    for scene in all.iter().flat_map(|package| &package.scenes) {
        let path = folder.path().join("scene.json");
        fs::write(&path, &scene.info).unwrap();
        let info = SceneInfo::load(&path).unwrap();
        assert!(scene.folder.ends_with(info.scene.as_deref().unwrap()), "{}", scene.folder);
        assert!(info.rig(&path, 1.0).unwrap().is_some(), "{}", scene.folder);
    }
}
