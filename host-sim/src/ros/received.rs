//! Images and calibrations of recordings, as far as they are used: `sensor_msgs/msg/Image`, `CompressedImage` and `CameraInfo`, and Foxglove's.

use super::cdr::Reader;
use super::foxglove;

/// Most coefficients of a lens.
const MOST_COEFFICIENTS: u32 = 64;

/// Content of a message that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Pixel by pixel.
    Image,
    /// As a file.
    CompressedImage,
    /// Of a camera.
    Calibration,
}

/// A message that is read: its content, and how it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Content of the message.
    pub content: Content,
    /// Foxglove's own schema in protobuf, not that of ROS 2 in CDR.
    pub is_foxglove: bool,
}

impl Kind {
    /// By the names of its schema and of its encoding; `None` for what is not read.
    #[must_use]
    pub fn of(schema: &str, encoding: &str) -> Option<Self> {
        let ros = [Content::Image, Content::CompressedImage, Content::Calibration];
        let names = ["sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/CameraInfo"];
        let foxglove = ["foxglove.RawImage", "foxglove.CompressedImage", "foxglove.CameraCalibration"];
        let (names, is_foxglove) = match encoding {
            "cdr" => (names, false),
            "protobuf" => (foxglove, true),
            _ => return None,
        };
        let content = *ros.get(names.iter().position(|&name| name == schema)?)?;
        Some(Self { content, is_foxglove })
    }

    /// Time and frame of an image.
    #[must_use]
    pub fn header(self, message: &[u8]) -> Option<Header<'_>> {
        match (self.is_foxglove, self.content) {
            (false, _) => header(message).map(|(header, _)| header),
            (true, Content::Image) => foxglove::image(message).map(|image| image.header),
            (true, _) => foxglove::compressed(message).map(|image| image.header),
        }
    }

    /// An image, pixel by pixel.
    #[must_use]
    pub fn image(self, message: &[u8]) -> Option<Image<'_>> {
        if self.is_foxglove { foxglove::image(message) } else { Image::read(message) }
    }

    /// An image as a file.
    #[must_use]
    pub fn compressed(self, message: &[u8]) -> Option<CompressedImage<'_>> {
        if self.is_foxglove { foxglove::compressed(message) } else { CompressedImage::read(message) }
    }

    /// A calibration.
    #[must_use]
    pub fn calibration(self, message: &[u8]) -> Option<CameraInfo> {
        if self.is_foxglove { foxglove::calibration(message) } else { CameraInfo::read(message) }
    }
}

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
fn header<'a>(message: &'a [u8]) -> Option<(Header<'a>, Reader<'a>)> {
    let mut reader = Reader::new(message)?;
    let (seconds, nanoseconds) = (reader.i32()?, reader.u32()?);
    let stamp_ns = i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds);
    let frame_id = reader.text()?;
    Some((Header { stamp_ns, frame_id }, reader))
}

impl<'a> Image<'a> {
    fn read(message: &'a [u8]) -> Option<Self> {
        let (header, mut reader) = header(message)?;
        let (height, width, encoding) = (reader.u32()?, reader.u32()?, reader.text()?);
        let (is_big_endian, step) = (reader.u8()? != 0, reader.u32()?);
        Some(Self { header, height, width, encoding, is_big_endian, step, data: reader.bytes()? })
    }
}

impl<'a> CompressedImage<'a> {
    /// The format is told by the bytes of the image.
    fn read(message: &'a [u8]) -> Option<Self> {
        let (header, mut reader) = header(message)?;
        let _format = reader.text()?;
        Some(Self { header, data: reader.bytes()? })
    }
}

impl CameraInfo {
    /// Binning and region of interest are not looked at.
    fn read(message: &[u8]) -> Option<Self> {
        let (_, mut reader) = header(message)?;
        let (height, width, model) = (reader.u32()?, reader.u32()?, reader.text()?.to_owned());
        let count = reader.u32().filter(|&count| count <= MOST_COEFFICIENTS)?;
        let d = (0..count).map(|_| reader.f64()).collect::<Option<_>>()?;
        Some(Self { height, width, model, d, k: reader.f64s()?, r: reader.f64s()?, p: reader.f64s()? })
    }
}
