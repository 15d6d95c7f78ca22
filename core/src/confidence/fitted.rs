//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 37176,
        coefficients_q12: [
            -18265, // this side's window: cost at the disparity / best cost elsewhere
            2207, // log2(1 + that cost per pixel)
            -1076, // log2(1 + how much worse elsewhere is, per pixel)
            2415, // segment window: best cost / best elsewhere
            -4445, // log2(1 + its cost per pixel)
            -3629, // census: best cost / best elsewhere
            3813, // log2(1 + its cost per point)
            -13685, // this side's census: cost at the disparity / best elsewhere
            -8229, // |window - census|, px
            5759, // |searched back - window|, px
            317, // searching back: best cost / best elsewhere
            -15738, // |difference of the halves' disparities| per row or column
            1210, // log2(1 + rows or columns)
            325, // the other side's window ratio
            -281, // 1 if the other side prefers another disparity
            -8552, // 1 if this side alone prefers another disparity
            1940, // 1 if a right segment's line agrees
            4407, // 1 if no right segment is compatible
            305, // -1 left of or above the edge, +1 right or below
            -2435, // slope against its direction, px per px
            -365, // log2(1 + disparities compared)
            -1088, // log2(1 + grey step)
            52, // log2(1 + neighbours that agree)
            -2277, // share of neighbours that contradict
            4375, // the edge itself: cost at the disparity / best elsewhere
            -961, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            531, 733, 1012, 1394, 1915, 2624, 3581, 4860, 6547, 8735, 11512,
            14940, 19029, 23712, 28833, 34158, 39409, 44328, 48715, 52463, 56189, 58985,
            61791, 63438, 64402, 64927, 65391, 65502, 65526, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            149, 149, 149, 149, 87, 87, 78, 47, 32, 27, 23,
            19, 16, 14, 13, 11, 10, 9, 8, 6, 6, 6,
        ],
    },
    near_horizontal: Model {
        bias_q12: 41884,
        coefficients_q12: [
            -9931, // this side's window: cost at the disparity / best cost elsewhere
            10, // log2(1 + that cost per pixel)
            -1679, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -13918, // census: best cost / best elsewhere
            3165, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3745, // |window - census|, px
            -1223, // |searched back - window|, px
            -4920, // searching back: best cost / best elsewhere
            -39581, // |difference of the halves' disparities| per row or column
            -3105, // log2(1 + rows or columns)
            484, // the other side's window ratio
            -374, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            243, // -1 left of or above the edge, +1 right or below
            -4285, // slope against its direction, px per px
            880, // log2(1 + disparities compared)
            -1283, // log2(1 + grey step)
            1700, // log2(1 + neighbours that agree)
            -822, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            85, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            1049, 1383, 1820, 2390, 3129, 4082, 5302, 6845, 8772, 11138, 13985,
            17328, 21142, 25355, 29843, 34444, 38979, 43281, 47213, 50689, 56211, 59907,
            62221, 63614, 64404, 64872, 65338, 65477, 65519, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 101, 101, 101, 101, 99, 73, 53, 38, 29, 23,
            19, 17, 14, 13, 11, 10, 10, 10, 9, 9, 9,
        ],
    },
    steep_edge: Model {
        bias_q12: 14082,
        coefficients_q12: [
            -1991, // this side's window: cost at the disparity / best cost elsewhere
            -493, // log2(1 + that cost per pixel)
            -115, // log2(1 + how much worse elsewhere is, per pixel)
            -2615, // segment window: best cost / best elsewhere
            -1886, // log2(1 + its cost per pixel)
            -10210, // census: best cost / best elsewhere
            1252, // log2(1 + its cost per point)
            -998, // this side's census: cost at the disparity / best elsewhere
            -6996, // |window - census|, px
            2686, // |searched back - window|, px
            -4929, // searching back: best cost / best elsewhere
            -23232, // |difference of the halves' disparities| per row or column
            1100, // log2(1 + rows or columns)
            -291, // the other side's window ratio
            -2757, // 1 if the other side prefers another disparity
            -331, // 1 if this side alone prefers another disparity
            3385, // 1 if a right segment's line agrees
            2498, // 1 if no right segment is compatible
            161, // -1 left of or above the edge, +1 right or below
            -3093, // slope against its direction, px per px
            1984, // log2(1 + disparities compared)
            -522, // log2(1 + grey step)
            1382, // log2(1 + neighbours that agree)
            1947, // share of neighbours that contradict
            1161, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            904, 1231, 1674, 2269, 3066, 4125, 5518, 7324, 9627, 12499, 15982,
            20068, 24679, 29658, 34787, 39818, 44524, 48731, 52346, 55346, 56950, 58334,
            61924, 63778, 64198, 64519, 65107, 65356, 65460, 65504, 65523, 65530, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 43, 35, 28, 24, 20,
            16, 14, 12, 11, 9, 8, 8, 8, 7, 6, 6,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 38694,
        coefficients_q12: [
            -5360, // this side's window: cost at the disparity / best cost elsewhere
            -957, // log2(1 + that cost per pixel)
            -47, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -9058, // census: best cost / best elsewhere
            2633, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -1915, // |window - census|, px
            -752, // |searched back - window|, px
            -4463, // searching back: best cost / best elsewhere
            -25291, // |difference of the halves' disparities| per row or column
            -2515, // log2(1 + rows or columns)
            444, // the other side's window ratio
            -6723, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -998, // -1 left of or above the edge, +1 right or below
            3059, // slope against its direction, px per px
            -244, // log2(1 + disparities compared)
            -444, // log2(1 + grey step)
            39, // log2(1 + neighbours that agree)
            -2980, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            976, 1286, 1693, 2224, 2913, 3804, 4945, 6393, 8207, 10446, 13154,
            16357, 20042, 24148, 28568, 33149, 37715, 42092, 46135, 49743, 55614, 59564,
            62510, 64039, 64669, 65035, 65403, 65501, 65526, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 137, 137, 137, 101, 69, 55, 46, 36, 28,
            22, 18, 16, 14, 12, 11, 9, 8, 8, 8, 8,
        ],
    },
};
