//! A pixel that was asked for: texture, uniqueness, left-right check, support, probability.

use super::{Account, Step};
use crate::engine::Engine;
use crate::results::listing::Query;
use linestereo::unstable::{
    FITTED_PIXEL, LEFT_RIGHT_GAP_Q8, PixelEvidence, PixelKind, SECOND_BEST_Q8,
};
use linestereo::{Params, units::Confidence};

/// Largest gap of the left-right check that evidence holds, px.
const FARTHEST: f64 = 4.0;

/// Reasons for the depth on demand of a pixel, or for the lack of it.
pub(super) fn account(pixel: (u16, u16), engine: &mut Engine, params: &Params) -> Account {
    let answer = engine.depth_at(pixel);
    let found = engine.ask(|matched| matched.pixel_evidence(pixel));
    let mut steps = Vec::new();
    if let Ok((d_q6, evidence)) = found {
        tests(&evidence, &mut steps);
        let p = Confidence::from_bits(
            FITTED_PIXEL.model.probability_q16(FITTED_PIXEL.model.score_q8(&evidence.0)),
        );
        let (p, least) = (p.to_num::<f64>(), params.min_confidence.to_num::<f64>());
        let words = format!("{p:.3} for {:.2} px, asked for {least:.2}", f64::from(d_q6) / 64.0);
        // The answer may be that of a bar.
        steps.push(Step::test("probability", answer.is_ok() && p >= least, words));
    }
    let own_q6 = found.as_ref().ok().map(|(d_q6, _)| *d_q6);
    if let Ok(depth) = &answer
        && own_q6 != Some(depth.disparity.to_bits().into())
    {
        let words = format!("it lies on one at {:.2} px", depth.disparity.to_num::<f64>());
        steps.push(Step::note("bar", words));
    }
    let (accepted, verdict) = match &answer {
        Ok(_) => (true, Query::new(pixel, answer).summary().trim_end().to_owned()),
        Err(reason) => (false, reason.to_string()),
    };
    let subject = format!("pixel {},{} on demand (as run --query)", pixel.0, pixel.1);
    Account { subject, steps, accepted, verdict, plots: Vec::new() }
}

fn tests(evidence: &PixelEvidence, steps: &mut Vec<Step>) {
    let of = |kind: PixelKind| f64::from(evidence.0[kind as usize]) / 256.0;
    let count = |kind: PixelKind| of(kind).exp2() - 1.0;
    steps.push(Step::note("texture", format!("mean gradient {:.1}", count(PixelKind::Texture))));
    let words = format!("cost here / best elsewhere {:.2}", of(PixelKind::CensusRatio));
    steps.push(Step::note("census", words));
    let allowed = f64::from(SECOND_BEST_Q8) / 256.0;
    let (whole, guided) = (of(PixelKind::JointRatio), of(PixelKind::GuidedRatio));
    let words = format!(
        "cost here / best elsewhere {whole:.2}; among what features nearby allow {guided:.2}, good below {allowed:.2}"
    );
    steps.push(Step::test("unique", guided <= allowed, words));
    let (gap, allowed) = (of(PixelKind::LeftRightGap), f64::from(LEFT_RIGHT_GAP_Q8) / 256.0);
    // Gaps beyond the largest one stored are not told apart.
    let or_more = if gap >= FARTHEST { " or more" } else { "" };
    let words = format!("{gap:.1} px{or_more} apart, good up to {allowed} px");
    steps.push(Step::test("left-right check", gap <= allowed, words));
    let words = format!(
        "features that agree {:.1}, support points that agree {:.1}, share of these that contradict {:.2}",
        count(PixelKind::Support),
        count(PixelKind::PointsAgreeing),
        of(PixelKind::PointsConflicting)
    );
    steps.push(Step::note("support around it", words));
}
