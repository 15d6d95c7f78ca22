//! Binary image of a rig for storage on a board: what rectifies both cameras, and the disparity
//! range, in [`RigImage::BYTES`] bytes.
//!
//! In: a calibration, a view and a disparity range. Out: bytes. The common view is found once,
//! where the image is made: decoding checks numbers and computes none, so that a board and a PC
//! rectify alike.
//!
//! ```text
//! offset  bytes                      all numbers little endian
//!      0      4  magic               "LSRG"
//!      4      2  version             3
//!      6      2  length              of the whole image, checksum included
//!      8      4  sequence            0 in a file; counted by boards that write images into two slots
//!     12    2+2  rectified size      px
//!     16      2  first disparity     px, signed
//!     18      2  end of disparities  px
//!     20    2+2  raw size            px
//!     24    4*4  rectified view      f32: focal length, centre x y, px; baseline, m
//!     40     96  left camera         f32: rotation from common to the camera's coordinates by rows (9*4), focal lengths x y, centre x y, skew,
//!                                    px; lens (4) 0: Brown-Conrady, 1: fisheye, 2: rational,
//!                                        then eight coefficients, k1 k2 k3 p1 p2 0 0 0,
//!                                    k1 k2 k3 k4 0 0 0 0, or k1 k2 k3 p1 p2 k4 k5 k6, and the
//!                                        tangent of the angle up to which the lens is used
//!    136     96  right camera        the same
//!    232      4  CRC-32              of all bytes before it
//! ```
//!
//! Magic, version, length, sequence and a CRC-32 at the end have the same offsets in every version,
//! so that another one is recognised.
//!
//! # Bounds
//! A CRC-32 detects one, two or three damaged bits in an image this short; other damage passes with
//! a probability of 1 / (4 * 10^9), and its numbers then still have to be within their ranges.
//!
//! # Cost
//! Checking an image: one pass over its bytes; decoding one: some hundred comparisons. No
//! allocation, no panic path.

use crate::calibration::{Calibration, CameraSide};
use crate::camera::{CameraError, Lens};
use crate::checksum::{CRC_32, CRC_BYTES};
use crate::rectification::{RectifyError, View};
use crate::remap::{Remap, RemapCamera, RemapError};
use linestereo::{Dims, Params, params::ParamError};
use serde::{Deserialize, Serialize};

/// First bytes of every image.
const MAGIC: [u8; 4] = *b"LSRG";
/// Version that is written.
const VERSION: u16 = 3;
/// Value of erased flash.
const ERASED: u8 = 0xff;

/// A rig that a board can use: its cameras can be rectified to this size and view, and the
/// disparity range fits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigImage {
    remap: Remap,
    min_disparity: i16,
    max_disparity: u16,
}

/// Start of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RigImageHead {
    /// Version of the layout.
    pub version: u16,
    /// Bytes of the image, checksum included.
    pub length: u16,
    /// Number of the image among those that a board wrote.
    pub sequence: u32,
    /// True when the checksum is that of the bytes.
    pub is_whole: bool,
}

/// Reason why bytes are no rig that a board can use.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RigImageError {
    /// Erased memory.
    #[error("empty: nothing was written here")]
    Empty,
    /// The first bytes are not those of an image.
    #[error("foreign: this does not start as a rig image does")]
    Foreign,
    /// The image ends too early.
    #[error("truncated: the image has {needed} bytes, {given} are here")]
    Truncated {
        /// Bytes of the image.
        needed: usize,
        /// Bytes given.
        given: usize,
    },
    /// Bytes follow the image.
    #[error("surplus: the image has {needed} bytes, {given} are here")]
    Surplus {
        /// Bytes of the image.
        needed: usize,
        /// Bytes given.
        given: usize,
    },
    /// The checksum is not that of the bytes.
    #[error("damaged: the checksum does not match the bytes")]
    Damaged,
    /// A whole image of another version.
    #[error("other version: it is {found}, this program knows {VERSION}")]
    OtherVersion {
        /// Its version.
        found: u16,
    },
    /// The length field is not that of this version: a damaged image, or one of a later version.
    #[error("damaged or of another version: it says it has {found} bytes, not {}", RigImage::BYTES)]
    Length {
        /// Its length.
        found: u16,
    },
    /// A kind of lens that this version does not have.
    #[error("{0} camera: lens {1} is not known, only 0, 1 and 2 are")]
    LensKind(CameraSide, u32),
    /// A camera is not usable.
    #[error("{0} camera: {1}")]
    Camera(CameraSide, CameraError),
    /// The pair cannot be rectified to this size and view.
    #[error("rectified view: {0}")]
    View(RectifyError),
    /// The disparity range does not fit.
    #[error("disparity range: {0}")]
    Range(ParamError),
}

