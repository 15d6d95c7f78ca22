//! Scores as text.

use super::summary::Summary;
use crate::bench::number;
use core::fmt::Write;

/// Stated against observed probability.
pub(crate) fn calibration_table(summary: &Summary) -> String {
    let mut text = String::from(
        "probability stated against observed (within 1 px, allGT)\n\
         bin            points  stated   observed\n",
    );
    for bin in &summary.calibration {
        let _ = writeln!(
            text,
            "{:.2}-{:.2}  {:10}  {:>6}   {:>8}",
            bin.low,
            bin.high,
            bin.points,
            number(bin.stated, 3),
            number(bin.observed, 3)
        );
    }
    text
}

/// The curve of one answer per cell: a line for each named summary.
pub(crate) fn cell_table<'a>(rows: impl IntoIterator<Item = (&'a str, &'a Summary)>) -> String {
    let rows: Vec<_> = rows.into_iter().collect();
    let width = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(30);
    let mut text = format!("{:width$}", "one answer per cell, bad1/bad2");
    let shown = |percent: usize| percent.is_multiple_of(10) || percent > 70;
    for row in rows.iter().take(1).flat_map(|(_, summary)| &summary.cells) {
        if shown(row.percent) {
            let _ = write!(text, " {:>11}", format!("{} %", row.percent));
        }
    }
    text.push('\n');
    for (name, summary) in rows {
        let _ = write!(text, "{name:width$}");
        for row in summary.cells.iter().filter(|row| shown(row.percent)) {
            let _ = write!(text, " {:>11}", pair(row.bad1, row.bad2));
        }
        text.push('\n');
    }
    text
}

/// Two rates of error.
pub(crate) fn pair(first: Option<f64>, second: Option<f64>) -> String {
    format!("{}/{}", number(first, 2), number(second, 2))
}
