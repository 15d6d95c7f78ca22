//! Kernels against naive oracles: every tail length, random and extreme rows, exact equality.

use linestereo::unstable::kernel::{
    CODE_FLAT, CODE_ROWS, CodeColumn, CodeMoments, Crossing, Crossings, FLAT, JUMP_PENALTY, LANES,
    LargestStep, Products, RUN_PIXELS, STRIP, Strip, add_products, census_row, code_columns,
    code_costs, code_moments, code_steps, crossing, gradient_row, hamming_curve, largest_step,
    limited_steps, lower_curve, lower_sum_curve, lowest, portable, reverse_row, row_difference,
    sad_curve, second_differences, sum_curve,
};
use linestereo_rig::kernel::{
    CELL, Knot, Ring, Run, bilinear, bilinear_cells, bilinear_runs, weigh_knots,
};
use linestereo_tests::drawn::{Random, painted};
use linestereo_tests::reference::{at, between, sobel};

/// Rows of an image of every width from 1 to 70: random, black, white, and black and white in turn.
fn rows(count: usize) -> Vec<Vec<Vec<u8>>> {
    let mut random = Random(1);
    let mut images = Vec::new();
    for width in 1..=70 {
        images.push((0..count).map(|_| (0..width).map(|_| random.grey()).collect()).collect());
        images.push(vec![vec![0; width]; count]);
        images.push(vec![vec![255; width]; count]);
        images.push(
            (0..count)
                .map(|y| (0..width).map(|x| if (x + y) % 2 == 0 { 255 } else { 0 }).collect())
                .collect(),
        );
    }
    images
}

#[test]
fn gradient_is_a_quarter_of_the_clipped_sobel() {
    for rows in rows(3) {
        let width = rows[0].len();
        let image = painted(width as u16, 3, |x, y| rows[usize::from(y)][usize::from(x)]);
        let mut found = vec![7; width];
        gradient_row(&rows[0], &rows[1], &rows[2], &mut found);
        for (x, &found) in found.iter().enumerate() {
            let found = i32::from(found) - i32::from(FLAT);
            if x == 0 || x + 1 == width {
                assert_eq!(found, 0, "column {x} of {rows:?}");
                continue;
            }
            // Two means, each of which two halvings rounded down: by three quarters at most.
            let sobel = sobel(&image, x as i32, 1).0;
            let exact = sobel.clamp(-31 * 4, 31 * 4);
            assert!(
                (4 * found - exact).abs() <= 3,
                "column {x} of {rows:?}: {found} for {sobel}/4"
            );
            let mean = |x: usize| {
                let [a, b, c] = [0, 1, 2].map(|y| i32::from(rows[y][x]));
                ((a + c).div_euclid(2) + b).div_euclid(2)
            };
            assert_eq!(found, (mean(x + 1) - mean(x - 1)).clamp(-31, 31), "column {x} of {rows:?}");
        }
    }
}

#[test]
fn census_tells_the_darker_neighbours_at_distance_two() {
    const NEIGHBOURS: [(i32, i32); 8] =
        [(-2, -2), (0, -2), (2, -2), (-2, 0), (2, 0), (-2, 2), (0, 2), (2, 2)];
    for rows in rows(5) {
        let width = rows[0].len();
        let image = painted(width as u16, 5, |x, y| rows[usize::from(y)][usize::from(x)]);
        let mut found = vec![7; width];
        census_row([&rows[0], &rows[2], &rows[4]], &mut found);
        for (x, &found) in found.iter().enumerate() {
            let expected = if x < 2 || x + 2 >= width {
                0
            } else {
                let x = x as i32;
                let is_darker =
                    NEIGHBOURS.map(|(dx, dy)| at(&image, x + dx, 2 + dy) < at(&image, x, 2));
                is_darker
                    .into_iter()
                    .zip(0..)
                    .map(|(is_darker, bit)| u8::from(is_darker) << bit)
                    .sum()
            };
            assert_eq!(found, expected, "column {x} of {rows:?}");
        }
    }
}

