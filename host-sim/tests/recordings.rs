//! Recordings of ROS 2, both ways: against files of the same pixels, and against `rosbags`, which
//! knows the official definitions.

use crate::support::{
    Folder, all_refused, json, json_lines, linestereo, refused, says, stderr, stdout, succeed,
    with_drawn_pairs,
};
use linestereo_frames::load_gray;
use linestereo_recordings::mcap::{McapFault, Reader, Record, Writer};
use linestereo_recordings::ros::cdr;
use linestereo_recordings::ros::messages::{
    Detection2D, Detection2DArray, Header, ObjectHypothesisWithPose,
};
use linestereo_recordings::ros::sent::Stamp;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Command;

const TOPICS: [&str; 2] = ["/stereo/left/image_rect", "/stereo/right/image_rect"];
const MS: u64 = 1_000_000;

/// Says so where a package of Python is missing.
fn has(package: &str) -> bool {
    let installed =
        Command::new("python3").args(["-c", &format!("import numpy, {package}")]).output();
    let is_there = installed.is_ok_and(|output| output.status.success());
    if !is_there {
        eprintln!("SKIPPED: no {package} in python3; pip install {}", package.replace('_', "-"));
    }
    is_there
}

/// Runs recordings.py; nothing where its packages are missing.
#[track_caller]
fn python(folder: &Path, args: &[&str]) -> Option<String> {
    if !has("rosbags") {
        return None;
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recordings.py");
    let output =
        Command::new("python3").arg(script).args(args).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    Some(String::from_utf8(output.stdout).unwrap())
}

/// A bag by `rosbags`, as this job describes it.
#[track_caller]
fn bag(folder: &Path, job: &Value) -> Option<String> {
    let _ = fs::remove_dir_all(folder.join("bag"));
    fs::write(folder.join("job.json"), job.to_string()).unwrap();
    python(folder, &["write", "bag", "job.json"])?;
    Some("bag/bag.mcap".to_owned())
}

/// Lines without what files and recordings call their frames.
fn records(text: &str) -> Vec<Value> {
    let mut lines = json_lines(text);
    for line in &mut lines {
        let fields = line.as_object_mut().unwrap();
        fields.remove("frame");
        fields.remove("name");
        fields.get_mut("health").unwrap().as_object_mut().unwrap().remove("skew_us");
    }
    lines
}

/// The line of each frame that a command prints; the command has to succeed.
#[track_caller]
fn recorded(folder: &Path, line: &str) -> Vec<Value> {
    records(&succeed(folder, line))
}

/// The images of some folders below this one, as PGM files too.
fn with_pgm(folder: &Path, names: &[&str]) {
    for name in names {
        for side in ["left", "right"] {
            let image = load_gray(&folder.join(name).join(format!("{side}.png"))).unwrap();
            let head = format!("P5\n{} {}\n255\n", image.dims.width, image.dims.height);
            let path = folder.join(name).join(format!("{side}.pgm.raw"));
            fs::write(path, [head.as_bytes(), &image.pixels].concat()).unwrap();
        }
    }
}

/// Three drawn pairs in `rec/1` to `rec/3`.
fn drawn() -> Folder {
    let folder = with_drawn_pairs();
    with_pgm(folder.path(), &["rec/1", "rec/2", "rec/3"]);
    folder
}

fn pairs(names: &[&str], file: &str) -> Vec<Value> {
    let pair = |(name, i): (&&str, u64)| {
        let ns = 1_700_000_000_000_000_000 + 33 * MS * i;
        json!([format!("{name}/left.{file}"), format!("{name}/right.{file}"), ns, ns + 200_000])
    };
    names.iter().zip(0..).map(pair).collect()
}

const DRAWN: [&str; 3] = ["rec/1", "rec/2", "rec/3"];

fn rig() -> Value {
    json!({"focal_px": 288.0, "baseline_m": 0.12, "centre": [159.5, 119.5], "size": [320, 240]})
}

#[test]
fn a_bag_gives_what_its_files_give() {
    let at: &Path = &drawn();
    let known = "--max-disparity 48";
    let expected = recorded(at, &format!("sequence rec --focal-px 288 --baseline-m 0.12 {known}"));
    for (encoding, compression, scramble) in [
        ("mono8", "none", false),
        ("mono16", "zstd", false),
        ("mono16be", "none", false),
        ("rgb8", "zstd", true),
        ("bgr8", "none", false),
        ("yuv422", "none", false),
        ("yuv422_yuy2", "zstd", false),
        ("file", "none", false),
    ] {
        let (file, suffix) =
            if encoding == "file" { ("png", "/compressed") } else { ("pgm.raw", "") };
        let topics = TOPICS.map(|topic| format!("{topic}{suffix}"));
        let job = json!({"pairs": pairs(&DRAWN, file), "encoding": encoding, "compression": compression,
                         "rig": rig(), "topics": topics, "scramble": scramble});
        let Some(bag) = bag(at, &job) else { return };
        let found = recorded(at, &format!("sequence {bag} {known}"));
        assert_eq!(found.len(), 3);
        assert!(found == expected, "{encoding} {compression}");
    }
}

#[test]
fn a_recording_of_foxglove_gives_what_its_files_give() {
    if !has("foxglove_schemas_protobuf") || !has("mcap_protobuf") {
        return;
    }
    let at: &Path = &drawn();
    let known = "--max-disparity 48";
    let expected = recorded(at, &format!("sequence rec --focal-px 288 --baseline-m 0.12 {known}"));
    for encoding in ["mono8", "mono16", "bgr8", "file"] {
        let file = if encoding == "file" { "png" } else { "pgm.raw" };
        let job = json!({"pairs": pairs(&DRAWN, file), "encoding": encoding, "rig": rig(), "topics": TOPICS});
        fs::write(at.join("job.json"), job.to_string()).unwrap();
        if python(at, &["foxglove", "fox.mcap", "job.json"]).is_none() {
            return;
        }
        let found = recorded(at, &format!("sequence fox.mcap {known}"));
        assert!(found.len() == 3 && found == expected, "{encoding}");
    }
    // Raw, with a lens: rectified by the calibration as by that of ROS 2.
    let mut raw = rig();
    raw["lens"] = json!([-0.1, 0.02, 0.001, -0.001, 0.0]);
    let topics = TOPICS.map(|topic| topic.replace("image_rect", "image_raw"));
    let job = json!({"pairs": pairs(&DRAWN, "pgm.raw"), "encoding": "mono8", "rig": raw, "topics": topics, "compression": "none"});
    let Some(bag) = bag(at, &job) else { return };
    python(at, &["foxglove", "fox.mcap", "job.json"]).unwrap();
    let expected = recorded(at, &format!("sequence {bag} {known}"));
    assert!(recorded(at, &format!("sequence fox.mcap {known}")) == expected, "raw");
}

#[test]
fn captured_pairs_come_out_of_a_bag_as_they_went_in() {
    let Some(frames) = linestereo_tests::captured::folder("qvga") else { return };
    let at: &Path = &Folder::new();
    let names = ["dolls", "motorcycle", "tsukuba"];
    for name in names {
        fs::create_dir(at.join(name)).unwrap();
        for side in ["left.png", "right.png"] {
            fs::copy(frames.join(name).join(side), at.join(name).join(side)).unwrap();
        }
    }
    with_pgm(at, &names);
    for name in names {
        let job = json!({"pairs": pairs(&[name], "pgm.raw"), "encoding": "mono8", "compression": "zstd",
                         "topics": ["/camera/infra1/image_rect_raw", "/camera/infra2/image_rect_raw"]});
        let Some(bag) = bag(at, &job) else { return };
        let expected = recorded(at, &format!("sequence {name}"));
        assert!(recorded(at, &format!("sequence {bag}")) == expected, "{name}");
    }
}

#[test]
fn images_are_paired_by_their_times_and_the_rest_is_counted() {
    let folder = drawn();
    let image = |side: &str| format!("rec/1/{side}.pgm.raw");
    let (left, right) = (image("left"), image("right"));
    // 0.5 ms apart; 12 ms apart; one without a partner on each side.
    let pairs = json!([
        [left, right, 1000 * MS, 1000 * MS + 500_000],
        [left, right, 1100 * MS, 1112 * MS],
        [left, null, 1200 * MS, 1200 * MS],
        [null, right, 1300 * MS, 1300 * MS]
    ]);
    let job = json!({"pairs": pairs, "encoding": "mono8", "compression": "none", "topics": TOPICS});
    let Some(bag) = bag(folder.path(), &job) else { return };
    let told = |args: &str, words: &[&str]| {
        let output = linestereo(folder.path(), &format!("sequence {bag} --no-points {args}"));
        says(&stderr(&output), words);
        json_lines(&String::from_utf8(output.stdout).unwrap())
    };
    let words = [
        "1 frames, 0 failed, 4 images without a partner; layout: MCAP recording",
        "paired within 10 ms; no rig in the recording: it has no CameraInfo",
    ];
    let lines = told("", &words);
    assert_eq!(
        (lines[0]["name"].as_str(), lines[0]["health"]["skew_us"].as_u64()),
        (Some("1.000000000"), Some(500))
    );
    let words = ["2 frames, 0 failed, 2 images without a partner"];
    let lines = told("--pair-window-ms 12", &words);
    assert_eq!(lines[1]["health"]["skew_us"].as_u64(), Some(12_000));
    assert!(
        lines[1]["health"]["flags"].as_array().unwrap().contains(&json!("skew")),
        "{}",
        lines[1]["health"]
    );
    let words = ["none of 3 left and 3 right images are within 0.4 ms; give --pair-window-ms"];
    told("--pair-window-ms 0.4", &words);
}

#[test]
fn raw_images_are_rectified_by_their_own_calibration() {
    let at: &Path = &drawn();
    let mut rig = rig();
    rig["lens"] = json!([-0.05, 0.01, 0.001, 0, 0]);
    let job = json!({"pairs": pairs(&DRAWN, "pgm.raw"), "encoding": "mono8", "compression": "none", "rig": rig,
                     "topics": ["/left/image_raw", "/right/image_raw"]});
    let Some(bag) = bag(at, &job) else { return };
    for (name, along) in [("left.yaml", 0.0), ("right.yaml", -288.0 * 0.12)] {
        let text = format!(
            "width: 320\nheight: 240\ndistortion_model: plumb_bob\nd: [-0.05, 0.01, 0.001, 0, 0]\n\
             k: [288, 0, 159.5, 0, 288, 119.5, 0, 0, 1]\nr: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n\
             p: [288, 0, 159.5, {along}, 0, 288, 119.5, 0, 0, 0, 1, 0]\n"
        );
        fs::write(at.join(name), text).unwrap();
    }
    let expected = recorded(at, "sequence rec --rig left.yaml --rig right.yaml");
    let output = linestereo(at, &format!("sequence {bag}"));
    says(&stderr(&output), &["raw, rectified by their CameraInfo"]);
    assert!(records(&stdout(&output)) == expected);
}

/// The drawn pairs as two files of a folder, as `ros2 bag record` splits them.
fn bag_folder(at: &Path) {
    let known = "--max-disparity 48 --focal-px 288 --baseline-m 0.12 --with images";
    fs::create_dir(at.join("bag")).unwrap();
    succeed(at, &format!("sequence rec --frames 1..3 --out all.mcap {known}"));
    for (frames, out) in [("0..1", "bag/bag_0.mcap"), ("2..2", "bag/bag_1.mcap")] {
        succeed(at, &format!("sequence all.mcap --frames {frames} --out {out} --with images"));
    }
    let metadata = "rosbag2_bagfile_information:\n  version: 9\n  relative_file_paths:\n    - bag_0.mcap\n    - bag_1.mcap\n";
    fs::write(at.join("bag/metadata.yaml"), metadata).unwrap();
}

#[test]
fn a_folder_of_ros_is_one_recording() {
    let at: &Path = &drawn();
    bag_folder(at);
    let expected = recorded(at, "sequence all.mcap --max-disparity 48");
    assert_eq!(expected.len(), 3);
    for path in ["bag", "bag/", "./bag"] {
        assert!(recorded(at, &format!("sequence {path} --max-disparity 48")) == expected, "{path}");
    }
    // Other commands take it, and nothing is written over its files.
    succeed(at, "report bag -o report.html");
    let words = ["is one of the files that are read"];
    refused(at, "sequence bag --out bag/bag_1.mcap", &words);
    // Without what ROS says of it it is read where that is clear.
    fs::remove_file(at.join("bag/metadata.yaml")).unwrap();
    let words = ["it holds bag_0.mcap, bag_1.mcap without a metadata.yaml; give one of them"];
    refused(at, "sequence bag", &words);
    fs::remove_file(at.join("bag/bag_1.mcap")).unwrap();
    assert!(recorded(at, "sequence bag --max-disparity 48") == expected[..2]);
}

#[test]
fn other_bags_say_how_they_are_converted() {
    let at: &Path = &Folder::new();
    fs::write(at.join("x.db3"), [&b"SQLite format 3\0"[..], &[0; 100]].concat()).unwrap();
    fs::write(at.join("x.bag"), "#ROSBAG V2.0\n").unwrap();
    fs::write(at.join("x.mcap.zstd"), [0x28, 0xb5, 0x2f, 0xfd]).unwrap();
    fs::write(at.join("x.svo"), "SVO").unwrap();
    fs::create_dir(at.join("bag")).unwrap();
    fs::copy(at.join("x.db3"), at.join("bag/bag_0.db3")).unwrap();
    fs::write(at.join("bag/metadata.yaml"), "rosbag2_bagfile_information:\n").unwrap();
    for (path, word) in [
        ("x.db3", "x.db3: it is no MCAP file; convert a ROS 1 or SQLite bag with `mcap convert`"),
        ("x.bag", "x.bag: it is no MCAP file; convert"),
        ("x.mcap.zstd", "unpack it with `zstd -d`"),
        ("bag", "it holds bag_0.db3 and no .mcap; convert it with `mcap convert`"),
        ("x.svo", "x.svo is n"),
    ] {
        refused(at, &format!("sequence {path}"), &[word]);
        refused(at, &format!("quality {path}"), &[word]);
    }
}

/// Messages of a detector that found the same two things in each frame, a box that is no object,
/// and nothing in the last.
fn detections(at: &Path, out: &str, topic: &str, stamps: &[u64]) {
    let mut writer = Writer::new(fs::File::create(at.join(out)).unwrap(), "test").unwrap();
    let channel = writer.channel(topic, "vision_msgs/msg/Detection2DArray", "").unwrap();
    let found = |class: &str, center: [f64; 3], id: &str| Detection2D {
        results: vec![ObjectHypothesisWithPose {
            class_id: class.to_owned(),
            score: 0.75,
            ..Default::default()
        }],
        center,
        size_x: 100.0,
        size_y: 80.0,
        id: id.to_owned(),
        ..Default::default()
    };
    for (number, &ns) in stamps.iter().enumerate() {
        let header = Header::from(Stamp { ns, frame_id: "left" });
        let all = vec![
            found("box", [100.0, 80.0, 0.0], "4"),
            found("out", [900.0, 80.0, 0.0], ""),
            found("cup", [200.0, 160.0, 0.0], "9"),
        ];
        let detections = if number + 1 < stamps.len() { all } else { Vec::new() };
        writer
            .message(channel, ns, &cdr::write(&Detection2DArray { header, detections }).unwrap())
            .unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn objects_of_a_recording_are_those_of_their_time() {
    let folder = drawn();
    let at = folder.path();
    let known = "--max-disparity 48 --focal-px 288 --baseline-m 0.12";
    succeed(at, &format!("sequence rec --out all.mcap --with images {known}"));
    let boxes = "x0,y0,x1,y1,name\n50,40,150,120,box\n850,40,950,120,out\n150,120,250,200,cup\n";
    fs::write(at.join("boxes.csv"), boxes).unwrap();
    let of_files = recorded(at, &format!("sequence rec --objects boxes.csv {known}"));
    // Pairs of a folder are 0.1 s apart; the second message is 2 ms late, and so is no other.
    detections(at, "found.mcap", "/yolo/detections", &[100 * MS, 202 * MS, 300 * MS]);
    let output = linestereo(at, "sequence all.mcap --max-disparity 48 --objects found.mcap");
    let words = ["2 objects skipped, 0 frames whose objects cannot be read\n"];
    says(&stderr(&output), &words);
    let found = records(&stdout(&output));
    for i in 0..2 {
        assert_eq!(found[i]["objects"], of_files[i]["objects"], "{i}");
        assert!(
            found[i]["objects"][0]["depth_m"].is_number()
                && found[i]["objects"][1]["name"] == "cup",
            "{}",
            found[i]["objects"]
        );
    }
    assert_eq!(found[2]["objects"], json!([]));
    // Messages out, with the places of the objects.
    let only_objects = "sequence all.mcap --max-disparity 48 --objects found.mcap --only-objects";
    let alone = recorded(at, only_objects);
    succeed(at, &format!("{only_objects} --out out.mcap"));
    let placed = placed(&at.join("out.mcap"));
    assert_eq!(placed.len(), 3);
    assert!(messages(&at.join("out.mcap"), "/linestereo/obstacles").is_empty(), "not one is whole");
    refused(
        at,
        &format!("{only_objects} --out no.mcap --sector-range 3"),
        &["in place of --only-"],
    );
    for (i, line) in alone.iter().enumerate() {
        let objects: Vec<&Value> = line["objects"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|object| object["depth_m"].is_number())
            .collect();
        assert_eq!(placed[i].len(), objects.len(), "{i}");
        for (object, (class, score, [x, y, z], [width, height, deep], id)) in
            objects.into_iter().zip(&placed[i])
        {
            let depth = object["depth_m"].as_f64().unwrap();
            let (name, track, centre) = if *class == "box" {
                ("box", "4", [99.5, 79.5])
            } else {
                ("cup", "9", [199.5, 159.5])
            };
            assert_eq!(
                (object["name"].as_str(), &**id, *score, *deep),
                (Some(name), track, 0.75, 0.0)
            );
            for (value, expected) in [
                (z, depth),
                (x, (centre[0] - 159.5) * depth / 288.0),
                (y, (centre[1] - 119.5) * depth / 288.0),
                (width, 100.0 * depth / 288.0),
                (height, 80.0 * depth / 288.0),
            ] {
                assert!(
                    (value - expected).abs() < 2e-3 * depth,
                    "{name} of {i}: {value} is not {expected}"
                );
            }
        }
    }
    let cases: [(&str, &str); 3] = [
        (
            "sequence all.mcap --objects boxes.csv",
            "give their topic, as in --objects /detections, or a recording of them",
        ),
        (
            "sequence all.mcap --objects /yolo",
            "it has no topic of vision_msgs/msg/Detection2DArray",
        ),
        (
            "sequence all.mcap --objects all.mcap",
            "it has no topic of vision_msgs/msg/Detection2DArray",
        ),
    ];
    all_refused(at, &cases);
    // No message within the window of a pair: counted, and not those of another time.
    detections(at, "late.mcap", "/a", &[111 * MS, 400 * MS]);
    let output = linestereo(at, "sequence all.mcap --objects late.mcap --max-disparity 48");
    says(&stderr(&output), &["3 frames without a file or a message of objects"]);
}

type Placed = (String, f64, [f64; 3], [f64; 3], String);

/// Class, score, place, size and track of what each message of `/linestereo/detections` holds.
fn placed(path: &Path) -> Vec<Vec<Placed>> {
    type Result = (String, f64, [f64; 7], [[f64; 18]; 2]);
    type Detection = (Header, Vec<Result>, [f64; 7], [f64; 3], String);
    let one = |(_, results, pose, size, id): Detection| {
        let (class, score, of_result, _) = results.into_iter().next().unwrap();
        assert_eq!(of_result, pose);
        (class, score, [pose[0], pose[1], pose[2]], size, id)
    };
    let of_message = |message: &Vec<u8>| -> Vec<Placed> {
        let (_, list): (Header, Vec<Detection>) = cdr::read(message).unwrap();
        list.into_iter().map(one).collect()
    };
    messages(path, "/linestereo/detections").iter().map(of_message).collect()
}

/// The messages of a topic, in the order of the file.
fn messages(path: &Path, topic: &str) -> Vec<Vec<u8>> {
    let mut reader = Reader::open(path).unwrap();
    let (mut channel_id, mut found) = (None, Vec::new());
    reader
        .scan(|record, _| -> Result<(), McapFault> {
            match record {
                Record::Channel(channel) if channel.topic == topic => channel_id = Some(channel.id),
                Record::Message { header, data } if Some(header.channel_id) == channel_id => {
                    found.push(data.into_owned());
                }
                _ => {}
            }
            Ok(())
        })
        .unwrap();
    found
}

/// Width of the cloud, and bytes of its points.
fn cloud_size(message: &[u8]) -> (u32, usize) {
    type Field = (String, u32, u8, u32);
    type Cloud = (Header, u32, u32, Vec<Field>, bool, u32, u32, Vec<u8>, bool);
    let (_, _, width, _, _, _, _, data, _): Cloud = cdr::read(message).unwrap();
    (width, data.len())
}

#[test]
fn the_cloud_of_exchanged_images_has_no_points() {
    let at: &Path = &with_drawn_pairs();
    fs::create_dir(at.join("exchanged")).unwrap();
    for (from, to) in [("left.png", "right.png"), ("right.png", "left.png")] {
        fs::copy(at.join("rec/1").join(from), at.join("exchanged").join(to)).unwrap();
    }
    let clouds = |name: &str| {
        let line = format!("sequence {name} --out out.mcap --focal-px 288 --baseline-m 0.12");
        let output = linestereo(at, &line);
        let clouds = messages(&at.join("out.mcap"), "/linestereo/points");
        let sizes: Vec<_> = clouds.iter().map(|cloud| cloud_size(cloud)).collect();
        (output.status.code(), sizes)
    };
    let (code, sizes) = clouds("rec/1");
    assert_eq!((code, sizes.len()), (Some(0), 1));
    let (width, bytes) = sizes[0];
    assert!(width > 5000 && bytes == 16 * width as usize, "{width} points in {bytes} bytes");
    assert_eq!(clouds("exchanged"), (Some(2), vec![(0, 0)]));
}

#[test]
fn a_topic_of_the_recording_itself_gives_its_objects() {
    let at: &Path = &drawn();
    let mut job = json!({"pairs": pairs(&DRAWN, "pgm.raw"), "encoding": "mono8", "compression": "none", "rig": rig(), "topics": TOPICS});
    job["detections"] = json!({"topic": "/boxes", "boxes": [[100, 80, 100, 80, "box"], [200, 160, 100, 80, "cup"]]});
    let Some(bag) = bag(at, &job) else { return };
    fs::write(at.join("boxes.csv"), "x0,y0,x1,y1,name\n50,40,150,120,box\n150,120,250,200,cup\n")
        .unwrap();
    let rig = "--focal-px 288 --baseline-m 0.12";
    let of_files = format!("sequence rec --max-disparity 48 {rig} --objects boxes.csv");
    let expected = recorded(at, &of_files);
    for path in [bag.as_str(), "bag"] {
        let line = format!("sequence {path} --objects /boxes --max-disparity 48");
        assert!(recorded(at, &line) == expected, "{path}");
    }
    refused(at, "sequence bag --objects /cats", &["is in /cats, but in /boxes"]);
}

#[test]
fn what_is_written_is_read_again() {
    let at: &Path = &drawn();
    let known = "--max-disparity 48 --focal-px 288 --baseline-m 0.12 --disparity-offset-px 1.5";
    let expected = recorded(at, &format!("sequence rec {known}"));
    succeed(at, &format!("sequence rec --out a.mcap --with images {known}"));
    assert!(recorded(at, "sequence a.mcap --max-disparity 48") == expected);
    // Some frames alone, into a recording again, of a name in other letters.
    succeed(at, "sequence a.mcap --frames 0..1 --max-disparity 48 --out b.MCAP --with images");
    assert!(recorded(at, "sequence b.MCAP --max-disparity 48") == expected[..2]);
    // Other commands find its pairs too.
    succeed(at, "report a.mcap -o report.html");
}

#[test]
fn messages_hold_the_numbers_of_the_lines() {
    let at: &Path = &drawn();
    let args = "sequence rec/1 --max-disparity 48 --objects rec/1/objects.png";
    let line = json(at, args);
    succeed(at, &format!("{args} --out out.mcap --with images,disparity"));
    let known = "--max-disparity 48 --sectors --json -";
    let sectors =
        json(at, &format!("run rec/1/left.png rec/1/right.png {known}"))["sectors"].take();
    let Some(text) = python(at, &["read", "out.mcap"]) else { return };
    let all = json_lines(&text);
    let on = |topic: &str| {
        all.iter().find(|line| line["topic"] == format!("/linestereo/{topic}")).unwrap()
    };
    let near = |a: &Value, b: f64, limit: f64| {
        assert!((a.as_f64().unwrap() - b).abs() <= limit, "{a} is not {b}")
    };
    let (f, baseline, [cx, cy]) = (288.0, 0.12, [159.5, 119.5]);

    let points = line["points"].as_array().unwrap();
    let cloud = on("points");
    assert_eq!(
        (cloud["message"]["width"].as_u64(), points.len() > 5000),
        (Some(points.len() as u64), true)
    );
    assert_eq!(cloud["message"]["header"]["frame_id"], "left_camera_optical_frame");
    for (point, found) in points.iter().zip(cloud["points"].as_array().unwrap()) {
        let [x, y, d] = [0, 1, 2].map(|i| point[i].as_f64().unwrap());
        let z = f * baseline / d;
        near(&found[0], (x - cx) * z / f, 1e-4);
        near(&found[1], (y - cy) * z / f, 1e-4);
        near(&found[2], z, 1e-4);
        near(&found[3], point[3].as_f64().unwrap(), 1e-5);
    }

    let segments = line["segments"].as_array().unwrap();
    let marker = &on("segments")["message"];
    let ends = marker["points"].as_array().unwrap();
    assert_eq!(
        (ends.len(), segments.len() > 50, marker["type"].as_u64()),
        (2 * segments.len(), true, Some(5))
    );
    for (segment, (ends, colours)) in
        segments.iter().zip(ends.chunks(2).zip(marker["colors"].as_array().unwrap().chunks(2)))
    {
        for i in 0..2 {
            let z = segment["depth_m"][i].as_f64().unwrap();
            near(&ends[i]["z"], z, 1e-4);
            near(&ends[i]["x"], (segment["left"][i][0].as_f64().unwrap() - cx) * z / f, 1e-4);
            near(&colours[i]["a"], segment["confidence"].as_f64().unwrap(), 1e-5);
        }
    }

    let mut known = 0;
    for (topic, field) in [("obstacles", "distance_m"), ("drop_offs", "drop_off_m")] {
        let scan = &on(topic)["message"];
        assert_eq!(scan["header"]["frame_id"], "left_camera_scan");
        let ranges = scan["ranges"].as_array().unwrap();
        assert_eq!(ranges.len(), 72);
        for (place, range) in ranges.iter().enumerate() {
            // From behind on, counter-clockwise.
            let sector = &sectors[(72 + 36 - place) % 72];
            match (range.as_f64(), &sector[field]) {
                (Some(metres), expected) => near(expected, metres, 1e-5),
                (None, expected) => assert!(expected.is_null(), "{sector}"),
            }
            known += usize::from(range.is_f64());
        }
    }
    assert!(known > 5, "{known} directions have a distance");
    let frame = all.iter().find(|line| line["topic"] == "/tf").unwrap();
    let frame = &frame["message"]["transforms"][0];
    assert_eq!(frame["child_frame_id"], "left_camera_scan");
    assert_eq!(frame["transform"]["rotation"]["y"], -0.5);

    let objects =
        line["objects"].as_array().unwrap().iter().filter(|object| !object["depth_m"].is_null());
    let objects: Vec<&Value> = objects.collect();
    let markers = on("objects")["message"]["markers"].as_array().unwrap();
    assert_eq!(
        (markers.len(), objects.is_empty(), markers[0]["action"].as_u64()),
        (1 + 2 * objects.len(), false, Some(3))
    );
    for (object, markers) in objects.iter().zip(markers[1..].chunks(2)) {
        let z = object["depth_m"].as_f64().unwrap();
        near(&markers[0]["pose"]["position"]["z"], z, 1e-4);
        assert_eq!(markers[1]["text"], format!("object {z:.2} m"));
    }

    let status = &on("health")["message"]["status"][0];
    let value = |key: &str| {
        status["values"].as_array().unwrap().iter().find(|value| value["key"] == key).unwrap()
    };
    let flags: Vec<&str> = line["health"]["flags"]
        .as_array()
        .unwrap()
        .iter()
        .map(|flag| flag.as_str().unwrap())
        .collect();
    let message = if flags.is_empty() { "good".to_owned() } else { flags.join(", ") };
    assert_eq!(
        (status["message"].as_str(), status["level"].as_u64()),
        (Some(&*message), Some((!flags.is_empty()).into()))
    );
    assert_eq!(value("points")["value"], points.len().to_string());

    let disparity = on("disparity");
    assert_eq!(disparity["message"]["image"]["encoding"], "32FC1");
    let mut expected = vec![-1.0; 320 * 240];
    for point in points {
        expected[(320 * point[1].as_u64().unwrap() + point[0].as_u64().unwrap()) as usize] =
            point[2].as_f64().unwrap();
    }
    assert_eq!(disparity["disparities"], json!(expected));
    near(&disparity["message"]["f"], f, 0.0);
    near(&disparity["message"]["t"], baseline, 1e-8);

    let image = load_gray(&at.join("rec/1/left.png")).unwrap();
    assert_eq!(on("left/image_rect")["message"]["data"], json!(image.pixels));
    assert_eq!(
        on("left/camera_info")["message"]["p"],
        json!([f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0])
    );
    let right = on("right/camera_info");
    near(&right["message"]["p"][3], -f * baseline, 1e-9);
    near(&right["message"]["k"][2], cx, 0.0);
    assert!(all.iter().any(|line| line["topic"] == "Foxglove reads it too") || python_lacks_mcap());
}

fn python_lacks_mcap() -> bool {
    let installed = Command::new("python3").args(["-c", "import mcap, mcap_ros2"]).output();
    !installed.is_ok_and(|output| output.status.success())
}

#[test]
fn options_of_recordings_are_refused_where_there_is_none() {
    let folder = drawn();
    succeed(folder.path(), "sequence rec --out a.mcap --with images");
    let cases: [(&str, &str); 7] = [
        ("sequence rec --pair-window-ms 3", "for an .mcap file"),
        ("sequence rec --out a.jsonl --with images", "give --out FILE.mcap"),
        ("sequence a.mcap --side-by-side", "a topic for each camera"),
        (
            "sequence a.mcap --objects rec/1/objects.png",
            "are messages of vision_msgs/msg/Detection2DArray",
        ),
        ("sequence a.mcap --out a.mcap", "are the same; write to another file"),
        (
            "sequence a.mcap --left-topic /a --right-topic /b",
            "no images are in /a, but in /linestereo/left",
        ),
        ("sequence none.mcap", "check the path"),
    ];
    all_refused(folder.path(), &cases);
}
