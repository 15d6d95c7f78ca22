//! Output files: all of a command's files appear, whole, or none does; "-" is stdout, for every one
//! of them.
//!
//! ```text
//! OutputPath    a file that is named on the command line to be written: `commands::arguments`
//!               knows them by this type
//! spare         none of them is among the files that a command is about to read
//! remember_inputs  none of them is among those that it has read, whichever output it is
//! OutputFiles   written beside their destinations, then renamed together
//! LineFile      one that grows line by line
//! print, say, detail   results and notes on stdout; more, for who asks, on stderr
//! ```
//!
//! Links are followed: a link to a photo is the photo, and what is written to another link is
//! written to what it points to.

use crate::interruption;
use anyhow::{Result, anyhow, bail};
use core::ops::Deref;
use core::sync::atomic::{AtomicBool, Ordering};
use image::{ExtendedColorType, ImageEncoder, ImageResult, codecs::png::PngEncoder};
use linestereo_frames::untrusted::{self, printable};
use serde::Serialize;
use std::collections::{BTreeSet, HashSet};
use std::ffi::OsString;
use std::fs::{self, File, Permissions};
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::{NamedTempFile, TempPath};

/// Links in a row that are followed to a file that is not there.
const MOST_LINKS: usize = 32;

/// Most bytes of a result that a terminal is given: more than a page of text scrolls away what was
/// asked before.
const MOST_ON_TERMINAL: usize = 16 << 10;

/// Results alone are printed.
static QUIET: AtomicBool = AtomicBool::new(false);
/// Details are told.
static VERBOSE: AtomicBool = AtomicBool::new(false);

/// Places of the files that were read.
static READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Has no output replace a file that is read from here on.
pub fn remember_inputs() {
    untrusted::observe(|path| {
        READ.lock().unwrap_or_else(PoisonError::into_inner).insert(place(path));
    });
}

/// Refuses a place where a file was read, however it is named.
pub fn check_unread(path: &Path) -> Result<()> {
    let read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    if read.contains(&place(path)) { Err(is_input(path)) } else { Ok(()) }
}

fn is_input(path: &Path) -> anyhow::Error {
    anyhow!("{} is one of the files that are read; write to another one", path.display())
}

/// File to be written, or stdout.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputPath(PathBuf);

impl OutputPath {
    pub fn is_stdout(&self) -> bool {
        is_stdout(&self.0)
    }
}

impl From<OsString> for OutputPath {
    fn from(path: OsString) -> Self {
        Self(path.into())
    }
}

impl Deref for OutputPath {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// Error of a closed stdout: nothing else is wanted.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("stdout was closed")]
pub struct ClosedPipe;

/// Sets what is printed: `quiet` leaves out texts of [`say`] and progress bars, `verbose` adds
/// those of [`detail`].
pub fn set_verbosity(quiet: bool, verbose: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
    VERBOSE.store(verbose, Ordering::Relaxed);
}

/// Is only what was asked for printed?
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Writes results to stdout, without what a terminal obeys in names of others; [`ClosedPipe`] where
/// nobody reads it any more (`| head`).
pub fn print(text: &str) -> Result<()> {
    print_bytes(printable(text).as_bytes())
}

/// Writes a note for people to stderr, unless they want none.
pub fn note(text: &str) {
    if !is_quiet() {
        tell(text);
    }
}

/// The same, but for notes that were written before.
pub fn note_once(text: &str) {
    static WRITTEN: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    if WRITTEN.lock().unwrap_or_else(PoisonError::into_inner).insert(text.to_owned()) {
        note(text);
    }
}

/// Writes a line to stderr; where nobody reads it, it is dropped.
pub fn tell(text: &str) {
    let _ = writeln!(io::stderr(), "{}", printable(text));
}

/// Do people read stdout?
pub fn is_terminal() -> bool {
    io::stdout().is_terminal()
}

/// Refuses what is too long for a terminal, or no text.
fn check_for_terminal(is_terminal: bool, contents: &[u8]) -> Result<()> {
    let is_text = core::str::from_utf8(contents).is_ok() && !contents.contains(&0);
    if is_terminal && (contents.len() > MOST_ON_TERMINAL || !is_text) {
        bail!(
            "{} bytes for stdout, which is a terminal; give a file in place of \"-\", or a pipe",
            contents.len()
        );
    }
    Ok(())
}

/// Writes a note for people to stdout, unless they want none.
pub fn say(text: &str) -> Result<()> {
    if is_quiet() { Ok(()) } else { print(text) }
}

/// Tells on stderr what a command takes and does, where that is asked for.
pub fn detail(text: impl FnOnce() -> String) {
    if VERBOSE.load(Ordering::Relaxed) {
        tell(&text());
    }
}

fn print_bytes(bytes: &[u8]) -> Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(bytes).and_then(|()| stdout.flush()).map_err(|error| match error.kind() {
        io::ErrorKind::BrokenPipe => ClosedPipe.into(),
        _ => error.into(),
    })
}

