//! `scene.json`: what is known of a pair, or of all pairs of a folder, besides the images.
//!
//! ```text
//! { "scene": "desk",                         name
//!   "size": [640, 480],                      of the images that all px here are of; "640x480" too
//!   "max_disparity": 64,                     disparities to search, 0 .. this, px
//!   "disparity_zero_px": -5,                 disparity of what is infinitely far: of cameras that
//!                                            look apart
//!   "rectified": { "focal_px": 451, "baseline_m": 0.075,
//!                  "disparity_offset_px": 0,           x_centre_right - x_centre_left: minus disparity_zero_px
//!                  "principal_point_px": [319.5, 239.5],
//!                  "left_valid_normalized": [0, 0, 1, 1] },   borders of the left image's content: left, top, right, bottom
//!   "camera": { "height_m": 0.15, "pitch_deg": 5, "roll_deg": 0 },    how it stands above the ground
//!   "ground_truth": { "file": "gt.png", "disparity_scale": 256 },   px = stored value / scale, 0 = unknown; PFM, NPY and NPZ too,
//!   "note": "..." }                                                 where infinite is unknown and 0 is not
//! ```
//!
//! Nothing is needed but both of `focal_px` and `baseline_m` in `rectified`, and `disparity_scale`
//! in `ground_truth`. A key that is a known one in the wrong place or written wrongly is refused,
//! others are notes; a file without any of these keys is no scene. Images of another size than
//! `size` are refused.

use super::error::FrameError;
use crate::rectified::{RectifiedRig, Unfit, check_baseline, check_centre_of};
use crate::untrusted::{self, SETTINGS_BYTES};
use linestereo::{Dims, Rig, ground::CameraPose, image::Span};
use linestereo_wire::RigUpdate;
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use std::path::Path;

const KEYS: [&str; 7] =
    ["scene", "size", "max_disparity", "disparity_zero_px", "ground_truth", "rectified", "camera"];
const CAMERA_KEYS: [&str; 3] = ["height_m", "pitch_deg", "roll_deg"];
const TRUTH_KEYS: [&str; 2] = ["file", "disparity_scale"];
const RIG_KEYS: [&str; 5] = [
    "focal_px", "baseline_m", "disparity_offset_px", "principal_point_px", "left_valid_normalized",
];
/// Letters that a key may differ by from a known one to be that one, written wrongly; in keys of
/// fewer than five letters that would be another word.
const MISSPELT: usize = 2;
/// Largest difference between `disparity_offset_px` and minus `disparity_zero_px`, px: they are the
/// same number.
const SAME_OFFSET_PX: f64 = 0.01;

/// Content of `scene.json`; fields it does not have are `None`.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct SceneInfo {
    /// Name of the scene.
    pub scene: Option<String>,
    #[serde(default, deserialize_with = "size")]
    pub(crate) size: Option<Dims>,
    /// Disparities to search, 0 .. this, in px.
    pub max_disparity: Option<f64>,
    /// Disparity of what is infinitely far, in px of the images as stored: what cameras that do not
    /// look in the same direction have.
    #[serde(default)]
    pub disparity_zero_px: f64,
    pub(crate) ground_truth: Option<GroundTruthInfo>,
    rectified: Option<RectifiedInfo>,
    camera: Option<CameraInfo>,
}

/// How the left camera stands above the ground; of other programs some numbers may be missing.
#[derive(Clone, Copy, Debug, Deserialize)]
struct CameraInfo {
    height_m: Option<f32>,
    pitch_deg: Option<f32>,
    /// Counter-clockwise as it looks, as rendered sets have it.
    #[serde(default)]
    roll_deg: f32,
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
    disparity_offset_px: Option<f64>,
    principal_point_px: Option<[f64; 2]>,
    left_valid_normalized: Option<[f64; 4]>,
}

