//! Frames' results as messages of ROS 2 in an `.mcap` file.
//!
//! ```text
//! /linestereo/points         sensor_msgs/PointCloud2: x, y, z, confidence      with a rig
//! /linestereo/segments       visualization_msgs/Marker, a list of lines        with a rig
//! /linestereo/obstacles      sensor_msgs/LaserScan: nearest obstacles          with a rig, of whole pairs
//! /linestereo/drop_offs      sensor_msgs/LaserScan: where the floor ends       with a rig, of whole pairs
//! /tf                        tf2_msgs/TFMessage: the frame of both             with a rig, of whole pairs
//! /linestereo/objects        visualization_msgs/MarkerArray                    where objects are given
//! /linestereo/detections     vision_msgs/Detection3DArray                      the same for other programs
//! /linestereo/health         diagnostic_msgs/DiagnosticArray                   always
//! /linestereo/disparity      stereo_msgs/DisparityImage                        where it is asked for
//! /linestereo/left/image_rect, camera_info, right/..                           where they are asked for
//! ```
//!
//! Frame: the optical one of the left camera, x right, y down, z forward, m. What has no finite
//! depth is left out. Scans have a frame of their own at the left camera, x forward, y left, z up.

use super::health;
use super::point_map::map;
use crate::engine::FrameResult;
use linestereo::obstacles::{ObstacleParams, ObstaclePlan, Obstacles, Sector};
use linestereo::units::{Confidence, Disparity, Position};
use linestereo::{Area, Dims, Params, Rig, results::ImagePosition};
use linestereo_frames::GrayImage;
use linestereo_recordings::mcap::Writer;
use linestereo_recordings::ros::messages::{DisparityImage, Image, RegionOfInterest};
use linestereo_recordings::ros::sent::{self, Beam, Label, Level, Line, Projection, Stamp, Topic};
use linestereo_recordings::ros::{cdr, schema};
use linestereo_wire::RigUpdate;
use serde::Serialize;
use std::io::{self, Write};

const POINTS: Topic = topic("/linestereo/points", "sensor_msgs", "PointCloud2");
const SEGMENTS: Topic = topic("/linestereo/segments", "visualization_msgs", "Marker");
const OBSTACLES: Topic = topic("/linestereo/obstacles", "sensor_msgs", "LaserScan");
const DROP_OFFS: Topic = topic("/linestereo/drop_offs", "sensor_msgs", "LaserScan");
const FRAMES: Topic = topic("/tf", "tf2_msgs", "TFMessage");
const OBJECTS: Topic = topic("/linestereo/objects", "visualization_msgs", "MarkerArray");
const DETECTIONS: Topic = topic("/linestereo/detections", "vision_msgs", "Detection3DArray");
const HEALTH: Topic = topic("/linestereo/health", "diagnostic_msgs", "DiagnosticArray");
const DISPARITY: Topic = topic("/linestereo/disparity", "stereo_msgs", "DisparityImage");
const IMAGES: [Topic; 2] = [
    topic("/linestereo/left/image_rect", "sensor_msgs", "Image"),
    topic("/linestereo/right/image_rect", "sensor_msgs", "Image"),
];
const INFOS: [Topic; 2] = [
    topic("/linestereo/left/camera_info", "sensor_msgs", "CameraInfo"),
    topic("/linestereo/right/camera_info", "sensor_msgs", "CameraInfo"),
];

const fn topic(name: &'static str, package: &'static str, message: &'static str) -> Topic {
    Topic { name, package, message }
}

/// Step of disparities, px.
const DISPARITY_STEP: f32 = 1.0 / 64.0;

/// More than is always written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Extra {
    /// Both images as they were matched, with their CameraInfo.
    Images,
    /// Disparities as an image, empty where there is none.
    Disparity,
}

/// Content of a file, besides what is always written.
#[derive(Clone, Copy, Debug)]
pub struct Content<'a> {
    pub extras: &'a [Extra],
    /// Range and heights of scans. Their frame looks where the camera looks, whatever the yaw.
    /// `None` where pairs are matched in areas alone: what stands elsewhere is not seen.
    pub sectors: Option<ObstacleParams>,
    /// Points are left out.
    pub no_points: bool,
}

