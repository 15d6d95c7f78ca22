//! Written by `linestereo-lab fit-confidence` from 125 pairs of qvga, robot_world, oakd_agreed_320, oakd_agreed_640, kitti2012_640, robot_world_640, middlebury2006_third, middlebury2006_half, middlebury2005_half, small ones under 7 damages: do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    near_vertical: Model {
        bias_q12: 1050,
        coefficients_q12: [
            -7290, // this side's window: cost at the disparity / best cost elsewhere
            1033, // log2(1 + that cost per pixel)
            1006, // log2(1 + how much worse elsewhere is, per pixel)
            11011, // segment window: best cost / best elsewhere
            -2933, // log2(1 + its cost per pixel)
            3450, // census: best cost / best elsewhere
            1074, // log2(1 + its cost per point)
            -5896, // this side's census: cost at the disparity / best elsewhere
            -3206, // |window - census|, px
            -12419, // |difference of the halves' disparities| per row or column
            -1218, // log2(1 + rows or columns)
            -381, // the other side's window ratio
            -1484, // 1 if the other side prefers another disparity
            -2712, // 1 if this side alone prefers another disparity
            -7770, // 1 if the right image has no such edge there
            -2254, // |the edge in the right image - halves|, px
            128, // -1 left of or above the edge, +1 right or below
            -106, // slope against its direction, px per px
            801, // log2(1 + disparities compared)
            -112, // log2(1 + grey step)
            1902, // log2(1 + how much codes change along a window of the image, on average)
            1596, // log2(1 + support points nearby that agree)
            -16343, // share of those that are farther
            -9974, // share of those that are nearer
            574, // log2(1 + segments nearby that agree)
            -1906, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            -893, // how unique the other side is at a nearer disparity, 0 ..= 1
            -1084, // distance of the pixel from the edge, px
            -941, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            111, 223, 334, 446, 557, 669, 780, 892, 2403, 4540, 8366,
            13044, 18592, 24875, 29371, 31856, 33349, 38663, 44907, 49158, 53111, 57232,
            59770, 61501, 62589, 63229, 63840, 64191, 64215, 65034, 65036, 65038, 65040,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 282, 282, 282,
            282, 282, 282, 174, 137, 117, 79, 47, 33, 26, 22,
            19, 16, 15, 13, 12, 11, 10, 9, 9, 9, 9,
        ],
    },
    near_horizontal: Model {
        bias_q12: 3531,
        coefficients_q12: [
            -1243, // this side's window: cost at the disparity / best cost elsewhere
            522, // log2(1 + that cost per pixel)
            -895, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -5653, // census: best cost / best elsewhere
            1290, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3210, // |window - census|, px
            -28717, // |difference of the halves' disparities| per row or column
            -3006, // log2(1 + rows or columns)
            -1961, // the other side's window ratio
            361, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -179, // -1 left of or above the edge, +1 right or below
            -3621, // slope against its direction, px per px
            -41, // log2(1 + disparities compared)
            -783, // log2(1 + grey step)
            3002, // log2(1 + how much codes change along a window of the image, on average)
            4310, // log2(1 + support points nearby that agree)
            -719, // share of those that are farther
            -1561, // share of those that are nearer
            500, // log2(1 + segments nearby that agree)
            8, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -5289, // the less unique half: cost at the disparity / best elsewhere
            -1763, // how unique the other side is at a nearer disparity, 0 ..= 1
            -836, // distance of the pixel from the edge, px
            -2932, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            1559, 3119, 4678, 6237, 7796, 9356, 10915, 12474, 13268, 13506, 13508,
            15203, 17778, 20763, 24662, 30880, 37300, 42633, 47569, 52340, 56068, 58740,
            61100, 62619, 63364, 63972, 64513, 64515, 65059, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 192, 192, 192,
            192, 192, 192, 146, 114, 87, 67, 54, 42, 34, 28,
            22, 19, 16, 14, 12, 11, 11, 10, 10, 10, 10,
        ],
    },
    near_vertical_edge: Model {
        bias_q12: -18684,
        coefficients_q12: [
            2810, // this side's window: cost at the disparity / best cost elsewhere
            560, // log2(1 + that cost per pixel)
            801, // log2(1 + how much worse elsewhere is, per pixel)
            -4562, // segment window: best cost / best elsewhere
            -4057, // log2(1 + its cost per pixel)
            -4435, // census: best cost / best elsewhere
            3475, // log2(1 + its cost per point)
            1606, // this side's census: cost at the disparity / best elsewhere
            -1958, // |window - census|, px
            -14615, // |difference of the halves' disparities| per row or column
            -1276, // log2(1 + rows or columns)
            -477, // the other side's window ratio
            -1767, // 1 if the other side prefers another disparity
            -1498, // 1 if this side alone prefers another disparity
            -8432, // 1 if the right image has no such edge there
            -5934, // |the edge in the right image - halves|, px
            -76, // -1 left of or above the edge, +1 right or below
            985, // slope against its direction, px per px
            120, // log2(1 + disparities compared)
            487, // log2(1 + grey step)
            3795, // log2(1 + how much codes change along a window of the image, on average)
            2595, // log2(1 + support points nearby that agree)
            -1072, // share of those that are farther
            -2507, // share of those that are nearer
            2957, // log2(1 + segments nearby that agree)
            1569, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            753, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            933, 1867, 2800, 3734, 4667, 5600, 6534, 7467, 8401, 9334, 10267,
            11201, 12134, 12136, 12138, 29482, 40464, 47092, 52768, 55528, 57858, 61304,
            62090, 62213, 63388, 64068, 64476, 64845, 65094, 65395, 65479, 65481, 65483,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 298, 234, 135, 92, 51, 36, 28, 23, 19,
            16, 14, 13, 12, 11, 11, 10, 10, 9, 8, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 2220,
        coefficients_q12: [
            2958, // this side's window: cost at the disparity / best cost elsewhere
            -596, // log2(1 + that cost per pixel)
            -295, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -3746, // census: best cost / best elsewhere
            1575, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3037, // |window - census|, px
            -19703, // |difference of the halves' disparities| per row or column
            -1867, // log2(1 + rows or columns)
            -5021, // the other side's window ratio
            -4022, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            121, // -1 left of or above the edge, +1 right or below
            1247, // slope against its direction, px per px
            360, // log2(1 + disparities compared)
            -58, // log2(1 + grey step)
            2097, // log2(1 + how much codes change along a window of the image, on average)
            2681, // log2(1 + support points nearby that agree)
            -1236, // share of those that are farther
            -761, // share of those that are nearer
            1422, // log2(1 + segments nearby that agree)
            -4821, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -3300, // the less unique half: cost at the disparity / best elsewhere
            -8217, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            1064, 2127, 3191, 4255, 5319, 6382, 7446, 8510, 9574, 10637, 10639,
            11302, 17820, 21170, 24914, 29305, 34901, 40082, 45644, 51023, 55410, 58772,
            61103, 62827, 63956, 64523, 65182, 65406, 65494, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            262, 231, 191, 164, 114, 85, 69, 54, 42, 33, 27,
            22, 17, 14, 12, 10, 9, 9, 7, 5, 5, 5,
        ],
    },
};
