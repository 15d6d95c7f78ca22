//! Videos: the same records as of the image files they were made of, by our readers and by ffmpeg;
//! and all that may be wrong with them.

use crate::rectify::RIG;
use crate::support::{
    Folder, all_refused, failed, json_lines, linestereo, program, refused, says, signal, stderr,
    stdout, succeed, tells, with_drawn_pairs,
};
use core::time::Duration;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};
use linestereo_frames::GrayImage;
use linestereo_frames::load_gray;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Instant;

const NUMBERS: [&str; 3] = ["1", "2", "3"];

/// Three drawn pairs in `rec/1` to `rec/3`, without what else is known of them.
fn drawn() -> Folder {
    let folder = with_drawn_pairs();
    for number in NUMBERS {
        fs::remove_file(folder.path().join("rec").join(number).join("scene.json")).unwrap();
    }
    folder
}

fn pairs(folder: &Path) -> Vec<[GrayImage; 2]> {
    let image =
        |number: &str, side: &str| load_gray(&folder.join("rec").join(number).join(side)).unwrap();
    NUMBERS.iter().map(|number| [image(number, "left.png"), image(number, "right.png")]).collect()
}

fn joined([left, right]: &[GrayImage; 2]) -> Vec<u8> {
    let width = usize::from(left.dims.width);
    let rows = left.pixels.chunks(width).zip(right.pixels.chunks(width));
    rows.flat_map(|(left, right)| [left, right].concat()).collect()
}

/// Frames of these fields, each with so many bytes of something else behind its luma.
fn y4m(fields: &str, frames: &[Vec<u8>], other: usize) -> Vec<u8> {
    let mut file = format!("YUV4MPEG2 {fields}\n").into_bytes();
    for frame in frames {
        file.extend(b"FRAME Ip\n");
        file.extend(frame);
        file.extend(vec![b'F'; other]);
    }
    file
}

fn jpeg(pixels: &[u8], width: u32, quality: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let height = pixels.len() as u32 / width;
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .write_image(pixels, width, height, ExtendedColorType::L8)
        .unwrap();
    bytes
}

/// `both.y4m`, `left.y4m` and `right.y4m` of drawn pairs.
fn with_y4m(folder: &Path) {
    let pairs = pairs(folder);
    let both: Vec<Vec<u8>> = pairs.iter().map(joined).collect();
    fs::write(folder.join("both.y4m"), y4m("W640 H240 F30:1 Ip A1:1 Cmono", &both, 0)).unwrap();
    for (eye, name) in ["left.y4m", "right.y4m"].into_iter().enumerate() {
        let frames: Vec<Vec<u8>> = pairs.iter().map(|pair| pair[eye].pixels.clone()).collect();
        fs::write(folder.join(name), y4m("W320 H240 F30:1 Cmono", &frames, 0)).unwrap();
    }
}

/// Lines without what files and videos call their frames.
fn records(text: &str) -> Vec<String> {
    text.lines()
        .map(|line| line.split_once("\"size\"").unwrap_or_else(|| panic!("{line}")).1.to_owned())
        .collect()
}

fn of(folder: &Path, args: &str) -> Vec<String> {
    records(&succeed(folder, &format!("sequence {args}")))
}

/// An ffmpeg of this machine; `false` where there is none.
#[track_caller]
fn ffmpeg(folder: &Path, args: &str) -> bool {
    let mut program = Command::new("ffmpeg");
    program.args(["-nostdin", "-v", "error", "-y"]).args(args.split(' ')).current_dir(folder);
    let Ok(output) = program.output() else {
        eprintln!("SKIPPED: no ffmpeg; apt install ffmpeg");
        return false;
    };
    stdout(&output);
    true
}

