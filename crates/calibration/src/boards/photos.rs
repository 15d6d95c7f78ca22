//! A folder of photos -> pairs of files.
//!
//! Left and right photos stand in one folder (`left01.jpg`, `right01.jpg`; `3_cam0.png`,
//! `3_cam1.png`) or in two inside it (`left/`, `right/`, or `cam0/`, `cam1/`, with or without
//! `data/` below), by every name of a side that recordings have. A pair has the same last number.
//! Without one, or where both cameras have several photos of one number, it has the same rest of
//! the name.

use linestereo_frames::{SIDES, without_side};
use linestereo_rig::CameraSide;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Words for the left and the right camera that may stand anywhere in a name, without a mark around
/// them.
const WORDS: [[&str; 2]; 2] = [["left", "cam0"], ["right", "cam1"]];
const EXTENSIONS: [&str; 10] =
    ["jpg", "jpeg", "png", "pgm", "ppm", "pnm", "tif", "tiff", "bmp", "webp"];
/// File names listed in a message.
const LISTED: usize = 4;

/// Two photos taken at the same time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PhotoPair {
    /// The number, or what the two names share.
    pub name: String,
    /// Left, right.
    pub files: [PathBuf; 2],
}

/// Why a folder holds no pairs.
#[derive(Debug, thiserror::Error)]
pub enum PhotoError {
    /// It cannot be listed.
    #[error("cannot read the folder {0}: {1}; check the path")]
    Folder(PathBuf, std::io::Error),
    /// No left or right photo in it.
    #[error(
        "{0} holds no photos named left*, right* (or cam0*, cam1*), nor folders of these names \
         with photos; name them left01.png, right01.png and so on"
    )]
    None(PathBuf),
    /// One camera's photos only.
    #[error(
        "{0} holds {1} photos but no {miss} ones; a pair has the same number or name",
        miss = if *.1 == CameraSide::Left { CameraSide::Right } else { CameraSide::Left }
    )]
    OneSide(PathBuf, CameraSide),
    /// Two photos of one camera have one number.
    #[error("{0} and {1} have the same number; rename or remove one")]
    Twice(PathBuf, PathBuf),
    /// Photos without a partner.
    #[error(
        "{} left and {} right photos do not make pairs: {} without a partner of the same number or \
         name; add it, remove them, or leave them out with --skip-unpaired",
        .1[0], .1[1], names(.0)
    )]
    Unpaired(Vec<PathBuf>, [usize; 2]),
}

fn names(paths: &[PathBuf]) -> String {
    let name = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let names: Vec<String> = paths.iter().take(LISTED).filter_map(name).collect();
    names.join(", ") + if paths.len() > LISTED { ", ..." } else { "" }
}

/// Pairs in a folder, in the order of their numbers or names, and the photos left without a
/// partner.
pub fn find_pairs(
    folder: &Path,
    skip_unpaired: bool,
) -> Result<(Vec<PhotoPair>, Vec<PathBuf>), PhotoError> {
    let photos = [named(folder, 0)?, named(folder, 1)?];
    let [mut left, mut right] = by_number_or_name(&photos)?;
    let counts = [left.len(), right.len()];
    match counts {
        [0, 0] => return Err(PhotoError::None(folder.to_path_buf())),
        [_, 0] => return Err(PhotoError::OneSide(folder.to_path_buf(), CameraSide::Left)),
        [0, _] => return Err(PhotoError::OneSide(folder.to_path_buf(), CameraSide::Right)),
        _ => {}
    }
    let keys: Vec<Key> = left.keys().filter(|key| right.contains_key(*key)).cloned().collect();
    let pair = |key: Key| {
        let files = [left.remove(&key)?, right.remove(&key)?];
        Some(PhotoPair { name: key.text(), files })
    };
    let pairs: Vec<PhotoPair> = keys.into_iter().filter_map(pair).collect();
    let alone: Vec<PathBuf> = left.into_values().chain(right.into_values()).collect();
    if alone.is_empty() || (skip_unpaired && !pairs.is_empty()) {
        return Ok((pairs, alone));
    }
    Err(PhotoError::Unpaired(alone, counts))
}

/// Common part of the names of two photos of a pair; numbers come in their order.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Number(u64),
    Rest(String),
}

impl Key {
    fn of(rest: &str) -> Self {
        let digits = rest.trim_end_matches(|letter: char| !letter.is_ascii_digit());
        let number = digits
            .rsplit(|letter: char| !letter.is_ascii_digit())
            .next()
            .and_then(|digits| digits.parse().ok());
        number.map_or_else(|| Self::name(rest), Self::Number)
    }

