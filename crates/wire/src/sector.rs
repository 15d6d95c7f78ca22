//! Nearest obstacle and nearest drop-off by direction.
//!
//! In: the core's [`Obstacles`](linestereo::obstacles::Obstacles). Out: a [`SectorRecord`] for each
//! direction of which something is known, of the same bits as the core's [`Sector`] and
//! [`DropOff`]. A direction without a record is unknown, or out of view.

use heapless::Vec;
use linestereo::obstacles::{DropOff, Sector};
use linestereo::units::Confidence;
use serde::{Deserialize, Serialize};

/// Sectors in one packet, so that it stays below `MAX_PACKET`: 120 degrees of view by sectors of 5
/// degrees.
pub const SECTORS_PER_PACKET: usize = 24;

/// Some of the directions that a frame knows something of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sectors {
    /// The frame they belong to.
    pub sequence: u32,
    /// Sectors of a full turn.
    pub turn: u8,
    /// The sectors, by index.
    pub list: Vec<SectorRecord, SECTORS_PER_PACKET>,
}

/// Nearest obstacle and nearest drop-off of one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SectorRecord {
    /// 0 is ahead of the vehicle, then clockwise, seen from above.
    pub index: u8,
    /// The nearest obstacle, or that the direction is free, at 0 cm; `None`: unknown.
    pub nearest: Option<Sighting>,
    /// The nearest drop-off.
    pub drop_off: Option<Sighting>,
}

/// Something at a distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sighting {
    /// Distance along the ground, cm; 1 or more.
    pub distance_cm: u16,
    /// Its probability, 1/65536.
    pub confidence_q16: u16,
    /// Time from when it was seen to the capture of the frame's pair, ms; 0: that pair shows it.
    pub age_ms: u16,
}

impl SectorRecord {
    /// The record of a direction; `None` where nothing is known.
    #[must_use]
    pub fn new(index: u8, sector: Sector, drop_off: Option<DropOff>) -> Option<Self> {
        let nearest = match sector {
            Sector::Outside | Sector::Unknown => None,
            Sector::Free { confidence, age_ms } => Some((0, confidence, age_ms)),
            Sector::Obstacle { distance_cm, confidence, age_ms } => {
                Some((distance_cm, confidence, age_ms))
            }
        };
        let nearest = nearest.map(Sighting::new);
        let drop_off = drop_off.map(|DropOff { distance_cm, confidence, age_ms }| {
            Sighting::new((distance_cm, confidence, age_ms))
        });
        let is_known = nearest.is_some() || drop_off.is_some();
        is_known.then_some(Self { index, nearest, drop_off })
    }

    /// State of the direction: an obstacle (cm), free, or unknown.
    #[must_use]
    pub fn sector(&self) -> Sector {
        let Some(nearest) = self.nearest else { return Sector::Unknown };
        let (distance_cm, confidence, age_ms) = nearest.parts();
        match distance_cm {
            0 => Sector::Free { confidence, age_ms },
            _ => Sector::Obstacle { distance_cm, confidence, age_ms },
        }
    }

    /// The nearest drop-off (cm), if one is known.
    #[must_use]
    pub fn drop_off(&self) -> Option<DropOff> {
        let (distance_cm, confidence, age_ms) = self.drop_off?.parts();
        Some(DropOff { distance_cm, confidence, age_ms })
    }
}

impl Sighting {
    fn new((distance_cm, confidence, age_ms): (u16, Confidence, u32)) -> Self {
        // Ages are within `ObstacleParams::keep_ms`.
        let age_ms = u16::try_from(age_ms).unwrap_or(u16::MAX);
        Self { distance_cm, confidence_q16: confidence.to_bits(), age_ms }
    }

    fn parts(self) -> (u16, Confidence, u32) {
        let Self { distance_cm, confidence_q16, age_ms } = self;
        (distance_cm, Confidence::from_bits(confidence_q16), age_ms.into())
    }
}
