//! From the options of a pair to its result: the same for every command that matches pairs.
//!
//! ```text
//! load     the images of a pair, checked, reduced by --width
//! Known    what options, or the files beside a pair, say of its rig and range
//! setup    disparity range, rig, parameters: once for all pairs of one size
//! PairMatcher  the core and, for raw pairs, the rectifier, with their memory: once; then by pair
//! ```

use super::arguments::position;
use super::engine_with;
use super::method::MethodArgs;
use super::pose::PoseArgs;
use super::rectified_view::ViewArgs;
use crate::engine::{Engine, FrameResult};
use crate::output::{detail, note};
use crate::planning::{LEAST_RANGE, MAX_RANGE};
use crate::results::listing::{Query, finite_metres};
use anyhow::{Context, Result, anyhow, bail};
use linestereo::image::{Span, ViewError, shrink_to_valid};
use linestereo::unstable::Observer;
use linestereo::{Dims, Gray, Params, Rig, ground::GroundPlane, params::RigError};
use linestereo_calibration::rectify::PairRectifier;
use linestereo_frames::rectified::{check_baseline, check_centre, check_focal};
use linestereo_frames::{
    GrayImage, PairFiles, RigText, SceneInfo, StoredPair, area_average, check_same_size,
    check_size, check_usable, load_images, scaled_max_disparity,
};
use linestereo_rig::{CameraSide, RigImage};
use linestereo_wire::RigUpdate;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Matches of what is infinitely far scatter by less than this, px.
const BEYOND_INFINITY: i16 = 2;

/// Disparity range, rig, size and method.
#[derive(Debug, Default, clap::Args)]
pub(super) struct InputArgs {
    /// Search disparities 0 .. N px, in the images as matched (after --width) [default: the scene
    /// file's, else 64].
    #[arg(long, value_name = "N")]
    max_disparity: Option<u16>,
    /// Search everything at least this far away; needs a rig.
    #[arg(long, value_name = "M", conflicts_with = "max_disparity")]
    nearest: Option<f64>,
    /// Focal length of the rectified images as given (before --width).
    #[arg(long, value_name = "PX", requires = "baseline_m")]
    focal_px: Option<f64>,
    /// Distance between the cameras.
    #[arg(long, value_name = "M", requires = "focal_px", value_parser = baseline)]
    baseline_m: Option<f64>,
    /// Focal length times baseline, where only their product is known: depths, but no directions.
    #[arg(long, value_name = "PX*M", conflicts_with = "focal_px")]
    fb: Option<f64>,
    /// Added to every disparity before it becomes a depth: x_centre_right - x_centre_left, 0 for
    /// most rigs [default: minus the scene file's disparity_zero_px].
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    disparity_offset_px: Option<f64>,
    /// Principal point of the left image as given (before --width) [default: the scene file's, else
    /// the middle].
    #[arg(long, value_name = "X,Y", value_parser = principal_point, allow_hyphen_values = true, conflicts_with_all = ["fb", "rig"])]
    principal_point: Option<[f64; 2]>,
    #[command(flatten)]
    pose: PoseArgs,
    /// Take disparity range, rig and the camera's pose from a scene.json; options override it.
    #[arg(long, value_name = "scene.json")]
    scene: Option<PathBuf>,
    /// Reduce both images to this width by area averaging; the rig follows.
    #[arg(long, value_name = "PX")]
    width: Option<u16>,
    /// Bits of the sensor whose values 16-bit files hold, 8 to 16 [default: 10 or 12 where no value
    /// of the pair is larger, else 16].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=16))]
    bits: Option<u32>,
    /// Match pairs of a recording whose times differ by at most this, for still scenes
    /// [default: 1].
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    max_skew_ms: Option<u32>,
    /// Rectify raw pairs first, with this rig: rig.toml, or files of OpenCV, Kalibr, ROS or EuRoC
    /// (twice if each camera has its own file).
    #[arg(long, value_name = "FILE", conflicts_with_all = ["focal_px", "fb", "disparity_offset_px", "scene", "width"])]
    rig: Vec<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    method: MethodArgs,
}

