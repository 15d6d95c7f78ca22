//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 28727,
        coefficients_q12: [
            -10334, // this side's window: cost at the disparity / best cost elsewhere
            101, // log2(1 + that cost per pixel)
            547, // log2(1 + how much worse elsewhere is, per pixel)
            4509, // segment window: best cost / best elsewhere
            -4823, // log2(1 + its cost per pixel)
            -3479, // census: best cost / best elsewhere
            2920, // log2(1 + its cost per point)
            -6684, // this side's census: cost at the disparity / best elsewhere
            -6396, // |window - census|, px
            3929, // |searched back - window|, px
            1471, // searching back: best cost / best elsewhere
            -15687, // |difference of the halves' disparities| per row or column
            -422, // log2(1 + rows or columns)
            639, // the other side's window ratio
            187, // 1 if the other side prefers another disparity
            -11126, // 1 if this side alone prefers another disparity
            220, // 1 if a right segment's line agrees
            368, // 1 if no right segment is compatible
            281, // -1 left of or above the edge, +1 right or below
            -2373, // slope against its direction, px per px
            765, // log2(1 + disparities compared)
            -435, // log2(1 + grey step)
            1134, // log2(1 + neighbours that agree)
            -4453, // share of neighbours that contradict
            1614, // the edge itself: cost at the disparity / best elsewhere
            -870, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            123, 187, 283, 429, 648, 979, 1475, 2213, 3301, 4882, 7135,
            10252, 14394, 19616, 25778, 32505, 39255, 45476, 50779, 55004, 58112, 60389,
            62583, 63868, 64066, 64242, 64959, 65280, 65423, 65486, 65514, 65526, 65532,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 195, 133, 128, 127, 107, 57, 40, 30, 25, 21,
            17, 15, 14, 13, 12, 11, 10, 9, 6, 6, 6,
        ],
    },
    near_horizontal: Model {
        bias_q12: 41005,
        coefficients_q12: [
            -12576, // this side's window: cost at the disparity / best cost elsewhere
            405, // log2(1 + that cost per pixel)
            -1991, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -10292, // census: best cost / best elsewhere
            2308, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5226, // |window - census|, px
            -563, // |searched back - window|, px
            -2900, // searching back: best cost / best elsewhere
            -33208, // |difference of the halves' disparities| per row or column
            -3152, // log2(1 + rows or columns)
            703, // the other side's window ratio
            -1210, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -338, // -1 left of or above the edge, +1 right or below
            -2807, // slope against its direction, px per px
            996, // log2(1 + disparities compared)
            -958, // log2(1 + grey step)
            1684, // log2(1 + neighbours that agree)
            -206, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            -403, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            2059, 2602, 3280, 4123, 5165, 6443, 7996, 9860, 12067, 14638, 17578,
            20865, 24454, 28269, 32213, 36174, 40036, 43697, 47074, 50114, 56379, 60362,
            62238, 63458, 64325, 64834, 65346, 65485, 65522, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 110, 91, 82, 74, 66, 55, 42, 30, 23,
            19, 16, 14, 13, 12, 11, 10, 10, 10, 10, 10,
        ],
    },
    steep_edge: Model {
        bias_q12: 19053,
        coefficients_q12: [
            -308, // this side's window: cost at the disparity / best cost elsewhere
            -53, // log2(1 + that cost per pixel)
            442, // log2(1 + how much worse elsewhere is, per pixel)
            -8492, // segment window: best cost / best elsewhere
            -3128, // log2(1 + its cost per pixel)
            -3441, // census: best cost / best elsewhere
            282, // log2(1 + its cost per point)
            -261, // this side's census: cost at the disparity / best elsewhere
            -5471, // |window - census|, px
            3451, // |searched back - window|, px
            -8854, // searching back: best cost / best elsewhere
            -20222, // |difference of the halves' disparities| per row or column
            -1189, // log2(1 + rows or columns)
            -1210, // the other side's window ratio
            -89, // 1 if the other side prefers another disparity
            -9128, // 1 if this side alone prefers another disparity
            -303, // 1 if a right segment's line agrees
            -3106, // 1 if no right segment is compatible
            489, // -1 left of or above the edge, +1 right or below
            -2558, // slope against its direction, px per px
            3002, // log2(1 + disparities compared)
            207, // log2(1 + grey step)
            1895, // log2(1 + neighbours that agree)
            163, // share of neighbours that contradict
            5371, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            11129, 12462, 13913, 15484, 17173, 18976, 20887, 22896, 24990, 27154, 29369,
            31616, 33874, 36121, 38337, 40502, 42598, 44608, 46522, 48327, 56724, 61376,
            62730, 63657, 63951, 64199, 65074, 65378, 65482, 65518, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 512, 49, 34, 26, 22,
            19, 16, 13, 11, 10, 9, 9, 9, 9, 8, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 28098,
        coefficients_q12: [
            -7002, // this side's window: cost at the disparity / best cost elsewhere
            -795, // log2(1 + that cost per pixel)
            -598, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -6309, // census: best cost / best elsewhere
            732, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5968, // |window - census|, px
            -511, // |searched back - window|, px
            -4719, // searching back: best cost / best elsewhere
            -18564, // |difference of the halves' disparities| per row or column
            -1566, // log2(1 + rows or columns)
            303, // the other side's window ratio
            -7982, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -241, // -1 left of or above the edge, +1 right or below
            5178, // slope against its direction, px per px
            781, // log2(1 + disparities compared)
            30, // log2(1 + grey step)
            1229, // log2(1 + neighbours that agree)
            -1294, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            837, 1119, 1492, 1987, 2639, 3493, 4603, 6032, 7847, 10116, 12894,
            16211, 20057, 24364, 29007, 33807, 38564, 43081, 47201, 50823, 55395, 58736,
            62512, 64237, 64731, 65039, 65246, 65367, 65438, 65479, 65503, 65517, 65525,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 102, 98, 87, 69, 50, 37, 32, 25,
            19, 15, 13, 11, 10, 9, 8, 8, 7, 7, 7,
        ],
    },
};
