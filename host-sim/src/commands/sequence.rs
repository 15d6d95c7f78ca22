//! `linestereo sequence`: a recorded sequence, a line of JSON or messages of ROS 2 per frame.

use super::asked_for;
use super::input::InputArgs;
use super::objects::{Asked, ObjectArgs, ObjectTally};
use super::pairs::{bar, has_ended, named_bar};
use super::player::{Player, SourceArgs, line};
use super::recording::{Played, Sink};
use super::sector_options::SectorPlanArgs;
use crate::interruption::{self, Interrupted};
use crate::output::{OutputPath, is_quiet, say, spare, tell};
use crate::results::health;
use crate::results::ros::{Content, Extra};
use anyhow::{Result, bail};
use linestereo_frames::{StoredPair, layouts};
use linestereo_recordings::{Footage, Video};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Match every pair of a recorded sequence: one line of JSON per frame, or messages of ROS 2.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/sequence.txt"))]
pub struct Args {
    /// Folder with the sequence, a recording of ROS 2 (.mcap), or a video (.y4m; by ffmpeg .mp4,
    /// .mkv, .avi, .mov, .webm, .mjpeg) with both views side by side, or of the left camera.
    #[arg(required_unless_present = "camera", conflicts_with = "camera")]
    folder: Option<PathBuf>,
    /// Write to this file and not to stdout; ROS 2 messages if its name ends in .mcap.
    #[arg(long, value_name = "FILE.jsonl|FILE.mcap")]
    out: Option<OutputPath>,
    /// Leave the points out, and /linestereo/points of messages.
    #[arg(long)]
    no_points: bool,
    /// Also write these messages to --out FILE.mcap, besides points, segments and health.
    #[arg(long, value_name = "WHAT", value_delimiter = ',', requires = "out")]
    with: Vec<Extra>,
    #[command(flatten)]
    source: SourceArgs,
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    objects: ObjectArgs,
    /// List the nearest obstacle and drop-off of each direction in each line, by its pair alone;
    /// needs a rig. ROS 2 messages have them unless objects alone are matched, and keep for a
    /// while what was seen.
    #[arg(long, help_heading = "Distance per direction", conflicts_with = "only_objects")]
    sectors: bool,
    #[command(flatten, next_help_heading = "Distance per direction")]
    sector_plan: SectorPlanArgs,
}

