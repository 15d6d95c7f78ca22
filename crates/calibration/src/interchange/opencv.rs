//! OpenCV's calibration files: YAML or XML of `cv::FileStorage`, one file or several.
//!
//! # Conventions
//! Matrices by rows. A point `X` of the first (left) camera is at `R X + T` in the second: `T[0] <
//! 0` for a right camera. The unit of `T` is that of the board's squares, which the file does not
//! tell (see [`TranslationUnit`]). `R1`, `R2` turn each camera into the rectified directions,
//! `P2[0][3] = T_x * focal`. Whole pixel positions are pixel centres, as here. `fisheye` cameras
//! keep their skew as `alpha`: `K[0][1] = fx * alpha`, the same as ours; others have none.
//!
//! Names are habits, not a format: capitals and punctuation do not count, and the ones of
//! [`super::names`] are known. Where `R` and `T` are not there, `R1`, `R2`, `P1`, `P2` say the
//! same.
//!
//! # Source
//! OpenCV 4 documentation, "Camera Calibration and 3D Reconstruction": `stereoCalibrate`,
//! `stereoRectify`, `fisheye`; its samples `stereo_calib.cpp` (M1 D1 M2 D2, R T R1 R2 P1 P2 Q) and
//! `calibration.cpp` (camera_matrix, image_width).

use super::camera::{LensModel, camera, coefficients, intrinsics, matrix};
use super::error::{Fault, Place, Problem};
use super::names::{Found, Names};
use super::node::{Matrix, Node};
use super::pose::{self, Pose, Rows};
use super::{Options, StoredRectification, TranslationUnit};
use crate::rig_file::quaternion;
use linestereo::Dims;
use linestereo_frames::rectified::check_centre;
use linestereo_rig::{Calibration, CameraSide, Lens, View};
use nalgebra::{Matrix3, Vector3};

const CAMERA: &[&str] = &[
    "cameramatrix", "m", "k", "cm", "mtx", "matrix", "intrinsic", "intrinsics", "intrinsicmatrix",
];
const LENS: &[&str] = &[
    "d", "dist", "distcoeff", "distcoeffs", "distcoef", "distcoefs", "distortion",
    "distortioncoefficients", "distortioncoeffs", "dc", "kc",
];
const ROTATION: &[&str] = &[
    "r", "rmat", "rotation", "rotationmatrix", "rot", "rstereo", "stereor", "r12", "rlr", "om",
    "rvec", "rotationvector",
];
const TRANSLATION: &[&str] = &[
    "t", "translation", "translationvector", "translationmatrix", "trans", "tvec", "tstereo",
    "stereot", "t12", "tlr",
];
const RECTIFICATION: &[&str] = &["r", "rect", "rectification", "rectificationmatrix"];
const PROJECTION: &[&str] = &["p", "proj", "projection", "projectionmatrix"];

/// How far stored rectifications may be from what `R` and `T` say: an entry of a rotation, a share
/// of the baseline.
const CONTRADICTION: f64 = 0.01;
/// A length below this is taken as metres, above as millimetres.
const LONGEST_IN_METRES: f64 = 5.0;
/// Sides of the squares of boards, m: a file that says 1 means that its lengths are in squares, or
/// nothing.
const SQUARES: core::ops::RangeInclusive<f64> = 0.002..=0.5;
/// Baselines outside of this are worth a word, m.
const USUAL: core::ops::RangeInclusive<f64> = 0.01..=1.0;

/// Content of a file.
pub(super) struct Read {
    pub(super) calibration: Calibration,
    pub(super) stored: Option<StoredRectification>,
    pub(super) notes: Vec<String>,
}

