//! Answers of damaged pairs against the truth.
//!
//! ```text
//! refused   the pair is not healthy: no object of it has a depth
//! answers   depths of objects while the pair was called healthy, by masks and by drawn boxes
//! wrong     of these: more than 1 px outside of the object's own 5-95 % of true disparities
//! far off   of these: wrong, and the depth differs by more than 20 % from the true median
//! points    with p >= 0.9 while the pair was called healthy: how many are more than 1 px off, and
//!           how many should be by what they state
//! ```

use super::{Damage, Evidence, Family};
use crate::evaluate::{ObjectCase, ObjectScore, Outline, score_objects};
use core::fmt::Write;
use linestereo::health::HealthFlags;
use linestereo_frames::Truth;
use linestereo_sim::engine::{Engine, FrameResult};
use serde::Serialize;
use std::collections::BTreeMap;

/// A depth that differs by more is far off.
const FAR_OFF: f32 = 0.2;
/// A point or an answer further from the truth is wrong, px.
const WRONG_PX: f32 = 1.0;

/// Counts of one pair or of many.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Tally {
    pub(crate) pairs: usize,
    /// Pairs that are not healthy.
    pub(crate) refused: usize,
    pub(crate) objects: usize,
    /// Depths of objects.
    pub(crate) answers: usize,
    /// More than 1 px off.
    pub(crate) wrong: usize,
    /// Wrong, and more than 20 % in depth.
    pub(crate) far_off: usize,
    /// Points with truth.
    pub(crate) points: usize,
    /// More than 1 px off.
    pub(crate) points_wrong: usize,
    /// Sum of the probabilities that these points state.
    pub(crate) stated: f64,
    /// The wrong answers, one a line: object, form, answer, true range, probability.
    pub(crate) wrong_answers: Vec<String>,
}

impl Tally {
    fn add(&mut self, other: &Self) {
        self.pairs += other.pairs;
        self.refused += other.refused;
        self.objects += other.objects;
        self.answers += other.answers;
        self.wrong += other.wrong;
        self.far_off += other.far_off;
        self.points += other.points;
        self.points_wrong += other.points_wrong;
        self.stated += other.stated;
        self.wrong_answers.extend_from_slice(&other.wrong_answers);
    }

    /// Answers that are wrong, and far off, in percent of all; 0 without any.
    pub(crate) fn wrong_percent(&self) -> [f64; 2] {
        [self.wrong, self.far_off].map(|count| 100.0 * count as f64 / self.answers.max(1) as f64)
    }

    /// Points more than 1 px off in percent, and the mean probability that they state.
    fn points_percent(&self) -> Option<(f64, f64)> {
        let count = self.points as f64;
        (self.points > 0).then(|| (100.0 * self.points_wrong as f64 / count, self.stated / count))
    }
}

/// Counts of what the engine has just said of a damaged pair.
pub(crate) fn score(
    engine: &mut Engine,
    result: &FrameResult,
    cases: &[ObjectCase],
    truth: &Truth,
) -> Tally {
    let mut tally = Tally { pairs: 1, objects: cases.len(), ..Tally::default() };
    if !result.health.of_pair().is_fit() {
        tally.refused = 1;
        return tally;
    }
    for answer in score_objects(engine, cases).iter().filter(|answer| answer.refused.is_none()) {
        tally.answers += 1;
        tally.wrong += usize::from(answer.wrong);
        tally.far_off += usize::from(answer.wrong && answer.error > FAR_OFF * answer.disparity);
        if answer.wrong {
            let ObjectScore { name, outline, disparity, range: (low, high), confidence, .. } =
                answer;
            tally.wrong_answers.push(format!(
                "{name}, {}: {disparity:.1} px, true {low:.1} to {high:.1}, at p {confidence:.3}",
                outline.name()
            ));
        }
    }
    for point in &result.points {
        if let Some(disparity) = truth.disparity(point.x.into(), point.y.into()) {
            tally.points += 1;
            tally.points_wrong +=
                usize::from((point.disparity.to_num::<f32>() - disparity).abs() > WRONG_PX);
            tally.stated += point.confidence.to_num::<f64>();
        }
    }
    tally
}

/// True for the forms of objects that the bench asks for: sloppy masks are scored by
/// `compare`.
pub(crate) fn is_asked(case: &ObjectCase) -> bool {
    matches!(case.outline, Outline::Given | Outline::Box)
}

/// All pairs of one damage.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct FaultRow {
    pub(crate) family: Family,
    pub(crate) damage: String,
    /// The flags that were raised, and on how many pairs each.
    pub(crate) flags: BTreeMap<&'static str, usize>,
    #[serde(flatten)]
    pub(crate) tally: Tally,
}

/// The bench's result.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct FaultReport {
    pub(crate) damages: Vec<FaultRow>,
    /// Families that a pair can show, undamaged pairs left out.
    pub(crate) shown_by_a_pair: Tally,
}

impl FaultReport {
    /// Pools the pairs of each damage.
    pub(crate) fn new(cases: &[(Family, Damage, HealthFlags, Tally)]) -> Self {
        let mut damages: Vec<FaultRow> = Vec::new();
        let mut all = Tally::default();
        for (family, damage, flags, tally) in cases {
            let name = damage.to_string();
            let place = damages.iter().position(|row| row.damage == name).unwrap_or_else(|| {
                let row = FaultRow {
                    family: *family,
                    damage: name,
                    flags: BTreeMap::new(),
                    tally: Tally::default(),
                };
                damages.push(row);
                damages.len() - 1
            });
            let row = &mut damages[place];
            row.tally.add(tally);
            flags.names().for_each(|flag| *row.flags.entry(flag).or_default() += 1);
            if family.evidence() == Evidence::Pair && *family != Family::Undamaged {
                all.add(tally);
            }
        }
        Self { damages, shown_by_a_pair: all }
    }
    pub(crate) fn table(&self) -> String {
        let mut text = String::from(
            "damage                                 refused   answers   wrong  far off   points \
             off, stated   flags\n",
        );
        let mut families: BTreeMap<Family, Vec<&FaultRow>> = BTreeMap::new();
        self.damages.iter().for_each(|row| families.entry(row.family).or_default().push(row));
        for (family, rows) in families {
            let note = match family.evidence() {
                Evidence::Pair => "",
                Evidence::Sequence => ": a sequence can show it",
                Evidence::Other => ": no pair can show it",
            };
            let _ = writeln!(text, "\n{}{note}", family.name());
            for row in rows {
                let flags: Vec<String> =
                    row.flags.iter().map(|(flag, count)| format!("{count} {flag}")).collect();
                text.push_str(&line(&row.damage, &row.tally, &flags.join(", ")));
            }
        }
        text.push('\n');
        text.push_str(&line("all that a pair can show", &self.shown_by_a_pair, ""));
        let [wrong, far_off] = self.shown_by_a_pair.wrong_percent();
        let _ = writeln!(
            text,
            "\nof all answers of damaged pairs {wrong:.2} % are wrong, {far_off:.2} % far off"
        );
        text
    }
}

fn line(name: &str, tally: &Tally, flags: &str) -> String {
    let Tally { pairs, refused, answers, wrong, far_off, .. } = tally;
    let points = tally.points_percent().map_or_else(
        || "-".to_owned(),
        |(off, stated)| format!("{off:5.1} %, {:4.1} %", 100.0 * (1.0 - stated)),
    );
    format!(
        "{name:36} {refused:4} of {pairs:<4} {answers:5} {wrong:7} {far_off:8}   {points:>18}   \
         {flags}\n"
    )
}