#[test]
fn y4m_gives_what_its_images_give() {
    let at: &Path = &drawn();
    let expected = of(at, "rec");
    assert_eq!(expected.len(), 3);
    with_y4m(at);
    for args in ["both.y4m", "both.y4m --side-by-side", "left.y4m right.y4m"] {
        assert!(of(at, args) == expected, "{args}");
    }
    assert!(of(at, "both.y4m --frames 1..1") == of(at, "rec --frames 2..2"));
    let both: Vec<Vec<u8>> = pairs(at).iter().map(joined).collect();
    for (fields, other) in [
        ("H240 W640", 640 * 120),
        ("W640 H240 F0:0 C420mpeg2 XYSCSS=420MPEG2", 640 * 120),
        ("W640 H240 C422", 640 * 240),
        ("W640 H240 C444alpha", 3 * 640 * 240),
    ] {
        fs::write(at.join("x.Y4M"), y4m(fields, &both, other)).unwrap();
        assert!(of(at, "x.Y4M") == expected, "{fields}");
    }
    // 10 bits whose grey of 8 is the same.
    let ten = |frame: &Vec<u8>| {
        let values = frame.iter().map(|&value| ((u32::from(value) * 1023 + 127) / 255) as u16);
        values.flat_map(u16::to_le_bytes).collect::<Vec<u8>>()
    };
    let ten: Vec<Vec<u8>> = both.iter().map(ten).collect();
    fs::write(at.join("ten.y4m"), y4m("W640 H240 Cmono10", &ten, 0)).unwrap();
    assert!(of(at, "ten.y4m") == expected);
}

#[test]
fn a_video_is_input_like_any_other() {
    let at: &Path = &drawn();
    with_y4m(at);
    fs::write(at.join("rig.toml"), RIG).unwrap();
    let rig = "--rig rig.toml --size 320x240";
    // Drawn without a lens: by this rig their rows do not match, and the lines say so.
    let unfit = |args: &str| {
        let output = linestereo(at, &format!("sequence {args} {rig}"));
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        says(&stderr(&output), &["; or the images are rectified already: leave --rig out"]);
        records(&String::from_utf8(output.stdout).unwrap())
    };
    let of_files = unfit("rec");
    assert!(of_files.len() == 3 && unfit("both.y4m") == of_files);
    assert!(of_files != of(at, "rec"));
    let known = "--focal-px 288 --baseline-m 0.12";
    let alone = stderr(&linestereo(at, "sequence left.y4m --max-disparity 48"));
    says(&alone, &["left.y4m is taken as both views side by side, 160x240 each"]);
    let both = stderr(&linestereo(at, "sequence both.y4m --max-disparity 48"));
    assert!(!both.contains("taken as both views"), "{both}");
    let line = format!("sequence left.y4m right.y4m --out a.mcap --with images {known}");
    tells(at, &line, &["3 frames, 0 failed, 0 images without a partner; layout: video"]);
    tells(at, "sequence a.mcap --no-points", &["\"name\":\"0.033333333\""]);
    for input in ["both.y4m", "left.y4m right.y4m"] {
        tells(at, &format!("report {input} -o x.html"), &["3 of 3 pairs, 0 failed"]);
        tells(at, &format!("quality {input}"), &["verdict"]);
    }
    let cases = [
        ("sequence both.y4m --objects rec/1/left.png", "and a video has neither"),
        ("sequence both.y4m --out both.y4m", "the same; write to another"),
        ("sequence left.y4m rec", "rec is no video; of two paths both are videos"),
        ("sequence rec/1/left.png rec/1/right.png", "left.png is no video"),
        ("sequence left.y4m right.y4m --side-by-side", "--side-by-side is for one video"),
        ("sequence both.y4m --frames 3..9", "none of the 3 pairs in both.y4m"),
        ("sequence both.y4m --left-topic a --right-topic b", "are for an .mcap file"),
        ("sequence none.y4m", "none.y4m: it cannot be read"),
        ("sequence", "required"),
        ("sequence both.y4m --camera /dev/null", "cannot be used with"),
        ("sequence both.y4m --camera-size 9x9", "are for --camera"),
    ];
    all_refused(at, &cases);
}

