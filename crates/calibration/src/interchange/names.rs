//! Finding values in OpenCV's files, whose names are habits: `M1`, `cameraMatrix1`, `K_left`,
//! `camera_matrix` in two files, `left: { K }`.
//!
//! Capitals and punctuation do not count; names of nested maps stand before those in them. A value
//! may be found several times if it is the same, else it is ambiguous.

use super::error::{Fault, Place, Problem};
use super::node::{Matrix, Node, Value};
use linestereo::Dims;

/// How left and right are told apart.
const EYES: [[&str; 2]; 4] = [["left", "right"], ["l", "r"], ["1", "2"], ["0", "1"]];

/// A value and the name it stands under.
#[derive(Clone, Debug)]
pub(super) struct Found<'a> {
    pub(super) name: String,
    pub(super) node: &'a Node,
    /// The name without capitals and punctuation.
    key: String,
}

pub(super) struct Names<'a>(Vec<Found<'a>>);

impl<'a> Names<'a> {
    pub(super) fn of(files: &'a [Node]) -> Self {
        let mut found = Vec::new();
        for file in files {
            gather(file, "", "", &mut found);
        }
        Self(found)
    }

    /// The matrices of both cameras; `what` they are for messages.
    pub(super) fn pair(&self, what: &str, stems: &[&str]) -> Result<Option<[Found<'a>; 2]>, Fault> {
        let mut pairs = Vec::new();
        let mut alone = None;
        for eyes in EYES {
            let [left, right] = eyes.map(|eye| self.one(|key| is_tagged(key, stems, eye)));
            match (left?, right?) {
                (Some(left), Some(right)) => pairs.push([left, right]),
                (None, None) => {}
                (one, other) => alone = alone.or(one).or(other),
            }
        }
        let mut bare = self.matrices(|key| stems.contains(&key));
        match (pairs.pop(), bare.as_mut_slice(), alone) {
            (Some(pair), _, _) if pairs.is_empty() => Ok(Some(pair)),
            (Some([Found { name, node, .. }, _]), _, _) => {
                let other = &pairs[0][0].name;
                Err(Problem::Ambiguous(format!("{what} could be {other} or {name}")).at(node.place))
            }
            // One camera for each file, the left one first.
            (None, [left, right], _) if left.node.place.file < right.node.place.file => {
                Ok(Some([left.clone(), right.clone()]))
            }
            (None, [one], _) if what.starts_with("camera") => {
                let name = &one.name;
                let what = format!(
                    "there is only one camera ({name}); give the files of both, the left one first"
                );
                Err(Problem::Missing(what).at(one.node.place))
            }
            (None, [], Some(one)) if what.starts_with("camera") => {
                let what = format!("there is {} but none for the other camera; add it", one.name);
                Err(Problem::Missing(what).at(one.node.place))
            }
            _ => Ok(None),
        }
    }

