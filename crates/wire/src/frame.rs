//! One frame's result: a head, and its segments in pieces.
//!
//! In: the core's counts, matches and points. Out: records with these in pieces of a packet each.

use crate::board_state::TimeSource;
use crate::health::{Health, PairReport};
use heapless::Vec;
use linestereo::results::{Match, Point, Rejection};
use linestereo::{Dims, health::PairHealth};
use serde::{Deserialize, Serialize};

/// Most segments in one packet: what keeps `MAX_PACKET` below 600 bytes whatever the values are.
pub const SEGMENTS_PER_PACKET: usize = 10;

/// Most points in one packet, for the same reason.
pub const POINTS_PER_PACKET: usize = 32;

/// Result of a frame, without its segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FrameHead {
    /// Number of the captured pair: one more than the last one's, wrapping. A gap is a pair whose
    /// result did not arrive.
    pub sequence: u32,
    /// When the pair was captured, microseconds of the clock that `clock` names.
    pub capture_time_us: u64,
    /// Width of the images in px.
    pub width: u16,
    /// Height of the images in px.
    pub height: u16,
    /// Faults of the frame.
    pub health: Health,
    /// The numbers behind it; `None` when there was no pair to look at.
    pub pair: Option<PairReport>,
    /// Times of the frame.
    pub times: FrameTimes,
    /// Numbers of segments found, matched and rejected.
    pub counts: Counts,
    /// Segments that follow.
    pub segments: u16,
    /// The clock of `capture_time_us`.
    pub clock: TimeSource,
}

impl FrameHead {
    /// The head of a result of the core; what its counts say about full lists is added to `health`,
    /// and `send_frame` fills in the number of segments.
    #[must_use]
    pub fn new(
        sequence: u32,
        capture_time_us: u64,
        dims: Dims,
        health: Health,
        counts: &linestereo::results::Counts,
    ) -> Self {
        let Dims { width, height } = dims;
        let health = health | Health::of(counts);
        let (times, counts, clock) = (FrameTimes::default(), counts.into(), TimeSource::Board);
        Self {
            sequence,
            capture_time_us,
            width,
            height,
            health,
            pair: None,
            times,
            counts,
            segments: 0,
            clock,
        }
    }

    /// The same with the health of the pair.
    #[must_use]
    pub fn with_pair(self, pair: &PairHealth) -> Self {
        Self { health: self.health | pair.flags.into(), pair: Some(pair.into()), ..self }
    }
}

/// Times of a frame, us by the board's clock; 0 from programs that are fed by a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FrameTimes {
    /// Waiting for the pair, its rows being rectified meanwhile.
    pub waiting_us: u32,
    /// Matching it, and the depths of the wanted objects.
    pub matching_us: u32,
    /// Writing to the host since the frame before: waiting for room where the port is slow.
    pub port_us: u32,
}

/// The core's [`Counts`](linestereo::results::Counts), and the number of points.
///
/// Not the core's own type, since the points stand before the rejections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// Segments detected in the left image.
    pub segments_left: u16,
    /// Segments detected in the right image.
    pub segments_right: u16,
    /// Left segments beyond the detector's capacity.
    pub segments_left_dropped: u16,
    /// Right segments beyond the detector's capacity.
    pub segments_right_dropped: u16,
    /// Edges left out.
    pub edges_cut: u16,
    /// Segments that were not compared with all others.
    pub comparisons_cut: u16,
    /// See [`linestereo::results::Counts`].
    pub searched_fully: u16,
    /// Segments in the list of matches.
    pub matched: u16,
    /// Points of the pair; 0 where nobody counted them.
    pub points: u32,
    /// Left segments lost, in the order of [`Rejection::ALL`].
    pub rejected: [u16; Rejection::ALL.len()],
}

impl Counts {
    /// Left segments lost for this reason.
    #[must_use]
    pub fn rejected(&self, reason: Rejection) -> u16 {
        Rejection::ALL
            .iter()
            .zip(self.rejected)
            .find(|&(&of, _)| of == reason)
            .map_or(0, |(_, count)| count)
    }
}

impl From<&linestereo::results::Counts> for Counts {
    fn from(counts: &linestereo::results::Counts) -> Self {
        Self {
            segments_left: counts.segments_left,
            segments_right: counts.segments_right,
            segments_left_dropped: counts.segments_left_dropped,
            segments_right_dropped: counts.segments_right_dropped,
            edges_cut: counts.edges_cut,
            comparisons_cut: counts.comparisons_cut,
            searched_fully: counts.searched_fully,
            matched: counts.matched,
            points: 0,
            rejected: Rejection::ALL.map(|reason| counts.rejected(reason)),
        }
    }
}

/// Some of a frame's segments.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Segments {
    /// The frame they belong to.
    pub sequence: u32,
    /// Position of the first of them in the frame's list.
    pub first: u16,
    /// The segments.
    pub list: Vec<Match, SEGMENTS_PER_PACKET>,
}

/// Some of a frame's points.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Points {
    /// The frame they belong to.
    pub sequence: u32,
    /// Position of the first of them in the frame's list.
    pub first: u32,
    /// The points.
    pub list: Vec<Point, POINTS_PER_PACKET>,
}
