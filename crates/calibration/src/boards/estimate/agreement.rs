//! The pose between the cameras that most views agree with.

use super::super::board::Board;
use super::super::initial::{self, Sightings};
use super::super::markers::Pattern;
use super::super::model::{Intrinsics, Pose, Sighting};
use super::outcome::{Dropped, EstimateError, LEAST_VIEWS};
use super::single::Single;
use super::{median, root_mean_square};
use linestereo::Dims;
use linestereo_rig::CameraSide;

/// Views that may differ in what they say of the cameras' pose before it is refined, in widths of
/// the image.
const AGREE: f64 = 0.03;

/// The cameras' pose that most views agree with; the others are dropped.
pub(super) fn agreed_rig(
    board: &Board,
    dims: Dims,
    sightings: &[Vec<Sightings>; 2],
    [left, right]: [&Single; 2],
    dropped: &mut [Option<Dropped>],
) -> Result<Pose, EstimateError> {
    let used: Vec<usize> = (0..dropped.len()).filter(|&view| dropped[view].is_none()).collect();
    if used.len() < LEAST_VIEWS {
        return Err(EstimateError::TooFew(dropped.len(), used.len()));
    }
    let limit = AGREE * f64::from(dims.width);
    let camera = right.bundle.cameras[0];
    let poses = |single: &Single| -> Vec<Pose> {
        used.iter().map(|&view| single.bundle.views[view].pose).collect()
    };
    let from = poses(left);
    let seen: Vec<&Sightings> = used.iter().map(|&view| &sightings[1][view]).collect();
    let (rig, off) = nearest_rig(&camera, &from, &poses(right), &seen);
    let agree = off.iter().filter(|&&off| off <= limit).count();
    if agree >= LEAST_VIEWS && 2 * agree > used.len() {
        for (&view, &off) in used.iter().zip(&off) {
            if off > limit {
                dropped[view] = Some(Dropped::Pose(off));
            }
        }
        return Ok(rig);
    }
    // Markers in mirrored photos are not read: what was numbered by them is not mirrored.
    let sides: &[bool] = if board.pattern() == Pattern::Chessboard { &[false, true] } else { &[] };
    let mirrored = sides.iter().find_map(|&rows| {
        let seen: Vec<Sightings> =
            seen.iter().map(|seen| unmirrored(board, dims, seen, rows)).collect();
        let to = seen
            .iter()
            .map(|seen| initial::pose(&camera, dims, seen))
            .collect::<Option<Vec<_>>>()?;
        let (rig, off) = nearest_rig(&camera, &from, &to, &seen.iter().collect::<Vec<_>>());
        (2 * off.iter().filter(|&&off| off <= 2.0 * limit).count() > off.len()).then_some(rig)
    });
    Err(match mirrored {
        // With both mirrored the right camera appears on the wrong side: then it was the left one
        // that was.
        Some(rig) if rig.inverse().translation().x < 0.0 => {
            EstimateError::Mirrored(CameraSide::Left)
        }
        Some(_) => EstimateError::Mirrored(CameraSide::Right),
        None => EstimateError::NoRig(agree, used.len()),
    })
}

/// Of the poses between the cameras that the views suggest, the one that is off least in the
/// median, and how far it is off in each view, px.
fn nearest_rig(
    camera: &Intrinsics,
    from: &[Pose],
    to: &[Pose],
    seen: &[&Sightings],
) -> (Pose, Vec<f64>) {
    let off = |rig: &Pose| -> Vec<f64> {
        let one = |(pose, seen): (&Pose, &&Sightings)| {
            let errors = camera.errors(pose.then(rig), seen);
            root_mean_square(&errors.flatten().collect::<Vec<_>>())
        };
        from.iter().zip(seen).map(one).collect()
    };
    let rigs = from.iter().zip(to).map(|(from, to)| from.inverse().then(to));
    let tried = rigs.map(|rig| (rig, off(&rig)));
    let best = tried.min_by(|a, b| median(&a.1).total_cmp(&median(&b.1)));
    best.unwrap_or((Pose([0.0; 6]), Vec::new()))
}

/// As the photo would be without its mirroring. The numbering of a mirrored board runs backwards
/// along one side: the rows, or the columns.
fn unmirrored(board: &Board, dims: Dims, seen: &Sightings, rows: bool) -> Sightings {
    let (cols, count) = (board.cols(), board.corners());
    let other = |index: usize| {
        if rows {
            (count / cols - 1 - index / cols) * cols + index % cols
        } else {
            index / cols * cols + cols - 1 - index % cols
        }
    };
    let turned = |(index, &(place, _)): (usize, &Sighting)| {
        let [u, v] = seen[other(index)].1;
        (place, [f64::from(dims.width - 1) - u, v])
    };
    seen.iter().enumerate().map(turned).collect()
}
