//! A dark sheet for plans and charts: shapes and pixels as they come, labels on top.

use super::text::{Align, write};
use super::{opaque, paint, shown, stroke};
use image::RgbImage;
use linestereo_frames::GrayImage;
use tiny_skia::{Color, ColorU8, FillRule, LineCap, PathBuilder, Pixmap, Stroke, Transform};

/// Colour behind everything.
pub const BACKGROUND: [u8; 3] = [16, 16, 18];
/// Colour of what is to be read.
pub const INK: [u8; 3] = [225, 225, 225];
/// Colour of what stands back.
pub const FAINT: [u8; 3] = [120, 120, 128];
/// Colour of lines of a grid.
pub const GRID: [u8; 3] = [60, 60, 66];
/// Colours of what is good, fair and poor.
pub(super) const GOOD: [u8; 3] = [70, 225, 110];
pub(super) const FAIR: [u8; 3] = [255, 225, 40];
pub(super) const POOR: [u8; 3] = [255, 45, 45];
/// Colour of what was seen or measured.
pub(super) const SEEN: [u8; 3] = [0, 200, 255];
/// Height of a text, px.
pub const TEXT: f32 = 15.0;

/// A picture in the making.
pub struct Sheet {
    pixmap: Pixmap,
    labels: Vec<Label>,
}

struct Label {
    at: (f32, f32),
    align: Align,
    rgb: [u8; 3],
    text: String,
}

impl Sheet {
    /// An empty sheet of this size, px.
    pub fn new([width, height]: [u32; 2]) -> Self {
        let mut pixmap = Pixmap::new(width.max(1), height.max(1)).expect("sides are above 0");
        let [red, green, blue] = BACKGROUND;
        pixmap.fill(Color::from_rgba8(red, green, blue, u8::MAX));
        Self { pixmap, labels: Vec::new() }
    }

    /// Writes a text at this place, above all shapes.
    pub fn label(&mut self, at: (f32, f32), align: Align, rgb: [u8; 3], text: impl Into<String>) {
        self.labels.push(Label { at, align, rgb, text: text.into() });
    }

    /// Draws a straight line of this width, px.
    pub fn line(&mut self, from: (f32, f32), to: (f32, f32), rgb: [u8; 3], width: f32) {
        let style = Stroke { width, line_cap: LineCap::Round, ..Stroke::default() };
        stroke(&mut self.pixmap, [from, to], &paint(rgb, 1.0), &style);
    }

    pub fn fill(&mut self, corners: &[(f32, f32)], rgb: [u8; 3], alpha: f32) {
        let mut path = PathBuilder::new();
        for (index, &(x, y)) in corners.iter().enumerate() {
            if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        path.close();
        if let Some(path) = path.finish() {
            self.pixmap.fill_path(
                &path,
                &paint(rgb, alpha),
                FillRule::Winding,
                Transform::identity(),
                None,
            );
        }
    }

    pub fn pixel(&mut self, [x, y]: [u32; 2], [red, green, blue]: [u8; 3]) {
        let width = self.pixmap.width();
        if x < width && y < self.pixmap.height() {
            let place = y as usize * width as usize + x as usize;
            self.pixmap.pixels_mut()[place] =
                ColorU8::from_rgba(red, green, blue, u8::MAX).premultiply();
        }
    }

    /// Copies a part of an image, each pixel as a square of this side: first column and row,
    /// columns and rows.
    pub(super) fn image(
        &mut self,
        [left, top]: [u32; 2],
        image: &GrayImage,
        part: [u32; 4],
        side: u32,
        dimmed: u8,
    ) {
        let (image, [x0, y0, width, height]) = (shown(image), part);
        for y in 0..height * side {
            for x in 0..width * side {
                let place = (y0 + y / side) * u32::from(image.dims.width) + x0 + x / side;
                self.pixel([left + x, top + y], [image.pixels[place as usize] / dimmed; 3]);
            }
        }
    }

    pub fn into_picture(self) -> RgbImage {
        let mut picture = opaque(&self.pixmap);
        for Label { at, align, rgb, text } in &self.labels {
            write(&mut picture, *at, *align, TEXT, *rgb, text);
        }
        picture
    }
}
