//! Matching, and what is asked of a matched pair.

use crate::calibration::{Calibration, Rig};
use crate::image::{grey, view};
use crate::records::{self, Answer};
use crate::refused;
use core::fmt::Display;
use linestereo::ground::{CameraPose, GroundPlane};
use linestereo::image::{Span, shrink_to_valid};
use linestereo::results::ImagePosition;
use linestereo::units::{Disparity, Position};
use linestereo::{Area, Dims, Matched, Options, Params, Region, objects::Run};
use linestereo_frames::{GrayImage, MatchedPair, PairBuffers};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray as _, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// A matcher of consecutive pairs: it knows the health of those before.
#[pyclass(module = "linestereo", name = "Matcher")]
pub(crate) struct PyMatcher {
    params: Params,
    /// Nobody said how far to search.
    takes_what_fits: bool,
    calibration: Option<Py<Calibration>>,
    /// Stated pose of the camera, m and degrees, checked; `None` where it is not known.
    pose: Option<CameraPose>,
    state: Option<(Dims, linestereo::Matcher)>,
}

#[pymethods]
impl PyMatcher {
    #[new]
    #[pyo3(signature = (max_disparity, rig, min_disparity, min_confidence))]
    fn new(
        max_disparity: Option<u16>,
        rig: Option<&Bound<'_, PyAny>>,
        min_disparity: i16,
        min_confidence: Option<f64>,
    ) -> PyResult<Self> {
        let mut params = Params { min_disparity, ..Params::default() };
        params.max_disparity = max_disparity.unwrap_or(params.max_disparity);
        if let Some(confidence) = min_confidence {
            if !(0.0..1.0).contains(&confidence) {
                return Err(PyValueError::new_err(format!(
                    "min_confidence is {confidence} but must be 0.1 to 0.99"
                )));
            }
            params.min_confidence = linestereo::units::Confidence::from_num(confidence);
        }
        let mut calibration = None;
        if let Some(rig) = rig {
            if let Ok(rig) = rig.cast::<Rig>() {
                params.rig = Some(rig.get().rig);
            } else if let Ok(found) = rig.cast::<Calibration>() {
                params.rig = Some(found.try_borrow().map_err(in_use("Calibration"))?.rig);
                calibration = Some(found.clone().unbind());
            } else {
                return Err(PyValueError::new_err("rig is neither a Rig nor a Calibration"));
            }
        }
        let takes_what_fits = max_disparity.is_none();
        Ok(Self { params, takes_what_fits, calibration, pose: None, state: None })
    }

    /// The camera's height (m), pitch and roll (degrees) in the pairs that follow, or nothing.
    fn expect_ground(&mut self, pose: Option<[f32; 3]>) -> PyResult<()> {
        let pose = pose.map(|[height_m, pitch_deg, roll_deg]| CameraPose {
            height_m,
            pitch_deg,
            roll_deg,
        });
        // Refused here and not with the next pair: a pose that is right is so for all sizes.
        self.plane(pose, Dims { width: 320, height: 240 })?;
        self.pose = pose;
        Ok(())
    }

    #[pyo3(name = "match")]
    fn run(
        slf: &Bound<'_, Self>,
        py: Python<'_>,
        left: &Bound<'_, PyAny>,
        right: &Bound<'_, PyAny>,
        times_us: Option<[u64; 2]>,
        valid: [Option<PyReadonlyArray2<'_, u16>>; 2],
    ) -> PyResult<PyMatched> {
        let mut matcher = slf.try_borrow_mut().map_err(in_use("Matcher"))?;
        let mut images = [grey(left, "left")?, grey(right, "right")?];
        let [left, right] = images.each_ref().map(|image| image.dims);
        if left != right {
            return Err(PyValueError::new_err(format!(
                "left is {left}, right is {right}: both have to be of one size"
            )));
        }
        let mut usable = [Vec::new(), Vec::new()];
        for ((spans, given), image) in usable.iter_mut().zip(valid).zip(&images) {
            let Some(given) = given else { continue };
            spans.extend(
                given.as_array().rows().into_iter().map(|row| Span { start: row[0], end: row[1] }),
            );
            shrink_to_valid(spans, image.dims.width);
            view(image, spans)?;
        }
        if let Some(calibration) = &matcher.calibration {
            let calibration = calibration.bind(py).try_borrow_mut();
            let mut calibration = calibration.map_err(in_use("Calibration"))?;
            usable.clone_from(&calibration.usable);
            let calibration = &mut *calibration;
            images = py.detach(|| calibration.pair(&images))?;
        }
        let matcher = &mut *matcher;
        py.detach(|| matcher.matched(images, usable, times_us))
    }
}

/// Of an object that another thread works with.
pub(crate) fn in_use<E: Display>(name: &str) -> impl FnOnce(E) -> PyErr {
    move |error| {
        PyRuntimeError::new_err(format!(
            "the {name} is in use ({error}); give each thread one of its own"
        ))
    }
}

impl PyMatcher {
    /// The plane that a camera of this pose sees.
    fn plane(&self, pose: Option<CameraPose>, dims: Dims) -> PyResult<Option<GroundPlane>> {
        let Some(pose) = pose else { return Ok(None) };
        let Some(rig) = &self.params.rig else {
            return Err(PyValueError::new_err(
                "the camera's pose needs a rig; give rig=linestereo.Rig(..) to the matcher",
            ));
        };
        GroundPlane::of_pose(pose, rig, dims).map(Some).map_err(refused)
    }

