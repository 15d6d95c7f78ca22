//! Distance per direction: sectors against a naive reference, the rules of support, age and
//! freedom, and real frames against their truth.

use linestereo::ground::{CameraPose, GroundPlane};
use linestereo::obstacles::{ObstacleError, ObstacleParams, ObstaclePlan, Obstacles, Sector};
use linestereo::results::{ImagePosition, Match, Owner, Point, Source, Techniques};
use linestereo::units::{Confidence, Disparity, Position};
use linestereo::{Dims, Params, Rig, health::HealthFlags};
use linestereo_tests::drawn::Random;
use linestereo_tests::{captured, matched};

const DIMS: Dims = Dims { width: 320, height: 240 };
const FOCAL: f64 = 300.0;
const BASELINE: f64 = 0.1;
/// The last column and row in the middle of the image.
const CENTRE: [f64; 2] = [159.5, 119.5];

fn params() -> Params {
    Params { rig: Some(Rig::new(FOCAL as f32, BASELINE as f32, 0.0).unwrap()), ..Params::default() }
}

fn plan_of(change: impl FnOnce(&mut ObstacleParams)) -> ObstaclePlan {
    let mut wanted = ObstacleParams::DEFAULT;
    change(&mut wanted);
    wanted.plan(&params(), DIMS).unwrap()
}

fn segment(ends: [[f64; 2]; 2], disparity: [f64; 2], confidence: f64) -> Match {
    let d = disparity.map(Disparity::from_num);
    Match {
        ends: ends
            .map(|[x, y]| ImagePosition { x: Position::from_num(x), y: Position::from_num(y) }),
        disparity: d,
        sigma: Disparity::from_num(0.1),
        confidence: Confidence::from_num(confidence),
        owner: Owner::Both,
        depth: None,
        depth_sigma: None,
        techniques: Techniques { feature: None, window: d[0], census: d[0] },
    }
}

/// A vertical edge around the middle row.
fn edge(x: f64, disparity: f64, confidence: f64) -> Match {
    segment([[x, 105.0], [x, 135.0]], [disparity; 2], confidence)
}

/// One in each half of the sector ahead.
fn both_halves(disparity: f64) -> [Match; 2] {
    [156.0, 164.0].map(|x| edge(x, disparity, 0.995))
}

fn seen(plan: &ObstaclePlan, matches: &[Match]) -> Obstacles {
    let mut obstacles = Obstacles::new();
    obstacles.update(plan, matches, None, HealthFlags::GOOD, 0);
    obstacles
}

/// A point as likely as this.
pub(crate) fn point((x, y): (u16, u16), disparity: f64, confidence: f64, source: Source) -> Point {
    let disparity = Disparity::from_num(disparity);
    Point { x, y, disparity, confidence: Confidence::from_num(confidence), source }
}

pub(crate) fn seen_of_points(
    plan: &ObstaclePlan,
    points: impl Iterator<Item = Point>,
) -> Obstacles {
    let mut obstacles = Obstacles::new();
    obstacles.update(plan, &[], points, HealthFlags::GOOD, 0);
    obstacles
}

fn distance(sector: Sector) -> Option<u16> {
    if let Sector::Obstacle { distance_cm, .. } = sector { Some(distance_cm) } else { None }
}

/// Sector and distance (cm) of a point, by the definition.
fn reference(x: f64, disparity: f64, yaw_deg: f64, sectors: u8) -> (u8, f64) {
    let turn = (x - CENTRE[0]).atan2(FOCAL).to_degrees() + yaw_deg;
    let index = (turn / 360.0 * f64::from(sectors)).round().rem_euclid(sectors.into());
    let depth = FOCAL * BASELINE / disparity;
    (index as u8, 100.0 * depth.hypot(depth * (x - CENTRE[0]) / FOCAL))
}

