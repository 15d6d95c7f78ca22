//! Messages that are sent. Positions are in m, in the optical frame of the left camera: x right,
//! y down, z forward (REP 103).

use super::kind::NO_ROTATION;
use super::messages::{
    CameraInfo, Detection3D, Detection3DArray, DiagnosticArray, DiagnosticStatus, Header, Image,
    LaserScan, Marker, MarkerArray, ObjectHypothesisWithPose, PointCloud2, PointField, Pose,
    PoseWithCovariance, Time, TransformList, TransformStamped,
};

/// When and where a pair was seen.
#[derive(Clone, Copy, Debug)]
pub struct Stamp<'a> {
    /// Its time, ns.
    pub ns: u64,
    /// Name of the frame.
    pub frame_id: &'a str,
}

/// A type of messages, and its topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Topic {
    /// Name of the topic.
    pub name: &'static str,
    /// Package of the type.
    pub package: &'static str,
    /// Name of the type.
    pub message: &'static str,
}

/// Points in space with their confidence: x, y, z, confidence.
pub type CloudPoint = [f32; 4];

/// A line in space, with its confidence.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Its ends.
    pub ends: [[f64; 3]; 2],
    /// Probability.
    pub confidence: f32,
}

/// An object in space, with a word about it.
#[derive(Clone, Debug, Default)]
pub struct Label {
    /// Where.
    pub position: [f64; 3],
    /// The word.
    pub text: String,
    /// Probability.
    pub confidence: f32,
    /// Class that the detector gives it.
    pub class: String,
    /// Score that the detector gives it.
    pub score: f64,
    /// Name of its track, by the detector.
    pub id: String,
    /// Width and height of its box at its depth, m.
    pub size: [f64; 2],
    /// Standard deviation of the depth, m.
    pub sigma_m: f64,
}

/// A distance in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Distance, m; infinite where nothing is as far as the range, not a number where it is
    /// unknown.
    pub range_m: f32,
    /// Probability.
    pub confidence: f32,
}

/// A rig of rectified images.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// Focal length, px.
    pub focal_px: f64,
    /// Principal points of left and right, px.
    pub centres: [[f64; 2]; 2],
    /// Distance of the cameras, m.
    pub baseline_m: f64,
}

/// State of what is watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// All is well.
    Ok,
    /// To be looked after.
    Warn,
    /// Not to be relied on.
    Error,
}

/// `PointField.FLOAT32`.
const FLOAT32: u8 = 7;
/// Types of `Marker`, and the action that removes all.
const SPHERE: i32 = 2;
const LINE_LIST: i32 = 5;
const TEXT: i32 = 9;
const DELETE_ALL: i32 = 3;
/// Width of lines, diameter of balls and height of letters, m.
const LINE_WIDTH: f64 = 0.005;
const BALL: f64 = 0.05;
const LETTERS: f64 = 0.1;
/// Least distance that is told, m.
const LEAST_RANGE: f32 = 0.01;

impl From<Stamp<'_>> for Header {
    /// Seconds of 31 bits: beyond the year 2038 it stays there.
    fn from(Stamp { ns, frame_id }: Stamp<'_>) -> Self {
        let sec = i32::try_from(ns / 1_000_000_000).unwrap_or(i32::MAX);
        Self {
            stamp: Time { sec, nanosec: (ns % 1_000_000_000) as u32 },
            frame_id: frame_id.to_owned(),
        }
    }
}

/// 8-bit grey.
pub fn image<'a>(stamp: Stamp<'_>, [width, height]: [u16; 2], pixels: &'a [u8]) -> Image<'a> {
    Image {
        header: stamp.into(),
        height: height.into(),
        width: width.into(),
        encoding: "mono8".to_owned(),
        is_bigendian: 0,
        step: width.into(),
        data: pixels.into(),
    }
}

