//! Synthetic scenes against closed forms: what the renderer says must follow from geometry alone.

use crate::support::Folder;
use linestereo::{Dims, results::Owner};
use linestereo_frames::load_scene;
use linestereo_sim::scene::{
    self, DisparityPlane, EdgeCase, Kind, Pair, Pattern, Rendering, Scene, Sensor, Texture,
};
use linestereo_sim::scene_folder;
use std::collections::BTreeSet;

const DIMS: Dims = Dims { width: 64, height: 32 };

/// Column, row and place in the list of every pixel.
fn pixels() -> impl Iterator<Item = (f64, f64, usize)> {
    (0..32_u8).flat_map(|y| {
        (0..64_u8).map(move |x| (f64::from(x), f64::from(y), usize::from(y) * 64 + usize::from(x)))
    })
}

/// One unbounded grained plane.
fn plane_scene(plane: DisparityPlane, offset_px: f64) -> Scene {
    let pair = Pair { disparity_offset_px: offset_px, ..Pair::centred(DIMS, 64.0, 0.1) };
    let metres_per_pixel = pair.depth(plane.disparity) / pair.focal_px;
    let texture = Texture::grained(Pattern::Blank(128.0), 100.0, 3.0 * metres_per_pixel, 7);
    Scene {
        pair,
        surfaces: vec![plane.surface(&pair, [3.0, 1.0], texture, 1)],
        objects: vec!["plane"],
    }
}

fn render(scene: &Scene) -> Rendering {
    scene::render(scene, DIMS, &Sensor::default())
}

#[test]
fn whole_disparities_shift_the_image() {
    for offset in [0.0, 5.0] {
        let plane = DisparityPlane { at: [20.0, 10.0], disparity: 7.0, slope: [0.0; 2] };
        let rendering = render(&plane_scene(plane, offset));
        for (x, _, i) in pixels() {
            assert!((rendering.disparity[i] - 7.0).abs() < 1e-5);
            assert_eq!(rendering.visible[i], x >= 7.0, "column {x}");
            if x >= 7.0 {
                let (left, right) = (rendering.left.pixels[i], rendering.right.pixels[i - 7]);
                assert!(left.abs_diff(right) <= 1, "{left} {right} at {i}"); // rounding of half greys
            }
        }
    }
}

#[test]
fn slanted_planes_have_linear_disparity() {
    for slope in [[0.05, 0.0], [-0.03, 0.1], [0.0, -0.2]] {
        let plane = DisparityPlane { at: [30.0, 15.0], disparity: 9.25, slope };
        let rendering = render(&plane_scene(plane, 0.0));
        for (x, y, i) in pixels() {
            let expected = plane.disparity_at(x, y);
            assert!(
                (f64::from(rendering.disparity[i]) - expected).abs() < 1e-5,
                "{slope:?} at {x}, {y}"
            );
            assert_eq!(rendering.labels[i], 1);
            let seen_at = x - expected;
            if (seen_at + 0.5).abs() > 1e-6 && (seen_at - 63.5).abs() > 1e-6 {
                assert_eq!(
                    rendering.visible[i],
                    seen_at > -0.5 && seen_at < 63.5,
                    "{slope:?} at {x}, {y}"
                );
            }
        }
    }
}

fn edge_case(owner: Owner, direction: [f64; 2], slope: [f64; 2]) -> EdgeCase {
    let plane = DisparityPlane { at: [32.3, 16.0], disparity: 10.4, slope };
    EdgeCase { plane, direction, owner, background: 4.0, greys: [60.0, 200.0], grain: 0.0, seed: 1 }
}

/// Column at which a row of two greys changes from the first to the second, by its mean.
fn border(row: &[u8], [first, second]: [f64; 2]) -> f64 {
    let sum: f64 = row.iter().map(|&grey| f64::from(grey)).sum();
    (second * row.len() as f64 - sum) / (second - first) - 0.5
}

