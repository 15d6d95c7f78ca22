//! Written by `linestereo-lab fit-confidence` from 2000 pixels each of 14 scenes (aloe, art, baby1,
//! books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba,
//! wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 17637,
    coefficients_q12: [
        -3082, // census: cost at the disparity / best cost elsewhere
        -5770, // windows and census together: cost at the disparity / best cost elsewhere
        -6556, // the same, elsewhere being what features nearby allow
        -1159, // |searched back - answer|, px
        -1632, // log2(1 + mean gradient around the pixel)
        716, // log2(1 + features nearby that agree)
        -2797, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -2374, // outside of what features nearby span, px
        2371, // log2(1 + support points nearby that agree)
        -5233, // share of support points nearby that contradict
    ],
    probability_q16: [
        2, 4, 6, 8, 10, 12, 14, 153, 447, 1199, 3049,
        4466, 7343, 11878, 17824, 24504, 31226, 39518, 46387, 51221, 54857, 58293,
        61350, 63354, 64619, 65223, 65480, 65524, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 447, 287, 164, 90, 53, 39, 30, 23,
        19, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
