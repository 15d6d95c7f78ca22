//! Structures that both sides know. Suffixes: `_px` pixels, `_m` metres, `_q6` 1/64, `_q16`
//! 1/65536, and so on.

use linestereo::objects::Run as CoreRun;
use linestereo::{Area as CoreArea, health::HealthFlags, image::Span as CoreSpan};

/// Parameters of a matcher. Take them from `linestereo_config`, then change what differs.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Config {
    /// Width of both images, px; 16 to 1280.
    pub width: u16,
    /// Height of both images, px; 16 to 1280.
    pub height: u16,
    /// Largest number of segments listed in each image, 1 to 4096: a matter of memory. 1024; for
    /// the results of the PC's program 4096, where `LinestereoHealth.is_cut` is 1.
    pub segments: u16,
    /// First disparity searched, px; -32 to 0. 0.
    pub min_disparity: i16,
    /// End of the disparities searched, exclusive, px; 8 to 256 above `min_disparity`, below the
    /// width. The nearest depth is focal length times baseline divided by `max_disparity - 1.5`.
    /// 64, or what a narrower image allows.
    pub max_disparity: u16,
    /// Least grey step times four at which an edge is started; 4 to 1020. 48.
    pub anchor_gradient: u16,
    /// Least grey step times four along an edge; 4 to `anchor_gradient`. 20.
    pub edge_gradient: u16,
    /// Least extent of a segment, px; 6 to 32. 6.
    pub min_extent: u16,
    /// Side of the squares in each of which one segment is matched, px; 8 to 256. 20.
    pub cell: u16,
    /// Largest distance from an edge of pixels that get its disparity, px; 1 to 6. 4.
    pub reach: u16,
    /// Least probability of points and segments, 1/65536; 10 to 99 percent. 0xe666, which is 90
    /// percent.
    pub min_confidence_q16: u16,
    /// Largest difference between window and census, 1/64 px; 16 to 1024. 64.
    pub margin_q6: i16,
    /// Not 0: support points alone, a third of the work. 0.
    pub support_only: u16,
    /// Not 0: the principal point is given; else it is the centre of the image. 0.
    pub has_principal_point: u16,
    /// Focal length, px; 1 to 100000. 0 without a rig: disparities only. 0.
    pub focal_px: f32,
    /// Distance of the cameras, m; 0.0001 to 10. Unused without a focal length.
    pub baseline_m: f32,
    /// Added to every disparity: column of the principal point on the right minus that on the left,
    /// px. 0.
    pub disparity_offset_px: f32,
    /// Column and row of the left principal point, px; -2048 to 2048.
    pub principal_point_px: [f32; 2],
    /// Largest time between the captures of a pair, us; beyond it a pair is refused. 1000.
    pub skew_limit_us: u32,
}

/// Columns `start` to `end`, exclusive, of a row.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// First column, px.
    pub start: u16,
    /// Column after the last one, px.
    pub end: u16,
}

/// A grey image of 8 bits, row by row from the top. It stays as it is until its results were read.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// The first pixel of the first row.
    pub pixels: *const u8,
    /// Bytes that may be read from there: `stride * (height - 1) + width` at least.
    pub bytes: usize,
    /// Distance between rows, bytes; the width or more.
    pub stride: usize,
    /// Valid pixels of each row, where a rectified image does not have all; null when it has.
    pub valid: *const Span,
    /// Number of these spans: the height, or 0.
    pub valid_count: usize,
}

/// Pixels from `left`, `top` to `right`, `bottom`, exclusive, px.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Area {
    /// First column.
    pub left: u16,
    /// First row.
    pub top: u16,
    /// Column after the last one.
    pub right: u16,
    /// Row after the last one.
    pub bottom: u16,
}

/// Adjacent pixels of one row of a mask.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Label of the object that they belong to.
    pub label: u16,
    /// Row, px.
    pub y: u16,
    /// Columns, px.
    pub span: Span,
}

