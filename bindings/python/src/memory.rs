//! Working memory on the heap: the only unsafe code here.

use linestereo::scratch::{Capacity, Word};
use linestereo::{RunError, ScratchView};
use std::mem::{ManuallyDrop, MaybeUninit};

/// Memory of one pair and its results.
pub(crate) struct Memory {
    view: ManuallyDrop<ScratchView<'static>>,
    words: *mut [Word],
}

// SAFETY: the memory belongs to this value alone, and is reached by `&mut` only.
unsafe impl Send for Memory {}
// SAFETY: as above: nothing is reached by `&`.
unsafe impl Sync for Memory {}

impl Memory {
    pub(crate) fn new(capacity: &Capacity) -> Result<Self, RunError> {
        let words = Box::into_raw(vec![MaybeUninit::uninit(); capacity.words()].into_boxed_slice());
        // SAFETY: just allocated, and freed when this value is dropped, which the view is not used
        // after.
        let view = ScratchView::carve(unsafe { &mut *words }, capacity)?;
        Ok(Self { view: ManuallyDrop::new(view), words })
    }

    pub(crate) fn view(&mut self) -> ScratchView<'_> {
        self.view.reborrow()
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        // SAFETY: from `Box::into_raw`, freed once; the view has nothing to drop.
        drop(unsafe { Box::from_raw(self.words) });
    }
}
