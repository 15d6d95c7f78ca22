//! Parameters, checked once for one image size, and the models that rate evidence.

use crate::confidence::{FITTED, Models};
use crate::image::Dims;
use crate::params::{ParamError, Params};
use crate::support::{FITTED_SUPPORT, SupportModels};

/// Checked parameters for one image size, constant over frames.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    pub(crate) dims: Dims,
    pub(crate) params: Params,
    pub(crate) models: &'static Models,
    pub(crate) support_models: &'static SupportModels,
    pub(crate) has_bars: bool,
}

impl Plan {
    /// Checks all parameters for images of this size.
    pub(crate) fn new(params: Params, dims: Dims) -> Result<Self, ParamError> {
        params.check(dims)?;
        Ok(Self { dims, params, models: &FITTED, support_models: &FITTED_SUPPORT, has_bars: true })
    }

    /// First disparity, and the one after the last, px.
    pub(crate) fn disparities(&self) -> (i32, i32) {
        (self.params.min_disparity.into(), self.params.max_disparity.into())
    }
}
