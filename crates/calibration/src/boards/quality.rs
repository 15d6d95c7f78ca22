//! Quality of a calibration, and advice that would raise it.
//!
//! In: an [`Estimate`]. Out: what decides whether to trust it, in numbers, and a verdict with
//! reasons and remedies.
//!
//! The limits are those of the matcher behind: it takes rows that are up to a pixel off, loses some
//! matches above half a pixel and none below a quarter; an error of 1 % of focal length or baseline
//! is 1 % of every depth.

use super::estimate::{CornerError, Estimate};
use core::fmt;
use linestereo::image::{MAX_HEIGHT, MAX_WIDTH};
use linestereo::{Dims, Params};
use linestereo_rig::{CameraSide, Rectification, View};

/// Cells that coverage is counted in, across and down.
pub(super) const CELLS: [usize; 2] = [8, 6];
/// Names of thirds of the image.
const THIRDS: [[&str; 3]; 3] = [
    ["upper left corner", "upper edge", "upper right corner"],
    ["left edge", "middle", "right edge"],
    ["lower left corner", "lower edge", "lower right corner"],
];
/// Error of a disparity that the far range is stated for, px, and the share of the distance it may
/// cost.
const FAR: (f64, f64) = (0.25, 0.1);
/// Places across a raw image at which is asked whether they stay in view.
const ASKED: u16 = 33;

/// Limits up to which a calibration is good, and usable.
struct Limits {
    good: f64,
    usable: f64,
}
const RMS_PX: Limits = Limits { good: 0.5, usable: 1.0 };
const VERTICAL_PX: Limits = Limits { good: 0.25, usable: 0.5 };
/// Standard deviation of a focal length or the baseline, as its share.
const SPREAD: Limits = Limits { good: 0.005, usable: 0.02 };
/// Share of cells without a corner.
const UNSEEN: Limits = Limits { good: 0.35, usable: 0.65 };
/// Too few views: 1 over their number.
const VIEWS: Limits = Limits { good: 0.1, usable: 0.2 };
/// Share of views that were dropped.
const DROPPED: Limits = Limits { good: 0.2, usable: 0.5 };
/// Boards tilted less than this all look alike, degrees.
const LEAST_TILT: f64 = 12.0;
/// Focal lengths that differ by more cost one view its sharpness.
const FOCALS_DIFFER: f64 = 0.05;

/// May it be used?
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// As it is.
    Good,
    /// With less precision than the cameras could give.
    Usable,
    /// Take the photos again.
    Repeat,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Good => "good",
            Self::Usable => "usable",
            Self::Repeat => "repeat",
        })
    }
}

/// Something that lowers the verdict, or has to be known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The verdict it leaves.
    pub verdict: Verdict,
    /// The reason, a sentence.
    pub reason: String,
    /// The advice.
    pub remedy: String,
}

/// Where in a camera's image corners were seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// Corners in each of 8x6 cells, row by row.
    pub cells: Vec<u32>,
    /// Share of cells with corners.
    pub share: f64,
    /// Distance of the outermost corner from the image's middle, in half diagonals.
    pub reach: f64,
    /// Thirds of the image, across and down, without a corner.
    pub unseen: Vec<&'static str>,
}

/// Residual difference of rows after rectification at the raw images' size (or the largest the core
/// takes).
#[derive(Clone, Debug, PartialEq)]
pub struct Rectified {
    /// Virtual cameras.
    pub rectification: Rectification,
    /// Field of view across and down, degrees.
    pub field: [f64; 2],
    /// Share of each raw image that is still seen.
    pub kept: [f64; 2],
    /// Nearest distance that the disparity range holds, m.
    pub near: f64,
    /// Distance at which an error of 0.25 px costs 10 %, m.
    pub far: f64,
    /// Mean difference of rows of the same corner, px.
    pub vertical: f64,
    /// The same for each view; none for views not used.
    pub view_vertical: Vec<Option<f64>>,
}

/// All of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// Left and right.
    pub coverage: [Coverage; 2],
    /// None when the two cameras share no view.
    pub rectified: Option<Rectified>,
    /// The worst of the findings'.
    pub verdict: Verdict,
    /// Worst first.
    pub findings: Vec<Finding>,
}

/// Judges an estimate; the disparity range decides how near is seen.
pub fn assess(estimate: &Estimate, max_disparity: u16) -> Assessment {
    let dims = estimate.calibration.camera(CameraSide::Left).dims();
    let coverage = [0, 1].map(|eye| covered(dims, &estimate.errors[eye]));
    let rectified = rectified(estimate, max_disparity);
    let mut findings = findings(estimate, &coverage, rectified.as_ref());
    findings.sort_by_key(|finding| core::cmp::Reverse(finding.verdict));
    let verdict = findings.first().map_or(Verdict::Good, |finding| finding.verdict);
    Assessment { coverage, rectified, verdict, findings }
}

