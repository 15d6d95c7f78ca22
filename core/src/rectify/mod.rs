//! Raw frames -> rectified rows.
//!
//! ```text
//! once, floating point:  Calibration (two cameras, the pose between them)
//!                     -> Rectification (one virtual camera: directions, focal length, centre)
//! ```

mod calibration;
mod camera;
mod rectification;
mod turn;

pub use calibration::{Calibration, CalibrationError, Eye};
pub use camera::{Camera, CameraError, Lens, MAX_TANGENT};
pub use rectification::{Rectification, RectifyError, View};
