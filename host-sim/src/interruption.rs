//! Ctrl-C, and being asked to end: what is finished is kept.
//!
//! The first one is for the command to notice between two pairs; the second one ends the program at
//! once.

use core::sync::atomic::{AtomicBool, Ordering};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Exit code of a program that was interrupted, as shells have it: 128 + SIGINT.
pub const EXIT_CODE: u8 = 130;

static REQUESTED: AtomicBool = AtomicBool::new(false);
/// A file that nobody shall find when the program ends at once.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// From now on Ctrl-C no longer ends the program but is [`requested`].
pub fn watch() {
    // Where no handler can be set, Ctrl-C ends the program, which is all that is lost.
    let _ = ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            if let Some(path) = UNFINISHED.lock().ok().and_then(|mut path| path.take()) {
                let _ = fs::remove_file(path); // nowhere left to say it
            }
            std::process::exit(EXIT_CODE.into());
        }
    });
}

/// Somebody wants the program to end.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// A temporary file to be removed when the program ends at once.
pub(crate) fn remove_at_once(path: &Path) {
    if let Ok(mut unfinished) = UNFINISHED.lock() {
        *unfinished = Some(path.to_path_buf());
    }
}

/// The command ended early because somebody wanted it to; how far it came.
#[derive(Clone, Debug, thiserror::Error)]
#[error("interrupted {0}")]
pub struct Interrupted(pub String);
