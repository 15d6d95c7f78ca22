//! `linestereo compare`: the core, the classic methods and OpenCV on the same frames.

use super::batch::{BatchArgs, collect, write_part};
use super::method::MethodArgs;
use super::pairs::{for_each_pair, timed_bar};
use super::{asked_for, engine_with};
use crate::draw;
use crate::engine::{Engine, FrameResult};
use crate::evaluate::{ShardFile, ShardHead};
use crate::output::{OutputFiles, OutputPath, spare};
use crate::rivals::{
    CORE, Contender, MethodScore, MethodSummary, OpenCv, cell_comparison, compare_scene, comparison_table,
    object_comparison, summarise, time_scene,
};
use anyhow::{Context, Result, bail};
use linestereo_baselines::{Acceptance, AfterStep, BlockMatcher, CostKind, Fraction, Matcher, Method, Shape, Window};
use linestereo_calibration::rectify_raw;
use linestereo_frames::{
    GrayImage, PairFiles, Scene, StoredPair, area_average, check_same_size, check_size, check_usable, load_images,
};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Disparity range of two image files.
const DEFAULT_MAX_DISPARITY: u16 = 64;
/// Compared when nothing else is asked for.
const USUAL: [&str; 11] =
    [CORE, "bm", "bm-strict", "sad", "census", "scan-line", "sgm4", "sgm8", "sgm8-strict", "sparse-block", "pushbroom"];

const EXAMPLES: &str = "\
Examples:
  linestereo compare left.png right.png --picture maps.png       maps side by side
  linestereo compare frames/qvga --opencv                        with OpenCV's StereoBM and StereoSGBM
  linestereo compare frames/qvga --methods linestereo,census,ncc --window 9x9
  linestereo compare frames/qvga --after-steps                   what each after-step does to the scores
  linestereo compare frames/qvga --methods sad --left-right 1 --after speckle,median
  linestereo compare sets --no-times --shard 3/16 --json part3.json   a sixteenth, on one of 16 machines
  linestereo compare --merge part*.json                          all parts: the same bytes as without --shard

Methods:
  linestereo       the core: answers of p >= 0.9
  bm, bm-strict    block matching, OpenCV's StereoBM number for number; strict: uniqueness 90, texture 3000
  ssd sad ncc normalised-ssd normalised-sad rank census gradient    block matching by this cost, window 15x15
  scan-line        dynamic programming along rows with occlusion
  sgm4 sgm8 sgm8-strict    semi-global, 4 or 8 paths, census 5x5; strict: uniqueness 80
  sparse-block     TU Delft's stereo board: 5x5 at peaks of the gradient
  pushbroom        one disparity alone, half of the range or --pushbroom
  all              every one of them

Columns:
  points, cells    answers a frame; % of 16x16 cells (those at least half visible truth) with one
  vis, allGT       % of answers more than 1 / 2 px off: visible ones; all with truth
  top N            allGT of the N most confident answers a frame; confidence of a baseline is its uniqueness,
                   1 - cost / cost of the best place elsewhere. OpenCV tells none.
  ms               median time of a pair on one thread, with nothing else running";

