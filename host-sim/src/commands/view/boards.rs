//! A board's results, shown as they arrive, or at the times of their recording.

use super::space::Space;
use super::{Args, Asked, LOOK, Pace, end, picture};
use crate::commands::input::Setup;
use crate::interruption;
use crate::monitor::frames::Frame;
use crate::monitor::link::{Answered, Event, Link};
use crate::monitor::port::{Port, Received};
use crate::monitor::requests::{self, Wanted};
use crate::monitor::text;
use crate::output::say;
use crate::results::directions::Direction;
use crate::results::listing;
use crate::serve::Server;
use anyhow::{Result, bail};
use core::time::Duration;
use linestereo::{Area, Dims, obstacles::Sector};
use linestereo_calibration::rectify::PairRectifier;
use linestereo_frames::GrayImage;
use linestereo_rig::CameraSide;
use linestereo_wire::{ObjectRecord, Objects, RegionBox, Regions, Request, Sectors};
use serde_json::json;
use std::thread;
use std::time::Instant;

/// Requests of the page itself, not of --send.
const PHOTOGRAPH: &str = "photograph for the page";
const BOXES: &str = "the boxes of the page";
/// Counts of the link are told this often.
const COUNTS_EVERY: Duration = Duration::from_millis(250);

/// A board whose results are shown.
struct Show<'a> {
    args: &'a Args,
    server: &'a Server,
    link: Link,
    asked: Asked,
    /// The visitors' boxes that the board last accepted.
    accepted: Vec<RegionBox>,
    /// The board matches boxes alone, and sees no obstacle elsewhere.
    in_areas: bool,
    /// Depths that the board sent, and their frame.
    objects: (u32, Vec<ObjectRecord>),
    pace: Pace,
    /// A port that a board listens at.
    is_live: bool,
    /// Directions that the board sent, which know its support points, and their frame.
    sectors: Option<(u32, Vec<Direction>)>,
    told: Instant,
    /// When the last photograph was asked for, or the last of it arrived.
    photographed: Option<Instant>,
    /// Set-up of its frames by the options; `None` until their size is known.
    setup: Option<Setup<'a>>,
    space: Option<Space>,
    /// With --rig.
    rectifier: Option<PairRectifier>,
}

/// Shows what the board sends until its end, or Ctrl-C; the summary.
pub(super) fn show(args: &Args) -> Result<String> {
    let link = Link::new(requests::parse(&args.send)?);
    let mut port = args.board.open_or(args.path.as_deref())?;
    let server = &args.serve()?;
    let is_live = args.path.is_none();
    let mut show = Show {
        args,
        server,
        link,
        asked: Asked::default(),
        accepted: Vec::new(),
        in_areas: false,
        objects: (0, Vec::new()),
        pace: Pace::new(args),
        is_live,
        sectors: None,
        told: Instant::now(),
        photographed: None,
        setup: None,
        space: None,
        rectifier: None,
    };
    let outcome = loop {
        let outcome = show.follow(&mut port);
        show.link.finish();
        if outcome.is_err()
            || is_live
            || !args.repeat
            || interruption::requested()
            || show.link.has_nothing()
        {
            break outcome;
        }
        port = args.board.open_or(args.path.as_deref())?;
    };
    if let (Ok(()), Some(path)) = (&outcome, args.path.as_ref().filter(|_| show.link.has_nothing()))
    {
        bail!(
            "{} holds nothing that a board sent, in {} bytes; give a file of linestereo monitor \
             --record, a folder, an .mcap file or a video",
            path.display(),
            show.link.bytes()
        );
    }
    show.tell_counts();
    if outcome.is_ok() && !interruption::requested() {
        say("all frames are shown; the page stays until Ctrl-C\n")?;
        show.wait(None);
    }
    let summary = show.link.summary();
    match &outcome {
        Ok(()) => end(server, &summary),
        Err(error) => end(server, &format!("{error:#}\n{summary}")),
    }
    outcome.map(|()| summary)
}

