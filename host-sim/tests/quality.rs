//! Depth quality on walls that are known: drawn ones through the command, planes with known errors
//! through its arithmetic.

use crate::support::{Folder, all_refused, json, tells};
use linestereo::results::{Point, Source};
use linestereo::units::{Confidence, Disparity};
use linestereo::{Area, Dims, Rig};
use linestereo_sim::quality::{Wall, WallFigures};
use linestereo_sim::scene::{self, Pair, Pattern, Scene, Sensor, Surface, Texture};
use linestereo_sim::scene_folder;
use serde_json::Value;
use std::fs;
use std::path::Path;

const DIMS: Dims = Dims { width: 320, height: 240 };
const DISTANCE: f64 = 1.5;

/// A folder with pairs of a wall, turned about the vertical axis by an angle of this tangent, whose
/// middle is 1.5 m away.
fn wall(tangent: f64, texture: Texture, pairs: u64) -> Folder {
    let folder = Folder::new();
    let pair = Pair::centred(DIMS, 288.0, 0.12);
    let across = [8.0, 0.0, 8.0 * tangent];
    let corner = [-4.0, -3.0, DISTANCE - 4.0 * tangent];
    let surfaces = vec![Surface::rectangle(corner, across, [0.0, 6.0, 0.0], texture, 1)];
    let scene = Scene { pair, surfaces, objects: vec!["wall"] };
    for number in 1..=pairs {
        let sensor = Sensor { noise: 1.5, seed: number, ..Sensor::default() };
        let rendering = scene::render(&scene, DIMS, &sensor);
        for (name, contents) in scene_folder::files("wall", &pair, &rendering).unwrap() {
            let name = match name {
                "left.png" | "right.png" => format!("{number:04}_{name}"),
                "scene.json" => name.to_owned(),
                _ => continue,
            };
            fs::write(folder.path().join(name), contents).unwrap();
        }
    }
    folder
}

fn textured() -> Texture {
    Texture::grained(Pattern::Mosaic { greys: [60.0, 200.0], cell: [0.12, 0.09] }, 25.0, 0.02, 5)
}

fn measure(folder: &Path, more: &str) -> Value {
    json(folder, &format!("quality . --json - {more}"))
}

#[track_caller]
fn assert_near(value: &Value, expected: f64, tolerance: f64) {
    let number = value.as_f64().unwrap_or_else(|| panic!("{value} is no number"));
    assert!((number - expected).abs() <= tolerance, "{number} is not {expected} +- {tolerance}");
}

#[test]
fn a_wall_that_faces_the_cameras_is_good() {
    let folder = wall(0.0, textured(), 4);
    let found = measure(folder.path(), "--distance 1.5");
    assert_eq!(
        (found["pairs"].as_u64(), &found["verdict"]),
        (Some(4), &Value::from("good")),
        "{found}"
    );
    assert_eq!(found["region"], serde_json::json!([96, 72, 128, 96]));
    assert_near(&found["z_accuracy"], 0.0, 0.003);
    assert_near(&found["distance_m"], DISTANCE, 0.005);
    assert_near(&found["tilt_deg"], 0.5, 0.5);
    assert_near(&found["fill_rate"], 0.97, 0.035);
    // Noise is there, and below the limits of "good".
    assert_near(&found["sub_pixel_rms_px"], 0.11, 0.09);
    assert_near(&found["temporal_noise_px"], 0.07, 0.06);
    let words =
        ["Z accuracy", "plane-fit RMS", "temporal noise", "verdict: good", "wrote wall.png"];
    tells(folder.path(), "quality . --distance 1.5 --picture wall.png", &words);
    assert!(image::open(folder.path().join("wall.png")).unwrap().width() > 900);
}

#[test]
fn a_wall_that_is_turned_keeps_its_figures() {
    let folder = wall(0.5, textured(), 1);
    let found = measure(folder.path(), "--distance 1.5");
    assert_near(&found["tilt_deg"], 0.5_f64.atan().to_degrees(), 1.5);
    assert_near(&found["z_accuracy"], 0.0, 0.006);
    assert_near(&found["sub_pixel_rms_px"], 0.13, 0.12);
    assert!(found["temporal_noise_px"].is_null(), "one pair says nothing of it");
}

