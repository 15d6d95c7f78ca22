//! Line segments of one image: edge drawing, then straight pieces with sub-pixel ends.
//!
//! In: a grey image. Out: segments, each short enough to carry one straight line of disparity.
//!
//! ```text
//! for each direction (edges that run down the rows, then along the columns):
//!     on every sixth row (column): anchors = local maxima of the gradient across the edge
//!     from each anchor: follow the ridge both ways, one sub-pixel position per two rows (edges)
//!     cut the chain into straight runs, least squares each                             (fit)
//!     cut long runs into pieces
//! ```
//!
//! Only every sixth row and column is scanned; elsewhere gradients are computed where an edge
//! passes, and no gradient image is stored.
//!
//! Later stages read whole pixels along a segment by its `line`.
//!
//! # Bounds
//! A position is drawn at most once per direction; memory is a bit per pixel, one position per two
//! rows or columns of the longer side, and the list.
//!
//! # Cost
//! Scans for anchors: 2 instructions a pixel of every scanned row (column). Edges: a `Budget` per
//! image and direction in proportion to the pixels, which is used up by dense gratings alone; an
//! edge that it does not allow is counted. A segment takes 16 units of it at least, and some 400
//! instructions; beyond the list's capacity `log2` of that.
//!
//! # Source
//! Topal, Akinlar: "Edge Drawing", 2012 (anchors and routing); Akinlar, Topal: "EDLines", 2011
//! (incremental least squares along a chain); Suarez et al.: "ELSED", 2022. Differences: positions
//! are sub-pixel from the start, so the straightness tolerance is 0.7 px and not 1, and each
//! direction keeps one position per step, which makes a chain an array.

mod budget;
mod edges;
mod fit;
mod line;

use crate::area::Area;
use crate::cores::Cores;
use crate::image::{Dims, Gray, MAX_HEIGHT, MAX_WIDTH};
use crate::list::List;
use crate::result::ImagePosition;
use crate::sort::{make_heap, sift_down, sort_by_key};
use crate::units::{Position, quotient};
use budget::Taken;
use core::cmp::Reverse;
pub(crate) use edges::SCAN_STEP;
use edges::{Direction, Edges, STEP};
pub(crate) use line::Line;

/// Longest piece of a near-vertical segment, rows: the height of one window.
pub(crate) const MAX_ROWS: i32 = 32;
/// Longest piece of a near-horizontal segment, columns.
pub(crate) const MAX_COLUMNS: i32 = 24;

/// Largest slope of edges down the rows, px per px, Q12: 1.05. The two directions meet at 46.4
/// degrees and not at 45, a common angle at which noise would decide whether an edge is drawn once,
/// twice or not at all.
const DOWN_SLOPE_Q12: i32 = 4301;
/// Largest slope of edges along the columns, px per px, Q12: 1 / 1.05.
const ALONG_SLOPE_Q12: i32 = 3901;

/// Most segments of a list: indices take twelve bits where prominence is compared.
pub const MAX_SEGMENTS: usize = 4096;

/// Number of positions of the longest chain.
pub(crate) const MAX_POSITIONS: usize =
    if MAX_WIDTH > MAX_HEIGHT { MAX_WIDTH } else { MAX_HEIGHT } as usize / 2;

/// A straight edge, as detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Segment {
    /// Ends: top first; left first when [`Segment::near_horizontal`].
    pub ends: [ImagePosition; 2],
    /// True when the pixels right of the edge (below it, when near-horizontal) are the brighter
    /// ones.
    pub rising: bool,
    /// Mean grey step across the edge along the segment, 0 ..= 255.
    pub contrast: u8,
    /// True when it runs more along the columns than down the rows: its position determines its
    /// disparity poorly.
    pub near_horizontal: bool,
}

impl Segment {
    /// Ends as plain integers in 1/32 px: `(x0, y0, x1, y1)`.
    pub(crate) fn ends_q5(&self) -> (i32, i32, i32, i32) {
        let [a, b] = self.ends;
        (a.x.to_bits().into(), a.y.to_bits().into(), b.x.to_bits().into(), b.y.to_bits().into())
    }

