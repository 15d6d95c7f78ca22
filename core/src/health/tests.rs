//! The monitor with drawn pairs and made-up matches.

use super::*;
use crate::support::SupportPoint;

#[test]
fn few_matches_tell_rows_that_are_very_uneven_alone() {
    let limits = HealthLimits::DEFAULT;
    let told =
        |samples, spread_q8| are_uneven(&Rows { offset_q8: 0, spread_q8, samples }, &limits, 320);
    let HealthLimits { row_spread_q8: most, min_row_samples: enough, .. } = limits;
    assert_eq!([most, most + 1].map(|spread| told(enough, spread)), [Some(false), Some(true)]);
    assert_eq!(
        [2 * most + 1, 2 * most + 2].map(|spread| told(enough - 1, spread)),
        [None, Some(true)]
    );
    assert_eq!(told(LEAST_SAMPLES - 1, u16::MAX), None);
    let large =
        |spread_q8| are_uneven(&Rows { offset_q8: 0, spread_q8, samples: enough }, &limits, 640);
    assert_eq!([2 * most, 2 * most + 1].map(large), [Some(false), Some(true)]);
}

#[test]
fn few_are_matched_below_a_share_of_those_compared() {
    let limits =
        HealthLimits { matched_permille: 100, unwitnessed_permille: 200, ..HealthLimits::DEFAULT };
    let few = |segments: u16, less_prominent: u16, matched: u16, rows_are_known| {
        let mut counts = Counts::default();
        (counts.segments_left, counts.matched) = (segments, matched);
        counts.reject_many(Rejection::LessProminent, less_prominent);
        are_few(&counts, &limits, rows_are_known)
    };
    assert_eq!([3, 4].map(|matched| few(50, 10, matched, true)), [true, false]);
    assert_eq!([7, 8].map(|matched| few(50, 10, matched, false)), [true, false]);
    assert_eq!(
        [23, 24].map(|compared| few(compared, 0, 0, true)),
        [false, true],
        "of fewer nothing is said"
    );
}

#[test]
fn the_range_is_small_with_enough_windows_beyond_it() {
    let limits =
        HealthLimits { min_beyond_range: 3, beyond_range_permille: 20, ..HealthLimits::DEFAULT };
    let small = |beyond, windows| {
        let mut range = RangeCheck::default();
        (range.beyond, range.windows) = (beyond, windows);
        is_small(&range, &limits)
    };
    assert_eq!(
        [small(2, 10), small(3, 10), small(3, 150), small(3, 151)],
        [false, true, true, false]
    );
}

#[test]
fn the_third_smallest_disparity_is_that_of_the_larger_end() {
    let matches =
        [[5, -7], [1, 9], [-3, -8], [2, 2], [-4, 70]].map(|d| rows::tests::matched([(0, 0); 2], d));
    assert_eq!(
        [2, 3, 4, 5].map(|count| third_least_q6(&matches[..count])),
        [None, Some(9), Some(5), Some(5)]
    );
}

#[test]
fn a_flag_stays_until_pairs_were_free_of_it() {
    let (limits, mut monitor) =
        (HealthLimits { clear_after: 2, ..HealthLimits::DEFAULT }, HealthMonitor::new());
    let (torn, none) = (HealthFlags::TORN, HealthFlags::GOOD);
    // Raised, free of it, not tested, free of it, not tested.
    let flags = [(torn, torn), (none, torn), (none, none), (none, torn), (none, none)]
        .map(|(now, tested)| monitor.hold(&limits, now, tested));
    assert_eq!(flags, [torn, torn, torn, none, none]);
}

#[test]
fn differences_of_rows_are_a_mean_at_first_and_exponential_later() {
    let (limits, mut monitor) =
        (HealthLimits { row_pairs: (2, 4), ..HealthLimits::DEFAULT }, HealthMonitor::new());
    let means = [256, 0, 64, 64, 64].map(|offset_q8| {
        monitor.smooth(&limits, offset_q8);
        [monitor.short_q16 >> 8, monitor.long_q16 >> 8]
    });
    assert_eq!(means, [[256, 256], [128, 128], [96, 106], [80, 96], [72, 88]]);
}

const DIMS: crate::Dims = crate::Dims { width: 16, height: 16 };

/// Matches, without support points.
fn findings<'a>(matches: &'a [Match], counts: &'a Counts) -> Findings<'a> {
    let support = Support::new(&crate::Params::DEFAULT, DIMS, &[], 0);
    Findings {
        matches,
        counts,
        support,
        range: RangeCheck::default(),
        noise: Default::default(),
        row_offset: 0,
        has_segments: true,
        is_whole: true,
    }
}

