//! Portable kernels of support points: codes of texture, costs of windows of codes, paths.

use super::{LANES, STRIP};
use core::cell::Cell;

/// Number of rows of codes in a window, each of two rows of pixels.
pub const CODE_ROWS: usize = 4;
/// Code where nothing changes.
pub const CODE_FLAT: u8 = 128;
/// P1 of a path: cost of a change of disparity by 1 px.
pub const STEP_PENALTY: u8 = 6;
/// P2 of a path: cost of a larger change of disparity.
pub const JUMP_PENALTY: u8 = 20;

/// Codes of [`CODE_ROWS`] rows at one column.
pub type CodeColumn = [u8; CODE_ROWS];

/// Columns that are coded at a time: one less than vectors hold, since each reads the next one.
pub(in crate::kernel) const CODED_AT_ONCE: usize = LANES - 1;

/// Codes of the texture of twelve adjacent rows, column by column: code row `k` is of rows `2 k ..=
/// 2 k + 5`, whose middle ones are `a` and `b` below.
///
/// ```text
/// H = sum over four rows, a to b + 2 and below:   I(x) - I(x - 2)
/// V = I(a + 2) - I(a - 2) + I(b + 2) - I(b - 2)        b = a + 1
/// code = 128 + (2^n (H(x) + H(x + 1)) + 2^n (V(x) + V(x + 1))) / 2   sums limited to -128 ..= 127
/// ```
/// `doublings` is n: what a code's full scale is in grey levels. The first and last two columns are
/// [`CODE_FLAT`], and all where a row has fewer pixels than there are columns.
pub fn code_columns(rows: [&[u8]; 2 * CODE_ROWS + 4], doublings: u32, columns: &mut [CodeColumn]) {
    let width = columns.len();
    let coded = flat_but_coded(&rows, columns);
    for (start, columns) in (0..).step_by(CODED_AT_ONCE).zip(coded.chunks_mut(CODED_AT_ONCE)) {
        // Around 0, so that differences are of signed bytes.
        let mut pixels = [[0_i8; LANES + 2]; 2 * CODE_ROWS + 4];
        for (pixels, row) in pixels.iter_mut().zip(rows) {
            let row = row.get(start..width).unwrap_or(&[]);
            pixels
                .iter_mut()
                .zip(row)
                .for_each(|(pixel, &level)| *pixel = (level ^ 0x80).cast_signed());
        }
        let mut row_pairs = pixels.as_chunks::<2>().0.iter();
        let _first = row_pairs.next();
        let mut along = [[0; LANES]; CODE_ROWS + 1];
        for (sums, pair) in along.iter_mut().zip(row_pairs) {
            *sums = pair_along(pair);
        }
        for (k, (six, along)) in pixels.windows(6).step_by(2).zip(along.windows(2)).enumerate() {
            let (Some(six), &[upper, lower]) = (six.first_chunk(), along) else { continue };
            let h = full_scale(each(upper, lower, i8::saturating_add), doublings);
            let v = full_scale(down(six), doublings);
            let code = |(h, v): (i8, i8)| (((i16::from(h) + i16::from(v)) >> 1) as u8) ^ 0x80;
            for (column, code) in columns.iter_mut().zip(h.into_iter().zip(v).map(code)) {
                if let Some(entry) = column.get_mut(k) {
                    *entry = code;
                }
            }
        }
    }
}

/// Sets all columns to [`CODE_FLAT`]; returns those that have codes.
pub(in crate::kernel) fn flat_but_coded<'c>(
    rows: &[&[u8]; 2 * CODE_ROWS + 4],
    columns: &'c mut [CodeColumn],
) -> &'c mut [CodeColumn] {
    columns.fill([CODE_FLAT; CODE_ROWS]);
    let width = columns.len();
    let are_whole = rows.iter().all(|row| row.len() >= width);
    let coded = width.checked_sub(2).filter(|_| are_whole);
    coded.and_then(|end| columns.get_mut(2..end)).unwrap_or(&mut [])
}

/// `of(a, b)` of each two entries.
#[inline(always)]
fn each(a: [i8; LANES], b: [i8; LANES], of: impl Fn(i8, i8) -> i8) -> [i8; LANES] {
    let mut out = a;
    out.iter_mut().zip(b).for_each(|(out, b)| *out = of(*out, b));
    out
}

