//! Heap sort: in place, no recursion, no panic path (the standard library's sorts carry one for
//! inconsistent orders). The largest of a few.

/// Sorts by `key`, smallest first; equal keys may change places, so keys should be distinct where
/// order matters.
///
/// # Cost
/// At most `2 n log2 n` comparisons for any input.
pub(crate) fn sort_by_key<T: Copy, K: Ord>(items: &mut [T], key: impl Fn(&T) -> K) {
    let len = items.len();
    make_heap(items, &key);
    for end in (1..len).rev() {
        let Some((heap, last)) = items.split_at_mut_checked(end) else { break };
        if let (Some(largest), Some(last)) = (heap.first_mut(), last.first_mut()) {
            core::mem::swap(largest, last);
        }
        sift_down(heap, 0, &key);
    }
}

/// Orders items so that none is smaller than its children: the largest is the first.
pub(crate) fn make_heap<T: Copy, K: Ord>(items: &mut [T], key: &impl Fn(&T) -> K) {
    for root in (0..items.len() / 2).rev() {
        sift_down(items, root, key);
    }
}

/// Moves the item at `root` down until no child is larger. Larger children move up on its way, and
/// it is written once: one copy a level.
pub(crate) fn sift_down<T: Copy, K: Ord>(heap: &mut [T], mut root: usize, key: &impl Fn(&T) -> K) {
    let Some(&item) = heap.get(root) else { return };
    let own = key(&item);
    loop {
        let child = 2 * root + 1;
        let Some((before, children)) = heap.split_at_mut_checked(child) else { break };
        let (larger, right) = match *children {
            [left, right, ..] if key(&right) > key(&left) => (right, 1),
            [left, ..] => (left, 0),
            [] => break,
        };
        if own >= key(&larger) {
            break;
        }
        if let Some(slot) = before.get_mut(root) {
            *slot = larger;
        }
        root = child + right;
    }
    if let Some(slot) = heap.get_mut(root) {
        *slot = item;
    }
}

/// Puts a value into a list of the largest, largest first, whose least goes.
#[inline(never)] // once for lists of each length
pub(crate) fn keep_largest<T: Ord>(largest: &mut [T], mut value: T) {
    for slot in largest {
        if value > *slot {
            core::mem::swap(slot, &mut value);
        }
    }
}
