//! Results as bytes of structured arrays, whose dtypes stand in `python/linestereo/__init__.py`.

use linestereo::obstacles::{ObstaclePlan, Obstacles, Sector};
use linestereo::results::{
    Bar, ImagePosition, Match, Owner, PixelDepth, PixelRejection, Point, Source,
};
use linestereo::units::{Confidence, Depth, Disparity, INFINITE_DEPTH};
use linestereo::{NoDepth, ObjectDepth, Params, Rig};

/// Metres: infinite where the core says so, not a number without a rig.
fn metres(depth: Option<Depth>) -> f64 {
    depth.map_or(
        f64::NAN,
        |depth| if depth == INFINITE_DEPTH { f64::INFINITY } else { depth.to_num() },
    )
}

fn pixels(disparity: Disparity) -> [u8; 4] {
    disparity.to_num::<f32>().to_le_bytes()
}

/// Depths of disparities that were met: a division each is a tenth of the time that the core takes
/// for the pair.
struct Depths {
    rig: Rig,
    /// By disparity from 0 on, 1/64 px.
    known: Vec<Option<f64>>,
}

impl Depths {
    fn depth(&mut self, disparity: Disparity) -> f64 {
        let find = || metres(Some(self.rig.depth(disparity)));
        let known =
            usize::try_from(disparity.to_bits()).ok().and_then(|index| self.known.get_mut(index));
        known.map_or_else(find, |known| *known.get_or_insert_with(find))
    }
}

/// 24 bytes each.
pub(crate) fn of_points(points: &[Point], params: &Params) -> Vec<u8> {
    let known = vec![None; 64 * usize::from(params.max_disparity)];
    let mut depths = params.rig.map(|rig| Depths { rig, known });
    let mut bytes = vec![0; 24 * points.len()];
    for (record, point) in bytes.chunks_exact_mut(24).zip(points) {
        let segment = match point.source {
            Source::Segment(index) => index.into(),
            Source::Side => -1_i32,
            _ => -2,
        };
        let depth = depths.as_mut().map_or(f64::NAN, |depths| depths.depth(point.disparity));
        record[..2].copy_from_slice(&point.x.to_le_bytes());
        record[2..4].copy_from_slice(&point.y.to_le_bytes());
        record[4..8].copy_from_slice(&pixels(point.disparity));
        record[8..12].copy_from_slice(&point.confidence.to_num::<f32>().to_le_bytes());
        record[12..16].copy_from_slice(&segment.to_le_bytes());
        record[16..].copy_from_slice(&depth.to_le_bytes());
    }
    bytes
}

/// 72 bytes.
pub(crate) fn push_segment(bytes: &mut Vec<u8>, found: &Match) {
    push_ends(bytes, found.ends);
    for disparity in [found.disparity[0], found.disparity[1], found.sigma] {
        bytes.extend(pixels(disparity));
    }
    bytes.extend(found.confidence.to_num::<f32>().to_le_bytes());
    bytes.extend((found.owner as u32).to_le_bytes());
    bytes.extend([0; 4]);
    push_depths(bytes, found.depth, found.depth_sigma);
}

/// 72 bytes.
pub(crate) fn push_bar(bytes: &mut Vec<u8>, found: &Bar, rig: Option<Rig>) {
    let (disparity, sigma) = (found.disparity(), found.sigma());
    push_ends(bytes, found.ends());
    bytes.extend(found.width().to_num::<f32>().to_le_bytes());
    for disparity in [disparity[0], disparity[1], sigma] {
        bytes.extend(pixels(disparity));
    }
    bytes.extend(found.confidence().to_num::<f32>().to_le_bytes());
    bytes.extend([0; 4]);
    let depth = rig.map(|rig| disparity.map(|d| rig.depth(d)));
    let depth_sigma = rig.map(|rig| disparity.map(|d| rig.depth_sigma(d, sigma)));
    push_depths(bytes, depth, depth_sigma);
}

