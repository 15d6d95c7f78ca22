//! Pairs to a board and results back: the program `replay` in QEMU, fed with the packets that a
//! host sends over a port.

use super::firmware::{self, Logs};
use super::toolchain::Toolchain;
use super::{Board, qemu};
use crate::engine::FrameResult;
use anyhow::{Context, Result, bail};
use core::time::Duration;
use linestereo::{Dims, Params, unstable::Stage};
use linestereo_frames::untrusted::{self, RESULT_BYTES};
use linestereo_frames::{GrayImage, find_scenes, load_scene};
use linestereo_rig::RigImage;
use linestereo_wire::{
    Command, DELIMITER, Decoder, FrameHead, MAX_COMMAND, MAX_PACKET, Message, ObjectRecord,
    Outcome, PairHead, ParamUpdate, Refusal, Regions, Request, RigReport, RigUpdate, encode,
};
use std::path::{Path, PathBuf};

/// Longest run over a list of pairs.
const LIMIT: Duration = Duration::from_secs(600);

/// Instructions by stage.
pub type Costs = [u64; Stage::ALL.len()];

/// Result and cost of a pair on a board.
#[derive(Clone, Debug, Default)]
pub struct BoardResult {
    pub result: FrameResult,
    /// Cost of rectifying both images; 0 for a pair that was rectified before.
    pub rectification: u64,
    /// Cost of matching, by stage.
    pub costs: Costs,
    /// Depths of the objects that were asked for.
    pub objects: Vec<ObjectRecord>,
    /// Cost of those depths, on top.
    pub objects_cost: u64,
    /// Cost of making each point of the list once, on top.
    pub points_cost: u64,
}

/// Results of a list of pairs on a board.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// One entry per pair: its result, or why the board refused it. Other commands that it refused
    /// stand between them.
    pub pairs: Vec<Result<BoardResult, Refusal>>,
    /// Last report of the board on its rig, if it was asked to describe itself.
    pub rig: Option<RigReport>,
    pub bad_packets: u32,
    /// Largest depth of the board's stack in bytes.
    pub stack: u64,
}

/// A board with its firmware, ready to run.
#[derive(Clone, Debug)]
pub struct Machine {
    board: Board,
    elf: PathBuf,
}

/// The update that gives a board these parameters. A rig cannot be read out of them: its numbers
/// come beside.
pub fn update(params: &Params, rig: Option<RigUpdate>) -> ParamUpdate {
    ParamUpdate {
        min_disparity: Some(params.min_disparity),
        max_disparity: Some(params.max_disparity),
        anchor_gradient: Some(params.anchor_gradient),
        edge_gradient: Some(params.edge_gradient),
        min_extent: Some(params.min_extent),
        cell: Some(params.cell),
        margin: Some(params.margin),
        min_confidence: Some(params.min_confidence),
        reach: Some(params.reach),
        parts: Some(params.parts),
        rig,
    }
}

impl Machine {
    /// Builds the firmware of a board.
    pub fn new(board: Board) -> Result<Self> {
        let toolchain = Toolchain::for_board(&board)?;
        // Without logs: what is measured is what is shipped.
        Ok(Self { board, elf: firmware::build(&toolchain, &board, "replay", Logs::None)? })
    }

    pub fn board(&self) -> &Board {
        &self.board
    }

    /// Matches pairs on the board, all with the same parameters.
    pub fn run_pairs(
        &self,
        update: &ParamUpdate,
        pairs: &[(&GrayImage, &GrayImage)],
    ) -> Result<Replayed> {
        self.run(None, update, [], pairs)
    }

    /// Rectifies raw pairs on the board with this rig and matches them. The board has no flash: it
    /// forgets the rig.
    pub fn run_raw_pairs(
        &self,
        rig: &RigImage,
        update: &ParamUpdate,
        pairs: &[(&GrayImage, &GrayImage)],
    ) -> Result<Replayed> {
        self.run(Some(rig), update, [], pairs)
    }

    /// Matches pairs on the board and asks for the depths of these objects; each pair with regions
    /// of its own. Where they are to be looked at only, the first pair is matched as a whole: it
    /// tells how far the rows are apart.
    pub fn run_pairs_with_objects(
        &self,
        update: &ParamUpdate,
        pairs: &[(&GrayImage, &GrayImage, Regions)],
    ) -> Result<Replayed> {
        let mut input = Vec::new();
        push(&mut input, &Command { id: 0, request: Request::SetParams(*update) })?;
        for (number, (left, right, regions)) in pairs.iter().enumerate() {
            push(&mut input, &Command { id: 0, request: Request::SetRegions(regions.clone()) })?;
            push_pair(&mut input, id_of(number), left, right)?;
        }
        let (answers, replayed) = self.replay(&input)?;
        for (_, outcome) in answers {
            if let Outcome::Refused(why) = outcome {
                bail!("{} refused a request: {why}", self.board.name);
            }
        }
        Ok(replayed)
    }

