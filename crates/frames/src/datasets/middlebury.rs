//! Middlebury's scenes of 2001 to 2021, the third version of its benchmark, and ETH3D's two-view
//! scenes, which are stored like it.
//!
//! ```text
//! 2001       im2 im6 disp2 disp6 (steps of 1/8 px); tsukuba: scene1.row3.col3, .col4,
//!            truedisp.row3.col3 (1/16); map: im0 im1 disp0 (1/8)
//! 2003       the same names: 1800x1500 (1), 900x750 (1/2), 450x375 (1/4 px)
//! 2005/2006  view1 view5 disp1 disp5, 1110 rows (1), 555 (1/2), 370 (1/3 px); dmin.txt: least
//!            disparity at full size, focal 3740 px, 160 mm; with all exposures:
//!            Illum1..3/Exp0..2/view1, a pair for each
//! 2014/2021  im0 im1 disp0.pfm disp1.pfm calib.txt
//! version 3  im0 im1 disp0GT.pfm mask0nocc.png calib.txt: 255 = visible, 128 = hidden
//! ETH3D      the same and cameras.txt; the truth there, or in two_view_training_gt beside
//!            two_view_training
//! ```
//!
//! Visibility is told by the mask, else by the right image's truth, else by the truth itself.
//!
//! # Source
//! `vision.middlebury.edu/stereo/data/` (pages of 2001, 2003, 2005, 2006, 2014, 2021) and
//! `/submit3/`; `www.eth3d.net/documentation`. In 2005/2006 depth = 3740 px * 0.16 m / (disparity +
//! dmin), both scaled with the images.

use super::calibration;
use crate::decode::dimensions;
use crate::error::{FrameError, LayoutFault};
use crate::folder::Listing;
use crate::layout::Layout;
use crate::rectified::RectifiedRig;
use crate::sequence::PairFiles;
use crate::stored::{Scale, StoredPair, StoredRig, StoredTruth, Visibility};
use linestereo_wire::RigUpdate;
use std::path::{Path, PathBuf};

const STEPS_2001: f32 = 8.0;
const STEPS_TSUKUBA: f32 = 16.0;
/// Rows of the images and steps per pixel.
const STEPS_2003: &[(u16, f32)] = &[(1500, 1.0), (750, 2.0), (375, 4.0)];
const STEPS_2006: &[(u16, f32)] = &[(1110, 1.0), (555, 2.0), (370, 3.0)];
const FOCAL_2006_PX: f64 = 3740.0;
const BASELINE_2006_M: f64 = 0.16;
/// A mask's value of what the right image sees; 128 is hidden.
const HIDDEN: u16 = 128;

/// The scene in this folder, or its exposures; nothing where it is none.
pub(crate) fn find(folder: &Listing) -> Result<Vec<StoredPair>, FrameError> {
    if let (Some(left), Some(right)) = (folder.image("im0"), folder.image("im1")) {
        return Ok(calibrated(folder, [left, right])?.into_iter().collect());
    }
    if let (Some(left), Some(right)) = (folder.image("im2"), folder.image("im6")) {
        return Ok(by_steps(folder, [left, right])?.into_iter().collect());
    }
    if let (Some(left), Some(right)) =
        (folder.image("scene1.row3.col3"), folder.image("scene1.row3.col4"))
    {
        let truth = folder
            .image("truedisp.row3.col3")
            .map(|file| stored(file, None, Scale::Steps(STEPS_TSUKUBA)));
        return Ok(vec![pair(folder, Layout::Middlebury2001, [left, right], truth)]);
    }
    views(folder)
}

/// 2014 and later, and ETH3D; `map` of 2001.
fn calibrated(folder: &Listing, images: [PathBuf; 2]) -> Result<Option<StoredPair>, FrameError> {
    let is_eth3d = folder.has("cameras.txt") && folder.has("images.txt");
    let layout = if is_eth3d { Layout::Eth3d } else { Layout::Middlebury2014 };
    let truth = [folder.file("disp0GT.pfm"), folder.file("disp0.pfm")].into_iter().flatten().next();
    if !folder.has("calib.txt") {
        if truth.is_some() || is_eth3d {
            let fault = LayoutFault::MissingCalibration(layout);
            return Err(FrameError::Layout(folder.path.join("calib.txt"), fault));
        }
        let truth = folder
            .image("disp0")
            .map(|file| stored(file, folder.image("disp1"), Scale::Steps(STEPS_2001)));
        return Ok(truth.map(|truth| pair(folder, Layout::Middlebury2001, images, Some(truth))));
    }
    let path = folder.path.join("calib.txt");
    let calibration = calibration::middlebury(&path)?;
    let beside = beside_training(&folder.path);
    let truth =
        truth.or_else(|| Some(beside.as_ref()?.join("disp0GT.pfm")).filter(|path| path.is_file()));
    let truth = truth.map(|file| {
        let mask = file.with_file_name("mask0nocc.png");
        let right = folder.file("disp1GT.pfm").or_else(|| folder.file("disp1.pfm"));
        let visibility = if mask.is_file() {
            Visibility::Mask(mask, HIDDEN)
        } else {
            right.map_or(Visibility::Truth, Visibility::RightTruth)
        };
        StoredTruth { file, scale: Scale::SixteenBit, visibility }
    });
    Ok(Some(StoredPair {
        rig: StoredRig::Rectified(path, calibration.rig),
        max_disparity: calibration.range,
        ..pair(folder, layout, images, truth)
    }))
}

