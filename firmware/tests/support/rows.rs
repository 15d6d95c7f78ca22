//! Rows of which every byte says from which camera, frame and row it is, so that a row of another
//! frame cannot go unnoticed.

use linestereo_firmware::capture::Fault;
use linestereo_firmware::memory::Memory;
use linestereo_rig::CameraSide;
use linestereo_wire::CaptureReport;

pub(crate) const WIDTH: u16 = 16;

/// Value of every byte of a row.
pub(crate) fn paint(eye: CameraSide, frame: u32, row: u32) -> [u8; WIDTH as usize] {
    let [a, b, c, d] = frame.to_le_bytes();
    core::array::from_fn(|place| {
        [eye as u8, a, b, c, d, row as u8, !a, !b][place % 8] ^ (place as u8 & 8)
    })
}

/// Camera, frame and row of a row; `None` when its bytes do not belong together.
pub(crate) fn read(bytes: &[u8]) -> Option<(CameraSide, u32, u32)> {
    let [eye, a, b, c, d, row, ..] = *bytes else { return None };
    let frame = u32::from_le_bytes([a, b, c, d]);
    let eye = CameraSide::BOTH.into_iter().find(|of| *of as u8 == eye)?;
    (paint(eye, frame, row.into()) == *bytes).then_some((eye, frame, row.into()))
}

/// The number of the frame that lies there whole, of each camera.
pub(crate) fn frames_of(frames: [impl AsRef<[u8]>; 2]) -> Result<[u32; 2], String> {
    let mut found = [None; 2];
    for ((eye, frame), found) in CameraSide::BOTH.into_iter().zip(frames).zip(&mut found) {
        for (y, row) in (0..).zip(frame.as_ref().chunks(WIDTH.into())) {
            let (of, number, row) = read(row).ok_or(format!("{eye:?} row {y} is torn"))?;
            if (of, row) != (eye, y) || *found.get_or_insert(number) != number {
                let expected = format!("{eye:?} row {y} of frame {found:?}");
                return Err(format!("{of:?} row {row} of frame {number} is there for {expected}"));
            }
        }
    }
    let [Some(left), Some(right)] = found else { return Err("no rows".into()) };
    Ok([left, right])
}

/// The same of frames of so many rows in a board's memory.
pub(crate) fn frames_in(memory: &mut impl Memory, rows: u32) -> Result<[u32; 2], String> {
    frames_of(memory.frames().map(|frame| &frame[..usize::from(WIDTH) * rows as usize]))
}

/// How often the left and the right camera had this fault.
pub(crate) fn faults(losses: &CaptureReport, fault: Fault) -> [u32; 2] {
    losses.faults.map(|of| of[fault as usize])
}
