//! Codes of errors and of missing depths, with their texts.

use core::ffi::CStr;
use linestereo::ground::PoseError;
use linestereo::objects::{Reason, RegionError};
use linestereo::params::{Param, ParamError, RigError};
use linestereo::{RunError, image::ViewError, results::PixelRejection};

/// Result of a call: 0 when all is well, below 100 an error of the call, from 100 on why an object
/// or a pixel has no depth.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// All is well.
    Ok = 0,
    /// A pointer that has to point to something is null.
    Null = 1,
    /// A pointer is not aligned to what it points to; memory needs 8 bytes.
    Misaligned = 2,
    /// The memory is smaller than `linestereo_scratch_size` says.
    MemoryTooSmall = 3,
    /// There is no matcher, or are no obstacles, at this address: not initialised, or copied from
    /// elsewhere.
    NotInitialised = 4,
    /// The call comes from a callback of the same matcher.
    Busy = 5,
    /// No pair has been matched yet, or the last images were refused.
    NoPair = 6,
    /// There are not so many segments.
    NoSuchSegment = 7,
    /// More elements than memory can hold.
    TooMany = 8,
    /// The pair was looked at and is not fit to be used: `linestereo_health` says why.
    PairUnfit = 9,
    /// A size outside 16x16 to 1280x1280.
    ImageSize = 10,
    /// A stride shorter than a row.
    Stride = 11,
    /// The image ends before its last row does.
    ImageTooShort = 12,
    /// The number of spans of valid pixels is not that of rows.
    SpanCount = 13,
    /// A span of valid pixels starts after its end, or ends outside of the image.
    Span = 14,
    /// `segments` is outside its range.
    Segments = 20,
    /// `min_disparity` is outside its range.
    MinDisparity = 21,
    /// `max_disparity` is outside its range.
    MaxDisparity = 22,
    /// `anchor_gradient` is outside its range.
    AnchorGradient = 23,
    /// `edge_gradient` is outside its range.
    EdgeGradient = 24,
    /// `min_extent` is outside its range.
    MinExtent = 25,
    /// `cell` is outside its range.
    Cell = 26,
    /// `reach` is outside its range.
    Reach = 27,
    /// `min_confidence_q16` is outside its range.
    MinConfidence = 28,
    /// `margin_q6` is outside its range.
    Margin = 29,
    /// `focal_px` is outside its range.
    Focal = 30,
    /// `baseline_m` is outside its range.
    Baseline = 31,
    /// `disparity_offset_px` is outside its range.
    Offset = 32,
    /// `principal_point_px` is outside its range.
    PrincipalPoint = 33,
    /// There is no rig, and without one no depth in metres.
    NoRig = 34,
    /// The depth of this disparity is infinite.
    Infinite = 35,
    /// There are not so many bars.
    NoSuchBar = 36,
    /// A region without pixels.
    RegionEmpty = 40,
    /// A region outside of the image.
    RegionOutside = 41,
    /// A run of a mask is empty, outside of the image, or not behind the run before it.
    RegionRun = 42,
    /// There are not so many sectors.
    NoSuchSector = 50,
    /// `yaw_deg` is outside its range.
    Yaw = 51,
    /// `sectors` is outside its range.
    Sectors = 52,
    /// `range_m` is outside its range.
    SectorRange = 53,
    /// `heights_m` is outside its range.
    Heights = 54,
    /// `drop_m` is outside its range.
    DropDepth = 55,
    /// `error_probability` is outside its range.
    ErrorProbability = 56,
    /// A number of the camera's pose is outside its range.
    CameraPose = 60,
    /// No ground plane is known in the last pair.
    NoGround = 61,
    /// No depth: too few credible hypotheses in the region.
    LittleSupport = 100,
    /// No depth: two surfaces explain the region equally well.
    TwoSurfaces = 101,
    /// No depth: hypotheses on the outline only.
    OnlyOutline = 102,
    /// No depth: the pair is not fit to be used.
    UnhealthyPair = 103,
    /// No depth: the same pixels in both images.
    NoParallax = 104,
    /// No depth: the pixel lies outside of the valid image.
    PixelOutside = 110,
    /// No depth: too close to the border to compare disparities.
    NearBorder = 111,
    /// No depth: nothing to match around the pixel.
    NoTexture = 112,
    /// No depth: hidden in the right image, most likely.
    LeftRight = 113,
    /// No depth: another disparity matches nearly as well.
    NotUnique = 114,
    /// No depth: not credible enough.
    LowConfidence = 115,
}

