//! Written by `linestereo-lab fit-confidence` from 2000 pixels each of 14 scenes (aloe, art, baby1,
//! books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba,
//! wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::{Model, SigmaModel};

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: SigmaModel<PIXEL_EVIDENCE> = SigmaModel {
    model: Model {
        bias_q12: 18069,
        coefficients_q12: [
            -3101, // census: cost at the disparity / best cost elsewhere
            -5884, // windows and census together: cost at the disparity / best cost elsewhere
            -6661, // the same, elsewhere being what features nearby allow
            -1166, // |searched back - answer|, px
            -1679, // log2(1 + mean gradient around the pixel)
            755, // log2(1 + features nearby that agree)
            -2802, // log2(1 + surfaces that end at an edge before the pixel and agree)
            -2365, // outside of what features nearby span, px
            2231, // log2(1 + support points nearby that agree)
            -5416, // share of support points nearby that contradict
        ],
        probability_q16: [
            3, 7, 10, 13, 17, 20, 23, 277, 593, 1312, 3175,
            4551, 7149, 11632, 17624, 24708, 31597, 39184, 46288, 51178, 54799, 58455,
            61370, 63355, 64633, 65233, 65484, 65524, 65526, 65527, 65529, 65531, 65533,
        ],
    },
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 451, 283, 163, 93, 53, 39, 30, 23,
        19, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
