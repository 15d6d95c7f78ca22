//! Disparity, depth and depth margins against the float equations, over every disparity there is.

use linestereo::units::{Confidence, Depth, Disparity, INFINITE_DEPTH, Position};
use linestereo::{Dims, Rig, params::RigError, results::ImagePosition};
use linestereo_tests::reference;

/// Steps per metre of [`Depth`] and per pixel of [`Disparity`].
const DEPTH_STEPS: f64 = 65536.0;
const DISPARITY_STEPS: f64 = 64.0;

/// Focal length, baseline, offset: boards, Middlebury, and both ends of what is accepted.
const RIGS: [(f32, f32, f32); 7] = [
    (400.0, 0.1, 0.0),
    (288.0, 0.12, -3.25),
    (934.2704, 0.16, 67.4473),
    (3997.684, 0.193_001, 131.111),
    (1.0, 0.0001, 0.0),
    (100_000.0, 10.0, 0.0),
    (100_000.0, 10.0, -4096.0),
];

/// The rigs, and their numbers as given.
fn rigs() -> impl Iterator<Item = (Rig, f64, f64, f64)> {
    RIGS.into_iter().map(|(focal, baseline, offset)| {
        (Rig::new(focal, baseline, offset).unwrap(), focal.into(), baseline.into(), offset.into())
    })
}

/// Relative error of f*B, the product of two numbers in single precision.
const PRODUCT: f64 = 1.0 / (1 << 24) as f64;

fn disparities() -> impl Iterator<Item = Disparity> {
    (i16::MIN..=i16::MAX).map(Disparity::from_bits)
}

/// Numbers of the rig's arithmetic: the offset is rounded to the step of a disparity.
fn rounded(offset: f64) -> f64 {
    (offset * DISPARITY_STEPS).round() / DISPARITY_STEPS
}

#[test]
fn aliases_have_the_ranges_and_steps_of_their_documentation() {
    for (found, expected) in [
        (Disparity::MIN.to_num::<f64>(), -512.0),
        (Disparity::MAX.to_num(), 512.0 - 1.0 / DISPARITY_STEPS),
        (Disparity::DELTA.to_num(), 1.0 / DISPARITY_STEPS),
        (Position::MIN.to_num(), 0.0),
        (Position::MAX.to_num(), 2048.0 - 1.0 / 32.0),
        (Position::DELTA.to_num(), 1.0 / 32.0),
        (Depth::MAX.to_num(), 32768.0 - 1.0 / DEPTH_STEPS),
        (Depth::DELTA.to_num(), 1.0 / DEPTH_STEPS),
        (Confidence::MIN.to_num(), 0.0),
        (Confidence::MAX.to_num(), 1.0 - 1.0 / 65536.0),
        (INFINITE_DEPTH.to_num(), Depth::MAX.to_num()),
    ] {
        assert_eq!(found, expected);
    }
}

#[test]
fn depth_is_the_nearest_step() {
    for (rig, focal, baseline, offset) in rigs() {
        for disparity in disparities() {
            let (found, d) = (rig.depth(disparity), disparity.to_num::<f64>() + rounded(offset));
            let expected = reference::depth(focal * baseline, rounded(offset), disparity.to_num());
            if expected >= INFINITE_DEPTH.to_num::<f64>() {
                assert_eq!(found, INFINITE_DEPTH, "{focal} {baseline} {offset}: {disparity}");
                continue;
            }
            // Half a step, and f*B rounded to half a step, divided by d.
            let bound = 0.5 / DEPTH_STEPS * (1.0 + 1.0 / d) * (1.0 + 1e-9) + expected * PRODUCT;
            let error = (found.to_num::<f64>() - expected).abs();
            assert!(
                error <= bound,
                "{focal} {baseline} {offset}: {disparity} is {found}, not {expected}"
            );
        }
    }
}