/// Place of a file however it is named: links followed, as far as it is there.
pub fn place(path: &Path) -> PathBuf {
    let mut path = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        if let Ok(place) = path.canonicalize() {
            return place;
        }
        // A link to what is not there yet.
        let Ok(target) = fs::read_link(&path) else { break };
        path = folder_of(&path).join(target);
    }
    let name = path.file_name().zip(folder_of(&path).canonicalize().ok());
    name.map(|(name, folder)| folder.join(name)).unwrap_or(path)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Refuses outputs that are among the files that a command found for itself and reads.
pub fn spare<'a>(
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<()> {
    let mut outputs = outputs.into_iter().peekable();
    if outputs.peek().is_none() {
        return Ok(());
    }
    // All pairs of a recording are in one file.
    let inputs: HashSet<&Path> = inputs.into_iter().collect();
    let inputs: HashSet<PathBuf> = inputs.into_iter().map(place).collect();
    match outputs.find(|path| inputs.contains(&place(path))) {
        Some(path) => Err(is_input(path)),
        None => Ok(()),
    }
}

/// Files that are written beside their destinations first and renamed together at the end.
#[derive(Debug, Default)]
pub struct OutputFiles {
    staged: Vec<(NamedTempFile, PathBuf)>,
    /// Devices and pipes cannot be renamed onto; they are written last.
    direct: Vec<(PathBuf, Vec<u8>)>,
    stdout: Option<Vec<u8>>,
    repairs: bool,
}

impl OutputFiles {
    pub fn new() -> Self {
        Self::default()
    }

    /// Files that replace those that were read, because these are not as they should be.
    pub fn of_repair() -> Self {
        Self { repairs: true, ..Self::default() }
    }

    /// Writes one file's contents to a temporary file in the destination's folder, or keeps them
    /// for stdout.
    pub fn add(&mut self, path: &Path, contents: &[u8]) -> Result<()> {
        if is_stdout(path) {
            check_for_terminal(is_terminal(), contents)?;
            self.stdout = Some(contents.to_vec());
            return Ok(());
        }
        self.stage(path, contents).map_err(|error| cannot_write(path, &error))
    }

    /// The same of contents that are made only if they are asked for.
    pub fn add_made<T: AsRef<[u8]>>(
        &mut self,
        path: Option<&OutputPath>,
        contents: impl FnOnce() -> Result<T>,
    ) -> Result<()> {
        path.map_or(Ok(()), |path| self.add(path, contents()?.as_ref()))
    }

    /// The same of a value as indented JSON.
    pub fn add_json(&mut self, path: Option<&OutputPath>, value: &impl Serialize) -> Result<()> {
        self.add_made(path, || Ok(serde_json::to_string_pretty(value)? + "\n"))
    }

    fn stage(&mut self, path: &Path, contents: &[u8]) -> io::Result<()> {
        match fs::metadata(path) {
            Ok(there) if there.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(there) if !there.is_file() => {
                self.direct.push((path.to_path_buf(), contents.to_vec()));
                return Ok(());
            }
            _ => {}
        }
        let mut file = temporary_beside(&place(path))?;
        file.write_all(contents)?;
        detail(|| format!("{}: {} bytes", path.display(), contents.len()));
        self.staged.push((file, path.to_path_buf()));
        Ok(())
    }

    /// Puts every file in its place, and what is for stdout there.
    pub fn commit(self) -> Result<()> {
        for (_, path) in self.staged.iter().filter(|_| !self.repairs) {
            check_unread(path)?;
        }
        for (file, path) in self.staged {
            file.persist(place(&path)).map_err(|error| cannot_write(&path, &error.error))?;
        }
        for (path, contents) in self.direct {
            let write = || File::options().write(true).open(&path)?.write_all(&contents);
            write().map_err(|error| cannot_write(&path, &error))?;
        }
        self.stdout.map_or(Ok(()), |contents| print_bytes(&contents))
    }

