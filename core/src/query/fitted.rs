use super::PIXEL_EVIDENCE;
use crate::confidence::{Model, NODES};
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> =
    Model { bias_q12: 0, coefficients_q12: [0; PIXEL_EVIDENCE], probability_q16: [0; NODES], sigma_q6: [0; NODES] };
