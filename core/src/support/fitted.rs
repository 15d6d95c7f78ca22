//! Written by `linestereo fit-confidence` from 35 pairs under 7 damages (Aloe, Art, Baby1, Books, Bowling2, Cloth1, Dolls, Lampshade1, Monopoly, Motorcycle, Rocks1, Wood1, aloe, art, baby1, books, bowling2, boxes, cloth1, corridor, demo, dolls, lampshade1, monopoly, motorcycle, poles, rocks1, teddy, tsukuba, wood1): do not edit.

use super::evidence::SUPPORT_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_SUPPORT: Model<SUPPORT_EVIDENCE> = Model {
    bias_q12: -37105,
    coefficients_q12: [
        -17707, // log2 of the paths' sum: best / second-best
        3751, // log2 of the window's cost: at the disparity / best elsewhere
        197, // log2(1 + the window's cost)
        1593, // log2(1 + disparities compared)
        20, // log2(1 + how much worse the window is 1 px away)
        2790, // log2(1 + ranks that change along the window)
        -3237, // square of the first
        2185, // square of the second
        4439, // log2(1 + neighbours that agree)
        -1004, // log2(1 + neighbours that contradict)
        2190, // log2(1 + hypotheses of segments nearby that agree)
        -3297, // log2(1 + hypotheses of segments nearby that contradict)
        2031, // log2(1 + ranks that change along a window, on average)
    ],
    probability_q16: [
        3, 5, 10, 19, 36, 67, 127, 239, 449, 841, 1567,
        2894, 5251, 9245, 15496, 24159, 34342, 44228, 52199, 57715, 58718, 59605,
        61595, 62946, 63735, 64289, 64672, 64938, 65123, 65251, 65339, 65400, 65443,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 512, 160, 64, 48, 38, 32, 32,
        27, 24, 21, 20, 19, 18, 16, 16, 15, 14, 13,
    ],
};
