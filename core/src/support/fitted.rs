//! Written by `linestereo-lab fit-confidence` from 125 pairs of qvga, robot_world, oakd_agreed_320, oakd_agreed_640, kitti2012_640, robot_world_640, middlebury2006_third, middlebury2006_half, middlebury2005_half, small ones under 7 damages: do not edit.

use super::evidence::SUPPORT_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_SUPPORT: Model<SUPPORT_EVIDENCE> = Model {
    bias_q12: -33488,
    coefficients_q12: [
        -14061, // log2 of the paths' sum: best / second-best
        3730, // log2 of the window's cost: at the disparity / best elsewhere
        -1998, // log2(1 + the window's cost)
        863, // log2(1 + disparities compared)
        635, // log2(1 + how much worse the window is 1 px away)
        2240, // log2(1 + how much codes change along the window)
        -1715, // square of the first
        66, // square of the second
        2415, // log2(1 + neighbours that agree)
        49, // log2(1 + neighbours that contradict)
        -528, // log2(1 + hypotheses of segments nearby that agree)
        -1632, // log2(1 + hypotheses of segments nearby that contradict)
        745, // log2(1 + how much codes change along a window, on average)
    ],
    probability_q16: [
        847, 1694, 2541, 3388, 4235, 5082, 5929, 6776, 7623, 7625, 7627,
        7629, 9003, 12664, 17119, 24103, 34466, 43713, 50214, 54685, 57510, 59470,
        61190, 62514, 63324, 64011, 64474, 64787, 65022, 65397, 65433, 65531, 65533,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 356, 148, 75, 51, 38, 32, 27,
        22, 20, 17, 15, 14, 12, 12, 12, 11, 10, 10,
    ],
};