#[test]
fn window_curves_are_sums_of_absolute_differences() {
    let mut random = Random(2);
    for count in 0..=34 {
        for blocks in 0..=16 {
            let len = blocks * LANES;
            let needed = len + STRIP - 1;
            // Strips that are too short are left out.
            let others: Vec<Vec<u8>> = (0..count)
                .map(|i| if i % 7 == 3 { len / 2 } else { needed + count % 3 })
                .map(|pixels| (0..pixels).map(|_| 1 + random.below(127) as u8).collect())
                .collect();
            let strips: Vec<Strip<'_>> = others
                .iter()
                .map(|other| Strip {
                    reference: [0; STRIP].map(|_| 1 + random.below(127) as u8),
                    other,
                })
                .collect();
            let naive = |d: usize| -> u16 {
                strips
                    .iter()
                    .filter(|strip| strip.other.len() >= needed)
                    .flat_map(|s| {
                        s.reference
                            .iter()
                            .zip(&s.other[d..])
                            .map(|(&a, &b)| u16::from(a.abs_diff(b)))
                    })
                    .sum()
            };
            let expected: Vec<u16> = (0..len).map(|d| 5 + naive(d)).collect();
            for kernel in [sad_curve, portable::sad_curve] {
                let mut found = vec![5; len];
                kernel(&strips, &mut found);
                assert_eq!(found, expected, "{count} strips, {len} disparities");
            }
        }
    }
}

#[test]
fn census_curves_are_sums_of_hamming_distances() {
    let mut random = Random(3);
    for count in 0..=31 {
        for blocks in 0..=16 {
            let len = blocks * LANES;
            let others: Vec<Vec<u8>> =
                (0..count).map(|_| (0..len + 1).map(|_| random.grey()).collect()).collect();
            let points: Vec<(u8, &[u8])> =
                others.iter().map(|other| (random.grey(), &other[..])).collect();
            let mut found = vec![9; len];
            hamming_curve(&points, &mut found);
            let expected: Vec<u16> = (0..len)
                .map(|d| {
                    9 + points.iter().map(|(r, o)| (r ^ o[d]).count_ones() as u16).sum::<u16>()
                })
                .collect();
            assert_eq!(found, expected, "{count} points, {len} disparities");
        }
    }
}

#[test]
fn curves_are_combined_entry_by_entry() {
    let mut random = Random(4);
    for len in 0..=70 {
        let mut curve = || -> Vec<u16> {
            let entry = |random: &mut Random| match random.below(8) {
                0 => u16::MAX,
                _ => u16::from_le_bytes([random.grey(), random.grey()]),
            };
            (0..len).map(|_| entry(&mut random)).collect()
        };
        let (a, b, c) = (curve(), curve(), curve());
        let combined = |kernel: &dyn Fn(&mut [u16])| {
            let mut out = vec![7; len];
            kernel(&mut out);
            out
        };
        let each = |f: &dyn Fn(u32, u32, u32) -> u32| -> Vec<u16> {
            let wide = |i: usize| f(a[i].into(), b[i].into(), c[i].into()).min(0xffff) as u16;
            (0..len).map(wide).collect()
        };
        assert_eq!(combined(&|out| sum_curve(&a, &b, out)), each(&|a, b, _| a + b), "{a:?} {b:?}");
        assert_eq!(
            combined(&|out| lower_curve(&a, &b, out)),
            each(&|a, b, _| a.min(b)),
            "{a:?} {b:?}"
        );
        assert_eq!(
            combined(&|out| lower_sum_curve(&a, &b, &c, out)),
            each(&|a, b, c| a.min(b) + c),
            "{a:?} {b:?} {c:?}"
        );
        assert_eq!(lowest(&a), a.iter().copied().min().unwrap_or(u16::MAX), "{a:?}");
    }
}

#[test]
fn rows_are_reversed() {
    for rows in rows(1) {
        let mut found = rows[0].clone();
        reverse_row(&mut found);
        assert_eq!(found, rows[0].iter().rev().copied().collect::<Vec<_>>());
    }
}

