//! Raw frames -> rectified rows.
//!
//! ```text
//! once, floating point:  Calibration (two cameras, the pose between them)
//!                     -> Rectification (one virtual camera: directions, focal length, centre)
//!                     -> Mesh, one per camera (raw positions of every 16th pixel, what each row needs)
//! per raw row, integers: Band (the raw rows that are needed at once) -> rectified rows
//! ```

mod calibration;
mod camera;
mod grid;
mod mesh;
mod nodes;
mod rectification;
mod rows;
mod turn;

pub use calibration::{Calibration, CalibrationError, Eye};
pub use camera::{Camera, CameraError, Lens, MAX_TANGENT};
pub use mesh::{Mesh, MeshError};
pub use nodes::{fine_mesh_nodes, mesh_nodes};
pub use rectification::{Rectification, RectifyError, View};
pub use rows::{Band, RowError};