/// The side or sides of a segment whose surface the edge belongs to.
#[repr(u16)]
#[derive(Clone, Copy, Debug)]
pub enum Owner {
    /// Side of smaller x; above, where |dx| > 4 |dy|.
    Left = 0,
    /// Side of larger x; below, where |dx| > 4 |dy|.
    Right = 1,
    /// Both: texture inside a surface.
    Both = 2,
}

const _: () = assert!(linestereo::units::INFINITE_DEPTH.to_bits() == i32::MAX);

/// A segment of the left image with its disparity.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Columns of both ends, 1/32 px; whole numbers are pixel centres.
    pub x_q5: [u16; 2],
    /// Rows of both ends, 1/32 px.
    pub y_q5: [u16; 2],
    /// Disparity at both ends, 1/64 px.
    pub disparity_q6: [i16; 2],
    /// Standard deviation of the disparity, 1/64 px.
    pub sigma_q6: i16,
    /// Probability that the disparity along the edge is within 1 px, 1/65536.
    pub confidence_q16: u16,
    /// Side or sides that own the edge.
    pub owner: Owner,
    /// Depth at both ends, 1/65536 m; 0 without a rig, INT32_MAX where it is infinite.
    pub depth_q16: [i32; 2],
    /// Standard deviation of these, 1/65536 m; 0 without a rig.
    pub depth_sigma_q16: [i32; 2],
}

/// A pole, leg or stand of the left image, in front of what is around it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bar {
    /// Columns of both ends of its left edge, top first, 1/32 px; whole numbers are pixel centres.
    pub x_q5: [u16; 2],
    /// Rows of both ends, 1/32 px.
    pub y_q5: [u16; 2],
    /// Width from the left to the right edge, along a row, 1/32 px.
    pub width_q5: u16,
    /// Disparity at both ends, 1/64 px.
    pub disparity_q6: [i16; 2],
    /// Standard deviation of the disparity, 1/64 px.
    pub sigma_q6: i16,
    /// Probability that the disparity is within 1 px, 1/65536.
    pub confidence_q16: u16,
    /// Depth at both ends, 1/65536 m; 0 without a rig, INT32_MAX where it is infinite.
    pub depth_q16: [i32; 2],
    /// Standard deviation of these, 1/65536 m; 0 without a rig.
    pub depth_sigma_q16: [i32; 2],
}

/// A pixel of the left image with a disparity.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Column, px.
    pub x: u16,
    /// Row, px.
    pub y: u16,
    /// Disparity, 1/64 px.
    pub disparity_q6: i16,
    /// Probability that it is within 1 px, 1/65536.
    pub confidence_q16: u16,
    /// Index of its segment; -1: a bar, or a side of a segment that is not listed; -2: a support
    /// point.
    pub segment: i32,
}

/// The depth of an object or of a pixel; where it has none, all numbers but `support` are 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Depth {
    /// Disparity, 1/64 px: of an object at its centre.
    pub disparity_q6: i16,
    /// Standard deviation of the disparity, 1/64 px.
    pub sigma_q6: i16,
    /// Probability that the disparity is within 1 px, of an object within 1 px of its range,
    /// 1/65536.
    pub confidence_q16: u16,
    /// Segments and support points behind an object's depth; 0 of a pixel.
    pub support: u16,
    /// Depth, 1/65536 m; 0 without a rig, INT32_MAX where it is infinite.
    pub depth_q16: i32,
    /// Standard deviation of depth, 1/65536 m; 0 without a rig.
    pub depth_sigma_q16: i32,
    /// Depth of an object's nearest hypothesis, 1/65536 m; 0 without a rig, and of a pixel.
    pub nearest_q16: i32,
}

