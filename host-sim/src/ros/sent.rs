//! Messages that are sent. Positions are in m, in the optical frame of the left camera: x right, y down, z forward (REP 103).

use super::cdr::Writer;

/// When and where a pair was seen.
#[derive(Clone, Copy, Debug)]
pub struct Header<'a> {
    /// ns.
    pub stamp_ns: u64,
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

/// A place with a word about it.
#[derive(Clone, Debug)]
pub struct Label {
    /// Where.
    pub position: [f64; 3],
    /// The word.
    pub text: String,
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

/// Disparities, where there are any.
#[derive(Clone, Debug)]
pub struct Disparities<'a> {
    /// Columns and rows.
    pub size: [u16; 2],
    /// By rows, less the offset of the principal points; below `range[0]` where there is none.
    pub values: &'a [f32],
    /// Focal length, px, and distance of the cameras, m.
    pub rig: [f32; 2],
    /// Least and largest that was searched.
    pub range: [f32; 2],
    /// Step.
    pub step: f32,
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

/// Type of a marker.
#[derive(Clone, Copy)]
enum Shape {
    Sphere = 2,
    Lines = 5,
    Text = 9,
}

/// Action of a marker.
#[derive(Clone, Copy)]
enum Action {
    Add = 0,
    DeleteAll = 3,
}

/// `PointField.FLOAT32`.
const FLOAT32: u8 = 7;
/// Width of lines, diameter of balls and height of letters, m.
const LINE_WIDTH: f64 = 0.005;
const BALL: f64 = 0.05;
const LETTERS: f64 = 0.1;

fn begin(header: Header<'_>) -> Writer {
    let mut to = Writer::default();
    put_header(&mut to, header);
    to
}

fn put_header(to: &mut Writer, header: Header<'_>) {
    put_time(to, header.stamp_ns);
    to.text(header.frame_id);
}

/// Seconds of 31 bits: beyond the year 2038 it stays there.
fn put_time(to: &mut Writer, nanoseconds: u64) {
    to.i32(i32::try_from(nanoseconds / 1_000_000_000).unwrap_or(i32::MAX));
    to.u32((nanoseconds % 1_000_000_000) as u32);
}

/// `sensor_msgs/msg/Image` of 8-bit grey.
#[must_use]
pub fn image(header: Header<'_>, [width, height]: [u16; 2], pixels: &[u8]) -> Vec<u8> {
    let mut to = begin(header);
    put_image(&mut to, [width, height], "mono8", 1, |to| to.bytes(pixels));
    to.finish()
}

fn put_image(to: &mut Writer, size: [u16; 2], encoding: &str, bytes: u32, data: impl FnOnce(&mut Writer)) {
    let [width, height] = size.map(u32::from);
    to.u32(height);
    to.u32(width);
    to.text(encoding);
    to.u8(0); // little endian
    to.u32(width * bytes);
    data(to);
}

/// `sensor_msgs/msg/CameraInfo` of the left or the right rectified image.
#[must_use]
pub fn camera_info(header: Header<'_>, [width, height]: [u16; 2], rig: &Projection, is_right: bool) -> Vec<u8> {
    let mut to = begin(header);
    let (f, [x, y]) = (rig.focal_px, rig.centres[usize::from(is_right)]);
    to.u32(height.into());
    to.u32(width.into());
    to.text("plumb_bob");
    to.count(5);
    to.f64s(&[0.0; 5]);
    to.f64s(&[f, 0.0, x, 0.0, f, y, 0.0, 0.0, 1.0]);
    to.f64s(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let along = if is_right { -f * rig.baseline_m } else { 0.0 };
    to.f64s(&[f, 0.0, x, along, 0.0, f, y, 0.0, 0.0, 0.0, 1.0, 0.0]);
    (0..6).for_each(|_| to.u32(0)); // binning, region of interest
    to.u8(0);
    to.finish()
}

/// `sensor_msgs/msg/PointCloud2`.
#[must_use]
pub fn point_cloud(header: Header<'_>, points: &[CloudPoint]) -> Vec<u8> {
    let mut to = begin(header);
    let (count, size) = (points.len() as u32, size_of::<CloudPoint>() as u32);
    to.u32(1);
    to.u32(count);
    let names = ["x", "y", "z", "confidence"];
    to.count(names.len());
    for (name, offset) in names.into_iter().zip((0..).step_by(size_of::<f32>())) {
        to.text(name);
        to.u32(offset);
        to.u8(FLOAT32);
        to.u32(1);
    }
    to.u8(0); // little endian
    to.u32(size);
    to.u32(size * count);
    to.count(size_of_val(points));
    to.f32s(points.as_flattened());
    to.u8(1); // each is finite
    to.finish()
}

/// `stereo_msgs/msg/DisparityImage`.
#[must_use]
pub fn disparity_image(header: Header<'_>, of: &Disparities<'_>) -> Vec<u8> {
    let mut to = begin(header);
    put_header(&mut to, header);
    put_image(&mut to, of.size, "32FC1", size_of::<f32>() as u32, |to| {
        to.count(size_of_val(of.values));
        to.f32s(of.values);
    });
    to.f32s(&of.rig);
    let [width, height] = of.size.map(u32::from);
    [0, 0, height, width].into_iter().for_each(|side| to.u32(side));
    to.u8(0);
    to.f32s(&[of.range[0], of.range[1], of.step]);
    to.finish()
}

/// `visualization_msgs/msg/Marker`: a list of lines, which replaces the one before.
#[must_use]
pub fn lines(header: Header<'_>, lines: &[Line]) -> Vec<u8> {
    let mut to = Writer::default();
    let points: Vec<[f64; 3]> = lines.iter().flat_map(|line| line.ends).collect();
    let colours: Vec<[f32; 4]> = lines.iter().flat_map(|line| [colour(line.confidence); 2]).collect();
    let marker = Marker { points: &points, colours: &colours, ..Marker::new(header, 0, Shape::Lines) };
    marker.put(&mut to);
    to.finish()
}

/// `visualization_msgs/msg/MarkerArray`: a ball and a text for each, in place of those before.
#[must_use]
pub fn labels(header: Header<'_>, labels: &[Label]) -> Vec<u8> {
    let mut to = Writer::default();
    to.count(1 + 2 * labels.len());
    Marker { action: Action::DeleteAll, ..Marker::new(header, 0, Shape::Sphere) }.put(&mut to);
    for (label, id) in labels.iter().zip((0..).step_by(2)) {
        let colour = colour(label.confidence);
        let ball = Marker { position: label.position, colour, ..Marker::new(header, id, Shape::Sphere) };
        ball.put(&mut to);
        let [x, y, z] = label.position;
        let above = [x, y - LETTERS, z];
        let text = Marker { position: above, text: &label.text, ..Marker::new(header, id + 1, Shape::Text) };
        text.put(&mut to);
    }
    to.finish()
}

/// `diagnostic_msgs/msg/DiagnosticArray` of one state.
#[must_use]
pub fn diagnostics(header: Header<'_>, level: Level, message: &str, values: &[(String, String)]) -> Vec<u8> {
    let mut to = begin(header);
    to.count(1);
    to.u8(level as u8);
    to.text("linestereo: pair");
    to.text(message);
    to.text(header.frame_id);
    to.count(values.len());
    for (key, value) in values {
        to.text(key);
        to.text(value);
    }
    to.finish()
}

/// Green, from faint to full.
fn colour(confidence: f32) -> [f32; 4] {
    [0.1, 1.0, 0.3, confidence]
}

struct Marker<'a> {
    header: Header<'a>,
    id: i32,
    shape: Shape,
    action: Action,
    position: [f64; 3],
    colour: [f32; 4],
    points: &'a [[f64; 3]],
    colours: &'a [[f32; 4]],
    text: &'a str,
}

impl<'a> Marker<'a> {
    fn new(header: Header<'a>, id: i32, shape: Shape) -> Self {
        let (position, colour) = ([0.0; 3], [1.0; 4]);
        Self { header, id, shape, action: Action::Add, position, colour, points: &[], colours: &[], text: "" }
    }

    /// All fields, in the order of `visualization_msgs/msg/Marker`.
    fn put(&self, to: &mut Writer) {
        put_header(to, self.header);
        to.text(if matches!(self.shape, Shape::Lines) { "segments" } else { "objects" });
        to.i32(self.id);
        to.i32(self.shape as i32);
        to.i32(self.action as i32);
        to.f64s(&self.position);
        to.f64s(&[0.0, 0.0, 0.0, 1.0]); // not turned
        to.f64s(&match self.shape {
            Shape::Lines => [LINE_WIDTH, 0.0, 0.0],
            Shape::Sphere => [BALL; 3],
            Shape::Text => [0.0, 0.0, LETTERS],
        });
        to.f32s(&self.colour);
        put_time(to, 0); // it stays until the next one
        to.u8(0);
        to.count(self.points.len());
        to.f64s(self.points.as_flattened());
        to.count(self.colours.len());
        to.f32s(self.colours.as_flattened());
        to.text(""); // texture
        put_header(to, Header { stamp_ns: 0, frame_id: "" });
        to.text("");
        to.bytes(&[]);
        to.count(0);
        to.text(self.text);
        to.text(""); // mesh
        to.text("");
        to.bytes(&[]);
        to.u8(0);
    }
}
