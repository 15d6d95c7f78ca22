//! Portable kernels of block matching: the definition.
//!
//! Costs of four disparities that follow each other lie in a [`Group`], in the order 0, 2, 1, 3:
//! what the halves of two words hold after the bytes of one word were extended.
//!
//! # Bounds
//! Values are 0 ..= 62: a window of 16 x 16 costs at most 15 872. With other values all sums wrap,
//! and `dsp` wraps alike.

/// Costs of four disparities: of the first, the third, the second and the fourth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C, align(8))]
pub(crate) struct Group(pub(crate) [u16; 4]);

impl Group {
    /// Costs in the order of disparities.
    #[must_use]
    pub(crate) fn in_order(self) -> [u16; 4] {
        let Self([a, c, b, d]) = self;
        [a, b, c, d]
    }

    /// Of costs in the order of disparities.
    pub(crate) fn of([a, b, c, d]: [u16; 4]) -> Self {
        Self([a, c, b, d])
    }

    /// The cost of disparity `d % 4`.
    #[inline]
    pub(crate) fn at(&self, d: usize) -> u16 {
        let Self(costs) = self;
        costs.get((d & 1) << 1 | d >> 1 & 1).copied().unwrap_or(0)
    }

    fn each(self, other: Self, combine: impl Fn(u16, u16) -> u16) -> Self {
        let (Self([a, b, c, d]), Self([e, f, g, h])) = (self, other);
        Self([combine(a, e), combine(b, f), combine(c, g), combine(d, h)])
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        self.each(other, u16::wrapping_add)
    }

    fn minus(self, other: Self) -> Self {
        self.each(other, u16::wrapping_sub)
    }

    fn lower(self, other: Self) -> Self {
        self.each(other, u16::min)
    }
}

/// Largest difference of neighbours that counts; OpenCV's `preFilterCap`.
pub(crate) const CAP: u8 = 31;
/// The lowest of nothing.
const NOTHING: Group = Group([u16::MAX; 4]);

/// Sobel along the row, clipped to +-[`CAP`] and shifted by it: 0 ..= 62. The first and last pixel
/// are [`CAP`], and so is what `out` is longer than the shortest row.
pub(crate) fn sobel_row(above: &[u8], row: &[u8], below: &[u8], out: &mut [u8]) {
    out.fill(CAP);
    let triples = above.windows(3).zip(row.windows(3)).zip(below.windows(3));
    for (((above, row), below), value) in triples.zip(out.iter_mut().skip(1)) {
        let step = |row: &[u8]| if let [a, _, b] = *row { i16::from(b) - i16::from(a) } else { 0 };
        let cap = i16::from(CAP);
        *value = ((step(above) + 2 * step(row) + step(below)).clamp(-cap, cap) + cap) as u8;
    }
}

/// First and last group with a cost of at most `bound`.
pub(crate) fn groups_within(costs: &[Group], bound: u16) -> Option<[usize; 2]> {
    let is_within = |group: &Group| group.0.iter().any(|&cost| cost <= bound);
    Some([costs.iter().position(is_within)?, costs.iter().rposition(is_within)?])
}

/// Which costs of a group are at most `bound`: bit d for disparity d.
pub(crate) fn places_within(group: Group, bound: u16) -> u32 {
    group.in_order().iter().rev().fold(0, |places, &cost| places << 1 | u32::from(cost <= bound))
}

/// Columns of four rows, the first row in the lowest byte; as many as all have.
pub(crate) fn columns_of_four(rows: [&[u8]; 4], out: &mut [u32]) {
    let [a, b, c, d] = rows;
    for ((((out, &a), &b), &c), &d) in out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        *out = u32::from_le_bytes([a, b, c, d]);
    }
}

/// Costs of a block of four columns: at the last disparity of `out` it meets the first four of
/// `right`, at each one before that four begin one further on. `out` stays where `right` ends.
pub(crate) fn block_costs(left: &[u32; 4], right: &[u32], out: &mut [Group]) {
    let mut places = right.windows(4).take(4 * out.len()).rev();
    if places.len() < 4 * out.len() {
        return;
    }
    let difference = |(a, b): (&u32, &u32)| {
        a.to_le_bytes()
            .iter()
            .zip(b.to_le_bytes())
            .map(|(&a, b)| u16::from(a.abs_diff(b)))
            .sum::<u16>()
    };
    for group in out {
        *group =
            Group::of([0; 4].map(|_| {
                places.next().map_or(0, |four| left.iter().zip(four).map(difference).sum())
            }));
    }
}

/// Costs of blocks that the next window of a row has and the one before had not, and the other way
/// round; and of the row of blocks that leaves.
#[derive(Debug)]
pub(crate) struct Blocks<'a> {
    /// Costs of the block that enters.
    pub(crate) enters: &'a [Group],
    /// Costs of the block that leaves.
    pub(crate) leaves: &'a [Group],
    /// Sums over the blocks of one row that a window has.
    pub(crate) row: &'a mut [Group],
    /// The same of the row of blocks that leaves; afterwards of the one that enters.
    pub(crate) kept: &'a mut [Group],
}

/// Moves the sums of one row of blocks on by a block, and the costs of the window there down by a
/// row of blocks. Gives the lowest of every fourth cost. As many groups as all have.
pub(crate) fn add_block(blocks: &mut Blocks<'_>, costs: &mut [Group]) -> Group {
    let mut lowest = NOTHING;
    let (row, kept) = (blocks.row.iter_mut(), blocks.kept.iter_mut());
    for ((((cost, row), kept), &enters), &leaves) in
        costs.iter_mut().zip(row).zip(kept).zip(blocks.enters).zip(blocks.leaves)
    {
        *row = row.plus(enters.minus(leaves));
        *cost = cost.plus(row.minus(*kept));
        *kept = *row;
        lowest = lowest.lower(*cost);
    }
    lowest
}
