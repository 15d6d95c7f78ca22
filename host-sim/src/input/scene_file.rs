//! Scene folders: `scene.json`, `left.png`, `right.png` and, where there is any, the ground truth.
//!
//! `scene.json` needs nothing; it may hold `scene` (a name), `max_disparity`, `disparity_zero_px`, `ground_truth` (`file`, `disparity_scale`: disparity in
//! px = stored value / scale, 0 = unknown; PFM, NPY and NPZ too, where infinite is unknown and 0 is not) and `rectified` (`focal_px`, `baseline_m`, `disparity_offset_px`, `principal_point_px`,
//! `left_valid_normalized`: left, top, right, bottom border of the left image's content as shares of its sides). What is visible in
//! the right image comes from `visible.png` or `mask_nonocc.png` (0 = hidden), else from `gt_right.png`, else from the truth itself.

use super::error::FrameError;
use super::folder::{folder_name, image_path};
use super::layout::Layout;
use super::sequence::PairFiles;
use super::stored::{Scale, Scene, StoredPair, StoredRig, StoredTruth, Visibility};
use linestereo::{Dims, Rig, Span};
use linestereo_wire::RigUpdate;
use serde::Deserialize;
use std::fs;
use std::path::Path;

/// Content of `scene.json`; fields it does not have are `None`.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct SceneInfo {
    /// Name of the scene.
    pub scene: Option<String>,
    /// Disparities to search, 0 .. this, in px.
    pub max_disparity: Option<f64>,
    /// Disparity of what is infinitely far, in px of the images as stored: what cameras that do not look in the same direction have.
    #[serde(default)]
    pub disparity_zero_px: f64,
    ground_truth: Option<GroundTruthInfo>,
    rectified: Option<RectifiedInfo>,
}

#[derive(Clone, Debug, Deserialize)]
struct GroundTruthInfo {
    file: Option<String>,
    disparity_scale: f32,
}

#[derive(Clone, Debug, Deserialize)]
struct RectifiedInfo {
    focal_px: f64,
    baseline_m: f64,
    #[serde(default)]
    disparity_offset_px: f64,
    principal_point_px: Option<[f64; 2]>,
    left_valid_normalized: Option<[f64; 4]>,
}

impl SceneInfo {
    /// Reads a `scene.json`.
    pub fn load(path: &Path) -> Result<Self, FrameError> {
        let text = fs::read(path).map_err(|error| FrameError::Read(path.to_path_buf(), error))?;
        serde_json::from_slice(&text).map_err(|error| FrameError::SceneFile(path.to_path_buf(), error.to_string()))
    }

    /// The rig for images reduced by `scale` (1 = as stored), `None` when the file has none.
    pub fn rig(&self, path: &Path, scale: f64) -> Result<Option<Rig>, FrameError> {
        let Some(numbers) = self.rig_numbers(scale) else { return Ok(None) };
        numbers.rig().map(Some).map_err(|error| FrameError::Rig(path.to_path_buf(), error))
    }

    /// Of each row of a left image of this size the pixels with content; `None` when all have.
    #[must_use]
    pub fn left_content(&self, dims: Dims) -> Option<Vec<Span>> {
        let [left, top, right, bottom] = self.rectified.as_ref()?.left_valid_normalized?;
        let [width, height] = [dims.width, dims.height].map(f64::from);
        let within = |value: f64, side: f64| value.clamp(0.0, side) as u16;
        let span = Span {
            start: within((left * width).ceil(), width),
            end: within((right * width).floor(), width).max(within((left * width).ceil(), width)),
        };
        let rows = within((top * height).ceil(), height)..within((bottom * height).floor(), height);
        Some((0..dims.height).map(|y| if rows.contains(&y) { span } else { Span::default() }).collect())
    }

    /// Principal point of the left image reduced by `scale`, px.
    #[must_use]
    pub fn principal_point(&self, scale: f64) -> Option<[f64; 2]> {
        let stored = self.rectified.as_ref()?.principal_point_px?;
        Some(stored.map(|value| (value + 0.5) * scale - 0.5))
    }

    /// Stored ground truth values per px, where the file says so.
    pub(super) fn disparity_scale(&self) -> Option<f32> {
        let scale = self.ground_truth.as_ref()?.disparity_scale;
        (scale.is_finite() && scale > 0.0).then_some(scale)
    }

