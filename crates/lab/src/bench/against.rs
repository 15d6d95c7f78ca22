//! Gains and losses of a run against an earlier one.

use super::figures::{Better, Figure, Group, Report, SetReport};
use super::scoring::DAMAGES;
use core::fmt::Write;

/// A figure of linestereo that is not shown as it was.
#[derive(Clone, Debug, PartialEq)]
struct Change<'a> {
    set: &'a str,
    group: &'a str,
    figure: &'a Figure,
    before: Option<f64>,
    now: Option<f64>,
}

impl Change<'_> {
    /// A gain is `Some(true)`, a loss `Some(false)`.
    fn is_gain(&self) -> Option<bool> {
        let rises = match (self.before, self.now) {
            (Some(before), Some(now)) => now > before,
            // What is not reached at all, such as a coverage, is worse than any value of it.
            (before, _) => {
                return (self.figure.better != Better::Neither).then_some(before.is_none());
            }
        };
        match self.figure.better {
            Better::Higher => Some(rises),
            Better::Lower => Some(!rises),
            Better::Neither => None,
        }
    }

    fn line(&self) -> String {
        let what = match self.is_gain() {
            Some(true) => "gained",
            Some(false) => "lost",
            None => "changed",
        };
        let [before, now] = [self.before, self.now].map(|value| self.figure.shown(value));
        format!("    {what:<8}{:<44}{before:>9} -> {now}\n", self.figure.name)
    }
}

/// The figures of linestereo that changed in what is shown of them, by set and metric. Both runs
/// may have sets that the other one lacks: these are left out. A figure that is gone is a loss.
pub(crate) fn changes(before: &Report, now: &Report) -> String {
    let changes = find(before, now);
    let count =
        |kind: Option<bool>| changes.iter().filter(|change| change.is_gain() == kind).count();
    let mut text = format!(
        "\nagainst the stored run: {} gained, {} lost",
        count(Some(true)),
        count(Some(false))
    );
    let _ = match count(None) {
        0 => writeln!(text),
        others => writeln!(text, ", {others} others changed"),
    };
    let mut at = ("", "");
    for change in &changes {
        if (change.set, change.group) != at {
            at = (change.set, change.group);
            let _ = writeln!(text, "  {}: {}", change.set, change.group);
        }
        text.push_str(&change.line());
    }
    if before.opencv != now.opencv {
        text.push_str("  the stored run had another version of OpenCV, or none\n");
    }
    text
}

fn find<'a>(before: &'a Report, now: &'a Report) -> Vec<Change<'a>> {
    let mut changes = Vec::new();
    for set in &now.sets {
        let Some(old_set) = before.sets.iter().find(|old| old.name == set.name) else { continue };
        // Without OpenCV no image is damaged.
        let is_run = |old: &&Group| {
            now.opencv.is_some() || !DAMAGES.iter().any(|damage| old.name.ends_with(damage))
        };
        for old_group in old_set.groups.iter().filter(is_run) {
            let group = set.groups.iter().find(|group| group.name == old_group.name);
            let figures = group.map_or(&[][..], |group| &group.figures);
            let is_gone = |old: &&Figure| figures.iter().all(|figure| figure.name != old.name);
            for figure in figures.iter().chain(old_group.figures.iter().filter(is_gone)) {
                let of = |list: &[Figure]| {
                    list.iter().find(|of| of.name == figure.name)?.values.linestereo
                };
                let (before, now) = (of(&old_group.figures), of(figures));
                if figure.shown(before) != figure.shown(now) {
                    let (set, group) = (&*set.name, &*old_group.name);
                    changes.push(Change { set, group, figure, before, now });
                }
            }
        }
    }
    changes
}

/// A stored set that is not run again and has scores of another version of OpenCV.
pub(crate) fn of_other_version<'a>(
    stored: &'a Report,
    opencv: &str,
    is_run: impl Fn(&str) -> bool,
) -> Option<&'a str> {
    let mut kept = stored.sets.iter().filter(|set| set.has_opencv() && !is_run(&set.name));
    kept.find(|_| stored.opencv.as_deref() != Some(opencv)).map(|set| &*set.name)
}

