//! Written by `linestereo-lab fit-confidence` from 22 pairs under 7 damages (Aloe, Baby1, Bowling2, Cloth1, Lampshade1, Monopoly, Rocks1, Wood1, aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::evidence::SUPPORT_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_SUPPORT: Model<SUPPORT_EVIDENCE> = Model {
    bias_q12: -45134,
    coefficients_q12: [
        -11129, // log2 of the paths' sum: best / second-best
        3246, // log2 of the window's cost: at the disparity / best elsewhere
        -3722, // log2(1 + the window's cost)
        1511, // log2(1 + disparities compared)
        776, // log2(1 + how much worse the window is 1 px away)
        2689, // log2(1 + how much codes change along the window)
        -1370, // square of the first
        -48, // square of the second
        3213, // log2(1 + neighbours that agree)
        -324, // log2(1 + neighbours that contradict)
        -493, // log2(1 + hypotheses of segments nearby that agree)
        -1809, // log2(1 + hypotheses of segments nearby that contradict)
        3993, // log2(1 + codes that change along a window, on average)
    ],
    probability_q16: [
        16, 27, 46, 77, 129, 217, 366, 614, 1028, 1715, 2840,
        4648, 7471, 11680, 17543, 24985, 33387, 41708, 48946, 54563, 57423, 59619,
        61933, 63375, 64293, 64825, 65166, 65344, 65437, 65485, 65509, 65522, 65529,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 357, 160, 76, 53, 38, 32, 26,
        22, 19, 16, 14, 13, 12, 11, 11, 10, 10, 8,
    ],
};
