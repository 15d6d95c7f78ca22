//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 40538,
        coefficients_q12: [
            -22043, // this side's window: cost at the disparity / best cost elsewhere
            2900, // log2(1 + that cost per pixel)
            -1707, // log2(1 + how much worse elsewhere is, per pixel)
            1667, // segment window: best cost / best elsewhere
            -4626, // log2(1 + its cost per pixel)
            -2233, // census: best cost / best elsewhere
            3218, // log2(1 + its cost per point)
            -13674, // this side's census: cost at the disparity / best elsewhere
            -7667, // |window - census|, px
            6021, // |searched back - window|, px
            674, // searching back: best cost / best elsewhere
            -16653, // |difference of the halves' disparities| per row or column
            979, // log2(1 + rows or columns)
            191, // the other side's window ratio
            -484, // 1 if the other side prefers another disparity
            -10466, // 1 if this side alone prefers another disparity
            594, // 1 if a right segment's line agrees
            3541, // 1 if no right segment is compatible
            118, // -1 left of or above the edge, +1 right or below
            -3085, // slope against its direction, px per px
            -390, // log2(1 + disparities compared)
            -919, // log2(1 + grey step)
            381, // log2(1 + neighbours that agree)
            -1501, // share of neighbours that contradict
            4354, // the edge itself: cost at the disparity / best elsewhere
            -1056, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            139, 209, 312, 467, 698, 1040, 1547, 2292, 3376, 4934, 7129,
            10136, 14105, 19093, 24988, 31469, 38054, 44228, 49596, 53965, 56316, 58254,
            61671, 63539, 64394, 64887, 65412, 65512, 65526, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 129,
            129, 129, 129, 129, 129, 105, 69, 41, 31, 27, 24,
            20, 16, 14, 13, 11, 10, 9, 8, 7, 7, 7,
        ],
    },
    near_horizontal: Model {
        bias_q12: 39209,
        coefficients_q12: [
            -7431, // this side's window: cost at the disparity / best cost elsewhere
            -264, // log2(1 + that cost per pixel)
            -1154, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -13867, // census: best cost / best elsewhere
            2420, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3967, // |window - census|, px
            -1124, // |searched back - window|, px
            -4557, // searching back: best cost / best elsewhere
            -35746, // |difference of the halves' disparities| per row or column
            -2410, // log2(1 + rows or columns)
            372, // the other side's window ratio
            -349, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            304, // -1 left of or above the edge, +1 right or below
            -1918, // slope against its direction, px per px
            438, // log2(1 + disparities compared)
            -1056, // log2(1 + grey step)
            1226, // log2(1 + neighbours that agree)
            -1619, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            116, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            2918, 3602, 4434, 5443, 6655, 8101, 9809, 11803, 14100, 16705, 19608,
            22780, 26172, 29719, 33339, 36945, 40451, 43781, 46872, 49684, 56034, 60118,
            62258, 63580, 64499, 64990, 65387, 65496, 65525, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 119, 110, 110, 90, 90, 67, 55, 37, 28, 22,
            19, 16, 14, 12, 11, 10, 10, 9, 9, 9, 9,
        ],
    },
    steep_edge: Model {
        bias_q12: 13670,
        coefficients_q12: [
            -5390, // this side's window: cost at the disparity / best cost elsewhere
            413, // log2(1 + that cost per pixel)
            -322, // log2(1 + how much worse elsewhere is, per pixel)
            -4853, // segment window: best cost / best elsewhere
            -2151, // log2(1 + its cost per pixel)
            -7307, // census: best cost / best elsewhere
            776, // log2(1 + its cost per point)
            -852, // this side's census: cost at the disparity / best elsewhere
            -6466, // |window - census|, px
            2577, // |searched back - window|, px
            -3340, // searching back: best cost / best elsewhere
            -22721, // |difference of the halves' disparities| per row or column
            874, // log2(1 + rows or columns)
            -848, // the other side's window ratio
            -1847, // 1 if the other side prefers another disparity
            859, // 1 if this side alone prefers another disparity
            2433, // 1 if a right segment's line agrees
            2322, // 1 if no right segment is compatible
            105, // -1 left of or above the edge, +1 right or below
            -2936, // slope against its direction, px per px
            2141, // log2(1 + disparities compared)
            -363, // log2(1 + grey step)
            1593, // log2(1 + neighbours that agree)
            2721, // share of neighbours that contradict
            297, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            12012, 13760, 15687, 17792, 20066, 22493, 25053, 27715, 30449, 33214, 35974,
            38688, 41321, 43841, 46221, 48441, 50490, 52359, 54050, 55564, 56859, 58008,
            61877, 63816, 64207, 64510, 65135, 65380, 65476, 65513, 65527, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 42, 29, 27, 25, 21,
            17, 13, 12, 10, 9, 8, 8, 7, 6, 6, 6,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 39245,
        coefficients_q12: [
            -4897, // this side's window: cost at the disparity / best cost elsewhere
            -767, // log2(1 + that cost per pixel)
            -42, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -9865, // census: best cost / best elsewhere
            2168, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -2735, // |window - census|, px
            120, // |searched back - window|, px
            -4113, // searching back: best cost / best elsewhere
            -23768, // |difference of the halves' disparities| per row or column
            -2528, // log2(1 + rows or columns)
            209, // the other side's window ratio
            -6673, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -1047, // -1 left of or above the edge, +1 right or below
            4570, // slope against its direction, px per px
            -568, // log2(1 + disparities compared)
            -146, // log2(1 + grey step)
            -178, // log2(1 + neighbours that agree)
            -3848, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            533, 728, 994, 1355, 1844, 2501, 3380, 4546, 6075, 8050, 10553,
            13650, 17369, 21678, 26468, 31555, 36701, 41658, 46211, 50215, 55925, 59752,
            62636, 64116, 64572, 64883, 65330, 65472, 65516, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 182, 145, 145, 111, 79, 55, 44, 35, 28,
            21, 19, 16, 14, 12, 11, 9, 7, 7, 7, 7,
        ],
    },
};
