//! Numbered settings of a board: those of the method, then those of the vehicle and its autopilot.
//!
//! In: numbers and values, of a host's command or of an autopilot's parameters. Out: the name and
//! range of each. A board keeps them over a reset.
//!
//! Every value is an `f32`, which holds each whole number here exactly. `parts` is 0 for both and 1
//! for support alone, `policy` 0 for silent, 1 for block and 2 for unknown, `block_cm` 0 for the
//! near limit of the rig, `distance_sensor` 0 for off and 1 for on, `drop_m` 0 for a vehicle that
//! flies, to which drop-offs do not matter, `sectors` 1 where the host gets the directions of every
//! pair and 0 where it does not.

use crate::rig_fault::RigFault;
use serde::{Deserialize, Serialize};

/// Number of settings.
pub const SETTINGS: usize = 20;

/// Values of all settings, in the order of [`Setting::ALL`].
pub type SettingValues = [f32; SETTINGS];

/// Name and range of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Its name with its unit, of at most 16 characters; px where there is none. In capitals it is
    /// that of the MAVLink parameter.
    pub name: &'static str,
    /// Least value.
    pub least: f32,
    /// Largest value. Some are limited further by others.
    pub largest: f32,
    /// Only whole numbers are values.
    pub is_whole: bool,
}

impl Setting {
    /// Every setting. The order is that of the numbers: a change of it is another version of the
    /// settings that boards keep.
    pub const ALL: [Self; SETTINGS] = [
        Self::whole("min_disparity", -32.0, 0.0),
        Self::whole("max_disparity", 0.0, 256.0),
        Self::whole("anchor_gradient", 4.0, 1020.0),
        Self::whole("edge_gradient", 4.0, 1020.0),
        Self::whole("min_extent", 6.0, 32.0),
        Self::whole("cell", 8.0, 256.0),
        Self::whole("reach", 1.0, 6.0),
        Self::real("min_confidence", 0.1, 1.0),
        Self::whole("parts", 0.0, 1.0),
        Self::real("yaw_deg", -180.0, 180.0),
        Self::real("range_m", 0.1, 600.0),
        Self::real("lowest_m", -1000.0, 1000.0),
        Self::real("highest_m", -1000.0, 1000.0),
        Self::whole("system", 1.0, 255.0),
        Self::whole("rate_hz", 10.0, 20.0),
        Self::whole("policy", 0.0, 2.0),
        Self::whole("block_cm", 0.0, 60_000.0),
        Self::whole("distance_sensor", 0.0, 1.0),
        Self::real("drop_m", 0.0, 100.0),
        Self::whole("sectors", 0.0, 1.0),
    ];

    /// Number of the first setting of the vehicle.
    pub const VEHICLE: usize = 9;

    const fn whole(name: &'static str, least: f32, largest: f32) -> Self {
        Self { name, least, largest, is_whole: true }
    }

    const fn real(name: &'static str, least: f32, largest: f32) -> Self {
        Self { is_whole: false, ..Self::whole(name, least, largest) }
    }

    /// Is it a value of this setting?
    #[must_use]
    pub const fn takes(&self, value: f32) -> bool {
        let is_within = self.least <= value && value <= self.largest; // false for NaN
        is_within && (!self.is_whole || value as i32 as f32 == value)
    }

    /// Number of the setting of this name, in capitals or not.
    #[must_use]
    pub fn number(name: &[u8]) -> Option<u8> {
        (0..)
            .zip(&TABLE)
            .find(|(_, of)| of.name.as_bytes().eq_ignore_ascii_case(name))
            .map(|(number, _)| number)
    }

    /// The setting of this number.
    #[must_use]
    pub fn get(number: u8) -> Option<&'static Self> {
        TABLE.get(usize::from(number))
    }
}

/// One copy in memory.
static TABLE: [Setting; SETTINGS] = Setting::ALL;

/// Value of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SettingValue {
    /// Number of the [`Setting`].
    pub number: u8,
    /// The value.
    pub value: f32,
}

/// State of a board's stored settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct KeptReport {
    /// True when a reset changes none of them, nor the objects whose depths are wanted.
    pub is_kept: bool,
    /// Of each slot of the flash the number of its image, or what is wrong with it.
    pub slots: [Result<u32, RigFault>; 2],
}
