//! The dense methods: each against its definition, and all of them on drawn pairs.

use linestereo::Dims;
use linestereo_baselines::{DisparityMap, Method, Search, StereoBm};
use linestereo_frames::GrayImage;
use linestereo_sim::scene::Kind;
use linestereo_tests::drawn::{Random, painted, rendered};
use linestereo_tests::reference::{at, census};

/// Disparities of the small pairs.
const COUNT: usize = 16;

/// Random greys.
fn noise(width: u16, height: u16, seed: u64) -> GrayImage {
    let mut random = Random(seed);
    painted(width, height, |_, _| random.grey())
}

/// Noise as both cameras see it: a near square before a wall, 11 px and 4 px.
fn square_before_a_wall(width: u16, height: u16, seed: u64) -> [GrayImage; 2] {
    let (left, mut right) = (noise(width, height, seed), noise(width, height, seed + 1));
    // Nearer surfaces cover farther ones, so they come last.
    for shift in [4, 11] {
        for (x, y) in (shift..width)
            .flat_map(|x| (0..height).map(move |y| (x, y)))
            .filter(|&at| true_at(at) == shift)
        {
            let at = |x: u16| usize::from(y) * usize::from(width) + usize::from(x);
            right.pixels[at(x - shift)] = left.pixels[at(x)];
        }
    }
    [left, right]
}

fn true_at((x, y): (u16, u16)) -> u16 {
    if (40..70).contains(&x) && (16..48).contains(&y) { 11 } else { 4 }
}

/// Costs of left pixels at disparities from 0, for the columns that have all of them.
type Curves<'a> = &'a dyn Fn(i32, i32) -> Vec<i32>;

/// The best disparity: the largest of equals.
fn best(costs: &[i32]) -> usize {
    let lowest = costs.iter().min().unwrap();
    costs.iter().rposition(|cost| cost == lowest).unwrap()
}

/// Disparity and confidence of a curve, by the definition.
fn refined(costs: &[i32]) -> (f32, f32) {
    let d = best(costs);
    let elsewhere = costs.iter().enumerate().filter(|(other, _)| other.abs_diff(d) > 1);
    let second = elsewhere.map(|(_, &cost)| cost).min().unwrap();
    let mut disparity = d as f32;
    if (1..COUNT - 1).contains(&d) {
        let [before, after] = [costs[d - 1], costs[d + 1]];
        disparity += (before - after) as f32 / (2 * (before.max(after) - costs[d])) as f32;
    }
    (disparity, if second == 0 { 0.0 } else { 1.0 - costs[d] as f32 / second as f32 })
}

/// Sums of Hamming distances over windows of `half` px to each side.
fn census_costs([left, right]: &[GrayImage; 2], half: i32, x: i32, y: i32) -> Vec<i32> {
    let cost = |d: i32| {
        let window = (-half..=half).flat_map(|dy| (-half..=half).map(move |dx| (x + dx, y + dy)));
        window
            .map(|(x, y)| (census(left, x, y) ^ census(right, x - d, y)).count_ones() as i32)
            .sum()
    };
    (0..COUNT as i32).map(cost).collect()
}

/// Compares disparities and confidences, and how many there are at least.
fn check(map: &DisparityMap, least: usize, expected: impl Fn(i32, i32) -> Option<(f32, f32)>) {
    let Dims { width, height } = map.dims();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let at = (usize::from(x), usize::from(y));
        let found = map.at(at.0, at.1).map(|disparity| (disparity, map.confidence(at.0, at.1)));
        assert_eq!(found, expected(x.into(), y.into()), "at {x}, {y}");
    }
    assert!(map.count() >= least, "only {} disparities: the test says little", map.count());
}

#[test]
fn census_blocks_are_what_their_head_says() {
    let pair = square_before_a_wall(60, 24, 5);
    let map = Method::Census.run(&pair[0], &pair[1], COUNT as u16);
    check(&map, 100, |x, y| {
        let inside = (15 + 7..60 - 7).contains(&x) && (7..24 - 7).contains(&y);
        inside
            .then(|| refined(&census_costs(&pair, 7, x, y)))
            .filter(|&(_, confidence)| confidence >= 15.0 / 115.0)
    });
}

/// The values of the path that comes in direction `step` from the border of the searched pixels.
fn path(curves: Curves<'_>, dims: Dims, (x, y): (i32, i32), step: (i32, i32)) -> Vec<i32> {
    let before = |k: i32| (x - k * step.0, y - k * step.1);
    let searched = |(x, y): (i32, i32)| {
        (COUNT as i32 - 1..dims.width.into()).contains(&x) && (0..dims.height.into()).contains(&y)
    };
    let length = (0..).take_while(|&k| searched(before(k))).count() as i32;
    (0..length).rev().fold(vec![0; COUNT], |values, k| {
        let (x, y) = before(k);
        let low = *values.iter().min().unwrap();
        let at = |d: usize| values.get(d).copied().unwrap_or(i32::MAX / 2);
        let next = |(d, cost): (usize, i32)| {
            cost - low + at(d).min(at(d + 1) + 60).min(at(d.wrapping_sub(1)) + 60).min(low + 240)
        };
        curves(x, y).into_iter().enumerate().map(next).collect()
    })
}

