//! Written by `linestereo fit-confidence` from 31 pairs under 7 damages (Aloe, Art, Baby1, Books, Bowling2, Cloth1, Dolls, Lampshade1, Monopoly, Motorcycle, Rocks1, Wood1, aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 24051,
        coefficients_q12: [
            -13163, // this side's window: cost at the disparity / best cost elsewhere
            1288, // log2(1 + that cost per pixel)
            -240, // log2(1 + how much worse elsewhere is, per pixel)
            10551, // segment window: best cost / best elsewhere
            -2486, // log2(1 + its cost per pixel)
            -790, // census: best cost / best elsewhere
            5110, // log2(1 + its cost per point)
            -6046, // this side's census: cost at the disparity / best elsewhere
            -4205, // |window - census|, px
            -23573, // |difference of the halves' disparities| per row or column
            -2036, // log2(1 + rows or columns)
            3, // the other side's window ratio
            -407, // 1 if the other side prefers another disparity
            -2974, // 1 if this side alone prefers another disparity
            -7654, // 1 if the right image has no such edge there
            -1783, // |the edge in the right image - halves|, px
            294, // -1 left of or above the edge, +1 right or below
            -1953, // slope against its direction, px per px
            1651, // log2(1 + disparities compared)
            -207, // log2(1 + grey step)
            2322, // log2(1 + support points nearby that agree)
            -10452, // share of those that contradict
            -5155, // the edge itself: cost at the disparity / best elsewhere
            -852, // distance of the pixel from the edge, px
            -1674, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            239, 344, 494, 708, 1015, 1450, 2067, 2933, 4140, 5797, 8030,
            10966, 14701, 19259, 24547, 30336, 36282, 42002, 47170, 51580, 56505, 59882,
            62107, 63487, 64392, 64902, 65128, 65274, 65368, 65428, 65467, 65492, 65507,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 417,
            404, 395, 388, 343, 195, 117, 75, 48, 36, 27, 23,
            20, 18, 16, 15, 14, 13, 12, 11, 11, 11, 11,
        ],
    },
    near_horizontal: Model {
        bias_q12: 28534,
        coefficients_q12: [
            -3808, // this side's window: cost at the disparity / best cost elsewhere
            -704, // log2(1 + that cost per pixel)
            427, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -5957, // census: best cost / best elsewhere
            1416, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -2484, // |window - census|, px
            -25595, // |difference of the halves' disparities| per row or column
            -2576, // log2(1 + rows or columns)
            -1923, // the other side's window ratio
            -727, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -299, // -1 left of or above the edge, +1 right or below
            -4185, // slope against its direction, px per px
            649, // log2(1 + disparities compared)
            -546, // log2(1 + grey step)
            3081, // log2(1 + support points nearby that agree)
            -7859, // share of those that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            -591, // distance of the pixel from the edge, px
            -2147, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            184, 267, 387, 561, 812, 1173, 1691, 2428, 3468, 4921, 6913,
            9585, 13059, 17401, 22565, 28359, 34449, 40424, 45905, 50631, 56389, 60159,
            62518, 63871, 64667, 65085, 65331, 65443, 65494, 65517, 65527, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            431, 353, 290, 215, 151, 108, 78, 57, 42, 33, 26,
            22, 19, 17, 15, 14, 13, 11, 10, 10, 10, 10,
        ],
    },
    steep_edge: Model {
        bias_q12: 26981,
        coefficients_q12: [
            -338, // this side's window: cost at the disparity / best cost elsewhere
            242, // log2(1 + that cost per pixel)
            1081, // log2(1 + how much worse elsewhere is, per pixel)
            2194, // segment window: best cost / best elsewhere
            -2669, // log2(1 + its cost per pixel)
            -4422, // census: best cost / best elsewhere
            1151, // log2(1 + its cost per point)
            753, // this side's census: cost at the disparity / best elsewhere
            -3407, // |window - census|, px
            -21390, // |difference of the halves' disparities| per row or column
            -845, // log2(1 + rows or columns)
            -1756, // the other side's window ratio
            -1564, // 1 if the other side prefers another disparity
            -1783, // 1 if this side alone prefers another disparity
            -10584, // 1 if the right image has no such edge there
            -3959, // |the edge in the right image - halves|, px
            105, // -1 left of or above the edge, +1 right or below
            468, // slope against its direction, px per px
            -286, // log2(1 + disparities compared)
            148, // log2(1 + grey step)
            1164, // log2(1 + support points nearby that agree)
            -7066, // share of those that contradict
            -2037, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            62, 98, 156, 248, 394, 623, 986, 1553, 2435, 3787, 5822,
            8794, 12955, 18444, 25147, 32599, 40069, 46817, 52365, 56583, 58521, 60080,
            61466, 62517, 64162, 64919, 65247, 65401, 65473, 65507, 65522, 65530, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            314, 314, 269, 269, 253, 79, 45, 37, 29, 24, 21,
            19, 17, 15, 13, 12, 11, 11, 10, 7, 7, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 25056,
        coefficients_q12: [
            -5151, // this side's window: cost at the disparity / best cost elsewhere
            -842, // log2(1 + that cost per pixel)
            48, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -4825, // census: best cost / best elsewhere
            913, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -1991, // |window - census|, px
            -18107, // |difference of the halves' disparities| per row or column
            -1994, // log2(1 + rows or columns)
            -2683, // the other side's window ratio
            -6583, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -392, // -1 left of or above the edge, +1 right or below
            1086, // slope against its direction, px per px
            542, // log2(1 + disparities compared)
            160, // log2(1 + grey step)
            1509, // log2(1 + support points nearby that agree)
            -6784, // share of those that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            146, 215, 317, 467, 688, 1010, 1481, 2163, 3145, 4540, 6489,
            9149, 12666, 17125, 22485, 28535, 34893, 41094, 46717, 51489, 55524, 58558,
            62429, 64202, 64848, 65183, 65396, 65481, 65514, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            456, 404, 325, 220, 156, 109, 77, 53, 41, 32, 26,
            20, 16, 14, 13, 12, 11, 9, 6, 6, 6, 6,
        ],
    },
};