#[test]
fn the_largest_step_is_the_first_of_the_largest() {
    for rows in rows(1) {
        let row = &rows[0];
        for stride in 1..=5 {
            for count in 0..=row.len() / stride + 2 {
                let sequence: Vec<i32> =
                    row.iter().step_by(stride).take(count).map(|&pixel| pixel.into()).collect();
                let steps: Vec<i32> = sequence.windows(2).map(|two| two[1] - two[0]).collect();
                let size = steps.iter().map(|step| step.abs()).max().unwrap_or(0);
                let place =
                    steps.iter().position(|step| step.abs() == size && size > 0).unwrap_or(0);
                let expected = LargestStep {
                    place: place as i32,
                    step: if size > 0 { steps[place] } else { 0 },
                };
                assert_eq!(
                    largest_step(row, stride, count),
                    expected,
                    "{count} of {row:?}, {stride} apart"
                );
            }
        }
    }
}

#[test]
fn a_crossing_is_the_strongest_of_three_gradients() {
    let mut random = Random(5);
    for round in 0..2000 {
        // Seven pixels across an edge, in two neighbouring rows; a few levels only, so that ties
        // occur.
        let levels = if round % 2 == 0 { 4 } else { 256 };
        let across: Vec<[i32; 2]> =
            (0..7).map(|_| [0, 0].map(|_| random.below(levels) as i32)).collect();
        for sign in [1, -1] {
            let gradient = |u: usize| {
                sign * (across[u + 1].iter().sum::<i32>() - across[u - 1].iter().sum::<i32>())
            };
            let three = [gradient(2), gradient(3), gradient(4)];
            let shift = if three[1] == *three.iter().max().unwrap() {
                0
            } else if three[0] >= three[2] {
                -1
            } else {
                1
            };
            let at = (3 + shift) as usize;
            let step = |u: usize| across[u][1] - across[u][0];
            let expected = Some(Crossing {
                shift,
                gradients: [gradient(at - 1), gradient(at), gradient(at + 1)],
                along: step(at - 1) + 2 * step(at) + step(at + 1),
            });
            let rows: Vec<u8> =
                (0..2).flat_map(|k| across.iter().map(move |pair| pair[k] as u8)).collect();
            assert_eq!(crossing(&Crossings::of_rows(&rows, 7), 0, sign), expected, "{across:?}");
            let columns: Vec<u8> = across.iter().flatten().map(|&pixel| pixel as u8).collect();
            assert_eq!(
                crossing(&Crossings::of_columns(&columns, 2), 0, sign),
                expected,
                "{across:?}"
            );
            assert_eq!(
                crossing(&Crossings::of_rows(&rows, 7), 1, sign),
                None,
                "beyond the last row"
            );
            assert_eq!(
                crossing(&Crossings::of_columns(&columns, 2), 1, sign),
                None,
                "beyond the last column"
            );
        }
    }
}

#[test]
fn products_of_gradients_are_summed_at_five_lags() {
    let mut random = Random(6);
    for round in 0..500 {
        let mut pixels = || {
            [0; 22]
                .map(|_| if round % 3 == 0 { 255 * random.below(2) as u8 } else { random.grey() })
        };
        // The left row of ten pixels lies over the middle of the right one.
        let (left, right) = (pixels(), pixels());
        let expected = [255, 12].map(|most| {
            let gradients = |row: [u8; 22]| -> Vec<i32> {
                row.windows(3)
                    .map(|three| (i32::from(three[2]) - i32::from(three[0])).clamp(-most, most))
                    .collect()
            };
            let (left, right) = (gradients(left), gradients(right));
            let sum =
                |lag: i32| (6..14).map(|x| left[x] * right[(x as i32 + lag) as usize]).sum::<i32>();
            let energy = (6..14).map(|x| left[x].pow(2) + right[x].pow(2)).sum::<i32>();
            Products { at_lags: [0, -6, -4, 4, 6].map(sum), energy }
        });
        let mut found = [Products::default(); 2];
        add_products(left[6..16].try_into().unwrap(), &right, &mut found);
        assert_eq!(found, expected, "{left:?} {right:?}");
        add_products(left[6..16].try_into().unwrap(), &right, &mut found);
        assert_eq!(found[1].energy, 2 * expected[1].energy, "added to what was there");
    }
}