pub(super) fn read(files: &[Node], options: &Options) -> Result<Read, Fault> {
    let names = Names::of(files);
    let mut notes = Vec::new();
    let [left, right] = names
        .pair("camera matrices (M1 and M2, K1 and K2, cameraMatrix1 and 2 ...)", CAMERA)?
        .ok_or_else(|| {
            missing("there are no two camera matrices (M1 and M2, camera_matrix in two files ...)")
        })?;
    let lenses = names.pair("distortion coefficients", LENS)?.ok_or_else(|| {
        missing("there are no two lists of distortion coefficients (D1 and D2 ...)")
    })?;
    let (left, right) = (left.node.matrix(&left.name)?, right.node.matrix(&right.name)?);
    let dims = dims(&names, options, intrinsics(&left)?.1)?;
    let model = lens_model(&names, options)?;
    let one = |eye, matrix: &Matrix, lens: &Found<'_>| {
        let lens = model.lens(&lens.node.matrix(&lens.name)?)?;
        camera((eye, matrix.place), dims, intrinsics(matrix)?, lens)
    };
    let cameras =
        [one(CameraSide::Left, &left, &lenses[0])?, one(CameraSide::Right, &right, &lenses[1])?];
    if model == LensModel::BrownConrady && cameras.iter().any(|camera| camera.skew() != 0.0) {
        notes.push("the skew is kept; OpenCV itself takes no notice of it".to_owned());
    }
    let rectified = rectification(&names, &mut notes)?;
    let (pose, place) = pose(&names, rectified.as_ref().map(|found| &found.pose), &mut notes)?;
    let (scale, note) = scale(&pose, options.translation_unit, square(&names)?);
    notes.push(note);
    let scaled = Pose { translation: pose.translation * scale, ..pose };
    let calibration = scaled.pair(cameras, options.swap, place)?;
    let stored =
        rectified.filter(|_| !options.swap).and_then(|found| found.stored(&pose, &mut notes));
    Ok(Read { calibration, stored, notes })
}

fn missing(what: &str) -> Fault {
    Problem::Missing(what.to_owned()).anywhere()
}

fn dims(names: &Names<'_>, options: &Options, centre: [f64; 2]) -> Result<Dims, Fault> {
    match (names.size()?, options.size) {
        (Some((file, place)), Some(given)) if file != given => {
            Err(Problem::SizeDiffers { file, given }.at(place))
        }
        (Some((dims, _)), _) | (None, Some(dims)) => Ok(dims),
        (None, None) => match options.images {
            Some(images) => check_centre(centre, images)
                .map(|()| images)
                .map_err(|unfit| Problem::Unfit(CameraSide::Left, unfit).anywhere()),
            None => Err(Problem::NoSize { guess: centre.map(|c| 2.0 * c + 1.0) }.anywhere()),
        },
    }
}

fn lens_model(names: &Names<'_>, options: &Options) -> Result<LensModel, Fault> {
    match (stated_lens(names)?, options.lens) {
        (Some((file, place)), Some(given)) if file != given => {
            Err(Problem::Stated("--lens").at(place))
        }
        (Some((model, _)), _) | (None, Some(model)) => Ok(model),
        (None, None) => Ok(LensModel::BrownConrady),
    }
}

/// The lens model that the file states, and where.
fn stated_lens(names: &Names<'_>) -> Result<Option<(LensModel, Place)>, Fault> {
    if let Some(found) = names.word(&["fisheyemodel", "fisheye", "isfisheye"]) {
        let word = found.node.text().unwrap_or("");
        let is_fisheye =
            word.eq_ignore_ascii_case("true") || word.parse().is_ok_and(|value: f64| value != 0.0);
        let model = if is_fisheye { LensModel::Fisheye } else { LensModel::BrownConrady };
        return Ok(Some((model, found.node.place)));
    }
    let Some(found) = names.word(&["distortionmodel", "lensmodel"]) else { return Ok(None) };
    let model = LensModel::named(found.node.text().unwrap_or(""), found.node.place)?;
    Ok(Some((model.unwrap_or(LensModel::BrownConrady), found.node.place)))
}

/// From left to right, in the unit of the file.
fn pose(
    names: &Names<'_>,
    rectified: Option<&Pose>,
    notes: &mut Vec<String>,
) -> Result<(Pose, Option<Place>), Fault> {
    let (rotation, translation) = (names.single(ROTATION)?, names.single(TRANSLATION)?);
    match (rotation, translation, rectified) {
        (Some(rotation), Some(translation), _) => {
            let turn = rotation.node.matrix(&rotation.name)?;
            let rotation = match turn.vector_of() {
                Ok(vector) => linestereo_rig::rotation_matrix(quaternion(vector)),
                Err(_) => pose::rotation(&turn)?,
            };
            let translation = translation.node.matrix(&translation.name)?;
            let pose = Pose { rotation, translation: Vector3::from(translation.vector_of::<3>()?) };
            Ok((pose, Some(translation.place)))
        }
        (_, _, Some(&pose)) => {
            notes.push("there are no R and T: the pose is taken from R1, R2, P1 and P2".to_owned());
            Ok((pose, None))
        }
        _ => Err(missing(
            "there is no pose between the cameras (R and T, or R1, R2, P1 and P2); give the file \
             of the extrinsics too",
        )),
    }
}

