//! Positions of support points, and the memory that matching them takes.

use super::place::Place;
use super::{MIN_RANGE, SUPPORT_PITCH, SURROUNDINGS, codes, paths};
use crate::area::Area;
use crate::ground::GroundPlane;
use crate::image::{Dims, MAX_WIDTH, WIDEST};
use crate::kernel::CODE_ROWS;
use crate::params::Params;
use crate::row_memory::{BAND_ROWS, PLANES, row_bytes};
use crate::units::quotient;

/// Largest number of support points of images of this size.
#[must_use]
pub(crate) const fn most_support_points(dims: Dims) -> usize {
    (dims.width / SUPPORT_PITCH) as usize * (dims.height / SUPPORT_PITCH) as usize
}

/// Columns and rows of points, and the disparities that they are matched at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grid {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    pub(crate) disparities: usize,
    /// Pixels from one column of points to the next.
    pitch: u16,
    pub(super) width: u16,
    pub(super) min_disparity: i16,
    /// Labels beside the ground plane as well.
    pub(super) has_plane: bool,
    /// Of the halves of the images.
    pub(super) is_half: bool,
    /// Points are matched around those of the halves.
    is_fine: bool,
}

impl Grid {
    /// The grid of images of this size. Where the disparities of a row of points do not fit the
    /// memory of the band of rows (width 320: beyond 192), columns are twice as far apart.
    pub(crate) fn new(params: &Params, dims: Dims) -> Self {
        let range = [params.min_disparity.into(), params.max_disparity.into()];
        let close = Self::of_range(dims, range, SUPPORT_PITCH);
        if dims.is_large() {
            // Matched around what is known from the grid of the halves.
            return Self { is_fine: true, ..close };
        }
        let there = row_bytes(dims.width) * BAND_ROWS * PLANES;
        if close.bytes() <= there { close } else { Self::of_range(dims, range, 2 * SUPPORT_PITCH) }
    }

    /// The grid of the halves of images of this size, where they are matched first.
    pub(crate) fn of_halves(params: &Params, dims: Dims) -> Option<Self> {
        let half = Dims { width: dims.width / 2, height: dims.height / 2 };
        let first = i32::from(params.min_disparity.div_euclid(2));
        let end = i32::from(params.max_disparity.div_ceil(2)).max(first + MIN_RANGE as i32);
        let grid = Self { is_half: true, ..Self::of_range(half, [first, end], SUPPORT_PITCH) };
        dims.is_large().then_some(grid)
    }

    /// Points with these columns between them, at disparities from the first to before the second.
    fn of_range(dims: Dims, [first, end]: [i32; 2], pitch: u16) -> Self {
        Self {
            columns: (dims.width / pitch).into(),
            rows: (dims.height / SUPPORT_PITCH).into(),
            disparities: usize::try_from(end - first).unwrap_or(0),
            pitch,
            width: dims.width,
            min_disparity: first as i16,
            has_plane: false,
            is_half: false,
            is_fine: false,
        }
    }

    /// The same with labels beside the ground plane, where these fit the memory.
    pub(crate) fn with_plane(self, memory: usize) -> Self {
        let with = Self { has_plane: true, ..self };
        if with.bytes() <= memory { with } else { self }
    }

    /// True when points are matched around those of the halves. Without wide images nothing of it
    /// is compiled.
    pub(crate) fn is_fine(&self) -> bool {
        MAX_WIDTH > WIDEST && self.is_fine
    }

    /// Number of labels of a point: disparities, and beside the plane one that never matches
    /// between both kinds.
    pub(super) fn labels(&self) -> usize {
        self.disparities + if self.has_plane { 1 + paths::PLANE_LABELS } else { 0 }
    }

