//! The three messages, field for field in the order of the wire.

use crate::frame::{Fields, Mavlink};

/// A distance that is not known.
pub const UNKNOWN_CM: u16 = u16::MAX;

/// MAV_DISTANCE_SENSOR_UNKNOWN: the enumeration has no cameras.
const SENSOR_TYPE: u8 = 4;
/// MAV_FRAME_BODY_FRD: sector 0 is ahead of the vehicle.
const BODY_FRD: u8 = 12;
/// MAV_TYPE_ONBOARD_CONTROLLER, MAV_AUTOPILOT_INVALID, and the version in minimal.xml.
const ONBOARD_CONTROLLER: u8 = 18;
const NO_AUTOPILOT: u8 = 8;
const MAVLINK_VERSION: u8 = 3;

/// MAV_STATE, as far as it is used here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SystemStatus {
    /// Distances can be believed.
    Active = 4,
    /// The pair is not fit to be used, or shows nothing.
    Critical = 5,
}

/// HEARTBEAT of an onboard controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heartbeat {
    /// How the sender is.
    pub status: SystemStatus,
}

impl Mavlink for Heartbeat {
    const ID: u32 = 0;
    const CRC_EXTRA: u8 = 50;

    fn put(&self, fields: &mut Fields) {
        fields.put(&[0; 4]); // custom_mode
        fields.put(&[ONBOARD_CONTROLLER, NO_AUTOPILOT, 0, self.status as u8, MAVLINK_VERSION]);
    }
}

/// OBSTACLE_DISTANCE of the whole turn, around the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleDistance {
    /// Since the sender started, us.
    pub time_usec: u64,
    /// Sector 0 ahead, then clockwise, cm; one more than the largest distance: clear;
    /// [`UNKNOWN_CM`].
    pub distances: [u16; 72],
    /// Shortest distance that can be measured, cm.
    pub min_distance: u16,
    /// Largest distance that is measured, cm.
    pub max_distance: u16,
    /// Width of a sector, degrees; sent as a whole number as well.
    pub increment_f: f32,
    /// Direction of sector 0, degrees clockwise.
    pub angle_offset: f32,
}

impl Mavlink for ObstacleDistance {
    const ID: u32 = 330;
    const CRC_EXTRA: u8 = 23;

    fn put(&self, fields: &mut Fields) {
        fields.put(&self.time_usec.to_le_bytes());
        for distance in self.distances {
            fields.put(&distance.to_le_bytes());
        }
        fields.put(&self.min_distance.to_le_bytes());
        fields.put(&self.max_distance.to_le_bytes());
        fields.put(&[SENSOR_TYPE, self.increment_f as u8]);
        fields.put(&self.increment_f.to_le_bytes());
        fields.put(&self.angle_offset.to_le_bytes());
        fields.put(&[BODY_FRD]);
    }
}

/// DISTANCE_SENSOR, forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceSensor {
    /// Since the sender started, ms.
    pub time_boot_ms: u32,
    /// Shortest distance that can be measured, cm.
    pub min_distance: u16,
    /// Largest distance that is measured, cm.
    pub max_distance: u16,
    /// Distance, cm; one more than the largest: clear.
    pub current_distance: u16,
    /// Number of the sensor.
    pub id: u8,
    /// Angle of view that the distance is of, rad.
    pub horizontal_fov: f32,
    /// The same up and down, rad; 0 is not known.
    pub vertical_fov: f32,
    /// Percent; 0 is not known, 1 is useless.
    pub signal_quality: u8,
}

impl Mavlink for DistanceSensor {
    const ID: u32 = 132;
    const CRC_EXTRA: u8 = 85;

    fn put(&self, fields: &mut Fields) {
        fields.put(&self.time_boot_ms.to_le_bytes());
        fields.put(&self.min_distance.to_le_bytes());
        fields.put(&self.max_distance.to_le_bytes());
        fields.put(&self.current_distance.to_le_bytes());
        // Orientation 0: MAV_SENSOR_ROTATION_NONE, forward. Variance: not known.
        fields.put(&[SENSOR_TYPE, self.id, 0, u8::MAX]);
        fields.put(&self.horizontal_fov.to_le_bytes());
        fields.put(&self.vertical_fov.to_le_bytes());
        fields.put(&[0; 16]); // quaternion
        fields.put(&[self.signal_quality]);
    }
}