impl SceneInfo {
    /// The information in a data set's calibration.
    pub fn of_rig(rig: &RectifiedRig, max_disparity: Option<f64>) -> Self {
        let rectified = RectifiedInfo {
            focal_px: rig.numbers.focal_px,
            baseline_m: rig.numbers.baseline_m,
            disparity_offset_px: Some(rig.numbers.offset_px),
            principal_point_px: rig.centre_px,
            left_valid_normalized: None,
        };
        Self { size: rig.size, max_disparity, rectified: Some(rectified), ..Self::default() }
    }

    /// True when pairs of both are matched with the same parameters.
    pub fn matches_like(&self, other: &Self) -> bool {
        let of = |info: &Self| {
            (info.size, info.max_disparity, info.disparity_zero_px, info.rectified.clone())
        };
        of(self) == of(other)
    }

    /// Reads a `scene.json`.
    pub fn load(path: &Path) -> Result<Self, FrameError> {
        let text = untrusted::read(path, SETTINGS_BYTES)
            .map_err(|error| FrameError::Read(path.to_path_buf(), error))?;
        Self::parsed(&text).map_err(|what| FrameError::SceneFile(path.to_path_buf(), what))
    }

    fn parsed(text: &[u8]) -> Result<Self, String> {
        let value: Value = serde_json::from_slice(text).map_err(|error| error.to_string())?;
        check_keys("", &value, &KEYS)?;
        let is_known = |key: &String| KEYS.contains(&key.as_str()) || key == "note";
        if value
            .as_object()
            .is_some_and(|fields| !fields.is_empty() && !fields.keys().any(is_known))
        {
            return Err(format!("it has none of the keys {}, note", KEYS.join(", ")));
        }
        check_keys("ground_truth", &value["ground_truth"], &TRUTH_KEYS)?;
        check_keys("rectified", &value["rectified"], &RIG_KEYS)?;
        check_keys("camera", &value["camera"], &CAMERA_KEYS)?;
        let info: Self = serde_json::from_value(value).map_err(|error| error.to_string())?;
        if let Some(rectified) = &info.rectified {
            check_baseline(rectified.baseline_m).map_err(|unfit| unfit.to_string())?;
            if let (Some(centre), Some(size)) = (rectified.principal_point_px, info.size) {
                check_centre_of(centre, size).map_err(|unfit| unfit.to_string())?;
            }
            let (zero, offset) = (info.disparity_zero_px, rectified.disparity_offset_px);
            if let Some(offset) =
                offset.filter(|offset| zero != 0.0 && (offset + zero).abs() > SAME_OFFSET_PX)
            {
                return Err(format!(
                    "disparity_offset_px is {offset} and disparity_zero_px {zero}: one is minus \
                     the other; remove the wrong one"
                ));
            }
        }
        Ok(info)
    }

    /// Refuses images of another size than these numbers are of, before they are reduced.
    ///
    /// # Errors
    /// The images have another size, or the numbers cannot be of images of this size.
    pub fn check_images(&self, images: Dims) -> Result<(), Unfit> {
        match (self.rectified_rig(), self.size) {
            (Some(rig), _) => rig.check_images(images),
            (None, Some(of)) if of != images => Err(Unfit::Size { of, images }),
            (None, _) => Ok(()),
        }
    }

    /// How the left camera stands above the ground, where height and pitch are said: rolled
    /// clockwise, the file counter-clockwise.
    pub fn pose(&self) -> Option<CameraPose> {
        let CameraInfo { height_m, pitch_deg, roll_deg } = self.camera?;
        Some(CameraPose { height_m: height_m?, pitch_deg: pitch_deg?, roll_deg: -roll_deg })
    }

    /// Of height and pitch one alone is said, which is no pose.
    pub fn has_half_pose(&self) -> bool {
        self.camera.is_some_and(|camera| camera.height_m.is_some() != camera.pitch_deg.is_some())
    }

    /// The rig of the images as stored, before the gate.
    pub(crate) fn rectified_rig(&self) -> Option<RectifiedRig> {
        let numbers = self.rig_numbers(1.0)?;
        let centre_px = self.rectified.as_ref().and_then(|rectified| rectified.principal_point_px);
        Some(RectifiedRig { numbers, centre_px, size: self.size })
    }