/// Differences over two columns of two rows, summed.
#[inline(always)]
fn pair_along(rows: &[[i8; LANES + 2]; 2]) -> [i8; LANES] {
    let [upper, lower] =
        rows.each_ref().map(|row| each(from(row, 2), from(row, 0), i8::saturating_sub));
    each(upper, lower, i8::saturating_add)
}

/// Differences over four rows, of two adjacent ones summed.
#[inline(always)]
fn down(rows: &[[i8; LANES + 2]; 6]) -> [i8; LANES] {
    let [above, next, _, _, third, fourth] = rows.each_ref().map(|row| from(row, 2));
    each(
        each(third, above, i8::saturating_sub),
        each(fourth, next, i8::saturating_sub),
        i8::saturating_add,
    )
}

#[inline(always)]
fn from(row: &[i8; LANES + 2], start: usize) -> [i8; LANES] {
    row.get(start..).and_then(<[i8]>::first_chunk).copied().unwrap_or([0; LANES])
}

/// Sums of each entry and the next one, doubled so many times; the last one is not summed.
#[inline(always)]
fn full_scale(sums: [i8; LANES], doublings: u32) -> [i8; LANES] {
    let mut next = sums;
    next.rotate_left(1);
    let mut sums = each(sums, next, i8::saturating_add);
    for _ in 0..doublings {
        sums = each(sums, sums, i8::saturating_add);
    }
    sums
}

/// Cost of a window of codes along the columns in which it is searched: entry i is 1/64 of the sum
/// of absolute differences to `columns[i..i + 8]`, 0 ..= 127, plus [`JUMP_PENALTY`]. Entries for
/// which there are too few columns stay.
pub fn code_costs(window: &[CodeColumn; STRIP], columns: &[CodeColumn], costs: &mut [u8]) {
    for (cost, columns) in costs.iter_mut().zip(columns.windows(STRIP)) {
        let codes = window.as_flattened().iter().zip(columns.as_flattened());
        let sum = codes.fold(0, |sum, (&left, &right)| sum + u16::from(left.abs_diff(right)));
        *cost = (sum >> 6) as u8 + JUMP_PENALTY;
    }
}

/// Sum of the differences of each two consecutive columns of a window: 0 ..= 28 * 255.
#[must_use]
pub fn code_steps(window: &[CodeColumn; STRIP]) -> u16 {
    let rest = window.as_flattened().get(CODE_ROWS..).unwrap_or(&[]);
    rest.iter()
        .zip(window.as_flattened())
        .fold(0, |sum, (after, &before)| sum + u16::from(after.abs_diff(before)))
}

/// Sums over a window of the squared changes of codes along the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeMoments {
    /// Their sum: 8 * 4 * 255^2 at most.
    pub all: u32,
    /// Of each times its column, 0 ..= 7.
    pub across: u32,
    /// Of each times its row of codes, 0 ..= 3.
    pub down: u32,
}

/// Moments of the changes over two columns of a window, given with the column before and the one
/// behind it.
#[must_use]
pub fn code_moments(columns: &[CodeColumn; STRIP + 2]) -> CodeMoments {
    let mut sums = CodeMoments { all: 0, across: 0, down: 0 };
    for (x, (before, after)) in (0..).zip(columns.iter().zip(columns.iter().skip(2))) {
        for (row, (before, after)) in (0..).zip(before.iter().zip(after)) {
            let change = u32::from(before.abs_diff(*after));
            let square = change * change;
            sums.all += square;
            sums.across += x * square;
            sums.down += row * square;
        }
    }
    sums
}

/// Pixels of a row of [`second_differences`].
pub const RUN_PIXELS: usize = STRIP + 4;

