//! Pairs without a data set's rules: a folder for each camera, the side in each name, one pair in a
//! folder, both views side by side.
//!
//! ```text
//! left/0001.png right/0001.png   truth: disp/, disparity/, gt/ or disp_occ/ with the same names
//! 0001_left.png 0001_right.png   truth: 0001_disp.*, 0001_gt.*
//! left.png right.png             truth: disp.*, disparity.*, gt.*
//! 0001.png (both views)          truth: none; any image that is at least twice as wide as high, in
//!                                a tree without a pair and without a side in any name
//! ```
//!
//! Truth is PFM, NPZ or NPY in px, or a 16-bit image of 1/256 px (KITTI's way). A `scene.json` in
//! the folder gives range, rig and, with `disparity_scale`, the steps of truth images, for every
//! frame.

use super::Dataset;
use crate::decode::dimensions;
use crate::error::FrameError;
use crate::folder::{Listing, folder_name, walk};
use crate::layout::Layout;
use crate::scene_info::SceneInfo;
use crate::sequence::{Sequence, SequencePair, has_side};
use crate::stored::{Scale, StoredPair, StoredRig, StoredTruth, Visibility};
use std::path::Path;

const TRUTH_FOLDERS: [&str; 4] = ["disp", "disparity", "gt", "disp_occ"];
const TRUTH_NAMES: [&str; 3] = ["disp", "disparity", "gt"];
/// Sides of an image that holds two views: a single one is seldom as wide.
const LEAST_ASPECT: u64 = 2;

/// The pairs of this folder itself; folders below are for the caller.
pub(crate) fn find(folder: &Listing, is_lenient: bool) -> Result<Dataset, FrameError> {
    let (sequence, in_folders) = Sequence::here(folder)?;
    let info = info(folder, is_lenient)?;
    let truths = TRUTH_FOLDERS.iter().filter(|_| in_folders).find(|name| folder.has_folder(name));
    let truths = truths.map(|name| folder.below(name)).transpose()?.flatten();
    let pairs = sequence
        .pairs
        .iter()
        .map(|pair| stored(folder, pair, info.as_ref(), in_folders.then_some(truths.as_ref())));
    Ok(Dataset { pairs: pairs.collect(), alone: sequence.alone, ..Dataset::default() })
}

/// The folder's `scene.json`; of one that is broken its pairs say so when they are loaded, if that
/// is early enough.
fn info(folder: &Listing, is_lenient: bool) -> Result<Option<SceneInfo>, FrameError> {
    match folder.file("scene.json").map(|path| SceneInfo::load(&path)).transpose() {
        Err(_) if is_lenient => Ok(None),
        info => info,
    }
}

/// `truths` is the folder with truth, if there is one, of frames in folders.
fn stored(
    folder: &Listing,
    pair: &SequencePair,
    info: Option<&SceneInfo>,
    truths: Option<Option<&Listing>>,
) -> StoredPair {
    let (layout, file) = match truths {
        Some(truths) => {
            (Layout::CameraFolders, truths.and_then(|listing| listing.disparities(&pair.name)))
        }
        None if pair.name.is_empty() => {
            (Layout::PairFolder, TRUTH_NAMES.iter().find_map(|name| folder.disparities(name)))
        }
        None => {
            let beside = |name: &&str| folder.disparities(&format!("{}_{name}", pair.name));
            (Layout::SidesInNames, TRUTH_NAMES.iter().find_map(beside))
        }
    };
    let scale = info.and_then(SceneInfo::disparity_scale).map_or(Scale::SixteenBit, Scale::Steps);
    let rig = info.and_then(SceneInfo::rectified_rig);
    StoredPair {
        layout,
        folder: folder.path.clone(),
        truth: file.map(|file| StoredTruth { file, scale, visibility: Visibility::Truth }),
        rig: rig.map_or(StoredRig::Unknown, |rig| {
            StoredRig::Rectified(folder.path.join("scene.json"), rig)
        }),
        max_disparity: info.and_then(|info| info.max_disparity),
        ..StoredPair::alone(pair.name.clone(), pair.files.clone())
    }
}

/// Every image of this folder, each of both views.
pub(crate) fn side_by_side(
    folder: &Listing,
    is_lenient: bool,
) -> Result<Vec<StoredPair>, FrameError> {
    let info = info(folder, is_lenient)?;
    let pairs = Sequence::side_by_side(&folder.path)?.pairs;
    let stored = |pair| StoredPair {
        layout: Layout::SideBySide,
        ..stored(folder, pair, info.as_ref(), Some(None))
    };
    Ok(pairs.iter().map(stored).collect())
}

/// The images of a tree that hold both views; none where a name says that they are of one camera.
pub(crate) fn side_by_side_tree(
    root: &Path,
    is_lenient: bool,
) -> Result<Vec<StoredPair>, FrameError> {
    let place = root.canonicalize().unwrap_or_else(|_| root.to_path_buf());
    let camera = if place.ends_with("data") { place.parent() } else { Some(&*place) };
    // A folder of its own may be named at random: a letter in it says nothing.
    let mut is_sided = camera.is_some_and(|camera| has_side(&folder_name(camera), true));
    let mut found = Vec::new();
    walk(root, |folder| {
        let images = side_by_side(folder, is_lenient)?;
        let mut names = folder.folders.iter().chain(images.iter().map(|image| &image.name));
        is_sided = is_sided || names.any(|name| has_side(name, false));
        found.extend(images);
        Ok(!is_sided)
    })?;
    found.retain(|pair| {
        let is_wide = |(width, height)| u64::from(width) >= LEAST_ASPECT * u64::from(height);
        !is_sided && dimensions(pair.left()).is_ok_and(is_wide)
    });
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::LayoutFault;
    use image::GrayImage;
    use std::fs;

    #[test]
    fn images_of_one_camera_are_not_cut_in_two() {
        for (files, root, is_found) in [
            (&["image_02/data/0000000000.png"][..], ".", false),
            (&["image_02/data/0000000000.png"], "image_02/data", false),
            (&["rect_left/1.png"], "rect_left", false),
            (&["left/a1.png", "right/b1.png"], ".", false),
            (&["0001_l.png"], ".", false),
            (&["x/1.png", "x/2.png"], ".", true),
        ] {
            let folder = tempfile::tempdir().unwrap();
            for file in files {
                let path = folder.path().join(file);
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                GrayImage::new(124, 37).save(path).unwrap();
            }
            let root = folder.path().join(root);
            for found in [Dataset::find(&root), Dataset::sequence(&root, false)] {
                match found {
                    Ok(found) => assert_eq!((is_found, found.pairs.len()), (true, 2), "{files:?}"),
                    Err(FrameError::Layout(_, LayoutFault::NotRecognised)) => {
                        assert!(!is_found, "{files:?}");
                    }
                    Err(error) => panic!("{error}"),
                }
            }
        }
    }
}