#[test]
fn grey_levels_between_pixels_are_rounded_to_the_nearest() {
    let mut random = Random(9);
    for round in 0..20_000 {
        let four = [0; 4].map(|_| {
            if round % 5 == 0 { [0, 255][random.below(2) as usize] } else { random.grey() }
        });
        let [a, b, c, d] = four;
        let (fx, fy) = match round % 4 {
            0 => ([0, 128][random.below(2) as usize], [0, 1 << 14][random.below(2) as usize]),
            _ => (random.below(129) as i32, random.below((1 << 14) + 1) as i32),
        };
        let rows = [[a, b], [c, d]].map(|row| row.map(i32::from));
        let exact = between(rows, f64::from(fx) / 128.0, f64::from(fy) / 16384.0);
        let found = f64::from(bilinear([a, b], [c, d], fx, fy));
        assert!((found - exact).abs() <= 0.5, "{four:?} at {fx}, {fy}: {found} for {exact}");
    }
}

#[test]
fn runs_follow_their_lines() {
    let mut random = Random(10);
    let (width, rows) = (60_usize, 9_usize);
    for round in 0..500 {
        let pixels: Vec<u8> = (0..width * rows).map(|_| random.grey()).collect();
        let count = 1 + random.below(6) as usize;
        let mut runs = Vec::new();
        for _ in 0..count {
            let length = 1 + random.below(20) as u32;
            // From anywhere to anywhere, backwards as well.
            let [x0, x1] = [0; 2].map(|_| random.below((width as u64 - 1) << 16) as i32);
            let [y0, y1] = [0; 2].map(|_| random.below(1 << 14) as i32);
            let steps = (length as i32 - 1).max(1);
            let [top, bottom] = [0; 2].map(|_| (random.below(rows as u64) * width as u64) as u32);
            let (dx_q16, dfy_q14) = ((x1 - x0) / steps, (y1 - y0) / steps);
            // A parabola, where it stays between both ends.
            let ddx_q16 = if dx_q16.abs() > 6000 { random.below(500) as i32 - 250 } else { 0 };
            let dx_q16 = dx_q16 - ddx_q16 * (steps - 1) / 2;
            runs.push(Run { top, bottom, x_q16: x0, dx_q16, ddx_q16, fy_q14: y0, dfy_q14, length });
        }
        let total: u32 = runs.iter().map(|run| run.length).sum();
        let mut found = vec![77; total as usize + 3];
        bilinear_runs(&pixels, width, &runs, &mut found);
        let mut places = found.iter();
        for run in &runs {
            for i in 0..run.length as i32 {
                let growth = run.ddx_q16 * (i * (i - 1) / 2);
                let (x, fy) = (run.x_q16 + i * run.dx_q16 + growth, run.fy_q14 + i * run.dfy_q14);
                let column = (x >> 16) as usize;
                let two = |start: u32| [0, 1].map(|k| pixels[start as usize + column + k].into());
                let fx = f64::from(x & 0xffff) / 65536.0;
                let exact = between([two(run.top), two(run.bottom)], fx, f64::from(fy) / 16384.0);
                let found = f64::from(*places.next().unwrap());
                // The fraction across is cut to 1/128: up to 255/128 levels.
                assert!(
                    (found - exact).abs() <= 0.5 + 255.0 / 128.0,
                    "round {round}: {found} for {exact}"
                );
            }
        }
        assert!(places.all(|&beyond| beyond == 77));
    }
}

