//! Written by `linestereo-lab fit-confidence` from 2000 pixels each of 14 scenes (aloe, art, baby1,
//! books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba,
//! wood1): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::{Model, SigmaModel};

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: SigmaModel<PIXEL_EVIDENCE> = SigmaModel {
    model: Model {
        bias_q12: 18075,
        coefficients_q12: [
            -3110, // census: cost at the disparity / best cost elsewhere
            -5880, // windows and census together: cost at the disparity / best cost elsewhere
            -6666, // the same, elsewhere being what features nearby allow
            -1166, // |searched back - answer|, px
            -1680, // log2(1 + mean gradient around the pixel)
            751, // log2(1 + features nearby that agree)
            -2805, // log2(1 + surfaces that end at an edge before the pixel and agree)
            -2365, // outside of what features nearby span, px
            2236, // log2(1 + support points nearby that agree)
            -5410, // share of support points nearby that contradict
        ],
        probability_q16: [
            3, 7, 10, 13, 17, 20, 23, 276, 593, 1314, 3176,
            4557, 7153, 11637, 17608, 24662, 31568, 39190, 46317, 51172, 54798, 58465,
            61369, 63355, 64632, 65232, 65485, 65524, 65526, 65527, 65529, 65531, 65533,
        ],
    },
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 450, 284, 164, 93, 52, 39, 30, 23,
        19, 15, 14, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
