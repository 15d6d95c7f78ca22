//! Areas of the left image in which equal bars stand at equal distances: fences, banisters,
//! radiators, stripes.
//!
//! In: the strongest bars of the left image, not matched yet. Out: the areas; which bars lie in
//! them; the support points without those in them.
//!
//! ```text
//! alike:    two bars at a common row with edges of the same signs, as strong, wide and steep
//! repeats:  a bar that is one of five alike at equal distances
//! area:     such bars, the distance on both sides, and twice their rows above and below
//! ```
//! Where the disparities of bars and of what lies behind them differ by the distance from bar to
//! bar, a window wider than a bar matches bars and gaps at the disparity of what lies behind. So
//! segments and support points are left out here. A bar is matched by its own pixels, if these are
//! unique in the range; without points around it nothing tells that it is in front.
//!
//! # Cost
//! 15 instructions for every two bars, at most [`MOST_BARS`](super::MOST_BARS).

use super::{AMID, Bar};
use crate::area::Area;
use crate::image::Dims;
use crate::places::Places;
use crate::support::{Grid, SupportPoint};
use heapless::Vec;

/// Bars in a row that repeat; `docs/experiments.md` has four.
const RUN: i32 = 5;
/// Deviation from equal distances, px.
const TOLERANCE: i32 = 1;
/// Least distance between them, px: nearer ones are the same bar, found twice.
const NEAREST: i32 = 5;
/// Largest difference of two widths, 1/32 px: 1 px, since each edge is off by up to half of that.
const AS_WIDE_Q5: u16 = 32;
/// Largest difference of two slopes, px per px, Q12: 3/16, which is 1 px at the ends of a bar of
/// ten rows.
const AS_STEEP_Q12: u16 = 3 << 8;
/// Columns on both sides of a bar, at least: those of a support point's window.
const BESIDE: i32 = 8;
/// Most areas; further ones join the last.
const MOST_AREAS: usize = 8;

/// Areas in which bars repeat.
#[derive(Debug, Default)]
pub(crate) struct Repeating(Vec<Area, MOST_AREAS>);

impl Repeating {
    /// Finds the areas in which these bars repeat; marks all bars in them.
    pub(super) fn mark(bars: &mut [Bar], dims: Dims) -> Self {
        let mut areas = Self::default();
        for bar in bars.iter() {
            if let Some(distance) = alike(bar, bars).distance(RUN, TOLERANCE) {
                areas.add(around(bar, distance.max(BESIDE), dims));
            }
        }
        for bar in bars {
            let y = bar.middle_row();
            if areas.contain((bar.x_at_q5(y) + i32::from(bar.width_q5 / 2)) >> 5, y) {
                bar.flags |= AMID;
            }
        }
        areas
    }

    fn add(&mut self, area: Area) {
        let known = self.0.iter().position(|known| !known.common(area).is_empty());
        match known.or(self.0.is_full().then_some(MOST_AREAS - 1)) {
            Some(index) => {
                if let Some(known) = self.0.get_mut(index) {
                    *known = known.joined(area);
                }
            }
            None => {
                let _ = self.0.push(area); // it is not full
            }
        }
    }

    pub(crate) fn areas(&self) -> &[Area] {
        &self.0
    }

    fn contain(&self, x: i32, y: i32) -> bool {
        self.0.iter().any(|area| area.contains(x, y))
    }

    /// Removes the disparities of the points in these areas, whose windows repeat.
    pub(crate) fn clear(&self, points: &mut [SupportPoint], grid: Grid) {
        for &area in &self.0 {
            for index in grid.around(area) {
                let Some(point) = points.get_mut(index) else { continue };
                let (x, y) = grid.pixel(index, point.place);
                if area.contains(x.into(), y.into()) {
                    *point = SupportPoint::repeated();
                }
            }
        }
    }
}

/// The places of the bars that are like this one, at its middle row.
fn alike(bar: &Bar, bars: &[Bar]) -> Places {
    let y = bar.middle_row();
    let mut places = Places::default();
    for other in bars {
        let [first, last] = other.first_and_last();
        let offset = (other.x_at_q5(y) - bar.x_at_q5(y) + 16) >> 5;
        if offset.abs() >= NEAREST
            && (first..=last).contains(&y)
            && other.signs() == bar.signs()
            && other.width_q5.abs_diff(bar.width_q5) <= AS_WIDE_Q5
            && other.slope_q12.abs_diff(bar.slope_q12) <= AS_STEEP_Q12
            && is_as_strong(bar, other)
        {
            places.add(offset);
        }
    }
    places
}