#[test]
fn the_shorter_of_two_videos_ends_them() {
    let at: &Path = &drawn();
    with_y4m(at);
    let right = fs::read(at.join("right.y4m")).unwrap();
    fs::write(at.join("right.y4m"), &right[..right.len() - 50_000]).unwrap();
    let words = [
        "2 frames, 0 failed, 1 images without a partner",
        "right.y4m: cut off inside frame 2, which is left out",
    ];
    tells(at, "sequence left.y4m right.y4m --out x.jsonl", &words);
    assert!(records(&fs::read_to_string(at.join("x.jsonl")).unwrap()) == of(at, "rec")[..2]);
    tells(at, "quality left.y4m right.y4m", &["1 frames of the longer video"]);
}

#[test]
fn what_ffmpeg_decodes_gives_what_its_images_give() {
    let at: &Path = &drawn();
    with_y4m(at);
    let expected = of(at, "rec");
    for name in ["both.mkv", "both.avi", "-both.mkv", "a:b.mkv", "both.mov"] {
        let codec = if name.ends_with("mov") { "png" } else { "ffv1" };
        if !ffmpeg(at, &format!("-i both.y4m -c:v {codec} file:{name}")) {
            return;
        }
        let path = if name.starts_with('-') { name } else { &format!("./{name}") };
        assert!(of(at, &format!("-- {path}")) == expected, "{name}");
    }
    for side in ["left", "right"] {
        ffmpeg(at, &format!("-i {side}.y4m -c:v ffv1 {side}.mkv"));
    }
    assert!(of(at, "left.mkv right.mkv") == expected);
    assert!(of(at, "left.mkv right.y4m") == expected);
    assert!(of(at, "both.mkv --frames 1..2") == of(at, "rec --frames 2..3"));
    // Frames that are stored in another order than they are shown: each once, in its place.
    ffmpeg(at, "-stream_loop 3 -i both.y4m -c:v mpeg4 -bf 2 -qscale:v 2 lossy.mp4");
    fs::create_dir(at.join("decoded")).unwrap();
    ffmpeg(
        at,
        "-i lossy.mp4 -sws_flags bicubic+accurate_rnd+bitexact -pix_fmt gray decoded/%d.png",
    );
    let decoded = of(at, "decoded --side-by-side");
    assert!(decoded.len() == 12 && of(at, "lossy.mp4") == decoded);
    // JPEG files one behind the other, which have no times.
    let jpegs: Vec<Vec<u8>> = pairs(at).iter().map(|pair| jpeg(&joined(pair), 640, 90)).collect();
    fs::write(at.join("both.mjpeg"), jpegs.concat()).unwrap();
    fs::create_dir(at.join("jpegs")).unwrap();
    ffmpeg(at, "-i both.mjpeg -sws_flags bicubic+accurate_rnd+bitexact -pix_fmt gray jpegs/%d.png");
    let decoded = of(at, "jpegs --side-by-side");
    assert!(decoded.len() == 3 && of(at, "both.mjpeg") == decoded);
    // Frames at times of their own: each once.
    ffmpeg(
        at,
        "-stream_loop 3 -i both.y4m -vf setpts=N*(N+1)*1000 -fps_mode vfr -c:v ffv1 long.mkv",
    );
    let names = |video: &str| {
        let lines = json_lines(&succeed(at, &format!("sequence {video} --no-points")));
        lines.iter().map(|line| line["name"].to_string()).collect::<Vec<_>>()
    };
    assert_eq!(names("both.mkv"), ["\"0.000\"", "\"0.033\"", "\"0.067\""]);
    assert_eq!(names("both.mjpeg"), ["\"0\"", "\"1\"", "\"2\""]);
    let long = names("long.mkv");
    let times: Vec<f64> = long.iter().map(|name| name.trim_matches('"').parse().unwrap()).collect();
    assert!(times.len() == 12 && times.is_sorted() && times[11] > 1000.0, "{long:?}");
    // A video of sound alone, a text, a playlist that names another file, an address.
    ffmpeg(at, "-f lavfi -i sine=duration=0.1 sound.mkv");
    fs::write(at.join("text.mkv"), "hello").unwrap();
    fs::write(at.join("list.mkv"), "ffconcat version 1.0\nfile both.mkv\n").unwrap();
    fs::write(at.join("cut.mkv"), &fs::read(at.join("both.mkv")).unwrap()[..400]).unwrap();
    for name in ["sound.mkv", "text.mkv", "list.mkv", "cut.mkv"] {
        let words = format!("{name}: ffmpeg cannot read it (");
        refused(at, &format!("sequence {name}"), &[&words]);
    }
    refused(at, "sequence http://127.0.0.1:9/x.mp4", &["it cannot be read"]);
    let whole = fs::read(at.join("both.mkv")).unwrap();
    fs::write(at.join("part.mkv"), &whole[..whole.len() * 9 / 10]).unwrap();
    let words = ["2 frames, 0 failed", "part.mkv: ffmpeg says: "];
    tells(at, "sequence part.mkv --out x.jsonl", &words);
    assert!(records(&fs::read_to_string(at.join("x.jsonl")).unwrap()) == expected[..2]);
    ffmpeg(at, "-i both.y4m -vf crop=639:240:0:0:exact=1 -c:v ffv1 odd.mkv");
    refused(at, "sequence odd.mkv", &["odd.mkv: its width 639 is odd"]);
}

