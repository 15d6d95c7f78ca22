//! Numbers without a pattern, the same in every run (xorshift, Marsaglia 2003).

/// A generator with its state, which is not 0.
#[derive(Clone, Debug)]
pub(crate) struct Random(pub(crate) u32);

impl Random {
    pub(crate) fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.next() >> 8) as usize % end
    }

    /// Any entry of a curve, often an extreme one.
    pub(crate) fn entry(&mut self) -> u16 {
        match self.below(8) {
            0 => u16::MAX,
            1 => 0,
            2 => 0x8000,
            _ => self.next() as u16,
        }
    }
}
