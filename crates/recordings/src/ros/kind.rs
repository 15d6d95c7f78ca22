//! Messages that are read: images and calibrations, as ROS 2 or Foxglove writes them.

use super::messages::{CameraInfo, CompressedImage, Header, Image};
use super::{cdr, foxglove};

/// Most coefficients of a lens.
const MOST_COEFFICIENTS: usize = 64;
/// The rotation of a camera that is not turned, by rows.
pub const NO_ROTATION: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

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
    pub fn of(schema: &str, encoding: &str) -> Option<Self> {
        let (content, is_foxglove) = match (encoding, schema) {
            ("cdr", "sensor_msgs/msg/Image") => (Content::Image, false),
            ("cdr", "sensor_msgs/msg/CompressedImage") => (Content::CompressedImage, false),
            ("cdr", "sensor_msgs/msg/CameraInfo") => (Content::Calibration, false),
            ("protobuf", "foxglove.RawImage") => (Content::Image, true),
            ("protobuf", "foxglove.CompressedImage") => (Content::CompressedImage, true),
            ("protobuf", "foxglove.CameraCalibration") => (Content::Calibration, true),
            _ => return None,
        };
        Some(Self { content, is_foxglove })
    }

    /// Time and frame of an image.
    #[must_use]
    pub fn header(self, message: &[u8]) -> Option<Header> {
        match (self.is_foxglove, self.content) {
            (false, _) => cdr::read(message),
            (true, Content::Image) => foxglove::image(message).map(|image| image.header),
            (true, _) => foxglove::compressed(message).map(|image| image.header),
        }
    }

    /// An image, pixel by pixel.
    #[must_use]
    pub fn image(self, message: &[u8]) -> Option<Image<'_>> {
        if self.is_foxglove { foxglove::image(message) } else { cdr::read(message) }
    }

    /// An image as a file.
    #[must_use]
    pub fn compressed(self, message: &[u8]) -> Option<CompressedImage<'_>> {
        if self.is_foxglove { foxglove::compressed(message) } else { cdr::read(message) }
    }

    /// A calibration, whenever it was sent.
    #[must_use]
    pub fn calibration(self, message: &[u8]) -> Option<CameraInfo> {
        let info =
            if self.is_foxglove { foxglove::calibration(message) } else { cdr::read(message) };
        let info: CameraInfo =
            info.filter(|info: &CameraInfo| info.d.len() <= MOST_COEFFICIENTS)?;
        let r = if info.r == [0.0; 9] { NO_ROTATION } else { info.r }; // nobody set it
        Some(CameraInfo { header: Header::default(), r, ..info })
    }
}