#[test]
fn cells_follow_their_knots_round_the_ring() {
    let mut random = Random(11);
    let (width, rows) = (120_usize, 12_usize);
    for round in 0..300 {
        let first = random.below(40) as i32;
        let image: Vec<Vec<u8>> =
            (0..rows).map(|_| (0..width).map(|_| random.grey()).collect()).collect();
        // Row `first` lies at the start, those before it at the end: the ring holds `first - 4 ..
        // first + 8`.
        let oldest = first - 4;
        let row = |y: i32| &image[(y - oldest) as usize];
        let bytes: Vec<u8> = (first..first + 8)
            .chain(oldest..first)
            .flat_map(|y| row(y).clone())
            .chain([0; 400])
            .collect();
        // Three cells from column 20 to 68 and a row that moves by up to 3 px a cell, bent and back
        // again.
        let lean = random.below(7) as i32 - 3;
        let bend = random.below(40_000) as i32 - 20_000;
        let knot = |i: i32| Knot {
            x: (20 + 16 * i) * 65536 + bend * i * i / 9,
            y: (first + lean * i) * 65536 + 9000,
        };
        let knots: Vec<Knot> = (-1..=4)
            .map(knot)
            .filter(|knot| ((oldest << 16)..(first + 7) << 16).contains(&knot.y))
            .collect();
        let cells = knots.len().saturating_sub(3);
        let mut found = vec![77; cells * CELL + 2];
        bilinear_cells(Ring { bytes: &bytes, width, rows: rows as u32, first }, &knots, &mut found);
        for (i, &found) in found[..cells * CELL].iter().enumerate() {
            let (cell, t) = (i / CELL, (i % CELL) as f64);
            let at = |k: usize| {
                [f64::from(knots[cell + k].x), f64::from(knots[cell + k].y)].map(|v| v / 65536.0)
            };
            let [p, q, r, s] = [at(0), at(1), at(2), at(3)];
            let bend = (p[0] - q[0] - r[0] + s[0]) / 2.0 / 256.0;
            let x = q[0] + (r[0] - q[0]) * t / 16.0 - bend * t * (16.0 - t) / 2.0;
            let y = q[1] + (r[1] - q[1]) * t / 16.0;
            let (column, line) = (x.floor(), y.floor());
            let two = |y: i32| [0, 1].map(|k| row(y)[column as usize + k].into());
            let exact = between([two(line as i32), two(line as i32 + 1)], x - column, y - line);
            // The fraction across is rounded to 1/128: 1/256 off, by up to 255 levels; steps are
            // cut to 2^-14 px, sixteen times.
            let bound = 0.5 + 255.0 / 256.0 + 2.0 * 255.0 * 16.0 / 16384.0;
            assert!(
                (f64::from(found) - exact).abs() <= bound,
                "round {round}, pixel {i}: {found} for {exact}"
            );
        }
        assert_eq!(found[cells * CELL..], [77; 2]);
    }
}

#[test]
fn knots_are_weighed_to_a_few_steps() {
    let mut random = Random(12);
    for _ in 0..2000 {
        let mut number = |most: u64| random.below(2 * most) as i32 - most as i32;
        let weights = [number(1 << 28), number(1 << 30), number(1 << 30), number(1 << 28)];
        let rows = [(); 4].map(|()| [Knot { x: number(1 << 28), y: number(1 << 28) }]);
        let mut found = [Knot::default(); 2];
        weigh_knots(rows.each_ref().map(|row| &row[..]), weights, &mut found);
        for (found, of) in
            [(found[0].x, (|k: &Knot| k.x) as fn(&Knot) -> i32), (found[0].y, |k| k.y)]
        {
            let exact: f64 = rows
                .iter()
                .zip(weights)
                .map(|(row, w)| f64::from(of(&row[0])) * f64::from(w) / f64::from(1 << 30))
                .sum();
            // Four products are rounded down by up to 4 each, and 8 is added.
            assert!((f64::from(found) - exact).abs() <= 8.0, "{found} for {exact}");
        }
        assert_eq!(found[1], Knot::default());
    }
}

/// The code of row `k` at a column by its definition, pixel by pixel.
fn naive_code(rows: &[Vec<u8>], k: usize, x: usize, doublings: u32) -> u8 {
    let limited = |value: i32| value.clamp(-128, 127);
    let grey = |row: usize, x: usize| i32::from(rows[2 * k + row][x]);
    let h = |x: usize| {
        let along = |row: usize| limited(grey(row, x) - grey(row, x - 2));
        limited(limited(along(2) + along(3)) + limited(along(4) + along(5)))
    };
    let v = |x: usize| limited(limited(grey(4, x) - grey(0, x)) + limited(grey(5, x) - grey(1, x)));
    let full = |sum: i32| (0..doublings).fold(limited(sum), |sum, _| limited(2 * sum));
    ((full(h(x) + h(x + 1)) + full(v(x) + v(x + 1))).div_euclid(2) + 128) as u8
}

