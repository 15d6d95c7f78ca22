//! Messages that are read: images and calibrations, as ROS 2 or Foxglove writes them.

use super::foxglove;
use super::received::{CameraInfo, CompressedImage, Header, Image, header};

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