    fn matched(
        &mut self,
        images: [GrayImage; 2],
        usable: [Vec<Span>; 2],
        times_us: Option<[u64; 2]>,
    ) -> PyResult<PyMatched> {
        let dims = images[0].dims;
        if self.state.as_ref().is_none_or(|(planned, _)| *planned != dims) {
            if self.takes_what_fits {
                self.params.max_disparity = Params::default_max_disparity(dims.width);
            }
            self.state =
                Some((dims, linestereo::Matcher::new(self.params, dims).map_err(refused)?));
        }
        let expected = self.plane(self.pose, dims)?;
        let Some((_, matcher)) = &mut self.state else {
            return Err(PyValueError::new_err("no matcher"));
        };
        matcher.expect_ground(expected);
        let start = Instant::now();
        let options = Options { times_us, ..Options::default() };
        let mut pair = MatchedPair::run(matcher, PairBuffers::new(images, usable), options)
            .map_err(refused)?;
        let points: Vec<_> = pair.ask(|matched| matched.points().collect());
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        let (mut segments, mut bars) = (Vec::new(), Vec::new());
        pair.get().segments().iter().for_each(|found| records::push_segment(&mut segments, found));
        for found in pair.get().bars() {
            records::push_bar(&mut bars, found, self.params.rig);
        }
        let records = records::of_points(&points, &self.params);
        let matched = pair.get();
        Ok(PyMatched {
            health: (matched.health().flags.bits(), matched.is_fit(), matched.counts().is_cut()),
            segments_found: matched.counts().segments_left,
            dims,
            pair: Mutex::new(pair),
            params: self.params,
            points: Some(records),
            segments: Some(segments),
            bars: Some(bars),
            milliseconds,
        })
    }
}

/// A matched pair with all that its results need.
#[pyclass(module = "linestereo", name = "Matched")]
pub(crate) struct PyMatched {
    /// Threads that ask wait for each other.
    pair: Mutex<MatchedPair>,
    dims: Dims,
    /// Bits of the faults, whether results may be used, and whether a list was full or a budget of
    /// work spent.
    #[pyo3(get)]
    health: (u32, bool, bool),
    /// Segments found in the left image.
    #[pyo3(get)]
    segments_found: u16,
    params: Params,
    points: Option<Vec<u8>>,
    segments: Option<Vec<u8>>,
    bars: Option<Vec<u8>>,
    /// Time that the core took, ms.
    #[pyo3(get)]
    milliseconds: f64,
}

#[pymethods]
impl PyMatched {
    /// Bytes of the points, once.
    fn take_points<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        self.points.take().unwrap_or_default().into_pyarray(py)
    }