#[test]
fn codes_are_limited_differences_of_rows() {
    for rows in rows(2 * CODE_ROWS + 4) {
        let width = rows[0].len();
        for doublings in [1, 2, 4] {
            let mut found = vec![[7; CODE_ROWS]; width];
            code_columns(core::array::from_fn(|row| &rows[row][..]), doublings, &mut found);
            for (x, column) in found.iter().enumerate() {
                for (k, &code) in column.iter().enumerate() {
                    let is_border = x < 2 || x + 2 >= width;
                    let expected =
                        if is_border { CODE_FLAT } else { naive_code(&rows, k, x, doublings) };
                    assert_eq!(
                        code, expected,
                        "row {k}, column {x} of {width}, {doublings} doublings"
                    );
                }
            }
        }
    }
}

#[test]
fn costs_of_codes_are_a_64th_of_their_differences() {
    let mut random = Random(3);
    for length in 0..40 {
        let mut column = || -> CodeColumn { core::array::from_fn(|_| random.grey()) };
        let window: [CodeColumn; STRIP] = core::array::from_fn(|_| column());
        let columns: Vec<CodeColumn> = (0..length + STRIP - 1).map(|_| column()).collect();
        let mut costs = vec![0; length];
        code_costs(&window, &columns, &mut costs);
        for (i, &cost) in costs.iter().enumerate() {
            let apart = |k: usize| (0..CODE_ROWS).map(move |row| (k, row));
            let sum: u32 = (0..STRIP)
                .flat_map(apart)
                .map(|(k, row)| u32::from(window[k][row].abs_diff(columns[i + k][row])))
                .sum();
            assert_eq!(u32::from(cost), sum / 64 + u32::from(JUMP_PENALTY));
        }
        let steps = |k: usize| {
            (0..CODE_ROWS)
                .map(|row| u16::from(window[k][row].abs_diff(window[k + 1][row])))
                .sum::<u16>()
        };
        assert_eq!(code_steps(&window), (0..STRIP - 1).map(steps).sum::<u16>());
    }
}

#[test]
fn moments_of_a_window_are_those_of_its_changes() {
    let mut columns = [[90; CODE_ROWS]; STRIP + 2];
    assert_eq!(code_moments(&columns), CodeMoments { all: 0, across: 0, down: 0 });
    // Seen from the columns before and behind it, 5 and 7 of the ten: 4 and 6 of the window.
    columns[6][2] = 80;
    assert_eq!(code_moments(&columns), CodeMoments { all: 200, across: 1000, down: 400 });
    columns[9][3] = 255;
    let across = 1000 + 7 * 165 * 165;
    assert_eq!(
        code_moments(&columns),
        CodeMoments { all: 200 + 165 * 165, across, down: 400 + 3 * 165 * 165 }
    );
}

#[test]
fn second_differences_see_no_plane_and_each_step_of_noise() {
    let plane: [[u8; RUN_PIXELS]; 3] =
        core::array::from_fn(|y| core::array::from_fn(|x| (20 + 7 * x + 11 * y) as u8));
    for apart in [1, 2] {
        assert_eq!(second_differences(plane.each_ref(), apart), 0);
        let mut noisy = plane;
        noisy[1][5] += 3;
        // -2 down, then 1, -2 and 1 across.
        assert_eq!(second_differences(noisy.each_ref(), apart), 6 * 4, "{apart}");
    }
}

#[test]
fn steps_are_limited_and_rows_differ_by_the_sum() {
    for rows in rows(2) {
        for most in [32, 63] {
            let mut found = vec![7; rows[0].len()];
            limited_steps(&rows[0], &rows[1], most, &mut found);
            for ((&before, &after), &found) in rows[0].iter().zip(&rows[1]).zip(&found) {
                let limit = i32::from(most);
                let step = (i32::from(after) - i32::from(before)).clamp(-limit, limit);
                assert_eq!(i32::from(found), step + limit);
            }
        }
        if let (Some(a), Some(b)) = (rows[0].first_chunk(), rows[1].first_chunk()) {
            let sum: u16 = a.iter().zip(b).map(|(a, b)| u16::from(a.abs_diff(*b))).sum();
            assert_eq!(row_difference(a, b), sum);
        }
    }
}