/// Match the same frames by several methods: scores, times and pictures side by side.
///
/// Give two rectified images, or folders of any layout with ground truth: those are matched on all cores.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Two rectified images, or folders to search for pairs, at any depth and in any layout.
    #[arg(required_unless_present = "merge", conflicts_with = "merge", value_name = "LEFT RIGHT | FOLDER")]
    inputs: Vec<PathBuf>,
    /// Methods to compare, or "all".
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    methods: Vec<String>,
    /// Add OpenCV's StereoBM and StereoSGBM, where a Python with OpenCV is installed.
    #[arg(long)]
    opencv: bool,
    /// The Python that has OpenCV [default: $LINESTEREO_PYTHON, else python3].
    #[arg(long, value_name = "PROGRAM", requires = "opencv")]
    python: Option<PathBuf>,
    /// Compare the after-steps in place of the methods: each one alone on block matching by census.
    #[arg(long, conflicts_with = "methods")]
    after_steps: bool,
    /// Window of block matching by any cost, scan-line and sgm.
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = parse_window)]
    window: Option<(usize, usize)>,
    /// Windows are crosses in place of rectangles.
    #[arg(long, requires = "window")]
    cross: bool,
    /// Steps after every baseline: gradient-descent, speckle, median, fill-surface, fill-neighbours.
    #[arg(long, value_name = "STEP,...", value_delimiter = ',', value_parser = parse_step)]
    after: Vec<AfterStep>,
    /// Least confidence of block matching by any cost, scan-line and sgm, 0 to 1.
    #[arg(long, value_name = "C")]
    least_confidence: Option<f32>,
    /// Drop what the right image matches more than this far away, in block matching by any cost and sgm.
    #[arg(long, value_name = "PX")]
    left_right: Option<u32>,
    /// The disparity of pushbroom stereo.
    #[arg(long, value_name = "PX")]
    pushbroom: Option<u16>,
    /// Draw all maps side by side; scenes beyond the first 16 are not drawn.
    #[arg(long, value_name = "FILE.png", conflicts_with_all = ["shard", "merge"])]
    picture: Option<OutputPath>,
    /// Write the scores as JSON to FILE, or to stdout in place of the tables with "-".
    #[arg(long, value_name = "FILE")]
    json: Option<OutputPath>,
    /// Reduce images to this width by area averaging; truth, range and rig follow.
    #[arg(long, value_name = "PX")]
    width: Option<u16>,
    /// Search disparities 0 .. N [default: the data set's, 64 for two images].
    #[arg(long, value_name = "N")]
    max_disparity: Option<u16>,
    /// Leave the times out. They are measured one pair after the other, when all others are done, and differ from run to run.
    #[arg(long)]
    no_times: bool,
    #[command(flatten)]
    batch: BatchArgs,
    #[command(flatten)]
    method: MethodArgs,
}

/// Scenes in the picture.
const DRAWN: usize = 16;

#[derive(Serialize)]
struct JsonReport {
    frames: usize,
    methods: Vec<MethodSummary>,
    scenes: Vec<JsonScene>,
}

#[derive(Serialize)]
struct JsonScene {
    scene: String,
    methods: Vec<MethodSummary>,
}

/// Results of every method for one pair.
#[derive(Serialize, Deserialize)]
struct Compared {
    name: String,
    methods: Vec<MethodScore>,
    /// Left image and range, for the picture.
    #[serde(skip)]
    drawn: Option<(GrayImage, u16)>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    if !args.batch.merge.is_empty() {
        let (head, compared) = ShardFile::merge(&args.batch.merge)?;
        return args.write(compared, &head.notes);
    }
    let contenders = if args.after_steps { after_steps() } else { args.contenders()? };
    let mut notes = Vec::new();
    let opencv = args.opencv(&mut notes)?;
    let rivals = Rivals { args, contenders, opencv };
    if let [left, right] = args.inputs.as_slice()
        && left.is_file()
        && right.is_file()
    {
        let scene = args.load_pair(left, right)?;
        let mut compared = rivals.compare(&scene, true)?;
        rivals.time(&scene, &mut compared)?;
        return args.write(vec![compared], &notes);
    }
    // Without any truth there are still yields, times and pictures.
    let found = collect(&args.inputs, false)?;
    spare(asked_for([&args.json, &args.picture]), found.pairs.iter().flat_map(StoredPair::files))?;
    notes.splice(..0, found.notes);
    let head = ShardHead::new("compare", args.words(), found.pairs.iter().map(|pair| pair.name.as_str()), notes);
    let (places, pairs) = args.batch.part(found.pairs);
    let pairs: Vec<(usize, StoredPair)> = pairs.into_iter().enumerate().collect();
    let name = |(_, pair): &(usize, StoredPair)| pair.name.clone();
    let mut compared = for_each_pair(&pairs, args.batch.threads(), name, |(place, pair)| {
        rivals.compare(&args.load(pair)?, args.picture.is_some() && *place < DRAWN)
    })?;
    if !args.no_times {
        let progress = timed_bar(pairs.len());
        for ((_, pair), compared) in pairs.iter().zip(&mut compared) {
            progress.set_message(format!("timing {}", pair.name));
            rivals.time(&args.load(pair)?, compared)?;
            progress.inc(1);
        }
        progress.finish_and_clear();
    }
    match args.batch.shard {
        Some(shard) => {
            let count = compared.len();
            write_part(
                &ShardFile::new(head, shard, places.into_iter().zip(compared).collect()),
                args.json.as_ref(),
                shard,
                count,
            )
        }
        None => args.write(compared, &head.notes),
    }
}

