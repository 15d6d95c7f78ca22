//! A board behind a port: bytes to what they say, and commands with their answers.
//!
//! In: bytes, and requests. Out: frames, photographs, depths of objects, directions, notes; a
//! command is sent again until it is answered.

use super::frames::{Assembler, Frame, FrameCounts};
use super::photo::PhotoAssembler;
use super::port::Port;
use super::requests::{self, Wanted};
use super::text;
use anyhow::{Result, bail};
use core::time::Duration;
use linestereo_frames::GrayImage;
use linestereo_wire::{
    Answer, Command, Counters, DecodeError, Decoder, Hello, MAX_PACKET, Message, Objects, Outcome,
    Refusal, Request, Sectors, SettingValue,
};
use std::collections::VecDeque;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Has the board give times in this computer's clock, anew after so long: the board forgets it
/// after 10 s.
const SYNC: &str = "sync";
const SYNC_EVERY: Duration = Duration::from_secs(2);
/// A command is sent again after this long without an answer,
const ANSWER_WITHIN: Duration = Duration::from_secs(1);
/// this many times in all.
const ATTEMPTS: u32 = 5;

/// Content of one or more packets.
#[derive(Clone, Debug)]
pub enum Event {
    /// A frame, complete or not.
    Frame(Frame),
    /// Depths of the boxes that the board was asked for; those of a frame come in several packets.
    Objects(Box<Objects>),
    /// Nearest obstacle and nearest drop-off by direction, of the frame before.
    Sectors(Box<Sectors>),
    /// Both images as the cameras delivered them, before they were rectified.
    Photo([GrayImage; 2]),
    /// The board's answer to a request.
    Answer(Answered),
    /// A line for people.
    Note(String),
}

/// A request, and why the board refused it, if it did.
#[derive(Clone, Debug)]
pub struct Answered {
    pub wanted: Wanted,
    pub refusal: Option<Refusal>,
}

impl Answered {
    /// A line for people; a refusal is an error.
    pub fn note(&self) -> Result<String> {
        let words = &self.wanted.words;
        match &self.refusal {
            None => Ok(format!("accepted: {words}")),
            Some(refusal) => bail!("the board refused {words}: {refusal}"),
        }
    }
}

/// A command that was sent, and has no answer yet.
struct Waiting {
    command: Command,
    words: String,
    since: Instant,
    attempts: u32,
}

/// State of the link and of the board as far as it is known.
#[derive(Default)]
pub struct Link {
    decoder: Decoder<Message, MAX_PACKET>,
    frames: Assembler,
    photos: PhotoAssembler,
    bytes: u64,
    other_version: Option<u8>,
    wanted: VecDeque<Wanted>,
    /// When the board's clock was last asked for, if it is to follow the host's.
    synced: Option<Instant>,
    waiting: Option<Waiting>,
    next_id: u16,
    last_hello: Option<Hello>,
    /// Those of a list that is not complete yet.
    settings: Vec<SettingValue>,
}

impl Link {
    /// A link that sends these requests, each after the answer to the one before.
    pub fn new(wanted: Vec<Wanted>) -> Self {
        // A late answer to an earlier program is not taken for one to this.
        let next_id = std::process::id() as u16;
        Self { wanted: described(wanted).into(), next_id, ..Self::default() }
    }

    /// One more request, behind those that wait.
    pub fn ask(&mut self, wanted: Wanted) {
        self.wanted.push_back(wanted);
    }

    /// Was everything answered that was asked?
    pub fn is_answered(&self) -> bool {
        self.waiting.is_none() && self.wanted.is_empty()
    }

    /// Are the pixels of a photograph on their way?
    pub fn is_photographing(&self) -> bool {
        self.photos.is_arriving()
    }

    /// Sends the next command, or the last one again.
    pub fn command(&mut self, port: &mut Port) -> Result<()> {
        match &mut self.waiting {
            None => {
                if self.wanted.is_empty()
                    && self.synced.is_some_and(|since| since.elapsed() >= SYNC_EVERY)
                {
                    self.wanted
                        .push_back(Wanted { request: Request::ReadClock, words: SYNC.to_owned() });
                }
                let Some(Wanted { request, words }) = self.wanted.pop_front() else {
                    return Ok(());
                };
                if request == Request::ReadClock {
                    self.synced = Some(Instant::now());
                }
                self.next_id = self.next_id.wrapping_add(1);
                let command = Command { id: self.next_id, request };
                self.waiting = Some(Waiting { command, words, since: Instant::now(), attempts: 0 });
            }
            Some(waiting) if waiting.since.elapsed() < ANSWER_WITHIN => return Ok(()),
            Some(waiting) if waiting.attempts == ATTEMPTS => {
                bail!(
                    "no answer to {} in {ATTEMPTS} s; does the board run, and is the speed right?",
                    waiting.words
                )
            }
            Some(_) => {}
        }
        let Some(waiting) = &mut self.waiting else { return Ok(()) };
        waiting.attempts += 1;
        waiting.since = Instant::now();
        port.send(&waiting.command)
    }

