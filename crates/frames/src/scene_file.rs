//! Scene folders: `scene.json`, `left.png`, `right.png` and, where there is any, the ground truth.
//!
//! The mask of pixels visible in the right image comes from `visible.png` or `mask_nonocc.png` (0 =
//! hidden), else from `gt_right.png`, else from the truth itself.

use super::error::{FrameError, LayoutFault};
use super::folder::{folder_name, image_path};
use super::layout::Layout;
use super::scene_info::SceneInfo;
use super::sequence::PairFiles;
use super::stored::{Scale, Scene, StoredPair, StoredRig, StoredTruth, Visibility};
use crate::untrusted::printable;
use std::path::Path;

/// The folder's `scene.json` names ground truth.
pub fn has_truth(folder: &Path) -> Result<bool, FrameError> {
    Ok(SceneInfo::load(&folder.join("scene.json"))?.ground_truth.is_some())
}

/// Loads a scene folder, reduced to `width` if asked; images are checked against the core's limits
/// after that.
pub fn load_scene(folder: &Path, width: Option<u16>) -> Result<Scene, FrameError> {
    stored(folder)?.load(width, &|files, _, _| {
        // A scene folder has no raw rig.
        let path = files.first().map(|file| file.path.clone()).unwrap_or_default();
        Err(FrameError::Layout(
            path,
            LayoutFault::RawRig("the folder's images are rectified".to_owned()),
        ))
    })
}

/// Content of a scene folder.
pub(crate) fn stored(folder: &Path) -> Result<StoredPair, FrameError> {
    let info_path = folder.join("scene.json");
    let info = SceneInfo::load(&info_path)?;
    let image = |name| {
        image_path(folder, name).ok_or_else(|| FrameError::NoImage(folder.to_path_buf(), name))
    };
    let truth = stored_truth(folder, &info)?;
    let rig = info.rectified_rig();
    let name = printable(&info.scene.clone().unwrap_or_else(|| folder_name(folder))).into_owned();
    let images = PairFiles::Two([image("left")?, image("right")?]);
    Ok(StoredPair {
        layout: Layout::SceneJson,
        folder: folder.to_path_buf(),
        truth,
        rig: rig.map_or(StoredRig::Unknown, |rig| StoredRig::Rectified(info_path, rig)),
        max_disparity: info.max_disparity,
        ..StoredPair::alone(name, images)
    })
}

fn stored_truth(folder: &Path, info: &SceneInfo) -> Result<Option<StoredTruth>, FrameError> {
    let Some(ground_truth) = &info.ground_truth else { return Ok(None) };
    let scale = ground_truth.disparity_scale;
    if !(scale.is_finite() && scale > 0.0) {
        let what = format!("disparity_scale is {scale}, it has to be above 0");
        return Err(FrameError::SceneFile(folder.join("scene.json"), what));
    }
    let mask = ["visible.png", "mask_nonocc.png"]
        .map(|name| folder.join(name))
        .into_iter()
        .find(|path| path.is_file());
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
    use crate::folder::find_scenes;
    use linestereo::Rig;
    use std::fs;

    #[test]
    fn a_folder_is_read_with_rig_truth_and_visibility() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let grey = |value: u8| {
            image::GrayImage::from_fn(32, 16, |x, y| {
                image::Luma([value.wrapping_add((x * y) as u8)])
            })
        };
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
