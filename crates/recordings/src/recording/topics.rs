//! Which topics are the left and the right images, and which the calibration of each.
//!
//! ```text
//! /stereo/left/image_rect, /stereo/right/image_rect     names that differ by the side alone: left and right, infra1 and infra2, 0 and 1, ..
//! best first                                            rectified, not coloured, not compressed
//! /stereo/left/camera_info                              in the namespace of the images, else the only one of that side
//!                                                       whose words are of the image's name, else the only one of that
//!                                                       side, unless its other words are of other images
//! ```

use super::{RecordingFault, Topic};
use crate::ros::kind::Content;
use linestereo_frames::{SIDES, without_side};

/// Longest time between two images of a pair, ms, where none is given.
pub const DEFAULT_WINDOW_MS: f64 = 10.0;
/// Sides in names of topics, besides those of files.
const NUMBERED: [[&str; 2]; 3] = [["camera_0", "camera_1"], ["cam_0", "cam_1"], ["0", "1"]];
/// Words in names of topics with rectified images, words that say the contrary, and those of raw
/// images.
const RECTIFIED: [&str; 4] = ["rect", "rectified", "rectify", "recti"];
const NOT: [&str; 6] = ["not", "no", "non", "un", "before", "pre"];
const RAW: [&str; 6] =
    ["raw", "unrect", "unrectified", "notrectified", "nonrectified", "distorted"];
/// Topics that a message lists.
const LISTED: usize = 8;

/// Words in names of calibrations, besides those that their images have.
const CALIBRATION: [&str; 7] =
    ["camera", "cam", "info", "calib", "calibration", "intrinsics", "parameters"];

/// Topics and limits by which pairs are taken from a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Topics of the left and of the right images; found by their names where none is given.
    pub topics: [Option<String>; 2],
    /// Longest time between both images of a pair, ms.
    pub window_ms: f64,
}

impl Default for Choice {
    fn default() -> Self {
        Self { topics: [None, None], window_ms: DEFAULT_WINDOW_MS }
    }
}

impl Choice {
    pub(super) fn window_ns(&self) -> u64 {
        (self.window_ms * 1e6) as u64
    }

    /// The topics of both images.
    pub(super) fn topics<'a>(&self, all: &'a [Topic]) -> Result<[&'a Topic; 2], RecordingFault> {
        let listed = || {
            let names: Vec<&str> =
                all.iter().filter(|topic| topic.has_images()).map(|topic| &*topic.name).collect();
            let more = if names.len() > LISTED { ", ..." } else { "" };
            names[..names.len().min(LISTED)].join(", ") + more
        };
        let ask = "give --left-topic and --right-topic";
        if let [Some(left), Some(right)] = &self.topics {
            let named = |name: &String| {
                let found = all.iter().find(|topic| topic.has_images() && topic.name == *name);
                found.ok_or_else(|| {
                    RecordingFault::Topics(format!("no images are in {name}, but in {}", listed()))
                })
            };
            return Ok([named(left)?, named(right)?]);
        }
        let mut found = by_sides(all);
        found.sort_by_key(|pair| rank(pair[0]));
        match &found[..] {
            [] => Err(RecordingFault::Topics(format!(
                "no topics of a left and a right camera among {}; {ask}",
                listed()
            ))),
            [first, second, ..] if rank(first[0]) == rank(second[0]) => {
                let [a, b] = [&first[0].name, &second[0].name];
                Err(RecordingFault::Topics(format!(
                    "both {a} and {b} may be the left images; {ask}"
                )))
            }
            [first, ..] => Ok(*first),
        }
    }

    /// The topics with the calibrations of both.
    pub(super) fn infos<'a>(
        &self,
        all: &'a [Topic],
        chosen: [&Topic; 2],
    ) -> [Option<&'a Topic>; 2] {
        let named = |images: &Topic| {
            let base = images.name.strip_suffix("/compressed").unwrap_or(&images.name);
            let name =
                format!("{}/camera_info", base.rsplit_once('/').map_or("", |(space, _)| space));
            all.iter().find(|topic| !topic.has_images() && topic.name == name)
        };
        let by_side = |eye: usize| {
            let of_images = words(&chosen[eye].name);
            let foreign = |topic: &Topic| {
                let mut words = words(&topic.name);
                words.retain(|word| !of_images.contains(word) && !CALIBRATION.contains(&&**word));
                words
            };
            let is_of_side = |topic: &&Topic| {
                let mut sides = sides();
                !topic.has_images()
                    && sides.any(|side| without_side(&topic.name, side[eye]).is_some())
            };
            let of_side: Vec<_> = all.iter().filter(is_of_side).collect();
            let near: Vec<_> =
                of_side.iter().copied().filter(|topic| foreign(topic).is_empty()).collect();
            // Names of other heads have words of their own: those of /back/left and /front/left.
            let is_of_others = |info: &Topic| {
                let is_other = |topic: &&Topic| chosen.iter().all(|of| of.name != topic.name);
                let mut others = all.iter().filter(|topic| topic.has_images()).filter(is_other);
                let foreign = foreign(info);
                others.any(|other| words(&other.name).iter().any(|word| foreign.contains(word)))
            };
            match (&near[..], &of_side[..]) {
                ([near], _) => Some(*near),
                ([], [only]) => Some(*only).filter(|only| !is_of_others(only)),
                _ => None,
            }
        };
        [0, 1].map(|eye| named(chosen[eye]).or_else(|| by_side(eye)))
    }
}

