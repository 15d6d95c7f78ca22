//! Records from a board to its host.

use crate::board_state::{CaptureReport, Reset};
use crate::case::{CaseReport, MachineReport};
use crate::command::{PairHead, Refusal};
use crate::frame::{FrameHead, Points, SEGMENTS_PER_PACKET, Segments};
use crate::object::Objects;
use crate::packet::{Record, Sealed, VERSION, packet_bytes};
use crate::rig_fault::RigReport;
use crate::sector::Sectors;
use crate::settings::{KeptReport, SettingValue};
use heapless::String;
use serde::{Deserialize, Serialize};

/// The name of a board.
pub type BoardName = String<32>;

/// One record from the board to the host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Message {
    /// Description of the board: sent when it starts, and for `Request::Describe` before the
    /// answer.
    Hello(Hello),
    /// A frame begins.
    Frame(FrameHead),
    /// Segments of the frame that began last.
    Segments(Segments),
    /// Outcome of a command.
    Answer(Answer),
    /// Points of the frame that began last: only from programs that are fed by a file, a serial
    /// port is too slow.
    Points(Points),
    /// Depths of the wanted objects, of the frame that began last.
    Objects(Objects),
    /// Losses of the cameras so far: sent when it has changed, at most once a second.
    Capture(CaptureReport),
    /// A requested photo begins: the pair as the cameras deliver it.
    Photo(PairHead),
    /// Pixels of the photo that began last.
    Pixels(Pixels),
    /// Machine, sent by `selftest` after each `Hello`.
    Machine(MachineReport),
    /// A built-in pair that was matched: by `selftest`, before the answer to `Request::RunCase`.
    Case(CaseReport),
    /// A setting, for `Request::Settings`, before `Message::Kept`.
    Setting(SettingValue),
    /// State of the stored settings, for `Request::Settings`, before the answer.
    Kept(KeptReport),
    /// Time of the board's own clock, in which pairs are captured, microseconds: for
    /// `Request::ReadClock`, before the answer.
    Clock(u64),
    /// Nearest obstacle and nearest drop-off by direction, of the frame that began last: where the
    /// setting `sectors` is 1 and there is a rig; an empty list where nothing is known.
    Sectors(Sectors),
}

impl Sealed for Message {}

impl Record for Message {
    const TAG: u8 = VERSION;
}

/// Bytes of the largest packet of a [`Message`], which is a full list of segments whose numbers all
/// take their longest form.
pub const MAX_PACKET: usize = {
    // postcard: 16 bits take 3 bytes, 32 take 5; ends 12, disparities 6, sigma 3, confidence 3,
    // owner 1, depths 2 * 11, techniques 10
    const SEGMENT: usize = 57;
    // kind 1, sequence 5, first 3, length 1
    packet_bytes(10 + SEGMENTS_PER_PACKET * SEGMENT)
};

/// Neighbouring pixels of a photo, row by row.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Pixels {
    /// Of the right image; of the left one if not.
    pub is_right: bool,
    /// The number of the first one, counted from the upper left corner.
    pub first: u32,
    /// Grey levels.
    pub list: heapless::Vec<u8, PIXELS_PER_PACKET>,
}

/// Most pixels in one packet: fewer bytes than a full list of segments.
pub const PIXELS_PER_PACKET: usize = 512;

/// Description of a board.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Hello {
    /// Its name.
    pub board: BoardName,
    /// Widest image it has memory for, px.
    pub largest_width: u16,
    /// Highest image it has memory for, px.
    pub largest_height: u16,
    /// Segments it can detect per image, and match.
    pub segments: u16,
    /// The rig it uses.
    pub rig: RigReport,
    /// Why it was reset, if it knows.
    pub reset: Option<Reset>,
}

/// Outcome of a command.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Answer {
    /// The id of the command.
    pub command: u16,
    /// Its outcome.
    pub outcome: Outcome,
}

/// Accepted, or refused for a reason; what is refused has changed nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// Done.
    Accepted,
    /// Not done.
    Refused(Refusal),
}

impl From<Result<(), Refusal>> for Outcome {
    fn from(result: Result<(), Refusal>) -> Self {
        match result {
            Ok(()) => Self::Accepted,
            Err(refusal) => Self::Refused(refusal),
        }
    }
}
