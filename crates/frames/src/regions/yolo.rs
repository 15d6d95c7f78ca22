//! YOLO's text: a line per object, the class first, then centre and size as shares of the image
//! (and perhaps a probability, and the number of what is tracked), or the corners of an outline.

use super::{Collector, Frame, Objects, ObjectsError, Shape, Why, read};
use std::path::Path;

/// Largest distance of an outline's corner from the image, as a share of its side.
const OUTSIDE: f64 = 0.05;
const CLASS_FILES: [&str; 3] = ["classes.txt", "obj.names", "classes.names"];

pub(crate) fn load(
    path: &Path,
    classes: Option<&Path>,
    frame: Frame<'_>,
) -> Result<Objects, ObjectsError> {
    let names = names(path, classes)?;
    let text = String::from_utf8_lossy(&read(path)?).into_owned();
    let mut collector = Collector::new(frame);
    collector.unit = "shares of its sides, 0 to 1";
    let lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
    for (line, number) in lines {
        collector.line = Some(number);
        let found = object(line, frame);
        let mut unknown = false;
        let named = found.map(|(class, shape)| {
            let name = names.as_ref().and_then(|names| names.get(class).cloned());
            unknown = name.is_none() && names.is_some();
            (shape, name, None)
        });
        collector.put(named);
        collector.objects.skipped.unknown_class += usize::from(unknown);
    }
    Ok(collector.objects)
}

fn object(line: &str, frame: Frame<'_>) -> Result<(usize, Shape), Why> {
    let mut words = line.split_whitespace();
    let class = words.next().and_then(|word| word.parse().ok()).ok_or(Why::Unreadable)?;
    let values: Vec<f64> =
        words.map(|word| word.parse().map_err(|_| Why::Unreadable)).collect::<Result<_, _>>()?;
    let (width, height) = (f64::from(frame.given.width), f64::from(frame.given.height));
    let box_of = |[x, y, w, h]: [f64; 4]| {
        Shape::Box([
            (x - 0.5 * w) * width,
            (y - 0.5 * h) * height,
            (x + 0.5 * w) * width,
            (y + 0.5 * h) * height,
        ])
    };
    let is_share = |value: &f64| (-OUTSIDE..=1.0 + OUTSIDE).contains(value);
    let shape = match values[..] {
        [x, y, w, h] | [x, y, w, h, _] => box_of([x, y, w, h]),
        // A box that is tracked: its probability, then its number.
        [x, y, w, h, _, number] if number >= 1.0 && number.fract() == 0.0 => box_of([x, y, w, h]),
        _ if values.len() >= 6 && values.len().is_multiple_of(2) && values.iter().all(is_share) => {
            let corners = values.chunks_exact(2);
            Shape::Polygons(vec![
                corners.map(|corner| [corner[0] * width, corner[1] * height]).collect(),
            ])
        }
        _ => return Err(Why::Unreadable),
    };
    Ok((class, shape))
}

/// A name per line; `None` without a list.
fn names(path: &Path, classes: Option<&Path>) -> Result<Option<Vec<String>>, ObjectsError> {
    let beside = || {
        CLASS_FILES
            .map(|name| path.with_file_name(name))
            .into_iter()
            .find(|file| file.is_file() && file != path)
    };
    let Some(file) = classes.map(Path::to_path_buf).or_else(beside) else { return Ok(None) };
    let text = String::from_utf8(read(&file)?)
        .map_err(|_| ObjectsError::Classes(file.clone(), "it is not text".to_owned()))?;
    Ok(Some(text.lines().map(|line| line.trim().to_owned()).collect()))
}