#[test]
fn hostile_heads_are_refused() {
    let folder = Folder::new();
    let frame = vec![vec![7; 64 * 48]];
    let long = format!("W64 H48 X{}", "x".repeat(2000));
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (Vec::new(), "it is empty"),
        (b"YUV4MPEG2".to_vec(), "its first line has no end"),
        (b"RIFF\n".to_vec(), "it starts with something else"),
        (y4m("", &frame, 0), "its width or height is missing"),
        (y4m("W64", &frame, 0), "its width or height is missing"),
        (y4m("Wx H48", &frame, 0), "its width or height is missing"),
        (y4m("W-64 H48", &frame, 0), "its width or height is missing"),
        (y4m("W0 H48 Cmono", &frame, 0), "frames of 0x48 px are not read"),
        (y4m("W1000000000 H1000000000", &frame, 0), "frames of 1000000000x1000000000 px"),
        (y4m("W65535 H65535", &frame, 0), "frames of 65535x65535 px"),
        (y4m("W18446744073709551615 H2", &frame, 0), "frames of 18446744073709551615x2 px"),
        (y4m("W64 H48 Crgb", &frame, 0), "its samples are \"rgb\""),
        (y4m("W64 H48 Cmono99999999999", &frame, 0), "its samples are"),
        (y4m(&long, &frame, 0), "its first line has no end"),
        (y4m("W64 H48 Cmono", &[], 0), "it holds no whole frame"),
        (y4m("W64 H96 Cmono", &frame, 0), "it holds no whole frame"),
        (
            [y4m("W64 H48 Cmono", &frame, 0), vec![b'x'; 5000]].concat(),
            "frame 1 does not begin with FRAME",
        ),
        (y4m("W63 H48 Cmono", &[vec![7; 63 * 48]], 0), "its width 63 is odd"),
    ];
    for (bytes, word) in cases {
        fs::write(folder.path().join("x.y4m"), bytes).unwrap();
        refused(folder.path(), "sequence x.y4m", &[word, ";"]);
    }
    // A whole frame and a piece of another one: there is nothing to match in it.
    fs::write(folder.path().join("x.y4m"), y4m("W64 H48 Cmono", &frame, 9)).unwrap();
    assert_eq!(linestereo(folder.path(), "sequence x.y4m").status.code(), Some(2));
}

/// A program called ffmpeg that does this; where it counts packets it lists six.
#[cfg(unix)]
fn with_fake(folder: &Path, script: &str) {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.join("bin/ffmpeg");
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
    fs::write(folder.join("x.mp4"), "x").unwrap();
}

