//! Recordings that are cut off, foreign, changed or made to do harm: an error each, within 256 MiB.

use crate::support::{Folder, says, stderr, stdout, succeed, with_drawn_pairs};
use crate::untrusted::within;
use linestereo_recordings::ros::cdr;
use linestereo_recordings::ros::messages::{CompressedImage, Image};
use linestereo_recordings::ros::sent::{self, Stamp};
use linestereo_tests::drawn::Random;
use linestereo_tests::fuzz;
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Output;

/// Address space of a call, KiB.
const MEMORY: usize = 256 << 10;
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

fn record(kind: u8, fields: &[&[u8]]) -> Vec<u8> {
    let fields = fields.concat();
    [&[kind][..], &(fields.len() as u64).to_le_bytes(), &fields].concat()
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

/// A chunk of these bytes, without a checksum, so that what is changed in them is looked at.
fn chunk(packer: &str, size: u64, stored: &[u8]) -> Vec<u8> {
    let length = (stored.len() as u64).to_le_bytes();
    record(6, &[&[0; 16], &size.to_le_bytes(), &[0; 4], &text(packer), &length, stored])
}

fn file(records: &[Vec<u8>]) -> Vec<u8> {
    [MAGIC, &record(1, &[&text("ros2"), &text("")]), &records.concat(), &record(15, &[&[0; 4]])]
        .concat()
}

fn lz4(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn zstd(bytes: &[u8]) -> Vec<u8> {
    compress_to_vec(bytes, CompressionLevel::Fastest)
}

fn schema(id: u16, name: &str) -> Vec<u8> {
    record(3, &[&id.to_le_bytes(), &text(name), &text("ros2msg"), &text("")])
}

fn channel(id: u16, schema: u16, topic: &str) -> Vec<u8> {
    record(4, &[&id.to_le_bytes(), &schema.to_le_bytes(), &text(topic), &text("cdr"), &[0; 4]])
}

fn message(channel: u16, time: u64, data: &[u8]) -> Vec<u8> {
    record(5, &[&channel.to_le_bytes(), &[0; 4], &time.to_le_bytes(), &time.to_le_bytes(), data])
}

fn stamp(ns: u64) -> Stamp<'static> {
    Stamp { ns, frame_id: "left" }
}

/// `cargo test -p linestereo-sim ten_thousand -- --ignored --nocapture`
#[test]
#[ignore = "it bounds the memory of the whole process, where it has to be alone"]
fn ten_thousand_mutated_recordings_take_little_memory() {
    let (inputs, mut random) = (fuzz::corpus("recordings"), Random(2));
    for _ in 0..10_000 {
        let _ = fuzz::footage("mcap", &fuzz::mutated(&inputs, &mut random));
    }
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    let kilobytes: usize = peak.trim().trim_end_matches(" kB").parse().unwrap();
    eprintln!("{kilobytes} kB at most");
    assert!(kilobytes < MEMORY, "{kilobytes}");
}

/// Calls `sequence` on a recording within the bounds.
fn bounded(folder: &Path, recording: &[u8]) -> Output {
    fs::write(folder.join("x.mcap"), recording).unwrap();
    within(MEMORY, folder, "sequence x.mcap --no-points")
}

#[test]
fn what_is_cut_off_foreign_or_a_bomb_says_so() {
    let folder = Folder::new();
    let zeros = vec![0; 64 << 20];
    let topics = |kind: &str| {
        [schema(1, kind), channel(0, 1, "/left/image"), channel(1, 1, "/right/image")].concat()
    };
    let pair =
        |kind: &str, data: &[u8]| file(&[topics(kind), message(0, 7, data), message(1, 7, data)]);
    let image_of = "sensor_msgs/msg/Image";
    let named = |encoding: &str, size: u32, step: u32| {
        let image = sent::image(stamp(1_000_000_000), [0; 2], &[9; 100]);
        let encoding = encoding.to_owned();
        let image = Image { height: size, width: size, encoding, step, ..image };
        pair(image_of, &cdr::write(&image).unwrap())
    };
    let compressed = |bytes: &[u8]| {
        let (header, format) = (stamp(1_000_000_000).into(), "png".to_owned());
        let image = CompressedImage { header, format, data: bytes.into() };
        pair("sensor_msgs/msg/CompressedImage", &cdr::write(&image).unwrap())
    };
    let mut broken = file(&[chunk("", 2000, &[0; 2000])]);
    broken.truncate(broken.len() - 1000);
    let mut huge =
        b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\x2d\x41\0\0\x2d\x41\x10\x06\0\0\0\x3d\x05\x8f\x8a"
            .to_vec();
    huge.extend(b"\0\0\0\x0bIDATx\xdac`\x80\x01\0\0\x0a\0\x01\xec$\x03\xb9");
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (b"bag\n".to_vec(), "it is no MCAP file"),
        (Vec::new(), "it is no MCAP file"),
        (MAGIC.to_vec(), "it ends early, in or behind the record at byte 8"),
        (broken, "it ends early"),
        (file(&[]), "it holds no images"),
        (
            pair("foxglove.RawImage", b""),
            "it holds images as foxglove.RawImage in cdr; sensor_msgs/msg/Image",
        ),
        (pair(image_of, b""), "the message ends early, or is of another type"),
        (file(&[topics(image_of)]), "no topics of a left and a right camera"),
        (named("bayer_rgbg8", 10, 10), "the encoding \"bayer_rgbg8\" is not read; record mono8"),
        (named("bayer_rggb16", 10, 10), "100 bytes are no 10x10 px with rows of 10 bytes"),
        (named("yuv420", 10, 10), "the encoding \"yuv420\" is not read; record mono8"),
        (named("yuv422", 10, 10), "100 bytes are no 10x10 px with rows of 10 bytes"),
        (named("mono8", 11, 11), "100 bytes are no 11x11 px"),
        (named("mono8", u32::MAX, u32::MAX), "100 bytes are no 4294967295x4294967295 px"),
        (named("mono8", 10, 9), "with rows of 9 bytes"),
        (compressed(b"GIF89a"), "neither JPEG nor PNG"),
        (compressed(&huge), "cannot be decoded"),
        // Bombs: said to be large; said to be small; many of them; a window of 128 MiB.
        (
            file(&[chunk("zstd", 64 << 20, &zstd(&zeros))]),
            "more than 32 MiB; record with smaller chunks",
        ),
        (file(&[chunk("lz4", 1 << 40, &lz4(&zeros))]), "has 1099511627776 bytes, more than 32 MiB"),
        (file(&[chunk("zstd", 9000, &zstd(&zeros))]), "it holds no images"),
        (file(&vec![chunk("lz4", 32 << 20, &lz4(&zeros[..32 << 20])); 4]), "the record at byte"),
        (file(&[chunk("zstd", 9, b"\x28\xb5\x2f\xfd\x00\x88\x01\x00\x00")]), "is broken"),
        (
            file(&[chunk("bzip2", 9, b"xxxxxxxxx")]),
            "is compressed with \"bzip2\", not with lz4 or zstd",
        ),
        (file(&[chunk("zstd", 9, b"xxxxxxxxx")]), "the chunk at byte"),
        (file(&[record(5, &[&[0; 3]])]), "the record at byte"),
        (file(&[[&[5][..], &u64::MAX.to_le_bytes()].concat()]), "it ends early"),
    ];
    for (recording, word) in cases {
        let output = bounded(folder.path(), &recording);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{word}: {said}");
        says(&said, &[word]);
        assert!(!said.contains("panicked"), "{said}");
    }
}

#[test]
fn one_bad_image_ends_its_pair_alone() {
    let folder = with_drawn_pairs();
    succeed(folder.path(), "sequence rec --out a.mcap --with images");
    let mut bytes = fs::read(folder.path().join("a.mcap")).unwrap();
    // The encoding of the third image, in the second pair; without checksums nothing else notices.
    let places: Vec<usize> =
        (0..bytes.len() - 6).filter(|&at| &bytes[at..at + 6] == b"mono8\0").collect();
    assert_eq!(places.len(), 6);
    bytes[places[2]..places[2] + 5].copy_from_slice(b"bayer");
    let chunks: Vec<usize> = (8..bytes.len() - 60)
        .filter(|&at| bytes[at] == 6 && bytes[at + 37..at + 41] == [0; 4])
        .collect();
    for at in chunks {
        bytes[at + 33..at + 37].fill(0);
    }
    let output = bounded(folder.path(), &bytes);
    stdout(&output);
    says(&stderr(&output), &["3 frames, 1 failed", "the encoding \"bayer\" is not read"]);
}
