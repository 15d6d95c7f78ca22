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
pub fn write(
    picture: &mut RgbImage,
    (x, y): (f32, f32),
    align: Align,
    height: f32,
    rgb: [u8; 3],
    text: &str,
) {
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
        draw(
            picture,
            &font,
            id.with_scale_and_position(height, point(pen, y + scaled.ascent())),
            rgb,
        );
        pen += scaled.h_advance(id);
    }
}

/// Width of a line of text in px.
pub fn width(height: f32, text: &str) -> f32 {
    let font = FontRef::try_from_slice(HACK_REGULAR).expect("the built-in font is valid");
    let scaled = font.as_scaled(PxScale::from(height));
    text.chars().map(|letter| scaled.h_advance(font.glyph_id(letter))).sum()
}

/// A line in pieces of at most this width in px, cut between words; the second piece and those
/// behind it are indented by four more spaces.
pub fn wrapped(line: &str, height: f32, most: f32) -> Vec<String> {
    let indent = &line[..line.len() - line.trim_start().len()];
    let (mut lines, mut now) = (Vec::new(), indent.to_owned());
    let mut is_empty = true;
    // Columns within a line stay where they are.
    for word in line.trim_start().split_inclusive(' ') {
        if !is_empty && width(height, &format!("{now}{}", word.trim_end())) > most {
            lines.push(core::mem::replace(&mut now, format!("{indent}    ")));
        }
        now.push_str(word);
        is_empty = false;
    }
    lines.push(now);
    lines
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_between_words_and_nothing_is_lost() {
        let line =
            "  depths are 3.1 % too far at 2 m, as 0.43 px of disparity too little would make them";
        let most = width(15.0, "twenty-eight letters, no more");
        let found = wrapped(line, 15.0, most);
        assert!(
            found.len() > 3 && found.iter().all(|part| width(15.0, part.trim_end()) <= most),
            "{found:?}"
        );
        assert!(found[0].starts_with("  depths") && found[1].starts_with("      "), "{found:?}");
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(words(&found.join(" ")), words(line));
        assert_eq!(wrapped("short  line", 15.0, most), ["short  line"]);
        assert_eq!(wrapped("", 15.0, most), [""]);
        assert_eq!(wrapped("averylongwordthatfitsnowhereatall", 15.0, 10.0).len(), 1);
    }
}