impl Status {
    /// Every code in words, with the range of a number that is outside it.
    const TEXTS: [(Self, &CStr); 55] = [
        (Self::Ok, c"all is well"),
        (Self::Null, c"a pointer is null"),
        (
            Self::Misaligned,
            c"a pointer is not aligned: memory needs 8 bytes, structures their C alignment",
        ),
        (Self::MemoryTooSmall, c"the memory is smaller than linestereo_scratch_size says"),
        (
            Self::NotInitialised,
            c"nothing at this address: not initialised, or copied from elsewhere",
        ),
        (Self::Busy, c"a callback called the matcher that runs it"),
        (Self::NoPair, c"no pair has been matched yet, or the last images were refused"),
        (Self::NoSuchSegment, c"no segment has this index"),
        (Self::TooMany, c"more elements than memory can hold"),
        (Self::PairUnfit, c"the pair is not fit to be used: linestereo_health says why"),
        (Self::ImageSize, c"an image is outside 16x16 to 1280x1280"),
        (Self::Stride, c"a stride is shorter than a row"),
        (Self::ImageTooShort, c"an image ends before its last row does"),
        (Self::SpanCount, c"one span of valid pixels is needed for each row"),
        (Self::Span, c"the valid pixels of a row are no part of the image"),
        (Self::Segments, c"segments is outside 1 to 4096"),
        (Self::MinDisparity, c"min_disparity is outside -32 to 0"),
        (
            Self::MaxDisparity,
            c"max_disparity is outside 8 to 256 above min_disparity, or not below the width",
        ),
        (Self::AnchorGradient, c"anchor_gradient is outside 4 to 1020"),
        (Self::EdgeGradient, c"edge_gradient is outside 4 to anchor_gradient"),
        (Self::MinExtent, c"min_extent is outside 6 to 32"),
        (Self::Cell, c"cell is outside 8 to 256"),
        (Self::Reach, c"reach is outside 1 to 6"),
        (Self::MinConfidence, c"min_confidence_q16 is outside 10 to 99 percent"),
        (Self::Margin, c"margin_q6 is outside 16 to 1024"),
        (Self::Focal, c"focal_px is outside 1 to 100000"),
        (Self::Baseline, c"baseline_m is outside 0.0001 to 10: is it in mm?"),
        (Self::Offset, c"disparity_offset_px is outside -4096 to 4096"),
        (Self::PrincipalPoint, c"principal_point_px is outside -2048 to 2048"),
        (Self::NoRig, c"depths in metres need a rig: focal length and baseline"),
        (Self::Infinite, c"the depth of this disparity is infinite"),
        (Self::NoSuchBar, c"no bar has this index"),
        (Self::RegionEmpty, c"a region without pixels"),
        (Self::RegionOutside, c"a region outside of the image"),
        (
            Self::RegionRun,
            c"a run of the mask is empty, outside of the image, or not behind the run before it",
        ),
        (Self::NoSuchSector, c"no sector has this index"),
        (Self::Yaw, c"yaw_deg is outside -180 to 180"),
        (Self::Sectors, c"sectors is outside 4 to 72"),
        (Self::SectorRange, c"range_m is outside 0.1 to 600"),
        (Self::Heights, c"heights_m is outside -1000 to 1000, or the lowest is above the highest"),
        (Self::DropDepth, c"drop_m is outside 0 to 100"),
        (Self::ErrorProbability, c"error_probability is outside 0.00002 to 0.5"),
        (
            Self::CameraPose,
            c"height_m is outside 0.01 to 100 or below a quarter of the baseline, \
              or pitch_deg or roll_deg outside -80 to 80",
        ),
        (Self::NoGround, c"no ground plane is known in the last pair"),
        (Self::LittleSupport, c"too few credible hypotheses in the region"),
        (Self::TwoSurfaces, c"two surfaces explain the region equally well"),
        (
            Self::OnlyOutline,
            c"hypotheses on the outline only: they may belong to what is beside the region",
        ),
        (Self::UnhealthyPair, c"the pair is not fit to be used"),
        (
            Self::NoParallax,
            c"the same pixels in both images: too far for a depth, or dirt, or overlaid text",
        ),
        (Self::PixelOutside, c"the pixel lies outside of the valid image"),
        (Self::NearBorder, c"too close to the border to compare disparities"),
        (Self::NoTexture, c"nothing to match around the pixel"),
        (Self::LeftRight, c"hidden in the right image, most likely"),
        (Self::NotUnique, c"another disparity matches nearly as well"),
        (Self::LowConfidence, c"not credible enough"),
    ];