#[test]
fn every_column_has_the_sector_and_the_distance_of_the_definition() {
    for (yaw_deg, sectors) in
        [(0.0, 72), (90.0, 72), (-180.0, 72), (33.3, 72), (0.0, 36), (10.0, 8), (179.0, 4)]
    {
        let plan = plan_of(|p| {
            (p.yaw_deg, p.sectors) = (yaw_deg, sectors);
        });
        for step in 0..2 * 319 {
            let x = f64::from(step) * 0.5;
            let disparity = 4.0 + f64::from(step % 50);
            let (index, expected_cm) = reference(x, disparity, yaw_deg.into(), sectors);
            let obstacles = seen(&plan, &[edge(x, disparity, 0.995)]);
            let turn = ((x - CENTRE[0]).atan2(FOCAL).to_degrees() + f64::from(yaw_deg)) / 360.0
                * f64::from(sectors);
            // Boundaries are within 0.0125 of a sector: the tangent in single precision.
            let is_at_a_boundary = ((turn - 0.5) - (turn - 0.5).round()).abs() < 0.015;
            let found: Vec<(u8, u16)> = obstacles
                .sectors(&plan, 0)
                .zip(0_u8..)
                .filter_map(|(s, i)| Some((i, distance(s)?)))
                .collect();
            let [(found_index, cm)] = found[..] else { panic!("x {x}: {found:?}") };
            assert!(
                found_index == index || is_at_a_boundary,
                "x {x}, yaw {yaw_deg}, {sectors} sectors: {found_index} not {index}"
            );
            // A centimetre is cut off, half a step of the disparity, and a thousandth for the
            // cosine.
            let bound = 1.0 + expected_cm * (0.001 + 1.0 / 128.0 / disparity);
            assert!(
                (f64::from(cm) - expected_cm).abs() <= bound,
                "x {x}, d {disparity}: {cm} cm not {expected_cm:.1}"
            );
        }
    }
}

/// Things on the ground around a camera that is pitched and rolled: sector and distance are those
/// along the ground.
#[test]
fn a_tilted_camera_tells_directions_and_distances_along_the_ground() {
    let rig = params().rig.unwrap();
    for (height, pitch_deg, roll_deg) in
        [(0.9, 30.0, -4.0), (0.4, 45.0, 3.0), (1.5, 20.0, 10.0), (0.3, -8.0, 0.0)]
    {
        let pose = CameraPose { height_m: height, pitch_deg, roll_deg };
        let plane = GroundPlane::of_pose(pose, &rig, DIMS).unwrap();
        let plan = plan_of(|_| {}).on_ground(Some(plane));
        let (pitch, roll) = (f64::from(pitch_deg).to_radians(), f64::from(roll_deg).to_radians());
        let mut tested = 0;
        for (direction, ground_m, up) in (-28..=28).flat_map(|degrees| {
            [(0.5, 0.15), (0.8, 0.2), (1.2, 0.25), (2.0, 0.6), (3.0, 0.6)]
                .map(|(ground_m, up)| (f64::from(degrees), ground_m, up))
        }) {
            // Axes of a level camera, then pitched, then rolled.
            let (right, forward) =
                (ground_m * direction.to_radians().sin(), ground_m * direction.to_radians().cos());
            let down = f64::from(height) - up;
            let depth = forward * pitch.cos() + down * pitch.sin();
            let lower = down * pitch.cos() - forward * pitch.sin();
            let (x, y) = (
                CENTRE[0] + FOCAL * (right * roll.cos() + lower * roll.sin()) / depth,
                CENTRE[1] + FOCAL * (lower * roll.cos() - right * roll.sin()) / depth,
            );
            let disparity = FOCAL * BASELINE / depth;
            let is_in_view = (5.0..315.0).contains(&x) && (5.0..235.0).contains(&y);
            let turn = direction / 5.0;
            let is_at_a_boundary = ((turn - 0.5) - (turn - 0.5).round()).abs() < 0.12;
            if !is_in_view || is_at_a_boundary {
                continue;
            }
            let stick = segment([[x, y - 2.0], [x, y + 2.0]], [disparity; 2], 0.995);
            let obstacles = seen(&plan, &[stick]);
            let index = turn.round().rem_euclid(72.0) as u8;
            let found: Vec<(u8, u16)> = (0..72)
                .filter_map(|i| Some((i, distance(obstacles.sector(&plan, i, 0))?)))
                .collect();
            if obstacles.sector(&plan, index, 0) == Sector::Outside {
                continue;
            }
            let [(found_index, cm)] = found[..] else {
                panic!("{pose:?}, {direction} degrees, {ground_m} m: {found:?}")
            };
            let off = f64::from(cm) / 100.0 / ground_m - 1.0;
            assert!(
                found_index == index && off.abs() < 0.04,
                "{pose:?}, {direction} degrees, {ground_m} m: {cm} cm in {found_index}"
            );
            tested += 1;
        }
        assert!(tested >= 30, "{tested} for {pose:?}");
    }
}

