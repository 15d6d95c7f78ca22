//! Boxes as CSV: `x0,y0,x1,y1` and perhaps `label`, `name`, in any order below a line of names, or
//! in this order without one; x1 and y1 are behind the last pixel.

use super::{Collector, Frame, Objects, ObjectsError, Shape, Why, read};
use csv::{ReaderBuilder, StringRecord, Trim};
use std::path::Path;

/// Their order where no line names them.
const COLUMNS: [&str; 6] = ["x0", "y0", "x1", "y1", "label", "name"];

pub(crate) fn load(path: &Path, frame: Frame<'_>) -> Result<Objects, ObjectsError> {
    let broken = |what: String| ObjectsError::Table(path.to_path_buf(), what);
    let bytes = read(path)?;
    let table = |has_headers| {
        ReaderBuilder::new()
            .flexible(true)
            .trim(Trim::All)
            .has_headers(has_headers)
            .from_reader(&bytes[..])
    };
    let mut reader = table(true);
    let mut head = reader.headers().map_err(|error| broken(error.to_string()))?.clone();
    if head.is_empty() {
        return Ok(Objects::default()); // a detector that found nothing
    }
    if head.len() >= 4 && head.iter().take(4).all(|value| value.parse::<f64>().is_ok()) {
        (reader, head) = (table(false), StringRecord::from(COLUMNS.to_vec()));
    }
    let column = |name: &str| head.iter().position(|found| found.eq_ignore_ascii_case(name));
    let mut borders = [0; 4];
    for (border, name) in borders.iter_mut().zip(["x0", "y0", "x1", "y1"]) {
        *border = column(name).ok_or_else(|| broken(format!("there is no column {name}")))?;
    }
    let (label, name) = (column("label"), column("name"));
    let mut collector = Collector::new(frame);
    for record in reader.records() {
        collector.line = match &record {
            Ok(record) => record.position().map(csv::Position::line),
            Err(error) => error.position().map(csv::Position::line),
        };
        collector.put(
            record
                .map_err(|_| Why::Unreadable)
                .and_then(|record| object(&record, borders, label, name)),
        );
    }
    Ok(collector.objects)
}

type Found = (Shape, Option<String>, Option<u16>);

fn object(
    record: &StringRecord,
    borders: [usize; 4],
    label: Option<usize>,
    name: Option<usize>,
) -> Result<Found, Why> {
    let mut box_ = [0.0_f64; 4];
    for (value, column) in box_.iter_mut().zip(borders) {
        *value = record.get(column).and_then(|text| text.parse().ok()).ok_or(Why::Unreadable)?;
    }
    if box_.iter().all(|border| (0.0..=1.0).contains(border))
        && box_.iter().any(|border| border.fract() != 0.0)
    {
        return Err(Why::Shares);
    }
    let text = |column: Option<usize>| {
        column.and_then(|column| record.get(column)).filter(|text| !text.is_empty())
    };
    let label = text(label).map(|text| text.parse().map_err(|_| Why::Unreadable)).transpose()?;
    Ok((Shape::Box(box_), text(name).map(str::to_owned), label))
}
