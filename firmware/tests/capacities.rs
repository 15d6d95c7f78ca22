//! Which rigs the memory of a board takes, and how the others are refused.

use linestereo::Dims;
use linestereo_boards::Board;
use linestereo_firmware::boards::{mps2_an500, pico2, portenta_h7, stm32h743};
use linestereo_firmware::memory::Memory;
use linestereo_firmware::session::{Reply, Session};
use linestereo_rig::{Calibration, Camera, Lens, RigImage, View};
use linestereo_wire::{Command, Outcome, Request};

const QVGA: Dims = Dims { width: 320, height: 240 };

/// A strong barrel, 110 degrees of view, cameras turned by 2 degrees and rolled by so many more
/// against each other.
fn strong(raw: Dims, roll_deg: f64) -> RigImage {
    let (width, height) = (f64::from(raw.width), f64::from(raw.height));
    let lens = Lens::BrownConrady { k: [-0.3, 0.09, -0.011], p: [0.0005, -0.0003] };
    let camera = |x: f64, y: f64| {
        Camera::new(raw, [0.5 * width; 2], [0.5 * width + x, 0.5 * height + y], 0.0, lens).unwrap()
    };
    let turn = [1.0, 0.006, -0.008, 0.014 + (0.5 * roll_deg.to_radians()).tan()];
    let calibration =
        Calibration::new(camera(1.5, -2.0), camera(-2.0, 1.0), turn, [-0.06, 0.0005, 0.001])
            .unwrap();
    RigImage::new(calibration, QVGA, View::default(), (0, 48)).unwrap()
}

/// The answers of a board to rigs.
fn answers(board: Board, memory: &mut impl Memory, rigs: [&RigImage; 3]) -> [String; 3] {
    let mut session = Session::new(board);
    rigs.map(|rig| {
        let request = Request::SetRig(rig.encode(0).into_iter().collect());
        match session.command(&Command { id: 1, request }, memory) {
            Reply::Answer(answer) => match answer.outcome {
                // Without a flash it is used and not kept.
                Outcome::Accepted => "accepted".to_owned(),
                Outcome::Refused(why) => why.to_string(),
            },
            other => panic!("{other:?}"),
        }
    })
}

#[test]
fn boards_take_the_rigs_of_their_sensors_and_name_what_is_too_large() {
    let [strong_lens, wide, rolled] =
        [strong(QVGA, 0.0), strong(Dims { width: 640, height: 480 }, 0.0), strong(QVGA, 6.0)];
    let rigs = [&strong_lens, &wide, &rolled];
    for ([first, second, third], row, band) in [
        (
            answers(Board::STM32H743, &mut *Box::new(stm32h743::BoardMemory::CLEARED), rigs),
            320,
            12_288,
        ),
        (
            answers(Board::PORTENTA_H7, &mut *Box::new(portenta_h7::BoardMemory::CLEARED), rigs),
            320,
            12_288,
        ),
        (answers(Board::PICO2, &mut *Box::new(pico2::BoardMemory::CLEARED), rigs), 320, 12_288),
        (
            answers(Board::MPS2_AN500, &mut *Box::new(mps2_an500::BoardMemory::CLEARED), rigs),
            480,
            12_800,
        ),
    ] {
        let too_wide = format!("raw row of the board's memory holds {row}, these images need 640");
        assert_eq!([first, second], ["accepted", &too_wide]);
        let too_large = format!("band of the board's memory holds {band}, these images need ");
        assert!(third.starts_with(&too_large), "{third}");
    }
}