#[test]
fn a_long_segment_stands_in_every_sector_that_it_crosses() {
    let plan = plan_of(|_| {});
    // 100 columns, 2 m on the left to 1 m on the right.
    let matches = [
        segment([[110.0, 120.0], [210.0, 121.0]], [15.0, 30.0], 0.995),
        segment([[210.0, 121.0], [110.0, 120.0]], [30.0, 15.0], 0.995),
    ];
    for across in matches {
        let obstacles = seen(&plan, &[across]);
        let mut last = u16::MAX;
        for offset in -2_i16..=2 {
            let index = offset.rem_euclid(72) as u8;
            let cm = distance(obstacles.sector(&plan, index, 0)).unwrap();
            assert!(cm < last, "sector {index}: {cm} cm after {last}");
            last = cm;
            // Its nearest part there, the right end of the sector.
            let x = (CENTRE[0] + FOCAL * ((f64::from(offset) + 0.5) * 5.0).to_radians().tan())
                .clamp(110.0, 210.0);
            let (_, expected) = reference(x, 15.0 + 0.15 * (x - 110.0), 0.0, 72);
            assert!(
                (f64::from(cm) - expected).abs() <= 2.0,
                "sector {index}: {cm} cm not {expected:.1}"
            );
        }
    }
}

#[test]
fn sectors_outside_of_the_view_are_outside_whatever_is_seen() {
    let plan = plan_of(|_| {});
    // 56 degrees: 28 to each side, so that 5 sectors to each side are whole and the sixth is cut.
    let matches: Vec<Match> = (0..320).map(|x| edge(x.into(), 1.5, 0.99)).collect();
    let obstacles = seen(&plan, &matches);
    for (sector, index) in obstacles.sectors(&plan, 0).zip(0_i16..) {
        let offset = if index > 36 { index - 72 } else { index };
        assert_eq!(sector == Sector::Outside, offset.abs() > 6, "sector {index}: {sector:?}");
    }
    assert_eq!(obstacles.sector(&plan, 72, 0), Sector::Outside);
    assert_eq!(obstacles.sector(&plan, 255, 0), Sector::Outside);
}

#[test]
fn free_is_what_both_cameras_see_whole_with_something_behind() {
    let plan = plan_of(|_| {});
    // 20 m, with 10 m as the range.
    let far: Vec<Match> = (0..320).step_by(2).map(|x| edge(x.into(), 1.5, 0.95)).collect();
    let obstacles = seen(&plan, &far);
    for offset in -6_i16..=6 {
        let sector = obstacles.sector(&plan, offset.rem_euclid(72) as u8, 0);
        // Where a disparity of 64 px does not fit, or a border cuts the sector, the near is not
        // seen by both.
        let left = CENTRE[0] + FOCAL * ((f64::from(offset) - 0.5) * 5.0).to_radians().tan();
        let is_whole = left >= 64.0 && offset < 6;
        assert_eq!(matches!(sector, Sector::Free { .. }), is_whole, "sector {offset}: {sector:?}");
    }
    // One weak claim is not enough, and no claim says nothing.
    assert_eq!(seen(&plan, &[edge(160.0, 1.5, 0.95)]).sector(&plan, 0, 0), Sector::Unknown);
    assert_eq!(seen(&plan, &[]).sector(&plan, 0, 0), Sector::Unknown);
    assert!(matches!(seen(&plan, &both_halves(1.5)).sector(&plan, 0, 0), Sector::Free { .. }));
    assert_eq!(
        seen(&plan, &both_halves(1.5)[..1]).sector(&plan, 0, 0),
        Sector::Unknown,
        "something may stand in the other half"
    );
    let above = [156.0, 164.0].map(|x| segment([[x, 90.0], [x, 118.0]], [1.5; 2], 0.995));
    let below = [156.0, 164.0].map(|x| segment([[x, 121.0], [x, 149.0]], [1.5; 2], 0.995));
    for (half, beside) in [(above, "below"), (below, "above")] {
        let sector = seen(&plan, &half).sector(&plan, 0, 0);
        assert_eq!(sector, Sector::Unknown, "something may stand {beside} the camera's height");
    }
    // A segment without support within the range is no obstacle, but the sector is not free either.
    let mut doubtful = far.clone();
    doubtful.push(edge(160.0, 30.0, 0.9));
    assert_eq!(seen(&plan, &doubtful).sector(&plan, 0, 0), Sector::Unknown);
    // An infinite depth, and one beyond it, is far.
    for d in [0.0, -0.5] {
        assert!(matches!(seen(&plan, &both_halves(d)).sector(&plan, 0, 0), Sector::Free { .. }));
    }
}

