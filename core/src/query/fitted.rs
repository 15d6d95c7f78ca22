//! Written by `linestereo eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 25531,
    coefficients_q12: [
        -3928, // census: cost at the disparity / best cost elsewhere
        -8325, // windows and census together: cost at the disparity / best cost elsewhere
        -6160, // the same, elsewhere being what features nearby leave possible
        -1350, // |searched back - answer|, px
        -2957, // searching back: cost at the disparity / best cost elsewhere
        -1868, // log2(1 + mean gradient around the pixel)
        1245, // log2(1 + features nearby that agree)
        -4961, // share of features nearby that contradict
        1238, // distance of the nearest feature that agrees
        -2587, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -984, // outside of what features nearby span, px
    ],
    probability_q16: [
        29, 47, 77, 124, 201, 326, 527, 850, 1367, 2189, 3477,
        5458, 8415, 12636, 18296, 25281, 33065, 40816, 47714, 53266, 56861, 59521,
        61884, 63352, 64796, 65289, 65469, 65518, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 346, 168, 85, 48, 36, 27, 21,
        18, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