    /// The same; then a note for people on stdout, unless a file went there.
    pub fn commit_and_say(self, text: &str) -> Result<()> {
        let is_free = self.stdout.is_none();
        self.commit()?;
        if is_free { say(text) } else { Ok(()) }
    }

    /// The same; then the results that were asked for on stdout, between notes for people, unless a
    /// file went there.
    pub fn commit_and_tell(self, before: &str, results: &str, after: &str) -> Result<()> {
        let is_free = self.stdout.is_none();
        self.commit()?;
        match is_free {
            true if is_quiet() => print(results),
            true => print(&[before, results, after].concat()),
            false => Ok(()),
        }
    }

    /// The same of a summary that is a result only where no file is written.
    pub fn commit_and_sum_up(self, before: &str, summary: &str, after: &str) -> Result<()> {
        if self.staged.is_empty() && self.direct.is_empty() {
            self.commit_and_tell(before, summary, after)
        } else {
            self.commit_and_say(&[before, summary, after].concat())
        }
    }
}

/// A file that grows line by line beside its destination, and appears there when it is whole.
#[derive(Debug)]
pub struct LineFile {
    file: io::BufWriter<File>,
    /// Its temporary name; none for devices and pipes.
    temporary: Option<TempPath>,
    path: PathBuf,
}

impl LineFile {
    pub fn new(path: &Path) -> Result<Self> {
        check_unread(path)?;
        let open = || match fs::metadata(path) {
            Ok(there) if there.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
            Ok(there) if !there.is_file() => Ok((File::options().write(true).open(path)?, None)),
            _ => temporary_beside(&place(path))
                .map(|file| file.into_parts())
                .map(|(file, name)| (file, Some(name))),
        };
        let (file, temporary) = open().map_err(|error| cannot_write(path, &error))?;
        temporary.iter().for_each(|name| interruption::remove_at_once(name));
        Ok(Self { file: io::BufWriter::new(file), temporary, path: path.to_path_buf() })
    }

    /// Puts it in its place.
    pub fn commit(self) -> Result<()> {
        let Self { mut file, temporary, path } = self;
        check_unread(&path)?;
        file.flush().map_err(|error| cannot_write(&path, &error))?;
        let persist = |name: TempPath| {
            name.persist(place(&path)).map_err(|error| cannot_write(&path, &error.error))
        };
        temporary.map_or(Ok(()), persist)
    }
}

impl Write for LineFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Samples as the bytes of a PNG file; those of 16 bits are in the machine's byte order.
pub(crate) fn png_file(
    samples: &[u8],
    [width, height]: [u32; 2],
    colour: ExtendedColorType,
) -> ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(samples, width, height, colour)?;
    Ok(bytes)
}

fn temporary_beside(path: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    if let Some(permissions) = ordinary_permissions() {
        builder.permissions(permissions);
    }
    builder.prefix(".linestereo-").tempfile_in(folder_of(path))
}

/// Only the kind: the error itself names the temporary file, which nobody asked for.
pub(crate) fn cannot_write(path: &Path, error: &io::Error) -> anyhow::Error {
    let why = match error.kind() {
        io::ErrorKind::NotFound => "its folder does not exist".to_owned(),
        kind => kind.to_string(),
    };
    anyhow!(
        "cannot write {}: {why}; choose a file in a folder that exists and is writable",
        path.display()
    )
}

/// Temporary files are private by default; results are for everybody the umask allows.
#[cfg(unix)]
fn ordinary_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn ordinary_permissions() -> Option<Permissions> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_gets_no_flood_and_no_bytes() {
        for (is_terminal, contents, is_right) in [
            (true, vec![b'x'; MOST_ON_TERMINAL], true),
            (true, vec![b'x'; MOST_ON_TERMINAL + 1], false),
            (true, vec![0xff, 0xfe], false),
            (true, vec![b'x', 0], false),
            (false, vec![0; 2 * MOST_ON_TERMINAL], true),
        ] {
            assert_eq!(
                check_for_terminal(is_terminal, &contents).is_ok(),
                is_right,
                "{is_terminal} {}",
                contents.len()
            );
        }
    }

    #[test]
    fn files_appear_together_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let good = folder.path().join("good.txt");
        let mut output = OutputFiles::new();
        output.add(&good, b"x").unwrap();
        assert!(output.add(&folder.path().join("missing/bad.txt"), b"y").is_err());
        drop(output);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);

        let mut output = OutputFiles::new();
        output.add(&good, b"x").unwrap();
        output.commit().unwrap();
        assert_eq!(fs::read(&good).unwrap(), b"x");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