/// Knowledge of a pair besides its images.
#[derive(Clone, Debug, Default)]
pub(super) enum Known {
    #[default]
    Nothing,
    /// It is rectified; the file that says what else is known.
    Scene(PathBuf, SceneInfo),
    /// A scene.json that nobody named lies beside the images: what it says, or why it is none.
    Beside(PathBuf, Result<SceneInfo, String>),
    /// It is raw; its rig.
    Raw(Vec<RigText>),
}

impl Known {
    /// Pairs of both are matched with the same.
    pub(super) fn matches_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Nothing, Self::Nothing) => true,
            (Self::Scene(_, info), Self::Scene(_, other))
            | (Self::Beside(_, Ok(info)), Self::Beside(_, Ok(other))) => info.matches_like(other),
            (Self::Raw(files), Self::Raw(others)) => files == others,
            _ => false,
        }
    }
}

/// Two images of one size: rectified and reduced, or raw.
pub(super) struct LoadedPair {
    images: [GrayImage; 2],
    /// Before --width.
    given: Dims,
}

/// Sizes, rig and parameters with which pairs of one size are matched.
pub(super) struct Setup<'a> {
    args: &'a InputArgs,
    /// Of the loaded images.
    loaded: Dims,
    /// Of the rectified images before --width: that of a detector's boxes and masks.
    pub(super) given: Dims,
    /// Pixels of the left image with content, where the scene file says so; empty when all have.
    left_content: Vec<Span>,
    pub(super) params: Params,
    pub(super) rig_numbers: Option<RigUpdate>,
    /// Disparity of what is infinitely far, px, where there is no rig.
    zero_px: f64,
    /// Note about the scene.json beside the pair: used, or why it is not.
    pub(super) note: Option<String>,
    /// Pairs are raw and of this rig.
    pub(super) rig: Option<RigImage>,
    /// Where the ground is, by the camera's pose.
    ground: Option<GroundPlane>,
}

/// A pair as it was matched.
pub(super) struct TimedResult {
    /// Rectified.
    pub(super) images: [GrayImage; 2],
    pub(super) result: FrameResult,
    /// For the core and its health monitor.
    pub(super) seconds: f64,
}

impl InputArgs {
    /// Knowledge of a pair: by the options, else by the files beside it.
    pub(super) fn known_of(&self, pair: &StoredPair) -> Result<Known> {
        if !self.rig.is_empty() {
            return Ok(Known::Raw(self.rig_texts()));
        }
        if let Some(path) = &self.scene {
            return Ok(Known::Scene(path.clone(), SceneInfo::load(path)?));
        }
        let has_no_rig = self.focal_px.is_none() && self.fb.is_none();
        if let Some(rig) = pair.raw_rig().filter(|_| has_no_rig) {
            return Ok(Known::Raw(rig.to_vec()));
        }
        Ok(match (pair.info()?, beside(&pair.images).filter(|_| has_no_rig)) {
            (Some((path, info)), _) => Known::Scene(path, info),
            (None, Some(path)) => {
                let info = SceneInfo::load(&path).map_err(|error| error.to_string());
                Known::Beside(path, info)
            }
            (None, None) => Known::Nothing,
        })
    }

    fn rig_texts(&self) -> Vec<RigText> {
        self.rig.iter().cloned().map(RigText::from).collect()
    }

    /// Reads and checks both images; with --width they are reduced.
    pub(super) fn load_as(&self, files: &PairFiles, known: &Known) -> Result<LoadedPair> {
        let ([left_path, right_path], [left, right]) =
            (files.paths(), load_images(files, self.bits)?);
        let is_raw = matches!(known, Known::Raw(_));
        if is_raw && self.width.is_some() {
            bail!(
                "{} is a raw image of its data set; give --rig and --raw-width in place of --width",
                left_path.display()
            );
        }
        let given = left.dims;
        check_same_size((left_path, given), (right_path, right.dims))?;
        let reduced = |image: GrayImage| match self.width {
            Some(width) => area_average(&image, width),
            None => Ok(image),
        };
        let (left, right) = (reduced(left)?, reduced(right)?);
        for (path, image) in [(left_path, &left), (right_path, &right)] {
            if !is_raw {
                check_size(path, image)?;
            }
            check_usable(path, image)?;
        }
        Ok(LoadedPair { images: [left, right], given })
    }