    fn name(rest: &str) -> Self {
        Self::Rest(rest.trim_matches(['_', '-', ' ', '.']).to_owned())
    }

    fn text(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Rest(rest) => rest.clone(),
        }
    }
}

/// One camera's photos by what pairs have in common.
type Photos = BTreeMap<Key, PathBuf>;

/// Both cameras' photos by number, or by name where both have several of one number.
fn by_number_or_name(photos: &[Vec<Photo>; 2]) -> Result<[Photos; 2], PhotoError> {
    let by = |key: fn(&str) -> Key| photos.each_ref().map(|photos| keyed(photos, key));
    let [left, right] = match by(Key::of) {
        [Err(_), Err(_)] => by(Key::name),
        found => found,
    };
    Ok([left?, right?])
}

fn keyed(photos: &[Photo], key: fn(&str) -> Key) -> Result<Photos, PhotoError> {
    let mut found = Photos::new();
    for Photo { path, rest } in photos {
        if let Some(other) = found.insert(key(rest), path.clone()) {
            return Err(PhotoError::Twice(other, path.clone()));
        }
    }
    Ok(found)
}

/// A photo and its name without the word for the camera.
struct Photo {
    path: PathBuf,
    rest: String,
}

/// One camera's photos.
fn named(folder: &Path, side: usize) -> Result<Vec<Photo>, PhotoError> {
    let mut found = Vec::new();
    for path in listed(folder)? {
        if path.is_dir() {
            let stem = stem_of(&path);
            if SIDES.iter().any(|names| names[side] == stem) {
                let below = path.join("data");
                let inside = listed(if below.is_dir() { &below } else { &path })?;
                let photos = inside.into_iter().filter(|path| is_photo(path));
                found.extend(photos.map(|path| {
                    let rest = rest_of(&path, side).unwrap_or_else(|| stem_of(&path));
                    Photo { path, rest }
                }));
            }
        } else if is_photo(&path)
            && let Some(rest) = rest_of(&path, side)
        {
            found.push(Photo { path, rest });
        }
    }
    Ok(found)
}

fn stem_of(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// The name without the word for the camera; `None` without such a word.
fn rest_of(path: &Path, side: usize) -> Option<String> {
    let stem = stem_of(path);
    if let Some(rest) = SIDES.iter().find_map(|names| without_side(&stem, names[side])) {
        return Some(rest);
    }
    let word = WORDS[side].iter().find(|word| stem.contains(*word))?;
    Some(stem.replacen(word, "", 1))
}

fn is_photo(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    path.is_file() && EXTENSIONS.contains(&extension.as_str())
}

fn listed(folder: &Path) -> Result<Vec<PathBuf>, PhotoError> {
    let entries = fs::read_dir(folder).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let entries = entries.map_err(|error| PhotoError::Folder(folder.to_path_buf(), error))?;
    let mut paths: Vec<PathBuf> = entries.into_iter().map(|entry| entry.path()).collect();
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photos_of_one_number_are_paired_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let photo = |name: &str| fs::write(folder.path().join(name), b"").unwrap();
        for side in ["left", "right"] {
            fs::create_dir(folder.path().join(side)).unwrap();
            for number in [1, 2, 10] {
                photo(&format!("{side}/{number}_640.png"));
            }
        }
        let (pairs, alone) = find_pairs(folder.path(), false).unwrap();
        let names: Vec<[String; 2]> =
            pairs.iter().map(|pair| pair.files.each_ref().map(|file| stem_of(file))).collect();
        assert_eq!(names, [["10_640"; 2], ["1_640"; 2], ["2_640"; 2]]);
        assert!(alone.is_empty());
        photo("left/3_640.png");
        let error = find_pairs(folder.path(), false).unwrap_err();
        assert!(matches!(&error, PhotoError::Unpaired(alone, [4, 3]) if alone.len() == 1));
    }

    #[test]
    fn the_last_number_of_a_name_counts() {
        assert_eq!(Key::of("007"), Key::Number(7));
        assert_eq!(Key::of("2024-05-01_12"), Key::Number(12));
        assert_eq!(Key::of("12_"), Key::Number(12));
        assert_eq!(Key::of("_kitchen"), Key::Rest("kitchen".into()));
        assert_eq!(Key::of("ä7"), Key::Number(7));
    }
}
