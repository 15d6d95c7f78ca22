//! Code common to test files.

pub(crate) mod flash;
pub(crate) mod live;
pub(crate) mod port;
pub(crate) mod random;
pub(crate) mod rows;
pub(crate) mod sensor;

use linestereo::Dims;
use linestereo_rig::{Calibration, Camera, Lens, Rectification, View};

/// A rig of two cameras with a little barrel distortion that are turned against each other, 64x48.
pub(crate) fn rectification() -> Rectification {
    let dims = Dims { width: 64, height: 48 };
    let lens = Lens::BrownConrady { k: [-0.1, 0.0, 0.0], p: [0.0; 2] };
    let camera = || Camera::new(dims, [50.0; 2], [31.0, 24.0], 0.0, lens).unwrap();
    let rig = Calibration::new(camera(), camera(), [1.0, 0.001, -0.002, 0.003], [-0.06, 0.0, 0.0])
        .unwrap();
    rig.rectify(dims, View::default()).unwrap()
}