fn sides() -> impl Iterator<Item = [&'static str; 2]> {
    SIDES.into_iter().chain(NUMBERED)
}

/// Pairs of topics with images whose names differ by the side alone.
fn by_sides(all: &[Topic]) -> Vec<[&Topic; 2]> {
    let is_used = |topic: &&Topic| !topic.images.is_empty() || topic.is_broken;
    let with_images = || all.iter().filter(|topic| topic.has_images()).filter(is_used);
    let mut found: Vec<[&Topic; 2]> = Vec::new();
    for [left_side, right_side] in sides() {
        for left in with_images() {
            let Some(rest) = without_side(&left.name, left_side) else { continue };
            let partner =
                |right: &&Topic| without_side(&right.name, right_side).as_ref() == Some(&rest);
            let is_new = found.iter().all(|pair| pair.iter().all(|known| known.name != left.name));
            if let Some(right) = with_images().find(partner).filter(|_| is_new) {
                found.push([left, right]);
            }
        }
    }
    found
}

/// Images of rectified names, these alone: the last part of the name that has a word for it
/// decides.
pub(super) fn is_rectified(topic: &str) -> bool {
    topic.rsplit('/').find_map(says_rectified) == Some(true)
}

/// `image_rect_raw` and `imageRect` are rectified, `image_not_rectified` and `image_raw` are not;
/// `None` of other parts.
fn says_rectified(part: &str) -> Option<bool> {
    let words = words(part);
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&&**word));
    match (has(&RECTIFIED), has(&NOT)) {
        (true, is_not) => Some(!is_not),
        (false, _) => has(&RAW).then_some(false),
    }
}

/// Words of a name in small letters: `left`, `image` and `rect` of `/left/imageRect`.
fn words(name: &str) -> Vec<String> {
    let mut words = String::new();
    let mut was_lower = false;
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && was_lower {
            words.push(' ');
        }
        was_lower = letter.is_ascii_lowercase();
        words.push(if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { ' ' });
    }
    words.split_whitespace().map(str::to_owned).collect()
}

