//! Written by `linestereo fit-confidence` from 31 pairs under 7 damages (Aloe, Art, Baby1, Books, Bowling2, Cloth1, Dolls, Lampshade1, Monopoly, Motorcycle, Rocks1, Wood1, aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::evidence::SUPPORT_EVIDENCE;
use crate::confidence::Model;

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_SUPPORT: Model<SUPPORT_EVIDENCE> = Model {
    bias_q12: -30337,
    coefficients_q12: [
        -18181, // log2 of the paths' sum: best / second-best
        2871, // log2 of the window's cost: at the disparity / best elsewhere
        2507, // log2(1 + the window's cost)
        2071, // log2(1 + disparities compared)
        466, // log2(1 + how much worse the window is 1 px away)
        -3323, // square of the first
        2429, // square of the second
        4396, // log2(1 + neighbours that agree)
        -995, // log2(1 + neighbours that contradict)
        2568, // log2(1 + claims of segments nearby that agree)
        -3680, // log2(1 + claims of segments nearby that contradict)
    ],
    probability_q16: [
        2, 5, 9, 17, 33, 62, 118, 223, 423, 800, 1505,
        2803, 5131, 9112, 15395, 24156, 34475, 44465, 52460, 57940, 58585, 59181,
        61402, 62881, 63633, 64177, 64592, 64881, 65083, 65223, 65319, 65386, 65433,
    ],
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 512, 512, 512, 160, 64, 48, 40, 32, 32,
        27, 24, 22, 20, 19, 18, 16, 16, 15, 14, 13,
    ],
};