    /// Index of the side to the right: of one along the columns that falls to the right it is the
    /// one above.
    pub(crate) fn right_side(&self) -> usize {
        let (_, y0, _, y1) = self.ends_q5();
        usize::from(!self.near_horizontal || y1 < y0)
    }

    /// Bounding box, px.
    pub(crate) fn area(&self) -> Area {
        let (x0, y0, x1, y1) = self.ends_q5();
        let [left, top] = [x0.min(x1), y0.min(y1)].map(|q5| u16::try_from(q5 >> 5).unwrap_or(0));
        let [right, bottom] =
            [x0.max(x1), y0.max(y1)].map(|q5| u16::try_from((q5 >> 5) + 1).unwrap_or(0));
        Area { left, top, right, bottom }
    }

    /// First row, px.
    pub(crate) fn top(&self) -> i32 {
        let (_, y0, _, y1) = self.ends_q5();
        y0.min(y1) >> 5
    }

    /// Extent along its direction in 1/32 px.
    pub(crate) fn extent_q5(&self) -> i32 {
        let (x0, y0, x1, y1) = self.ends_q5();
        if self.near_horizontal { x1.wrapping_sub(x0) } else { y1.wrapping_sub(y0) }
    }
}

/// Thresholds of the detector, checked by the plan.
#[derive(Clone, Copy, Debug)]
pub struct LineParams {
    /// Least gradient of an anchor, Sobel units (grey step times 4).
    pub anchor: i32,
    /// Least gradient along a chain, Sobel units.
    pub edge: i32,
    /// Least extent of a segment, rows or columns.
    pub min_extent: i32,
    /// Rows between two scans for edges that run down the rows, even; `None` draws no such edges.
    pub row_scan: Option<i32>,
    /// Columns between two scans for edges along the columns, even; `None` draws no such edges.
    pub column_scan: Option<i32>,
}

/// Working memory of the detector.
#[derive(Debug)]
pub struct LineScratch<'a> {
    /// A bit per pixel: [`mark_words`] of the image.
    pub marks: &'a mut [u32],
    /// One position per two rows or columns, along the longer side.
    pub chain: &'a mut [u16],
    /// As many: strength of the edge at each position.
    pub strengths: &'a mut [u8],
}

/// Number of 32-bit words of marks for images of this size, a bit per pixel.
#[must_use]
pub const fn mark_words(dims: Dims) -> usize {
    (dims.width as usize * dims.height as usize).div_ceil(32)
}

/// Work of a detection, and what it left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Detection {
    /// Segments that did not fit, the shortest.
    pub segments: u16,
    /// Edges that were not drawn, because the budget of work was spent: places where one would have
    /// started.
    pub edges: u16,
    /// Work of the edges that were drawn, units of some 50 instructions of a Cortex-M7.
    pub units: u32,
}

impl Detection {
    fn new(list: &KeepLongest<'_, '_>, [down, along]: [Taken; 2]) -> Self {
        Self {
            segments: list.dropped,
            edges: down.cut.saturating_add(along.cut),
            units: down.units + along.units,
        }
    }
}

/// Lists the segments of `image` in the order in which they are drawn; returns what was left out.
///
/// With `areas`, only edges with an anchor in one of them are drawn, in full length.
pub fn detect(
    image: Gray<'_>,
    areas: Option<&[Area]>,
    params: &LineParams,
    mut scratch: LineScratch<'_>,
    out: &mut List<'_, Segment>,
) -> Detection {
    let mut list = KeepLongest::new(out);
    let detector = Detector { image, areas, params };
    let down = detector.draw(Direction::Down, 0, &mut scratch, &mut list);
    let along = detector.draw(Direction::Along, down.beyond_share, &mut scratch, &mut list);
    Detection::new(&list, [down, along])
}