    /// The set-up for pairs like this one.
    pub(super) fn setup_as(&self, pair: &LoadedPair, known: &Known) -> Result<Setup<'_>> {
        let (loaded, given) = (pair.images[0].dims, pair.given);
        let (setup, source) = match known {
            Known::Nothing => (self.rectified(loaded, given, None)?, None),
            Known::Scene(path, info) => {
                (self.rectified(loaded, given, Some((path, info)))?, Some(path))
            }
            Known::Beside(path, found) => {
                let fits = found.as_ref().map_err(String::clone).and_then(|info| {
                    info.check_images(given)
                        .map(|()| info)
                        .map_err(|unfit| format!("{}: {unfit}", path.display()))
                });
                match fits {
                    Ok(info) => {
                        let mut setup = self.rectified(loaded, given, Some((path, info)))?;
                        let (path_name, described) = (path.display(), setup.described());
                        setup.note = Some(format!("{path_name} lies beside the pair: {described}"));
                        (setup, Some(path))
                    }
                    Err(why) => {
                        let note = format!("the scene.json beside the pair is not used: {why}");
                        let setup = self.rectified(loaded, given, None)?;
                        (Setup { note: Some(note), ..setup }, None)
                    }
                }
            }
            Known::Raw(rig) => (self.raw(loaded, Some(loaded), rig)?, Some(&rig[0].path)),
        };
        detail(|| {
            let source = source.map_or("options".to_owned(), |path| path.display().to_string());
            let (dims, described) = (setup.dims(), setup.described());
            format!("images of {given}, matched as {dims}; {described} by {source}")
        });
        Ok(setup)
    }

    fn rectified(
        &self,
        loaded: Dims,
        given: Dims,
        scene: Option<(&PathBuf, &SceneInfo)>,
    ) -> Result<Setup<'_>> {
        let (scale, full) = (f64::from(loaded.width) / f64::from(given.width), given);
        let (mut range, mut rig, mut rig_numbers) = (None, None, None);
        let zero = scene.as_ref().map_or(0.0, |(_, info)| info.disparity_zero_px);
        if let Some((path, info)) = &scene {
            info.check_images(given).map_err(|unfit| anyhow!("{}: {unfit}", path.display()))?;
            let scaled =
                |range| if scale < 1.0 { scaled_max_disparity(range, scale) } else { range as u16 };
            range = info.max_disparity.map(scaled);
            rig = info.rig(path, scale)?;
            rig_numbers = info.rig_numbers(scale);
        }
        let product = self.fb.map(|fb| (fb, 1.0));
        if let Some((focal_px, baseline_m)) = self.focal_px.zip(self.baseline_m).or(product) {
            let offset_px = self.disparity_offset_px.unwrap_or(-zero);
            let numbers =
                RigUpdate { focal_px: focal_px * scale, baseline_m, offset_px: offset_px * scale };
            if self.fb.is_none() {
                check_focal(focal_px, given.width)
                    .map_err(|unfit| anyhow!("--focal-px: {unfit}"))?;
            }
            let unfit = |error| anyhow!("{error}; correct {}", self.option_behind(&error));
            rig = Some(numbers.rig().map_err(unfit)?);
            rig_numbers = Some(numbers);
        } else if self.disparity_offset_px.is_some() {
            bail!(
                "--disparity-offset-px alone gives no depths; add --focal-px and --baseline-m, or \
                 --fb"
            );
        }
        let nearest =
            self.nearest.map(|nearest| range_to(nearest, rig.as_ref(), loaded)).transpose()?;
        let max_disparity =
            self.max_disparity.or(nearest).or(range).unwrap_or_else(|| default_range(loaded));
        if self.fb.is_none() {
            let given =
                self.principal_point.map(|given| given.map(|value| (value + 0.5) * scale - 0.5));
            let centre = given.or_else(|| scene.and_then(|(_, info)| info.principal_point(scale)));
            if let Some(option) = self.principal_point {
                check_centre(option, full)
                    .map_err(|unfit| anyhow!("--principal-point: {unfit}"))?;
            }
            if given.is_some() && rig.is_none() {
                bail!(
                    "--principal-point alone gives no depths; add --focal-px and --baseline-m, or \
                     --scene"
                );
            }
            if let (Some(known), Some(centre)) = (rig, centre) {
                rig = Some(known.with_principal_point(centre.map(|v| v as f32))?);
            }
            rig = rig.map(|rig| rig.centred(loaded));
        }
        let mut params = self.method.params(max_disparity, rig)?;
        if !self.method.has_min_disparity() {
            // Points at infinity have their place in the range.
            params.min_disparity = ((zero * scale).floor().clamp(-30.0, 0.0) as i16
                - BEYOND_INFINITY * i16::from(zero < 0.0))
            .max(-32);
        }
        let ground = self.pose.ground(
            scene.and_then(|(_, info)| info.pose()),
            params.rig.as_ref(),
            loaded,
        )?;
        Ok(Setup {
            args: self,
            loaded,
            given,
            ground,
            left_content: scene
                .as_ref()
                .and_then(|(_, info)| info.left_content(loaded))
                .unwrap_or_default(),
            params,
            rig_numbers,
            zero_px: zero * scale,
            note: None,
            rig: None,
        })
    }

    /// The set-up of rectified images of this size that are matched elsewhere: by the options
    /// alone.
    pub(super) fn setup_of(&self, dims: Dims) -> Result<Setup<'_>> {
        if self.rig.is_empty() {
            return self.rectified(dims, dims, None);
        }
        let setup = self.raw(dims, None, &self.rig_texts())?;
        if setup.dims() != dims {
            bail!(
                "the board matches images of {dims}, but --rig gives {}; add --size {dims}",
                setup.dims()
            );
        }
        Ok(setup)
    }

    /// Rectifies raw images of this size; `None` without --rig.
    pub(super) fn rectifier_of(&self, raw: Dims) -> Result<Option<PairRectifier>> {
        if self.rig.is_empty() {
            return Ok(None);
        }
        let setup = self.raw(raw, Some(raw), &self.rig_texts())?;
        Ok(setup.rig.map(|rig| PairRectifier::new(rig.remap())).transpose()?)
    }

    fn option_behind(&self, error: &RigError) -> &'static str {
        match error {
            RigError::Focal(_) if self.fb.is_some() => "--fb",
            RigError::Focal(_) => "--focal-px",
            RigError::Baseline(_) => "--baseline-m",
            RigError::Offset(_) => "--disparity-offset-px",
            RigError::PrincipalPoint(_) if self.principal_point.is_some() => "--principal-point",
            _ => "--scene",
        }
    }

    fn raw(&self, loaded: Dims, images: Option<Dims>, rig: &[RigText]) -> Result<Setup<'_>> {
        // Without a range the least one, until the size is known.
        let mut params = self.method.params(self.max_disparity.unwrap_or(LEAST_RANGE), None)?;
        let mut image =
            self.view.image(rig, images, None, (params.min_disparity, params.max_disparity))?;
        if self.max_disparity.is_none() {
            let (rig_of, dims) = (image.params(params)?.rig, image.remap().dims());
            let reach = |nearest| range_to(nearest, rig_of.as_ref(), dims);
            params.max_disparity = self.nearest.map_or_else(|| Ok(default_range(dims)), reach)?;
            image =
                self.view.image(rig, images, None, (params.min_disparity, params.max_disparity))?;
        }
        let (params, dims) = (image.params(params)?, image.remap().dims());
        Ok(Setup {
            args: self,
            loaded,
            ground: self.pose.ground(None, params.rig.as_ref(), dims)?,
            given: dims,
            left_content: Vec::new(),
            params,
            rig_numbers: None,
            zero_px: 0.0,
            note: None,
            rig: Some(image),
        })
    }
}

