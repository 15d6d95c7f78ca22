//! Frames of one folder: which files are pairs, by their names.
//!
//! ```text
//! 0001_left.png, 0001_right.png, ..           a number and the side, or the side and a number
//!                                             (left_0001.png, left1.png)
//! left/0001.png, right/0001.png, ..           a folder per camera
//! cam0/data/140...png, cam1/data/140...png    EuRoC, also below mav0; the number is the time in ns
//! 0001.png, 0002.png, ..                      both images side by side, where that is asked for
//! ```
//!
//! Sides are called left and right, L and R, infra1 and infra2 and so on, in any case: [`SIDES`].
//! Where names in two folders are times that differ, pairs are those of which each is the nearest
//! of all images of the other side, and nearer than half of the time to the images around it. Pairs
//! are ordered by their numbers, then by name. An image without a partner is counted.

use super::error::FrameError;
use super::folder::{IMAGE_EXTENSIONS, Listing};
use super::layout::Layout;
use super::source::PairSource;
use core::ops::{RangeBounds, RangeInclusive};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Names of the left and the right camera in names of files and folders.
pub const SIDES: [[&str; 2]; 6] = [
    ["left", "right"],
    ["l", "r"],
    ["infra1", "infra2"],
    ["cam0", "cam1"],
    ["camera0", "camera1"],
    ["ir1", "ir2"],
];
/// Folders whose names are taken as they are: KITTI's, of benchmarks and of recordings.
const CAMERA_FOLDERS: [[&str; 2]; 4] = [
    ["image_0", "image_1"],
    ["image_2", "image_3"],
    ["image_00", "image_01"],
    ["image_02", "image_03"],
];
/// Names of the two images of a single pair, besides those with a side in them: Middlebury's.
const SINGLE: [[&str; 2]; 3] = [["im0", "im1"], ["im2", "im6"], ["view1", "view5"]];
/// Numbers with so many digits are times in us and in ns: none of a frame counter is as long, and
/// dates to the millisecond have 17.
const US_DIGITS: RangeInclusive<usize> = 15..=16;
const NS_DIGITS: RangeInclusive<usize> = 18..=19;

/// How a pair is stored.
#[derive(Clone, Debug)]
pub enum PairFiles {
    /// A file each.
    Two([PathBuf; 2]),
    /// One file, left beside right.
    SideBySide(PathBuf),
    /// Messages of a recording, or frames of a video.
    Source(Arc<dyn PairSource>),
}

impl PairFiles {
    /// The files, left first: of both views in one file that one twice.
    pub fn paths(&self) -> [&Path; 2] {
        match self {
            Self::Two([left, right]) => [left, right],
            Self::SideBySide(both) => [both, both],
            Self::Source(pair) => pair.paths(),
        }
    }

    /// A frame of a video or a camera holds both views.
    pub fn is_one_video(&self) -> bool {
        let Self::Source(pair) = self else { return false };
        let [left, right] = pair.paths();
        pair.layout() == Layout::Video && left == right
    }

    /// When the images were captured, where both names or their messages say so.
    pub fn times_us(&self) -> Option<[u64; 2]> {
        if let Self::Source(pair) = self {
            return pair.times_us();
        }
        let [left, right] = self.paths().map(|path| time_ns(&stem(path)));
        Some([left? / 1000, right? / 1000])
    }

    /// When the left image was captured, ns, where its name, its message or its video says so.
    pub fn time_ns(&self) -> Option<u64> {
        match self {
            Self::Source(pair) => pair.time_ns(),
            _ => time_ns(&stem(self.paths()[0])),
        }
    }
}

/// A pair of a folder.
#[derive(Clone, Debug)]
pub(crate) struct SequencePair {
    /// Name of its files without the side; empty for the only pair of a folder.
    pub(crate) name: String,
    /// Paths of its images.
    pub(crate) files: PairFiles,
}

/// The pairs of a folder.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sequence {
    /// In the order of their numbers, then of their names.
    pub(crate) pairs: Vec<SequencePair>,
    /// Images without a partner.
    pub(crate) alone: usize,
}

impl Sequence {
    /// Every image of this folder, as one that holds both views.
    pub(crate) fn side_by_side(root: &Path) -> Result<Self, FrameError> {
        let pair =
            |path: PathBuf| SequencePair { name: stem(&path), files: PairFiles::SideBySide(path) };
        Ok(Self { pairs: images(root)?.into_iter().map(pair).collect(), alone: 0 }.sorted())
    }

