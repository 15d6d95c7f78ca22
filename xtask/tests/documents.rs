//! Documents and comments: lengths of lines, links, figures, the README, generated pages.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask::results;

/// Longest line of prose, characters.
const WIDTH: usize = 100;

/// Files that programs write.
const GENERATED: [&str; 3] =
    ["xtask/board-numbers.toml", "xtask/board-sizes.toml", "bindings/c/include/linestereo.h"];

fn top() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// Files of the repository with these extensions, by their path below its top.
fn files(extensions: &[&str]) -> Vec<(String, String)> {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(top()).output();
    let names: Vec<String> = match listed {
        Ok(listed) if listed.status.success() => {
            String::from_utf8(listed.stdout).unwrap().split('\0').map(str::to_owned).collect()
        }
        _ => walked(top()),
    };
    let is_wanted = |name: &String| extensions.iter().any(|end| name.ends_with(&format!(".{end}")));
    let texts = names.into_iter().filter(is_wanted).filter_map(|name| {
        let text = fs::read_to_string(top().join(&name)).ok()?;
        Some((name, text))
    });
    let texts: Vec<_> = texts.collect();
    assert!(!texts.is_empty(), "{extensions:?}");
    texts
}

/// The same without git: a source archive.
fn walked(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && name != "target" && !name.starts_with('.') {
            names.extend(walked(&path));
        } else if path.is_file() {
            names.push(path.strip_prefix(top()).unwrap().display().to_string());
        }
    }
    names
}

/// Lines outside of blocks of code, with their numbers.
fn outside_code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    (1..).zip(text.lines()).filter(move |(_, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// The same without blocks that programs write.
fn written_by_hand(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_generated = false;
    outside_code(text).filter(move |(_, line)| {
        if line.trim_start().starts_with("<!--") {
            is_generated = line.contains("written by");
        }
        !is_generated
    })
}

/// The same without tables, links of their own and images.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    written_by_hand(text).filter(|(_, line)| {
        let line = line.trim_start();
        !line.starts_with(['|', '<']) && !line.starts_with("![")
    })
}

fn fail_with(found: &[String]) {
    assert!(found.is_empty(), "{} found:\n{}", found.len(), found.join("\n"));
}

fn is_long(line: &str) -> bool {
    // A line that cannot be broken, such as an address, may be longer.
    let words = line.trim_start_matches([' ', '/', '!', '#', '*', '-', '>']);
    line.chars().count() > WIDTH && words.contains(' ')
}

#[test]
fn prose_ends_at_100_columns() {
    let mut found = Vec::new();
    for (name, text) in files(&["md"]) {
        let long = prose(&text).filter(|(_, line)| is_long(line));
        found.extend(long.map(|(number, line)| format!("{name}:{number}: {line}")));
    }
    fail_with(&found);
}

#[test]
fn comments_end_at_100_columns() {
    let mut found = Vec::new();
    let kinds: [(&[&str], &[&str]); 3] = [
        (&["rs", "c", "h", "hpp", "cpp", "js", "mjs"], &["//", "/*", "* "]),
        (&["toml", "py", "sh"], &["# "]),
        (&["css", "x"], &["/*", "* "]),
    ];
    for (extensions, starts) in kinds {
        for (name, text) in files(extensions) {
            if GENERATED.iter().any(|generated| name == *generated) {
                continue;
            }
            let mut is_code = false;
            for (number, line) in text.lines().enumerate() {
                let trimmed = line.trim_start();
                if !starts.iter().any(|start| trimmed.starts_with(start)) {
                    continue;
                }
                let said = trimmed.trim_start_matches(['/', '!', '#', '*', ' ']);
                if said.starts_with("```") {
                    is_code = !is_code;
                } else if !is_code && !said.starts_with('|') && is_long(line) {
                    found.push(format!("{name}:{}: {line}", number + 1));
                }
            }
        }
    }
    fail_with(&found);
}

/// A heading's anchor, as GitHub makes it.
fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text).filter_map(|(_, line)| line.strip_prefix('#'));
    headings.map(|heading| anchor(heading.trim_start_matches('#').trim())).collect()
}

/// Targets of the links of a page.
fn links(text: &str) -> Vec<&str> {
    let targets = outside_code(text).flat_map(|(_, line)| line.split("](").skip(1));
    targets.filter_map(|rest| rest.split(')').next()).collect()
}

#[test]
fn links_lead_somewhere() {
    let mut found = Vec::new();
    for (name, text) in files(&["md"]) {
        for link in links(&text) {
            if link.contains("://") {
                continue;
            }
            let (path, part) = link.split_once('#').unwrap_or((link, ""));
            let page = top().join(&name);
            let target: PathBuf =
                if path.is_empty() { page } else { page.parent().unwrap().join(path) };
            let leads = target.exists()
                && (part.is_empty()
                    || anchors(&fs::read_to_string(&target).unwrap()).contains(part));
            if !leads {
                found.push(format!("{name}: {link}"));
            }
        }
    }
    fail_with(&found);
}

#[test]
fn documents_that_are_named_exist() {
    let mut found = Vec::new();
    for (name, text) in files(&["rs", "toml", "txt", "md", "h", "c", "py", "mjs"]) {
        if name == "CHANGELOG.md" {
            continue;
        }
        for rest in text.split("docs/").skip(1) {
            let path: String =
                rest.chars().take_while(|c| c.is_alphanumeric() || "-_/.".contains(*c)).collect();
            let path = path.trim_end_matches('.');
            if path.ends_with(".md")
                && !path.contains("NAME")
                && !top().join("docs").join(path).is_file()
            {
                found.push(format!("{name}: docs/{path}"));
            }
        }
    }
    fail_with(&found);
}