/// As [`detect`], on two cores: the edges of one direction each, those along the columns in
/// `spare`. Where edges down the rows leave too little to these, or a list does not hold all of
/// them, they are drawn again.
pub(crate) fn detect_on(
    cores: &mut dyn Cores,
    image: Gray<'_>,
    areas: Option<&[Area]>,
    params: &LineParams,
    [mut here, mut there]: [LineScratch<'_>; 2],
    [out, spare]: [&mut List<'_, Segment>; 2],
) -> Detection {
    let (mut list, mut others) = (KeepLongest::new(out), KeepLongest::new(spare));
    let detector = Detector { image, areas, params };
    let (mut down, mut along) = (Taken::default(), Taken::default());
    cores.join(&mut || down = detector.draw(Direction::Down, 0, &mut here, &mut list), &mut || {
        along = detector.draw(Direction::Along, 0, &mut there, &mut others)
    });
    if down.beyond_share > along.to_spare || others.dropped > 0 {
        along = detector.draw(Direction::Along, down.beyond_share, &mut here, &mut list);
    } else {
        others.out.iter().for_each(|&segment| list.push(segment));
    }
    Detection::new(&list, [down, along])
}

/// An image, and what is looked for in it.
#[derive(Clone, Copy)]
struct Detector<'d> {
    image: Gray<'d>,
    areas: Option<&'d [Area]>,
    params: &'d LineParams,
}

impl Detector<'_> {
    /// Lists the segments of one direction; `beyond` is what those of the other one took of their
    /// budget.
    #[inline(never)] // called for both directions
    fn draw(
        &self,
        direction: Direction,
        beyond: u32,
        scratch: &mut LineScratch<'_>,
        list: &mut KeepLongest<'_, '_>,
    ) -> Taken {
        let Self { image, areas, params } = *self;
        let (scan, largest_q12) = match direction {
            Direction::Down => (params.row_scan, DOWN_SLOPE_Q12),
            Direction::Along => (params.column_scan, ALONG_SLOPE_Q12),
        };
        let Some(scan) = scan else { return Taken::default() };
        let mut room = Room { positions: scratch.chain, strengths: scratch.strengths };
        Edges::new(image, areas, params, scan, beyond, direction, scratch.marks).for_each_chain(
            &mut room,
            |chain| {
                fit::for_each_run(chain.positions, (params.min_extent + STEP - 1) / STEP, |run| {
                    // Steeper ones are drawn by the other direction, with more positions.
                    if run.slope_q12.abs() <= STEP * largest_q12 {
                        cut(&run, chain, direction, list);
                    }
                });
            },
        )
    }
}

/// Sorts segments by their first row, and from left to right within it.
pub(crate) fn sort_by_top(list: &mut List<'_, Segment>) {
    sort_by_key(list, |s| {
        let [a, b] =
            s.ends.map(|end| (u32::from(end.y.to_bits()) << 16) | u32::from(end.x.to_bits()));
        a.min(b)
    });
}

/// Keeps of every `cell` x `cell` square the segment with the largest extent times contrast (by its
/// midpoint), in order; of larger squares while more than `most` remain. Returns the number
/// removed. `marks` is scratch.
///
/// The cost of matching is bounded by the area of the image, not by its content.
pub(crate) fn keep_prominent(
    list: &mut List<'_, Segment>,
    cell: i32,
    most: usize,
    width: i32,
    marks: &mut [u32],
) -> u16 {
    let before = list.len();
    let mut cell = cell;
    keep_one_per_square(list, cell, width, marks);
    while list.len() > most && cell < i32::from(MAX_HEIGHT) {
        cell += cell / 2;
        keep_one_per_square(list, cell, width, marks);
    }
    list.truncate(most); // only where not even one fits
    u16::try_from(before - list.len()).unwrap_or(u16::MAX)
}