#[test]
fn a_wrong_distance_is_told_as_disparity() {
    let folder = wall(0.0, textured(), 1);
    let found = measure(folder.path(), "--distance 1.6");
    assert_near(&found["z_accuracy"], 1.5 / 1.6 - 1.0, 0.004);
    assert_near(&found["disparity_error_px"], 288.0 * 0.12 * (1.0 / 1.6 - 1.0 / 1.5), 0.08);
    assert_eq!(found["verdict"], "poor");
    let words = ["too near at 1.6 m", "px of disparity too much"];
    tells(folder.path(), "quality . --distance 1.6", &words);
}

#[test]
fn a_blank_wall_is_poor_and_says_what_it_lacks() {
    let folder = wall(0.0, Texture::plain(Pattern::Blank(150.0)), 1);
    let found = measure(folder.path(), "--distance 1.5");
    assert_eq!(found["verdict"], "poor");
    assert!(found["fill_rate"].as_f64().unwrap() < 0.2, "{found}");
    assert!(found["advice"][0].as_str().unwrap().contains("more texture"), "{found}");
}

#[test]
fn without_a_rig_pixels_are_all_that_is_said() {
    let folder = wall(0.0, textured(), 1);
    fs::remove_file(folder.path().join("scene.json")).unwrap();
    let found = measure(folder.path(), "--region 100,80,120,80");
    assert!(found["distance_m"].is_null() && found["plane_fit_rms_m"].is_null(), "{found}");
    assert!(found["sub_pixel_rms_px"].is_f64());
    let cases: [(&str, &str); 4] = [
        ("quality . --distance 1.5", "--distance needs depths"),
        ("quality . --region 300,0,40,40", "does not lie in the left image"),
        ("quality . --region 0,0,16,16", "less than 32 px"),
        ("quality nowhere", "is no folder"),
    ];
    all_refused(folder.path(), &cases);
}

/// A point on d = 20 + x / 32 with an error.
fn point(x: u16, y: u16, error: f64) -> Point {
    let disparity = Disparity::from_num(20.0 + f64::from(x) / 32.0 + error);
    Point { x, y, disparity, confidence: Confidence::from_num(0.95), source: Source::Support }
}

#[test]
fn figures_are_those_of_the_definitions() {
    let region = Area { left: 64, top: 64, right: 224, bottom: 144 };
    let rig = Rig::new(288.0, 0.12, 0.0).unwrap().centred(DIMS);
    let wall = Wall { region, rig: Some(&rig), distance_m: None };
    // 20 by 10 cells; each answer 0.25 px off, this way and that; two are wrong, and ten are
    // missing.
    let grid = || (0..200_u16).map(|i| (68 + 8 * (i % 20), 68 + 8 * (i / 20)));
    let pair = |sign: f64| -> Vec<Point> {
        let off =
            |(x, y): (u16, u16)| if (x / 8 + y / 8) % 2 == 0 { 0.25 * sign } else { -0.25 * sign };
        grid()
            .skip(10)
            .zip(0..)
            .map(|(at, i)| point(at.0, at.1, if i < 2 { 9.0 } else { off(at) }))
            .collect()
    };
    let mut figures = WallFigures::default();
    [1.0, -1.0].iter().for_each(|&sign| figures.push(&wall, &pair(sign)));
    let (quality, answers) = figures.of_all(&wall);
    assert_eq!((quality.cells, answers.len()), (200, 190));
    assert!((quality.fill_rate - 0.95).abs() < 1e-9);
    assert!((quality.off_plane.unwrap() - 2.0 / 190.0).abs() < 1e-9);
    assert!((quality.sub_pixel_rms_px.unwrap() - 0.25).abs() < 0.005, "{quality:?}");
    // Two values 0.5 px apart: a deviation of 0.5 / sqrt(2).
    assert!(
        (quality.temporal_noise_px.unwrap() - 0.5 / 2.0_f64.sqrt()).abs() < 1e-6,
        "{quality:?}"
    );
    let middle = 20.0 + 143.5 / 32.0;
    let distance = 288.0 * 0.12 / middle;
    assert!((quality.distance_m.unwrap() / distance - 1.0).abs() < 1e-3);
    // dZ = Z / d * dd, along the rows of a slanted wall between 22 and 27 px.
    let rms = 0.25 * distance / middle;
    assert!((quality.plane_fit_rms_m.unwrap() / rms - 1.0).abs() < 0.03, "{quality:?}");
    let tilt = (288.0_f64 / 32.0).atan2(20.0 + 159.5 / 32.0).to_degrees();
    assert!((quality.tilt_deg.unwrap() - tilt).abs() < 0.2, "{quality:?}");
}
