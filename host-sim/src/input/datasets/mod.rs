//! Folders of stereo pairs as data sets and recorders store them: which layout it is, told from names alone, and the pairs in it.
//!
//! ```text
//! Dataset::find(root):
//!   a folder is taken by the first layout that knows its files:
//!     scene.json   left.*, right.* and scene.json                      this project's own, see `scene`
//!     middlebury   im2 + im6, view1 + view5, im0 + im1 + calib.txt     2001 to 2021, the benchmark's version 3, ETH3D's two-view sets
//!     kitti        image_2 + image_3 (or 0 + 1) with 000000_10.png     2012 and 2015
//!     euroc        mav0/cam0/data + mav0/cam1/data                     raw: rectified while loading
//!     plain        left/ + right/; 0001_left + 0001_right; left + right; sequences of them
//!   folders below it are searched where nothing took it, and below single pairs
//!   in a tree without any pair, images at least twice as wide as high hold both views side by side
//! ```
//!
//! Only names and small text files are read here; images when a pair is loaded. Each layout's module says where its rules are from.

mod calibration;
mod euroc;
mod kitti;
mod middlebury;
mod plain;

use super::stored::StoredPair;
use super::{FrameError, scene};
use core::fmt;
use linestereo::Dims;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Layouts that are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layout {
    /// A folder with `scene.json`.
    SceneJson,
    /// `im2.ppm`, `im6.ppm`, `disp2.pgm`; `tsukuba` and `map` have names of their own.
    Middlebury2001,
    /// `im2.png`, `im6.png`, `disp2.png` of cones and teddy.
    Middlebury2003,
    /// `view1.png`, `view5.png`, `disp1.png`, `dmin.txt`: 2005 and 2006.
    Middlebury2006,
    /// `im0.png`, `im1.png`, `disp0.pfm` or `disp0GT.pfm`, `calib.txt`: 2014, 2021 and version 3 of the benchmark.
    Middlebury2014,
    /// The same with COLMAP's `cameras.txt`.
    Eth3d,
    /// `image_0`, `image_1` or `colored_0`, `colored_1`, `disp_occ`, `calib`.
    Kitti2012,
    /// `image_2`, `image_3`, `disp_occ_0`, `calib_cam_to_cam`.
    Kitti2015,
    /// `mav0/cam0/data`, `mav0/cam1/data` with a `sensor.yaml` each.
    Euroc,
    /// A folder for each camera with the same names in both.
    CameraFolders,
    /// One folder, the side in each name.
    SidesInNames,
    /// A folder with `left` and `right`.
    PairFolder,
    /// One image for both views.
    SideBySide,
}

impl Layout {
    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SceneJson => "scene.json",
            Self::Middlebury2001 => "Middlebury 2001",
            Self::Middlebury2003 => "Middlebury 2003",
            Self::Middlebury2006 => "Middlebury 2005/2006",
            Self::Middlebury2014 => "Middlebury 2014-2021",
            Self::Eth3d => "ETH3D two-view",
            Self::Kitti2012 => "KITTI 2012",
            Self::Kitti2015 => "KITTI 2015",
            Self::Euroc => "EuRoC",
            Self::CameraFolders => "a folder for each camera",
            Self::SidesInNames => "the side in each name",
            Self::PairFolder => "a folder for each pair",
            Self::SideBySide => "side by side",
        }
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Why a folder of a known layout cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LayoutFault {
    /// No layout fits.
    NotRecognised,
    /// A layout that has a calibration lacks its file.
    MissingCalibration(Layout),
    /// A calibration file lacks this, or it is no number.
    Calibration(&'static str),
    /// A raw pair cannot be rectified.
    RawRig(String),
    /// The values of a truth image of this size mean nothing known.
    TruthScale(Dims),
}

impl fmt::Display for LayoutFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotRecognised => f.write_str(
                "no pair in a layout that is known; give Middlebury, KITTI, ETH3D or EuRoC folders as downloaded, left/ and right/, \
                 0001_left.png and 0001_right.png, or images side by side",
            ),
            Self::MissingCalibration(layout) => write!(
                f,
                "the calibration is missing, which {layout} has; add the file from the data set's download, or rename the images to \
                 left.png and right.png to match them without depths"
            ),
            Self::Calibration(what) => write!(f, "{what} is missing or no number; take the file from the download again"),
            Self::RawRig(what) => write!(f, "the raw pair cannot be rectified by this calibration ({what}); correct it"),
            Self::TruthScale(dims) => write!(
                f,
                "nothing says what a grey value of this ground truth of {dims} is in px; store 16 bit (value / 256), PFM or NPZ, \
                 or add a scene.json with disparity_scale"
            ),
        }
    }
}

/// The pairs of a folder, whatever their layout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dataset {
    /// Sorted by folder, then by number.
    pub pairs: Vec<StoredPair>,
    /// Images without a partner.
    pub alone: usize,
}