#[test]
fn a_claim_needs_support_unless_it_is_sure() {
    let plan = plan_of(|_| {});
    let ahead = |matches: &[Match]| distance(seen(&plan, matches).sector(&plan, 0, 0));
    let at = |d: f64| Some(reference(160.0, d, 0.0, 72).1);
    let is = |found: Option<u16>, expected: Option<f64>| match (found, expected) {
        (Some(cm), Some(expected)) => (f64::from(cm) - expected).abs() <= 1.0,
        (found, expected) => found.is_none() && expected.is_none(),
    };
    assert!(is(ahead(&[edge(160.0, 30.0, 0.92)]), None));
    assert!(is(ahead(&[edge(160.0, 30.0, 0.992)]), at(30.0)));
    // Two that agree; the answer is the farther of both, which both support.
    assert!(is(ahead(&[edge(158.0, 30.0, 0.92), edge(162.0, 29.0, 0.92)]), at(29.0)));
    // Two that do not.
    assert!(is(ahead(&[edge(158.0, 30.0, 0.92), edge(162.0, 20.0, 0.92)]), None));
    // In another sector it is no support.
    assert!(is(ahead(&[edge(160.0, 30.0, 0.92), edge(200.0, 30.0, 0.92)]), None));
    // A single look-alike in front of a wall is passed over.
    let wall = [edge(152.0, 12.0, 0.95), edge(157.0, 12.2, 0.95), edge(164.0, 11.9, 0.95)];
    let with = |more: &[Match]| [wall.as_slice(), more].concat();
    assert!(is(ahead(&with(&[edge(160.0, 60.0, 0.95)])), at(12.0)));
    // The order of the list does not matter.
    let mut list =
        with(&[edge(160.0, 60.0, 0.95), edge(159.0, 45.0, 0.91), edge(155.0, 33.0, 0.93)]);
    let expected = ahead(&list);
    for _ in 0..list.len() {
        list.rotate_left(1);
        assert_eq!(ahead(&list), expected);
    }
    assert!(is(expected, at(12.0)));
}

#[test]
fn three_support_points_that_agree_are_an_obstacle() {
    let plan = plan_of(|_| {});
    let ahead = |count: u16, source: Source| {
        let points = (0..count).map(|n| point((160, 100 + 8 * n), 30.0, 0.999, source));
        distance(seen_of_points(&plan, points).sector(&plan, 0, 0))
    };
    assert_eq!(ahead(3, Source::Support), Some(reference(160.0, 30.0, 0.0, 72).1 as u16));
    assert_eq!(ahead(2, Source::Support), None, "neighbours are wrong together");
    // Those of segments are counted as matches.
    assert_eq!(ahead(20, Source::Segment(0)), None);
}

#[test]
fn two_support_points_of_a_large_image_count_as_one() {
    let dims = Dims { width: 640, height: 480 };
    let plan = ObstacleParams::DEFAULT.plan(&params(), dims).unwrap();
    let is_told = |count: u16| {
        let points = (0..count).map(|n| point((320, 200 + 8 * n), 30.0, 0.999, Source::Support));
        distance(seen_of_points(&plan, points).sector(&plan, 0, 0)).is_some()
    };
    assert_eq!([5, 6].map(is_told), [false, true]);
}

#[test]
fn support_points_beside_a_sector_help_its_own_hypotheses() {
    let plan = plan_of(|_| {});
    let beside = 160 + (FOCAL * 5_f64.to_radians().tan()).round() as u16;
    let told = |ahead: u16, right: u16, right_disparity: f64| {
        let column = |count: u16, x: u16, disparity: f64| {
            (0..count).map(move |n| point((x, 100 + 8 * n), disparity, 0.999, Source::Support))
        };
        let points = column(ahead, 160, 30.0).chain(column(right, beside, right_disparity));
        let obstacles = seen_of_points(&plan, points);
        [0, 1].map(|sector| distance(obstacles.sector(&plan, sector, 0)).is_some())
    };
    assert_eq!(told(2, 1, 30.0), [true, false], "one point does not tell its own sector");
    assert_eq!(told(2, 2, 31.0), [true, true]);
    assert_eq!(told(2, 2, 20.0), [false, false], "another surface");
    assert_eq!(told(1, 4, 30.0), [false, true]);
    // A segment is one witness, in however many sectors it stands.
    let across = segment([[150.0, 120.0], [f64::from(beside), 120.0]], [30.0; 2], 0.95);
    let obstacles = seen(&plan, &[across]);
    assert_eq!([0, 1].map(|sector| distance(obstacles.sector(&plan, sector, 0))), [None; 2]);
}