    /// Bytes of the segments, once.
    fn take_segments<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        self.segments.take().unwrap_or_default().into_pyarray(py)
    }

    /// Bytes of the bars, once.
    fn take_bars<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        self.bars.take().unwrap_or_default().into_pyarray(py)
    }

    /// The ground plane: px per row, px per column, px at the first pixel; then the camera's
    /// height, pitch and roll, not a number without a rig.
    #[getter]
    fn ground(&self) -> Option<[f64; 6]> {
        let plane = self.pair().get().ground()?;
        let [down, across, origin] = [plane.down_q16, plane.across_q16, plane.origin_q16]
            .map(|number| f64::from(number) / 65536.0);
        let pose = self.params.rig.and_then(|rig| CameraPose::of_plane(plane, &rig, self.dims));
        let [height, pitch, roll] = pose.map_or([f64::NAN; 3], |pose| {
            [pose.height_m, pose.pitch_deg, pose.roll_deg].map(f64::from)
        });
        Some([down, across, origin, height, pitch, roll])
    }

    /// Columns and rows.
    #[getter]
    fn size(&self) -> (u16, u16) {
        (self.dims.width, self.dims.height)
    }

    /// Places of these points in space, three numbers of m each; not a number where there is none.
    fn xyz<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'_, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let Some(rig) = self.params.rig else {
            return Err(PyValueError::new_err(
                "places in space need a rig; give rig=linestereo.Rig(..) to the matcher",
            ));
        };
        let (rig, points) = (rig.centred(self.dims), points.as_array());
        let place = |[x, y, disparity]: [f32; 3]| {
            if [x, y, disparity].iter().any(|number| number.is_nan()) {
                return [f64::NAN; 3];
            }
            let at = ImagePosition {
                x: Position::saturating_from_num(x),
                y: Position::saturating_from_num(y),
            };
            let found = rig.xyz(at, Disparity::saturating_from_num(disparity));
            found.map_or([f64::NAN; 3], |place| place.map(|metres| metres.to_num()))
        };
        let places =
            points.rows().into_iter().flat_map(|row| place([row[0], row[1], row[2]])).collect();
        Ok(Array2::from_shape_vec((points.nrows(), 3), places).map_err(refused)?.into_pyarray(py))
    }

    fn boxes(&self, py: Python<'_>, boxes: PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Answer>> {
        let boxes = boxes.as_array();
        let dims = self.dims;
        let mut regions = Vec::with_capacity(boxes.nrows());
        for (index, row) in boxes.rows().into_iter().enumerate() {
            let wrong = |what: &str| PyValueError::new_err(format!("boxes[{index}]: {what}"));
            let area = nearest_area([row[0], row[1], row[2], row[3]], dims).map_err(wrong)?;
            let label = u16::try_from(index).map_err(|_| wrong("more than 65535 boxes"))?;
            regions
                .push(Region::boxed(label, area, dims).map_err(|error| wrong(&error.to_string()))?);
        }
        Ok(py.detach(|| self.answers(&regions)))
    }

    /// Of an image of labels, 0 for what is no object.
    fn labels(&self, py: Python<'_>, labels: PyReadonlyArray2<'_, u16>) -> PyResult<Vec<Answer>> {
        let labels = labels.as_array();
        let dims = self.dims;
        if labels.dim() != (dims.height.into(), dims.width.into()) {
            let (rows, columns) = labels.dim();
            return Err(PyValueError::new_err(format!(
                "a mask is {columns}x{rows}, the pair {dims}"
            )));
        }
        let mut runs: Vec<Run> = Vec::new();
        for (y, row) in (0..dims.height).zip(labels.rows()) {
            for (x, &label) in (0..dims.width).zip(row) {
                match runs.last_mut() {
                    Some(run) if run.label == label && run.y == y && run.span.end == x => {
                        run.span.end = x + 1
                    }
                    _ if label > 0 => {
                        runs.push(Run { label, y, span: Span { start: x, end: x + 1 } })
                    }
                    _ => {}
                }
            }
        }
        let mut names: Vec<u16> = runs.iter().map(|run| run.label).collect();
        names.sort_unstable();
        names.dedup();
        let region = |&label: &u16| Region::masked(label, &runs, dims).map_err(refused);
        let regions = names.iter().map(region).collect::<PyResult<Vec<_>>>()?;
        Ok(py.detach(|| self.answers(&regions)))
    }

    /// Or the reason why there is none.
    fn pixel(&self, py: Python<'_>, x: u16, y: u16) -> Answer {
        match py.detach(|| self.pair().ask(|matched| matched.pixel((x, y)))) {
            Ok(found) => records::of_pixel(&found),
            Err(reason) => records::of_rejection(reason),
        }
    }
}

/// Borders go to the nearest border of a pixel; what has an area keeps a pixel: as the PC's program
/// reads a detector's boxes.
fn nearest_area(borders: [f64; 4], dims: Dims) -> Result<Area, &'static str> {
    if borders.iter().any(|border| !border.is_finite()) {
        return Err("not a finite number");
    }
    let [left, top, right, bottom] = borders;
    if left >= right || top >= bottom {
        return Err("a region without pixels; give left, top, right, bottom");
    }
    let (width, height) = (f64::from(dims.width), f64::from(dims.height));
    if right <= 0.0 || bottom <= 0.0 || left >= width || top >= height {
        return Err("a region outside of the image");
    }
    let side = |from: f64, to: f64, limit: f64| {
        let start = from.clamp(0.0, limit).round().min(limit - 1.0);
        (start as u16, to.clamp(0.0, limit).round().max(start + 1.0) as u16)
    };
    let ((left, right), (top, bottom)) = (side(left, right, width), side(top, bottom, height));
    Ok(Area { left, top, right, bottom })
}

impl PyMatched {
    /// The pair, for one thread at a time, which must not wait for the GIL while it has it.
    pub(crate) fn pair(&self) -> MutexGuard<'_, MatchedPair> {
        self.pair.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn params(&self) -> &Params {
        &self.params
    }

    fn answers(&self, regions: &[Region<'_>]) -> Vec<Answer> {
        let answer = |matched: &mut Matched<'_>, region: &Region<'_>| {
            records::of_object(region.label(), &matched.object(region))
        };
        self.pair().ask(|matched| regions.iter().map(|region| answer(matched, region)).collect())
    }
}
