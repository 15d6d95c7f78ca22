//! Figures of README.md: each stands between two pieces of its text.

use super::stored::{Stored, number};
use anyhow::{Context, Result, bail};

/// A figure: the text before it, itself, and the text behind it.
struct Figure {
    before: &'static str,
    value: String,
    after: &'static str,
}

fn all(stored: &Stored) -> Result<[Figure; 5]> {
    const M7: &str = "mps2-an500";
    let of_board = |path: &[&str]| {
        let path = [&["boards", M7], path].concat();
        stored.number(&path).with_context(|| format!("no number {}", path.join(".")))
    };
    let millions = of_board(&["captured", "320x240", "median"])? as f64 / 1e6;
    let kib = |bytes: u64| bytes.div_ceil(1024).to_string();
    let rooms = stored.scores.bench.sets.get("robot_world").context("no scores of robot_world")?;
    let [ours, sgbm, _] = rooms.figure("cells", "first 50 % of all cells: off by > 1 px, %");
    let percent = |value: Option<f64>| value.map(|value| format!("{value:.1}")).context("no score");
    let ram = kib(of_board(&["bytes", "ram"])?);
    let flash = number(&stored.sizes, &[M7, "flash"]).context("no size of live")?;
    Ok([
        Figure {
            before: "pair takes ",
            value: format!("{millions:.1}"),
            after: " million instructions",
        },
        Figure { before: "frames and stack included, ", value: ram, after: " KiB of RAM" },
        Figure { before: "of RAM and ", value: kib(flash), after: " KiB of flash" },
        Figure { before: "rendered rooms, ", value: percent(ours)?, after: " % are wrong" },
        Figure { before: "OpenCV's SGBM: ", value: percent(sgbm)?, after: " %" },
    ])
}

/// The text with its figures as they are stored.
pub(super) fn filled(text: &str, stored: &Stored) -> Result<String> {
    all(stored)?.into_iter().try_fold(text.to_owned(), |text, Figure { before, value, after }| {
        let mut places =
            text.match_indices(before).map(|(place, _)| place + before.len()).filter(|&start| {
                let digits =
                    text[start..].trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
                digits.starts_with(after)
            });
        let (Some(start), None) = (places.next(), places.next()) else {
            bail!("README.md has not one place \"{before}...{after}\"");
        };
        let end = start + text[start..].find(after).context("the text behind a figure")?;
        Ok([&text[..start], &value, &text[end..]].concat())
    })
}

/// Each figure with its unit.
pub(super) fn figures(stored: &Stored) -> Result<Vec<String>> {
    Ok(all(stored)?.into_iter().map(|figure| figure.value + figure.after).collect())
}
