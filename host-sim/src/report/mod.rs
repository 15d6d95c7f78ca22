//! Results of pairs -> one page that needs nothing but a browser.
//!
//! In: a [`PageFrame`] per pair. Out: HTML with images, data, style and script in it: no network,
//! no other files.
//!
//! The data are compact lists (`page.js` names their fields); positions and disparities have two
//! decimals, metres three. Points are thinned to [`MOST_POINTS`] a frame: they are seen from above
//! only. Images are PNG where there is one pair, JPEG in a sequence.

pub mod browser;

use crate::draw::{ColourRange, gray_png, shown};
use crate::engine::FrameResult;
use crate::explain::{Rejected, TestTexts, meaning};
use crate::results::health;
use crate::results::listing::{self, finite_metres, owner_name};
use base64::{Engine as _, prelude::BASE64_STANDARD};
use image::{ExtendedColorType, ImageEncoder, codecs::jpeg::JpegEncoder};
use linestereo::objects::Reason;
use linestereo::results::{Bar, Match, Rejection};
use linestereo::{Rig, units::Depth};
use linestereo_frames::GrayImage;
use linestereo_frames::regions::{Object, Pixels};
use linestereo_wire::{Health, MAX_REGIONS};
use serde::Serialize;
use serde_json::{Value, json};

/// Points of a frame that are kept: every so many-th of them.
pub const MOST_POINTS: usize = 4000;
const JPEG_QUALITY: u8 = 85;

const LIVE_PAGE: &str = include_str!("live.html");
const LIVE_SCRIPT: &str = include_str!("live.js");
const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
const DRAWING: &str = include_str!("drawing.js");
/// Style of every page.
const BASE_STYLE: &str = include_str!("base.css");
/// Style of the live page and of the page for browsers.
const SHARED_STYLE: &str = include_str!("shared.css");

/// A pair and what was found in it.
pub struct PageFrame<'a> {
    pub name: String,
    /// Disparities searched: 0 .. this, px.
    pub max_disparity: u16,
    /// Where depths are known; with a principal point directions too.
    pub rig: Option<Rig>,
    pub images: &'a [GrayImage; 2],
    pub result: &'a FrameResult,
    pub rejected: &'a [Rejected],
    /// Regions with their depths; empty when nobody asked.
    pub objects: &'a [(Object, listing::Object)],
    /// The tests of each segment and bar in words; empty when nobody asked.
    pub tests: &'a TestTexts,
}

/// Settings common to all pairs of a page.
pub struct PageSetup {
    pub title: String,
    /// There are several frames: smaller images.
    pub many: bool,
}

/// Ends, position of the reason in the list of reasons, tests.
type RejectedData<'a> = (f64, f64, f64, f64, usize, Option<&'a str>);

#[derive(Serialize)]
struct FrameData<'a> {
    name: String,
    max_disparity: u16,
    has_depth: bool,
    pinhole: Option<(f64, f64, f64)>,
    size: [u16; 2],
    images: [String; 2],
    /// Colours span these disparities, px.
    range: [f32; 2],
    segments: Vec<Vec<Value>>,
    bars: Vec<Vec<Value>>,
    rejected: Vec<RejectedData<'a>>,
    /// x, y, disparity.
    points: Vec<(u16, u16, f64, Option<f64>)>,
    objects: Vec<ObjectData>,
    counts: Vec<(&'static str, u32)>,
    health: Vec<(&'static str, &'static str)>,
    rows_px: Option<f64>,
}

#[derive(Serialize)]
struct ObjectData {
    #[serde(flatten)]
    depth: listing::Object,
    /// Rectangles: x, y, width, height.
    cover: Vec<[u16; 4]>,
    is_box: bool,
}

#[derive(Serialize)]
struct PageData<'a> {
    title: &'a str,
    version: &'static str,
    reasons: [(&'static str, &'static str); Rejection::ALL.len()],
}

/// Focal length and principal point, px.
fn pinhole(rig: Rig) -> Option<(f64, f64, f64)> {
    let [cx, cy] = rig.principal_point_q16()?.map(|v| f64::from(v) / 65536.0);
    Some((rig.focal_q16() as f64 / 65536.0, cx, cy))
}

/// A page in the making: frames are turned into text one by one.
pub struct Page {
    setup: PageSetup,
    frames: Vec<String>,
}

impl Page {
    pub fn new(setup: PageSetup) -> Self {
        Self { setup, frames: Vec::new() }
    }

