//! Written by `linestereo-lab fit-confidence` from 22 pairs under 7 damages (Aloe, Baby1, Bowling2, Cloth1, Lampshade1, Monopoly, Rocks1, Wood1, aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    near_vertical: Model {
        bias_q12: -2690,
        coefficients_q12: [
            -16322, // this side's window: cost at the disparity / best cost elsewhere
            2315, // log2(1 + that cost per pixel)
            -354, // log2(1 + how much worse elsewhere is, per pixel)
            9178, // segment window: best cost / best elsewhere
            -2677, // log2(1 + its cost per pixel)
            2175, // census: best cost / best elsewhere
            2554, // log2(1 + its cost per point)
            -6891, // this side's census: cost at the disparity / best elsewhere
            -4080, // |window - census|, px
            -23427, // |difference of the halves' disparities| per row or column
            -2338, // log2(1 + rows or columns)
            -361, // the other side's window ratio
            -1586, // 1 if the other side prefers another disparity
            -3578, // 1 if this side alone prefers another disparity
            -6817, // 1 if the right image has no such edge there
            -2978, // |the edge in the right image - halves|, px
            83, // -1 left of or above the edge, +1 right or below
            -1998, // slope against its direction, px per px
            1439, // log2(1 + disparities compared)
            -941, // log2(1 + grey step)
            7432, // log2(1 + ranks that change along a window of the image, on average)
            2310, // log2(1 + support points nearby that agree)
            -13974, // share of those that are farther
            -8827, // share of those that are nearer
            1165, // log2(1 + segments nearby that agree)
            -1156, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            1064, // how unique the other side is at a nearer disparity, 0 ..= 1
            -993, // distance of the pixel from the edge, px
            -1276, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            593, 807, 1097, 1488, 2015, 2721, 3660, 4897, 6508, 8575, 11173,
            14361, 18155, 22509, 27306, 32357, 37428, 42280, 46716, 50605, 56355, 60128,
            61744, 62898, 64411, 65063, 65299, 65417, 65477, 65506, 65521, 65529, 65532,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 417, 375, 375,
            375, 363, 201, 163, 139, 133, 93, 50, 33, 26, 22,
            19, 17, 15, 14, 13, 12, 11, 10, 9, 9, 9,
        ],
    },
    near_horizontal: Model {
        bias_q12: 4101,
        coefficients_q12: [
            -4290, // this side's window: cost at the disparity / best cost elsewhere
            291, // log2(1 + that cost per pixel)
            -1061, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -5507, // census: best cost / best elsewhere
            1052, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3378, // |window - census|, px
            -27876, // |difference of the halves' disparities| per row or column
            -3552, // log2(1 + rows or columns)
            -2181, // the other side's window ratio
            640, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -206, // -1 left of or above the edge, +1 right or below
            -5251, // slope against its direction, px per px
            763, // log2(1 + disparities compared)
            -897, // log2(1 + grey step)
            7007, // log2(1 + ranks that change along a window of the image, on average)
            4600, // log2(1 + support points nearby that agree)
            -4022, // share of those that are farther
            -2620, // share of those that are nearer
            625, // log2(1 + segments nearby that agree)
            -1083, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -4589, // the less unique half: cost at the disparity / best elsewhere
            -1883, // how unique the other side is at a nearer disparity, 0 ..= 1
            -638, // distance of the pixel from the edge, px
            -2196, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            361, 505, 706, 984, 1371, 1905, 2638, 3638, 4986, 6778, 9119,
            12101, 15785, 20168, 25152, 30539, 36050, 41380, 46261, 50514, 55772, 59412,
            61906, 63421, 64667, 65183, 65296, 65373, 65426, 65461, 65485, 65502, 65513,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            504, 224, 182, 146, 121, 97, 76, 57, 44, 34, 27,
            22, 19, 16, 14, 13, 12, 12, 12, 12, 12, 12,
        ],
    },
    near_vertical_edge: Model {
        bias_q12: -6561,
        coefficients_q12: [
            1385, // this side's window: cost at the disparity / best cost elsewhere
            882, // log2(1 + that cost per pixel)
            367, // log2(1 + how much worse elsewhere is, per pixel)
            -9331, // segment window: best cost / best elsewhere
            -3400, // log2(1 + its cost per pixel)
            -2894, // census: best cost / best elsewhere
            2480, // log2(1 + its cost per point)
            1604, // this side's census: cost at the disparity / best elsewhere
            -1730, // |window - census|, px
            -22801, // |difference of the halves' disparities| per row or column
            -2248, // log2(1 + rows or columns)
            -38, // the other side's window ratio
            -2010, // 1 if the other side prefers another disparity
            -4192, // 1 if this side alone prefers another disparity
            -6809, // 1 if the right image has no such edge there
            -5316, // |the edge in the right image - halves|, px
            -22, // -1 left of or above the edge, +1 right or below
            -2663, // slope against its direction, px per px
            570, // log2(1 + disparities compared)
            382, // log2(1 + grey step)
            6005, // log2(1 + ranks that change along a window of the image, on average)
            2961, // log2(1 + support points nearby that agree)
            -1439, // share of those that are farther
            -1148, // share of those that are nearer
            4533, // log2(1 + segments nearby that agree)
            5473, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            1756, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            93, 145, 226, 352, 547, 849, 1313, 2024, 3102, 4710, 7058,
            10377, 14860, 20557, 27264, 34482, 41536, 47812, 52944, 56860, 59427, 61292,
            61906, 62435, 63688, 64443, 65019, 65292, 65421, 65482, 65511, 65524, 65530,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 272, 214, 99, 94, 51, 34, 26, 22, 19,
            17, 15, 14, 12, 11, 10, 10, 10, 9, 8, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 5943,
        coefficients_q12: [
            -464, // this side's window: cost at the disparity / best cost elsewhere
            -67, // log2(1 + that cost per pixel)
            -1006, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -3310, // census: best cost / best elsewhere
            1056, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -2866, // |window - census|, px
            -18364, // |difference of the halves' disparities| per row or column
            -2180, // log2(1 + rows or columns)
            -4804, // the other side's window ratio
            -5253, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -511, // -1 left of or above the edge, +1 right or below
            866, // slope against its direction, px per px
            1116, // log2(1 + disparities compared)
            -162, // log2(1 + grey step)
            4392, // log2(1 + ranks that change along a window of the image, on average)
            3372, // log2(1 + support points nearby that agree)
            -1785, // share of those that are farther
            -2449, // share of those that are nearer
            682, // log2(1 + segments nearby that agree)
            -6717, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -2751, // the less unique half: cost at the disparity / best elsewhere
            -7303, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            143, 212, 314, 466, 690, 1020, 1503, 2209, 3228, 4683, 6724,
            9515, 13205, 17868, 23441, 29670, 36133, 42343, 47881, 52504, 56299, 59123,
            61335, 62819, 64510, 65155, 65363, 65457, 65500, 65520, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 357, 234, 198, 138, 93, 67, 49, 38, 32, 27,
            23, 19, 15, 12, 11, 10, 9, 8, 8, 8, 8,
        ],
    },
};
