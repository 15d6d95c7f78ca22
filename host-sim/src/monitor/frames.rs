//! Messages to frames.
//!
//! In: the messages that arrived. Out: frames, each with the number of segments it lacks, and
//! counts of the frames that never arrived.
//!
//! A frame ends with its last segment, or when something of a later frame arrives. Sequence numbers
//! say what is missing: a step of more than one is a loss, a step back (or none) a board that
//! started anew.
//!
//! # Bounds
//! A step of 2^31 or more is a step back. At most 65535 segments are held, as many as a head can
//! promise.

use linestereo::results::Match;
use linestereo_wire::{FrameHead, Segments};

/// A frame as far as it arrived.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    pub head: FrameHead,
    pub matches: Vec<Match>,
    /// Position after the last segment that arrived.
    next: u16,
}

impl Frame {
    /// Segments that did not arrive.
    pub fn missing(&self) -> usize {
        usize::from(self.head.segments).saturating_sub(self.matches.len())
    }
}

/// Frames by what became of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct FrameCounts {
    /// With all their segments.
    pub complete: u64,
    /// Without some of them.
    pub incomplete: u64,
    /// Segments that the incomplete ones lack.
    pub missing_segments: u64,
    /// Frames between others, of which no head arrived.
    pub lost: u64,
    /// Times the numbers began anew.
    pub restarts: u64,
}

#[derive(Debug, Default)]
pub struct Assembler {
    open: Option<Frame>,
    last: Option<u32>,
    counts: FrameCounts,
}

impl Assembler {
    pub fn counts(&self) -> FrameCounts {
        self.counts
    }

    /// A frame begins: gives the frame that this ends, and this one if it has no segments.
    pub fn begin(&mut self, head: FrameHead) -> impl Iterator<Item = Frame> + use<> {
        let before = self.finish();
        match self.last.map(|last| head.sequence.wrapping_sub(last)) {
            None => {}
            Some(0 | 0x8000_0000..) => self.counts.restarts += 1,
            Some(step) => self.counts.lost += u64::from(step) - 1,
        }
        self.last = Some(head.sequence);
        self.open = Some(Frame { head, matches: Vec::new(), next: 0 });
        before.into_iter().chain(self.finish_if_ended())
    }

    /// Some segments arrived: gives the frame that they end, or the one before if they belong to a
    /// later one.
    pub fn add(&mut self, segments: &Segments) -> Option<Frame> {
        match self.last.map(|last| segments.sequence.wrapping_sub(last)) {
            Some(0) => {}
            // Joined in the middle of a frame, or an old one: of no use, and no loss.
            None | Some(0x8000_0000..) => return None,
            Some(step) => {
                // The head of their frame is lost, and with it the frame.
                self.counts.lost += u64::from(step);
                self.last = Some(segments.sequence);
                return self.finish();
            }
        }
        let frame = self.open.as_mut()?;
        let end = usize::from(segments.first) + segments.list.len();
        if segments.first < frame.next || end > usize::from(frame.head.segments) {
            return None; // twice, or more than promised
        }
        frame.matches.extend(segments.list.iter().copied());
        frame.next = end as u16; // at most head.segments
        self.finish_if_ended()
    }

    /// No more comes of this run of the board: what follows is neither late nor lost.
    pub fn end(&mut self) -> Option<Frame> {
        self.last = None;
        self.finish()
    }

    /// No more comes of the open frame.
    fn finish(&mut self) -> Option<Frame> {
        let frame = self.open.take()?;
        if frame.missing() == 0 {
            self.counts.complete += 1;
        } else {
            self.counts.incomplete += 1;
            self.counts.missing_segments += frame.missing() as u64;
        }
        Some(frame)
    }

