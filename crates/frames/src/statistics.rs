//! Middles and shares of lists of numbers.

use core::cmp::Ordering;
use core::ops::{Add, Mul};

/// The value below which this share of the values lies, the upper one of two; `None` of nothing.
pub fn quantile<T: Copy>(
    mut values: Vec<T>,
    share: f64,
    order: impl FnMut(&T, &T) -> Ordering,
) -> Option<T> {
    let place = ((share * values.len() as f64) as usize).min(values.len().checked_sub(1)?);
    Some(*values.select_nth_unstable_by(place, order).1)
}

/// The middle value, the upper one of two; `None` of nothing.
pub fn upper_median<T: Copy>(values: Vec<T>, order: impl FnMut(&T, &T) -> Ordering) -> Option<T> {
    quantile(values, 0.5, order)
}

/// The middle value, the mean of the two for an even count; `None` of nothing.
pub fn median<T: Copy + Add<Output = T> + Mul<Output = T> + From<f32>>(
    mut values: Vec<T>,
    order: impl FnMut(&T, &T) -> Ordering,
) -> Option<T> {
    values.sort_unstable_by(order);
    let middle = values.len() / 2;
    let upper = *values.get(middle)?;
    Some(if values.len() % 2 == 1 { upper } else { T::from(0.5) * (values[middle - 1] + upper) })
}

/// Straight between the two nearest of sorted values; `None` of nothing.
pub fn interpolated_quantile(sorted: &[f32], share: f64) -> Option<f32> {
    let place = share * sorted.len().checked_sub(1)? as f64;
    let (low, part) = (place.floor() as usize, place.fract() as f32);
    let next = sorted[(low + 1).min(sorted.len() - 1)];
    Some(sorted[low] + part * (next - sorted[low]))
}

/// As NumPy has it: straight between the two nearest of sorted values; `None` of nothing.
pub fn numpy_quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let at = sorted.len().checked_sub(1)? as f64 * share;
    let (low, fraction) = (at.floor() as usize, at.fract());
    let (below, above) = (sorted[low], sorted[(low + 1).min(sorted.len() - 1)]);
    let step = above - below;
    // The nearer neighbour is the base: so does NumPy, and the last digit depends on it.
    Some(if fraction < 0.5 { below + step * fraction } else { above - step * (1.0 - fraction) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn middles_of_even_and_odd_counts() {
        assert_eq!(median(vec![], f64::total_cmp), None);
        assert_eq!(median(vec![3.0, 1.0], f32::total_cmp), Some(2.0));
        assert_eq!(median(vec![3.0, 1.0, 9.0], f64::total_cmp), Some(3.0));
        assert_eq!(
            (upper_median(vec![3, 1], Ord::cmp), upper_median(Vec::<u8>::new(), Ord::cmp)),
            (Some(3), None)
        );
        assert_eq!(quantile((0..10).collect(), 0.9, i32::cmp), Some(9));
        assert_eq!(interpolated_quantile(&[0.0, 1.0, 4.0], 0.75), Some(2.5));
        let of = |share| numpy_quantile(&[1.0, 2.0, 4.0], share);
        assert_eq!([0.5, 0.25, 0.95].map(of), [2.0, 1.5, 3.8].map(Some));
        assert_eq!((numpy_quantile(&[], 0.5), numpy_quantile(&[7.0], 0.95)), (None, Some(7.0)));
    }
}