fn keep_one_per_square(list: &mut List<'_, Segment>, cell: i32, width: i32, marks: &mut [u32]) {
    marks.fill(0);
    let per_row = quotient(width, cell) + 1;
    let square = |s: &Segment| {
        let (x0, y0, x1, y1) = s.ends_q5();
        usize::try_from(quotient((y0 + y1) >> 6, cell) * per_row + quotient((x0 + x1) >> 6, cell))
            .unwrap_or(0)
    };
    // Prominence in the upper bits, position in the list in the lower twelve: later ones lose ties.
    let rank = |s: &Segment, i: usize| {
        let prominence = (s.extent_q5() >> 5).clamp(0, 4095) as u32 * (u32::from(s.contrast) + 1);
        prominence.min(0xf_ffff) << 12 | (4095 - i.min(4095)) as u32
    };
    for (i, segment) in list.iter().enumerate() {
        if let Some(best) = marks.get_mut(square(segment)) {
            *best = (*best).max(rank(segment, i));
        }
    }
    let mut i = 0;
    list.retain(|s| {
        let keep = marks.get(square(s)).is_none_or(|&best| best == rank(s, i));
        i += 1;
        keep
    });
}

/// Positions of an edge, one per step of rows (columns) from `first` on.
#[derive(Clone, Copy)]
pub(crate) struct Chain<'a> {
    pub(crate) first: i32,
    pub(crate) positions: &'a [u16],
    /// Grey step across the edge at each position.
    pub(crate) strengths: &'a [u8],
    pub(crate) rising: bool,
}

impl Chain<'_> {
    /// Mean grey step of the positions `first ..= last`.
    fn contrast(&self, first: i32, last: i32) -> u8 {
        let Some(piece) =
            usize::try_from(first).ok().and_then(|first| self.strengths.get(first..=last as usize))
        else {
            return 0;
        };
        let sum: i32 = piece.iter().map(|&strength| i32::from(strength)).sum();
        u8::try_from(quotient(sum, last - first + 1)).unwrap_or(u8::MAX)
    }
}

/// Memory for a chain.
pub(crate) struct Room<'a> {
    pub(crate) positions: &'a mut [u16],
    pub(crate) strengths: &'a mut [u8],
}

/// Cuts a straight run into equal pieces of at most [`MAX_ROWS`] rows or [`MAX_COLUMNS`] columns.
fn cut(run: &fit::Run, chain: Chain<'_>, direction: Direction, list: &mut KeepLongest<'_, '_>) {
    let near_horizontal = direction == Direction::Along;
    let longest = if near_horizontal { MAX_COLUMNS } else { MAX_ROWS };
    let length = run.last - run.first;
    let pieces = (length * STEP + longest - 1) / longest;
    for piece in 0..pieces {
        let t0 = run.first + quotient(length * piece, pieces);
        let t1 = run.first + quotient(length * (piece + 1), pieces);
        let end = |t: i32| {
            let along = position(((chain.first + t * STEP) << 5) + 16);
            let across = position(run.at_q5(t));
            if near_horizontal {
                ImagePosition { x: along, y: across }
            } else {
                ImagePosition { x: across, y: along }
            }
        };
        list.push(Segment {
            ends: [end(t0), end(t1)],
            rising: chain.rising,
            contrast: chain.contrast(t0, t1),
            near_horizontal,
        });
    }
}

fn position(q5: i32) -> Position {
    Position::from_bits(u16::try_from(q5.max(0)).unwrap_or(u16::MAX))
}

/// A bounded list that drops its shortest entries. Once full it is a heap with the shortest first:
/// an entry costs `log2` of the length.
struct KeepLongest<'a, 'b> {
    out: &'a mut List<'b, Segment>,
    dropped: u16,
}

impl<'a, 'b> KeepLongest<'a, 'b> {
    fn new(out: &'a mut List<'b, Segment>) -> Self {
        out.clear();
        Self { out, dropped: 0 }
    }

    fn push(&mut self, segment: Segment) {
        let Err(segment) = self.out.push(segment) else { return };
        let shortest_first = |s: &Segment| Reverse(s.extent_q5());
        if self.dropped == 0 {
            make_heap(self.out, &shortest_first);
        }
        self.dropped = self.dropped.saturating_add(1);
        if let Some(shortest) = self.out.first_mut()
            && shortest.extent_q5() < segment.extent_q5()
        {
            *shortest = segment;
            sift_down(self.out, 0, &shortest_first);
        }
    }
}