#[test]
fn semi_global_matching_is_what_its_head_says() {
    let pair = square_before_a_wall(54, 23, 7);
    let dims = pair[0].dims;
    let (width, height) = (i32::from(dims.width), i32::from(dims.height));
    let first = COUNT as i32 - 1;
    let searched = || (0..height).flat_map(|y| (first..width).map(move |x| (x, y)));
    let index = |x: i32, y: i32| (y * (width - first) + x - first) as usize;
    let costs: Vec<Vec<i32>> = searched().map(|(x, y)| census_costs(&pair, 2, x, y)).collect();
    let curves: Curves<'_> = &|x, y| costs[index(x, y)].clone();
    let steps: Vec<(i32, i32)> = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))).collect();
    let sum = |at: (i32, i32)| {
        steps.iter().filter(|&&step| step != (0, 0)).fold(vec![0; COUNT], |sums, &step| {
            sums.into_iter()
                .zip(path(curves, dims, at, step))
                .map(|(sum, value)| sum + value)
                .collect()
        })
    };
    let sums: Vec<Vec<i32>> = searched().map(sum).collect();
    // Of a right pixel the disparity of the left one that costs least, the largest of equals.
    let right_best = |right: i32, y: i32| {
        let seen = (0..COUNT as i32).filter(|d| (first..width).contains(&(right + d)));
        seen.min_by_key(|&d| (sums[index(right + d, y)][d as usize], -d)).unwrap()
    };
    for (method, least, least_confidence) in
        [(Method::Sgm8, 400, 0.0), (Method::Sgm8Strict, 100, 0.8)]
    {
        check(&method.run(&pair[0], &pair[1], COUNT as u16), least, |x, y| {
            let sums = (x >= first).then(|| &sums[index(x, y)])?;
            let d = best(sums) as i32;
            let is_agreed = right_best(x - d, y).abs_diff(d) <= 1;
            Some(refined(sums))
                .filter(|&(_, confidence)| is_agreed && confidence >= least_confidence)
        });
    }
}

/// The block matcher of OpenCV by its definition, without sliding anything.
#[test]
fn stereo_bm_is_what_its_head_says() {
    let pair = rendered(Kind::Boxes, Dims { width: 96, height: 49 }, 2.0, 3);
    let search = Search::up_to(pair.left.dims, COUNT as u16);
    let value = |image: &GrayImage, x: i32, y: i32| {
        if x == 0 || x == 95 || y == 48 {
            return 0; // an odd last row is not filtered
        }
        // Above the first row lies the second.
        let row = |dy: i32| if y + dy < 0 { 1 } else { y + dy };
        let step = |dy: i32| at(image, x + 1, row(dy)) - at(image, x - 1, row(dy));
        (step(-1) + 2 * step(0) + step(1)).clamp(-31, 31)
    };
    let around =
        |x: i32, y: i32| (-7..=7).flat_map(move |dy| (-7..=7).map(move |dx| (x + dx, y + dy)));
    let map = StereoBm { texture_threshold: 1000, uniqueness_ratio: 20 }.run(
        &pair.left,
        &pair.right,
        search,
    );
    check(&map, 300, |x, y| {
        let inside = (15 + 7..96 - 7).contains(&x) && (7..49 - 7).contains(&y);
        if !inside || around(x, y).map(|(x, y)| value(&pair.left, x, y).abs()).sum::<i32>() < 1000 {
            return None;
        }
        let cost = |d: i32| {
            around(x, y)
                .map(|(x, y)| (value(&pair.left, x, y) - value(&pair.right, x - d, y)).abs())
                .sum::<i32>()
        };
        let costs: Vec<i32> = (0..COUNT as i32).map(cost).collect();
        let d = best(&costs);
        let is_unique = |(other, &cost): (usize, &i32)| {
            other.abs_diff(d) <= 1 || cost > costs[d] + costs[d] * 20 / 100
        };
        let mut value = d as i32 * 256 + 15;
        if (1..COUNT - 1).contains(&d) {
            let [before, after] = [costs[d - 1], costs[d + 1]];
            value += (before - after) * 256 / (2 * (before.max(after) - costs[d]));
        }
        let found = ((value >> 4) as f32 / 16.0, refined(&costs).1);
        costs.iter().enumerate().all(is_unique).then_some(found)
    });
}

#[test]
fn every_method_sees_a_square_before_a_wall() {
    let [left, right] = square_before_a_wall(96, 64, 11);
    for method in Method::ALL {
        let map = method.run(&left, &right, COUNT as u16);
        let right = |&(x, y): &(u16, u16)| {
            let found = map.at(x.into(), y.into());
            found.is_some_and(|d| (d - f32::from(true_at((x, y)))).abs() <= 0.5)
        };
        let pixels = (0..64).flat_map(|y| (0..96).map(move |x| (x, y)));
        let share = pixels.filter(right).count() as f64 / map.count() as f64;
        let (least_share, least_count) = match method {
            // A window of 15 px sees two surfaces 7 px around the square.
            Method::Bm | Method::BmStrict => (0.8, 1200),
            Method::Census => (0.8, 2500),
            Method::Sgm8 | Method::Sgm8Strict => (0.93, 3500),
        };
        assert!(
            share >= least_share && map.count() >= least_count,
            "{method:?}: {share:.3} of {}",
            map.count()
        );
    }
}

#[test]
fn uniqueness_refuses_repetition() {
    // Stripes of 4 px: every fourth disparity is as good. Paths of sgm tell what the image's border
    // says: it may answer.
    let stripes = painted(96, 40, |x, _| if x % 4 < 2 { 40 } else { 200 });
    for method in [Method::Bm, Method::Census] {
        let map = method.run(&stripes, &stripes, COUNT as u16);
        // A window that touches the image's border sees it, and the border is unique.
        let found = (8..32)
            .flat_map(|y| (0..84).map(move |x| (x, y)))
            .filter(|&(x, y)| map.at(x, y).is_some())
            .count();
        assert_eq!(found, 0, "{method:?}");
    }
}

#[test]
fn images_too_small_for_a_search_have_no_disparities() {
    let tiny = noise(16, 16, 1);
    for method in Method::ALL {
        assert_eq!(method.run(&tiny, &tiny, 32).count(), 0, "{method:?}");
    }
}