/// Calibration of the left or the right rectified image.
pub fn camera_info(
    stamp: Stamp<'_>,
    [width, height]: [u16; 2],
    rig: &Projection,
    is_right: bool,
) -> CameraInfo {
    let (f, [x, y]) = (rig.focal_px, rig.centres[usize::from(is_right)]);
    let along = if is_right { -f * rig.baseline_m } else { 0.0 };
    CameraInfo {
        header: stamp.into(),
        height: height.into(),
        width: width.into(),
        distortion_model: "plumb_bob".to_owned(),
        d: vec![0.0; 5],
        k: [f, 0.0, x, 0.0, f, y, 0.0, 0.0, 1.0],
        r: NO_ROTATION,
        p: [f, 0.0, x, along, 0.0, f, y, 0.0, 0.0, 0.0, 1.0, 0.0],
        ..CameraInfo::default()
    }
}

/// Points, each of them finite.
pub fn point_cloud(stamp: Stamp<'_>, points: &[CloudPoint]) -> PointCloud2 {
    let (count, size) = (points.len() as u32, size_of::<CloudPoint>() as u32);
    let names = ["x", "y", "z", "confidence"].into_iter().zip((0..).step_by(size_of::<f32>()));
    PointCloud2 {
        header: stamp.into(),
        height: 1,
        width: count,
        fields: names
            .map(|(name, offset)| PointField { name, offset, datatype: FLOAT32, count: 1 })
            .collect(),
        is_bigendian: false,
        point_step: size,
        row_step: size * count,
        data: points.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect(),
        is_dense: true,
    }
}

/// A list of lines, which replaces the one before.
pub fn lines(stamp: Stamp<'_>, lines: &[Line]) -> Marker {
    Marker {
        ns: "segments",
        scale: [LINE_WIDTH, 0.0, 0.0],
        points: lines.iter().flat_map(|line| line.ends).collect(),
        colors: lines.iter().flat_map(|line| [colour(line.confidence); 2]).collect(),
        ..marker(stamp, 0, LINE_LIST)
    }
}

/// A ball and a text for each, in place of those before.
pub fn labels(stamp: Stamp<'_>, labels: &[Label]) -> MarkerArray {
    let mut markers =
        vec![Marker { action: DELETE_ALL, scale: [BALL; 3], ..marker(stamp, 0, SPHERE) }];
    for (label, id) in labels.iter().zip((0..).step_by(2)) {
        let [x, y, z] = label.position;
        let mut ball = Marker {
            color: colour(label.confidence),
            scale: [BALL; 3],
            ..marker(stamp, id, SPHERE)
        };
        ball.pose.position = label.position;
        let mut text = Marker {
            text: label.text.clone(),
            scale: [0.0, 0.0, LETTERS],
            ..marker(stamp, id + 1, TEXT)
        };
        text.pose.position = [x, y - LETTERS, z];
        markers.extend([ball, text]);
    }
    MarkerArray { markers }
}

/// The same for other programs: boxes at the depths of their objects, which are 0 deep, since
/// nobody knows how deep they are. The variance of z is in the covariance.
pub fn detections(stamp: Stamp<'_>, labels: &[Label]) -> Detection3DArray {
    let detection = |label: &Label| {
        let center = Pose { position: label.position, orientation: [0.0, 0.0, 0.0, 1.0] };
        let mut covariance = [[0.0; 18]; 2];
        covariance[0][14] = label.sigma_m * label.sigma_m;
        let pose = PoseWithCovariance { pose: center, covariance };
        let [width, height] = label.size;
        Detection3D {
            header: stamp.into(),
            results: vec![ObjectHypothesisWithPose {
                class_id: label.class.clone(),
                score: label.score,
                pose,
            }],
            center,
            size: [width, height, 0.0],
            id: label.id.clone(),
        }
    };
    Detection3DArray { header: stamp.into(), detections: labels.iter().map(detection).collect() }
}