#[test]
fn nothing_in_front_of_infinity_is_infinite() {
    let rig = Rig::new(400.0, 0.1, 0.0).unwrap();
    for disparity in [Disparity::ZERO, Disparity::from_num(-1), Disparity::MIN] {
        assert_eq!(rig.depth(disparity), INFINITE_DEPTH);
        assert_eq!(rig.depth_sigma(disparity, Disparity::ONE), INFINITE_DEPTH);
        let (low, high) = rig.disparity_interval(disparity, Depth::ONE, Depth::ONE);
        assert_eq!((low, high), (Disparity::ZERO, Disparity::ZERO));
    }
    let offset = Rig::new(400.0, 0.1, 10.0).unwrap();
    assert_eq!(offset.depth(Disparity::ZERO), Depth::from_num(4));
    assert_eq!(offset.depth(Disparity::from_num(-10)), INFINITE_DEPTH);
}

#[test]
fn depth_never_grows_with_disparity() {
    for (rig, focal, baseline, offset) in rigs() {
        let depths: Vec<Depth> = disparities().map(|disparity| rig.depth(disparity)).collect();
        assert!(depths.is_sorted_by(|far, near| far >= near), "{focal} {baseline} {offset}");
    }
}

#[test]
fn sigma_follows_the_slope_of_depth() {
    for (rig, focal, baseline, offset) in rigs() {
        for sigma in [0.0, 1.0 / 64.0, 0.25, 1.0, 7.5, 500.0] {
            for disparity in disparities().step_by(7) {
                let d = disparity.to_num::<f64>() + rounded(offset);
                let z = reference::depth(focal * baseline, rounded(offset), disparity.to_num());
                let found = rig.depth_sigma(disparity, Disparity::from_num(sigma));
                let infinite = rig.depth(disparity) == INFINITE_DEPTH;
                if infinite || z * sigma / d >= INFINITE_DEPTH.to_num::<f64>() {
                    assert_eq!(
                        found, INFINITE_DEPTH,
                        "{focal} {baseline} {offset}: {disparity} +- {sigma}"
                    );
                    continue;
                }
                // A step for the quotient, and what half a step of z and of f*B makes of it.
                let bound = (1.0 + 0.5 * (1.0 + 1.0 / d) * sigma / d) / DEPTH_STEPS * (1.0 + 1e-9)
                    + z * sigma / d * PRODUCT;
                let error = (found.to_num::<f64>() - z * sigma / d).abs();
                assert!(
                    error <= bound,
                    "{focal} {baseline} {offset}: {disparity} +- {sigma} is {found}"
                );
            }
        }
    }
}

#[test]
fn margins_become_the_interval_of_equation_13() {
    for (rig, focal, baseline, offset) in rigs() {
        let product = focal * baseline;
        for (nearer, farther) in [(0.25, 0.5), (0.0, 0.0), (3.0, 1000.0), (30_000.0, 0.125)] {
            for disparity in disparities() {
                // From the rounded depth, so that only the interval itself is on trial.
                let z = rig.depth(disparity);
                if z == INFINITE_DEPTH || z == Depth::ZERO {
                    continue;
                }
                let (near, far) = (Depth::from_num(nearer), Depth::from_num(farther));
                let found = rig.disparity_interval(disparity, near, far);
                let (low, high) = reference::disparity_interval(
                    product,
                    rounded(offset),
                    z.to_num(),
                    nearer,
                    farther,
                );
                let case = || {
                    format!(
                        "{focal} {baseline} {offset}: {disparity} - {nearer} + {farther} is \
                         {found:?}"
                    )
                };
                for (found, expected) in [(found.0, low), (found.1, high)] {
                    let saturated = expected.clamp(-512.0, Disparity::MAX.to_num());
                    // Half a step, and f*B rounded to half a step of depth, relative.
                    let bound = 0.5 / DISPARITY_STEPS
                        + if expected.is_finite() {
                            (expected + rounded(offset)) * (0.5 / DEPTH_STEPS / product + PRODUCT)
                        } else {
                            0.0
                        };
                    let error = (found.to_num::<f64>() - saturated).abs();
                    assert!(error <= bound * (1.0 + 1e-9), "{}, not {low} to {high}", case());
                }
            }
        }
    }
}

