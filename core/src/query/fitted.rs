//! Written by `linestereo eval-pixels` from 2000 pixels each of 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: Model<PIXEL_EVIDENCE> = Model {
    bias_q12: 24853,
    coefficients_q12: [
        -3994, // census: cost at the disparity / best cost elsewhere
        -8175, // windows and census together: cost at the disparity / best cost elsewhere
        -6325, // the same, elsewhere being what features nearby leave possible
        -1370, // |searched back - answer|, px
        -2900, // searching back: cost at the disparity / best cost elsewhere
        -1878, // log2(1 + mean gradient around the pixel)
        1423, // log2(1 + features nearby that agree)
        -4935, // share of features nearby that contradict
        2115, // distance of the nearest feature that agrees
        -2479, // log2(1 + surfaces that end at an edge before the pixel and agree)
        -1019, // outside of what features nearby span, px
    ],
    probability_q16: [
        28, 46, 75, 121, 197, 319, 517, 836, 1348, 2162, 3443,
        5416, 8367, 12591, 18265, 25276, 33094, 40875, 47790, 53345, 56787, 59370,
        61869, 63391, 64814, 65297, 65469, 65517, 65526, 65527, 65529, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 347, 176, 82, 48, 36, 27, 21,
        18, 15, 13, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