/// End of the disparities searched where nobody says how far; a note where images of this size have
/// no room for the usual one.
fn default_range(dims: Dims) -> u16 {
    let most = Params::default_max_disparity(dims.width).max(LEAST_RANGE);
    if most < Params::DEFAULT.max_disparity {
        note(&format!(
            "disparities below {most} are searched, as images of {dims} have no more; \
             --max-disparity sets a smaller range"
        ));
    }
    most
}

/// End of the disparities searched so that nothing at least `nearest` metres away is beyond them.
fn range_to(nearest: f64, rig: Option<&Rig>, dims: Dims) -> Result<u16> {
    let Some(rig) = rig else {
        bail!("--nearest needs a rig: give --focal-px and --baseline-m, --fb, --scene, or --rig")
    };
    if !(0.01..=1000.0).contains(&nearest) {
        bail!("--nearest is {nearest}; give 0.01 to 1000 metres");
    }
    let most = (dims.width - 1).min(MAX_RANGE);
    let limit = |range: u16| rig.depth(Params::largest_disparity(range)).to_num::<f64>();
    (LEAST_RANGE..=most).find(|&range| limit(range) <= nearest).with_context(|| {
        let least = (100.0 * limit(most)).ceil() / 100.0;
        format!(
            "--nearest {nearest} needs more than {most} disparities; give {least:.2} or more, or \
             reduce the images with --width, or --size with --rig"
        )
    })
}

