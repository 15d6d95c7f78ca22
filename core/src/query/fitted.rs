//! Written by `linestereo eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 17510,
    coefficients_q12: [
        -2662, // census: cost at the disparity / best cost elsewhere
        -6511, // windows and census together: cost at the disparity / best cost elsewhere
        -6098, // the same, elsewhere being what features nearby allow
        -1297, // |searched back - answer|, px
        -1737, // log2(1 + mean gradient around the pixel)
        352, // log2(1 + features nearby that agree)
        -3035, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -1917, // outside of what features nearby span, px
        2981, // log2(1 + support points nearby that agree)
        -4020, // share of support points nearby that contradict
    ],
    probability_q16: [
        30, 48, 78, 125, 203, 328, 529, 852, 1368, 2187, 3468,
        5437, 8372, 12559, 18176, 25114, 32862, 40600, 47511, 53093, 55745, 57913,
        61672, 63638, 64869, 65305, 65498, 65524, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 440, 287, 161, 85, 51, 38, 30, 24,
        19, 16, 14, 13, 12, 11, 11, 11, 11, 11, 11,
    ],
};
