//! Every damage of the bench.

use super::{detail, geometry, sensor, texture};
use core::fmt;
use linestereo_frames::{GrayImage, Perturbation, Scene};
use linestereo_sim::results::mask::Mask;

/// A pair to be damaged, and what the damages take from elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Another pair.
    pub other: [&'a GrayImage; 2],
    /// Pixels of objects in the left image.
    pub objects: &'a Mask,
    /// Seed of everything random.
    pub seed: u64,
}

/// Kind of damage, as a user would look for it; tables have this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Family {
    /// No damage.
    Undamaged,
    /// The same thing at the same pixel of both images.
    SamePixel,
    /// Rows of one image that moved along themselves.
    MovedRows,
    /// Rows moved in proportion to their number: a plane added to all disparities, as another
    /// attitude of the camera would.
    Sheared,
    /// Rows, rotation, focal length: the calibration does not hold.
    Geometry,
    /// A periodic texture on the objects themselves.
    Repetition,
    /// Less detail than there was.
    Detail,
    /// Noise, exposure, dirt in one image alone.
    OneCamera,
    /// Both cameras show another scene than there is.
    Frozen,
    /// All disparities are changed by as much.
    Sideways,
}

/// The least with which a damage can be told from a healthy pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Evidence {
    /// The pair itself.
    Pair,
    /// Several pairs of a moving camera.
    Sequence,
    /// Something else: a known distance, times of capture.
    Other,
}

impl Family {
    /// In words.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Undamaged => "undamaged",
            Self::SamePixel => "the same at the same pixel",
            Self::MovedRows => "rows that moved",
            Self::Sheared => "rolling shutter of one camera",
            Self::Geometry => "geometry",
            Self::Repetition => "repetition on objects",
            Self::Detail => "less detail",
            Self::OneCamera => "one camera",
            Self::Frozen => "frozen at another scene",
            Self::Sideways => "sideways shift",
        }
    }

    /// The least with which its damages can be told.
    pub(crate) const fn evidence(self) -> Evidence {
        match self {
            Self::Frozen => Evidence::Sequence,
            Self::Sheared | Self::Sideways => Evidence::Other,
            _ => Evidence::Pair,
        }
    }
}

/// One damage with its strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damage {
    /// Nothing is done.
    None,
    /// Fixed pattern noise: standard deviation, grey levels, the same in both images.
    FixedPattern(f64),
    /// An offset for every column: standard deviation, grey levels, the same in both images.
    ColumnNoise(f64),
    /// An offset for every row, the same in both images.
    RowNoise(f64),
    /// The left camera's image delivered as both.
    OneCameraTwice,
    /// Lines of overlaid text, at the same place in both images.
    Text(usize),
    /// Dark blobs of this radius, px, at the same places in both images.
    Dirt(usize, f64),
    /// Bright blobs.
    BrightDirt(usize, f64),
    /// Blurred discs: drops on a common window.
    Drops(usize, f64),
    /// Every n-th column black.
    DeadColumns(usize),
    /// Every n-th column white.
    BrightColumns(usize),
    /// The right image's lower half is moved to the right, px.
    Torn(f64),
    /// The right image is sheared: its last row is moved by so many px against its first.
    RollingShutter(f64),
    /// Every fourth band of eight rows of the right image is moved, px.
    LostSync(f64),
    /// The right image is magnified, percent.
    Focal(f64),
    /// The right image is rotated about its centre, degrees.
    Roll(f64),
    /// The right image is lower, px.
    RowsOff(f64),
    /// Radial distortion of the right image: displacement at the corner, px.
    Distortion(f64),
    /// Soft vertical bars of this period, px, on the objects.
    Bars(f64),
    /// A checkerboard of this period, px, on the objects.
    Checker(f64),
    /// Bricks of this length, px, on the objects.
    Bricks(f64),
    /// JPEG at this quality.
    Jpeg(u8),
    /// Grey levels of this depth, bits.
    Bits(u32),
    /// Gaussian blur of both images: standard deviation, px.
    Blur(f64),
    /// The same of the right image alone.
    BlurOneEye(f64),
    /// Horizontal motion blur of both images, px.
    Motion(usize),
    /// Fog: contrast that remains.
    Fog(f64),
    /// Gaussian noise of its own on each image: standard deviation, grey levels.
    Noise(f64),
    /// Pixels that are black or white, percent, each image its own.
    SaltAndPepper(f64),
    /// The right image's brightness: factor.
    Gain(f64),
    /// The right image is covered from its left side on, percent of its width.
    Covered(f64),
    /// Blobs of dirt on the right camera alone.
    DirtOneEye(usize, f64),
    /// Left and right image change places.
    Swapped,
    /// The right image is another scene's.
    OneFrozen,
    /// Both images are another scene's.
    BothFrozen,
    /// The right image is moved to the left, px: all disparities are larger by as much.
    Shift(f64),
}

use Damage as D;
use Family as F;

