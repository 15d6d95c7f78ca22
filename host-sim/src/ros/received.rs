//! Images and calibrations of recordings, as far as they are used: `sensor_msgs/msg/Image`, `CompressedImage` and `CameraInfo`.

use super::cdr::Reader;

/// Most coefficients of a lens.
const MOST_COEFFICIENTS: u32 = 64;

/// When and where something was seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header<'a> {
    /// Time of the exposure, ns; 0 where nobody set it.
    pub stamp_ns: i64,
    /// Name of the camera's frame.
    pub frame_id: &'a str,
}

/// An image, pixel by pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image<'a> {
    /// Its camera and time.
    pub header: Header<'a>,
    /// Rows.
    pub height: u32,
    /// Columns.
    pub width: u32,
    /// Channels and bits, by name.
    pub encoding: &'a str,
    /// Byte order of values of 16 bits.
    pub is_big_endian: bool,
    /// Bytes of a row.
    pub step: u32,
    /// Its rows.
    pub data: &'a [u8],
}

/// An image as a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompressedImage<'a> {
    /// Its camera and time.
    pub header: Header<'a>,
    /// JPEG or PNG.
    pub data: &'a [u8],
}

/// Calibration of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraInfo {
    /// Rows.
    pub height: u32,
    /// Columns.
    pub width: u32,
    /// Name of the lens model.
    pub model: String,
    /// Its coefficients.
    pub d: Vec<f64>,
    /// Camera matrix of the raw image, by rows.
    pub k: [f64; 9],
    /// From camera coordinates to rectified ones, by rows.
    pub r: [f64; 9],
    /// Projection into the rectified image, by rows.
    pub p: [f64; 12],
}

/// The header, and what is behind it.
pub(super) fn header<'a>(message: &'a [u8]) -> Option<(Header<'a>, Reader<'a>)> {
    let mut reader = Reader::new(message)?;
    let (seconds, nanoseconds) = (reader.i32()?, reader.u32()?);
    let stamp_ns = i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds);
    let frame_id = reader.text()?;
    Some((Header { stamp_ns, frame_id }, reader))
}

impl<'a> Image<'a> {
    pub(super) fn read(message: &'a [u8]) -> Option<Self> {
        let (header, mut reader) = header(message)?;
        let (height, width, encoding) = (reader.u32()?, reader.u32()?, reader.text()?);
        let (is_big_endian, step) = (reader.u8()? != 0, reader.u32()?);
        Some(Self { header, height, width, encoding, is_big_endian, step, data: reader.bytes()? })
    }
}

impl<'a> CompressedImage<'a> {
    /// The format is told by the bytes of the image.
    pub(super) fn read(message: &'a [u8]) -> Option<Self> {
        let (header, mut reader) = header(message)?;
        let _format = reader.text()?;
        Some(Self { header, data: reader.bytes()? })
    }
}

impl CameraInfo {
    /// Binning and region of interest are not looked at.
    pub(super) fn read(message: &[u8]) -> Option<Self> {
        let (_, mut reader) = header(message)?;
        let (height, width, model) = (reader.u32()?, reader.u32()?, reader.text()?.to_owned());
        let count = reader.u32().filter(|&count| count <= MOST_COEFFICIENTS)?;
        let d = (0..count).map(|_| reader.f64()).collect::<Option<_>>()?;
        Some(Self { height, width, model, d, k: reader.f64s()?, r: reader.f64s()?, p: reader.f64s()? })
    }
}