    /// The matrix that belongs to both cameras together.
    pub(super) fn single(&self, stems: &[&str]) -> Result<Option<Found<'a>>, Fault> {
        self.one(|key| stems.contains(&key))
    }

    /// The first text of one of these names.
    pub(super) fn word(&self, stems: &[&str]) -> Option<&Found<'a>> {
        self.0.iter().find(|found| found.node.text().is_some() && is_named(&found.key, stems))
    }

    /// The size of the images, wherever it stands.
    pub(super) fn size(&self) -> Result<Option<(Dims, Place)>, Fault> {
        let mut size: Option<(Dims, Place)> = None;
        for found in &self.0 {
            let Some(dims) = self.size_at(found)? else { continue };
            match size {
                Some((first, _)) if first != dims => {
                    let what = format!("{dims} here and {first} elsewhere");
                    return Err(Problem::Size(what).at(found.node.place));
                }
                _ => size = size.or(Some((dims, found.node.place))),
            }
        }
        Ok(size)
    }

    fn size_at(&self, found: &Found<'a>) -> Result<Option<Dims>, Fault> {
        let Found { name, node, key } = found;
        let pair = ["imagesize", "size", "imgsize", "framesize", "resolution"];
        if node.is_matrix() && is_named(key, &pair) {
            return size(node, name).map(Some);
        }
        if node.text().is_none()
            || !is_named(key, &["imagewidth", "width", "imgwidth", "framewidth"])
        {
            return Ok(None);
        }
        let other = key.replace("width", "height");
        let height = self
            .0
            .iter()
            .find(|found| found.key == other && found.node.place.file == node.place.file);
        let height = height.ok_or_else(|| {
            Problem::Missing(format!("there is {name} but no height")).at(node.place)
        })?;
        Ok(Some(Dims { width: node.whole(name)?, height: height.node.whole(&height.name)? }))
    }

    fn matrices(&self, is_meant: impl Fn(&str) -> bool) -> Vec<Found<'a>> {
        self.0
            .iter()
            .filter(|found| found.node.is_matrix() && is_meant(&found.key))
            .cloned()
            .collect()
    }

    /// The only value among those meant; several are one if they say the same.
    fn one(&self, is_meant: impl Fn(&str) -> bool) -> Result<Option<Found<'a>>, Fault> {
        let found = self.matrices(is_meant);
        let Some((first, others)) = found.split_first() else { return Ok(None) };
        if !others.is_empty() {
            let matrix =
                |found: &Found<'_>| -> Result<Matrix, Fault> { found.node.matrix(&found.name) };
            let value = matrix(first)?;
            for other in others {
                if !matrix(other)?.same_values(&value) {
                    let what = format!(
                        "{} and {} (line {}) differ",
                        other.name, first.name, first.node.place.line
                    );
                    return Err(Problem::Ambiguous(what).at(other.node.place));
                }
            }
        }
        Ok(Some(first.clone()))
    }
}

/// Width and height as a list or matrix of two.
pub(super) fn size(node: &Node, name: &str) -> Result<Dims, Fault> {
    let [width, height] = node.matrix(name)?.vector_of::<2>()?;
    let side = |value: f64| {
        (value.fract() == 0.0 && (1.0..=f64::from(u16::MAX)).contains(&value))
            .then_some(value as u16)
    };
    match (side(width), side(height)) {
        (Some(width), Some(height)) => Ok(Dims { width, height }),
        _ => Err(Problem::Size(format!("{width}x{height}")).at(node.place)),
    }
}

fn gather<'a>(node: &'a Node, outer_name: &str, outer_key: &str, found: &mut Vec<Found<'a>>) {
    let Value::Map(entries) = &node.value else { return };
    for (name, node) in entries {
        let key: String = name
            .chars()
            .filter(char::is_ascii_alphanumeric)
            .map(|c| c.to_ascii_lowercase())
            .collect();
        let (key, name) = (format!("{outer_key}{key}"), format!("{outer_name}{name}"));
        if matches!(node.value, Value::Map(_)) && !node.is_matrix() {
            gather(node, &format!("{name}."), &key, found);
        } else {
            let name = name.chars().take(40).collect();
            found.push(Found { name, node, key });
        }
    }
}

/// `cameramatrix1`, `1cameramatrix`, `cam1matrix`, `matrixcamera1`: a stem with which camera it is.
fn is_tagged(key: &str, stems: &[&str], eye: &str) -> bool {
    let camera = |rest: &str| stems.contains(&rest);
    let behind = |word: &str| {
        key.strip_suffix(eye).and_then(|rest| rest.strip_suffix(word)).is_some_and(camera)
    };
    let before = |word: &str| {
        key.strip_prefix(word).and_then(|rest| rest.strip_prefix(eye)).is_some_and(camera)
    };
    ["", "cam", "camera"].into_iter().any(|word| behind(word) || before(word))
}

/// With or without which camera it is.
fn is_named(key: &str, stems: &[&str]) -> bool {
    stems.contains(&key) || EYES.as_flattened().iter().any(|eye| is_tagged(key, stems, eye))
}
