//! Image files to 8-bit grey.
//!
//! In: PNG, JPEG, PGM or PPM, 8 or 16 bit, grey or colour. Out: [`GrayImage`], or the raw values of a ground-truth file.
//! Colour becomes `0.299 R + 0.587 G + 0.114 B` (BT.601, what a JPEG's own grey channel is), transparency is ignored, 16 bits
//! become 8 by `round(v / 257)`.

use super::error::FrameError;
use image::{DynamicImage, ImageDecoder, ImageReader};
use linestereo::Dims;
use linestereo::image::ViewError;
use linestereo_baselines::GrayImage;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Largest share of pixels, in percent, at one end of the scale that leaves anything to match.
const MAX_SATURATED_PERCENT: f64 = 95.0;

/// Reads an image file as 8-bit grey. The core's limits of size do not apply yet.
pub fn load_gray(path: &Path) -> Result<GrayImage, FrameError> {
    let image = decode(path)?;
    let dims = dims_of(path, &image)?;
    let pixels = match image.color() {
        image::ColorType::L8 | image::ColorType::La8 => image.into_luma8().into_raw(),
        image::ColorType::L16 | image::ColorType::La16 => {
            image.into_luma16().into_raw().into_iter().map(to_8_bit).collect()
        }
        image::ColorType::Rgb16 | image::ColorType::Rgba16 => {
            image.into_rgb16().pixels().map(|rgb| to_8_bit(luma(rgb.0.map(u32::from)))).collect()
        }
        _ => image.into_rgb8().pixels().map(|rgb| luma(rgb.0.map(u32::from)) as u8).collect(),
    };
    Ok(GrayImage { dims, pixels })
}

/// Reads a file of plain numbers (disparities, masks): grey values as stored, 8 or 16 bit.
pub(crate) fn load_values(path: &Path) -> Result<(Dims, Vec<u16>), FrameError> {
    let image = decode(path)?;
    let dims = dims_of(path, &image)?;
    let values = match image.color() {
        image::ColorType::L16 => image.into_luma16().into_raw(),
        image::ColorType::L8 => image.into_luma8().into_raw().into_iter().map(u16::from).collect(),
        // Grey stored as a palette or as three equal channels.
        _ => {
            let rgb = image.into_rgb8();
            if rgb.pixels().any(|pixel| pixel.0 != [pixel.0[0]; 3]) {
                return Err(FrameError::ColouredTruth(path.to_path_buf()));
            }
            rgb.pixels().map(|pixel| u16::from(pixel.0[0])).collect()
        }
    };
    Ok((dims, values))
}

/// An image has 16 bits a value.
pub(super) fn is_16_bit(path: &Path) -> Result<bool, FrameError> {
    let decoder =
        open(path)?.into_decoder().map_err(|error| FrameError::Decode(path.to_path_buf(), error.to_string()))?;
    Ok(decoder.color_type().bytes_per_pixel() / decoder.color_type().channel_count() == 2)
}

/// Height of an image, by its first bytes.
pub(super) fn rows(path: &Path) -> Result<u16, FrameError> {
    let dims = open(path)?.into_dimensions();
    let (_, rows) = dims.map_err(|error| FrameError::Decode(path.to_path_buf(), error.to_string()))?;
    Ok(u16::try_from(rows).unwrap_or(u16::MAX))
}

/// Refuses an image in which nothing can be matched: one value only, or more than 95 % of it black or white.
pub fn check_usable(path: &Path, image: &GrayImage) -> Result<(), FrameError> {
    let first = image.pixels.first().copied().unwrap_or(0);
    if image.pixels.iter().all(|&value| value == first) {
        return Err(FrameError::Uniform(path.to_path_buf(), first));
    }
    for end in [u8::MIN, u8::MAX] {
        let count = image.pixels.iter().filter(|&&value| value == end).count();
        let percent = 100.0 * count as f64 / image.pixels.len() as f64;
        if percent > MAX_SATURATED_PERCENT {
            return Err(FrameError::Saturated { path: path.to_path_buf(), percent, value: end });
        }
    }
    Ok(())
}

