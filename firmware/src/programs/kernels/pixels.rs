//! Grey levels between pixels.

use super::rooms::{ALIGNMENTS, Contents, IMAGE, ROW, UNTOUCHED, range, same};
use super::{Kernels, Trial};
use crate::programs::random::Random;
use linestereo_rig::kernel::{CELL, Knot, Ring, Run, columns, portable};

/// Most runs of one list here.
const MOST: usize = 5;

/// A run that lies between two rows, often as close to an end of them as can be.
fn inside(random: &mut Random, width: usize, length: usize, bytes: usize) -> Run {
    let end = (width as i32 - 1) << 16;
    let mut run = Run { length: length as u32, ..Run::default() };
    let mut row = || if random.below(3) == 0 { bytes - width } else { random.below(bytes - width + 1) } as u32;
    (run.top, run.bottom) = (row(), row());
    let mut ends = |most: i32| match random.below(4) {
        0 => 0,
        1 => most,
        _ => (random.next() >> 1) as i32 % (most + 1),
    };
    let steps = (length as i32 - 1).max(1);
    for (from, step, most) in
        [(&mut run.x_q16, &mut run.dx_q16, end - 1), (&mut run.fy_q14, &mut run.dfy_q14, 1 << 14)]
    {
        let (first, last) = (ends(most), ends(most));
        // Rounded towards zero: the last one is not passed.
        (*from, *step) = (first, (last - first) / steps);
    }
    // A parabola now and then: a little, so that it mostly stays inside.
    if random.below(2) == 0 {
        run.ddx_q16 = random.below(300) as i32 - 150;
    }
    run
}

pub(super) fn bilinear_runs(kernels: &Kernels, trial: &mut Trial<'_>) {
    let Trial { rooms, random, compared } = trial;
    for round in 0..12_000_usize {
        if round % 40 == 0 {
            Contents::ALL[round / 40 % 6].fill(random, &mut rooms.image.contents);
        }
        let at_back = round % 2 == 0;
        let width = match round % 5 {
            0 => random.below(4),
            1 => 320,
            _ => 2 + random.below(60),
        };
        let bytes = width + random.below(1000);
        let mut runs = [Run::default(); MOST];
        let count = 1 + random.below(MOST);
        let mut total = 0;
        for run in &mut runs[..count] {
            let length = if round % 7 == 0 { random.below(90) } else { 1 + random.below(18) };
            if width >= 2 {
                *run = inside(random, width, length, bytes);
            }
            total += length;
        }
        // Often one of them is off by a little or by much.
        if round % 3 == 0 {
            let run = &mut runs[random.below(count)];
            let much = [1, -1, 1 << 14, -(1 << 16), 1 << 26, i32::MAX, i32::MIN][random.below(7)];
            match random.below(8) {
                7 => run.ddx_q16 = run.ddx_q16.wrapping_add(much),
                0 => run.x_q16 = run.x_q16.wrapping_add(much),
                1 => run.dx_q16 = run.dx_q16.wrapping_add(much),
                2 => run.fy_q14 = run.fy_q14.wrapping_add(much),
                3 => run.dfy_q14 = run.dfy_q14.wrapping_add(much),
                4 => run.top = run.top.wrapping_add(much as u32),
                5 => run.bottom = run.bottom.wrapping_add(much as u32),
                _ => run.length = run.length.wrapping_add(much as u32),
            }
        }
        let length =
            if round % 11 == 0 { random.below(total + 3) } else { total }.min(ROW - ALIGNMENTS);
        let rows = range(IMAGE, bytes, random.below(ALIGNMENTS), at_back);
        let to = range(ROW, length, random.below(ALIGNMENTS), at_back);
        let starts = [rows.start, to.start, 0, 0];
        let (rows, runs) = (&rooms.image.contents[rows], &runs[..count]);
        let out = &mut rooms.out.contents;
        out.fill(UNTOUCHED);
        let mut expected = *out;
        (kernels.bilinear_runs)(rows, width, runs, &mut out[to.clone()]);
        portable::bilinear_runs(rows, width, runs, &mut expected[to]);
        compared.note(same(out, &expected), runs[0].length as usize, (count, width), starts);
    }
}

