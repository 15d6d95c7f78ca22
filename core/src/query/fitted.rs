//! Written by `linestereo eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 26506,
    coefficients_q12: [
        -4065, // census: cost at the disparity / best cost elsewhere
        -8223, // windows and census together: cost at the disparity / best cost elsewhere
        -6214, // the same, elsewhere being what features nearby leave possible
        -1370, // |searched back - answer|, px
        -2885, // searching back: cost at the disparity / best cost elsewhere
        -1803, // log2(1 + mean gradient around the pixel)
        907, // log2(1 + features nearby that agree)
        -5613, // share of features nearby that contradict
        922, // distance of the nearest feature that agrees
        -2367, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -1079, // outside of what features nearby span, px
    ],
    probability_q16: [
        31, 50, 80, 130, 210, 338, 545, 877, 1407, 2244, 3553,
        5558, 8538, 12777, 18439, 25401, 33143, 40843, 47698, 53224, 56403, 58864,
        62042, 63752, 64796, 65232, 65459, 65516, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 339, 182, 90, 49, 36, 28, 22,
        18, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