    /// Matches pairs after further requests; raw ones with a rig.
    pub fn run(
        &self,
        rig: Option<&RigImage>,
        update: &ParamUpdate,
        requests: impl IntoIterator<Item = Request>,
        pairs: &[(&GrayImage, &GrayImage)],
    ) -> Result<Replayed> {
        let set_rig = rig.map(|rig| Request::SetRig(rig.encode(0).into_iter().collect()));
        let settings = set_rig.into_iter().chain([Request::SetParams(*update)]).chain(requests);
        let (mut input, mut requested) = (Vec::new(), 0);
        for request in settings {
            push(&mut input, &Command { id: 0, request })?;
            requested += 1;
        }
        let push = if rig.is_some() { push_raw_pair } else { push_pair };
        for (number, (left, right)) in pairs.iter().enumerate() {
            push(&mut input, id_of(number), left, right)?;
        }
        let (answers, replayed) = self.replay(&input)?;
        for number in 0..requested {
            match answers.get(number) {
                Some((0, Outcome::Accepted)) => {}
                Some((0, Outcome::Refused(why))) => {
                    bail!("{} refused a request: {why}", self.board.name)
                }
                _ => bail!("{} does not answer", self.board.name),
            }
        }
        if replayed.pairs.len() != pairs.len() {
            let (sent, answered) = (pairs.len(), replayed.pairs.len());
            bail!("{sent} pairs were sent to {}, {answered} were answered", self.board.name);
        }
        Ok(replayed)
    }

    /// Feeds the board with these bytes. Gives what became of the commands that it accepted and
    /// that are no pairs, and the rest.
    pub fn replay(&self, input: &[u8]) -> Result<(Vec<(u16, Outcome)>, Replayed)> {
        self.replay_with(input, None)
    }

    /// The same on a board with flash: what is in it, and after the run what is in it then.
    pub fn replay_with(
        &self,
        input: &[u8],
        flash: Option<&mut Vec<u8>>,
    ) -> Result<(Vec<(u16, Outcome)>, Replayed)> {
        let folder = tempfile::tempdir()?;
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("input"), input)?;
        let mut arguments = vec!["input", "output", "table"];
        if let Some(flash) = &flash {
            std::fs::write(at("flash"), flash)?;
            arguments.push("flash");
        }
        qemu::run(&self.board, &self.elf, &arguments, folder.path(), LIMIT)?
            .success("replay", &self.board)?;
        if let Some(flash) = flash {
            *flash = untrusted::read(&at("flash"), RESULT_BYTES)?;
        }
        let table = untrusted::read_text(&at("table"), RESULT_BYTES)?;
        let output = untrusted::read(&at("output"), RESULT_BYTES)?;
        collect(&output, &table)
            .with_context(|| format!("what {} answered cannot be used", self.board.name))
    }
}

/// Names and pairs of every captured scene below a folder: reduced to the width of `dims`, and of
/// that as many rows from the middle as `dims` has. Scenes that are smaller are left out.
pub fn captured(folder: &Path, dims: Dims) -> Result<Vec<(String, (GrayImage, GrayImage))>> {
    let mut list = Vec::new();
    for path in find_scenes(folder)? {
        let name =
            path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let scene = load_scene(&path, Some(dims.width)).with_context(|| format!("scene {name}"))?;
        if scene.left.dims.height >= dims.height {
            list.push((name, (middle(&scene.left, dims), middle(&scene.right, dims))));
        }
    }
    Ok(list)
}

/// Rows from the middle of an image.
fn middle(image: &GrayImage, dims: Dims) -> GrayImage {
    let width = usize::from(dims.width);
    let first = usize::from(image.dims.height - dims.height) / 2;
    let rows = image.pixels.chunks(width).skip(first).take(dims.height.into());
    GrayImage { dims, pixels: rows.flatten().copied().collect() }
}

/// The id of the command that sends pair number `n`; ids wrap.
fn id_of(number: usize) -> u16 {
    (number % usize::from(u16::MAX)) as u16 + 1
}

