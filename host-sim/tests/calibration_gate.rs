//! Calibrations that do not fit their images are refused by name: files of other programs, and
//! `CameraInfo` of recordings.

use crate::formats::{Outcome, debug, known};
use crate::interchange::{
    EUROC, KALIBR, ROS, USUAL, assert_is_the_example, bad, good, opencv, opencv_cameras,
    opencv_pose, read, written,
};
use crate::support::{Folder, says};
use linestereo::Dims;
use linestereo_calibration::interchange::{Format, Options, Problem, export};
use linestereo_recordings::mcap::Writer;
use linestereo_recordings::ros::cdr;
use linestereo_recordings::ros::messages::{CameraInfo, RegionOfInterest};
use linestereo_recordings::ros::sent::{self, Projection, Stamp};
use linestereo_recordings::{Choice, Footage};
use linestereo_rig::CameraSide;
use std::fs;

/// A recording with these messages of the left and the right camera, and images of this size.
pub(crate) fn recorded(infos: &[[CameraInfo; 2]], topics: [&str; 2], size: [u16; 2]) -> Outcome {
    let folder = Folder::new();
    let mut file = Writer::new(Vec::new(), "test").unwrap();
    let pixels: Vec<u8> =
        (0..u32::from(size[0]) * u32::from(size[1])).map(|at| (at % 251) as u8).collect();
    for (eye, topic) in topics.into_iter().enumerate() {
        let images = file.channel(topic, "sensor_msgs/msg/Image", "").unwrap();
        let space = topic.rsplit_once('/').unwrap().0;
        let channel = file
            .channel(&format!("{space}/camera_info"), "sensor_msgs/msg/CameraInfo", "")
            .unwrap();
        for (ns, info) in (1..).zip(infos) {
            let stamp = Stamp { ns: ns * 1_000_000_000, frame_id: "left" };
            let image = cdr::write(&sent::image(stamp, size, &pixels)).unwrap();
            file.message(images, stamp.ns, &image).unwrap();
            file.message(channel, stamp.ns, &cdr::write(&info[eye]).unwrap()).unwrap();
        }
    }
    let path = folder.path().join("in.mcap");
    fs::write(&path, file.finish().unwrap()).unwrap();
    let found = Footage::recorded(&path, &Choice::default()).map_err(|error| error.to_string())?;
    let pair = &found.pairs[0];
    match pair.raw_rig() {
        Some(rig) => Ok((debug(&rig), String::new())),
        None => known(pair, size),
    }
    .map(|(used, said)| (used.replace(&folder.path().display().to_string(), ""), said))
}

pub(crate) const RECTIFIED: [&str; 2] = ["/stereo/left/image_rect", "/stereo/right/image_rect"];

/// Of cameras 60 mm apart.
pub(crate) fn infos(size: [u16; 2], focal_px: f64) -> [CameraInfo; 2] {
    let centre = size.map(|side| (f64::from(side) - 1.0) / 2.0);
    let rig = Projection { focal_px, baseline_m: 0.06, centres: [centre; 2] };
    [false, true]
        .map(|is_right| sent::camera_info(Stamp { ns: 1, frame_id: "left" }, size, &rig, is_right))
}

const RAW: [&str; 2] = ["/stereo/left/image_raw", "/stereo/right/image_raw"];

/// A recording with these `CameraInfo` is refused with these words.
#[track_caller]
fn refused_for(infos: [CameraInfo; 2], topics: [&str; 2], size: [u16; 2], words: &[&str]) {
    says(&recorded(&[infos], topics, size).expect_err("this is no rig"), words);
}

#[track_caller]
fn taken(infos: [CameraInfo; 2], topics: [&str; 2], size: [u16; 2], words: &[&str]) {
    let (used, _) = recorded(&[infos], topics, size).unwrap_or_else(|error| panic!("{error}"));
    says(&used, words);
}

#[test]
fn camera_info_is_of_the_images_that_are_sent() {
    let (full, half) = ([128, 96], [64, 48]);
    let both = |change: fn(&mut CameraInfo)| {
        infos(full, 100.0).map(|mut info| {
            change(&mut info);
            info
        })
    };
    let binned = both(|info| (info.binning_x, info.binning_y) = (2, 2));
    let narrow = both(|info| info.binning_x = 2);
    // Half of the size: by binning, by nothing, and by binning the wrong way.
    let words = ["focal_px: 50.0", "baseline_m: 0.06", "[31.5, 23.5]"];
    taken(binned.clone(), RECTIFIED, half, &words);
    refused_for(both(|_| ()), RECTIFIED, half, &["images of 128x96, but these are 64x48"]);
    refused_for(binned, RECTIFIED, full, &["binning 2x2", "images are 128x96"]);
    refused_for(narrow, RECTIFIED, [64, 96], &["rectified images need square pixels"]);
    // A region of both, or one that differs, moves the principal points.
    let mut cut = infos(full, 100.0);
    for (info, x_offset) in cut.iter_mut().zip([20, 4]) {
        info.roi =
            RegionOfInterest { x_offset, y_offset: 10, height: 48, width: 64, do_rectify: true };
    }
    let words = ["focal_px: 100.0", "disparity_offset_px: Some(16.0)", "[43.5, 37.5]"];
    taken(cut.clone(), RECTIFIED, half, &words);
    cut[1].roi.y_offset = 20;
    refused_for(cut.clone(), RECTIFIED, half, &["lie in the rows", "y_offset"]);
    cut[1].roi.x_offset = 100;
    refused_for(cut, RECTIFIED, half, &["roi"]);
    // Raw images alike.
    let mut raw = both(|info| info.d[0] = -0.1);
    refused_for(raw.clone(), RAW, half, &["images of 128x96, but these are 64x48"]);
    raw.iter_mut().for_each(|info| (info.binning_x, info.binning_y) = (2, 2));
    taken(raw, RAW, half, &["binning_x: 2"]);
}

