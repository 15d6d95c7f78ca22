//! Limits at which flags are raised.

use crate::rig::Rig;

/// Limits of every quantity of a [`PairHealth`](super::PairHealth). The defaults are measured on 14
/// captured pairs, 6 of a robot's camera and three sequences of a robot (see
/// `tests/tests/health.rs`), without false flags.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HealthLimits {
    /// Largest time between the captures of a pair, us; beyond it the pair is refused. Turning at
    /// 90 degrees a second, 1 ms is half a pixel of disparity in QVGA. Default 1000.
    pub skew_us: u32,
    /// Least and largest mean level of an image. Default 20 and 235.
    pub level: (u8, u8),
    /// Most saturated pixels (0 ..= 2 and 253 ..= 255) of an image, per thousand. Default 250.
    pub saturated_permille: u16,
    /// Largest difference of levels in an image of a dead camera. Default 2: noise of any sensor is
    /// more.
    pub dead_range: u8,
    /// A camera is covered when its detail, relative to its level, is below the other's divided by
    /// this. Default 3.
    pub covered_ratio: u8,
    /// A camera is covered when its mean level is below this, and the other's is four times as
    /// high. Default 12.
    pub covered_level: u8,
    /// Number of pairs for which an image may stay the same, bit for bit. Default 0: a sensor's
    /// noise never repeats.
    pub frozen_pairs: u8,
    /// Least share of valid pixels of a rectified image, per thousand. Default 500.
    pub view_permille: u16,
    /// Largest ratio of the mean levels, 1/256. Default 448 (1.75).
    pub exposure_ratio_q8: u16,
    /// Largest difference of rows, 1/256 px, smoothed. Default 51 (0.2 px): below it no score of
    /// captured pairs changes but the number of segments (5 % fewer at 0.25 px); at half a pixel 15
    /// % are lost; beyond 2 px the matcher finds nothing.
    pub row_offset_q8: u16,
    /// Largest difference of rows with which matches are used, 1/256 px, smoothed. Default 384 (1.5
    /// px): the matcher looks for it within 2 px.
    pub row_limit_q8: u16,
    /// Largest change of the smoothed difference of rows against its long mean, 1/256 px. Default
    /// 38 (0.15 px).
    pub row_drift_q8: u16,
    /// Largest spread of the difference of rows over one image, 1/256 px; in proportion in images
    /// wider than 320 px; more is uneven, and its median is not used. Default 32 (0.125 px):
    /// captured pairs, at several sizes, and those of a robot's camera as it was delivered stay
    /// below 0.1 px. Where too few support points say whether rows are even.
    pub row_spread_q8: u16,
    /// Largest difference of rows between two parts of an image, at support points, 1/256 px; in
    /// proportion in images wider than 320 px; more is uneven. Default 256 (1 px).
    pub row_region_q8: u16,
    /// Least number of matches for a difference of rows to be used. Default 6.
    pub min_row_samples: u8,
    /// Number of pairs over which the difference of rows is smoothed, and of its long mean. Default
    /// 8 and 256; at most 1024.
    pub row_pairs: (u16, u16),
    /// Least share of the compared left segments that are matched, per thousand, where at least 24
    /// are compared. Default 60: of captured pairs without a fault the least is 69 (stairs, a
    /// robot's camera), most have 400 and more.
    pub matched_permille: u16,
    /// The same where too few of them can say how far rows are apart, and support points do not
    /// show that rows are right. Default 140; the least of such captured pairs is 159.
    pub unwitnessed_permille: u16,
    /// Share of the places of the support grid with a probability of at least 0.9, per thousand,
    /// from which few matched segments are no fault, if most of these points agree about the rows.
    /// Default 150: dim rooms in which segments hardly match have 250 and more; pairs with images
    /// exchanged, mirrored, turned over or five rows apart at most 110, and those turned by 1.5
    /// degrees or more, up to 300, do not agree.
    pub credible_permille: u16,
    /// Share of such points on the ground plane that shows the same without rows. Default 200: 210
    /// and more in these rooms, at most 165 in pairs that are turned.
    pub credible_ground_permille: u16,
    /// Least possible disparity, 1/64 px: minus the rig's offset, minus a tolerance. Default -64
    /// (-1 px).
    pub least_disparity_q6: i16,
    /// Least number of windows that match beyond the disparity range for it to be too small.
    /// Default 3.
    pub min_beyond_range: u16,
    /// Least share of these among the windows compared, per thousand. Default 20.
    pub beyond_range_permille: u16,
    /// Largest share of credible support points without parallax, per thousand. Default 500.
    pub still_permille: u16,
    /// Largest likeness of both images at the same pixels, per thousand. Default 80.
    pub pattern_permille: i16,
    /// Number of consecutive pairs without a fault until its flag is cleared. Default 3.
    pub clear_after: u8,
}

