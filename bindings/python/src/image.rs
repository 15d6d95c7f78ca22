//! Arrays of Python as grey images. Pixels are copied, 10 us for QVGA: another thread may write to
//! the array while the pair is matched.

use linestereo::{Dims, Gray, image::Span};
use linestereo_frames::GrayImage;
use numpy::{PyReadonlyArray2, PyUntypedArray, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// An array of shape (rows, columns) and dtype uint8, with any strides.
pub(crate) fn grey(array: &Bound<'_, PyAny>, name: &str) -> PyResult<GrayImage> {
    let Ok(pixels) = array.extract::<PyReadonlyArray2<'_, u8>>() else {
        return Err(refusal(array, name));
    };
    let view = pixels.as_array();
    let (height, width) = view.dim();
    let side = |side: usize| u16::try_from(side).unwrap_or(u16::MAX);
    let dims = Dims { width: side(width), height: side(height) };
    let mut pixels = Vec::with_capacity(width * height);
    for row in view.rows() {
        match row.to_slice() {
            Some(row) => pixels.extend_from_slice(row),
            None => pixels.extend(row),
        }
    }
    // Checked here, where the name is known.
    Gray::new(&pixels, dims, dims.width.into())
        .map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?;
    Ok(GrayImage { dims, pixels })
}

/// Why an array is no image, and what to do.
fn refusal(array: &Bound<'_, PyAny>, name: &str) -> PyErr {
    let Ok(array) = array.cast::<PyUntypedArray>() else {
        return PyValueError::new_err(format!("{name} is no numpy array"));
    };
    let (shape, kind) = (array.shape(), array.dtype().to_string());
    PyValueError::new_err(if array.ndim() == 3 {
        format!(
            "{name} has shape {shape:?}: give grey of shape (rows, columns), as by cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)"
        )
    } else if array.ndim() != 2 {
        format!("{name} has shape {shape:?}: give grey of shape (rows, columns)")
    } else {
        format!("{name} has dtype {kind}: give uint8, 0 to 255{}", conversion(&kind))
    })
}

/// How an array of this type becomes one of bytes.
fn conversion(kind: &str) -> &'static str {
    if kind.starts_with("float") {
        "; (255 * image).round().astype(numpy.uint8) where 1.0 is white, image.round().astype(numpy.uint8) where 255 is"
    } else if kind == "bool" {
        "; (255 * image).astype(numpy.uint8) makes it of a mask"
    } else if kind.contains("int16") {
        "; (image >> 8).astype(numpy.uint8) makes it of 16 bits, (image >> 2) of 10"
    } else {
        ""
    }
}

/// The core's view of an image, and of its valid pixels where they are not all.
pub(crate) fn view<'a>(image: &'a GrayImage, valid: &'a [Span]) -> PyResult<Gray<'a>> {
    let view =
        Gray::new(&image.pixels, image.dims, image.dims.width.into()).map_err(crate::refused)?;
    if valid.is_empty() { Ok(view) } else { view.with_valid(valid).map_err(crate::refused) }
}