    /// The pairs of this folder itself, and whether each camera has a folder.
    pub(crate) fn here(folder: &Listing) -> Result<(Self, bool), FrameError> {
        if let Some([left, right]) = camera_folders(folder)? {
            return Ok((by_name(images(&left)?, images(&right)?).sorted(), true));
        }
        Ok((by_side(images(&folder.path)?).sorted(), false))
    }

    fn sorted(mut self) -> Self {
        self.pairs.sort_by_cached_key(|pair| (numbers(&pair.name), pair.name.clone()));
        self
    }
}

/// All numbers in a name, of which the first that differ tell the order: `12.000005` is after
/// `11.100000`.
pub(crate) fn numbers(name: &str) -> Vec<u128> {
    let digits = name.split(|c: char| !c.is_ascii_digit()).filter(|digits| !digits.is_empty());
    digits.map(|digits| digits.parse().unwrap_or(u128::MAX)).collect()
}

fn time_ns(name: &str) -> Option<u64> {
    let is_number = name.bytes().all(|byte| byte.is_ascii_digit());
    let number = || name.parse::<u64>().ok();
    match name.len() {
        _ if !is_number => None,
        digits if NS_DIGITS.contains(&digits) => number(),
        digits if US_DIGITS.contains(&digits) => number()?.checked_mul(1000),
        _ => None,
    }
}

/// The folders of both cameras in this one, or in `mav0`; of those that have one, their `data`.
fn camera_folders(folder: &Listing) -> Result<Option<[PathBuf; 2]>, FrameError> {
    let exact = |[left, right]: &[&str; 2]| {
        Some([folder.folder_in_any_case(left)?, folder.folder_in_any_case(right)?])
    };
    let sided = |[left, right]: &[&'static str; 2]| {
        folder.folders.iter().find_map(|name| {
            let rest = without_side(name, left)?;
            let partner = |other: &&String| without_side(other, right).as_ref() == Some(&rest);
            Some([name.as_str(), folder.folders.iter().find(partner)?])
        })
    };
    let found = CAMERA_FOLDERS.iter().find_map(exact).or_else(|| SIDES.iter().find_map(sided));
    if found.is_none()
        && let Some(inner) = folder.below("mav0")?
    {
        return camera_folders(&inner);
    }
    Ok(found.map(|names| {
        names.map(|name| {
            let (camera, data) = (folder.path.join(name), folder.path.join(name).join("data"));
            if data.is_dir() { data } else { camera }
        })
    }))
}

