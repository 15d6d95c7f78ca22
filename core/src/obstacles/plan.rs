//! View of a camera as sectors of a turn, computed once: the only checks and floating point of
//! `obstacles`.
//!
//! In: a rig, mounting yaw, range and height band. Out: an [`ObstaclePlan`]: the columns of the
//! boundaries between sectors in view, and cosines of directions.
//!
//! Sector `k` of `n` is centred at `k * 360/n` degrees clockwise from ahead, as autopilots read
//! OBSTACLE_DISTANCE. A boundary at the angle `a` from the optical axis is the column `cx + f *
//! tan(a)`; the tangent is micromath's, within 0.1 degrees of the angle, the same on every machine.
//!
//! # Cost
//! At set-up alone: a tangent for each boundary of a sector.

use super::PARTS_OF_ROWS;
use super::tilt::Tilt;
use crate::ground::GroundPlane;
use crate::health::HealthFlags;
use crate::image::Dims;
use crate::named::named_enum;
use crate::params::Params;
use crate::rig::{Rig, nearest};
use crate::support::SUPPORT_PITCH;
use core::f32::consts::PI;
use micromath::F32;

/// Largest number of sectors in view of a camera: half of 72, and one more where both borders cut
/// one.
pub const MAX_IN_VIEW: usize = 37;

/// Largest column of a boundary, and of one left of the image, px.
const FARTHEST: f32 = 2047.0;

/// Largest number of sectors of a turn: capacity of OBSTACLE_DISTANCE, beyond which PX4 would read.
const MAX_SECTORS: u8 = 72;
/// Largest disparity with the offset of a rig, px: in 1/64 px it has 16 bits.
const LARGEST: f32 = 1023.0;

/// Parameters of sectors: directions, range, height band, age and error probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleParams {
    /// Direction of the optical axis, degrees clockwise from ahead, seen from above; -180 ..= 180.
    pub yaw_deg: f32,
    /// Number of sectors of a full turn; 4 ..= 72. 72 are 5 degrees each.
    pub sectors: u8,
    /// Range, m: obstacles at this distance or further are ignored; 0.1 ..= 600.
    pub range_m: f32,
    /// Lowest and highest height of obstacles, m above the camera; -1000 ..= 1000. One plan and one
    /// [`Obstacles`](super::Obstacles) for each band.
    pub heights_m: [f32; 2],
    /// Least depth below the ground plane of a drop-off, m; 0 ..= 100. `None` for a vehicle that
    /// flies: drop-offs do not matter to it.
    pub drop_m: Option<f32>,
    /// Time for which a state is kept when it is not seen again, ms. Both autopilots keep a message
    /// for half a second themselves.
    pub keep_ms: u16,
    /// Largest probability that all hypotheses for a state are wrong, taken as independent; 0.00002
    /// ..= 0.5. At 0.01 one hypothesis is enough only if its confidence is 0.99, otherwise two or
    /// more have to agree.
    pub error_probability: f32,
    /// Flags of health with which a pair is not used.
    pub unfit: HealthFlags,
}

impl Default for ObstacleParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl ObstacleParams {
    /// The documented defaults: 72 sectors, up to 10 m, all heights, drop-offs of 5 cm, half a
    /// second.
    pub const DEFAULT: Self = Self {
        yaw_deg: 0.0,
        sectors: MAX_SECTORS,
        range_m: 10.0,
        heights_m: [-1000.0, 1000.0],
        drop_m: Some(0.05),
        keep_ms: 500,
        error_probability: 0.01,
        unfit: HealthFlags::UNFIT,
    };

