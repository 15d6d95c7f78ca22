//! A frame's result as JSON and as CSV.
//!
//! Decimals: positions and disparities are exact (steps of 1/32 and 1/64 px), probabilities and
//! metres have five decimals. An infinite depth (a disparity plus offset of zero or less) is `null`
//! in JSON and empty in CSV.

use super::directions::{Direction, five_decimals};
use super::ground::Ground;
use crate::engine::FrameResult;
use crate::results::health;
use core::fmt::Write;
use linestereo::results::{
    Bar, ImagePosition, Match, Owner, PixelDepth, PixelRejection, Rejection,
};
use linestereo::units::{Depth, Disparity, INFINITE_DEPTH};
use linestereo::{Dims, NoDepth, ObjectDepth};
use linestereo_wire::Counts;
use serde::{Serialize, Serializer};

const CSV_HEAD: &str = "id,x0,y0,x1,y1,disparity0_px,disparity1_px,sigma_px,confidence,owner,depth0_m,depth1_m,depth0_sigma_m,depth1_sigma_m\n";

#[derive(Serialize)]
struct Listing<'a> {
    size: [u16; 2],
    segments: Vec<Segment>,
    bars: Vec<ListedBar>,
    /// x, y, disparity in px, confidence.
    points: Vec<(u16, u16, f64, f64)>,
    #[serde(serialize_with = "as_map")]
    counts: Vec<(&'static str, u32)>,
    health: health::Listing,
    #[serde(flatten)]
    answers: &'a Answers,
}

/// Results of a pair besides segments and points; `None` is not listed.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Answers {
    /// Depth of each region.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub objects: Option<Vec<Object>>,
    /// Why the list of objects is empty: its file could not be read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub objects_error: Option<String>,
    /// Depth of each pixel that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub queries: Option<Vec<Query>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground: Option<Ground>,
    /// Every direction of the turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sectors: Option<Vec<Direction>>,
}

/// The depth of a pixel, or why it is not known.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Query {
    pub x: u16,
    pub y: u16,
    /// `None` where it is not known.
    pub disparity_px: Option<f64>,
    /// 0 without a disparity.
    pub sigma_px: f64,
    /// `None` without a rig or a disparity, and for an infinite depth.
    pub depth_m: Option<f64>,
    /// `None` without a depth, and where it is infinite.
    pub sigma_m: Option<f64>,
    /// Probability that the disparity is within 1 px; 0 without a disparity.
    pub confidence: f64,
    /// Why there is no disparity.
    pub reason: Option<&'static str>,
}

impl Query {
    /// The core's answer for a pixel.
    pub fn new((x, y): (u16, u16), answer: Result<PixelDepth, PixelRejection>) -> Self {
        match answer {
            Err(reason) => Self { x, y, reason: Some(reason.name()), ..Self::default() },
            Ok(found) => Self {
                x,
                y,
                disparity_px: Some(found.disparity.to_num()),
                sigma_px: found.sigma.to_num(),
                depth_m: found.depth.and_then(finite_metres),
                sigma_m: found.depth_sigma.and_then(finite_metres),
                confidence: five_decimals(found.confidence.to_num()),
                reason: None,
            },
        }
    }

    pub fn summary(&self) -> String {
        let Self { x, y, sigma_px, sigma_m, confidence, .. } = self;
        let Some(disparity) = self.disparity_px else {
            return format!("pixel {x},{y}: not known ({})\n", self.reason.unwrap_or_default());
        };
        let metres = self.depth_m.map_or(String::new(), |z| match sigma_m {
            Some(sigma_m) => format!(", {z:.3} +- {sigma_m:.3} m"),
            None => format!(", {z:.3} m, sigma infinite"),
        });
        format!("pixel {x},{y}: {disparity:.2} +- {sigma_px:.2} px{metres}, p {confidence:.2}\n")
    }
}