/// The sets of `before` that were not run again, and those of `now`, of one version of OpenCV. A
/// set that has scores of OpenCV stays where OpenCV was not run.
pub(crate) fn merged(before: Option<Report>, now: Report) -> Report {
    let Report { opencv, mut sets } = before.unwrap_or_default();
    let is_newer = |old: &SetReport| now.sets.iter().any(|set| set.name == old.name);
    sets.retain(|old| !is_newer(old) || (now.opencv.is_none() && old.has_opencv()));
    let of_now = now.sets.into_iter();
    let newer: Vec<_> = of_now.filter(|set| sets.iter().all(|old| old.name != set.name)).collect();
    sets.extend(newer);
    sets.sort_by(|a, b| a.name.cmp(&b.name));
    Report { opencv: now.opencv.or(opencv), sets }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::figures::{Group, SetReport, Values};

    fn report(set: &str, better: Better, value: f64) -> Report {
        let figure = Figure::new("a figure", better, 1, Values::linestereo(value));
        let group = Group::new("cells", vec![figure]);
        let set =
            SetReport { name: set.to_owned(), scenes: 1, notes: Vec::new(), groups: vec![group] };
        Report { opencv: None, sets: vec![set] }
    }

    #[test]
    fn gains_and_losses_are_told_apart() {
        let of = |better, before, now| {
            changes(&report("room", better, before), &report("room", better, now))
        };
        assert!(
            of(Better::Lower, 2.0, 1.0)
                .contains("1 gained, 0 lost\n  room: cells\n    gained  a figure")
        );
        assert!(of(Better::Higher, 2.0, 1.0).contains("0 gained, 1 lost"));
        assert!(of(Better::Neither, 2.0, 1.0).contains("0 gained, 0 lost, 1 others changed"));
        assert!(
            of(Better::Lower, 2.0, 2.01).contains("0 gained, 0 lost\n"),
            "what is shown is equal"
        );
    }

    #[test]
    fn what_is_gone_is_lost() {
        let (before, mut now) = (report("a", Better::Lower, 1.0), report("a", Better::Lower, 1.0));
        now.sets[0].groups[0].figures.clear();
        let lost = "0 gained, 1 lost\n  a: cells\n    lost    a figure";
        assert!(changes(&before, &now).contains(lost));
        now.sets[0].groups.clear();
        assert!(changes(&before, &now).contains(lost), "with its metric");
    }

    #[test]
    fn without_opencv_its_scores_stay() {
        let (mut before, now) = (report("a", Better::Lower, 1.0), report("a", Better::Lower, 2.0));
        before.opencv = Some("5.0.0".to_owned());
        assert_eq!(super::merged(Some(before.clone()), now.clone()).sets, now.sets);
        before.sets[0].groups[0].name.push_str(", noise5");
        before.sets[0].groups[0].figures[0].values.sgbm = Some(3.0);
        assert!(changes(&before, &now).contains("0 gained, 0 lost\n"), "it was not run");
        assert_eq!(super::merged(Some(before.clone()), now.clone()), before);
        let other = |version, run: &str| of_other_version(&before, version, |set| set == run);
        assert_eq!(
            [other("5.0.1", "b"), other("5.0.1", "a"), other("5.0.0", "b")],
            [Some("a"), None, None]
        );
        let again = Report { opencv: before.opencv.clone(), ..now };
        assert_eq!(super::merged(Some(before), again.clone()), again);
    }

    #[test]
    fn other_sets_are_left_out_and_kept() {
        let (before, now) = (report("b", Better::Lower, 1.0), report("a", Better::Lower, 2.0));
        assert!(changes(&before, &now).contains("0 gained, 0 lost\n"));
        let merged = merged(Some(before), now.clone());
        assert_eq!(merged.sets.iter().map(|set| set.name.as_str()).collect::<Vec<_>>(), ["a", "b"]);
        assert_eq!(super::merged(Some(report("a", Better::Lower, 9.0)), now.clone()), now);
    }
}