/// `two_view_training_gt/scene` of `two_view_training/scene`.
fn beside_training(scene: &Path) -> Option<PathBuf> {
    let set = scene.parent()?;
    let name = set.file_name()?.to_str()?;
    Some(set.with_file_name(format!("{name}_gt")).join(scene.file_name()?))
}

/// 2001 and 2003.
fn by_steps(folder: &Listing, images: [PathBuf; 2]) -> Result<Option<StoredPair>, FrameError> {
    let Some(file) = folder.image("disp2") else { return Ok(None) };
    let (_, rows) = dimensions(&images[0])?;
    let is_2003 = STEPS_2003.iter().any(|(known, _)| u32::from(*known) == rows);
    let (layout, scale) = if is_2003 {
        (Layout::Middlebury2003, Scale::ByHeight(STEPS_2003))
    } else {
        (Layout::Middlebury2001, Scale::Steps(STEPS_2001))
    };
    Ok(Some(pair(folder, layout, images, Some(stored(file, folder.image("disp6"), scale)))))
}

/// 2005 and 2006.
fn views(folder: &Listing) -> Result<Vec<StoredPair>, FrameError> {
    let truth = folder.image("disp1");
    let mut found: Vec<(String, [PathBuf; 2])> = Vec::new();
    if let (Some(left), Some(right)) = (folder.image("view1"), folder.image("view5")) {
        found.push((String::new(), [left, right]));
    } else if truth.is_some() {
        for light in folder.folders.iter().filter(|name| name.starts_with("Illum")) {
            let Some(light_folder) = folder.below(light)? else { continue };
            for exposure in light_folder.folders.iter().filter(|name| name.starts_with("Exp")) {
                let Some(images) = light_folder.below(exposure)? else { continue };
                if let (Some(left), Some(right)) = (images.image("view1"), images.image("view5")) {
                    found.push((format!("{light}/{exposure}"), [left, right]));
                }
            }
        }
    }
    if found.is_empty() {
        return Ok(Vec::new());
    }
    let path = folder.path.join("dmin.txt");
    if !folder.has("dmin.txt") {
        return Err(FrameError::Layout(
            path,
            LayoutFault::MissingCalibration(Layout::Middlebury2006),
        ));
    }
    let least = calibration::single_number(&path, "the least disparity")?;
    let (_, rows) = dimensions(&found[0].1[0])?;
    // Images of another height have been resized by somebody: their truth has no known scale, nor
    // have they a focal length.
    let steps = STEPS_2006
        .iter()
        .find(|(known, _)| u32::from(*known) == rows)
        .map(|(_, steps)| f64::from(*steps));
    let rig = steps.map_or(StoredRig::Unknown, |steps| {
        let numbers = RigUpdate {
            focal_px: FOCAL_2006_PX / steps,
            baseline_m: BASELINE_2006_M,
            offset_px: least / steps,
        };
        StoredRig::Rectified(path, RectifiedRig { numbers, centre_px: None, size: None })
    });
    let truth = truth.map(|file| stored(file, folder.image("disp5"), Scale::ByHeight(STEPS_2006)));
    let one = |(name, images)| StoredPair {
        name,
        rig: rig.clone(),
        ..pair(folder, Layout::Middlebury2006, images, truth.clone())
    };
    Ok(found.into_iter().map(one).collect())
}

fn stored(file: PathBuf, right: Option<PathBuf>, scale: Scale) -> StoredTruth {
    StoredTruth { file, scale, visibility: right.map_or(Visibility::Truth, Visibility::RightTruth) }
}

fn pair(
    folder: &Listing,
    layout: Layout,
    images: [PathBuf; 2],
    truth: Option<StoredTruth>,
) -> StoredPair {
    let alone = StoredPair::alone(String::new(), PairFiles::Two(images));
    StoredPair { layout, folder: folder.path.clone(), truth, ..alone }
}