impl HealthLimits {
    /// The documented defaults.
    pub const DEFAULT: Self = Self {
        skew_us: 1000,
        level: (20, 235),
        saturated_permille: 250,
        dead_range: 2,
        covered_ratio: 3,
        covered_level: 12,
        frozen_pairs: 0,
        view_permille: 500,
        exposure_ratio_q8: 448,
        row_offset_q8: 51,
        row_limit_q8: 384,
        row_drift_q8: 38,
        row_spread_q8: 32,
        row_region_q8: 256,
        min_row_samples: 6,
        row_pairs: (8, 256),
        matched_permille: 60,
        unwitnessed_permille: 140,
        credible_permille: 150,
        credible_ground_permille: 200,
        least_disparity_q6: -64,
        min_beyond_range: 3,
        beyond_range_permille: 20,
        still_permille: 500,
        pattern_permille: 80,
        clear_after: 3,
    };

    /// The same for pairs of this rig: what is infinitely far has minus its offset as its
    /// disparity.
    ///
    /// ```
    /// use linestereo::Rig;
    /// use linestereo::health::HealthLimits;
    /// let squinting = Rig::new(100.0, 0.06, 5.0)?; // what is infinitely far is seen at -5 px
    /// assert_eq!(HealthLimits::DEFAULT.of_rig(Some(&squinting)).least_disparity_q6, -6 * 64);
    /// # Ok::<(), linestereo::params::RigError>(())
    /// ```
    #[must_use]
    #[inline(never)] // copies of all limits: 800 B
    pub const fn of_rig(self, rig: Option<&Rig>) -> Self {
        let least_q6 = match rig {
            Some(rig) => (Self::DEFAULT.least_disparity_q6 as i64).wrapping_sub(rig.offset_q6()),
            None => return self,
        };
        let least_disparity_q6 = match least_q6 {
            ..=-32_768 => i16::MIN,
            32_767.. => i16::MAX,
            #[expect(clippy::cast_possible_truncation, reason = "the arms before exclude it")]
            _ => least_q6 as i16,
        };
        Self { least_disparity_q6, ..self }
    }

    /// Time between the captures of a pair, us, or an error if it is beyond the limit. To be called
    /// before the pair is used.
    ///
    /// ```
    /// use linestereo::health::HealthLimits;
    /// let limits = HealthLimits { skew_us: 500, ..HealthLimits::DEFAULT };
    /// assert_eq!(limits.skew_us([1_000_000, 1_000_500]), Ok(500));
    /// let refused = limits.skew_us([1_000_501, 1_000_000]).unwrap_err();
    /// let said = refused.to_string();
    /// assert!(said.starts_with("the images were captured 501 us apart, more than 500 us:"));
    /// ```
    pub fn skew_us(&self, [left, right]: [u64; 2]) -> Result<u32, Skewed> {
        let skew_us = u32::try_from(left.abs_diff(right)).unwrap_or(u32::MAX);
        if skew_us > self.skew_us {
            Err(Skewed { skew_us, limit_us: self.skew_us })
        } else {
            Ok(skew_us)
        }
    }
}

impl Default for HealthLimits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Two images that were captured too far apart to be a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the images were captured {skew_us} us apart, more than {limit_us} us: trigger both cameras \
     together"
)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Skewed {
    /// Time between the captures, us.
    pub skew_us: u32,
    /// Largest allowed time, us.
    pub limit_us: u32,
}
