//! The health of a pair, for people and for JSON.

use crate::engine::FrameResult;
use linestereo::health::{CameraHealth, HealthFlags};
use linestereo::results::Rejection;
use linestereo_wire::{Health, PairReport, RangeReport};
use serde::Serialize;

/// Least number of compared segments, and their share below which the matched ones are said to be
/// few.
const LEAST_COMPARED: u16 = 24;
const FEW: f64 = 0.15;
/// Least share of a picture without noise that is said, per thousand.
const MUCH_REMOVED_PERMILLE: u16 = 100;

/// Flags with their remedies: first those by which the pair is not fit to be used, then warnings,
/// then what only costs yield.
pub fn advice(health: Health) -> impl Iterator<Item = (&'static str, &'static str)> {
    let is_far = health.of_pair().contains(HealthFlags::ROWS_FAR);
    let mut told: Vec<_> = Health::NAMES
        .into_iter()
        .zip(Health::ADVICE)
        .filter(|((flag, name), _)| {
            health.contains(*flag) && !(*name == "rows_off" && is_far) // it says: corrected
        })
        .collect();
    told.sort_by_key(|&((_, name), _)| urgency(name));
    told.into_iter().map(|(_, told)| told)
}

/// Order in which flags are told, lowest first: 0 not fit to be used, 1 a warning, 2 a loss of
/// yield.
pub fn urgency(name: &str) -> u8 {
    let flag = Health::NAMES
        .into_iter()
        .find(|(_, known)| *known == name)
        .map_or(Health::GOOD, |(flag, _)| flag);
    u8::from(is_fit(flag)) + u8::from(is_loss(flag))
}

/// Results are right, and fewer than the images have.
fn is_loss(flag: Health) -> bool {
    (Health::SEGMENTS_DROPPED | Health::RESULTS_SKIPPED).contains(flag)
}

/// May what is matched be believed? With one of these flags it may be wrong, or from another time;
/// the others cost yield, or warn.
pub fn is_fit(health: Health) -> bool {
    let of_pair = health.of_pair();
    !health.contains(Health::PAIR_MISSING)
        && !health.contains(Health::SIZE_MISMATCH)
        && of_pair.is_fit()
}

/// Matches of the exchanged images, if they are far more.
fn exchange(result: &FrameResult) -> Option<String> {
    result.exchanged.map(|[matched, segments]| {
        format!(
            "left and right are exchanged, or both images are mirrored or upside down: exchange \
             them, then {matched} of {segments} segments match"
        )
    })
}

/// Windows that match beyond the range, and the range that has them; `None` where it is not small.
fn beyond_range(result: &FrameResult) -> Option<String> {
    let is_small = result.health.of_pair().contains(HealthFlags::RANGE_SMALL);
    let RangeReport { windows, beyond, disparity } =
        result.pair.as_ref().filter(|_| is_small)?.range?;
    Some(format!(
        "{beyond} of {windows} windows match beyond the range, at up to {disparity} px: \
         --max-disparity {} or more",
        (disparity + disparity / 8).max(disparity + 2),
    ))
}

/// Rows that are off or few matches, as of rectified images that are rectified once more.
pub fn may_be_rectified(health: Health) -> bool {
    let flags = HealthFlags::ROWS_OFF
        | HealthFlags::ROWS_FAR
        | HealthFlags::ROWS_UNEVEN
        | HealthFlags::FEW_MATCHES;
    health.of_pair().intersects(flags)
}

/// Why nothing of a pair is to be used, with what to do; `None` where something is matched, and may
/// be believed.
pub fn refusal(result: &FrameResult) -> Option<String> {
    let by_flag = || {
        let (flag, what) = advice(result.health).next()?;
        // Few matches come of a small range too, whose end is known.
        let range = beyond_range(result).filter(|_| ["few_matches", "range_small"].contains(&flag));
        Some(
            range
                .map_or_else(|| format!("{flag}: {what}"), |range| format!("range_small: {range}")),
        )
    };
    let told = exchange(result).or_else(by_flag);
    if !is_fit(result.health) {
        return Some(format!("the pair is not fit to be used; {}", told.unwrap_or_default()));
    }
    if !result.matches.is_empty() || !result.points.is_empty() {
        return None;
    }
    let unknown = "give two rectified images of one scene that has texture, left before right";
    Some(format!("nothing is matched; {}", told.unwrap_or_else(|| unknown.to_owned())))
}

/// Names of the flags; unnamed ones as a number.
pub fn names(health: Health) -> Vec<String> {
    let mut names: Vec<String> = health.names().map(str::to_owned).collect();
    if health.unnamed() != Health::GOOD {
        names.push(health.unnamed().to_string());
    }
    names
}

#[derive(Clone, Debug, Serialize)]
pub struct Listing {
    flags: Vec<String>,
    /// Segments of the exchanged pair that match, and all of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    exchanged: Option<[u16; 2]>,
    #[serde(flatten)]
    numbers: Option<Numbers>,
}

#[derive(Clone, Debug, Serialize)]
struct Numbers {
    left: Camera,
    right: Camera,
    skew_us: Option<u32>,
    rows: Option<Rows>,
    row_offset_px: Option<f64>,
    row_drift_px: Option<f64>,
    least_disparity_px: Option<f64>,
    noise: Option<[Noise; 2]>,
    range: Option<Range>,
    still: Option<Still>,
    tear: Option<Tear>,
}

/// Standard deviation in grey levels, and share of the picture without any.
#[derive(Clone, Debug, Serialize)]
struct Noise {
    deviation: f64,
    noiseless: f64,
}

#[derive(Clone, Debug, Serialize)]
struct Still {
    share: f64,
    pattern: f64,
}

