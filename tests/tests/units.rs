//! The fixed-point aliases hold what their docs say.

use linestereo::image::{MAX_HEIGHT, MAX_WIDTH};
use linestereo::units::{Confidence, Depth, Disparity, INFINITE_DEPTH, Position};

#[test]
fn ranges_and_steps() {
    assert_eq!(
        (Disparity::MIN.to_num::<f64>(), Disparity::MAX.to_num::<f64>()),
        (-512.0, 512.0 - 1.0 / 64.0)
    );
    assert_eq!(Disparity::DELTA.to_num::<f64>(), 1.0 / 64.0);
    assert_eq!(
        (Position::MIN.to_num::<f64>(), Position::MAX.to_num::<f64>()),
        (0.0, 2048.0 - 1.0 / 32.0)
    );
    assert_eq!(Position::DELTA.to_num::<f64>(), 1.0 / 32.0);
    assert_eq!(
        (Depth::MAX.to_num::<f64>(), Depth::DELTA.to_num::<f64>()),
        (32768.0 - 1.0 / 65536.0, 1.0 / 65536.0)
    );
    assert_eq!(
        (Confidence::MIN.to_num::<f64>(), Confidence::MAX.to_num::<f64>()),
        (0.0, 1.0 - 1.0 / 65536.0)
    );
    assert_eq!(INFINITE_DEPTH, Depth::MAX);
}

#[test]
fn every_position_in_the_largest_image_fits() {
    assert!(
        Position::checked_from_num(MAX_WIDTH).is_some()
            && Position::checked_from_num(MAX_HEIGHT).is_some()
    );
}
