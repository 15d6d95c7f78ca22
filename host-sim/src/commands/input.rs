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
use super::known::{Known, beside};
use super::method::MethodArgs;
use super::pose::PoseArgs;
use super::range::{default_range, of_scene, range_to};
use super::rectified_view::ViewArgs;
use crate::engine::{Engine, FrameResult};
use crate::output::{detail, is_quiet, note_once, tell};
use crate::planning::LEAST_RANGE;
use crate::results::health;
use crate::results::listing::{Query, finite_metres};
use anyhow::{Result, anyhow, bail};
use linestereo::image::{Span, ViewError, shrink_to_valid};
use linestereo::unstable::Observer;
use linestereo::{Dims, Gray, Params, Rig, ground::GroundPlane, params::RigError};
use linestereo_calibration::rectify::PairRectifier;
use linestereo_frames::rectified::{check_baseline, check_centre, check_focal, check_product};
use linestereo_frames::{
    GrayImage, PairFiles, RigText, SceneInfo, StoredPair, area_average, check_same_size,
    check_size, check_usable, load_images,
};
use linestereo_rig::{CameraSide, RigImage};
use linestereo_wire::RigUpdate;
use std::path::PathBuf;
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
    /// Focal length times baseline, where only their product is known: depths, but no directions
    /// and no pose of the camera.
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
    /// Take disparity range, rig and the camera's pose from a scene.json [default: the one beside
    /// the pair]; options override what they name, the rest of it holds.
    #[arg(long, value_name = "scene.json")]
    scene: Option<PathBuf>,
    /// Reduce both images to this width by area averaging; the rig follows.
    #[arg(long, value_name = "PX")]
    width: Option<u16>,
    /// Bits of the sensor whose values 16-bit files hold, 8 to 16 [default: 8, 10 or 12 where no
    /// value of the pair is larger, else 16].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=16))]
    bits: Option<u32>,
    /// Match pairs of a recording whose times differ by at most this, for still scenes
    /// [default: 1].
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    max_skew_ms: Option<u32>,
    /// Rectify raw pairs first, with this rig: rig.toml, or files of OpenCV, Kalibr, ROS or EuRoC
    /// (twice if each camera has its own file).
    #[arg(long, value_name = "FILE", conflicts_with_all = ["focal_px", "fb", "disparity_offset_px", "scene"])]
    rig: Vec<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    method: MethodArgs,
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
        if let Some(rig) = pair.raw_rig().filter(|_| !self.has_rig()) {
            return Ok(Known::Raw(rig.to_vec()));
        }
        Ok(match (pair.info()?, beside(&pair.images)) {
            (Some((path, info)), _) => Known::Scene(path, info),
            (None, Some(path)) => {
                let info = SceneInfo::load(&path).map_err(|error| error.to_string());
                Known::Beside(path, info)
            }
            (None, None) => Known::Nothing,
        })
    }

    /// Options give the rig of rectified images.
    fn has_rig(&self) -> bool {
        self.focal_px.is_some() || self.fb.is_some()
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
            let whose =
                if self.rig.is_empty() { " of its data set; give --rig and" } else { "; give" };
            bail!(
                "{} is a raw image{whose} --raw-width in place of --width, or --size for the \
                 rectified images",
                left_path.display()
            );
        }
        let given = left.dims;
        if files.is_one_video() && given.width < given.height {
            note_once(&format!(
                "{} is taken as both views side by side, {given} each; if it is of one camera, \
                 give the right video as second path",
                left_path.display()
            ));
        }
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
                        let rig =
                            if self.has_rig() { "; the rig is that of the options" } else { "" };
                        setup.note =
                            Some(format!("{path_name} lies beside the pair: {described}{rig}"));
                        (setup, Some(path))
                    }
                    Err(why) => {
                        let note = format!("the scene.json beside the pair is not used: {why}");
                        if is_quiet() {
                            tell(&note); // a fault, not only a note
                        }
                        let setup = self.rectified(loaded, given, None)?;
                        (Setup { note: Some(note), ..setup }, None)
                    }
                }
            }
            Known::Raw(rig) => (self.raw(loaded, Some(loaded), rig)?, Some(&rig[0].path)),
        };
        detail(|| {
            let named = source.map(|path| path.display().to_string());
            let of_options = named.is_none() || self.has_rig();
            let source: Vec<String> =
                of_options.then(|| "options".to_owned()).into_iter().chain(named).collect();
            let source = source.join(" and ");
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
            range = info.max_disparity.map(|range| (path, range));
            rig = info.rig(path, scale)?;
            if info.has_half_pose() {
                note_once(&format!(
                    "{}: \"camera\" says no pose without both height_m and pitch_deg",
                    path.display()
                ));
            }
            rig_numbers = info.rig_numbers(scale);
        }
        let product = self.fb.map(|fb| (fb, 1.0));
        if let Some((focal_px, baseline_m)) = self.focal_px.zip(self.baseline_m).or(product) {
            let offset_px = self.disparity_offset_px.unwrap_or(-zero);
            let numbers =
                RigUpdate { focal_px: focal_px * scale, baseline_m, offset_px: offset_px * scale };
            let (name, fits) = match self.fb {
                Some(fb) => ("--fb", check_product(fb, given.width)),
                None => ("--focal-px", check_focal(focal_px, given.width)),
            };
            fits.map_err(|unfit| anyhow!("{name}: {unfit}"))?;
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
        let max_disparity = match (self.max_disparity.or(nearest), range) {
            (Some(given), _) => given,
            (None, Some((path, range))) => of_scene(path, range, scale, loaded)?,
            (None, None) => default_range(loaded),
        };
        if self.fb.is_none() {
            let given =
                self.principal_point.map(|given| given.map(|value| (value + 0.5) * scale - 0.5));
            let centre = given.or_else(|| scene.and_then(|(_, info)| info.principal_point(scale)));
            if let Some(option) = self.principal_point {
                let [x, y] = option;
                if !(0.0..f64::from(full.width)).contains(&x)
                    || !(0.0..f64::from(full.height)).contains(&y)
                {
                    bail!("--principal-point {x},{y} lies outside of the image, which is {full}");
                }
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
            with_directions(&params),
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
        with_directions(&self.params)
    }

    /// The error of an option that needs depths or directions, which are not known.
    pub(super) fn lacks(&self, option: &str) -> anyhow::Error {
        if self.params.rig.is_some() {
            return anyhow!(
                "{option} needs directions, and --fb gives depths alone; give --focal-px and \
                 --baseline-m in its place"
            );
        }
        let note = self.note.as_ref().map_or(String::new(), |note| format!(" ({note})"));
        anyhow!("{option} needs depths; give --focal-px and --baseline-m, --scene, or --rig{note}")
    }

    /// Why nothing of a pair is to be used, with what to do.
    pub(super) fn refusal(&self, result: &FrameResult) -> Option<String> {
        let why = health::refusal(result)?;
        let is_rectified = !self.args.rig.is_empty() && health::may_be_rectified(result.health);
        let more = if is_rectified {
            "; or the images are rectified already: leave --rig out"
        } else {
            ""
        };
        Some(why + more)
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

fn with_directions(params: &Params) -> Option<&Rig> {
    params.rig.as_ref().filter(|rig| rig.principal_point_q16().is_some())
}

/// A distance between cameras in metres.
pub(super) fn baseline(text: &str) -> Result<f64, String> {
    let metres = text.parse().map_err(|_| "give metres, such as 0.075")?;
    check_baseline(metres).map(|()| metres).map_err(|unfit| unfit.to_string())
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