    fn finish_if_ended(&mut self) -> Option<Frame> {
        self.open.as_ref().filter(|frame| frame.next == frame.head.segments)?;
        self.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::Dims;
    use linestereo::results::{ImagePosition, Owner, Techniques};
    use linestereo::units::{Confidence, Disparity};
    use linestereo_wire::Health;

    fn head(sequence: u32, segments: u16) -> FrameHead {
        let dims = Dims { width: 64, height: 48 };
        let counts = linestereo::results::Counts::default();
        FrameHead { segments, ..FrameHead::new(sequence, 0, dims, Health::GOOD, &counts) }
    }

    fn piece(sequence: u32, first: u16, length: usize) -> Segments {
        let none = Disparity::ZERO;
        let segment = Match {
            ends: [ImagePosition::default(); 2],
            disparity: [none; 2],
            sigma: none,
            confidence: Confidence::ZERO,
            owner: Owner::Both,
            depth: None,
            depth_sigma: None,
            techniques: Techniques { feature: None, window: none, census: none },
        };
        Segments { sequence, first, list: core::iter::repeat_n(segment, length).collect() }
    }

    /// Sequence and missing segments of what a step gave.
    fn said(frames: impl IntoIterator<Item = Frame>) -> Vec<(u32, usize)> {
        frames.into_iter().map(|frame| (frame.head.sequence, frame.missing())).collect()
    }

    #[test]
    fn a_frame_ends_with_its_last_segment() {
        let mut frames = Assembler::default();
        assert_eq!(said(frames.begin(head(u32::MAX, 13))), []);
        assert_eq!(said(frames.add(&piece(u32::MAX, 0, 10))), []);
        assert_eq!(said(frames.add(&piece(u32::MAX, 10, 3))), [(u32::MAX, 0)]);
        assert_eq!(
            said(frames.begin(head(0, 0))),
            [(0, 0)],
            "numbers wrap, and no segments are none to wait for"
        );
        assert_eq!(frames.counts(), FrameCounts { complete: 2, ..FrameCounts::default() });
    }

    #[test]
    fn missing_segments_are_counted_wherever_they_were() {
        let mut frames = Assembler::default();
        assert_eq!(said(frames.begin(head(1, 25))), []);
        assert_eq!(said(frames.add(&piece(1, 0, 10))), []);
        assert_eq!(said(frames.add(&piece(1, 20, 5))), [(1, 10)], "the middle");
        assert_eq!(said(frames.begin(head(2, 12))), []);
        assert_eq!(said(frames.add(&piece(2, 0, 10))), []);
        assert_eq!(said(frames.begin(head(3, 0))), [(2, 2), (3, 0)], "the end");
        assert_eq!(said(frames.begin(head(4, 1))), []);
        assert_eq!(said(frames.finish()), [(4, 1)], "everything");
        let expected = FrameCounts {
            complete: 1,
            incomplete: 3,
            missing_segments: 13,
            ..FrameCounts::default()
        };
        assert_eq!(frames.counts(), expected);
    }

    #[test]
    fn gaps_are_losses_and_steps_back_are_restarts() {
        let mut frames = Assembler::default();
        assert_eq!(said(frames.add(&piece(6, 0, 1))), [], "joined in the middle of a frame");
        for (sequence, lost, restarts) in [(7, 0, 0), (10, 2, 0), (10, 2, 1), (0, 2, 2), (1, 2, 2)]
        {
            assert_eq!(said(frames.begin(head(sequence, 0))), [(sequence, 0)]);
            assert_eq!(
                (frames.counts().lost, frames.counts().restarts),
                (lost, restarts),
                "{sequence}"
            );
        }
        assert_eq!(said(frames.begin(head(2, 5))), []);
        assert_eq!(said(frames.add(&piece(4, 0, 1))), [(2, 5)], "two heads are lost");
        assert_eq!(said(frames.add(&piece(4, 1, 1))), []);
        assert_eq!(said(frames.begin(head(5, 0))), [(5, 0)]);
        assert_eq!((frames.counts().lost, frames.counts().incomplete), (4, 1));
    }

    #[test]
    fn pieces_that_do_not_belong_are_left_out() {
        let mut frames = Assembler::default();
        assert_eq!(said(frames.begin(head(9, 12))), []);
        for other in [piece(8, 0, 2), piece(9, 10, 3), piece(9, u16::MAX, 1)] {
            assert_eq!(said(frames.add(&other)), []);
        }
        assert_eq!(said(frames.add(&piece(9, 0, 10))), []);
        assert_eq!(said(frames.add(&piece(9, 0, 10))), [], "twice");
        assert_eq!(said(frames.add(&piece(9, 10, 2))), [(9, 0)]);
        assert_eq!(frames.counts(), FrameCounts { complete: 1, ..FrameCounts::default() });
    }
}
