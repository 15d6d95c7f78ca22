//! The scores of one data set, scene by scene, in one state of its images.

use super::cells::{self, Cells};
use super::classes::{self, SeenByClass};
use super::data_set::{DataSet, Known, Room, SceneFolder};
use super::figures::Group;
use super::objects::{self, Objects};
use super::opencv::{Answer, PairRequest, Request};
use super::reliability::Reliability;
use super::sectors::Sectors;
use super::seen::{self, Seen};
use anyhow::Result;
use std::path::Path;

/// Damages of images before they are matched; the first one is none.
pub(crate) const DAMAGES: [&str; 5] = ["none", "noise2", "noise5", "blur1", "gain"];

/// A data set in one state of its images.
#[derive(Clone, Debug)]
pub(crate) struct Task<'a> {
    pub(crate) set: &'a DataSet,
    /// Of [`DAMAGES`].
    pub(crate) damage: &'static str,
}

/// Scores of the scenes so far.
#[derive(Debug, Default)]
pub(crate) struct Scores {
    scenes: usize,
    cells: Cells,
    cells_sgbm: Cells,
    /// Of linestereo, SGBM and BM.
    seen: [Vec<Seen>; 3],
    classes: [SeenByClass; 3],
    reliability: Reliability,
    objects: Option<Objects>,
    sectors: Option<Sectors>,
}

impl Task<'_> {
    /// A measure of how long it takes: bytes of the images times disparities.
    pub(crate) fn cost(&self) -> u64 {
        let of = |scene: &SceneFolder| {
            let bytes = scene.stored.left().metadata().map_or(0, |file| file.len());
            bytes * u64::from(scene.likely_range())
        };
        self.set.scenes.iter().map(of).sum()
    }

    /// Is more scored than cells?
    fn is_whole(&self) -> bool {
        self.damage == DAMAGES[0]
    }

    /// Request to OpenCV.
    pub(crate) fn request(
        &self,
        scenes: &[(&SceneFolder, Known)],
        cache: Option<&Path>,
    ) -> Request {
        let pair = |(scene, known): &(&SceneFolder, Known)| {
            let [left, right] = scene.stored.images.paths().map(Path::to_path_buf);
            PairRequest { left, right, disparities: known.max_disparity }
        };
        Request {
            pairs: scenes.iter().map(pair).collect(),
            damage: self.damage,
            generator_per_pair: self.set.is_rooms,
            cache: cache.map(Path::to_path_buf),
        }
    }
}

impl Scores {
    /// Adds a scene. An error is that of the scene: nothing of it is counted.
    pub(crate) fn add(
        &mut self,
        task: &Task<'_>,
        scene: &SceneFolder,
        known: &Known,
        answer: Option<&Answer>,
    ) -> Result<()> {
        let range = known.max_disparity;
        let stored = &known.pair;
        let given = answer.map_or(stored, |answer| &answer.pair);
        let points = given.points(range)?;
        let stored_points = match task.is_whole() && stored != given {
            true => &stored.points(range)?,
            false => &points,
        };
        let objects = match (&known.room, scene.object_mask()) {
            (Some(room), Some(mask)) => {
                let truths = objects::truths(
                    &super::product::load_numbers(&mask)?,
                    &known.truth,
                    &room.labels,
                    &room.visible,
                );
                Some((truths, stored.objects(range, &mask)?))
            }
            _ => None,
        };
        let sectors = match (&known.room, scene.camera()) {
            (Some(room), Some(camera)) => Some((room, camera, stored.sectors(range, &camera)?)),
            _ => None,
        };

        let judged = known.judged();
        self.scenes += 1;
        self.cells.add(&points, &judged);
        self.reliability.add(&points, &judged);
        if let Some(answer) = answer {
            self.cells_sgbm.add(&answer.hypotheses, &judged);
        }
        if !task.is_whole() {
            return Ok(());
        }
        let maps = answer.map(|answer| [&answer.sgbm, &answer.bm]);
        match &known.room {
            None => {
                let cells = seen::cells(&known.truth);
                self.seen[0].push(seen::of_points(&cells, stored_points, &known.truth));
                for (scenes, map) in self.seen[1..].iter_mut().zip(maps.into_iter().flatten()) {
                    scenes.push(seen::of_map(&cells, map, &known.truth));
                }
            }
            Some(Room { labels, visible }) => {
                let cells = classes::cells(labels, visible);
                self.classes[0].add_points(&cells, stored_points, labels, &known.truth);
                for (classes, map) in self.classes[1..].iter_mut().zip(maps.into_iter().flatten()) {
                    classes.add_map(&cells, map, labels, &known.truth);
                }
            }
        }
        if let Some((truths, answers)) = objects {
            self.objects.get_or_insert_default().add(&truths, &answers);
        }
        if let Some((room, camera, said)) = sectors {
            self.sectors.get_or_insert_default().add(&known.truth, &room.labels, &camera, said);
        }
        Ok(())
    }

    /// Scenes that were scored.
    pub(crate) fn scenes(&self) -> usize {
        self.scenes
    }

    /// Figures of all scenes.
    pub(crate) fn groups(&self, task: &Task<'_>) -> Vec<Group> {
        let state = if task.is_whole() { String::new() } else { format!(", {}", task.damage) };
        let name = format!("one hypothesis per 16x16 cell{state}");
        let mut groups = vec![cells::group(&name, &self.cells, &self.cells_sgbm)];
        if task.is_whole() && task.set.is_rooms {
            groups.push(classes::group(&self.classes));
        } else if task.is_whole() {
            groups.push(seen::group(&self.seen));
        }
        groups.extend(self.objects.as_ref().map(Objects::group));
        groups.extend(self.sectors.as_ref().map(Sectors::group));
        groups.push(self.reliability.group(&format!("said against right{state}")));
        groups
    }
}