#[test]
fn rows_are_reported_rounded_and_flagged_where_they_were_measured_alone() {
    let pixels = [0; 256];
    let images = [Gray::new(&pixels, DIMS, 16).unwrap(); 2];
    let mut monitor =
        HealthMonitor { short_q16: 100 * 256 + 128, long_q16: 40 * 256, ..HealthMonitor::new() };
    let mut reported = |pairs| {
        let mut health = PairHealth::default();
        monitor.pairs = pairs;
        let flags = monitor.check_rows(
            &HealthLimits::DEFAULT,
            images[0].dims(),
            &findings(&[], &Counts::default()),
            None,
            None,
            &mut health,
        );
        assert_eq!(flags, (HealthFlags::GOOD, HealthFlags::GOOD), "no match measures them");
        (health.row_offset_q8, health.row_drift_q8)
    };
    assert_eq!(
        [0, 1, SETTLED - 1].map(&mut reported),
        [(None, None), (Some(101), None), (Some(101), None)]
    );
    assert_eq!(reported(SETTLED), (Some(101), Some(61)));
}

/// The report on edges that fall, the right image moved down from a row on.
fn falling(
    monitor: &mut HealthMonitor,
    limits: &HealthLimits,
    moved: i32,
    from: i32,
) -> (HealthFlags, PairHealth) {
    let mut health = PairHealth::default();
    let ([left, right], edges) = rows::tests::falling(moved, from);
    let [left, right] = [rows::tests::view(&left), rows::tests::view(&right)];
    let counts = Counts::default();
    let found = findings(&edges, &counts);
    let measured = rows::measure(left, right, &edges);
    let (now, _) = monitor.check_rows(limits, left.dims(), &found, None, measured, &mut health);
    (now, health)
}

#[test]
fn even_rows_are_smoothed_and_uneven_ones_flagged() {
    let limits = HealthLimits { min_row_samples: 4, ..HealthLimits::DEFAULT };
    let of = |moved, from| {
        let (now, health) = falling(&mut HealthMonitor::new(), &limits, moved, from);
        (now, health.row_offset_q8)
    };
    let (off, far) = (HealthFlags::ROWS_OFF, HealthFlags::ROWS_OFF | HealthFlags::ROWS_FAR);
    assert_eq!(
        [0, 1, -2].map(|moved| of(moved, -100)),
        [(HealthFlags::GOOD, Some(0)), (off, Some(256)), (far, Some(-512))]
    );
    assert_eq!(of(2, 45), (HealthFlags::ROWS_UNEVEN, None), "the lower two of four edges");
}

#[test]
fn rows_drift_beyond_a_difference_from_their_long_mean() {
    // Sixteen pairs with rows at this difference, 1/256 px, then one at none: both means are
    // those of all pairs.
    let limits = HealthLimits { min_row_samples: 4, row_pairs: (1, 1024), ..HealthLimits::DEFAULT };
    let drifts = |before_q8: i16| {
        let mut monitor = HealthMonitor::new();
        (0..SETTLED).for_each(|_| monitor.smooth(&limits, before_q8));
        let (now, health) = falling(&mut monitor, &limits, 0, 0);
        (now.contains(HealthFlags::ROWS_DRIFT), health.row_drift_q8)
    };
    // Of the long mean a seventeenth is new: 40 * 16 / 17 is 37.6, 41 * 16 / 17 is 38.6, and 38
    // the limit.
    assert_eq!(
        [40, 41, -40, -41].map(drifts),
        [(false, Some(-38)), (true, Some(-39)), (false, Some(38)), (true, Some(39))]
    );
}

#[test]
fn exposures_differ_beyond_their_ratio() {
    let differ = |left: u8, right: u8| {
        let pixels = [left, right]
            .map(|level| -> [u8; 256] { core::array::from_fn(|i| level + (i % 2 * 8) as u8 - 4) });
        let images = pixels.each_ref().map(|pixels| Gray::new(pixels, DIMS, 16).unwrap());
        HealthMonitor::new().check_images(&HealthLimits::DEFAULT, images[0], images[1], None).now
    };
    let flag = HealthFlags::EXPOSURES_DIFFER;
    let found = [differ(100, 100), differ(100, 175), differ(100, 176), differ(176, 100)];
    assert_eq!(found, [HealthFlags::GOOD, HealthFlags::GOOD, flag, flag]);
}

