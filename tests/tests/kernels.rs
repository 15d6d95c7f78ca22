//! Kernels against naive oracles: every tail length, random and extreme rows, exact equality.

use linestereo::kernel::{FLAT, LANES, STRIP, Strip, census_row, gradient_row, hamming_curve, portable, sad_curve};
use linestereo_tests::drawn::{Random, painted};
use linestereo_tests::reference::{census, sobel};

/// Rows of an image of every width from 1 to 70: random, black, white, and black and white in turn.
fn rows(count: usize) -> Vec<Vec<Vec<u8>>> {
    let mut random = Random(1);
    let mut images = Vec::new();
    for width in 1..=70 {
        images.push((0..count).map(|_| (0..width).map(|_| random.grey()).collect()).collect());
        images.push(vec![vec![0; width]; count]);
        images.push(vec![vec![255; width]; count]);
        images.push((0..count).map(|y| (0..width).map(|x| if (x + y) % 2 == 0 { 255 } else { 0 }).collect()).collect());
    }
    images
}

#[test]
fn gradient_is_half_the_clipped_sobel() {
    for rows in rows(3) {
        let width = rows[0].len();
        let image = painted(width as u16, 3, |x, y| rows[usize::from(y)][usize::from(x)]);
        let mut found = vec![7; width];
        gradient_row(&rows[0], &rows[1], &rows[2], &mut found);
        let expected: Vec<u8> = (0..width)
            .map(|x| match x {
                0 => FLAT,
                x if x + 1 == width => FLAT,
                x => (sobel(&image, x as i32, 1).0.div_euclid(2).clamp(-63, 63) + i32::from(FLAT)) as u8,
            })
            .collect();
        assert_eq!(found, expected, "{rows:?}");
    }
}

#[test]
fn census_tells_the_darker_neighbours_at_distance_two() {
    /// Bit of a neighbour in the full census of 24.
    fn place((dx, dy): (i32, i32)) -> i32 {
        let k = (dy + 2) * 5 + dx + 2;
        if k > 12 { k - 1 } else { k }
    }
    const NEIGHBOURS: [(i32, i32); 8] = [(-2, -2), (0, -2), (2, -2), (-2, 0), (2, 0), (-2, 2), (0, 2), (2, 2)];
    for rows in rows(5) {
        let width = rows[0].len();
        let image = painted(width as u16, 5, |x, y| rows[usize::from(y)][usize::from(x)]);
        let mut found = vec![7; width];
        census_row([&rows[0], &rows[1], &rows[2], &rows[3], &rows[4]], &mut found);
        for (x, &found) in found.iter().enumerate() {
            let expected = if x < 2 || x + 2 >= width {
                0
            } else {
                let all = census(&image, x as i32, 2);
                NEIGHBOURS.iter().zip(0..).map(|(&at, bit)| (((all >> place(at)) & 1) as u8) << bit).sum::<u8>()
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
            let others: Vec<Vec<u8>> = (0..count)
                .map(|_| (0..len + STRIP - 1 + count % 3).map(|_| 1 + random.below(127) as u8).collect())
                .collect();
            let strips: Vec<Strip<'_>> = others
                .iter()
                .map(|other| Strip { reference: [0; STRIP].map(|_| 1 + random.below(127) as u8), other })
                .collect();
            let naive = |d: usize| -> u16 {
                strips
                    .iter()
                    .flat_map(|s| s.reference.iter().zip(&s.other[d..]).map(|(&a, &b)| u16::from(a.abs_diff(b))))
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
            let others: Vec<Vec<u8>> = (0..count).map(|_| (0..len + 1).map(|_| random.grey()).collect()).collect();
            let points: Vec<(u8, &[u8])> = others.iter().map(|other| (random.grey(), &other[..])).collect();
            let mut found = vec![9; len];
            hamming_curve(&points, &mut found);
            let expected: Vec<u16> =
                (0..len).map(|d| 9 + points.iter().map(|(r, o)| (r ^ o[d]).count_ones() as u16).sum::<u16>()).collect();
            assert_eq!(found, expected, "{count} points, {len} disparities");
        }
    }
}
