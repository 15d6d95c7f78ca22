//! Maps of several methods side by side: a row per scene, or one scene in as many rows as it needs.

use image::{Rgb, RgbImage};
use linestereo_frames::GrayImage;
use linestereo_sim::draw::text::{Align, write};
use linestereo_sim::draw::{ColourRange as Range, colour};
use linestereo_sim::engine::FrameResult;

/// Titles stand in a strip of this height.
const TITLE: u32 = 20;
const TEXT: f32 = 14.0;
const GAP: u32 = 4;
const BACKGROUND: [u8; 3] = [16, 16, 18];
const INK: [u8; 3] = [225, 225, 225];
/// Largest width of the picture; images are drawn at every second, third, ... pixel to fit.
const LARGEST_WIDTH: u32 = 4096;
/// Maps in a row where only one scene is drawn.
const IN_A_ROW: usize = 4;
/// Share of its brightness that the image keeps where nothing is known.
const DIMMED: f32 = 0.35;

/// One scene: its left image, the largest disparity, and a titled map per method.
#[derive(Clone, Debug)]
pub struct SceneMaps<'a> {
    /// Name of the scene.
    pub name: &'a str,
    /// Left image.
    pub left: &'a GrayImage,
    /// Red.
    pub max_disparity: u16,
    /// Points of each method.
    pub maps: Vec<(String, FrameResult)>,
}

/// The left image and all maps of every scene.
#[must_use]
pub fn maps(scenes: &[SceneMaps<'_>]) -> RgbImage {
    let count = scenes.iter().map(|scene| scene.maps.len() + 1).max().unwrap_or(1);
    let in_a_row = if scenes.len() == 1 { count.min(IN_A_ROW) } else { count };
    let side = |of: fn(&GrayImage) -> u16| {
        scenes.iter().map(|scene| u32::from(of(scene.left))).max().unwrap_or(1)
    };
    let (width, height) = (side(|image| image.dims.width), side(|image| image.dims.height));
    let step = (in_a_row as u32 * (width + GAP)).div_ceil(LARGEST_WIDTH).max(1);
    let cell = [width.div_ceil(step) + GAP, height.div_ceil(step) + TITLE];
    let rows =
        scenes.iter().map(|scene| (scene.maps.len() + 1).div_ceil(in_a_row)).sum::<usize>().max(1);
    let mut picture =
        RgbImage::from_pixel(in_a_row as u32 * cell[0], rows as u32 * cell[1], Rgb(BACKGROUND));
    let mut row = 0;
    for scene in scenes {
        let titled = [(scene.name, None)]
            .into_iter()
            .chain(scene.maps.iter().map(|(name, map)| (name.as_str(), Some(map))));
        for (i, (title, map)) in titled.enumerate() {
            let at = [(i % in_a_row) as u32 * cell[0], (row + i / in_a_row) as u32 * cell[1]];
            write(
                &mut picture,
                (at[0] as f32 + 2.0, at[1] as f32 + 2.0),
                Align::Left,
                TEXT,
                INK,
                title,
            );
            draw(&mut picture, [at[0], at[1] + TITLE], step, scene, map);
        }
        row += (scene.maps.len() + 1).div_ceil(in_a_row);
    }
    picture
}

fn draw(
    picture: &mut RgbImage,
    at: [u32; 2],
    step: u32,
    scene: &SceneMaps<'_>,
    map: Option<&FrameResult>,
) {
    let (width, height) = (u32::from(scene.left.dims.width), u32::from(scene.left.dims.height));
    let share = if map.is_some() { DIMMED } else { 1.0 };
    for y in (0..height).step_by(step as usize) {
        for x in (0..width).step_by(step as usize) {
            let grey = (share * f32::from(scene.left.pixels[(y * width + x) as usize])) as u8;
            picture.put_pixel(at[0] + x / step, at[1] + y / step, Rgb([grey; 3]));
        }
    }
    let range = Range { far: 0.0, near: scene.max_disparity.max(1).into() };
    for point in map.iter().flat_map(|map| &map.points) {
        let (x, y) = (u32::from(point.x) / step, u32::from(point.y) / step);
        picture.put_pixel(at[0] + x, at[1] + y, Rgb(colour(&range, point.disparity.to_num())));
    }
}
