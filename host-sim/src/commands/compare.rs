//! `linestereo compare`: the core, the classic methods and OpenCV on the same frames.

use super::batch::{BatchArgs, collect};
use super::method::MethodArgs;
use super::{engine_with, print};
use crate::baselines::{Acceptance, AfterStep, BlockMatcher, CostKind, Fraction, Matcher, Method, Shape, Window};
use crate::compare::{
    CORE, Contender, MethodScore, MethodSummary, OpenCv, compare_scene, comparison_table, object_comparison, summarise,
};
use crate::draw;
use crate::engine::FrameResult;
use crate::evaluate::{ShardFile, ShardHead, for_each_pair};
use crate::frames::{Scene, StoredPair, area_average, check_same_size, check_size, check_usable, load_gray};
use crate::output::OutputFiles;
use anyhow::{Context, Result, anyhow, bail};
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
  linestereo compare kitti/training --width 640 --no-times --shard 3/16 --json part3.json   a part; docs/scale.md
  linestereo compare --merge part*.json                          all parts: the same bytes as without --shard

Methods:
  linestereo       the core: claims of p >= 0.9
  bm, bm-strict    block matching, OpenCV's StereoBM number for number; strict: uniqueness 90, texture 3000
  ssd sad ncc normalised-ssd normalised-sad rank census gradient    block matching by this cost, window 15x15
  scan-line        dynamic programming along rows with occlusion
  sgm4 sgm8 sgm8-strict    semi-global, 4 or 8 paths, census 5x5; strict: uniqueness 80
  sparse-block     TU Delft's stereo board: 5x5 at peaks of the gradient
  pushbroom        one disparity alone, half of the range or --pushbroom
  all              every one of them

Columns:
  points, cells    claims a frame; % of 16x16 cells (those at least half visible truth) with one
  vis, allGT       % of claims more than 1 / 2 px off: visible ones; all with truth
  top N            allGT of the N most confident claims a frame; confidence of a baseline is its uniqueness,
                   1 - cost / cost of the best place elsewhere. OpenCV tells none.
  ms               median time of a pair on one thread, while other threads match other pairs";

/// Match the same frames by several methods: scores, times and pictures side by side.
///
/// One pair per thread, on all cores.
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
    picture: Option<PathBuf>,
    /// Write the scores as JSON to FILE, or to stdout in place of the tables with "-".
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Reduce images to this width by area averaging; truth, range and rig follow.
    #[arg(long, value_name = "PX")]
    width: Option<u16>,
    /// Search disparities 0 .. N [default: the scene file's, 64 for two images].
    #[arg(long, value_name = "N")]
    max_disparity: Option<u16>,
    /// Match every pair once and leave the times out: they differ from run to run.
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

/// What is matched: a pair of files, or one of a data set.
enum Source {
    Files(PathBuf, PathBuf),
    Stored(StoredPair),
}

impl Source {
    fn name(&self) -> String {
        match self {
            Self::Files(left, _) => {
                left.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
            }
            Self::Stored(pair) => pair.name.clone(),
        }
    }
}

