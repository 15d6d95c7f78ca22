//! Written by `linestereo fit-confidence` from 35 pairs under 7 damages (Aloe, Art, Baby1, Books, Bowling2, Cloth1, Dolls, Lampshade1, Monopoly, Motorcycle, Rocks1, Wood1, aloe, art, baby1, books, bowling2, boxes, cloth1, corridor, demo, dolls, lampshade1, monopoly, motorcycle, poles, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    near_vertical: Model {
        bias_q12: -19029,
        coefficients_q12: [
            -14481, // this side's window: cost at the disparity / best cost elsewhere
            1462, // log2(1 + that cost per pixel)
            -462, // log2(1 + how much worse elsewhere is, per pixel)
            9572, // segment window: best cost / best elsewhere
            -3233, // log2(1 + its cost per pixel)
            882, // census: best cost / best elsewhere
            2402, // log2(1 + its cost per point)
            -6597, // this side's census: cost at the disparity / best elsewhere
            -3486, // |window - census|, px
            -18515, // |difference of the halves' disparities| per row or column
            -1523, // log2(1 + rows or columns)
            574, // the other side's window ratio
            -353, // 1 if the other side prefers another disparity
            -3204, // 1 if this side alone prefers another disparity
            -8777, // 1 if the right image has no such edge there
            -1385, // |the edge in the right image - halves|, px
            290, // -1 left of or above the edge, +1 right or below
            -2180, // slope against its direction, px per px
            1257, // log2(1 + disparities compared)
            -667, // log2(1 + grey step)
            11581, // log2(1 + ranks that change along a window of the image, on average)
            2902, // log2(1 + support points nearby that agree)
            -9104, // share of those that are farther
            -7465, // share of those that are nearer
            710, // log2(1 + segments nearby that agree)
            -4720, // the edge itself: cost at the disparity / best elsewhere
            -892, // distance of the pixel from the edge, px
            -1073, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            85, 130, 198, 303, 462, 704, 1072, 1625, 2455, 3683, 5471,
            8017, 11519, 16122, 21822, 28380, 35316, 42030, 47993, 52898, 56828, 59672,
            62238, 63715, 64252, 64633, 65146, 65369, 65464, 65505, 65523, 65530, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 477, 384, 293, 125, 71, 46, 34, 28, 24,
            21, 19, 17, 16, 14, 13, 12, 11, 10, 10, 10,
        ],
    },
    near_horizontal: Model {
        bias_q12: -5251,
        coefficients_q12: [
            -8806, // this side's window: cost at the disparity / best cost elsewhere
            -310, // log2(1 + that cost per pixel)
            -938, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -5946, // census: best cost / best elsewhere
            643, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -2693, // |window - census|, px
            -25616, // |difference of the halves' disparities| per row or column
            -2133, // log2(1 + rows or columns)
            -2090, // the other side's window ratio
            -130, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -305, // -1 left of or above the edge, +1 right or below
            -3256, // slope against its direction, px per px
            499, // log2(1 + disparities compared)
            -832, // log2(1 + grey step)
            9298, // log2(1 + ranks that change along a window of the image, on average)
            2891, // log2(1 + support points nearby that agree)
            -7470, // share of those that are farther
            -6785, // share of those that are nearer
            1206, // log2(1 + segments nearby that agree)
            0, // the edge itself: cost at the disparity / best elsewhere
            -587, // distance of the pixel from the edge, px
            -2166, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            187, 271, 393, 569, 823, 1189, 1712, 2458, 3511, 4978, 6991,
            9686, 13187, 17556, 22742, 28550, 34640, 40603, 46062, 50761, 56451, 60181,
            62357, 63676, 64618, 65086, 65351, 65460, 65505, 65523, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 489, 351, 223, 151, 105, 76, 56, 43, 33, 27,
            22, 19, 17, 15, 14, 13, 12, 10, 10, 10, 10,
        ],
    },
    near_vertical_edge: Model {
        bias_q12: -10307,
        coefficients_q12: [
            -3009, // this side's window: cost at the disparity / best cost elsewhere
            910, // log2(1 + that cost per pixel)
            300, // log2(1 + how much worse elsewhere is, per pixel)
            -275, // segment window: best cost / best elsewhere
            -3623, // log2(1 + its cost per pixel)
            -2955, // census: best cost / best elsewhere
            995, // log2(1 + its cost per point)
            -272, // this side's census: cost at the disparity / best elsewhere
            -2307, // |window - census|, px
            -17803, // |difference of the halves' disparities| per row or column
            -666, // log2(1 + rows or columns)
            -779, // the other side's window ratio
            -737, // 1 if the other side prefers another disparity
            -564, // 1 if this side alone prefers another disparity
            -11850, // 1 if the right image has no such edge there
            -4556, // |the edge in the right image - halves|, px
            134, // -1 left of or above the edge, +1 right or below
            -488, // slope against its direction, px per px
            488, // log2(1 + disparities compared)
            38, // log2(1 + grey step)
            8216, // log2(1 + ranks that change along a window of the image, on average)
            646, // log2(1 + support points nearby that agree)
            -2814, // share of those that are farther
            -7824, // share of those that are nearer
            3955, // log2(1 + segments nearby that agree)
            -299, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            75, 118, 184, 287, 447, 695, 1080, 1673, 2577, 3941, 5957,
            8856, 12862, 18101, 24482, 31613, 38856, 45531, 51154, 55543, 58160, 60158,
            61611, 62690, 64138, 64857, 65151, 65318, 65413, 65466, 65497, 65514, 65523,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 358, 346, 204, 97, 59, 37, 28, 24, 21,
            19, 17, 15, 14, 12, 12, 11, 11, 10, 8, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: -269,
        coefficients_q12: [
            -9615, // this side's window: cost at the disparity / best cost elsewhere
            -559, // log2(1 + that cost per pixel)
            -1225, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -4707, // census: best cost / best elsewhere
            700, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -1979, // |window - census|, px
            -17874, // |difference of the halves' disparities| per row or column
            -1605, // log2(1 + rows or columns)
            -1807, // the other side's window ratio
            -6065, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -360, // -1 left of or above the edge, +1 right or below
            2022, // slope against its direction, px per px
            385, // log2(1 + disparities compared)
            -47, // log2(1 + grey step)
            6753, // log2(1 + ranks that change along a window of the image, on average)
            904, // log2(1 + support points nearby that agree)
            -5962, // share of those that are farther
            -6571, // share of those that are nearer
            2214, // log2(1 + segments nearby that agree)
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            142, 210, 310, 457, 674, 992, 1458, 2134, 3108, 4495, 6439,
            9097, 12618, 17090, 22473, 28552, 34942, 41170, 46809, 51586, 55943, 59109,
            62092, 63732, 64783, 65225, 65384, 65462, 65500, 65518, 65527, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 408, 228, 154, 105, 75, 53, 40, 31, 26,
            20, 17, 15, 13, 12, 11, 10, 8, 6, 6, 6,
        ],
    },
};
