//! Ground truth: a disparity per pixel of the left image, and which true matches are visible in the
//! right one.

use super::resample::resampled_height;
use linestereo::Dims;

/// Two true disparities further apart than this, in px, are two surfaces.
const SAME_SURFACE_PX: f32 = 1.0;

/// Ground truth of a pair.
#[derive(Clone, Debug)]
pub struct Truth {
    dims: Dims,
    disparity: Vec<f32>,
    visible: Vec<bool>,
}

impl Truth {
    /// Truth from disparities in px (NaN = unknown), row-major, and the visibility of each pixel's
    /// true match.
    ///
    /// # Panics
    /// When a list's length is not `width * height`.
    pub fn new(dims: Dims, disparity: Vec<f32>, visible: Vec<bool>) -> Self {
        let count = usize::from(dims.width) * usize::from(dims.height);
        assert!(
            disparity.len() == count && visible.len() == count,
            "truth of {dims} needs {count} values"
        );
        Self { dims, disparity, visible }
    }

    /// Truth whose visibility follows from the disparities alone: hidden is what a nearer surface
    /// of the same row covers in the right image, and what lies outside it.
    pub fn with_reprojected_visibility(dims: Dims, disparity: Vec<f32>) -> Self {
        let width = usize::from(dims.width);
        let mut visible = Vec::with_capacity(disparity.len());
        for row in disparity.chunks(width) {
            let nearest = nearest_per_right_column(row);
            visible.extend((0..width).map(|x| {
                right_column(x, row[x], width)
                    .is_some_and(|column| nearest[column] - row[x] <= SAME_SURFACE_PX)
            }));
        }
        Self::new(dims, disparity, visible)
    }

    /// Truth whose visibility follows from the right image's truth: visible is what the right image
    /// sees at the same disparity.
    pub fn with_right_truth(dims: Dims, disparity: Vec<f32>, right: &[f32]) -> Self {
        let width = usize::from(dims.width);
        let visible = disparity
            .iter()
            .enumerate()
            .map(|(i, &d)| {
                let (row, x) = (i / width * width, i % width);
                right_column(x, d, width)
                    .is_some_and(|column| (right[row + column] - d).abs() <= SAME_SURFACE_PX)
            })
            .collect();
        Self::new(dims, disparity, visible)
    }

    /// Width and height.
    pub fn dims(&self) -> Dims {
        self.dims
    }

    /// True disparity at a pixel in px, `None` where it is unknown or outside.
    pub fn disparity(&self, x: i32, y: i32) -> Option<f32> {
        let value = *self.disparity.get(self.index(x, y)?)?;
        value.is_finite().then_some(value)
    }

    /// The truth without these pixels.
    #[must_use]
    pub fn without(mut self, is_left_out: impl Fn(usize) -> bool) -> Self {
        let unknown =
            self.disparity.iter_mut().enumerate().filter(|(index, _)| is_left_out(*index));
        unknown.for_each(|(_, disparity)| *disparity = f32::NAN);
        self
    }

    /// The true match of a pixel is known and visible in the right image.
    pub fn is_visible(&self, x: i32, y: i32) -> bool {
        self.disparity(x, y).is_some() && self.index(x, y).is_some_and(|index| self.visible[index])
    }

    /// Largest known disparity, `None` when none is known.
    pub fn largest(&self) -> Option<f32> {
        self.disparity.iter().copied().filter(|d| d.is_finite()).reduce(f32::max)
    }

    /// The truth of an image reduced to `width`: each pixel takes the value at its centre,
    /// disparities shrink in proportion.
    pub fn resampled(&self, width: u16) -> Self {
        let dims = Dims { width, height: resampled_height(self.dims, width) };
        let scale = f32::from(dims.width) / f32::from(self.dims.width);
        let centre = |i: u16, from: u16, to: u16| {
            (2 * usize::from(i) + 1) * usize::from(from) / (2 * usize::from(to))
        };
        let (mut disparity, mut visible) = (Vec::new(), Vec::new());
        for y in 0..dims.height {
            let row = centre(y, self.dims.height, dims.height) * usize::from(self.dims.width);
            for x in 0..dims.width {
                let index = row + centre(x, self.dims.width, dims.width);
                disparity.push(self.disparity[index] * scale);
                visible.push(self.visible[index]);
            }
        }
        Self::new(dims, disparity, visible)
    }

    fn index(&self, x: i32, y: i32) -> Option<usize> {
        let inside = (0..i32::from(self.dims.width)).contains(&x)
            && (0..i32::from(self.dims.height)).contains(&y);
        inside.then(|| y as usize * usize::from(self.dims.width) + x as usize)
    }
}

/// Column of the right image that sees column `x` at disparity `d`.
fn right_column(x: usize, d: f32, width: usize) -> Option<usize> {
    let column = (x as f32 - d).round();
    (column >= 0.0 && column < width as f32).then_some(column as usize) // false for NaN
}

/// Largest disparity that falls on each column of the right image, `-infinity` where none does.
fn nearest_per_right_column(row: &[f32]) -> Vec<f32> {
    let mut nearest = vec![f32::NEG_INFINITY; row.len()];
    for (x, &d) in row.iter().enumerate() {
        if let Some(column) = right_column(x, d, row.len()) {
            nearest[column] = nearest[column].max(d);
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: f32 = f32::NAN;

    fn row(values: &[f32]) -> Truth {
        Truth::with_reprojected_visibility(
            Dims { width: values.len() as u16, height: 1 },
            values.to_vec(),
        )
    }

    #[test]
    fn nearer_surfaces_hide_what_they_cover() {
        // Column 5 at disparity 4 lands on column 1, where column 2 at disparity 1 would be.
        let truth = row(&[1.0, 1.0, 1.0, 1.0, 4.0, 4.0, 1.0, N]);
        let visible: Vec<bool> = (0..8).map(|x| truth.is_visible(x, 0)).collect();
        assert_eq!(visible, [false, false, false, true, true, true, true, false]);
    }

    #[test]
    fn right_truth_decides_where_it_is_given() {
        let dims = Dims { width: 4, height: 1 };
        let truth = Truth::with_right_truth(dims, vec![1.0, 1.0, 1.0, 1.0], &[1.5, 3.0, N, 1.0]);
        let visible: Vec<bool> = (0..4).map(|x| truth.is_visible(x, 0)).collect();
        assert_eq!(visible, [false, true, false, false]);
    }

    #[test]
    fn reduction_scales_disparities() {
        let truth = row(&[2.0, 2.0, 2.0, 2.0, 6.0, 6.0, N, N]).resampled(4);
        assert_eq!(
            (truth.disparity(1, 0), truth.disparity(2, 0), truth.disparity(3, 0)),
            (Some(1.0), Some(3.0), None)
        );
    }
}
