//! Obstacles by direction, as a robot needs them.
//!
//! An obstacle is what stands 0.05 to 0.4 m above the floor, within 3 m. The truth of a sector of 5
//! degrees is the tenth nearest such pixel; with fewer the sector is clear. A drop-off is where
//! rays of pixels labelled as below the floor meet the floor's plane, again the tenth nearest.
//!
//! ```text
//! pixel, true disparity -> point in the camera's axes -> turned back by roll and pitch
//!                       -> height above the floor, distance along it, direction
//! ```

use super::figures::{Better, Figure, Group, Values, percent};
use super::grid::Grid;
use linestereo::ground::CameraPose;
use linestereo_wire::RigUpdate;
use std::collections::BTreeMap;

/// How far obstacles matter, m.
pub(crate) const RANGE_M: f64 = 3.0;
/// Heights above the floor that matter, m.
pub(crate) const HEIGHTS_M: [f64; 2] = [0.05, 0.4];
/// Half of a sector, degrees.
const HALF_WIDTH_DEG: f64 = 2.5;
/// Fewest pixels that make an obstacle.
const LEAST_PIXELS: usize = 10;
/// Distances within this share of the true one are right.
const TOLERANCE: f64 = 0.25;
/// Label of what lies below the floor.
const BELOW_FLOOR: u8 = 6;
/// Labels of what can stand in the way: walls, furniture, thin and glossy things.
const SOLID: [u8; 4] = [2, 3, 4, 5];

/// Geometry and place of the left camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Camera {
    pub(crate) rig: RigUpdate,
    pub(crate) pose: CameraPose,
    /// Principal point, px; the middle of the image where it is not known.
    pub(crate) centre: Option<[f64; 2]>,
}

/// State of a sector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Said {
    Obstacle(f64),
    Free,
    Unknown,
}

/// Answer for a sector: its direction (degrees), its state, and the edge of a drop-off (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Answer {
    /// Its middle, clockwise from ahead.
    pub(crate) direction_deg: f64,
    pub(crate) obstacle: Said,
    pub(crate) drop_off_m: Option<f64>,
}

/// A pixel with truth, as the robot meets it.
#[derive(Clone, Copy, Debug)]
struct Seen {
    direction_deg: f64,
    distance_m: f64,
    is_obstacle: bool,
    /// Distance at which its ray goes through the floor's plane, where it does.
    falls_m: Option<f64>,
}

/// Sectors in view of all scenes, by what is true and said of them: an outcome of [`obstacle`] and
/// one of [`drop_off`] each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sectors(BTreeMap<&'static str, usize>);

/// Outcome of a sector by its nearest obstacle.
fn obstacle(truth_m: Option<f64>, said: Said) -> &'static str {
    match (truth_m, said) {
        (Some(_), Said::Unknown) => "obstacle: unknown",
        (Some(_), Said::Free) => "obstacle: called free",
        (Some(truth), Said::Obstacle(said)) if is_right(truth, said) => "obstacle: told right",
        (Some(truth), Said::Obstacle(said)) if said > truth => "obstacle: told farther",
        (Some(_), Said::Obstacle(_)) => "obstacle: a ghost nearer",
        (None, Said::Unknown) => "clear: unknown",
        (None, Said::Free) => "clear: free",
        (None, Said::Obstacle(_)) => "clear: a ghost",
    }
}

/// Outcome of a sector by its drop-off; none where that is too far away to matter.
fn drop_off(truth_m: Option<f64>, said_m: Option<f64>) -> Option<&'static str> {
    Some(match (truth_m, said_m) {
        (Some(truth), _) if truth >= RANGE_M => return None,
        (Some(_), None) => "drop-off: not told",
        (Some(truth), Some(said)) if is_right(truth, said) => "drop-off: told right",
        (Some(truth), Some(said)) if said > truth => "drop-off: told farther",
        (Some(_), Some(_)) => "drop-off: told nearer",
        (None, None) => "no drop-off: none told",
        (None, Some(_)) => "no drop-off: one told",
    })
}

fn is_right(truth: f64, said: f64) -> bool {
    (said - truth).abs() <= TOLERANCE * truth
}

/// The tenth least of these, if there are as many.
fn tenth(distances: impl Iterator<Item = f64>) -> Option<f64> {
    let mut distances: Vec<f64> = distances.collect();
    distances.sort_unstable_by(f64::total_cmp);
    distances.get(LEAST_PIXELS - 1).copied()
}

