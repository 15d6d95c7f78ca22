//! Steps and crossings of edges, and census of one pixel.

use super::rooms::{ALIGNMENTS, Contents, IMAGE, range};
use super::{Kernels, Trial};
use linestereo::unstable::kernel::portable;

pub(super) fn largest_steps(kernels: &Kernels, trial: &mut Trial<'_>) {
    const FAR: [usize; 5] =
        [usize::MAX / 20, usize::MAX / 2, usize::MAX / 2 + 1, usize::MAX - 1, usize::MAX];
    let Trial { rooms, random, compared } = trial;
    for contents in Contents::ALL {
        contents.fill(random, &mut rooms.image.contents);
        for stride in (0..=5).chain([8, 63, 255, 319, 320, 321, 322, 640]).chain(FAR) {
            for count in (0..=20).chain([500, 0xfffe, 0xffff, 0x1_0000, usize::MAX]) {
                if stride == 0 && count > 500 && (contents != Contents::Random || count > 0x1_0000)
                {
                    continue; // the same pixel for ever
                }
                let needed = count.saturating_sub(1).saturating_mul(stride).saturating_add(1);
                for length in [
                    needed,
                    needed.saturating_add(1),
                    needed - 1,
                    needed - needed.min(stride),
                    needed / 2,
                    0,
                ] {
                    let length = length.min(IMAGE - ALIGNMENTS);
                    for distance in 0..ALIGNMENTS {
                        let range = range(IMAGE, length, distance, count % 2 == 0);
                        let starts = [range.start, 0, 0, 0];
                        let pixels = &rooms.image.contents[range];
                        let ours = (kernels.largest_step)(pixels, stride, count);
                        let equal = ours == portable::largest_step(pixels, stride, count);
                        compared.note(equal, length, (count, stride), starts);
                        if count > 500 {
                            break;
                        }
                    }
                }
            }
        }
    }
}

/// A kernel that looks around a pixel at a stride, with a sign; `look` runs it.
pub(super) fn crossings<T: PartialEq>(
    kernels: &Kernels,
    trial: &mut Trial<'_>,
    look: impl Fn(&Kernels, &[u8], usize, usize, i32) -> Option<T>,
) {
    const FAR: [usize; 12] = [
        usize::MAX,
        usize::MAX - 1,
        usize::MAX - 2,
        usize::MAX - 6,
        usize::MAX - 7,
        usize::MAX - 13,
        usize::MAX / 2,
        usize::MAX / 2 + 1,
        usize::MAX / 6,
        usize::MAX / 6 + 1,
        usize::MAX / 7,
        usize::MAX / 7 + 1,
    ];
    let Trial { rooms, random, compared } = trial;
    let mut compare = |image: &[u8; IMAGE],
                       length: usize,
                       first: usize,
                       stride: usize,
                       distance: usize,
                       at_back| {
        let range = range(IMAGE, length, distance, at_back);
        let start = range.start;
        let pixels = &image[range];
        for sign in [1, -1] {
            let [ours, theirs] = [kernels, &Kernels::PORTABLE]
                .map(|kernels| look(kernels, pixels, first, stride, sign));
            compared.note(ours == theirs, length, (first, stride), [start, 0, 0, 0]);
        }
    };
    for contents in Contents::ALL {
        contents.fill(random, &mut rooms.image.contents);
        let image = &rooms.image.contents;
        for length in 0..=24 {
            for first in (0..length + 2).chain(FAR) {
                for stride in (0..9).chain(FAR) {
                    compare(image, length, first, stride, length % ALIGNMENTS, false);
                    compare(image, length, first, stride, 0, true);
                }
            }
        }
        for round in 0..1000 {
            // Just long enough, or just not, or anything.
            let (first, stride) = (random.below(700), [random.below(400), 320, 64][round % 3]);
            let needed = first + [6 * stride + 2, stride + 7][round % 2];
            let length = (needed + 1 - random.below(3)).min(IMAGE - ALIGNMENTS);
            compare(image, length, first, stride, round % ALIGNMENTS, round % 8 < 4);
        }
    }
}
