//! Reasons for the disparity, or the lack of one, of a pixel, and of the segment, the bar and the
//! support point next to it.
//!
//! In: what an observer sees of a run, a pixel of the left image. Out: the tests in their order,
//! each in plain words, and the cost curves.
//!
//! ```text
//! CurveLog    costs and outcome of every segment, bar and support point of a run   (log)
//! bar         cost, edges, repetition, in front, probability                       (bar)
//! segment     window by sides, census, halves, feature, sides, probability         (segment)
//! support     window before aggregation, sum of paths after it, neighbours         (support)
//! pixel       the depth on demand of a pixel that lies on no segment               (pixel)
//! ```

mod bar;
mod curve;
mod log;
mod pixel;
mod segment;
mod support;

pub use curve::{Curve, Mark, Plot};
pub use log::{CurveLog, Rejected};
pub use segment::meaning;

use crate::engine::{Engine, FrameResult};
use crate::results::listing::finite_metres;
use core::fmt;
use linestereo::results::{Bar, ImagePosition, Support};
use linestereo::{Params, units::Depth};
use std::collections::HashMap;

/// Distance of a segment or bar up to which it is taken for the one that is meant, px.
pub const REACH: f64 = 4.0;

/// A test, or a number on the way, and its outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    pub name: &'static str,
    /// Outcome; `None` for a number that nothing depends on alone.
    pub passed: Option<bool>,
    /// Numbers behind it.
    pub words: String,
}

impl Step {
    fn note(name: &'static str, words: impl Into<String>) -> Self {
        Self { name, passed: None, words: words.into() }
    }

    fn test(name: &'static str, passed: bool, words: impl Into<String>) -> Self {
        Self { name, passed: Some(passed), words: words.into() }
    }
}

/// Reasons for the disparity of one thing, or for the lack of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Account {
    /// The thing, with its place.
    pub subject: String,
    /// Tests in their order, up to the one that rejected it.
    pub steps: Vec<Step>,
    /// It is among the results.
    pub accepted: bool,
    /// The end of it, in words.
    pub verdict: String,
    pub plots: Vec<Plot>,
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let outcome = match self.passed {
            Some(true) => "passed",
            Some(false) => "FAILED",
            None => "",
        };
        writeln!(f, "{:<17} {outcome:<6} {}", self.name, self.words)
    }
}

impl fmt::Display for Account {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.subject)?;
        self.steps.iter().try_for_each(|step| write!(f, "  {step}"))?;
        writeln!(f, "  {}: {}", if self.accepted { "accepted" } else { "rejected" }, self.verdict)
    }
}

/// The tests of each segment and of each bar of a pair, in lines.
#[derive(Clone, Debug, Default)]
pub struct TestTexts {
    segments: HashMap<[ImagePosition; 2], String>,
    bars: HashMap<Bar, String>,
}

impl TestTexts {
    /// Of every segment that was tested in the pair that was matched last, and of its bars, with
    /// what `log` saw of them.
    pub fn new(log: &CurveLog, engine: &mut Engine, params: &Params, result: &FrameResult) -> Self {
        let matched = engine.matched();
        let lines = |account: Account| account.steps.iter().map(Step::to_string).collect();
        let text = |index: usize| -> (_, String) {
            let account = segment::account(index, 0.0, log, matched.candidates(), params, result);
            (log.segments[index].segment.ends, lines(account))
        };
        let of_bar = |bar: &Bar| (*bar, lines(bar::account(bar, 0.0, log, params, result)));
        let segments = (0..log.segments.len()).map(text);
        Self {
            segments: segments.filter(|(_, text)| !text.is_empty()).collect(),
            bars: result.bars.iter().map(of_bar).collect(),
        }
    }

    /// Of the segment with these ends, in any order.
    pub fn of(&self, [a, b]: [ImagePosition; 2]) -> Option<&str> {
        self.segments.get(&[a, b]).or_else(|| self.segments.get(&[b, a])).map(String::as_str)
    }

    pub fn of_bar(&self, bar: &Bar) -> Option<&str> {
        self.bars.get(bar).map(String::as_str)
    }
}

fn metres(depth: Depth) -> String {
    finite_metres(depth).map_or("infinite".to_owned(), |z| format!("{z:.2} m"))
}

/// Everything known of a pixel.
#[derive(Clone, Debug)]
pub struct Explanation {
    pub pixel: (u16, u16),
    /// The segment next to it, within [`REACH`]: its ends, px, and why it has a match, or none.
    pub segment: Option<([[f64; 2]; 2], Account)>,
    /// The bar next to it, within [`REACH`]: its corners, px, and why it is told, or not.
    pub bar: Option<([[f64; 2]; 4], Account)>,
    /// The support point next to it.
    pub support: Option<((u16, u16), Account)>,
    /// The pixel itself, answered on demand.
    pub asked: Account,
}

impl Explanation {
    /// Of a pixel of the pair that was matched last, with what `log` saw of it.
    pub fn new(
        pixel: (u16, u16),
        log: &CurveLog,
        engine: &mut Engine,
        params: &Params,
        result: &FrameResult,
    ) -> Self {
        let asked = pixel::account(pixel, engine, params);
        let matched = engine.matched();
        let segment = segment::nearest(pixel, log).map(|(index, distance)| {
            let account =
                segment::account(index, distance, log, matched.candidates(), params, result);
            (segment::ends(&log.segments[index].segment), account)
        });
        let bar = bar::nearest(pixel, log, result).map(|(bar, distance)| {
            (bar::corners(&bar), bar::account(&bar, distance, log, params, result))
        });
        let points: Support<'_> = matched.support();
        let support = support::nearest(pixel, &points)
            .map(|index| support::account(index, log, &points, params));
        Self { pixel, segment, bar, support, asked }
    }

    /// Each part of it, the segment first.
    pub fn accounts(&self) -> impl Iterator<Item = &Account> {
        let segment = self.segment.iter().map(|(_, account)| account);
        let bar = self.bar.iter().map(|(_, account)| account);
        let support = self.support.iter().map(|(_, account)| account);
        segment.chain(bar).chain(support).chain([&self.asked])
    }
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.segment.is_none() {
            let (x, y) = self.pixel;
            writeln!(
                f,
                "no segment was detected within {REACH} px of {x},{y}: no straight edge with \
                 enough contrast"
            )?;
        }
        self.accounts().try_for_each(|account| write!(f, "{account}"))
    }
}