    /// The numbers behind [`SceneInfo::rig`], for a board.
    #[must_use]
    pub fn rig_numbers(&self, scale: f64) -> Option<RigUpdate> {
        self.rectified.as_ref().map(|rectified| RigUpdate {
            focal_px: rectified.focal_px * scale,
            baseline_m: rectified.baseline_m,
            offset_px: rectified.disparity_offset_px * scale,
        })
    }
}

/// The folder's `scene.json` names ground truth.
pub fn has_truth(folder: &Path) -> Result<bool, FrameError> {
    Ok(SceneInfo::load(&folder.join("scene.json"))?.ground_truth.is_some())
}

/// Loads a scene folder, reduced to `width` if asked; images are checked against the core's limits after that.
pub fn load_scene(folder: &Path, width: Option<u16>) -> Result<Scene, FrameError> {
    stored(folder)?.load(width)
}

/// Content of a scene folder.
pub(super) fn stored(folder: &Path) -> Result<StoredPair, FrameError> {
    let info_path = folder.join("scene.json");
    let info = SceneInfo::load(&info_path)?;
    let image = |name| image_path(folder, name).ok_or_else(|| FrameError::NoImage(folder.to_path_buf(), name));
    let truth = stored_truth(folder, &info)?;
    let rig = info.rig_numbers(1.0);
    Ok(StoredPair {
        name: info.scene.clone().unwrap_or_else(|| folder_name(folder)),
        layout: Layout::SceneJson,
        folder: folder.to_path_buf(),
        images: PairFiles::Two([image("left")?, image("right")?]),
        truth,
        rig: rig.map_or(StoredRig::Unknown, |rig| StoredRig::Rectified(info_path, rig)),
        max_disparity: info.max_disparity,
    })
}

fn stored_truth(folder: &Path, info: &SceneInfo) -> Result<Option<StoredTruth>, FrameError> {
    let Some(ground_truth) = &info.ground_truth else { return Ok(None) };
    let scale = ground_truth.disparity_scale;
    if !(scale.is_finite() && scale > 0.0) {
        let what = format!("disparity_scale is {scale}, it has to be above 0");
        return Err(FrameError::SceneFile(folder.join("scene.json"), what));
    }
    let mask = ["visible.png", "mask_nonocc.png"].map(|name| folder.join(name)).into_iter().find(|path| path.is_file());
    let right = Some(folder.join("gt_right.png")).filter(|path| path.is_file());
    Ok(Some(StoredTruth {
        file: folder.join(ground_truth.file.as_deref().unwrap_or("gt.png")),
        scale: Scale::Steps(scale),
        visibility: match (mask, right) {
            (Some(mask), _) => Visibility::Mask(mask, 0),
            (None, Some(right)) => Visibility::RightTruth(right),
            (None, None) => Visibility::Truth,
        },
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::find_scenes;

    #[test]
    fn a_folder_is_read_with_rig_truth_and_visibility() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let grey =
            |value: u8| image::GrayImage::from_fn(32, 16, |x, y| image::Luma([value.wrapping_add((x * y) as u8)]));
        grey(3).save(at("left.png")).unwrap();
        grey(5).save(at("right.pgm")).unwrap();
        let truth = image::ImageBuffer::<image::Luma<u16>, Vec<u16>>::from_fn(32, 16, |x, _| {
            image::Luma([if x == 0 { 0 } else { 640 }])
        });
        truth.save(at("gt.png")).unwrap();
        let json = r#"{"scene":"s","ground_truth":{"disparity_scale":64},
            "rectified":{"focal_px":100,"baseline_m":0.1,"disparity_offset_px":2}}"#;
        fs::write(at("scene.json"), json).unwrap();

        let scene = load_scene(folder.path(), None).unwrap();
        assert_eq!((scene.name.as_str(), scene.max_disparity), ("s", 16));
        assert_eq!(scene.rig, Some(Rig::new(100.0, 0.1, 2.0).unwrap()));
        let truth = scene.truth.unwrap();
        assert_eq!((truth.disparity(0, 0), truth.disparity(1, 0)), (None, Some(10.0)));
        assert!(!truth.is_visible(9, 3) && truth.is_visible(10, 3));

        let half = load_scene(folder.path(), Some(16));
        assert!(matches!(half, Err(FrameError::Size(..)))); // 16x8
        assert_eq!(find_scenes(folder.path()).unwrap(), [folder.path()]);
    }
}