fn seen(truth: &Grid<f64>, labels: &Grid<u8>, camera: &Camera) -> Vec<Seen> {
    let middle = [truth.width(), truth.height()].map(|side| (side as f64 - 1.0) / 2.0);
    let [centre_x, centre_y] = camera.centre.unwrap_or(middle);
    let (RigUpdate { focal_px, baseline_m, .. }, pose) = (camera.rig, camera.pose);
    let height_m = f64::from(pose.height_m);
    let (sin_pitch, cos_pitch) = f64::from(pose.pitch_deg).to_radians().sin_cos();
    let (sin_roll, cos_roll) = f64::from(pose.roll_deg).to_radians().sin_cos();
    let of = |(x, y): (usize, usize)| {
        let ahead = focal_px * baseline_m / truth.at(x, y);
        let right = (x as f64 - centre_x) / focal_px * ahead;
        let down = (y as f64 - centre_y) / focal_px * ahead;
        let (right, down) =
            (right * cos_roll - down * sin_roll, right * sin_roll + down * cos_roll);
        let (level_down, level_ahead) =
            (down * cos_pitch + ahead * sin_pitch, ahead * cos_pitch - down * sin_pitch);
        let (above, distance_m) = (height_m - level_down, right.hypot(level_ahead));
        let matters = above > HEIGHTS_M[0] && above < HEIGHTS_M[1] && distance_m < RANGE_M;
        Seen {
            direction_deg: right.atan2(level_ahead).to_degrees(),
            distance_m,
            is_obstacle: matters && SOLID.contains(&labels.at(x, y)),
            falls_m: (labels.at(x, y) == BELOW_FLOOR && level_down > 0.0)
                .then(|| distance_m * height_m / level_down),
        }
    };
    truth.positions().filter(|&(x, y)| truth.at(x, y) > 0.0).map(of).collect()
}

impl Sectors {
    /// Adds a scene with what was said of each sector in view.
    pub(crate) fn add(
        &mut self,
        truth: &Grid<f64>,
        labels: &Grid<u8>,
        camera: &Camera,
        said: impl IntoIterator<Item = Answer>,
    ) {
        let seen = seen(truth, labels, camera);
        for Answer { direction_deg, obstacle: said, drop_off_m } in said {
            let within =
                |pixel: &&Seen| (pixel.direction_deg - direction_deg).abs() <= HALF_WIDTH_DEG;
            let inside: Vec<&Seen> = seen.iter().filter(within).collect();
            if inside.len() as f64 <= truth.height() as f64 * 0.5 {
                continue; // hardly in view
            }
            let obstacles = inside.iter().filter(|pixel| pixel.is_obstacle);
            let nearest = tenth(obstacles.map(|pixel| pixel.distance_m));
            self.count(obstacle(nearest, said));
            let edge = tenth(inside.iter().filter_map(|pixel| pixel.falls_m));
            drop_off(edge, drop_off_m).into_iter().for_each(|outcome| self.count(outcome));
        }
    }

    fn count(&mut self, outcome: &'static str) {
        *self.0.entry(outcome).or_default() += 1;
    }

    /// Sectors with an outcome that begins like this.
    fn all(&self, start: &str) -> usize {
        let counts = self.0.iter().filter(|(outcome, _)| outcome.starts_with(start));
        counts.map(|(_, count)| count).sum()
    }

