//! Cost curves with the sum-of-absolute-differences instruction of x86-64; codes and paths of
//! support points with its saturating sums of bytes.
//!
//! In and out as the [`portable`](super::portable) versions, the same bits.

use super::portable::support::{CODED_AT_ONCE, flat_but_coded};
use super::portable::{CODE_ROWS, CodeColumn, JUMP_PENALTY, LANES, STEP_PENALTY, STRIP, Strip};
use core::arch::x86_64::{
    __m128i, _mm_add_epi16, _mm_adds_epi8, _mm_and_si128, _mm_avg_epu8, _mm_cvtsi128_si32,
    _mm_max_epu8, _mm_min_epu8, _mm_or_si128, _mm_sad_epu8, _mm_set_epi64x, _mm_set1_epi8,
    _mm_setzero_si128, _mm_slli_si128, _mm_srli_si128, _mm_storeu_si128, _mm_sub_epi8,
    _mm_subs_epi8, _mm_subs_epu8, _mm_unpackhi_epi8, _mm_unpackhi_epi16, _mm_unpacklo_epi8,
    _mm_unpacklo_epi16, _mm_xor_si128,
};

/// Number of disparities whose sums are held in registers.
const BLOCK: usize = 8;

/// Adds the sum of absolute differences of all strips to each entry of `curve`: see
/// [`portable::sad_curve`](super::portable::sad_curve).
pub fn sad_curve(strips: &[Strip<'_>], curve: &mut [u16]) {
    // SAFETY: SSE2 is part of every x86-64 target; a third of a frame's matching time is spent
    // here, and this halves it.
    unsafe { sad_curve_sse2(strips, curve) }
}

#[target_feature(enable = "sse2")]
fn sad_curve_sse2(strips: &[Strip<'_>], curve: &mut [u16]) {
    let needed = curve.len() + STRIP - 1;
    let whole = curve.as_chunks_mut::<LANES>().0.as_flattened_mut();
    for (block, costs) in whole.chunks_exact_mut(BLOCK).enumerate() {
        let start = block * BLOCK;
        let mut sums = [_mm_setzero_si128(); BLOCK];
        let mut pairs = strips.chunks_exact(2);
        for pair in &mut pairs {
            if let [a, b] = pair {
                add_pair([Some(a), Some(b)], start, needed, &mut sums);
            }
        }
        if let [last] = pairs.remainder() {
            add_pair([Some(last), None], start, needed, &mut sums);
        }
        for (cost, sum) in costs.iter_mut().zip(sums) {
            let both = _mm_add_epi16(sum, _mm_srli_si128::<8>(sum));
            *cost = cost.wrapping_add(_mm_cvtsi128_si32(both) as u16);
        }
    }
}

/// Adds two strips, one in each half of a register, to the sums of eight disparities.
#[inline]
#[target_feature(enable = "sse2")]
fn add_pair(
    pair: [Option<&Strip<'_>>; 2],
    start: usize,
    needed: usize,
    sums: &mut [__m128i; BLOCK],
) {
    const REACH: usize = BLOCK + STRIP - 1;
    let [(others_a, reference_a), (others_b, reference_b)] = pair.map(|strip| {
        let strip = strip.filter(|strip| strip.other.len() >= needed);
        let others =
            strip.and_then(|s| s.other.get(start..)).and_then(|o| o.first_chunk::<REACH>());
        // A strip that is missing or too short adds 0: zeros against zeros.
        others.zip(strip).map_or((&[0; REACH], 0), |(o, s)| (o, i64::from_le_bytes(s.reference)))
    });
    let reference = _mm_set_epi64x(reference_b, reference_a);
    let windows = others_a.windows(STRIP).zip(others_b.windows(STRIP));
    for ((window_a, window_b), sum) in windows.zip(sums.iter_mut()) {
        let eight =
            |window: &[u8]| window.first_chunk::<STRIP>().map_or(0, |w| i64::from_le_bytes(*w));
        let other = _mm_set_epi64x(eight(window_b), eight(window_a));
        *sum = _mm_add_epi16(*sum, _mm_sad_epu8(reference, other));
    }
}

/// See [`portable::code_columns`](super::portable::code_columns).
pub fn code_columns(rows: [&[u8]; 2 * CODE_ROWS + 4], doublings: u32, columns: &mut [CodeColumn]) {
    // SAFETY: SSE2 is part of every x86-64 target; it takes a sixth of the portable version's
    // time, which is a fifth of a pair's.
    unsafe { code_columns_sse2(rows, doublings, columns) }
}

#[target_feature(enable = "sse2")]
fn code_columns_sse2(rows: [&[u8]; 2 * CODE_ROWS + 4], doublings: u32, columns: &mut [CodeColumn]) {
    let width = columns.len();
    let coded = flat_but_coded(&rows, columns);
    for (start, columns) in (0..).step_by(CODED_AT_ONCE).zip(coded.chunks_mut(CODED_AT_ONCE)) {
        // Around 0, so that differences are of signed bytes: two columns before, and there.
        let of = |row: &[u8], at: usize| {
            let pixels = row.get(at..width).unwrap_or(&[]);
            _mm_xor_si128(load(pixels), _mm_set1_epi8(i8::MIN))
        };
        let here = rows.map(|row| of(row, start + 2));
        let mut along = [_mm_setzero_si128(); CODE_ROWS + 1];
        let pairs = rows.as_chunks::<2>().0.iter().zip(here.as_chunks::<2>().0).skip(1);
        for (sums, ([upper, lower], here)) in along.iter_mut().zip(pairs) {
            *sums = _mm_adds_epi8(
                _mm_subs_epi8(here[0], of(upper, start)),
                _mm_subs_epi8(here[1], of(lower, start)),
            );
        }
        let mut codes = [_mm_setzero_si128(); CODE_ROWS];
        for (codes, (six, along)) in
            codes.iter_mut().zip(here.windows(6).step_by(2).zip(along.windows(2)))
        {
            let (&[above, next, _, _, third, fourth], &[upper, lower]) = (six, along) else {
                continue;
            };
            let down = _mm_adds_epi8(_mm_subs_epi8(third, above), _mm_subs_epi8(fourth, next));
            let h = full_scale(_mm_adds_epi8(upper, lower), doublings);
            let v = full_scale(down, doublings);
            // The mean of both, rounded down: `_mm_avg_epu8` rounds up.
            let odd = _mm_and_si128(_mm_xor_si128(h, v), _mm_set1_epi8(1));
            *codes = _mm_sub_epi8(_mm_avg_epu8(h, v), odd);
        }
        let [a, b, c, d] = codes;
        let low = (_mm_unpacklo_epi8(a, b), _mm_unpacklo_epi8(c, d));
        let high = (_mm_unpackhi_epi8(a, b), _mm_unpackhi_epi8(c, d));
        let fours = [
            _mm_unpacklo_epi16(low.0, low.1),
            _mm_unpackhi_epi16(low.0, low.1),
            _mm_unpacklo_epi16(high.0, high.1),
            _mm_unpackhi_epi16(high.0, high.1),
        ];
        for (four, columns) in fours.into_iter().zip(columns.chunks_mut(LANES / CODE_ROWS)) {
            store(four, columns.as_flattened_mut());
        }
    }
}

/// Sums of each entry and the next one, doubled so many times, from 0 on instead of around it; the
/// last one is not summed.
#[inline]
#[target_feature(enable = "sse2")]
fn full_scale(sums: __m128i, doublings: u32) -> __m128i {
    let mut sums = _mm_adds_epi8(sums, _mm_srli_si128::<1>(sums));
    for _ in 0..doublings {
        sums = _mm_adds_epi8(sums, sums);
    }
    _mm_xor_si128(sums, _mm_set1_epi8(i8::MIN))
}

/// See [`portable::code_costs`](super::portable::code_costs).
pub fn code_costs(window: &[CodeColumn; STRIP], columns: &[CodeColumn], costs: &mut [u8]) {
    // SAFETY: SSE2 is part of every x86-64 target; half of the time of support points is spent
    // here.
    unsafe { code_costs_sse2(window, columns, costs) }
}

#[target_feature(enable = "sse2")]
fn code_costs_sse2(window: &[CodeColumn; STRIP], columns: &[CodeColumn], costs: &mut [u8]) {
    let halves = |columns: &[CodeColumn]| {
        let (left, right) = columns.as_flattened().split_at(LANES.min(columns.len() * CODE_ROWS));
        (load(left), load(right))
    };
    let (left, right) = halves(window);
    for (cost, columns) in costs.iter_mut().zip(columns.windows(STRIP)) {
        let (x, y) = halves(columns);
        let sum = _mm_add_epi16(_mm_sad_epu8(left, x), _mm_sad_epu8(right, y));
        let sum = _mm_cvtsi128_si32(_mm_add_epi16(sum, _mm_srli_si128::<8>(sum)));
        *cost = (sum >> 6) as u8 + JUMP_PENALTY;
    }
}

/// See [`portable::path_step`](super::portable::path_step).
pub fn path_step(costs: &[u8], lowest: u8, path: &mut [u8]) -> u8 {
    // SAFETY: SSE2 is part of every x86-64 target; it takes a quarter of the portable version's
    // time.
    unsafe { path_step_sse2(costs, lowest, path) }
}

#[target_feature(enable = "sse2")]
fn path_step_sse2(costs: &[u8], lowest: u8, path: &mut [u8]) -> u8 {
    let length = path.len().min(costs.len());
    let Some(path) = path.get_mut(..length) else { return u8::MAX };
    let all = |byte: u8| _mm_set1_epi8(byte.cast_signed());
    let (step, reach) = (all(STEP_PENALTY), all(lowest.saturating_add(JUMP_PENALTY)));
    let mut lows = all(u8::MAX);
    // The last entry of the previous block, before its update.
    let mut before = u8::MAX;
    for (start, costs) in (0..).step_by(LANES).zip(costs.chunks(LANES)) {
        let Some(rest) = path.get_mut(start..) else { break };
        let behind = rest.get(LANES).copied().unwrap_or(u8::MAX);
        let here = rest.len().min(LANES);
        let Some(block) = rest.get_mut(..here) else { break };
        let same = load(block);
        let left = _mm_or_si128(_mm_slli_si128::<1>(same), _mm_set_epi64x(0, before.into()));
        let right =
            _mm_or_si128(_mm_srli_si128::<1>(same), _mm_set_epi64x(i64::from(behind) << 56, 0));
        before = block.last().copied().unwrap_or(u8::MAX);
        let near = _mm_subs_epu8(_mm_subs_epu8(reach, _mm_min_epu8(left, right)), step);
        let new = _mm_sub_epi8(load(costs), _mm_max_epu8(near, _mm_subs_epu8(reach, same)));
        lows = _mm_min_epu8(
            lows,
            if here == LANES { new } else { load(bytes(new).get(..here).unwrap_or(&[])) },
        );
        store(new, block);
    }
    bytes(lows).into_iter().fold(u8::MAX, u8::min)
}

/// Sixteen bytes, 255 where there are fewer.
#[inline]
#[target_feature(enable = "sse2")]
fn load(bytes: &[u8]) -> __m128i {
    let sixteen = bytes.first_chunk::<LANES>().copied().unwrap_or_else(|| {
        let mut padded = [u8::MAX; LANES];
        padded.iter_mut().zip(bytes).for_each(|(padded, &byte)| *padded = byte);
        padded
    });
    let (low, high) = sixteen.split_at(LANES / 2);
    let eight = |half: &[u8]| half.first_chunk().map_or(0, |half| i64::from_le_bytes(*half));
    _mm_set_epi64x(eight(high), eight(low))
}

/// The bytes of a register.
#[inline]
#[target_feature(enable = "sse2")]
fn bytes(register: __m128i) -> [u8; LANES] {
    let mut bytes = [0; LANES];
    // SAFETY: sixteen bytes are written to sixteen.
    unsafe { _mm_storeu_si128(bytes.as_mut_ptr().cast(), register) };
    bytes
}

/// As many of a register's bytes as there is room for.
#[inline]
#[target_feature(enable = "sse2")]
fn store(register: __m128i, out: &mut [u8]) {
    let found = bytes(register);
    match out.first_chunk_mut::<LANES>() {
        Some(sixteen) => *sixteen = found,
        None => out.iter_mut().zip(found).for_each(|(out, byte)| *out = byte),
    }
}
