//! Depth per object against ground truth: which answers are wrong, which objects have one, and
//! whether what is reported of them is true.
//!
//! In: scenes with `objects.png` (a label per surface) or `objects.json` (boxes drawn by hand, with
//! `mask_objects.png` as their truth). Out: a table. A wrong answer is more than 1 px outside of
//! the object's own 5-95 % range of true disparities; a covered object has an answer. The masks are
//! given to the core as they are, 2 px too large and eroded by 2 px.

use anyhow::{Context, Result, ensure};
use linestereo::objects::Reason;
use linestereo::{Area, Dims, NoDepth, ObjectDepth, Region};
use linestereo_frames::regions::{self, Frame, Object, Pixels};
use linestereo_frames::statistics::{interpolated_quantile, median};
use linestereo_frames::untrusted::{self, SETTINGS_BYTES};
use linestereo_frames::{Scene, load_values};
use linestereo_sim::engine::Engine;
use linestereo_sim::results::mask::Mask;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Pixels by which masks are made too large or too small.
const SLOPPY_PX: usize = 2;
/// An answer further than this from the object's own range is wrong.
const WRONG_PX: f32 = 1.0;

/// Form in which an object is given to the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outline {
    /// Its mask.
    Given,
    /// Its mask, 2 px too large.
    TooLarge,
    /// Its mask, eroded by 2 px.
    Eroded,
    /// A box drawn by hand.
    Box,
}

impl Outline {
    /// Every kind, in the order of the table.
    pub const ALL: [Self; 4] = [Self::Given, Self::TooLarge, Self::Eroded, Self::Box];

    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Given => "as given",
            Self::TooLarge => "2 px too large",
            Self::Eroded => "eroded 2 px",
            Self::Box => "drawn boxes",
        }
    }
}

/// One object with its truth and what the core is given of it.
#[derive(Clone, Debug)]
pub struct ObjectCase {
    /// Scene and object.
    pub name: String,
    /// Form given to the core.
    pub outline: Outline,
    dims: Dims,
    given: Object,
    /// 5 % and 95 % of its true disparities, px.
    range: (f32, f32),
    /// Their median.
    median: f32,
    /// Its true pixels.
    mask: Arc<Mask>,
}

impl ObjectCase {
    /// Of the pixels of this mask; `None` where none of them has truth.
    fn new(
        scene: &Scene,
        object: &str,
        outline: Outline,
        given: Object,
        mask: &Arc<Mask>,
    ) -> Option<Self> {
        let (truth, dims) = (scene.truth.as_ref()?, scene.left.dims);
        let places = (0..dims.height).flat_map(|y| (0..dims.width).map(move |x| (x, y)));
        let own = places.zip(mask.pixels()).filter(|(_, is_own)| **is_own);
        let mut values: Vec<f32> =
            own.filter_map(|((x, y), _)| truth.disparity(x.into(), y.into())).collect();
        values.sort_by(f32::total_cmp);
        Some(Self {
            name: format!("{} {object}", scene.name),
            outline,
            dims,
            given,
            range: (interpolated_quantile(&values, 0.05)?, interpolated_quantile(&values, 0.95)?),
            median: interpolated_quantile(&values, 0.5)?,
            mask: Arc::clone(mask),
        })
    }

    /// Region given to the core; `None` where erosion left nothing.
    pub fn region(&self) -> Option<Region<'_>> {
        self.given.region(self.dims).ok()
    }

    /// Its true pixels.
    pub fn mask(&self) -> &Mask {
        &self.mask
    }

    /// Scores what the core reports of it.
    pub fn score(&self, found: &Result<ObjectDepth, NoDepth>) -> ObjectScore {
        let (low, high) = self.range;
        let object = found.as_ref().ok();
        let disparity = object.map(|object| object.disparity.to_num::<f32>());
        ObjectScore {
            name: self.name.clone(),
            outline: self.outline,
            refused: found.as_ref().err().map(|why| why.reason),
            range: self.range,
            disparity: disparity.unwrap_or(f32::NAN),
            wrong: disparity.is_some_and(|d| low - d > WRONG_PX || d - high > WRONG_PX),
            error: disparity.map_or(f32::NAN, |d| (d - self.median).abs()),
            relative: disparity.map_or(f32::NAN, |d| (d - self.median).abs() / self.median),
            sigma: object.map_or(0.0, |object| object.sigma.to_num()),
            confidence: object.map_or(0.0, |object| object.confidence.to_num()),
        }
    }
}

