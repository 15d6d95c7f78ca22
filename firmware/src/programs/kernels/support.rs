//! Kernels of support points.

use super::rooms::{ALIGNMENTS, Contents, IMAGE, ROW, range, same};
use super::{Kernels, Trial};
use linestereo::unstable::kernel::{CODE_ROWS, CodeColumn, STRIP, portable};

/// Lengths of curves of bytes: all short ones, and some up to the longest.
fn lengths() -> impl Iterator<Item = usize> {
    (0..=256_usize).filter(|length| *length <= 70 || length % 31 == 0 || *length == 256)
}

/// Rows in one image; those above and below sometimes repeat the next one, sometimes one row is out
/// of line or shorter.
pub(super) fn code_columns(kernels: &Kernels, trial: &mut Trial<'_>) {
    const ROWS: usize = 2 * CODE_ROWS + 4;
    let Trial { rooms, random, compared } = trial;
    for width in (0..=40_usize).chain([61, 80, 128]) {
        for round in 0..20_usize {
            let image = &mut rooms.image.contents;
            Contents::ALL[random.below(6)].fill(random, image);
            let stride = width + random.below(20);
            let at_image =
                range(IMAGE, stride * (ROWS - 1) + width, round % ALIGNMENTS, random.below(2) == 0);
            let mut starts: [usize; ROWS] = core::array::from_fn(|k| at_image.start + k * stride);
            let mut lengths = [width; ROWS];
            match random.below(8) {
                0 => (starts[0], starts[1]) = (starts[2], starts[2]),
                1 => (starts[ROWS - 2], starts[ROWS - 1]) = (starts[ROWS - 3], starts[ROWS - 3]),
                2 => starts[random.below(ROWS)] = at_image.start,
                3 => lengths[random.below(ROWS)] = random.below(width + 1),
                _ => {}
            }
            let rows: [&[u8]; ROWS] = core::array::from_fn(|k| &image[starts[k]..][..lengths[k]]);
            let doublings = random.below(6) as u32; // the core: 1 to 4
            // Columns begin at whole words in the core.
            let (needed, distance) =
                (CODE_ROWS * width, if round % 4 == 0 { random.below(ALIGNMENTS) } else { 0 });
            let at_columns = range(ROW, needed, distance.min(ROW - needed), random.below(2) == 0);
            let out = &mut rooms.out.contents;
            Contents::Random.fill(random, out);
            let mut expected = *out;
            (kernels.code_columns)(rows, doublings, out[at_columns.clone()].as_chunks_mut().0);
            portable::code_columns(rows, doublings, expected[at_columns.clone()].as_chunks_mut().0);
            compared.note(
                same(out, &expected),
                width,
                (ROWS, stride),
                [starts[0], starts[1], at_columns.start, 0],
            );
        }
    }
}

/// A kernel that looks at a window of `N` columns of codes; `look` runs it.
fn windows<const N: usize, T: PartialEq>(
    kernels: &Kernels,
    trial: &mut Trial<'_>,
    look: impl Fn(&Kernels, &[CodeColumn; N]) -> T,
) {
    let Trial { rooms, random, compared } = trial;
    let room = &mut rooms.rows[0].contents;
    for round in 0..800_usize {
        Contents::ALL[random.below(6)].fill(random, room);
        let at = range(ROW, CODE_ROWS * N, round % ALIGNMENTS, round % 8 < 4);
        let start = at.start;
        let Some(window) = room[at].as_chunks().0.first_chunk() else { continue };
        let same = look(kernels, window) == look(&Kernels::PORTABLE, window);
        compared.note(same, N, (CODE_ROWS, 0), [start, 0, 0, 0]);
    }
}

pub(super) fn code_steps(kernels: &Kernels, trial: &mut Trial<'_>) {
    windows(kernels, trial, |of, window| (of.code_steps)(window));
}

pub(super) fn code_moments(kernels: &Kernels, trial: &mut Trial<'_>) {
    windows(kernels, trial, |of, columns| (of.code_moments)(columns));
}

/// A kernel that looks at `N` pixels of each of three rows; `look` runs it, with a number.
fn few_pixels<const N: usize, T: PartialEq>(
    kernels: &Kernels,
    trial: &mut Trial<'_>,
    look: impl Fn(&Kernels, [&[u8; N]; 3], usize) -> T,
) {
    let Trial { rooms, random, compared } = trial;
    for round in 0..1600_usize {
        for room in &mut rooms.rows {
            Contents::ALL[random.below(6)].fill(random, &mut room.contents);
        }
        let starts = [0, 1, 2, 2]
            .map(|k| range(ROW, N, (round >> (2 * k)) % ALIGNMENTS, round % 3 == k).start);
        let mut rows = [&[0; N]; 3];
        for ((row, room), start) in rows.iter_mut().zip(&rooms.rows).zip(starts) {
            if let Some(pixels) = room.contents[start..].first_chunk() {
                *row = pixels;
            }
        }
        let number = random.below(4);
        let same = look(kernels, rows, number) == look(&Kernels::PORTABLE, rows, number);
        compared.note(same, N, (3, 0), starts);
    }
}

pub(super) fn second_differences(kernels: &Kernels, trial: &mut Trial<'_>) {
    // Apart by 1 or 2 in the core.
    few_pixels(kernels, trial, |of, rows, apart| (of.second_differences)(rows, apart));
}

pub(super) fn row_differences(kernels: &Kernels, trial: &mut Trial<'_>) {
    few_pixels(kernels, trial, |of, [a, b, _], _| (of.row_difference)(a, b));
}

