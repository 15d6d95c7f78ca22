//! Data sets of a folder, by what they hold.
//!
//! ```text
//! FRAMES/.../SET/SCENE/scene.json     with "ground_truth": a scene of the set
//!                      left.png right.png gt.png
//!                      labels.png visible.png    a rendered room: scored by class
//!                      mask_objects.png          objects
//! "camera" in scene.json                         obstacles by direction
//! ```

use super::cells::spread;
use super::classes::GLOSSY;
use super::grid::Grid;
use super::product::{Pair, load_numbers};
use super::sectors::Camera;
use anyhow::{Context, Result, bail};
use linestereo_frames::{Dataset, Layout, SceneInfo, StoredPair, load_scene};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Disparity ranges that follow from the truth are multiples of this, and at most
/// [`LARGEST_RANGE`].
const RANGE_STEP: f64 = 16.0;
const LARGEST_RANGE: f64 = 240.0;
/// A range that suits most large images.
const LIKELY_RANGE: u16 = 160;
/// Widest images of a set that is also scored damaged.
const SMALL: usize = 320;

/// Scenes that are scored together.
#[derive(Clone, Debug)]
pub(crate) struct DataSet {
    /// Its path below the folder of all frames.
    pub(crate) name: String,
    pub(crate) scenes: Vec<SceneFolder>,
    /// Rendered rooms with labels.
    pub(crate) is_rooms: bool,
}

/// One scene.
#[derive(Clone, Debug)]
pub(crate) struct SceneFolder {
    pub(crate) stored: StoredPair,
    info: SceneInfo,
}

/// A scene's images and truth, and what else is known of its pixels.
#[derive(Clone, Debug)]
pub(crate) struct Known {
    /// As the program reads it: of colours it makes other grey values than OpenCV.
    pub(crate) pair: Pair,
    /// Disparities, px; not a number where they are unknown.
    pub(crate) truth: Grid<f64>,
    pub(crate) max_disparity: u16,
    /// Of a rendered room.
    pub(crate) room: Option<Room>,
}

/// Pixels of a rendered room.
#[derive(Clone, Debug)]
pub(crate) struct Room {
    pub(crate) labels: Grid<u8>,
    pub(crate) visible: Grid<bool>,
}

/// Every data set below a folder, in the order of their names.
pub(crate) fn find(frames: &Path) -> Result<Vec<DataSet>> {
    let mut sets = BTreeMap::<PathBuf, Vec<SceneFolder>>::new();
    for stored in Dataset::find(frames)?.pairs {
        let is_scene = stored.layout == Layout::SceneJson && stored.has_truth();
        let above = stored.folder.parent().filter(|set| is_scene && set.starts_with(frames));
        if let (Some(set), Some((_, info))) = (above, stored.info()?) {
            let scenes = sets.entry(set.to_path_buf()).or_default();
            scenes.push(SceneFolder { stored, info });
        }
    }
    if sets.is_empty() {
        bail!(
            "{} holds no scenes with ground truth; give a folder of sets, whose scenes have left.png, right.png, gt.png \
             and a scene.json with \"ground_truth\"",
            frames.display()
        );
    }
    let data_set = |(folder, mut scenes): (PathBuf, Vec<SceneFolder>)| {
        let is_rooms = scenes.iter().any(SceneFolder::is_room);
        scenes.retain(|scene| scene.is_room() == is_rooms);
        let below = folder.strip_prefix(frames).unwrap_or(&folder);
        let name = if below == Path::new("") { frames } else { below };
        DataSet { name: name.display().to_string(), scenes, is_rooms }
    };
    Ok(sets.into_iter().map(data_set).collect())
}

impl DataSet {
    /// Small sets without labels are scored damaged too; rendered rooms have noise of their own.
    pub(crate) fn is_damaged_too(&self) -> bool {
        let first = self.scenes.first().filter(|_| !self.is_rooms);
        first.and_then(|first| first.known().ok()).is_some_and(|known| known.truth.width() <= SMALL)
    }
}

impl SceneFolder {
    /// The folder's name.
    pub(crate) fn name(&self) -> String {
        self.stored.folder.file_name().unwrap_or_default().display().to_string()
    }

