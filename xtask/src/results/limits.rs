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
    let frames_bytes = |name| frames(name).map(bytes);
    Ok(format!(
        "\
| input | at most | beyond |
| --- | --- | --- |
| image | {image} stored and decoded, {pixels} px, 65535 px a side | refused by its header |
| disparities: PFM, NPY, NPZ | the same | \
         the same; an archive is unpacked as far as its header says |
| detections: JSON, text, CSV | {detections}, {objects} objects, {runs} runs of masks and outlines | \
         the file is refused; objects beyond are skipped and counted |
| `scene.json`, `rig.toml`, other calibrations, rig images | \
         {settings}; YAML and XML {depth} levels, {values} values | refused |
| results of this program | {results} | refused |
| recording (`.mcap`) | any length; a chunk or message {record}; {images} images, {topics} topics | \
         refused by the stated length |
| video, camera | any length; {video_frames} frames; {silence} s of silence | \
         ended; finished pairs are kept |
| package of frames | {package}; the SHA-256 of each file is known | refused |
| request to the page of `view` | head {head}, body {body}, {within} s, {connections} connections | \
         refused |
| page of `view` | {visitors} pages; {messages} messages or {waiting} wait for each | \
         the oldest messages are dropped, and the page is told |
| packet on a port | one record, with CRC-32 | dropped and counted; the next one is read |
",
        image = frames_bytes("IMAGE_BYTES")?,
        pixels = frames("PIXELS")?,
        detections = frames_bytes("OBJECTS_BYTES")?,
        objects = get(REGIONS, "MAX_OBJECTS")?,
        runs = get(REGIONS, "MAX_RUNS")?,
        settings = frames_bytes("SETTINGS_BYTES")?,
        depth = get(NODE, "MAX_DEPTH")?,
        values = get(NODE, "MAX_VALUES")?,
        results = frames_bytes("RESULT_BYTES")?,
        record = bytes(get("crates/recordings/src/mcap/mod.rs", "RECORD_BYTES")?),
        images = get(RECORDING, "MOST_IMAGES")?,
        topics = get(RECORDING, "MOST_TOPICS")?,
        video_frames = get("crates/recordings/src/video/mod.rs", "MOST_FRAMES")?,
        silence = get("crates/recordings/src/video/ffmpeg.rs", "SILENCE")?,
        package = frames_bytes("PACKAGE_BYTES")?,
        head = bytes(get(REQUEST, "HEAD_BYTES")?),
        body = bytes(get(REQUEST, "BODY_BYTES")?),
        within = get(REQUEST, "WITHIN")?,
        connections = get("host-sim/src/serve/server.rs", "MOST_CONNECTIONS")?,
        visitors = get(VISITORS, "MOST_VISITORS")?,
        messages = get(VISITORS, "MOST_WAITING")?,
        waiting = bytes(get(VISITORS, "MOST_BYTES")?),
    ))
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
