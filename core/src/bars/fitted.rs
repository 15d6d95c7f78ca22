//! Written by `linestereo-lab thin` from 1500 pairs with poles in scenes of qvga, robot_world, and
//! what repeats: do not edit.

use super::evidence::BAR_EVIDENCE;
use crate::confidence::{Model, SigmaModel};

/// The model of bars in front of what is around them.
#[rustfmt::skip]
pub const FITTED_BAR: SigmaModel<BAR_EVIDENCE> = SigmaModel {
    model: Model {
        bias_q12: -38895,
        coefficients_q12: [
            2944, // log2 of the lowest cost elsewhere / the cost
            3259, // the lowest cost elsewhere / the bar's own gradients
            -466, // the cost / the bar's own gradients
            -23678, // share of rows with the left edge in the right image
            -21236, // share of rows with the right edge in the right image
            45773, // the lesser of both
            2866, // the cost of the most similar place of the left image / the bar's own gradients
            5977, // log2(1 + width)
            -1201, // log2(1 + rows)
            5834, // log2(1 + gradient of the weaker edge)
            -2417, // sum of the second edge's gradients / sum of their magnitudes
            6051, // |difference of the halves' disparities|, px
            7170, // 1 if both edges have the same sign
            1389, // log2(1 + disparities compared)
            5437, // share of the support points around it that agree
            -2195, // share of those that are farther
            746, // share of those that are nearer
            16056, // 1 if there is none
        ],
        probability_q16: [
            225, 451, 676, 901, 1127, 1352, 1577, 1803, 2028, 2253, 2479,
            2704, 2929, 8985, 20351, 25274, 25883, 40328, 53727, 56303, 57687, 58806,
            60996, 62511, 63609, 64287, 64289, 64291, 64293, 64295, 65310, 65457, 65533,
        ],
    },
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 263, 255, 251, 158, 31, 13, 12, 12, 11,
        10, 10, 9, 9, 9, 8, 8, 8, 8, 8, 7,
    ],
};

/// The model of bars level with what is around them.
#[rustfmt::skip]
pub const FITTED_LEVEL_BAR: SigmaModel<BAR_EVIDENCE> = SigmaModel {
    model: Model {
        bias_q12: 24872,
        coefficients_q12: [
            490, // log2 of the lowest cost elsewhere / the cost
            3867, // the lowest cost elsewhere / the bar's own gradients
            -33335, // the cost / the bar's own gradients
            -38835, // share of rows with the left edge in the right image
            -33069, // share of rows with the right edge in the right image
            52623, // the lesser of both
            7176, // the cost of the most similar place of the left image / the bar's own gradients
            1024, // log2(1 + width)
            -2268, // log2(1 + rows)
            -3313, // log2(1 + gradient of the weaker edge)
            14254, // sum of the second edge's gradients / sum of their magnitudes
            -3774, // |difference of the halves' disparities|, px
            3139, // 1 if both edges have the same sign
            -413, // log2(1 + disparities compared)
            20147, // share of the support points around it that agree
            20147, // share of those that are farther
            3268, // share of those that are nearer
            0, // 1 if there is none
        ],
        probability_q16: [
            2681, 5362, 8043, 10724, 13405, 16086, 18768, 21449, 24130, 26811, 29492,
            32173, 34854, 37535, 38215, 38217, 45165, 48421, 51083, 55339, 56359, 58172,
            60220, 62124, 63980, 64255, 64488, 64561, 64743, 64945, 64947, 64948, 64974,
        ],
    },
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        299, 131, 66, 66, 66, 52, 50, 42, 33, 23, 19,
        15, 13, 10, 8, 6, 6, 5, 5, 4, 4, 4,
    ],
};