#[test]
fn what_is_matched_has_limits_that_raise_flags_beyond_them() {
    let noise = still::tests::noise(1);
    let image = Gray::new(&noise, still::tests::DIMS, 128).unwrap();
    // An eighth without parallax, the others at 10 px; both images are one.
    let points: [_; still::tests::GRID] =
        core::array::from_fn(|i| SupportPoint::matched(if i % 8 == 0 { 0 } else { 640 }, 0xffff));
    let matches = [rows::tests::matched([(0, 0); 2], [-64; 2]); 3];
    let mut counts = Counts::default();
    (counts.segments_left, counts.matched) = (100, 3);
    let mut range = RangeCheck::default();
    (range.beyond, range.windows) = (5, 100);
    let support = Support::new(&crate::Params::default(), still::tests::DIMS, &points, 0);
    let findings = Findings {
        matches: &matches,
        counts: &counts,
        support,
        range,
        noise: Default::default(),
        row_offset: 0,
        has_segments: true,
        is_whole: true,
    };
    let raised = |limits: &HealthLimits, before| {
        let mut health = PairHealth { now: before, ..PairHealth::default() };
        HealthMonitor::new().check_matches(limits, [image; 2], &findings, &mut health);
        (health.now, health.still.unwrap().pattern_permille)
    };
    let (_, pattern_permille) = raised(&HealthLimits::DEFAULT, HealthFlags::GOOD);
    let limits = HealthLimits {
        still_permille: 125,
        pattern_permille,
        least_disparity_q6: -64,
        unwitnessed_permille: 30,
        beyond_range_permille: 51,
        // Both images are one: no match is one.
        row_region_q8: u16::MAX,
        row_limit_q8: u16::MAX,
        ..HealthLimits::DEFAULT
    };
    let now = |limits| raised(&limits, HealthFlags::GOOD).0;
    assert_eq!(now(limits), HealthFlags::GOOD);
    assert_eq!(now(HealthLimits { still_permille: 124, ..limits }), HealthFlags::NO_PARALLAX);
    assert_eq!(
        now(HealthLimits { pattern_permille: pattern_permille - 1, ..limits }),
        HealthFlags::SAME_PIXEL
    );
    assert_eq!(
        now(HealthLimits { least_disparity_q6: -63, ..limits }),
        HealthFlags::BEYOND_INFINITY
    );
    assert_eq!(now(HealthLimits { unwitnessed_permille: 31, ..limits }), HealthFlags::FEW_MATCHES);
    let are_credible = |credible_permille, agree: Option<u8>| {
        let by_points =
            agree.map(|agree| Evenness { offset_q8: 0, spread_q8: 0, samples: 50, agree });
        super::are_credible(support, by_points, &HealthLimits { credible_permille, ..limits })
    };
    assert!(are_credible(999, Some(35)) && !are_credible(1000, Some(35)));
    assert!(!are_credible(999, Some(34)) && !are_credible(999, None), "rows do not agree");
    let small = HealthLimits { beyond_range_permille: 50, ..limits };
    assert_eq!(now(small), HealthFlags::RANGE_SMALL);
    assert_eq!(
        raised(&small, HealthFlags::LEFT_DEAD).0,
        HealthFlags::LEFT_DEAD,
        "a fault of a camera does the same"
    );
    let darker = HealthFlags::EXPOSURES_DIFFER;
    assert_eq!(raised(&small, darker).0, darker | HealthFlags::RANGE_SMALL, "one darker image");
}

/// Faults of the left camera beside a right one of level 100 and detail 10.
fn faults(health: CameraHealth, is_flat: bool) -> HealthFlags {
    let check = |health, is_flat| camera::CameraCheck { health, is_flat, digest: 1 };
    let usual =
        CameraHealth { level: 100, detail_q4: 160, view_permille: 1000, ..CameraHealth::default() };
    HealthMonitor::new().fault(
        &HealthLimits::DEFAULT,
        &check(health, is_flat),
        &check(usual, false),
        0,
    )
}

#[test]
fn a_camera_is_covered_when_it_is_black_or_plain_beside_the_other() {
    let camera = |level, detail_q4| CameraHealth {
        level,
        detail_q4,
        view_permille: 1000,
        ..CameraHealth::default()
    };
    let is_covered = |health| faults(health, false).contains(HealthFlags::LEFT_COVERED);
    assert_eq!([11, 12].map(|level| is_covered(camera(level, 160))), [true, false], "black");
    // A third of the other's detail, at half its level a sixth.
    assert_eq!([53, 54].map(|detail_q4| is_covered(camera(100, detail_q4))), [true, false]);
    assert_eq!(
        [79, 80].map(|detail_q4| is_covered(camera(150, detail_q4))),
        [true, false],
        "the limit itself is none"
    );
    assert_eq!([26, 27].map(|detail_q4| is_covered(camera(50, detail_q4))), [true, false]);
    let overexposed = CameraHealth { white_permille: 251, ..camera(100, 0) };
    assert_eq!(
        [250, 251].map(|white_permille| is_covered(CameraHealth { white_permille, ..overexposed })),
        [true, false]
    );
    assert_eq!(faults(camera(100, 0), true), HealthFlags::LEFT_DEAD, "flat is dead, not covered");
}

#[test]
fn levels_saturation_and_view_have_limits() {
    let usual =
        CameraHealth { level: 100, detail_q4: 160, view_permille: 1000, ..CameraHealth::default() };
    assert_eq!(faults(usual, false), HealthFlags::GOOD);
    for (level, is_good) in [(19, false), (20, true), (235, true), (236, false)] {
        assert_eq!(
            faults(CameraHealth { level, ..usual }, false) == HealthFlags::GOOD,
            is_good,
            "{level}"
        );
    }
    for (black_permille, white_permille, flag) in
        [(150, 100, HealthFlags::GOOD), (150, 101, HealthFlags::LEFT_SATURATED)]
    {
        assert_eq!(faults(CameraHealth { black_permille, white_permille, ..usual }, false), flag);
    }
    assert_eq!(faults(CameraHealth { view_permille: 500, ..usual }, false), HealthFlags::GOOD);
    assert_eq!(faults(CameraHealth { view_permille: 499, ..usual }, false), HealthFlags::LEFT_VIEW);
}
