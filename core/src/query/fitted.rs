//! Written by `linestereo-lab eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 17363,
    coefficients_q12: [
        -2639, // census: cost at the disparity / best cost elsewhere
        -6770, // windows and census together: cost at the disparity / best cost elsewhere
        -5769, // the same, elsewhere being what features nearby allow
        -1296, // |searched back - answer|, px
        -1709, // log2(1 + mean gradient around the pixel)
        317, // log2(1 + features nearby that agree)
        -2923, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -1808, // outside of what features nearby span, px
        3060, // log2(1 + support points nearby that agree)
        -4027, // share of support points nearby that contradict
    ],
    probability_q16: [
        29, 48, 77, 125, 202, 326, 526, 848, 1362, 2177, 3454,
        5417, 8346, 12527, 18139, 25076, 32828, 40573, 47493, 53083, 55793, 57998,
        61713, 63657, 64853, 65291, 65496, 65524, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 447, 285, 161, 82, 50, 38, 30, 24,
        20, 16, 14, 13, 12, 11, 11, 11, 11, 11, 11,
    ],
};