/// Score of one answer.
#[derive(Clone, Debug)]
pub struct ObjectScore {
    /// Scene and object.
    pub name: String,
    /// Form given to the core.
    pub outline: Outline,
    /// Why there is no answer.
    pub refused: Option<Reason>,
    /// 5 % and 95 % of the true disparities, px.
    pub range: (f32, f32),
    /// The answer in px; not a number without one, like what follows from it.
    pub disparity: f32,
    /// More than 1 px outside of the range.
    pub wrong: bool,
    /// Distance from the true median in px, and as a part of it.
    pub error: f32,
    /// See `error`.
    pub relative: f32,
    /// Standard deviation stated.
    pub sigma: f32,
    /// Probability stated that the answer is not wrong.
    pub confidence: f32,
}

/// The scores of one kind of outline together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ObjectSummary {
    /// Form given to the core.
    pub outline: Outline,
    /// Objects asked for.
    pub objects: usize,
    /// Objects with an answer.
    pub covered: usize,
    /// Wrong answers.
    pub wrong: usize,
    /// Median of |answer - true median| / true median.
    pub median_relative_error: Option<f64>,
    /// Share of answers within one stated standard deviation of the true median.
    pub within_sigma: Option<f64>,
    /// Share within two.
    pub within_two_sigma: Option<f64>,
    /// Mean probability stated.
    pub mean_confidence: Option<f64>,
    /// Objects refused for each reason of [`Reason::ALL`].
    pub refused: [usize; Reason::ALL.len()],
}

impl ObjectSummary {
    /// Of those scores that are of this kind.
    pub fn pool(outline: Outline, scores: &[ObjectScore]) -> Self {
        let all: Vec<&ObjectScore> =
            scores.iter().filter(|score| score.outline == outline).collect();
        let answers: Vec<&ObjectScore> =
            all.iter().copied().filter(|score| score.refused.is_none()).collect();
        let share = |is: &dyn Fn(&ObjectScore) -> bool| {
            let count = answers.iter().filter(|score| is(score)).count();
            (!answers.is_empty()).then(|| count as f64 / answers.len() as f64)
        };
        let sum: f64 = answers.iter().map(|score| f64::from(score.confidence)).sum();
        Self {
            outline,
            objects: all.len(),
            covered: answers.len(),
            wrong: answers.iter().filter(|score| score.wrong).count(),
            median_relative_error: median(
                answers.iter().map(|score| score.relative).collect(),
                f32::total_cmp,
            )
            .map(f64::from),
            within_sigma: share(&|score| score.error <= score.sigma),
            within_two_sigma: share(&|score| score.error <= 2.0 * score.sigma),
            mean_confidence: (!answers.is_empty()).then(|| sum / answers.len() as f64),
            refused: Reason::ALL
                .map(|reason| all.iter().filter(|score| score.refused == Some(reason)).count()),
        }
    }

    /// Wrong answers in percent of all answers; 0 without any.
    pub fn wrong_percent(&self) -> f64 {
        100.0 * self.wrong as f64 / self.covered.max(1) as f64
    }

    /// Objects with an answer in percent.
    pub fn covered_percent(&self) -> f64 {
        100.0 * self.covered as f64 / self.objects.max(1) as f64
    }
}

