//! A pair as a data set stores it -> a [`Scene`]: images, ground truth and rig of one size,
//! whatever the layout.
//!
//! ```text
//! images    two files, or one with both side by side; raw ones are rectified by their rig
//! truth     stored disparities / scale, or floats; a mask, the right image's truth, or the truth
//!           itself says what is visible
//! --width   images by area, truth at pixel centres, range and rig in proportion
//! ```

use super::decode::{check_same_size, check_size, is_16_bit, load_images, load_values};
use super::disparity_file::{is_float_file, load_disparities};
use super::error::{FrameError, LayoutFault};
use super::layout::Layout;
use super::rectified::RectifiedRig;
use super::resample::{WidthError, area_average, resampled_height};
use super::scene_info::SceneInfo;
use super::sequence::PairFiles;
use super::truth::Truth;
use crate::grey::GrayImage;
use linestereo::{Dims, Params, Rig};
use linestereo_wire::RigUpdate;
use std::path::{Path, PathBuf};

/// Derived disparity ranges are multiples of this.
const RANGE_STEP: u16 = 16;

/// A pair with what is known about it, ready for the core.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the scene: from `scene.json`, else the folder's.
    pub name: String,
    /// Its folder.
    pub folder: PathBuf,
    /// Left image, the reference.
    pub left: GrayImage,
    /// Right image.
    pub right: GrayImage,
    /// Disparities to search, 0 .. this, in px.
    pub max_disparity: u16,
    /// Rectified rig, if known.
    pub rig: Option<Rig>,
    /// The numbers behind it.
    pub rig_numbers: Option<RigUpdate>,
    /// Ground truth, if any.
    pub truth: Option<Truth>,
}

/// A pair on disk with everything that is known of it.
#[derive(Clone, Debug)]
pub struct StoredPair {
    /// Its path below the folder that was searched, with the frame's name where a folder holds
    /// several.
    pub name: String,
    /// The last number in that path.
    pub number: Option<u64>,
    /// How it is stored.
    pub layout: Layout,
    /// Its folder.
    pub folder: PathBuf,
    /// Its images.
    pub images: PairFiles,
    pub(crate) truth: Option<StoredTruth>,
    /// Rig of its cameras.
    pub rig: StoredRig,
    /// Disparities to search in the images as stored, px.
    pub(crate) max_disparity: Option<f64>,
}

/// Rig of the cameras, as far as it is known.
#[derive(Clone, Debug, PartialEq)]
pub enum StoredRig {
    /// Nothing.
    Unknown,
    /// Images are rectified; the file that says so, and the rig of the images as stored.
    Rectified(PathBuf, RectifiedRig),
    /// Images are raw: the calibration of both cameras.
    Raw(Vec<RigText>),
}

/// A file with the calibration of raw images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RigText {
    /// Its path; of what is no file of its own, where it is from.
    pub path: PathBuf,
    /// Its content, where it is no file of its own.
    pub text: Option<String>,
}

impl From<PathBuf> for RigText {
    fn from(path: PathBuf) -> Self {
        Self { path, text: None }
    }
}

/// Ground truth of a pair.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StoredTruth {
    pub(crate) file: PathBuf,
    pub(crate) scale: Scale,
    pub(crate) visibility: Visibility,
}

/// Scale of stored values, px; 0 is unknown in images, not in files of floats, which hold px where
/// no steps are given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Scale {
    /// Disparity = value / this.
    Steps(f32),
    /// The same, by the height of the images: rows and steps.
    ByHeight(&'static [(u16, f32)]),
    /// 16 bit: 1/256 px, as KITTI has it. 8 bit do not say.
    SixteenBit,
}

/// Where it is said which true matches are visible in the right image.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Visibility {
    /// A mask: visible is a value above this.
    Mask(PathBuf, u16),
    /// The right image's truth, stored like the left one's.
    RightTruth(PathBuf),
    /// It follows from the truth itself.
    Truth,
}

