//! Kernels of support points.

use super::rooms::{ALIGNMENTS, Contents, ROW, Random, Rooms, place};
use super::{Compared, Kernels};
use linestereo::kernel::{RANK_ROWS, STRIP, portable};

/// Lengths of curves of bytes: all short ones, and some up to the longest.
fn lengths() -> impl Iterator<Item = usize> {
    (0..=256_usize).filter(|length| *length <= 70 || length % 31 == 0 || *length == 256)
}

pub(super) fn rank_costs(kernels: &Kernels, rooms: &mut Rooms) -> Compared {
    let mut compared = Compared::new("rank_costs");
    let mut random = Random::new();
    for length in lengths() {
        for round in 0..40_usize {
            let contents = Contents::ALL[random.below(6)];
            for room in &mut rooms.rows {
                // As often ranks as bytes that are none.
                contents.fill(&mut random, &mut room.contents);
                if round % 2 == 0 {
                    room.contents.iter_mut().for_each(|byte| *byte %= 5);
                }
            }
            let mut window = [[0; STRIP]; RANK_ROWS];
            Contents::ALL[random.below(6)].fill(&mut random, window.as_flattened_mut());
            let mut starts = [0; 4];
            let mut rows = [[].as_slice(); RANK_ROWS];
            for (k, row) in rows.iter_mut().enumerate() {
                let needed = length + STRIP - 1;
                let long = match random.below(24) {
                    0 => random.below(needed + 1),
                    1 => needed + 1 + random.below(20),
                    _ => needed,
                };
                let place = place(ROW, long, (round + k) % ALIGNMENTS, random.below(2) == 0);
                starts[k % 3] = place.start;
                *row = &rooms.rows[k % 3].contents[place];
            }
            let out = &mut rooms.out.contents;
            Contents::Random.fill(&mut random, out);
            let mut expected = *out;
            let place = place(ROW, length, round % ALIGNMENTS, round % 8 < 4);
            starts[3] = place.start;
            (kernels.rank_costs)(&window, &rows, &mut out[place.clone()]);
            portable::rank_costs(&window, &rows, &mut expected[place]);
            compared.note(*out == expected, length, (RANK_ROWS, 0), starts);
        }
    }
    compared
}

pub(super) fn path_steps(kernels: &Kernels, rooms: &mut Rooms) -> Compared {
    let mut compared = Compared::new("path_step");
    let mut random = Random::new();
    for length in lengths() {
        for round in 0..32_usize {
            let [costs, paths, sums] = &mut rooms.rows;
            for room in [&mut *costs, paths, sums] {
                Contents::ALL[random.below(6)].fill(&mut random, &mut room.contents);
            }
            let mut lengths = [length; 3];
            if round % 8 == 0 {
                lengths[random.below(3)] = random.below(length + 1);
            }
            let places = [0, 1, 2].map(|k: usize| place(ROW, lengths[k], (round + k) % ALIGNMENTS, round % 3 == k));
            let starts = [0, 1, 2, 2].map(|k: usize| places[k].start);
            let [at_costs, at_path, at_sums] = places;
            let path = &paths.contents[at_path.clone()];
            let of_path = portable::lowest_byte(path);
            let lowest = if round % 4 == 0 { random.next() as u8 } else { of_path };
            let (mut path, mut sum) = (paths.contents, sums.contents);
            let costs = &costs.contents[at_costs];
            let first = round % 2 == 0;
            let theirs =
                portable::path_step(costs, lowest, &mut path[at_path.clone()], &mut sum[at_sums.clone()], first);
            let ours =
                (kernels.path_step)(costs, lowest, &mut paths.contents[at_path], &mut sums.contents[at_sums], first);
            compared.note(ours == theirs && path == paths.contents && sum == sums.contents, length, (1, 0), starts);
        }
    }
    compared
}

pub(super) fn lowest_bytes(kernels: &Kernels, rooms: &mut Rooms) -> Compared {
    let mut compared = Compared::new("lowest_byte");
    let mut random = Random::new();
    let room = &mut rooms.rows[0].contents;
    for length in 0..=70 {
        for round in 0..64_usize {
            match round {
                0..8 => room.fill(u8::MAX),
                8..16 => room.iter_mut().for_each(|byte| *byte = 254 + (random.next() & 1) as u8),
                _ => Contents::ALL[random.below(6)].fill(&mut random, room),
            }
            let place = place(ROW, length, round % ALIGNMENTS, round % 8 < 4);
            if round < 16 && length > 0 {
                room[place.start + random.below(length)] = 3;
            }
            let start = place.start;
            let bytes = &room[place];
            compared.note(
                (kernels.lowest_byte)(bytes) == portable::lowest_byte(bytes),
                length,
                (1, 0),
                [start, 0, 0, 0],
            );
        }
    }
    compared
}