/// Distances all around, from behind counter-clockwise as seen from above, in [`scan_frame`]; none
/// is as large as `range_m`.
pub fn scan(stamp: Stamp<'_>, range_m: f32, beams: &[Beam]) -> LaserScan {
    let increment = core::f32::consts::TAU / beams.len().max(1) as f32;
    LaserScan {
        header: Stamp { frame_id: &scan_frame_id(stamp.frame_id), ..stamp }.into(),
        angle_min: -core::f32::consts::PI,
        angle_max: core::f32::consts::PI - increment,
        angle_increment: increment,
        time_increment: 0.0,
        scan_time: 0.0,
        range_min: LEAST_RANGE,
        range_max: range_m,
        ranges: beams.iter().map(|beam| beam.range_m).collect(),
        intensities: beams.iter().map(|beam| beam.confidence).collect(),
    }
}

/// Where the frame of scans lies: at the left camera, x forward along its optical axis, y left, z
/// up.
pub fn scan_frame(stamp: Stamp<'_>) -> TransformList {
    let transform = TransformStamped {
        header: stamp.into(),
        child_frame_id: scan_frame_id(stamp.frame_id),
        translation: [0.0; 3],
        rotation: [0.5, -0.5, 0.5, 0.5],
    };
    TransformList { transforms: vec![transform] }
}

/// `left_camera_scan` of `left_camera_optical_frame`.
fn scan_frame_id(optical: &str) -> String {
    format!("{}_scan", optical.strip_suffix("_optical_frame").unwrap_or(optical))
}

/// A white marker that is not turned and stays until the next one.
fn marker(stamp: Stamp<'_>, id: i32, r#type: i32) -> Marker {
    let pose = Pose { position: [0.0; 3], orientation: [0.0, 0.0, 0.0, 1.0] };
    Marker {
        header: stamp.into(),
        ns: "objects",
        id,
        r#type,
        pose,
        color: [1.0; 4],
        ..Marker::default()
    }
}

/// Green, from faint to full.
fn colour(confidence: f32) -> [f32; 4] {
    [0.1, 1.0, 0.3, confidence]
}

/// One state.
pub fn diagnostics(
    stamp: Stamp<'_>,
    level: Level,
    message: String,
    values: Vec<(String, String)>,
) -> DiagnosticArray {
    let hardware_id = stamp.frame_id.to_owned();
    let status = DiagnosticStatus {
        level: level as u8,
        name: "linestereo: pair",
        message,
        hardware_id,
        values,
    };
    DiagnosticArray { header: stamp.into(), status: vec![status] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scans_turn_left_from_behind_in_a_frame_beside_the_optical_one() {
        let stamp = Stamp { ns: 2_500_000_000, frame_id: "left_camera_optical_frame" };
        let beam = |range_m| Beam { range_m, confidence: 0.5 };
        let found = scan(stamp, 10.0, &[1.0, f32::INFINITY, f32::NAN, 4.0].map(beam));
        assert_eq!((&*found.header.frame_id, found.header.stamp.sec), ("left_camera_scan", 2));
        let quarter = core::f32::consts::FRAC_PI_2;
        assert_eq!((found.angle_min, found.angle_increment), (-2.0 * quarter, quarter));
        assert!((found.angle_max - quarter).abs() < 1e-6);
        assert!(found.ranges[1].is_infinite() && found.ranges[2].is_nan());

        let [frame] = &scan_frame(stamp).transforms[..] else { panic!("one frame") };
        let [x, y, z, w] = frame.rotation;
        // Forward, left and up in the optical frame: columns of the rotation's matrix.
        let columns = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
            [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
            [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        assert_eq!(columns, [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);
        assert_eq!(
            (&*frame.header.frame_id, &*frame.child_frame_id),
            ("left_camera_optical_frame", "left_camera_scan")
        );
        assert_eq!(scan_frame_id("cam"), "cam_scan");
    }
}