/// Parameters of obstacles by direction. Take them from `linestereo_obstacle_config`, then change
/// what differs.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ObstacleConfig {
    /// Direction of the optical axis, degrees clockwise from ahead, seen from above; -180 to 180.
    /// 0.
    pub yaw_deg: f32,
    /// Obstacles and drop-offs at this distance or farther are ignored, m; 0.1 to 600. 10.
    pub range_m: f32,
    /// Lowest and highest height of obstacles, m above the camera; -1000 to 1000. All.
    pub heights_m: [f32; 2],
    /// Least depth of a drop-off below the floor, m; 0 to 100; 0 for a vehicle that flies, which
    /// has none. 0.05.
    pub drop_m: f32,
    /// Largest probability that all evidence of an obstacle or a drop-off is wrong; 0.00002 to 0.5.
    /// 0.01.
    pub error_probability: f32,
    /// Sectors of a full turn, 4 to 72. 72, which are 5 degrees each.
    pub sectors: u16,
    /// Time for which a state is kept when it is not seen again, ms. 500.
    pub keep_ms: u16,
}

/// Obstacles and drop-offs by direction, kept between pairs. For the functions alone; it stays
/// where `linestereo_obstacles_init` found it. No memory has to be freed.
#[repr(C)]
#[derive(Debug)]
pub struct Obstacles {
    /// Not for callers.
    pub words: [u64; 112],
}

/// State of a direction.
#[repr(u16)]
#[derive(Clone, Copy, Debug)]
pub enum SectorState {
    /// Not in view of the camera.
    Outside = 0,
    /// In view, but without evidence, or with evidence that is too old.
    Unknown = 1,
    /// Surfaces behind the range are seen, and none within it. Obstacles without texture, such as a
    /// blank wall, are not detected.
    Free = 2,
    /// An obstacle within the range.
    Obstacle = 3,
}

/// The nearest obstacle and the nearest drop-off of a direction.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sector {
    /// Unknown, free, or an obstacle at `distance_cm`.
    pub state: SectorState,
    /// Distance of the obstacle along the ground, cm; 1 or more, below the range; 0 without one.
    pub distance_cm: u16,
    /// Probability of the obstacle, or that the sector is free, 1/65536; 0 otherwise.
    pub confidence_q16: u16,
    /// Distance along the ground to where the floor ends, cm; 1 or more, below the range; 0 where
    /// no drop-off is known.
    pub drop_off_cm: u16,
    /// Probability of the drop-off, 1/65536; 0 without one.
    pub drop_off_confidence_q16: u16,
    /// Time since the obstacle or the free way was seen, ms; 0 otherwise.
    pub age_ms: u32,
    /// Time since the drop-off was seen, ms; 0 without one.
    pub drop_off_age_ms: u32,
}

/// Height and attitude of the left camera above a level ground.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CameraPose {
    /// Height above the ground, m; 0.01 to 100, and a quarter of the baseline or more.
    pub height_m: f32,
    /// How far the optical axis points down, degrees; -80 to 80.
    pub pitch_deg: f32,
    /// How far the camera is rolled, clockwise as it looks, degrees; -80 to 80.
    pub roll_deg: f32,
}

/// The ground plane of a pair: disparity = down * y + across * x + origin.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Ground {
    /// Change of the disparity down the rows, 1/65536 px per row.
    pub down_q16: i32,
    /// Change along the columns, 1/65536 px per column.
    pub across_q16: i32,
    /// Disparity at the left top pixel, 1/65536 px.
    pub origin_q16: i32,
    /// The camera above this plane; all 0 without a rig.
    pub camera: CameraPose,
}

/// Levels of one camera's image.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Mean grey level, 0 to 255.
    pub level: u16,
    /// Mean grey step between samples of a row, 1/16 grey level.
    pub detail_q4: u16,
    /// Samples at 0 to 2, per thousand.
    pub black_permille: u16,
    /// Samples at 253 to 255, per thousand.
    pub white_permille: u16,
    /// Valid pixels, per thousand.
    pub view_permille: u16,
}

