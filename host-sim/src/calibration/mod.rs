//! From photos of a board to a calibrated pair, and the file that keeps it.

mod rig_file;

pub use rig_file::{Quality, RigFile, RigFileError, quaternion, rotation_vector};