/// True where the weaker edge of neither bar is more than about twice as strong as the other's.
fn is_as_strong(a: &Bar, b: &Bar) -> bool {
    let [a, b] = [a, b].map(|bar| bar.strengths_q3[0].min(bar.strengths_q3[1]));
    a / 2 <= b && b / 2 <= a
}

fn around(bar: &Bar, beside: i32, dims: Dims) -> Area {
    let Area { left, top, right, bottom } = bar.area();
    let at = |at: i32| u16::try_from(at.max(0)).unwrap_or(u16::MAX);
    // Bars are pieces of what is taller; of a mosaic of squares a row alone repeats by chance.
    let above = 2 * bar.height();
    Area {
        left: at(i32::from(left) - beside),
        top: at(i32::from(top) - above),
        right: at(i32::from(right) + beside),
        bottom: at(i32::from(bottom) + above),
    }
    .common(Area::of(dims))
}

#[cfg(test)]
mod tests {
    use super::super::keep;
    use super::*;

    const DIMS: Dims = Dims { width: 320, height: 240 };

    fn bar(x: u16, rows: [u16; 2], width: u16, flags: u8) -> Bar {
        Bar { flags, ..keep::tests::bar(x, width, rows, 9) }
    }

    /// The areas of these bars, of which so many lie in one.
    fn areas(bars: impl IntoIterator<Item = Bar>, dims: Dims, amid: usize) -> Repeating {
        let mut bars = bars.into_iter().collect::<Vec<_, 64>>();
        let repeating = Repeating::mark(&mut bars, dims);
        assert_eq!(bars.iter().filter(|bar| bar.is(AMID)).count(), amid);
        repeating
    }

    #[test]
    fn a_fence_is_one_area() {
        // 14.4 px apart, the rows of every second one somewhat lower.
        let bars =
            (0..5).map(|k| bar(50 + k * 144 / 10, [100 + k % 2 * 10, 120 + k % 2 * 10], 4, 1));
        let Repeating(areas) = areas(bars, DIMS, 5);
        assert_eq!(areas, [Area { left: 36, top: 58, right: 126, bottom: 173 }]);
    }

    #[test]
    fn fewer_bars_and_bars_of_other_kinds_do_not_repeat() {
        let fence = |k: u16| bar(50 + k * 14, [100, 120], 4, 1);
        let strong = Bar { strengths_q3: [9, 19], ..fence(4) };
        let others = [
            ("at another distance", bar(50 + 4 * 14 + 6, [100, 120], 4, 1)),
            ("wider", bar(50 + 4 * 14, [100, 120], 8, 1)),
            ("with edges of other signs", bar(50 + 4 * 14, [100, 120], 4, 2)),
            ("at other rows", bar(50 + 4 * 14, [140, 160], 4, 1)),
            ("steeper", Bar { slope_q12: 1000, ..fence(4) }),
            ("stronger", Bar { strengths_q3: [20; 2], ..strong }),
        ];
        for (which, last) in others {
            let found = areas((0..4).map(fence).chain([last]), DIMS, 0);
            assert!(found.0.is_empty(), "{which}");
        }
        assert!(!areas((0..4).map(fence).chain([strong]), DIMS, 5).0.is_empty());
    }

    #[test]
    fn more_areas_than_there_is_room_for_join_the_last() {
        let fences = (0..11).flat_map(|row| {
            (0..5).map(move |k| bar(50 + k * 6, [row * 200, row * 200 + 10], 2, 1))
        });
        let dims = Dims { width: 320, height: 2400 };
        let Repeating(areas) = areas(fences, dims, 55);
        assert_eq!(areas.len(), MOST_AREAS);
        assert_eq!(areas.last().unwrap().bottom, 2000 + 11 + 22);
    }

    #[test]
    fn points_in_an_area_have_no_disparity() {
        let params = crate::Params::default();
        let grid = Grid::new(&params, DIMS);
        let mut point = SupportPoint::none();
        point.take_bar(640, crate::units::Confidence::MAX);
        let mut points = Vec::<_, 2048>::new();
        points.resize(grid.columns * grid.rows, point).unwrap();
        let repeating = areas((0..5).map(|k| bar(50 + k * 14, [100, 120], 4, 1)), DIMS, 5);
        repeating.clear(&mut points, grid);
        for (index, point) in points.iter().enumerate() {
            let (x, y) = grid.pixel(index, point.place);
            let is_in = repeating.contain(x.into(), y.into());
            assert_eq!([point.is_matched(), point.repeats()], [!is_in, is_in], "{x} {y}");
        }
        assert!(points.iter().any(|point| !point.is_matched()));
    }
}