pub fn run(args: &Args) -> Result<()> {
    if args.objects.is_given() && args.folder.is_none() {
        bail!(
            "--objects needs image names or the time stamps of a recording, and a camera has \
             neither; give a folder or a recording"
        );
    }
    // What is begun here, a video's decoder too, is ended in order.
    interruption::watch();
    let folder = args.folder.as_deref();
    let found = args.source.find(folder)?;
    let folder = folder.unwrap_or(Path::new(""));
    let frames = args.source.chosen(folder, &found)?;
    let objects = args.objects.open(folder, &found)?;
    spare(asked_for([&args.out]), found.pairs.iter().flat_map(StoredPair::files))?;
    let sectors = (!args.objects.is_only()).then(|| args.sector_plan.wanted());
    let mut player = Player::new(&args.input, folder)?;
    let content = Content { extras: &args.with, sectors, no_points: args.no_points };
    let mut sink = Sink::new(args.out.as_ref(), content, found.of_recording())?;
    args.check_sectors(sink.is_ros())?;
    let mut tally = Tally { may_be_empty: args.objects.is_only(), ..Tally::default() };
    let progress = frames.count().map_or_else(|| bar(0, "{spinner} {pos} {msg}"), named_bar);
    for (number, pair) in frames.pairs(&found) {
        if interruption::requested() {
            break;
        }
        progress.set_message(pair.name.clone());
        let outcome = player.next(&pair, &objects);
        // Then it is not this pair that failed.
        if outcome.is_err() && (interruption::requested() || has_ended(&found)) {
            break;
        }
        let mut played = tally.count(&pair, outcome);
        if let (true, Ok(of), Some(setup)) = (args.sectors, &mut played, player.setup()) {
            of.sectors = Some(args.sector_plan.directions(setup, &of.result)?.list());
        }
        if sink.is_ros() {
            sink.messages(number, &pair, player.setup(), &played)?;
        } else if sink.is_terminal() {
            sink.line(&short(number, &pair, &played))?;
        } else {
            sink.line(&line(number, &pair, &played, args.no_points)?)?;
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    let mut notes = tally.summary(&found);
    if args.objects.is_given() {
        notes.push_str(&tally.objects.summary());
    }
    let out = sink.path();
    // Without a line an earlier file stays.
    notes.push_str(&sink.commit(tally.frames > 0)?);
    if out.is_some() {
        say(&notes)?;
    } else if !is_quiet() {
        tell(notes.trim_end());
    }
    match frames.count().filter(|_| interruption::requested() || !has_ended(&found)) {
        Some(wanted) => tally.outcome(wanted, out),
        None if tally.frames == 0 && !interruption::requested() => {
            bail!("no frame came; {}", notes.replace('\n', " "))
        }
        None => tally.outcome(tally.frames, out),
    }
}

impl Args {
    /// Refuses options of sectors that nothing here uses.
    fn check_sectors(&self, is_ros: bool) -> Result<()> {
        if self.objects.is_only() {
            return self.sector_plan.refuse_unused("--sectors in place of --only-objects");
        }
        if !is_ros && !self.sectors {
            return self.sector_plan.refuse_unused("--sectors, or --out FILE.mcap");
        }
        if is_ros && self.sector_plan.has_yaw() {
            bail!(
                "--camera-yaw turns no messages, whose scans are in the camera's frame; leave it \
                 out, and turn that frame in your robot's transforms"
            );
        }
        Ok(())
    }
}

/// A frame for people: lines of JSON are for files and programs.
fn short(number: u64, pair: &StoredPair, played: &Result<Played, String>) -> String {
    let name = &pair.name;
    match played {
        Err(error) => format!("{number} {name}: {error}\n"),
        Ok(Played { result, objects, .. }) => {
            let (segments, points) = (result.matches.len(), result.points.len());
            let objects = objects.as_ref().map_or(String::new(), Asked::summary);
            format!(
                "{number} {name}: {segments} segments, {points} points, health: {}\n{objects}",
                result.health
            )
        }
    }
}

/// Counts of frames by outcome.
#[derive(Default)]
struct Tally {
    frames: usize,
    failed: usize,
    /// Frames that are not fit to be used, or in which nothing is matched.
    refused: usize,
    first_error: Option<String>,
    /// Why the first of them is not.
    first_refusal: Option<String>,
    /// Only objects are matched: a frame without any is right.
    may_be_empty: bool,
    /// Frames with each flag of their health.
    flagged: BTreeMap<&'static str, (usize, &'static str)>,
    objects: ObjectTally,
}

impl Tally {
    /// Counts a frame; an error as one line.
    fn count(&mut self, pair: &StoredPair, outcome: Result<Played>) -> Result<Played, String> {
        self.frames += 1;
        let played = match outcome {
            Ok(played) => played,
            Err(error) => {
                self.failed += 1;
                let error = format!("{error:#}").split_whitespace().collect::<Vec<_>>().join(" ");
                self.first_error.get_or_insert_with(|| format!("{}: {error}", pair.name));
                return Err(error);
            }
        };
        let is_right = self.may_be_empty && health::is_fit(played.result.health);
        if let Some(why) = played.refusal.as_ref().filter(|_| !is_right) {
            self.refused += 1;
            self.first_refusal.get_or_insert_with(|| format!("{}: {why}", pair.name));
        }
        for (flag, what) in health::advice(played.result.health) {
            self.flagged.entry(flag).or_insert((0, what)).0 += 1;
        }
        if let Some(objects) = &played.objects {
            self.objects.count(&pair.name, objects);
        }
        Ok(played)
    }

    fn summary(&self, found: &Footage) -> String {
        let layouts: Vec<&str> =
            layouts(&found.pairs).into_iter().map(|(layout, _)| layout.name()).collect();
        let (frames, failed) = (self.frames, self.failed);
        let mut text =
            format!("{frames} frames, {failed} failed, {} images without a partner", found.alone);
        text.push_str(&format!("; layout: {}\n", layouts.join(", ")));
        if self.refused > 0 {
            text.push_str(&format!(
                "{} frames are not fit to be used, or nothing is matched in them\n",
                self.refused
            ));
        }
        if let Some(recording) = found.of_recording() {
            text.push_str(&format!("recording: {}\n", recording.summary()));
        }
        let video = found.of_video().and_then(Video::summary);
        text.extend(video.map(|note| format!("video: {note}\n")));
        if let Some(error) = &self.first_error {
            text.push_str(&format!("first failure: {error}\n"));
        }
        let mut flagged: Vec<_> = self.flagged.iter().collect();
        flagged
            .sort_by_key(|(flag, (count, _))| (health::urgency(flag), core::cmp::Reverse(*count)));
        let line = |(flag, (count, what)): (&&str, &(usize, &str))| {
            format!("health: {flag} in {count} frames: {what}\n")
        };
        text.extend(flagged.into_iter().map(line));
        if self.flagged.contains_key("skew") {
            text.push_str(
                "--max-skew-ms matches pairs that were captured apart; their depths are right only \
                 for still scenes\n",
            );
        }
        text
    }

    /// Was anything matched, and everything that was asked for?
    fn outcome(&self, wanted: usize, out: Option<String>) -> Result<()> {
        if self.frames < wanted {
            let kept = out.map_or(String::new(), |path| format!("; their lines are in {path}"));
            return Err(
                Interrupted(format!("after {} of {wanted} frames{kept}", self.frames)).into()
            );
        }
        match (&self.first_error, &self.first_refusal) {
            (Some(error), _) if self.failed == self.frames => {
                bail!("no frame can be matched; {error}")
            }
            (_, Some(why)) if self.failed + self.refused == self.frames => {
                bail!("no frame can be used; {why}")
            }
            _ => Ok(()),
        }
    }
}
