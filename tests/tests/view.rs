//! Grey views: what is accepted, and that rows are exactly the rows.

use linestereo::image::{MAX_HEIGHT, MAX_WIDTH, MIN_SIDE, ViewError};
use linestereo::{Dims, Gray};
use linestereo_tests::drawn::{Random, painted, with_padding};

#[test]
fn rows_are_the_same_with_every_padding() {
    let mut random = Random(1);
    for (width, height) in [(16, 16), (17, 20), (33, 16)] {
        let image = painted(width, height, |_, _| random.grey());
        for padding in 0..=usize::from(width) + 1 {
            let (bytes, stride) = with_padding(&image, padding, 0xaa);
            let last_row_ends_the_slice = &bytes[..bytes.len() - padding];
            let view = Gray::new(last_row_ends_the_slice, image.dims, stride).unwrap();
            assert_eq!(view.dims(), image.dims);
            for (y, row) in image.pixels.chunks(usize::from(width)).enumerate() {
                assert_eq!(view.row(y), Some(row), "{width}x{height}, padding {padding}, row {y}");
            }
            for below in
                [usize::from(height), usize::from(height) + 1, usize::MAX / stride, usize::MAX]
            {
                assert_eq!(view.row(below), None);
            }
        }
    }
}

#[test]
fn sizes_outside_the_limits_are_refused() {
    let bytes = vec![0; 1281 * 1281];
    let edges = [MIN_SIDE, MAX_WIDTH].into_iter().flat_map(|side| side - 1..=side + 1);
    let edges: Vec<u16> = edges.chain([0, 1, u16::MAX]).collect();
    for &width in &edges {
        for &height in &edges {
            let allowed = (MIN_SIDE..=MAX_WIDTH).contains(&width)
                && (MIN_SIDE..=MAX_HEIGHT).contains(&height);
            let dims = Dims { width, height };
            let found = Gray::new(&bytes, dims, width.into()).map(Gray::dims);
            assert_eq!(found, if allowed { Ok(dims) } else { Err(ViewError::Dims(dims)) });
        }
    }
}

#[test]
fn short_strides_and_slices_are_refused() {
    let bytes = [0; 40 * 16];
    let dims = Dims { width: 32, height: 16 };
    for stride in [0, 1, 31] {
        let error = Gray::new(&bytes, dims, stride).unwrap_err();
        assert_eq!(error, ViewError::Stride { stride, width: 32 });
    }
    for (stride, needed) in [(32, 512), (40, 632)] {
        assert!(Gray::new(&bytes[..needed], dims, stride).is_ok());
        for given in [0, 1, needed - 1] {
            let error = Gray::new(&bytes[..given], dims, stride).unwrap_err();
            assert_eq!(error, ViewError::TooShort { needed, given });
        }
    }
    // Rows so far apart that the size of the image overflows.
    for stride in [usize::MAX / 15, usize::MAX / 2, usize::MAX] {
        let error = Gray::new(&bytes, dims, stride).unwrap_err();
        assert!(matches!(error, ViewError::TooShort { .. }), "{stride}: {error}");
    }
}

#[test]
fn errors_say_what_is_wrong() {
    for (side, stride, given, says) in [
        (1, 1, 0, "an image of 1x1 is outside 16x16 to 1280x1280"),
        (16, 15, 256, "a stride of 15 is shorter than a row of 16"),
        (16, 16, 255, "the image needs 256 bytes, 255 were given"),
    ] {
        let dims = Dims { width: side, height: side };
        assert_eq!(Gray::new(&vec![0; given], dims, stride).unwrap_err().to_string(), says);
    }
}