/// Every object of a scene that has truth, given in every way there is.
pub fn object_cases(scene: &Scene) -> Result<Vec<ObjectCase>> {
    let (dims, mut cases) = (scene.left.dims, Vec::new());
    let path = scene.folder.join("objects.png");
    if path.is_file() {
        for object in objects(&path, load_values(&path)?.0, dims)? {
            let (label, name) = (object.label, object.label.to_string());
            let mask = Arc::new(Mask::of(&object.region(dims)?, dims));
            for (outline, shape) in [
                (Outline::Given, Mask::clone(&mask)),
                (Outline::TooLarge, mask.grown(SLOPPY_PX)),
                (Outline::Eroded, mask.eroded(SLOPPY_PX)),
            ] {
                let pixels = Pixels::Mask(shape.runs(label));
                let given = Object { label, name: None, pixels };
                cases.extend(ObjectCase::new(scene, &name, outline, given, &mask));
            }
        }
    }
    if let Some(folder) = folder_with_boxes(&scene.folder)? {
        let path = folder.join("mask_objects.png");
        let (own, _) = load_values(&path)?;
        let masks = objects(&path, own, dims)?;
        for drawn in objects(&folder.join("objects.json"), own, own)? {
            let Some(mask) = masks.iter().find(|mask| mask.label == drawn.label) else { continue };
            let mask = Arc::new(Mask::of(&mask.region(dims)?, dims));
            let name = drawn.name.clone().unwrap_or_default();
            let given = reduced_box(drawn, own, dims);
            cases.extend(ObjectCase::new(scene, &name, Outline::Box, given, &mask));
        }
    }
    Ok(cases)
}

/// A box of an image of the size `own`, reduced to `matched`: rows and columns by their own ratio.
fn reduced_box(mut drawn: Object, own: Dims, matched: Dims) -> Object {
    let scaled = |at: u16, from: u16, to: u16| {
        (f64::from(at) * f64::from(to) / f64::from(from)).round() as u16
    };
    if let Pixels::Box(Area { left, top, right, bottom }) = &mut drawn.pixels {
        for x in [left, right] {
            *x = scaled(*x, own.width, matched.width);
        }
        for y in [top, bottom] {
            *y = scaled(*y, own.height, matched.height);
        }
    }
    drawn
}

/// Objects of a file about images of the size `own`, reduced to `matched`.
fn objects(path: &Path, own: Dims, matched: Dims) -> Result<Vec<Object>> {
    let found = regions::load(path, None, Frame { given: own, matched, image: None })?;
    ensure!(found.skipped.objects() == 0, "{}: {}", path.display(), found.skipped.summary());
    Ok(found.list)
}

/// Answers of the core about each object of the pair that the engine ran last.
#[must_use]
pub fn score_objects(engine: &mut Engine, cases: &[ObjectCase]) -> Vec<ObjectScore> {
    let answer = |case: &ObjectCase, engine: &mut Engine| {
        let nothing = NoDepth { reason: Reason::LittleSupport, support: 0 };
        case.score(&case.region().map_or(Err(nothing), |region| engine.object(&region)))
    };
    cases.iter().map(|case| answer(case, engine)).collect()
}

#[derive(Deserialize)]
struct Origin {
    from: Option<String>,
}

/// The folder that holds boxes of this scene: its own, or the one that it was reduced from.
fn folder_with_boxes(folder: &Path) -> Result<Option<PathBuf>> {
    if folder.join("objects.json").is_file() {
        return Ok(Some(folder.to_path_buf()));
    }
    let path = folder.join("scene.json");
    let text = untrusted::read(&path, SETTINGS_BYTES)
        .with_context(|| format!("cannot read {}", path.display()))?;
    let origin: Origin =
        serde_json::from_slice(&text).with_context(|| path.display().to_string())?;
    let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_path_buf()); // of `.` there is no parent
    let folder = origin.from.and_then(|from| Some(folder.parent()?.parent()?.join(from)));
    Ok(folder.filter(|folder| folder.join("objects.json").is_file()))
}
