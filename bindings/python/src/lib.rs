//! The core for Python: what `python/linestereo/__init__.py` calls, with images of any strides and
//! results as bytes of structured arrays.

mod calibration;
mod image;
mod matcher;
mod obstacles;
mod records;

use core::fmt::Display;
use linestereo::health::HealthFlags;
use linestereo_wire::Health;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A `ValueError` with the core's text.
fn refused(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Names of the faults by bit.
#[pyfunction]
fn fault_names() -> Vec<&'static str> {
    HealthFlags::NAMES.into_iter().map(|(_, name)| name).collect()
}

/// Remedy for a fault; nothing for a name that is none.
#[pyfunction]
fn remedy(name: &str) -> Option<&'static str> {
    Health::ADVICE.into_iter().find(|(known, _)| *known == name).map(|(_, what)| what)
}

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<calibration::Calibration>()?;
    module.add_class::<calibration::Rig>()?;
    module.add_class::<matcher::PyMatched>()?;
    module.add_class::<matcher::PyMatcher>()?;
    module.add_class::<obstacles::PyObstacles>()?;
    module.add_function(wrap_pyfunction!(remedy, module)?)?;
    module.add_function(wrap_pyfunction!(fault_names, module)?)
}
