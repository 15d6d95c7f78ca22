//! The rig of raw images that were reduced.

use anyhow::Result;
use linestereo::Dims;
use linestereo_rig::{Calibration, Camera, Eye};

/// The same rig for raw images of another size that show the same: whole pixels are centres, so borders are half a pixel outside.
pub fn reduced(calibration: &Calibration, dims: Dims) -> Result<Calibration> {
    let camera = |eye| {
        let camera = calibration.camera(eye);
        let [sx, sy] = [
            f64::from(dims.width) / f64::from(camera.dims().width),
            f64::from(dims.height) / f64::from(camera.dims().height),
        ];
        let ([fx, fy], [cx, cy]) = (camera.focal(), camera.centre());
        let centre = [(cx + 0.5) * sx - 0.5, (cy + 0.5) * sy - 0.5];
        Camera::new(dims, [fx * sx, fy * sy], centre, camera.skew() * sx, camera.lens())
    };
    let (left, right) = (camera(Eye::Left)?, camera(Eye::Right)?);
    Ok(Calibration::new(left, right, calibration.rotation(), calibration.translation())?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo_rig::Lens;

    #[test]
    fn a_ray_stays_at_its_place_in_the_image() {
        let dims = Dims { width: 640, height: 480 };
        let lens = Lens::BrownConrady { k: [-0.3, 0.1, 0.0], p: [1e-3, 0.0] };
        let camera = Camera::new(dims, [500.0, 510.0], [300.0, 250.0], 2.0, lens).unwrap();
        let pair = Calibration::new(camera, camera, [1.0, 0.0, 0.0, 0.0], [-0.1, 0.0, 0.0]).unwrap();
        let small = reduced(&pair, Dims { width: 320, height: 160 }).unwrap();
        for ray in [[0.0, 0.0, 1.0], [0.3, -0.2, 1.0], [-0.25, 0.1, 1.0]] {
            let [[u, v], [x, y]] = [&pair, &small].map(|rig| rig.camera(Eye::Right).project(ray).unwrap());
            assert!(((u + 0.5) / 2.0 - (x + 0.5)).abs() < 1e-9 && ((v + 0.5) / 3.0 - (y + 0.5)).abs() < 1e-9);
        }
        assert_eq!(reduced(&pair, dims).unwrap(), pair);
    }
}
