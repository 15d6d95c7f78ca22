//! Obstacles by direction, as a robot needs them.
//!
//! An obstacle is what stands 0.05 to 0.4 m above the floor, within 3 m. The truth of a sector of 5
//! degrees is the tenth nearest such pixel; with fewer the sector is clear.
//!
//! ```text
//! pixel, true disparity -> point in the camera's axes -> turned back by roll and pitch
//!                       -> height above the floor, distance along it, direction
//! ```

use super::figures::{Better, Figure, Group, Method, Values, percent};
use super::grid::Grid;

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
/// Labels of what can stand in the way: walls, furniture, thin and glossy things.
const SOLID: [u8; 4] = [2, 3, 4, 5];

/// Geometry and place of the left camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Camera {
    pub(crate) focal_px: f64,
    pub(crate) baseline_m: f64,
    /// Above the floor.
    pub(crate) height_m: f64,
    /// Down.
    pub(crate) pitch_deg: f64,
    pub(crate) roll_deg: f64,
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

/// A pixel with truth, as the robot meets it.
#[derive(Clone, Copy, Debug)]
struct Seen {
    direction_deg: f64,
    distance_m: f64,
    is_obstacle: bool,
}

/// Sectors in view of all scenes, by what is true and said of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sectors {
    right: usize,
    farther: usize,
    called_free: usize,
    ghost_nearer: usize,
    unknown: usize,
    clear_free: usize,
    clear_ghost: usize,
    clear_unknown: usize,
}

fn seen(truth: &Grid<f64>, labels: &Grid<u8>, camera: &Camera) -> Vec<Seen> {
    let middle = [truth.width(), truth.height()].map(|side| (side as f64 - 1.0) / 2.0);
    let [centre_x, centre_y] = camera.centre.unwrap_or(middle);
    let (sin_pitch, cos_pitch) = camera.pitch_deg.to_radians().sin_cos();
    let (sin_roll, cos_roll) = camera.roll_deg.to_radians().sin_cos();
    let of = |(x, y): (usize, usize)| {
        let ahead = camera.focal_px * camera.baseline_m / truth.at(x, y);
        let right = (x as f64 - centre_x) / camera.focal_px * ahead;
        let down = (y as f64 - centre_y) / camera.focal_px * ahead;
        let (right, down) =
            (right * cos_roll - down * sin_roll, right * sin_roll + down * cos_roll);
        let (level_down, level_ahead) =
            (down * cos_pitch + ahead * sin_pitch, ahead * cos_pitch - down * sin_pitch);
        let (above, distance_m) = (camera.height_m - level_down, right.hypot(level_ahead));
        let matters = above > HEIGHTS_M[0] && above < HEIGHTS_M[1] && distance_m < RANGE_M;
        Seen {
            direction_deg: right.atan2(level_ahead).to_degrees(),
            distance_m,
            is_obstacle: matters && SOLID.contains(&labels.at(x, y)),
        }
    };
    truth.positions().filter(|&(x, y)| truth.at(x, y) > 0.0).map(of).collect()
}

impl Sectors {
    /// Adds a scene: for the middle of each sector that was answered, clockwise from ahead, what
    /// was said of it.
    pub(crate) fn add(
        &mut self,
        truth: &Grid<f64>,
        labels: &Grid<u8>,
        camera: &Camera,
        said: impl IntoIterator<Item = (f64, Said)>,
    ) {
        let seen = seen(truth, labels, camera);
        for (direction_deg, said) in said {
            let within =
                |pixel: &&Seen| (pixel.direction_deg - direction_deg).abs() <= HALF_WIDTH_DEG;
            let inside: Vec<&Seen> = seen.iter().filter(within).collect();
            if inside.len() as f64 <= truth.height() as f64 * 0.5 {
                continue; // hardly in view
            }
            let obstacles = inside.iter().filter(|pixel| pixel.is_obstacle);
            let mut distances: Vec<f64> = obstacles.map(|pixel| pixel.distance_m).collect();
            distances.sort_unstable_by(f64::total_cmp);
            *self.kind(distances.get(LEAST_PIXELS - 1).copied(), said) += 1;
        }
    }

