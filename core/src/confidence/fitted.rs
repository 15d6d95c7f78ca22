//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 27918,
        coefficients_q12: [
            -8793, // this side's window: cost at the disparity / best cost elsewhere
            -80, // log2(1 + that cost per pixel)
            937, // log2(1 + how much worse elsewhere is, per pixel)
            5812, // segment window: best cost / best elsewhere
            -4713, // log2(1 + its cost per pixel)
            -1812, // census: best cost / best elsewhere
            2832, // log2(1 + its cost per point)
            -6678, // this side's census: cost at the disparity / best elsewhere
            -5649, // |window - census|, px
            3668, // |searched back - window|, px
            811, // searching back: best cost / best elsewhere
            -20347, // |difference of the halves' disparities| per row or column
            -424, // log2(1 + rows or columns)
            249, // the other side's window ratio
            615, // 1 if the other side prefers another disparity
            -11486, // 1 if this side alone prefers another disparity
            -147, // 1 if a right segment's line agrees
            181, // 1 if no right segment is compatible
            205, // -1 left of or above the edge, +1 right or below
            -2342, // slope against its direction, px per px
            810, // log2(1 + disparities compared)
            -640, // log2(1 + grey step)
            1336, // log2(1 + neighbours that agree)
            -3225, // share of neighbours that contradict
            167, // the edge itself: cost at the disparity / best elsewhere
            -943, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            82, 128, 199, 310, 482, 747, 1155, 1781, 2732, 4157, 6251,
            9242, 13341, 18656, 25072, 32179, 39343, 45906, 51415, 55709, 58178, 60087,
            62322, 63669, 64204, 64588, 64973, 65202, 65338, 65419, 65467, 65495, 65512,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 262, 140, 130, 125, 91, 49, 36, 31, 26, 21,
            17, 15, 14, 13, 12, 11, 10, 9, 7, 7, 7,
        ],
    },
    near_horizontal: Model {
        bias_q12: 39797,
        coefficients_q12: [
            -11861, // this side's window: cost at the disparity / best cost elsewhere
            421, // log2(1 + that cost per pixel)
            -2142, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -11243, // census: best cost / best elsewhere
            2259, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5517, // |window - census|, px
            -685, // |searched back - window|, px
            -2945, // searching back: best cost / best elsewhere
            -34936, // |difference of the halves' disparities| per row or column
            -3264, // log2(1 + rows or columns)
            1735, // the other side's window ratio
            -1454, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -350, // -1 left of or above the edge, +1 right or below
            -3136, // slope against its direction, px per px
            1425, // log2(1 + disparities compared)
            -1233, // log2(1 + grey step)
            2212, // log2(1 + neighbours that agree)
            977, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            -382, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            744, 1000, 1344, 1801, 2409, 3212, 4264, 5629, 7379, 9586, 12314,
            15600, 19444, 23783, 28493, 33389, 38257, 42889, 47113, 50819, 56540, 60267,
            62260, 63524, 64292, 64770, 65344, 65488, 65524, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 107, 100, 94, 85, 69, 55, 40, 30, 24,
            20, 16, 15, 13, 12, 11, 11, 10, 10, 10, 10,
        ],
    },
    steep_edge: Model {
        bias_q12: 17130,
        coefficients_q12: [
            -1004, // this side's window: cost at the disparity / best cost elsewhere
            3, // log2(1 + that cost per pixel)
            557, // log2(1 + how much worse elsewhere is, per pixel)
            -7333, // segment window: best cost / best elsewhere
            -3198, // log2(1 + its cost per pixel)
            -3528, // census: best cost / best elsewhere
            469, // log2(1 + its cost per point)
            -840, // this side's census: cost at the disparity / best elsewhere
            -5186, // |window - census|, px
            2279, // |searched back - window|, px
            -7644, // searching back: best cost / best elsewhere
            -27121, // |difference of the halves' disparities| per row or column
            -1336, // log2(1 + rows or columns)
            -1346, // the other side's window ratio
            -34, // 1 if the other side prefers another disparity
            -9043, // 1 if this side alone prefers another disparity
            -808, // 1 if a right segment's line agrees
            -3147, // 1 if no right segment is compatible
            485, // -1 left of or above the edge, +1 right or below
            -2332, // slope against its direction, px per px
            3217, // log2(1 + disparities compared)
            510, // log2(1 + grey step)
            1863, // log2(1 + neighbours that agree)
            159, // share of neighbours that contradict
            5208, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            10118, 11428, 12868, 14440, 16146, 17983, 19944, 22020, 24197, 26459, 28785,
            31152, 33537, 35913, 38256, 40543, 42753, 44867, 46870, 48752, 56452, 60951,
            62622, 63703, 63969, 64198, 65084, 65385, 65486, 65519, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 512, 44, 32, 26, 23,
            19, 16, 13, 11, 10, 9, 9, 9, 8, 8, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 30264,
        coefficients_q12: [
            -6193, // this side's window: cost at the disparity / best cost elsewhere
            -889, // log2(1 + that cost per pixel)
            -536, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -7483, // census: best cost / best elsewhere
            985, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5861, // |window - census|, px
            -501, // |searched back - window|, px
            -4493, // searching back: best cost / best elsewhere
            -20374, // |difference of the halves' disparities| per row or column
            -1888, // log2(1 + rows or columns)
            205, // the other side's window ratio
            -7954, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -282, // -1 left of or above the edge, +1 right or below
            5188, // slope against its direction, px per px
            764, // log2(1 + disparities compared)
            -40, // log2(1 + grey step)
            1009, // log2(1 + neighbours that agree)
            -1710, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            762, 1023, 1371, 1835, 2449, 3259, 4318, 5690, 7445, 9653, 12378,
            15656, 19483, 23800, 28482, 33349, 38191, 42800, 47010, 50710, 55398, 58800,
            62537, 64246, 64722, 65024, 65253, 65380, 65450, 65489, 65510, 65522, 65528,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 102, 98, 88, 67, 52, 38, 32, 25,
            20, 15, 13, 11, 10, 9, 9, 8, 7, 7, 7,
        ],
    },
};
