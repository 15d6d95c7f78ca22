//! Kernels that give a row.

use super::rooms::{ALIGNMENTS, Contents, ROW, Rooms, UNTOUCHED, range, same};
use super::{Kernels, Trial};
use linestereo::unstable::kernel::portable;

/// A kernel that computes a row from three, which `run` runs, at every width; then with rows that
/// are not equally long.
pub(super) fn rows(
    kernels: &Kernels,
    trial: &mut Trial<'_>,
    run: impl Fn(&Kernels, [&[u8]; 3], &mut [u8]),
) {
    let Trial { rooms, random, compared } = trial;
    let mut expected = [0; ROW];
    let mut compare =
        |rooms: &mut Rooms, lengths: [usize; 4], distances: [usize; 4], at_back: bool| {
            let mut ranges = [const { 0..0 }; 4];
            for ((range, length), distance) in ranges.iter_mut().zip(lengths).zip(distances) {
                *range = super::rooms::range(ROW, length, distance, at_back);
            }
            let starts = [0, 1, 2, 3].map(|i: usize| ranges[i].start);
            let [a, r, b, to] = ranges;
            let [above, row, below] = &rooms.rows;
            let inputs = [&above.contents[a], &row.contents[r], &below.contents[b]];
            let out = &mut rooms.out.contents;
            out.fill(UNTOUCHED);
            expected.fill(UNTOUCHED);
            run(kernels, inputs, &mut out[to.clone()]);
            run(&Kernels::PORTABLE, inputs, &mut expected[to]);
            compared.note(same(out, &expected), lengths[1], (3, 0), starts);
        };
    for width in (1..=80).chain([320]) {
        for contents in Contents::ALL {
            for room in &mut rooms.rows {
                contents.fill(random, &mut room.contents);
            }
            for at_back in [false, true] {
                // Every combination once; with other contents all alignments of each slice, in
                // twenty combinations.
                let step = if contents == Contents::Random { 1 } else { 13 };
                for combination in (0..256_usize).step_by(step) {
                    let distances = [0, 2, 4, 6].map(|bit| combination >> bit & 3);
                    compare(rooms, [width; 4], distances, at_back);
                }
            }
        }
    }
    for round in 0..4000 {
        let mut around = || random.below(32);
        let length = around();
        // Often one of them alone is off.
        let mut lengths = [length; 4];
        lengths[round % 4] = around();
        if round % 3 == 0 {
            lengths = [around(), around(), around(), around()];
        }
        compare(rooms, lengths, [0; 4].map(|_: usize| random.below(ALIGNMENTS)), round % 8 < 4);
    }
}

pub(super) fn reversed_rows(kernels: &Kernels, trial: &mut Trial<'_>) {
    let Trial { rooms, random, compared } = trial;
    for length in (0..=80).chain([320]) {
        for distance in 0..ALIGNMENTS {
            for at_back in [false, true] {
                let range = range(ROW, length, distance, at_back);
                let out = &mut rooms.out.contents;
                Contents::Random.fill(random, out);
                let mut expected = *out;
                (kernels.reverse_row)(&mut out[range.clone()]);
                portable::reverse_row(&mut expected[range.clone()]);
                compared.note(same(out, &expected), length, (1, 0), [range.start, 0, 0, 0]);
            }
        }
    }
}