const LISTS: &str = "case \"$*\" in *framecrc*) for i in 0 1 2 3 4 5; do echo \"0, $i, $i, 1, 9, 0x0\"; done; exit 0;; esac\n";

/// Calls the program with the fake before other programs.
#[cfg(unix)]
fn faked(folder: &Path, line: &str) -> Command {
    let mut command = program(folder, line);
    let path = format!("{}/bin:/usr/bin:/bin", folder.display());
    command.env("PATH", path).stdin(Stdio::null());
    command
}

#[cfg(unix)]
fn fake_refused(folder: &Path, script: &str, says: &str) {
    with_fake(folder, script);
    let line = failed(&faked(folder, "sequence x.mp4").output().unwrap());
    assert!(line.contains(says), "{script} does not say {says}: {line}");
}

#[test]
#[cfg(unix)]
fn an_ffmpeg_that_fails_is_named() {
    let at: &Path = &Folder::new();
    let cases = [
        (
            "echo first >&2; echo \"x.mp4: [h264 @ 0x55ab] \\033[2Jno key\" >&2; exit 1",
            "(x.mp4: [h264]",
        ),
        ("exit 3", "ffmpeg cannot read it (exit status: 3)"),
        ("kill -9 $$", "ffmpeg cannot read it (signal: 9"),
        ("cat /dev/zero", "the output of ffmpeg is not as requested (no list of packets)"),
        ("yes rubbish", "the output of ffmpeg is not as requested (no list of packets)"),
        ("yes '0, 1, 1, 1, 9, 0x0'", "it has more than 524288 frames"),
        (
            "head -c 100000000 /dev/zero >&2; echo >&2; echo end >&2; exit 1",
            "ffmpeg cannot read it (end)",
        ),
    ];
    for (script, says) in cases {
        fake_refused(at, script, says);
    }
    let cases = [
        ("echo no decoder >&2; exit 1", "ffmpeg cannot read it (no decoder)"),
        ("cat /dev/zero", "the output of ffmpeg is not as requested (no Y4M)"),
        (
            "echo YUV4MPEG2 W1000000000 H1000000000; cat /dev/zero",
            "frames of 1000000000x1000000000 px",
        ),
        (
            "echo YUV4MPEG2 W64 H48 Cmono; yes",
            "the output of ffmpeg is not as requested (no frame of Y4M)",
        ),
        (
            "echo YUV4MPEG2 W64 H48 Cmono; echo FRAME; echo x; echo lost >&2",
            "ffmpeg cannot read it (lost)",
        ),
    ];
    for (script, says) in cases {
        fake_refused(at, &format!("{LISTS}{script}"), says);
    }
    fs::remove_file(at.join("bin/ffmpeg")).unwrap();
    let output = faked(at, "sequence x.mp4").env("PATH", at.join("bin")).output().unwrap();
    let words = ["x.mp4: ffmpeg, which is needed for it, cannot be started", "apt install ffmpeg"];
    says(&stderr(&output), &words);
}

