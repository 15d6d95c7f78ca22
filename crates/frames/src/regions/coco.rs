//! COCO's JSON: annotations, results, or the project's own list of boxes.
//!
//! Annotations are an object with `annotations`, and perhaps `images` and `categories`; results are
//! a list of annotations. An annotation has a `segmentation` (run lengths or polygons), else a
//! `bbox` (left, top, width, height). In a file of several images those of the one image are
//! taken whose `file_name` shares the most last parts with the path of the left image; where only
//! numbers tell images apart, there may be one image.
//!
//! # Bounds
//! Lists are told apart into their texts first and read one by one, of 1 MiB at most: a value of
//! two bytes takes up to 90 times as many.

use super::{Collector, Frame, Objects, ObjectsError, Shape, Why, read, run_length};
use crate::untrusted::SETTINGS_BYTES;
use linestereo::Dims;
use serde::Deserialize;
use serde_json::Value;
use serde_json::value::RawValue;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

#[derive(Deserialize)]
struct Image {
    id: u64,
    file_name: Option<String>,
    width: Option<u64>,
    height: Option<u64>,
}

#[derive(Deserialize)]
struct Category {
    id: u64,
    name: String,
}

/// An object of lists, none of which is read yet.
#[derive(Default, Deserialize)]
struct File<'a> {
    #[serde(borrow)]
    objects: Option<&'a RawValue>,
    #[serde(borrow)]
    annotations: Option<&'a RawValue>,
    #[serde(borrow)]
    images: Option<&'a RawValue>,
    #[serde(borrow)]
    categories: Option<&'a RawValue>,
}

pub(crate) fn load(path: &Path, frame: Frame<'_>) -> Result<Objects, ObjectsError> {
    let broken = |what: String| ObjectsError::Json(path.to_path_buf(), what);
    let bytes = read(path)?;
    let whole: &RawValue =
        serde_json::from_slice(&bytes).map_err(|error| broken(error.to_string()))?;
    let file = if whole.get().starts_with('{') {
        serde_json::from_str(whole.get()).map_err(|error| broken(error.to_string()))?
    } else {
        File { annotations: Some(whole), ..File::default() }
    };
    if let Some(objects) = file.objects {
        let list: Vec<&RawValue> = serde_json::from_str(objects.get())
            .map_err(|_| broken("\"objects\" is no list".to_owned()))?;
        return Ok(project_list(&list, frame));
    }
    let list =
        file.annotations.and_then(|list| serde_json::from_str::<Vec<&RawValue>>(list.get()).ok());
    let list = list.ok_or_else(|| broken("there is no list of annotations".to_owned()))?;
    let images: Vec<Image> = part(file.images, "images").map_err(broken)?;
    let categories: Vec<Category> = part(file.categories, "categories").map_err(broken)?;
    let names: BTreeMap<u64, String> =
        categories.into_iter().map(|category| (category.id, category.name)).collect();
    let wanted = wanted_image(path, &list, &images, frame)?;
    let is_wanted = |annotation: &&&RawValue| {
        let image = image_of(annotation);
        wanted.as_ref().is_none_or(|wanted| image.is_none_or(|image| image == *wanted))
    };
    let mut collector = Collector::new(frame);
    for annotation in list.iter().filter(is_wanted) {
        let annotation = one(annotation).unwrap_or_default();
        let category = annotation.get("category_id").and_then(Value::as_u64);
        let name = category.and_then(|id| names.get(&id).cloned());
        let unknown = name.is_none() && category.is_some() && !names.is_empty();
        let shape = shape(&annotation, frame.given);
        collector.objects.skipped.unknown_class += usize::from(unknown && shape.is_ok());
        collector.put(shape.map(|shape| (shape, name, None)));
    }
    Ok(collector.objects)
}

/// A list that may be missing.
fn part<'a, T: Deserialize<'a>>(list: Option<&'a RawValue>, name: &str) -> Result<Vec<T>, String> {
    match list {
        None => Ok(Vec::new()),
        Some(list) => {
            serde_json::from_str(list.get()).map_err(|error| format!("\"{name}\": {error}"))
        }
    }
}

/// One object of a list.
fn one(text: &RawValue) -> Option<Value> {
    (text.get().len() as u64 <= SETTINGS_BYTES).then(|| serde_json::from_str(text.get()).ok())?
}

/// Number or name of the image that an annotation belongs to.
fn image_of(annotation: &RawValue) -> Option<String> {
    #[derive(Deserialize)]
    struct Of<'a> {
        #[serde(borrow)]
        image_id: Option<&'a RawValue>,
    }
    Some(serde_json::from_str::<Of<'_>>(annotation.get()).ok()?.image_id?.get().to_owned())
}

