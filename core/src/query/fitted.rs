//! Written by `linestereo eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 26516,
    coefficients_q12: [
        -4067, // census: cost at the disparity / best cost elsewhere
        -8242, // windows and census together: cost at the disparity / best cost elsewhere
        -6212, // the same, elsewhere being what features nearby leave possible
        -1369, // |searched back - answer|, px
        -2892, // searching back: cost at the disparity / best cost elsewhere
        -1810, // log2(1 + mean gradient around the pixel)
        907, // log2(1 + features nearby that agree)
        -5544, // share of features nearby that contradict
        897, // distance of the nearest feature that agrees
        -2340, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -1081, // outside of what features nearby span, px
    ],
    probability_q16: [
        31, 49, 80, 129, 209, 337, 544, 875, 1403, 2239, 3547,
        5551, 8532, 12773, 18439, 25409, 33159, 40865, 47722, 53247, 56417, 58872,
        62033, 63741, 64796, 65234, 65460, 65517, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 337, 183, 90, 48, 36, 28, 22,
        18, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