#[derive(Clone, Debug)]
pub struct Frame<'a> {
    pub images: &'a [GrayImage; 2],
    pub result: &'a FrameResult,
    /// Parameters by which it was matched.
    pub params: &'a Params,
    /// The numbers behind its rig, where they are known more exactly.
    pub rig_numbers: Option<RigUpdate>,
    /// Objects with a depth; `None` where nobody asked.
    pub objects: Option<Vec<Label>>,
}

/// The file, which grows.
pub struct RosFile<W: Write> {
    writer: Writer<W>,
    extras: Vec<Extra>,
    no_points: bool,
    channels: Vec<(Topic, u16)>,
    /// Range and heights of scans, where there are any.
    sectors: Option<ObstacleParams>,
    /// Kept from pair to pair, of the rig and size of the last one.
    directions: Option<(ObstaclePlan, Obstacles)>,
}

impl<W: Write> RosFile<W> {
    pub fn new(out: W, content: Content<'_>) -> io::Result<Self> {
        let writer = Writer::new(out, concat!("linestereo ", env!("CARGO_PKG_VERSION")))?;
        let Content { extras, sectors, no_points } = content;
        let (extras, channels) = (extras.to_vec(), Vec::new());
        let sectors = sectors.map(|sectors| ObstacleParams { yaw_deg: 0.0, ..sectors });
        Ok(Self { writer, extras, no_points, channels, sectors, directions: None })
    }

    /// The messages of a pair.
    pub fn frame(
        &mut self,
        stamp: Stamp<'_>,
        named: (u64, &str),
        frame: &Frame<'_>,
    ) -> io::Result<()> {
        let (result, size) =
            (frame.result, [frame.images[0].dims.width, frame.images[0].dims.height]);
        let rig = frame.params.rig.as_ref().filter(|rig| rig.principal_point_q16().is_some());
        if let Some(rig) = rig {
            if !self.no_points {
                self.send(POINTS, stamp, &sent::point_cloud(stamp, &points(rig, result)))?;
            }
            self.send(SEGMENTS, stamp, &sent::lines(stamp, &lines(rig, result)))?;
            self.scans(stamp, frame)?;
            if let Some(labels) = &frame.objects {
                self.send(OBJECTS, stamp, &sent::labels(stamp, labels))?;
                self.send(DETECTIONS, stamp, &sent::detections(stamp, labels))?;
            }
        }
        if self.extras.contains(&Extra::Disparity) {
            self.send(DISPARITY, stamp, &disparity_image(stamp, frame))?;
        }
        if self.extras.contains(&Extra::Images) {
            let projection = rig.map(|rig| projection(rig, frame.rig_numbers));
            for eye in 0..2 {
                self.send(
                    IMAGES[eye],
                    stamp,
                    &sent::image(stamp, size, &frame.images[eye].pixels),
                )?;
                if let Some(projection) = &projection {
                    let info = sent::camera_info(stamp, size, projection, eye == 1);
                    self.send(INFOS[eye], stamp, &info)?;
                }
            }
        }
        let flags = health::names(result.health);
        let level = match flags.len() {
            _ if !health::is_fit(result.health) => Level::Error,
            0 => Level::Ok,
            _ => Level::Warn,
        };
        let text = |(name, value): (&str, &str)| (name.to_owned(), value.to_owned());
        let mut values: Vec<_> = health::advice(result.health).map(text).collect();
        let counts = super::listing::counts(&result.counts);
        values.extend(counts.into_iter().map(|(name, count)| (name.to_owned(), count.to_string())));
        let message = if flags.is_empty() { "good".to_owned() } else { flags.join(", ") };
        self.state(stamp, named, level, message, values)
    }

