//! Written by `linestereo-lab fit-confidence` from 125 pairs of qvga, robot_world, oakd_agreed_320, oakd_agreed_640, kitti2012_640, robot_world_640, middlebury2006_third, middlebury2006_half, middlebury2005_half, small ones under 7 damages: do not edit.

use super::evidence::SUPPORT_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_SUPPORT: Model<SUPPORT_EVIDENCE> = Model {
    bias_q12: -33293,
    coefficients_q12: [
        -13579, // log2 of the paths' sum: best / second-best
        3256, // log2 of the window's cost: at the disparity / best elsewhere
        -1974, // log2(1 + the window's cost)
        856, // log2(1 + disparities compared)
        669, // log2(1 + how much worse the window is 1 px away)
        2183, // log2(1 + how much codes change along the window)
        -1656, // square of the first
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
};
