//! Written by `linestereo-lab fit-confidence` from 35 pairs under 7 damages (Aloe, Art, Baby1, Books, Bowling2, Cloth1, Dolls, Lampshade1, Monopoly, Motorcycle, Rocks1, Wood1, aloe, art, baby1, books, bowling2, boxes, cloth1, corridor, demo, dolls, lampshade1, monopoly, motorcycle, poles, rocks1, teddy, tsukuba, wood1): do not edit.

use super::evidence::SUPPORT_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_SUPPORT: Model<SUPPORT_EVIDENCE> = Model {
    bias_q12: -37185,
    coefficients_q12: [
        -17680, // log2 of the paths' sum: best / second-best
        3721, // log2 of the window's cost: at the disparity / best elsewhere
        194, // log2(1 + the window's cost)
        1598, // log2(1 + disparities compared)
        11, // log2(1 + how much worse the window is 1 px away)
        2797, // log2(1 + ranks that change along the window)
        -3232, // square of the first
        2177, // square of the second
        4432, // log2(1 + neighbours that agree)
        -1002, // log2(1 + neighbours that contradict)
        2191, // log2(1 + hypotheses of segments nearby that agree)
        -3311, // log2(1 + hypotheses of segments nearby that contradict)
        2048, // log2(1 + ranks that change along a window, on average)
    ],
    probability_q16: [
        3, 5, 10, 19, 36, 67, 127, 239, 449, 841, 1568,
        2894, 5250, 9242, 15489, 24147, 34325, 44211, 52184, 57704, 58714, 59608,
        61599, 62950, 63738, 64291, 64674, 64940, 65124, 65252, 65340, 65401, 65443,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 512, 160, 64, 48, 38, 32, 32,
        27, 24, 21, 20, 19, 18, 16, 16, 15, 14, 13,
    ],
};
