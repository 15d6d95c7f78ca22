//! Naive oracles: as short as possible, nothing shared with the core. Outside an image its nearest
//! pixel counts.

use linestereo_frames::GrayImage;

/// The pixel, or the nearest one of the image.
#[must_use]
pub fn at(image: &GrayImage, x: i32, y: i32) -> i32 {
    let (width, height) = (i32::from(image.dims.width), i32::from(image.dims.height));
    let index = y.clamp(0, height - 1) * width + x.clamp(0, width - 1);
    i32::from(image.pixels[index as usize])
}

/// Grey level at a position between pixels: bilinear.
#[must_use]
pub fn bilinear(image: &GrayImage, [x, y]: [f64; 2]) -> f64 {
    let (column, row) = (x.floor() as i32, y.floor() as i32);
    let grey = |dx: i32, dy: i32| at(image, column + dx, row + dy);
    between([[grey(0, 0), grey(1, 0)], [grey(0, 1), grey(1, 1)]], x - x.floor(), y - y.floor())
}

/// Between four grey levels, two in each row, by the fractions across and down.
#[must_use]
pub fn between(rows: [[i32; 2]; 2], across: f64, down: f64) -> f64 {
    let [above, below] = rows.map(|[a, b]| f64::from(a) * (1.0 - across) + f64::from(b) * across);
    above * (1.0 - down) + below * down
}

/// 3x3 Sobel: eight times the grey step per pixel to the right, and downwards.
#[must_use]
pub fn sobel(image: &GrayImage, x: i32, y: i32) -> (i32, i32) {
    let mut gradient = (0, 0);
    for (dy, row) in (-1..=1).zip([1, 2, 1]) {
        for (dx, column) in (-1..=1).zip([1, 2, 1]) {
            let grey = at(image, x + dx, y + dy);
            gradient.0 += dx * row * grey;
            gradient.1 += dy * column * grey;
        }
    }
    gradient
}

/// 5x5 census: bit `k` is set when the `k`-th neighbour, row by row and without the centre, is
/// darker than the centre.
#[must_use]
pub fn census(image: &GrayImage, x: i32, y: i32) -> u32 {
    let offsets =
        (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy))).filter(|&offset| offset != (0, 0));
    let darker = offsets.map(|(dx, dy)| at(image, x + dx, y + dy) < at(image, x, y));
    darker.enumerate().map(|(k, darker)| u32::from(darker) << k).sum()
}

/// A straight line through points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Mean of the points.
    pub centre: [f64; 2],
    /// Unit vector along the line, pointing down (right on a level one).
    pub direction: [f64; 2],
    /// Root mean square distance of the points from it.
    pub rms: f64,
}

/// The line of least squared distances.
#[must_use]
pub fn fit_line(points: &[[f64; 2]]) -> Line {
    let count = points.len() as f64;
    let centre = [0, 1].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / count);
    let moment = |a: usize, b: usize| {
        points.iter().map(|p| (p[a] - centre[a]) * (p[b] - centre[b])).sum::<f64>() / count
    };
    let (xx, xy, yy) = (moment(0, 0), moment(0, 1), moment(1, 1));
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy); // of the principal axis
    let upward = angle < 0.0;
    let direction =
        [angle.cos(), angle.sin()].map(|component| if upward { -component } else { component });
    let least = 0.5 * (xx + yy - ((xx - yy).powi(2) + 4.0 * xy * xy).sqrt());
    Line { centre, direction, rms: least.max(0.0).sqrt() }
}

/// Depth of a disparity (Eqs. 5, 12), infinite where `disparity + offset` is zero or less.
#[must_use]
pub fn depth(focal_baseline: f64, offset: f64, disparity: f64) -> f64 {
    if disparity + offset > 0.0 { focal_baseline / (disparity + offset) } else { f64::INFINITY }
}

/// Disparities of everything from `nearer` m in front of `depth` to `farther` m behind it (Eq. 13).
#[must_use]
pub fn disparity_interval(
    focal_baseline: f64,
    offset: f64,
    depth: f64,
    nearer: f64,
    farther: f64,
) -> (f64, f64) {
    let near = if depth > nearer { focal_baseline / (depth - nearer) } else { f64::INFINITY };
    (focal_baseline / (depth + farther) - offset, near - offset)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawn::image;

    #[test]
    fn sobel_of_a_step_and_of_a_ramp() {
        let step = image(&["00ff", "00ff", "00ff"]);
        assert_eq!(
            [0, 1, 2, 3].map(|x| sobel(&step, x, 1)),
            [(0, 0), (4 * 255, 0), (4 * 255, 0), (0, 0)]
        );
        let ramp = image(&["000", "111", "222"]);
        assert_eq!(sobel(&ramp, 1, 1), (0, 8 * 17));
    }

    #[test]
    fn census_bits_are_row_by_row() {
        let darker = image(&["88888", "88888", "88817", "88888", "98880"]);
        assert_eq!(census(&darker, 2, 2), 1 << 12 | 1 << 13 | 1 << 23); // the centre has no bit, equal is not darker
        let bright = image(&["08888", "88888", "88987", "88888", "98880"]);
        assert_eq!(census(&bright, 2, 2), 0xff_ffff & !(1 << 19));
    }

    #[test]
    fn lines_are_found_in_every_direction() {
        for degrees in 0..180 {
            let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
            let points: Vec<[f64; 2]> = (-5..=5)
                .map(|t| [3.0 + f64::from(t) * cosine, 4.0 + f64::from(t) * sine])
                .collect();
            let line = fit_line(&points);
            assert!(line.rms < 1e-6 && (line.centre[0] - 3.0).abs() < 1e-9, "{degrees}: {line:?}");
            let cross = line.direction[0] * sine - line.direction[1] * cosine;
            assert!(cross.abs() < 1e-9 && line.direction[1] > -1e-9, "{degrees}: {line:?}");
        }
    }

    #[test]
    fn equation_13_by_hand() {
        // 40 px m at 4 m: 10 px; 1 m nearer: 40/3 px, 1 m farther: 8 px. The width agrees with the
        // chapter's formula.
        let (low, high) = disparity_interval(40.0, 0.0, depth(40.0, 0.0, 10.0), 1.0, 1.0);
        assert_eq!(low, 8.0);
        assert!((high - low - 40.0 * 2.0 / (3.0 * 5.0)).abs() < 1e-12);
        assert_eq!(disparity_interval(40.0, 2.0, 1.0, 1.0, 1.0), (18.0, f64::INFINITY));
    }
}
