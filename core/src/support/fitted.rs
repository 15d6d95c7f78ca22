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
            Unit { bias_q18: -1871493, output_q10: -929, weights_q10: [-373, -297, -748, -501, 28, 925, -1593, 344, -360, 1041, 242, -54, -708, -343, -114, 305] },
            Unit { bias_q18: 3375361, output_q10: -771, weights_q10: [-251, -41, 365, 1106, 259, -230, 614, 264, -315, -1265, -602, -203, 66, -675, -478, 3583] },
            Unit { bias_q18: 4907759, output_q10: 541, weights_q10: [180, 772, -688, -1974, 145, -1329, -883, 874, -1018, -1507, -518, 103, -432, -3040, -177, 2603] },
            Unit { bias_q18: 118648, output_q10: -973, weights_q10: [-73, -121, 122, 353, 63, -1369, -629, -1133, 428, -171, -75, 171, -72, 1019, -15, -1455] },
            Unit { bias_q18: 3324168, output_q10: -898, weights_q10: [-50, -395, 1081, -1006, 183, 690, 260, 1304, -11, -1287, -442, -209, -369, -1227, -429, 528] },
            Unit { bias_q18: -9985350, output_q10: 691, weights_q10: [397, 675, -906, 593, -111, 371, 1876, -381, 1321, 2870, -87, -486, -338, -4233, 937, -2041] },
            Unit { bias_q18: 1805423, output_q10: 668, weights_q10: [244, 182, 143, -117, 374, 796, 2343, -237, -96, -614, -1139, -133, -1727, -997, -705, 1741] },
            Unit { bias_q18: -519055, output_q10: 579, weights_q10: [196, -140, 1238, 1036, 297, 370, -763, 1684, 340, -88, 365, 103, 1071, 971, -704, -244] },
        ],
        bias_q10: -3315,
        probability_q16: [
            5325, 5331, 5338, 6023, 7723, 11734, 17655, 25882, 34681, 41677, 47622,
            52662, 56588, 59664, 61633, 62802, 63619, 64164, 64281, 64580, 64959, 65307,
            65422, 65428, 65438, 65470, 65477, 65484, 65490, 65497, 65503, 65510, 65516,
        ],
    },
};