impl Damage {
    /// Every damage of the bench with its family.
    pub(crate) fn all() -> Vec<(Family, Self)> {
        let mut all = Vec::new();
        let mut add = |family: Family, damages: &[Self]| {
            all.extend(damages.iter().map(|&damage| (family, damage)));
        };
        add(F::Undamaged, &[D::None]);
        add(F::SamePixel, &[25.0, 12.0, 6.0, 3.0].map(D::FixedPattern));
        add(F::SamePixel, &[30.0, 15.0, 5.0, 2.0].map(D::ColumnNoise));
        add(F::SamePixel, &[D::RowNoise(10.0), D::OneCameraTwice]);
        add(F::SamePixel, &[12, 4, 1].map(D::Text));
        add(F::SamePixel, &[D::Dirt(12, 10.0), D::Dirt(24, 5.0), D::BrightDirt(24, 5.0)]);
        add(F::SamePixel, &[D::Drops(8, 14.0)]);
        add(F::SamePixel, &[D::DeadColumns(16), D::BrightColumns(16), D::DeadColumns(64)]);
        add(F::MovedRows, &[8.0, 4.0, -4.0, 2.0].map(D::Torn));
        add(F::Sheared, &[8.0, -8.0, 4.0].map(D::RollingShutter));
        add(F::MovedRows, &[D::LostSync(4.0)]);
        add(F::Geometry, &[5.0, 2.0, 1.0, -2.0].map(D::Focal));
        add(F::Geometry, &[2.0, 1.0, 0.5, -1.0].map(D::Roll));
        add(F::Geometry, &[5.0, 3.0, -3.0, 2.0, 1.0, -1.0, 0.5, -0.5].map(D::RowsOff));
        add(F::Geometry, &[6.0, -6.0].map(D::Distortion));
        add(F::Repetition, &[4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0].map(D::Bars));
        add(F::Repetition, &[8.0, 16.0].map(D::Checker));
        add(F::Repetition, &[12.0, 20.0].map(D::Bricks));
        add(F::Detail, &[10, 30, 60].map(D::Jpeg));
        add(F::Detail, &[2, 3, 4].map(D::Bits));
        add(F::Detail, &[1.0, 2.0, 3.0].map(D::Blur));
        add(F::Detail, &[1.0, 2.0].map(D::BlurOneEye));
        add(F::Detail, &[5, 9].map(D::Motion));
        add(F::Detail, &[0.5, 0.25, 0.12].map(D::Fog));
        add(F::OneCamera, &[2.0, 5.0, 10.0, 20.0].map(D::Noise));
        add(F::OneCamera, &[1.0, 5.0].map(D::SaltAndPepper));
        add(F::OneCamera, &[0.8, 0.5, 1.6].map(D::Gain));
        add(F::OneCamera, &[25.0, 60.0].map(D::Covered));
        add(F::OneCamera, &[D::DirtOneEye(24, 5.0), D::DirtOneEye(12, 10.0)]);
        add(F::OneCamera, &[D::Swapped, D::OneFrozen]);
        add(F::Frozen, &[D::BothFrozen]);
        add(F::Sideways, &[2.0, 4.0, 8.0, -2.0].map(D::Shift));
        all
    }

