//! The scores of a frame and of an object as JSON that gives back the same bits: parts of a large evaluation are merged exactly.
//!
//! Decimal numbers need not come back as they went; lists of floats are their bytes, little endian, in base64. A point with truth is
//! its probability and its error, negative where the true match is hidden; a cell without a claim, and a claim without truth, is a NaN.

use super::cells::{CellClaim, CellClaims};
use super::frame::{CellScore, FrameScore, PointScore, SegmentScore};
use super::objects::{ObjectScore, Outline};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use linestereo::NoDepth;
use serde::{Deserialize, Serialize};

/// [`FrameScore`] as it is stored.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct PackedScore {
    name: String,
    segments: usize,
    confidences: String,
    scored_segments: String,
    scored_points: String,
    cells: String,
    cell_claims: String,
    all_cells: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    milliseconds_bits: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    instructions: Option<u64>,
}

impl From<FrameScore> for PackedScore {
    fn from(score: FrameScore) -> Self {
        let signed = |point: &PointScore| if point.visible { point.error } else { -point.error };
        Self {
            name: score.name,
            segments: score.segments,
            confidences: packed(score.confidences),
            scored_segments: packed(score.scored_segments.iter().flat_map(|s| [s.confidence, s.median_error])),
            scored_points: packed(score.scored_points.iter().flat_map(|point| [point.confidence, signed(point)])),
            cells: packed(score.cells.iter().map(|cell| cell.best.unwrap_or(f32::NAN))),
            cell_claims: packed(
                score.cell_claims.claims.iter().flat_map(|claim| [claim.confidence, claim.error.unwrap_or(f32::NAN)]),
            ),
            all_cells: score.cell_claims.cells,
            milliseconds_bits: score.milliseconds.map(f64::to_bits),
            instructions: score.instructions,
        }
    }
}

impl TryFrom<PackedScore> for FrameScore {
    type Error = &'static str;

    fn try_from(stored: PackedScore) -> Result<Self, Self::Error> {
        let pairs = |text: &str| {
            let values = unpacked(text)?;
            let (pairs, rest) = values.as_chunks::<2>();
            if rest.is_empty() { Ok(pairs.to_vec()) } else { Err("half a pair of numbers") }
        };
        let point = |[confidence, signed]: [f32; 2]| PointScore {
            confidence,
            error: signed.abs(),
            visible: signed.is_sign_positive(),
        };
        let segment = |[confidence, median_error]: [f32; 2]| SegmentScore { confidence, median_error };
        let cell_claim =
            |[confidence, error]: [f32; 2]| CellClaim { confidence, error: (!error.is_nan()).then_some(error) };
        let cell = |best: f32| CellScore { best: (!best.is_nan()).then_some(best) };
        Ok(Self {
            name: stored.name,
            segments: stored.segments,
            confidences: unpacked(&stored.confidences)?,
            scored_segments: pairs(&stored.scored_segments)?.into_iter().map(segment).collect(),
            scored_points: pairs(&stored.scored_points)?.into_iter().map(point).collect(),
            milliseconds: stored.milliseconds_bits.map(f64::from_bits),
            instructions: stored.instructions,
            cell_claims: CellClaims {
                claims: pairs(&stored.cell_claims)?.into_iter().map(cell_claim).collect(),
                cells: stored.all_cells,
            },
            cells: unpacked(&stored.cells)?.into_iter().map(cell).collect(),
        })
    }
}

/// [`ObjectScore`] as it is stored.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct PackedObject {
    name: String,
    outline: Outline,
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<String>,
    wrong: bool,
    support: u16,
    /// Both ends of the range, disparity, error, relative error, standard deviation, probability.
    values: String,
    overlap_bits: [u64; 2],
}

impl From<ObjectScore> for PackedObject {
    fn from(score: ObjectScore) -> Self {
        let ObjectScore { name, outline, refused, range, disparity, wrong, error, relative, .. } = score;
        let refused = refused.map(|reason| reason.name().to_owned());
        let values = packed([range.0, range.1, disparity, error, relative, score.sigma, score.confidence]);
        let overlap_bits = score.overlap.map(f64::to_bits);
        Self { name, outline, refused, wrong, support: score.support, values, overlap_bits }
    }
}

impl TryFrom<PackedObject> for ObjectScore {
    type Error = &'static str;

    fn try_from(stored: PackedObject) -> Result<Self, Self::Error> {
        let named = |name: String| NoDepth::ALL.into_iter().find(|reason| reason.name() == name);
        let refused = stored.refused.map(|name| named(name).ok_or("a reason that is not known")).transpose()?;
        let values = <[f32; 7]>::try_from(unpacked(&stored.values)?).map_err(|_| "an object has other values")?;
        let [low, high, disparity, error, relative, sigma, confidence] = values;
        let PackedObject { name, outline, wrong, support, .. } = stored;
        let (range, overlap) = ((low, high), stored.overlap_bits.map(f64::from_bits));
        Ok(Self {
            name,
            outline,
            refused,
            range,
            disparity,
            wrong,
            error,
            relative,
            sigma,
            confidence,
            support,
            overlap,
        })
    }
}

fn packed(values: impl IntoIterator<Item = f32>) -> String {
    STANDARD.encode(values.into_iter().flat_map(f32::to_le_bytes).collect::<Vec<u8>>())
}

fn unpacked(text: &str) -> Result<Vec<f32>, &'static str> {
    let bytes = STANDARD.decode(text).map_err(|_| "a list of numbers is no base64")?;
    let (numbers, rest) = bytes.as_chunks::<4>();
    if !rest.is_empty() {
        return Err("a list of numbers ends inside one");
    }
    Ok(numbers.iter().map(|&number| f32::from_le_bytes(number)).collect())
}