#[test]
fn edges_lie_where_they_are_said_to_lie_in_both_images() {
    for (owner, slope) in
        [(Owner::Both, [0.0; 2]), (Owner::Left, [0.02, 0.0]), (Owner::Right, [0.03, -0.05])]
    {
        for direction in [[0.0, 1.0], [1.0, 4.0], [-1.0, 3.0]] {
            let case = edge_case(owner, direction, slope);
            let rendering = render(&case.scene(DIMS));
            for (y, (left, right)) in
                rendering.left.pixels.chunks(64).zip(rendering.right.pixels.chunks(64)).enumerate()
            {
                let (left, right) = (border(left, case.greys), border(right, case.greys));
                let expected = 32.3 + (y as f64 - 16.0) * direction[0] / direction[1];
                let disparity = case.plane.disparity_at(expected, y as f64);
                // A step of the lattice, and half a grey of rounding in each of up to three mixed
                // pixels.
                assert!((left - expected).abs() < 0.03, "{case:?}: {left} instead of {expected}");
                assert!(
                    (left - right - disparity).abs() < 0.05,
                    "{case:?}: {left} - {right} is not {disparity}"
                );
            }
        }
    }
}

#[test]
fn the_owner_is_the_plane_in_front() {
    for direction in [[0.0, 1.0], [0.0, -1.0], [2.0, 3.0], [-3.0, 1.0], [1.0, 0.0], [-8.0, 1.0]] {
        for owner in [Owner::Left, Owner::Right] {
            let case = edge_case(owner, direction, [0.01, -0.02]);
            let rendering = render(&case.scene(DIMS));
            for (x, y, i) in pixels() {
                let side = case.side(x, y);
                if side.abs() < 1e-9 {
                    continue;
                }
                let in_front = if owner == Owner::Left { side < 0.0 } else { side > 0.0 };
                assert_eq!(
                    rendering.labels[i],
                    if in_front { 1 } else { 2 },
                    "{case:?} at {x}, {y}"
                );
                let grey = case.greys[usize::from(side > 0.0)];
                assert!(
                    side.abs() < 1.0 || (f64::from(rendering.left.pixels[i]) - grey).abs() <= 0.5
                );
            }
            let first_side =
                if case.is_near_horizontal() { case.side(32.3, 0.0) } else { case.side(0.0, 16.0) };
            assert!(first_side < 0.0, "{case:?}");
        }
    }
}

#[test]
fn hidden_is_what_the_front_covers_in_the_right_image() {
    for owner in [Owner::Left, Owner::Right] {
        let case = edge_case(owner, [0.0, 1.0], [0.0; 2]);
        let rendering = render(&case.scene(DIMS));
        for (x, _, i) in pixels() {
            let in_front = if owner == Owner::Left { x <= 32.3 } else { x >= 32.3 };
            let seen_at = x - if in_front { 10.4 } else { 4.0 };
            let edge = 32.3 - 10.4;
            let covered =
                !in_front && if owner == Owner::Left { seen_at <= edge } else { seen_at >= edge };
            assert_eq!(rendering.visible[i], seen_at >= -0.5 && !covered, "{owner:?} column {x}");
        }
    }
}

#[test]
fn every_case_of_the_grid_is_well_formed() {
    let cases = EdgeCase::grid(DIMS, 12.0);
    assert_eq!(cases.len(), 480);
    for case in cases.iter().step_by(7) {
        let rendering = render(&case.scene(DIMS));
        assert!(rendering.disparity.iter().all(|d| (0.0..30.0).contains(d)), "{case:?}");
        assert!(case.side(case.plane.at[0], case.plane.at[1]).abs() < 1e-9);
        let labels: BTreeSet<u8> = rendering.labels.iter().copied().collect();
        assert_eq!(labels.len(), if case.owner == Owner::Both { 1 } else { 2 }, "{case:?}");
    }
}