    fn kind(&mut self, obstacle_m: Option<f64>, said: Said) -> &mut usize {
        match (obstacle_m, said) {
            (Some(_), Said::Unknown) => &mut self.unknown,
            (Some(_), Said::Free) => &mut self.called_free,
            (Some(nearest), Said::Obstacle(told))
                if (told - nearest).abs() <= TOLERANCE * nearest =>
            {
                &mut self.right
            }
            (Some(nearest), Said::Obstacle(told)) if told > nearest => &mut self.farther,
            (Some(_), Said::Obstacle(_)) => &mut self.ghost_nearer,
            (None, Said::Unknown) => &mut self.clear_unknown,
            (None, Said::Free) => &mut self.clear_free,
            (None, Said::Obstacle(_)) => &mut self.clear_ghost,
        }
    }

    /// Figures of linestereo.
    pub(crate) fn group(&self) -> Group {
        let of = |value: f64| Values::default().with(Method::Linestereo, Some(value));
        let Self {
            right,
            farther,
            called_free,
            ghost_nearer,
            unknown,
            clear_free,
            clear_ghost,
            clear_unknown,
        } = *self;
        let obstacles = right + farther + called_free + ghost_nearer + unknown;
        let clear = clear_free + clear_ghost + clear_unknown;
        let share = |name: &str, better: Better, part: usize, whole: usize| {
            Figure::new(format!("{name}, %"), better, 0, of(percent(part, whole.max(1))))
        };
        let figures = vec![
            Figure::new("sectors with an obstacle", Better::Neither, 0, of(obstacles as f64))
                .minor(),
            share("obstacle: told right", Better::Higher, right, obstacles),
            share("obstacle: told farther", Better::Lower, farther, obstacles),
            share("obstacle: called free", Better::Lower, called_free, obstacles),
            share("obstacle: a ghost nearer", Better::Lower, ghost_nearer, obstacles),
            share("obstacle: unknown", Better::Lower, unknown, obstacles),
            Figure::new("clear sectors", Better::Neither, 0, of(clear as f64)).minor(),
            share("clear: free", Better::Higher, clear_free, clear),
            share("clear: a ghost", Better::Lower, clear_ghost, clear),
            share("clear: unknown", Better::Lower, clear_unknown, clear),
        ];
        Group::new("obstacles by direction, 0.05 to 0.4 m high, within 3 m", figures)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A level camera 0.2 m above the floor looks at a wall 2 m away.
    #[test]
    fn the_tenth_nearest_pixel_is_the_distance() {
        let camera = Camera {
            focal_px: 100.0,
            baseline_m: 0.1,
            height_m: 0.2,
            pitch_deg: 0.0,
            roll_deg: 0.0,
            centre: None,
        };
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
        sectors.add(&truth, &wall, &camera, said.map(|said| (0.0, said)));
        let expected = Sectors {
            right: 1,
            farther: 1,
            ghost_nearer: 1,
            called_free: 1,
            unknown: 1,
            ..Sectors::default()
        };
        assert_eq!(sectors, expected);

        // The floor is no obstacle, and what lies behind the camera is not in view.
        let mut clear = Sectors::default();
        clear.add(
            &truth,
            &wall.map(|_, _| 1),
            &camera,
            [(0.0, Said::Obstacle(1.0)), (5.0, Said::Free), (90.0, Said::Free)],
        );
        assert_eq!(clear, Sectors { clear_ghost: 1, clear_free: 1, ..Sectors::default() });
        assert_eq!(clear.group().figures.len(), 10);
    }

    #[test]
    fn pitch_and_roll_are_turned_back() {
        let camera = Camera {
            focal_px: 100.0,
            baseline_m: 0.1,
            height_m: 0.5,
            pitch_deg: 30.0,
            roll_deg: 0.0,
            centre: None,
        };
        // The optical axis, 30 degrees down, meets the floor after 1 m.
        let truth = Grid::new(1, vec![10.0]);
        let pixel = seen(&truth, &Grid::new(1, vec![2]), &camera)[0];
        assert!((pixel.distance_m - 0.75_f64.sqrt()).abs() < 1e-12);
        assert!(!pixel.is_obstacle, "it lies on the floor");
    }
}