impl RigImageHead {
    /// Reads the start of an image. Only the magic is checked.
    pub fn read(bytes: &[u8]) -> Result<Self, RigImageError> {
        if !bytes.is_empty() && bytes.iter().all(|&byte| byte == ERASED) {
            return Err(RigImageError::Empty);
        }
        if MAGIC.iter().zip(bytes).any(|(a, b)| a != b) {
            return Err(RigImageError::Foreign);
        }
        let Ok((Head { version, length, sequence, .. }, _)) = postcard::take_from_bytes(bytes)
        else {
            return Err(RigImageError::Truncated { needed: RigImage::BYTES, given: bytes.len() });
        };
        let image = bytes.get(..length.into()).unwrap_or_default();
        let is_whole = image
            .split_last_chunk::<CRC_BYTES>()
            .is_some_and(|(bytes, crc)| CRC_32.checksum(bytes) == u32::from_le_bytes(*crc));
        Ok(Self { version, length, sequence, is_whole })
    }

    /// Reads the start of an image of this version, and checks its length and checksum.
    pub fn check(bytes: &[u8]) -> Result<Self, RigImageError> {
        let head = Self::read(bytes)?;
        let (needed, given) = (RigImage::BYTES, bytes.len());
        match usize::from(head.length) {
            RigImage::BYTES if given < needed => {
                return Err(RigImageError::Truncated { needed, given });
            }
            RigImage::BYTES if given > needed => {
                return Err(RigImageError::Surplus { needed, given });
            }
            RigImage::BYTES if !head.is_whole => return Err(RigImageError::Damaged),
            RigImage::BYTES if head.version == VERSION => return Ok(head),
            // The version field is valid only with a valid checksum.
            _ if head.is_whole && head.version != VERSION => {}
            _ => return Err(RigImageError::Length { found: head.length }),
        }
        Err(RigImageError::OtherVersion { found: head.version })
    }
}

impl RigImage {
    /// Size of an image, bytes.
    pub const BYTES: usize = 236;

    /// A rig whose images are rectified to this size and view and searched at disparities
    /// `min_disparity .. max_disparity`, px.
    pub fn new(
        calibration: Calibration,
        dims: Dims,
        view: View,
        (min_disparity, max_disparity): (i16, u16),
    ) -> Result<Self, RigImageError> {
        let rectification = calibration.rectify(dims, view).map_err(RigImageError::View)?;
        Self { remap: rectification.remap(), min_disparity, max_disparity }.checked()
    }

    fn checked(self) -> Result<Self, RigImageError> {
        let remap = self.remap.checked().map_err(|error| match error {
            RemapError::Camera(side, error) => RigImageError::Camera(side, error),
            RemapError::View(error) => RigImageError::View(error),
        })?;
        self.params(Params::DEFAULT)?.check(remap.dims()).map_err(RigImageError::Range)?;
        Ok(self)
    }

    /// The image as bytes.
    #[must_use]
    pub fn encode(&self, sequence: u32) -> [u8; Self::BYTES] {
        let size = |Dims { width, height }: Dims| [width, height].map(Short);
        let Remap { dims, raw, focal, centre, baseline, cameras } = self.remap;
        let [left, right] = cameras;
        let numbers = Numbers {
            head: Head { magic: MAGIC, version: VERSION, length: Self::BYTES as u16, sequence },
            dims: size(dims),
            min_disparity: self.min_disparity,
            max_disparity: self.max_disparity,
            raw: size(raw),
            focal,
            centre,
            baseline,
            left: left.into(),
            right: right.into(),
        };
        let mut bytes = [0; Self::BYTES];
        if let Some((content, crc)) = bytes.split_last_chunk_mut::<CRC_BYTES>() {
            let _ = postcard::to_slice(&numbers, content); // exactly as long as its content: a test holds it
            *crc = CRC_32.checksum(content).to_le_bytes();
        }
        bytes
    }

