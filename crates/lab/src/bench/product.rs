//! The core on a pair, as `linestereo run` would list its results.
//!
//! Everything that the bench takes of the program under test is taken here.

use super::cells::Hypothesis;
use super::grid::Grid;
use super::sectors::{self, Answer, Camera, Said};
use anyhow::{Context, Result, bail};
use linestereo::ground::GroundPlane;
use linestereo::{Dims, Gray, Params, Region, obstacles::ObstacleParams, units::Confidence};
use linestereo_frames::regions::{self, Frame};
use linestereo_frames::{GrayImage, PairFiles, check_usable, load_values};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::results::directions::{Direction, Directions, five_decimals};
use linestereo_sim::results::health::is_fit;
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
    /// Images that the program would match.
    pub(crate) fn new(files: &PairFiles, images: [GrayImage; 2]) -> Result<Self> {
        for (path, image) in files.paths().into_iter().zip(&images) {
            check_usable(path, image)?;
        }
        let [left, right] = images.map(|image| Grid::new(image.dims.width.into(), image.pixels));
        Ok(Self { left, right })
    }

    /// Refuses a size, or a range, that the core does not take.
    pub(crate) fn check(&self, max_disparity: u16) -> Result<()> {
        let dims = self.dims()?;
        if max_disparity >= dims.width {
            bail!("a disparity range of {max_disparity} does not fit images of {dims}");
        }
        Params { max_disparity, ..Params::default() }.check(dims)?;
        Ok(())
    }

    fn dims(&self) -> Result<Dims> {
        let [width, height] = [self.left.width(), self.left.height()].map(u16::try_from);
        Ok(Dims { width: width?, height: height? })
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
        let rig = camera.rig.rig()?;
        let params = Params { max_disparity, rig: Some(rig.centred(dims)), ..Params::default() };
        let height_m = f64::from(camera.pose.height_m);
        // In millimetres, as options are given.
        let above_camera = |height: f64| format!("{:.3}", height - height_m).parse::<f32>();
        let [low, high] = sectors::HEIGHTS_M.map(above_camera);
        let wanted = ObstacleParams {
            range_m: sectors::RANGE_M as f32,
            heights_m: [low?, high?],
            ..ObstacleParams::DEFAULT
        };
        let plan = wanted.plan(&params, dims)?;
        let mut engine = Engine::new(&params, dims)?;
        engine.matcher.expect_ground(Some(GroundPlane::of_pose(camera.pose, &rig, dims)?));
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

/// Reads an image of plain numbers.
pub(crate) fn load_numbers(path: &Path) -> Result<Grid<u16>> {
    let (dims, values) =
        load_values(path).with_context(|| format!("{} is not scored", path.display()))?;
    Ok(Grid::new(dims.width.into(), values))
}
