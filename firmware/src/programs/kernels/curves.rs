//! Curves of costs over disparity.

use super::rooms::{ALIGNMENTS, CURVE, Contents, ROW, range};
use super::{Kernels, Trial};
use crate::programs::random::Random;
use core::ops::RangeInclusive;
use linestereo::unstable::kernel::{LANES, STRIP, Strip, portable};

/// Lengths of cost curves: whole blocks, and such that are none.
fn curve_lengths() -> impl Iterator<Item = usize> {
    (0..=256_usize).filter(|length| *length <= 40 || matches!(length % LANES, 0 | 1 | 8 | 15))
}

/// Most strips or points of one curve here.
const MOST: usize = 34;

/// Curves that sum what `count` slices of pixels give, with slices that are too short or longer
/// than need be among them. `run` runs the kernel on the slices, and on what it makes of a seed.
fn summed_curves(
    kernels: &Kernels,
    trial: &mut Trial<'_>,
    counts: RangeInclusive<usize>,
    beyond: usize,
    run: impl Fn(&Kernels, &[&[u8]], u32, &mut [u16]),
) {
    let Trial { rooms, random, compared } = trial;
    for length in curve_lengths() {
        for count in counts.clone() {
            let contents = Contents::ALL[random.below(6)];
            for room in &mut rooms.rows {
                contents.fill(random, &mut room.contents);
            }
            for distance in 0..ALIGNMENTS {
                let needed = length + beyond;
                let mut others: [&[u8]; MOST] = [&[]; MOST];
                let mut starts = [0; 4];
                let some_short = random.below(2) == 0;
                for (i, other) in others.iter_mut().enumerate().take(count) {
                    let long = match random.below(12) {
                        0 if some_short => random.below(needed + 1),
                        1 if some_short => needed.saturating_sub(1),
                        2 => needed + 1 + random.below(20),
                        _ => needed,
                    };
                    let range = range(ROW, long, (distance + i) % ALIGNMENTS, random.below(2) == 0);
                    if let Some(start) = starts.get_mut(i).filter(|_| i < 3) {
                        *start = range.start;
                    }
                    *other = &rooms.rows[i % 3].contents[range];
                }
                let curve = &mut rooms.curve.contents;
                curve.fill_with(|| random.entry());
                let mut expected = *curve;
                let range = range(CURVE, length, distance / 2, distance % 2 == 0);
                starts[3] = range.start;
                let (others, seed) = (&others[..count], random.next());
                run(kernels, others, seed, &mut curve[range.clone()]);
                run(&Kernels::PORTABLE, others, seed, &mut expected[range]);
                compared.note(*curve == expected, length, (count, 0), starts);
            }
        }
    }
}

pub(super) fn sad_curves(kernels: &Kernels, trial: &mut Trial<'_>) {
    summed_curves(kernels, trial, 0..=10, STRIP - 1, |of, others, seed, curve| {
        let mut random = Random(seed | 1);
        let mut strips = [Strip { reference: [0; STRIP], other: &[] }; MOST];
        for (strip, &other) in strips.iter_mut().zip(others) {
            Contents::ALL[random.below(6)].fill(&mut random, &mut strip.reference);
            strip.other = other;
        }
        (of.sad_curve)(&strips[..others.len()], curve);
    });
}

pub(super) fn hamming_curves(kernels: &Kernels, trial: &mut Trial<'_>) {
    // Three more than the most that are allowed: no reason to give other bits.
    summed_curves(kernels, trial, 0..=MOST, 0, |of, others, seed, curve| {
        let mut random = Random(seed | 1);
        let mut points: [(u8, &[u8]); MOST] = [(0, &[]); MOST];
        let extreme = seed & 0x100 != 0;
        for (point, &other) in points.iter_mut().zip(others) {
            let code = random.next() as u8;
            *point = (if extreme { !other.first().unwrap_or(&0) } else { code }, other);
        }
        (of.hamming_curve)(&points[..others.len()], curve);
    });
}

/// Entries of the longest curve that is combined with others.
const COMBINED: usize = 72;

/// A kernel that makes a curve of up to three others; `run` runs it.
pub(super) fn combined(
    kernels: &Kernels,
    trial: &mut Trial<'_>,
    run: impl Fn(&Kernels, [&[u16]; 3], &mut [u16]),
) {
    let Trial { random, compared, .. } = trial;
    for length in 0..=70 {
        for round in 0..64_usize {
            let mut inputs = [[0; COMBINED]; 3];
            inputs.as_flattened_mut().fill_with(|| random.entry());
            let mut starts = [0, 1, 2, 3].map(|bit| round >> bit & 1);
            let mut lengths = [length; 4];
            if round >= 48 {
                lengths = [0; 4].map(|_: usize| random.below(length + 1));
            } else if round >= 32 {
                lengths[round % 4] = random.below(length + 1);
            }
            let [a, b, c, to] = [0, 1, 2, 3].map(|i: usize| starts[i]..starts[i] + lengths[i]);
            let given = [&inputs[0][a], &inputs[1][b], &inputs[2][c]];
            let mut out = [0; COMBINED];
            out.fill_with(|| random.entry());
            let mut expected = out;
            run(kernels, given, &mut out[to.clone()]);
            run(&Kernels::PORTABLE, given, &mut expected[to]);
            starts = starts.map(|start| 2 * start);
            compared.note(out == expected, length, (3, 0), starts);
        }
    }
}

pub(super) fn lowest_entries(kernels: &Kernels, trial: &mut Trial<'_>) {
    let Trial { random, compared, .. } = trial;
    for length in 0..=70 {
        for round in 0..64 {
            let mut curve = [u16::MAX; COMBINED];
            match round {
                0 | 1 => {}
                2..10 => curve[random.below(COMBINED)] = random.next() as u16,
                10..20 => curve.fill_with(|| 0xffff - (random.next() & 3) as u16),
                _ => curve.fill_with(|| random.entry()),
            }
            let start = round % 2;
            let curve = &curve[start..start + length];
            compared.note(
                (kernels.lowest)(curve) == portable::lowest(curve),
                length,
                (1, 0),
                [2 * start, 0, 0, 0],
            );
        }
    }
}
