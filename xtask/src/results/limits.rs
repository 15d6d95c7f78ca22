//! The table of `docs/security.md`, from the constants that the programs are compiled with.

use super::read;
use anyhow::{Context, Result};
use std::path::Path;

const BEGIN: &str = "<!-- limits, written by `cargo xtask results` -->\n";
const END: &str = "<!-- end of limits -->\n";

/// The text with its table as the sources have it.
pub(super) fn filled(text: &str, top: &Path) -> Result<String> {
    let missing = || format!("docs/security.md has no {}", BEGIN.trim());
    let (before, rest) = text.split_once(BEGIN).with_context(missing)?;
    let (_, after) = rest.split_once(END).with_context(missing)?;
    Ok([before, BEGIN, &table(top)?, END, after].concat())
}

fn table(top: &Path) -> Result<String> {
    const UNTRUSTED: &str = "crates/frames/src/untrusted.rs";
    const REGIONS: &str = "crates/frames/src/regions/mod.rs";
    const NODE: &str = "crates/calibration/src/interchange/node.rs";
    const RECORDING: &str = "crates/recordings/src/recording/mod.rs";
    const VISITORS: &str = "host-sim/src/serve/visitors.rs";
    const REQUEST: &str = "host-sim/src/serve/request.rs";
    let get = |file: &str, name: &str| {
        constant(&read(&top.join(file))?, name).with_context(|| format!("{file}: {name}"))
    };
    let frames = |name| get(UNTRUSTED, name);
    let video = |name| get("crates/recordings/src/video/mod.rs", name);
    let rows = [
        ["input", "at most", "beyond"].map(str::to_owned),
        ["---", "---", "---"].map(str::to_owned),
        [
            "image".to_owned(),
            format!(
                "{} stored and decoded, {} px, 65535 px a side",
                bytes(frames("IMAGE_BYTES")?),
                frames("PIXELS")?
            ),
            "refused by its header".to_owned(),
        ],
        [
            "disparities: PFM, NPY, NPZ".to_owned(),
            "the same".to_owned(),
            "the same; an archive is unpacked as far as its header says".to_owned(),
        ],
        [
            "detections: JSON, text, CSV".to_owned(),
            format!(
                "{}, {} objects, {} runs of masks and outlines",
                bytes(frames("OBJECTS_BYTES")?),
                get(REGIONS, "MAX_OBJECTS")?,
                get(REGIONS, "MAX_RUNS")?,
            ),
            "the file is refused; objects beyond are skipped and counted".to_owned(),
        ],
        [
            "`scene.json`, `rig.toml`, other calibrations, rig images".to_owned(),
            format!(
                "{}; YAML and XML {} levels, {} values",
                bytes(frames("SETTINGS_BYTES")?),
                get(NODE, "MAX_DEPTH")?,
                get(NODE, "MAX_VALUES")?,
            ),
            "refused".to_owned(),
        ],
        [
            "results of this program".to_owned(),
            bytes(frames("RESULT_BYTES")?),
            "refused".to_owned(),
        ],
        [
            "recording (`.mcap`)".to_owned(),
            format!(
                "any length; a chunk or message {}; {} images, {} topics",
                bytes(get("crates/recordings/src/mcap/mod.rs", "RECORD_BYTES")?),
                get(RECORDING, "MOST_IMAGES")?,
                get(RECORDING, "MOST_TOPICS")?,
            ),
            "refused by the stated length".to_owned(),
        ],
        [
            "video, camera".to_owned(),
            format!(
                "any length; {} frames; {} s of silence",
                video("MOST_FRAMES")?,
                get("crates/recordings/src/video/ffmpeg.rs", "SILENCE")?,
            ),
            "ended; finished pairs are kept".to_owned(),
        ],
        [
            "package of frames".to_owned(),
            format!("{}; the SHA-256 of each file is known", bytes(frames("PACKAGE_BYTES")?)),
            "refused".to_owned(),
        ],
        [
            "request to the page of `view`".to_owned(),
            format!(
                "head {}, body {}, {} s, {} connections",
                bytes(get(REQUEST, "HEAD_BYTES")?),
                bytes(get(REQUEST, "BODY_BYTES")?),
                get(REQUEST, "WITHIN")?,
                get("host-sim/src/serve/server.rs", "MOST_CONNECTIONS")?,
            ),
            "refused".to_owned(),
        ],
        [
            "page of `view`".to_owned(),
            format!(
                "{} pages; {} messages or {} wait for each",
                get(VISITORS, "MOST_VISITORS")?,
                get(VISITORS, "MOST_WAITING")?,
                bytes(get(VISITORS, "MOST_BYTES")?),
            ),
            "the oldest messages are dropped, and the page is told".to_owned(),
        ],
        [
            "packet on a port".to_owned(),
            "one record, with CRC-32".to_owned(),
            "dropped and counted; the next one is read".to_owned(),
        ],
    ];
    Ok(rows.map(|row| format!("| {} |\n", row.join(" | "))).concat())
}

/// The value of a constant: a number, a shift of two, or seconds.
fn constant(source: &str, name: &str) -> Result<u64> {
    let (_, rest) =
        source.split_once(&format!("const {name}: ")).context("there is no such constant")?;
    let value = rest
        .split_once('=')
        .and_then(|(_, rest)| rest.split_once(';'))
        .context("it has no value")?
        .0;
    let value = value.trim().trim_start_matches("Duration::from_secs(").trim_end_matches(')');
    let number =
        |text: &str| text.trim().replace('_', "").parse::<u64>().context("it is no number");
    Ok(match value.split_once("<<") {
        Some((value, places)) => number(value)? << number(places)?,
        None => number(value)?,
    })
}

fn bytes(count: u64) -> String {
    match count {
        0..1024 => format!("{count} bytes"),
        1024..0x10_0000 => format!("{} KiB", count >> 10),
        0x10_0000..0x4000_0000 => format!("{} MiB", count >> 20),
        _ => format!("{} GiB", count >> 30),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_are_read_as_rust_has_them() {
        let source = "pub const A: u64 = 32 << 20;\nconst B: usize = 100_000;\n\
                      const C: Duration = Duration::from_secs(15);";
        assert_eq!(
            ["A", "B", "C"].map(|name| constant(source, name).unwrap()),
            [32 << 20, 100_000, 15]
        );
        assert!(constant(source, "D").is_err());
        assert_eq!(
            [512, 8 << 10, 128 << 20, 1 << 30].map(bytes),
            ["512 bytes", "8 KiB", "128 MiB", "1 GiB"]
        );
    }
}
