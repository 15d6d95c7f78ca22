//! Text on pictures.

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};
use epaint_default_fonts::HACK_REGULAR;
use image::RgbImage;

/// Where a text stands relative to its x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Align {
    /// It begins at x.
    Left,
    /// Its middle is at x.
    Centre,
    /// It ends at x.
    Right,
}

/// Writes one line of text with its upper border at `y`.
pub fn write(picture: &mut RgbImage, (x, y): (f32, f32), align: Align, height: f32, rgb: [u8; 3], text: &str) {
    let font = FontRef::try_from_slice(HACK_REGULAR).expect("the built-in font is valid");
    let scaled = font.as_scaled(PxScale::from(height));
    let start = match align {
        Align::Left => x,
        Align::Centre => x - 0.5 * width(height, text),
        Align::Right => x - width(height, text),
    };
    let mut pen = start;
    for letter in text.chars() {
        let id = font.glyph_id(letter);
        draw(picture, &font, id.with_scale_and_position(height, point(pen, y + scaled.ascent())), rgb);
        pen += scaled.h_advance(id);
    }
}

/// Width of a line of text in px.
pub fn width(height: f32, text: &str) -> f32 {
    let font = FontRef::try_from_slice(HACK_REGULAR).expect("the built-in font is valid");
    let scaled = font.as_scaled(PxScale::from(height));
    text.chars().map(|letter| scaled.h_advance(font.glyph_id(letter))).sum()
}

fn draw(picture: &mut RgbImage, font: &FontRef<'_>, glyph: Glyph, rgb: [u8; 3]) {
    let Some(outline) = font.outline_glyph(glyph) else { return };
    let bounds = outline.px_bounds();
    outline.draw(|dx, dy, cover| {
        let (x, y) = (bounds.min.x + dx as f32, bounds.min.y + dy as f32);
        if x < 0.0 || y < 0.0 {
            return;
        }
        if let Some(pixel) = picture.get_pixel_mut_checked(x as u32, y as u32) {
            for (value, ink) in pixel.0.iter_mut().zip(rgb) {
                *value = (f32::from(*value) * (1.0 - cover) + f32::from(ink) * cover) as u8;
            }
        }
    });
}