impl StoredPair {
    /// Two images that stand alone.
    pub fn alone(name: String, images: PairFiles) -> Self {
        let layout = match images {
            PairFiles::Two(_) => Layout::PairFolder,
            PairFiles::SideBySide(_) => Layout::SideBySide,
            PairFiles::Source(ref pair) => pair.layout(),
        };
        // No folder: what stands beside them was not asked for.
        let (folder, rig) = (PathBuf::new(), StoredRig::Unknown);
        Self { name, number: None, layout, folder, images, truth: None, rig, max_disparity: None }
    }

    /// The file with the left image.
    pub fn left(&self) -> &Path {
        self.images.paths()[0]
    }

    /// There is ground truth.
    pub fn has_truth(&self) -> bool {
        self.truth.is_some()
    }

    /// Every file that is read with it.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let truth = self.truth.as_ref().map(|truth| truth.file.as_path());
        let (file, texts) = match &self.rig {
            StoredRig::Unknown => (None, &[][..]),
            StoredRig::Rectified(path, _) => (Some(path.as_path()), &[][..]),
            StoredRig::Raw(texts) => (None, texts.as_slice()),
        };
        let of_raw = texts.iter().filter(|rig| rig.text.is_none()).map(|rig| rig.path.as_path());
        self.images.paths().into_iter().chain(truth).chain(file).chain(of_raw)
    }

    /// Information besides its images: its `scene.json`, or the calibration of its data set.
    pub fn info(&self) -> Result<Option<(PathBuf, SceneInfo)>, FrameError> {
        let file = self.folder.join("scene.json");
        if !self.folder.as_os_str().is_empty() && file.is_file() {
            return SceneInfo::load(&file).map(|info| Some((file, info)));
        }
        let StoredRig::Rectified(path, rig) = &self.rig else { return Ok(None) };
        Ok(Some((path.clone(), SceneInfo::of_rig(rig, self.max_disparity))))
    }

    /// The calibration of its cameras, where it is raw.
    pub fn raw_rig(&self) -> Option<&[RigText]> {
        if let StoredRig::Raw(files) = &self.rig { Some(files) } else { None }
    }

    /// Loads it, reduced to `width` if asked; images are checked against the core's limits after
    /// that. `rectify` makes a rectified pair of a raw one.
    pub fn load(&self, width: Option<u16>, rectify: &RectifyRaw) -> Result<Scene, FrameError> {
        let [left_path, right_path] = self.images.paths();
        let [left, right] = load_images(&self.images, None)?;
        check_same_size((left_path, left.dims), (right_path, right.dims))?;
        let truth =
            self.truth.as_ref().map(|truth| truth.load((left_path, left.dims))).transpose()?;
        let full = left.dims;
        if let Some(asked) = width.filter(|&width| width == 0 || width > full.width) {
            return Err(WidthError { have: full.width, asked }.into());
        }
        let reduced =
            width.map_or(full, |width| Dims { width, height: resampled_height(full, width) });
        let scale = f64::from(reduced.width) / f64::from(full.width);
        let (images, rig_numbers, rig) = match &self.rig {
            StoredRig::Raw(files) => {
                let (images, rig) = rectify(files, reduced, [left, right])?;
                (images, rig.map(|(numbers, _)| numbers), rig.map(|(_, rig)| rig))
            }
            known => {
                let images =
                    [area_average(&left, reduced.width)?, area_average(&right, reduced.width)?];
                let (numbers, rig) = known.at(full, scale)?.unzip();
                (images, numbers, rig)
            }
        };
        let [left, right] = images;
        check_size(left_path, &left)?;
        check_size(right_path, &right)?;
        let truth = truth.map(|truth| width.map_or(truth.clone(), |width| truth.resampled(width)));
        let max_disparity = self.range(left.dims, (width.is_some(), scale), truth.as_ref());
        let (name, folder) = (self.name.clone(), self.folder.clone());
        Ok(Scene { name, folder, left, right, max_disparity, rig, rig_numbers, truth })
    }

    fn range(&self, dims: Dims, (is_reduced, scale): (bool, f64), truth: Option<&Truth>) -> u16 {
        match (self.max_disparity, truth.and_then(Truth::largest)) {
            (Some(range), _) if !is_reduced => range.round() as u16,
            (Some(range), _) => scaled_max_disparity(range, scale),
            // A range of N searches 0 .. N - 1: the largest truth itself has to be inside.
            (None, Some(largest)) => scaled_max_disparity(f64::from(largest.ceil()) + 1.0, 1.0),
            (None, None) => Params::default_max_disparity(dims.width),
        }
    }
}