/// The image whose objects are taken; `None` takes all.
fn wanted_image(
    path: &Path,
    list: &[&RawValue],
    images: &[Image],
    frame: Frame<'_>,
) -> Result<Option<String>, ObjectsError> {
    let left = frame.image.map_or(String::new(), |image| {
        let whole = std::path::absolute(image).unwrap_or_else(|_| image.to_path_buf());
        whole.to_string_lossy().into_owned()
    });
    let common = |image: &Image| common_parts(image.file_name.as_deref().unwrap_or(""), &left);
    let most = images.iter().map(common).max().unwrap_or(0);
    let candidates: Vec<&Image> =
        images.iter().filter(|image| most > 0 && common(image) == most).collect();
    if candidates.len() > 1 {
        let candidates = candidates.iter().filter_map(|image| image.file_name.clone()).collect();
        return Err(ObjectsError::SeveralImages {
            path: path.to_path_buf(),
            image: left,
            candidates,
        });
    }
    let named = candidates.first().copied();
    if let Some(image) = named.or(images.first().filter(|_| images.len() == 1))
        && let (Some(width), Some(height)) = (image.width, image.height)
        && (width, height) != (frame.given.width.into(), frame.given.height.into())
    {
        return Err(ObjectsError::ImageSize {
            path: path.to_path_buf(),
            size: [width, height],
            image: frame.given,
        });
    }
    if let Some(image) = named {
        return Ok(Some(image.id.to_string()));
    }
    let ids: BTreeSet<String> = list.iter().filter_map(|annotation| image_of(annotation)).collect();
    if ids.len() > 1 || images.len() > 1 {
        return Err(ObjectsError::NoSuchImage {
            path: path.to_path_buf(),
            image: left,
            images: ids.len().max(images.len()),
        });
    }
    Ok(None)
}

/// Number of last parts that two paths share. Both kinds of slashes separate parts.
fn common_parts(a: &str, b: &str) -> usize {
    let [a, b] =
        [a, b].map(|path| path.rsplit(['/', '\\']).filter(|part| !matches!(*part, "" | ".")));
    a.zip(b).take_while(|(a, b)| a == b).count()
}

fn shape(annotation: &Value, given: Dims) -> Result<Shape, Why> {
    match annotation.get("segmentation") {
        Some(Value::Object(mask)) => {
            let size = mask.get("size").and_then(numbers).ok_or(Why::BrokenMask)?;
            if size != [f64::from(given.height), f64::from(given.width)] {
                return Err(Why::MaskSize);
            }
            let counts = match mask.get("counts") {
                Some(Value::String(text)) => run_length::decompressed(text)?,
                Some(Value::Array(list)) => {
                    list.iter().map(Value::as_u64).collect::<Option<_>>().ok_or(Why::BrokenMask)?
                }
                _ => return Err(Why::BrokenMask),
            };
            Ok(Shape::RunLengths(counts))
        }
        Some(Value::Array(parts)) if !parts.is_empty() => {
            let parts = parts.iter().map(|part| {
                let corners = numbers(part)
                    .filter(|values| values.len().is_multiple_of(2))
                    .ok_or(Why::Unreadable)?;
                Ok(corners.chunks_exact(2).map(|corner| [corner[0], corner[1]]).collect())
            });
            Ok(Shape::Polygons(parts.collect::<Result<_, Why>>()?))
        }
        _ => match annotation.get("bbox").and_then(numbers).as_deref() {
            Some(&[left, top, width, height]) => {
                Ok(Shape::Box([left, top, left + width, top + height]))
            }
            _ => Err(Why::Unreadable),
        },
    }
}

/// Boxes `[x0, y0, x1, y1)` with name and label.
fn project_list(list: &[&RawValue], frame: Frame<'_>) -> Objects {
    let mut collector = Collector::new(frame);
    for object in list {
        let object = one(object).unwrap_or_default();
        let name = object.get("name").and_then(Value::as_str).map(str::to_owned);
        let label =
            object.get("label").and_then(Value::as_u64).and_then(|label| u16::try_from(label).ok());
        let borders = object
            .get("box")
            .and_then(numbers)
            .and_then(|borders| <[f64; 4]>::try_from(borders).ok());
        collector
            .put(borders.map(|borders| (Shape::Box(borders), name, label)).ok_or(Why::Unreadable));
    }
    collector.objects
}

fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Object, Pixels};
    use super::*;

    /// Left edges of the boxes that are taken for an image; box `n` is of image `n`.
    fn taken(image: &str, files: &[&str]) -> Result<Vec<u16>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        let (images, annotations): (Vec<_>, Vec<_>) = (0..)
            .zip(files)
            .map(|(id, file)| {
                let annotation = serde_json::json!({"image_id": id, "bbox": [id, 0, 5, 5]});
                (serde_json::json!({"id": id, "file_name": file}), annotation)
            })
            .unzip();
        let file = serde_json::json!({"images": images, "annotations": annotations});
        std::fs::write(&path, file.to_string()).unwrap();
        let dims = Dims { width: 40, height: 20 };
        let frame = Frame { given: dims, matched: dims, image: Some(Path::new(image)) };
        let objects = load(&path, frame).map_err(|error| error.to_string())?;
        let left = |object: &Object| match object.pixels {
            Pixels::Box(area) => area.left,
            Pixels::Mask(_) => u16::MAX,
        };
        Ok(objects.list.iter().map(left).collect())
    }

    #[test]
    fn images_are_told_apart_by_the_end_of_their_paths() {
        let files = ["right/1.png", "left/1.png", "set\\night\\left\\1.png", "left/2.png"];
        assert_eq!(taken("/x/day/left/2.png", &files), Ok(vec![3]));
        assert_eq!(taken("/x/right/1.png", &files), Ok(vec![0]));
        assert_eq!(taken("night/left/1.png", &files), Ok(vec![2]));
        assert_eq!(taken("elsewhere/2.png", &files), Ok(vec![3]));
        let error = taken("cam0/1.png", &files[..2]).unwrap_err();
        assert!(error.contains("right/1.png, left/1.png"), "{error}");
        assert!(taken("left/3.png", &files).unwrap_err().contains("none of them called"));
    }
}
