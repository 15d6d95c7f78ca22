//! Image files to 8-bit grey.
//!
//! In: PNG, JPEG, PGM, PPM, TIFF, BMP or WebP, 8 or 16 bit, grey or colour, turned as EXIF says.
//! Out: [`GrayImage`], or the raw values of a ground-truth file. Transparency is ignored. Both
//! images of a pair have one scale: [`load_images`].
//!
//! # Bounds
//! A header of more than [`PIXELS`] or [`IMAGE_BYTES`] is all that is read of a file.

use super::error::FrameError;
use super::grey::{StoredGray, Values, luma};
use super::resample::halves;
use super::sequence::PairFiles;
use super::source::Views;
use crate::grey::GrayImage;
use crate::untrusted::{self, IMAGE_BYTES, PIXELS};
use image::error::{LimitError, LimitErrorKind};
use image::metadata::Orientation;
use image::{
    DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, ImageResult, Limits, Pixel,
};
use linestereo::Dims;
use linestereo::image::ViewError;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, ErrorKind, Seek};
use std::path::Path;

/// Largest share of pixels, in percent, at one end of the scale that leaves anything to match.
const MAX_SATURATED_PERCENT: f64 = 95.0;
/// Markers of a JPEG.
const END_OF_IMAGE: u8 = 0xd9;
const TEMPORARY: u8 = 0x01;

/// Reads an image file as 8-bit grey. The core's limits of size do not apply yet.
pub fn load_gray(path: &Path) -> Result<GrayImage, FrameError> {
    let stored = StoredGray::load(path)?;
    let bits = stored.bits();
    Ok(stored.into_8_bit(bits))
}

/// How EXIF turns an image, in words; the image comes turned.
pub fn exif_turn(path: &Path) -> Result<&'static str, FrameError> {
    let turn = decoded(path, reader(path)?, |mut decoder| decoder.orientation())?;
    Ok(match turn {
        Orientation::NoTransforms => UPRIGHT,
        Orientation::Rotate90 => "by 90 degrees",
        Orientation::Rotate180 => "by 180 degrees",
        Orientation::Rotate270 => "by 270 degrees",
        Orientation::FlipHorizontal
        | Orientation::FlipVertical
        | Orientation::Rotate90FlipH
        | Orientation::Rotate270FlipH => "into its mirror image",
    })
}

/// [`exif_turn`] of an image that EXIF leaves as it is.
pub const UPRIGHT: &str = "not at all";

/// Reads both images of a pair: 16-bit ones with one scale, that of `bits` or of the largest value
/// in both.
pub fn load_images(files: &PairFiles, bits: Option<u32>) -> Result<[GrayImage; 2], FrameError> {
    match files {
        PairFiles::Two([left, right]) => {
            let [of_left, of_right] = [exif_turn(left)?, exif_turn(right)?];
            if of_left != of_right {
                return Err(FrameError::Turned(left.clone(), of_left, right.clone(), of_right));
            }
            on_one_scale([StoredGray::load(left)?, StoredGray::load(right)?], files, bits)
        }
        PairFiles::SideBySide(both) => split(StoredGray::load(both)?, files, bits),
        PairFiles::Source(pair) => match pair.grey()? {
            Views::Two(stored) => on_one_scale(stored, files, bits),
            Views::Both(both) => split(both, files, bits),
        },
    }
}

fn on_one_scale(
    stored: [StoredGray; 2],
    files: &PairFiles,
    bits: Option<u32>,
) -> Result<[GrayImage; 2], FrameError> {
    for (stored, path) in stored.iter().zip(files.paths()) {
        check_bits(stored, path, bits)?;
    }
    let bits = bits.unwrap_or_else(|| stored[0].bits().max(stored[1].bits()));
    Ok(stored.map(|stored| stored.into_8_bit(bits)))
}

fn split(
    both: StoredGray,
    files: &PairFiles,
    bits: Option<u32>,
) -> Result<[GrayImage; 2], FrameError> {
    check_bits(&both, files.paths()[0], bits)?;
    let bits = bits.unwrap_or_else(|| both.bits());
    Ok(halves(&both.into_8_bit(bits)))
}

/// A sensor of so many bits has no larger values.
fn check_bits(stored: &StoredGray, path: &Path, bits: Option<u32>) -> Result<(), FrameError> {
    let largest = stored.largest();
    let needed = largest.checked_ilog2().map_or(1, |bit| bit + 1);
    match bits.filter(|&given| needed > given) {
        Some(given) => Err(FrameError::Bits { path: path.to_path_buf(), largest, needed, given }),
        None => Ok(()),
    }
}

