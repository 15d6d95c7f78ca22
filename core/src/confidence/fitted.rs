//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 28631,
        coefficients_q12: [
            -10264, // this side's window: cost at the disparity / best cost elsewhere
            85, // log2(1 + that cost per pixel)
            557, // log2(1 + how much worse elsewhere is, per pixel)
            4495, // segment window: best cost / best elsewhere
            -4810, // log2(1 + its cost per pixel)
            -3422, // census: best cost / best elsewhere
            2890, // log2(1 + its cost per point)
            -6671, // this side's census: cost at the disparity / best elsewhere
            -6378, // |window - census|, px
            3946, // |searched back - window|, px
            1360, // searching back: best cost / best elsewhere
            -15802, // |difference of the halves' disparities| per row or column
            -421, // log2(1 + rows or columns)
            653, // the other side's window ratio
            137, // 1 if the other side prefers another disparity
            -11178, // 1 if this side alone prefers another disparity
            206, // 1 if a right segment's line agrees
            337, // 1 if no right segment is compatible
            278, // -1 left of or above the edge, +1 right or below
            -2325, // slope against its direction, px per px
            768, // log2(1 + disparities compared)
            -429, // log2(1 + grey step)
            1142, // log2(1 + neighbours that agree)
            -4366, // share of neighbours that contradict
            1611, // the edge itself: cost at the disparity / best elsewhere
            -870, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            136, 206, 310, 466, 701, 1051, 1573, 2345, 3474, 5104, 7406,
            10566, 14732, 19944, 26055, 32696, 39342, 45469, 50703, 54892, 58081, 60404,
            62587, 63867, 64073, 64255, 64962, 65281, 65423, 65486, 65514, 65526, 65532,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 190, 132, 128, 126, 99, 56, 41, 30, 25, 21,
            17, 15, 14, 13, 12, 11, 10, 9, 7, 7, 7,
        ],
    },
    near_horizontal: Model {
        bias_q12: 40542,
        coefficients_q12: [
            -13532, // this side's window: cost at the disparity / best cost elsewhere
            183, // log2(1 + that cost per pixel)
            -1590, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -9986, // census: best cost / best elsewhere
            2295, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -4540, // |window - census|, px
            -903, // |searched back - window|, px
            -2213, // searching back: best cost / best elsewhere
            -32889, // |difference of the halves' disparities| per row or column
            -2988, // log2(1 + rows or columns)
            195, // the other side's window ratio
            -1437, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -261, // -1 left of or above the edge, +1 right or below
            -2496, // slope against its direction, px per px
            1060, // log2(1 + disparities compared)
            -1029, // log2(1 + grey step)
            1304, // log2(1 + neighbours that agree)
            -503, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            -284, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            5067, 5994, 7070, 8314, 9739, 11360, 13188, 15227, 17476, 19925, 22557,
            25343, 28246, 31225, 34229, 37208, 40115, 42905, 45541, 47996, 56756, 61508,
            62501, 63258, 64256, 64821, 65275, 65441, 65502, 65524, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 107, 92, 79, 76, 66, 60, 43, 30, 22,
            19, 16, 14, 13, 12, 11, 10, 10, 10, 10, 10,
        ],
    },
    steep_edge: Model {
        bias_q12: 19057,
        coefficients_q12: [
            -289, // this side's window: cost at the disparity / best cost elsewhere
            -45, // log2(1 + that cost per pixel)
            442, // log2(1 + how much worse elsewhere is, per pixel)
            -8479, // segment window: best cost / best elsewhere
            -3120, // log2(1 + its cost per pixel)
            -3423, // census: best cost / best elsewhere
            277, // log2(1 + its cost per point)
            -251, // this side's census: cost at the disparity / best elsewhere
            -5458, // |window - census|, px
            3478, // |searched back - window|, px
            -8899, // searching back: best cost / best elsewhere
            -20222, // |difference of the halves' disparities| per row or column
            -1193, // log2(1 + rows or columns)
            -1204, // the other side's window ratio
            -96, // 1 if the other side prefers another disparity
            -9137, // 1 if this side alone prefers another disparity
            -299, // 1 if a right segment's line agrees
            -3105, // 1 if no right segment is compatible
            486, // -1 left of or above the edge, +1 right or below
            -2532, // slope against its direction, px per px
            3007, // log2(1 + disparities compared)
            206, // log2(1 + grey step)
            1872, // log2(1 + neighbours that agree)
            31, // share of neighbours that contradict
            5371, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            10583, 11902, 13346, 14917, 16613, 18433, 20368, 22410, 24546, 26759, 29030,
            31338, 33660, 35973, 38255, 40483, 42638, 44703, 46665, 48511, 56783, 61380,
            62710, 63628, 63938, 64199, 65075, 65378, 65482, 65518, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 512, 49, 34, 25, 21,
            19, 16, 13, 11, 10, 9, 9, 9, 9, 8, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 29316,
        coefficients_q12: [
            -7729, // this side's window: cost at the disparity / best cost elsewhere
            -794, // log2(1 + that cost per pixel)
            -553, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -5377, // census: best cost / best elsewhere
            378, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -6492, // |window - census|, px
            -416, // |searched back - window|, px
            -4669, // searching back: best cost / best elsewhere
            -17372, // |difference of the halves' disparities| per row or column
            -1672, // log2(1 + rows or columns)
            113, // the other side's window ratio
            -7823, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -299, // -1 left of or above the edge, +1 right or below
            2671, // slope against its direction, px per px
            696, // log2(1 + disparities compared)
            36, // log2(1 + grey step)
            1174, // log2(1 + neighbours that agree)
            -1245, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            668, 905, 1224, 1652, 2225, 2987, 3994, 5311, 7014, 9179, 11877,
            15154, 19015, 23403, 28190, 33185, 38161, 42893, 47201, 50967, 55623, 58982,
            62412, 64091, 64723, 65080, 65263, 65373, 65438, 65478, 65501, 65515, 65524,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 110, 101, 98, 69, 51, 38, 32, 26,
            19, 15, 13, 12, 11, 10, 9, 8, 7, 7, 7,
        ],
    },
};
