//! Messages of ROS 2 that are read or written, field by field in the order of their definitions.

#![expect(missing_docs, reason = "fields are named and explained by ROS 2's own definitions")]

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// `builtin_interfaces/msg/Time` and `Duration`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    pub sec: i32,
    pub nanosec: u32,
}

/// `std_msgs/msg/Header`: when and where something was seen.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    pub stamp: Time,
    pub frame_id: String,
}

impl Header {
    /// Time of the exposure, ns; 0 where nobody set it.
    pub fn stamp_ns(&self) -> i64 {
        i64::from(self.stamp.sec) * 1_000_000_000 + i64::from(self.stamp.nanosec)
    }
}

/// `sensor_msgs/msg/Image`: pixel by pixel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Image<'a> {
    pub header: Header,
    pub height: u32,
    pub width: u32,
    pub encoding: String,
    pub is_bigendian: u8,
    pub step: u32,
    #[serde(borrow, with = "serde_bytes")]
    pub data: Cow<'a, [u8]>,
}

/// `sensor_msgs/msg/CompressedImage`: as a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CompressedImage<'a> {
    pub header: Header,
    pub format: String,
    #[serde(borrow, with = "serde_bytes")]
    pub data: Cow<'a, [u8]>,
}

/// `sensor_msgs/msg/RegionOfInterest`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegionOfInterest {
    pub x_offset: u32,
    pub y_offset: u32,
    pub height: u32,
    pub width: u32,
    pub do_rectify: bool,
}

/// `sensor_msgs/msg/CameraInfo`: calibration of a camera; matrices by rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CameraInfo {
    pub header: Header,
    pub height: u32,
    pub width: u32,
    pub distortion_model: String,
    pub d: Vec<f64>,
    pub k: [f64; 9],
    pub r: [f64; 9],
    pub p: [f64; 12],
    pub binning_x: u32,
    pub binning_y: u32,
    pub roi: RegionOfInterest,
}

/// `sensor_msgs/msg/PointField`.
#[derive(Clone, Debug, Serialize)]
pub struct PointField {
    pub name: &'static str,
    pub offset: u32,
    pub datatype: u8,
    pub count: u32,
}

/// `sensor_msgs/msg/PointCloud2`.
#[derive(Clone, Debug, Serialize)]
pub struct PointCloud2 {
    pub header: Header,
    pub height: u32,
    pub width: u32,
    pub fields: Vec<PointField>,
    pub is_bigendian: bool,
    pub point_step: u32,
    pub row_step: u32,
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
    pub is_dense: bool,
}

/// `stereo_msgs/msg/DisparityImage`.
#[derive(Clone, Debug, Serialize)]
pub struct DisparityImage<'a> {
    pub header: Header,
    pub image: Image<'a>,
    pub f: f32,
    pub t: f32,
    pub valid_window: RegionOfInterest,
    pub min_disparity: f32,
    pub max_disparity: f32,
    pub delta_d: f32,
}

/// `geometry_msgs/msg/Pose`, its orientation as x, y, z, w.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    pub position: [f64; 3],
    pub orientation: [f64; 4],
}

/// `visualization_msgs/msg/MeshFile`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct MeshFile {
    pub filename: String,
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

/// `visualization_msgs/msg/Marker`; colours are red, green, blue and opacity.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Marker {
    pub header: Header,
    pub ns: &'static str,
    pub id: i32,
    pub r#type: i32,
    pub action: i32,
    pub pose: Pose,
    pub scale: [f64; 3],
    pub color: [f32; 4],
    pub lifetime: Time,
    pub frame_locked: bool,
    pub points: Vec<[f64; 3]>,
    pub colors: Vec<[f32; 4]>,
    pub texture_resource: String,
    pub texture: CompressedImage<'static>,
    pub uv_coordinates: Vec<[f32; 2]>,
    pub text: String,
    pub mesh_resource: String,
    pub mesh_file: MeshFile,
    pub mesh_use_embedded_materials: bool,
}

/// `visualization_msgs/msg/MarkerArray`.
#[derive(Clone, Debug, Serialize)]
pub struct MarkerArray {
    pub markers: Vec<Marker>,
}

/// `diagnostic_msgs/msg/DiagnosticStatus`; values are pairs of a key and its value.
#[derive(Clone, Debug, Serialize)]
pub struct DiagnosticStatus {
    pub level: u8,
    pub name: &'static str,
    pub message: String,
    pub hardware_id: String,
    pub values: Vec<(String, String)>,
}

/// `diagnostic_msgs/msg/DiagnosticArray`.
#[derive(Clone, Debug, Serialize)]
pub struct DiagnosticArray {
    pub header: Header,
    pub status: Vec<DiagnosticStatus>,
}

/// `sensor_msgs/msg/LaserScan`: angles in rad counter-clockwise, seen from above, ranges in m.
#[derive(Clone, Debug, Serialize)]
pub struct LaserScan {
    pub header: Header,
    pub angle_min: f32,
    pub angle_max: f32,
    pub angle_increment: f32,
    pub time_increment: f32,
    pub scan_time: f32,
    pub range_min: f32,
    pub range_max: f32,
    pub ranges: Vec<f32>,
    pub intensities: Vec<f32>,
}

/// `geometry_msgs/msg/TransformStamped`; the rotation is x, y, z, w.
#[derive(Clone, Debug, Serialize)]
pub struct TransformStamped {
    pub header: Header,
    pub child_frame_id: String,
    pub translation: [f64; 3],
    pub rotation: [f64; 4],
}

/// `tf2_msgs/msg/TFMessage`.
#[derive(Clone, Debug, Serialize)]
pub struct TransformList {
    pub transforms: Vec<TransformStamped>,
}

/// `geometry_msgs/msg/PoseWithCovariance`: 36 numbers by rows, in two halves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseWithCovariance {
    pub pose: Pose,
    pub covariance: [[f64; 18]; 2],
}

/// `vision_msgs/msg/ObjectHypothesisWithPose`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectHypothesisWithPose {
    pub class_id: String,
    pub score: f64,
    pub pose: PoseWithCovariance,
}

/// `vision_msgs/msg/Detection2D`; the centre of its box is x, y and an angle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection2D {
    pub header: Header,
    pub results: Vec<ObjectHypothesisWithPose>,
    pub center: [f64; 3],
    pub size_x: f64,
    pub size_y: f64,
    pub id: String,
}

/// `vision_msgs/msg/Detection2DArray`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection2DArray {
    pub header: Header,
    pub detections: Vec<Detection2D>,
}

/// `vision_msgs/msg/Detection3D`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Detection3D {
    pub header: Header,
    pub results: Vec<ObjectHypothesisWithPose>,
    pub center: Pose,
    pub size: [f64; 3],
    pub id: String,
}

/// `vision_msgs/msg/Detection3DArray`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Detection3DArray {
    pub header: Header,
    pub detections: Vec<Detection3D>,
}