fn covered(dims: Dims, corners: &[CornerError]) -> Coverage {
    let sides = [f64::from(dims.width), f64::from(dims.height)];
    let cell = |at: [f64; 2], counts: [usize; 2]| {
        let step = |axis: usize| {
            (((at[axis] + 0.5) / sides[axis] * counts[axis] as f64).max(0.0) as usize)
                .min(counts[axis] - 1)
        };
        step(1) * counts[0] + step(0)
    };
    let (mut cells, mut thirds) = (vec![0; CELLS[0] * CELLS[1]], [0_u32; 9]);
    let mut reach = 0.0_f64;
    for corner in corners {
        cells[cell(corner.at, CELLS)] += 1;
        thirds[cell(corner.at, [3, 3])] += 1;
        let from_middle = [0, 1].map(|axis| corner.at[axis] - (sides[axis] - 1.0) / 2.0);
        reach = reach.max(from_middle[0].hypot(from_middle[1]));
    }
    let share = cells.iter().filter(|&&count| count > 0).count() as f64 / cells.len() as f64;
    let unseen = thirds
        .iter()
        .zip(THIRDS.concat())
        .filter(|(count, _)| **count == 0)
        .map(|(_, name)| name)
        .collect();
    Coverage { cells, share, reach: reach / (sides[0].hypot(sides[1]) / 2.0), unseen }
}

/// The raw size, reduced to what the core takes.
fn rectified_dims(dims: Dims) -> Dims {
    let scale = (f64::from(MAX_WIDTH) / f64::from(dims.width))
        .min(f64::from(MAX_HEIGHT) / f64::from(dims.height))
        .min(1.0);
    let side = |side: u16| (f64::from(side) * scale).round() as u16;
    Dims { width: side(dims.width), height: side(dims.height) }
}

fn rectified(estimate: &Estimate, max_disparity: u16) -> Option<Rectified> {
    let raw = estimate.calibration.camera(CameraSide::Left).dims();
    let dims = rectified_dims(raw);
    let rectification = estimate.calibration.rectify(dims, View::default()).ok()?;
    let focal = rectification.focal();
    let angle = |low: f64, high: f64| ((high / focal).atan() - (low / focal).atan()).to_degrees();
    let [cx, cy] = rectification.centre();
    let field = [
        angle(-0.5 - cx, f64::from(dims.width) - 0.5 - cx),
        angle(-0.5 - cy, f64::from(dims.height) - 0.5 - cy),
    ];
    let strength = focal * rectification.baseline();
    let (vertical, view_vertical) = vertical_residuals(estimate, &rectification);
    Some(Rectified {
        field,
        kept: CameraSide::BOTH.map(|eye| kept(&rectification, eye, raw)),
        near: strength / Params::largest_disparity(max_disparity).to_num::<f64>(),
        far: FAR.1 * strength / FAR.0,
        vertical,
        view_vertical,
        rectification,
    })
}

/// Share of a raw image inside the rectified one.
fn kept(rectification: &Rectification, eye: CameraSide, raw: Dims) -> f64 {
    let dims = rectification.dims();
    let inside = |at: [f64; 2]| {
        (-0.5..f64::from(dims.width) - 0.5).contains(&at[0])
            && (-0.5..f64::from(dims.height) - 0.5).contains(&at[1])
    };
    let place = |i: u16, side: u16| f64::from(i) / f64::from(ASKED - 1) * f64::from(side - 1);
    let asked = (0..ASKED).flat_map(|j| (0..ASKED).map(move |i| (i, j)));
    let at = asked.filter_map(|(i, j)| {
        rectification.rectified(eye, [place(i, raw.width), place(j, raw.height)])
    });
    at.filter(|&at| inside(at)).count() as f64 / f64::from(ASKED * ASKED)
}

/// Mean absolute difference of rows of corners seen by both, over all and for each view.
fn vertical_residuals(
    estimate: &Estimate,
    rectification: &Rectification,
) -> (f64, Vec<Option<f64>>) {
    let mut sums = vec![(0.0, 0_u32); estimate.views.len()];
    // Both lists are in the order of views, then corners.
    let mut right = estimate.errors[1].iter().peekable();
    for left in &estimate.errors[0] {
        let key = |corner: &CornerError| (corner.view, corner.corner);
        while right.next_if(|other| key(other) < key(left)).is_some() {}
        let Some(partner) = right.next_if(|other| key(other) == key(left)) else { continue };
        let rows = (
            rectification.rectified(CameraSide::Left, left.at),
            rectification.rectified(CameraSide::Right, partner.at),
        );
        if let (Some([_, a]), Some([_, b])) = rows {
            sums[left.view].0 += (a - b).abs();
            sums[left.view].1 += 1;
        }
    }
    let total = sums.iter().fold((0.0, 0), |total, sum| (total.0 + sum.0, total.1 + sum.1));
    let mean = |(sum, count): (f64, u32)| (count > 0).then(|| sum / f64::from(count));
    (mean(total).unwrap_or(0.0), sums.into_iter().map(mean).collect())
}

