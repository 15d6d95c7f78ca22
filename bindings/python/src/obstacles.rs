//! Obstacles by direction over consecutive pairs.

use crate::matcher::PyMatched;
use crate::{records, refused};
use linestereo::Dims;
use linestereo::obstacles::{ObstacleParams, ObstaclePlan, Obstacles};
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Parameters and what is known of each direction.
#[pyclass(module = "linestereo", name = "Obstacles")]
pub(crate) struct PyObstacles {
    wanted: ObstacleParams,
    /// Of the last pair's rig and size.
    view: Option<(ObstaclePlan, Obstacles)>,
}

#[pymethods]
impl PyObstacles {
    #[new]
    fn new(
        yaw_deg: f32,
        sectors: u8,
        range_m: f32,
        heights_m: [f32; 2],
        drop_m: Option<f32>,
        keep_ms: u16,
        error_probability: f32,
    ) -> PyResult<Self> {
        let wanted = ObstacleParams {
            yaw_deg,
            sectors,
            range_m,
            heights_m,
            drop_m,
            keep_ms,
            error_probability,
            ..ObstacleParams::DEFAULT
        };
        // Refused here and not with the first pair: with any rig and size.
        let rig = linestereo::Rig::new(100.0, 0.1, 0.0).map_err(refused)?;
        let params = linestereo::Params { rig: Some(rig), ..linestereo::Params::default() };
        wanted.plan(&params, Dims { width: 320, height: 240 }).map_err(refused)?;
        Ok(Self { wanted, view: None })
    }

    /// Takes a pair. With another rig or size than that of the pair before nothing is known of it.
    fn update(&mut self, pair: &PyMatched, time_us: u64) -> PyResult<()> {
        let matched = pair.pair();
        let matched = matched.get();
        let plan = self.wanted.plan(pair.params(), matched.dims()).map_err(refused)?;
        if self.view.as_ref().is_none_or(|(known, _)| *known != plan) {
            self.view = None;
        }
        let (_, obstacles) = self.view.get_or_insert_with(|| (plan, Obstacles::new()));
        matched.update_obstacles(&plan, obstacles, time_us);
        Ok(())
    }

    /// Bytes of the sectors of a turn.
    fn sectors<'py>(&self, py: Python<'py>, time_us: u64) -> PyResult<Bound<'py, PyArray1<u8>>> {
        let Some((plan, obstacles)) = &self.view else {
            return Err(PyValueError::new_err("no pair yet: call update first"));
        };
        Ok(records::of_sectors(plan, obstacles, time_us).into_pyarray(py))
    }
}