/// Bytes of a pixel.
#[derive(Clone, Copy, Debug)]
pub enum PixelBytes {
    /// One.
    Grey,
    /// Two, one of them luma.
    Luma {
        /// Its place, 0 or 1.
        at: usize,
    },
    /// Two, in the order of this function.
    Grey16(fn([u8; 2]) -> u16),
    /// So many; two are at these places, green between them.
    Colour {
        /// Place of red.
        red: usize,
        /// Place of blue.
        blue: usize,
        /// Bytes of a pixel.
        bytes: usize,
    },
}

impl PixelBytes {
    /// Their number.
    #[must_use]
    pub fn bytes(self) -> usize {
        match self {
            Self::Grey => 1,
            Self::Grey16(_) | Self::Luma { .. } => 2,
            Self::Colour { bytes, .. } => bytes,
        }
    }
}

impl StoredGray {
    fn load(path: &Path) -> Result<Self, FrameError> {
        let image = decode(path)?;
        Ok(Self::of_image(dims_of(path, &image)?, image))
    }

    /// A JPEG or PNG in a recording, of at most so many bytes when decoded.
    ///
    /// # Errors
    /// The fault, and what to do.
    pub fn of_file(bytes: &[u8], most: u64) -> Result<Self, String> {
        let format = image::guess_format(bytes).ok();
        if !matches!(format, Some(ImageFormat::Jpeg | ImageFormat::Png)) {
            return Err("it is neither JPEG nor PNG; record one of them, or raw images".to_owned());
        }
        if format == Some(ImageFormat::Jpeg) && !is_whole_jpeg(bytes) {
            return Err("a JPEG that ends too early; record it again".to_owned());
        }
        let mut reader = ImageReader::new(Cursor::new(bytes));
        format.into_iter().for_each(|format| reader.set_format(format));
        reader.limits(limits(most));
        let image = guarded(reader, most, upright).ok_or("its decoder failed; record it again")?;
        let image = image.map_err(|error| {
            format!("it cannot be decoded ({error}); record it again, or smaller")
        })?;
        let dims = [image.width(), image.height()].map(u16::try_from);
        let [Ok(width), Ok(height)] = dims else {
            return Err("it has a side of more than 65535 px".to_owned());
        };
        Ok(Self::of_image(Dims { width, height }, image))
    }

    /// Rows of pixels in a recording, each of the whole width.
    ///
    /// # Errors
    /// A side is longer than 65535 px.
    pub fn of_rows<'a>(
        sides: [u32; 2],
        layout: PixelBytes,
        rows: impl Iterator<Item = &'a [u8]>,
    ) -> Result<Self, String> {
        let [Ok(width), Ok(height)] = sides.map(u16::try_from) else {
            return Err("it has a side of more than 65535 px".to_owned());
        };
        let values = match layout {
            PixelBytes::Grey => Values::Eight(rows.flatten().copied().collect()),
            PixelBytes::Luma { at } => Values::Eight(
                rows.flat_map(|row| row.as_chunks::<2>().0).map(|pixel| pixel[at.min(1)]).collect(),
            ),
            PixelBytes::Grey16(value) => Values::Sixteen(
                rows.flat_map(|row| row.as_chunks().0).map(|bytes| value(*bytes)).collect(),
            ),
            PixelBytes::Colour { red, blue, bytes } => {
                let grey =
                    |pixel: &[u8]| luma([pixel[red], pixel[1], pixel[blue]].map(u32::from)) as u8;
                Values::Eight(rows.flat_map(|row| row.chunks_exact(bytes).map(grey)).collect())
            }
        };
        Ok(Self { dims: Dims { width, height }, values })
    }

    fn of_image(dims: Dims, image: DynamicImage) -> Self {
        // From each layout at once: an image in between would double the memory.
        let values = match image {
            DynamicImage::ImageLuma8(image) => Values::Eight(image.into_raw()),
            DynamicImage::ImageLumaA8(image) => eight(image.pixels()),
            DynamicImage::ImageRgb8(image) => eight(image.pixels()),
            DynamicImage::ImageRgba8(image) => eight(image.pixels()),
            DynamicImage::ImageLuma16(image) => Values::Sixteen(image.into_raw()),
            DynamicImage::ImageLumaA16(image) => sixteen(image.pixels()),
            DynamicImage::ImageRgb16(image) => sixteen(image.pixels()),
            DynamicImage::ImageRgba16(image) => sixteen(image.pixels()),
            other => eight(other.into_rgb8().pixels()),
        };
        Self { dims, values }
    }
}