    /// The damaged pair.
    #[must_use]
    pub fn apply(self, source: &Source<'_>) -> [GrayImage; 2] {
        let pair = [source.scene.left.clone(), source.scene.right.clone()];
        let right_only = |change: &dyn Fn(&GrayImage) -> GrayImage| {
            let [left, right] = &pair;
            [left.clone(), change(right)]
        };
        let perturbed = |change: Perturbation| {
            let [left, right] = &pair;
            <[GrayImage; 2]>::from(Perturbation { seed: source.seed, ..change }.apply(left, right))
        };
        let blobs = |image: GrayImage, count: usize, radius: f64, level: u8| {
            sensor::blobs(image, count, radius, level, source.seed)
        };
        let painted = |pattern: &dyn Fn(f64, f64) -> f64| {
            texture::paint(source.scene, source.objects, pattern)
        };
        let none = Perturbation::NONE;
        match self {
            D::None => pair,
            D::FixedPattern(sigma) => sensor::fixed_pattern(pair, sigma, source.seed),
            D::ColumnNoise(sigma) => sensor::line_noise(pair, sigma, source.seed, true),
            D::RowNoise(sigma) => sensor::line_noise(pair, sigma, source.seed, false),
            D::OneCameraTwice => [source.scene.left.clone(), source.scene.left.clone()],
            D::Text(lines) => sensor::text(pair, lines, source.seed),
            D::Dirt(count, radius) => pair.map(|image| blobs(image, count, radius, 25)),
            D::BrightDirt(count, radius) => pair.map(|image| blobs(image, count, radius, 235)),
            D::Drops(count, radius) => {
                pair.map(|image| sensor::drops(&image, count, radius, source.seed))
            }
            D::DeadColumns(step) => pair.map(|image| sensor::columns(image, step, 0)),
            D::BrightColumns(step) => pair.map(|image| sensor::columns(image, step, 255)),
            D::Torn(by) => right_only(&|right| geometry::torn(right, by)),
            D::RollingShutter(by) => right_only(&|right| geometry::sheared(right, by)),
            D::LostSync(by) => right_only(&|right| geometry::bands(right, by)),
            D::Focal(percent) => {
                right_only(&|right| geometry::magnified(right, 1.0 + percent / 100.0))
            }
            D::Roll(degrees) => right_only(&|right| geometry::rotated(right, degrees.to_radians())),
            D::RowsOff(by) => right_only(&|right| geometry::moved(right, 0.0, by)),
            D::Distortion(by) => right_only(&|right| geometry::distorted(right, by)),
            D::Bars(period) => painted(&|x, y| texture::bars(x, y, period)),
            D::Checker(period) => painted(&|x, y| texture::checker(x, y, period)),
            D::Bricks(length) => painted(&|x, y| texture::bricks(x, y, length)),
            D::Jpeg(quality) => pair.map(|image| detail::jpeg(&image, quality)),
            D::Bits(bits) => pair.map(|image| detail::bits(image, bits)),
            D::Blur(sigma) => perturbed(Perturbation { blur: sigma, ..none }),
            D::BlurOneEye(sigma) => {
                let [_, right] = perturbed(Perturbation { blur: sigma, ..none });
                [source.scene.left.clone(), right]
            }
            D::Motion(length) => pair.map(|image| detail::motion(&image, length)),
            D::Fog(contrast) => detail::fog(pair, contrast, source.seed),
            D::Noise(sigma) => perturbed(Perturbation { noise: sigma, ..none }),
            D::SaltAndPepper(percent) => sensor::salt_and_pepper(pair, percent, source.seed),
            D::Gain(gain) => perturbed(Perturbation { gain, ..none }),
            D::Covered(percent) => right_only(&|right| sensor::covered(right.clone(), percent)),
            D::DirtOneEye(count, radius) => {
                right_only(&|right| blobs(right.clone(), count, radius, 25))
            }
            D::Swapped => perturbed(Perturbation { swap: true, ..none }),
            D::OneFrozen => [
                source.scene.left.clone(),
                geometry::fitted(source.other[1], source.scene.left.dims),
            ],
            D::BothFrozen => {
                source.other.map(|image| geometry::fitted(image, source.scene.left.dims))
            }
            D::Shift(by) => right_only(&|right| geometry::moved(right, -by, 0.0)),
        }
    }
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::None => write!(f, "none"),
            Self::FixedPattern(sigma) => write!(f, "fixed pattern noise of {sigma}"),
            Self::ColumnNoise(sigma) => write!(f, "column noise of {sigma}"),
            Self::RowNoise(sigma) => write!(f, "row noise of {sigma}"),
            Self::OneCameraTwice => write!(f, "one camera delivered twice"),
            Self::Text(1) => write!(f, "overlaid text, 1 line"),
            Self::Text(lines) => write!(f, "overlaid text, {lines} lines"),
            Self::Dirt(count, radius) => write!(f, "{count} dark spots, radius {radius}"),
            Self::BrightDirt(count, radius) => write!(f, "{count} bright spots, radius {radius}"),
            Self::Drops(count, radius) => write!(f, "{count} drops, radius {radius}"),
            Self::DeadColumns(step) => write!(f, "dead columns every {step}"),
            Self::BrightColumns(step) => write!(f, "bright columns every {step}"),
            Self::Torn(by) => write!(f, "torn by {by} at half height"),
            Self::RollingShutter(by) => write!(f, "rolling shutter of {by}"),
            Self::LostSync(by) => write!(f, "bands of rows moved by {by}"),
            Self::Focal(percent) => write!(f, "focal length {percent:+} %"),
            Self::Roll(degrees) => write!(f, "roll of {degrees} degrees"),
            Self::RowsOff(by) => write!(f, "rows off by {by}"),
            Self::Distortion(by) => write!(f, "distortion of {by} at the corner"),
            Self::Bars(period) => write!(f, "soft bars, period {period}"),
            Self::Checker(period) => write!(f, "checker, period {period}"),
            Self::Bricks(length) => write!(f, "bricks of {length}"),
            Self::Jpeg(quality) => write!(f, "JPEG quality {quality}"),
            Self::Bits(bits) => write!(f, "{bits} bits"),
            Self::Blur(sigma) => write!(f, "blur of {sigma}"),
            Self::BlurOneEye(sigma) => write!(f, "blur of {sigma}, right alone"),
            Self::Motion(length) => write!(f, "motion blur of {length}"),
            Self::Fog(contrast) => write!(f, "fog, contrast {contrast}"),
            Self::Noise(sigma) => write!(f, "noise of {sigma}"),
            Self::SaltAndPepper(percent) => write!(f, "salt and pepper {percent} %"),
            Self::Gain(gain) => write!(f, "gain {gain} of the right"),
            Self::Covered(percent) => write!(f, "right covered by {percent} %"),
            Self::DirtOneEye(count, radius) => {
                write!(f, "{count} spots, radius {radius}, right alone")
            }
            Self::Swapped => write!(f, "swapped"),
            Self::OneFrozen => write!(f, "right frozen at another scene"),
            Self::BothFrozen => write!(f, "both frozen at another scene"),
            Self::Shift(by) => write!(f, "shift by {by}"),
        }
    }
}
