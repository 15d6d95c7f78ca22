//! The core on a pair, as `linestereo run` would list its results.
//!
//! Everything that the bench takes of the program under test is taken here.

use super::cells::Hypothesis;
use super::grid::Grid;
use super::sectors::{self, Answer, Camera, Said};
use anyhow::{Context, Result, bail};
use linestereo::ground::{CameraPose, GroundPlane};
use linestereo::{Dims, Gray, Params, Region, obstacles::ObstacleParams, units::Confidence};
use linestereo_frames::regions::{self, Frame};
use linestereo_frames::{
    PairFiles, check_same_size, check_size, check_usable, load_images, load_values,
};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::results::directions::{Direction, Directions, five_decimals};
use linestereo_sim::results::health::is_fit;
use linestereo_wire::RigUpdate;
use std::collections::BTreeMap;
use std::path::Path;

/// Least probability of a point that is scored.
const LEAST_PROBABILITY: f64 = 0.2;

/// Pixels of both images.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) left: Grid<u8>,
    pub(crate) right: Grid<u8>,
}

impl Pair {
    /// Reads a pair as the program does.
    pub(crate) fn load(left: &Path, right: &Path) -> Result<Self> {
        let images = load_images(&PairFiles::Two([left.to_path_buf(), right.to_path_buf()]), None)?;
        check_same_size((left, images[0].dims), (right, images[1].dims))?;
        for (path, image) in [left, right].into_iter().zip(&images) {
            check_size(path, image)?;
            check_usable(path, image)?;
        }
        let [left, right] = images.map(|image| Grid::new(image.dims.width.into(), image.pixels));
        Ok(Self { left, right })
    }

    fn dims(&self) -> Result<Dims> {
        dims([self.left.width(), self.left.height()])
    }

    fn run(&self, params: &Params) -> Result<(Engine, FrameResult)> {
        let mut engine = Engine::new(params, self.dims()?)?.answering_unfit();
        let result = self.run_by(&mut engine)?;
        Ok((engine, result))
    }

    fn run_by(&self, engine: &mut Engine) -> Result<FrameResult> {
        let dims = self.dims()?;
        let view = |image| Gray::new(Grid::values(image), dims, dims.width.into());
        Ok(engine.run(view(&self.left)?, view(&self.right)?)?)
    }

    /// Points with their probabilities, in the order in which they are listed.
    pub(crate) fn points(&self, max_disparity: u16) -> Result<Vec<Hypothesis>> {
        let min_confidence = Confidence::from_num(LEAST_PROBABILITY);
        let (_, result) =
            self.run(&Params { max_disparity, min_confidence, ..Params::default() })?;
        let listed = result.points.iter().map(|point| Hypothesis {
            x: point.x.into(),
            y: point.y.into(),
            disparity: point.disparity.to_num(),
            confidence: five_decimals(point.confidence.to_num()),
        });
        Ok(listed.collect())
    }

    /// The disparity of each object of a label image that has one, by its label, px.
    pub(crate) fn objects(&self, max_disparity: u16, mask: &Path) -> Result<BTreeMap<u16, f64>> {
        let dims = self.dims()?;
        let objects = regions::load(mask, None, Frame { given: dims, matched: dims, image: None })?;
        let (mut engine, result) = self.run(&Params { max_disparity, ..Params::default() })?;
        let regions = objects.list.iter().filter_map(|object| object.region(dims).ok());
        let regions = regions.filter(|_| is_fit(result.health));
        let depth = |region: Region<'_>| {
            Some((region.label(), engine.object(&region).ok()?.disparity.to_num()))
        };
        Ok(regions.filter_map(depth).collect())
    }

    /// Answers for each sector in view.
    pub(crate) fn sectors(&self, max_disparity: u16, camera: &Camera) -> Result<Vec<Answer>> {
        let dims = self.dims()?;
        let numbers =
            RigUpdate { focal_px: camera.focal_px, baseline_m: camera.baseline_m, offset_px: 0.0 };
        let rig = Some(numbers.rig()?.centred(dims));
        let params = Params { max_disparity, rig, ..Params::default() };
        // In millimetres, as options are given.
        let above_camera = |height: f64| format!("{:.3}", height - camera.height_m).parse::<f32>();
        let [low, high] = sectors::HEIGHTS_M.map(above_camera);
        let wanted = ObstacleParams {
            range_m: sectors::RANGE_M as f32,
            heights_m: [low?, high?],
            ..ObstacleParams::DEFAULT
        };
        let plan = wanted.plan(&params, dims)?;
        let (height_m, pitch_deg) = (camera.height_m as f32, camera.pitch_deg as f32);
        let pose = CameraPose { height_m, pitch_deg, roll_deg: camera.roll_deg as f32 };
        let mut engine = Engine::new(&params, dims)?;
        engine.matcher.expect_ground(Some(GroundPlane::of_pose(pose, &numbers.rig()?, dims)?));
        let result = self.run_by(&mut engine)?;
        let directions = Directions::new(
            plan.on_ground(result.ground),
            &result.matches,
            &result.obstacle_points,
            result.health.of_pair(),
        );
        let said = |direction: Direction| {
            let obstacle = match (direction.state, direction.distance_m) {
                ("outside", _) => return None,
                ("free", _) => Said::Free,
                (_, Some(distance)) => Said::Obstacle(distance),
                _ => Said::Unknown,
            };
            let (direction_deg, drop_off_m) = (direction.direction_deg, direction.drop_off_m);
            Some(Answer { direction_deg, obstacle, drop_off_m })
        };
        Ok(directions.list().into_iter().filter_map(said).collect())
    }
}

fn dims(sides: [usize; 2]) -> Result<Dims> {
    let [width, height] = sides.map(u16::try_from);
    Ok(Dims { width: width?, height: height? })
}

/// Refuses images of a size, or a range, that the core does not take.
pub(crate) fn check(sides: [usize; 2], max_disparity: u16) -> Result<()> {
    let dims = dims(sides)?;
    if max_disparity >= dims.width {
        bail!("a disparity range of {max_disparity} does not fit images of {dims}");
    }
    Params { max_disparity, ..Params::default() }.check(dims)?;
    Ok(())
}

/// Reads an image of plain numbers.
pub(crate) fn load_numbers(path: &Path) -> Result<Grid<u16>> {
    let (dims, values) =
        load_values(path).with_context(|| format!("{} is not scored", path.display()))?;
    Ok(Grid::new(dims.width.into(), values))
}