    /// The rig for images reduced by `scale` (1 = as stored), `None` when the file has none.
    pub fn rig(&self, path: &Path, scale: f64) -> Result<Option<Rig>, FrameError> {
        let Some(numbers) = self.rig_numbers(scale) else { return Ok(None) };
        numbers.rig().map(Some).map_err(|error| FrameError::Rig(path.to_path_buf(), error))
    }

    /// Of each row of a left image of this size the pixels with content; `None` when all have.
    pub fn left_content(&self, dims: Dims) -> Option<Vec<Span>> {
        let [left, top, right, bottom] = self.rectified.as_ref()?.left_valid_normalized?;
        let [width, height] = [dims.width, dims.height].map(f64::from);
        let within = |value: f64, side: f64| value.clamp(0.0, side) as u16;
        let span = Span {
            start: within((left * width).ceil(), width),
            end: within((right * width).floor(), width).max(within((left * width).ceil(), width)),
        };
        let rows = within((top * height).ceil(), height)..within((bottom * height).floor(), height);
        Some(
            (0..dims.height)
                .map(|y| if rows.contains(&y) { span } else { Span::default() })
                .collect(),
        )
    }

    /// Principal point of the left image reduced by `scale`, px.
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
    pub fn rig_numbers(&self, scale: f64) -> Option<RigUpdate> {
        self.rectified.as_ref().map(|rectified| RigUpdate {
            focal_px: rectified.focal_px * scale,
            baseline_m: rectified.baseline_m,
            offset_px: rectified.disparity_offset_px.unwrap_or(-self.disparity_zero_px) * scale,
        })
    }
}

/// Refuses a key that is a known one elsewhere, or written wrongly: what it was to say would be
/// missing without a word. Others are notes of people and of other programs.
fn check_keys(object: &str, value: &Value, known: &[&str]) -> Result<(), String> {
    let places = [
        ("the file itself", &KEYS[..]),
        ("\"ground_truth\"", &TRUTH_KEYS),
        ("\"rectified\"", &RIG_KEYS),
        ("\"camera\"", &CAMERA_KEYS),
    ];
    let at = if object.is_empty() { String::new() } else { format!(" in \"{object}\"") };
    for key in value.as_object().into_iter().flat_map(|fields| fields.keys()) {
        if known.contains(&key.as_str()) {
            continue;
        }
        if let Some((place, _)) = places.iter().find(|(_, keys)| keys.contains(&key.as_str())) {
            return Err(format!("\"{key}\"{at} is misplaced; move it into {place}"));
        }
        if let Some(meant) = known.iter().find(|known| is_like(key, known)) {
            let known = known.join(", ");
            return Err(format!(
                "\"{key}\"{at} is unknown; did you mean {meant}? The known keys are {known}; all \
                 others are notes"
            ));
        }
    }
    Ok(())
}

/// True when the key is a known one with a few other letters, or a part of it.
fn is_like(key: &str, known: &str) -> bool {
    let [key, known] = [key, known].map(|name| name.to_lowercase().replace(['-', '_', ' '], ""));
    let is_part = key.len() > 3 && (known.starts_with(&key) || known.ends_with(&key));
    is_part || key == known || key.len() > 4 && strsim::levenshtein(&key, &known) <= MISSPELT
}

/// `[640, 480]` or `"640x480"`.
fn size<'de, D: Deserializer<'de>>(value: D) -> Result<Option<Dims>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Size {
        Sides([u16; 2]),
        Text(String),
    }
    let sides = match Option::<Size>::deserialize(value).map_err(|_| wrong_size())? {
        None => return Ok(None),
        Some(Size::Sides(sides)) => Some(sides),
        Some(Size::Text(text)) => text.split_once('x').and_then(|(width, height)| {
            Some([width.trim().parse().ok()?, height.trim().parse().ok()?])
        }),
    };
    let [width, height] = sides.ok_or_else(wrong_size)?;
    Ok(Some(Dims { width, height }))
}

fn wrong_size<E: serde::de::Error>() -> E {
    E::custom("size is neither [width, height] nor \"WIDTHxHEIGHT\" in px")
}
