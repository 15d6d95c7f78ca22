//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 30016,
        coefficients_q12: [
            -9084, // this side's window: cost at the disparity / best cost elsewhere
            114, // log2(1 + that cost per pixel)
            914, // log2(1 + how much worse elsewhere is, per pixel)
            6719, // segment window: best cost / best elsewhere
            -5015, // log2(1 + its cost per pixel)
            -1972, // census: best cost / best elsewhere
            3073, // log2(1 + its cost per point)
            -7016, // this side's census: cost at the disparity / best elsewhere
            -5721, // |window - census|, px
            3935, // |searched back - window|, px
            198, // searching back: best cost / best elsewhere
            -19659, // |difference of the halves' disparities| per row or column
            -298, // log2(1 + rows or columns)
            417, // the other side's window ratio
            128, // 1 if the other side prefers another disparity
            -9094, // 1 if this side alone prefers another disparity
            -696, // 1 if a right segment's line agrees
            -253, // 1 if no right segment is compatible
            221, // -1 left of or above the edge, +1 right or below
            -2186, // slope against its direction, px per px
            653, // log2(1 + disparities compared)
            -758, // log2(1 + grey step)
            1201, // log2(1 + neighbours that agree)
            -3445, // share of neighbours that contradict
            482, // the edge itself: cost at the disparity / best elsewhere
            -972, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            220, 322, 471, 688, 1005, 1464, 2125, 3071, 4409, 6271, 8806,
            12156, 16412, 21556, 27412, 33643, 39810, 45496, 50403, 54402, 57462, 59771,
            62198, 63636, 64279, 64708, 65117, 65325, 65430, 65482, 65509, 65522, 65529,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 248, 199, 137, 119, 80, 55, 40, 33, 27, 21,
            17, 15, 13, 12, 11, 10, 10, 8, 7, 7, 7,
        ],
    },
    near_horizontal: Model {
        bias_q12: 42563,
        coefficients_q12: [
            -13422, // this side's window: cost at the disparity / best cost elsewhere
            886, // log2(1 + that cost per pixel)
            -2570, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -11553, // census: best cost / best elsewhere
            2660, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5353, // |window - census|, px
            -523, // |searched back - window|, px
            -2979, // searching back: best cost / best elsewhere
            -37132, // |difference of the halves' disparities| per row or column
            -3473, // log2(1 + rows or columns)
            1824, // the other side's window ratio
            -1528, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -268, // -1 left of or above the edge, +1 right or below
            -3229, // slope against its direction, px per px
            1247, // log2(1 + disparities compared)
            -1156, // log2(1 + grey step)
            1845, // log2(1 + neighbours that agree)
            253, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            -360, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            775, 1041, 1394, 1865, 2489, 3310, 4384, 5773, 7548, 9780, 12529,
            15831, 19681, 24014, 28704, 33570, 38401, 42992, 47177, 50851, 56481, 60179,
            62314, 63625, 64308, 64750, 65353, 65494, 65526, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 96, 94, 89, 86, 70, 55, 40, 30, 23,
            20, 16, 14, 13, 12, 11, 11, 11, 11, 11, 11,
        ],
    },
    steep_edge: Model {
        bias_q12: 19858,
        coefficients_q12: [
            -1258, // this side's window: cost at the disparity / best cost elsewhere
            21, // log2(1 + that cost per pixel)
            570, // log2(1 + how much worse elsewhere is, per pixel)
            -7916, // segment window: best cost / best elsewhere
            -3455, // log2(1 + its cost per pixel)
            -3037, // census: best cost / best elsewhere
            160, // log2(1 + its cost per point)
            -978, // this side's census: cost at the disparity / best elsewhere
            -6468, // |window - census|, px
            2191, // |searched back - window|, px
            -7587, // searching back: best cost / best elsewhere
            -21754, // |difference of the halves' disparities| per row or column
            -1112, // log2(1 + rows or columns)
            -1126, // the other side's window ratio
            -685, // 1 if the other side prefers another disparity
            -7130, // 1 if this side alone prefers another disparity
            -1569, // 1 if a right segment's line agrees
            -3240, // 1 if no right segment is compatible
            498, // -1 left of or above the edge, +1 right or below
            -2375, // slope against its direction, px per px
            3094, // log2(1 + disparities compared)
            220, // log2(1 + grey step)
            1954, // log2(1 + neighbours that agree)
            1263, // share of neighbours that contradict
            5588, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            7425, 8624, 9983, 11513, 13222, 15114, 17188, 19436, 21846, 24396, 27060,
            29803, 32590, 35378, 38130, 40806, 43372, 45801, 48071, 50167, 55579, 59322,
            62549, 64140, 64142, 64144, 65090, 65399, 65494, 65523, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 512, 57, 33, 29, 24,
            20, 16, 13, 10, 9, 8, 8, 8, 8, 7, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 30129,
        coefficients_q12: [
            -6261, // this side's window: cost at the disparity / best cost elsewhere
            -865, // log2(1 + that cost per pixel)
            -459, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -6328, // census: best cost / best elsewhere
            956, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5606, // |window - census|, px
            -340, // |searched back - window|, px
            -4650, // searching back: best cost / best elsewhere
            -22350, // |difference of the halves' disparities| per row or column
            -1954, // log2(1 + rows or columns)
            799, // the other side's window ratio
            -8127, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -265, // -1 left of or above the edge, +1 right or below
            4842, // slope against its direction, px per px
            793, // log2(1 + disparities compared)
            -148, // log2(1 + grey step)
            1017, // log2(1 + neighbours that agree)
            -1308, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            690, 933, 1259, 1696, 2280, 3055, 4076, 5409, 7128, 9308, 12018,
            15302, 19162, 23539, 28306, 33274, 38218, 42920, 47201, 50947, 55518, 58845,
            62551, 64249, 64700, 64994, 65252, 65387, 65458, 65495, 65515, 65525, 65530,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 99, 99, 98, 69, 51, 38, 32, 24,
            20, 15, 13, 11, 10, 9, 8, 8, 7, 7, 7,
        ],
    },
};
