//! Rigs: numbers of a rectified pair, and calibrations of raw ones.

use crate::image::{grey, view};
use crate::matcher::in_use;
use crate::refused;
use linestereo::{Dims, image::Span};
use linestereo_calibration::PairRectifier;
use linestereo_calibration::interchange::{Imported, Options, TranslationUnit, load_rig};
use linestereo_frames::GrayImage;
use linestereo_rig::{CameraSide, RigImage, View};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray as _, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;

/// A rectified pair: depth = focal_px * baseline_m / (disparity + disparity_offset_px).
///
/// focal_px: 1 to 100000. baseline_m: 0.0001 to 10. disparity_offset_px: column of the principal
/// point on the right minus that on the left, -4096 to 4096. principal_point_px: column and row in
/// the left image, -2048 to 2048, its centre without.
#[pyclass(frozen, module = "linestereo")]
pub(crate) struct Rig {
    pub(crate) rig: linestereo::Rig,
    numbers: RigNumbers,
}

/// Focal length, px, baseline, m, offset, px, and principal point, px.
type RigNumbers = (f32, f32, f32, Option<[f32; 2]>);

#[pymethods]
impl Rig {
    #[new]
    #[pyo3(signature = (focal_px, baseline_m, disparity_offset_px = 0.0, principal_point_px = None))]
    fn new(
        focal_px: f32,
        baseline_m: f32,
        disparity_offset_px: f32,
        principal_point_px: Option<[f32; 2]>,
    ) -> PyResult<Self> {
        let mut rig =
            linestereo::Rig::new(focal_px, baseline_m, disparity_offset_px).map_err(refused)?;
        if let Some(point) = principal_point_px {
            rig = rig.with_principal_point(point).map_err(refused)?;
        }
        Ok(Self { rig, numbers: (focal_px, baseline_m, disparity_offset_px, principal_point_px) })
    }

    /// For `pickle` and `copy`.
    fn __getnewargs__(&self) -> RigNumbers {
        self.numbers
    }

    /// Focal length, px.
    #[getter]
    fn focal_px(&self) -> f64 {
        self.rig.focal_q16() as f64 / 65536.0
    }

    /// Distance of the cameras, m.
    #[getter]
    fn baseline_m(&self) -> f64 {
        self.rig.focal_baseline_q16() as f64 / self.rig.focal_q16() as f64
    }

    /// Added to every disparity, px.
    #[getter]
    fn disparity_offset_px(&self) -> f32 {
        self.numbers.2
    }

    /// Principal point of the left image, px; None for its centre.
    #[getter]
    fn principal_point_px(&self) -> Option<(f32, f32)> {
        self.numbers.3.map(|[x, y]| (x, y))
    }

    fn __repr__(&self) -> String {
        let (focal, baseline, offset, centre) = &self.numbers;
        let mut text = format!("Rig(focal_px={focal}, baseline_m={baseline}");
        if *offset != 0.0 {
            text += &format!(", disparity_offset_px={offset}");
        }
        if let Some([x, y]) = centre {
            text += &format!(", principal_point_px=({x}, {y})");
        }
        text + ")"
    }
}

/// A calibrated pair of cameras, and the view that its images are rectified to.
#[pyclass(module = "linestereo")]
pub(crate) struct Calibration {
    image: RigImage,
    pub(crate) rig: linestereo::Rig,
    pub(crate) usable: [Vec<Span>; 2],
    rectifier: PairRectifier,
    notes: Vec<String>,
}

/// Files of one rig.
#[derive(FromPyObject)]
enum Paths {
    One(PathBuf),
    Each(Vec<PathBuf>),
}

/// Unit of lengths in files of OpenCV.
#[derive(FromPyObject)]
enum Unit {
    Name(String),
    SquareMm(f64),
}

impl Unit {
    fn unit(self) -> PyResult<TranslationUnit> {
        match self {
            Self::Name(name) if name == "m" => Ok(TranslationUnit::Metres),
            Self::Name(name) if name == "mm" => Ok(TranslationUnit::Millimetres),
            Self::SquareMm(millimetres) if (0.1..=10_000.0).contains(&millimetres) => {
                Ok(TranslationUnit::Squares { millimetres })
            }
            _ => Err(PyValueError::new_err(
                "translation_unit is \"m\", \"mm\", or the side of the board's squares in mm",
            )),
        }
    }
}