#[test]
fn the_sensor_does_what_it_says() {
    let plane = DisparityPlane { at: [20.0, 10.0], disparity: 7.0, slope: [0.0; 2] };
    let scene = plane_scene(plane, 0.0);
    let clean = render(&scene);

    let lower = scene::render(&scene, DIMS, &Sensor { row_offset: 1.0, ..Sensor::default() });
    assert_eq!(lower.left, clean.left);
    for (shifted, grey) in lower.right.pixels[64..].iter().zip(&clean.right.pixels) {
        assert!(shifted.abs_diff(*grey) <= 1);
    }

    let darker =
        scene::render(&scene, DIMS, &Sensor { gain: 0.5, bias: 10.0, ..Sensor::default() });
    assert_eq!(darker.left, clean.left);
    for (dark, bright) in darker.right.pixels.iter().zip(&clean.right.pixels) {
        assert!((f64::from(*dark) - (0.5 * f64::from(*bright) + 10.0)).abs() <= 0.76);
    }

    let flat = EdgeCase { greys: [128.0; 2], ..edge_case(Owner::Both, [0.0, 1.0], [0.0; 2]) };
    let noisy = scene::render(
        &flat.scene(DIMS),
        DIMS,
        &Sensor { noise: 5.0, seed: 3, ..Sensor::default() },
    );
    assert_ne!(noisy.left, noisy.right);
    for image in [&noisy.left, &noisy.right] {
        let count = image.pixels.len() as f64;
        let mean = image.pixels.iter().map(|&grey| f64::from(grey)).sum::<f64>() / count;
        let variance =
            image.pixels.iter().map(|&grey| (f64::from(grey) - mean).powi(2)).sum::<f64>() / count;
        assert!(
            (mean - 128.0).abs() < 0.4 && (variance.sqrt() - 5.0).abs() < 0.3,
            "{mean} {variance}"
        );
    }
}

/// Every built-in scene, small: a change of any pixel or truth on any machine shows here.
#[test]
fn the_same_seed_gives_the_same_bytes() {
    let dims = Dims { width: 48, height: 36 };
    let mut digests = String::new();
    for kind in Kind::ALL {
        let built = scene::build(kind, dims, 5);
        let Rendering { left, right, disparity, visible, labels } =
            scene::render(&built, dims, &Sensor { noise: 2.0, seed: 9, ..Sensor::default() });
        assert!(labels.iter().all(|&label| usize::from(label) <= built.objects.len()));
        let bytes = left.pixels.into_iter().chain(right.pixels).chain(labels);
        let bytes = bytes.chain(visible.into_iter().map(u8::from));
        let bytes =
            bytes.chain(disparity.into_iter().flat_map(|d| ((d * 256.0) as u16).to_le_bytes()));
        let fnv_1a = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        digests.push_str(&format!(
            "{:<10} {:016x}\n",
            kind.name(),
            bytes.fold(0xcbf2_9ce4_8422_2325, fnv_1a)
        ));
    }
    let expected = "\
demo       2c5ac6e99efad993
cards      0efb73c8bd533302
corridor   3069e79e24dd59ad
poles      dad2a4cfc67918e8
boxes      42c7e1e13ae95819
blank      86721c9145c52f3e
repetition 594dd979ab673a5f
";
    assert_eq!(
        digests, expected,
        "\nif the change is meant, take over the digests on the left:\n{digests}"
    );
}

#[test]
fn a_folder_reads_back_as_it_was_rendered() {
    let folder = Folder::new();
    let dims = Dims { width: 80, height: 60 };
    let built = scene::build(Kind::Demo, dims, 1);
    let rendering = scene::render(&built, dims, &Sensor::default());
    for (name, contents) in scene_folder::files("demo", &built.pair, &rendering).unwrap() {
        std::fs::write(folder.path().join(name), contents).unwrap();
    }
    let read = load_scene(folder.path(), None).unwrap();
    assert_eq!(
        (read.name.as_str(), &read.left, &read.right),
        ("demo", &rendering.left, &rendering.right)
    );
    assert_eq!(read.rig, Some(built.pair.rig().unwrap()));
    assert_eq!(read.max_disparity, 16);
    let truth = read.truth.unwrap();
    for (i, &disparity) in rendering.disparity.iter().enumerate() {
        let (x, y) = (i as i32 % 80, i as i32 / 80);
        assert!((truth.disparity(x, y).unwrap() - disparity).abs() <= 1.0 / 512.0);
        assert_eq!(truth.is_visible(x, y), rendering.visible[i]);
    }
}
