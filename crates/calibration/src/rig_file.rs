//! `rig.toml`: two cameras and the pose between them, for people to read and programs to load.

use core::fmt::Write;
use linestereo::Dims;
use linestereo_frames::untrusted::{self, SETTINGS_BYTES};
use linestereo_rig::{Calibration, CalibrationError, Camera, CameraError, CameraSide, Lens};
use serde::Deserialize;
use std::io;
use std::path::{Path, PathBuf};
use toml::Value;

/// The version of the format that is written.
const VERSION: u32 = 1;

/// A calibrated pair with what is known of its making.
#[derive(Clone, Debug, PartialEq)]
pub struct RigFile {
    /// The cameras and their pose.
    pub calibration: Calibration,
    /// How well it fits what it was made from, if that is known.
    pub quality: Option<Quality>,
}

/// How well a calibration fits the photos it was made from.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quality {
    /// Origin of the rig, in words.
    pub source: String,
    /// Pairs of photos used.
    pub views: u32,
    /// Root mean square of the reprojection error over both cameras, px.
    pub stereo_rms_px: f64,
    /// Mean difference of rows of the same corner after rectification, px; `None` where the rig
    /// cannot be rectified.
    pub vertical_residual_px: Option<f64>,
    /// `good`, `usable` or `repeat`.
    pub verdict: String,
}

/// Why a rig file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RigFileError {
    /// It cannot be read.
    #[error("{0}: {1}")]
    Read(PathBuf, io::Error),
    /// It is no rig file: line and column stand in the text.
    #[error("{0}: {1}")]
    Parse(PathBuf, String),
    /// A later version.
    #[error(
        "{0} is a rig file of version {1}, and this program reads version {VERSION}; use the \
         program that wrote it, or a later one"
    )]
    Version(PathBuf, u32),
    /// A camera in it is none.
    #[error("{0}, [{1}]: {2}")]
    Camera(PathBuf, CameraSide, CameraError),
    /// Its cameras are no pair.
    #[error("{0}, [pose]: {1}")]
    Pair(PathBuf, CalibrationError),
}

/// The part that every version has.
#[derive(Deserialize)]
struct AnyVersion {
    version: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    #[serde(rename = "version")]
    _version: u32,
    left: RawCamera,
    right: RawCamera,
    pose: RawPose,
    quality: Option<Quality>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCamera {
    size: [u16; 2],
    focal_px: [f64; 2],
    centre_px: [f64; 2],
    #[serde(default)]
    skew_px: f64,
    lens: RawLens,
}

#[derive(Deserialize)]
#[serde(tag = "model", rename_all = "kebab-case", deny_unknown_fields)]
enum RawLens {
    BrownConrady { k: [f64; 3], p: [f64; 2] },
    Rational { k: [f64; 6], p: [f64; 2] },
    Fisheye { k: [f64; 4] },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPose {
    rotation_rad: [f64; 3],
    translation_m: [f64; 3],
}

impl RigFile {
    /// Reads and checks a file.
    pub fn load(path: &Path) -> Result<Self, RigFileError> {
        let at = || path.to_path_buf();
        let text = untrusted::read_text(path, SETTINGS_BYTES)
            .map_err(|error| RigFileError::Read(at(), error))?;
        let no_rig = |error: toml::de::Error| RigFileError::Parse(at(), error.to_string());
        let AnyVersion { version } = toml::from_str(&text).map_err(no_rig)?;
        if version != VERSION {
            return Err(RigFileError::Version(at(), version));
        }
        let raw: Raw = toml::from_str(&text).map_err(no_rig)?;
        let camera = |raw: &RawCamera, eye| {
            camera(raw).map_err(|error| RigFileError::Camera(at(), eye, error))
        };
        let (left, right) =
            (camera(&raw.left, CameraSide::Left)?, camera(&raw.right, CameraSide::Right)?);
        let calibration = Calibration::new(
            left,
            right,
            quaternion(raw.pose.rotation_rad),
            raw.pose.translation_m,
        )
        .map_err(|error| RigFileError::Pair(at(), error))?;
        Ok(Self { calibration, quality: raw.quality })
    }