/// Both images have the same size.
pub fn check_same_size(first: (&Path, Dims), second: (&Path, Dims)) -> Result<(), FrameError> {
    if first.1 == second.1 {
        return Ok(());
    }
    Err(FrameError::SizesDiffer { first: (first.0.to_path_buf(), first.1), second: (second.0.to_path_buf(), second.1) })
}

/// Refuses an image of a size the core does not take.
pub fn check_size(path: &Path, image: &GrayImage) -> Result<(), FrameError> {
    image.view().map(|_| ()).map_err(|error| FrameError::Size(path.to_path_buf(), error))
}

fn decode(path: &Path) -> Result<DynamicImage, FrameError> {
    open(path)?.decode().map_err(|error| match error {
        image::ImageError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
            FrameError::Read(path.to_path_buf(), error)
        }
        other => FrameError::Decode(path.to_path_buf(), other.to_string()),
    })
}

fn open(path: &Path) -> Result<ImageReader<BufReader<File>>, FrameError> {
    let read_error = |error| FrameError::Read(path.to_path_buf(), error);
    ImageReader::open(path).map_err(read_error)?.with_guessed_format().map_err(read_error)
}

fn dims_of(path: &Path, image: &DynamicImage) -> Result<Dims, FrameError> {
    match (u16::try_from(image.width()), u16::try_from(image.height())) {
        (Ok(width), Ok(height)) => Ok(Dims { width, height }),
        _ => {
            let largest = Dims { width: u16::MAX, height: u16::MAX };
            Err(FrameError::Size(path.to_path_buf(), ViewError::Dims(largest)))
        }
    }
}

/// BT.601 in thousandths, rounded; for 8 or 16-bit channels alike.
fn luma([red, green, blue]: [u32; 3]) -> u16 {
    ((299 * red + 587 * green + 114 * blue + 500) / 1000) as u16
}

fn to_8_bit(value: u16) -> u8 {
    ((u32::from(value) + 128) / 257) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Luma, Rgb};

    fn load_back(image: &DynamicImage, name: &str) -> GrayImage {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        image.save(&path).unwrap();
        load_gray(&path).unwrap()
    }

    #[test]
    fn sixteen_bits_are_rounded_to_eight() {
        for value in 0..=u16::MAX {
            assert_eq!(f64::from(to_8_bit(value)), (f64::from(value) / 257.0).round(), "{value}");
        }
        let image = ImageBuffer::<Luma<u16>, _>::from_raw(3, 1, vec![0, 32_896, 65_535]).unwrap();
        for name in ["grey.png", "grey.pgm"] {
            assert_eq!(load_back(&image.clone().into(), name).pixels, [0, 128, 255], "{name}");
        }
    }

    #[test]
    fn colour_becomes_bt601_grey() {
        let image = ImageBuffer::<Rgb<u8>, _>::from_raw(3, 1, vec![255, 0, 0, 0, 255, 0, 0, 0, 255]).unwrap();
        for name in ["colour.png", "colour.ppm"] {
            assert_eq!(load_back(&image.clone().into(), name).pixels, [76, 150, 29], "{name}");
        }
    }

    #[test]
    fn nothing_to_match_is_refused() {
        let image = |pixels: Vec<u8>| GrayImage { dims: Dims { width: 100, height: 1 }, pixels };
        let path = Path::new("x.png");
        assert!(matches!(check_usable(path, &image(vec![7; 100])), Err(FrameError::Uniform(_, 7))));
        let mut white = vec![255; 96];
        white.extend([0, 1, 2, 3]);
        assert!(matches!(check_usable(path, &image(white.clone())), Err(FrameError::Saturated { value: 255, .. })));
        white[0] = 9; // 95 of 100
        assert!(check_usable(path, &image(white)).is_ok());
    }
}
