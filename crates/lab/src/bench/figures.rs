//! Figures of a run: what each metric says of each method, as JSON and as the lines of a table.

use serde::{Deserialize, Serialize};

/// A value in a table.
pub(crate) fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
}

/// A value for each method; `None` where a metric is not defined for it, or has nothing to say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Values {
    pub(crate) linestereo: Option<f64>,
    pub(crate) sgbm: Option<f64>,
    pub(crate) bm: Option<f64>,
}

impl Values {
    /// Of linestereo, SGBM and StereoBM; what is not a number is left out.
    pub(crate) fn new(of: [Option<f64>; 3]) -> Self {
        let [linestereo, sgbm, bm] = of.map(|value| value.filter(|value| value.is_finite()));
        Self { linestereo, sgbm, bm }
    }

    /// Of linestereo alone.
    pub(crate) fn linestereo(value: f64) -> Self {
        Self::new([Some(value), None, None])
    }

    fn all(&self) -> [Option<f64>; 3] {
        [self.linestereo, self.sgbm, self.bm]
    }
}

/// Which change of a figure is a gain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Better {
    /// A larger value.
    Higher,
    /// A smaller value.
    Lower,
    /// None: it describes the data, or what another figure is about.
    Neither,
}

/// One line of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Figure {
    pub(crate) name: String,
    pub(crate) better: Better,
    /// Digits shown behind the point.
    pub(crate) decimals: usize,
    /// Shown without `--full`.
    pub(crate) main: bool,
    pub(crate) values: Values,
}

impl Figure {
    pub(crate) fn new(
        name: impl Into<String>,
        better: Better,
        decimals: usize,
        values: Values,
    ) -> Self {
        Self { name: name.into(), better, decimals, main: true, values }
    }

    /// A number of cells, objects or sectors, shown where every figure is asked for.
    pub(crate) fn count(name: impl Into<String>, values: Values) -> Self {
        Self::new(name, Better::Neither, 0, values).minor()
    }

    /// The same, shown where every figure is asked for.
    pub(crate) fn minor(self) -> Self {
        Self { main: false, ..self }
    }

    fn is_empty(&self) -> bool {
        self.values.all().iter().all(Option::is_none)
    }

    /// A value as tables show it.
    pub(crate) fn shown(&self, value: Option<f64>) -> String {
        number(value, self.decimals)
    }

    fn line(&self) -> String {
        let [linestereo, sgbm, bm] = self.values.all().map(|value| self.shown(value));
        format!("    {:<44}{linestereo:>11}{sgbm:>9}{bm:>10}\n", self.name)
    }
}

/// Figures of one metric.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Group {
    pub(crate) name: String,
    pub(crate) figures: Vec<Figure>,
}

impl Group {
    /// Figures that no method has are left out.
    pub(crate) fn new(name: impl Into<String>, mut figures: Vec<Figure>) -> Self {
        figures.retain(|figure| !figure.is_empty());
        Self { name: name.into(), figures }
    }
}

/// A data set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SetReport {
    /// Its path below the folder that was scored.
    pub(crate) name: String,
    pub(crate) scenes: usize,
    /// Scenes that were left out, and why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) notes: Vec<String>,
    pub(crate) groups: Vec<Group>,
}

/// Everything that a run found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Report {
    /// Version of OpenCV.
    pub(crate) opencv: Option<String>,
    pub(crate) sets: Vec<SetReport>,
}

impl Report {
    /// As a table; with `full`, every figure.
    pub(crate) fn table(&self, full: bool) -> String {
        self.sets.iter().map(|set| set.table(full)).collect()
    }
}

impl SetReport {
    /// Says whether OpenCV was scored, too.
    pub(crate) fn has_opencv(&self) -> bool {
        let mut figures = self.groups.iter().flat_map(|group| &group.figures);
        figures.any(|Figure { values, .. }| values.sgbm.or(values.bm).is_some())
    }

    fn table(&self, full: bool) -> String {
        let head = format!("{}, {} scenes", self.name, self.scenes);
        let mut text = format!("\n{head:<48}{:>11}{:>9}{:>10}\n", "linestereo", "SGBM", "StereoBM");
        for group in &self.groups {
            let lines: String = group
                .figures
                .iter()
                .filter(|figure| full || figure.main)
                .map(Figure::line)
                .collect();
            if !lines.is_empty() {
                text.push_str(&format!("  {}\n{lines}", group.name));
            }
        }
        text.extend(self.notes.iter().map(|note| format!("  note: {note}\n")));
        text
    }
}

/// A share in percent: not a number where the whole is 0.
pub(crate) fn percent(part: usize, whole: usize) -> f64 {
    (100 * part) as f64 / whole as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_has_a_line_per_figure() {
        let values = Values::new([Some(12.345), None, Some(f64::NAN)]);
        let shown = Figure::new("off by > 1 px, %", Better::Lower, 2, values);
        let group = Group::new(
            "cells",
            vec![
                shown.clone(),
                shown.clone().minor(),
                Figure { values: Values::default(), ..shown },
            ],
        );
        assert_eq!(group.figures.len(), 2, "no method has a value");
        let set = SetReport {
            name: "room".to_owned(),
            scenes: 3,
            notes: vec!["one".to_owned()],
            groups: vec![group],
        };
        let report = Report { opencv: None, sets: vec![set] };
        let text = report.table(false);
        assert_eq!(text.matches("off by > 1 px, %").count(), 1);
        assert!(text.ends_with("      12.35        -         -\n  note: one\n"), "{text}");
        assert_eq!(report.table(true).matches("12.35").count(), 2);
        let json = serde_json::to_string(&report).unwrap();
        assert_eq!(serde_json::from_str::<Report>(&json).unwrap(), report);
    }
}