/// Reasons that lower the verdict.
fn findings(
    estimate: &Estimate,
    coverage: &[Coverage; 2],
    rectified: Option<&Rectified>,
) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut judge = |value: f64, limits: &Limits, reason: String, remedy: &str| {
        let verdict = if value <= limits.good {
            return;
        } else if value <= limits.usable {
            Verdict::Usable
        } else {
            Verdict::Repeat
        };
        found.push(Finding { verdict, reason, remedy: remedy.to_owned() });
    };
    let rms = estimate.rms;
    judge(
        rms,
        &RMS_PX,
        format!("the corners are {rms:.2} px off"),
        "use a flat, rigid board, hold it still, and fix the focus; try --lens fisheye for a wide lens",
    );
    match rectified {
        Some(rectified) => judge(
            rectified.vertical,
            &VERTICAL_PX,
            format!(
                "rows of the same corner differ by {:.2} px after rectification",
                rectified.vertical
            ),
            "take both photos of a pair at the same moment, and hold the board still",
        ),
        None => judge(
            f64::MAX,
            &VERTICAL_PX,
            "the two cameras share no view".into(),
            "turn them to look the same way",
        ),
    }
    let used = estimate.views.iter().filter(|view| view.dropped.is_none()).count();
    judge(
        1.0 / used.max(1) as f64,
        &VIEWS,
        format!("only {used} views"),
        "take 15 or more, near and far, in all parts of the image",
    );
    let dropped = estimate.views.len() - used;
    judge(
        dropped as f64 / estimate.views.len().max(1) as f64,
        &DROPPED,
        format!("{dropped} of {} views were dropped", estimate.views.len()),
        "hold the board still and take both photos of a pair at the same moment",
    );
    for (coverage, side) in coverage.iter().zip(["left", "right"]) {
        let (places, remedy) = if coverage.unseen.is_empty() {
            (
                format!("corners in {:.0} % of the {side} image only", 100.0 * coverage.share),
                "hold the board near its edges too",
            )
        } else {
            (
                format!("no corners in the {} of the {side} image", coverage.unseen.join(", ")),
                "hold the board there",
            )
        };
        judge(1.0 - coverage.share, &UNSEEN, places, remedy);
    }
    spreads(estimate, &mut judge);
    found.extend(focals(estimate));
    found
}

/// Focal lengths and baseline that the photos do not fix.
fn spreads(estimate: &Estimate, judge: &mut impl FnMut(f64, &Limits, String, &str)) {
    let tilted = estimate
        .views
        .iter()
        .filter(|view| view.dropped.is_none() && view.tilt >= LEAST_TILT)
        .count();
    let remedy = if tilted < 3 {
        "all boards are nearly parallel to the image: tilt it by 20 to 45 degrees, to all sides"
    } else {
        "take more photos, with the board larger in the image and tilted to all sides"
    };
    for name in ["left.fx", "left.fy", "right.fx", "right.fy"] {
        let Some(parameter) = estimate.parameters.iter().find(|parameter| parameter.name == name)
        else {
            continue;
        };
        let share = parameter.sigma / parameter.value;
        judge(share, &SPREAD, format!("{name} is known to {:.1} % only", 100.0 * share), remedy);
    }
    let share = estimate.baseline_sigma / estimate.calibration.baseline();
    judge(share, &SPREAD, format!("the baseline is known to {:.1} % only", 100.0 * share), remedy);
}

/// A warning where one view is enlarged.
fn focals(estimate: &Estimate) -> Option<Finding> {
    let [left, right] = CameraSide::BOTH.map(|eye| estimate.calibration.camera(eye).focal()[0]);
    let differ = (left - right).abs() / left.min(right);
    (differ > FOCALS_DIFFER).then(|| Finding {
        verdict: Verdict::Usable,
        reason: format!(
            "the focal lengths differ by {:.0} % ({left:.0} and {right:.0} px)",
            100.0 * differ
        ),
        remedy: "use two cameras of one kind: the common focal length pixelates one view".into(),
    })
}
