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
    let image = kind.compressed(message).ok_or(EARLY)?;
    let stored = StoredGray::of_file(&image.data, RECORD_BYTES)?;
    Ok(if holds_mosaic(&image.format) { stored.of_mosaic() } else { stored })
}

/// The file is a mosaic, in the words of ROS: `bayer_rggb8; jpeg compressed `, with nothing or a
/// mosaic behind `compressed`. Another encoding there is what it was turned into.
fn holds_mosaic(format: &str) -> bool {
    let (encoding, file) = format.split_once(';').unwrap_or((format, ""));
    let turned_into = file.split_once("compressed").map_or("", |(_, encoding)| encoding.trim());
    mosaic(encoding.trim()).is_some() && (turned_into.is_empty() || mosaic(turned_into).is_some())
}

fn uncompressed(message: &[u8], kind: Kind) -> Result<StoredGray, String> {
    let image = kind.image(message).ok_or(EARLY)?;
    let mosaic = mosaic(&image.encoding);
    let layout = match mosaic.unwrap_or(&image.encoding) {
        // Rows of luma come first, those of colour behind them.
        "mono8" | "8UC1" | "nv12" | "nv21" | "nv24" => PixelBytes::Grey,
        "yuv422" | "uyvy" => PixelBytes::Luma { at: 1 },
        "yuv422_yuy2" | "yuyv" => PixelBytes::Luma { at: 0 },
        "mono16" | "16UC1" if image.is_bigendian != 0 => PixelBytes::Grey16(u16::from_be_bytes),
        "mono16" | "16UC1" => PixelBytes::Grey16(u16::from_le_bytes),
        "rgb8" => PixelBytes::Colour { red: 0, blue: 2, bytes: 3 },
        "bgr8" | "8UC3" => PixelBytes::Colour { red: 2, blue: 0, bytes: 3 },
        "rgba8" => PixelBytes::Colour { red: 0, blue: 2, bytes: 4 },
        "bgra8" | "8UC4" => PixelBytes::Colour { red: 2, blue: 0, bytes: 4 },
        other => {
            let other: String = other.chars().take(24).collect();
            return Err(format!(
                "the encoding \"{other}\" is not read; record mono8, mono16, rgb8, bgr8, bayer_rggb8 or yuv422"
            ));
        }
    };
    let (width, height, step) = (image.width as usize, image.height as usize, image.step as usize);
    let row = width * layout.bytes();
    let is_short =
        step < row || step.checked_mul(height).is_none_or(|bytes| image.data.len() < bytes);
    if width == 0 || height == 0 || is_short || (width * height) as u64 > PIXELS {
        return Err(format!(
            "{} bytes are no {width}x{height} px with rows of {step} bytes; record it again",
            image.data.len()
        ));
    }
    let rows = image.data.chunks_exact(step).take(height).map(|bytes| &bytes[..row]);
    let stored = StoredGray::of_rows([image.width, image.height], layout, rows)?;
    Ok(if mosaic.is_some() { stored.of_mosaic() } else { stored })
}

