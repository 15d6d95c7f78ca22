//! Plans of rigs: figures that makers publish, the equations by another way, and wishes that cannot
//! be had.

use crate::support::says;
use linestereo::units::{Depth, Disparity};
use linestereo::{Dims, Params, Rig};
use linestereo_sim::planning::{Focal, RigPlan, USUAL_SIGMA, Wish, suggest};

const VGA: Dims = Dims { width: 640, height: 480 };

fn plan(focal: f64, dims: Dims, baseline: f64, range: u16) -> RigPlan {
    RigPlan::new(focal, dims, baseline, range, USUAL_SIGMA).unwrap()
}

fn assert_near(found: f64, expected: f64, bound: f64) {
    assert!((found - expected).abs() <= bound, "{found} is not {expected}");
}

#[test]
fn near_limits_are_those_of_the_core_and_makers_have_the_same_equation() {
    // OAK-D Lite, 640x480: 451 px * 75 mm = 33.825 px m.
    let rig = Rig::new(451.0, 0.075, 0.0).unwrap();
    for range in [64, 96, 128, 256] {
        let limit: Depth = rig.depth(Params::largest_disparity(range));
        assert_near(plan(451.0, VGA, 0.075, range).near_limit(), limit.to_num(), 1e-4);
        assert_near(limit.to_num(), 33.825 / (f64::from(range) - 1.5), 1e-4);
    }
    // Luxonis, "Configuring stereo depth": 71.9 degrees are 441.25 px at 640, 882.5 px at 1280;
    // 0.70 m at 95 disparities of 800P.
    let wide = Dims { width: 1280, height: 800 };
    assert_near(Focal::FieldOfView(71.9).pixels(Dims { width: 640, height: 400 }), 441.25, 0.05);
    let focal = Focal::FieldOfView(71.9).pixels(wide);
    assert_near(focal, 882.5, 0.1);
    assert_near(plan(focal, wide, 0.075, 96).disparity(0.70), 95.0, 0.7);
    // Intel, D435: 90 degrees, 848x480, 50 mm, 126 disparities: 16.8 cm.
    let d435 = Dims { width: 848, height: 480 };
    let focal = Focal::FieldOfView(90.0).pixels(d435);
    assert_near(plan(focal, d435, 0.05, 128).disparity(0.168), 126.0, 0.4);
    // A D435's lens and sensor: 1.93 mm, 3 um.
    assert_near(Focal::Millimetres { focal: 1.93, pixel: 3.0 }.pixels(d435), 643.33, 0.01);
    assert_near(plan(424.0, d435, 0.05, 126).fields_of_view()[0], 90.0, 1e-9);
}

#[test]
fn errors_are_those_of_the_core() {
    // Result of the board for a disparity and its standard deviation, in steps of 1/64 px and
    // 1/65536 m.
    let rig = Rig::new(451.0, 0.075, 0.0).unwrap();
    let plan = plan(451.0, VGA, 0.075, 96);
    for distance in [0.4, 1.0, 2.5, 6.0] {
        let disparity = Disparity::from_num(plan.disparity(distance));
        let rounding = 1.0 / 64.0 / plan.disparity(distance);
        let depth: Depth = rig.depth(disparity);
        assert_near(depth.to_num::<f64>() / distance, 1.0, rounding);
        let sigma = rig.depth_sigma(disparity, Disparity::from_num(USUAL_SIGMA));
        let step = 1.0 / 65536.0 / plan.error(distance);
        assert_near(sigma.to_num::<f64>() / plan.error(distance), 1.0, 2.0 * rounding + step);
    }
    // 33.825 px m * 5 % / 0.25 px.
    assert_near(plan.reach(0.05), 6.765, 1e-9);
    assert_near(plan.reach(0.1), 13.53, 1e-9);
    assert_near(plan.row(6.765).error_percent, 5.0, 1e-9);
}