/// Everything that matches.
struct Rivals<'a> {
    args: &'a Args,
    contenders: Vec<Contender>,
    opencv: Option<OpenCv>,
}

impl Rivals<'_> {
    fn engine(&self, scene: &Scene) -> Result<Engine> {
        engine_with(&self.args.method.params(scene.max_disparity, scene.rig)?, scene.left.dims)
            .with_context(|| scene.name.clone())
    }

    fn compare(&self, scene: &Scene, draw: bool) -> Result<Compared> {
        let mut methods = compare_scene(scene, &self.contenders, self.opencv.as_ref(), |scene| self.engine(scene))?;
        if !draw {
            methods.iter_mut().for_each(|score| score.result = None);
        }
        let drawn = draw.then(|| (scene.left.clone(), scene.max_disparity));
        Ok(Compared { name: scene.name.clone(), methods, drawn })
    }

    fn time(&self, scene: &Scene, compared: &mut Compared) -> Result<()> {
        if self.args.no_times {
            return Ok(());
        }
        let times = time_scene(scene, &self.contenders, self.opencv.as_ref(), |scene| self.engine(scene))?;
        for (score, milliseconds) in compared.methods.iter_mut().zip(times) {
            score.score.milliseconds = Some(milliseconds);
        }
        Ok(())
    }
}

impl Args {
    fn contenders(&self) -> Result<Vec<Contender>> {
        let known = Method::all();
        let names: Vec<&str> = match self.methods.as_slice() {
            [] => USUAL.to_vec(),
            [all] if all == "all" => [CORE].into_iter().chain(known.iter().map(|m| m.name.as_str())).collect(),
            names => names.iter().map(String::as_str).collect(),
        };
        names
            .into_iter()
            .map(|name| {
                if name == CORE {
                    return Ok(Contender::Core);
                }
                let method = known.iter().find(|method| method.name == name);
                let method = method.with_context(|| {
                    let all: Vec<&str> = known.iter().map(|method| method.name.as_str()).collect();
                    format!("there is no method {name}; give {CORE}, {} or all", all.join(", "))
                })?;
                self.changed(method.clone()).map(Contender::Baseline)
            })
            .collect()
    }

    /// The method with what the options change.
    fn changed(&self, mut method: Method) -> Result<Method> {
        if let Some((columns, rows)) = self.window {
            let shape = if self.cross { Shape::Cross } else { Shape::Rectangle };
            method = method.with_window(Window::new(columns, rows, shape));
        }
        if let Some(least) = self.least_confidence
            && !(0.0..=1.0).contains(&least)
        {
            bail!("--least-confidence is {least}; give 0 to 1");
        }
        let change = |acceptance: &mut Acceptance| {
            acceptance.least_confidence = self.least_confidence.unwrap_or(acceptance.least_confidence);
            acceptance.left_right = self.left_right.or(acceptance.left_right);
        };
        match &mut method.matcher {
            Matcher::Block(matcher) => change(&mut matcher.acceptance),
            Matcher::SemiGlobal(matcher) => change(&mut matcher.acceptance),
            Matcher::ScanLine(matcher) => {
                matcher.least_confidence = self.least_confidence.unwrap_or(matcher.least_confidence);
            }
            Matcher::Pushbroom(disparity) => *disparity = self.pushbroom,
            Matcher::StereoBm(_) | Matcher::SparseBlock(_) => {}
        }
        method.after.clone_from(&self.after);
        Ok(method)
    }

