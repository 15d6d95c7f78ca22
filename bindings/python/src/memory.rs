//! Working memory on the heap: the only unsafe code here.

use linestereo::{Capacity, MemorySlice};
use std::mem::MaybeUninit;

/// Memory of one pair and its results.
pub(crate) fn allocate(capacity: &Capacity) -> Box<MemorySlice> {
    let words = vec![MaybeUninit::uninit(); capacity.words()].into_boxed_slice();
    let memory: *mut MemorySlice = MemorySlice::new(Box::leak(words), capacity.segments);
    // SAFETY: the address of the box above, which nobody else has: a memory is a slice of words.
    unsafe { Box::from_raw(memory) }
}
