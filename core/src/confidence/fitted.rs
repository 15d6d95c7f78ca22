//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 34581,
        coefficients_q12: [
            -17374, // this side's window: cost at the disparity / best cost elsewhere
            2030, // log2(1 + that cost per pixel)
            -880, // log2(1 + how much worse elsewhere is, per pixel)
            1826, // segment window: best cost / best elsewhere
            -4169, // log2(1 + its cost per pixel)
            -2618, // census: best cost / best elsewhere
            3744, // log2(1 + its cost per point)
            -14247, // this side's census: cost at the disparity / best elsewhere
            -8390, // |window - census|, px
            5357, // |searched back - window|, px
            329, // searching back: best cost / best elsewhere
            -18042, // |difference of the halves' disparities| per row or column
            1196, // log2(1 + rows or columns)
            186, // the other side's window ratio
            -739, // 1 if the other side prefers another disparity
            -7946, // 1 if this side alone prefers another disparity
            2328, // 1 if a right segment's line agrees
            5584, // 1 if no right segment is compatible
            434, // -1 left of or above the edge, +1 right or below
            -2425, // slope against its direction, px per px
            -286, // log2(1 + disparities compared)
            -1141, // log2(1 + grey step)
            323, // log2(1 + neighbours that agree)
            -1545, // share of neighbours that contradict
            5350, // the edge itself: cost at the disparity / best elsewhere
            -859, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            477, 663, 920, 1276, 1765, 2435, 3345, 4571, 6202, 8335, 11064,
            14461, 18546, 23260, 28446, 33863, 39220, 44241, 48715, 52525, 56450, 59331,
            62019, 63580, 64328, 64793, 65376, 65502, 65526, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            163, 163, 163, 162, 109, 88, 74, 46, 30, 25, 21,
            18, 15, 13, 12, 10, 9, 8, 8, 7, 7, 7,
        ],
    },
    near_horizontal: Model {
        bias_q12: 42100,
        coefficients_q12: [
            -9519, // this side's window: cost at the disparity / best cost elsewhere
            -90, // log2(1 + that cost per pixel)
            -1471, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -14264, // census: best cost / best elsewhere
            2943, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3021, // |window - census|, px
            -946, // |searched back - window|, px
            -3843, // searching back: best cost / best elsewhere
            -38092, // |difference of the halves' disparities| per row or column
            -3040, // log2(1 + rows or columns)
            -633, // the other side's window ratio
            -570, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            150, // -1 left of or above the edge, +1 right or below
            -4460, // slope against its direction, px per px
            682, // log2(1 + disparities compared)
            -1326, // log2(1 + grey step)
            1814, // log2(1 + neighbours that agree)
            -21, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            82, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            847, 1132, 1512, 2014, 2677, 3546, 4676, 6130, 7977, 10284, 13106,
            16473, 20367, 24719, 29396, 34215, 38973, 43474, 47564, 51146, 56652, 60269,
            62347, 63631, 64344, 64793, 65301, 65462, 65513, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 115, 115, 115, 97, 72, 52, 35, 27, 22,
            19, 16, 14, 12, 10, 10, 9, 9, 9, 9, 9,
        ],
    },
    steep_edge: Model {
        bias_q12: 14031,
        coefficients_q12: [
            -1996, // this side's window: cost at the disparity / best cost elsewhere
            -494, // log2(1 + that cost per pixel)
            -115, // log2(1 + how much worse elsewhere is, per pixel)
            -2624, // segment window: best cost / best elsewhere
            -1882, // log2(1 + its cost per pixel)
            -10203, // census: best cost / best elsewhere
            1257, // log2(1 + its cost per point)
            -994, // this side's census: cost at the disparity / best elsewhere
            -7005, // |window - census|, px
            2681, // |searched back - window|, px
            -4922, // searching back: best cost / best elsewhere
            -23221, // |difference of the halves' disparities| per row or column
            1103, // log2(1 + rows or columns)
            -287, // the other side's window ratio
            -2754, // 1 if the other side prefers another disparity
            -325, // 1 if this side alone prefers another disparity
            3383, // 1 if a right segment's line agrees
            2494, // 1 if no right segment is compatible
            160, // -1 left of or above the edge, +1 right or below
            -3087, // slope against its direction, px per px
            1990, // log2(1 + disparities compared)
            -522, // log2(1 + grey step)
            1385, // log2(1 + neighbours that agree)
            1895, // share of neighbours that contradict
            1158, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            905, 1232, 1674, 2270, 3068, 4127, 5520, 7326, 9629, 12501, 15984,
            20071, 24681, 29660, 34788, 39819, 44524, 48731, 52345, 55345, 56951, 58337,
            61924, 63777, 64197, 64518, 65107, 65356, 65461, 65504, 65523, 65530, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 45, 35, 27, 23, 20,
            16, 14, 11, 11, 9, 8, 8, 8, 7, 6, 6,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 36898,
        coefficients_q12: [
            -5741, // this side's window: cost at the disparity / best cost elsewhere
            -915, // log2(1 + that cost per pixel)
            37, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -8717, // census: best cost / best elsewhere
            1797, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -1275, // |window - census|, px
            -882, // |searched back - window|, px
            -3178, // searching back: best cost / best elsewhere
            -20448, // |difference of the halves' disparities| per row or column
            -1676, // log2(1 + rows or columns)
            -1190, // the other side's window ratio
            -7617, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -941, // -1 left of or above the edge, +1 right or below
            4103, // slope against its direction, px per px
            -175, // log2(1 + disparities compared)
            -607, // log2(1 + grey step)
            104, // log2(1 + neighbours that agree)
            -3275, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            737, 989, 1326, 1775, 2370, 3154, 4181, 5513, 7219, 9371, 12032,
            15243, 19007, 23270, 27915, 32769, 37623, 42268, 46531, 50294, 56063, 59893,
            62408, 63834, 64530, 64945, 65318, 65456, 65507, 65525, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 209, 153, 101, 63, 53, 43, 32, 23,
            18, 14, 12, 10, 8, 8, 7, 7, 6, 6, 6,
        ],
    },
};
