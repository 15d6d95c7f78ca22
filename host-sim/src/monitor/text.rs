//! Frames and counts as text.

use super::frames::{Frame, FrameCounts};
use crate::engine::FrameResult;
use crate::results::directions::Direction;
use crate::results::health;
use crate::results::listing;
use core::fmt::Write;
use linestereo::ObjectDepth;
use linestereo_wire::{
    Counters, FrameHead, FrameTimes, ObjectRecord, SectorRecord, Sectors, VERSION,
};
use serde::Serialize;
use serde_json::{Value, json};

/// Names of the columns of a line of the table.
pub const HEAD: &str = "    frame      time s  since ms  wait ms  match ms  port ms  segments  nearest m  farthest m  health";

/// A frame as one line; `last` is the capture time of the frame before.
pub fn line(frame: &Frame, last: Option<u64>) -> String {
    let head = &frame.head;
    let FrameTimes { waiting_us, matching_us, port_us } = head.times;
    let since = last.and_then(|last| head.capture_time_us.checked_sub(last));
    let segments = match frame.missing() {
        0 => head.segments.to_string(),
        _ => format!("{}/{}", frame.matches.len(), head.segments),
    };
    let depths = || frame.matches.iter().filter_map(|found| found.depth).flatten();
    let metres = |depth: Option<_>| match depth.map(listing::finite_metres) {
        None => "-".to_owned(),
        Some(None) => "infinite".to_owned(),
        Some(Some(metres)) => format!("{metres:.2}"),
    };
    format!(
        "{:>9} {:>11.3} {:>9} {:>8.1} {:>9.1} {:>8.1} {segments:>9} {:>10} {:>11}  {}",
        head.sequence,
        head.capture_time_us as f64 / 1e6,
        since.map_or("-".to_owned(), |since| format!("{:.1}", since as f64 / 1e3)),
        f64::from(waiting_us) / 1e3,
        f64::from(matching_us) / 1e3,
        f64::from(port_us) / 1e3,
        metres(depths().min()),
        metres(depths().max()),
        head.health
    )
}

/// The depth of an object as one line.
pub fn object(record: &ObjectRecord) -> String {
    let label = record.label;
    let object = match record.depth() {
        Ok(object) => object,
        Err(why) => return format!("object {label}: {why}"),
    };
    let ObjectDepth { disparity, sigma, metres, support, .. } = object;
    match metres.and_then(|metres| listing::finite_metres(metres.depth)) {
        Some(metres) => format!("object {label}: {metres:.2} m, support {support}"),
        None => format!("object {label}: {disparity:.2} px, sigma {sigma:.2} px"),
    }
}

/// The nearest of what is known by direction, as one line.
pub fn sectors(sectors: &Sectors) -> String {
    let list = directions(sectors);
    let nearest = |what: &str, distance: fn(&Direction) -> Option<f64>| {
        let all = list.iter().filter_map(|of| Some((distance(of)?, of.direction_deg)));
        all.min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(metres, degrees)| format!("{what} {metres:.2} m at {degrees} degrees"))
    };
    let found = [
        nearest("obstacle", |of| of.distance_m),
        nearest("drop-off", |of| of.drop_off_m),
        match list.iter().filter(|of| of.state == "free").count() {
            0 => None,
            free => Some(format!("{free} free")),
        },
    ];
    let found: Vec<_> = found.into_iter().flatten().collect();
    format!("sectors: {}", if found.is_empty() { "unknown".to_owned() } else { found.join(", ") })
}

/// Directions as one line of JSON; each is as in [`listing::json`].
pub fn sectors_json(sectors: &Sectors) -> serde_json::Result<String> {
    serde_json::to_string(&json!({
        "sequence": sectors.sequence, "turn": sectors.turn, "sectors": directions(sectors)
    }))
}

/// The directions of a record, with distances in m, as `run --json` lists them.
pub fn directions(sectors: &Sectors) -> Vec<Direction> {
    let direction = |record: &SectorRecord| {
        Direction::new(record.index, sectors.turn, record.sector(), record.drop_off())
    };
    sectors.list.iter().map(direction).collect()
}

#[derive(Serialize)]
struct Listing {
    sequence: u32,
    capture_time_us: u64,
    clock: &'static str,
    size: [u16; 2],
    times_us: Value,
    health: health::Listing,
    segments: Vec<listing::Segment>,
    #[serde(serialize_with = "listing::as_map")]
    counts: Vec<(&'static str, u32)>,
}

/// A frame as one line of JSON; its segments are those of [`listing::json`].
pub fn json(frame: &Frame) -> serde_json::Result<String> {
    let head = &frame.head;
    let FrameHead { health, pair, times, .. } = *head;
    let FrameTimes { waiting_us, matching_us, port_us } = times;
    serde_json::to_string(&Listing {
        sequence: head.sequence,
        capture_time_us: head.capture_time_us,
        clock: head.clock.name(),
        size: [head.width, head.height],
        times_us: json!({ "waiting": waiting_us, "matching": matching_us, "port": port_us }),
        health: health::Listing::new(&FrameResult { health, pair, ..FrameResult::default() }),
        segments: frame.matches.iter().enumerate().map(listing::segment).collect(),
        counts: listing::counts(&head.counts),
    })
}

/// Summary of received, incomplete and lost frames, a few lines.
pub fn summary(
    frames: &FrameCounts,
    packets: &Counters,
    bytes: u64,
    other_version: Option<u8>,
) -> String {
    let mut text =
        format!("frames: {} complete, {} incomplete", frames.complete, frames.incomplete);
    if frames.missing_segments > 0 {
        let _ = write!(text, " ({} segments missing)", frames.missing_segments);
    }
    let _ = write!(text, ", {} lost", frames.lost);
    if frames.restarts > 0 {
        let _ = write!(text, ", {} restarts of the board", frames.restarts);
    }
    let _ = writeln!(
        text,
        "\npackets: {} good, {} framing damaged, {} checksum wrong, {} too long, {} malformed, \
         {} of another version",
        packets.good,
        packets.cobs,
        packets.checksum,
        packets.too_long,
        packets.malformed,
        packets.other_version
    );
    if let Some(found) = other_version {
        let what = if found & 0x80 == 0 { "version" } else { "commands (an echo?) of version" };
        let found = found & 0x7f;
        let _ =
            writeln!(text, "another version: {what} {found}, this program reads version {VERSION}");
    }
    let _ = writeln!(text, "bytes: {bytes} received, {} skipped", packets.skipped_bytes);
    text
}
