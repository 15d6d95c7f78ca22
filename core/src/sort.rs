//! Heap sort: in place, no recursion, no panic path (the standard library's sorts carry one for inconsistent orders).

/// Sorts by `key`, smallest first; equal keys may change places, so keys should be distinct where order matters.
///
/// # Cost
/// At most `2 n log2 n` comparisons for any input.
pub(crate) fn sort_by_key<T: Copy, K: Ord>(items: &mut [T], key: impl Fn(&T) -> K) {
    let len = items.len();
    make_heap(items, &key);
    for end in (1..len).rev() {
        swap(items, 0, end);
        if let Some(heap) = items.get_mut(..end) {
            sift_down(heap, 0, &key);
        }
    }
}

/// Orders items so that none is smaller than its children: the largest is the first.
pub(crate) fn make_heap<T: Copy, K: Ord>(items: &mut [T], key: &impl Fn(&T) -> K) {
    for root in (0..items.len() / 2).rev() {
        sift_down(items, root, key);
    }
}

/// Moves the item at `root` down until no child is larger.
pub(crate) fn sift_down<T: Copy, K: Ord>(heap: &mut [T], mut root: usize, key: &impl Fn(&T) -> K) {
    loop {
        let child = 2 * root + 1;
        let Some(left) = heap.get(child) else { return };
        let largest = match heap.get(child + 1) {
            Some(right) if key(right) > key(left) => child + 1,
            _ => child,
        };
        if heap.get(root).map(key) >= heap.get(largest).map(key) {
            return;
        }
        swap(heap, root, largest);
        root = largest;
    }
}

fn swap<T: Copy>(items: &mut [T], a: usize, b: usize) {
    let (Some(&at_a), Some(&at_b)) = (items.get(a), items.get(b)) else { return };
    if let Some(slot) = items.get_mut(a) {
        *slot = at_b;
    }
    if let Some(slot) = items.get_mut(b) {
        *slot = at_a;
    }
}
