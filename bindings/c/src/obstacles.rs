//! Obstacles by direction with their plan, as the functions of the header use them.

use crate::engine::Engine;
use crate::status::Status;
use crate::types::{ObstacleConfig, Obstacles, Sector, SectorState};
use linestereo::obstacles::{
    self, DropOff, ObstacleError, ObstacleParam, ObstacleParams, ObstaclePlan, Sector as CoreSector,
};

/// The content of [`Obstacles`].
pub struct Directions {
    /// Its own address: elsewhere, and in memory that was not initialised, there is another value.
    pub address: usize,
    plan: ObstaclePlan,
    known: obstacles::Obstacles,
}

const _: () = assert!(size_of::<Directions>() <= size_of::<Obstacles>());
const _: () = assert!(align_of::<Directions>() <= align_of::<Obstacles>());

impl ObstacleConfig {
    pub const fn new() -> Self {
        let ObstacleParams {
            yaw_deg,
            sectors,
            range_m,
            heights_m,
            drop_m,
            keep_ms,
            error_probability,
            ..
        } = ObstacleParams::DEFAULT;
        let drop_m = match drop_m {
            Some(drop_m) => drop_m,
            None => 0.0,
        };
        Self {
            yaw_deg,
            range_m,
            heights_m,
            drop_m,
            error_probability,
            sectors: sectors as u16,
            keep_ms,
        }
    }

    fn params(&self) -> Result<ObstacleParams, Status> {
        Ok(ObstacleParams {
            yaw_deg: self.yaw_deg,
            sectors: u8::try_from(self.sectors).map_err(|_| Status::Sectors)?,
            range_m: self.range_m,
            heights_m: self.heights_m,
            drop_m: (self.drop_m != 0.0).then_some(self.drop_m),
            keep_ms: self.keep_ms,
            error_probability: self.error_probability,
            ..ObstacleParams::DEFAULT
        })
    }
}

impl Directions {
    /// Nothing known yet, for an object at this address.
    pub fn new(address: usize, config: &ObstacleConfig, engine: &Engine) -> Result<Self, Status> {
        let plan = config.params()?.plan(engine.params(), engine.dims())?;
        Ok(Self { address, plan, known: obstacles::Obstacles::new() })
    }

    /// Takes the last pair; without one all that is known ages.
    pub fn update(&mut self, engine: &mut Engine, time_us: u64) -> Result<(), Status> {
        let Ok(matched) = engine.matched() else {
            self.known.mark_missing();
            return Err(Status::NoPair);
        };
        matched.update_obstacles(&self.plan, &mut self.known, time_us);
        if self.known.is_fit() { Ok(()) } else { Err(Status::PairUnfit) }
    }

    pub fn sector(&self, index: usize, time_us: u64) -> Result<Sector, Status> {
        let index = u8::try_from(index).ok().filter(|&index| index < self.plan.sectors());
        let index = index.ok_or(Status::NoSuchSector)?;
        let none =
            DropOff { distance_cm: 0, confidence: linestereo::units::Confidence::ZERO, age_ms: 0 };
        let drop_off = self.known.drop_off(&self.plan, index, time_us).unwrap_or(none);
        let (state, distance_cm, confidence_q16, age_ms) =
            match self.known.sector(&self.plan, index, time_us) {
                CoreSector::Outside => (SectorState::Outside, 0, 0, 0),
                CoreSector::Unknown => (SectorState::Unknown, 0, 0, 0),
                CoreSector::Free { confidence, age_ms } => {
                    (SectorState::Free, 0, confidence.to_bits(), age_ms)
                }
                CoreSector::Obstacle { distance_cm, confidence, age_ms } => {
                    (SectorState::Obstacle, distance_cm, confidence.to_bits(), age_ms)
                }
            };
        Ok(Sector {
            state,
            distance_cm,
            confidence_q16,
            drop_off_cm: drop_off.distance_cm,
            drop_off_confidence_q16: drop_off.confidence.to_bits(),
            age_ms,
            drop_off_age_ms: drop_off.age_ms,
        })
    }
}

impl From<ObstacleError> for Status {
    fn from(error: ObstacleError) -> Self {
        let param = match error {
            ObstacleError::OutOfRange { param, .. } => param,
            ObstacleError::TooLarge(_) => return Self::Offset,
            _ => return Self::NoRig,
        };
        match param {
            ObstacleParam::Yaw => Self::Yaw,
            ObstacleParam::Sectors => Self::Sectors,
            ObstacleParam::Range => Self::SectorRange,
            ObstacleParam::LowestHeight | ObstacleParam::HighestHeight => Self::Heights,
            ObstacleParam::DropDepth => Self::DropDepth,
            ObstacleParam::ErrorProbability => Self::ErrorProbability,
            _ => Self::PrincipalPoint,
        }
    }
}