impl Dataset {
    /// Finds every pair at or below `root`.
    pub fn find(root: &Path) -> Result<Self, FrameError> {
        let mut found = Self::default();
        found.search(root, root)?;
        if found.pairs.is_empty() {
            found.pairs = plain::side_by_side_tree(root)?;
            name_below(root, &mut found.pairs);
        }
        if found.pairs.is_empty() {
            return Err(FrameError::Layout(root.to_path_buf(), LayoutFault::NotRecognised));
        }
        Ok(found)
    }

    /// How many pairs each layout has.
    #[must_use]
    pub fn layouts(&self) -> Vec<(Layout, usize)> {
        let mut counts = std::collections::BTreeMap::new();
        for pair in &self.pairs {
            *counts.entry(pair.layout).or_insert(0) += 1;
        }
        counts.into_iter().collect()
    }

    fn search(&mut self, root: &Path, path: &Path) -> Result<(), FrameError> {
        let folder = Listing::read(path)?;
        let mut taken = recognised(&folder)?;
        name_below(root, &mut taken.pairs);
        // Single pairs may stand above others; what has frames in folders of its own has been searched.
        let descend = taken.pairs.iter().all(|pair| matches!(pair.layout, Layout::SceneJson | Layout::PairFolder));
        self.pairs.append(&mut taken.pairs);
        self.alone += taken.alone;
        if descend {
            for name in &folder.folders {
                self.search(root, &path.join(name))?;
            }
        }
        Ok(())
    }
}

/// The first layout that knows the folder.
fn recognised(folder: &Listing) -> Result<Dataset, FrameError> {
    let of = |pairs| Ok(Dataset { pairs, alone: 0 });
    let has_scene = folder.has("scene.json");
    if has_scene && folder.image("left").is_some() && folder.image("right").is_some() {
        return of(vec![scene::stored(&folder.path)?]);
    }
    for find in [middlebury::find, kitti::find, euroc::find] {
        let pairs = find(folder)?;
        if !pairs.is_empty() {
            return of(pairs);
        }
    }
    let plain = plain::find(folder)?;
    // A scene that lacks its images is an error of its own when it is loaded.
    if plain.pairs.is_empty() && has_scene && scene::has_truth(&folder.path)? {
        return of(vec![scene::stored(&folder.path)?]);
    }
    Ok(plain)
}

/// Names as paths below the root; a single pair at the root itself is called as its folder, or as its `scene.json` says.
fn name_below(root: &Path, pairs: &mut [StoredPair]) {
    for pair in pairs {
        let below = pair.folder.strip_prefix(root).unwrap_or(&pair.folder);
        let frame = if pair.layout == Layout::SceneJson { "" } else { pair.name.as_str() };
        let path = below.join(frame).display().to_string();
        let path = path.trim_end_matches('/');
        if !path.is_empty() {
            pair.name = path.to_owned();
        } else if pair.name.is_empty() {
            pair.name = folder_name(&pair.folder);
        }
    }
}

pub(super) fn folder_name(folder: &Path) -> String {
    let name = |folder: &Path| folder.file_name().map(|name| name.to_string_lossy().into_owned());
    // "." has no name of its own.
    name(folder).or_else(|| name(&folder.canonicalize().ok()?)).unwrap_or_default()
}

/// The names in a folder.
struct Listing {
    path: PathBuf,
    files: BTreeSet<String>,
    folders: BTreeSet<String>,
}

impl Listing {
    fn read(path: &Path) -> Result<Self, FrameError> {
        let read_error = |error| FrameError::Read(path.to_path_buf(), error);
        let (mut files, mut folders) = (BTreeSet::new(), BTreeSet::new());
        for entry in fs::read_dir(path).map_err(read_error)? {
            let entry = entry.map_err(read_error)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            // Links are followed.
            let kind = entry.file_type().map_err(read_error)?;
            let is_folder = if kind.is_symlink() { entry.path().is_dir() } else { kind.is_dir() };
            if is_folder {
                folders.insert(name)
            } else {
                files.insert(name)
            };
        }
        Ok(Self { path: path.to_path_buf(), files, folders })
    }

    fn has(&self, file: &str) -> bool {
        self.files.contains(file)
    }

    fn has_folder(&self, folder: &str) -> bool {
        self.folders.contains(folder)
    }

    fn file(&self, name: &str) -> Option<PathBuf> {
        self.has(name).then(|| self.path.join(name))
    }

    /// The image of this name, whatever its format.
    fn image(&self, stem: &str) -> Option<PathBuf> {
        scene::IMAGE_EXTENSIONS.iter().find_map(|extension| self.file(&format!("{stem}.{extension}")))
    }

    /// The disparities of this name: floats before images.
    fn disparities(&self, stem: &str) -> Option<PathBuf> {
        ["pfm", "npz", "npy", "png", "pgm"].iter().find_map(|extension| self.file(&format!("{stem}.{extension}")))
    }

    /// The folder of this name below it.
    fn below(&self, folder: &str) -> Result<Option<Self>, FrameError> {
        self.has_folder(folder).then(|| Self::read(&self.path.join(folder))).transpose()
    }
}