#[test]
fn a_bar_is_one_witness() {
    let plan = plan_of(|_| {});
    let ahead = |disparities: &[f64], confidence: f64| {
        let points = (100..).zip(disparities);
        let points = points.map(|(y, &d)| point((160, y), d, confidence, Source::Side));
        distance(seen_of_points(&plan, points).sector(&plan, 0, 0))
    };
    let at = Some(reference(160.0, 30.0, 0.0, 72).1 as u16);
    assert_eq!(ahead(&[30.0], 0.995), at);
    assert_eq!(ahead(&[30.0; 20], 0.98), None, "twenty points of one bar");
    assert_eq!(ahead(&[30.0, 10.0, 30.0], 0.98), at, "two bars");
}

#[test]
fn confidence_is_that_of_the_group() {
    let plan = plan_of(|_| {});
    let Sector::Obstacle { confidence, .. } =
        seen(&plan, &[edge(158.0, 30.0, 0.92), edge(162.0, 30.0, 0.95), edge(161.0, 29.5, 0.9)])
            .sector(&plan, 0, 0)
    else {
        panic!("no obstacle")
    };
    assert!((confidence.to_num::<f64>() - (1.0 - 0.08 * 0.05 * 0.1)).abs() < 1e-4, "{confidence}");
}

#[test]
fn only_the_height_band_matters() {
    // Rows above the centre are above the camera: at 2 m (15 px), 60 rows are 0.4 m.
    let plan = plan_of(|p| p.heights_m = [-0.2, 0.3]);
    let ahead = |from: f64, to: f64, d: f64| {
        let matches = [segment([[160.0, from], [160.0, to]], [d; 2], 0.995)];
        distance(seen(&plan, &matches).sector(&plan, 0, 0)).is_some()
    };
    assert!(ahead(100.0, 130.0, 15.0), "around the camera's height");
    assert!(!ahead(10.0, 40.0, 15.0), "0.53 m to 0.73 m above");
    assert!(ahead(60.0, 90.0, 15.0), "from 0.2 m to 0.4 m: reaches into the band");
    assert!(!ahead(170.0, 200.0, 15.0), "0.34 m to 0.54 m below: the floor");
    assert!(ahead(140.0, 170.0, 15.0), "from 0.14 m to 0.34 m below");
    assert!(ahead(20.0, 220.0, 15.0), "through the band");
    // Segments behind the range at the camera's height: free, as far as it is theirs to say.
    let free = |heights_m: [f32; 2], from: f64, to: f64, d: f64| {
        let plan = plan_of(|p| p.heights_m = heights_m);
        let matches = [156.0, 164.0].map(|x| segment([[x, from], [x, to]], [d; 2], 0.995));
        matches!(seen(&plan, &matches).sector(&plan, 0, 0), Sector::Free { .. })
    };
    assert!(free([-0.2, 0.3], 100.0, 130.0, 1.5), "20 m away");
    assert!(
        !free([-0.2, 0.3], 10.0, 40.0, 1.5) && !free([-0.2, 0.3], 170.0, 200.0, 15.0),
        "a wall seen over something, or a floor before it, says nothing of the camera's height"
    );
    assert!(!free([-0.2, 0.3], 122.0, 148.0, 1.5), "nor do rows below it alone");
    assert!(
        !free([0.1, 0.3], 170.0, 200.0, 15.0),
        "a band above the camera is not seen through by looking down"
    );
    // An obstacle that begins shortly behind the range (10 m, 3 px) may reach into it: neither.
    assert!(!free([-1.0, 1.0], 100.0, 130.0, 2.9) && !free([-1.0, 1.0], 100.0, 130.0, 2.5));
    assert!(free([-1.0, 1.0], 100.0, 130.0, 2.3));
    assert!(!ahead(100.0, 130.0, 2.9));
}

