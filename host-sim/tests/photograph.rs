//! `linestereo photograph` as a user types it, with boards behind a connection.

use crate::support::{linestereo, refused};
use linestereo_wire::*;
use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::thread::{self, JoinHandle};
use tempfile::TempDir;

const SIZE: [u16; 2] = [40, 30];
const PIXELS: usize = 40 * 30;

fn send<T: Record>(stream: &mut TcpStream, record: &T) {
    stream.write_all(encode(record, &mut [0; MAX_PACKET]).unwrap()).unwrap();
}

/// The id of the next command, which has to ask for a photo.
fn asked(stream: &mut TcpStream) -> Option<u16> {
    let mut decoder: Decoder<Command, MAX_COMMAND> = Decoder::new();
    let mut byte = [0];
    while stream.read(&mut byte).ok()? > 0 {
        if let Some(command) = decoder.push(byte[0]) {
            let command = command.unwrap();
            assert_eq!(command.request, Request::Photograph);
            return Some(command.id);
        }
    }
    None
}

/// Photo number `n` of a side.
fn image(n: u8, is_right: bool) -> Vec<u8> {
    (0..PIXELS).map(|place| (place % 97) as u8 + n + 100 * u8::from(is_right)).collect()
}

fn send_photo(stream: &mut TcpStream, command: u16, n: u8, lost: Option<usize>) {
    send(stream, &Message::Answer(Answer { command, outcome: Outcome::Accepted }));
    let [width, height] = SIZE;
    send(
        stream,
        &Message::Photo(PairHead {
            width,
            height,
            capture_time_us: 1,
            right_capture_time_us: None,
        }),
    );
    for is_right in [false, true] {
        for (place, piece) in image(n, is_right).chunks(PIXELS_PER_PACKET).enumerate() {
            if lost == Some(place) && is_right {
                continue;
            }
            let list = heapless::Vec::from_slice(piece).unwrap();
            send(
                stream,
                &Message::Pixels(Pixels {
                    is_right,
                    first: (place * PIXELS_PER_PACKET) as u32,
                    list,
                }),
            );
            // Other messages of a board stand between them.
            send(stream, &Message::Capture(CaptureReport::default()));
        }
    }
}

/// A board that does this for every photo it is asked for, counted from 0.
fn board(act: impl Fn(&mut TcpStream, u16, u8) + Send + 'static) -> (String, JoinHandle<u8>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let thread = thread::spawn(move || {
        let mut stream = listener.accept().unwrap().0;
        let mut photos = 0;
        while let Some(command) = asked(&mut stream) {
            act(&mut stream, command, photos);
            photos += 1;
        }
        photos
    });
    (address, thread)
}

#[test]
fn pairs_become_files_that_calibrate_reads_behind_those_that_are_there() {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("photos")).unwrap();
    fs::write(folder.path().join("photos/left07.png"), "an older one").unwrap();
    let (address, thread) = board(|stream, command, n| send_photo(stream, command, n, None));
    let output =
        linestereo(folder.path(), &["photograph", "photos", "--tcp", &address, "--count", "2"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(thread.join().unwrap(), 2);
    let said = String::from_utf8(output.stdout).unwrap();
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
    let folder = TempDir::new().unwrap();
    let no_pair = |stream: &mut TcpStream, command: u16, _: u8| {
        send(
            stream,
            &Message::Answer(Answer { command, outcome: Outcome::Refused(Refusal::NoPair) }),
        );
    };
    let run = |address: &str| refused(folder.path(), &["photograph", "photos", "--tcp", address]);
    let (address, _) = board(no_pair);
    assert!(
        run(&address)
            .contains("photo 1 of 1: the board refused: the cameras delivered no complete pair")
    );
    let (address, _) = board(|stream, command, n| send_photo(stream, command, n, Some(1)));
    assert!(run(&address).contains("pixels were lost on the way"));
    let (address, _) = board(|stream, _, _| {
        let _ = stream.shutdown(std::net::Shutdown::Both);
    });
    assert!(run(&address).contains("was closed"));
    assert_eq!(fs::read_dir(folder.path().join("photos")).unwrap().count(), 0);
    let nowhere = refused(folder.path(), &["photograph", "photos"]);
    assert!(nowhere.contains("--tcp") && nowhere.contains("--serial"), "{nowhere}");
}
