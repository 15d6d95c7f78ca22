//! Faults of a pair as a set of flags.

use core::fmt;

bitflags::bitflags! {
    /// Set of flags; empty without a fault. Bits from 24 on stay unused.
    ///
    /// ```
    /// use linestereo::health::HealthFlags;
    /// let flags = HealthFlags::LEFT_FROZEN | HealthFlags::ROWS_OFF;
    /// assert!(flags.contains(HealthFlags::ROWS_OFF) && !flags.contains(HealthFlags::SKEW));
    /// assert!(flags.names().eq(["left_frozen", "rows_off"]));
    /// ```
    #[derive(Clone, Copy, PartialEq, Eq, Default, Hash)]
    pub struct HealthFlags: u32 {
        /// The left image's mean level is outside
        /// [`HealthLimits::level`](super::HealthLimits::level).
        const LEFT_EXPOSURE = 1;
        /// The right image's mean level is outside
        /// [`HealthLimits::level`](super::HealthLimits::level).
        const RIGHT_EXPOSURE = 1 << 1;
        /// More than [`HealthLimits::saturated_permille`](super::HealthLimits::saturated_permille)
        /// of the left image are black or white.
        const LEFT_SATURATED = 1 << 2;
        /// More than [`HealthLimits::saturated_permille`](super::HealthLimits::saturated_permille)
        /// of the right image are black or white.
        const RIGHT_SATURATED = 1 << 3;
        /// All of the left image is one grey level, without a sensor's noise.
        const LEFT_DEAD = 1 << 4;
        /// All of the right image is one grey level, without a sensor's noise.
        const RIGHT_DEAD = 1 << 5;
        /// The left image is black, or has almost no detail compared with the right one.
        const LEFT_COVERED = 1 << 6;
        /// The right image is black, or has almost no detail compared with the left one.
        const RIGHT_COVERED = 1 << 7;
        /// The left image repeats the one before: its sampled rows, evenly spread, at most 32 and
        /// at least half as many (all of an image of 32 rows or fewer), are the same bit for bit.
        const LEFT_FROZEN = 1 << 8;
        /// The right image repeats the one before, as for the left one.
        const RIGHT_FROZEN = 1 << 9;
        /// Too few pixels of the left image are valid.
        const LEFT_VIEW = 1 << 10;
        /// Too few pixels of the right image are valid.
        const RIGHT_VIEW = 1 << 11;
        /// One image is much brighter than the other.
        const EXPOSURES_DIFFER = 1 << 12;
        /// The images were captured too far apart in time: the pair is refused.
        const SKEW = 1 << 13;
        /// Rows do not match: the rig has moved since its calibration. The matcher corrects it, up
        /// to [`HealthFlags::ROWS_FAR`].
        const ROWS_OFF = 1 << 14;
        /// The difference of rows has changed against its long mean: the rig moves.
        const ROWS_DRIFT = 1 << 15;
        /// The difference of rows varies over the image: a camera is turned about its axis, or the
        /// calibration is wrong.
        const ROWS_UNEVEN = 1 << 16;
        /// Few of the left segments are matched.
        const FEW_MATCHES = 1 << 17;
        /// Several credible matches lie beyond infinity.
        const BEYOND_INFINITY = 1 << 18;
        /// Something is nearer than the disparity range allows: it is matched wrongly.
        const RANGE_SMALL = 1 << 19;
        /// Most of what is matched has no parallax: one camera is delivered twice, or a pattern
        /// covers both images, or all of the scene is far.
        const NO_PARALLAX = 1 << 20;
        /// Both images show something at the same pixels: noise of columns, a fixed pattern, dirt
        /// on a common window, overlaid text.
        const SAME_PIXEL = 1 << 21;
        /// The lower part of one image is moved sideways.
        const TORN = 1 << 22;
        /// Rows are further apart than the matcher corrects.
        const ROWS_FAR = 1 << 23;
        /// Flags with which matches may be wrong or outdated. The others (exposure, rows that are
        /// corrected, their drift, a smaller view) reduce the number of matches, or warn.
        const UNFIT = Self::LEFT_DEAD.bits()
            | Self::RIGHT_DEAD.bits()
            | Self::LEFT_COVERED.bits()
            | Self::RIGHT_COVERED.bits()
            | Self::LEFT_FROZEN.bits()
            | Self::RIGHT_FROZEN.bits()
            | Self::SKEW.bits()
            | Self::ROWS_UNEVEN.bits()
            | Self::FEW_MATCHES.bits()
            | Self::BEYOND_INFINITY.bits()
            | Self::RANGE_SMALL.bits()
            | Self::NO_PARALLAX.bits()
            | Self::SAME_PIXEL.bits()
            | Self::TORN.bits()
            | Self::ROWS_FAR.bits();
    }
}

