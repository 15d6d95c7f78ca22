//! Folders and the names in them: listings, images whatever their format, folders that hold a scene
//! or a pair.

use super::error::FrameError;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Endings of images that are read, in the order in which they are looked for.
pub(crate) const IMAGE_EXTENSIONS: [&str; 10] =
    ["png", "jpg", "jpeg", "pgm", "ppm", "pnm", "tif", "tiff", "bmp", "webp"];

/// Every folder at or below `root` that holds a `scene.json`, sorted.
pub fn find_scenes(root: &Path) -> Result<Vec<PathBuf>, FrameError> {
    let mut found = Vec::new();
    walk(root, |folder| {
        found.extend(folder.has("scene.json").then(|| folder.path.clone()));
        Ok(true)
    })?;
    found.sort();
    Ok(found)
}

/// Calls `visit` for a folder and, where that says so, for those below it, by name: each once,
/// whatever links lead to it.
pub(crate) fn walk(
    root: &Path,
    mut visit: impl FnMut(&Listing) -> Result<bool, FrameError>,
) -> Result<(), FrameError> {
    let (mut pending, mut seen) = (vec![root.to_path_buf()], BTreeSet::new());
    while let Some(path) = pending.pop() {
        // A link to a folder above it begins the tree anew, two of them double it at every level.
        if path.canonicalize().is_ok_and(|place| !seen.insert(place)) {
            continue;
        }
        let folder = Listing::read(&path)?;
        if visit(&folder)? {
            pending.extend(folder.folders.iter().rev().map(|name| path.join(name)));
        }
    }
    Ok(())
}

/// The image of this name in a folder, whatever its format.
pub(crate) fn image_path(folder: &Path, name: &str) -> Option<PathBuf> {
    let paths =
        IMAGE_EXTENSIONS.iter().map(|extension| folder.join(name).with_extension(extension));
    paths.into_iter().find(|path| path.is_file())
}

/// Name of a folder.
pub(crate) fn folder_name(folder: &Path) -> String {
    let name = |folder: &Path| folder.file_name().map(|name| name.to_string_lossy().into_owned());
    // "." has no name of its own.
    name(folder).or_else(|| name(&folder.canonicalize().ok()?)).unwrap_or_default()
}

/// The names in a folder.
pub(crate) struct Listing {
    pub(crate) path: PathBuf,
    pub(crate) files: BTreeSet<String>,
    pub(crate) folders: BTreeSet<String>,
}

impl Listing {
    pub(crate) fn read(path: &Path) -> Result<Self, FrameError> {
        let read_error = |error| FrameError::Read(path.to_path_buf(), error);
        let (mut files, mut folders) = (BTreeSet::new(), BTreeSet::new());
        for entry in fs::read_dir(path).map_err(read_error)? {
            let entry = entry.map_err(read_error)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            // Links are followed. Pipes and devices are nobody's frames: to open one may wait for
            // ever.
            let kind = entry.file_type().map_err(read_error)?;
            let is = |plain: bool, linked: fn(&Path) -> bool| {
                plain || (kind.is_symlink() && linked(&entry.path()))
            };
            if is(kind.is_dir(), Path::is_dir) {
                folders.insert(name);
            } else if is(kind.is_file(), Path::is_file) {
                files.insert(name);
            }
        }
        Ok(Self { path: path.to_path_buf(), files, folders })
    }

    pub(crate) fn has(&self, file: &str) -> bool {
        self.files.contains(file)
    }

    pub(crate) fn has_folder(&self, folder: &str) -> bool {
        self.folders.contains(folder)
    }

    /// The folder of this name, however it is spelt.
    pub(crate) fn folder_in_any_case(&self, folder: &str) -> Option<&str> {
        self.folders.iter().find(|name| name.eq_ignore_ascii_case(folder)).map(String::as_str)
    }

    pub(crate) fn file(&self, name: &str) -> Option<PathBuf> {
        self.has(name).then(|| self.path.join(name))
    }

    /// The image of this name, whatever its format.
    pub(crate) fn image(&self, stem: &str) -> Option<PathBuf> {
        IMAGE_EXTENSIONS.iter().find_map(|extension| self.file(&format!("{stem}.{extension}")))
    }

    /// The disparities of this name: floats before images.
    pub(crate) fn disparities(&self, stem: &str) -> Option<PathBuf> {
        ["pfm", "npz", "npy", "png", "pgm"]
            .iter()
            .find_map(|extension| self.file(&format!("{stem}.{extension}")))
    }

    /// The folder of this name below it.
    pub(crate) fn below(&self, folder: &str) -> Result<Option<Self>, FrameError> {
        self.has_folder(folder).then(|| Self::read(&self.path.join(folder))).transpose()
    }
}
