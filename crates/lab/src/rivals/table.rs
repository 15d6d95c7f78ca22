//! Comparisons as text.

use super::MethodSummary;
use crate::bench::number;
use crate::evaluate::{Outline, YIELDS, cell_table, pair};
use core::fmt::Write;

/// One line per method: yield, errors, errors of the most confident points, time.
pub(crate) fn comparison_table(methods: &[MethodSummary]) -> String {
    let width = name_width(methods);
    let mut text = format!("{:width$}   points  cells  vis bad1/bad2  allGT bad1/bad2", "method");
    for wanted in YIELDS {
        let _ = write!(text, "  {:>11}", format!("top {wanted}"));
    }
    text.push_str("  median px       ms\n");
    for MethodSummary { method, summary, .. } in methods {
        let errors = &summary.all.errors;
        let _ = write!(
            text,
            "{method:width$}  {:7.0}  {:>3} %  {:>13}  {:>15}",
            summary.all.points_per_frame,
            number(summary.all.cells_percent, 0),
            pair(errors.vis_bad1, errors.vis_bad2),
            pair(errors.all_gt_bad1, errors.all_gt_bad2),
        );
        for row in &summary.curve {
            let enough = row.available_per_frame >= row.points_per_frame as f64;
            let is_ordered = row.least_probability.is_some_and(|least| least > 0.0);
            let rates = if enough && is_ordered {
                pair(row.errors.all_gt_bad1, row.errors.all_gt_bad2)
            } else {
                "-".to_owned()
            };
            let _ = write!(text, "  {rates:>11}");
        }
        let _ = writeln!(
            text,
            "  {:>9}  {:>7}",
            number(summary.median_error_px, 2),
            number(summary.milliseconds, 2)
        );
    }
    text
}

/// One answer per cell, of what each method lists.
pub(crate) fn cell_comparison(methods: &[MethodSummary]) -> String {
    cell_table(methods.iter().map(|method| (method.method.as_str(), &method.summary)))
}

/// Depths of objects: wrong and covered by method and outline; empty where no scene has objects.
pub(crate) fn object_comparison(methods: &[MethodSummary]) -> String {
    let kinds: Vec<Outline> = Outline::ALL
        .into_iter()
        .filter(|outline| {
            methods.iter().any(|method| method.objects.iter().any(|o| o.outline == *outline))
        })
        .collect();
    if kinds.is_empty() {
        return String::new();
    }
    let width = name_width(methods);
    let mut text = format!("objects: % wrong / % covered\n{:width$}", "method");
    for kind in &kinds {
        let _ = write!(text, "  {:>15}", kind.name());
    }
    text.push_str("  median error\n");
    for method in methods {
        let _ = write!(text, "{:width$}", method.method);
        for kind in &kinds {
            let cell =
                method.objects.iter().find(|o| o.outline == *kind).map_or("-".to_owned(), |o| {
                    format!("{:.1} / {:.0}", o.wrong_percent(), o.covered_percent())
                });
            let _ = write!(text, "  {cell:>15}");
        }
        let error =
            method.objects.first().and_then(|o| o.median_relative_error).map(|error| 100.0 * error);
        let _ = writeln!(text, "  {:>10} %", number(error, 2));
    }
    text
}

fn name_width(methods: &[MethodSummary]) -> usize {
    methods
        .iter()
        .map(|method| method.method.chars().count())
        .max()
        .unwrap_or(0)
        .max("method".len())
}
