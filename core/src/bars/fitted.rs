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
            2944, 3259, -466, -23678, -21236, 45773, 2866, 5977, -1201,
            5834, -2417, 6051, 7170, 1389, 5437, -2195, 746, 16056,
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
            490, 3867, -33335, -38835, -33069, 52623, 7176, 1024, -2268,
            -3313, 14254, -3774, 3139, -413, 20147, 20147, 3268, 0,
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
