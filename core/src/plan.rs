//! Parameters, checked once for one image size, and the models that rate evidence.

use crate::confidence::{FITTED, Model, Models};
use crate::image::Dims;
use crate::params::{ParamError, Params};
use crate::query::{FITTED_PIXEL, PIXEL_EVIDENCE};
use crate::rig::Rig;
use crate::support::{FITTED_SUPPORT, SupportModels};

/// Checked parameters for one image size, constant over frames.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    pub(crate) dims: Dims,
    pub(crate) params: Params,
    pub(crate) models: &'static Models,
    pub(crate) pixel_model: &'static Model<PIXEL_EVIDENCE>,
    pub(crate) support_models: &'static SupportModels,
    pub(crate) has_bars: bool,
}

impl Params {
    /// Checks all parameters for images of this size.
    pub fn plan(self, dims: Dims) -> Result<Plan, ParamError> {
        self.check(dims)?;
        Ok(Plan {
            dims,
            params: self,
            models: &FITTED,
            pixel_model: &FITTED_PIXEL,
            support_models: &FITTED_SUPPORT,
            has_bars: true,
        })
    }
}

impl Plan {
    /// Size of both images.
    #[must_use]
    pub fn dims(&self) -> Dims {
        self.dims
    }

    /// The rig that depths are measured with.
    #[must_use]
    pub const fn rig(&self) -> Option<Rig> {
        self.params.rig
    }

    /// The same plan with other confidence models.
    #[must_use]
    pub fn with_models(self, models: &'static Models) -> Self {
        Self { models, ..self }
    }

    /// The same plan with other confidence models for support points.
    #[must_use]
    pub fn with_support_models(self, support_models: &'static SupportModels) -> Self {
        Self { support_models, ..self }
    }

    /// The same plan without bars, for comparisons.
    #[doc(hidden)]
    #[must_use]
    pub fn without_bars(self) -> Self {
        Self { has_bars: false, ..self }
    }
}