    pub fn push(&mut self, frame: &PageFrame<'_>) -> anyhow::Result<()> {
        let PageFrame { result, max_disparity, rig, .. } = *frame;
        let range = ColourRange::of(result, max_disparity);
        let [left, right] = frame.images;
        let data = FrameData {
            name: frame.name.clone(),
            max_disparity,
            has_depth: rig.is_some(),
            pinhole: rig.and_then(pinhole),
            size: [left.dims.width, left.dims.height],
            images: [data_uri(left, self.setup.many)?, data_uri(right, self.setup.many)?],
            range: [range.far, range.near],
            segments: result
                .matches
                .iter()
                .map(|found| segment(found, frame.tests.of(found.ends)))
                .collect(),
            bars: result
                .bars
                .iter()
                .map(|bar| bar_data(bar, rig, frame.tests.of_bar(bar)))
                .collect(),
            rejected: frame
                .rejected
                .iter()
                .map(|lost| rejected(lost, frame.tests.of(lost.ends)))
                .collect(),
            points: points(result, rig),
            objects: frame.objects.iter().map(object).collect(),
            counts: listing::counts(&result.counts),
            health: health::advice(result.health).collect(),
            rows_px: result
                .pair
                .as_ref()
                .and_then(|pair| pair.row_offset_q8)
                .map(|q8| f64::from(q8) / 256.0),
        };
        self.frames.push(serde_json::to_string(&data)?);
        Ok(())
    }

    /// A pair that failed: its name and why.
    pub fn push_error(&mut self, name: &str, error: &str) {
        self.frames.push(serde_json::json!({"name": name, "error": error}).to_string());
    }

    pub fn html(&self) -> serde_json::Result<String> {
        let setup = &self.setup;
        let data = serde_json::to_string(&PageData {
            title: &setup.title,
            version: env!("CARGO_PKG_VERSION"),
            reasons: Rejection::ALL.map(|reason| (reason.name(), meaning(reason))),
        })?;
        let frames = harmless(&format!("[{}]", self.frames.join(",\n")));
        let (before, after) = PAGE.split_once("/*SCRIPT*/").unwrap_or((PAGE, ""));
        let before = before
            .replace("/*STYLE*/", &[BASE_STYLE, STYLE].concat())
            .replace("/*SETUP*/", &harmless(&data))
            .replace("<!--TITLE-->", &escaped(&setup.title));
        let (head, tail) = before.split_once("/*FRAMES*/").unwrap_or((&before, ""));
        Ok([head, &frames, tail, &with_drawing(SCRIPT), after].concat())
    }
}

/// The live page of this source, a name for people: events of a server in, pictures and charts out.
/// It asks for nothing but those events. The server's word `nonce` marks its scripts and styles.
pub fn live_page(source: &str, nonce: &str) -> String {
    // Flags and reasons share names.
    let reasons = Reason::ALL.map(|reason| (reason.name(), reason.to_string()));
    let words =
        json!({"flags": Health::ADVICE, "reasons": reasons, "most_boxes": MAX_REGIONS}).to_string();
    let parts = [
        ("/*NONCE*/", nonce),
        ("/*STYLE*/", &[BASE_STYLE, SHARED_STYLE].concat()),
        ("/*WORDS*/", &harmless(&words)),
        ("/*SCRIPT*/", &with_drawing(LIVE_SCRIPT)),
        ("/*SOURCE*/", &escaped(source)),
    ];
    parts.into_iter().fold(LIVE_PAGE.to_owned(), |page, (place, part)| page.replace(place, part))
}

/// A script behind what it imports: it needs no imports.
fn with_drawing(script: &str) -> String {
    let own = script.split_inclusive('\n').filter(|line| !line.starts_with("import "));
    DRAWING.to_owned() + &own.collect::<String>()
}

/// Nothing in these data may end the script that holds them.
fn harmless(json: &str) -> String {
    json.replace('<', "\\u003c")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

fn data_uri(image: &GrayImage, small: bool) -> image::ImageResult<String> {
    let image = &*shown(image);
    let (kind, bytes) = if small {
        let (mut bytes, [width, height]) =
            (Vec::new(), [image.dims.width, image.dims.height].map(u32::from));
        let encoder = JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY);
        encoder.write_image(&image.pixels, width, height, ExtendedColorType::L8)?;
        ("jpeg", bytes)
    } else {
        ("png", gray_png(image)?)
    };
    Ok(format!("data:image/{kind};base64,{}", BASE64_STANDARD.encode(bytes)))
}

