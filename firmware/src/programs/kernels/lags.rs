//! Products of gradients along two rows, at several lags.

use super::rooms::{ALIGNMENTS, Contents, ROW, range};
use super::{Kernels, Trial};
use linestereo::unstable::kernel::{GRADIENTS, Products, RIGHT_GRADIENTS, portable};

pub(super) fn products(kernels: &Kernels, trial: &mut Trial<'_>) {
    const LEFT: usize = GRADIENTS + 2;
    const RIGHT: usize = RIGHT_GRADIENTS + 2;
    let Trial { rooms, random, compared } = trial;
    let [left, right, _] = &mut rooms.rows;
    for (of_left, of_right) in
        Contents::ALL.into_iter().flat_map(|of_left| Contents::ALL.map(|all| (of_left, all)))
    {
        for round in 0..8 * ALIGNMENTS * ALIGNMENTS {
            of_left.fill(random, &mut left.contents);
            of_right.fill(random, &mut right.contents);
            let at_left = range(ROW, LEFT, round % ALIGNMENTS, random.below(2) == 0);
            let at_right = range(ROW, RIGHT, round / ALIGNMENTS % ALIGNMENTS, random.below(2) == 0);
            let starts = [at_left.start, at_right.start, 0, 0];
            let (Some(left), Some(right)) =
                (left.contents[at_left].first_chunk(), right.contents[at_right].first_chunk())
            else {
                continue;
            };
            // What was summed before: anything, so that sums wrap.
            let mut number = || random.next() as i32;
            let mut sums = [(); 2]
                .map(|()| Products { at_lags: [(); 5].map(|()| number()), energy: number() });
            let mut expected = sums;
            (kernels.add_products)(left, right, &mut sums);
            portable::add_products(left, right, &mut expected);
            compared.note(sums == expected, RIGHT, (LEFT, 0), starts);
        }
    }
}