impl Setup<'_> {
    /// Size of the images as matched.
    pub(super) fn dims(&self) -> Dims {
        self.rig.as_ref().map_or(self.loaded, |rig| rig.remap().dims())
    }

    fn described(&self) -> String {
        let Params { min_disparity, max_disparity, rig, .. } = &self.params;
        let nearest = rig.map(|rig| rig.depth(Params::largest_disparity(*max_disparity)));
        let nearest =
            nearest.and_then(finite_metres).map(|metres| format!(", depths from {metres:.3} m"));
        format!(
            "disparities {min_disparity} to {max_disparity} px{}",
            nearest.unwrap_or(", no depths".to_owned())
        )
    }

    /// The rig where directions are known too, not the product of focal length and baseline alone.
    pub(super) fn geometry(&self) -> Option<&Rig> {
        self.params.rig.as_ref().filter(|rig| rig.principal_point_q16().is_some())
    }

    /// The pixel of the images as matched that holds this one of those before --width.
    pub(super) fn as_matched(&self, (x, y): (u16, u16)) -> (u16, u16) {
        let reduced = |at: u16, given: u16, matched: u16| {
            let at = (2 * u64::from(at) + 1) * u64::from(matched) / (2 * u64::from(given));
            u16::try_from(at).unwrap_or(u16::MAX)
        };
        let (given, matched) = (self.given, self.dims());
        (reduced(x, given.width, matched.width), reduced(y, given.height, matched.height))
    }

    /// The images for a board, or for the rectifier: raw ones as the rig sees them.
    pub(super) fn raw(&self, pair: &LoadedPair) -> Result<[GrayImage; 2]> {
        let [left, right] = pair.images.clone();
        match self.rig {
            Some(_) => Ok([self.args.view.raw(left)?, self.args.view.raw(right)?]),
            None => Ok([left, right]),
        }
    }
}

/// The core and what goes before it, for pairs of one size in the order in which they were
/// captured.
pub(super) struct PairMatcher {
    rectifier: Option<PairRectifier>,
    usable: [Vec<Span>; 2],
    pub(super) engine: Engine,
}

