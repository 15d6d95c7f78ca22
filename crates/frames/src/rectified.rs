//! The gate that the calibration of every rectified pair passes, whatever says it.
//!
//! ```text
//! projections, or focal length and baseline -> finite, side by side, the right camera on the
//!     right, square pixels, plausible
//! size of the images they are of            -> that of the images that are matched
//! binning and region of ROS                 -> the numbers of the images as they are sent
//! ```
//!
//! Which source gives which of these stands in `docs/formats.md`.

pub use linestereo::Dims;
use linestereo_wire::RigUpdate;

/// Baselines of stereo heads, m. Others are in another unit.
const BASELINES_M: core::ops::RangeInclusive<f64> = 0.001..=10.0;
/// Focal lengths, in widths of the image: 157 to 2.9 degrees across. Others are in another unit, or
/// of other images.
const FOCALS: core::ops::RangeInclusive<f64> = 0.1..=20.0;
/// Products of focal length, in widths of the image, and baseline, m: the largest is that of
/// cameras 10 m apart that see 53 degrees. Baselines in mm give 10 and more from 20 mm on.
const PRODUCTS_M: core::ops::RangeInclusive<f64> = 0.0001..=10.0;
/// Share by which the focal lengths across and down, or those of both images, may differ.
const SAME_FOCAL: f64 = 0.01;
/// Share of the baseline by which the right camera may lie higher, lower, or farther forward.
const OFF_AXIS: f64 = 0.02;
/// Rows by which the principal points of two rectified images may differ, px: the matcher finds as
/// many.
const SAME_ROWS_PX: f64 = 1.5;
/// Ratio of twice the principal point to the size of the images, in both directions alike, from
/// which on the calibration is of images of another size: principal points are off the middle by
/// some percent, and sizes differ by 1.25 (800 and 640 px) or more.
const OTHER_SIZE: f64 = 1.2;
/// The same where the source says the size too: images that were cropped off their middle are kept.
const OTHER_THAN_SAID: f64 = 1.35;
/// Largest ratio of these two ratios, across and down: images are scaled alike in both directions.
const SAME_RATIO: f64 = 1.2;

/// Numbers of a rectified pair that passed the gate but for the images themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectifiedRig {
    /// Focal length, baseline and offset.
    pub numbers: RigUpdate,
    /// Principal point of the left image, px, where it is known.
    pub centre_px: Option<[f64; 2]>,
    /// Size of the images that the numbers are of, where the source says it.
    pub size: Option<Dims>,
}

