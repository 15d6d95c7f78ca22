//! Label images: the value of a pixel is the label of its object, 0 is none.

use super::{Frame, Object, Objects, ObjectsError, Pixels, reduced};
use crate::decode::load_values;
use linestereo::{Dims, image::Span, objects::Run};
use std::collections::BTreeMap;
use std::path::Path;

pub(crate) fn load(path: &Path, frame: Frame<'_>) -> Result<Objects, ObjectsError> {
    let (mask, values) = load_values(path).map_err(ObjectsError::Image)?;
    let labels = if mask == frame.given {
        reduced(&values, &frame)
    } else if mask == frame.matched {
        values
    } else {
        return Err(ObjectsError::MaskSize { path: path.to_path_buf(), mask, image: frame.given });
    };
    let mut objects = Objects::default();
    let mut by_label: BTreeMap<u16, Vec<Run>> = BTreeMap::new();
    for run in runs(&labels, frame.matched) {
        by_label.entry(run.label).or_default().push(run);
    }
    for (label, runs) in by_label {
        if objects.list.len() < super::MAX_OBJECTS {
            objects.list.push(Object { label, name: None, pixels: Pixels::Mask(runs) });
        } else {
            objects.skipped.too_many += 1;
        }
    }
    Ok(objects)
}

/// The runs of equal values other than 0, row by row.
pub(crate) fn runs<T: Copy + PartialEq + Default + Into<u16>>(
    values: &[T],
    dims: Dims,
) -> Vec<Run> {
    let mut runs = Vec::new();
    for (row, y) in values.chunks_exact(dims.width.into()).zip(0_u16..) {
        let mut start = 0;
        for same in row.chunk_by(|a, b| a == b) {
            let end = start + same.len();
            if same[0] != T::default() {
                let span = Span { start: start as u16, end: end as u16 };
                runs.push(Run { label: same[0].into(), y, span });
            }
            start = end;
        }
    }
    runs
}
