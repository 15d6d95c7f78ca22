//! Recorded sequences: a folder -> its pairs in the order in which they were captured.
//!
//! ```text
//! 0001/left.png, 0001/right.png, 0002/..      a folder per pair
//! 0001_left.png, 0001_right.png, ..           a number and the side, or the side and a number (left_0001.png, left1.png)
//! left/0001.png, right/0001.png, ..           a folder per camera: left and right, image_0 and image_1 (KITTI: image_2 and image_3),
//! cam0/data/140...png, cam1/data/140...png    EuRoC, also below mav0; the number is the time in ns
//! 0001.png, 0002.png, ..                      both images side by side, where that is asked for
//! ```
//!
//! Pairs are ordered by their numbers, then by name. An image without a partner is counted.

use super::error::FrameError;
use super::folder::{IMAGE_EXTENSIONS, find_pairs};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

const CAMERA_FOLDERS: [[&str; 2]; 6] = [
    ["left", "right"],
    ["image_0", "image_1"],
    ["image_2", "image_3"],
    ["image_02/data", "image_03/data"],
    ["cam0/data", "cam1/data"],
    ["mav0/cam0/data", "mav0/cam1/data"],
];
/// Numbers of EuRoC's files are times in ns: none of a frame counter is as long.
const LEAST_TIME_DIGITS: usize = 16;

/// How a pair is stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PairFiles {
    /// A file each.
    Two([PathBuf; 2]),
    /// One file, left beside right.
    SideBySide(PathBuf),
}

/// A pair of a sequence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SequencePair {
    /// Name of its files or its folder, without the side.
    pub name: String,
    /// The number in the name.
    pub number: Option<u64>,
    /// Where its images are.
    pub files: PairFiles,
}

impl SequencePair {
    /// The file with the left image.
    #[must_use]
    pub fn left(&self) -> &Path {
        match &self.files {
            PairFiles::Two([left, _]) | PairFiles::SideBySide(left) => left,
        }
    }

    /// When it was captured, where the name says so (EuRoC).
    #[must_use]
    pub fn time_us(&self) -> Option<u64> {
        let digits = self.name.bytes().filter(u8::is_ascii_digit).count();
        self.number.filter(|_| digits >= LEAST_TIME_DIGITS && digits == self.name.len()).map(|ns| ns / 1000)
    }
}

/// A folder of pairs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sequence {
    /// In the order of their numbers, then of their names.
    pub pairs: Vec<SequencePair>,
    /// Images without a partner.
    pub alone: usize,
}

impl Sequence {
    /// Finds the pairs of a folder; a folder without any is no error.
    pub fn find(root: &Path, side_by_side: bool) -> Result<Self, FrameError> {
        if side_by_side {
            let pairs = images(root)?.into_iter().map(|path| pair(&stem(&path), PairFiles::SideBySide(path)));
            return Ok(Self { pairs: pairs.collect(), alone: 0 }.sorted());
        }
        match Self::here(root)? {
            (none, false) if none.pairs.is_empty() => {
                Ok(Self { alone: none.alone, ..folders_of_pairs(root)? }.sorted())
            }
            (found, _) => Ok(found),
        }
    }

    /// The pairs of this folder itself, and whether each camera has a folder.
    pub(super) fn here(root: &Path) -> Result<(Self, bool), FrameError> {
        let camera_folders = CAMERA_FOLDERS.map(|names| names.map(|name| root.join(name)));
        Ok(match camera_folders.iter().find(|folders| folders.iter().all(|folder| folder.is_dir())) {
            Some([left, right]) => (by_name(images(left)?, images(right)?).sorted(), true),
            None => (by_side(images(root)?).sorted(), false),
        })
    }

    fn sorted(mut self) -> Self {
        self.pairs.sort_by(|a, b| (a.number, &a.name).cmp(&(b.number, &b.name)));
        self
    }
}

fn pair(name: &str, files: PairFiles) -> SequencePair {
    SequencePair { name: name.to_owned(), number: number(name), files }
}

/// The last number in a name.
fn number(name: &str) -> Option<u64> {
    name.split(|c: char| !c.is_ascii_digit()).rfind(|digits| !digits.is_empty())?.parse().ok()
}

