//! Two lines to the host, on fakes.

use core::cell::{Cell, RefCell};
use linestereo_firmware::host_lines::{HostLine, HostLines, Line, Listener};
use linestereo_firmware::ports::{ByteSink as _, ByteSource as _, Room};
use std::collections::VecDeque;
use std::rc::Rc;

const CAPACITY: usize = 8;

/// A line whose other end fetches a byte every so many looks at the clock.
struct FakeLine {
    listener: Listener,
    /// Bytes that wait, and those that were fetched.
    waiting: Rc<RefCell<VecDeque<u8>>>,
    into: VecDeque<u8>,
}

impl FakeLine {
    fn new(listener: Listener) -> Self {
        Self { listener, waiting: Rc::default(), into: VecDeque::new() }
    }
}

impl Line for FakeLine {
    fn listener(&self) -> Listener {
        self.listener
    }

    fn room(&self) -> Room {
        Room { free: CAPACITY - self.waiting.borrow().len(), all: CAPACITY }
    }

    fn put(&mut self, bytes: &[u8]) {
        assert!(bytes.len() <= self.room().free, "there was no room");
        self.waiting.borrow_mut().extend(bytes);
    }

    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let count = self.into.len().min(bytes.len());
        bytes.iter_mut().zip(self.into.drain(..count)).for_each(|(place, byte)| *place = byte);
        count
    }

    fn heard(&mut self) {
        self.listener = Listener::Somebody;
    }
}

fn still() -> u64 {
    0
}

#[test]
fn records_go_to_both_whole_or_not_at_all() {
    let [nobody, perhaps] = [Listener::Nobody, Listener::Perhaps].map(FakeLine::new);
    let (first, second) = (nobody.waiting.clone(), perhaps.waiting.clone());
    let mut lines =
        HostLines::new(HostLine::new(nobody, still, 100), HostLine::new(perhaps, still, 100));
    for record in [&[1, 2, 3][..], &[4, 5, 6], &[7, 8, 9], &[10, 11]] {
        lines.write(record); // for nobody here is anything waited for: this clock stands still
    }
    assert!(first.borrow().is_empty());
    assert_eq!(*second.borrow(), [1, 2, 3, 4, 5, 6, 10, 11]);
}

#[test]
fn who_listens_is_waited_for_but_not_for_ever() {
    let now = Rc::new(Cell::new(0_u64));
    let line = FakeLine::new(Listener::Somebody);
    let waiting = line.waiting.clone();
    // A byte is fetched every 10 us, until 300 us.
    let clock = {
        let (now, waiting) = (now.clone(), waiting.clone());
        move || {
            now.set(now.get() + 1);
            if now.get().is_multiple_of(10) && now.get() < 300 {
                waiting.borrow_mut().pop_front();
            }
            now.get()
        }
    };
    let mut lines = HostLine::new(line, clock, 100);
    lines.write(&[1; 8]);
    lines.write(&[2; 8]);
    assert!((70..90).contains(&now.get()), "{}", now.get());
    now.set(300);
    lines.write(&[3; 8]); // dropped after 100 us
    assert!((400..405).contains(&now.get()), "{}", now.get());
    lines.write(&[4; 8]); // and this one at once
    assert!((400..408).contains(&now.get()), "{}", now.get());
    assert_eq!(*waiting.borrow(), [2; 8]);
    waiting.borrow_mut().clear();
    lines.write(&[5; 4]); // it fetches again: waited for from now on
    lines.write(&[6; 8]);
    assert!((500..520).contains(&now.get()), "{}", now.get());
    assert_eq!(*waiting.borrow(), [5; 4]);
}

/// Bytes without a command, such as those of a plug, say nothing of the line.
#[test]
fn a_command_says_which_line_has_a_host() {
    for at in [0, 1] {
        let mut lines = [Listener::Perhaps; 2].map(FakeLine::new);
        lines[at].into.extend([1, 2]);
        let waiting = lines.each_ref().map(|line| line.waiting.clone());
        let [first, second] = lines.map(|line| HostLine::new(line, still, 0));
        let mut lines = HostLines::new(first, second);
        lines.read(&mut [0; 8]);
        waiting[1 - at].borrow_mut().extend([0; 2]);
        assert_eq!(lines.room().free, 6, "of both the one with less");
        lines.heard();
        assert_eq!(lines.room().free, 8, "of the one that is known");
    }
}

#[test]
fn commands_come_from_either() {
    let [mut first, mut second] = [Listener::Nobody, Listener::Somebody].map(FakeLine::new);
    first.into.extend([1, 2, 3]);
    second.into.extend([4, 5]);
    let mut lines =
        HostLines::new(HostLine::new(first, still, 100), HostLine::new(second, still, 100));
    let mut bytes = [0; 2];
    let mut read = || (lines.read(&mut bytes), bytes);
    assert_eq!(
        [read(), read(), read(), read()],
        [(2, [1, 2]), (1, [3, 2]), (2, [4, 5]), (0, [4, 5])]
    );
}