    /// Working memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes_of_codes() + paths::bytes(self.labels(), self.columns) + self.bytes_of_planes()
    }

    /// Bytes of labels beside the plane.
    fn bytes_of_planes(&self) -> usize {
        if self.has_plane {
            CODE_ROWS * usize::from(self.width) + paths::PLANE_LABELS * self.columns
        } else {
            0
        }
    }

    /// Bytes of the codes, and of the rows that they are of, if these are no image's.
    const fn bytes_of_codes(&self) -> usize {
        codes::bytes(self.width) + if self.is_half { codes::bytes_of_half(self.width) } else { 0 }
    }

    /// The memory of the codes, that of the paths, that of labels beside the plane, and the rest.
    pub(super) fn split<'m>(&self, memory: &'m mut [u8]) -> Option<[&'m mut [u8]; 4]> {
        let (codes, memory) = memory.split_at_mut_checked(self.bytes_of_codes())?;
        let (paths, memory) =
            memory.split_at_mut_checked(paths::bytes(self.labels(), self.columns))?;
        let (planes, spare) = memory.split_at_mut_checked(self.bytes_of_planes())?;
        Some([codes, paths, planes, spare])
    }

    /// The largest disparity compared, px: costs are stored from there down, as columns of the
    /// right image rise.
    pub(crate) fn last(&self) -> i32 {
        i32::from(self.min_disparity) + self.disparities as i32 - 1
    }

    /// Pixel column of a column of points.
    pub(crate) fn x(&self, column: usize) -> i32 {
        i32::from(self.pitch / 2) + (column * usize::from(self.pitch)) as i32
    }

    /// Change of the ground's disparity from a point to one so many columns and rows away, 1/64 px.
    #[inline(always)] // in loops over all points
    pub(super) fn change_q6(
        &self,
        plane: GroundPlane,
        [from, to]: [Place; 2],
        (columns, rows): (i32, i32),
    ) -> i32 {
        let across = columns * i32::from(self.pitch) + to.dx() - from.dx();
        let down = rows * i32::from(SUPPORT_PITCH) + to.dy() - from.dy();
        plane.change_q6(across, down)
    }

    /// First pixel column of the window of a column of points: around it, but not on the two pixels
    /// at each border, which have no codes.
    pub(super) fn window(&self, column: usize) -> i32 {
        let last = i32::from(self.width) - codes::BORDER - codes::WINDOW_COLUMNS as i32;
        (self.x(column) - codes::WINDOW_COLUMNS as i32 / 2).min(last).max(codes::BORDER)
    }

    /// The pixel column after the last one of windows.
    pub(super) fn border(&self) -> i32 {
        i32::from(self.width) - codes::BORDER
    }

    /// Pixel row of a row of points.
    pub(crate) fn y(row: usize) -> i32 {
        i32::from(SUPPORT_PITCH / 2) + (row * usize::from(SUPPORT_PITCH)) as i32
    }

    /// Pixel of the point at this index in the list.
    pub(crate) fn pixel(&self, index: usize, place: Place) -> (u16, u16) {
        let row = index.checked_div(self.columns).unwrap_or(0);
        let column = index - row * self.columns;
        ((self.x(column) + place.dx()) as u16, (Self::y(row) + place.dy()) as u16)
    }

    /// Columns of points between two pixel columns, both included.
    pub(crate) fn columns_within(&self, from: i32, to: i32) -> core::ops::Range<usize> {
        within(from, to, self.pitch.into(), self.columns)
    }

    /// Rows of points between two pixel rows, both included.
    pub(crate) fn rows_within(&self, from: i32, to: i32) -> core::ops::Range<usize> {
        within(from, to, SUPPORT_PITCH.into(), self.rows)
    }

    /// Indices of the points that may stand in an area: less than a pitch from the middle of their
    /// square.
    pub(crate) fn around(&self, area: Area) -> impl Iterator<Item = usize> + use<> {
        let Area { left, top, right, bottom } = area;
        let (beside, all) = (i32::from(SUPPORT_PITCH), self.columns);
        let columns = self.columns_within(i32::from(left) - beside, i32::from(right) + beside);
        self.rows_within(i32::from(top) - beside, i32::from(bottom) + beside)
            .flat_map(move |row| columns.clone().map(move |column| row * all + column))
    }

    /// Down the rows and along the columns.
    pub(crate) fn axes(&self) -> [Axis; 2] {
        let down = Axis { step: self.columns, pitch: SUPPORT_PITCH.into(), count: self.rows };
        [down, Axis { step: 1, pitch: self.pitch.into(), count: self.columns }]
    }

    /// Columns and rows of points around an area of pixels: those in it, and its surroundings on
    /// each side.
    pub(super) fn within(&self, area: Area) -> Area {
        let beside = |pitch: u16| (SURROUNDINGS + pitch - 1).checked_div(pitch).unwrap_or(0);
        let first =
            |at: u16, pitch: u16| at.checked_div(pitch).unwrap_or(0).saturating_sub(beside(pitch));
        let end = |at: u16, pitch: u16, most: usize| {
            let end = at
                .saturating_add(pitch - 1)
                .checked_div(pitch)
                .unwrap_or(0)
                .saturating_add(beside(pitch));
            end.min(u16::try_from(most).unwrap_or(u16::MAX))
        };
        Area {
            left: first(area.left, self.pitch),
            top: first(area.top, SUPPORT_PITCH),
            right: end(area.right, self.pitch, self.columns),
            bottom: end(area.bottom, SUPPORT_PITCH, self.rows),
        }
    }
}

/// Points in one direction.
#[derive(Clone, Copy)]
pub(crate) struct Axis {
    /// Indices of the list from one to the next.
    pub(crate) step: usize,
    /// Pixels from one to the next.
    pitch: i32,
    count: usize,
}

impl Axis {
    /// Points between two pixels, both included.
    pub(crate) fn within(&self, from: i32, to: i32) -> core::ops::Range<usize> {
        within(from, to, self.pitch, self.count)
    }

    /// Pixel of a point.
    pub(crate) fn pixel(&self, at: usize) -> i32 {
        self.pitch / 2 + at as i32 * self.pitch
    }
}

/// Indices of the points between two pixels, both included; points are `pitch` px apart, the first
/// one at half of it.
fn within(from: i32, to: i32, pitch: i32, count: usize) -> core::ops::Range<usize> {
    let index = |pixel: i32| {
        usize::try_from(quotient(pixel - pitch / 2 + pitch - 1, pitch)).unwrap_or(0).min(count)
    };
    index(from)..index(to + 1)
}
