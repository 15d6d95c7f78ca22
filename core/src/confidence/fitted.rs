//! Written by `linestereo-lab fit-confidence` from 125 pairs of qvga, robot_world, oakd_agreed_320, oakd_agreed_640, kitti2012_640, robot_world_640, middlebury2006_third, middlebury2006_half, middlebury2005_half, small ones under 7 damages: do not edit.

use super::{Model, Models};

/// The models that plans use unless they are given others.
#[rustfmt::skip]
pub const FITTED: Models = Models {
    near_vertical: Model {
        bias_q12: -552,
        coefficients_q12: [
            -7823, // this side's window: cost at the disparity / best cost elsewhere
            1146, // log2(1 + that cost per pixel)
            887, // log2(1 + how much worse elsewhere is, per pixel)
            10649, // segment window: best cost / best elsewhere
            -2923, // log2(1 + its cost per pixel)
            3651, // census: best cost / best elsewhere
            1027, // log2(1 + its cost per point)
            -5974, // this side's census: cost at the disparity / best elsewhere
            -3241, // |window - census|, px
            -12565, // |difference of the halves' disparities| per row or column
            -1239, // log2(1 + rows or columns)
            -342, // the other side's window ratio
            -1466, // 1 if the other side prefers another disparity
            -2849, // 1 if this side alone prefers another disparity
            -8155, // 1 if the right image has no such edge there
            -2291, // |the edge in the right image - halves|, px
            138, // -1 left of or above the edge, +1 right or below
            -164, // slope against its direction, px per px
            769, // log2(1 + disparities compared)
            -111, // log2(1 + grey step)
            2107, // log2(1 + how much codes change along a window of the image, on average)
            1612, // log2(1 + support points nearby that agree)
            -16199, // share of those that are farther
            -9642, // share of those that are nearer
            586, // log2(1 + segments nearby that agree)
            -1667, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            -921, // how unique the other side is at a nearer disparity, 0 ..= 1
            -1081, // distance of the pixel from the edge, px
            -937, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            253, 507, 760, 1013, 1267, 1520, 1773, 2027, 2280, 6227, 8825,
            14197, 19648, 25191, 29570, 31392, 33119, 38745, 44884, 49133, 53128, 57247,
            59808, 61493, 62575, 63237, 63841, 64124, 64126, 65045, 65047, 65049, 65051,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 267, 267, 267,
            267, 267, 267, 169, 139, 120, 80, 48, 33, 26, 22,
            19, 16, 15, 13, 12, 11, 10, 10, 10, 10, 10,
        ],
    },
    near_horizontal: Model {
        bias_q12: 1237,
        coefficients_q12: [
            -1264, // this side's window: cost at the disparity / best cost elsewhere
            450, // log2(1 + that cost per pixel)
            -918, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -5954, // census: best cost / best elsewhere
            1373, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -3102, // |window - census|, px
            -28698, // |difference of the halves' disparities| per row or column
            -2889, // log2(1 + rows or columns)
            -1868, // the other side's window ratio
            331, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            -260, // -1 left of or above the edge, +1 right or below
            -3443, // slope against its direction, px per px
            -62, // log2(1 + disparities compared)
            -823, // log2(1 + grey step)
            3256, // log2(1 + how much codes change along a window of the image, on average)
            4287, // log2(1 + support points nearby that agree)
            -1176, // share of those that are farther
            -1443, // share of those that are nearer
            482, // log2(1 + segments nearby that agree)
            -80, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -5369, // the less unique half: cost at the disparity / best elsewhere
            -1742, // how unique the other side is at a nearer disparity, 0 ..= 1
            -842, // distance of the pixel from the edge, px
            -2953, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            1406, 2813, 4219, 5626, 7032, 8439, 9845, 13344, 13346, 13348, 13350,
            14705, 17696, 20798, 25098, 30881, 36982, 42390, 47502, 52413, 56242, 58914,
            61223, 62730, 63436, 63976, 64446, 64448, 64937, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 193, 193, 193,
            193, 193, 191, 146, 115, 87, 68, 54, 42, 34, 28,
            23, 19, 16, 14, 13, 11, 11, 10, 9, 9, 9,
        ],
    },
    near_vertical_edge: Model {
        bias_q12: -15628,
        coefficients_q12: [
            2756, // this side's window: cost at the disparity / best cost elsewhere
            546, // log2(1 + that cost per pixel)
            806, // log2(1 + how much worse elsewhere is, per pixel)
            -4292, // segment window: best cost / best elsewhere
            -3922, // log2(1 + its cost per pixel)
            -4217, // census: best cost / best elsewhere
            3354, // log2(1 + its cost per point)
            1633, // this side's census: cost at the disparity / best elsewhere
            -2065, // |window - census|, px
            -14058, // |difference of the halves' disparities| per row or column
            -1258, // log2(1 + rows or columns)
            -524, // the other side's window ratio
            -1590, // 1 if the other side prefers another disparity
            -1635, // 1 if this side alone prefers another disparity
            -8821, // 1 if the right image has no such edge there
            -5919, // |the edge in the right image - halves|, px
            -30, // -1 left of or above the edge, +1 right or below
            840, // slope against its direction, px per px
            12, // log2(1 + disparities compared)
            473, // log2(1 + grey step)
            3520, // log2(1 + how much codes change along a window of the image, on average)
            2540, // log2(1 + support points nearby that agree)
            -1150, // share of those that are farther
            -2270, // share of those that are nearer
            2990, // log2(1 + segments nearby that agree)
            1093, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            0, // the less unique half: cost at the disparity / best elsewhere
            646, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            1001, 2001, 3002, 4003, 5004, 6004, 7005, 8006, 9007, 10007, 11008,
            12009, 13010, 13012, 13590, 30121, 41478, 46967, 53032, 55557, 57741, 61374,
            62168, 62293, 63374, 64065, 64482, 64866, 65073, 65362, 65476, 65478, 65480,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            512, 512, 498, 221, 118, 87, 53, 35, 28, 22, 19,
            16, 14, 13, 12, 11, 10, 10, 10, 9, 8, 7,
        ],
    },
    near_horizontal_edge: Model {
        bias_q12: 5493,
        coefficients_q12: [
            3134, // this side's window: cost at the disparity / best cost elsewhere
            -700, // log2(1 + that cost per pixel)
            -231, // log2(1 + how much worse elsewhere is, per pixel)
            0, // segment window: best cost / best elsewhere
            0, // log2(1 + its cost per pixel)
            -3980, // census: best cost / best elsewhere
            1719, // log2(1 + its cost per point)
            0, // this side's census: cost at the disparity / best elsewhere
            -2978, // |window - census|, px
            -19882, // |difference of the halves' disparities| per row or column
            -1818, // log2(1 + rows or columns)
            -4886, // the other side's window ratio
            -4090, // 1 if the other side prefers another disparity
            0, // 1 if this side alone prefers another disparity
            0, // 1 if the right image has no such edge there
            0, // |the edge in the right image - halves|, px
            94, // -1 left of or above the edge, +1 right or below
            1453, // slope against its direction, px per px
            341, // log2(1 + disparities compared)
            -85, // log2(1 + grey step)
            1753, // log2(1 + how much codes change along a window of the image, on average)
            2708, // log2(1 + support points nearby that agree)
            -1061, // share of those that are farther
            -578, // share of those that are nearer
            1455, // log2(1 + segments nearby that agree)
            -4854, // the edge itself, or the row next to it: cost at the disparity / best elsewhere
            -3255, // the less unique half: cost at the disparity / best elsewhere
            -8195, // how unique the other side is at a nearer disparity, 0 ..= 1
            0, // distance of the pixel from the edge, px
            0, // 1 for the pixels next to an edge whose two sides are not known to be one surface
        ],
        probability_q16: [
            1139, 2279, 3418, 4557, 5697, 6836, 7976, 9115, 10254, 11394, 11396,
            11811, 18025, 21395, 24738, 29212, 34997, 40062, 45592, 50941, 55152, 58790,
            61374, 63092, 64052, 64432, 65066, 65398, 65483, 65527, 65529, 65531, 65533,
        ],
        sigma_q6: [
            512, 512, 512, 512, 512, 512, 512, 512, 512, 512, 512,
            280, 224, 188, 163, 115, 85, 69, 54, 41, 33, 27,
            22, 17, 14, 12, 10, 9, 9, 8, 6, 6, 6,
        ],
    },
};