/// A scene with what every method made of it.
#[derive(Serialize, Deserialize)]
struct Compared {
    name: String,
    scores: Vec<MethodScore>,
    /// For a picture.
    #[serde(skip)]
    scene: Option<Scene>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    if !args.batch.merge.is_empty() {
        let (head, compared) = ShardFile::merge(&args.batch.merge)?;
        return args.write(&compared, &head);
    }
    let contenders = if args.after_steps { after_steps() } else { args.contenders()? };
    let opencv = if args.opencv { Some(OpenCv::find(args.python.as_deref())) } else { None };
    let (sources, mut notes) = args.sources()?;
    match &opencv {
        Some(Ok(opencv)) => notes.push(format!("OpenCV {}", opencv.version())),
        Some(Err(error)) => notes.push(format!("without OpenCV: {error}")),
        None => {}
    }
    let opencv = opencv.and_then(Result::ok);
    let names: Vec<String> = sources.iter().map(Source::name).collect();
    let head = ShardHead::new("compare", args.options(), names.iter().map(String::as_str), notes);
    let (places, sources) = args.batch.part(sources);
    let items: Vec<(usize, Source)> = sources.into_iter().enumerate().collect();
    let name = |(_, source): &(usize, Source)| source.name();
    let compared = for_each_pair(&items, args.batch.threads(), name, |(index, source)| {
        let is_drawn = args.picture.is_some() && *index < DRAWN;
        args.compare(source, &contenders, opencv.as_ref(), is_drawn)
    })?;
    match args.batch.shard {
        Some(shard) => {
            let count = compared.len();
            let file = ShardFile::new(head, shard, places.into_iter().zip(compared).collect());
            super::batch::write_part(&file, args.json.as_deref(), shard, count)
        }
        None => args.write(&compared, &head),
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

    /// Every option that changes a result.
    fn options(&self) -> String {
        let Self { methods, opencv, after_steps, window, cross, after, least_confidence, left_right, .. } = self;
        let Self { pushbroom, width, max_disparity, no_times, method, .. } = self;
        format!(
            "{methods:?}, OpenCV {opencv}, after-steps {after_steps}, {window:?}, {cross}, {after:?}, {least_confidence:?}, {left_right:?}, \
             {pushbroom:?}, {width:?}, {max_disparity:?}, no times {no_times}, {method:?}"
        )
    }

    /// What is matched, and what there is to say of it.
    fn sources(&self) -> Result<(Vec<Source>, Vec<String>)> {
        if let [left, right] = self.inputs.as_slice()
            && left.is_file()
            && right.is_file()
        {
            return Ok((vec![Source::Files(left.clone(), right.clone())], Vec::new()));
        }
        // Without any truth there are still yields, times and pictures.
        let found = collect(&self.inputs, false)?;
        Ok((found.pairs.into_iter().map(Source::Stored).collect(), found.notes))
    }

    fn compare(
        &self,
        source: &Source,
        contenders: &[Contender],
        opencv: Option<&OpenCv>,
        is_drawn: bool,
    ) -> Result<Compared> {
        let scene = self.load(source)?;
        let engine = |scene: &Scene| {
            engine_with(&self.method.params(scene.max_disparity, scene.rig)?, scene.left.dims)
                .with_context(|| scene.name.clone())
        };
        let mut scores = compare_scene(&scene, contenders, opencv, !self.no_times, engine)?;
        if !is_drawn {
            scores.iter_mut().for_each(|score| score.result.points = Vec::new());
        }
        Ok(Compared { name: scene.name.clone(), scores, scene: is_drawn.then_some(scene) })
    }

    fn load(&self, source: &Source) -> Result<Scene> {
        let mut scene = match source {
            Source::Files(left, right) => self.load_pair(left, right)?,
            Source::Stored(pair) => {
                let scene = pair.load(self.width)?;
                check_usable(&pair.folder.join("left"), &scene.left)?;
                check_usable(&pair.folder.join("right"), &scene.right)?;
                scene
            }
        };
        scene.max_disparity = self.max_disparity.unwrap_or(scene.max_disparity);
        if scene.max_disparity == 0 || scene.max_disparity >= scene.left.dims.width {
            let (range, dims) = (scene.max_disparity, scene.left.dims);
            return Err(anyhow!(
                "a disparity range of {range} does not fit an image of {dims}; change --max-disparity"
            ));
        }
        Ok(scene)
    }

    fn load_pair(&self, left_path: &Path, right_path: &Path) -> Result<Scene> {
        let (left, right) = (load_gray(left_path)?, load_gray(right_path)?);
        check_same_size((left_path, left.dims), (right_path, right.dims))?;
        let reduced = |image| self.width.map_or_else(|| Ok(Clone::clone(&image)), |width| area_average(&image, width));
        let (left, right) = (reduced(left)?, reduced(right)?);
        for (path, image) in [(left_path, &left), (right_path, &right)] {
            check_size(path, image)?;
            check_usable(path, image)?;
        }
        Ok(Scene {
            name: left_path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
            folder: left_path.parent().unwrap_or(Path::new("")).to_path_buf(),
            left,
            right,
            max_disparity: DEFAULT_MAX_DISPARITY,
            rig: None,
            rig_numbers: None,
            truth: None,
        })
    }

    /// Tables and JSON; of merged parts the same as of everything at once.
    fn write(&self, compared: &[Compared], head: &ShardHead) -> Result<()> {
        let frames: Vec<Vec<MethodScore>> = compared.iter().map(|compared| compared.scores.clone()).collect();
        let methods = summarise(&frames);
        let count = frames.len();
        let mut text =
            format!("{count} {}\n\n{}", if count == 1 { "pair" } else { "pairs" }, comparison_table(&methods));
        let objects = object_comparison(&methods);
        if !objects.is_empty() {
            text.push_str(&format!("\n{objects}"));
        }
        for note in &head.notes {
            text.push_str(&format!("\n{note}\n"));
        }
        let mut output = OutputFiles::new();
        if let Some(path) = &self.picture {
            output.add(path, &draw::png(&picture(compared))?)?;
        }
        let to_stdout = self.json.as_deref() == Some(Path::new("-"));
        if let Some(path) = &self.json {
            let scenes = compared
                .iter()
                .zip(&frames)
                .map(|(compared, frame)| JsonScene {
                    scene: compared.name.clone(),
                    methods: summarise(core::slice::from_ref(frame)),
                })
                .collect();
            let mut json = serde_json::to_string_pretty(&JsonReport { frames: count, methods, scenes })?;
            json.push('\n');
            if to_stdout {
                text = json;
            } else {
                output.add(path, json.as_bytes())?;
            }
        }
        output.commit()?;
        print(&text)
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
    let drawn = &compared[..compared.len().min(DRAWN)];
    let maps: Vec<Vec<(&str, &FrameResult)>> = drawn
        .iter()
        .map(|compared| compared.scores.iter().map(|score| (score.method.as_str(), &score.result)).collect())
        .collect();
    let scenes: Vec<draw::SceneMaps<'_>> = drawn
        .iter()
        .zip(&maps)
        .filter_map(|(compared, maps)| {
            let scene = compared.scene.as_ref()?;
            Some(draw::SceneMaps { name: &scene.name, left: &scene.left, max_disparity: scene.max_disparity, maps })
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
