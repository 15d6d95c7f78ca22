//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 36707,
        coefficients_q12: [
            -18171, // this side's window: cost at the disparity / best cost elsewhere
            2241, // log2(1 + that cost per pixel)
            -1115, // log2(1 + how much worse elsewhere is, per pixel)
            1761, // segment window: best cost / best elsewhere
            -4245, // log2(1 + its cost per pixel)
            -3388, // census: best cost / best elsewhere
            3750, // log2(1 + its cost per point)
            -13901, // this side's census: cost at the disparity / best elsewhere
            -8393, // |window - census|, px
            5715, // |searched back - window|, px
            -266, // searching back: best cost / best elsewhere
            -16523, // |difference of the halves' disparities| per row or column
            1198, // log2(1 + rows or columns)
            321, // the other side's window ratio
            -338, // 1 if the other side prefers another disparity
            -8686, // 1 if this side alone prefers another disparity
            1868, // 1 if a right segment's line agrees
            4361, // 1 if no right segment is compatible
            318, // -1 left of or above the edge, +1 right or below
            -2374, // slope against its direction, px per px
            -312, // log2(1 + disparities compared)
            -1113, // log2(1 + grey step)
            146, // log2(1 + neighbours that agree)
            -2054, // share of neighbours that contradict
            4876, // the edge itself: cost at the disparity / best elsewhere
            -978, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            539, 744, 1025, 1411, 1936, 2650, 3611, 4894, 6584, 8773, 11548,
            14968, 19045, 23712, 28813, 34117, 39350, 44256, 48637, 52384, 56271, 59149,
            61887, 63492, 64370, 64875, 65385, 65502, 65526, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            164, 164, 164, 159, 118, 94, 76, 46, 31, 26, 21,
            18, 15, 13, 12, 10, 9, 8, 8, 8, 8, 8,
        ],
    },
    near_horizontal: Model {
        bias_q12: 43736,
        coefficients_q12: [
            -10038, // this side's window: cost at the disparity / best cost elsewhere
            -65, // log2(1 + that cost per pixel)
            -1596, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -14308, // census: best cost / best elsewhere
            3081, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3104, // |window - census|, px
            -1111, // |searched back - window|, px
            -4261, // searching back: best cost / best elsewhere
            -38174, // |difference of the halves' disparities| per row or column
            -3173, // log2(1 + rows or columns)
            -400, // the other side's window ratio
            -471, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            211, // -1 left of or above the edge, +1 right or below
            -4434, // slope against its direction, px per px
            667, // log2(1 + disparities compared)
            -1337, // log2(1 + grey step)
            1739, // log2(1 + neighbours that agree)
            -422, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            70, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            1002, 1326, 1751, 2309, 3037, 3978, 5188, 6725, 8652, 11029, 13898,
            17277, 21141, 25414, 29969, 34634, 39225, 43567, 47521, 51001, 56476, 60109,
            62278, 63608, 64379, 64845, 65317, 65467, 65514, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 120, 109, 109, 97, 72, 50, 36, 28, 22,
            19, 17, 14, 12, 11, 10, 9, 9, 9, 9, 9,
        ],
    },
    steep_edge: Model {
        bias_q12: 14069,
        coefficients_q12: [
            -1999, // this side's window: cost at the disparity / best cost elsewhere
            -493, // log2(1 + that cost per pixel)
            -114, // log2(1 + how much worse elsewhere is, per pixel)
            -2622, // segment window: best cost / best elsewhere
            -1883, // log2(1 + its cost per pixel)
            -10204, // census: best cost / best elsewhere
            1253, // log2(1 + its cost per point)
            -994, // this side's census: cost at the disparity / best elsewhere
            -7004, // |window - census|, px
            2687, // |searched back - window|, px
            -4930, // searching back: best cost / best elsewhere
            -23221, // |difference of the halves' disparities| per row or column
            1102, // log2(1 + rows or columns)
            -290, // the other side's window ratio
            -2758, // 1 if the other side prefers another disparity
            -325, // 1 if this side alone prefers another disparity
            3384, // 1 if a right segment's line agrees
            2499, // 1 if no right segment is compatible
            160, // -1 left of or above the edge, +1 right or below
            -3093, // slope against its direction, px per px
            1985, // log2(1 + disparities compared)
            -522, // log2(1 + grey step)
            1382, // log2(1 + neighbours that agree)
            1937, // share of neighbours that contradict
            1156, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            909, 1237, 1680, 2277, 3076, 4137, 5532, 7340, 9644, 12516, 15999,
            20083, 24690, 29665, 34788, 39814, 44515, 48720, 52333, 55332, 56952, 58348,
            61924, 63775, 64197, 64519, 65107, 65356, 65460, 65504, 65523, 65530, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 45, 35, 28, 23, 20,
            16, 14, 11, 11, 9, 8, 8, 8, 7, 6, 6,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 38183,
        coefficients_q12: [
            -6079, // this side's window: cost at the disparity / best cost elsewhere
            -999, // log2(1 + that cost per pixel)
            -50, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -8475, // census: best cost / best elsewhere
            2208, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -1283, // |window - census|, px
            -760, // |searched back - window|, px
            -3930, // searching back: best cost / best elsewhere
            -21702, // |difference of the halves' disparities| per row or column
            -1968, // log2(1 + rows or columns)
            -403, // the other side's window ratio
            -7571, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -995, // -1 left of or above the edge, +1 right or below
            3460, // slope against its direction, px per px
            -376, // log2(1 + disparities compared)
            -493, // log2(1 + grey step)
            144, // log2(1 + neighbours that agree)
            -2491, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            789, 1056, 1410, 1879, 2499, 3312, 4371, 5738, 7481, 9666, 12355,
            15583, 19347, 23591, 28198, 32996, 37785, 42364, 46567, 50282, 55909, 59701,
            62338, 63818, 64563, 64987, 65409, 65507, 65526, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 189, 180, 152, 95, 67, 53, 46, 36, 26,
            20, 15, 13, 11, 9, 8, 7, 7, 7, 7, 7,
        ],
    },
};
