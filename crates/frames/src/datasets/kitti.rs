//! KITTI's stereo benchmarks: `training` or `testing` as downloaded.
//!
//! ```text
//! 2012  image_0 image_1 (grey) or colored_0 colored_1    disp_occ disp_noc       calib/000000.txt
//! 2015  image_2 image_3 (colour)                         disp_occ_0 disp_noc_0   calib_cam_to_cam/000000.txt
//! ```
//!
//! Frames are `000000_10.png` with truth and `000000_11.png`, the next one, without. Truth: 16 bit,
//! disparity = value / 256, 0 = unknown. `disp_occ` has every pixel, `disp_noc` those whose match
//! lies inside the right image: they are called visible.
//!
//! # Source
//! readme.txt of `devkit_stereo_flow` (2012) and `devkit_scene_flow` (2015). Geiger, Lenz, Urtasun,
//! CVPR 2012; Menze, Geiger, CVPR 2015.

use super::calibration;
use crate::error::{FrameError, LayoutFault};
use crate::folder::Listing;
use crate::layout::Layout;
use crate::sequence::PairFiles;
use crate::stored::{Scale, StoredPair, StoredRig, StoredTruth, Visibility};
use std::path::PathBuf;

/// Folders of the images, numbers of the cameras, the layout, folders of truth and of calibration.
struct Variant {
    images: [&'static str; 2],
    cameras: [u8; 2],
    layout: Layout,
    truth: [&'static str; 2],
    calibration: &'static str,
}

const GREY_2012: Variant = Variant {
    images: ["image_0", "image_1"],
    cameras: [0, 1],
    layout: Layout::Kitti2012,
    truth: ["disp_occ", "disp_noc"],
    calibration: "calib",
};
const VARIANTS: [Variant; 3] = [
    Variant {
        images: ["image_2", "image_3"],
        cameras: [2, 3],
        layout: Layout::Kitti2015,
        truth: ["disp_occ_0", "disp_noc_0"],
        calibration: "calib_cam_to_cam",
    },
    GREY_2012,
    Variant { images: ["colored_0", "colored_1"], cameras: [2, 3], ..GREY_2012 },
];

/// The frames of the first kind of images that is there; nothing where names are not those of the
/// benchmarks.
pub(crate) fn find(folder: &Listing) -> Result<Vec<StoredPair>, FrameError> {
    for variant in &VARIANTS {
        let (Some(left), Some(right)) =
            (folder.below(variant.images[0])?, folder.below(variant.images[1])?)
        else {
            continue;
        };
        let frames: Vec<&String> = left
            .files
            .iter()
            .filter(|name| scene_number(name).is_some() && right.has(name))
            .collect();
        if frames.is_empty() {
            continue;
        }
        let truth = [folder.below(variant.truth[0])?, folder.below(variant.truth[1])?];
        let calibrations = folder.below(variant.calibration)?;
        let one = |name: &String| {
            frame(folder, variant, name, [&left, &right], &truth, calibrations.as_ref())
        };
        return frames.into_iter().map(one).collect();
    }
    Ok(Vec::new())
}

/// `000000` of `000000_10.png`.
fn scene_number(file: &str) -> Option<&str> {
    let (number, frame) = file.strip_suffix(".png")?.split_once('_')?;
    let digits =
        |text: &str, count| text.len() == count && text.bytes().all(|byte| byte.is_ascii_digit());
    (digits(number, 6) && digits(frame, 2)).then_some(number)
}

fn frame(
    folder: &Listing,
    variant: &Variant,
    file: &str,
    images: [&Listing; 2],
    [all, visible]: &[Option<Listing>; 2],
    calibrations: Option<&Listing>,
) -> Result<StoredPair, FrameError> {
    let calibration = format!("{}.txt", scene_number(file).unwrap_or_default());
    let Some(path) = calibrations.and_then(|listing| listing.file(&calibration)) else {
        let path: PathBuf = folder.path.join(variant.calibration).join(calibration);
        return Err(FrameError::Layout(path, LayoutFault::MissingCalibration(variant.layout)));
    };
    let rig = calibration::kitti(&path, variant.cameras)?;
    let in_folder =
        |listing: &Option<Listing>| listing.as_ref().and_then(|listing| listing.file(file));
    let truth = in_folder(all).map(|truth| StoredTruth {
        file: truth,
        scale: Scale::SixteenBit,
        visibility: in_folder(visible).map_or(Visibility::Truth, |path| Visibility::Mask(path, 0)),
    });
    let images = PairFiles::Two(images.map(|listing| listing.path.join(file)));
    Ok(StoredPair {
        layout: variant.layout,
        folder: folder.path.clone(),
        truth,
        rig: StoredRig::Rectified(path, rig),
        ..StoredPair::alone(file.trim_end_matches(".png").to_owned(), images)
    })
}
