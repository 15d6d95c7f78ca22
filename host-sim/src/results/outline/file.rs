//! Refined outlines as files: JSON that `--objects` reads back, with what belongs to each object; or a label image.

use super::{Refined, RefinedOutline};
use anyhow::Result;
use image::{ImageBuffer, ImageFormat, Luma};
use linestereo::diagnostics::Segment;
use linestereo::{Area, Dims, Region};
use linestereo_frames::regions::Object;
use serde::Serialize;
use std::io::Cursor;

/// Every object's outline and segments, in px of the left image as matched.
#[derive(Debug, Serialize)]
pub struct OutlineFile {
    width: u16,
    height: u16,
    objects: Vec<Outline>,
}

#[derive(Debug, Serialize)]
struct Outline {
    label: u16,
    name: Option<String>,
    /// `[left, top, right, bottom)`.
    #[serde(rename = "box")]
    corners: [u16; 4],
    /// `[row, first column, column after the last]` of a mask; `null` for a box.
    runs: Option<Vec<[u16; 3]>>,
    /// Both ends `[x, y]` of the segments that belong to the object.
    segments: Vec<[[f64; 2]; 2]>,
    /// Number of them that are depth edges that it owns.
    owned_edges: usize,
}

impl OutlineFile {
    /// Of objects with what they are refined to.
    pub fn new<'a>(dims: Dims, list: impl IntoIterator<Item = (&'a Object, Refined)>) -> Self {
        let objects = list.into_iter().map(|(object, refined)| Outline::new(dims, object, &refined)).collect();
        Self { width: dims.width, height: dims.height, objects }
    }
}

impl Outline {
    fn new(dims: Dims, object: &Object, refined: &Refined) -> Self {
        let (area, runs) = match &refined.outline {
            RefinedOutline::Box(area) => (*area, None),
            RefinedOutline::Mask(mask) => {
                let runs = mask.runs(object.label);
                // Erosion may leave nothing of a thin mask.
                let area = Region::masked(object.label, &runs, dims).map_or(Area::default(), |region| region.area());
                (area, Some(runs.iter().map(|run| [run.y, run.span.start, run.span.end]).collect()))
            }
        };
        let ends = |segment: &Segment| segment.ends.map(|end| [end.x.to_num(), end.y.to_num()]);
        Self {
            label: object.label,
            name: object.name.clone(),
            corners: [area.left, area.top, area.right, area.bottom],
            runs,
            segments: refined.segments.iter().map(ends).collect(),
            owned_edges: refined.owned_edges,
        }
    }
}

/// A 16-bit PNG with each object's label at its pixels, 0 elsewhere; later objects lie on top.
pub fn label_png<'a>(dims: Dims, list: impl IntoIterator<Item = (&'a Object, Refined)>) -> Result<Vec<u8>> {
    let mut image = ImageBuffer::<Luma<u16>, Vec<u16>>::new(dims.width.into(), dims.height.into());
    for (object, refined) in list {
        for (x, y, pixel) in image.enumerate_pixels_mut() {
            let (x, y) = (x as i32, y as i32);
            let belongs = match &refined.outline {
                RefinedOutline::Box(area) => area.contains(x, y),
                RefinedOutline::Mask(mask) => mask.contains(x, y),
            };
            if belongs {
                *pixel = Luma([object.label]);
            }
        }
    }
    let mut png = Vec::new();
    image.write_to(&mut Cursor::new(&mut png), ImageFormat::Png)?;
    Ok(png)
}