/// Why a calibration is not that of a rectified pair, or not of these images.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// A number is infinite, not a number, or a focal length is not above 0.
    #[error(
        "P is no projection: a number is not finite, or a focal length not above 0; calibrate as \
         a stereo pair"
    )]
    NoProjection,
    /// The baseline is in other units than metres.
    #[error("{}", text_of_baseline(*.0))]
    Baseline(f64),
    /// Both projections say the same place.
    #[error("P of the right camera has no baseline")]
    NoBaseline,
    /// `P[3]` of the left and of the right camera, which put the right camera on the left.
    #[error(
        "P[3] is {left} for the left and {right} for the right camera, but must be 0 for the left \
         and -(focal length * baseline) for the right one: either left and right are exchanged, or \
         its sign is wrong; correct the driver or the calibration"
    )]
    Sign {
        /// Of the left camera, px m.
        left: f64,
        /// Of the right camera, px m.
        right: f64,
    },
    /// Shares of the baseline, m, along the columns and forward.
    #[error(
        "the right camera lies {across} m to the right of the left one, {down} m below it and \
         {forward} m in front of it (P[3], P[7], P[11]): cameras above each other, or placed \
         diagonally, cannot be matched along rows; for a vertical rig, turn the images by 90 \
         degrees and calibrate with them"
    )]
    Axis {
        /// Along the rows, m.
        across: f64,
        /// Along the columns, m.
        down: f64,
        /// Along the optical axis, m.
        forward: f64,
    },
    /// Focal lengths across and down.
    #[error(
        "the focal lengths across and down are {0} and {1} px, but rectified images need square \
         pixels; scale the images by the same factor both ways, or rectify them again"
    )]
    NotSquare(f64, f64),
    /// Focal lengths of both images.
    #[error(
        "the focal lengths of the left and right image are {0} and {1} px: rectified images have \
         one; rectify them anew"
    )]
    FocalsDiffer(f64, f64),
    /// Rows of both principal points.
    #[error(
        "the principal points lie in the rows {0} (left) and {1} (right), but must lie in the same \
         row; crop both images at the same y_offset"
    )]
    RowsDiffer(f64, f64),
    /// Focal length, and width of the images, px.
    #[error(
        "a focal length of {0} px is not plausible for images {1} px wide; give it in px: focal \
         length in mm / sensor width in mm * {1}"
    )]
    Focal(f64, u16),
    /// Focal length times baseline, and width of the images, px.
    #[error(
        "a focal length times a baseline of {0} px m is not plausible for images {1} px wide: did \
         you mean px mm? then give {mm}; if it is right, give focal length and baseline apart",
        mm = .0 / 1000.0
    )]
    Product(f64, u16),
    /// The principal point of images of this size.
    #[error(
        "the principal point ({x}, {y}) px is the middle of images of about \
         {of_width:.0}x{of_height:.0}, but these are {images}: the calibration is for another \
         image size; give images of that size and reduce them with --width, or give a calibration \
         for {images}",
        x = .centre[0], y = .centre[1], of_width = 2.0 * .centre[0] + 1.0, of_height = 2.0 * .centre[1] + 1.0
    )]
    Centre {
        /// Principal point, px.
        centre: [f64; 2],
        /// Size of the images.
        images: Dims,
    },
    /// The calibration is of images of another size.
    #[error(
        "the calibration is for images of {of}, but these are {images}, so depths would be wrong \
         by that ratio; give images of {of} and reduce them with --width, or give a calibration \
         for {images}"
    )]
    Size {
        /// Of the calibration.
        of: Dims,
        /// Of the images.
        images: Dims,
    },
    /// Binning and region do not lie within the full image.
    #[error(
        "binning {0}x{1} and roi do not fit an image of {2}x{3}: binning must divide both sides, \
         and roi must lie within the unbinned image; correct the driver's CameraInfo"
    )]
    Window(u32, u32, u32, u32),
    /// The images are not what binning and region make of the full image.
    #[error(
        "CameraInfo states {}x{} with binning {}x{} and a region (roi) of {}x{} at ({}, {}), which \
         gives images of {sent}, but the images are {images}: scale CameraInfo with the images, or \
         record the images that it describes",
        .window.full[0], .window.full[1], .window.binning[0], .window.binning[1], .window.roi[2], .window.roi[3], .window.roi[0], .window.roi[1]
    )]
    Sent {
        /// Binning and region.
        window: SentWindow,
        /// Size that they make.
        sent: Dims,
        /// Size of the images.
        images: Dims,
    },
}

fn text_of_baseline(metres: f64) -> String {
    if metres.abs() > *BASELINES_M.end() {
        let (of_mm, of_cm) = (metres / 1000.0, metres / 100.0);
        return format!(
            "a baseline of {metres} m: did you mean mm? then give {of_mm}, for cm {of_cm}"
        );
    }
    format!(
        "a baseline of {metres} m is not plausible for a stereo camera; give the distance between \
         the cameras in metres, such as 0.075"
    )
}

/// Refuses a distance between the cameras that is in other units than metres.
///
/// # Errors
/// [`Unfit::Baseline`] outside of 1 mm to 10 m.
pub fn check_baseline(metres: f64) -> Result<(), Unfit> {
    if BASELINES_M.contains(&metres) { Ok(()) } else { Err(Unfit::Baseline(metres)) }
}

/// Refuses a focal length that is in other units than pixels of images this wide.
///
/// # Errors
/// [`Unfit::Focal`] outside of a tenth to twenty widths.
pub fn check_focal(focal_px: f64, width: u16) -> Result<(), Unfit> {
    let is_likely = FOCALS.contains(&(focal_px / f64::from(width)));
    if is_likely { Ok(()) } else { Err(Unfit::Focal(focal_px, width)) }
}