    /// Disparities that are searched, as far as it is said.
    fn range(&self) -> Option<u16> {
        Some(self.info.max_disparity?.round() as u16)
    }

    /// Disparities that are searched, before the truth is read.
    pub(crate) fn likely_range(&self) -> u16 {
        self.range().unwrap_or(LIKELY_RANGE)
    }

    /// A file beside its images.
    fn file(&self, name: &str) -> Option<PathBuf> {
        Some(self.stored.folder.join(name)).filter(|path| path.is_file())
    }

    fn is_room(&self) -> bool {
        self.file("labels.png").is_some()
    }

    /// The label image of its objects.
    pub(crate) fn object_mask(&self) -> Option<PathBuf> {
        self.file("mask_objects.png")
    }

    /// Geometry and place of its camera.
    pub(crate) fn camera(&self) -> Option<Camera> {
        let (rig, pose) = (self.info.rig_numbers(1.0)?, self.info.pose()?);
        Some(Camera { rig, pose, centre: self.info.principal_point(1.0) })
    }

    /// Reads its images and its truth.
    pub(crate) fn known(&self) -> Result<Known> {
        let scene = load_scene(&self.stored.folder, None)?;
        let truth = scene.truth.as_ref().context("it has no ground truth")?;
        let pair = Pair::new(&self.stored.images, [scene.left, scene.right])?;
        let truth =
            pair.left.map(|x, y| truth.disparity(x as i32, y as i32).map_or(f64::NAN, f64::from));
        let room = if self.is_room() { Some(self.room()?) } else { None };
        let max_disparity = self.range().unwrap_or_else(|| range_of(&truth));
        pair.check(max_disparity)?;
        Ok(Known { pair, truth, max_disparity, room })
    }

    fn room(&self) -> Result<Room> {
        let labels = load_numbers(&self.stored.folder.join("labels.png"))?;
        let visible = load_numbers(&self.stored.folder.join("visible.png"))?;
        Ok(Room {
            labels: labels.map(|x, y| u8::try_from(labels.at(x, y)).unwrap_or(0)),
            visible: visible.map(|x, y| visible.at(x, y) > 0),
        })
    }
}

impl Known {
    /// Truth for hypotheses of cells: sparse one spread, nothing where something shines.
    pub(crate) fn judged(&self) -> Grid<f64> {
        match &self.room {
            None => spread(&self.truth),
            Some(room) => self.truth.map(|x, y| match room.labels.at(x, y) {
                GLOSSY => f64::NAN,
                _ => self.truth.at(x, y),
            }),
        }
    }
}

/// Disparities to search, by the largest one that there is.
fn range_of(truth: &Grid<f64>) -> u16 {
    let largest = truth.values().iter().copied().fold(f64::NAN, f64::max);
    ((((largest + 2.0) / RANGE_STEP).floor() * RANGE_STEP) + RANGE_STEP).min(LARGEST_RANGE) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn the_range_reaches_beyond_the_largest_truth() {
        let of = |largest: f64| range_of(&Grid::new(2, vec![f64::NAN, largest]));
        assert_eq!([13.9, 14.0, 45.0, 229.0, 500.0].map(of), [16, 32, 48, 240, 240]);
    }

    #[test]
    fn sets_are_found_by_their_scenes() {
        let root = tempfile::tempdir().unwrap();
        for (name, info) in
            [("b/1", r#"{"ground_truth":{"file":"gt.png","disparity_scale":4}}"#), ("a/x/1", "{}")]
        {
            let folder = root.path().join(name);
            fs::create_dir_all(&folder).unwrap();
            for (file, content) in [("left.png", ""), ("right.png", ""), ("scene.json", info)] {
                fs::write(folder.join(file), content).unwrap();
            }
        }
        let sets = find(root.path()).unwrap();
        assert_eq!(sets.iter().map(|set| set.name.as_str()).collect::<Vec<_>>(), ["b"]);
        assert!(!sets[0].is_rooms);
        let empty = find(&root.path().join("a")).unwrap_err().to_string();
        assert!(empty.contains("holds no scenes with ground truth"), "{empty}");
    }
}
