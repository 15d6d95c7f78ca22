//! Written by `linestereo-lab fit-confidence` from 2000 pixels each of 14 scenes (aloe, art, baby1,
//! books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba,
//! wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::{Model, SigmaModel};

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: SigmaModel<PIXEL_EVIDENCE> = SigmaModel {
    model: Model {
        bias_q12: 18049,
        coefficients_q12: [
            -3096, // census: cost at the disparity / best cost elsewhere
            -5948, // windows and census together: cost at the disparity / best cost elsewhere
            -6602, // the same, elsewhere being what features nearby allow
            -1156, // |searched back - answer|, px
            -1677, // log2(1 + mean gradient around the pixel)
            746, // log2(1 + features nearby that agree)
            -2804, // log2(1 + surfaces that end at an edge before the pixel and agree)
            -2341, // outside of what features nearby span, px
            2252, // log2(1 + support points nearby that agree)
            -5472, // share of support points nearby that contradict
        ],
        probability_q16: [
            28, 56, 84, 112, 140, 168, 196, 345, 579, 1276, 3150,
            4594, 7153, 11580, 17537, 24704, 31518, 39210, 46256, 51163, 54749, 58460,
            61423, 63367, 64627, 65230, 65484, 65524, 65526, 65527, 65529, 65531, 65533,
        ],
    },
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 450, 285, 164, 94, 53, 39, 30, 23,
        19, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
