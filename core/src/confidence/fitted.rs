//! Written by `linestereo-lab fit-confidence` from 125 pairs of qvga, robot_world, oakd_agreed_320, oakd_agreed_640, kitti2012_640, robot_world_640, middlebury2006_third, middlebury2006_half, middlebury2005_half, small ones under 7 damages: do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    near_vertical: Model {
        bias_q12: -870,
        coefficients_q12: [
            -7452, // this side's window: cost at the disparity / best cost elsewhere
            1106, // log2(1 + that cost per pixel)
            1032, // log2(1 + how much worse elsewhere is, per pixel)
            11586, // segment window: best cost / best elsewhere
            -3124, // log2(1 + its cost per pixel)
            3318, // census: best cost / best elsewhere
            1214, // log2(1 + its cost per point)
            -5893, // this side's census: cost at the disparity / best elsewhere
            -3247, // |window - census|, px
            -13388, // |difference of the halves' disparities| per row or column
            -1270, // log2(1 + rows or columns)
            -274, // the other side's window ratio
            -1609, // 1 if the other side prefers another disparity
            -2945, // 1 if this side alone prefers another disparity
            -7932, // 1 if the right image has no such edge there
            -2285, // |the edge in the right image - halves|, px
            169, // -1 left of or above the edge, +1 right or below
            -437, // slope against its direction, px per px
            1077, // log2(1 + disparities compared)
            -126, // log2(1 + grey step)
            1983, // log2(1 + how much codes change along a window of the image, on average)
            1596, // log2(1 + support points nearby that agree)
            -16306, // share of those that are farther
            -9623, // share of those that are nearer
            817, // log2(1 + segments nearby that agree)
            -1786, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            -877, // how unique the other side is at a nearer disparity, 0 ..= 1
            -1078, // distance of the pixel from the edge, px
            -884, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            59, 118, 177, 236, 295, 354, 413, 472, 3318, 7744, 9339,
            11737, 17184, 23672, 28546, 31613, 33293, 39432, 45137, 49060, 53274, 57328,
            59919, 61510, 62652, 63431, 63893, 64171, 64264, 65250, 65252, 65254, 65256,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 273, 273, 273,
            273, 273, 273, 166, 133, 116, 80, 48, 33, 26, 22,
            19, 16, 15, 13, 13, 11, 10, 10, 10, 10, 10,
        ],
    },
    near_horizontal: Model {
        bias_q12: -911,
        coefficients_q12: [
            -1729, // this side's window: cost at the disparity / best cost elsewhere
            335, // log2(1 + that cost per pixel)
            -816, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -5677, // census: best cost / best elsewhere
            1294, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3186, // |window - census|, px
            -28196, // |difference of the halves' disparities| per row or column
            -2824, // log2(1 + rows or columns)
            -1686, // the other side's window ratio
            69, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -177, // -1 left of or above the edge, +1 right or below
            -3306, // slope against its direction, px per px
            165, // log2(1 + disparities compared)
            -758, // log2(1 + grey step)
            3313, // log2(1 + how much codes change along a window of the image, on average)
            4123, // log2(1 + support points nearby that agree)
            -1422, // share of those that are farther
            -2019, // share of those that are nearer
            667, // log2(1 + segments nearby that agree)
            454, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -5343, // the less unique half: cost at the disparity / best elsewhere
            -1882, // how unique the other side is at a nearer disparity, 0 ..= 1
            -856, // distance of the pixel from the edge, px
            -3050, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            1533, 3066, 4599, 6131, 7664, 9197, 10730, 12263, 12265, 12267, 12269,
            14902, 18057, 20378, 24039, 30645, 36999, 42382, 47700, 52543, 56211, 58944,
            61254, 62683, 63460, 63945, 64443, 64445, 64447, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 219, 219, 219,
            219, 219, 196, 149, 117, 89, 69, 54, 42, 34, 27,
            23, 19, 16, 14, 13, 11, 10, 10, 9, 9, 9,
        ],
    },
    near_vertical_edge: Model {
        bias_q12: -20124,
        coefficients_q12: [
            2275, // this side's window: cost at the disparity / best cost elsewhere
            782, // log2(1 + that cost per pixel)
            826, // log2(1 + how much worse elsewhere is, per pixel)
            -3496, // segment window: best cost / best elsewhere
            -4417, // log2(1 + its cost per pixel)
            -4661, // census: best cost / best elsewhere
            3458, // log2(1 + its cost per point)
            2375, // this side's census: cost at the disparity / best elsewhere
            -2099, // |window - census|, px
            -15437, // |difference of the halves' disparities| per row or column
            -1336, // log2(1 + rows or columns)
            -477, // the other side's window ratio
            -1635, // 1 if the other side prefers another disparity
            -1695, // 1 if this side alone prefers another disparity
            -8660, // 1 if the right image has no such edge there
            -6004, // |the edge in the right image - halves|, px
            27, // -1 left of or above the edge, +1 right or below
            509, // slope against its direction, px per px
            405, // log2(1 + disparities compared)
            509, // log2(1 + grey step)
            3798, // log2(1 + how much codes change along a window of the image, on average)
            2588, // log2(1 + support points nearby that agree)
            -1137, // share of those that are farther
            -2188, // share of those that are nearer
            3279, // log2(1 + segments nearby that agree)
            1705, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            469, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            976, 1952, 2928, 3903, 4879, 5855, 6831, 7807, 8783, 9758, 10734,
            11710, 12686, 12688, 16086, 30578, 39090, 45406, 52527, 54826, 57874, 61587,
            61976, 62324, 63440, 64097, 64407, 64763, 65026, 65407, 65487, 65488, 65490,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 285, 208, 125, 95, 52, 36, 28, 23, 19,
            16, 14, 13, 12, 11, 10, 10, 10, 10, 8, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: -644,
        coefficients_q12: [
            2669, // this side's window: cost at the disparity / best cost elsewhere
            -785, // log2(1 + that cost per pixel)
            -167, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -3978, // census: best cost / best elsewhere
            1578, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3064, // |window - census|, px
            -19184, // |difference of the halves' disparities| per row or column
            -1447, // log2(1 + rows or columns)
            -4879, // the other side's window ratio
            -4270, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            104, // -1 left of or above the edge, +1 right or below
            1646, // slope against its direction, px per px
            485, // log2(1 + disparities compared)
            -55, // log2(1 + grey step)
            2317, // log2(1 + how much codes change along a window of the image, on average)
            1837, // log2(1 + support points nearby that agree)
            -2817, // share of those that are farther
            -1988, // share of those that are nearer
            1821, // log2(1 + segments nearby that agree)
            -4496, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -3563, // the less unique half: cost at the disparity / best elsewhere
            -8055, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            628, 1256, 1883, 2511, 3139, 3767, 4394, 5022, 5650, 6278, 9688,
            13415, 19427, 22148, 24934, 29960, 35818, 39644, 44661, 50522, 55470, 59037,
            61522, 63080, 63895, 64507, 65087, 65378, 65478, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            242, 190, 189, 161, 116, 85, 69, 55, 42, 33, 27,
            22, 17, 14, 12, 10, 9, 9, 8, 6, 6, 6,
        ],
    },
};
