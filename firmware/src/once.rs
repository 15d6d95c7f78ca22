//! A value in a static that is handed out once.

use core::cell::UnsafeCell;
use core::fmt;
use core::sync::atomic::{AtomicBool, Ordering};

/// A value that [`Once::take`] hands out once, for as long as the program runs.
pub struct Once<T> {
    value: UnsafeCell<T>,
    is_taken: AtomicBool,
}

// SAFETY: only `take` reaches the value, and hands it out once.
unsafe impl<T: Send> Sync for Once<T> {}

impl<T> Once<T> {
    /// Nobody has it yet.
    pub const fn new(value: T) -> Self {
        Self { value: UnsafeCell::new(value), is_taken: AtomicBool::new(false) }
    }

    /// The value; `None` when it was taken before.
    #[expect(clippy::mut_from_ref, reason = "handed out once")]
    pub fn take(&'static self) -> Option<&'static mut T> {
        if self.is_taken.swap(true, Ordering::Relaxed) {
            return None;
        }
        // SAFETY: `is_taken` was false until now, so this is the only reference there will ever be.
        Some(unsafe { &mut *self.value.get() })
    }
}

impl<T> fmt::Debug for Once<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Once").field("is_taken", &self.is_taken).finish_non_exhaustive()
    }
}
