//! Windows that costs are summed over.
//!
//! Every shape is a sum of rectangles around one centre, each added or taken away, so that sliding sums serve all of them.

/// How the pixels of a window lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Shape {
    /// All of its columns and rows.
    #[default]
    Rectangle,
    /// Two bars, a third of the other side wide: what is nearest along the axes.
    Cross,
}

/// A window around a pixel; both sides are odd.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Window {
    columns: usize,
    rows: usize,
    shape: Shape,
}

/// A centred rectangle that is added to the window or taken away from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) half_columns: usize,
    pub(super) half_rows: usize,
    pub(super) added: bool,
}

impl Window {
    /// A window of `columns` x `rows` px; even sides grow by one.
    #[must_use]
    pub const fn new(columns: usize, rows: usize, shape: Shape) -> Self {
        Self { columns: columns | 1, rows: rows | 1, shape }
    }

    /// A square window.
    #[must_use]
    pub const fn square(side: usize) -> Self {
        Self::new(side, side, Shape::Rectangle)
    }

    /// Columns to each side of the centre.
    #[must_use]
    pub const fn half_columns(&self) -> usize {
        self.columns / 2
    }

    /// Rows above the centre and below it.
    #[must_use]
    pub const fn half_rows(&self) -> usize {
        self.rows / 2
    }

    /// Pixels in it.
    #[must_use]
    pub fn area(&self) -> usize {
        self.offsets().count()
    }

    /// Offsets of its pixels from the centre.
    pub fn offsets(&self) -> impl Iterator<Item = (isize, isize)> + use<> {
        let (x, y) = (self.half_columns() as isize, self.half_rows() as isize);
        let parts = self.parts();
        (-y..=y).flat_map(move |dy| (-x..=x).map(move |dx| (dx, dy))).filter(move |&(dx, dy)| {
            let inside = |part: &Part| {
                dx.unsigned_abs() <= part.half_columns && dy.unsigned_abs() <= part.half_rows && part.added
            };
            parts.iter().any(inside)
        })
    }

    /// The rectangles whose sum it is.
    pub(super) fn parts(&self) -> Vec<Part> {
        let part = |columns: usize, rows: usize, added| Part { half_columns: columns / 2, half_rows: rows / 2, added };
        let bar = |side: usize| (side / 3) | 1;
        let (columns, rows) = (self.columns, self.rows);
        match self.shape {
            Shape::Rectangle => vec![part(columns, rows, true)],
            Shape::Cross => vec![
                part(columns, bar(rows), true),
                part(bar(columns), rows, true),
                part(bar(columns), bar(rows), false),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cross_is_two_bars() {
        let cross = Window::new(7, 5, Shape::Cross);
        let mut drawn = vec!["       ".to_owned(); 5];
        for (dx, dy) in cross.offsets() {
            let (x, y) = ((dx + 3) as usize, (dy + 2) as usize);
            drawn[y].replace_range(x..=x, "#");
        }
        assert_eq!(drawn, ["  ###  ", "  ###  ", "#######", "  ###  ", "  ###  "]);
        let sum: i64 = cross
            .parts()
            .iter()
            .map(|p| ((2 * p.half_columns + 1) * (2 * p.half_rows + 1)) as i64 * if p.added { 1 } else { -1 })
            .sum();
        assert_eq!(sum as usize, cross.area());
    }
}