    /// Nearest obstacles and drop-offs after this pair.
    fn scans(&mut self, stamp: Stamp<'_>, frame: &Frame<'_>) -> io::Result<()> {
        let result = frame.result;
        let Some(sectors) = self.sectors else { return Ok(()) };
        let plan = sectors.plan(frame.params, frame.images[0].dims);
        let Ok(plan) = plan else { return Ok(()) }; // a principal point outside of the image
        if self.directions.as_ref().is_none_or(|(known, _)| *known != plan) {
            self.directions = None;
        }
        let (_, obstacles) = self.directions.get_or_insert_with(|| (plan, Obstacles::new()));
        let (points, time_us) = (result.obstacle_points.iter().copied(), stamp.ns / 1000);
        let (plan, health) = (plan.on_ground(result.ground), result.health.of_pair());
        obstacles.update(&plan, &result.matches, points, health, time_us);
        let [nearest, edges] = beams(&plan, obstacles, time_us);
        let range_m = f32::from(plan.range_cm()) / 100.0;
        self.send(FRAMES, stamp, &sent::scan_frame(stamp))?;
        self.send(OBSTACLES, stamp, &sent::scan(stamp, range_m, &nearest))?;
        self.send(DROP_OFFS, stamp, &sent::scan(stamp, range_m, &edges))
    }

    /// The message of one that cannot be matched.
    pub fn failure(&mut self, stamp: Stamp<'_>, named: (u64, &str), error: &str) -> io::Result<()> {
        self.state(stamp, named, Level::Error, error.to_owned(), Vec::new())
    }

    /// Anything had a place in space.
    pub fn has_places(&self) -> bool {
        self.channels.iter().any(|(topic, _)| *topic == SEGMENTS)
    }

    pub fn finish(self) -> io::Result<W> {
        self.writer.finish()
    }

    fn state(
        &mut self,
        stamp: Stamp<'_>,
        (number, name): (u64, &str),
        level: Level,
        message: String,
        values: Vec<(String, String)>,
    ) -> io::Result<()> {
        let named =
            [("frame".to_owned(), number.to_string()), ("name".to_owned(), name.to_owned())];
        let values = named.into_iter().chain(values).collect();
        self.send(HEALTH, stamp, &sent::diagnostics(stamp, level, message, values))
    }

    fn send(&mut self, topic: Topic, stamp: Stamp<'_>, message: &impl Serialize) -> io::Result<()> {
        let channel = self.channel(topic)?;
        self.writer.message(channel, stamp.ns, &cdr::write(message)?)
    }

    /// A topic and its definition are written before its first message.
    fn channel(&mut self, topic: Topic) -> io::Result<u16> {
        if let Some((_, id)) = self.channels.iter().find(|(known, _)| *known == topic) {
            return Ok(*id);
        }
        let Topic { name, package, message } = topic;
        let definition = schema::definition(&format!("{package}/{message}"));
        let id = self.writer.channel(name, &format!("{package}/msg/{message}"), &definition)?;
        self.channels.push((topic, id));
        Ok(id)
    }
}

/// A place in space, m.
fn point(rig: &Rig, at: ImagePosition, disparity: Disparity) -> Option<[f64; 3]> {
    Some(rig.xyz(at, disparity)?.map(|metres| metres.to_num()))
}

fn points(rig: &Rig, result: &FrameResult) -> Vec<[f32; 4]> {
    let place = |found: &linestereo::results::Point| {
        let [x, y, z] = point(rig, found.position(), found.disparity)?.map(|metres| metres as f32);
        Some([x, y, z, found.confidence.to_num()])
    };
    result.points.iter().filter_map(place).collect()
}

fn lines(rig: &Rig, result: &FrameResult) -> Vec<Line> {
    let line = |found: &linestereo::results::Match| {
        let [start, end] = [0, 1].map(|end| point(rig, found.ends[end], found.disparity[end]));
        Some(Line { ends: [start?, end?], confidence: found.confidence.to_num() })
    };
    result.matches.iter().filter_map(line).collect()
}