    /// Decodes an image.
    ///
    /// ```
    /// use linestereo::Dims;
    /// use linestereo_rig::{Calibration, Camera, Lens, RigImage, RigImageError, View};
    /// let dims = Dims { width: 320, height: 240 };
    /// let camera = Camera::new(dims, [250.0; 2], [159.5, 119.5], 0.0, Lens::NONE)?;
    /// let pair = Calibration::new(camera, camera, [1.0, 0.0, 0.0, 0.0], [-0.1, 0.0, 0.0])?;
    /// let image = RigImage::new(pair, dims, View::default(), (0, 64))?;
    /// let mut bytes = image.encode(0);
    /// assert_eq!(RigImage::decode(&bytes), Ok(image));
    /// bytes[100] ^= 1;
    /// assert_eq!(RigImage::decode(&bytes), Err(RigImageError::Damaged));
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    pub fn decode(bytes: &[u8]) -> Result<Self, RigImageError> {
        RigImageHead::check(bytes)?;
        let Ok((numbers, _)) = postcard::take_from_bytes::<Numbers>(bytes) else {
            return Err(RigImageError::Damaged);
        };
        let size = |[Short(width), Short(height)]: [Short; 2]| Dims { width, height };
        let Numbers {
            dims,
            min_disparity,
            max_disparity,
            raw,
            focal,
            centre,
            baseline,
            left,
            right,
            ..
        } = numbers;
        let cameras = [left.camera(CameraSide::Left)?, right.camera(CameraSide::Right)?];
        let remap = Remap { dims: size(dims), raw: size(raw), focal, centre, baseline, cameras };
        Self { remap, min_disparity, max_disparity }.checked()
    }

    /// First disparity, and the end of disparities, px.
    #[must_use]
    pub fn disparities(&self) -> (i16, u16) {
        (self.min_disparity, self.max_disparity)
    }

    /// Raw positions of rectified pixels.
    #[must_use]
    pub fn remap(&self) -> &Remap {
        &self.remap
    }

    /// `params` with this rig and its disparity range.
    pub fn params(&self, params: Params) -> Result<Params, RigImageError> {
        let rig =
            self.remap.rig().map_err(|error| RigImageError::View(RectifyError::Rig(error)))?;
        let (min_disparity, max_disparity) = self.disparities();
        Ok(Params { min_disparity, max_disparity, rig: Some(rig), ..params })
    }
}

/// Fields at the same offsets in every version.
#[derive(Serialize, Deserialize)]
struct Head {
    magic: [u8; 4],
    #[serde(with = "postcard::fixint::le")]
    version: u16,
    #[serde(with = "postcard::fixint::le")]
    length: u16,
    #[serde(with = "postcard::fixint::le")]
    sequence: u32,
}

/// Number of two bytes.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Short(#[serde(with = "postcard::fixint::le")] u16);

/// All fields but the checksum, unchecked.
#[derive(Serialize, Deserialize)]
struct Numbers {
    head: Head,
    dims: [Short; 2],
    #[serde(with = "postcard::fixint::le")]
    min_disparity: i16,
    #[serde(with = "postcard::fixint::le")]
    max_disparity: u16,
    raw: [Short; 2],
    focal: f32,
    centre: [f32; 2],
    baseline: f32,
    left: CameraNumbers,
    right: CameraNumbers,
}

#[derive(Serialize, Deserialize)]
struct CameraNumbers {
    rotation: [[f32; 3]; 3],
    focal: [f32; 2],
    centre: [f32; 2],
    skew: f32,
    #[serde(with = "postcard::fixint::le")]
    lens_kind: u32,
    lens: [f32; 8],
    limit: f32,
}

struct LensKind;

impl LensKind {
    const BROWN_CONRADY: u32 = 0;
    const FISHEYE: u32 = 1;
    const RATIONAL: u32 = 2;
}

impl From<RemapCamera> for CameraNumbers {
    fn from(RemapCamera { rotation, focal, centre, skew, lens, limit }: RemapCamera) -> Self {
        let lens_kind = match lens {
            Lens::BrownConrady { .. } => LensKind::BROWN_CONRADY,
            Lens::Fisheye { .. } => LensKind::FISHEYE,
            Lens::Rational { .. } => LensKind::RATIONAL,
        };
        Self { rotation, focal, centre, skew, lens_kind, lens: lens.coefficients(), limit }
    }
}

impl CameraNumbers {
    fn camera(self, side: CameraSide) -> Result<RemapCamera, RigImageError> {
        let Self {
            rotation,
            focal,
            centre,
            skew,
            lens_kind,
            lens: [a, b, c, d, e, f, g, h],
            limit,
        } = self;
        let lens = match lens_kind {
            LensKind::BROWN_CONRADY => Lens::BrownConrady { k: [a, b, c], p: [d, e] },
            LensKind::FISHEYE => Lens::Fisheye { k: [a, b, c, d] },
            LensKind::RATIONAL => Lens::Rational { k: [a, b, c, f, g, h], p: [d, e] },
            kind => return Err(RigImageError::LensKind(side, kind)),
        };
        Ok(RemapCamera { rotation, focal, centre, skew, lens, limit })
    }
}
