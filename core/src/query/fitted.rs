//! Written by `linestereo eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 17436,
    coefficients_q12: [
        -2704, // census: cost at the disparity / best cost elsewhere
        -6730, // windows and census together: cost at the disparity / best cost elsewhere
        -5758, // the same, elsewhere being what features nearby allow
        -1299, // |searched back - answer|, px
        -1728, // log2(1 + mean gradient around the pixel)
        319, // log2(1 + features nearby that agree)
        -2954, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -1820, // outside of what features nearby span, px
        3040, // log2(1 + support points nearby that agree)
        -3997, // share of support points nearby that contradict
    ],
    probability_q16: [
        29, 47, 76, 124, 200, 324, 523, 844, 1357, 2171, 3447,
        5409, 8338, 12523, 18142, 25090, 32853, 40607, 47529, 53117, 55761, 57922,
        61684, 63648, 64866, 65301, 65498, 65524, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 441, 289, 163, 84, 50, 38, 30, 24,
        19, 16, 14, 13, 12, 11, 11, 11, 11, 11, 11,
    ],
};