/// Most knots of one row here.
const KNOTS: usize = 8;
/// Positions far outside, or next to the end of numbers.
const ANYWHERE: [i32; 8] = [0, 1, -1, 1 << 16, -(1 << 20), 1 << 29, i32::MAX, i32::MIN];

pub(super) fn bilinear_cells(kernels: &Kernels, trial: &mut Trial<'_>) {
    let Trial { rooms, random, compared } = trial;
    for round in 0..8_000_usize {
        if round % 40 == 0 {
            Contents::ALL[round / 40 % 6].fill(random, &mut rooms.image.contents);
        }
        let at_back = round % 2 == 0;
        let width = [1 + random.below(60), 255, 256, 257, 320][round % 5];
        let rows = 1 + random.below(9);
        // Rows held, as few as may be; now and then a little less.
        let bytes =
            (rows - 1) * width + columns(width) + 1 - random.below(2) * usize::from(round % 9 == 0);
        let first = random.below(500) as i32;
        // From anywhere to anywhere inside, by about as many pixels as there are, up or down.
        let mut knots = [Knot::default(); KNOTS];
        let (lean, mut at) = (random.below(7) as i32 - 3, Knot { x: 0, y: 0 });
        at.x = random.below(width) as i32 * 65536 - (1 << 20);
        at.y = (first + random.below(rows) as i32) * 65536 + random.below(65536) as i32;
        for knot in &mut knots {
            *knot = at;
            at.x = at.x.wrapping_add((1 << 20) + random.below(120_000) as i32 - 60_000);
            at.y = at.y.wrapping_add(lean * random.below(1 << 17) as i32);
        }
        if round % 3 == 0 {
            let knot = &mut knots[random.below(KNOTS)];
            let value = ANYWHERE[random.below(8)];
            *(if random.below(2) == 0 { &mut knot.x } else { &mut knot.y }) = value;
        }
        let count = random.below(KNOTS + 1);
        let cells = count.saturating_sub(3) * CELL;
        let length = if round % 4 == 0 { random.below(cells + 20) } else { cells };
        let held = range(IMAGE, bytes, random.below(ALIGNMENTS), at_back);
        let to = range(ROW, length, random.below(ALIGNMENTS), at_back);
        let starts = [held.start, to.start, 0, 0];
        let rows = if round % 50 == 0 { 0 } else { rows as u32 };
        let ring = Ring { bytes: &rooms.image.contents[held], width, rows, first };
        let out = &mut rooms.out.contents;
        out.fill(UNTOUCHED);
        let mut expected = *out;
        (kernels.bilinear_cells)(ring, &knots[..count], &mut out[to.clone()]);
        portable::bilinear_cells(ring, &knots[..count], &mut expected[to]);
        compared.note(same(out, &expected), length, (count, width), starts);
    }
}

pub(super) fn weighed_knots(kernels: &Kernels, trial: &mut Trial<'_>) {
    let Trial { random, compared, .. } = trial;
    for round in 0..2_000_usize {
        let mut number = || match round % 3 {
            0 => ANYWHERE[random.below(8)],
            _ => random.next() as i32,
        };
        let rows: [[Knot; KNOTS]; 4] =
            [(); 4].map(|()| [(); KNOTS].map(|()| Knot { x: number(), y: number() }));
        let weights = [(); 4].map(|()| number());
        let counts: [usize; 5] =
            [(); 5].map(|()| if round % 4 == 0 { random.below(KNOTS + 1) } else { 6 });
        let [a, b, c, d] = &rows;
        let rows = [&a[..counts[0]], &b[..counts[1]], &c[..counts[2]], &d[..counts[3]]];
        let mut found = [Knot { x: 7, y: 7 }; KNOTS];
        let mut expected = found;
        (kernels.weigh_knots)(rows, weights, &mut found[..counts[4]]);
        portable::weigh_knots(rows, weights, &mut expected[..counts[4]]);
        compared.note(found == expected, counts[4], (counts[0], 0), [0; 4]);
    }
}