/// The encoding of a mosaic's values; `None` of other encodings.
fn mosaic(encoding: &str) -> Option<&'static str> {
    match encoding.strip_prefix("bayer_")?.split_at_checked(4)? {
        ("rggb" | "bggr" | "gbrg" | "grbg", "8") => Some("mono8"),
        ("rggb" | "bggr" | "gbrg" | "grbg", "16") => Some("mono16"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros::messages::{CompressedImage, Header, Image};
    use linestereo_frames::grey::Values;

    /// 2x2 px: 0, 100, 100, 0.
    const CHESSBOARD_PNG: &[u8] =
        b"\x89PNG\x0d\x0a\x1a\x0a\x00\x00\x00\x0dIHDR\x00\x00\x00\x02\x00\x00\x00\x02\x08\x00\x00\
        \x00\x00W\xddR\xf8\x00\x00\x00\x0cIDATx\x9cc`H\x01B\x00\x02^\x00\xc9\xedH\x84\xef\x00\
        \x00\x00\x00IEND\xaeB`\x82";

    fn read(
        encoding: &str,
        [width, height]: [u32; 2],
        data: &[u8],
        step: u32,
    ) -> Result<Values, String> {
        let (header, encoding, data) = (Header::default(), encoding.to_owned(), data.into());
        let image = Image { header, height, width, encoding, is_bigendian: 0, step, data };
        let message = crate::ros::cdr::write(&image).unwrap();
        grey(&message, Kind { content: Content::Image, is_foxglove: false })
            .map(|stored| stored.values)
    }

    #[test]
    fn yuv_gives_its_luma() {
        let eight =
            |values| if let Ok(Values::Eight(values)) = values { values } else { Vec::new() };
        let bytes = [128, 10, 129, 20, 130, 30, 131, 40];
        for (encoding, luma) in [
            ("yuv422", [10, 20, 30, 40]),
            ("uyvy", [10, 20, 30, 40]),
            ("yuv422_yuy2", [128, 129, 130, 131]),
            ("yuyv", [128, 129, 130, 131]),
        ] {
            assert_eq!(eight(read(encoding, [2, 2], &bytes, 4)), luma, "{encoding}");
        }
        assert_eq!(eight(read("nv21", [2, 2], &[1, 2, 3, 4, 99, 99], 2)), [1, 2, 3, 4]);
        assert!(read("yuv422", [2, 2], &bytes[..7], 4).is_err());
        assert!(read("yuv422_v210", [2, 2], &bytes, 4).is_err());
    }

    #[test]
    fn a_mosaic_of_one_colour_is_one_grey() {
        let [red, green, blue] = [200_u8, 100, 40];
        let grey_of = (u32::from(red) + 2 * u32::from(green) + u32::from(blue)) / 4;
        for (order, square) in [
            ("rggb", [red, green, green, blue]),
            ("bggr", [blue, green, green, red]),
            ("gbrg", [green, blue, red, green]),
            ("grbg", [green, red, blue, green]),
        ] {
            let at = |i: usize| square[2 * (i / 6 % 2) + i % 6 % 2];
            let pixels: Vec<u8> = (0..30).map(at).collect();
            let Ok(Values::Eight(found)) = read(&format!("bayer_{order}8"), [6, 5], &pixels, 6)
            else {
                panic!("{order}")
            };
            assert!(found.iter().all(|&grey| u32::from(grey) == grey_of), "{order} {found:?}");
            let wide: Vec<u8> =
                pixels.iter().flat_map(|&value| (4 * u16::from(value)).to_le_bytes()).collect();
            let Ok(Values::Sixteen(found)) = read(&format!("bayer_{order}16"), [6, 5], &wide, 12)
            else {
                panic!("{order}")
            };
            assert!(found.iter().all(|&grey| u32::from(grey) == 4 * grey_of), "{order} {found:?}");
        }
        // A file is not turned into grey, or is already.
        for (format, is_mosaic) in [
            ("bayer_rggb8; png compressed ", true),
            ("bayer_rggb8; jpeg compressed bayer_rggb8", true),
            ("bayer_gbrg16;png", true),
            ("bayer_rggb8; jpeg compressed bgr8", false),
            ("mono8; jpeg compressed ", false),
            ("png", false),
            ("", false),
        ] {
            let (header, format) = (Header::default(), format.to_owned());
            let image = CompressedImage { header, format, data: CHESSBOARD_PNG.into() };
            let kind = Kind { content: Content::CompressedImage, is_foxglove: false };
            let found = super::grey(&crate::ros::cdr::write(&image).unwrap(), kind).unwrap();
            let Values::Eight(found) = found.values else { panic!("8 bits") };
            let expected = if is_mosaic { [50; 4] } else { [0, 100, 100, 0] };
            assert_eq!(found, expected, "{}", image.format);
        }
        assert!(read("bayer_rgbg8", [2, 2], &[0; 4], 2).unwrap_err().contains("bayer_rgbg8"));
    }
}
