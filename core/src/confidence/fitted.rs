//! Written by `linestereo-lab fit-confidence` from 35 pairs under 7 damages (Aloe, Art, Baby1, Books, Bowling2, Cloth1, Dolls, Lampshade1, Monopoly, Motorcycle, Rocks1, Wood1, aloe, art, baby1, books, bowling2, boxes, cloth1, corridor, demo, dolls, lampshade1, monopoly, motorcycle, poles, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    near_vertical: Model {
        bias_q12: -18857,
        coefficients_q12: [
            -14607, // this side's window: cost at the disparity / best cost elsewhere
            1482, // log2(1 + that cost per pixel)
            -478, // log2(1 + how much worse elsewhere is, per pixel)
            9643, // segment window: best cost / best elsewhere
            -3200, // log2(1 + its cost per pixel)
            1113, // census: best cost / best elsewhere
            2310, // log2(1 + its cost per point)
            -6647, // this side's census: cost at the disparity / best elsewhere
            -3489, // |window - census|, px
            -18578, // |difference of the halves' disparities| per row or column
            -1536, // log2(1 + rows or columns)
            495, // the other side's window ratio
            -377, // 1 if the other side prefers another disparity
            -3197, // 1 if this side alone prefers another disparity
            -8777, // 1 if the right image has no such edge there
            -1381, // |the edge in the right image - halves|, px
            290, // -1 left of or above the edge, +1 right or below
            -2194, // slope against its direction, px per px
            1257, // log2(1 + disparities compared)
            -677, // log2(1 + grey step)
            11572, // log2(1 + ranks that change along a window of the image, on average)
            2907, // log2(1 + support points nearby that agree)
            -9162, // share of those that are farther
            -7455, // share of those that are nearer
            698, // log2(1 + segments nearby that agree)
            -4780, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            511, // how unique the other side is at a nearer disparity, 0 ..= 1
            -890, // distance of the pixel from the edge, px
            -1061, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            86, 131, 200, 305, 466, 710, 1079, 1635, 2467, 3698, 5490,
            8037, 11539, 16138, 21830, 28376, 35299, 42002, 47960, 52864, 56832, 59695,
            62245, 63716, 64248, 64627, 65144, 65368, 65464, 65505, 65523, 65530, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 466, 386, 294, 125, 70, 46, 34, 28, 24,
            21, 19, 17, 16, 14, 13, 12, 11, 10, 10, 10,
        ],
    },
    near_horizontal: Model {
        bias_q12: -2938,
        coefficients_q12: [
            -6246, // this side's window: cost at the disparity / best cost elsewhere
            57, // log2(1 + that cost per pixel)
            -1313, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -4686, // census: best cost / best elsewhere
            839, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3032, // |window - census|, px
            -27666, // |difference of the halves' disparities| per row or column
            -2228, // log2(1 + rows or columns)
            -1133, // the other side's window ratio
            -79, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -332, // -1 left of or above the edge, +1 right or below
            -4779, // slope against its direction, px per px
            519, // log2(1 + disparities compared)
            -1102, // log2(1 + grey step)
            9436, // log2(1 + ranks that change along a window of the image, on average)
            2969, // log2(1 + support points nearby that agree)
            -6587, // share of those that are farther
            -6312, // share of those that are nearer
            1287, // log2(1 + segments nearby that agree)
            34, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -4917, // the less unique half: cost at the disparity / best elsewhere
            -653, // how unique the other side is at a nearer disparity, 0 ..= 1
            -593, // distance of the pixel from the edge, px
            -2154, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            296, 419, 593, 837, 1180, 1659, 2327, 3250, 4513, 6218, 8476,
            11398, 15061, 19478, 24559, 30100, 35799, 41319, 46363, 50733, 56324, 60033,
            62202, 63544, 64573, 65074, 65325, 65440, 65492, 65516, 65527, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            415, 288, 232, 166, 123, 93, 72, 56, 43, 33, 27,
            23, 20, 17, 16, 14, 13, 12, 11, 11, 11, 11,
        ],
    },
    near_vertical_edge: Model {
        bias_q12: -10394,
        coefficients_q12: [
            -3005, // this side's window: cost at the disparity / best cost elsewhere
            893, // log2(1 + that cost per pixel)
            312, // log2(1 + how much worse elsewhere is, per pixel)
            -24, // segment window: best cost / best elsewhere
            -3624, // log2(1 + its cost per pixel)
            -2779, // census: best cost / best elsewhere
            921, // log2(1 + its cost per point)
            -337, // this side's census: cost at the disparity / best elsewhere
            -2330, // |window - census|, px
            -17930, // |difference of the halves' disparities| per row or column
            -677, // log2(1 + rows or columns)
            -946, // the other side's window ratio
            -823, // 1 if the other side prefers another disparity
            -589, // 1 if this side alone prefers another disparity
            -11805, // 1 if the right image has no such edge there
            -4568, // |the edge in the right image - halves|, px
            103, // -1 left of or above the edge, +1 right or below
            -456, // slope against its direction, px per px
            495, // log2(1 + disparities compared)
            51, // log2(1 + grey step)
            8260, // log2(1 + ranks that change along a window of the image, on average)
            669, // log2(1 + support points nearby that agree)
            -2786, // share of those that are farther
            -7814, // share of those that are nearer
            3893, // log2(1 + segments nearby that agree)
            -459, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            1172, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            79, 123, 191, 298, 463, 718, 1112, 1716, 2635, 4015, 6049,
            8963, 12975, 18205, 24557, 31644, 38838, 45473, 51073, 55457, 58234, 60319,
            61632, 62631, 64126, 64860, 65152, 65318, 65413, 65466, 65497, 65514, 65523,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 353, 339, 205, 90, 59, 38, 29, 24, 21,
            19, 17, 15, 14, 12, 12, 11, 11, 10, 8, 6,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 3260,
        coefficients_q12: [
            -4972, // this side's window: cost at the disparity / best cost elsewhere
            176, // log2(1 + that cost per pixel)
            -1889, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -2685, // census: best cost / best elsewhere
            962, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -2350, // |window - census|, px
            -19700, // |difference of the halves' disparities| per row or column
            -1793, // log2(1 + rows or columns)
            -3234, // the other side's window ratio
            -5041, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -657, // -1 left of or above the edge, +1 right or below
            690, // slope against its direction, px per px
            483, // log2(1 + disparities compared)
            -225, // log2(1 + grey step)
            6658, // log2(1 + ranks that change along a window of the image, on average)
            1294, // log2(1 + support points nearby that agree)
            -4825, // share of those that are farther
            -6136, // share of those that are nearer
            2328, // log2(1 + segments nearby that agree)
            -5227, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -2941, // the less unique half: cost at the disparity / best elsewhere
            -5236, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            282, 400, 568, 805, 1140, 1609, 2266, 3178, 4430, 6128, 8387,
            11320, 15010, 19470, 24610, 30217, 35978, 41545, 46616, 50990, 56124, 59655,
            61960, 63394, 64639, 65165, 65363, 65455, 65498, 65518, 65528, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            429, 325, 221, 167, 132, 101, 73, 53, 41, 32, 26,
            21, 18, 15, 14, 12, 11, 10, 9, 7, 7, 7,
        ],
    },
};
