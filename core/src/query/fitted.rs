//! Written by `linestereo-lab eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 17602,
    coefficients_q12: [
        -3085, // census: cost at the disparity / best cost elsewhere
        -5791, // windows and census together: cost at the disparity / best cost elsewhere
        -6501, // the same, elsewhere being what features nearby allow
        -1159, // |searched back - answer|, px
        -1634, // log2(1 + mean gradient around the pixel)
        728, // log2(1 + features nearby that agree)
        -2801, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -2373, // outside of what features nearby span, px
        2371, // log2(1 + support points nearby that agree)
        -5228, // share of support points nearby that contradict
    ],
    probability_q16: [
        2, 4, 6, 8, 10, 12, 14, 154, 454, 1218, 2998,
        4459, 7379, 11882, 17893, 24537, 31174, 39497, 46399, 51202, 54847, 58305,
        61360, 63353, 64617, 65223, 65481, 65524, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 448, 288, 165, 90, 53, 39, 30, 23,
        19, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
