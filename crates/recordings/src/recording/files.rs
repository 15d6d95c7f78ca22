//! The files of a recording: one of MCAP, or those of a folder that `ros2 bag record` wrote.

use super::RecordingFault;
use crate::mcap::{McapFault, Place, Reader};
use linestereo_frames::FrameError;
use linestereo_frames::untrusted::{self, SETTINGS_BYTES};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// File in which ROS 2 lists the files of a folder.
const METADATA: &str = "metadata.yaml";
/// Most files of a recording.
const MOST_FILES: usize = 4096;
/// Files that a message lists.
const LISTED: usize = 4;

/// Is this a recording, by its name? Bags of other formats are, too: what is to be done with them
/// is said when they are opened.
pub fn is_recording(path: &Path) -> bool {
    if !path.is_dir() {
        return is_mcap(path) || is_other_bag(path);
    }
    let Ok(names) = names(path) else { return false };
    let holds_bags = names.iter().any(|name| is_mcap(name) || is_other_bag(name));
    // Without what ROS says of it, a folder that holds nothing else.
    holds_bags
        && (path.join(METADATA).is_file()
            || names.iter().all(|name| is_mcap(name) || is_other_bag(name)))
}

/// The name of an MCAP file.
pub fn is_mcap(path: &Path) -> bool {
    ends_in(path, "mcap")
}

fn ends_in(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

/// The name of a bag in SQLite or of ROS 1, or of one that is packed as a whole.
fn is_other_bag(path: &Path) -> bool {
    let packed = path.file_stem().map(Path::new).filter(|_| ends_in(path, "zstd"));
    ends_in(path, "db3")
        || ends_in(path, "bag")
        || packed.is_some_and(|inner| is_mcap(inner) || ends_in(inner, "db3"))
}

fn names(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder)?.take(MOST_FILES);
    let names: Result<Vec<_>, _> =
        entries.map(|entry| entry.map(|entry| PathBuf::from(entry.file_name()))).collect();
    names
}

/// The MCAP files of a recording, in their order.
fn paths(root: &Path) -> Result<Vec<PathBuf>, RecordingFault> {
    if !root.is_dir() {
        if ends_in(root, "zstd") {
            return Err(RecordingFault::Folder(
                "it is packed as a whole; unpack it with `zstd -d`".to_owned(),
            ));
        }
        return Ok(vec![root.to_path_buf()]);
    }
    let all = names(root).map_err(|error| RecordingFault::File(McapFault::Read(error)))?;
    let (mut found, others): (Vec<PathBuf>, Vec<PathBuf>) =
        all.into_iter().partition(|name| is_mcap(name));
    found.sort_by_key(|name| (number(name), name.clone()));
    let listed = |names: &[PathBuf]| {
        let shown: Vec<String> =
            names.iter().take(LISTED).map(|name| name.display().to_string()).collect();
        shown.join(", ") + if names.len() > LISTED { ", .." } else { "" }
    };
    if found.is_empty() {
        let bags: Vec<PathBuf> = others.into_iter().filter(|name| is_other_bag(name)).collect();
        let is_packed = bags.iter().any(|name| ends_in(name, "zstd"));
        let remedy = if is_packed { "unpack it with `zstd -d`" } else { CONVERT };
        return Err(RecordingFault::Folder(format!(
            "it holds {} and no .mcap; {remedy}",
            listed(&bags)
        )));
    }
    if !root.join(METADATA).is_file() {
        if found.len() > 1 {
            let which = listed(&found);
            return Err(RecordingFault::Folder(format!(
                "it holds {which} without a {METADATA}; give one of them, or `ros2 bag reindex` \
                 the folder"
            )));
        }
    } else {
        let promised = promised(root)?;
        if let Some(missing) = promised.iter().find(|name| !found.contains(name)) {
            let missing = missing.display();
            return Err(RecordingFault::Folder(format!(
                "its {METADATA} names {missing}, which is not there; copy the whole folder, or \
                 give the .mcap files one by one"
            )));
        }
        // Others were put beside them: results, for example.
        found.retain(|name| promised.is_empty() || promised.contains(name));
    }
    Ok(found.iter().map(|name| root.join(name)).collect())
}

/// Remedy for bags in SQLite and of ROS 1.
const CONVERT: &str = "convert it with `mcap convert`";