    /// The file as text; numbers are read back as the same bits, but for the last of the rotation.
    pub fn text(&self) -> String {
        let mut text = format!(
            "# A stereo rig: two cameras and the pose between them. Pixels: whole numbers are pixel centres.\n\
             version = {VERSION}\n"
        );
        for eye in CameraSide::BOTH {
            text.push_str(&camera_text(eye, self.calibration.camera(eye)));
        }
        let _ = write!(
            text,
            "\n# A point X of the left camera (x right, y down, z forward) is at R X + t in the right one.\n\
             [pose]\n\
             rotation_rad = {:?} # axis times angle\n\
             translation_m = {:?} # baseline {:.4} m\n",
            rotation_vector(self.calibration.rotation()),
            self.calibration.translation(),
            self.calibration.baseline(),
        );
        if let Some(Quality { source, views, stereo_rms_px, vertical_residual_px, verdict }) =
            &self.quality
        {
            // As TOML quotes text.
            let [source, verdict] = [source, verdict].map(|text| Value::from(text.as_str()));
            let residual = vertical_residual_px
                .map_or(String::new(), |px| format!("vertical_residual_px = {px:?}\n"));
            let _ = write!(
                text,
                "\n[quality]\n\
                 source = {source}\n\
                 views = {views}\n\
                 stereo_rms_px = {stereo_rms_px:?}\n\
                 {residual}\
                 verdict = {verdict}\n"
            );
        }
        text
    }
}

fn camera(raw: &RawCamera) -> Result<Camera, CameraError> {
    let [width, height] = raw.size;
    let lens = match raw.lens {
        RawLens::BrownConrady { k, p } => Lens::BrownConrady { k, p },
        RawLens::Rational { k, p } => Lens::Rational { k, p },
        RawLens::Fisheye { k } => Lens::Fisheye { k },
    };
    Camera::new(Dims { width, height }, raw.focal_px, raw.centre_px, raw.skew_px, lens)
}

fn camera_text(eye: CameraSide, camera: &Camera) -> String {
    let Dims { width, height } = camera.dims();
    let lens = match camera.lens() {
        Lens::BrownConrady { k, p } => {
            format!("{{ model = \"brown-conrady\", k = {k:?}, p = {p:?} }}")
        }
        Lens::Rational { k, p } => format!("{{ model = \"rational\", k = {k:?}, p = {p:?} }}"),
        Lens::Fisheye { k } => format!("{{ model = \"fisheye\", k = {k:?} }}"),
    };
    format!(
        "\n[{eye}]\nsize = [{width}, {height}]\nfocal_px = {:?}\ncentre_px = {:?}\nskew_px = {:?}\nlens = {lens}\n",
        camera.focal(),
        camera.centre(),
        camera.skew(),
    )
}

/// A rotation vector (axis times angle, radians) as a unit quaternion. By the `libm` crate: the
/// same bits on every machine.
pub fn quaternion(vector: [f64; 3]) -> [f64; 4] {
    let angle = libm::sqrt(vector.iter().map(|v| v * v).sum());
    let scale = if angle > 1e-12 { libm::sin(angle / 2.0) / angle } else { 0.5 };
    let [x, y, z] = vector.map(|v| v * scale);
    [libm::cos(angle / 2.0), x, y, z]
}

/// The inverse of [`quaternion`].
pub fn rotation_vector([w, x, y, z]: [f64; 4]) -> [f64; 3] {
    let sine = libm::sqrt(x * x + y * y + z * z);
    let scale = if sine > 1e-12 { 2.0 * libm::atan2(sine, w) / sine } else { 2.0 };
    [x * scale, y * scale, z * scale]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_file_is_read_back_as_it_was_written() {
        let dims = Dims { width: 640, height: 480 };
        let lens = Lens::BrownConrady { k: [-0.3, 0.1, 1e-3], p: [1e-4, -2e-4] };
        let left = Camera::new(dims, [500.1, 501.2], [320.3, 240.4], 0.25, lens).unwrap();
        let lens = Lens::Fisheye { k: [0.01, 0.0, 0.0, -0.001] };
        let right = Camera::new(dims, [499.0, 498.0], [310.0, 250.0], 0.0, lens).unwrap();
        let (turn, shift) = (quaternion([0.01, -0.02, 0.03]), [-0.1, 0.001, -0.002]);
        let calibration = Calibration::new(left, right, turn, shift).unwrap();
        // Of a rig that cannot be rectified, from a folder with an odd name.
        let quality =
            Quality { source: "a \"quoted\" \u{1b}".into(), views: 9, ..Quality::default() };
        let file = RigFile { calibration, quality: Some(quality) };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rig.toml");
        fs::write(&path, file.text()).unwrap();
        let again = RigFile::load(&path).unwrap();
        assert_eq!(again.quality, file.quality);
        let again = again.calibration;
        assert_eq!(CameraSide::BOTH.map(|eye| *again.camera(eye)), [left, right]);
        assert_eq!(again.translation(), shift);
        assert!(again.rotation().into_iter().zip(turn).all(|(a, b)| (a - b).abs() < 1e-15));
    }

    #[test]
    fn a_wrong_number_is_named_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rig.toml");
        fs::write(&path, "version = 1\n[left]\nsize = [640, -3]\n").unwrap();
        let text = RigFile::load(&path).unwrap_err().to_string();
        assert!(text.contains("line 3"), "{text}");
        // What a later version has is not known.
        fs::write(&path, "version = 2\nnew = 1\n").unwrap();
        let text = RigFile::load(&path).unwrap_err().to_string();
        assert!(text.contains("of version 2") && text.contains("a later one"), "{text}");
    }
}