    /// One byte from the board: the events that it completes, mostly none.
    pub fn push(&mut self, byte: u8) -> Vec<Event> {
        self.bytes += 1;
        let event = match self.decoder.push(byte) {
            None => return Vec::new(),
            Some(Ok(Message::Frame(head))) => {
                return self.frames.begin(head).map(Event::Frame).collect();
            }
            Some(Ok(Message::Segments(segments))) => self.frames.add(&segments).map(Event::Frame),
            Some(Ok(Message::Objects(objects))) => Some(Event::Objects(Box::new(objects))),
            Some(Ok(Message::Sectors(sectors))) => Some(Event::Sectors(Box::new(sectors))),
            Some(Ok(Message::Photo(head))) => {
                self.photos.begin(&head).err().map(|lost| Event::Note(lost.to_string()))
            }
            Some(Ok(Message::Pixels(pixels))) => match self.photos.add(&pixels) {
                Ok(pair) => pair.map(Event::Photo),
                Err(lost) => Some(Event::Note(lost.to_string())),
            },
            // Points come only from programs that are fed by a file; the others are for
            // `bench-board`.
            Some(Ok(Message::Points(_) | Message::Machine(_) | Message::Case(_))) => None,
            Some(Ok(Message::Setting(value))) => {
                self.settings.push(value);
                None
            }
            Some(Ok(Message::Kept(report))) => {
                let settings = core::mem::take(&mut self.settings);
                Some(Event::Note(requests::listing(&settings, &report)))
            }
            Some(Ok(Message::Clock(board_us))) => {
                self.set_clock(board_us);
                None
            }
            Some(Ok(Message::Capture(lost))) => Some(Event::Note(format!("cameras lost: {lost}"))),
            Some(Ok(Message::Hello(hello))) => {
                let is_news = self.last_hello.as_ref() != Some(&hello);
                let note = is_news.then(|| Event::Note(introduction(&hello)));
                self.last_hello = Some(hello);
                note
            }
            Some(Ok(Message::Answer(answer))) => self.answered(answer),
            Some(Err(error)) => {
                if let DecodeError::Version { found } = error {
                    self.other_version = Some(found);
                }
                None // counted
            }
        };
        event.into_iter().collect()
    }

    fn answered(&mut self, answer: Answer) -> Option<Event> {
        // `None` for one that is answered twice.
        let Waiting { command, words, .. } =
            self.waiting.take_if(|waiting| waiting.command.id == answer.command)?;
        let refusal = match answer.outcome {
            // Every few seconds; frames name the clock.
            Outcome::Accepted if words == SYNC => return None,
            Outcome::Accepted => None,
            Outcome::Refused(refusal) => Some(refusal),
        };
        let wanted = Wanted { request: command.request, words };
        Some(Event::Answer(Answered { wanted, refusal }))
    }

    /// Has the board give times in this computer's clock: its time in the middle of the question
    /// and the answer less the board's.
    fn set_clock(&mut self, board_us: u64) {
        let is_asked = |waiting: &&Waiting| {
            waiting.command.request == Request::ReadClock && waiting.attempts == 1
        };
        let Some(waiting) = self.waiting.as_ref().filter(is_asked) else { return };
        let middle = SystemTime::now() - waiting.since.elapsed() / 2;
        let now_us = middle.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_micros() as u64);
        let offset_us = now_us.saturating_sub(board_us);
        self.wanted
            .push_front(Wanted { request: Request::SetClock(offset_us), words: SYNC.to_owned() });
    }

    /// No more bytes come of this run: the frame that is left incomplete.
    pub fn finish(&mut self) -> Option<Frame> {
        self.decoder.finish();
        self.frames.end()
    }

    /// True when no packet of a board, of this version or another one, was among the bytes.
    pub fn has_nothing(&self) -> bool {
        let packets = self.decoder.counters();
        packets.good == 0 && packets.other_version == 0
    }

    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    pub fn counts(&self) -> (FrameCounts, Counters) {
        (self.frames.counts(), self.decoder.counters())
    }

    pub fn summary(&self) -> String {
        text::summary(
            &self.frames.counts(),
            &self.decoder.counters(),
            self.bytes,
            self.other_version,
        )
    }
}

/// Before a start, a board says what it is and why it was reset: when it began to run, nobody may
/// have listened.
fn described(mut wanted: Vec<Wanted>) -> Vec<Wanted> {
    let place = |request: &Request| wanted.iter().position(|wanted| wanted.request == *request);
    if let (Some(start), None) = (place(&Request::Start), place(&Request::Describe)) {
        wanted.insert(start, Wanted { request: Request::Describe, words: "describe".to_owned() });
    }
    wanted
}

fn introduction(hello: &Hello) -> String {
    let Hello { board, largest_width, largest_height, segments, rig, reset } = hello;
    let reset = reset.map_or_else(String::new, |reset| format!("; reset by {reset}"));
    format!(
        "board: {board}, images up to {largest_width}x{largest_height}, up to {segments} \
         segments; {rig}{reset}"
    )
}
