//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 28761,
        coefficients_q12: [
            -10340, // this side's window: cost at the disparity / best cost elsewhere
            97, // log2(1 + that cost per pixel)
            550, // log2(1 + how much worse elsewhere is, per pixel)
            4531, // segment window: best cost / best elsewhere
            -4829, // log2(1 + its cost per pixel)
            -3422, // census: best cost / best elsewhere
            2886, // log2(1 + its cost per point)
            -6676, // this side's census: cost at the disparity / best elsewhere
            -6419, // |window - census|, px
            3895, // |searched back - window|, px
            1476, // searching back: best cost / best elsewhere
            -15621, // |difference of the halves' disparities| per row or column
            -417, // log2(1 + rows or columns)
            629, // the other side's window ratio
            184, // 1 if the other side prefers another disparity
            -11160, // 1 if this side alone prefers another disparity
            224, // 1 if a right segment's line agrees
            385, // 1 if no right segment is compatible
            279, // -1 left of or above the edge, +1 right or below
            -2344, // slope against its direction, px per px
            759, // log2(1 + disparities compared)
            -432, // log2(1 + grey step)
            1116, // log2(1 + neighbours that agree)
            -4439, // share of neighbours that contradict
            1579, // the edge itself: cost at the disparity / best elsewhere
            -869, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            124, 188, 285, 431, 652, 984, 1482, 2222, 3314, 4901, 7159,
            10282, 14430, 19656, 25818, 32543, 39286, 45500, 50795, 55014, 58120, 60394,
            62566, 63846, 64072, 64268, 64960, 65276, 65419, 65483, 65512, 65525, 65531,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 203, 132, 127, 127, 98, 57, 40, 31, 25, 21,
            17, 15, 14, 13, 12, 11, 10, 9, 6, 6, 6,
        ],
    },
    near_horizontal: Model {
        bias_q12: 41637,
        coefficients_q12: [
            -12147, // this side's window: cost at the disparity / best cost elsewhere
            214, // log2(1 + that cost per pixel)
            -1828, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -10431, // census: best cost / best elsewhere
            2421, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5335, // |window - census|, px
            -1052, // |searched back - window|, px
            -2989, // searching back: best cost / best elsewhere
            -33093, // |difference of the halves' disparities| per row or column
            -3198, // log2(1 + rows or columns)
            572, // the other side's window ratio
            -1057, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -306, // -1 left of or above the edge, +1 right or below
            -2892, // slope against its direction, px per px
            983, // log2(1 + disparities compared)
            -1025, // log2(1 + grey step)
            1592, // log2(1 + neighbours that agree)
            -321, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            -351, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            1817, 2313, 2938, 3722, 4699, 5909, 7392, 9190, 11340, 13870, 16788,
            20083, 23709, 27592, 31631, 35705, 39689, 43469, 46956, 50088, 56408, 60407,
            62206, 63397, 64357, 64890, 65311, 65458, 65509, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 107, 94, 82, 76, 66, 54, 43, 30, 23,
            19, 16, 14, 13, 12, 11, 10, 10, 10, 10, 10,
        ],
    },
    steep_edge: Model {
        bias_q12: 19141,
        coefficients_q12: [
            -313, // this side's window: cost at the disparity / best cost elsewhere
            -52, // log2(1 + that cost per pixel)
            443, // log2(1 + how much worse elsewhere is, per pixel)
            -8497, // segment window: best cost / best elsewhere
            -3125, // log2(1 + its cost per pixel)
            -3431, // census: best cost / best elsewhere
            287, // log2(1 + its cost per point)
            -253, // this side's census: cost at the disparity / best elsewhere
            -5474, // |window - census|, px
            3459, // |searched back - window|, px
            -8868, // searching back: best cost / best elsewhere
            -20186, // |difference of the halves' disparities| per row or column
            -1193, // log2(1 + rows or columns)
            -1204, // the other side's window ratio
            -87, // 1 if the other side prefers another disparity
            -9134, // 1 if this side alone prefers another disparity
            -299, // 1 if a right segment's line agrees
            -3109, // 1 if no right segment is compatible
            486, // -1 left of or above the edge, +1 right or below
            -2535, // slope against its direction, px per px
            3003, // log2(1 + disparities compared)
            205, // log2(1 + grey step)
            1856, // log2(1 + neighbours that agree)
            2, // share of neighbours that contradict
            5369, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            11528, 12869, 14325, 15896, 17579, 19372, 21266, 23252, 25317, 27447, 29624,
            31830, 34043, 36246, 38417, 40538, 42592, 44565, 46444, 48220, 56778, 61463,
            62722, 63603, 63935, 64210, 65075, 65377, 65481, 65517, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 512, 57, 32, 26, 21,
            19, 16, 13, 11, 10, 9, 9, 9, 9, 8, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 28918,
        coefficients_q12: [
            -7044, // this side's window: cost at the disparity / best cost elsewhere
            -915, // log2(1 + that cost per pixel)
            -434, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -6453, // census: best cost / best elsewhere
            681, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -6085, // |window - census|, px
            -769, // |searched back - window|, px
            -4337, // searching back: best cost / best elsewhere
            -17809, // |difference of the halves' disparities| per row or column
            -1556, // log2(1 + rows or columns)
            113, // the other side's window ratio
            -7963, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -278, // -1 left of or above the edge, +1 right or below
            3899, // slope against its direction, px per px
            796, // log2(1 + disparities compared)
            -75, // log2(1 + grey step)
            1042, // log2(1 + neighbours that agree)
            -1505, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            937, 1242, 1643, 2171, 2860, 3754, 4906, 6376, 8226, 10518, 13300,
            16595, 20389, 24613, 29148, 33828, 38464, 42877, 46919, 50493, 55508, 59066,
            62486, 64141, 64725, 65066, 65247, 65359, 65427, 65469, 65495, 65511, 65521,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 107, 99, 84, 70, 52, 38, 31, 25,
            19, 15, 13, 11, 10, 9, 9, 8, 7, 7, 7,
        ],
    },
};