    /// Checks all parameters for images of this size that are matched with `params`, which need a
    /// rig: its focal length and principal point give the directions.
    #[expect(
        clippy::float_arithmetic,
        clippy::cast_possible_truncation,
        reason = "set-up; ranges are checked before"
    )]
    pub fn plan(&self, params: &Params, dims: Dims) -> Result<ObstaclePlan, ObstacleError> {
        let rig = params.rig.ok_or(ObstacleError::NoRig)?.centred(dims);
        check(ObstacleParam::Yaw, self.yaw_deg, -180.0, 180.0)?;
        check(ObstacleParam::Sectors, self.sectors.into(), 4.0, MAX_SECTORS.into())?;
        check(ObstacleParam::Range, self.range_m, 0.1, 600.0)?;
        let [low, high] = self.heights_m;
        check(ObstacleParam::LowestHeight, low, -1000.0, 1000.0)?;
        check(ObstacleParam::HighestHeight, high, low, 1000.0)?;
        if let Some(drop_m) = self.drop_m {
            check(ObstacleParam::DropDepth, drop_m, 0.0, 100.0)?;
        }
        check(ObstacleParam::ErrorProbability, self.error_probability, 0.000_02, 0.5)?;
        let view = View::new(self, &rig, dims)?;

        let focal_baseline = rig.focal_baseline_q16() as f32;
        let [first, last] = [-0.5, view.width - 0.5].map(|column| view.sector_at(column));
        let in_view = (last - first + 1).clamp(1, MAX_IN_VIEW as i32);
        let range_cm = nearest(100.0 * self.range_m) as u16;
        let offset = rig.offset_q6() as f32 / 64.0;
        let most = f32::from(params.max_disparity) + offset;
        if most > LARGEST {
            return Err(ObstacleError::TooLarge(most));
        }
        let found = f32::from(Params::largest_disparity(params.max_disparity)) + offset;
        let near =
            if found > 0.0 { nearest(100.0 / 65536.0 * focal_baseline / found) } else { i64::MAX };
        let mut plan = ObstaclePlan {
            first: first.rem_euclid(self.sectors.into()) as u8,
            in_view: in_view as u8,
            sectors: self.sectors,
            complete: 0,
            edges_q4: [0; MAX_IN_VIEW + 1],
            max_disparity: params.max_disparity,
            width: dims.width,
            height: dims.height,
            part_q5: i32::from(dims.height.div_ceil(PARTS_OF_ROWS as u16).max(SUPPORT_PITCH)) << 5,
            level: [0; 2],
            row_q5: nearest(32.0 * view.row) as i32,
            // Nearness at the range; at least one step, so that a disparity of 0 is beyond it.
            far_q6: nearest(focal_baseline / 1024.0 / self.range_m).clamp(1, i32::MAX.into())
                as i32,
            offset_q6: rig.offset_q6() as i32,
            focal_baseline_q16: rig.focal_baseline_q16(),
            baseline_q16: nearest(focal_baseline / view.focal),
            heights_q16: [nearest(65536.0 * low), nearest(65536.0 * high)],
            drop_q16: self.drop_m.map(|drop_m| nearest(65536.0 * drop_m)),
            range_cm,
            near_cm: near.min(i64::from(range_cm) - 1).max(1) as u16,
            keep_ms: self.keep_ms.into(),
            error_q16: nearest(65536.0 * self.error_probability) as u16,
            unfit: self.unfit,
            column_q5: nearest(32.0 * view.column) as i32,
            tilt: view.level(),
            ground: None,
        };
        for (edge_q4, k) in plan.edges_q4.iter_mut().zip(0..=in_view) {
            let column = view.boundary(first + k).clamp(-FARTHEST, FARTHEST);
            *edge_q4 = nearest(16.0 * column) as i16;
        }
        plan.complete = plan.seen_whole([plan.row_q5; 2]);
        plan.level = plan.level_parts();
        Ok(plan)
    }
}

/// Directions of columns.
struct View {
    /// Focal length, px.
    focal: f32,
    /// Column of the optical axis, px.
    column: f32,
    /// Row of the optical axis, px.
    row: f32,
    /// Width of the image, px.
    width: f32,
    /// Direction of the optical axis, rad clockwise from ahead.
    yaw: f32,
    /// Number of sectors of a full turn.
    sectors: u8,
}

