//! Written by `linestereo fit-confidence` from 14 scenes (aloe, art, baby1, books, bowling2, cloth1, dolls, lampshade1, monopoly, motorcycle, rocks1, teddy, tsukuba, wood1): do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    steep: Model {
        bias_q12: 27851,
        coefficients_q12: [
            -8820, // this side's window: cost at the disparity / best cost elsewhere
            -77, // log2(1 + that cost per pixel)
            929, // log2(1 + how much worse elsewhere is, per pixel)
            5749, // segment window: best cost / best elsewhere
            -4702, // log2(1 + its cost per pixel)
            -1805, // census: best cost / best elsewhere
            2822, // log2(1 + its cost per point)
            -6712, // this side's census: cost at the disparity / best elsewhere
            -5648, // |window - census|, px
            3638, // |searched back - window|, px
            834, // searching back: best cost / best elsewhere
            -20265, // |difference of the halves' disparities| per row or column
            -419, // log2(1 + rows or columns)
            245, // the other side's window ratio
            592, // 1 if the other side prefers another disparity
            -11492, // 1 if this side alone prefers another disparity
            -99, // 1 if a right segment's line agrees
            231, // 1 if no right segment is compatible
            207, // -1 left of or above the edge, +1 right or below
            -2340, // slope against its direction, px per px
            808, // log2(1 + disparities compared)
            -632, // log2(1 + grey step)
            1340, // log2(1 + neighbours that agree)
            -3213, // share of neighbours that contradict
            205, // the edge itself: cost at the disparity / best elsewhere
            -944, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            81, 126, 196, 305, 474, 736, 1141, 1761, 2705, 4122, 6208,
            9191, 13288, 18607, 25035, 32162, 39347, 45928, 51447, 55744, 58178, 60066,
            62310, 63662, 64205, 64594, 64975, 65203, 65338, 65419, 65467, 65495, 65512,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 262, 140, 130, 125, 90, 49, 36, 31, 26, 21,
            17, 15, 14, 13, 12, 11, 10, 9, 7, 7, 7,
        ],
    },
    near_horizontal: Model {
        bias_q12: 39867,
        coefficients_q12: [
            -11877, // this side's window: cost at the disparity / best cost elsewhere
            423, // log2(1 + that cost per pixel)
            -2141, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -11256, // census: best cost / best elsewhere
            2269, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5517, // |window - census|, px
            -689, // |searched back - window|, px
            -2954, // searching back: best cost / best elsewhere
            -34948, // |difference of the halves' disparities| per row or column
            -3265, // log2(1 + rows or columns)
            1713, // the other side's window ratio
            -1456, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -352, // -1 left of or above the edge, +1 right or below
            -3132, // slope against its direction, px per px
            1423, // log2(1 + disparities compared)
            -1228, // log2(1 + grey step)
            2186, // log2(1 + neighbours that agree)
            946, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            -382, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            747, 1004, 1348, 1807, 2416, 3220, 4273, 5640, 7391, 9599, 12327,
            15614, 19456, 23794, 28500, 33393, 38257, 42885, 47106, 50811, 56546, 60279,
            62257, 63516, 64293, 64774, 65344, 65488, 65524, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 107, 101, 93, 86, 69, 55, 40, 30, 24,
            20, 16, 15, 13, 12, 11, 11, 10, 10, 10, 10,
        ],
    },
    steep_edge: Model {
        bias_q12: 17156,
        coefficients_q12: [
            -1035, // this side's window: cost at the disparity / best cost elsewhere
            -1, // log2(1 + that cost per pixel)
            558, // log2(1 + how much worse elsewhere is, per pixel)
            -7380, // segment window: best cost / best elsewhere
            -3183, // log2(1 + its cost per pixel)
            -3566, // census: best cost / best elsewhere
            463, // log2(1 + its cost per point)
            -866, // this side's census: cost at the disparity / best elsewhere
            -5186, // |window - census|, px
            2227, // |searched back - window|, px
            -7650, // searching back: best cost / best elsewhere
            -27040, // |difference of the halves' disparities| per row or column
            -1335, // log2(1 + rows or columns)
            -1356, // the other side's window ratio
            -62, // 1 if the other side prefers another disparity
            -9049, // 1 if this side alone prefers another disparity
            -757, // 1 if a right segment's line agrees
            -3106, // 1 if no right segment is compatible
            488, // -1 left of or above the edge, +1 right or below
            -2311, // slope against its direction, px per px
            3213, // log2(1 + disparities compared)
            523, // log2(1 + grey step)
            1825, // log2(1 + neighbours that agree)
            141, // share of neighbours that contradict
            5224, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            10727, 12060, 13517, 15101, 16811, 18643, 20590, 22642, 24786, 27005, 29280,
            31590, 33911, 36221, 38497, 40717, 42862, 44916, 46864, 48698, 56466, 60985,
            62629, 63698, 63965, 64194, 65084, 65385, 65486, 65519, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 512, 512, 512, 512, 44, 32, 26, 23,
            19, 16, 13, 11, 10, 9, 9, 9, 8, 8, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 30264,
        coefficients_q12: [
            -6198, // this side's window: cost at the disparity / best cost elsewhere
            -888, // log2(1 + that cost per pixel)
            -536, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -7483, // census: best cost / best elsewhere
            988, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -5863, // |window - census|, px
            -501, // |searched back - window|, px
            -4497, // searching back: best cost / best elsewhere
            -20382, // |difference of the halves' disparities| per row or column
            -1888, // log2(1 + rows or columns)
            200, // the other side's window ratio
            -7953, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if a right segment's line agrees
            0, // 1 if no right segment is compatible
            -283, // -1 left of or above the edge, +1 right or below
            5185, // slope against its direction, px per px
            765, // log2(1 + disparities compared)
            -38, // log2(1 + grey step)
            1010, // log2(1 + neighbours that agree)
            -1705, // share of neighbours that contradict
            0, // the edge itself: cost at the disparity / best elsewhere
            0, // distance of the pixel from the edge, px
        ],
        probability_q16: [
            756, 1015, 1362, 1823, 2435, 3242, 4298, 5667, 7419, 9625, 12348,
            15625, 19455, 23776, 28464, 33338, 38187, 42804, 47019, 50724, 55396, 58791,
            62532, 64244, 64722, 65025, 65254, 65380, 65450, 65489, 65510, 65522, 65528,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 512, 102, 98, 88, 67, 52, 38, 32, 25,
            20, 15, 13, 11, 10, 9, 9, 8, 7, 7, 7,
        ],
    },
};