#[test]
fn a_disparity_lies_in_its_own_interval() {
    let (nearer, farther) = (Depth::from_num(0.05), Depth::from_num(0.05));
    for (rig, focal, baseline, offset) in rigs().take(4) {
        for disparity in disparities().filter(|&disparity| rig.depth(disparity) != INFINITE_DEPTH) {
            let (low, high) = rig.disparity_interval(disparity, nearer, farther);
            assert!(
                low <= disparity && disparity <= high,
                "{focal} {baseline} {offset}: {disparity}"
            );
        }
    }
}

#[test]
fn unusable_rigs_are_refused_by_name() {
    for focal in [0.0, 0.99, -400.0, 100_001.0, f32::INFINITY] {
        assert_eq!(Rig::new(focal, 0.1, 0.0), Err(RigError::Focal(focal)));
    }
    for baseline in [0.0, 0.000_09, -0.1, 10.1, 60.0, f32::INFINITY] {
        assert_eq!(Rig::new(400.0, baseline, 0.0), Err(RigError::Baseline(baseline)));
    }
    for offset in [-4096.1, 4096.1, f32::NEG_INFINITY] {
        assert_eq!(Rig::new(400.0, 0.1, offset), Err(RigError::Offset(offset)));
    }
    assert!(matches!(Rig::new(f32::NAN, 0.1, 0.0), Err(RigError::Focal(_))));
    assert!(matches!(Rig::new(400.0, f32::NAN, 0.0), Err(RigError::Baseline(_))));
    assert!(matches!(Rig::new(400.0, 0.1, f32::NAN), Err(RigError::Offset(_))));
    let error = Rig::new(0.0, 0.1, 0.0).unwrap_err();
    assert_eq!(error.to_string(), "focal length 0 px is outside 1 to 100000");
}

/// Against the float equation, at corners and centre, for whole and broken principal points.
#[test]
fn a_pixel_and_its_disparity_are_a_position_in_space() {
    for (rig, focal, _, offset) in rigs() {
        let at =
            |x: f64, y: f64| ImagePosition { x: Position::from_num(x), y: Position::from_num(y) };
        assert_eq!(
            rig.xyz(at(1.0, 1.0), Disparity::from_num(20)),
            None,
            "where is the optical axis?"
        );
        for point in [[159.5, 119.5], [-31.25, 700.0], [0.1, 1279.9]] {
            let rig = rig.with_principal_point(point).unwrap();
            let [cx, cy] = point.map(f64::from);
            for (x, y) in [(0.0, 0.0), (1279.0, 0.03125), (159.5, 1279.0)] {
                for disparity in [0.5, 3.25, 63.984_375].map(Disparity::from_num) {
                    let z = rig.depth(disparity);
                    let metres = z.to_num::<f64>();
                    let expected = [(x - cx) * metres / focal, (y - cy) * metres / focal, metres];
                    let Some(found) = rig.xyz(at(x, y), disparity) else {
                        let is_far = expected.iter().any(|v| v.abs() >= 32767.9);
                        assert!(
                            z == INFINITE_DEPTH || is_far,
                            "{focal} {offset} {disparity}: {expected:?}"
                        );
                        continue;
                    };
                    for (found, expected) in
                        found.map(|v| v.to_num::<f64>()).into_iter().zip(expected)
                    {
                        // Half a step; focal length and principal point are rounded to 1/131072 px.
                        let bound = 0.5 / DEPTH_STEPS + (expected.abs() + metres) / focal / 65536.0;
                        assert!(
                            (found - expected).abs() <= bound * 1.001,
                            "{focal} {x} {y}: {found}, not {expected}"
                        );
                    }
                }
            }
        }
        let dims = Dims { width: 320, height: 240 };
        assert_eq!(rig.centred(dims), rig.with_principal_point([159.5, 119.5]).unwrap());
        let given = rig.with_principal_point([1.0, 2.0]).unwrap();
        assert_eq!(given.centred(dims), given);
        assert_eq!(
            rig.with_principal_point([0.0, f32::INFINITY]),
            Err(RigError::PrincipalPoint(f32::INFINITY))
        );
    }
}
