//! Written by `linestereo eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 26468,
    coefficients_q12: [
        -4082, // census: cost at the disparity / best cost elsewhere
        -8182, // windows and census together: cost at the disparity / best cost elsewhere
        -6252, // the same, elsewhere being what features nearby leave possible
        -1364, // |searched back - answer|, px
        -2885, // searching back: cost at the disparity / best cost elsewhere
        -1813, // log2(1 + mean gradient around the pixel)
        932, // log2(1 + features nearby that agree)
        -5624, // share of features nearby that contradict
        925, // distance of the nearest feature that agrees
        -2337, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -1061, // outside of what features nearby span, px
    ],
    probability_q16: [
        30, 49, 80, 129, 208, 336, 542, 872, 1399, 2234, 3539,
        5540, 8516, 12753, 18416, 25385, 33136, 40846, 47709, 53238, 56458, 58939,
        62012, 63698, 64798, 65243, 65464, 65518, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 346, 182, 90, 49, 36, 28, 22,
        18, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
