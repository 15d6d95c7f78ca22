//! Written by `linestereo-lab fit-confidence` from 125 pairs of qvga, robot_world, oakd_agreed_320,
//! oakd_agreed_640, kitti2012_640, robot_world_640, middlebury2006_third, middlebury2006_half,
//! middlebury2005_half, small ones under 7 damages, listed where the models before these put
//! them; the network among neighbours that these models rate: do not edit.

use super::SupportModels;
use crate::confidence::{Model, Network, Unit};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED_SUPPORT: SupportModels = SupportModels {
    upright: Model {
        bias_q12: -32271,
        coefficients_q12: [
            -12735, // log2 of the paths' sum: best / second-best
            3141, // log2 of the window's cost: at the disparity / best elsewhere
            -2270, // log2(1 + the window's cost)
            842, // log2(1 + disparities compared)
            641, // log2(1 + how much worse the window is 1 px away)
            2330, // log2(1 + how much codes change along the window)
            -1653, // square of the first
            0, // label beside the ground plane
            0, // at most 1.5 px off the ground plane
            0, // farther than the ground plane by more
            0, // log-odds of the answer at half of the size
            0, // |answer - that at half of the size|, px
            3227, // log2(1 + neighbours that agree)
            -81, // log2(1 + neighbours that contradict)
            364, // log2(1 + hypotheses of segments nearby that agree)
            -1430, // log2(1 + hypotheses of segments nearby that contradict)
            698, // log2(1 + how much codes change along a window, on average)
        ],
        probability_q16: [
            489, 978, 1466, 1955, 2444, 2933, 3422, 3911, 4399, 4888, 5377,
            5379, 8651, 12778, 17093, 23962, 34166, 43546, 49841, 54234, 57477, 59565,
            60927, 62033, 62973, 63506, 63923, 64206, 64531, 64936, 65338, 65468, 65533,
        ],
    },
    ground: Model {
        bias_q12: -25207,
        coefficients_q12: [
            -11577, // log2 of the paths' sum: best / second-best
            2968, // log2 of the window's cost: at the disparity / best elsewhere
            -2620, // log2(1 + the window's cost)
            870, // log2(1 + disparities compared)
            722, // log2(1 + how much worse the window is 1 px away)
            2218, // log2(1 + how much codes change along the window)
            -1551, // square of the first
            2803, // label beside the ground plane
            3774, // at most 1.5 px off the ground plane
            -1068, // farther than the ground plane by more
            0, // log-odds of the answer at half of the size
            0, // |answer - that at half of the size|, px
            3684, // log2(1 + neighbours that agree)
            -632, // log2(1 + neighbours that contradict)
            278, // log2(1 + hypotheses of segments nearby that agree)
            -1200, // log2(1 + hypotheses of segments nearby that contradict)
            203, // log2(1 + how much codes change along a window, on average)
        ],
        probability_q16: [
            418, 836, 1253, 1671, 2089, 2507, 2925, 3343, 3760, 4178, 4596,
            4598, 8379, 11899, 16218, 23162, 33111, 41776, 47849, 52490, 56305, 59299,
            61270, 62469, 63342, 63999, 64463, 64801, 65067, 65301, 65449, 65492, 65533,
        ],
    },
    fine: Model {
        bias_q12: 57686,
        coefficients_q12: [
            -5518, // log2 of the paths' sum: best / second-best
            0, // log2 of the window's cost: at the disparity / best elsewhere
            -2666, // log2(1 + the window's cost)
            0, // log2(1 + disparities compared)
            775, // log2(1 + how much worse the window is 1 px away)
            1656, // log2(1 + how much codes change along the window)
            0, // square of the first
            -1249, // label beside the ground plane
            2206, // at most 1.5 px off the ground plane
            1550, // farther than the ground plane by more
            713, // log-odds of the answer at half of the size
            -928, // |answer - that at half of the size|, px
            2498, // log2(1 + neighbours that agree)
            -880, // log2(1 + neighbours that contradict)
            989, // log2(1 + hypotheses of segments nearby that agree)
            -2264, // log2(1 + hypotheses of segments nearby that contradict)
            -6742, // log2(1 + how much codes change along a window, on average)
        ],
        probability_q16: [
            53, 105, 158, 210, 263, 315, 368, 421, 473, 526, 578,
            3305, 7364, 10652, 16766, 25254, 33943, 41596, 48177, 53173, 56516, 59479,
            61584, 62849, 63745, 64464, 64955, 65207, 65286, 65288, 65355, 65358, 65360,
        ],
    },
    context: Network {
        units: [
            Unit { bias_q18: -114381, output_q10: -1030, weights_q10: [-107, -18, 543, 287, 93, 83, -1148, -108, 70, 176, -324, -285, 39, -162, -327, 2421, 114, -38, 121, 194, -1900, 477, 103, -1040] },
            Unit { bias_q18: 1857444, output_q10: -817, weights_q10: [-355, -45, -188, 173, 154, -43, -341, 346, -5, -844, 235, -12, -510, 105, 80, 1173, -165, 114, 124, -1066, -434, 99, 152, 427] },
            Unit { bias_q18: 2709775, output_q10: 564, weights_q10: [75, 361, -372, -490, 99, -662, 1005, -234, -970, -514, -281, -421, -152, -1880, -108, -2055, 99, -402, -544, 1276, 2654, -375, -125, -476] },
            Unit { bias_q18: -12297113, output_q10: 464, weights_q10: [126, -137, -36, 117, 279, 2026, 1118, 516, -130, 5135, -158, 646, -157, 633, -106, 4678, -180, -138, 211, 2889, -1096, -1170, 132, -482] },
            Unit { bias_q18: -1598118, output_q10: 451, weights_q10: [317, 141, 128, 150, 28, 196, 2268, -457, 654, 401, -995, -1417, -791, -3907, -231, -2841, -140, -40, 188, 684, 2511, 262, -251, -318] },
            Unit { bias_q18: -1811238, output_q10: 800, weights_q10: [274, 260, -817, -628, 15, -1450, -1023, 589, -403, 896, -809, 67, -409, -434, 200, 1472, 401, 9, -364, -1478, -1256, 406, 73, -340] },
            Unit { bias_q18: 1181203, output_q10: 537, weights_q10: [300, 8, -182, 152, 282, 1, -576, 1284, 22, -540, 793, 185, 555, -212, -328, -8192, -29, 264, 230, -526, -1658, -382, -188, 355] },
            Unit { bias_q18: -14797820, output_q10: -517, weights_q10: [-165, -42, -682, 472, 209, 986, -833, -313, -1190, 6493, 406, -45, 378, -1482, 550, -1054, 77, -360, -70, 1032, -448, -185, 85, -804] },
        ],
        bias_q10: -3597,
        probability_q16: [
            3558, 3564, 3571, 5367, 8168, 12526, 18268, 25893, 34123, 41524, 47586,
            52479, 56380, 59395, 61537, 62881, 63615, 64057, 64437, 64745, 65020, 65220,
            65356, 65447, 65464, 65470, 65477, 65484, 65490, 65497, 65503, 65510, 65516,
        ],
    },
};
