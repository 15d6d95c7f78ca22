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
    let try_size = |width, height| {
        let dims = Dims { width, height };
        Gray::new(&bytes, dims, usize::from(width)).map(Gray::dims).map_err(|error| (error, dims))
    };
    let edges = [
        0,
        1,
        MIN_SIDE - 1,
        MIN_SIDE,
        MIN_SIDE + 1,
        MAX_WIDTH - 1,
        MAX_WIDTH,
        MAX_WIDTH + 1,
        u16::MAX,
    ];
    for width in edges {
        for height in edges {
            let allowed = (MIN_SIDE..=MAX_WIDTH).contains(&width)
                && (MIN_SIDE..=MAX_HEIGHT).contains(&height);
            match try_size(width, height) {
                Ok(dims) => {
                    assert!(allowed && dims == Dims { width, height }, "{dims} was accepted")
                }
                Err((error, dims)) => {
                    assert!(!allowed && error == ViewError::Dims(dims), "{dims}: {error}")
                }
            }
        }
    }
}

#[test]
fn strides_shorter_than_a_row_are_refused() {
    let bytes = [0; 32 * 16];
    let dims = Dims { width: 32, height: 16 };
    for stride in [0, 1, 31] {
        assert_eq!(
            Gray::new(&bytes, dims, stride).unwrap_err(),
            ViewError::Stride { stride, width: 32 }
        );
    }
    assert!(Gray::new(&bytes, dims, 32).is_ok());
}

#[test]
fn slices_that_end_early_are_refused() {
    let bytes = [0; 40 * 16];
    let dims = Dims { width: 32, height: 16 };
    for (stride, needed) in [(32, 512), (40, 632)] {
        assert!(Gray::new(&bytes[..needed], dims, stride).is_ok());
        for given in [0, 1, needed - 1] {
            let expected = ViewError::TooShort { needed, given };
            assert_eq!(Gray::new(&bytes[..given], dims, stride).unwrap_err(), expected);
        }
    }
    // Rows so far apart that the size of the image overflows.
    for stride in [usize::MAX / 15, usize::MAX / 2, usize::MAX] {
        assert!(
            matches!(Gray::new(&bytes, dims, stride), Err(ViewError::TooShort { .. })),
            "{stride}"
        );
    }
}

#[test]
fn errors_say_what_is_wrong() {
    let say = |bytes: &[u8], width, height, stride| {
        Gray::new(bytes, Dims { width, height }, stride).unwrap_err().to_string()
    };
    assert_eq!(say(&[], 1, 1, 1), "an image of 1x1 is outside 16x16 to 1280x1280");
    assert_eq!(say(&[0; 256], 16, 16, 15), "a stride of 15 is shorter than a row of 16");
    assert_eq!(say(&[0; 255], 16, 16, 16), "the image needs 256 bytes, 255 were given");
}
