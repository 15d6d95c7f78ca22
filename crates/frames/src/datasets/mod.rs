//! Folders of stereo pairs as data sets and recorders store them: which layout it is, told from
//! names alone, and the pairs in it.
//!
//! ```text
//! Dataset::find(root):
//!   a folder is taken by the first layout that knows its files:
//!     scene.json   left.*, right.* and scene.json                      this project's own, see `scene_file`
//!     middlebury   im2 + im6, view1 + view5, im0 + im1 + calib.txt     2001 to 2021, the benchmark's version 3, ETH3D's two-view sets
//!     kitti        image_2 + image_3 (or 0 + 1) with 000000_10.png     2012 and 2015
//!     euroc        mav0/cam0/data + mav0/cam1/data                     raw: rectified while loading
//!     plain        left/ + right/; 0001_left + 0001_right; left + right; sequences of them; sides
//!                  by any of their names
//!   folders below it are searched where nothing took it, and below single pairs
//!   in a tree without any pair, and without a camera's side in any name, images at least twice as
//!   wide as high hold both views side by side
//! ```
//!
//! Only names and small text files are read here; images when a pair is loaded. Each layout's
//! module says where its rules are from.

mod calibration;
mod euroc;
mod kitti;
mod middlebury;
mod plain;

use super::error::{FrameError, LayoutFault};
use super::folder::{Listing, folder_name, walk};
use super::layout::Layout;
use super::scene_file;
use super::sequence::numbers;
use super::stored::StoredPair;
use crate::untrusted::printable;
use std::path::Path;

/// The pairs of a folder, whatever their layout.
#[derive(Clone, Debug, Default)]
pub struct Dataset {
    /// Sorted by folder, then by number.
    pub pairs: Vec<StoredPair>,
    /// Images without a partner.
    pub alone: usize,
    /// A data set may lack its calibration.
    is_lenient: bool,
}

impl Dataset {
    /// Finds every pair at or below `root`.
    pub fn find(root: &Path) -> Result<Self, FrameError> {
        let mut found = Self::default();
        found.search(root)?;
        if found.pairs.is_empty() {
            return Err(FrameError::Layout(root.to_path_buf(), LayoutFault::NotRecognised));
        }
        Ok(found)
    }

    /// The same where no truth is needed: a calibration that a data set lacks costs depths alone, a
    /// file that is broken its own pairs, and every image holds both views where that is said.
    /// Pairs come in the order of their numbers, then of their names.
    pub fn sequence(root: &Path, side_by_side: bool) -> Result<Self, FrameError> {
        let mut found = Self { is_lenient: true, ..Self::default() };
        if side_by_side {
            found.pairs = plain::side_by_side(&Listing::read(root)?, true)?;
            name_below(root, &mut found.pairs);
        } else {
            found.search(root)?;
        }
        if found.pairs.is_empty() {
            return Err(FrameError::Layout(root.to_path_buf(), LayoutFault::NotRecognised));
        }
        found.pairs.sort_by_cached_key(|pair| (numbers(&pair.name), pair.name.clone()));
        Ok(found)
    }

    fn search(&mut self, root: &Path) -> Result<(), FrameError> {
        walk(root, |folder| {
            let mut taken = recognised(folder, self.is_lenient)?;
            name_below(root, &mut taken.pairs);
            // Single pairs may stand above others; what has frames in folders of its own has been
            // searched.
            let descend = taken
                .pairs
                .iter()
                .all(|pair| matches!(pair.layout, Layout::SceneJson | Layout::PairFolder));
            self.pairs.append(&mut taken.pairs);
            self.alone += taken.alone;
            Ok(descend)
        })?;
        if self.pairs.is_empty() && self.alone == 0 {
            self.pairs = plain::side_by_side_tree(root, self.is_lenient)?;
            name_below(root, &mut self.pairs);
        }
        Ok(())
    }
}

/// Number of pairs of each layout.
pub fn layouts(pairs: &[StoredPair]) -> Vec<(Layout, usize)> {
    let mut counts = std::collections::BTreeMap::new();
    for pair in pairs {
        *counts.entry(pair.layout).or_insert(0) += 1;
    }
    counts.into_iter().collect()
}

/// The first layout that knows the folder.
fn recognised(folder: &Listing, is_lenient: bool) -> Result<Dataset, FrameError> {
    let of = |pairs| Ok(Dataset { pairs, ..Dataset::default() });
    let has_scene = folder.has("scene.json");
    if has_scene && folder.image("left").is_some() && folder.image("right").is_some() {
        match scene_file::stored(&folder.path) {
            Err(_) if is_lenient => {} // the pair says so, when it is loaded
            stored => return of(vec![stored?]),
        }
    }
    for find in [middlebury::find, kitti::find, euroc::find] {
        let pairs = match find(folder) {
            Err(
                FrameError::Layout(_, LayoutFault::MissingCalibration(_)) | FrameError::Decode(..),
            ) if is_lenient => {
                continue;
            }
            found => found?,
        };
        if !pairs.is_empty() {
            return of(pairs);
        }
    }
    let plain = plain::find(folder, is_lenient)?;
    // A scene that lacks its images is an error of its own when it is loaded.
    if plain.pairs.is_empty() && has_scene && !is_lenient && scene_file::has_truth(&folder.path)? {
        return of(vec![scene_file::stored(&folder.path)?]);
    }
    Ok(plain)
}

/// Names as paths below the root; a single pair at the root itself is called as its folder, or as
/// its `scene.json` says.
fn name_below(root: &Path, pairs: &mut [StoredPair]) {
    for pair in pairs {
        let below = pair.folder.strip_prefix(root).unwrap_or(&pair.folder);
        let frame = if pair.layout == Layout::SceneJson { "" } else { pair.name.as_str() };
        let path = below.join(frame).display().to_string();
        let path = path.trim_end_matches('/');
        if !path.is_empty() {
            pair.name = path.to_owned();
            pair.number = numbers(path).last().and_then(|&last| last.try_into().ok());
        } else if pair.name.is_empty() {
            pair.name = folder_name(&pair.folder);
        }
        pair.name = printable(&pair.name).into_owned();
    }
}
