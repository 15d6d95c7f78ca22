//! Written by `linestereo fit-confidence` from 35 pairs under 7 damages (Aloe, Art, Baby1, Books, Bowling2, Cloth1, Dolls, Lampshade1, Monopoly, Motorcycle, Rocks1, Wood1, aloe, art, baby1, books, bowling2, boxes, cloth1, corridor, demo, dolls, lampshade1, monopoly, motorcycle, poles, rocks1, teddy, tsukuba, wood1): do not edit.

use super::evidence::SUPPORT_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_SUPPORT: Model<SUPPORT_EVIDENCE> = Model {
    bias_q12: -37036,
    coefficients_q12: [
        -17691, // log2 of the paths' sum: best / second-best
        3750, // log2 of the window's cost: at the disparity / best elsewhere
        198, // log2(1 + the window's cost)
        1594, // log2(1 + disparities compared)
        20, // log2(1 + how much worse the window is 1 px away)
        2787, // log2(1 + ranks that change along the window)
        -3235, // square of the first
        2184, // square of the second
        4430, // log2(1 + neighbours that agree)
        -994, // log2(1 + neighbours that contradict)
        2240, // log2(1 + hypotheses of segments nearby that agree)
        -3333, // log2(1 + hypotheses of segments nearby that contradict)
        2017, // log2(1 + ranks that change along a window, on average)
    ],
    probability_q16: [
        3, 5, 10, 19, 36, 67, 126, 238, 448, 839, 1565,
        2890, 5246, 9239, 15491, 24158, 34346, 44237, 52209, 57724, 58720, 59603,
        61596, 62948, 63736, 64289, 64671, 64937, 65122, 65250, 65338, 65400, 65442,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 512, 160, 64, 48, 38, 32, 32,
        27, 24, 21, 20, 19, 18, 16, 16, 15, 14, 13,
    ],
};