fn images(folder: &Path) -> Result<Vec<PathBuf>, FrameError> {
    let read_error = |error| FrameError::Read(folder.to_path_buf(), error);
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(read_error)? {
        let path = entry.map_err(read_error)?.path();
        let extension =
            path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        let is_image = extension.is_some_and(|extension| IMAGE_EXTENSIONS.contains(&&*extension));
        if is_image && path.is_file() {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}

/// The nearest to a time: of the last image before it and the first one of `later`.
fn nearest(
    time: u64,
    all: &BTreeMap<u64, String>,
    later: impl RangeBounds<u64>,
) -> Option<(u64, &String)> {
    let around = all.range(..time).next_back().into_iter().chain(all.range(later).next());
    around.map(|(other, name)| (*other, name)).min_by_key(|(other, _)| other.abs_diff(time))
}

/// Time to the nearest of the others.
fn gap(time: u64, all: &BTreeMap<u64, String>) -> u64 {
    nearest(time, all, time + 1..).map_or(u64::MAX, |(other, _)| other.abs_diff(time))
}

/// Files of one name in two folders; where names are times, those nearest to each other as well. A
/// time that an image of the other folder has exactly is nearest to that one alone.
fn by_name(left: Vec<PathBuf>, right: Vec<PathBuf>) -> Sequence {
    let named = |paths: Vec<PathBuf>| paths.into_iter().map(|path| (stem(&path), path)).collect();
    let names = [named(left), named(right)];
    let [left_times, right_times] = names.each_ref().map(|names: &ByName| {
        let timed = names.keys().filter_map(|name| Some((time_ns(name)?, name.clone())));
        timed.collect::<BTreeMap<u64, String>>()
    });
    let [left, right] = names;
    let (mut sequence, [left, right]) = matched(left, right);
    let mut found = Vec::new();
    for (name, path) in &left {
        // Images of lost partners may be nearest to each other, but about a frame apart.
        if let Some(time) = time_ns(name)
            && let Some((other, partner)) = nearest(time, &right_times, time..)
            && let Some(partner) = right.get(partner)
            && time.abs_diff(other) < gap(time, &left_times).min(gap(other, &right_times)) / 2
        {
            found.push(pair(name, path.clone(), partner.clone()));
        }
    }
    sequence.alone -= 2 * found.len();
    sequence.pairs.append(&mut found);
    sequence
}

/// Files whose names differ by the side alone, as most of them call it.
fn by_side(images: Vec<PathBuf>) -> Sequence {
    let sided = |side: &str| -> ByName {
        images
            .iter()
            .filter_map(|path| Some((without_side(&stem(path), side)?, path.clone())))
            .collect()
    };
    let called = |[left, right]: &[&str; 2]| matched(sided(left), sided(right)).0;
    let single = |names: &[&str; 2]| {
        let [left, right] = names.map(|name| images.iter().find(|path| stem(path) == name));
        Some(Sequence { pairs: vec![pair("", left?.clone(), right?.clone())], alone: 0 })
    };
    let by_side = SIDES.iter().map(called).find(|sequence| !sequence.pairs.is_empty());
    by_side.or_else(|| SINGLE.iter().find_map(single)).unwrap_or_else(|| called(&SIDES[0]))
}

/// A name of one camera's images or of their folder. Of `whole` names a single letter is a side
/// only if nothing else is in them.
pub(crate) fn has_side(name: &str, whole: bool) -> bool {
    let is = |side: &&str| name.eq_ignore_ascii_case(side);
    let in_name = |side: &&str| (!whole || side.len() > 1) && without_side(name, side).is_some();
    SIDES.as_flattened().iter().any(|side| is(side) || in_name(side))
        || CAMERA_FOLDERS.as_flattened().iter().any(is)
}

/// `0001_left`, `Left0001` or `cam_left_1` without the side; `None` for other names.
pub fn without_side(name: &str, side: &str) -> Option<String> {
    let is_mark = |c: char| !c.is_ascii_alphanumeric();
    let ends_in_digit = side.ends_with(|c: char| c.is_ascii_digit());
    name.to_ascii_lowercase().match_indices(side).find_map(|(start, _)| {
        let (before, after) = (&name[..start], &name[start + side.len()..]);
        let is_apart = !before.ends_with(|c: char| c.is_ascii_alphabetic())
            && !after.starts_with(|c: char| {
                c.is_ascii_alphabetic() || (ends_in_digit && c.is_ascii_digit())
            });
        let [before, after] = [before.trim_end_matches(is_mark), after.trim_start_matches(is_mark)];
        let between = if before.is_empty() || after.is_empty() { "" } else { "_" };
        is_apart.then(|| format!("{before}{between}{after}"))
    })
}

fn pair(name: &str, left: PathBuf, right: PathBuf) -> SequencePair {
    SequencePair { name: name.to_owned(), files: PairFiles::Two([left, right]) }
}

type ByName = BTreeMap<String, PathBuf>;

/// Files of one name, and those that are left.
fn matched(left: ByName, mut right: ByName) -> (Sequence, [ByName; 2]) {
    let (mut pairs, mut alone) = (Vec::new(), ByName::new());
    for (name, left) in left {
        match right.remove(&name) {
            Some(right) => pairs.push(pair(&name, left, right)),
            None => _ = alone.insert(name, left),
        }
    }
    (Sequence { pairs, alone: alone.len() + right.len() }, [alone, right])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with these files, whose names are separated by blanks.
    fn folder(files: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in files.split(' ') {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, b"").unwrap();
        }
        folder
    }

    fn names(files: &str) -> (Vec<String>, usize) {
        let folder = folder(files);
        let (sequence, _) = Sequence::here(&Listing::read(folder.path()).unwrap()).unwrap();
        (sequence.pairs.into_iter().map(|pair| pair.name).collect(), sequence.alone)
    }

    #[test]
    fn every_layout_is_found_in_order() {
        for files in [
            "2_left.png 2_right.png 10_left.png 10_right.png 11_left.png scene.json",
            "left2.png right2.png left_10.png right_10.png right_11.png frames.csv",
            "left/2.png right/2.png left/10.png right/10.png left/11.png left/x.txt",
            "cam0/data/2.png cam1/data/2.png cam0/data/10.png cam1/data/10.png cam1/data/9.png a.yaml",
            "Left/2.png Right/2.png Left/10.png Right/10.png Left/11.png",
            "L/2.png R/2.png L/10.png R/10.png R/11.png",
            "infra1/2.png infra2/2.png infra1/10.png infra2/10.png infra2/11.png",
            "cam_left/2.png cam_right/2.png cam_left/10.png cam_right/10.png cam_left/11.png",
            "2_L.png 2_R.png 10_L.png 10_R.png 11_L.png",
            "infra1_2.png infra2_2.png infra1_10.png infra2_10.png infra1_11.png",
        ] {
            assert_eq!(names(files), (vec!["2".to_owned(), "10".to_owned()], 1), "{files}");
        }
        assert_eq!(names("im0.png im1.png calib.txt"), (vec![String::new()], 0));
        assert_eq!(names("leftmost.png right.png"), (vec![], 1));
        assert_eq!(names("model.png tower.png"), (vec![], 0));
    }

    #[test]
    fn the_nearest_times_are_pairs() {
        let time = |camera: &str, ms: u64| {
            format!("{camera}/{}.png", 1_403_715_273_262_142_976 + 1_000_000 * ms)
        };
        // Frame 2 has no right image, frame 4 no left one.
        let left = [0, 50, 100, 150].map(|ms| time("left", ms));
        let right = [3, 54, 149, 203].map(|ms| time("right", ms));
        let folder = folder(&[left, right].concat().join(" "));
        let (sequence, _) = Sequence::here(&Listing::read(folder.path()).unwrap()).unwrap();
        let skews = sequence.pairs.iter().map(|pair| pair.files.times_us().unwrap());
        let skews: Vec<i64> = skews.map(|[left, right]| right as i64 - left as i64).collect();
        assert_eq!((skews, sequence.alone), (vec![3000, 4000, -1000], 2));
    }

    #[test]
    fn long_numbers_are_times() {
        assert_eq!(time_ns("1403715273262142976"), Some(1_403_715_273_262_142_976));
        assert_eq!(time_ns("1403715273262142"), Some(1_403_715_273_262_142_000));
        assert_eq!((time_ns("0001"), time_ns("x1403715273262142976")), (None, None));
        assert_eq!(time_ns("20240501120059123"), None, "a date");
        let [left, right] =
            ["left", "right"].map(|side| PathBuf::from(format!("{side}/1403715273262142976.png")));
        let files = PairFiles::Two([left, right]);
        assert_eq!(files.time_ns(), Some(1_403_715_273_262_142_976));
        assert_eq!(files.times_us(), Some([1_403_715_273_262_142; 2]));
    }

    #[test]
    fn one_equal_name_leaves_the_others_to_their_times() {
        let time = |ms: u64| (1_403_715_273_262_142_976 + 1_000_000 * ms).to_string();
        let found = |left: &[u64], right: &[u64]| {
            let files = |side: &str, times: &[u64]| -> Vec<String> {
                times.iter().map(|&ms| format!("{side}/{}.png", time(ms))).collect()
            };
            let names = names(&[files("left", left), files("right", right)].concat().join(" "));
            let ms = |name: &String| left.iter().copied().find(|&ms| time(ms) == *name).unwrap();
            (names.0.iter().map(ms).collect::<Vec<_>>(), names.1)
        };
        assert_eq!(found(&[0, 50, 100], &[3, 50, 98]), (vec![0, 50, 100], 0));
        // Lost images of a synchronised pair have no partner.
        assert_eq!(found(&[0, 50, 100, 150], &[0, 50, 150, 200]), (vec![0, 50, 150], 2));
        assert_eq!(found(&[0, 1000, 1500], &[0, 501, 1500]), (vec![0, 1500], 2));
    }

    #[test]
    fn names_are_in_the_order_of_all_their_numbers() {
        for sorted in [
            ["10.900000", "11.100000", "12.000005", "12.100000"],
            [
                "2024-05-01_12-00-58", "2024-05-01_12-00-59", "2024-05-01_12-01-00",
                "2025-01-01_00-00-00",
            ],
            ["frame_2", "frame_10", "frame_10_b", "frame_11"],
        ] {
            let mut names = sorted;
            names.reverse();
            names.sort_by_cached_key(|name| (numbers(name), *name));
            assert_eq!(names, sorted);
        }
    }
}
