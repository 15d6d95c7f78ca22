//! Values of the pixels of an image, row by row.

/// One value per pixel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid<T> {
    width: usize,
    values: Vec<T>,
}

impl<T: Copy> Grid<T> {
    /// Rows of this width, one behind the other; what does not fill a row is left out.
    pub(crate) fn new(width: usize, mut values: Vec<T>) -> Self {
        values.truncate(values.len() / width.max(1) * width);
        Self { width, values }
    }

    pub(crate) fn width(&self) -> usize {
        self.width
    }

    pub(crate) fn height(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    pub(crate) fn values(&self) -> &[T] {
        &self.values
    }

    pub(crate) fn at(&self, x: usize, y: usize) -> T {
        self.values[y * self.width + x]
    }

    /// The value of the pixel that is so far to the right and below; both sides of the image are
    /// joined, and its top and bottom.
    pub(crate) fn around(&self, (x, y): (usize, usize), [right, down]: [isize; 2]) -> T {
        let moved = |at: usize, by: isize, side: usize| (at + side).wrapping_add_signed(by) % side;
        self.at(moved(x, right, self.width), moved(y, down, self.height()))
    }

    /// Positions of all pixels, row by row.
    pub(crate) fn positions(&self) -> impl Iterator<Item = (usize, usize)> + use<T> {
        let (width, height) = (self.width, self.height());
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    /// A grid of the same size; `value` is given the positions.
    pub(crate) fn map<U: Copy>(&self, value: impl Fn(usize, usize) -> U) -> Grid<U> {
        Grid { width: self.width, values: self.positions().map(|(x, y)| value(x, y)).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_found_across_the_borders() {
        let grid = Grid::new(3, vec![0, 1, 2, 3, 4, 5]);
        assert_eq!((grid.width(), grid.height()), (3, 2));
        assert_eq!(grid.around((0, 0), [-1, 0]), 2);
        assert_eq!(grid.around((2, 1), [1, 1]), 0);
        assert_eq!(grid.around((1, 0), [0, -1]), 4);
        assert_eq!(grid.map(|x, y| 10 * y + x).values(), [0, 1, 2, 10, 11, 12]);
    }
}
