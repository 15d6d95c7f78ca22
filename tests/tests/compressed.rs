//! Compressed pictures: the steps that blank surfaces become are not believed, what has texture is.

use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageFormat, load_from_memory_with_format};
use linestereo::results::Point;
use linestereo::{Dims, Params};
use linestereo_frames::GrayImage;
use linestereo_tests::drawn::{Random, surface};
use linestereo_tests::matched;

const DIMS: Dims = Dims { width: 320, height: 240 };
/// Disparity of the wall, px: no multiple of a block of JPEG.
const WALL: f64 = 19.6;
/// First row of the part of the wall without texture.
const BLANK: u16 = 120;

/// As it comes back from a JPEG file of this quality.
fn compressed(image: &GrayImage, quality: u8) -> GrayImage {
    let (mut file, Dims { width, height }) = (Vec::new(), DIMS);
    JpegEncoder::new_with_quality(&mut file, quality)
        .encode(&image.pixels, width.into(), height.into(), ExtendedColorType::L8)
        .unwrap();
    let levels = load_from_memory_with_format(&file, ImageFormat::Jpeg).unwrap().into_luma8();
    GrayImage { pixels: levels.into_raw(), ..image.clone() }
}

/// A wall of little contrast above, and below of one grey level, in light that falls off to the
/// sides, by cameras with a noise of 1.7 grey levels.
fn wall(seed: u64) -> [GrayImage; 2] {
    let mut random = Random(seed);
    let mut pair = surface(DIMS, seed, |_| WALL, 0.0);
    for image in &mut pair {
        for (at, grey) in image.pixels.iter_mut().enumerate() {
            let (x, y) = (at % usize::from(DIMS.width), at / usize::from(DIMS.width));
            let texture = if y < usize::from(BLANK) { f64::from(*grey) / 4.0 - 32.0 } else { 0.0 };
            let off = (x as f64 - f64::from(DIMS.width) / 2.0) / f64::from(DIMS.width);
            *grey = (130.0 + texture - 60.0 * off * off + 1.7 * random.normal()).round() as u8;
        }
    }
    pair
}

#[test]
fn the_steps_of_blank_surfaces_are_not_believed() {
    for quality in [60, 40] {
        let (mut wrong, mut right) = (0, 0);
        for seed in 50..56 {
            let pair = wall(seed).map(|image| compressed(&image, quality));
            let (_, result) = matched(&Params::default(), pair.each_ref());
            let is_wrong = |point: &&Point| (point.disparity.to_num::<f64>() - WALL).abs() > 1.0;
            wrong += result.points.iter().filter(is_wrong).count();
            right += result.points.iter().filter(|point| point.y < BLANK).count();
            let [left, _] = result.pair.unwrap().noise.unwrap();
            assert!(left.noiseless_permille > 100, "JPEG {quality}: {left:?}");
        }
        // Otherwise 578 and 754 are wrong.
        assert!(wrong < 150 && right > 20_000, "JPEG {quality}: {wrong} wrong, {right} right");
    }
}

#[test]
fn a_sensor_leaves_noise_everywhere() {
    let pair = wall(60);
    let (_, result) = matched(&Params::default(), pair.each_ref());
    for noise in result.pair.unwrap().noise.unwrap() {
        assert_eq!(noise.noiseless_permille, 0, "{noise:?}");
        let levels = f64::from(noise.deviation_q4) / 16.0;
        assert!((1.4..2.0).contains(&levels), "{levels} grey levels");
    }
}
