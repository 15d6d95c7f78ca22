//! Memory around the inputs and outputs of kernels that no kernel may touch; on a board the
//! processor forbids it.

/// Bytes that no kernel may touch: the first half of a page.
#[derive(Debug)]
#[repr(C)]
pub struct Fence([u8; Self::BYTES]);

impl Fence {
    /// A power of two, as memory protection units want it.
    pub const BYTES: usize = Self::PAGE / 2;
    /// Alignment of memory that begins with a fence, bytes. QEMU looks at the end of an unaligned
    /// word only when it lies in another page than the start.
    pub const PAGE: usize = 1024;
    /// With the bytes that stay.
    pub(crate) const NEW: Self = Self([0xc3; Self::BYTES]);

    #[cfg(test)]
    pub(crate) fn is_untouched(&self) -> bool {
        self.0 == Self::NEW.0
    }
}
