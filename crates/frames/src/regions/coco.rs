//! COCO's JSON: annotations, results, or the project's own list of boxes.
//!
//! Annotations are an object with `annotations`, and perhaps `images` and `categories`; results are
//! a list of annotations. An annotation has a `segmentation` (run lengths or polygons), else a
//! `bbox` (left, top, width, height). In a file of several images those of the image that is called
//! like the left one are taken; where only numbers tell images apart, there may be one image.
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
    let stem =
        |name: &str| Path::new(name).file_name().map(|name| name.to_string_lossy().into_owned());
    let wanted = frame.image_name.and_then(stem);
    let named = images.iter().find(|image| {
        let name = image.file_name.as_deref().and_then(stem);
        name.is_some() && name == wanted
    });
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
            image: wanted.unwrap_or_default(),
            images: ids.len().max(images.len()),
        });
    }
    Ok(None)
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
