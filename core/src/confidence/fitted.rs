//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 39567,
        coefficients_q12: [
            -21918, // this side's window: cost at the disparity / best cost elsewhere
            2965, // log2(1 + that cost per pixel)
            -1725, // log2(1 + how much worse elsewhere is, per pixel)
            1920, // segment window: best cost / best elsewhere
            -4627, // log2(1 + its cost per pixel)
            -2576, // census: best cost / best elsewhere
            3300, // log2(1 + its cost per point)
            -13942, // this side's census: cost at the disparity / best elsewhere
            -7965, // |window - census|, px
            5784, // |searched back - window|, px
            979, // searching back: best cost / best elsewhere
            -16846, // |difference of the halves' disparities| per row or column
            1185, // log2(1 + rows or columns)
            183, // the other side's window ratio
            -403, // 1 if the other side prefers another disparity
            -10705, // 1 if this side alone prefers another disparity
            1686, // 1 if a right segment's line agrees
            4340, // 1 if no right segment is compatible
            59, // -1 left of or above the edge, +1 right or below
            -2411, // slope against its direction, px per px
            -568, // log2(1 + disparities compared)
            -905, // log2(1 + grey step)
            147, // log2(1 + neighbours that agree)
            -2238, // share of neighbours that contradict
            4962, // the edge itself: cost at the disparity / best elsewhere
            -1017, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            188, 276, 405, 595, 871, 1274, 1858, 2697, 3893, 5572, 7882,
            10975, 14966, 19880, 25591, 31799, 38079, 43981, 49161, 53438, 56392, 58717,
            61663, 63382, 64420, 64963, 65383, 65495, 65525, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 132,
            132, 132, 132, 132, 132, 112, 79, 44, 32, 27, 23,
            19, 16, 14, 13, 11, 10, 9, 8, 7, 7, 7,
        ],
    },
    near_horizontal: Model {
        bias_q12: 39008,
        coefficients_q12: [
            -7860, // this side's window: cost at the disparity / best cost elsewhere
            -298, // log2(1 + that cost per pixel)
            -1075, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -12682, // census: best cost / best elsewhere
            2649, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -4242, // |window - census|, px
            -865, // |searched back - window|, px
            -4451, // searching back: best cost / best elsewhere
            -38127, // |difference of the halves' disparities| per row or column
            -2932, // log2(1 + rows or columns)
            555, // the other side's window ratio
            -627, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            152, // -1 left of or above the edge, +1 right or below
            -3143, // slope against its direction, px per px
            817, // log2(1 + disparities compared)
            -1230, // log2(1 + grey step)
            1591, // log2(1 + neighbours that agree)
            -1008, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            116, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            2539, 3161, 3926, 4862, 6000, 7371, 9007, 10940, 13189, 15768, 18671,
            21874, 25330, 28968, 32705, 36443, 40087, 43550, 46762, 49676, 55537, 59495,
            62378, 63922, 64504, 64878, 65397, 65507, 65526, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 122, 103, 103, 84, 84, 73, 56, 37, 29, 23,
            19, 17, 14, 12, 11, 10, 10, 9, 8, 8, 8,
        ],
    },
    steep_edge: Model {
        bias_q12: 12624,
        coefficients_q12: [
            -5008, // this side's window: cost at the disparity / best cost elsewhere
            420, // log2(1 + that cost per pixel)
            -244, // log2(1 + how much worse elsewhere is, per pixel)
            -4050, // segment window: best cost / best elsewhere
            -2260, // log2(1 + its cost per pixel)
            -8364, // census: best cost / best elsewhere
            832, // log2(1 + its cost per point)
            -1364, // this side's census: cost at the disparity / best elsewhere
            -6768, // |window - census|, px
            1703, // |searched back - window|, px
            -2763, // searching back: best cost / best elsewhere
            -23348, // |difference of the halves' disparities| per row or column
            963, // log2(1 + rows or columns)
            -875, // the other side's window ratio
            -1786, // 1 if the other side prefers another disparity
            1016, // 1 if this side alone prefers another disparity
            3315, // 1 if a right segment's line agrees
            2629, // 1 if no right segment is compatible
            70, // -1 left of or above the edge, +1 right or below
            -2731, // slope against its direction, px per px
            2101, // log2(1 + disparities compared)
            -430, // log2(1 + grey step)
            1585, // log2(1 + neighbours that agree)
            2798, // share of neighbours that contradict
            1381, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            1007, 1369, 1858, 2514, 3389, 4547, 6062, 8016, 10488, 13543, 17210,
            21459, 26190, 31224, 36332, 41271, 45828, 49854, 53278, 56096, 57147, 58098,
            61987, 63900, 64207, 64458, 65103, 65363, 65467, 65509, 65525, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 53, 31, 28, 24, 20,
            16, 13, 12, 10, 9, 8, 8, 7, 6, 6, 6,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 37596,
        coefficients_q12: [
            -4386, // this side's window: cost at the disparity / best cost elsewhere
            -755, // log2(1 + that cost per pixel)
            6, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -9229, // census: best cost / best elsewhere
            2134, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -2724, // |window - census|, px
            -361, // |searched back - window|, px
            -4692, // searching back: best cost / best elsewhere
            -24868, // |difference of the halves' disparities| per row or column
            -2508, // log2(1 + rows or columns)
            825, // the other side's window ratio
            -6803, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -1137, // -1 left of or above the edge, +1 right or below
            3490, // slope against its direction, px per px
            -400, // log2(1 + disparities compared)
            -245, // log2(1 + grey step)
            31, // log2(1 + neighbours that agree)
            -3185, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            587, 798, 1083, 1467, 1984, 2675, 3593, 4803, 6377, 8397, 10938,
            14058, 17779, 22062, 26798, 31808, 36862, 41726, 46198, 50140, 55723, 59524,
            62549, 64089, 64598, 64930, 65398, 65505, 65526, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 153, 147, 141, 111, 80, 56, 46, 35, 28,
            21, 18, 16, 14, 12, 11, 9, 7, 7, 7, 7,
        ],
    },
};
