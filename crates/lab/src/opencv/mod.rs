//! OpenCV's StereoBM and StereoSGBM on the same pair, through a Python with `cv2`: evidence that is
//! not ours.

use anyhow::{Result, anyhow, bail};
use linestereo_frames::GrayImage;
use linestereo_frames::untrusted::{self, RESULT_BYTES};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io;
use std::path::Path;
use std::process::Command;

const SCRIPT: &str = include_str!("opencv.py");
/// Steps of OpenCV's disparities in one px.
const STEPS: f32 = 16.0;

/// Which Python runs it, where no option says so.
pub(crate) const PYTHON_VARIABLE: &str = "LINESTEREO_PYTHON";

/// OpenCV's methods, in the order of tables: BM with uniqueness 15, and with 90 and texture 3000;
/// SGBM along five paths with uniqueness 10 and 80, along eight (`MODE_HH`) with 10 and 95.
pub(crate) const OPENCV_METHODS: [&str; 6] = [
    "opencv-bm", "opencv-bm-strict", "opencv-sgbm", "opencv-sgbm-strict", "opencv-sgbm8",
    "opencv-sgbm8-strict",
];

/// A Python with OpenCV.
#[derive(Clone, Debug)]
pub(crate) struct OpenCv {
    python: OsString,
    version: String,
}

#[derive(Deserialize)]
struct Answer {
    milliseconds: BTreeMap<String, f64>,
}

/// Result of one method.
#[derive(Clone, Debug)]
pub(crate) struct OpenCvMap {
    /// One of [`OPENCV_METHODS`].
    pub(crate) name: &'static str,
    /// Disparities of the left image's pixels, px, row by row; not a number in gaps.
    pub(crate) disparities: Vec<f32>,
    /// Time of the pair on one thread.
    pub(crate) milliseconds: f64,
}

impl OpenCv {
    /// Looks for OpenCV in this Python, else in that of the environment variable, else in
    /// `python3`.
    pub(crate) fn find(python: Option<&Path>) -> Result<Self> {
        let python = python
            .map(|path| path.as_os_str().to_owned())
            .or_else(|| std::env::var_os(PYTHON_VARIABLE))
            .unwrap_or_else(|| "python3".into());
        let version = ["-c", "import cv2; print(cv2.__version__)"];
        let output = Command::new(&python).args(version).output();
        let named = python.display();
        let output = match output {
            Ok(output) => output,
            Err(error) => bail!(
                "cannot run {named}: {error}; install Python, or name one by --python or \
                 {PYTHON_VARIABLE}"
            ),
        };
        if !output.status.success() {
            bail!(
                "{named} has no OpenCV; pip install opencv-python-headless, or name another \
                 Python by --python or {PYTHON_VARIABLE}"
            );
        }
        Ok(Self { python, version: String::from_utf8_lossy(&output.stdout).trim().to_owned() })
    }
    pub(crate) fn python(&self) -> &OsStr {
        &self.python
    }
    pub(crate) fn version(&self) -> &str {
        &self.version
    }

    /// Matches a pair by all of its methods with disparities `0 .. disparities`, each so many times
    /// for the median of its times.
    pub(crate) fn run(
        &self,
        left: &GrayImage,
        right: &GrayImage,
        disparities: usize,
        runs: usize,
    ) -> Result<Vec<OpenCvMap>> {
        let no_files = |error: io::Error| {
            anyhow!(
                "cannot exchange files with Python: {error}; free space in the temporary folder"
            )
        };
        let failed = |what: &str| {
            anyhow!("OpenCV failed ({what}); try another version of opencv-python-headless")
        };
        let folder = tempfile::tempdir().map_err(no_files)?;
        let at = |name: &str| folder.path().join(name);
        fs::write(at("opencv.py"), SCRIPT).map_err(no_files)?;
        fs::write(at("left.pgm"), pgm(left)).map_err(no_files)?;
        fs::write(at("right.pgm"), pgm(right)).map_err(no_files)?;
        let (count, runs) = (disparities.to_string(), runs.to_string());
        let arguments = ["opencv.py", "left.pgm", "right.pgm", &count, &runs, "."];
        let mut python = Command::new(&self.python);
        let output =
            python.args(arguments).current_dir(folder.path()).output().map_err(no_files)?;
        if !output.status.success() {
            let text = String::from_utf8_lossy(&output.stderr);
            return Err(failed(text.lines().last().unwrap_or("no message")));
        }
        let answer: Answer =
            serde_json::from_slice(&output.stdout).map_err(|error| failed(&error.to_string()))?;
        let read = |name: &'static str| {
            let bytes = untrusted::read(&at(&format!("{name}.i16")), RESULT_BYTES);
            let milliseconds = answer.milliseconds.get(name).copied().unwrap_or(f64::NAN);
            Ok(OpenCvMap { name, disparities: decoded(&bytes.map_err(no_files)?), milliseconds })
        };
        OPENCV_METHODS.into_iter().map(read).collect()
    }
}

fn pgm(image: &GrayImage) -> Vec<u8> {
    let mut bytes = format!("P5\n{} {}\n255\n", image.dims.width, image.dims.height).into_bytes();
    bytes.extend_from_slice(&image.pixels);
    bytes
}

/// Negative values are gaps.
fn decoded(bytes: &[u8]) -> Vec<f32> {
    let values = bytes.as_chunks().0.iter().map(|value| i16::from_ne_bytes(*value));
    values.map(|value| if value < 0 { f32::NAN } else { f32::from(value) / STEPS }).collect()
}