    /// The text of a code.
    pub(crate) fn text(code: i32) -> Option<&'static CStr> {
        Self::TEXTS.iter().find(|(known, _)| *known as i32 == code).map(|&(_, text)| text)
    }
}

impl From<ViewError> for Status {
    fn from(error: ViewError) -> Self {
        match error {
            ViewError::Dims(_) => Self::ImageSize,
            ViewError::Stride { .. } => Self::Stride,
            ViewError::TooShort { .. } => Self::ImageTooShort,
            ViewError::Spans { .. } => Self::SpanCount,
            _ => Self::Span,
        }
    }
}

impl From<ParamError> for Status {
    fn from(error: ParamError) -> Self {
        let ParamError::OutOfRange { param, .. } = error else { return Self::NoRig };
        match param {
            Param::MinDisparity => Self::MinDisparity,
            Param::MaxDisparity => Self::MaxDisparity,
            Param::AnchorGradient => Self::AnchorGradient,
            Param::EdgeGradient => Self::EdgeGradient,
            Param::MinExtent => Self::MinExtent,
            Param::Cell => Self::Cell,
            Param::Reach => Self::Reach,
            Param::MinConfidence => Self::MinConfidence,
            _ => Self::Margin,
        }
    }
}

impl From<RigError> for Status {
    fn from(error: RigError) -> Self {
        match error {
            RigError::Focal(_) => Self::Focal,
            RigError::Baseline(_) => Self::Baseline,
            RigError::Offset(_) => Self::Offset,
            _ => Self::PrincipalPoint,
        }
    }
}

impl From<PoseError> for Status {
    fn from(_: PoseError) -> Self {
        Self::CameraPose
    }
}

impl From<RunError> for Status {
    fn from(error: RunError) -> Self {
        match error {
            RunError::SizeMismatch { .. } => Self::ImageSize,
            _ => Self::MemoryTooSmall,
        }
    }
}

impl From<RegionError> for Status {
    fn from(error: RegionError) -> Self {
        match error {
            RegionError::Empty => Self::RegionEmpty,
            RegionError::Outside => Self::RegionOutside,
            _ => Self::RegionRun,
        }
    }
}

impl From<Reason> for Status {
    fn from(reason: Reason) -> Self {
        match reason {
            Reason::TwoSurfaces => Self::TwoSurfaces,
            Reason::OnlyOutline => Self::OnlyOutline,
            Reason::UnhealthyPair => Self::UnhealthyPair,
            Reason::NoParallax => Self::NoParallax,
            _ => Self::LittleSupport,
        }
    }
}

impl From<PixelRejection> for Status {
    fn from(reason: PixelRejection) -> Self {
        match reason {
            PixelRejection::Outside => Self::PixelOutside,
            PixelRejection::OutsideRegion => Self::RegionOutside,
            PixelRejection::NearBorder => Self::NearBorder,
            PixelRejection::NoTexture => Self::NoTexture,
            PixelRejection::LeftRight => Self::LeftRight,
            PixelRejection::NotUnique => Self::NotUnique,
            PixelRejection::UnhealthyPair => Self::UnhealthyPair,
            _ => Self::LowConfidence,
        }
    }
}
