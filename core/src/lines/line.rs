//! The line of a segment, by whole rows or columns.

use super::Segment;
use crate::units::quotient;

/// Steepest line across, Q12.
const MOST_SLOPE_Q12: i32 = 8 << 12;

/// Where a line is across by where it is along, 1/32 px: x by y, or y by x of a near-horizontal
/// one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// Ends along.
    first: i32,
    last: i32,
    /// Across, at the first end.
    across: i32,
    slope_q12: i32,
}

impl Line {
    /// x by y, whichever end is the upper one.
    pub(crate) fn upright(segment: &Segment) -> Self {
        let (x0, y0, x1, y1) = segment.ends_q5();
        if y0 > y1 { Self::between((y1, x1), (y0, x0)) } else { Self::between((y0, x0), (y1, x1)) }
    }

    /// y by x.
    pub(crate) fn level(segment: &Segment) -> Self {
        let (x0, y0, x1, y1) = segment.ends_q5();
        Self::between((x0, y0), (x1, y1))
    }

    /// As the segment was drawn.
    pub(crate) fn of(segment: &Segment) -> Self {
        if segment.near_horizontal { Self::level(segment) } else { Self::upright(segment) }
    }

    fn between((first, across): (i32, i32), (last, end): (i32, i32)) -> Self {
        let slope_q12 = quotient((end - across) << 12, last - first);
        Self { first, last, across, slope_q12: slope_q12.clamp(-MOST_SLOPE_Q12, MOST_SLOPE_Q12) }
    }

    /// Across by along, Q12.
    pub(crate) fn slope_q12(&self) -> i32 {
        self.slope_q12
    }

    /// First and last whole row, or column.
    pub(crate) fn extent(&self) -> (i32, i32) {
        ((self.first + 31) >> 5, self.last >> 5)
    }

    /// Nearest place between the ends, 1/32 px.
    pub(crate) fn nearest_q5(&self, along_q5: i32) -> i32 {
        along_q5.min(self.last).max(self.first)
    }

    /// Across, 1/32 px, at a place along, 1/32 px.
    pub(crate) fn at_q5(&self, along_q5: i32) -> i32 {
        self.rounded_q17(along_q5) >> 12
    }

    /// Nearest whole column at a whole row, or row at a column.
    pub(crate) fn at(&self, along: i32) -> i32 {
        self.at_q17(along) >> 17
    }

    /// The same before it is cut to whole pixels, px in Q17.
    pub(crate) fn at_q17(&self, along: i32) -> i32 {
        self.rounded_q17(along << 5) + (1 << 16)
    }

    /// Change of [`Line::at_q17`] from one row, or column, to the next.
    pub(crate) fn step_q17(&self) -> i32 {
        self.slope_q12 << 5
    }

    /// Across, px in Q17, and half of 1/32 px: of either sign below 2^29 between its ends.
    fn rounded_q17(&self, along_q5: i32) -> i32 {
        (self.across << 12) + (along_q5 - self.first) * self.slope_q12 + 2048
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::ImagePosition;
    use crate::units::Position;

    #[test]
    fn both_directions_agree_and_steps_give_each_place() {
        let end =
            |x: u16, y: u16| ImagePosition { x: Position::from_bits(x), y: Position::from_bits(y) };
        for (drop, rise) in [(900, 0), (700, 655), (320, 33), (31, -31), (64, -512)] {
            let to = |along: i32, across: i32| ((3210 + along) as u16, (6543 + across) as u16);
            let (x, y) = to(drop, rise);
            let segment = |ends, near_horizontal| Segment {
                ends,
                rising: true,
                contrast: 9,
                near_horizontal,
            };
            let level = Line::of(&segment([end(3210, 6543), end(x, y)], true));
            let ends = [end(6543, 3210), end(y, x)];
            let [first, last] = ends;
            for ends in [ends, [last, first]] {
                let upright = Line::of(&segment(ends, false));
                assert_eq!(upright.extent(), level.extent());
                let (from, to) = level.extent();
                let mut at_q17 = level.at_q17(from);
                for along in from..=to {
                    let exact =
                        6543.0 + f64::from((along << 5) - 3210) * f64::from(rise) / f64::from(drop);
                    assert!((f64::from(level.at(along)) - exact / 32.0).abs() <= 0.52);
                    assert_eq!(
                        (upright.at(along), at_q17 >> 17),
                        (level.at(along), level.at(along))
                    );
                    at_q17 += level.step_q17();
                }
            }
        }
    }
}