impl StoredRig {
    /// The rig of rectified images of this size, reduced by `scale`.
    fn at(&self, full: Dims, scale: f64) -> Result<Option<(RigUpdate, Rig)>, FrameError> {
        let Self::Rectified(path, rig) = self else { return Ok(None) };
        rig.check_images(full).map_err(|unfit| FrameError::Unfit(path.clone(), unfit))?;
        let numbers = &rig.numbers;
        let (focal_px, offset_px) = (numbers.focal_px * scale, numbers.offset_px * scale);
        let reduced = RigUpdate { focal_px, offset_px, ..*numbers };
        let rig = reduced.rig().map_err(|error| FrameError::Rig(path.clone(), error))?;
        Ok(Some((reduced, rig)))
    }
}

impl StoredTruth {
    fn load(&self, image: (&Path, Dims)) -> Result<Truth, FrameError> {
        let disparity = self.disparities(&self.file, image)?;
        let dims = image.1;
        Ok(match &self.visibility {
            Visibility::Truth => Truth::with_reprojected_visibility(dims, disparity),
            Visibility::RightTruth(path) => {
                Truth::with_right_truth(dims, disparity, &self.disparities(path, image)?)
            }
            Visibility::Mask(path, above) => {
                let (mask_dims, values) = load_values(path)?;
                check_same_size(image, (path, mask_dims))?;
                Truth::new(
                    dims,
                    disparity,
                    values.into_iter().map(|value| value > *above).collect(),
                )
            }
        })
    }

    fn disparities(&self, path: &Path, image: (&Path, Dims)) -> Result<Vec<f32>, FrameError> {
        if is_float_file(path) {
            let (dims, mut values) = load_disparities(path)?;
            if let Scale::Steps(steps) = self.scale {
                values.iter_mut().for_each(|value| *value /= steps);
            }
            return check_same_size(image, (path, dims)).map(|()| values);
        }
        let (dims, values) = load_values(path)?;
        check_same_size(image, (path, dims))?;
        let scale = match self.scale {
            Scale::Steps(scale) => Some(scale),
            Scale::ByHeight(known) => {
                known.iter().find(|(rows, _)| *rows == dims.height).map(|(_, scale)| *scale)
            }
            Scale::SixteenBit => is_16_bit(path)?.then_some(KITTI_STEPS),
        };
        let scale = scale
            .ok_or_else(|| FrameError::Layout(path.to_path_buf(), LayoutFault::TruthScale(dims)))?;
        Ok(values
            .into_iter()
            .map(|value| if value == 0 { f32::NAN } else { f32::from(value) / scale })
            .collect())
    }
}

/// A disparity range for images reduced by `scale`: rounded up to a multiple of 16.
pub fn scaled_max_disparity(range: f64, scale: f64) -> u16 {
    let steps = (range * scale / f64::from(RANGE_STEP)).ceil().max(1.0);
    (steps as u16).saturating_mul(RANGE_STEP)
}

/// Steps of KITTI's truth per pixel.
pub(crate) const KITTI_STEPS: f32 = 256.0;

/// Both images rectified, and the rig of the rectified view.
pub type RectifiedPair = ([GrayImage; 2], Option<(RigUpdate, Rig)>);

/// Makes a rectified pair of this size of a raw one, by the calibration files of its cameras.
pub type RectifyRaw<'a> =
    dyn Fn(&[RigText], Dims, [GrayImage; 2]) -> Result<RectifiedPair, FrameError> + Sync + 'a;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_multiples_of_sixteen() {
        assert_eq!(scaled_max_disparity(64.0, 0.5), 32);
        assert_eq!(scaled_max_disparity(65.0, 0.5), 48);
        assert_eq!(scaled_max_disparity(3.0, 1.0), 16);
    }
}
