//! Written by `linestereo-lab fit-confidence` from 2000 pixels each of 70 scenes (aloe, art, baby1,
//! books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1,
//! 00_living, 02_stairs_down, 04_dining_legs, 06_corridor, 08_desk_arm, 100_dining_legs,
//! 102_corridor, 104_desk_arm, 106_window, 108_drop_off, 10_window, 110_doorway, 12_drop_off,
//! 14_doorway, 16_kitchen, 18_night_lamp, 20_warehouse, 22_blank_wall, 24_office, 26_glossy_mirror,
//! 28_stairs_up, 30_yard, 32_living, 34_stairs_down, 36_dining_legs, 38_corridor, 40_desk_arm,
//! 42_window, 44_drop_off, 46_doorway, 48_kitchen, 50_night_lamp, 52_warehouse, 54_blank_wall,
//! 56_office, 58_glossy_mirror, 60_stairs_up, 62_yard, 64_living, 66_stairs_down, 68_dining_legs,
//! 70_corridor, 72_desk_arm, 74_window, 76_drop_off, 78_doorway, 80_kitchen, 82_night_lamp,
//! 84_warehouse, 86_blank_wall, 88_office, 90_glossy_mirror, 92_stairs_up, 94_yard, 96_living,
//! 98_stairs_down): do not edit.

use super::PIXEL_EVIDENCE;
use crate::confidence::{Model, SigmaModel};

/// The model that plans use unless they are given another.
#[rustfmt::skip]
pub const FITTED_PIXEL: SigmaModel<PIXEL_EVIDENCE> = SigmaModel {
    model: Model {
        bias_q12: 12622,
        coefficients_q12: [
            -35, -6548, -4886, -932, -1706, 1027, -2157, -3040, 2965, -3525,
        ],
        probability_q16: [
            61, 121, 182, 243, 304, 348, 534, 838, 1434, 2504, 3615,
            4650, 7214, 11248, 17630, 25035, 31902, 38749, 45701, 52139, 56964, 60176,
            62268, 63514, 64023, 64783, 65460, 65524, 65526, 65527, 65529, 65531, 65533,
        ],
    },
    sigma_q6: [
        512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
        512, 512, 412, 267, 172, 115, 82, 58, 41, 31, 24,
        19, 15, 13, 12, 12, 11, 11, 11, 11, 11, 11,
    ],
};