/// Obstacles and drop-offs all around, from behind counter-clockwise. Both are infinite where a
/// direction is free.
fn beams(plan: &ObstaclePlan, obstacles: &Obstacles, time_us: u64) -> [Vec<Beam>; 2] {
    let beam =
        |range_m: f32, confidence: Confidence| Beam { range_m, confidence: confidence.to_num() };
    let metres = |cm: u16| f32::from(cm) / 100.0;
    let none = beam(f32::NAN, Confidence::ZERO);
    let turn = plan.sectors();
    // Sectors are counted clockwise from ahead.
    let sectors = (0..turn).map(|place| (turn + turn / 2 - place) % turn);
    sectors
        .map(|index| {
            let (nearest, free) = match obstacles.sector(plan, index, time_us) {
                Sector::Outside | Sector::Unknown => (none, none),
                Sector::Free { confidence, .. } => [beam(f32::INFINITY, confidence); 2].into(),
                Sector::Obstacle { distance_cm, confidence, .. } => {
                    (beam(metres(distance_cm), confidence), none)
                }
            };
            let drop_off = obstacles.drop_off(plan, index, time_us);
            let edge =
                drop_off.map_or(free, |found| beam(metres(found.distance_cm), found.confidence));
            (nearest, edge)
        })
        .unzip()
        .into()
}

/// The label of an object, placed at the middle of its area, with the area's size at its depth, m.
pub fn placed(rig: &Rig, area: Area, disparity_px: f64, said: Label) -> Option<Label> {
    let middle = |from: u16, to: u16| {
        Position::saturating_from_num((f64::from(from) + f64::from(to) - 1.0) / 2.0)
    };
    let at = ImagePosition { x: middle(area.left, area.right), y: middle(area.top, area.bottom) };
    let position = point(rig, at, Disparity::saturating_from_num(disparity_px))?;
    let metres_a_pixel = position[2] * 65_536.0 / rig.focal_q16() as f64;
    let size =
        [area.right - area.left, area.bottom - area.top].map(|px| f64::from(px) * metres_a_pixel);
    Some(Label { position, size, ..said })
}

fn projection(rig: &Rig, numbers: Option<RigUpdate>) -> Projection {
    let focal_px = rig.focal_q16() as f64 / 65_536.0;
    let baseline_m = rig.focal_baseline_q16() as f64 / 65_536.0 / focal_px;
    let offset_px = rig.offset_q6() as f64 / 64.0;
    let RigUpdate { focal_px, baseline_m, offset_px } =
        numbers.unwrap_or(RigUpdate { focal_px, baseline_m, offset_px });
    let [x, y] = rig.principal_point_q16().unwrap_or_default().map(|px| f64::from(px) / 65_536.0);
    Projection { focal_px, centres: [[x, y], [x + offset_px, y]], baseline_m }
}

fn disparity_image(stamp: Stamp<'_>, frame: &Frame<'_>) -> DisparityImage<'static> {
    let Dims { width, height } = frame.images[0].dims;
    let projection = frame.params.rig.as_ref().map(|rig| projection(rig, frame.rig_numbers));
    let offset = projection.map_or(0.0, |rig| (rig.centres[1][0] - rig.centres[0][0]) as f32);
    let range = [f32::from(frame.params.min_disparity), f32::from(frame.params.max_disparity)]
        .map(|end| end + offset);
    // As OpenCV marks them.
    let values = map(frame.images[0].dims, frame.result, range[0] - 1.0, |disparity| {
        disparity.to_num::<f32>() + offset
    });
    let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let (encoding, step) = ("32FC1".to_owned(), 4 * u32::from(width));
    DisparityImage {
        header: stamp.into(),
        image: Image {
            encoding,
            step,
            data: data.into(),
            ..sent::image(stamp, [width, height], &[])
        },
        f: projection.map_or(0.0, |rig| rig.focal_px as f32),
        t: projection.map_or(0.0, |rig| rig.baseline_m as f32),
        valid_window: RegionOfInterest {
            height: height.into(),
            width: width.into(),
            ..RegionOfInterest::default()
        },
        min_disparity: range[0],
        max_disparity: range[1],
        delta_d: DISPARITY_STEP,
    }
}