/// Faults of a pair, and its counts.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Health {
    /// Sum of `LinestereoFault`: faults of this pair or of one shortly before.
    pub faults: u32,
    /// The same of this pair alone.
    pub faults_now: u32,
    /// 1 when results may be used, 0 when they may be wrong or outdated.
    pub is_fit: u16,
    /// 1 when the images were captured too far apart to be matched.
    pub is_refused: u16,
    /// Left and right camera.
    pub cameras: [Camera; 2],
    /// Row in the right image minus row in the left one, median, 1/256 px.
    pub rows_q8: i16,
    /// Matches that measured it; 0: not measured.
    pub rows_samples: u16,
    /// Segments found in the left image.
    pub segments_found: u16,
    /// Segments with a disparity.
    pub segments_matched: u16,
    /// 1 when the list of segments was full or the budget of work spent: results are good, but not
    /// all that the images have.
    pub is_cut: u16,
    /// Bars in front of what is around them.
    pub bars: u16,
}

/// Faults of a pair, a bit each.
#[repr(u32)]
#[derive(Clone, Copy, Debug)]
#[allow(dead_code, reason = "for the header")]
pub enum Fault {
    /// The left image is too dark or too bright.
    LeftExposure = 1,
    /// The right image is too dark or too bright.
    RightExposure = 2,
    /// Much of the left image is black or white.
    LeftSaturated = 4,
    /// Much of the right image is black or white.
    RightSaturated = 8,
    /// The left image is one grey level.
    LeftDead = 16,
    /// The right image is one grey level.
    RightDead = 32,
    /// The left image has almost no detail.
    LeftCovered = 64,
    /// The right image has almost no detail.
    RightCovered = 128,
    /// The left image repeats the one before.
    LeftFrozen = 256,
    /// The right image repeats the one before.
    RightFrozen = 512,
    /// Too few pixels of the left image are valid.
    LeftView = 1024,
    /// Too few pixels of the right image are valid.
    RightView = 2048,
    /// One image is much brighter than the other.
    ExposuresDiffer = 4096,
    /// Captured too far apart in time: the pair is refused.
    Skew = 8192,
    /// Rows do not match; the matcher corrects it.
    RowsOff = 16384,
    /// The difference of rows changes.
    RowsDrift = 32768,
    /// The difference of rows varies over the image.
    RowsUneven = 65536,
    /// Few of the left segments are matched.
    FewMatches = 131072,
    /// Several credible matches lie beyond infinity.
    BeyondInfinity = 262144,
    /// Something is nearer than the disparity range allows.
    RangeSmall = 524288,
    /// Most of what is matched has no parallax.
    NoParallax = 1048576,
    /// Both images show something at the same pixels.
    SamePixel = 2097152,
    /// The lower part of one image is moved sideways.
    Torn = 4194304,
    /// Rows are further apart than the matcher corrects.
    RowsFar = 8388608,
}

/// Largest name of a fault with its NUL, bytes.
const NAME: usize = 20;

/// Names of the faults by bit, in C's form.
#[expect(clippy::indexing_slicing, reason = "evaluated while it is compiled")]
pub static FAULT_NAMES: [[u8; NAME]; HealthFlags::NAMES.len()] = {
    let mut names = [[0; NAME]; HealthFlags::NAMES.len()];
    let mut bit = 0;
    while bit < names.len() {
        let name = HealthFlags::NAMES[bit].1.as_bytes();
        assert!(name.len() < NAME && HealthFlags::NAMES[bit].0.bits() == 1 << bit);
        let mut index = 0;
        while index < name.len() {
            names[bit][index] = name[index];
            index += 1;
        }
        bit += 1;
    }
    names
};

// Bits of the header are those of the core, and what is read as its structures looks like them.
const _: () = {
    assert!(Fault::RowsFar as u32 == HealthFlags::ROWS_FAR.bits());
    assert!(Fault::Skew as u32 == HealthFlags::SKEW.bits());
    assert!(
        size_of::<Span>() == size_of::<CoreSpan>() && align_of::<Span>() == align_of::<CoreSpan>()
    );
    assert!(
        size_of::<Area>() == size_of::<CoreArea>() && align_of::<Area>() == align_of::<CoreArea>()
    );
    assert!(size_of::<Run>() == size_of::<CoreRun>() && align_of::<Run>() == align_of::<CoreRun>());
};
