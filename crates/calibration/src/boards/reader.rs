//! A quadrilateral in an image -> the marker in it.

use super::markers::Dictionary;
use calib_targets_aruco::{MarkerCell, Matcher, ScanDecodeConfig, decode_marker_in_cell};
use calib_targets_core::{Coord, GrayImageView};
use linestereo::Dims;
use linestereo_frames::GrayImage;

/// Resolution at which a cell is read: positions are relative to it, so that it only has to be
/// large.
const CELL_PX: f32 = 64.0;
/// Bits of a marker that may be wrong; fewer where markers of the dictionary differ less.
const WRONG_BITS: u8 = 2;

/// An image in the detectors' type.
pub(super) fn view(image: &GrayImage) -> GrayImageView<'_> {
    let Dims { width, height } = image.dims;
    GrayImageView { width: width.into(), height: height.into(), data: &image.pixels }
}

/// Reads markers of one dictionary.
pub(super) struct Reader<'a> {
    view: GrayImageView<'a>,
    matcher: Matcher,
    config: ScanDecodeConfig,
}

/// A marker that was read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Marker {
    pub(super) id: usize,
    /// Quarter turns between the quadrilateral and the upright marker.
    turns: u8,
}

impl Marker {
    /// A place of the quadrilateral on the upright marker, both from the middle.
    pub(super) fn upright(&self, place: [i32; 2]) -> [i32; 2] {
        turned(place, self.turns)
    }
}

/// A place after so many quarter turns about the middle, anticlockwise as seen.
pub(super) fn turned([x, y]: [i32; 2], turns: u8) -> [i32; 2] {
    match turns % 4 {
        0 => [x, y],
        1 => [y, -x],
        2 => [-x, -y],
        _ => [-y, x],
    }
}

impl<'a> Reader<'a> {
    /// Markers with this rim, in cells, that take this share of the side of a quadrilateral.
    pub(super) fn new(
        image: &'a GrayImage,
        dictionary: Dictionary,
        rim: usize,
        share: f64,
    ) -> Self {
        // OpenCV's count of correctable bits is 0 for AprilTags, of which any two differ in 5 bits
        // (16h5) at least.
        let dictionary = dictionary.inner();
        let wrong = if dictionary.name().contains("APRILTAG") {
            WRONG_BITS
        } else {
            dictionary.max_correction_bits()
        };
        let config = ScanDecodeConfig::default().with_border_bits(rim).with_inset_frac(0.0);
        Self {
            view: view(image),
            matcher: Matcher::new(dictionary, wrong.min(WRONG_BITS)),
            config: config.with_marker_size_rel(share as f32),
        }
    }

    /// The marker in a quadrilateral given clockwise from its upper left corner.
    pub(super) fn read(&self, corners: [[f64; 2]; 4]) -> Option<Marker> {
        let corners = corners.map(|[x, y]| [x as f32, y as f32].into());
        let cell = MarkerCell::new(Coord::new(0, 0), corners);
        let found = decode_marker_in_cell(&self.view, &cell, CELL_PX, &self.config, &self.matcher)?;
        (!found.inverted).then_some(Marker { id: found.id as usize, turns: found.rotation })
    }
}
