//! Naive oracles: as short as possible, nothing shared with the core. Outside an image its nearest
//! pixel counts.

use linestereo_frames::GrayImage;

/// The pixel, or the nearest one of the image.
pub fn at(image: &GrayImage, x: i32, y: i32) -> i32 {
    let (width, height) = (i32::from(image.dims.width), i32::from(image.dims.height));
    let index = y.clamp(0, height - 1) * width + x.clamp(0, width - 1);
    i32::from(image.pixels[index as usize])
}

/// Grey level at a position between pixels: bilinear.
pub fn bilinear(image: &GrayImage, [x, y]: [f64; 2]) -> f64 {
    let (column, row) = (x.floor() as i32, y.floor() as i32);
    let grey = |dx: i32, dy: i32| at(image, column + dx, row + dy);
    between([[grey(0, 0), grey(1, 0)], [grey(0, 1), grey(1, 1)]], x - x.floor(), y - y.floor())
}

/// Between four grey levels, two in each row, by the fractions across and down.
pub fn between(rows: [[i32; 2]; 2], across: f64, down: f64) -> f64 {
    let [above, below] = rows.map(|[a, b]| f64::from(a) * (1.0 - across) + f64::from(b) * across);
    above * (1.0 - down) + below * down
}

/// 3x3 Sobel: eight times the grey step per pixel to the right, and downwards.
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
pub fn depth(focal_baseline: f64, offset: f64, disparity: f64) -> f64 {
    if disparity + offset > 0.0 { focal_baseline / (disparity + offset) } else { f64::INFINITY }
}

/// Disparities of everything from `nearer` m in front of `depth` to `farther` m behind it (Eq. 13).
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
