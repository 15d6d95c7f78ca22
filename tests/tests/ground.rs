//! The ground plane: found in drawn floors, and floors seen along it.
//!
//! A floor from its horizon down, with a wall above, drawn exactly; cells are of 16 x 16 px, each
//! with its most probable point.

use linestereo::ground::{CameraPose, GroundPlane};
use linestereo::{Dims, Params};
use linestereo_frames::{GrayImage, SceneInfo};
use linestereo_sim::engine::FrameResult;
use linestereo_tests::drawn::{painted, surface};
use linestereo_tests::{captured, matched};

const DIMS: Dims = Dims { width: 320, height: 240 };
/// Row below which the floor is, px.
const FOOT: f64 = 88.0;
/// Cells of the image, px.
const CELL: u16 = 16;
/// Label of floors in rendered rooms.
const FLOOR_LABEL: u8 = 1;

/// A floor whose disparity changes by `down` px per row and `across` px per column; 0 in the middle
/// of row 80.
#[derive(Clone, Copy)]
pub(crate) struct Floor {
    pub(crate) down: f64,
    pub(crate) across: f64,
}

impl Floor {
    fn disparity(&self, x: f64, y: f64) -> f64 {
        self.down * (y.max(FOOT) - 80.0) + self.across * (x - 160.0)
    }

    pub(crate) fn draw(&self, seed: u64) -> [GrayImage; 2] {
        surface(DIMS, seed, |y| self.disparity(0.0, y), self.across)
    }

    fn run(&self, ground: bool, seed: u64) -> FrameResult {
        let params = Params { max_disparity: 144, ground, ..Params::default() };
        matched(&params, self.draw(seed).each_ref()).1
    }

    /// Percentage of the floor's cells whose match the right image holds that are answered, and of
    /// these answers that are off by more than 1 px.
    fn seen(&self, result: &FrameResult) -> [f64; 2] {
        let (mut cells, mut seen, mut wrong) = (0, 0, 0);
        for top in (96..DIMS.height).step_by(CELL.into()) {
            for left in (0..DIMS.width).step_by(CELL.into()) {
                let [x, y] = [left, top].map(|at| f64::from(at + CELL / 2));
                if self.disparity(x, y) > x - 16.0 {
                    continue;
                }
                cells += 1;
                let inside = result
                    .points
                    .iter()
                    .filter(|p| p.x / CELL == left / CELL && p.y / CELL == top / CELL);
                if let Some(best) = inside.max_by_key(|point| point.confidence) {
                    seen += 1;
                    let error = best.disparity.to_num::<f64>()
                        - self.disparity(best.x.into(), best.y.into());
                    wrong += u32::from(error.abs() > 1.0);
                }
            }
        }
        [
            100.0 * f64::from(seen) / f64::from(cells),
            100.0 * f64::from(wrong) / f64::from(seen.max(1)),
        ]
    }
}

/// Largest difference of a plane from a floor at four pixels of it, px.
fn apart(plane: GroundPlane, floor: Floor) -> f64 {
    let at = |x: i32, y: i32| {
        (f64::from(plane.at_q6(x, y)) / 64.0 - floor.disparity(x.into(), y.into())).abs()
    };
    [(20, 100), (300, 100), (20, 230), (300, 230)]
        .into_iter()
        .map(|(x, y)| at(x, y))
        .fold(0.0, f64::max)
}

#[test]
fn floors_are_found_and_seen_at_every_slope() {
    let mut table = String::new();
    let mut all = true;
    for (down, across, seed) in [
        (0.2, 0.0, 3),
        (0.3, 0.01, 4),
        (0.4, 0.0, 5),
        (0.6, -0.015, 6),
        (0.8, 0.01, 7),
        (0.9, 0.0, 8),
    ] {
        let floor = Floor { down, across };
        let result = floor.run(true, seed);
        let [seen, wrong] = floor.seen(&result);
        let [without, _] = floor.seen(&floor.run(false, seed));
        let off = result.ground.map_or(f64::INFINITY, |plane| apart(plane, floor));
        table += &format!(
            "slope {down:.1}, roll {across:6.3}: plane {off:.2} px off, {seen:.0} % seen ({without:.0} % without), {wrong:.1} % of these off\n"
        );
        all &= off < 1.0 && seen >= 75.0 && wrong <= 2.0;
    }
    assert!(all, "{table}");
}

/// Floors of rendered rooms against their truth, by the height, pitch and roll of the scene file.
#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn floors_of_rooms_are_rolled_as_their_scene_files_say() {
    let Some(rooms) = captured::folder("robot_world") else { return };
    let mut rolled = 0;
    for room in linestereo_frames::find_scenes(&rooms).unwrap() {
        let scene = linestereo_frames::load_scene(&room, None).unwrap();
        let pose = SceneInfo::load(&room.join("scene.json")).unwrap().pose().unwrap();
        let labels = linestereo_frames::load_gray(&room.join("labels.png")).unwrap().pixels;
        let (dims, truth) = (scene.left.dims, scene.truth.as_ref().unwrap());
        let pixels = (0..dims.height).flat_map(|y| (0..dims.width).map(move |x| (x, y)));
        let floor: Vec<(i32, i32, f64)> = pixels
            .zip(labels)
            .filter(|(_, label)| *label == FLOOR_LABEL)
            .filter_map(|((x, y), _)| {
                let (x, y) = (i32::from(x), i32::from(y));
                Some((x, y, truth.disparity(x, y)?.into()))
            })
            .collect();
        if pose.roll_deg.abs() < 1.0 || floor.len() < 1000 {
            continue;
        }
        let off = |roll_deg: f32| {
            let pose = CameraPose { roll_deg, ..pose };
            let plane = GroundPlane::of_pose(pose, &scene.rig.unwrap(), dims).unwrap();
            let error =
                |&(x, y, d): &(i32, i32, f64)| (f64::from(plane.at_q6(x, y)) / 64.0 - d).abs();
            floor.iter().map(error).sum::<f64>() / floor.len() as f64
        };
        let (said, mirrored) = (off(pose.roll_deg), off(-pose.roll_deg));
        assert!(said < mirrored, "{}: {said:.2} px off, {mirrored:.2} mirrored", room.display());
        rolled += 1;
    }
    assert!(rolled >= 10, "only {rolled} rooms are seen by a rolled camera");
}

#[test]
fn a_wall_has_no_ground_and_keeps_its_bits() {
    let wall = Floor { down: 0.02, across: 0.0 };
    for seed in [9, 11] {
        let [with, without] = [true, false].map(|ground| wall.run(ground, seed));
        assert_eq!(with.ground, None);
        assert_eq!((with.points, with.matches), (without.points, without.matches));
    }
}

#[test]
fn a_pair_without_texture_has_no_ground_and_no_match() {
    let flat = painted(DIMS.width, DIMS.height, |_, _| 90);
    let (_, result) = matched(&Params::default(), [&flat; 2]);
    assert_eq!((result.ground, result.matches.len(), result.points.len()), (None, 0, 0));
}