/// Puts a command behind what is there. The delimiter before it ends whatever came before, pixels
/// as well.
pub fn push(input: &mut Vec<u8>, command: &Command) -> Result<()> {
    input.push(DELIMITER);
    input.extend_from_slice(encode(command, &mut [0; MAX_COMMAND])?);
    Ok(())
}

/// A rectified pair: the command, then both images as they are.
pub fn push_pair(input: &mut Vec<u8>, id: u16, left: &GrayImage, right: &GrayImage) -> Result<()> {
    push(input, &Command { id, request: Request::Pair(head_of(id, left)) })?;
    input.extend_from_slice(&left.pixels);
    input.extend_from_slice(&right.pixels);
    Ok(())
}

/// A raw pair: the command, then the rows of both images in turn.
pub fn push_raw_pair(
    input: &mut Vec<u8>,
    id: u16,
    left: &GrayImage,
    right: &GrayImage,
) -> Result<()> {
    push(input, &Command { id, request: Request::RawPair(head_of(id, left)) })?;
    let [left, right] = [left, right].map(|image| image.pixels.chunks(image.dims.width.into()));
    for (left, right) in left.zip(right) {
        input.extend_from_slice(left);
        input.extend_from_slice(right);
    }
    Ok(())
}

fn head_of(id: u16, image: &GrayImage) -> PairHead {
    let Dims { width, height } = image.dims;
    PairHead { width, height, capture_time_us: id.into(), right_capture_time_us: None }
}

/// Puts messages and costs together.
fn collect(output: &[u8], table: &str) -> Result<(Vec<(u16, Outcome)>, Replayed)> {
    let mut decoder: Decoder<Message, MAX_PACKET> = Decoder::new();
    let (mut answers, mut frame) = (Vec::new(), None);
    let mut replayed = Replayed { pairs: Vec::new(), rig: None, bad_packets: 0, stack: 0 };
    for &byte in output {
        let Some(message) = decoder.push(byte) else { continue };
        match message? {
            Message::Hello(hello) => replayed.rig = Some(hello.rig),
            Message::Photo(_) | Message::Pixels(_) => {
                bail!("a board that is fed by a file sent a photo")
            }
            Message::Capture(lost) => bail!("a board that is fed by a file lost {lost}"),
            Message::Machine(_) | Message::Case(_) => {
                bail!("a board that is fed by a file ran a built-in pair")
            }
            Message::Setting(_) | Message::Kept(_) | Message::Clock(_) | Message::Sectors(_) => {
                bail!("nobody asked the board for settings, its time or sectors")
            }
            Message::Frame(head) => {
                let FrameHead { counts, health, pair, .. } = head;
                let result = FrameResult { counts, health, pair, ..FrameResult::default() };
                frame = Some(BoardResult { result, ..BoardResult::default() });
            }
            Message::Segments(segments) => {
                let frame = frame.as_mut().context("segments without a frame")?;
                frame.result.matches.extend(segments.list);
            }
            Message::Points(points) => {
                let frame = frame.as_mut().context("points without a frame")?;
                frame.result.points.extend(points.list);
            }
            Message::Objects(objects) => {
                let frame = frame.as_mut().context("objects without a frame")?;
                frame.objects.extend(&objects.list);
            }
            Message::Answer(answer) => match (frame.take(), answer.outcome) {
                (Some(frame), Outcome::Accepted) => replayed.pairs.push(Ok(frame)),
                (None, Outcome::Refused(why)) if answer.command > 0 => {
                    replayed.pairs.push(Err(why))
                }
                (_, outcome) => answers.push((answer.command, outcome)),
            },
        }
    }
    if let Some(error) = decoder.finish() {
        bail!("the last message: {error}");
    }
    let mut matched = replayed.pairs.iter_mut().filter_map(|pair| pair.as_mut().ok());
    for line in table.lines() {
        match line.split('\t').collect::<Vec<_>>()[..] {
            ["pair", _, rectification, objects, points, ref costs @ ..] => {
                let costs: Vec<u64> =
                    costs.iter().map(|cost| cost.parse()).collect::<Result<_, _>>()?;
                let pair = matched.next().context("costs of an unknown pair")?;
                pair.rectification = rectification.parse()?;
                pair.objects_cost = objects.parse()?;
                pair.points_cost = points.parse()?;
                pair.costs = costs.try_into().ok().context("too few costs")?;
            }
            ["packets", _, bad, _] => replayed.bad_packets = bad.parse()?,
            ["stack", bytes] => replayed.stack = bytes.parse()?,
            _ => bail!("an unknown line of its table: {line}"),
        }
    }
    Ok((answers, replayed))
}
