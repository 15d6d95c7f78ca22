//! Our StereoBM against the installed OpenCV's: the rival that users know is not a straw man.
//!
//! Skipped, with a message, where no Python with OpenCV is found (`LINESTEREO_PYTHON`, else
//! `python3`).

use linestereo::Dims;
use linestereo_baselines::{Search, StereoBm};
use linestereo_frames::GrayImage;
use linestereo_lab::rivals::OpenCv;
use linestereo_sim::scene::Kind;
use linestereo_tests::captured;
use linestereo_tests::drawn::rendered;

/// Drawn ones of even and odd sizes, and captured ones where there are any.
fn pairs() -> Vec<(GrayImage, GrayImage)> {
    let sizes = [(320, 240), (161, 121), (200, 99)];
    let render = |(seed, (width, height)): (u64, (u16, u16))| {
        let pair = rendered(Kind::Boxes, Dims { width, height }, 2.0, seed);
        (pair.left, pair.right)
    };
    let captured = captured::qvga().into_iter().flatten().map(|scene| (scene.left, scene.right));
    (1..).zip(sizes).map(render).chain(captured).collect()
}

#[test]
fn stereo_bm_is_opencvs_number_for_number() {
    let opencv = match OpenCv::find(None) {
        Ok(opencv) => opencv,
        Err(why) => return eprintln!("SKIPPED: {why}"),
    };
    for (left, right) in pairs() {
        let search = Search::up_to(left.dims, 48);
        let found = opencv.run(&left, &right, search, 1).unwrap();
        for (name, ours) in
            [("opencv-bm", StereoBm::default()), ("opencv-bm-strict", StereoBm::strict())]
        {
            let theirs = &found.iter().find(|map| map.name == name).unwrap().map;
            let map = ours.run(&left, &right, search);
            let equal =
                |(ours, theirs): (&f32, &f32)| ours == theirs || ours.is_nan() && theirs.is_nan();
            let different =
                map.values().iter().zip(theirs.values()).filter(|&pair| !equal(pair)).count();
            assert_eq!(
                different,
                0,
                "{name} of {}, OpenCV {}: {} values",
                left.dims,
                opencv.version(),
                map.count()
            );
            assert!(
                map.count() > 500,
                "{name} of {}: {} values say little",
                left.dims,
                map.count()
            );
        }
    }
}
