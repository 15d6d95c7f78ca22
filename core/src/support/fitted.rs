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
            Unit { bias_q18: -276955, output_q10: 800, weights_q10: [224, 28, 183, -20, 129, 117, 201, 1268, 216, 22, 100, 15, 724, -803, -369, -8192, -52, 275, 33, -2, -841, 62, -147, -11] },
            Unit { bias_q18: 2660757, output_q10: 667, weights_q10: [323, 155, -63, -253, 119, -1695, 205, -368, 16, -1015, -502, -1187, -616, -933, -341, -2741, -107, -175, 107, 686, 3928, -39, -97, -88] },
            Unit { bias_q18: 169630, output_q10: -1316, weights_q10: [-295, -96, 74, 222, 98, 167, -1287, 245, -138, 54, -9, -61, 316, -193, -255, 1384, -29, 7, 108, -686, -1373, 660, 64, -797] },
            Unit { bias_q18: -3992045, output_q10: 491, weights_q10: [-66, -23, -379, -147, 284, -822, -1105, 1526, -223, 1555, 940, 1111, 445, 1124, 203, 1141, 9, 98, 192, 1175, -1252, -1227, 50, 58] },
            Unit { bias_q18: -917263, output_q10: 501, weights_q10: [178, -167, 49, -239, -12, 3202, 2827, -440, 32, 456, -311, 345, -1935, 214, -187, -2262, -311, -125, 3, 1548, 633, -282, -39, -72] },
            Unit { bias_q18: -15000077, output_q10: 647, weights_q10: [5, 309, -713, 295, 354, 969, 1600, 762, 1158, 4865, 563, 334, 530, -3096, 390, 3309, 232, -263, 108, -147, -535, -505, -167, -131] },
            Unit { bias_q18: 9192067, output_q10: -357, weights_q10: [-315, -127, 1128, -784, 147, 1112, 708, 1682, 2, -3788, -327, -344, -1291, -1511, -187, 124, -109, 405, -345, -348, 240, 582, 214, 454] },
            Unit { bias_q18: 5972327, output_q10: 634, weights_q10: [106, 237, -572, -1265, 20, -1075, -345, 633, -766, -2049, -589, 290, -818, -661, -51, 3191, 412, 24, -583, -1552, 48, 279, 150, -5] },
        ],
        bias_q10: -4206,
        probability_q16: [
            3553, 3559, 4649, 5929, 7919, 12006, 18479, 26062, 33826, 41185, 47480,
            52591, 56612, 59678, 61788, 62877, 63583, 64009, 64382, 64727, 65056, 65214,
            65371, 65457, 65464, 65470, 65477, 65484, 65490, 65497, 65503, 65510, 65516,
        ],
    },
};