    /// Figures of linestereo.
    pub(crate) fn group(&self) -> Group {
        let count =
            |name: &str, of: &str| Figure::count(name, Values::linestereo(self.all(of) as f64));
        let share = |outcome: &str, better: Better| {
            let whole = outcome.split_inclusive(':').next().map_or(0, |start| self.all(start));
            let share = percent(self.all(outcome), whole.max(1));
            Figure::new(format!("{outcome}, %"), better, 0, Values::linestereo(share))
        };
        let mut figures = vec![
            count("sectors with an obstacle", "obstacle:"),
            share("obstacle: told right", Better::Higher),
            share("obstacle: told farther", Better::Lower),
            share("obstacle: called free", Better::Lower),
            share("obstacle: a ghost nearer", Better::Lower),
            share("obstacle: unknown", Better::Lower),
            count("clear sectors", "clear:"),
            share("clear: free", Better::Higher),
            share("clear: a ghost", Better::Lower),
            share("clear: unknown", Better::Lower),
        ];
        if self.all("drop-off:") > 0 {
            figures.extend([
                count("sectors with a drop-off", "drop-off:"),
                share("drop-off: told right", Better::Higher),
                share("drop-off: told farther", Better::Lower),
                share("drop-off: told nearer", Better::Lower),
                share("drop-off: not told", Better::Lower),
            ]);
        }
        figures.push(share("no drop-off: one told", Better::Lower));
        Group::new("obstacles by direction, 0.05 to 0.4 m high, within 3 m", figures)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Level, 0.2 m above the floor.
    const CAMERA: Camera = Camera {
        rig: RigUpdate { focal_px: 100.0, baseline_m: 0.1, offset_px: 0.0 },
        pose: CameraPose { height_m: 0.2, pitch_deg: 0.0, roll_deg: 0.0 },
        centre: None,
    };

    /// The camera looks at a wall 2 m away.
    #[test]
    fn the_tenth_nearest_pixel_is_the_distance() {
        let truth = Grid::new(81, vec![5.0; 81 * 61]);
        let wall = truth.map(|_, _| 2_u8);
        let mut sectors = Sectors::default();
        let said = [
            Said::Obstacle(2.4),
            Said::Obstacle(2.6),
            Said::Obstacle(1.4),
            Said::Free,
            Said::Unknown,
        ];
        sectors.add(&truth, &wall, &CAMERA, said.map(|said| answer(0.0, said, None)));
        let expected = BTreeMap::from([
            ("obstacle: told right", 1),
            ("obstacle: told farther", 1),
            ("obstacle: a ghost nearer", 1),
            ("obstacle: called free", 1),
            ("obstacle: unknown", 1),
            ("no drop-off: none told", 5),
        ]);
        assert_eq!(sectors.0, expected);

        // The floor is no obstacle, and what lies behind the camera is not in view.
        let mut clear = Sectors::default();
        let said = [(0.0, Said::Obstacle(1.0)), (5.0, Said::Free), (90.0, Said::Free)];
        let floor = wall.map(|_, _| 1);
        clear.add(&truth, &floor, &CAMERA, said.map(|(at, said)| answer(at, said, None)));
        let expected = [("clear: a ghost", 1), ("clear: free", 1), ("no drop-off: none told", 2)];
        assert_eq!(clear.0, BTreeMap::from(expected));
        assert_eq!(clear.group().figures.len(), 11);
    }

    fn answer(direction_deg: f64, obstacle: Said, drop_off_m: Option<f64>) -> Answer {
        Answer { direction_deg, obstacle, drop_off_m }
    }

    /// The same camera, and a lower floor that is seen from row 10 below the axis up: its rays meet
    /// the plane of the floor at 2 m and farther.
    #[test]
    fn a_drop_off_is_where_rays_go_through_the_floor() {
        let truth = Grid::new(81, vec![2.0; 81 * 61]);
        let labels = truth.map(|_, y| if y <= 40 { BELOW_FLOOR } else { 1 });
        let told = [Some(2.1), Some(2.9), Some(1.4), None];
        let mut sectors = Sectors::default();
        sectors.add(&truth, &labels, &CAMERA, told.map(|at| answer(0.0, Said::Unknown, at)));
        let expected = BTreeMap::from([
            ("clear: unknown", 4),
            ("drop-off: told right", 1),
            ("drop-off: told farther", 1),
            ("drop-off: told nearer", 1),
            ("drop-off: not told", 1),
        ]);
        assert_eq!(sectors.0, expected);

        // On a floor that goes on, what is told is a ghost.
        let mut whole = Sectors::default();
        let floor = labels.map(|_, _| 1);
        whole.add(&truth, &floor, &CAMERA, told.map(|at| answer(0.0, Said::Unknown, at)));
        let [none, one] = ["no drop-off: none told", "no drop-off: one told"];
        assert_eq!((whole.0[none], whole.0[one]), (1, 3));
    }

    #[test]
    fn pitch_and_roll_are_turned_back() {
        let camera =
            Camera { pose: CameraPose { height_m: 0.5, pitch_deg: 30.0, roll_deg: 0.0 }, ..CAMERA };
        // The optical axis, 30 degrees down, meets the floor after 1 m.
        let truth = Grid::new(1, vec![10.0]);
        let pixel = seen(&truth, &Grid::new(1, vec![2]), &camera)[0];
        assert!((pixel.distance_m - 0.75_f64.sqrt()).abs() < 1e-12);
        assert!(!pixel.is_obstacle, "it lies on the floor");
    }
}