/// Has it run no more?
#[cfg(unix)]
fn is_gone(pid: &Path) -> bool {
    let pid = fs::read_to_string(pid).unwrap();
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(5) {
        let probe = Command::new("kill").args(["-0", pid.trim()]).output().unwrap();
        if !probe.status.success() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    false
}

/// Takes as long as a silent program is waited for.
#[test]
#[cfg(unix)]
fn an_ffmpeg_that_never_ends_is_ended() {
    let folder = Folder::new();
    let start = Instant::now();
    fake_refused(
        folder.path(),
        "echo $$ > pid; exec sleep 1000",
        "ffmpeg wrote nothing for 15 s and was stopped",
    );
    assert!(start.elapsed() < Duration::from_secs(25), "{:?}", start.elapsed());
    assert!(is_gone(&folder.path().join("pid")));
}

/// A fake that writes a frame of `both.y4m` after the other, and what it was called with.
#[cfg(unix)]
fn with_camera(folder: &Path, frames: &str) {
    with_y4m(folder);
    let both = fs::read(folder.join("both.y4m")).unwrap();
    let head = both.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    let frame = (both.len() - head) / 3;
    fs::write(folder.join("head"), &both[..head]).unwrap();
    for index in 0..3 {
        fs::write(folder.join(format!("frame{index}")), &both[head + frame * index..][..frame])
            .unwrap();
    }
    with_fake(folder, &format!("{LISTS}echo \"$*\" > args; echo $$ > pid; cat head; {frames}"));
}

#[test]
#[cfg(target_os = "linux")]
fn a_camera_gives_pairs_until_their_number_is_reached() {
    let at: &Path = &drawn();
    with_camera(at, "while :; do cat frame0 frame1 frame2; done");
    let line = "sequence --camera /dev/null --camera-size 640x240 --camera-fps 30 \
                --camera-format mjpeg --frames 1..3";
    let found = records(&stdout(&faked(at, line).output().unwrap()));
    let expected = of(at, "rec");
    assert_eq!(found.len(), 3);
    // What was matched before has no part in the health of the first pair.
    assert!(found[0].contains("\"points\"") && expected[1].contains("\"points\""));
    let called = fs::read_to_string(at.join("args")).unwrap();
    let wanted = "-f v4l2 -input_format mjpeg -video_size 640x240 -framerate 30 -i /dev/null";
    assert!(called.contains(wanted) && called.contains("-nostdin"), "{called}");
    assert!(is_gone(&at.join("pid")));
    // Pulled out.
    with_camera(at, "cat frame0 frame1; echo No such device >&2; exit 1");
    let output = faked(at, "sequence --camera /dev/null --out x.jsonl").output().unwrap();
    let words =
        ["2 frames, 0 failed", "it ended behind 2 frames; /dev/null: ffmpeg says: No such device"];
    says(&stdout(&output), &words);
    assert!(records(&fs::read_to_string(at.join("x.jsonl")).unwrap()) == expected[..2]);
    let cases = [
        ("sequence --camera /dev/video987", "/dev/video987: there is no camera (No such file"),
        ("sequence --camera both.y4m", "both.y4m: it is no camera; give its device"),
        ("sequence --camera /dev/null --camera-size 9", "give width and height of both views"),
        ("sequence --camera /dev/null --camera-format a/b", "give a name"),
        ("sequence --camera /dev/null --objects a.csv", "and a camera has neither"),
    ];
    all_refused(at, &cases);
}

#[test]
#[cfg(target_os = "linux")]
fn an_interrupted_camera_or_video_keeps_what_is_done() {
    let at: &Path = &drawn();
    // The end of the first line shows that pairs were matched.
    let interrupted = |line: &str, frames: &str| -> Output {
        with_camera(at, frames);
        fs::write(at.join("pid"), "").unwrap();
        let child = faked(at, line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let start = Instant::now();
        while !at.join("third").exists() && start.elapsed() < Duration::from_secs(20) {
            std::thread::sleep(Duration::from_millis(20));
        }
        fs::remove_file(at.join("third")).unwrap();
        signal(&child, "-INT");
        let output = child.wait_with_output().unwrap();
        assert!(is_gone(&at.join("pid")));
        output
    };
    // Then it waits for a frame that does not come.
    let three = "cat frame0 frame1 frame2; sleep 2; touch third; exec sleep 1000";
    stdout(&interrupted("sequence --camera /dev/null --out x.jsonl", three));
    assert!(records(&fs::read_to_string(at.join("x.jsonl")).unwrap()) == of(at, "rec"));
    for (line, word) in [
        (
            "sequence --camera /dev/null --frames 0..9 --out y.jsonl",
            "interrupted after 3 of 10 frames; their lines are in y.jsonl",
        ),
        ("sequence x.mp4 --out z.jsonl", "interrupted after 3 of 6 frames"),
    ] {
        let output = interrupted(line, three);
        assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
        says(&stderr(&output), &[word]);
    }
}
