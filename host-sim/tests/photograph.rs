//! `linestereo photograph` as a user types it, with boards behind a connection.

use crate::monitor::{next_command, packet};
use crate::support::{Folder, listening, refused, succeed};
use core::time::Duration;
use linestereo_wire::*;
use std::fs;
use std::io::Write;
use std::net::TcpStream;
use std::thread::{self, JoinHandle};

const SIZE: [u16; 2] = [40, 30];
const PIXELS: usize = 40 * 30;

fn send(stream: &mut TcpStream, message: &Message) {
    stream.write_all(&packet(message)).unwrap();
}

/// Photo number `n` of a side.
fn image(n: u8, is_right: bool) -> Vec<u8> {
    (0..PIXELS).map(|place| (place % 97) as u8 + n + 100 * u8::from(is_right)).collect()
}

fn send_photo(stream: &mut TcpStream, command: u16, n: u8, lost: Option<usize>) {
    send(stream, &Message::Answer(Answer { command, outcome: Outcome::Accepted }));
    let [width, height] = SIZE;
    let head = PairHead { width, height, capture_time_us: 1, right_capture_time_us: None };
    send(stream, &Message::Photo(head));
    for is_right in [false, true] {
        for (place, piece) in image(n, is_right).chunks(PIXELS_PER_PACKET).enumerate() {
            if lost == Some(place) && is_right {
                continue;
            }
            let list = heapless::Vec::from_slice(piece).unwrap();
            let first = (place * PIXELS_PER_PACKET) as u32;
            send(stream, &Message::Pixels(Pixels { is_right, first, list }));
            // Other messages of a board stand between them.
            send(stream, &Message::Capture(CaptureReport::default()));
        }
    }
}

/// A board that does this for every photo it is asked for, counted from 0.
fn board(act: impl Fn(&mut TcpStream, u16, u8) + Send + 'static) -> (String, JoinHandle<u8>) {
    let (listener, address) = listening();
    let thread = thread::spawn(move || {
        let mut stream = listener.accept().unwrap().0;
        let (mut decoder, mut photos) = (Decoder::new(), 0);
        while let Some(Command { id, request }) = next_command(&mut stream, &mut decoder) {
            assert_eq!(request, Request::Photograph);
            act(&mut stream, id, photos);
            photos += 1;
        }
        photos
    });
    (address, thread)
}

#[test]
fn pairs_become_files_that_calibrate_reads_behind_those_that_are_there() {
    let folder = Folder::new();
    fs::create_dir(folder.path().join("photos")).unwrap();
    fs::write(folder.path().join("photos/left07.png"), "an older one").unwrap();
    let (address, thread) = board(|stream, command, n| send_photo(stream, command, n, None));
    let said = succeed(folder.path(), &format!("photograph photos --tcp {address} --count 2"));
    assert_eq!(thread.join().unwrap(), 2);
    assert!(said.starts_with("photo 08: 40x30, mean grey level 47 left, 147 right\n"), "{said}");
    for (number, n) in [("08", 0), ("09", 1)] {
        for (side, is_right) in [("left", false), ("right", true)] {
            let path = folder.path().join(format!("photos/{side}{number}.png"));
            assert_eq!(image::open(path).unwrap().into_luma8().into_raw(), image(n, is_right));
        }
    }
    assert_eq!(fs::read(folder.path().join("photos/left07.png")).unwrap(), b"an older one");
}

#[test]
fn what_fails_is_said_and_leaves_no_half_pair() {
    let folder = Folder::new();
    let no_pair = |stream: &mut TcpStream, command: u16, _: u8| {
        let outcome = Outcome::Refused(Refusal::NoPair);
        send(stream, &Message::Answer(Answer { command, outcome }));
    };
    let lost_pixels =
        |stream: &mut TcpStream, command: u16, n: u8| send_photo(stream, command, n, Some(1));
    let closed = |stream: &mut TcpStream, _: u16, _: u8| {
        let _ = stream.shutdown(std::net::Shutdown::Both);
    };
    // At another speed, say.
    let garbage = |stream: &mut TcpStream, _: u16, _: u8| {
        while stream.write_all(&[0x55; 64]).is_ok() {
            thread::sleep(Duration::from_millis(20));
        }
    };
    for ((address, _), word) in [
        (board(garbage), "no photograph in 5 s, though bytes came; check --baud"),
        (board(no_pair), "photo 1 of 1: the board refused: the cameras delivered no complete pair"),
        (board(lost_pixels), "pixels were lost on the way"),
        (board(closed), "was closed"),
    ] {
        refused(folder.path(), &format!("photograph photos --tcp {address}"), &[word]);
    }
    assert_eq!(fs::read_dir(folder.path().join("photos")).unwrap().count(), 0);
    refused(folder.path(), "photograph photos", &["--tcp", "--serial"]);
}
