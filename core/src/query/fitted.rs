//! Written by `linestereo-lab fit-confidence` from 2000 pixels each of 14 scenes (aloe, art, baby1,
//! books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba,
//! wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 17666,
    coefficients_q12: [
        -3087, // census: cost at the disparity / best cost elsewhere
        -5766, // windows and census together: cost at the disparity / best cost elsewhere
        -6554, // the same, elsewhere being what features nearby allow
        -1158, // |searched back - answer|, px
        -1640, // log2(1 + mean gradient around the pixel)
        720, // log2(1 + features nearby that agree)
        -2798, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -2375, // outside of what features nearby span, px
        2361, // log2(1 + support points nearby that agree)
        -5254, // share of support points nearby that contradict
    ],
    probability_q16: [
        2, 4, 6, 8, 10, 12, 14, 153, 447, 1206, 3057,
        4468, 7413, 11812, 17814, 24561, 31269, 39453, 46308, 51270, 54915, 58348,
        61318, 63342, 64624, 65226, 65481, 65524, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 446, 285, 164, 91, 53, 39, 30, 23,
        19, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