    /// OpenCV if it is asked for; what is to be said of it joins the notes.
    fn opencv(&self, notes: &mut Vec<String>) -> Result<Option<OpenCv>> {
        if !self.opencv {
            return Ok(None);
        }
        match OpenCv::find(self.python.as_deref()) {
            Ok(opencv) => {
                notes.push(format!("OpenCV {}", opencv.version()));
                Ok(Some(opencv))
            }
            // A part without it would not fit the others.
            Err(error) if self.batch.shard.is_some() => Err(error.into()),
            Err(error) => {
                notes.push(format!("without OpenCV: {error}"));
                Ok(None)
            }
        }
    }

    /// Every option that changes a result.
    fn words(&self) -> String {
        let Self { methods, after_steps, window, cross, after, least_confidence, left_right, pushbroom, .. } = self;
        let Self { opencv, width, max_disparity, no_times, method, .. } = self;
        format!(
            "methods {methods:?}, after-steps {after_steps}, window {window:?}, cross {cross}, after {after:?}, \
             least confidence {least_confidence:?}, left-right {left_right:?}, pushbroom {pushbroom:?}, opencv {opencv}, \
             width {width:?}, range {max_disparity:?}, no times {no_times}, {method:?}"
        )
    }

    /// The scene as it is to be matched.
    fn load(&self, pair: &StoredPair) -> Result<Scene> {
        let mut scene = pair.load(self.width, &rectify_raw)?;
        check_usable(&scene.folder.join("left"), &scene.left)?;
        check_usable(&scene.folder.join("right"), &scene.right)?;
        scene.max_disparity = self.range(&scene)?;
        Ok(scene)
    }

    fn range(&self, scene: &Scene) -> Result<u16> {
        let (range, dims) = (self.max_disparity.unwrap_or(scene.max_disparity), scene.left.dims);
        if range == 0 || range >= dims.width {
            bail!("a disparity range of {range} does not fit an image of {dims}; change --max-disparity");
        }
        Ok(range)
    }

    fn load_pair(&self, left_path: &Path, right_path: &Path) -> Result<Scene> {
        let files = PairFiles::Two([left_path, right_path].map(Path::to_path_buf));
        let [left, right] = load_images(&files, None)?;
        check_same_size((left_path, left.dims), (right_path, right.dims))?;
        let reduced = |image| self.width.map_or_else(|| Ok(Clone::clone(&image)), |width| area_average(&image, width));
        let (left, right) = (reduced(left)?, reduced(right)?);
        for (path, image) in [(left_path, &left), (right_path, &right)] {
            check_size(path, image)?;
            check_usable(path, image)?;
        }
        let mut scene = Scene {
            name: left_path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
            folder: left_path.parent().unwrap_or(Path::new("")).to_path_buf(),
            left,
            right,
            max_disparity: DEFAULT_MAX_DISPARITY,
            rig: None,
            rig_numbers: None,
            truth: None,
        };
        scene.max_disparity = self.range(&scene)?;
        Ok(scene)
    }

    fn write(&self, compared: Vec<Compared>, notes: &[String]) -> Result<()> {
        let methods = summarise(compared.iter().map(|compared| compared.methods.as_slice()));
        let count = compared.len();
        let mut text =
            format!("{count} {}\n\n{}", if count == 1 { "pair" } else { "pairs" }, comparison_table(&methods));
        text.push('\n');
        text.push_str(&cell_comparison(&methods));
        let objects = object_comparison(&methods);
        if !objects.is_empty() {
            text.push_str(&format!("\n{objects}"));
        }
        for note in notes {
            text.push_str(&format!("\n{note}\n"));
        }
        let mut output = OutputFiles::new();
        if let Some(path) = &self.picture {
            output.add(path, &draw::png(&picture(&compared))?)?;
        }
        let scene = |Compared { name, methods, .. }: &Compared| JsonScene {
            scene: name.clone(),
            methods: summarise([methods.as_slice()]),
        };
        let report = JsonReport { frames: count, methods, scenes: compared.iter().map(scene).collect() };
        output.add_json(self.json.as_ref(), &report)?;
        output.commit_and_say(&text)
    }
}

