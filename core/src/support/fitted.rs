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
            Unit { bias_q18: 4897175, output_q10: 519, weights_q10: [52, 101, -179, -1203, 18, -1286, -974, 833, -776, -1586, -254, 379, -122, 174, 65, 4447, 349, 74, -864, -1024, 281] },
            Unit { bias_q18: 899606, output_q10: -2175, weights_q10: [-260, -42, 64, 10, 88, 1065, -999, 402, -101, -283, -503, -191, -329, 157, -260, 404, -213, 13, 53, 121, -1107] },
            Unit { bias_q18: 2346537, output_q10: 716, weights_q10: [162, 422, -415, -162, 84, -1327, -233, -113, -119, -882, -273, -19, -683, -393, -138, -2344, 192, -31, 43, -1075, 504] },
            Unit { bias_q18: -5958978, output_q10: -512, weights_q10: [117, -92, -1729, 538, -98, -275, -466, -2034, 133, 2331, 366, 127, -454, -565, -27, -1559, 203, -284, 448, -220, -1010] },
            Unit { bias_q18: -11693876, output_q10: 651, weights_q10: [265, 418, -1254, 371, 226, -187, 664, 967, 922, 3663, -19, -346, 283, -2267, 126, 2297, 314, -71, 206, 186, -515] },
            Unit { bias_q18: -1317750, output_q10: 538, weights_q10: [287, -82, 336, 497, 167, -24, 251, 195, 336, 273, 484, 883, 957, -629, -352, -2010, -62, 321, 422, 463, -1949] },
            Unit { bias_q18: 6478085, output_q10: -523, weights_q10: [-209, -346, 1078, 139, 42, -957, -710, -1824, 67, -2328, -184, 382, -264, -1126, 13, 2417, 134, 174, 42, -961, -44] },
            Unit { bias_q18: 1645254, output_q10: 601, weights_q10: [234, -61, 227, 17, 84, 1738, 1719, -1057, 72, -509, -896, -546, -1675, -770, -561, -754, -322, -172, 21, 2047, 1781] },
        ],
        bias_q10: -3480,
        probability_q16: [
            1662, 3371, 4976, 6151, 8353, 12006, 18329, 25927, 33603, 41005, 47407,
            52683, 56677, 59636, 61824, 63071, 63680, 64084, 64519, 64856, 65022, 65195,
            65387, 65457, 65464, 65470, 65477, 65484, 65490, 65497, 65503, 65510, 65516,
        ],
    },
};
