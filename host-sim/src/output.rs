//! Output files: all of a command's files appear, whole, or none does.

use anyhow::{Result, anyhow};
use serde::Serialize;
use std::fs::{self, File, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Files that are written beside their destinations first and renamed together at the end.
#[derive(Debug, Default)]
pub struct OutputFiles {
    staged: Vec<(NamedTempFile, PathBuf)>,
    /// Devices and pipes cannot be renamed onto; they are written last.
    direct: Vec<(PathBuf, Vec<u8>)>,
}

impl OutputFiles {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Writes one file's contents to a temporary file in the destination's folder.
    pub fn add(&mut self, path: &Path, contents: &[u8]) -> Result<()> {
        self.stage(path, contents).map_err(|error| cannot_write(path, &error))
    }

    /// The same of a listing, made only if it is asked for. "-" is stdout, for which the listing is given back: print it after the files.
    pub fn add_listing(
        &mut self,
        path: Option<&Path>,
        listing: impl FnOnce() -> serde_json::Result<String>,
    ) -> Result<Option<String>> {
        let Some(path) = path else { return Ok(None) };
        let listing = listing()?;
        if path == Path::new("-") {
            return Ok(Some(listing));
        }
        self.add(path, listing.as_bytes())?;
        Ok(None)
    }

    /// The same of a value as indented JSON.
    pub fn add_json(&mut self, path: Option<&Path>, value: &impl Serialize) -> Result<Option<String>> {
        self.add_listing(path, || Ok(serde_json::to_string_pretty(value)? + "\n"))
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
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        if let Some(permissions) = ordinary_permissions() {
            builder.permissions(permissions);
        }
        let mut file = builder.prefix(".linestereo-").tempfile_in(folder)?;
        file.write_all(contents)?;
        self.staged.push((file, path.to_path_buf()));
        Ok(())
    }

    /// Puts every file in its place.
    pub fn commit(self) -> Result<()> {
        for (file, path) in self.staged {
            file.persist(&path).map_err(|error| cannot_write(&path, &error.error))?;
        }
        for (path, contents) in self.direct {
            let write = || File::options().write(true).open(&path)?.write_all(&contents);
            write().map_err(|error| cannot_write(&path, &error))?;
        }
        Ok(())
    }
}

/// A file that grows line by line beside its destination, and appears there when it is whole.
#[derive(Debug)]
pub struct LineFile {
    file: io::BufWriter<NamedTempFile>,
    path: PathBuf,
}

impl LineFile {
    /// Nothing yet.
    pub fn new(path: &Path) -> Result<Self> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        if let Some(permissions) = ordinary_permissions() {
            builder.permissions(permissions);
        }
        let file = builder.prefix(".linestereo-").tempfile_in(folder).map_err(|error| cannot_write(path, &error))?;
        Ok(Self { file: io::BufWriter::new(file), path: path.to_path_buf() })
    }

    /// More of it.
    pub fn push(&mut self, text: &str) -> Result<()> {
        self.file.write_all(text.as_bytes()).map_err(|error| cannot_write(&self.path, &error))
    }

    /// Puts it in its place.
    pub fn commit(self) -> Result<()> {
        let Self { file, path } = self;
        let file = file.into_inner().map_err(|error| cannot_write(&path, error.error()))?;
        file.persist(&path).map_err(|error| cannot_write(&path, &error.error))?;
        Ok(())
    }
}

/// Only the kind: the error itself names the temporary file, which nobody asked for.
fn cannot_write(path: &Path, error: &io::Error) -> anyhow::Error {
    anyhow!("cannot write {}: {}; choose a file in a folder that exists and is writable", path.display(), error.kind())
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