#[expect(
    clippy::float_arithmetic,
    clippy::cast_possible_truncation,
    reason = "set-up; ranges are checked before"
)]
impl View {
    fn new(params: &ObstacleParams, rig: &Rig, dims: Dims) -> Result<Self, ObstacleError> {
        let [column, row] =
            rig.principal_point_q16().unwrap_or_default().map(|v| v as f32 / 65536.0);
        check(ObstacleParam::PrincipalColumn, column, 0.0, dims.width.into())?;
        check(ObstacleParam::PrincipalRow, row, 0.0, dims.height.into())?;
        let (yaw, sectors) = (params.yaw_deg / 180.0 * PI, params.sectors);
        Ok(Self {
            focal: rig.focal_q16() as f32 / 65536.0,
            column,
            row,
            width: dims.width.into(),
            yaw,
            sectors,
        })
    }

    /// Sector that a column falls into, counted from ahead.
    fn sector_at(&self, column: f32) -> i32 {
        let turn = i32::from(self.sectors);
        (-turn..turn).find(|sector| self.boundary(sector + 1) > column).unwrap_or(turn)
    }

    /// Column of the boundary before a sector; infinite beyond a right angle from the axis, where
    /// there is none.
    fn boundary(&self, sector: i32) -> f32 {
        let angle = (sector as f32 - 0.5) * 2.0 * PI / f32::from(self.sectors) - self.yaw;
        if angle <= -0.5 * PI {
            f32::NEG_INFINITY
        } else if angle >= 0.5 * PI {
            f32::INFINITY
        } else {
            self.column + self.focal * F32(angle).tan().0
        }
    }

    /// Of a camera that is level.
    fn level(&self) -> Tilt {
        let origin_q5 = [self.column, self.row].map(|at| nearest(32.0 * at) as i32);
        Tilt::level(origin_q5, nearest(32.0 * self.focal) as i32)
    }
}

fn check(param: ObstacleParam, value: f32, low: f32, high: f32) -> Result<(), ObstacleError> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(ObstacleError::OutOfRange { param, value, low, high })
    }
}

/// Checked parameters for one camera, constant over pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObstaclePlan {
    /// Sector at the left border.
    pub(super) first: u8,
    /// Number of sectors in view.
    pub(super) in_view: u8,
    pub(super) sectors: u8,
    /// A bit for each sector in view: set when both cameras see all of it.
    pub(super) complete: u64,
    /// Columns of the boundaries of the sectors in view, as a level camera sees them, 1/16 px.
    pub(super) edges_q4: [i16; MAX_IN_VIEW + 1],
    /// The largest disparity that is searched, px.
    pub(super) max_disparity: u16,
    /// Width of the image, px.
    pub(super) width: u16,
    pub(super) height: u16,
    /// Height of a part of the rows, 1/32 px.
    pub(super) part_q5: i32,
    /// Parts of the rows above and below the camera's own height.
    pub(super) level: [u32; 2],
    /// Principal row, 1/32 px.
    pub(super) row_q5: i32,
    /// Nearness at the range, 1/64 px.
    pub(super) far_q6: i32,
    pub(super) offset_q6: i32,
    /// Focal length times baseline, px*m.
    pub(super) focal_baseline_q16: i64,
    /// Baseline, m.
    pub(super) baseline_q16: i64,
    /// Lowest and highest height of obstacles, m above the camera.
    pub(super) heights_q16: [i64; 2],
    /// Least depth of a drop-off, m.
    pub(super) drop_q16: Option<i64>,
    pub(super) range_cm: u16,
    pub(super) near_cm: u16,
    pub(super) keep_ms: u32,
    pub(super) error_q16: u16,
    pub(super) unfit: HealthFlags,
    /// Principal column, 1/32 px.
    pub(super) column_q5: i32,
    /// Pitch and roll of the camera; level without a ground plane.
    pub(super) tilt: Tilt,
    pub(super) ground: Option<Ground>,
}

/// The ground plane of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ground {
    /// Its disparity, without the rig's offset.
    pub(super) plane: GroundPlane,
    /// Change of the disparity per row that a level camera at this height sees: baseline / height,
    /// Q16.
    pub(super) per_row_q16: i32,
    /// Parts of the rows in which the ground within the range lies, a bit each.
    pub(super) parts: u32,
}

