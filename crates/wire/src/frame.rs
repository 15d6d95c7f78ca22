//! One frame's result: a head, and its segments in pieces.
//!
//! In: the core's counts and matches. Out: records of the same bits (a [`Match`] that went over the wire comes back equal), in the core's
//! fixed-point formats; `q5` is 1/32 px, `q6` 1/64 px, `q16` 1/65536.

use crate::board_state::TimeSource;
use crate::health::{Health, PairReport};
use heapless::Vec;
use linestereo::diagnostics::Techniques;
use linestereo::{
    Confidence, Depth, Dims, Disparity, ImagePosition, Match, Owner, PairHealth, Point, Position, Rejection, Source,
};
use serde::{Deserialize, Serialize};

/// Most segments in one packet: what keeps `MAX_PACKET` below 600 bytes whatever the values are.
pub const SEGMENTS_PER_PACKET: usize = 10;

/// Most points in one packet, for the same reason.
pub const POINTS_PER_PACKET: usize = 32;

/// Result of a frame, without its segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FrameHead {
    /// Number of the captured pair: one more than the last one's, wrapping. A gap is a pair whose result did not arrive.
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
    /// The head of a result of the core; what its counts say about full lists is added to `health`, and `send_frame`
    /// fills in the number of segments.
    #[must_use]
    pub fn new(sequence: u32, capture_time_us: u64, dims: Dims, health: Health, counts: &linestereo::Counts) -> Self {
        let Dims { width, height } = dims;
        let health = health | Health::of(counts);
        let (times, counts, clock) = (FrameTimes::default(), counts.into(), TimeSource::Board);
        Self { sequence, capture_time_us, width, height, health, pair: None, times, counts, segments: 0, clock }
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

/// The core's [`Counts`](linestereo::Counts), number for number.
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
    /// See [`linestereo::Counts`].
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
        Rejection::ALL.iter().zip(self.rejected).find(|&(&of, _)| of == reason).map_or(0, |(_, count)| count)
    }
}

impl From<&linestereo::Counts> for Counts {
    fn from(counts: &linestereo::Counts) -> Self {
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
    pub list: Vec<Segment, SEGMENTS_PER_PACKET>,
}

/// Some of a frame's points.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Points {
    /// The frame they belong to.
    pub sequence: u32,
    /// Position of the first of them in the frame's list.
    pub first: u32,
    /// The points.
    pub list: Vec<PointRecord, POINTS_PER_PACKET>,
}

/// A [`Point`] in plain numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointRecord {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
    /// Disparity, 1/64 px.
    pub disparity_q6: i16,
    /// Probability that the disparity is within 1 px, 1/65536.
    pub confidence_q16: u16,
    /// Kind and position of the hypothesis that it comes from.
    #[serde(with = "SourceOrder")]
    pub source: Source,
}

/// Order of a [`Source`] on the wire; the first two are encoded as the `Option` of a position that stood here before there were support points.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Source")]
enum SourceOrder {
    Side,
    Segment(u16),
    Support,
}

impl From<&Point> for PointRecord {
    fn from(point: &Point) -> Self {
        let Point { x, y, disparity, confidence, source } = *point;
        Self { x, y, disparity_q6: disparity.to_bits(), confidence_q16: confidence.to_bits(), source }
    }
}

impl From<&PointRecord> for Point {
    fn from(record: &PointRecord) -> Self {
        Self {
            x: record.x,
            y: record.y,
            disparity: Disparity::from_bits(record.disparity_q6),
            confidence: Confidence::from_bits(record.confidence_q16),
            source: record.source,
        }
    }
}

/// A [`Match`] in plain numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Segment {
    /// x and y of both ends, 1/32 px.
    pub ends_q5: [[u16; 2]; 2],
    /// Disparity at each end, 1/64 px.
    pub disparity_q6: [i16; 2],
    /// Standard deviation of the disparity, 1/64 px.
    pub sigma_q6: i16,
    /// Probability that the disparity is within 1 px, 1/65536.
    pub confidence_q16: u16,
    /// Which sides carry the disparity.
    #[serde(with = "OwnerOrder")]
    pub owner: Owner,
    /// Depth at each end, 1/65536 m; `i32::MAX` is infinite.
    pub depth_q16: Option<[i32; 2]>,
    /// Standard deviation of depth at each end, 1/65536 m.
    pub depth_sigma_q16: Option<[i32; 2]>,
    /// Disparity by feature matching, 1/64 px.
    pub feature_q6: Option<i16>,
    /// Disparity of the window, 1/64 px.
    pub window_q6: i16,
    /// Disparity by census, 1/64 px.
    pub census_q6: i16,
}

/// Order of an [`Owner`] on the wire.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Owner")]
enum OwnerOrder {
    Left,
    Right,
    Both,
}

impl From<&Match> for Segment {
    fn from(found: &Match) -> Self {
        Self {
            ends_q5: found.ends.map(|end| [end.x.to_bits(), end.y.to_bits()]),
            disparity_q6: found.disparity.map(Disparity::to_bits),
            sigma_q6: found.sigma.to_bits(),
            confidence_q16: found.confidence.to_bits(),
            owner: found.owner,
            depth_q16: found.depth.map(|ends| ends.map(Depth::to_bits)),
            depth_sigma_q16: found.depth_sigma.map(|ends| ends.map(Depth::to_bits)),
            feature_q6: found.techniques.feature.map(Disparity::to_bits),
            window_q6: found.techniques.window.to_bits(),
            census_q6: found.techniques.census.to_bits(),
        }
    }
}

impl From<&Segment> for Match {
    fn from(segment: &Segment) -> Self {
        let point = |[x, y]: [u16; 2]| ImagePosition { x: Position::from_bits(x), y: Position::from_bits(y) };
        Self {
            ends: segment.ends_q5.map(point),
            disparity: segment.disparity_q6.map(Disparity::from_bits),
            sigma: Disparity::from_bits(segment.sigma_q6),
            confidence: Confidence::from_bits(segment.confidence_q16),
            owner: segment.owner,
            depth: segment.depth_q16.map(|ends| ends.map(Depth::from_bits)),
            depth_sigma: segment.depth_sigma_q16.map(|ends| ends.map(Depth::from_bits)),
            techniques: Techniques {
                feature: segment.feature_q6.map(Disparity::from_bits),
                window: Disparity::from_bits(segment.window_q6),
                census: Disparity::from_bits(segment.census_q6),
            },
        }
    }
}
