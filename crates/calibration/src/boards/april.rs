//! A photo -> the corners of an AprilGrid that are seen.
//!
//! ```text
//! four X-junctions, the next ones along each other's edges -> the tag between them (reader)
//! all tags: the plane-to-plane map that most agree with; tags that do not are dropped
//! ```

use super::board::{Board, BoardCorners};
use super::corner;
use super::grid::NotFound;
use super::initial::homography;
use super::markers::RIMS;
use super::reader::{Reader, turned};
use calib_targets_chessboard::ChessCorner;
use linestereo_frames::GrayImage;
use linestereo_frames::statistics::upper_median;
use nalgebra::{Matrix3, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// Junctions looked at, strongest first: those inside tags are many.
const MOST_JUNCTIONS: usize = 3000;
/// Sides of tags below this are not read, px.
const LEAST_SIDE: f64 = 12.0;
/// A side's direction may differ from the edge at its corner by this angle, and the fourth corner
/// from that of a parallelogram by this share of the longer side: perspective and lenses.
const BENT: f64 = 0.12;
const SKEWED: f64 = 0.3;
/// Junctions tried along each edge: one more than the next, which may be a false one.
const TRIED: usize = 2;
/// Places along a side at which it has to be darker inside than outside by so many grey levels, and
/// how far from it these are looked at, as the share of the distance from the middle.
const ALONG: [f64; 3] = [0.25, 0.5, 0.75];
const ACROSS: f64 = 0.15;
const RISE: i32 = 8;
/// A tag's corners may be off from the map that most agree with by this share of its side.
const OFF: f64 = 0.3;
/// Reach of a corner's window as a share of the tag's side: its bits begin at 0.2, with a narrow
/// rim at 0.125.
const REACH: f64 = 0.125;

/// A tag: its number, and its corners from the middle of the upright tag, px.
struct Tag {
    id: usize,
    corners: [([i32; 2], [f64; 2]); 4],
    side: f64,
}

/// The corners of all tags between these junctions.
pub(super) fn numbered(
    image: &GrayImage,
    board: &Board,
    junctions: &[ChessCorner],
) -> Result<BoardCorners, NotFound> {
    let Some(dictionary) = board.pattern().dictionary() else { return Err(NotFound::Nothing) };
    let mut quads = quadrilaterals(junctions);
    quads.retain(|quad| has_rim(image, quad));
    if quads.is_empty() {
        return Err(NotFound::Nothing);
    }
    let read = |&rim: &usize| {
        let reader = Reader::new(image, dictionary, rim, 1.0);
        quads.iter().filter_map(|&quad| tag(&reader, quad)).collect::<Vec<Tag>>()
    };
    // Kalibr's rim first; others print the narrow one.
    let tags = RIMS.iter().rev().map(read).find(|tags| !tags.is_empty());
    let tags = tags.ok_or(NotFound::NoMarkers(junctions.len()))?;
    agreed(image, board, &tags)
}

fn tag(reader: &Reader, quad: [[f64; 2]; 4]) -> Option<Tag> {
    let marker = reader.read(quad)?;
    let round = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
    let side = (0..4).map(|i| distance(quad[i], quad[(i + 1) % 4])).fold(f64::MAX, f64::min);
    Some(Tag {
        id: marker.id,
        corners: [0, 1, 2, 3].map(|i| (marker.upright(round[i]), quad[i])),
        side,
    })
}

/// Tags that lie where the board has them; it may be printed with its tags turned by any quarter
/// turns, the same for all.
fn agreed(image: &GrayImage, board: &Board, tags: &[Tag]) -> Result<BoardCorners, NotFound> {
    let places = board.points();
    let squares = board.markers();
    let number = |tag: &Tag, place: [i32; 2], turns: u8| {
        let [x, y] = turned(place, turns);
        let [col, row] = *squares.get(tag.id)?;
        Some((2 * row + usize::from(y > 0)) * board.cols() + 2 * col + usize::from(x > 0))
    };
    let known: Vec<&Tag> = tags.iter().filter(|tag| tag.id < squares.len()).collect();
    if known.len() < 2 {
        return Err(if tags.len() > known.len() {
            NotFound::OtherLayout
        } else {
            NotFound::Part(4 * known.len())
        });
    }
    let mut best: Option<(f64, u8, Vec<f64>)> = None;
    for turns in 0..4 {
        let corners = known
            .iter()
            .flat_map(|tag| tag.corners.iter().map(move |&(place, at)| (*tag, place, at)));
        let pairs: Vec<([f64; 2], [f64; 2])> = corners
            .filter_map(|(tag, place, at)| Some((places[number(tag, place, turns)?], at)))
            .collect();
        let Some(map) = homography(&pairs) else { continue };
        let off: Vec<f64> = known
            .iter()
            .zip(pairs.chunks_exact(4))
            .map(|(tag, pairs)| {
                pairs.iter().map(|pair| distance(through(&map, pair.0), pair.1)).sum::<f64>()
                    / 4.0
                    / tag.side
            })
            .collect();
        let middle = upper_median(off.clone(), f64::total_cmp).unwrap_or(f64::MAX);
        if best.as_ref().is_none_or(|(least, ..)| middle < *least) {
            best = Some((middle, turns, off));
        }
    }
    let Some((_, turns, off)) = best.filter(|(middle, ..)| *middle < OFF) else {
        return Err(NotFound::OtherLayout);
    };
    let mut corners = BTreeMap::new();
    let mut nearest: Vec<(&Tag, f64)> =
        known.into_iter().zip(off).filter(|(_, off)| *off < OFF).collect();
    nearest.sort_by(|a, b| b.1.total_cmp(&a.1));
    for (tag, _) in nearest {
        for (place, at) in tag.corners {
            // As of ChArUco (charuco): the detector's own place, 0.035 px off where refined ones
            // are 0.075, if refining stays there.
            if corner::refine_within(image, at, REACH * tag.side).is_none() {
                continue;
            }
            corners.extend(number(tag, place, turns).map(|number| (number, at)));
        }
    }
    Ok(BoardCorners::numbered(board, corners))
}

fn through(map: &Matrix3<f64>, [x, y]: [f64; 2]) -> [f64; 2] {
    let at = map * Vector3::new(x, y, 1.0);
    [at.x / at.z, at.y / at.z]
}

/// Quadrilaterals of junctions, clockwise, whose sides run along the edges at their first corner.
fn quadrilaterals(junctions: &[ChessCorner]) -> Vec<[[f64; 2]; 4]> {
    let mut junctions: Vec<&ChessCorner> = junctions.iter().collect();
    junctions.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    junctions.truncate(MOST_JUNCTIONS);
    let at: Vec<[f64; 2]> =
        junctions.iter().map(|one| [one.position.x, one.position.y].map(f64::from)).collect();
    let mut found = BTreeSet::new();
    for (index, junction) in junctions.iter().enumerate() {
        let [a, b] =
            junction.axes.map(|axis| f64::from(axis.angle).sin_cos()).map(|(sin, cos)| [cos, sin]);
        let directions = [a, b, a.map(|v| -v), b.map(|v| -v)];
        let next = directions.map(|direction| along(&at, index, direction));
        for (first, second) in (0..4).map(|i| (&next[i], &next[(i + 1) % 4])) {
            for (&q, &s) in first.iter().flat_map(|q| second.iter().map(move |s| (q, s))) {
                found.extend(fourth(&at, index, q, s));
            }
        }
    }
    found.into_iter().map(|quad: [usize; 4]| quad.map(|i| at[i])).collect()
}

/// The next junctions in a direction.
fn along(at: &[[f64; 2]], from: usize, [dx, dy]: [f64; 2]) -> Vec<usize> {
    let ahead = |&to: &usize| {
        let [x, y] = [0, 1].map(|i| at[to][i] - at[from][i]);
        let far = x * dx + y * dy;
        far >= LEAST_SIDE && (x * dy - y * dx).abs() <= BENT * far
    };
    let mut next: Vec<usize> = (0..at.len()).filter(ahead).collect();
    next.sort_by(|&a, &b| distance(at[from], at[a]).total_cmp(&distance(at[from], at[b])));
    next.truncate(TRIED);
    next
}

/// The quadrilateral of a corner and its two neighbours, clockwise from the corner of the least
/// index.
fn fourth(at: &[[f64; 2]], p: usize, q: usize, s: usize) -> Option<[usize; 4]> {
    let expected = [0, 1].map(|i| at[q][i] + at[s][i] - at[p][i]);
    let limit = SKEWED * distance(at[p], at[q]).max(distance(at[p], at[s]));
    let others = (0..at.len()).filter(|&r| r != p && r != q && r != s);
    let r =
        others.min_by(|&a, &b| distance(at[a], expected).total_cmp(&distance(at[b], expected)))?;
    if distance(at[r], expected) > limit {
        return None;
    }
    let area = (at[q][0] - at[p][0]) * (at[s][1] - at[p][1])
        - (at[q][1] - at[p][1]) * (at[s][0] - at[p][0]);
    let mut quad = if area > 0.0 { [p, q, r, s] } else { [p, s, r, q] };
    let first = (0..4).min_by_key(|&i| quad[i])?;
    quad.rotate_left(first);
    Some(quad)
}

/// Are all sides darker inside than outside? Reading a marker takes a hundred times as long.
fn has_rim(image: &GrayImage, quad: &[[f64; 2]; 4]) -> bool {
    let middle = [0, 1].map(|axis| quad.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0);
    let grey = |[x, y]: [f64; 2]| {
        let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
        let (x, y) = (x.round().max(0.0) as usize, y.round().max(0.0) as usize);
        i32::from(image.pixels[y.min(height - 1) * width + x.min(width - 1)])
    };
    (0..4).all(|i| {
        let (from, to) = (quad[i], quad[(i + 1) % 4]);
        ALONG.iter().all(|part| {
            let on = [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]));
            let away = |share: f64| [0, 1].map(|axis| on[axis] + share * (on[axis] - middle[axis]));
            grey(away(ACROSS)) - grey(away(-ACROSS)) >= RISE
        })
    })
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
