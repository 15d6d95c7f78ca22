//! A list of a bounded number of elements in memory of the caller.

use core::mem::MaybeUninit;
use core::ops::{Deref, DerefMut};

/// A list of at most as many elements as it has slots. It drops none of them.
#[derive(Debug)]
pub struct List<'a, T> {
    /// The first `len` are values.
    slots: &'a mut [MaybeUninit<T>],
    /// At most their number.
    len: usize,
}

impl<'a, T> List<'a, T> {
    /// An empty list.
    pub fn new(slots: &'a mut [MaybeUninit<T>]) -> Self {
        Self { slots, len: 0 }
    }

    /// The elements, for as long as the slots live.
    pub(crate) fn into_slice(self) -> &'a [T] {
        // SAFETY: `len` is at most the number of slots, and so many are values.
        unsafe { core::slice::from_raw_parts(self.slots.as_ptr().cast(), self.len) }
    }

    /// An empty list in the same slots, for a time.
    pub(crate) fn lent(&mut self) -> List<'_, T> {
        List::new(self.slots)
    }

    /// Largest number of elements.
    #[must_use]
    pub const fn capacity(&self) -> usize {
        self.slots.len()
    }

    /// True when no further element fits.
    #[must_use]
    pub const fn is_full(&self) -> bool {
        self.len == self.slots.len()
    }

    /// Appends an element.
    ///
    /// # Errors
    /// The element, where it does not fit.
    pub fn push(&mut self, element: T) -> Result<(), T> {
        let Some(slot) = self.slots.get_mut(self.len) else { return Err(element) };
        slot.write(element);
        self.len += 1;
        Ok(())
    }

    /// Removes all elements.
    pub const fn clear(&mut self) {
        self.len = 0;
    }

    /// Leaves the first `len` elements.
    pub fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }
}

impl<T> List<'_, T> {
    /// Empties the list, and lets `fill` fill two lists, in its first `at` slots and in the others.
    /// Their elements are the list's then, in this order.
    pub(crate) fn fill_in_two(
        &mut self,
        at: usize,
        fill: impl FnOnce(&mut List<'_, T>, &mut List<'_, T>),
    ) {
        self.len = 0;
        let Some((first, second)) = self.slots.split_at_mut_checked(at) else { return };
        let starts = [first.as_ptr(), second.as_ptr()];
        let (mut first, mut second) = (List::new(first), List::new(second));
        fill(&mut first, &mut second);
        // What it has put in their place holds no element of these slots.
        let [count, more] = [(&first, starts[0]), (&second, starts[1])]
            .map(|(list, start)| if list.slots.as_ptr() == start { list.len } else { 0 });
        for index in 0..more {
            // Where the first slots are full, the others are in their places.
            if let Some((before, from)) = self.slots.split_at_mut_checked(at + index)
                && let (Some(to), Some(from)) = (before.get_mut(count + index), from.first_mut())
            {
                core::mem::swap(to, from);
            }
        }
        self.len = count + more;
    }
}

impl<T: Copy> List<'_, T> {
    /// Leaves the elements that `keep` is true of, in their order.
    pub fn retain(&mut self, mut keep: impl FnMut(&T) -> bool) {
        let mut kept = 0;
        for index in 0..self.len {
            let Some(&element) = self.get(index) else { break };
            if keep(&element)
                && let Some(slot) = self.slots.get_mut(kept)
            {
                slot.write(element);
                kept += 1;
            }
        }
        self.len = kept;
    }
}

impl<T> Deref for List<'_, T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        // SAFETY: `len` is at most the number of slots, and so many are values.
        unsafe { core::slice::from_raw_parts(self.slots.as_ptr().cast(), self.len) }
    }
}

impl<T> DerefMut for List<'_, T> {
    fn deref_mut(&mut self) -> &mut [T] {
        // SAFETY: as above.
        unsafe { core::slice::from_raw_parts_mut(self.slots.as_mut_ptr().cast(), self.len) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_appended_while_they_fit_and_kept_in_their_order() {
        let mut slots = [MaybeUninit::uninit(); 3];
        let mut list = List::new(&mut slots);
        assert_eq!((list.is_full(), list.first()), (false, None));
        assert_eq!([7, 8, 9, 10].map(|value| list.push(value)), [Ok(()), Ok(()), Ok(()), Err(10)]);
        assert!(list.is_full());
        list.retain(|&value| value != 8);
        assert_eq!((&list[..], list.capacity()), (&[7, 9][..], 3));
        list.truncate(5);
        list.truncate(1);
        assert_eq!(*list, [7]);
        list.clear();
        assert!(list.is_empty());
    }

    #[test]
    fn two_lists_in_the_slots_of_one_become_one() {
        let mut slots = [MaybeUninit::uninit(); 5];
        let mut list = List::new(&mut slots);
        list.fill_in_two(3, |first, second| {
            assert_eq!([first.capacity(), second.capacity()], [3, 2]);
            let pushed = [8, 9, 10].map(|value| second.push(value).is_ok());
            assert_eq!(pushed, [true, true, false]);
            let _ = first.push(7);
        });
        assert_eq!(*list, [7, 8, 9]);
        list.fill_in_two(1, |first, second| {
            let _ = (first.push(1), second.push(2));
            *second = List::new(&mut []);
        });
        assert_eq!(*list, [1]);
    }
}