#[test]
fn overlap_is_what_rays_say() {
    let plan = plan(451.0, VGA, 0.075, 96);
    for distance in [0.1, 0.5, 3.0] {
        // Which of many rays of the left camera hit a point at this distance that the right one
        // sees.
        let columns = (0..64_000).map(|i| (f64::from(i) + 0.5) / 100.0);
        let seen = columns.filter(|column| (column - 451.0 * 0.075 / distance) >= 0.0).count();
        assert_near(plan.overlap(distance), seen as f64 / 64_000.0, 1e-4);
    }
    assert_near(plan.meeting(), 451.0 * 0.075 / 640.0, 1e-12);
    assert_eq!(plan.overlap(0.99 * plan.meeting()), 0.0);
}

#[test]
fn the_baseline_suggested_is_the_smallest_that_will_do() {
    let wish = Wish { near: 0.5, far: 3.0, error: 0.05 };
    let found = suggest(230.0, Dims { width: 320, height: 240 }, 64, 0.25, &wish).unwrap();
    // 3 m * 0.25 px / (230 px * 0.05).
    assert_near(found.baseline_m, 0.065_217, 1e-6);
    let dims = Dims { width: 320, height: 240 };
    for (share, enough) in [(1.001, true), (0.999, false)] {
        let plan = plan(230.0, dims, share * found.baseline_m, 64);
        assert_eq!(plan.row(wish.far).error_percent <= 5.0, enough);
    }
    // 230 px * 65.2 mm / 0.5 m.
    assert_near(found.disparity_near_px, 30.0, 1e-9);
    assert!(found.within_range && found.advice.is_empty(), "{found:?}");
}

#[test]
fn what_cannot_be_had_is_said_with_what_to_change() {
    let dims = Dims { width: 320, height: 240 };
    let wish = Wish { near: 0.2, far: 5.0, error: 0.05 };
    let found = suggest(230.0, dims, 64, 0.25, &wish).unwrap();
    // 5 m * 0.25 px / (0.2 m * 0.05), whatever the lens.
    assert_near(found.disparity_near_px, 125.0, 1e-9);
    assert!(!found.within_range);
    let advice = found.advice.join("\n");
    for part in [
        "disparity of 125 px", "--max-disparity 128", "nearer than 0.40 m", "allow 10.0 % at 5 m",
        "to 2.50 m",
    ] {
        assert!(advice.contains(part), "{part} is not in\n{advice}");
    }
    // Each of the ways out is one.
    assert!(suggest(230.0, dims, 128, 0.25, &wish).unwrap().within_range);
    assert!(suggest(230.0, dims, 64, 0.25, &Wish { error: 0.1, ..wish }).unwrap().within_range);
    assert!(suggest(230.0, dims, 64, 0.25, &Wish { near: 0.4, ..wish }).unwrap().within_range);
    assert!(suggest(230.0, dims, 64, 0.25, &Wish { far: 2.5, ..wish }).unwrap().within_range);
    // And what is said to be none, is none.
    for (focal, width) in [(460.0, 640), (115.0, 320), (920.0, 1280)] {
        let found = suggest(focal, Dims { width, height: 240 }, 64, 0.25, &wish).unwrap();
        assert_near(found.disparity_near_px, 125.0, 1e-9);
    }
    // 254.5 px are found of the widest range.
    let within = suggest(230.0, VGA, 64, 0.25, &Wish { far: 10.18, ..wish }).unwrap();
    says(&within.advice.join("\n"), &["--max-disparity 256"]);
    let beyond = suggest(230.0, VGA, 256, 0.25, &Wish { far: 10.2, ..wish }).unwrap();
    let advice = beyond.advice.join("\n");
    assert!(!beyond.within_range && advice.contains("allow 5.1 %"), "{advice}");
    assert!(!advice.contains("search"), "{advice}");
    // There is room for the range in images with more pixels, and only there.
    let few = Dims { width: 120, height: 90 };
    let advice = suggest(86.0, few, 64, 0.25, &wish).unwrap().advice.join("\n");
    says(&advice, &["more pixels across than the 120"]);
    assert!(!advice.contains("search") && !advice.contains("does not change"), "{advice}");
    let error = suggest(230.0, dims, 64, 0.25, &Wish { far: 1000.0, ..wish }).unwrap_err();
    says(&error.to_string(), &["5.00 % at 1000 m needs a baseline of 21.7", "0.0001 to 10 m"]);
    // A short common view, a long baseline, one that is too short to be built.
    let narrow = Dims { width: 160, height: 120 };
    assert!(
        suggest(115.0, narrow, 128, 0.25, &wish).unwrap().advice.join(" ").contains("share 22 %")
    );
    let long = suggest(230.0, dims, 64, 0.25, &Wish { near: 5.0, far: 40.0, error: 0.05 }).unwrap();
    assert!(long.advice.join(" ").contains("hard to keep rigid"), "{long:?}");
    let short = suggest(230.0, dims, 64, 0.25, &Wish { near: 0.1, far: 0.5, error: 0.05 }).unwrap();
    assert!(short.advice.join(" ").contains("closer than most lenses stand"), "{short:?}");
}

