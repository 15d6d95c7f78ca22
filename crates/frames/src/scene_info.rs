//! `scene.json`: what is known of a pair, or of all pairs of a folder, besides the images.
//!
//! ```text
//! { "scene": "desk",                         name
//!   "max_disparity": 64,                     disparities to search, 0 .. this, px
//!   "disparity_zero_px": -5,                 disparity of what is infinitely far: of cameras that look apart
//!   "rectified": { "focal_px": 451, "baseline_m": 0.075,
//!                  "disparity_offset_px": 0,           x_centre_right - x_centre_left
//!                  "principal_point_px": [319.5, 239.5],
//!                  "left_valid_normalized": [0, 0, 1, 1] },   borders of the left image's content: left, top, right, bottom
//!   "ground_truth": { "file": "gt.png", "disparity_scale": 256 },   px = stored value / scale, 0 = unknown; PFM, NPY and NPZ too,
//!   "note": "..." }                                                 where infinite is unknown and 0 is not
//! ```
//!
//! Nothing is needed but both of `focal_px` and `baseline_m` in `rectified`, and `disparity_scale` in `ground_truth`. A key that means nothing
//! is refused, but for those of notes.

use super::error::FrameError;
use crate::untrusted::{self, SETTINGS_BYTES};
use linestereo::{Dims, Rig, Span};
use linestereo_wire::RigUpdate;
use serde::Deserialize;
use serde_json::Value;
use std::path::Path;

const KEYS: [&str; 5] = ["scene", "max_disparity", "disparity_zero_px", "ground_truth", "rectified"];
const TRUTH_KEYS: [&str; 2] = ["file", "disparity_scale"];
const RIG_KEYS: [&str; 5] =
    ["focal_px", "baseline_m", "disparity_offset_px", "principal_point_px", "left_valid_normalized"];
/// Notes of people and of other programs: where frames are from, what else lies beside them.
const NOTES: [&str; 18] = [
    "note",
    "rectified_note",
    "set",
    "size",
    "frames",
    "source",
    "from",
    "terms",
    "licence",
    "license",
    "kind",
    "published",
    "calib",
    "gt",
    "gt_kind",
    "visible",
    "objects",
    "comment",
];
/// No rig is as wide, m; most are of some centimetres, which somebody has in mm.
const MOST_BASELINE_M: f64 = 10.0;

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
    pub(crate) ground_truth: Option<GroundTruthInfo>,
    rectified: Option<RectifiedInfo>,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct GroundTruthInfo {
    pub(crate) file: Option<String>,
    pub(crate) disparity_scale: f32,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
struct RectifiedInfo {
    focal_px: f64,
    baseline_m: f64,
    #[serde(default)]
    disparity_offset_px: f64,
    principal_point_px: Option<[f64; 2]>,
    left_valid_normalized: Option<[f64; 4]>,
}

impl SceneInfo {
    /// The information in a data set's calibration.
    #[must_use]
    pub fn of_rig(rig: RigUpdate, centre: Option<[f64; 2]>, max_disparity: Option<f64>) -> Self {
        let rectified = RectifiedInfo {
            focal_px: rig.focal_px,
            baseline_m: rig.baseline_m,
            disparity_offset_px: rig.offset_px,
            principal_point_px: centre,
            left_valid_normalized: None,
        };
        Self { max_disparity, rectified: Some(rectified), ..Self::default() }
    }

    /// True when pairs of both are matched with the same parameters.
    #[must_use]
    pub fn matches_like(&self, other: &Self) -> bool {
        let of = |info: &Self| (info.max_disparity, info.disparity_zero_px, info.rectified.clone());
        of(self) == of(other)
    }

    /// Reads a `scene.json`.
    pub fn load(path: &Path) -> Result<Self, FrameError> {
        let text =
            untrusted::read(path, SETTINGS_BYTES).map_err(|error| FrameError::Read(path.to_path_buf(), error))?;
        Self::parsed(&text).map_err(|what| FrameError::SceneFile(path.to_path_buf(), what))
    }

    fn parsed(text: &[u8]) -> Result<Self, String> {
        let value: Value = serde_json::from_slice(text).map_err(|error| error.to_string())?;
        check_keys("", &value, &KEYS)?;
        check_keys("ground_truth", &value["ground_truth"], &TRUTH_KEYS)?;
        check_keys("rectified", &value["rectified"], &RIG_KEYS)?;
        let info: Self = serde_json::from_value(value).map_err(|error| error.to_string())?;
        match &info.rectified {
            Some(rectified) => check_baseline(rectified.baseline_m).map(|()| info),
            None => Ok(info),
        }
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
    pub(crate) fn disparity_scale(&self) -> Option<f32> {
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

/// A key that means nothing is a mistake: what it was to say would be missing without a word.
fn check_keys(object: &str, value: &Value, known: &[&str]) -> Result<(), String> {
    let keys = value.as_object().into_iter().flat_map(|fields| fields.keys());
    let Some(key) = keys.into_iter().find(|key| !known.contains(&key.as_str()) && !NOTES.contains(&key.as_str()))
    else {
        return Ok(());
    };
    let places = [("the file itself", &KEYS[..]), ("\"ground_truth\"", &TRUTH_KEYS), ("\"rectified\"", &RIG_KEYS)];
    let right = places.into_iter().find(|(_, keys)| keys.contains(&key.as_str()));
    let at = if object.is_empty() { String::new() } else { format!(" in \"{object}\"") };
    Err(match right {
        Some((place, _)) => format!("\"{key}\"{at} means nothing, it belongs into {place}"),
        None => format!("\"{key}\"{at} means nothing; known are {}, and for notes \"note\"", known.join(", ")),
    })
}

/// Refuses a distance between the cameras that is in other units than metres.
pub fn check_baseline(metres: f64) -> Result<(), String> {
    if metres <= MOST_BASELINE_M || !metres.is_finite() {
        return Ok(());
    }
    let (of_mm, of_cm) = (metres / 1000.0, metres / 100.0);
    Err(format!("a baseline of {metres} m: did you mean mm? then give {of_mm}, for cm {of_cm}"))
}
