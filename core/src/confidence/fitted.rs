//! Written by `linestereo-lab fit-confidence` from 125 pairs of qvga, robot_world, oakd_agreed_320,
//! oakd_agreed_640, kitti2012_640, robot_world_640, middlebury2006_third, middlebury2006_half,
//! middlebury2005_half, small ones under 7 damages: do not edit.

use super::{Model, Models, SigmaModel};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    near_vertical: Model {
        bias_q12: -825,
        coefficients_q12: [
            -7715, // this side's window: cost at the disparity / best cost elsewhere
            1150, // log2(1 + that cost per pixel)
            1004, // log2(1 + how much worse elsewhere is, per pixel)
            11697, // segment window: best cost / best elsewhere
            -3153, // log2(1 + its cost per pixel)
            3285, // census: best cost / best elsewhere
            1224, // log2(1 + its cost per point)
            -5910, // this side's census: cost at the disparity / best elsewhere
            -3227, // |window - census|, px
            -12787, // |difference of the halves' disparities| per row or column
            -1252, // log2(1 + rows or columns)
            -285, // the other side's window ratio
            -1611, // 1 if the other side prefers another disparity
            -2944, // 1 if this side alone prefers another disparity
            -7979, // 1 if the right image has no such edge there
            -2313, // |the edge in the right image - halves|, px
            189, // -1 left of or above the edge, +1 right or below
            -413, // slope against its direction, px per px
            1117, // log2(1 + disparities compared)
            -122, // log2(1 + grey step)
            1979, // log2(1 + how much codes change along a window of the image, on average)
            1511, // log2(1 + support points nearby that agree)
            -16423, // share of those that are farther
            -9745, // share of those that are nearer
            837, // log2(1 + segments nearby that agree)
            -1850, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            -877, // how unique the other side is at a nearer disparity, 0 ..= 1
            -1074, // distance of the pixel from the edge, px
            -889, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            47, 95, 142, 189, 236, 284, 331, 378, 3393, 7829, 9510,
            11900, 16878, 24562, 29465, 32036, 33380, 39076, 44654, 48953, 53320, 57272,
            59866, 61541, 62672, 63425, 63881, 64159, 64184, 65237, 65239, 65241, 65243,
        ],
    },
    near_horizontal: Model {
        bias_q12: 728,
        coefficients_q12: [
            -1052, // this side's window: cost at the disparity / best cost elsewhere
            396, // log2(1 + that cost per pixel)
            -842, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -5876, // census: best cost / best elsewhere
            1392, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3224, // |window - census|, px
            -28855, // |difference of the halves' disparities| per row or column
            -2826, // log2(1 + rows or columns)
            -1831, // the other side's window ratio
            282, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -173, // -1 left of or above the edge, +1 right or below
            -3558, // slope against its direction, px per px
            87, // log2(1 + disparities compared)
            -815, // log2(1 + grey step)
            3258, // log2(1 + how much codes change along a window of the image, on average)
            3954, // log2(1 + support points nearby that agree)
            -1311, // share of those that are farther
            -2310, // share of those that are nearer
            635, // log2(1 + segments nearby that agree)
            -58, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -5472, // the less unique half: cost at the disparity / best elsewhere
            -1704, // how unique the other side is at a nearer disparity, 0 ..= 1
            -839, // distance of the pixel from the edge, px
            -2958, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            1699, 3397, 5096, 6795, 8493, 10192, 11891, 13589, 13591, 13593, 13595,
            15600, 18228, 21069, 24414, 30533, 37231, 42723, 47565, 52439, 56288, 58968,
            61272, 62739, 63414, 63951, 64454, 64456, 64530, 65527, 65529, 65531, 65533,
        ],
    },
    near_vertical_edge: SigmaModel {
        model: Model {
            bias_q12: -20207,
            coefficients_q12: [
                2276, // this side's window: cost at the disparity / best cost elsewhere
                760, // log2(1 + that cost per pixel)
                856, // log2(1 + how much worse elsewhere is, per pixel)
                -3387, // segment window: best cost / best elsewhere
                -4422, // log2(1 + its cost per pixel)
                -4617, // census: best cost / best elsewhere
                3438, // log2(1 + its cost per point)
                2257, // this side's census: cost at the disparity / best elsewhere
                -2049, // |window - census|, px
                -14583, // |difference of the halves' disparities| per row or column
                -1311, // log2(1 + rows or columns)
                -517, // the other side's window ratio
                -1616, // 1 if the other side prefers another disparity
                -1667, // 1 if this side alone prefers another disparity
                -8734, // 1 if the right image has no such edge there
                -6086, // |the edge in the right image - halves|, px
                48, // -1 left of or above the edge, +1 right or below
                582, // slope against its direction, px per px
                451, // log2(1 + disparities compared)
                516, // log2(1 + grey step)
                3797, // log2(1 + how much codes change along a window of the image, on average)
                2459, // log2(1 + support points nearby that agree)
                -1306, // share of those that are farther
                -2370, // share of those that are nearer
                3312, // log2(1 + segments nearby that agree)
                1616, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
                0, // the less unique half: cost at the disparity / best elsewhere
                335, // how unique the other side is at a nearer disparity, 0 ..= 1
                0, // distance of the pixel from the edge, px
                0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
            ],
            probability_q16: [
                973, 1946, 2919, 3893, 4866, 5839, 6812, 7785, 8758, 9731, 10705,
                11678, 12651, 12653, 12655, 29510, 41016, 46684, 52854, 54875, 57904, 61581,
                62056, 62285, 63383, 64051, 64381, 64783, 65049, 65389, 65477, 65479, 65481,
            ],
        },
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 285, 242, 120, 98, 49, 36, 28, 23, 19,
            16, 14, 13, 12, 11, 10, 10, 10, 10, 8, 7,
        ],
    },
    near_horizontal_edge: SigmaModel {
        model: Model {
            bias_q12: -473,
            coefficients_q12: [
                3369, // this side's window: cost at the disparity / best cost elsewhere
                -777, // log2(1 + that cost per pixel)
                -170, // log2(1 + how much worse elsewhere is, per pixel)
                0, // segment window: best cost / best elsewhere
                0, // log2(1 + its cost per pixel)
                -3968, // census: best cost / best elsewhere
                1698, // log2(1 + its cost per point)
                0, // this side's census: cost at the disparity / best elsewhere
                -3024, // |window - census|, px
                -19687, // |difference of the halves' disparities| per row or column
                -1710, // log2(1 + rows or columns)
                -4935, // the other side's window ratio
                -4144, // 1 if the other side prefers another disparity
                0, // 1 if this side alone prefers another disparity
                0, // 1 if the right image has no such edge there
                0, // |the edge in the right image - halves|, px
                152, // -1 left of or above the edge, +1 right or below
                1384, // slope against its direction, px per px
                439, // log2(1 + disparities compared)
                -81, // log2(1 + grey step)
                2318, // log2(1 + how much codes change along a window of the image, on average)
                2443, // log2(1 + support points nearby that agree)
                -1634, // share of those that are farther
                -1337, // share of those that are nearer
                1545, // log2(1 + segments nearby that agree)
                -4859, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
                -3300, // the less unique half: cost at the disparity / best elsewhere
                -8095, // how unique the other side is at a nearer disparity, 0 ..= 1
                0, // distance of the pixel from the edge, px
                0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
            ],
            probability_q16: [
                1024, 2048, 3072, 4096, 5120, 6145, 7169, 8193, 9217, 10241, 10243,
                11556, 18487, 21714, 24806, 29257, 34893, 40154, 45648, 51035, 55438, 58892,
                61428, 63157, 64065, 64440, 65071, 65403, 65481, 65527, 65529, 65531, 65533,
            ],
        },
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            267, 213, 184, 162, 114, 85, 69, 54, 42, 33, 27,
            22, 17, 14, 12, 10, 9, 9, 8, 6, 6, 6,
        ],
    },
};