/// Reads a file of plain numbers (disparities, masks): grey values as stored, 8 or 16 bit.
pub fn load_values(path: &Path) -> Result<(Dims, Vec<u16>), FrameError> {
    let image = decode(path)?;
    let dims = dims_of(path, &image)?;
    let values = match image.color() {
        image::ColorType::L16 => image.into_luma16().into_raw(),
        image::ColorType::L8 => image.into_luma8().into_raw().into_iter().map(u16::from).collect(),
        // Grey stored as a palette, as three equal channels or with transparency.
        color => {
            let step = match color.bytes_per_pixel() / color.channel_count() {
                1 => 257, // of 8 bits as 16
                2 => 1,
                _ => return Err(FrameError::NoTruth(path.to_path_buf())),
            };
            let rgb = image.into_rgb16();
            if rgb.pixels().any(|pixel| pixel.0 != [pixel.0[0]; 3]) {
                return Err(FrameError::NoTruth(path.to_path_buf()));
            }
            rgb.pixels().map(|pixel| pixel.0[0] / step).collect()
        }
    };
    Ok((dims, values))
}

/// An image has 16 bits a value.
pub(crate) fn is_16_bit(path: &Path) -> Result<bool, FrameError> {
    let color = decoded(path, reader(path)?, |decoder| Ok(decoder.color_type()))?;
    Ok(color.bytes_per_pixel() / color.channel_count() == 2)
}

/// Width and height of an image, by its first bytes; no observer hears of it.
pub(crate) fn dimensions(path: &Path) -> Result<(u32, u32), FrameError> {
    decoded(path, reader_of(path, untrusted::glance)?, |decoder| Ok(decoder.dimensions()))
}

/// Refuses an image in which nothing can be matched: one value only, or more than 95 % of it black
/// or white.
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
    Err(FrameError::SizesDiffer {
        first: (first.0.to_path_buf(), first.1),
        second: (second.0.to_path_buf(), second.1),
    })
}

/// Refuses an image of a size the core does not take.
pub fn check_size(path: &Path, image: &GrayImage) -> Result<(), FrameError> {
    image.view().map(|_| ()).map_err(|error| FrameError::Size(path.to_path_buf(), error))
}

fn decode(path: &Path) -> Result<DynamicImage, FrameError> {
    let reader = reader(path)?;
    if reader.format() == Some(ImageFormat::Jpeg) {
        let bytes = untrusted::read(path, IMAGE_BYTES)
            .map_err(|error| FrameError::Read(path.to_path_buf(), error))?;
        if !is_whole_jpeg(&bytes) {
            return Err(FrameError::Decode(
                path.to_path_buf(),
                "a JPEG that ends too early".to_owned(),
            ));
        }
    }
    decoded(path, reader, upright)
}

/// The image, turned as EXIF says.
fn upright(mut decoder: Box<dyn ImageDecoder + '_>) -> ImageResult<DynamicImage> {
    let orientation = decoder.orientation()?;
    let mut image = DynamicImage::from_decoder(decoder)?;
    image.apply_orientation(orientation);
    Ok(image)
}

type Reader = ImageReader<BufReader<File>>;

fn reader(path: &Path) -> Result<Reader, FrameError> {
    reader_of(path, untrusted::open)
}

fn reader_of(
    path: &Path,
    open: fn(&Path, u64) -> io::Result<BufReader<File>>,
) -> Result<Reader, FrameError> {
    let read_error = |error| FrameError::Read(path.to_path_buf(), error);
    let mut reader = ImageReader::new(open(path, IMAGE_BYTES).map_err(read_error)?);
    if let Ok(format) = ImageFormat::from_path(path) {
        reader.set_format(format);
    }
    reader.limits(limits(IMAGE_BYTES));
    reader.with_guessed_format().map_err(read_error)
}

fn limits(bytes: u64) -> Limits {
    let mut limits = Limits::default();
    limits.max_alloc = Some(bytes);
    limits
}

