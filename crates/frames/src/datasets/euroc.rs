//! EuRoC's recordings (the ASL layout): `mav0` with `cam0` and `cam1`, or a folder with both.
//!
//! Pairs are images of the same name, which is the time in ns. They are raw: `cam0/sensor.yaml` and
//! `cam1/sensor.yaml` rectify them while they are loaded. There is no ground truth of disparities.
//!
//! # Source
//! Burri et al., "The EuRoC micro aerial vehicle datasets", IJRR 2016. The files' conventions stand
//! in `interchange::euroc`.

use crate::error::{FrameError, LayoutFault};
use crate::folder::Listing;
use crate::layout::Layout;
use crate::sequence::Sequence;
use crate::stored::{RigText, StoredPair, StoredRig};

/// The pairs of a recording; nothing where there is none.
pub(crate) fn find(folder: &Listing) -> Result<Vec<StoredPair>, FrameError> {
    let inner = folder.below("mav0")?;
    let cameras = inner.as_ref().unwrap_or(folder);
    let data = |camera: &str| cameras.path.join(camera).join("data").is_dir();
    if !(cameras.has_folder("cam0") && cameras.has_folder("cam1") && data("cam0") && data("cam1")) {
        return Ok(Vec::new());
    }
    let files = ["cam0", "cam1"].map(|camera| cameras.path.join(camera).join("sensor.yaml"));
    if let Some(missing) = files.iter().find(|path| !path.is_file()) {
        return Err(FrameError::Layout(
            missing.clone(),
            LayoutFault::MissingCalibration(Layout::Euroc),
        ));
    }
    let pairs = Sequence::here(cameras)?.0.pairs.into_iter().map(|pair| StoredPair {
        layout: Layout::Euroc,
        folder: folder.path.clone(),
        rig: StoredRig::Raw(files.clone().map(RigText::from).to_vec()),
        ..StoredPair::alone(pair.name, pair.files)
    });
    Ok(pairs.collect())
}