/// The depth of a region, or why it has none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Object {
    /// Value in the mask, or position in the file.
    pub label: u16,
    pub name: Option<String>,
    /// At the region's centre.
    pub disparity_px: Option<f64>,
    /// 0 without a disparity.
    pub sigma_px: f64,
    /// `None` without a rig or a disparity, and for an infinite depth.
    pub depth_m: Option<f64>,
    /// `None` without a depth, and where it is infinite.
    pub sigma_m: Option<f64>,
    pub nearest_m: Option<f64>,
    pub support: u16,
    /// Probability that the disparity is within 1 px of the object's own range.
    pub confidence: f64,
    /// Why there is no disparity.
    pub reason: Option<&'static str>,
}

impl Object {
    /// With the name that the detector gave it.
    pub fn new(label: u16, found: &Result<ObjectDepth, NoDepth>, name: Option<&str>) -> Self {
        let (object, reason) = (found.as_ref().ok(), found.as_ref().err());
        let metres = object.and_then(|object| object.metres);
        Self {
            label,
            name: name.map(str::to_owned),
            disparity_px: object.map(|object| object.disparity.to_num()),
            sigma_px: object.map_or(0.0, |object| object.sigma.to_num()),
            depth_m: metres.and_then(|metres| finite_metres(metres.depth)),
            sigma_m: metres.and_then(|metres| finite_metres(metres.sigma)),
            nearest_m: metres.and_then(|metres| finite_metres(metres.nearest)),
            support: reason.map_or_else(|| object.map_or(0, |o| o.support), |why| why.support),
            confidence: object.map_or(0.0, |o| five_decimals(o.confidence.to_num())),
            reason: reason.map(|why| why.reason.name()),
        }
    }
}

#[derive(Serialize)]
pub(crate) struct Segment {
    id: usize,
    left: [[f64; 2]; 2],
    disparity_px: [f64; 2],
    sigma_px: f64,
    confidence: f64,
    owner: &'static str,
    depth_m: Option<[Option<f64>; 2]>,
    techniques: TechniqueDisparities,
}

/// A thin thing: ends of its left edge in the left image, and how far its right one is along a row.
#[derive(Serialize)]
struct ListedBar {
    left: [[f64; 2]; 2],
    width_px: f64,
    disparity_px: [f64; 2],
    sigma_px: f64,
    confidence: f64,
}

impl ListedBar {
    fn new(bar: &Bar) -> Self {
        Self {
            left: bar.ends().map(position),
            width_px: bar.width().to_num(),
            disparity_px: bar.disparity().map(Disparity::to_num),
            sigma_px: bar.sigma().to_num(),
            confidence: five_decimals(bar.confidence().to_num()),
        }
    }
}

#[derive(Serialize)]
struct TechniqueDisparities {
    feature: Option<f64>,
    window: f64,
    census: f64,
}

/// The result as JSON: `size`, `segments`, `points`, `counts` and `health`, and the answers to what
/// was asked.
pub fn json(dims: Dims, result: &FrameResult, answers: &Answers) -> serde_json::Result<String> {
    let points = result.points.iter();
    let listing = Listing {
        size: [dims.width, dims.height],
        segments: result.matches.iter().enumerate().map(segment).collect(),
        bars: result.bars.iter().map(ListedBar::new).collect(),
        points: points
            .map(|p| (p.x, p.y, p.disparity.to_num(), five_decimals(p.confidence.to_num())))
            .collect(),
        counts: counts(&result.counts),
        health: health::Listing::new(result),
        answers,
    };
    let mut text = serde_json::to_string(&listing)?;
    text.push('\n');
    Ok(text)
}

/// The segments as CSV, one line each below a line of names.
pub fn csv(result: &FrameResult) -> String {
    let mut text = String::from(CSV_HEAD);
    for (id, found) in result.matches.iter().enumerate() {
        let [[x0, y0], [x1, y1]] = found.ends.map(position);
        let [d0, d1] = found.disparity.map(Disparity::to_num::<f64>);
        let (sigma, owner) = (found.sigma.to_num::<f64>(), owner_name(found.owner));
        let p = five_decimals(found.confidence.to_num());
        let _ = write!(text, "{id},{x0},{y0},{x1},{y1},{d0},{d1},{sigma},{p},{owner}");
        for metres in [found.depth, found.depth_sigma] {
            for end in 0..2 {
                text.push(',');
                if let Some(finite) = metres.and_then(|ends| finite_metres(ends[end])) {
                    let _ = write!(text, "{finite}");
                }
            }
        }
        text.push('\n');
    }
    text
}

