//! `linestereo-lab compare`: the core, dense methods and OpenCV on the same frames.

use super::batch::{BatchArgs, collect};
use crate::draw;
use crate::rivals::{
    Contender, MethodScore, MethodSummary, OpenCv, cell_comparison, compare_scene,
    comparison_table, object_comparison, summarise, time_scene,
};
use anyhow::{Context, Result, bail};
use linestereo::Params;
use linestereo_calibration::rectify_raw;
use linestereo_frames::{
    GrayImage, PairFiles, Scene, StoredPair, area_average, check_same_size, check_size,
    check_usable, load_images,
};
use linestereo_sim::commands::method::MethodArgs;
use linestereo_sim::commands::pairs::{for_each_pair, timed_bar};
use linestereo_sim::commands::{asked_for, engine_with};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::output::{OutputFiles, OutputPath, spare};
use serde::Serialize;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  linestereo-lab compare left.png right.png --picture maps.png       maps side by side
  linestereo-lab compare frames/qvga --opencv                        with OpenCV's StereoBM and StereoSGBM
  linestereo-lab compare frames/qvga --methods linestereo,sgm8-strict

Methods:
  linestereo       the core: answers of p >= 0.9
  bm, bm-strict    block matching, OpenCV's StereoBM number for number; strict: uniqueness 90, texture 3000
  census           block matching on census codes, window 15x15
  sgm8             semi-global along 8 paths, census 5x5
  sgm8-strict      the same with uniqueness 80

Columns:
  points, cells    answers a frame; % of 16x16 cells (those at least half visible truth) with one
  vis, allGT       % of answers more than 1 / 2 px off: visible ones; all with truth
  top N            allGT of the N most confident answers a frame; confidence of a baseline is its uniqueness,
                   1 - cost / cost of the best place elsewhere. OpenCV tells none.
  ms               median time of a pair on one thread, with nothing else running";

/// Match the same frames by several methods: scores, times and pictures side by side.
///
/// Give two rectified images, or folders of any layout with ground truth: those are matched on all
/// cores.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Two rectified images, or folders to search for pairs, at any depth and in any layout.
    #[arg(required = true, value_name = "LEFT RIGHT | FOLDER")]
    inputs: Vec<PathBuf>,
    /// Methods to compare [default: all].
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = Contender::named)]
    methods: Vec<Contender>,
    /// Add OpenCV's StereoBM and StereoSGBM, where a Python with OpenCV is installed.
    #[arg(long)]
    opencv: bool,
    /// The Python that has OpenCV [default: $LINESTEREO_PYTHON, else python3].
    #[arg(long, value_name = "PROGRAM", requires = "opencv")]
    python: Option<PathBuf>,
    /// Draw all maps side by side; scenes beyond the first 16 are not drawn.
    #[arg(long, value_name = "FILE.png")]
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
    /// Leave the times out. They are measured one pair after the other, when all others are done,
    /// and differ from run to run.
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
struct Compared {
    name: String,
    methods: Vec<MethodScore>,
    /// Left image and range, for the picture.
    drawn: Option<(GrayImage, u16)>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let contenders =
        if args.methods.is_empty() { Contender::ALL.to_vec() } else { args.methods.clone() };
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
    let pairs: Vec<(usize, StoredPair)> = found.pairs.into_iter().enumerate().collect();
    let name = |(_, pair): &(usize, StoredPair)| pair.name.clone();
    // A pair that cannot be loaded costs itself alone.
    let outcomes = for_each_pair(&pairs, args.batch.threads(), name, |(place, pair)| {
        let scene = match args.load(pair) {
            Ok(scene) => scene,
            Err(error) => return Ok(Err(error.context(pair.name.clone()))),
        };
        rivals
            .compare(&scene, args.picture.is_some() && *place < DRAWN)
            .map(|compared| Ok((*place, compared)))
    })?;
    let (mut compared, mut left_out) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        outcome.map_or_else(|error| left_out.push(error), |found| compared.push(found));
    }
    if let Some(first) = left_out.first() {
        if compared.is_empty() {
            bail!("no pair can be compared; {first:#}");
        }
        notes.push(format!("{} pairs were left out, the first: {first:#}", left_out.len()));
    }
    if !args.no_times {
        let progress = timed_bar(compared.len());
        for (place, compared) in &mut compared {
            let Some((_, pair)) = pairs.get(*place) else { continue };
            progress.set_message(format!("timing {}", pair.name));
            rivals.time(&args.load(pair)?, compared)?;
            progress.inc(1);
        }
        progress.finish_and_clear();
    }
    args.write(compared.into_iter().map(|(_, compared)| compared).collect(), &notes)
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
            .map(Engine::answering_unfit)
            .with_context(|| scene.name.clone())
    }

    fn compare(&self, scene: &Scene, draw: bool) -> Result<Compared> {
        let mut methods = compare_scene(scene, &self.contenders, self.opencv.as_ref(), |scene| {
            self.engine(scene)
        })?;
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
        let times =
            time_scene(scene, &self.contenders, self.opencv.as_ref(), |scene| self.engine(scene))?;
        for (score, milliseconds) in compared.methods.iter_mut().zip(times) {
            score.score.milliseconds = Some(milliseconds);
        }
        Ok(())
    }
}