/// The best are lowest.
fn rank(topic: &Topic) -> [bool; 3] {
    [
        !is_rectified(&topic.name),
        topic.name.contains("color"),
        topic.content == Content::CompressedImage,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mcap::Place;
    use crate::recording::Stored;
    use crate::ros::kind::Kind;

    fn topics(names: &[&str]) -> Vec<Topic> {
        let image = Stored {
            file: 0,
            place: Place::default(),
            stamp_ns: 0,
            kind: Kind { content: Content::Image, is_foxglove: false },
        };
        let topic = |name: &&str| {
            let content = match *name {
                name if name.ends_with("info") => Content::Calibration,
                name if name.ends_with("compressed") => Content::CompressedImage,
                _ => Content::Image,
            };
            Topic { images: vec![image], ..Topic::new((*name).to_owned(), content) }
        };
        names.iter().map(topic).collect()
    }

    fn chosen(names: &[&str]) -> Result<[String; 2], String> {
        let all = topics(names);
        let found = Choice::default().topics(&all).map_err(|fault| fault.to_string())?;
        Ok(found.map(|topic| topic.name.clone()))
    }

    #[test]
    fn the_best_topics_are_found_by_their_names() {
        for (left, right) in [
            ("/stereo/left/image_rect", "/stereo/right/image_rect"),
            ("/camera/infra1/image_rect_raw", "/camera/infra2/image_rect_raw"),
            ("/cam0/image_raw", "/cam1/image_raw"),
            ("/camera/0/image", "/camera/1/image"),
            (
                "/zed/zed_node/left/image_rect/compressed",
                "/zed/zed_node/right/image_rect/compressed",
            ),
        ] {
            assert_eq!(
                chosen(&[right, left, "/rgb/image"]),
                Ok([left.to_owned(), right.to_owned()])
            );
        }
        let sides = |rest: &str| [format!("/left/{rest}"), format!("/right/{rest}")];
        let rests = ["image_raw", "image_rect_color", "image_rect/compressed", "image_rect"];
        for best in 1..rests.len() {
            let names: Vec<String> = rests[..=best].iter().flat_map(|rest| sides(rest)).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            assert_eq!(chosen(&names), Ok(sides(rests[best])));
        }
    }

    #[test]
    fn a_calibration_is_of_the_head_of_its_images() {
        let of = |image: &str, infos: &[&str]| -> [Option<String>; 2] {
            let images = ["left", "right"].map(|side| image.replace("SIDE", side));
            let infos: Vec<[String; 2]> = infos
                .iter()
                .map(|info| ["left", "right"].map(|side| info.replace("SIDE", side)))
                .collect();
            let names = images.iter().chain(infos.as_flattened());
            let all = topics(&names.map(String::as_str).collect::<Vec<_>>());
            let found = Choice::default().infos(&all, [&all[0], &all[1]]);
            found.map(|topic| topic.map(|topic| topic.name.clone()))
        };
        let sides = |info: &str| ["left", "right"].map(|side| Some(info.replace("SIDE", side)));
        for (image, infos, found) in [
            ("/front/SIDE/image", &["/back/SIDE/camera_info", "/back/SIDE/image"][..], None),
            ("/front/SIDE/image", &["/back_SIDE_info", "/back/SIDE/image"], None),
            ("/front/SIDE/image", &["/a/SIDE/info", "/b/SIDE/info"], None),
            ("/SIDE/image_raw", &["/stereo/SIDE/camera_info"], Some(0)),
            ("/SIDE/image_raw", &["/stereo/SIDE/camera_info", "/SIDE/info"], Some(1)),
            ("/front/SIDE/image", &["/back/SIDE/camera_info", "/front_SIDE_info"], Some(1)),
            ("/front/SIDE/image", &["/SIDE/info", "/front/SIDE/camera_info"], Some(1)),
            ("/robot/image/SIDE", &["/robot/camera_info/SIDE/info"], Some(0)),
            ("/SIDE/gray/image_rect/compressed", &["/SIDE/camera_info"], Some(0)),
        ] {
            let found = found.map_or([None, None], |at: usize| sides(infos[at]));
            assert_eq!(of(image, infos), found, "{image} {infos:?}");
        }
        let all = topics(&["/infra1/image", "/infra2/image", "/left/camera_info"]);
        let [left, right] = Choice::default().infos(&all, [&all[0], &all[1]]);
        assert_eq!(
            (left.map(|info| &*info.name), right.is_none()),
            (Some("/left/camera_info"), true)
        );
    }

    #[test]
    fn whole_words_say_that_images_are_rectified() {
        for name in [
            "/stereo/left/image_rect",
            "/stereo/left/image_rect_color/compressed",
            "/camera/infra1/image_rect_raw",
            "/zed/zed_node/left/gray/rect/image",
            "/left/imageRect",
            "/left/image-rectified",
            "/raw_recorder/left/rectified",
        ] {
            assert!(is_rectified(name), "{name}");
        }
        for name in [
            "/direct_drive/left/image_raw", "/left/image_not_rectified", "/left/image_unrectified",
            "/left/image_non_rect", "/left/rectangle", "/corrected/left/image",
            "/rect_test/left/image_raw", "/rectangular/left/image_mono", "/left/image",
        ] {
            assert!(!is_rectified(name), "{name}");
        }
    }

    #[test]
    fn nothing_is_guessed() {
        let two =
            ["/front/left/image", "/front/right/image", "/back/left/image", "/back/right/image"];
        assert!(chosen(&two).unwrap_err().contains("both /front/left/image and /back/left/image"));
        assert!(
            chosen(&["/a/image", "/b/image"])
                .unwrap_err()
                .contains("among /a/image, /b/image; give --left-topic")
        );
    }
}
