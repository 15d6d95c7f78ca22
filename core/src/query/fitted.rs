//! Written by `linestereo eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 26790,
    coefficients_q12: [
        -4084, // census: cost at the disparity / best cost elsewhere
        -8469, // windows and census together: cost at the disparity / best cost elsewhere
        -5907, // the same, elsewhere being what features nearby leave possible
        -1375, // |searched back - answer|, px
        -2871, // searching back: cost at the disparity / best cost elsewhere
        -1794, // log2(1 + mean gradient around the pixel)
        854, // log2(1 + features nearby that agree)
        -5869, // share of features nearby that contradict
        642, // distance of the nearest feature that agrees
        -2416, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -1037, // outside of what features nearby span, px
    ],
    probability_q16: [
        31, 50, 81, 131, 211, 340, 548, 880, 1410, 2248, 3555,
        5556, 8529, 12754, 18397, 25338, 33061, 40751, 47608, 53145, 56513, 59077,
        62047, 63693, 64779, 65228, 65456, 65515, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 339, 181, 89, 48, 36, 28, 22,
        18, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