/// 40 bytes for each sector of the turn.
pub(crate) fn of_sectors(plan: &ObstaclePlan, obstacles: &Obstacles, time_us: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    let metres = |cm: u16| f64::from(cm) / 100.0;
    for (index, sector) in (0..plan.sectors()).zip(obstacles.sectors(plan, time_us)) {
        let turned = 360.0 * f32::from(index) / f32::from(plan.sectors());
        let (state, distance, confidence, age_ms) = match sector {
            Sector::Outside => (0_u32, f64::NAN, Confidence::ZERO, 0),
            Sector::Unknown => (1, f64::NAN, Confidence::ZERO, 0),
            Sector::Free { confidence, age_ms } => (2, f64::INFINITY, confidence, age_ms),
            Sector::Obstacle { distance_cm, confidence, age_ms } => {
                (3, metres(distance_cm), confidence, age_ms)
            }
        };
        let (drop_off, drop_confidence, drop_age_ms) = obstacles
            .drop_off(plan, index, time_us)
            .map_or((f64::NAN, Confidence::ZERO, 0), |found| {
                (metres(found.distance_cm), found.confidence, found.age_ms)
            });
        let direction = if turned < 180.0 { turned } else { turned - 360.0 };
        bytes.extend(direction.to_le_bytes());
        bytes.extend(state.to_le_bytes());
        bytes.extend(distance.to_le_bytes());
        bytes.extend(drop_off.to_le_bytes());
        for probability in [confidence, drop_confidence] {
            bytes.extend(probability.to_num::<f32>().to_le_bytes());
        }
        bytes.extend(age_ms.to_le_bytes());
        bytes.extend(drop_age_ms.to_le_bytes());
    }
    bytes
}

/// Column and row of both ends.
fn push_ends(bytes: &mut Vec<u8>, ends: [ImagePosition; 2]) {
    for end in ends {
        bytes.extend(end.x.to_num::<f32>().to_le_bytes());
        bytes.extend(end.y.to_num::<f32>().to_le_bytes());
    }
}

/// Depth at both ends, and its standard deviation.
fn push_depths(bytes: &mut Vec<u8>, depth: Option<[Depth; 2]>, depth_sigma: Option<[Depth; 2]>) {
    for depths in [depth, depth_sigma] {
        for end in 0..2 {
            bytes.extend(metres(depths.map(|ends| ends[end])).to_le_bytes());
        }
    }
}

const _: () =
    assert!(Owner::Left as u32 == 0 && Owner::Right as u32 == 1 && Owner::Both as u32 == 2);

/// Disparity, sigma, depth, its sigma, nearest depth, support, confidence, and the reason where
/// there is no disparity.
pub(crate) type Answer =
    (u16, Option<f64>, f64, f64, f64, f64, u16, f64, Option<(&'static str, String)>);

pub(crate) fn of_object(label: u16, found: &Result<ObjectDepth, NoDepth>) -> Answer {
    let found = match found {
        Ok(found) => found,
        Err(NoDepth { reason, support }) => {
            let reason = Some((reason.name(), reason.to_string()));
            return (label, None, 0.0, f64::NAN, f64::NAN, f64::NAN, *support, 0.0, reason);
        }
    };
    (
        label,
        Some(found.disparity.to_num()),
        found.sigma.to_num(),
        metres(found.metres.map(|metres| metres.depth)),
        metres(found.metres.map(|metres| metres.sigma)),
        metres(found.metres.map(|metres| metres.nearest)),
        found.support,
        found.confidence.to_num(),
        None,
    )
}

pub(crate) fn of_pixel(found: &PixelDepth) -> Answer {
    let (depth, sigma) = (metres(found.depth), metres(found.depth_sigma));
    let disparity = Some(found.disparity.to_num());
    (0, disparity, found.sigma.to_num(), depth, sigma, depth, 0, found.confidence.to_num(), None)
}

pub(crate) fn of_rejection(reason: PixelRejection) -> Answer {
    (0, None, 0.0, f64::NAN, f64::NAN, f64::NAN, 0, 0.0, Some((reason.name(), reason.to_string())))
}