fn images(folder: &Path) -> Result<Vec<PathBuf>, FrameError> {
    let read_error = |error| FrameError::Read(folder.to_path_buf(), error);
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(read_error)? {
        let path = entry.map_err(read_error)?.path();
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
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

/// Files of one name in two folders.
fn by_name(left: Vec<PathBuf>, right: Vec<PathBuf>) -> Sequence {
    matched(left.into_iter().map(|path| (stem(&path), path)), right.into_iter().map(|path| (stem(&path), path)))
}

/// Files whose names differ by the side alone.
fn by_side(images: Vec<PathBuf>) -> Sequence {
    let sided = |side: &'static str| {
        let images = images.iter();
        images.filter_map(move |path| Some((without_side(&stem(path), side)?, path.clone()))).collect::<Vec<_>>()
    };
    matched(sided("left").into_iter(), sided("right").into_iter())
}

/// `0001_left` and `left0001` without `left`; `None` for other names.
fn without_side(name: &str, side: &str) -> Option<String> {
    let is_mark = |c: char| !c.is_ascii_alphanumeric();
    if let Some(rest) = name.strip_suffix(side) {
        return rest
            .chars()
            .next_back()
            .is_none_or(|c| is_mark(c) || c.is_ascii_digit())
            .then(|| rest.trim_end_matches(is_mark).to_owned());
    }
    let rest = name.strip_prefix(side)?;
    rest.chars()
        .next()
        .is_none_or(|c| is_mark(c) || c.is_ascii_digit())
        .then(|| rest.trim_start_matches(is_mark).to_owned())
}

fn matched(left: impl Iterator<Item = (String, PathBuf)>, right: impl Iterator<Item = (String, PathBuf)>) -> Sequence {
    let mut right: BTreeMap<String, PathBuf> = right.collect();
    let mut sequence = Sequence::default();
    for (name, left) in left {
        match right.remove(&name) {
            Some(right) => sequence.pairs.push(pair(&name, PairFiles::Two([left, right]))),
            None => sequence.alone += 1,
        }
    }
    sequence.alone += right.len();
    sequence
}

/// A folder per pair, at any depth.
fn folders_of_pairs(root: &Path) -> Result<Sequence, FrameError> {
    let pairs = find_pairs(root)?.into_iter().map(|(folder, files)| {
        let name = folder.strip_prefix(root).unwrap_or(&folder).display().to_string();
        pair(&name, PairFiles::Two(files))
    });
    Ok(Sequence { pairs: pairs.collect(), alone: 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, b"").unwrap();
        }
        folder
    }

    fn names(files: &[&str], side_by_side: bool) -> (Vec<String>, usize) {
        let folder = folder(files);
        let sequence = Sequence::find(folder.path(), side_by_side).unwrap();
        (sequence.pairs.into_iter().map(|pair| pair.name).collect(), sequence.alone)
    }

    #[test]
    fn every_layout_is_found_in_order() {
        for files in [
            ["2_left.png", "2_right.png", "10_left.png", "10_right.png", "11_left.png", "scene.json"],
            ["left2.png", "right2.png", "left_10.png", "right_10.png", "right_11.png", "frames.csv"],
            ["left/2.png", "right/2.png", "left/10.png", "right/10.png", "left/11.png", "left/x.txt"],
            ["cam0/data/2.png", "cam1/data/2.png", "cam0/data/10.png", "cam1/data/10.png", "cam1/data/9.png", "a.yaml"],
        ] {
            assert_eq!(names(&files, false), (vec!["2".to_owned(), "10".to_owned()], 1), "{files:?}");
        }
        let folders = ["a/2/left.png", "a/2/right.pgm", "a/10/left.png", "a/10/right.png", "a/10/scene.json"];
        assert_eq!(names(&folders, false).0, ["a/2", "a/10"]);
        assert_eq!(names(&["b2.png", "b1.png", "b1.csv"], true).0, ["b1", "b2"]);
        assert_eq!(names(&["leftmost.png", "right.png"], false), (vec![], 1));
    }

    #[test]
    fn long_numbers_are_times() {
        let of = |name: &str| pair(name, PairFiles::SideBySide(PathBuf::new())).time_us();
        assert_eq!(of("1403715273262142976"), Some(1_403_715_273_262_142));
        assert_eq!((of("0001"), of("x1403715273262142976")), (None, None));
    }
}