#[test]
fn the_table_spans_the_range_and_rises() {
    let wish = Wish { near: 0.45, far: 4.1, error: 0.05 };
    for wish in [None, Some(&wish)] {
        let table = plan(451.0, VGA, 0.075, 96).table(wish);
        let distances: Vec<f64> = table.iter().map(|row| row.distance_m).collect();
        assert!(distances.is_sorted() && (6..30).contains(&distances.len()), "{distances:?}");
        assert_near(distances[0], 451.0 * 0.075 / 94.5, 1e-12);
        assert_eq!(wish.is_some(), distances.contains(&0.45) && distances.contains(&4.1));
        assert!(table.is_sorted_by(|near, far| near.error_percent <= far.error_percent));
        assert!(table.is_sorted_by(|near, far| near.overlap_percent <= far.overlap_percent));
    }
}

#[test]
fn extreme_plans_are_tabled() {
    for (focal, dims, baseline, range) in [
        (1.0, Dims { width: 16, height: 16 }, 0.0001, 8),
        (100_000.0, Dims { width: 1280, height: 16 }, 10.0, 256),
        (10.0, Dims { width: 1280, height: 1280 }, 10.0, 8),
        (100_000.0, Dims { width: 16, height: 1280 }, 0.0001, 15),
    ] {
        for sigma in [0.001, 16.0] {
            let plan = RigPlan::new(focal, dims, baseline, range, sigma).unwrap();
            let wishes = [None, Some(Wish { near: 0.01, far: 10_000.0, error: 0.5 })];
            for wish in wishes {
                assert!((1..=70).contains(&plan.table(wish.as_ref()).len()));
            }
        }
    }
}

#[test]
fn impossible_plans_are_refused_by_name() {
    let plans = [
        (f64::NAN, 320, 0.1, 64, 0.25, "focal length"),
        (230.0, 320, 0.0, 64, 0.25, "baseline"),
        (230.0, 8, 0.1, 64, 0.25, "images of 8x240"),
        (230.0, 320, 0.1, 7, 0.25, "is 7 but must be 8 to 256; change --max-disparity"),
        (230.0, 200, 0.1, 200, 0.25, "is 200 but must be 8 to 199"),
        (230.0, 320, 0.1, 257, 0.25, "is 257 but must be 8 to 256"),
        (230.0, 320, 0.1, 64, 0.0, "deviation of 0 px"),
    ];
    for (focal, width, baseline, range, sigma, says) in plans {
        let error =
            RigPlan::new(focal, Dims { width, height: 240 }, baseline, range, sigma).unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
    }
    let bad = f64::NAN;
    let distances = [(0.0, 1.0), (2.0, 1.0), (1.0, f64::INFINITY), (bad, 1.0)]
        .map(|(near, far)| (near, far, 0.05));
    let wishes = distances.map(|wish| (wish, "the distances")).into_iter();
    for ((near, far, error), says) in
        wishes.chain([0.0, 1.0, -0.1, bad].map(|error| ((0.5, 1.0, error), "an error of")))
    {
        let wish = Wish { near, far, error };
        let error = suggest(230.0, Dims { width: 320, height: 240 }, 64, 0.25, &wish).unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
    }
}