/// Position, disparity, depth.
fn points(result: &FrameResult, rig: Option<Rig>) -> Vec<(u16, u16, f64, Option<f64>)> {
    let every = result.points.len().div_ceil(MOST_POINTS).max(1);
    let depth =
        |disparity| rig.and_then(|rig| finite_metres(rig.depth(disparity))).map(thousandths);
    let points = result.points.iter().step_by(every);
    points.map(|p| (p.x, p.y, hundredths(p.disparity.to_num()), depth(p.disparity))).collect()
}

/// x0, y0, x1, y1, d0, d1, sigma, confidence, owner, z0, z1, sigma of z0, of z1, feature, window,
/// census, tests.
fn segment(found: &Match, tests: Option<&str>) -> Vec<Value> {
    let [a, b] = found.ends;
    let px = |value: f64| Value::from(hundredths(value));
    let metres = |ends: Option<[Depth; 2]>, i: usize| {
        Value::from(ends.and_then(|ends| finite_metres(ends[i])).map(thousandths))
    };
    vec![
        px(a.x.to_num()),
        px(a.y.to_num()),
        px(b.x.to_num()),
        px(b.y.to_num()),
        px(found.disparity[0].to_num()),
        px(found.disparity[1].to_num()),
        px(found.sigma.to_num()),
        thousandths(found.confidence.to_num()).into(),
        owner_name(found.owner).into(),
        metres(found.depth, 0),
        metres(found.depth, 1),
        metres(found.depth_sigma, 0),
        metres(found.depth_sigma, 1),
        found.techniques.feature.map(|d| hundredths(d.to_num())).into(),
        px(found.techniques.window.to_num()),
        px(found.techniques.census.to_num()),
        tests.into(),
    ]
}

/// x0, y0, x1, y1 of the left edge, width, d0, d1, sigma, confidence, z0, z1, sigma of z0, of z1,
/// tests.
fn bar_data(bar: &Bar, rig: Option<Rig>, tests: Option<&str>) -> Vec<Value> {
    let px = |value: f64| Value::from(hundredths(value));
    let metres = |z: Option<Depth>| Value::from(z.and_then(finite_metres).map(thousandths));
    let depths = bar.disparity().map(|d| metres(rig.map(|rig| rig.depth(d))));
    let sigmas = bar.disparity().map(|d| metres(rig.map(|rig| rig.depth_sigma(d, bar.sigma()))));
    let mut data: Vec<Value> =
        bar.ends().iter().flat_map(|end| [px(end.x.to_num()), px(end.y.to_num())]).collect();
    data.push(px(bar.width().to_num()));
    data.extend(bar.disparity().map(|d| px(d.to_num())));
    data.extend([px(bar.sigma().to_num()), thousandths(bar.confidence().to_num()).into()]);
    data.extend(depths.into_iter().chain(sigmas));
    data.push(tests.into());
    data
}

fn rejected<'a>(lost: &Rejected, tests: Option<&'a str>) -> RejectedData<'a> {
    let [a, b] = lost.ends;
    let px = |value: linestereo::units::Position| hundredths(value.to_num());
    (px(a.x), px(a.y), px(b.x), px(b.y), lost.reason as usize, tests)
}

fn object((object, depth): &(Object, listing::Object)) -> ObjectData {
    let cover = match &object.pixels {
        Pixels::Box(area) => {
            vec![[area.left, area.top, area.right - area.left, area.bottom - area.top]]
        }
        Pixels::Mask(runs) => runs
            .iter()
            .map(|run| [run.span.start, run.y, run.span.end - run.span.start, 1])
            .collect(),
    };
    ObjectData { depth: depth.clone(), cover, is_box: matches!(object.pixels, Pixels::Box(_)) }
}

fn hundredths(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

fn thousandths(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_needs_nothing_else_and_no_name_ends_its_script() {
        let title = "</script><b>&".to_owned();
        let setup = PageSetup { title, many: false };
        let mut page = Page::new(setup);
        page.push_error("</script>", "broken");
        let html = page.html().unwrap();
        assert_eq!(html.matches("</script>").count(), 3); // setup, frames, script
        for outside in ["http://", "https://", "src=\"/", "@import", "url("] {
            let html = html.replace("http://www.w3.org/2000/svg", "");
            assert!(!html.contains(outside), "{outside}");
        }
        for place in ["/*STYLE*/", "/*SETUP*/", "/*FRAMES*/", "/*SCRIPT*/", "<!--TITLE-->"] {
            assert!(PAGE.contains(place) && !html.contains(place), "{place}");
        }
    }
}
