//! A message with an image -> grey values, as files of the same pixels give them.

use crate::mcap::RECORD_BYTES;
use crate::ros::kind::{Content, Kind};
use linestereo_frames::PixelBytes;
use linestereo_frames::grey::StoredGray;
use linestereo_frames::untrusted::PIXELS;

/// Why nothing is made of a message that ends before its fields do.
const EARLY: &str = "the message ends early; record it again";

/// The image in a message, or why there is none.
pub(super) fn grey(message: &[u8], kind: Kind) -> Result<StoredGray, String> {
    match kind.content {
        Content::CompressedImage => compressed(message, kind),
        Content::Image | Content::Calibration => uncompressed(message, kind),
    }
}

fn compressed(message: &[u8], kind: Kind) -> Result<StoredGray, String> {
    StoredGray::of_file(&kind.compressed(message).ok_or(EARLY)?.data, RECORD_BYTES)
}

fn uncompressed(message: &[u8], kind: Kind) -> Result<StoredGray, String> {
    let image = kind.image(message).ok_or(EARLY)?;
    let layout = match &*image.encoding {
        "mono8" | "8UC1" => PixelBytes::Grey,
        "mono16" | "16UC1" if image.is_bigendian != 0 => PixelBytes::Grey16(u16::from_be_bytes),
        "mono16" | "16UC1" => PixelBytes::Grey16(u16::from_le_bytes),
        "rgb8" => PixelBytes::Colour { red: 0, blue: 2, bytes: 3 },
        "bgr8" | "8UC3" => PixelBytes::Colour { red: 2, blue: 0, bytes: 3 },
        "rgba8" => PixelBytes::Colour { red: 0, blue: 2, bytes: 4 },
        "bgra8" | "8UC4" => PixelBytes::Colour { red: 2, blue: 0, bytes: 4 },
        bayer if bayer.starts_with("bayer") => {
            return Err(format!("{bayer} is a mosaic of colours; record what image_proc's debayer node makes of it"));
        }
        other => {
            let other: String = other.chars().take(24).collect();
            return Err(format!("the encoding \"{other}\" is not read; record mono8, mono16, rgb8 or bgr8"));
        }
    };
    let (width, height, step) = (image.width as usize, image.height as usize, image.step as usize);
    let row = width * layout.bytes();
    let is_short = step < row || step.checked_mul(height).is_none_or(|bytes| image.data.len() < bytes);
    if width == 0 || height == 0 || is_short || (width * height) as u64 > PIXELS {
        return Err(format!(
            "{} bytes are no {width}x{height} px with rows of {step} bytes; record it again",
            image.data.len()
        ));
    }
    let rows = image.data.chunks_exact(step).take(height).map(|bytes| &bytes[..row]);
    StoredGray::of_rows([image.width, image.height], layout, rows)
}
