//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 35143,
        coefficients_q12: [
            -17578, // this side's window: cost at the disparity / best cost elsewhere
            2049, // log2(1 + that cost per pixel)
            -918, // log2(1 + how much worse elsewhere is, per pixel)
            1926, // segment window: best cost / best elsewhere
            -4175, // log2(1 + its cost per pixel)
            -2612, // census: best cost / best elsewhere
            3670, // log2(1 + its cost per point)
            -14397, // this side's census: cost at the disparity / best elsewhere
            -8362, // |window - census|, px
            5343, // |searched back - window|, px
            261, // searching back: best cost / best elsewhere
            -17967, // |difference of the halves' disparities| per row or column
            1166, // log2(1 + rows or columns)
            181, // the other side's window ratio
            -743, // 1 if the other side prefers another disparity
            -7936, // 1 if this side alone prefers another disparity
            2342, // 1 if a right segment's line agrees
            5589, // 1 if no right segment is compatible
            435, // -1 left of or above the edge, +1 right or below
            -2431, // slope against its direction, px per px
            -296, // log2(1 + disparities compared)
            -1141, // log2(1 + grey step)
            322, // log2(1 + neighbours that agree)
            -1520, // share of neighbours that contradict
            5390, // the edge itself: cost at the disparity / best elsewhere
            -859, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            477, 663, 921, 1276, 1765, 2434, 3344, 4569, 6197, 8327, 11053,
            14446, 18526, 23234, 28416, 33829, 39185, 44206, 48682, 52496, 56467, 59370,
            62028, 63579, 64324, 64789, 65373, 65501, 65526, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            164, 164, 164, 162, 109, 87, 72, 46, 30, 25, 21,
            18, 15, 13, 12, 10, 9, 8, 8, 7, 7, 7,
        ],
    },
    near_horizontal: Model {
        bias_q12: 43037,
        coefficients_q12: [
            -9683, // this side's window: cost at the disparity / best cost elsewhere
            -56, // log2(1 + that cost per pixel)
            -1536, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -14530, // census: best cost / best elsewhere
            2783, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -2964, // |window - census|, px
            -954, // |searched back - window|, px
            -3891, // searching back: best cost / best elsewhere
            -37974, // |difference of the halves' disparities| per row or column
            -3154, // log2(1 + rows or columns)
            -646, // the other side's window ratio
            -565, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            146, // -1 left of or above the edge, +1 right or below
            -4501, // slope against its direction, px per px
            691, // log2(1 + disparities compared)
            -1311, // log2(1 + grey step)
            1817, // log2(1 + neighbours that agree)
            3, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            82, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            826, 1106, 1479, 1974, 2627, 3485, 4603, 6044, 7878, 10173, 12986,
            16348, 20245, 24605, 29298, 34139, 38920, 43445, 47556, 51155, 56632, 60239,
            62348, 63644, 64343, 64787, 65301, 65462, 65513, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 117, 114, 114, 97, 72, 53, 35, 27, 22,
            19, 16, 14, 12, 10, 10, 9, 9, 9, 9, 9,
        ],
    },
    steep_edge: Model {
        bias_q12: 14374,
        coefficients_q12: [
            -2027, // this side's window: cost at the disparity / best cost elsewhere
            -490, // log2(1 + that cost per pixel)
            -125, // log2(1 + how much worse elsewhere is, per pixel)
            -2571, // segment window: best cost / best elsewhere
            -1886, // log2(1 + its cost per pixel)
            -10309, // census: best cost / best elsewhere
            1215, // log2(1 + its cost per point)
            -1036, // this side's census: cost at the disparity / best elsewhere
            -6974, // |window - census|, px
            2669, // |searched back - window|, px
            -4942, // searching back: best cost / best elsewhere
            -23195, // |difference of the halves' disparities| per row or column
            1084, // log2(1 + rows or columns)
            -288, // the other side's window ratio
            -2759, // 1 if the other side prefers another disparity
            -315, // 1 if this side alone prefers another disparity
            3385, // 1 if a right segment's line agrees
            2499, // 1 if no right segment is compatible
            157, // -1 left of or above the edge, +1 right or below
            -3096, // slope against its direction, px per px
            1983, // log2(1 + disparities compared)
            -524, // log2(1 + grey step)
            1386, // log2(1 + neighbours that agree)
            1909, // share of neighbours that contradict
            1164, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            944, 1282, 1738, 2350, 3166, 4247, 5664, 7495, 9821, 12710, 16203,
            20287, 24881, 29830, 34917, 39903, 44564, 48735, 52322, 55304, 56940, 58348,
            61932, 63783, 64198, 64517, 65106, 65355, 65460, 65504, 65523, 65530, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 44, 35, 28, 24, 20,
            16, 14, 12, 11, 9, 8, 8, 7, 7, 6, 6,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 37336,
        coefficients_q12: [
            -5701, // this side's window: cost at the disparity / best cost elsewhere
            -923, // log2(1 + that cost per pixel)
            25, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -8890, // census: best cost / best elsewhere
            1707, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -1240, // |window - census|, px
            -887, // |searched back - window|, px
            -3169, // searching back: best cost / best elsewhere
            -20392, // |difference of the halves' disparities| per row or column
            -1746, // log2(1 + rows or columns)
            -1189, // the other side's window ratio
            -7617, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -944, // -1 left of or above the edge, +1 right or below
            4081, // slope against its direction, px per px
            -167, // log2(1 + disparities compared)
            -600, // log2(1 + grey step)
            116, // log2(1 + neighbours that agree)
            -3239, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            722, 971, 1304, 1747, 2335, 3113, 4131, 5455, 7152, 9296, 11952,
            15162, 18929, 23200, 27860, 32732, 37605, 42270, 46548, 50323, 56046, 59859,
            62402, 63838, 64532, 64946, 65316, 65455, 65506, 65525, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 209, 157, 102, 63, 53, 43, 32, 23,
            18, 14, 12, 10, 8, 8, 7, 7, 6, 6, 6,
        ],
    },
};
