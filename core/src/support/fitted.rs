//! Written by `linestereo-lab fit-confidence` from 125 pairs of qvga, robot_world, oakd_agreed_320,
//! oakd_agreed_640, kitti2012_640, robot_world_640, middlebury2006_third, middlebury2006_half,
//! middlebury2005_half, small ones under 7 damages; `upright` and `ground` before large ones were
//! matched at half of their size: do not edit.

use super::SupportModels;
use crate::confidence::Model;

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED_SUPPORT: SupportModels = SupportModels {
    upright: Model {
        bias_q12: -33293,
        coefficients_q12: [
            -13579, // log2 of the paths' sum: best / second-best
            3256, // log2 of the window's cost: at the disparity / best elsewhere
            -1974, // log2(1 + the window's cost)
            856, // log2(1 + disparities compared)
            669, // log2(1 + how much worse the window is 1 px away)
            2183, // log2(1 + how much codes change along the window)
            -1656, // square of the first
            0, // label beside the ground plane
            0, // at most 1.5 px off the ground plane
            0, // farther than the ground plane by more
            0, // log-odds of the answer at half of the size
            0, // |answer - that at half of the size|, px
            2193, // log2(1 + neighbours that agree)
            -31, // log2(1 + neighbours that contradict)
            -322, // log2(1 + hypotheses of segments nearby that agree)
            -1743, // log2(1 + hypotheses of segments nearby that contradict)
            819, // log2(1 + how much codes change along a window, on average)
        ],
        probability_q16: [
            1094, 2189, 3283, 4378, 5472, 6567, 7661, 8755, 9850, 9852, 9854,
            9856, 10288, 13120, 17512, 24085, 34194, 43432, 49910, 54522, 57478, 59486,
            61176, 62549, 63379, 64036, 64542, 64795, 64991, 65404, 65499, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 344, 148, 75, 52, 38, 32, 27,
            22, 19, 16, 15, 13, 12, 12, 11, 11, 9, 9,
        ],
    },
    ground: Model {
        bias_q12: -27439,
        coefficients_q12: [
            -11846, // log2 of the paths' sum: best / second-best
            2893, // log2 of the window's cost: at the disparity / best elsewhere
            -2305, // log2(1 + the window's cost)
            794, // log2(1 + disparities compared)
            766, // log2(1 + how much worse the window is 1 px away)
            2013, // log2(1 + how much codes change along the window)
            -1488, // square of the first
            3238, // label beside the ground plane
            3582, // at most 1.5 px off the ground plane
            -2574, // farther than the ground plane by more
            0, // log-odds of the answer at half of the size
            0, // |answer - that at half of the size|, px
            2817, // log2(1 + neighbours that agree)
            -876, // log2(1 + neighbours that contradict)
            -468, // log2(1 + hypotheses of segments nearby that agree)
            -1734, // log2(1 + hypotheses of segments nearby that contradict)
            565, // log2(1 + how much codes change along a window, on average)
        ],
        probability_q16: [
            543, 1086, 1629, 2172, 2716, 3259, 3802, 4345, 4888, 5431, 5433,
            5435, 8051, 12083, 17207, 24049, 32872, 41135, 47371, 52359, 56206, 59085,
            61269, 62712, 63651, 64353, 64831, 65135, 65317, 65448, 65525, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 332, 144, 75, 53, 39, 32, 27,
            22, 19, 17, 15, 13, 12, 12, 11, 11, 9, 7,
        ],
    },
    fine: Model {
        bias_q12: 50776,
        coefficients_q12: [
            -5578, // log2 of the paths' sum: best / second-best
            0, // log2 of the window's cost: at the disparity / best elsewhere
            -2921, // log2(1 + the window's cost)
            0, // log2(1 + disparities compared)
            734, // log2(1 + how much worse the window is 1 px away)
            1745, // log2(1 + how much codes change along the window)
            0, // square of the first
            -302, // label beside the ground plane
            2247, // at most 1.5 px off the ground plane
            1381, // farther than the ground plane by more
            625, // log-odds of the answer at half of the size
            -741, // |answer - that at half of the size|, px
            2256, // log2(1 + neighbours that agree)
            -986, // log2(1 + neighbours that contradict)
            19, // log2(1 + hypotheses of segments nearby that agree)
            -3329, // log2(1 + hypotheses of segments nearby that contradict)
            -6048, // log2(1 + how much codes change along a window, on average)
        ],
        probability_q16: [
            60, 120, 179, 239, 299, 359, 418, 478, 538, 598, 657,
            4060, 7867, 11533, 17599, 25678, 34395, 41615, 47581, 52006, 55797, 59147,
            61470, 62947, 63980, 64599, 65016, 65207, 65268, 65319, 65359, 65361, 65363,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 411, 177, 80, 56, 40, 32, 32,
            25, 22, 19, 17, 16, 16, 16, 16, 16, 16, 15,
        ],
    },
};
