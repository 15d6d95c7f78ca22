//! The one policy for what others made: bytes, pixels and levels of folders that are read, the
//! panic of a decoder, names on a terminal.
//!
//! ```text
//! read, read_text, open   a file, of at most so many bytes
//! glance                  the same for its first bytes, of which no observer hears
//! guarded                 a decoder's panic is the error of its file
//! observe                 every file that is opened from here on
//! printable               text of others without what a terminal obeys
//! ```
//!
//! `docs/security.md` states it for users. Nothing else in this crate opens a file to read it:
//! `clippy.toml` refuses that.

use core::cell::Cell;
use core::panic::AssertUnwindSafe;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read};
use std::panic;
use std::path::Path;
use std::sync::{Once, OnceLock};

/// Most bytes of a file of settings: rigs, calibrations, `scene.json`, an image for a board's
/// flash.
pub const SETTINGS_BYTES: u64 = 1 << 20;
/// Most bytes of what a detector found in an image or in many.
pub const OBJECTS_BYTES: u64 = 32 << 20;
/// Most bytes of an image or of disparities, as stored and as decoded.
pub const IMAGE_BYTES: u64 = 128 << 20;
/// Most bytes of what this program itself wrote.
pub const RESULT_BYTES: u64 = 256 << 20;
/// Most bytes of a package of frames; its files are images.
pub const PACKAGE_BYTES: u64 = 1 << 30;
/// Most pixels of an image.
pub const PIXELS: u64 = 1 << 25;

/// The bytes of a file; an error where they are more.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // A device may have no length, and no end.
    opened(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(most)) } else { Ok(bytes) }
}

/// The text of a file; an error where it has more bytes.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read(path, most)?)
        .map_err(|_| io::Error::new(ErrorKind::InvalidData, "it is not text"))
}

/// A file to be read from any place; an error where it has more bytes, or no place but the next.
pub fn open(path: &Path, most: u64) -> io::Result<BufReader<File>> {
    bounded(opened(path)?, most)
}

/// The same for a look at what kind of file it is, of which no observer is told.
pub(crate) fn glance(path: &Path, most: u64) -> io::Result<BufReader<File>> {
    bounded(unobserved(path)?, most)
}

fn bounded(file: File, most: u64) -> io::Result<BufReader<File>> {
    let about = file.metadata()?;
    if about.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    if !about.is_file() {
        return Err(io::Error::new(ErrorKind::NotSeekable, "it is no plain file"));
    }
    if about.len() > most { Err(too_large(most)) } else { Ok(BufReader::new(file)) }
}

static OBSERVER: OnceLock<fn(&Path)> = OnceLock::new();

/// Calls `opened` with the path of each file of others that this process opens from here on. The
/// first observer stays.
pub fn observe(opened: fn(&Path)) {
    let _ = OBSERVER.set(opened);
}

/// A file whose reader takes one piece after the other, for as long as there are any.
pub fn opened(path: &Path) -> io::Result<File> {
    let file = unobserved(path)?;
    if let Some(observer) = OBSERVER.get() {
        observer(path);
    }
    Ok(file)
}

#[expect(clippy::disallowed_methods, reason = "the place that all others use")]
fn unobserved(path: &Path) -> io::Result<File> {
    File::open(path)
}

fn too_large(most: u64) -> io::Error {
    io::Error::new(ErrorKind::FileTooLarge, format!("it is larger than {} MiB", most >> 20))
}

thread_local! {
    /// A panic on this thread is about to be an error.
    static IS_GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Does work of others' code on others' data: `None` where that panics.
pub fn guarded<T>(work: impl FnOnce() -> T) -> Option<T> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |about| {
            if !IS_GUARDED.get() {
                before(about);
            }
        }));
    });
    let before = IS_GUARDED.replace(true);
    let outcome = panic::catch_unwind(AssertUnwindSafe(work));
    IS_GUARDED.set(before);
    outcome.ok()
}

/// Text for a terminal: what moves its cursor, turns its direction or sets anything of it becomes
/// U+FFFD. Ends of lines and tabs stay.
pub fn printable(text: &str) -> Cow<'_, str> {
    if text.chars().any(is_order) {
        text.chars()
            .map(|letter| if is_order(letter) { char::REPLACEMENT_CHARACTER } else { letter })
            .collect()
    } else {
        text.into()
    }
}

fn is_order(letter: char) -> bool {
    let turns = matches!(letter, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || (letter.is_control() && !matches!(letter, '\n' | '\t'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_file_ends_where_its_kind_does() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        fs::write(&path, [7; 100]).unwrap();
        assert_eq!(read(&path, 100).unwrap(), [7; 100]);
        assert_eq!(read(&path, 99).unwrap_err().kind(), ErrorKind::FileTooLarge);
        assert!(open(&path, 100).is_ok());
        assert_eq!(open(&path, 99).unwrap_err().kind(), ErrorKind::FileTooLarge);
        assert!(open(folder.path(), 99).is_err());
    }

    #[test]
    fn a_panic_is_an_error() {
        assert_eq!(guarded(|| 3), Some(3));
        assert_eq!(guarded(|| [1][core::hint::black_box(1)]), None);
        assert!(!IS_GUARDED.get());
    }

    #[test]
    fn a_terminal_is_given_no_orders() {
        assert_eq!(
            printable("a\tb\n\u{1b}[2Jc\u{9b}\r\u{7f}\u{202e}d"),
            "a\tb\n\u{fffd}[2Jc\u{fffd}\u{fffd}\u{fffd}\u{fffd}d"
        );
        assert!(matches!(printable("ä – 3 µm"), Cow::Borrowed(_)));
    }
}