impl ObstaclePlan {
    /// Number of sectors of a full turn.
    #[must_use]
    pub fn sectors(&self) -> u8 {
        self.sectors
    }

    /// The same plan for a pair with this ground plane, if it has one: heights, directions and
    /// distances are then along it, and it is no obstacle.
    #[must_use]
    pub fn on_ground(mut self, plane: Option<GroundPlane>) -> Self {
        let ground = plane.filter(GroundPlane::is_bounded).and_then(|plane| self.seen_on(plane));
        let rows_q5;
        (self.tilt, self.ground, rows_q5) = match ground {
            Some((tilt, ground, rows_q5)) => (tilt, Some(ground), rows_q5),
            None => (self.tilt.levelled(), None, [self.row_q5; 2]),
        };
        self.complete = self.seen_whole(rows_q5);
        self
    }

    /// Tilt of the camera above this ground, and the rows of the ground within the range, 1/32
    /// px.
    fn seen_on(&self, plane: GroundPlane) -> Option<(Tilt, Ground, [i32; 2])> {
        // The plane's normal, in units of baseline / height: b and c per px, and the disparity on
        // the axis per focal length.
        let axis_q6 = plane.at_q6(self.column_q5 >> 5, self.row_q5 >> 5) + self.offset_q6;
        let along = (i64::from(axis_q6) << 10)
            .checked_mul(self.baseline_q16)?
            .checked_div(self.focal_baseline_q16)?;
        let [down, across] = [plane.down_q16, plane.across_q16].map(i64::from);
        let length =
            (down * down + across * across + along.checked_mul(along)?).unsigned_abs().isqrt();
        let per_row_q16 = i32::try_from(length).ok().filter(|&length| length > 0)?;
        let tilt = self.tilt.above([across, down, along])?;
        // Rows from that of the ground at the range down.
        let height = i32::from(self.height);
        let is_within_range = |y: &i32| {
            let ground_q6 = plane.at_q6(self.column_q5 >> 5, *y) + self.offset_q6;
            let along = tilt.along(self.column_q5, y << 5);
            along.is_some_and(|along| along.nearness_q6(ground_q6) >= self.far_q6)
        };
        let rows_q5 = [(0..height).find(is_within_range)? << 5, (height - 1) << 5];
        Some((tilt, Ground { plane, per_row_q16, parts: self.parts(rows_q5) }, rows_q5))
    }

    /// A bit for each sector in view: set when both cameras see all of it in these rows, 1/32 px,
    /// at any distance from the near limit on.
    fn seen_whole(&self, rows_q5: [i32; 2]) -> u64 {
        let (first_q5, end_q5) =
            (i32::from(self.max_disparity) << 5, (i32::from(self.width) << 5) - 16);
        let mut complete = 0;
        for ([left, right], k) in self.sectors_q5().zip(0..) {
            let is_seen = rows_q5.into_iter().all(|row_q5| {
                let column_q5 = |edge_q5| self.tilt.column_q5(edge_q5, row_q5);
                column_q5(left).is_some_and(|column_q5| column_q5 >= first_q5)
                    && column_q5(right).is_some_and(|column_q5| column_q5 <= end_q5)
            });
            complete |= u64::from(is_seen) << k;
        }
        complete
    }

    /// Columns of both boundaries of each sector in view, 1/32 px.
    pub(super) fn sectors_q5(&self) -> impl Iterator<Item = [i32; 2]> + '_ {
        let edges = self.edges_q4.windows(2).take(self.in_view.into());
        edges.map(|edges| edges.first_chunk().map_or([0; 2], |e| e.map(|e| i32::from(e) << 1)))
    }

    /// Range, cm: obstacles at this distance or further are ignored.
    #[must_use]
    pub fn range_cm(&self) -> u16 {
        self.range_cm
    }

    /// Near limit, cm: depth along the optical axis below which nothing is measured; 1 or more,
    /// below the range.
    #[must_use]
    pub fn near_cm(&self) -> u16 {
        self.near_cm
    }

    /// Index of a sector among those in view.
    #[must_use]
    pub fn in_view(&self, sector: u8) -> Option<usize> {
        if sector >= self.sectors {
            return None;
        }
        let behind = if sector < self.first { self.sectors } else { 0 };
        let index = u16::from(sector) + u16::from(behind) - u16::from(self.first);
        (index < u16::from(self.in_view)).then_some(index.into())
    }
}

