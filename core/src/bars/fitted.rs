//! Written by `linestereo-lab thin` from 420 pairs with poles in scenes of qvga, and what
//! repeats: do not edit.

use super::evidence::BAR_EVIDENCE;
use crate::confidence::{Model, SigmaModel};

/// The model of bars in front of what is around them.
#[rustfmt::skip]
pub const FITTED_BAR: SigmaModel<BAR_EVIDENCE> = SigmaModel {
    model: Model {
        bias_q12: -32727,
        coefficients_q12: [
            1031, // log2 of the lowest cost elsewhere / the cost
            20510, // the lowest cost elsewhere / the bar's own gradients
            -26377, // the cost / the bar's own gradients
            -11394, // share of rows with the left edge in the right image
            -14233, // share of rows with the right edge in the right image
            26281, // the lesser of both
            11573, // the cost of the most similar place of the left image / the bar's own gradients
            -1221, // log2(1 + width)
            600, // log2(1 + rows)
            3695, // log2(1 + gradient of the weaker edge)
            7180, // sum of the second edge's gradients / sum of their magnitudes
            -841, // |difference of the halves' disparities|, px
            2511, // 1 if both edges have the same sign
            3328, // log2(1 + disparities compared)
            -6346, // share of the support points around it that agree
            -22672, // share of those that are farther
            -5390, // share of those that are nearer
            6793, // 1 if there is none
        ],
        probability_q16: [
            1741, 3482, 5224, 6965, 8706, 10447, 12189, 13930, 15671, 17412, 19154,
            20895, 22636, 24377, 24780, 25283, 35569, 42015, 46070, 53523, 53525, 55750,
            59586, 62564, 64184, 64458, 64695, 64696, 65036, 65271, 65273, 65468, 65533,
        ],
    },
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 26, 26,
        26, 26, 22, 19, 19, 19, 19, 19, 15, 14, 13,
        12, 10, 10, 9, 8, 7, 7, 7, 6, 6, 6,
    ],
};

/// The model of bars level with what is around them.
#[rustfmt::skip]
pub const FITTED_LEVEL_BAR: SigmaModel<BAR_EVIDENCE> = SigmaModel {
    model: Model {
        bias_q12: 42486,
        coefficients_q12: [
            3518, // log2 of the lowest cost elsewhere / the cost
            -636, // the lowest cost elsewhere / the bar's own gradients
            -15029, // the cost / the bar's own gradients
            -28509, // share of rows with the left edge in the right image
            -26746, // share of rows with the right edge in the right image
            33685, // the lesser of both
            1576, // the cost of the most similar place of the left image / the bar's own gradients
            742, // log2(1 + width)
            -3104, // log2(1 + rows)
            -850, // log2(1 + gradient of the weaker edge)
            -9698, // sum of the second edge's gradients / sum of their magnitudes
            -4485, // |difference of the halves' disparities|, px
            193, // 1 if both edges have the same sign
            -487, // log2(1 + disparities compared)
            19491, // share of the support points around it that agree
            19844, // share of those that are farther
            1667, // share of those that are nearer
            0, // 1 if there is none
        ],
        probability_q16: [
            3379, 6757, 10136, 13514, 16893, 20271, 23650, 27028, 30407, 33786, 37164,
            40543, 43921, 47300, 50678, 54057, 54059, 54061, 54063, 55929, 58147, 60010,
            61704, 62342, 62738, 63439, 63689, 64338, 64614, 64806, 65051, 65053, 65055,
        ],
    },
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 26, 22, 21, 21, 21, 21, 21, 21, 19, 17,
        16, 14, 11, 9, 8, 7, 6, 5, 5, 5, 5,
    ],
};