#[test]
fn an_offset_of_the_rig_moves_distances_not_directions() {
    let rig = Rig::new(FOCAL as f32, BASELINE as f32, 40.0).unwrap();
    let plan = ObstacleParams::DEFAULT.plan(&Params { rig: Some(rig), ..params() }, DIMS).unwrap();
    // 20 + 40 px: half a metre.
    assert_eq!(distance(seen(&plan, &[edge(160.0, 20.0, 0.995)]).sector(&plan, 0, 0)), Some(50));
    assert_eq!(distance(seen(&plan, &[edge(160.0, -10.0, 0.995)]).sector(&plan, 0, 0)), Some(100));
}

/// The sector ahead in a word or its distance.
fn word(sector: Sector) -> String {
    match sector {
        Sector::Outside => "outside".to_owned(),
        Sector::Unknown => "unknown".to_owned(),
        Sector::Free { age_ms, .. } => format!("free {age_ms}"),
        Sector::Obstacle { distance_cm, age_ms, .. } => format!("{distance_cm} cm {age_ms}"),
    }
}

#[test]
fn what_was_seen_is_kept_with_its_age_until_it_is_too_old() {
    let plan = plan_of(|p| p.keep_ms = 300);
    let mut obstacles = Obstacles::new();
    let near = [edge(160.0, 30.0, 0.995)];
    let mid = [edge(160.0, 20.0, 0.995)];
    let far = both_halves(1.5);
    let steps: [(u64, &[Match], &str); 12] = [
        (0, &near, "100 cm 0"),
        (100, &[], "100 cm 100"),
        (200, &mid, "100 cm 200"), // the nearer one stays
        (300, &far, "100 cm 300"),
        (301, &far, "free 0"),
        (400, &[], "free 99"),
        (500, &near, "100 cm 0"), // nothing protects what is free
        (600, &[edge(160.0, 31.0, 0.995)], "96 cm 0"),
        (700, &[edge(160.0, 29.0, 0.995)], "103 cm 0"), // the same one, moving away
        (1000, &[], "103 cm 300"),
        (1001, &[], "unknown"),
        (1100, &mid, "150 cm 0"),
    ];
    for (time_ms, matches, expected) in steps {
        obstacles.update(&plan, matches, None, HealthFlags::GOOD, time_ms * 1000);
        assert_eq!(word(obstacles.sector(&plan, 0, time_ms * 1000)), expected, "at {time_ms} ms");
    }
    // Between pairs, age counts as well.
    assert_eq!(word(obstacles.sector(&plan, 0, 1_400_000)), "150 cm 300");
    assert_eq!(word(obstacles.sector(&plan, 0, 1_401_000)), "unknown");
    // 49 days later, when milliseconds have wrapped, an old one does not become new.
    obstacles.update(&plan, &[], None, HealthFlags::GOOD, 1_500_000);
    assert_eq!(word(obstacles.sector(&plan, 0, 1_100_000 + (1 << 32) * 1000)), "unknown");
}

#[test]
fn an_unfit_pair_says_nothing() {
    let plan = plan_of(|_| {});
    let near = [edge(160.0, 30.0, 0.995)];
    for (flag, name) in HealthFlags::NAMES {
        let mut obstacles = Obstacles::new();
        assert!(!obstacles.is_fit(), "before the first pair");
        obstacles.update(&plan, &near, None, flag, 0);
        let is_fit = !HealthFlags::UNFIT.contains(flag);
        assert_eq!(obstacles.is_fit(), is_fit, "{name}");
        assert_eq!(distance(obstacles.sector(&plan, 0, 0)).is_some(), is_fit, "{name}");
        // Earlier knowledge grows old.
        obstacles.update(&plan, &near, None, HealthFlags::GOOD, 0);
        obstacles.update(
            &plan,
            &[edge(160.0, 60.0, 0.995)],
            None,
            HealthFlags::FEW_MATCHES,
            100_000,
        );
        assert_eq!(word(obstacles.sector(&plan, 0, 100_000)), "100 cm 100");
        obstacles.update(&plan, &near, None, HealthFlags::GOOD, 200_000);
        obstacles.mark_missing();
        assert!(!obstacles.is_fit());
        assert_eq!(word(obstacles.sector(&plan, 0, 250_000)), "100 cm 50");
    }
    let all = plan_of(|p| p.unfit = HealthFlags::LEFT_EXPOSURE);
    let mut obstacles = Obstacles::new();
    obstacles.update(&all, &near, None, HealthFlags::LEFT_EXPOSURE | HealthFlags::SKEW, 0);
    assert!(!obstacles.is_fit());
}