/// Refuses a product of focal length and baseline that is in other units than pixels of images this
/// wide and metres.
///
/// # Errors
/// [`Unfit::Product`] outside of a ten-thousandth to ten widths times metres.
pub fn check_product(product: f64, width: u16) -> Result<(), Unfit> {
    let is_likely = PRODUCTS_M.contains(&(product / f64::from(width)));
    if is_likely { Ok(()) } else { Err(Unfit::Product(product, width)) }
}

/// Refuses a principal point that is the middle of images of another size, where nothing else says
/// the size.
///
/// # Errors
/// [`Unfit::Centre`] where both of its coordinates say the same ratio of sizes, and one far from 1.
pub fn check_centre(centre: [f64; 2], images: Dims) -> Result<(), Unfit> {
    near_middle(centre, images, OTHER_SIZE)
}

/// The same where the source says the size of its images too: a principal point of other images
/// contradicts it.
///
/// # Errors
/// As [`check_centre`].
pub fn check_centre_of(centre: [f64; 2], of: Dims) -> Result<(), Unfit> {
    near_middle(centre, of, OTHER_THAN_SAID)
}

fn near_middle(centre: [f64; 2], images: Dims, other: f64) -> Result<(), Unfit> {
    let sides = [images.width, images.height];
    let [x, y] = [0, 1].map(|axis| (2.0 * centre[axis] + 1.0) / f64::from(sides[axis]));
    let differ = |ratio: f64, by: f64| ratio > by || ratio < 1.0 / by;
    let is_other = differ(x, other) && differ(y, other) && !differ(x / y, SAME_RATIO);
    let is_unset = centre == [0.0; 2];
    if is_other || is_unset { Err(Unfit::Centre { centre, images }) } else { Ok(()) }
}

impl RectifiedRig {
    /// Of the projections of a left and a right camera, 3x4 by rows.
    ///
    /// # Errors
    /// They are not those of rectified images of cameras side by side, the right one on the right.
    pub fn of_projections(
        [left, right]: [&[f64; 12]; 2],
        size: Option<Dims>,
    ) -> Result<Self, Unfit> {
        let is_projection =
            |p: &[f64; 12]| p.iter().all(|value| value.is_finite()) && p[0] > 0.0 && p[5] > 0.0;
        let is_plain = |p: &[f64; 12]| {
            [p[1], p[4], p[8], p[9], p[10] - 1.0].iter().all(|value| value.abs() < 1e-6)
        };
        if ![left, right].into_iter().all(|p| is_projection(p) && is_plain(p)) {
            return Err(Unfit::NoProjection);
        }
        let differ = |a: f64, b: f64| (a - b).abs() > SAME_FOCAL * a;
        let focal_px = left[0];
        if differ(focal_px, right[0]) {
            return Err(Unfit::FocalsDiffer(focal_px, right[0]));
        }
        for p in [left, right] {
            if differ(p[0], p[5]) {
                return Err(Unfit::NotSquare(p[0], p[5]));
            }
        }
        if (left[6] - right[6]).abs() > SAME_ROWS_PX {
            return Err(Unfit::RowsDiffer(left[6], right[6]));
        }
        let centre_px = [left[2], left[6]];
        // A camera at c has P = f (I, -c): in the last column -f c_x + c_x' * -c_z and so on.
        let place = |p: &[f64; 12]| {
            [(p[3] - p[2] * p[11]) / p[0], (p[7] - p[6] * p[11]) / p[5], p[11]].map(|value| -value)
        };
        let (from, to) = (place(left), place(right));
        let [across, down, forward] = [0, 1, 2].map(|axis| to[axis] - from[axis]);
        if [across, down, forward].iter().all(|value| value.abs() < 1e-9) {
            return Err(Unfit::NoBaseline);
        }
        if down.abs().max(forward.abs()) > OFF_AXIS * across.abs() {
            return Err(Unfit::Axis { across, down, forward });
        }
        if across < 0.0 || right[3] >= 0.0 {
            return Err(Unfit::Sign { left: left[3], right: right[3] });
        }
        let numbers = RigUpdate { focal_px, baseline_m: across, offset_px: right[2] - left[2] };
        Self { numbers, centre_px: Some(centre_px), size }.checked()
    }