impl PairMatcher {
    /// Checks the parameters and allocates the memory.
    pub(super) fn new(setup: &Setup<'_>) -> Result<Self> {
        let rectifier =
            setup.rig.as_ref().map(|rig| PairRectifier::new(rig.remap())).transpose()?;
        let mut usable = CameraSide::BOTH
            .map(|eye| rectifier.as_ref().map_or(Vec::new(), |r| r.facts(eye).usable));
        if !setup.left_content.is_empty() {
            usable[0].clone_from(&setup.left_content);
            shrink_to_valid(&mut usable[0], setup.dims().width);
        }
        let mut engine = engine_with(&setup.params, setup.dims())?;
        engine.matcher.expect_ground(setup.ground);
        if setup.params.rig.is_none() {
            engine.expect_infinity_at(setup.zero_px);
        }
        if let Some(milliseconds) = setup.args.max_skew_ms {
            engine.matcher.limits.skew_us = 1000 * milliseconds;
        }
        Ok(Self { rectifier, usable, engine })
    }

    /// Matches the next pair.
    pub(super) fn run(
        &mut self,
        setup: &Setup<'_>,
        pair: &LoadedPair,
        times_us: Option<[u64; 2]>,
    ) -> Result<TimedResult> {
        self.run_observed(setup, pair, times_us, &mut ())
    }

    /// The same, watched.
    pub(super) fn run_observed(
        &mut self,
        setup: &Setup<'_>,
        pair: &LoadedPair,
        times_us: Option<[u64; 2]>,
        observer: &mut impl Observer,
    ) -> Result<TimedResult> {
        if pair.images[0].dims != setup.loaded {
            let [first, this] = [setup.loaded, pair.images[0].dims];
            bail!("the pair is {this}, but earlier pairs are {first}; give pairs of one size");
        }
        let images = setup.raw(pair)?;
        let images = match &mut self.rectifier {
            Some(rectifier) => rectifier.pair(&images[0], &images[1])?.into(),
            None => images,
        };
        let start = Instant::now();
        let views = views(&images, &self.usable)?;
        let result = self.engine.run_next(views, times_us, observer)?;
        Ok(TimedResult { images, result, seconds: start.elapsed().as_secs_f64() })
    }

    /// The depth of pixels of the pair that was matched last, which are counted before --width.
    pub(super) fn ask(&mut self, setup: &Setup<'_>, pixels: &[(u16, u16)]) -> Vec<Query> {
        let mut ask =
            |&pixel: &(u16, u16)| Query::new(pixel, self.engine.depth_at(setup.as_matched(pixel)));
        pixels.iter().map(&mut ask).collect()
    }
}

/// A distance between cameras in metres.
pub(super) fn baseline(text: &str) -> Result<f64, String> {
    let metres = text.parse().map_err(|_| "give metres, such as 0.075")?;
    check_baseline(metres).map(|()| metres).map_err(|unfit| unfit.to_string())
}

/// The scene.json in the folder of both images of a pair that stands alone.
fn beside(images: &PairFiles) -> Option<PathBuf> {
    let [left, right] = match images {
        PairFiles::Two(_) | PairFiles::SideBySide(_) => images.paths().map(Path::parent),
        PairFiles::Source(_) => return None,
    };
    let path = left.filter(|_| left == right)?.join("scene.json");
    path.is_file().then_some(path)
}

fn principal_point(text: &str) -> Result<[f64; 2], &'static str> {
    position(text).ok_or("give a column and a row, such as 319.5,239.5")
}

/// Both images with what is usable of them.
fn views<'a>(
    images: &'a [GrayImage; 2],
    usable: &'a [Vec<Span>; 2],
) -> Result<(Gray<'a>, Gray<'a>), ViewError> {
    let view = |eye: usize| {
        let view = images[eye].view()?;
        if usable[eye].is_empty() { Ok(view) } else { view.with_valid(&usable[eye]) }
    };
    Ok((view(0)?, view(1)?))
}