impl HealthFlags {
    /// No fault.
    pub const GOOD: Self = Self::empty();

    /// Every flag with its name.
    pub const NAMES: [(Self, &'static str); 24] = [
        (Self::LEFT_EXPOSURE, "left_exposure"),
        (Self::RIGHT_EXPOSURE, "right_exposure"),
        (Self::LEFT_SATURATED, "left_saturated"),
        (Self::RIGHT_SATURATED, "right_saturated"),
        (Self::LEFT_DEAD, "left_dead"),
        (Self::RIGHT_DEAD, "right_dead"),
        (Self::LEFT_COVERED, "left_covered"),
        (Self::RIGHT_COVERED, "right_covered"),
        (Self::LEFT_FROZEN, "left_frozen"),
        (Self::RIGHT_FROZEN, "right_frozen"),
        (Self::LEFT_VIEW, "left_view"),
        (Self::RIGHT_VIEW, "right_view"),
        (Self::EXPOSURES_DIFFER, "exposures_differ"),
        (Self::SKEW, "skew"),
        (Self::ROWS_OFF, "rows_off"),
        (Self::ROWS_DRIFT, "rows_drift"),
        (Self::ROWS_UNEVEN, "rows_uneven"),
        (Self::FEW_MATCHES, "few_matches"),
        (Self::BEYOND_INFINITY, "beyond_infinity"),
        (Self::RANGE_SMALL, "range_small"),
        (Self::NO_PARALLAX, "no_parallax"),
        (Self::SAME_PIXEL, "same_pixel"),
        (Self::TORN, "torn"),
        (Self::ROWS_FAR, "rows_far"),
    ];

    /// The names of the flags that are set, in the order of [`HealthFlags::NAMES`].
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::NAMES.into_iter().filter(move |&(flag, _)| self.contains(flag)).map(|(_, name)| name)
    }

    /// True when matches may be used: no flag of [`HealthFlags::UNFIT`] is set.
    #[must_use]
    pub const fn is_fit(self) -> bool {
        !self.intersects(Self::UNFIT)
    }

    /// This set if `is_set`, else none.
    pub(crate) const fn when(self, is_set: bool) -> Self {
        if is_set { self } else { Self::GOOD }
    }
}

/// The names with `+` between them, `good` when empty.
impl fmt::Display for HealthFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::GOOD {
            return f.write_str("good");
        }
        let mut separator = "";
        for name in self.names() {
            write!(f, "{separator}{name}")?;
            separator = "+";
        }
        Ok(())
    }
}

/// As [`Display`](fmt::Display).
#[cfg(feature = "defmt")]
impl defmt::Format for HealthFlags {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{}", defmt::Display2Format(self));
    }
}

impl fmt::Debug for HealthFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "HealthFlags({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_leave_a_pair_fit() {
        use HealthFlags as Flags;
        let warnings = Flags::LEFT_EXPOSURE
            | Flags::EXPOSURES_DIFFER
            | Flags::ROWS_OFF
            | Flags::ROWS_DRIFT
            | Flags::RIGHT_VIEW;
        assert!(Flags::GOOD.is_fit() && warnings.is_fit());
        assert!(
            ![warnings | Flags::ROWS_FAR, Flags::SKEW, Flags::RIGHT_FROZEN]
                .iter()
                .any(|flags| flags.is_fit())
        );
        assert!(
            warnings.contains(Flags::ROWS_OFF | Flags::ROWS_DRIFT)
                && !warnings.contains(Flags::ROWS_OFF | Flags::ROWS_FAR)
        );
        assert!(
            warnings
                .names()
                .eq(["left_exposure", "right_view", "exposures_differ", "rows_off", "rows_drift"])
        );
    }
}
