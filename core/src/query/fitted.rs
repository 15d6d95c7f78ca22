//! Written by `linestereo eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 27462,
    coefficients_q12: [
        -4718, // census: cost at the disparity / best cost elsewhere
        -9247, // windows and census together: cost at the disparity / best cost elsewhere
        -5125, // the same, elsewhere being what features nearby leave possible
        -1503, // |searched back - answer|, px
        -2880, // searching back: cost at the disparity / best cost elsewhere
        -2127, // log2(1 + mean gradient around the pixel)
        792, // log2(1 + features nearby that agree)
        -5184, // share of features nearby that contradict
        601, // distance of the nearest feature that agrees
        0,
        -1196, // outside of what features nearby span, px
    ],
    probability_q16: [
        29, 47, 76, 124, 201, 325, 525, 848, 1364, 2185, 3472,
        5452, 8408, 12630, 18293, 25283, 33073, 40829, 47730, 53282, 56503, 58982,
        62001, 63674, 64930, 65341, 65475, 65517, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 339, 183, 82, 52, 36, 27, 20,
        17, 14, 13, 12, 11, 11, 11, 11, 11, 11, 11,
    ],
};