#[test]
fn sides_axes_and_lengths_of_camera_info_are_checked() {
    let size = [64, 48];
    let right = |change: fn(&mut CameraInfo)| {
        let [left, mut right] = infos(size, 50.0);
        change(&mut right);
        [left, right]
    };
    let positive = right(|info| info.p[3] = 3.0);
    let mut exchanged = positive.clone();
    exchanged.swap(0, 1);
    let of_larger = |width: u32, height: u32| {
        infos([128, 96], 100.0).map(|info| CameraInfo { width, height, ..info })
    };
    let cases: [([CameraInfo; 2], &[&str]); 8] = [
        (positive, &["P[3] is 0 for the left and 3 for the right", "sign is wrong", "exchanged"]),
        (exchanged, &["P[3] is 3 for the left and 0 for the right", "sign is wrong"]),
        (right(|info| (info.p[3], info.p[7]) = (0.0, -3.0)), &["above each other", "P[7]"]),
        (right(|info| info.p[7] = -3.0), &["placed diagonally"]),
        (right(|info| info.p[3] = -3000.0), &["60 m: did you mean mm? then give 0.06"]),
        (infos(size, 4.0), &["focal length of 4 px"]),
        (of_larger(64, 48), &["of about 128x96"]),
        (of_larger(0, 0), &["of about 128x96"]),
    ];
    for (infos, words) in cases {
        refused_for(infos, RECTIFIED, size, words);
    }
}

#[test]
fn the_first_message_that_says_anything_counts() {
    let good = infos([64, 48], 50.0);
    let blank = good.clone().map(|info| CameraInfo { k: [0.0; 9], p: [0.0; 12], ..info });
    let late = recorded(&[blank.clone(), good.clone(), blank.clone()], RECTIFIED, [64, 48]);
    assert_eq!(late, recorded(&[good], RECTIFIED, [64, 48]));
    assert_eq!(recorded(&[blank], RECTIFIED, [64, 48]), Err("nothing is known".to_owned()));
}

#[test]
fn a_word_within_another_rectifies_nothing() {
    let mut both = infos([64, 48], 50.0);
    both[1].k[2] = 27.5; // of the raw image; P says 31.5
    for (space, image) in [
        ("direct_drive", "image_raw"),
        ("robot", "image_raw"),
        ("correct", "image_raw"),
        ("stereo", "image_not_rectified"),
    ] {
        let topics = ["left", "right"].map(|side| format!("/{space}/{side}/{image}"));
        taken(both.clone(), topics.each_ref().map(String::as_str), [64, 48], &["27.5"]); // raw
    }
}

#[test]
fn images_at_hand_say_the_size_that_nothing_else_does() {
    let without = format!("{}{}", opencv_cameras(USUAL), opencv_pose(false));
    let of = |width, height| Options { images: Some(Dims { width, height }), ..Options::default() };
    assert_is_the_example(&read(&[&without], &of(640, 480)).unwrap());
    // The principal point is the middle of other images.
    for (width, height) in [(320, 240), (1280, 960), (480, 360), (960, 720)] {
        let error = read(&[&without], &of(width, height)).unwrap_err().to_string();
        assert!(error.contains("images of about 641x481") && !error.contains("--size"), "{error}");
    }
    // Where the file says it, the images are compared elsewhere.
    assert_is_the_example(&read(&[&opencv()], &of(320, 240)).unwrap());
    let error = read(&[&without], &Options::default()).unwrap_err().to_string();
    says(&error, &["convert-rig FILES --size WxH", "your photos, about 641x481"]);
}

#[test]
fn numbers_that_are_none_of_a_stereo_head_are_refused() {
    let long = KALIBR.replace("-0.08]", "-80.0]").replace("0.06]", "60.0]");
    let sensors = [EUROC[0], &EUROC[1].replace("2.1,", "62.0,")];
    let infos = [ROS[0], &ROS[1].replace("-40.0", "-40000.0")];
    for texts in [&[long.as_str()][..], &sensors, &infos] {
        assert!(matches!(bad(texts), (Some(_), Problem::Pair(_))), "{texts:?}");
    }
    // A focal length in mm; of larger images; of another unit down than across.
    for (intrinsics, problem) in [
        ("[4.0, 4.0, 320.0, 240.0]", "Unfit(Left"),
        ("[1000.0, 1002.0, 640.0, 480.0]", "Unfit(Left"),
        ("[500.0, 501.0, 0.0, 0.0]", "Unfit(Left"),
        ("[500.0, 50.0, 320.0, 240.0]", "PixelShape(Left"),
    ] {
        let text = KALIBR.replace("[500.0, 501.0, 320.0, 240.0]", intrinsics);
        let (_, error) = bad(&[&text]);
        assert!(format!("{error:?}").starts_with(problem), "{error:?} is not {problem}");
    }
}

