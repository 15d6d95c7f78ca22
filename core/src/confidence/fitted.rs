//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 28672,
        coefficients_q12: [
            -8425, // this side's window: cost at the disparity / best cost elsewhere
            -84, // log2(1 + that cost per pixel)
            992, // log2(1 + how much worse elsewhere is, per pixel)
            6133, // segment window: best cost / best elsewhere
            -4913, // log2(1 + its cost per pixel)
            -1752, // census: best cost / best elsewhere
            2749, // log2(1 + its cost per point)
            -6930, // this side's census: cost at the disparity / best elsewhere
            -5388, // |window - census|, px
            3926, // |searched back - window|, px
            962, // searching back: best cost / best elsewhere
            -20678, // |difference of the halves' disparities| per row or column
            -354, // log2(1 + rows or columns)
            186, // the other side's window ratio
            660, // 1 if the other side prefers another disparity
            -10777, // 1 if this side alone prefers another disparity
            -184, // 1 if a right segment's line agrees
            557, // 1 if no right segment is compatible
            256, // -1 left of or above the edge, +1 right or below
            -2252, // slope against its direction, px per px
            793, // log2(1 + disparities compared)
            -742, // log2(1 + grey step)
            1153, // log2(1 + neighbours that agree)
            -3847, // share of neighbours that contradict
            300, // the edge itself: cost at the disparity / best elsewhere
            -945, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            93, 143, 221, 341, 526, 810, 1244, 1904, 2898, 4376, 6528,
            9573, 13709, 19024, 25391, 32403, 39450, 45905, 51338, 55593, 58095, 60030,
            62311, 63677, 64221, 64608, 64991, 65217, 65349, 65427, 65472, 65499, 65514,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 246, 140, 130, 125, 83, 50, 38, 31, 26, 21,
            17, 15, 14, 13, 12, 11, 10, 9, 8, 8, 8,
        ],
    },
    near_horizontal: Model {
        bias_q12: 40920,
        coefficients_q12: [
            -12824, // this side's window: cost at the disparity / best cost elsewhere
            637, // log2(1 + that cost per pixel)
            -2392, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -11187, // census: best cost / best elsewhere
            2506, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5546, // |window - census|, px
            -627, // |searched back - window|, px
            -3326, // searching back: best cost / best elsewhere
            -35222, // |difference of the halves' disparities| per row or column
            -3438, // log2(1 + rows or columns)
            1983, // the other side's window ratio
            -1461, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -260, // -1 left of or above the edge, +1 right or below
            -2938, // slope against its direction, px per px
            1360, // log2(1 + disparities compared)
            -1143, // log2(1 + grey step)
            2110, // log2(1 + neighbours that agree)
            641, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            -368, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            853, 1138, 1515, 2013, 2669, 3526, 4637, 6065, 7876, 10135, 12897,
            16192, 20008, 24282, 28889, 33657, 38388, 42889, 47004, 50631, 56430, 60211,
            62304, 63601, 64315, 64769, 65310, 65470, 65517, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 101, 96, 91, 85, 70, 55, 40, 30, 23,
            20, 16, 15, 13, 12, 11, 11, 11, 10, 10, 10,
        ],
    },
    steep_edge: Model {
        bias_q12: 17470,
        coefficients_q12: [
            -862, // this side's window: cost at the disparity / best cost elsewhere
            19, // log2(1 + that cost per pixel)
            550, // log2(1 + how much worse elsewhere is, per pixel)
            -7278, // segment window: best cost / best elsewhere
            -3307, // log2(1 + its cost per pixel)
            -3635, // census: best cost / best elsewhere
            330, // log2(1 + its cost per point)
            -863, // this side's census: cost at the disparity / best elsewhere
            -5210, // |window - census|, px
            2129, // |searched back - window|, px
            -7482, // searching back: best cost / best elsewhere
            -27051, // |difference of the halves' disparities| per row or column
            -1254, // log2(1 + rows or columns)
            -1402, // the other side's window ratio
            -53, // 1 if the other side prefers another disparity
            -8732, // 1 if this side alone prefers another disparity
            -806, // 1 if a right segment's line agrees
            -3148, // 1 if no right segment is compatible
            528, // -1 left of or above the edge, +1 right or below
            -2489, // slope against its direction, px per px
            3212, // log2(1 + disparities compared)
            398, // log2(1 + grey step)
            1945, // log2(1 + neighbours that agree)
            917, // share of neighbours that contradict
            5269, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            6788, 7924, 9220, 10689, 12340, 14181, 16212, 18431, 20824, 23374, 26054,
            28832, 31668, 34521, 37347, 40105, 42758, 45275, 47629, 49805, 56563, 60700,
            62607, 63783, 63995, 64182, 65083, 65386, 65486, 65520, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 512, 40, 30, 26, 23,
            19, 16, 14, 11, 10, 9, 9, 9, 8, 8, 6,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 29886,
        coefficients_q12: [
            -6127, // this side's window: cost at the disparity / best cost elsewhere
            -907, // log2(1 + that cost per pixel)
            -467, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -6704, // census: best cost / best elsewhere
            842, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5672, // |window - census|, px
            -381, // |searched back - window|, px
            -4539, // searching back: best cost / best elsewhere
            -21584, // |difference of the halves' disparities| per row or column
            -1857, // log2(1 + rows or columns)
            546, // the other side's window ratio
            -8040, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -254, // -1 left of or above the edge, +1 right or below
            4938, // slope against its direction, px per px
            831, // log2(1 + disparities compared)
            -171, // log2(1 + grey step)
            1055, // log2(1 + neighbours that agree)
            -1423, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            966, 1279, 1689, 2227, 2928, 3837, 5004, 6490, 8357, 10663, 13455,
            16756, 20547, 24761, 29276, 33929, 38536, 42919, 46934, 50486, 55363, 58868,
            62586, 64275, 64734, 65027, 65253, 65379, 65449, 65488, 65509, 65521, 65528,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 103, 103, 100, 67, 50, 37, 33, 25,
            20, 15, 13, 11, 10, 9, 9, 8, 8, 8, 8,
        ],
    },
};