/// Objects as CSV, one line each below a line of names; what is unknown is empty.
pub fn objects_csv(objects: &[Object]) -> String {
    let mut text = String::from(
        "label,name,disparity_px,sigma_px,depth_m,sigma_m,nearest_m,support,confidence,reason\n",
    );
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for object in objects {
        let name = object.name.as_deref().unwrap_or("");
        let name = if name.contains([',', '"', '\n']) {
            format!("\"{}\"", name.replace('"', "\"\""))
        } else {
            name.to_owned()
        };
        let Object { label, sigma_px, support, confidence, .. } = object;
        let [disparity, depth, sigma_m, nearest] =
            [object.disparity_px, object.depth_m, object.sigma_m, object.nearest_m].map(number);
        let reason = object.reason.unwrap_or("");
        let _ = write!(text, "{label},{name},{disparity},{sigma_px},{depth},{sigma_m},{nearest},");
        let _ = writeln!(text, "{support},{confidence},{reason}");
    }
    text
}

/// Everything counted in a frame by name: found, matched, one entry per [`Rejection`], dropped for
/// space.
pub fn counts(counts: &Counts) -> Vec<(&'static str, u32)> {
    let mut list = vec![
        ("segments_left", u32::from(counts.segments_left)),
        ("segments_right", u32::from(counts.segments_right)),
        ("matched", u32::from(counts.matched)),
    ];
    list.extend(Rejection::ALL.map(|reason| (reason.name(), u32::from(counts.rejected(reason)))));
    list.extend([
        ("segments_left_dropped", u32::from(counts.segments_left_dropped)),
        ("segments_right_dropped", u32::from(counts.segments_right_dropped)),
        ("edges_cut", u32::from(counts.edges_cut)),
        ("comparisons_cut", u32::from(counts.comparisons_cut)),
        ("searched_fully", u32::from(counts.searched_fully)),
        ("points", counts.points),
    ]);
    list
}

/// Metres with five decimals, `None` for an infinite depth.
pub fn finite_metres(depth: Depth) -> Option<f64> {
    (depth != INFINITE_DEPTH).then(|| five_decimals(depth.to_num()))
}

pub(crate) fn segment((id, found): (usize, &Match)) -> Segment {
    Segment {
        id,
        left: found.ends.map(position),
        disparity_px: found.disparity.map(Disparity::to_num),
        sigma_px: found.sigma.to_num(),
        confidence: five_decimals(found.confidence.to_num()),
        owner: owner_name(found.owner),
        depth_m: found.depth.map(|ends| ends.map(finite_metres)),
        techniques: TechniqueDisparities {
            feature: found.techniques.feature.map(Disparity::to_num),
            window: found.techniques.window.to_num(),
            census: found.techniques.census.to_num(),
        },
    }
}

fn position(point: ImagePosition) -> [f64; 2] {
    [point.x.to_num(), point.y.to_num()]
}

/// The side or sides in JSON and CSV.
pub fn owner_name(owner: Owner) -> &'static str {
    match owner {
        Owner::Left => "left",
        Owner::Right => "right",
        Owner::Both => "both",
    }
}