impl Show<'_> {
    fn follow(&mut self, port: &mut Port) -> Result<()> {
        let mut buffer = [0; 4096];
        while !interruption::requested() {
            if self.is_live {
                self.ask();
                self.link.command(port)?;
            }
            match port.read(&mut buffer)? {
                Received::Silence => {}
                Received::End => return Ok(()),
                Received::Bytes(length) => {
                    for &byte in &buffer[..length] {
                        for event in self.link.push(byte) {
                            self.event(event)?;
                        }
                    }
                }
            }
            if self.told.elapsed() >= COUNTS_EVERY {
                self.tell_counts();
            }
        }
        Ok(())
    }

    /// Asks the board for a photograph, where one is due, and for the visitors' boxes, where they
    /// are others than before.
    fn ask(&mut self) {
        // The board would begin anew, and pairs are matched between photographs.
        if self.link.is_photographing() {
            self.photographed = Some(Instant::now());
        }
        let every = self.args.photograph.map(|seconds| Duration::from_secs(seconds.into()));
        if every.is_some_and(|every| self.photographed.is_none_or(|last| last.elapsed() >= every))
            && self.link.is_answered()
        {
            self.photographed = Some(Instant::now());
            self.link.ask(Wanted { request: Request::Photograph, words: PHOTOGRAPH.to_owned() });
        }
        if !self.asked.changed(self.server) {
            return;
        }
        let numbered = self.asked.boxes.iter().zip(0..);
        let boxes = numbered.map(|(&[left, top, right, bottom], label)| {
            RegionBox::from((label, Area { left, top, right, bottom }))
        });
        let request = Request::SetRegions(Regions { boxes: boxes.collect(), only: false });
        self.link.ask(Wanted { request, words: BOXES.to_owned() });
    }

    fn event(&mut self, event: Event) -> Result<()> {
        match event {
            Event::Frame(frame) => {
                self.objects.1.clear();
                self.frame(&frame)?;
            }
            Event::Objects(objects) => self.objects(&objects),
            Event::Sectors(sectors) => self.directions(&sectors),
            Event::Photo(photo) => self.photo(&photo),
            Event::Answer(answered) => self.answered(&answered)?,
            Event::Note(note) => self.note(&note),
        }
        Ok(())
    }

    /// Tells the visitors. A refusal of what --send asked for ends the program, one of what the
    /// page asked for does not.
    fn answered(&mut self, answered: &Answered) -> Result<()> {
        let Wanted { request, words } = &answered.wanted;
        match (answered.note(), request) {
            (Err(error), _) if words != PHOTOGRAPH && words != BOXES => return Err(error),
            (Err(error), _) => self.note(&error.to_string()),
            (Ok(note), Request::SetRegions(regions)) => {
                self.note(&note);
                self.in_areas = regions.only;
                self.accepted = if words == BOXES { regions.boxes.to_vec() } else { Vec::new() };
            }
            (Ok(note), _) => self.note(&note),
        }
        Ok(())
    }

    fn note(&self, note: &str) {
        self.server.send("note", &[("note", json!(note).to_string())]);
    }

    /// Shows a complete frame; others are counted.
    fn frame(&mut self, frame: &Frame) -> Result<()> {
        if frame.missing() > 0 {
            return Ok(());
        }
        if !self.is_live {
            let due = self.pace.due(Some(frame.head.capture_time_us));
            self.wait(Some(due));
        }
        let mut events = vec![("frame", text::json(frame)?)];
        let dims = Dims { width: frame.head.width, height: frame.head.height };
        if dims.width == 0 || dims.height == 0 {
            // A pair that the board missed: it has nothing to be placed.
            self.server.send("pair", &events);
            return Ok(());
        }
        let setup = match self.setup.take().filter(|setup| setup.dims() == dims) {
            Some(setup) => setup,
            None => self.args.input.setup_of(dims)?,
        };
        let setup = self.setup.insert(setup);
        if let Some(space) = Space::of(&mut self.space, self.args, setup)? {
            events.push(space.above(&frame.matches, &[]));
            if !self.in_areas && self.sectors.is_none() {
                events.push(space.sectors(&frame.matches, &[], None, frame.head.health)?);
            }
        }
        self.server.send("pair", &events);
        Ok(())
    }

    /// Shows the left image under the segments of the frames that come: with --rig as the board
    /// rectifies it. One that is not of the rig's size is left out, with a note.
    fn photo(&mut self, [left, _]: &[GrayImage; 2]) {
        if self.rectifier.is_none() {
            match self.args.input.rectifier_of(left.dims) {
                Ok(rectifier) => self.rectifier = rectifier,
                Err(error) => {
                    return self.note(&format!("a photograph is left out: {error:#}"));
                }
            }
        }
        let shown = match &mut self.rectifier {
            Some(rectifier) => rectifier.image(CameraSide::Left, left),
            None => Ok(left.clone()),
        };
        match shown {
            Ok(shown) => self.server.send("picture", &[picture(&shown)]),
            Err(error) => self.note(&format!("a photograph is left out: {error}")),
        }
    }

    /// Depths by the board, whose packets of one frame belong together: of the visitors' boxes by
    /// their labels, behind them of those of --send.
    fn objects(&mut self, packet: &Objects) {
        if self.objects.0 != packet.sequence {
            self.objects = (packet.sequence, Vec::new());
        }
        self.objects.1.extend_from_slice(&packet.list);
        let list = &self.objects.1;
        let object =
            |record: &ObjectRecord| listing::Object::new(record.label, &record.depth(), None);
        let asked = |record: &ObjectRecord| {
            let found = self.accepted.iter().find(|of| of.label == record.label)?;
            Some([found.left, found.top, found.right, found.bottom])
        };
        let of_visitors = |record| Some((asked(record)?, object(record)));
        let (boxes, mut objects): (Vec<_>, Vec<_>) = list.iter().filter_map(of_visitors).unzip();
        objects.extend(list.iter().filter(|record| asked(record).is_none()).map(object));
        let has_metres = list.iter().any(|record| record.depth_q16.is_some());
        let told = json!({"boxes": boxes, "objects": objects, "rig": has_metres});
        self.server.send("objects", &[("objects", told.to_string())]);
    }

    /// Obstacles and drop-offs by the board, whose packets of one frame belong together.
    fn directions(&mut self, sectors: &Sectors) {
        let (sequence, turn) = (sectors.sequence, sectors.turn);
        let unknown = |index| Direction::new(index, turn, Sector::Unknown, None);
        let (_, known) = self
            .sectors
            .take_if(|(of, known)| *of == sequence && known.len() == usize::from(turn))
            .unwrap_or_else(|| (sequence, (0..turn).map(unknown).collect()));
        let (_, known) = self.sectors.insert((sequence, known));
        for found in text::directions(sectors) {
            if let Some(place) = known.get_mut(usize::from(found.index)) {
                *place = found;
            }
        }
        self.server.send("sectors", &[("sectors", json!(known).to_string())]);
    }

    fn tell_counts(&mut self) {
        self.told = Instant::now();
        let (frames, packets) = self.link.counts();
        let damaged = packets.cobs + packets.checksum + packets.too_long + packets.malformed;
        let told = json!({
            "complete": frames.complete, "incomplete": frames.incomplete, "lost": frames.lost,
            "missing_segments": frames.missing_segments, "restarts": frames.restarts,
            "damaged": damaged, "bytes": self.link.bytes(),
        });
        self.server.send("link", &[("link", told.to_string())]);
    }

    /// Until it is time, or Ctrl-C.
    fn wait(&mut self, due: Option<Instant>) {
        while due.is_none_or(|due| Instant::now() < due) && !interruption::requested() {
            self.asked.changed(self.server);
            thread::sleep(LOOK);
        }
    }
}