impl Args {
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
            Err(error) => {
                notes.push(format!("without OpenCV: {error}"));
                Ok(None)
            }
        }
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
            bail!(
                "a disparity range of {range} does not fit an image of {dims}; change \
                 --max-disparity"
            );
        }
        Ok(range)
    }

    fn load_pair(&self, left_path: &Path, right_path: &Path) -> Result<Scene> {
        let files = PairFiles::Two([left_path, right_path].map(Path::to_path_buf));
        let [left, right] = load_images(&files, None)?;
        check_same_size((left_path, left.dims), (right_path, right.dims))?;
        let reduced = |image| {
            self.width.map_or_else(|| Ok(Clone::clone(&image)), |width| area_average(&image, width))
        };
        let (left, right) = (reduced(left)?, reduced(right)?);
        for (path, image) in [(left_path, &left), (right_path, &right)] {
            check_size(path, image)?;
            check_usable(path, image)?;
        }
        let mut scene = Scene {
            name: left_path
                .file_stem()
                .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
            folder: left_path.parent().unwrap_or(Path::new("")).to_path_buf(),
            max_disparity: Params::default_max_disparity(left.dims.width),
            left,
            right,
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
        let mut text = format!(
            "{count} {}\n\n{}",
            if count == 1 { "pair" } else { "pairs" },
            comparison_table(&methods)
        );
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
            output.add(path, &linestereo_sim::draw::png(&picture(&compared))?)?;
        }
        let scene = |Compared { name, methods, .. }: &Compared| JsonScene {
            scene: name.clone(),
            methods: summarise([methods.as_slice()]),
        };
        let report =
            JsonReport { frames: count, methods, scenes: compared.iter().map(scene).collect() };
        output.add_json(self.json.as_ref(), &report)?;
        output.commit_and_say(&text)
    }
}

fn picture(compared: &[Compared]) -> image::RgbImage {
    let maps = |compared: &Compared| -> Vec<(String, FrameResult)> {
        let drawn = compared
            .methods
            .iter()
            .filter_map(|score| Some((score.method.clone(), score.result.clone()?)));
        drawn.collect()
    };
    let scenes: Vec<draw::SceneMaps<'_>> = compared
        .iter()
        .filter_map(|compared| {
            let (left, max_disparity) = compared.drawn.as_ref()?;
            Some(draw::SceneMaps {
                name: &compared.name,
                left,
                max_disparity: *max_disparity,
                maps: maps(compared),
            })
        })
        .collect();
    draw::maps(&scenes)
}
