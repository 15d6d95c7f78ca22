//! Kernels of support points.

use super::rooms::{ALIGNMENTS, Contents, IMAGE, ROW, Rooms, range, same};
use super::{Compared, Kernels};
use crate::programs::random::Random;
use linestereo::unstable::kernel::{CODE_ROWS, STRIP, portable};

/// Lengths of curves of bytes: all short ones, and some up to the longest.
fn lengths() -> impl Iterator<Item = usize> {
    (0..=256_usize).filter(|length| *length <= 70 || length % 31 == 0 || *length == 256)
}

/// Rows in one image; those above and below sometimes repeat the next one, sometimes one row is out
/// of line or shorter.
pub(super) fn code_columns(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
    const ROWS: usize = 2 * CODE_ROWS + 4;
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

pub(super) fn code_steps(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
    let room = &mut rooms.rows[0].contents;
    for round in 0..800_usize {
        Contents::ALL[random.below(6)].fill(random, room);
        let at = range(ROW, CODE_ROWS * STRIP, round % ALIGNMENTS, round % 8 < 4);
        let start = at.start;
        let Some(window) = room[at].as_chunks().0.first_chunk() else { continue };
        let same = (kernels.code_steps)(window) == portable::code_steps(window);
        compared.note(same, STRIP, (CODE_ROWS, 0), [start, 0, 0, 0]);
    }
}

pub(super) fn code_moments(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
    let room = &mut rooms.rows[0].contents;
    for round in 0..800_usize {
        Contents::ALL[random.below(6)].fill(random, room);
        let at = range(ROW, CODE_ROWS * (STRIP + 2), round % ALIGNMENTS, round % 8 < 4);
        let start = at.start;
        let Some(columns) = room[at].as_chunks().0.first_chunk() else { continue };
        let same = (kernels.code_moments)(columns) == portable::code_moments(columns);
        compared.note(same, STRIP + 2, (CODE_ROWS, 0), [start, 0, 0, 0]);
    }
}

/// A kernel that looks at `N` pixels of each of three rows, which are handed to `same`.
fn few_pixels<const N: usize>(
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
    same: impl Fn([&[u8; N]; 3], &mut Random) -> bool,
) {
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
        compared.note(same(rows, random), N, (3, 0), starts);
    }
}

pub(super) fn second_differences(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
    few_pixels(rooms, random, compared, |rows, random| {
        let apart = random.below(4); // the core: 1 and 2
        (kernels.second_differences)(rows, apart) == portable::second_differences(rows, apart)
    });
}

/// A kernel that writes what two rows of bytes give into a third one, at every length, of which one
/// is now and then shorter. `same` is handed the two, the outputs of the kernel and of its
/// definition, and says whether what they return is the same.
fn two_into_one(
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
    same: impl Fn([&[u8]; 2], [&mut [u8]; 2], &mut Random) -> bool,
) {
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
            let outs = [&mut out.contents[at_out.clone()], &mut expected[at_out]];
            let is_same = same([&a.contents[at_a], &b.contents[at_b]], outs, random);
            compared.note(is_same && expected == out.contents, length, (1, 0), starts);
        }
    }
}

pub(super) fn limited_steps(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
    two_into_one(rooms, random, compared, |[before, after], [ours, theirs], random| {
        let most = random.next() as u8; // the core: 32 and 63
        (kernels.limited_steps)(before, after, most, ours);
        portable::limited_steps(before, after, most, theirs);
        true
    });
}

pub(super) fn row_differences(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
    few_pixels(rooms, random, compared, |[a, b, _], _| {
        (kernels.row_difference)(a, b) == portable::row_difference(a, b)
    });
}

pub(super) fn code_costs(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
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

pub(super) fn path_steps(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
    for length in lengths() {
        for round in 0..32_usize {
            let [costs, path, _] = &mut rooms.rows;
            let mut lengths = [length; 2];
            if round % 8 == 0 {
                lengths[random.below(2)] = random.below(length + 1);
            }
            let [at_costs, at_path] = [0, 1]
                .map(|k: usize| range(ROW, lengths[k], (round + k) % ALIGNMENTS, round % 3 == k));
            for room in [&mut *costs, path] {
                Contents::ALL[random.below(6)].fill(random, &mut room.contents);
            }
            let starts = [at_costs.start, at_path.start, 0, 0];
            let of_path = portable::lowest_byte(&path.contents[at_path.clone()]);
            let lowest = if round % 4 == 0 { random.next() as u8 } else { of_path };
            let mut expected = path.contents;
            let costs = &costs.contents[at_costs];
            let theirs = portable::path_step(costs, lowest, &mut expected[at_path.clone()]);
            let ours = (kernels.path_step)(costs, lowest, &mut path.contents[at_path]);
            compared.note(ours == theirs && expected == path.contents, length, (1, 0), starts);
        }
    }
}

pub(super) fn sums_of_paths(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
    two_into_one(rooms, random, compared, |[a, b], [ours, theirs], _| {
        (kernels.sum_paths)(a, b, ours) == portable::sum_paths(a, b, theirs)
    });
}

/// A kernel that looks at bytes alone, at every length; they are handed to `same`, which compares
/// it with the definition.
fn look(
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
    same: impl Fn(&[u8], &mut Random) -> bool,
) {
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
            let start = range.start;
            compared.note(same(&room[range], random), length, (1, 0), [start, 0, 0, 0]);
        }
    }
}

pub(super) fn lowest_bytes(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
    look(rooms, random, compared, |bytes, _| {
        (kernels.lowest_byte)(bytes) == portable::lowest_byte(bytes)
    });
}

pub(super) fn places_of_bytes(
    kernels: &Kernels,
    rooms: &mut Rooms,
    random: &mut Random,
    compared: &mut Compared,
) {
    look(rooms, random, compared, |bytes, random| {
        let lowest = portable::lowest_byte(bytes);
        let bound = if random.below(3) == 0 { random.next() as u8 } else { lowest };
        (kernels.place_of_byte)(bytes, bound) == portable::place_of_byte(bytes, bound)
    });
}
