//! `linestereo flash-image` as a user types it.

use crate::support::{all_refused, refused, says, succeed, with_rig};
use linestereo::Dims;
use linestereo_rig::RigImage;
use std::fs;

const RIG: &str = "\
version = 1
[left]
size = [640, 480]
focal_px = [532.5, 532.75]
centre_px = [320.25, 240.5]
lens = { model = \"brown-conrady\", k = [-0.28, 0.05, 0.001], p = [0.0001, -0.0002] }
[right]
size = [640, 480]
focal_px = [530.5, 531.0]
centre_px = [322.0, 239.0]
lens = { model = \"fisheye\", k = [0.01, 0.0, 0.0, 0.0] }
[pose]
rotation_rad = [0.001, 0.02, -0.003]
translation_m = [-0.0832, 0.0001, 0.0002]
";

#[test]
fn an_image_is_written_and_explained() {
    let folder = with_rig(RIG);
    let made = succeed(
        folder.path(),
        "flash-image rig.toml rig.bin --size 320x240 --alpha 0.5 --max-disparity 48",
    );
    let bytes = fs::read(folder.path().join("rig.bin")).unwrap();
    let image = RigImage::decode(&bytes).unwrap();
    assert_eq!(image.remap().dims(), Dims { width: 320, height: 240 });
    assert_eq!(image.disparities(), (0, 48));
    let explained = succeed(folder.path(), "flash-image --check rig.bin");
    assert_eq!(format!("{explained}wrote rig.bin\n"), made);
    let words = [
        "version 3, 236 bytes, sequence 0, checksum right",
        "left camera   640x480, focal length 532.50 532.75 px, centre (320.25, 240.50), skew 0 px, Brown-Conrady",
        "right camera  640x480, focal length 530.50 531.00 px, centre (322.00, 239.00), skew 0 px, fisheye",
        "baseline 83.20 mm, cameras turned by 1.16",
        "rectified     320x240, focal length ",
        "disparities   0 .. 48 px: depths from 0.",
    ];
    says(&explained, &words);
    succeed(folder.path(), "flash-image rig.toml rig.bin --focal-px 321.5");
    let image = RigImage::decode(&fs::read(folder.path().join("rig.bin")).unwrap()).unwrap();
    assert_eq!(image.remap().focal(), 321.5);
    assert_eq!(image.remap().dims(), Dims { width: 640, height: 480 }, "as the raw images");
}

#[test]
fn what_is_no_image_is_refused_by_name() {
    let folder = with_rig(RIG);
    succeed(folder.path(), "flash-image rig.toml rig.bin --size 320x240");
    let good = fs::read(folder.path().join("rig.bin")).unwrap();
    let mut damaged = good.clone();
    damaged[100] ^= 1;
    let cases: [(&[u8], &[&str]); 4] = [
        (&damaged, &["other.bin: damaged: the checksum", "sequence 0, checksum wrong"]),
        (&good[..200], &["truncated: the image has 236 bytes, 200 are here"]),
        (RIG.as_bytes(), &["foreign: "]),
        (&[0xff; 236], &["empty: "]),
    ];
    for (bytes, words) in cases {
        fs::write(folder.path().join("other.bin"), bytes).unwrap();
        refused(folder.path(), "flash-image --check other.bin", words);
    }
    refused(folder.path(), "flash-image --check missing.bin", &["missing.bin cannot be read"]);
}

#[test]
fn what_no_board_could_use_is_not_written() {
    let folder = with_rig(RIG);
    let large = RIG
        .replace("[640, 480]", "[2048, 1536]")
        .replace("px = [53", "px = [173")
        .replace(", 53", ", 173");
    let large = large
        .replace("[320.25, 240.5]", "[1024.0, 768.0]")
        .replace("[322.0, 239.0]", "[1026.0, 767.0]");
    fs::write(folder.path().join("large.toml"), large).unwrap();
    let made = "flash-image rig.toml rig.bin";
    let cases: [(&str, &str); 9] = [
        (
            &format!("{made} --max-disparity 400"),
            "is 400 but must be 8 to 256; correct --max-disparity",
        ),
        (&format!("{made} --alpha -1"), "alpha is -1 but must be 0 to 1; correct --alpha"),
        (
            &format!("{made} --focal-px 0"),
            "focal length 0 px is outside 1 to 100000; correct --focal-px",
        ),
        (&format!("{made} --size 8x8"), "give a size from 16x16"),
        (&format!("{made} --alpha 1 --focal-px 300"), "cannot be used with"),
        (&format!("{made} --check rig.bin"), "cannot be used with"),
        ("flash-image large.toml rig.bin", "2048x1536 are outside 16x16 to 1280x1280; give --size"),
        ("flash-image rig.toml", "OUT.bin"),
        ("flash-image", "rig.toml"),
    ];
    all_refused(folder.path(), &cases);
    assert!(!folder.path().join("rig.bin").exists());
}
