//! Cost curves, and codes, costs and paths of support points, with the vectors of WebAssembly.
//!
//! In and out as the [`portable`](super::portable) versions, the same bits.

use super::portable::support::{CODED_AT_ONCE, flat_but_coded};
use super::portable::{CODE_ROWS, CodeColumn, JUMP_PENALTY, LANES, STEP_PENALTY, STRIP, Strip};
use core::arch::wasm32::{
    i8x16_add_sat, i8x16_shuffle, i8x16_splat, i8x16_sub_sat, i16x8_narrow_i32x4, i16x8_shuffle,
    u8x16_add, u8x16_avgr, u8x16_max, u8x16_min, u8x16_narrow_i16x8, u8x16_splat, u8x16_sub,
    u8x16_sub_sat, u16x8_add, u16x8_extadd_pairwise_u8x16, u16x8_splat,
    u32x4_extadd_pairwise_u16x8, u32x4_shr, u32x4_splat, v128, v128_and, v128_load, v128_store,
    v128_xor,
};

/// Columns of codes in a vector.
const COLUMNS: usize = LANES / CODE_ROWS;

/// See [`portable::sad_curve`](super::portable::sad_curve).
pub fn sad_curve(strips: &[Strip<'_>], curve: &mut [u16]) {
    let needed = curve.len() + STRIP - 1;
    for (start, costs) in (0..).step_by(LANES).zip(curve.as_chunks_mut::<LANES>().0) {
        let mut sums = [u16x8_splat(0); 2];
        for strip in strips.iter().filter(|strip| strip.other.len() >= needed) {
            const REACH: usize = LANES + STRIP - 1;
            let Some(others) = strip.other.get(start..).and_then(|o| o.first_chunk::<REACH>())
            else {
                continue;
            };
            let apart = |(other, &reference): (&[u8], &u8)| {
                let (other, reference) = (load(other), u8x16_splat(reference));
                u8x16_sub(u8x16_max(other, reference), u8x16_min(other, reference))
            };
            let mut differences = others.windows(LANES).zip(&strip.reference).map(apart);
            while let (Some(a), Some(b)) = (differences.next(), differences.next()) {
                let low =
                    i8x16_shuffle::<0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23>(a, b);
                let high =
                    i8x16_shuffle::<8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31>(
                        a, b,
                    );
                sums = [
                    u16x8_add(sums[0], u16x8_extadd_pairwise_u8x16(low)),
                    u16x8_add(sums[1], u16x8_extadd_pairwise_u8x16(high)),
                ];
            }
        }
        for (costs, sum) in costs.as_chunks_mut::<{ LANES / 2 }>().0.iter_mut().zip(sums) {
            let sums = bytes(sum);
            for (cost, &sum) in costs.iter_mut().zip(sums.as_chunks::<2>().0) {
                *cost = cost.wrapping_add(u16::from_le_bytes(sum));
            }
        }
    }
}

/// See [`portable::code_columns`](super::portable::code_columns).
pub fn code_columns(rows: [&[u8]; 2 * CODE_ROWS + 4], doublings: u32, columns: &mut [CodeColumn]) {
    let width = columns.len();
    let coded = flat_but_coded(&rows, columns);
    for (start, columns) in (0..).step_by(CODED_AT_ONCE).zip(coded.chunks_mut(CODED_AT_ONCE)) {
        // Around 0, so that differences are of signed bytes: two columns before, and there.
        let of = |row: &[u8], at: usize| {
            v128_xor(load(row.get(at..width).unwrap_or(&[])), i8x16_splat(i8::MIN))
        };
        let here = rows.map(|row| of(row, start + 2));
        let mut along = [u8x16_splat(0); CODE_ROWS + 1];
        let pairs = rows.as_chunks::<2>().0.iter().zip(here.as_chunks::<2>().0).skip(1);
        for (sums, ([upper, lower], here)) in along.iter_mut().zip(pairs) {
            *sums = i8x16_add_sat(
                i8x16_sub_sat(here[0], of(upper, start)),
                i8x16_sub_sat(here[1], of(lower, start)),
            );
        }
        let mut codes = [u8x16_splat(0); CODE_ROWS];
        for (codes, (six, along)) in
            codes.iter_mut().zip(here.windows(6).step_by(2).zip(along.windows(2)))
        {
            let (&[above, next, _, _, third, fourth], &[upper, lower]) = (six, along) else {
                continue;
            };
            let down = i8x16_add_sat(i8x16_sub_sat(third, above), i8x16_sub_sat(fourth, next));
            let h = full_scale(i8x16_add_sat(upper, lower), doublings);
            let v = full_scale(down, doublings);
            // The mean of both, rounded down: `u8x16_avgr` rounds up.
            let odd = v128_and(v128_xor(h, v), u8x16_splat(1));
            *codes = u8x16_sub(u8x16_avgr(h, v), odd);
        }
        let [a, b, c, d] = codes;
        let low =
            |a, b| i8x16_shuffle::<0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23>(a, b);
        let high = |a, b| {
            i8x16_shuffle::<8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31>(a, b)
        };
        let halves = [(low(a, b), low(c, d)), (high(a, b), high(c, d))];
        let fours = halves.into_iter().flat_map(|(ab, cd)| {
            [
                i16x8_shuffle::<0, 8, 1, 9, 2, 10, 3, 11>(ab, cd),
                i16x8_shuffle::<4, 12, 5, 13, 6, 14, 7, 15>(ab, cd),
            ]
        });
        for (four, columns) in fours.zip(columns.chunks_mut(COLUMNS)) {
            store(four, columns.as_flattened_mut());
        }
    }
}

/// Sums of each entry and the next one, doubled so many times, from 0 on instead of around it; the
/// last one is not summed.
#[inline]
fn full_scale(sums: v128, doublings: u32) -> v128 {
    let next = i8x16_shuffle::<1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 0>(sums, sums);
    let mut sums = i8x16_add_sat(sums, next);
    for _ in 0..doublings {
        sums = i8x16_add_sat(sums, sums);
    }
    v128_xor(sums, i8x16_splat(i8::MIN))
}

/// See [`portable::code_costs`](super::portable::code_costs).
pub fn code_costs(window: &[CodeColumn; STRIP], columns: &[CodeColumn], costs: &mut [u8]) {
    let reference = window.map(|column| u32x4_splat(u32::from_ne_bytes(column)));
    let count = costs.len().min((columns.len() + 1).saturating_sub(STRIP));
    let costs = costs.get_mut(..count).unwrap_or_default();
    for (start, costs) in (0..).step_by(LANES).zip(costs.chunks_mut(LANES)) {
        let codes = columns.get(start..).unwrap_or_default();
        let sums = [0, 1, 2, 3].map(|quarter| {
            four_sums(&reference, codes.get(quarter * COLUMNS..).unwrap_or_default())
        });
        let halves = i16x8_narrow_i32x4(sums[0], sums[1]);
        let bytes = u8x16_narrow_i16x8(halves, i16x8_narrow_i32x4(sums[2], sums[3]));
        store(u8x16_add(bytes, u8x16_splat(JUMP_PENALTY)), costs);
    }
}

/// 1/64 of the sums, for the windows that start at the first four columns; of columns that are
/// missing anything.
#[inline]
fn four_sums(reference: &[v128; STRIP], columns: &[CodeColumn]) -> v128 {
    const REACH: usize = COLUMNS + STRIP - 1;
    let mut padded = [[0; CODE_ROWS]; REACH];
    let columns = columns.first_chunk::<REACH>().unwrap_or_else(|| {
        padded.iter_mut().zip(columns).for_each(|(padded, column)| *padded = *column);
        &padded
    });
    let mut sums = u16x8_splat(0);
    for (reference, columns) in reference.iter().zip(columns.windows(COLUMNS)) {
        let codes = load(columns.as_flattened());
        let apart = u8x16_sub(u8x16_max(codes, *reference), u8x16_min(codes, *reference));
        sums = u16x8_add(sums, u16x8_extadd_pairwise_u8x16(apart));
    }
    u32x4_shr(u32x4_extadd_pairwise_u16x8(sums), 6)
}

/// See [`portable::path_step`](super::portable::path_step).
pub fn path_step(costs: &[u8], lowest: u8, path: &mut [u8]) -> u8 {
    let length = path.len().min(costs.len());
    let Some(path) = path.get_mut(..length) else { return u8::MAX };
    let (step, reach) =
        (u8x16_splat(STEP_PENALTY), u8x16_splat(lowest.saturating_add(JUMP_PENALTY)));
    let mut lows = u8x16_splat(u8::MAX);
    // The last entry of the previous block, before its update.
    let mut before = u8::MAX;
    for (start, costs) in (0..).step_by(LANES).zip(costs.chunks(LANES)) {
        let Some(rest) = path.get_mut(start..) else { break };
        let behind = rest.get(LANES).copied().unwrap_or(u8::MAX);
        let here = rest.len().min(LANES);
        let Some(block) = rest.get_mut(..here) else { break };
        let same = load(block);
        let left = i8x16_shuffle::<0, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30>(
            i8x16_splat(before.cast_signed()),
            same,
        );
        let right = i8x16_shuffle::<1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16>(
            same,
            i8x16_splat(behind.cast_signed()),
        );
        before = block.last().copied().unwrap_or(u8::MAX);
        let near = u8x16_sub_sat(u8x16_sub_sat(reach, u8x16_min(left, right)), step);
        let new = u8x16_sub(load(costs), u8x16_max(near, u8x16_sub_sat(reach, same)));
        lows = u8x16_min(
            lows,
            if here == LANES { new } else { load(bytes(new).get(..here).unwrap_or(&[])) },
        );
        store(new, block);
    }
    bytes(lows).into_iter().fold(u8::MAX, u8::min)
}

/// Sixteen bytes, 255 where there are fewer.
#[inline]
fn load(bytes: &[u8]) -> v128 {
    let sixteen = bytes.first_chunk::<LANES>().copied().unwrap_or_else(|| {
        let mut padded = [u8::MAX; LANES];
        padded.iter_mut().zip(bytes).for_each(|(padded, &byte)| *padded = byte);
        padded
    });
    // SAFETY: sixteen bytes are read of sixteen.
    unsafe { v128_load(sixteen.as_ptr().cast()) }
}

/// The bytes of a vector.
#[inline]
fn bytes(vector: v128) -> [u8; LANES] {
    let mut bytes = [0; LANES];
    // SAFETY: sixteen bytes are written to sixteen.
    unsafe { v128_store(bytes.as_mut_ptr().cast(), vector) };
    bytes
}

/// As many of a vector's bytes as there is room for.
#[inline]
fn store(vector: v128, out: &mut [u8]) {
    let found = bytes(vector);
    match out.first_chunk_mut::<LANES>() {
        Some(sixteen) => *sixteen = found,
        None => out.iter_mut().zip(found).for_each(|(out, byte)| *out = byte),
    }
}