/// Side of the board's squares in the unit of the file, where it is told.
fn square(names: &Names<'_>) -> Result<Option<f64>, Fault> {
    names.word(&["squaresize"]).map(|found| found.node.number(&found.name)).transpose()
}

/// Metres per unit of the file, and what was taken for it.
fn scale(pose: &Pose, unit: Option<TranslationUnit>, square: Option<f64>) -> (f64, String) {
    let length = pose.translation.norm();
    let likely = |unit, square| {
        format!("lengths are assumed to be in {unit}, since square_size is {square}")
    };
    let (scale, mut note) = match (unit, square) {
        (Some(TranslationUnit::Metres), _) => (1.0, "lengths are in m".to_owned()),
        (Some(TranslationUnit::Millimetres), _) => (1e-3, "lengths are in mm".to_owned()),
        (Some(TranslationUnit::Squares { millimetres }), _) => {
            (millimetres * 1e-3, format!("lengths are in squares of {millimetres} mm"))
        }
        (None, Some(square)) if SQUARES.contains(&square) => (1.0, likely("m", square)),
        (None, Some(square)) if SQUARES.contains(&(square * 1e-3)) => (1e-3, likely("mm", square)),
        (None, _) if length < LONGEST_IN_METRES => {
            (1.0, "lengths are assumed to be in m".to_owned())
        }
        (None, _) => (1e-3, "lengths are assumed to be in mm".to_owned()),
    };
    let baseline = length * scale;
    note.push_str(&format!(": the baseline is {baseline:.4} m"));
    if unit.is_none() || !USUAL.contains(&baseline) {
        note.push_str(
            "; if that is wrong, give --translation-unit m, mm or the board's squares in mm",
        );
    }
    (scale, note)
}

struct Rectified {
    pose: Pose,
    rotations: [Matrix3<f64>; 2],
    projections: [[f64; 12]; 2],
}

fn rectification(names: &Names<'_>, notes: &mut Vec<String>) -> Result<Option<Rectified>, Fault> {
    let rotations = names.pair("rectifying rotations", RECTIFICATION)?;
    let projections = names.pair("projections", PROJECTION)?;
    let (Some(rotations), Some(projections)) = (rotations, projections) else { return Ok(None) };
    let matrix = |found: &Found<'_>| found.node.matrix(&found.name);
    let [p1, p2] = [matrix(&projections[0])?, matrix(&projections[1])?];
    let rotations =
        [pose::rotation(&matrix(&rotations[0])?)?, pose::rotation(&matrix(&rotations[1])?)?];
    match pose::from_rectification([&rotations[0], &rotations[1]], [&p1, &p2]) {
        Ok(pose) => Ok(Some(Rectified {
            pose,
            rotations,
            projections: [p1.shaped(3, 4)?, p2.shaped(3, 4)?],
        })),
        // Not what the pose hangs on, unless there is no other: then its absence is reported.
        Err(Fault { problem, .. }) => {
            notes.push(format!("the stored rectification is not used: {problem}"));
            Ok(None)
        }
    }
}

impl Rectified {
    /// The part of a projection that is kept: one focal length and one centre, in accordance with
    /// the pose.
    fn stored(&self, pose: &Pose, notes: &mut Vec<String>) -> Option<StoredRectification> {
        let turned = (self.pose.rotation - pose.rotation).abs().max();
        let moved = (self.pose.translation - pose.translation).norm() / pose.translation.norm();
        if turned > CONTRADICTION || moved > CONTRADICTION {
            notes.push(
                "the stored rectification (R1, R2, P1, P2) contradicts R and T and is not used"
                    .to_owned(),
            );
            return None;
        }
        let [[fx, _, cx, _, _, fy, cy, ..], [fx2, _, cx2, _, _, fy2, cy2, ..]] = self.projections;
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs().max(1.0);
        if ![(fx, fy), (fx, fx2), (fx, fy2), (cx, cx2), (cy, cy2)]
            .into_iter()
            .all(|(a, b)| same(a, b))
        {
            notes.push(
                "the stored rectification has different centres or focal lengths and is not kept"
                    .to_owned(),
            );
            return None;
        }
        let rotations: [Rows; 2] = [pose::rows(&self.rotations[0]), pose::rows(&self.rotations[1])];
        Some(StoredRectification { rotations, focal: fx, centre: [cx, cy] })
    }
}