    /// The same, once its numbers are likely.
    ///
    /// # Errors
    /// The baseline is in another unit, or the focal length or principal point is none of images of
    /// this size.
    pub fn checked(self) -> Result<Self, Unfit> {
        let RigUpdate { focal_px, baseline_m, offset_px } = self.numbers;
        if ![focal_px, baseline_m, offset_px].iter().all(|value| value.is_finite())
            || focal_px <= 0.0
        {
            return Err(Unfit::NoProjection);
        }
        check_baseline(baseline_m)?;
        let Some(size) = self.size else { return Ok(self) };
        self.centre_px.map_or(Ok(()), |centre| check_centre_of(centre, size))?;
        check_focal(focal_px, size.width).map(|()| self)
    }

    /// Are these numbers of images of this size?
    ///
    /// # Errors
    /// They are of images of another size, or cannot be of these.
    pub fn check_images(&self, images: Dims) -> Result<(), Unfit> {
        match self.size {
            Some(of) if of != images => return Err(Unfit::Size { of, images }),
            Some(_) => {}
            None => self.centre_px.map_or(Ok(()), |centre| check_centre(centre, images))?,
        }
        check_focal(self.numbers.focal_px, images.width)
    }
}

/// Part of the full image that ROS's `CameraInfo` says is sent: a region of it, then binned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SentWindow {
    /// Width and height of the image that was calibrated, px.
    pub full: [u32; 2],
    /// Pixels across and down that are one; 0 is 1.
    pub binning: [u32; 2],
    /// `x_offset`, `y_offset`, width and height in the full image; without width and height all of
    /// it.
    pub roi: [u32; 4],
}

impl SentWindow {
    fn factors(&self) -> [f64; 2] {
        self.binning.map(|bin| f64::from(bin.max(1)))
    }

    /// True where the full image is sent.
    pub fn is_full(&self) -> bool {
        let [x, y, width, height] = self.roi;
        let is_whole = x == 0
            && y == 0
            && (width == 0 || width == self.full[0])
            && (height == 0 || height == self.full[1]);
        is_whole && self.binning.iter().all(|&bin| bin <= 1)
    }

    /// Size of the images as sent.
    ///
    /// # Errors
    /// [`Unfit::Window`].
    pub fn sent(&self) -> Result<Dims, Unfit> {
        let ([across, down], [full_width, full_height]) = (self.binning, self.full);
        let wrong = Unfit::Window(across, down, full_width, full_height);
        let [x, y, width, height] = self.roi;
        let side = |start: u32, length: u32, full: u32, bin: u32| {
            let length = if length == 0 { full.checked_sub(start)? } else { length };
            let fits = start.checked_add(length)? <= full;
            u16::try_from(length / bin.max(1)).ok().filter(|&sent| fits && sent > 0)
        };
        let sides = (side(x, width, full_width, across), side(y, height, full_height, down));
        let (Some(width), Some(height)) = sides else { return Err(wrong) };
        Ok(Dims { width, height })
    }

    /// Refuses images that are not what is sent.
    ///
    /// # Errors
    /// [`Unfit::Window`], [`Unfit::Size`] or [`Unfit::Sent`].
    pub fn check_images(&self, images: Dims) -> Result<(), Unfit> {
        let sent = self.sent()?;
        match sent == images {
            true => Ok(()),
            false if self.is_full() => Err(Unfit::Size { of: sent, images }),
            false => Err(Unfit::Sent { window: *self, sent, images }),
        }
    }

    /// Turns the first two rows of a camera matrix or a projection of the full image, `row` numbers
    /// each, into those of the images as sent, in place. Whole numbers are pixel centres.
    pub fn apply(&self, matrix: &mut [f64], row: usize) {
        let offset = [self.roi[0], self.roi[1]].map(f64::from);
        let axes = self.factors().into_iter().zip(offset);
        for (values, (factor, offset)) in matrix.chunks_exact_mut(row).zip(axes) {
            let [_, _, centre, ..] = values else { continue };
            *centre -= offset;
            *centre = (*centre + 0.5) / factor - 0.5;
            for (at, value) in values.iter_mut().enumerate() {
                *value /= if at == 2 { 1.0 } else { factor };
            }
        }
    }
}
