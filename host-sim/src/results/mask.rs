//! A flag per pixel: what belongs to an object, on a PC, where memory is no matter.

use linestereo::objects::{Run, Shape};
use linestereo::{Area, Dims, Region, image::Span};

/// Pixels of an object, row-major.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    dims: Dims,
    pixels: Vec<bool>,
}

impl Mask {
    /// From a flag per pixel.
    ///
    /// # Panics
    /// When there are not `width * height` of them.
    pub fn new(dims: Dims, pixels: Vec<bool>) -> Self {
        assert_eq!(pixels.len(), usize::from(dims.width) * usize::from(dims.height));
        Self { dims, pixels }
    }

    /// Of a region of an image of this size.
    pub fn of(region: &Region<'_>, dims: Dims) -> Self {
        let width = usize::from(dims.width);
        let mut mask = Self::new(dims, vec![false; width * usize::from(dims.height)]);
        let mut fill = |y: u16, start: u16, end: u16| {
            let row = usize::from(y) * width;
            mask.pixels[row + usize::from(start)..row + usize::from(end)].fill(true);
        };
        match region.shape() {
            Shape::Box => {
                let Area { left, top, right, bottom } = region.area();
                (top..bottom).for_each(|y| fill(y, left, right));
            }
            Shape::Mask(runs) => {
                runs.iter()
                    .filter(|run| run.label == region.label())
                    .for_each(|run| fill(run.y, run.span.start, run.span.end));
            }
        }
        mask
    }

    /// A flag per pixel, row-major.
    pub fn pixels(&self) -> &[bool] {
        &self.pixels
    }

    /// Does the pixel belong to it? None outside of the image does.
    pub fn contains(&self, x: i32, y: i32) -> bool {
        let (Ok(x), Ok(y)) = (u16::try_from(x), u16::try_from(y)) else { return false };
        x < self.dims.width && y < self.dims.height && self.at(x.into(), y.into())
    }

    /// Adds the pixels of another mask of the same size.
    pub fn join(&mut self, other: &Self) {
        self.pixels.iter_mut().zip(&other.pixels).for_each(|(own, other)| *own |= other);
    }

    fn at(&self, x: usize, y: usize) -> bool {
        self.pixels[y * usize::from(self.dims.width) + x]
    }

    /// Every pixel that `keep` makes of its own and its four neighbours' flags; there are none
    /// beyond the border.
    fn step(&self, keep: impl Fn(bool, [bool; 4]) -> bool) -> Self {
        let (width, height) = (usize::from(self.dims.width), usize::from(self.dims.height));
        let pixels = (0..width * height).map(|i| {
            let (x, y) = (i % width, i / width);
            let near = [
                x > 0 && self.at(x - 1, y),
                x + 1 < width && self.at(x + 1, y),
                y > 0 && self.at(x, y - 1),
                y + 1 < height && self.at(x, y + 1),
            ];
            keep(self.at(x, y), near)
        });
        Self { dims: self.dims, pixels: pixels.collect() }
    }

    /// Larger by so many steps to the four neighbours.
    pub fn grown(&self, steps: usize) -> Self {
        (0..steps).fold(self.clone(), |mask, _| mask.step(|own, near| own || near.contains(&true)))
    }

    /// Smaller by so many steps; the image's border erodes too.
    pub fn eroded(&self, steps: usize) -> Self {
        (0..steps)
            .fold(self.clone(), |mask, _| mask.step(|own, near| own && !near.contains(&false)))
    }

    /// Its runs, all with this label.
    pub fn runs(&self, label: u16) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        for (row, y) in self.pixels.chunks(self.dims.width.into()).zip(0..) {
            for (_, x) in row.iter().zip(0_u16..).filter(|(is_own, _)| **is_own) {
                match runs.last_mut() {
                    Some(run) if run.y == y && run.span.end == x => run.span.end = x + 1,
                    _ => runs.push(Run { label, y, span: Span { start: x, end: x + 1 } }),
                }
            }
        }
        runs
    }
}
