//! Images and calibrations of Foxglove's own schemas, in protobuf, as the messages of ROS 2 that
//! say the same. Only fields that are used are declared; others are passed over.
//!
//! # Source
//! The schemas of <https://github.com/foxglove/foxglove-sdk>.

use super::messages::{CameraInfo, CompressedImage, Header, Image, Time};
use prost::Message;

/// `google.protobuf.Timestamp`.
#[derive(Clone, Copy, PartialEq, Message)]
struct Timestamp {
    #[prost(int64, tag = "1")]
    seconds: i64,
    #[prost(int32, tag = "2")]
    nanos: i32,
}

/// `foxglove.RawImage`.
#[derive(Clone, PartialEq, Message)]
struct RawImage {
    #[prost(message, optional, tag = "1")]
    timestamp: Option<Timestamp>,
    #[prost(fixed32, tag = "2")]
    width: u32,
    #[prost(fixed32, tag = "3")]
    height: u32,
    #[prost(string, tag = "4")]
    encoding: String,
    #[prost(fixed32, tag = "5")]
    step: u32,
    #[prost(bytes = "vec", tag = "6")]
    data: Vec<u8>,
    #[prost(string, tag = "7")]
    frame_id: String,
}

/// `foxglove.CompressedImage`.
#[derive(Clone, PartialEq, Message)]
struct ImageFile {
    #[prost(message, optional, tag = "1")]
    timestamp: Option<Timestamp>,
    #[prost(bytes = "vec", tag = "2")]
    data: Vec<u8>,
    #[prost(string, tag = "4")]
    frame_id: String,
}

/// `foxglove.CameraCalibration`.
#[derive(Clone, PartialEq, Message)]
struct CameraCalibration {
    #[prost(fixed32, tag = "2")]
    width: u32,
    #[prost(fixed32, tag = "3")]
    height: u32,
    #[prost(string, tag = "4")]
    distortion_model: String,
    #[prost(double, repeated, tag = "5")]
    d: Vec<f64>,
    #[prost(double, repeated, tag = "6")]
    k: Vec<f64>,
    #[prost(double, repeated, tag = "7")]
    r: Vec<f64>,
    #[prost(double, repeated, tag = "8")]
    p: Vec<f64>,
}

/// `None` for a time that is none of ROS 2.
fn header(timestamp: Option<Timestamp>, frame_id: String) -> Option<Header> {
    let Timestamp { seconds, nanos } = timestamp.unwrap_or_default();
    let stamp = Time { sec: seconds.try_into().ok()?, nanosec: nanos.try_into().ok()? };
    Some(Header { stamp, frame_id })
}

/// An image, pixel by pixel.
pub(super) fn image(message: &[u8]) -> Option<Image<'static>> {
    let RawImage { timestamp, width, height, encoding, step, data, frame_id } =
        RawImage::decode(message).ok()?;
    let header = header(timestamp, frame_id)?;
    Some(Image { header, height, width, encoding, is_bigendian: 0, step, data: data.into() })
}

/// An image as a file.
pub(super) fn compressed(message: &[u8]) -> Option<CompressedImage<'static>> {
    let ImageFile { timestamp, data, frame_id } = ImageFile::decode(message).ok()?;
    let header = header(timestamp, frame_id)?;
    Some(CompressedImage { header, format: String::new(), data: data.into() })
}

/// Calibration of a camera, matrices that are not set as zeros; `None` where one is of another
/// size.
pub(super) fn calibration(message: &[u8]) -> Option<CameraInfo> {
    let CameraCalibration { width, height, distortion_model, d, k, r, p } =
        CameraCalibration::decode(message).ok()?;
    let (k, r, p) = (matrix(&k)?, matrix(&r)?, matrix(&p)?);
    Some(CameraInfo { height, width, distortion_model, d, k, r, p, ..CameraInfo::default() })
}

fn matrix<const N: usize>(values: &[f64]) -> Option<[f64; N]> {
    if values.is_empty() { Some([0.0; N]) } else { values.try_into().ok() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_in_any_order_and_broken_ones_refused() {
        // width, an unknown varint, frame_id, time, data.
        let message =
            [0x15, 64, 1, 0, 0, 0x78, 0x96, 1, 0x3a, 1, b'a', 0x0a, 4, 8, 2, 16, 5, 0x32, 2, 7, 9];
        let found = image(&message).unwrap();
        assert_eq!(
            (found.width, &*found.header.frame_id, found.header.stamp_ns()),
            (320, "a", 2_000_000_005)
        );
        assert_eq!((&*found.data, found.height), (&[7, 9][..], 0));
        for end in [1, 4, 6, 7, 9, 12, 16, 20] {
            assert!(image(&message[..end]).is_none(), "{end}");
        }
        assert!(image(&[0x10, 1]).is_none(), "a width as varint");
        assert!(
            image(&[0x32, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1]).is_none(),
            "2^64 - 1 bytes"
        );
        assert!(image(&[0xff; 11]).is_none(), "no end");
        let doubles =
            |tag: u8, count: usize| [&[tag, 8 * count as u8][..], &vec![0; 8 * count]].concat();
        let matrices = [doubles(0x32, 9), doubles(0x3a, 9), doubles(0x42, 12)].concat();
        assert_eq!(calibration(&matrices).unwrap().p, [0.0; 12]);
        assert_eq!(calibration(&doubles(0x32, 9)).unwrap().r, [0.0; 9], "not set");
        assert_eq!(calibration(&doubles(0x3a, 8)), None);
    }
}