/// The MCAP files that a folder's metadata names.
fn promised(root: &Path) -> Result<Vec<PathBuf>, RecordingFault> {
    let text = untrusted::read_text(&root.join(METADATA), SETTINGS_BYTES);
    let text = text.map_err(|error| RecordingFault::File(McapFault::Read(error)))?;
    let lines =
        text.lines().map(str::trim).skip_while(|line| *line != "relative_file_paths:").skip(1);
    let names = lines.map_while(|line| line.strip_prefix("- "));
    let names = names.map(|name| PathBuf::from(name.trim_matches(['"', '\''])));
    Ok(names.filter(|name| is_mcap(name)).take(MOST_FILES).collect())
}

/// The last number in a name: `bag_10.mcap` is behind `bag_9.mcap`.
fn number(name: &Path) -> u64 {
    let stem = name.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let digits = stem.len() - stem.trim_end_matches(|letter: char| letter.is_ascii_digit()).len();
    stem[stem.len() - digits..].parse().unwrap_or(0)
}

/// The files of a recording, one of them open: readers keep chunks.
pub(super) struct Files {
    paths: Vec<PathBuf>,
    open: Mutex<(usize, Reader)>,
}

impl Files {
    /// Opens a recording, and shows each of its files to `scan` with its number.
    pub(super) fn open(
        root: &Path,
        mut scan: impl FnMut(&mut Reader, u16) -> Result<(), RecordingFault>,
    ) -> Result<Self, FrameError> {
        let fault = |path: &Path, fault| FrameError::Source(path.to_path_buf(), Box::new(fault));
        let paths = paths(root).map_err(|error| fault(root, error))?;
        let mut last = None;
        for (path, number) in paths.iter().zip(0_u16..) {
            let mut reader = Reader::open(path).map_err(|error| fault(path, error.into()))?;
            scan(&mut reader, number).map_err(|error| fault(path, error))?;
            last = Some((usize::from(number), reader));
        }
        let none = || RecordingFault::Folder("it holds no .mcap; give one".to_owned());
        let last = last.ok_or_else(|| fault(root, none()))?;
        Ok(Self { paths, open: Mutex::new(last) })
    }

    /// The file of this number.
    pub(super) fn path(&self, file: u16) -> &Path {
        self.paths.get(usize::from(file)).map_or(Path::new(""), PathBuf::as_path)
    }

    /// The bytes of a message.
    pub(super) fn message(&self, file: u16, place: Place) -> Result<Vec<u8>, McapFault> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let wanted = usize::from(file);
        if open.0 != wanted {
            *open = (wanted, Reader::open(self.path(file))?);
        }
        open.1.message(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        files.iter().for_each(|name| fs::write(folder.path().join(name), "x").unwrap());
        folder
    }

    #[test]
    fn files_of_a_folder_come_in_the_order_of_their_numbers() {
        let bag =
            folder(&["bag_10.mcap", "bag_9.mcap", "bag_0.MCAP", "metadata.yaml", "notes.txt"]);
        assert!(is_recording(bag.path()));
        let names: Vec<_> = paths(bag.path())
            .unwrap()
            .iter()
            .map(|path| path.file_name().unwrap().to_owned())
            .collect();
        assert_eq!(names, ["bag_0.MCAP", "bag_9.mcap", "bag_10.mcap"]);
        let listed = "relative_file_paths:\n  - bag_10.mcap\n  - bag_9.mcap\n";
        fs::write(bag.path().join("metadata.yaml"), listed).unwrap();
        assert_eq!(
            paths(bag.path()).unwrap(),
            names[1..].iter().map(|name| bag.path().join(name)).collect::<Vec<_>>()
        );
        let alone = folder(&["one.mcap"]);
        assert!(is_recording(alone.path()) && paths(alone.path()).unwrap().len() == 1);
        // Images beside a recording are what was asked for.
        assert!(!is_recording(folder(&["one.mcap", "left.png", "right.png"]).path()));
        assert!(
            !is_recording(folder(&[]).path()) && !is_recording(folder(&["metadata.yaml"]).path())
        );
    }

    #[test]
    fn what_cannot_be_read_says_what_to_do() {
        let says = |file: &str, metadata: &str, words: &str| {
            let bag = folder(&[file]);
            fs::write(bag.path().join("metadata.yaml"), metadata).unwrap();
            assert!(is_recording(bag.path()), "{file}");
            let error = paths(bag.path()).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        };
        says("bag_0.mcap.zstd", "x", "unpack it with `zstd -d`");
        let listed = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - \
                      bag_0.mcap\n    - 'bag_1.mcap'\n  x: 1\n";
        says("bag_0.mcap", listed, "its metadata.yaml names bag_1.mcap, which is not there");
        assert!(is_recording(Path::new("x.BAG")) && !is_recording(Path::new("x.zstd")));
    }
}
