//! Strips of fewer than eight columns: what the kernel compares beyond them is taken off.
//!
//! In: strips whose last columns are flat. Out: the cost of the others alone.

use crate::curve::MAX_DISPARITIES;
use crate::kernel::{FLAT, STRIP};

/// Takes the differences between `beyond` flat pixels of each row and these rows off each cost.
pub(crate) fn take_off(rows: &[&[u8]], beyond: usize, costs: &mut [u16]) {
    let mut columns = [0_u8; MAX_DISPARITIES + STRIP];
    let length = if beyond > 0 { costs.len() + beyond } else { 0 };
    let fours = columns.as_chunks_mut().0;
    for (four, x) in fours.iter_mut().zip((0..length).step_by(4)) {
        *four = sizes(rows, x);
    }
    let entering = columns.get(beyond..).unwrap_or(&[]);
    let mut sum: u16 = columns.iter().take(beyond).map(|&size| u16::from(size)).sum();
    for ((cost, &gone), &next) in costs.iter_mut().zip(&columns).zip(entering) {
        *cost = cost.saturating_sub(sum);
        sum = sum.wrapping_add(next.into()).wrapping_sub(gone.into());
    }
}

/// Sums of the sizes of the gradients of these rows, at most eight, at four columns from `x` on.
fn sizes(rows: &[&[u8]], x: usize) -> [u8; 4] {
    let mut sums = 0_u32;
    for row in rows {
        let there = row.get(x..).unwrap_or(&[]);
        let four = there.first_chunk().copied().unwrap_or_else(|| {
            let mut four = [FLAT; 4];
            four.iter_mut().zip(there).for_each(|(four, &gradient)| *four = gradient);
            four
        });
        // Bit 5 is set from FLAT on: without it, what lies below is 64 less its size.
        let off = u32::from_le_bytes(four) ^ 0x2020_2020;
        let below = (off >> 5) & 0x0101_0101;
        sums += (off ^ (below * 63)) + below;
    }
    sums.to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Strip, sad_curve};

    #[test]
    fn what_is_beyond_is_taken_off() {
        let other: [u8; 48] = core::array::from_fn(|i| (i * 7 % 63) as u8 + 1);
        let reference = [FLAT, FLAT, FLAT, 20, 40, 33, 12, 60];
        let mut costs = [0; 32];
        sad_curve(&[Strip { reference, other: &other }], &mut costs);
        take_off(&[&other], 3, &mut costs);
        for (d, &cost) in costs.iter().enumerate() {
            let own =
                (3..STRIP).map(|k| u16::from(other[d + k].abs_diff(reference[k]))).sum::<u16>();
            assert_eq!(cost, own, "{d}");
        }
    }
}