named_enum! {
    /// A number that sectors depend on.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    #[cfg_attr(feature = "defmt", derive(defmt::Format))]
    #[non_exhaustive]
    pub enum ObstacleParam {
        /// [`ObstacleParams::yaw_deg`].
        Yaw = "yaw (degrees)",
        /// [`ObstacleParams::sectors`].
        Sectors = "sectors",
        /// [`ObstacleParams::range_m`].
        Range = "range (m)",
        /// The first of [`ObstacleParams::heights_m`].
        LowestHeight = "lowest height (m)",
        /// The second of [`ObstacleParams::heights_m`].
        HighestHeight = "highest height (m)",
        /// [`ObstacleParams::drop_m`].
        DropDepth = "depth of a drop-off (m)",
        /// [`ObstacleParams::error_probability`].
        ErrorProbability = "error probability",
        /// The rig's principal point, column.
        PrincipalColumn = "principal column (px)",
        /// The rig's principal point, row.
        PrincipalRow = "principal row (px)",
    }

    /// Its name, with its unit.
    fn name;
}

/// Reason why parameters of sectors are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ObstacleError {
    /// Distances need a rig, and there is none.
    #[error("distances need a rig (focal length and baseline)")]
    NoRig,
    /// Disparities beyond what obstacles are told from, with the rig's offset, px.
    #[error(
        "disparities and the rig's offset add up to {0} px, obstacles are told from up to 1023"
    )]
    TooLarge(f32),
    /// A number outside its range.
    #[error("{} is {value} but must be {low} to {high}", .param.name())]
    OutOfRange {
        /// The parameter.
        param: ObstacleParam,
        /// Its value.
        value: f32,
        /// Least allowed value.
        low: f32,
        /// Largest allowed value.
        high: f32,
    },
}

#[cfg(test)]
#[allow(clippy::float_arithmetic, clippy::unwrap_used, reason = "compared with double precision")]
mod tests {
    extern crate std;
    use super::*;

    /// Every boundary that 160 degrees of view can show, of every number of sectors: within 1/35 of
    /// a sector of the exact direction.
    #[test]
    fn single_precision_keeps_directions() {
        let dims = Dims { width: 320, height: 240 };
        let rig = Rig::new(250.0, 0.06, 0.0).unwrap().centred(dims);
        let (mut worst_deg, mut worst_share) = (0.0_f64, 0.0_f64);
        for sectors in 4..=MAX_SECTORS {
            for yaw_deg in [0.0, 31.0, -90.0, 180.0] {
                let view = View::new(
                    &ObstacleParams { sectors, yaw_deg, ..ObstacleParams::DEFAULT },
                    &rig,
                    dims,
                )
                .unwrap();
                for sector in -i32::from(sectors)..i32::from(sectors) {
                    let exact =
                        (f64::from(sector) - 0.5) * 360.0 / f64::from(sectors) - f64::from(yaw_deg);
                    if exact.abs() < 80.0 {
                        let tangent = f64::from((view.boundary(sector) - view.column) / view.focal);
                        let off = (tangent.atan().to_degrees() - exact).abs();
                        worst_deg = worst_deg.max(off);
                        worst_share = worst_share.max(off * f64::from(sectors) / 360.0);
                    }
                }
            }
        }
        std::eprintln!(
            "boundaries are within {worst_deg:.3} degrees, {worst_share:.4} of a sector"
        );
        assert!(worst_deg < 0.14 && worst_share < 1.0 / 35.0);
    }
}