/// A matrix to be written.
struct Entry {
    name: &'static str,
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

/// Matrices of an export: the names of OpenCV's `stereo_calib` in one file, lengths in metres.
fn entries(calibration: &Calibration) -> Result<Vec<Entry>, Problem> {
    let [left, right] = CameraSide::BOTH.map(|eye| calibration.camera(eye));
    let entry = |name, rows, data: &[f64]| Entry {
        name,
        rows,
        cols: data.len() / rows,
        data: data.to_vec(),
    };
    let lens = |lens: Lens| coefficients(lens, false);
    let pose = Pose::of(calibration);
    let mut entries = vec![
        entry("M1", 3, &matrix(left)),
        entry("D1", 1, &lens(left.lens())),
        entry("M2", 3, &matrix(right)),
        entry("D2", 1, &lens(right.lens())),
        entry("R", 3, pose::rows(&pose.rotation).as_flattened()),
        entry("T", 3, pose.translation.as_slice()),
    ];
    let rectified = calibration.rectify(left.dims(), View::default()).map_err(Problem::Rectify)?;
    let [r1, r2] = rectified.rotations();
    let ([p1, p2], q) = (projections(&rectified), reprojection(&rectified));
    entries.extend([entry("R1", 3, r1.as_flattened()), entry("R2", 3, r2.as_flattened())]);
    entries.extend([entry("P1", 3, &p1), entry("P2", 3, &p2), entry("Q", 4, &q)]);
    Ok(entries)
}

/// `P1` and `P2`.
pub(super) fn projections(rectified: &linestereo_rig::Rectification) -> [[f64; 12]; 2] {
    let (focal, [cx, cy]) = (rectified.focal(), rectified.centre());
    [0.0, -focal * rectified.baseline()]
        .map(|along| [focal, 0.0, cx, along, 0.0, focal, cy, 0.0, 0.0, 0.0, 1.0, 0.0])
}

/// `Q`: `(x, y, disparity, 1)` to homogeneous metres.
fn reprojection(rectified: &linestereo_rig::Rectification) -> [f64; 16] {
    let (focal, [cx, cy], inverse) =
        (rectified.focal(), rectified.centre(), 1.0 / rectified.baseline());
    [1.0, 0.0, 0.0, -cx, 0.0, 1.0, 0.0, -cy, 0.0, 0.0, 0.0, focal, 0.0, 0.0, inverse, 0.0]
}

/// One model for both cameras: whether it is the fisheye.
fn is_fisheye(calibration: &Calibration) -> Result<bool, Problem> {
    match CameraSide::BOTH.map(|eye| matches!(calibration.camera(eye).lens(), Lens::Fisheye { .. }))
    {
        [left, right] if left == right => Ok(left),
        _ => Err(Problem::NotRepresentable {
            format: "OpenCV",
            what: "a fisheye beside another lens",
        }),
    }
}

pub(super) fn yaml(calibration: &Calibration) -> Result<String, Problem> {
    let Dims { width, height } = calibration.camera(CameraSide::Left).dims();
    let fisheye = u8::from(is_fisheye(calibration)?);
    let mut text = format!(
        "%YAML:1.0\n---\nimage_width: {width}\nimage_height: {height}\nfisheye_model: {fisheye}\n"
    );
    for Entry { name, rows, cols, data } in entries(calibration)? {
        text.push_str(&format!(
            "{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n   data: {data:?}\n"
        ));
    }
    Ok(text)
}

pub(super) fn xml(calibration: &Calibration) -> Result<String, Problem> {
    let Dims { width, height } = calibration.camera(CameraSide::Left).dims();
    let fisheye = u8::from(is_fisheye(calibration)?);
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>{width}</image_width>\n\
         <image_height>{height}</image_height>\n<fisheye_model>{fisheye}</fisheye_model>\n"
    );
    for Entry { name, rows, cols, data } in entries(calibration)? {
        let data: Vec<String> = data.iter().map(|value| format!("{value:?}")).collect();
        text.push_str(&format!(
            "<{name} type_id=\"opencv-matrix\">\n  <rows>{rows}</rows>\n  <cols>{cols}</cols>\n  <dt>d</dt>\n  \
             <data>\n    {}</data></{name}>\n",
            data.join(" ")
        ));
    }
    text.push_str("</opencv_storage>\n");
    Ok(text)
}
