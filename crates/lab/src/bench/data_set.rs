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
use super::product::load_numbers;
use super::sectors::Camera;
use anyhow::{Context, Result, bail};
use linestereo_frames::untrusted;
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders below that of the frames in which sets are looked for.
const DEPTH: usize = 4;
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
    folder: PathBuf,
    info: Info,
}

#[derive(Clone, Debug, Deserialize)]
struct Info {
    max_disparity: Option<u16>,
    ground_truth: Option<GroundTruth>,
    rectified: Option<Rectified>,
    camera: Option<Placement>,
}

#[derive(Clone, Debug, Deserialize)]
struct GroundTruth {
    file: String,
    disparity_scale: f64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
struct Rectified {
    focal_px: f64,
    baseline_m: f64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
struct Placement {
    height_m: f64,
    pitch_deg: f64,
    /// Counter-clockwise as it looks.
    #[serde(default)]
    roll_deg: f64,
    principal_px: Option<[f64; 2]>,
}

/// Truth of a scene and what else is known of its pixels.
#[derive(Clone, Debug)]
pub(crate) struct Known {
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
    let mut sets = Vec::new();
    search(frames, frames, DEPTH, &mut sets)?;
    if sets.is_empty() {
        bail!(
            "{} holds no scenes with ground truth; give a folder of sets, whose scenes have left.png, right.png, gt.png \
             and a scene.json with \"ground_truth\"",
            frames.display()
        );
    }
    Ok(sets)
}

fn search(root: &Path, folder: &Path, depth: usize, sets: &mut Vec<DataSet>) -> Result<()> {
    let entries = fs::read_dir(folder)
        .with_context(|| format!("cannot read {}; check the path", folder.display()))?;
    let mut folders: Vec<PathBuf> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|at| at.is_dir()).collect();
    folders.sort_unstable();
    let mut scenes = Vec::new();
    for at in &folders {
        scenes.extend(SceneFolder::open(at)?);
    }
    let is_rooms = scenes.iter().any(SceneFolder::is_room);
    scenes.retain(|scene| scene.is_room() == is_rooms);
    if !scenes.is_empty() {
        let below = folder.strip_prefix(root).unwrap_or(folder);
        let name = if below == Path::new("") { root } else { below };
        sets.push(DataSet { name: name.display().to_string(), scenes, is_rooms });
    } else if depth > 0 {
        folders.iter().try_for_each(|at| search(root, at, depth - 1, sets))?;
    }
    Ok(())
}

impl DataSet {
    /// Small sets without labels are scored damaged too; rendered rooms have noise of their own.
    pub(crate) fn is_damaged_too(&self) -> Result<bool> {
        let Some(first) = self.scenes.first().filter(|_| !self.is_rooms) else { return Ok(false) };
        let truth = first.known()?.truth;
        Ok(truth.width() <= SMALL)
    }
}

impl SceneFolder {
    /// `None` where a folder is no scene with ground truth.
    fn open(folder: &Path) -> Result<Option<Self>> {
        let path = folder.join("scene.json");
        if !path.is_file() {
            return Ok(None);
        }
        let text = untrusted::read(&path, untrusted::SETTINGS_BYTES)
            .with_context(|| format!("cannot read {}", path.display()))?;
        let info: Info = serde_json::from_slice(&text).with_context(|| {
            format!("{} is not understood; correct it, or move the folder away", path.display())
        })?;
        let scene = Self { folder: folder.to_path_buf(), info };
        Ok(Some(scene).filter(|scene| scene.info.ground_truth.is_some() && scene.images().is_ok()))
    }

    /// The folder's name.
    pub(crate) fn name(&self) -> String {
        self.folder.file_name().unwrap_or_default().display().to_string()
    }

    /// Disparities that are searched, before the truth is read.
    pub(crate) fn likely_range(&self) -> u16 {
        self.info.max_disparity.unwrap_or(LIKELY_RANGE)
    }

    fn is_room(&self) -> bool {
        self.folder.join("labels.png").is_file()
    }

    /// Files of the left and the right image.
    pub(crate) fn images(&self) -> Result<[PathBuf; 2]> {
        let kinds = ["png", "jpg", "jpeg", "pgm", "ppm", "tif", "tiff", "bmp"];
        let find = |side: &str| {
            kinds
                .map(|kind| self.folder.join(side).with_extension(kind))
                .into_iter()
                .find(|at| at.is_file())
        };
        match (find("left"), find("right")) {
            (Some(left), Some(right)) => Ok([left, right]),
            _ => bail!("{} has no left.png and right.png", self.folder.display()),
        }
    }

    /// The label image of its objects.
    pub(crate) fn object_mask(&self) -> Option<PathBuf> {
        Some(self.folder.join("mask_objects.png")).filter(|path| path.is_file())
    }

    /// Geometry and place of its camera.
    pub(crate) fn camera(&self) -> Option<Camera> {
        let (rectified, placed) = (self.info.rectified?, self.info.camera?);
        Some(Camera {
            focal_px: rectified.focal_px,
            baseline_m: rectified.baseline_m,
            height_m: placed.height_m,
            pitch_deg: placed.pitch_deg,
            roll_deg: -placed.roll_deg,
            centre: placed.principal_px,
        })
    }

    /// Reads its truth.
    pub(crate) fn known(&self) -> Result<Known> {
        let Some(GroundTruth { file, disparity_scale }) = &self.info.ground_truth else {
            bail!("{} has no ground truth", self.folder.display())
        };
        let stored = load_numbers(&self.folder.join(file))?;
        let truth = stored.map(|x, y| match stored.at(x, y) {
            0 => f64::NAN,
            value => f64::from(value) / disparity_scale,
        });
        let room = if self.is_room() { Some(self.room()?) } else { None };
        let max_disparity = self.info.max_disparity.unwrap_or_else(|| range_of(&truth));
        Ok(Known { truth, max_disparity, room })
    }

    fn room(&self) -> Result<Room> {
        let labels = load_numbers(&self.folder.join("labels.png"))?;
        let visible = load_numbers(&self.folder.join("visible.png"))?;
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