#[derive(Clone, Debug, Serialize)]
struct Tear {
    row: u16,
    shift_px: i16,
}

#[derive(Clone, Debug, Serialize)]
struct Range {
    windows: u16,
    beyond: u16,
    disparity_px: u16,
}

#[derive(Clone, Debug, Serialize)]
struct Camera {
    level: u8,
    detail: f64,
    black: f64,
    white: f64,
    view: f64,
}

#[derive(Clone, Debug, Serialize)]
struct Rows {
    offset_px: f64,
    spread_px: f64,
    samples: u8,
}

impl Listing {
    /// Flags and, when somebody looked, the numbers behind them.
    pub fn new(result: &FrameResult) -> Self {
        let FrameResult { health, pair, exchanged, .. } = result;
        Self {
            flags: names(*health),
            exchanged: *exchanged,
            numbers: pair.as_ref().map(Numbers::from),
        }
    }
}

impl From<&PairReport> for Numbers {
    fn from(pair: &PairReport) -> Self {
        let [left, right] = pair.cameras.each_ref().map(Camera::from);
        let px = |q8: i16| f64::from(q8) / 256.0;
        Self {
            left,
            right,
            skew_us: pair.skew_us,
            rows: pair.rows.map(|rows| Rows {
                offset_px: px(rows.offset_q8),
                spread_px: f64::from(rows.spread_q8) / 256.0,
                samples: rows.samples,
            }),
            row_offset_px: pair.row_offset_q8.map(px),
            row_drift_px: pair.row_drift_q8.map(px),
            least_disparity_px: pair.least_disparity_q6.map(|d| f64::from(d) / 64.0),
            noise: pair.noise.map(|noise| {
                noise.map(|of| Noise {
                    deviation: f64::from(of.deviation_q4) / 16.0,
                    noiseless: f64::from(of.noiseless_permille) / 1000.0,
                })
            }),
            range: pair.range.map(|RangeReport { windows, beyond, disparity }| Range {
                windows,
                beyond,
                disparity_px: disparity,
            }),
            still: pair.still.map(|still| Still {
                share: f64::from(still.still_permille) / 1000.0,
                pattern: f64::from(still.pattern_permille) / 1000.0,
            }),
            tear: pair.tear.map(|tear| Tear { row: tear.row, shift_px: tear.shift }),
        }
    }
}

impl From<&CameraHealth> for Camera {
    fn from(camera: &CameraHealth) -> Self {
        let share = |permille: u16| f64::from(permille) / 1000.0;
        Self {
            level: camera.level,
            detail: f64::from(camera.detail_q4) / 16.0,
            black: share(camera.black_permille),
            white: share(camera.white_permille),
            view: share(camera.view_permille),
        }
    }
}

/// One line per flag with what to do; nothing when all is well.
pub fn remedies(health: Health) -> String {
    let mut text: String =
        advice(health).map(|(name, what)| format!("health: {name}: {what}\n")).collect();
    if !is_fit(health) {
        text.push_str(
            "health: the pair is not fit to be used: no segments, points, objects, pixels or \
             directions are given\n",
        );
    }
    text
}

/// The [`remedies`], and the numbers behind those about exchanged images, rows and range.
pub fn summary(result: &FrameResult) -> String {
    let (health, pair) = (result.health, result.pair.as_ref());
    let rows = HealthFlags::ROWS_OFF | HealthFlags::ROWS_DRIFT;
    let mut text = String::new();
    if let Some(exchange) = exchange(result) {
        text.push_str(&format!("health: {exchange}\n"));
    }
    text.push_str(&remedies(health));
    let counts = &result.counts;
    let compared = counts.segments_left.saturating_sub(counts.rejected(Rejection::LessProminent));
    if is_fit(health)
        && compared >= LEAST_COMPARED
        && f64::from(counts.matched) < FEW * f64::from(compared)
    {
        text.push_str(&format!(
            "health: only {} of {compared} segments match: reduce noise, blur and compression \
             (JPEG below quality 90 halves the number of matches)\n",
            counts.matched
        ));
    }
    let removed = pair
        .and_then(|pair| pair.noise)
        .map_or(0, |noise| noise.map(|of| of.noiseless_permille).into_iter().max().unwrap_or(0));
    if removed >= MUCH_REMOVED_PERMILLE {
        text.push_str(&format!(
            "health: {} % of the picture have no noise at all, as after compression or with few \
             grey levels: what is blank there is left out (JPEG: use a quality of 80 or more)\n",
            removed / 10
        ));
    }
    let offset = pair.and_then(|pair| pair.row_offset_q8);
    if let Some(offset) =
        offset.filter(|_| rows.names().any(|name| health.names().any(|set| set == name)))
    {
        let (px, side) =
            (f64::from(offset.unsigned_abs()) / 256.0, if offset > 0 { "low" } else { "high" });
        text.push_str(&format!("health: the right image is {px:.2} px too {side}\n"));
    }
    text.extend(beyond_range(result).map(|range| format!("health: {range}\n")));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_to_be_acted_on_comes_first() {
        let all = Health::NAMES.into_iter().fold(Health::GOOD, |all, (flag, _)| all | flag);
        let told: Vec<&str> = advice(all).map(|(name, _)| name).collect();
        let place = |name: &str| told.iter().position(|told| *told == name).unwrap();
        // What is too far is not told to be corrected.
        assert!(told.len() + 1 == Health::NAMES.len() && !told.contains(&"rows_off"));
        assert!(
            place("few_matches") < place("left_exposure")
                && place("rows_far") < place("exposures_differ")
        );
        assert_eq!(told[told.len() - 2..], ["segments_dropped", "results_skipped"]);
    }
}