/// Result of `work` on a file's decoder, once its header is within the limits.
fn decoded<T>(
    path: &Path,
    reader: Reader,
    work: impl FnOnce(Box<dyn ImageDecoder + '_>) -> ImageResult<T>,
) -> Result<T, FrameError> {
    let broken = |what: &str| FrameError::Decode(path.to_path_buf(), what.to_owned());
    let decoded = guarded(reader, IMAGE_BYTES, work);
    decoded.ok_or_else(|| broken("its decoder failed"))?.map_err(|error| match error {
        ImageError::IoError(error) if error.kind() != ErrorKind::UnexpectedEof => {
            FrameError::Read(path.to_path_buf(), error)
        }
        ImageError::Limits(_) => FrameError::TooLarge(path.to_path_buf()),
        other => broken(&other.to_string()),
    })
}

/// The same of what is decoded from anywhere; `None` where the decoder fails.
fn guarded<R: BufRead + Seek, T>(
    reader: ImageReader<R>,
    most: u64,
    work: impl FnOnce(Box<dyn ImageDecoder + '_>) -> ImageResult<T>,
) -> Option<ImageResult<T>> {
    untrusted::guarded(|| {
        let decoder = reader.into_decoder()?;
        check_limits(&decoder, most)?;
        work(Box::new(decoder))
    })
}

fn check_limits(decoder: &impl ImageDecoder, most: u64) -> ImageResult<()> {
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > PIXELS || decoder.total_bytes() > most {
        return Err(ImageError::Limits(LimitError::from_kind(LimitErrorKind::DimensionError)));
    }
    Ok(())
}

/// The end marker stands where it has to; decoders fill up with grey what is missing.
fn is_whole_jpeg(bytes: &[u8]) -> bool {
    let mut at = 2; // behind the start marker
    loop {
        // Up to the next marker: over fill bytes, and over the coded values behind a start of scan.
        let Some(next) = bytes.get(at..).and_then(|rest| rest.windows(2).position(is_marker))
        else {
            return false;
        };
        at += next + 2;
        match bytes[at - 1] {
            END_OF_IMAGE => return true,
            TEMPORARY => {}
            _ => match bytes.get(at..at + 2) {
                Some(length) => at += usize::from(u16::from_be_bytes([length[0], length[1]])),
                None => return false,
            },
        }
    }
}

/// A marker that ends coded values: neither a stuffed byte nor a restart.
fn is_marker(pair: &[u8]) -> bool {
    pair[0] == 0xff && !matches!(pair[1], 0 | 0xd0..=0xd7 | 0xff)
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

/// Grey of pixels, whatever stands behind their colours.
fn eight<'a, P: Pixel<Subpixel = u8> + 'a>(pixels: impl Iterator<Item = &'a P>) -> Values {
    Values::Eight(pixels.map(|pixel| luma(pixel.to_rgb().0.map(u32::from)) as u8).collect())
}

fn sixteen<'a, P: Pixel<Subpixel = u16> + 'a>(pixels: impl Iterator<Item = &'a P>) -> Values {
    Values::Sixteen(pixels.map(|pixel| luma(pixel.to_rgb().0.map(u32::from))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn colour_becomes_bt601_grey() {
        let image = image::RgbImage::from_raw(3, 1, vec![255, 0, 0, 0, 255, 0, 0, 0, 255]).unwrap();
        let folder = tempfile::tempdir().unwrap();
        for name in ["colour.png", "colour.ppm"] {
            let path = folder.path().join(name);
            image.save(&path).unwrap();
            assert_eq!(load_gray(&path).unwrap().pixels, [76, 150, 29], "{name}");
        }
    }

    #[test]
    fn values_keep_their_16_bits_in_every_layout() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("truth.png");
        let read = |image: DynamicImage| {
            image.save(&path).unwrap();
            load_values(&path).map(|(_, values)| values).map_err(|error| error.to_string())
        };
        let values = [0_u16, 1, 255, 256, 12_345, 65_535];
        let wide = image::ImageBuffer::from_fn(6, 1, |x, _| image::Luma([values[x as usize]]));
        let wide = DynamicImage::ImageLuma16(wide);
        for image in [
            DynamicImage::from(wide.to_luma_alpha16()),
            wide.to_rgb16().into(),
            wide.to_rgba16().into(),
            wide,
        ] {
            assert_eq!(read(image), Ok(values.to_vec()));
        }
        let narrow = image::GrayImage::from_raw(3, 1, vec![0, 7, 255]).unwrap();
        let narrow = DynamicImage::ImageLuma8(narrow);
        assert_eq!(read(narrow.to_rgba8().into()), Ok(vec![0, 7, 255]));
        let coloured = image::RgbImage::from_raw(1, 1, vec![1, 2, 3]).unwrap();
        assert!(read(coloured.into()).unwrap_err().contains("is coloured or holds floats"));
    }

    #[test]
    fn nothing_to_match_is_refused() {
        let image = |pixels: Vec<u8>| GrayImage { dims: Dims { width: 100, height: 1 }, pixels };
        let path = Path::new("x.png");
        assert!(matches!(check_usable(path, &image(vec![7; 100])), Err(FrameError::Uniform(_, 7))));
        let mut white = vec![255; 96];
        white.extend([0, 1, 2, 3]);
        assert!(matches!(
            check_usable(path, &image(white.clone())),
            Err(FrameError::Saturated { value: 255, .. })
        ));
        white[0] = 9; // 95 of 100
        assert!(check_usable(path, &image(white)).is_ok());
    }
}