/// Sum over eight columns of |second difference across of the second difference down|, of pixels
/// `apart` columns from each other, 1 or 2; 0 for any other.
#[must_use]
pub fn second_differences(rows: [&[u8; RUN_PIXELS]; 3], apart: usize) -> u32 {
    if !(1..=2).contains(&apart) {
        return 0;
    }
    let [above, here, below] = rows;
    let mut down = [0_i32; RUN_PIXELS];
    for (down, ((&above, &here), &below)) in down.iter_mut().zip(above.iter().zip(here).zip(below))
    {
        *down = i32::from(above) - 2 * i32::from(here) + i32::from(below);
    }
    let from = |first: usize| down.iter().skip(first);
    let across = from(0).zip(from(apart)).zip(from(2 * apart)).take(STRIP);
    across.map(|((&before, &here), &after)| (before - 2 * here + after).unsigned_abs()).sum()
}

/// Differences `after - before`, limited to +-`most` and shifted by it, over the length of the
/// shortest; `most` is at most 127.
pub fn limited_steps(before: &[u8], after: &[u8], most: u8, out: &mut [u8]) {
    let most = i16::from(most.min(127));
    for (out, (&before, &after)) in out.iter_mut().zip(before.iter().zip(after)) {
        *out = ((i16::from(after) - i16::from(before)).max(-most).min(most) + most) as u8;
    }
}

/// Sum of the absolute differences of two rows.
#[must_use]
pub fn row_difference(a: &[u8; STRIP], b: &[u8; STRIP]) -> u16 {
    a.iter().zip(b).map(|(a, b)| u16::from(a.abs_diff(*b))).sum()
}

/// Continues a path of semi-global matching to the next point, in place: `path[d]` becomes
/// `costs[d] - P2 + min(path[d], path[d - 1] + P1, path[d + 1] + P1, lowest + P2) - lowest`, where
/// `lowest` is the lowest of `path`; over the length of the shorter one. Costs contain P2. Returns
/// the lowest new cost. P1 is [`STEP_PENALTY`], P2 [`JUMP_PENALTY`] (Hirschmueller 2008).
///
/// Computed as `costs[d] - reach + min(path[d], path[d - 1] + P1, path[d + 1] + P1, reach)` with
/// `reach = lowest + P2`: one by one, since who takes these has no vectors; sixteen at once take
/// twice as many instructions there.
pub fn path_step(costs: &[u8], lowest: u8, path: &mut [u8]) -> u8 {
    let reach = u32::from(lowest.saturating_add(JUMP_PENALTY));
    let length = path.len().min(costs.len());
    let path = Cell::from_mut(path.get_mut(..length).unwrap_or_default()).as_slice_of_cells();
    let Some((last, others)) = path.split_last() else { return u8::MAX };
    // The entry before the current one, before its update; beyond the ends there is none below
    // `reach`.
    let (mut before, mut low) = (u32::from(u8::MAX), u32::from(u8::MAX));
    let mut step = |path: &Cell<u8>, cost: u8, after: u32| {
        let here = u32::from(path.get());
        let least = (before.min(after) + u32::from(STEP_PENALTY)).min(here).min(reach);
        let new = u32::from(cost).wrapping_add(least).wrapping_sub(reach) & 0xff;
        path.set(new as u8);
        (before, low) = (here, low.min(new));
    };
    let (last_cost, costs) = costs.get(..length).and_then(<[u8]>::split_last).unwrap_or((&0, &[])); // as many as of the path
    for ((path, after), &cost) in others.iter().zip(path.iter().skip(1)).zip(costs) {
        step(path, cost, after.get().into());
    }
    step(last, *last_cost, u8::MAX.into());
    low as u8
}

/// Adds two curves to a third, saturating, over the length of the shortest; returns the lowest sum.
pub fn sum_paths(a: &[u8], b: &[u8], sums: &mut [u8]) -> u8 {
    let mut lowest = u8::MAX;
    for (sum, (&a, &b)) in sums.iter_mut().zip(a.iter().zip(b)) {
        *sum = sum.saturating_add(a).saturating_add(b);
        lowest = lowest.min(*sum);
    }
    lowest
}

/// The lowest byte; [`u8::MAX`] without bytes.
#[must_use]
pub fn lowest_byte(costs: &[u8]) -> u8 {
    costs.iter().fold(u8::MAX, |lowest, &cost| lowest.min(cost))
}

/// Index of the first byte that is not above `bound`.
#[must_use]
pub fn place_of_byte(costs: &[u8], bound: u8) -> Option<usize> {
    costs.iter().position(|&cost| cost <= bound)
}
