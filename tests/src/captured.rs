//! Captured frames with ground truth, which are not part of the project: `LINESTEREO_FRAMES`, or `../shared/frames` beside it.

use linestereo_sim::frames::{Scene, find_scenes, load_scene};
use std::path::PathBuf;

/// A folder of captured frames; without them the test that asks says so and passes.
#[must_use]
pub fn folder(name: &str) -> Option<PathBuf> {
    let root = std::env::var_os("LINESTEREO_FRAMES")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/frames"), PathBuf::from);
    let folder = root.join(name);
    if !folder.is_dir() {
        eprintln!("SKIPPED: no captured frames; set LINESTEREO_FRAMES to a folder that holds {name}/");
        return None;
    }
    Some(folder)
}

/// The scoring set: every scene of `qvga`.
///
/// # Panics
/// When one of them cannot be loaded.
#[must_use]
pub fn qvga() -> Option<Vec<Scene>> {
    let load = |folder: &PathBuf| load_scene(folder, None).unwrap_or_else(|error| panic!("{error}"));
    let folders = find_scenes(&folder("qvga")?).unwrap_or_else(|error| panic!("{error}"));
    Some(folders.iter().map(load).collect())
}
