//! Scores as text.

use super::cells::SHARES;
use super::frame::FrameScore;
use super::summary::{Answers, ErrorRates, Summary};
use core::fmt::Write;

/// One line per frame and one for all of them.
#[must_use]
pub fn scene_table(scores: &[FrameScore]) -> String {
    let width = scores
        .iter()
        .map(|score| score.name.chars().count())
        .max()
        .unwrap_or(0)
        .max("pooled".len());
    let mut text = format!(
        "{:width$}  segments  segprec@1/@2   points  cells   vis bad1/bad2  allGT bad1/bad2  median   rms px  {:>6}\n",
        "scene", "ms"
    );
    for score in scores {
        line(&mut text, width, &score.name, &Summary::pool([score]));
    }
    line(&mut text, width, "pooled", &Summary::pool(scores));
    text
}

/// Second line of the pooled scores: sure answers, error against yield, stated against observed
/// probability.
#[must_use]
pub fn report(summary: &Summary) -> String {
    let mut text =
        String::from("answers     points/frame   cells   vis bad1/bad2   allGT bad1/bad2\n");
    for (name, answers) in [("all", &summary.all), ("p >= 0.9", &summary.sure)] {
        answers_line(&mut text, name, answers);
    }
    text.push_str("\nmost confident points of all scenes together (points with truth)\n");
    text.push_str("points/frame      least p   vis bad1/bad2   allGT bad1/bad2\n");
    for row in &summary.curve {
        let least = row.least_probability.map_or("-".to_owned(), |p| format!("{p:.3}"));
        let _ = write!(text, "{:12} {least:>12} {}", row.points_per_frame, rates(&row.errors));
        if row.available_per_frame < row.points_per_frame as f64 {
            let _ = write!(text, "   only {:.0} there are", row.available_per_frame);
        }
        text.push('\n');
    }
    text.push('\n');
    text.push_str(&cell_table([("share of all cells", summary)]));
    text.push_str(
        "\nprobability stated against observed (within 1 px, allGT)\nbin            points  stated   observed\n",
    );
    for bin in &summary.calibration {
        let share =
            |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
        let _ = writeln!(
            text,
            "{:.2}-{:.2}  {:10}  {:>6}   {:>8}",
            bin.low,
            bin.high,
            bin.points,
            share(bin.stated),
            share(bin.observed)
        );
    }
    if let Some(excess) = summary.overconfidence {
        let _ = writeln!(
            text,
            "largest excess of stated over observed, bins of 1000 answers and more: {excess:.1} percent"
        );
    }
    text
}

/// The curve of one answer per cell: a line for each named summary.
#[must_use]
pub fn cell_table<'a>(rows: impl IntoIterator<Item = (&'a str, &'a Summary)>) -> String {
    let rows: Vec<_> = rows.into_iter().collect();
    let width = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(30);
    let mut text = format!("{:width$}", "one answer per cell, bad1/bad2");
    for share in SHARES {
        let _ = write!(text, " {:>11}", format!("{share} %"));
    }
    text.push('\n');
    for (name, summary) in rows {
        let _ = write!(text, "{name:width$}");
        for row in &summary.cells {
            let _ = write!(text, " {:>11}", pair(row.bad1, row.bad2, 2));
        }
        text.push('\n');
    }
    text
}

fn line(text: &mut String, width: usize, name: &str, summary: &Summary) {
    let _ = writeln!(
        text,
        "{name:width$}  {:8.0}  {:>12}  {:7.0}  {:>4} %  {}  {:>6}  {:>7}  {:>6}",
        summary.segments_per_frame,
        pair(summary.segprec1, summary.segprec2, 1),
        summary.all.points_per_frame,
        number(summary.all.cells_percent, 0),
        rates(&summary.all.errors),
        number(summary.median_error_px, 2),
        number(summary.rms_error_px, 2),
        number(summary.milliseconds, 2),
    );
}

fn answers_line(text: &mut String, name: &str, answers: &Answers) {
    let _ = writeln!(
        text,
        "{name:10}  {:12.0}  {:>4} %  {}",
        answers.points_per_frame,
        number(answers.cells_percent, 0),
        rates(&answers.errors)
    );
}

fn rates(errors: &ErrorRates) -> String {
    format!(
        "{:>14}  {:>16}",
        pair(errors.vis_bad1, errors.vis_bad2, 2),
        pair(errors.all_gt_bad1, errors.all_gt_bad2, 2)
    )
}

fn pair(first: Option<f64>, second: Option<f64>, decimals: usize) -> String {
    format!("{}/{}", number(first, decimals), number(second, decimals))
}

fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
}