/// A kernel that writes what two rows of bytes give into a third one, at every length, of which one
/// is now and then shorter. `run` runs it, with a number, and gives what it returns.
fn two_into_one<T: PartialEq>(
    kernels: &Kernels,
    trial: &mut Trial<'_>,
    run: impl Fn(&Kernels, [&[u8]; 2], &mut [u8], u32) -> T,
) {
    let Trial { rooms, random, compared } = trial;
    for length in lengths() {
        for round in 0..32_usize {
            let mut lengths = [length; 3];
            if round % 8 == 0 {
                lengths[random.below(3)] = random.below(length + 1);
            }
            let ranges = [0, 1, 2]
                .map(|k: usize| range(ROW, lengths[k], (round + k) % ALIGNMENTS, round % 3 == k));
            let starts = [0, 1, 2, 2].map(|k: usize| ranges[k].start);
            for room in &mut rooms.rows {
                Contents::ALL[random.below(6)].fill(random, &mut room.contents);
            }
            let [a, b, out] = &mut rooms.rows;
            let [at_a, at_b, at_out] = ranges;
            let mut expected = out.contents;
            let (given, number) = ([&a.contents[at_a], &b.contents[at_b]], random.next());
            let ours = run(kernels, given, &mut out.contents[at_out.clone()], number);
            let theirs = run(&Kernels::PORTABLE, given, &mut expected[at_out], number);
            compared.note(ours == theirs && expected == out.contents, length, (1, 0), starts);
        }
    }
}

pub(super) fn limited_steps(kernels: &Kernels, trial: &mut Trial<'_>) {
    two_into_one(kernels, trial, |of, [before, after], out, number| {
        (of.limited_steps)(before, after, number as u8, out); // the core: 32 and 63
    });
}

pub(super) fn sums_of_paths(kernels: &Kernels, trial: &mut Trial<'_>) {
    two_into_one(kernels, trial, |of, [a, b], sums, _| (of.sum_paths)(a, b, sums));
}

/// With the lowest cost of the path, and with any number as such.
pub(super) fn path_steps(kernels: &Kernels, trial: &mut Trial<'_>) {
    two_into_one(kernels, trial, |of, [costs, _], path, number| {
        let is_any = number.is_multiple_of(4);
        let lowest = if is_any { (number >> 8) as u8 } else { portable::lowest_byte(path) };
        (of.path_step)(costs, lowest, path)
    });
}

pub(super) fn code_costs(kernels: &Kernels, trial: &mut Trial<'_>) {
    let Trial { rooms, random, compared } = trial;
    for length in lengths() {
        for round in 0..40_usize {
            let contents = Contents::ALL[random.below(6)];
            let codes = &mut rooms.image.contents;
            contents.fill(random, codes);
            let mut window = [[0; CODE_ROWS]; STRIP];
            Contents::ALL[random.below(6)].fill(random, window.as_flattened_mut());
            let needed = length + STRIP - 1;
            let long = match random.below(8) {
                0 => random.below(needed + 1),
                1 => needed + 1 + random.below(20),
                _ => needed,
            };
            // Columns begin at whole words in the core.
            let distance = if round % 4 == 0 { random.below(ALIGNMENTS) } else { 0 };
            let at_columns = range(IMAGE, long * CODE_ROWS, distance, random.below(2) == 0);
            let at_costs = range(ROW, length, round % ALIGNMENTS, round % 8 < 4);
            let starts = [at_columns.start, at_costs.start, 0, 0];
            let columns = codes[at_columns].as_chunks().0;
            let out = &mut rooms.out.contents;
            Contents::Random.fill(random, out);
            let mut expected = *out;
            (kernels.code_costs)(&window, columns, &mut out[at_costs.clone()]);
            portable::code_costs(&window, columns, &mut expected[at_costs]);
            compared.note(same(out, &expected), length, (CODE_ROWS, 0), starts);
        }
    }
}

/// A kernel that looks at bytes alone, at every length; `look` runs it, with a bound that mostly is
/// the lowest of them.
fn bytes<T: PartialEq>(
    kernels: &Kernels,
    trial: &mut Trial<'_>,
    look: impl Fn(&Kernels, &[u8], u8) -> T,
) {
    let Trial { rooms, random, compared } = trial;
    let room = &mut rooms.rows[0].contents;
    for length in 0..=70 {
        for round in 0..64_usize {
            match round {
                0..8 => room.fill(u8::MAX),
                8..16 => room.iter_mut().for_each(|byte| *byte = 254 + (random.next() & 1) as u8),
                _ => Contents::ALL[random.below(6)].fill(random, room),
            }
            let range = range(ROW, length, round % ALIGNMENTS, round % 8 < 4);
            if round < 16 && length > 0 {
                room[range.start + random.below(length)] = 3;
            }
            let (start, bytes) = (range.start, &room[range]);
            let lowest = portable::lowest_byte(bytes);
            let bound = if random.below(3) == 0 { random.next() as u8 } else { lowest };
            let same = look(kernels, bytes, bound) == look(&Kernels::PORTABLE, bytes, bound);
            compared.note(same, length, (1, 0), [start, 0, 0, 0]);
        }
    }
}

pub(super) fn lowest_bytes(kernels: &Kernels, trial: &mut Trial<'_>) {
    bytes(kernels, trial, |of, bytes, _| (of.lowest_byte)(bytes));
}

pub(super) fn places_of_bytes(kernels: &Kernels, trial: &mut Trial<'_>) {
    bytes(kernels, trial, |of, bytes, bound| (of.place_of_byte)(bytes, bound));
}
