//! Written by `linestereo-lab fit-confidence` from 125 pairs of qvga, robot_world, oakd_agreed_320, oakd_agreed_640, kitti2012_640, robot_world_640, middlebury2006_third, middlebury2006_half, middlebury2005_half, small ones under 7 damages: do not edit.

use super::evidence::SUPPORT_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_SUPPORT: Model<SUPPORT_EVIDENCE> = Model {
    bias_q12: -32210,
    coefficients_q12: [
        -13809, // log2 of the paths' sum: best / second-best
        3565, // log2 of the window's cost: at the disparity / best elsewhere
        -2021, // log2(1 + the window's cost)
        867, // log2(1 + disparities compared)
        651, // log2(1 + how much worse the window is 1 px away)
        2222, // log2(1 + how much codes change along the window)
        -1694, // square of the first
        39, // square of the second
        2364, // log2(1 + neighbours that agree)
        32, // log2(1 + neighbours that contradict)
        -408, // log2(1 + hypotheses of segments nearby that agree)
        -1689, // log2(1 + hypotheses of segments nearby that contradict)
        657, // log2(1 + how much codes change along a window, on average)
    ],
    probability_q16: [
        961, 1922, 2883, 3843, 4804, 5765, 6726, 7687, 8648, 8650, 8652,
        8654, 9447, 12865, 17290, 24026, 34374, 43799, 50236, 54616, 57449, 59387,
        61093, 62449, 63309, 64010, 64500, 64766, 64986, 65395, 65430, 65432, 65434,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 367, 153, 75, 51, 38, 32, 26,
        22, 19, 17, 15, 13, 12, 12, 11, 11, 9, 9,
    ],
};
