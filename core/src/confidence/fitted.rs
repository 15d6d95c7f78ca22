//! Written by `linestereo fit-confidence` from 35 pairs under 7 damages (Aloe, Art, Baby1, Books, Bowling2, Cloth1, Dolls, Lampshade1, Monopoly, Motorcycle, Rocks1, Wood1, aloe, art, baby1, books, bowling2, boxes, cloth1, corridor, demo, dolls, lampshade1, monopoly, motorcycle, poles, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    near_vertical: Model {
        bias_q12: -19054,
        coefficients_q12: [
            -14487, // this side's window: cost at the disparity / best cost elsewhere
            1458, // log2(1 + that cost per pixel)
            -460, // log2(1 + how much worse elsewhere is, per pixel)
            9679, // segment window: best cost / best elsewhere
            -3236, // log2(1 + its cost per pixel)
            930, // census: best cost / best elsewhere
            2389, // log2(1 + its cost per point)
            -6611, // this side's census: cost at the disparity / best elsewhere
            -3492, // |window - census|, px
            -18540, // |difference of the halves' disparities| per row or column
            -1526, // log2(1 + rows or columns)
            509, // the other side's window ratio
            -389, // 1 if the other side prefers another disparity
            -3207, // 1 if this side alone prefers another disparity
            -8767, // 1 if the right image has no such edge there
            -1387, // |the edge in the right image - halves|, px
            283, // -1 left of or above the edge, +1 right or below
            -2177, // slope against its direction, px per px
            1259, // log2(1 + disparities compared)
            -662, // log2(1 + grey step)
            11590, // log2(1 + ranks that change along a window of the image, on average)
            2905, // log2(1 + support points nearby that agree)
            -9102, // share of those that are farther
            -7468, // share of those that are nearer
            703, // log2(1 + segments nearby that agree)
            -4771, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            503, // how unique the other side is at a nearer disparity, 0 ..= 1
            -892, // distance of the pixel from the edge, px
            -1067, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            85, 130, 199, 304, 463, 706, 1074, 1628, 2458, 3687, 5477,
            8023, 11526, 16128, 21826, 28381, 35313, 42024, 47985, 52890, 56822, 59667,
            62239, 63718, 64251, 64630, 65146, 65369, 65465, 65505, 65523, 65530, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 486, 383, 295, 125, 71, 46, 34, 28, 24,
            21, 19, 17, 16, 14, 13, 12, 11, 10, 10, 10,
        ],
    },
    near_horizontal: Model {
        bias_q12: -3355,
        coefficients_q12: [
            -6752, // this side's window: cost at the disparity / best cost elsewhere
            106, // log2(1 + that cost per pixel)
            -1311, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -4490, // census: best cost / best elsewhere
            773, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3127, // |window - census|, px
            -27387, // |difference of the halves' disparities| per row or column
            -2181, // log2(1 + rows or columns)
            -1079, // the other side's window ratio
            -69, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -354, // -1 left of or above the edge, +1 right or below
            -4821, // slope against its direction, px per px
            530, // log2(1 + disparities compared)
            -1162, // log2(1 + grey step)
            9520, // log2(1 + ranks that change along a window of the image, on average)
            2991, // log2(1 + support points nearby that agree)
            -6519, // share of those that are farther
            -6181, // share of those that are nearer
            1298, // log2(1 + segments nearby that agree)
            251, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -4698, // the less unique half: cost at the disparity / best elsewhere
            -722, // how unique the other side is at a nearer disparity, 0 ..= 1
            -600, // distance of the pixel from the edge, px
            -2185, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            341, 478, 670, 938, 1312, 1829, 2544, 3521, 4846, 6615, 8935,
            11905, 15590, 19990, 25011, 30449, 36019, 41405, 46333, 50617, 56266, 60010,
            62189, 63538, 64572, 65075, 65327, 65441, 65493, 65517, 65527, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            366, 253, 209, 157, 121, 93, 72, 56, 43, 34, 27,
            23, 20, 17, 16, 14, 13, 12, 11, 11, 11, 11,
        ],
    },
    near_vertical_edge: Model {
        bias_q12: -10413,
        coefficients_q12: [
            -2990, // this side's window: cost at the disparity / best cost elsewhere
            889, // log2(1 + that cost per pixel)
            315, // log2(1 + how much worse elsewhere is, per pixel)
            -4, // segment window: best cost / best elsewhere
            -3625, // log2(1 + its cost per pixel)
            -2776, // census: best cost / best elsewhere
            921, // log2(1 + its cost per point)
            -334, // this side's census: cost at the disparity / best elsewhere
            -2326, // |window - census|, px
            -17881, // |difference of the halves' disparities| per row or column
            -672, // log2(1 + rows or columns)
            -950, // the other side's window ratio
            -821, // 1 if the other side prefers another disparity
            -593, // 1 if this side alone prefers another disparity
            -11813, // 1 if the right image has no such edge there
            -4566, // |the edge in the right image - halves|, px
            101, // -1 left of or above the edge, +1 right or below
            -455, // slope against its direction, px per px
            494, // log2(1 + disparities compared)
            51, // log2(1 + grey step)
            8261, // log2(1 + ranks that change along a window of the image, on average)
            663, // log2(1 + support points nearby that agree)
            -2783, // share of those that are farther
            -7833, // share of those that are nearer
            3903, // log2(1 + segments nearby that agree)
            -468, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            1182, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            79, 123, 191, 298, 463, 718, 1112, 1716, 2635, 4015, 6049,
            8963, 12974, 18202, 24554, 31640, 38834, 45469, 51070, 55454, 58238, 60325,
            61631, 62625, 64125, 64861, 65152, 65319, 65413, 65466, 65497, 65514, 65523,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 350, 339, 205, 91, 59, 38, 29, 24, 21,
            19, 17, 15, 14, 12, 12, 11, 11, 10, 8, 6,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 3086,
        coefficients_q12: [
            -5321, // this side's window: cost at the disparity / best cost elsewhere
            191, // log2(1 + that cost per pixel)
            -1891, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -2538, // census: best cost / best elsewhere
            1008, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -2393, // |window - census|, px
            -19298, // |difference of the halves' disparities| per row or column
            -1753, // log2(1 + rows or columns)
            -3155, // the other side's window ratio
            -5143, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -661, // -1 left of or above the edge, +1 right or below
            607, // slope against its direction, px per px
            497, // log2(1 + disparities compared)
            -235, // log2(1 + grey step)
            6632, // log2(1 + ranks that change along a window of the image, on average)
            1293, // log2(1 + support points nearby that agree)
            -4670, // share of those that are farther
            -6053, // share of those that are nearer
            2346, // log2(1 + segments nearby that agree)
            -5231, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -2749, // the less unique half: cost at the disparity / best elsewhere
            -5188, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            314, 443, 624, 880, 1237, 1737, 2430, 3385, 4688, 6441, 8754,
            11734, 15451, 19910, 25013, 30549, 36215, 41679, 46657, 50959, 56103, 59642,
            61944, 63380, 64631, 65160, 65363, 65457, 65500, 65519, 65528, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            409, 296, 206, 159, 130, 100, 72, 53, 41, 32, 26,
            21, 18, 15, 14, 12, 11, 10, 9, 7, 7, 7,
        ],
    },
};