#[pymethods]
impl Calibration {
    /// Of a `rig.toml`, or of files of OpenCV, Kalibr, ROS or EuRoC: a list of two, the left
    /// camera's first, where each has its own.
    ///
    /// size: columns and rows of rectified images, those of raw ones without. alpha: 0 keeps no
    /// pixel without a source, 1 every raw pixel. focal_px: focal length of rectified images, px,
    /// instead of alpha. raw_size: columns and rows of raw images, where a file of OpenCV does not
    /// say them. translation_unit: of OpenCV's T: "m", "mm", or the side of the board's squares in
    /// mm; it is assumed without, and `notes` say so.
    #[staticmethod]
    #[pyo3(signature = (path, size = None, alpha = 0.0, focal_px = None, raw_size = None, translation_unit = None))]
    fn load(
        path: Paths,
        size: Option<(u16, u16)>,
        alpha: f64,
        focal_px: Option<f64>,
        raw_size: Option<(u16, u16)>,
        translation_unit: Option<Unit>,
    ) -> PyResult<Self> {
        let paths = match path {
            Paths::One(path) => vec![path],
            Paths::Each(paths) => paths,
        };
        let options = Options {
            images: raw_size.map(|(width, height)| Dims { width, height }),
            translation_unit: translation_unit.map(Unit::unit).transpose()?,
            ..Options::default()
        };
        let Imported { rig, notes, .. } = load_rig(&paths, &options).map_err(refused)?;
        let calibration = rig.calibration;
        let raw = calibration.camera(CameraSide::Left).dims();
        let dims = size.map_or(raw, |(width, height)| Dims { width, height });
        let range = linestereo::Params::DEFAULT;
        let most = linestereo::Params::default_max_disparity(dims.width);
        let view = focal_px.map_or(View::Alpha(alpha), View::Focal);
        let image =
            RigImage::new(calibration, dims, view, (range.min_disparity, most)).map_err(refused)?;
        Ok(Self { notes, ..Self::of(image)? })
    }

    /// From the bytes that boards keep.
    #[staticmethod]
    fn _decoded(bytes: &[u8]) -> PyResult<Self> {
        Self::of(RigImage::decode(bytes).map_err(refused)?)
    }

    /// The bytes that boards keep.
    fn _encoded<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.image.encode(0))
    }

    /// Assumptions that reading the files took, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Columns and rows of rectified images.
    #[getter]
    fn size(&self) -> (u16, u16) {
        let dims = self.image.remap().dims();
        (dims.width, dims.height)
    }

    /// Columns and rows of raw images.
    #[getter]
    fn raw_size(&self) -> (u16, u16) {
        let dims = self.image.remap().raw_dims();
        (dims.width, dims.height)
    }

    /// The rig of the rectified images.
    #[getter]
    fn rig(&self) -> PyResult<Rig> {
        let remap = self.image.remap();
        Rig::new(remap.focal(), remap.baseline(), 0.0, Some(remap.centre()))
    }

    /// Of each row of the rectified images the first pixel with a source and the one behind the
    /// last, left and right.
    #[getter]
    fn valid<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray2<u16>>; 2]> {
        let [left, right] = CameraSide::BOTH.map(|eye| {
            let spans = self.rectifier.facts(eye).spans;
            let ends = spans.iter().flat_map(|span| [span.start, span.end]).collect();
            Array2::from_shape_vec((spans.len(), 2), ends)
        });
        Ok([left.map_err(refused)?.into_pyarray(py), right.map_err(refused)?.into_pyarray(py)])
    }

    /// As `linestereo.rectify`.
    fn rectify<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        left: &Bound<'py, PyAny>,
        right: &Bound<'py, PyAny>,
    ) -> PyResult<[Bound<'py, PyArray2<u8>>; 2]> {
        let images = [grey(left, "left")?, grey(right, "right")?];
        let mut calibration = slf.try_borrow_mut().map_err(in_use("Calibration"))?;
        let calibration = &mut *calibration;
        let [left, right] = py.detach(|| calibration.pair(&images))?;
        Ok([array(py, left)?, array(py, right)?])
    }

    fn __repr__(&self) -> PyResult<String> {
        let rig = self.rig()?.__repr__();
        Ok(format!(
            "Calibration(raw_size={:?}, size={:?}, rig={rig})",
            self.raw_size(),
            self.size()
        ))
    }
}

impl Calibration {
    fn of(image: RigImage) -> PyResult<Self> {
        let rectifier = PairRectifier::new(image.remap()).map_err(refused)?;
        let usable = CameraSide::BOTH.map(|eye| rectifier.facts(eye).usable);
        Ok(Self {
            rig: image.remap().rig().map_err(refused)?,
            image,
            usable,
            rectifier,
            notes: Vec::new(),
        })
    }

    pub(crate) fn pair(&mut self, [left, right]: &[GrayImage; 2]) -> PyResult<[GrayImage; 2]> {
        let (left, right) = self.rectifier.pair(left, right).map_err(refused)?;
        for (image, usable) in [&left, &right].into_iter().zip(&self.usable) {
            view(image, usable)?;
        }
        Ok([left, right])
    }
}

fn array(
    py: Python<'_>,
    GrayImage { dims, pixels }: GrayImage,
) -> PyResult<Bound<'_, PyArray2<u8>>> {
    let shape = (usize::from(dims.height), usize::from(dims.width));
    Ok(Array2::from_shape_vec(shape, pixels).map_err(refused)?.into_pyarray(py))
}
