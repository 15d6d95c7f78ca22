//! Times of a frame that `live` reports.

use crate::support::live::scripted;
use crate::support::port::Port;
use linestereo_firmware::boards::mps2_an386::{BOARD, BoardMemory};
use linestereo_firmware::ports::{ByteSink, ByteSource};
use linestereo_firmware::programs::live::Live;
use linestereo_firmware::session::Session;
use linestereo_wire::{FrameTimes, Message, Request};

/// Passes with every look at the clock, with every pair, and with every byte to the host, us.
const LOOK_US: u32 = 100;
const PAIR_US: u32 = 9000;
const BYTE_US: u32 = 10;

/// A line for which the program waits.
struct SlowLine(Port);

impl ByteSource for SlowLine {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        self.0.read(bytes)
    }
}

impl ByteSink for SlowLine {
    fn write(&mut self, bytes: &[u8]) {
        self.0.pass(BYTE_US * bytes.len() as u32);
        self.0.write(bytes);
    }
}

#[test]
fn a_frame_says_how_long_it_waited_and_took_and_how_long_the_one_before_was_written() {
    let (port, mut memory) = (Port::with_look(LOOK_US), Box::new(BoardMemory::CLEARED));
    let mut camera = scripted(|_, paint| {
        port.pass(PAIR_US);
        paint()
    });
    let mut live = Live::start(Session::new(BOARD), port.clone(), SlowLine(port.clone()));
    let hello = port.bytes().len() as u32 - 1; // the first delimiter is written before anything is counted
    port.send(1, Request::Start);
    let (mut written, mut writes) = (hello, 1);
    for frame in 0..3 {
        live.turn(&mut *memory, &mut camera);
        let bytes = port.bytes();
        let mut decoder =
            linestereo_wire::Decoder::<Message, { linestereo_wire::MAX_PACKET }>::new();
        let (mut answer, mut head) = (0, None);
        for (&byte, count) in bytes.iter().zip(1..) {
            match decoder.push(byte) {
                Some(Ok(Message::Answer(_))) => answer = count,
                Some(Ok(Message::Frame(found))) => head = Some(found),
                _ => {}
            }
        }
        if answer > 0 {
            (written, writes) = (written + answer, writes + 1);
        }
        let expected = FrameTimes {
            waiting_us: PAIR_US + LOOK_US,
            matching_us: LOOK_US,
            port_us: BYTE_US * written + LOOK_US * writes,
        };
        assert_eq!(head.unwrap().times, expected, "frame {frame}");
        (written, writes) = (bytes.len() as u32 - answer, 1);
    }
}