/// Pages whose figures are no measurements of the method, and why.
const PAGES_WITH_FIGURES: [(&str, &str); 7] = [
    ("docs/results.md", "generated"),
    ("docs/experiments.md", "what was tried at its time"),
    ("docs/boards/", "datasheets and memory maps"),
    ("docs/cameras.md", "datasheets, and what follows from them"),
    ("docs/autopilots.md", "rules of PX4 and ArduPilot"),
    ("docs/porting.md", "memory maps"),
    ("CHANGELOG.md", "history"),
];

/// Figures that are settings, limits or definitions.
const ALLOWED: [(&str, &str); 6] = [
    ("docs/contributing.md", "85 %"),
    ("docs/contributing.md", "90 %"),
    ("docs/formats.md", "1 %"),
    ("docs/formats.md", "2 %"),
    ("docs/recordings.md", "1 ms"),
    ("docs/recordings.md", "32 MiB"),
];

/// Numbers with a unit of measured figures: shares, instructions, times, sizes.
fn figures(line: &str) -> Vec<String> {
    const UNITS: [&str; 13] = [
        "%", "percent", "instructions", "M instructions", "million instructions", "ms", "KB", "kB",
        "KiB", "MB", "MiB", "fps", "cycles",
    ];
    let mut found = Vec::new();
    let words: Vec<&str> = line.split_whitespace().collect();
    for (index, word) in words.iter().enumerate() {
        let number = word.trim_start_matches(['(', '*', '~', '[']);
        if !number.starts_with(|c: char| c.is_ascii_digit()) {
            continue;
        }
        let digits = number.trim_end_matches(|c: char| !c.is_ascii_digit() && c != '%');
        let rest = words[index + 1..].join(" ");
        let of_unit = |unit: &&&str| {
            let behind = rest.strip_prefix(**unit);
            behind.is_some_and(|behind| !behind.starts_with(|c: char| c.is_alphanumeric()))
        };
        if let Some(unit) =
            digits.strip_suffix('%').map(|_| &"%").or_else(|| UNITS.iter().rev().find(of_unit))
        {
            found.push(format!("{} {unit}", digits.trim_end_matches('%')));
        }
    }
    found
}

#[test]
fn figures_are_generated() {
    let generated = results::readme_figures(top()).unwrap();
    let (mut found, mut used) = (Vec::new(), BTreeSet::new());
    for (name, text) in files(&["md"]) {
        if PAGES_WITH_FIGURES.iter().any(|(page, _)| name.starts_with(page)) {
            continue;
        }
        for (number, line) in written_by_hand(&text) {
            for figure in figures(line) {
                let is_known = |known: &String| known.starts_with(&figure);
                if name == "README.md" && generated.iter().any(is_known) {
                    continue;
                }
                let is_listed = |(page, known): &&(&str, &str)| name == *page && figure == *known;
                match ALLOWED.iter().find(is_listed) {
                    Some(listed) => _ = used.insert(*listed),
                    None => found.push(format!("{name}:{number}: {figure}: {line}")),
                }
            }
        }
    }
    fail_with(&found);
    let unused: Vec<_> = ALLOWED.iter().filter(|listed| !used.contains(*listed)).collect();
    assert!(unused.is_empty(), "no page has these any more: {unused:?}");
}

#[test]
fn figures_are_found() {
    let line = "It takes 13.2 million instructions, 302 KiB and 4.0 % (6.9 %), of 320x240 px.";
    assert_eq!(figures(line), ["13.2 million instructions", "302 KiB", "4.0 %", "6.9 %"]);
}

#[test]
fn the_readme_can_be_skimmed() {
    let text = fs::read_to_string(top().join("README.md")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines.len() <= 110, "{} lines", lines.len());
    let words = text.split_whitespace().count();
    assert!(words <= 900, "{words} words");
    let wide: Vec<_> = lines.iter().filter(|line| line.chars().count() > 110).collect();
    assert!(wide.is_empty(), "{wide:?}");
    let status = lines.iter().position(|line| line.contains("no board has run it yet"));
    assert!(
        status.is_some_and(|line| line < 25),
        "the status stands on the first screen: {status:?}"
    );
    let position = |part: &str| {
        lines.iter().position(|line| line.starts_with(part)).unwrap_or_else(|| panic!("{part}"))
    };
    let order = [
        "# linestereo", "![", "- ", "**Status", "## Use it if", "## Use something else if",
        "## Quick start on a PC", "cargo run ", "cargo test --workspace", "linestereo run ",
        "## Quick start in firmware", "```rust", "## More", "Licensed under",
    ];
    assert!(order.map(position).is_sorted(), "{:?}", order.map(position));
    let figures = results::readme_figures(top()).unwrap();
    assert!(figures.len() <= 5, "{figures:?}");
}

#[test]
fn the_design_can_be_read_in_one_sitting() {
    let text = fs::read_to_string(top().join("docs/design.md")).unwrap();
    assert!(text.lines().count() <= 220);
    for word in ["instead of", "no longer", "used to", "as it was", "as they were"] {
        assert!(!text.contains(word), "history: {word}");
    }
}

#[test]
fn results_agree_with_the_stored_measurements() {
    results::check(top()).unwrap();
}
