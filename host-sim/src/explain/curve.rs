//! Costs over disparity, with best and second-best as the core takes them.

/// Disparities on both sides of the best that the second-best leaves out, px.
const NEIGHBOURHOOD: i32 = 2;

/// Costs of the disparities from `first` on, one per px.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Curve {
    pub first: i32,
    pub costs: Vec<u16>,
}

/// A cost and its whole disparity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Low {
    pub(super) at: i32,
    pub(super) cost: u16,
}

impl Curve {
    pub(super) fn new((first, costs): (i32, &[u16])) -> Self {
        Self { first, costs: costs.to_vec() }
    }

    /// Of two curves over the same disparities.
    pub(super) fn combined(&self, other: &Self, combine: impl Fn(u16, u16) -> u16) -> Self {
        let costs = self.costs.iter().zip(&other.costs).map(|(&a, &b)| combine(a, b)).collect();
        Self { first: self.first, costs }
    }

    pub(super) fn sum(&self, other: &Self) -> Self {
        self.combined(other, u16::saturating_add)
    }

    pub(super) fn lower(&self, other: &Self) -> Self {
        self.combined(other, u16::min)
    }

    /// The last disparity, px.
    pub(super) fn last(&self) -> i32 {
        self.first + self.costs.len() as i32 - 1
    }

    fn entries(&self) -> impl Iterator<Item = Low> {
        (self.first..).zip(&self.costs).map(|(at, &cost)| Low { at, cost })
    }

    /// The first lowest entry of those that `is_in` takes.
    fn lowest(&self, is_in: impl Fn(i32) -> bool) -> Option<Low> {
        self.entries().filter(|low| is_in(low.at)).min_by_key(|low| low.cost)
    }

    /// The best, and the second-best outside of its neighbourhood.
    pub(super) fn best_and_second(&self) -> Option<(Low, Low)> {
        let best = self.lowest(|_| true)?;
        Some((best, self.second(best.at)?))
    }

    /// The lowest within `at +- reach`.
    pub(super) fn near(&self, at: i32, reach: i32) -> Option<Low> {
        self.lowest(|d| (d - at).abs() <= reach)
    }

    /// The lowest outside of the neighbourhood of `at`.
    pub(super) fn second(&self, at: i32) -> Option<Low> {
        self.lowest(|d| (d - at).abs() > NEIGHBOURHOOD)
    }

    /// Equiangular fit around a whole disparity, px.
    pub(super) fn subpixel(&self, at: i32) -> f64 {
        let cost = |d: i32| {
            usize::try_from(d - self.first)
                .ok()
                .and_then(|i| self.costs.get(i))
                .map(|&c| f64::from(c))
        };
        let shift = match (cost(at - 1), cost(at), cost(at + 1)) {
            (Some(before), Some(here), Some(after)) if before.max(after) > here => {
                0.5 * (before - after) / (before.max(after) - here)
            }
            _ => 0.0,
        };
        f64::from(at) + shift.clamp(-0.5, 0.5)
    }
}

/// Uniqueness ratio, best / second-best: below 1 the best is better. Rounded as the core does, down
/// to 1/256.
pub(super) fn ratio(best: Low, second: Low) -> f64 {
    let ratio_q8 = ((u32::from(best.cost) + 1) << 8) / (u32::from(second.cost) + 1);
    f64::from(ratio_q8) / 256.0
}

#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub name: &'static str,
    pub at: f64,
}

/// Curves of one technique, to be drawn together.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    pub title: String,
    /// Curves by name, the decisive one first.
    pub curves: Vec<(&'static str, Curve)>,
    /// Best, second-best, and what came of it.
    pub marks: Vec<Mark>,
}

impl Plot {
    /// Marks best and second-best of the first curve.
    pub(super) fn new(title: &str, curves: Vec<(&'static str, Curve)>) -> Self {
        let found = curves.first().and_then(|(_, curve)| Some((curve, curve.best_and_second()?)));
        let marks = found.map_or(Vec::new(), |(curve, (best, second))| {
            vec![
                Mark { name: "best", at: curve.subpixel(best.at) },
                Mark { name: "second", at: second.at.into() },
            ]
        });
        Self { title: title.to_owned(), curves, marks }
    }
}

/// Best and second-best in words.
pub(super) fn words(curve: &Curve, best: Low, second: Low) -> String {
    format!(
        "best {:.2} px (cost {}), second-best {} px (cost {}): ratio {:.2}",
        curve.subpixel(best.at),
        best.cost,
        second.at,
        second.cost,
        ratio(best, second)
    )
}
