//! Pairs of a folder, a recording, a video or a camera, shown as they are matched.

use super::space::Space;
use super::{Args, Asked, LOOK, Pace, end, picture};
use crate::commands::objects::ObjectArgs;
use crate::commands::pairs::{has_ended, video_note};
use crate::commands::player::{Player, line};
use crate::commands::recording::Played;
use crate::engine::FrameResult;
use crate::interruption;
use crate::output::say;
use crate::results::listing;
use crate::serve::{AskedBox, Server};
use anyhow::{Result, bail};
use linestereo::{Area, Region};
use linestereo_frames::StoredPair;
use linestereo_recordings::Footage;
use serde_json::json;
use std::path::Path;
use std::thread;
use std::time::Instant;

/// A source of pairs that is shown.
struct Show<'a> {
    args: &'a Args,
    server: &'a Server,
    player: Player<'a>,
    space: Option<Space>,
    asked: Asked,
    is_matched: bool,
    shown: u64,
    failed: u64,
    first_error: Option<String>,
}

/// Shows every pair, then the last one until Ctrl-C; the summary.
pub(super) fn show(args: &Args) -> Result<String> {
    let found = args.source.find(args.path.as_deref())?;
    let path = args.path.as_deref().unwrap_or(Path::new(""));
    let frames = args.source.chosen(path, &found)?;
    let player = Player::new(&args.input, path)?;
    let server = &args.serve()?;
    let mut show = Show {
        args,
        server,
        player,
        space: None,
        asked: Asked::default(),
        is_matched: false,
        shown: 0,
        failed: 0,
        first_error: None,
    };
    let is_live = frames.count().is_none();
    loop {
        let mut pace = Pace::new(args);
        for (number, pair) in frames.pairs(&found) {
            if !is_live {
                let due = pace.due(time_us(&pair));
                show.wait(|| Instant::now() >= due);
            }
            if interruption::requested() || !show.pair(number, &pair, &found)? {
                break;
            }
        }
        let is_over = interruption::requested() || is_live || has_ended(&found) || show.shown == 0;
        if is_over || !args.repeat {
            break;
        }
    }
    let summary = show.summary(&found);
    if let (0, Some(error)) = (show.shown, &show.first_error) {
        bail!("no pair can be matched; {error}");
    }
    if !interruption::requested() {
        say("all pairs are shown; the page stays until Ctrl-C\n")?;
        show.wait(|| false);
    }
    end(server, &summary);
    Ok(summary)
}

fn time_us(pair: &StoredPair) -> Option<u64> {
    pair.images.time_ns().map(|ns| ns / 1000)
}

impl Show<'_> {
    /// Matches and shows a pair; false where no more will come.
    fn pair(&mut self, number: u64, pair: &StoredPair, found: &Footage) -> Result<bool> {
        let outcome = self.player.next(pair, &ObjectArgs::default().open(Path::new(""), found)?);
        if outcome.is_err() && (interruption::requested() || has_ended(found)) {
            return Ok(false);
        }
        let played = outcome
            .map_err(|error| format!("{error:#}").split_whitespace().collect::<Vec<_>>().join(" "));
        let mut events = Vec::new();
        if let Ok(Played { images: [left, _], .. }) = &played {
            events.push(picture(left));
        }
        events.push(("frame", line(number, pair, &played, false)?));
        match played {
            Ok(Played { result, .. }) => {
                self.shown += 1;
                if let Some(setup) = self.player.setup()
                    && let Some(space) = Space::of(&mut self.space, self.args, setup)?
                {
                    let FrameResult { matches, obstacle_points, ground, health, .. } = &result;
                    events.push(space.above(matches, &result.points));
                    events.push(space.sectors(matches, obstacle_points, *ground, *health)?);
                }
                self.is_matched = true;
            }
            Err(error) => {
                self.failed += 1;
                self.first_error.get_or_insert_with(|| format!("{}: {error}", pair.name));
            }
        }
        self.server.send("pair", &events);
        self.asked.changed(self.server);
        self.answer();
        let counts = json!({"shown": self.shown, "failed": self.failed});
        self.server.send("link", &[("link", counts.to_string())]);
        Ok(true)
    }

    /// Answers the visitors until it is time, or Ctrl-C.
    fn wait(&mut self, is_time: impl Fn() -> bool) {
        while !is_time() && !interruption::requested() {
            if self.asked.changed(self.server) {
                self.answer();
            }
            thread::sleep(LOOK);
        }
    }

    /// Tells the depths of the visitors' boxes in the last pair.
    fn answer(&mut self) {
        if let Some(told) = self.answers() {
            self.server.send("objects", &[("objects", told)]);
        }
    }

    fn answers(&mut self) -> Option<String> {
        let (setup, matcher) = self.player.at_hand().filter(|_| self.is_matched)?;
        let dims = setup.dims();
        let answer = |(&asked, label): (&AskedBox, u16)| {
            let [left, top, right, bottom] = asked;
            let region = Region::boxed(label, Area { left, top, right, bottom }, dims).ok()?;
            let found = matcher.engine.object(&region);
            Some((asked, listing::Object::new(label, &found, None)))
        };
        let (boxes, objects): (Vec<_>, Vec<_>) =
            self.asked.boxes.iter().zip(0..).filter_map(answer).unzip();
        let has_metres = setup.params.rig.is_some();
        Some(json!({"boxes": boxes, "objects": objects, "rig": has_metres}).to_string())
    }

    fn summary(&self, found: &Footage) -> String {
        let mut text = format!("{} pairs shown, {} failed\n", self.shown, self.failed);
        if let Some(error) = &self.first_error {
            text.push_str(&format!("first failure: {error}\n"));
        }
        text + &video_note(found)
    }
}