#[test]
fn a_wrong_sign_of_the_projection_is_named() {
    let right = ROS[1].replace("-40.0", "40.0");
    let error = |texts: &[&str]| read(texts, &Options::default()).unwrap_err().to_string();
    says(&error(&[ROS[0], &right]), &["P[3]", "sign is wrong", "exchanged"]);
    says(&error(&[&right, ROS[0]]), &["P[3]", "sign is wrong"]);
}

#[test]
fn messages_are_of_the_images_that_are_sent() {
    let of = |binning: &str, roi: &str| {
        let with = |text: &str| {
            format!("{text}binning_x: {binning}\nbinning_y: {binning}\nroi: {{{roi}}}\n")
        };
        good(&[&with(ROS[0]), &with(ROS[1])]).rig.calibration
    };
    let all = "x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false";
    assert_eq!(
        *of("1", all).camera(CameraSide::Left),
        *good(&ROS).rig.calibration.camera(CameraSide::Left)
    );
    let binned = of("2", all);
    let left = binned.camera(CameraSide::Left);
    assert_eq!((left.dims(), left.focal()), (Dims { width: 320, height: 240 }, [250.0, 250.5]));
    assert_eq!(left.centre(), [159.75, 119.75]);
    let cut = of("0", "x_offset: 100, y_offset: 40, height: 400, width: 500, do_rectify: true");
    let left = cut.camera(CameraSide::Left);
    assert_eq!((left.dims(), left.centre()), (Dims { width: 500, height: 400 }, [220.0, 200.0]));
    assert_eq!((left.focal(), cut.translation()), ([500.0, 501.0], binned.translation()));
    let outside =
        format!("{}roi: {{x_offset: 200, y_offset: 0, height: 480, width: 500}}\n", ROS[0]);
    assert!(matches!(bad(&[&outside, ROS[1]]), (Some(_), Problem::Window(_))));
}

/// OAK: the numbers of a raw recording, and positions by OpenCV.
#[test]
fn a_rational_lens_undistorts_as_opencv_does() {
    let lens = "[1.2616, -57.753, 8.7e-4, 1.33e-3, 282.645, 1.107, -56.354, 277.476]";
    let camera = |text: &str, along: &str| {
        format!(
            "width: 1280\nheight: 720\ndistortion_model: rational_polynomial\nd: {text}\n\
             k: [1033.0, 0.0, 639.5, 0.0, 1033.0, 359.5, 0.0, 0.0, 1.0]\nr: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n\
             p: [1033.0, 0.0, 639.5, {along}, 0.0, 1033.0, 359.5, 0.0, 0.0, 0.0, 1.0, 0.0]\n"
        )
    };
    let both = |text: &str| [camera(text, "0.0"), camera(text, "-77.475")];
    let rig = good(&both(lens).each_ref().map(String::as_str)).rig;
    let left = *rig.calibration.camera(CameraSide::Left);
    for (raw, expected) in
        [([0.0, 0.0], [8.5538, 4.7474]), ([1279.0, 360.0], [1267.1539, 359.6652])]
    {
        let [x, y] = left.unproject(raw).unwrap();
        for (found, expected) in [1033.0 * x + 639.5, 1033.0 * y + 359.5].into_iter().zip(expected)
        {
            assert!((found - expected).abs() < 1e-4, "{raw:?}: {found}, not {expected}");
        }
    }
    for to in [Format::RigToml, Format::OpencvYaml, Format::OpencvXml, Format::Ros] {
        let again = written(&rig, to).rig.calibration;
        assert_eq!(*again.camera(CameraSide::Left), left, "{to}");
    }
    for to in [Format::Kalibr, Format::Euroc] {
        assert!(matches!(export(&rig, to), Err(Problem::NotRepresentable { .. })), "{to}");
    }
    // Twelve and fourteen coefficients too, where the further ones are zero.
    let longer = lens.replace(']', ", 0.0, 0.0, 0.0, 0.0]");
    assert_eq!(
        good(&both(&longer).each_ref().map(String::as_str)).rig.calibration,
        rig.calibration
    );
    let prism = lens.replace(']', ", 0.1, 0.0, 0.0, 0.0]");
    let refused = bad(&both(&prism).each_ref().map(String::as_str)).1;
    assert!(matches!(&refused, Problem::Coefficients { names } if names == "s1"), "{refused}");
    // One that folds the image over is none.
    let folds =
        bad(&both("[0.0, 0.0, 0.0, 0.0, 0.0, 8.0, 0.0, 0.0]").each_ref().map(String::as_str)).1;
    assert!(matches!(folds, Problem::Camera(CameraSide::Left, _)), "{folds}");
}