/// Block matching by census, as it comes and with each after-step alone; those that fill need gaps first.
fn after_steps() -> Vec<Contender> {
    let block = |name: &str, acceptance: Acceptance, after: &[AfterStep]| {
        let matcher = Matcher::Block(BlockMatcher { cost: CostKind::Census, window: Window::square(9), acceptance });
        Contender::Baseline(Method { name: name.to_owned(), matcher, after: after.to_vec() })
    };
    let plain = Acceptance { fraction: Fraction::None, ..Acceptance::default() };
    let checked = Acceptance { left_right: Some(1), ..plain };
    let all = Acceptance { left_right: Some(1), least_confidence: 0.1, fraction: Fraction::Equiangular };
    let (parabola, equiangular) = (Fraction::Parabola, Fraction::Equiangular);
    vec![
        block("whole disparities", plain, &[]),
        block("+ parabola", Acceptance { fraction: parabola, ..plain }, &[]),
        block("+ equiangular", Acceptance { fraction: equiangular, ..plain }, &[]),
        block("+ gradient descent", plain, &[AfterStep::GradientDescent]),
        block("+ median", plain, &[AfterStep::Median]),
        block("+ speckle removal", plain, &[AfterStep::Speckle]),
        block("+ uniqueness 0.1", Acceptance { least_confidence: 0.1, ..plain }, &[]),
        block("+ uniqueness 0.3", Acceptance { least_confidence: 0.3, ..plain }, &[]),
        block("+ left-right", checked, &[]),
        block("+ left-right, filled from neighbours", checked, &[AfterStep::FillNeighbours]),
        block("+ left-right, filled by surfaces", checked, &[AfterStep::FillSurface]),
        block("left-right, unique, equiangular, speckle, median", all, &[AfterStep::Speckle, AfterStep::Median]),
        block(
            "the same, filled by surfaces, then neighbours",
            all,
            &[AfterStep::Speckle, AfterStep::Median, AfterStep::FillSurface, AfterStep::FillNeighbours],
        ),
    ]
}

fn picture(compared: &[Compared]) -> image::RgbImage {
    let maps = |compared: &Compared| -> Vec<(String, FrameResult)> {
        let drawn = compared.methods.iter().filter_map(|score| Some((score.method.clone(), score.result.clone()?)));
        drawn.collect()
    };
    let scenes: Vec<draw::SceneMaps<'_>> = compared
        .iter()
        .filter_map(|compared| {
            let (left, max_disparity) = compared.drawn.as_ref()?;
            Some(draw::SceneMaps { name: &compared.name, left, max_disparity: *max_disparity, maps: maps(compared) })
        })
        .collect();
    draw::maps(&scenes)
}

fn parse_window(text: &str) -> Result<(usize, usize), String> {
    let sides = text.split_once('x').and_then(|(columns, rows)| Some((columns.parse().ok()?, rows.parse().ok()?)));
    let odd = |side: usize| side % 2 == 1 && side <= 63;
    sides
        .filter(|&(columns, rows)| odd(columns) && odd(rows))
        .ok_or("give two odd sides of up to 63, such as 9x5".into())
}

fn parse_step(text: &str) -> Result<AfterStep, String> {
    let names: Vec<&str> = AfterStep::ALL.iter().map(|step| step.name()).collect();
    let step = AfterStep::ALL.into_iter().find(|step| step.name() == text);
    step.ok_or_else(|| format!("there is no step {text}; give {}", names.join(", ")))
}