#[test]
fn parameters_without_sense_are_refused_by_name() {
    let refused = |change: &dyn Fn(&mut ObstacleParams)| {
        let mut wanted = ObstacleParams::DEFAULT;
        change(&mut wanted);
        wanted.plan(&params(), DIMS).unwrap_err().to_string()
    };
    type Change<'a> = &'a dyn Fn(&mut ObstacleParams);
    let cases: [(Change<'_>, &str); 7] = [
        (&|p| p.yaw_deg = 181.0, "yaw (degrees) is 181 but must be -180 to 180"),
        (&|p| p.sectors = 73, "sectors is 73 but must be 4 to 72"),
        (&|p| p.sectors = 0, "sectors is 0 but must be 4 to 72"),
        (&|p| p.range_m = 601.0, "range (m) is 601 but must be 0.1 to 600"),
        (&|p| p.heights_m = [2.0, 1.0], "highest height (m) is 1 but must be 2 to 1000"),
        (
            &|p| p.heights_m = [f32::NEG_INFINITY, 1.0],
            "lowest height (m) is -inf but must be -1000 to 1000",
        ),
        (&|p| p.error_probability = 0.0, "error probability is 0 but must be 0.00002 to 0.5"),
    ];
    for (change, expected) in cases {
        assert_eq!(refused(change), expected);
    }
    for (point, expected) in [
        ([400.0, 1.0], "principal column (px) is 400 but must be 0 to 320"),
        ([1.0, -1.0], "principal row (px) is -1 but must be 0 to 240"),
    ] {
        let rig = params().rig.map(|rig| rig.with_principal_point(point).unwrap());
        let refused = ObstacleParams::DEFAULT.plan(&Params { rig, ..params() }, DIMS).unwrap_err();
        assert_eq!(refused.to_string(), expected);
    }
    let no_rig = ObstacleParams::DEFAULT.plan(&Params::default(), DIMS);
    assert_eq!(no_rig, Err(ObstacleError::NoRig));
    // Disparities with an offset of the rig have 16 bits.
    for (offset, expected) in [(959.0, None), (960.0, Some(ObstacleError::TooLarge(1024.0)))] {
        let params =
            Params { rig: Some(Rig::new(250.0, 0.06, offset).unwrap()), ..Params::default() };
        assert_eq!(ObstacleParams::default().plan(&params, DIMS).err(), expected);
    }
}

/// Widest lenses, extreme rigs and matches of any bits: an answer within bounds, whatever it is.
#[test]
fn nothing_overflows() {
    let mut random = Random(1);
    let mut random = || random.bits() as u32;
    for round in 0..2000 {
        let rig = Rig::new(
            [1.0, 37.0, 300.0, 100_000.0][round % 4],
            [0.0001, 0.1, 10.0][round % 3],
            [0.0, 4096.0, -4096.0, 67.4][round % 4],
        );
        let dims =
            [DIMS, Dims { width: 1280, height: 16 }, Dims { width: 80, height: 1280 }][round % 3];
        let wanted = ObstacleParams {
            yaw_deg: (random() % 361) as f32 - 180.0,
            sectors: [4, 5, 7, 36, 71, 72][round % 6],
            range_m: [0.1, 10.0, 600.0][round % 3],
            heights_m: [[-1000.0, 1000.0], [-0.1, 0.1], [0.0, 0.0]][round % 3],
            ..ObstacleParams::DEFAULT
        };
        let plan = match wanted.plan(&Params { rig: Some(rig.unwrap()), ..params() }, dims) {
            Err(ObstacleError::TooLarge(_)) => continue,
            plan => plan.unwrap(),
        };
        let mut point = || ImagePosition {
            x: Position::from_bits(random() as u16),
            y: Position::from_bits(random() as u16),
        };
        let ends: Vec<_> = (0..20).map(|_| [point(), point()]).collect();
        let matches: Vec<Match> = ends
            .into_iter()
            .map(|ends| {
                let disparity =
                    [Disparity::from_bits(random() as i16), Disparity::from_bits(random() as i16)];
                let confidence = Confidence::from_bits(random() as u16);
                Match { ends, disparity, confidence, ..edge(1.0, 1.0, 0.5) }
            })
            .collect();
        let obstacles = seen(&plan, &matches);
        let mut in_view = 0;
        for sector in obstacles.sectors(&plan, 0) {
            in_view += usize::from(sector != Sector::Outside);
            if let Some(cm) = distance(sector) {
                assert!(cm > 0 && cm < plan.range_cm(), "{cm}");
            }
        }
        assert!((1..=37).contains(&in_view), "{in_view} in view");
    }
}

/// Real frames, as if a camera with 56 degrees of view had seen them: how often a sector shows
/// something nearer than anything that is there, or is free although something is there.
#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn captured_frames_give_no_ghosts() {
    let Some(scenes) = captured::qvga() else { return };
    let (mut sectors, mut shown, mut ghosts, mut missed, mut free, mut not_free, mut little) =
        (0, 0, 0, 0, 0, 0, 0);
    let mut least = 1.0_f64;
    for scene in scenes {
        let truth = scene.truth.as_ref().unwrap();
        let dims = scene.left.dims;
        let params = Params { max_disparity: scene.max_disparity, ..params() };
        let (_, result) = matched(&params, [&scene.left, &scene.right]);
        let cx = 0.5 * (f64::from(dims.width) - 1.0);
        // Distances (cm) of the truth in a sector and some columns beside it, nearest first.
        let of_truth = |offset: i16, beside: i32| {
            let column =
                |half: f64| cx + FOCAL * ((f64::from(offset) + half) * 5.0).to_radians().tan();
            let (from, to) =
                (column(-0.5).max(0.0) as i32, column(0.5).min(f64::from(dims.width) - 1.0) as i32);
            let mut list = Vec::new();
            for y in 0..i32::from(dims.height) {
                for x in from - beside..=to + beside {
                    let d = truth.disparity(x, y).filter(|&d| d > 0.5);
                    list.extend(d.map(|d| {
                        100.0 * FOCAL * BASELINE / f64::from(d)
                            * ((f64::from(x) - cx) / FOCAL).hypot(1.0)
                    }));
                }
            }
            list.sort_by(f64::total_cmp);
            list
        };
        let mut depths: Vec<f64> = (-5..=5).flat_map(|offset| of_truth(offset, 0)).collect();
        depths.sort_by(f64::total_cmp);
        // With all in range; and with ranges that most of the scene lies behind.
        let quantile = |share: usize| (depths[depths.len() / share] / 100.0) as f32;
        let short = [20, 14, 10, 7, 5, 4].map(quantile);
        for range_m in core::iter::once(10.0).chain(short) {
            let wanted =
                ObstacleParams { range_m, unfit: HealthFlags::GOOD, ..ObstacleParams::DEFAULT };
            let range_m = f64::from(range_m);
            let plan = wanted.plan(&params, dims).unwrap();
            let mut obstacles = Obstacles::new();
            obstacles.update(
                &plan,
                &result.matches,
                result.obstacle_points.iter().copied(),
                HealthFlags::GOOD,
                0,
            );
            for offset in -5_i16..=5 {
                let (own, wide) = (of_truth(offset, 0), of_truth(offset, 4));
                if own.len() < 200 {
                    continue;
                }
                // Least share of the sector that counts as an obstacle: a tenth.
                let something = own[own.len() / 10];
                let sector = obstacles.sector(&plan, offset.rem_euclid(72) as u8, 0);
                if range_m < 10.0 {
                    let is_free = matches!(sector, Sector::Free { .. });
                    free += u32::from(is_free);
                    not_free += u32::from(is_free && something < 95.0 * range_m);
                    // A hundredth of the sector.
                    little += u32::from(is_free && own[own.len() / 100] < 100.0 * range_m);
                    least = if is_free { least.min(something / 100.0 / range_m) } else { least };
                    continue;
                }
                sectors += 1;
                if let Some(cm) = distance(sector).map(f64::from) {
                    shown += 1;
                    ghosts += u32::from(cm < 0.9 * wide[0]);
                    missed += u32::from(cm > 1.25 * something);
                }
            }
        }
    }
    assert!(shown * 20 >= sectors * 19, "{shown} of {sectors} sectors show an obstacle");
    assert!(ghosts * 100 <= shown, "{ghosts} ghosts in {shown} sectors");
    assert!(missed * 8 <= shown, "{missed} of {shown} obstacles are too far");
    assert!(
        free >= 25 && not_free * 10 <= free && little * 4 <= free && least >= 0.7,
        "{not_free} of {free} free sectors are not, {little} with little within the range, {least:.2}"
    );
}