/// The [`counts`] as an object of JSON.
pub(crate) fn as_map<S: Serializer>(
    counts: &[(&'static str, u32)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(counts.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::objects::{ObjectMetres, Reason};
    use linestereo::results::{Point, Techniques};
    use linestereo::units::{Confidence, Position};

    fn example() -> FrameResult {
        let point =
            |x: f64, y: f64| ImagePosition { x: Position::from_num(x), y: Position::from_num(y) };
        let matched = Match {
            ends: [point(1.5, 2.0), point(3.03125, 40.0)],
            disparity: [Disparity::from_num(10.25), Disparity::from_num(0)],
            sigma: Disparity::from_num(0.125),
            confidence: Confidence::from_num(0.875),
            owner: Owner::Left,
            depth: Some([Depth::from_num(2.5), INFINITE_DEPTH]),
            depth_sigma: None,
            techniques: Techniques {
                feature: None,
                window: Disparity::from_num(10.25),
                census: Disparity::from_num(10.5),
            },
        };
        let point = Point {
            x: 7,
            y: 9,
            disparity: Disparity::from_num(10),
            confidence: Confidence::MAX,
            source: linestereo::results::Source::Segment(0),
        };
        FrameResult { matches: vec![matched], ..FrameResult::of_points(vec![point]) }
    }

    #[test]
    fn json_is_exactly_this() {
        let text = json(Dims { width: 64, height: 48 }, &example(), &Answers::default()).unwrap();
        let (head, counts) = text.split_once("\"counts\":").unwrap();
        let expected =
            r#"{"size":[64,48],"segments":[{"id":0,"left":[[1.5,2.0],[3.03125,40.0]],"disparity_px":[10.25,0.0],"#
                .to_owned()
                + r#""sigma_px":0.125,"confidence":0.875,"owner":"left","depth_m":[2.5,null],"#
                + r#""techniques":{"feature":null,"window":10.25,"census":10.5}}],"#
                + r#""bars":[],"points":[[7,9,10.0,0.99998]],"#;
        assert_eq!(head, expected);
        let (counts, health) = counts.split_once(r#","health":"#).unwrap();
        assert_eq!(health, "{\"flags\":[]}}\n");
        let counts = counts.trim_end_matches('}');
        let head = format!(
            r#"{{"segments_left":0,"segments_right":0,"matched":0,"{}":0,"#,
            Rejection::ALL[0].name()
        );
        assert!(counts.starts_with(&head), "{counts}");
        assert!(counts.ends_with(r#""points":0"#), "{counts}");
    }

    #[test]
    fn objects_are_exactly_this() {
        let found = ObjectDepth {
            disparity: Disparity::from_num(8),
            sigma: Disparity::from_num(0.25),
            slope_q10: [0; 2],
            spread: Disparity::from_num(1),
            metres: Some(ObjectMetres {
                depth: Depth::from_num(2.5),
                sigma: Depth::from_num(0.125),
                nearest: Depth::from_num(2.25),
            }),
            support: 7,
            confidence: Confidence::from_num(0.875),
        };
        let refused = NoDepth { reason: Reason::TwoSurfaces, support: 7 };
        let far = ObjectMetres { sigma: INFINITE_DEPTH, ..found.metres.unwrap() };
        let far = ObjectDepth { metres: Some(far), ..found };
        let objects =
            vec![Object::new(3, &Ok(found), Some("cup")), Object::new(3, &Err(refused), None)];
        let far = Object::new(3, &Ok(far), None);
        assert_eq!((far.depth_m, far.sigma_m), (Some(2.5), None), "not 0");
        let csv = objects_csv(&[far]);
        assert_eq!(csv.lines().nth(1), Some("3,,8,0.25,2.5,,2.25,7,0.875,"));
        let answers = Answers { objects: Some(objects), ..Answers::default() };
        let text = json(Dims { width: 64, height: 48 }, &example(), &answers).unwrap();
        let (_, objects) = text.split_once(r#""health":{"flags":[]},"#).unwrap();
        let expected = r#""objects":[{"label":3,"name":"cup","disparity_px":8.0,"sigma_px":0.25,"depth_m":2.5,"#
            .to_owned()
            + r#""sigma_m":0.125,"nearest_m":2.25,"support":7,"confidence":0.875,"reason":null},"#
            + r#"{"label":3,"name":null,"disparity_px":null,"sigma_px":0.0,"depth_m":null,"#
            + r#""sigma_m":null,"nearest_m":null,"support":7,"confidence":0.0,"reason":"two_surfaces"}]}"#
            + "\n";
        assert_eq!(objects, expected);
    }

    #[test]
    fn csv_leaves_what_is_unknown_empty() {
        assert_eq!(
            csv(&example()).lines().nth(1),
            Some("0,1.5,2,3.03125,40,10.25,0,0.125,0.875,left,2.5,,,")
        );
    }
}
