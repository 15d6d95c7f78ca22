//! Written by `linestereo-lab fit-confidence` from 2000 pixels each of 14 scenes (aloe, art, baby1,
//! books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba,
//! wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::{Model, SigmaModel};

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: SigmaModel<PIXEL_EVIDENCE> = SigmaModel {
    model: Model {
        bias_q12: 18030,
        coefficients_q12: [
            -3094, // census: cost at the disparity / best cost elsewhere
            -5888, // windows and census together: cost at the disparity / best cost elsewhere
            -6654, // the same, elsewhere being what features nearby allow
            -1157, // |searched back - answer|, px
            -1675, // log2(1 + mean gradient around the pixel)
            747, // log2(1 + features nearby that agree)
            -2821, // log2(1 + surfaces that end at an edge before the pixel and agree)
            -2335, // outside of what features nearby span, px
            2254, // log2(1 + support points nearby that agree)
            -5472, // share of support points nearby that contradict
        ],
        probability_q16: [
            28, 55, 83, 111, 138, 166, 194, 341, 581, 1277, 3163,
            4616, 7084, 11476, 17530, 24753, 31614, 39280, 46260, 51130, 54782, 58446,
            61403, 63361, 64624, 65228, 65484, 65524, 65526, 65527, 65529, 65531, 65533,
        ],
    },
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 448, 285, 164, 94, 53, 39, 30, 23,
        19, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
