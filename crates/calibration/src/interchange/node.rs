//! Content of parsed YAML and XML files: texts, lists and maps with the lines they stand on, and
//! the numbers in them.
//!
//! # Bounds
//! [`MAX_DEPTH`] levels, [`MAX_VALUES`] values, matrices of [`MAX_ELEMENTS`]: everything that walks
//! a tree ends early.

use super::error::{Fault, Place, Problem};
use std::collections::HashSet;

/// Levels of lists and maps. Kalibr's files have four.
pub(super) const MAX_DEPTH: usize = 16;
/// Values of a whole file, those behind aliases counted as often as they are used.
pub(super) const MAX_VALUES: usize = 100_000;
/// Values of a matrix that is looked at: the largest is 4x4.
const MAX_ELEMENTS: usize = 16;

#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) place: Place,
    pub(super) value: Value,
}

#[derive(Clone, Debug)]
pub(super) enum Value {
    Text(String),
    List(Vec<Node>),
    Map(Vec<(String, Node)>),
}

/// A matrix by rows, all values finite.
#[derive(Clone, Debug)]
pub(super) struct Matrix {
    pub(super) place: Place,
    name: String,
    /// `None`: a plain list, which may be of any shape.
    sides: Option<[usize; 2]>,
    data: Vec<f64>,
}

impl Node {
    /// Number of values in it, itself included.
    pub(super) fn count(&self) -> usize {
        match &self.value {
            Value::Text(_) => 1,
            Value::List(nodes) => 1 + nodes.iter().map(Self::count).sum::<usize>(),
            Value::Map(entries) => 1 + entries.iter().map(|(_, node)| node.count()).sum::<usize>(),
        }
    }

    /// The value of this name in a map.
    pub(super) fn get(&self, name: &str) -> Option<&Self> {
        let Value::Map(entries) = &self.value else { return None };
        entries.iter().find(|(key, _)| key == name).map(|(_, node)| node)
    }

    /// The same, where it must be.
    pub(super) fn require(&self, name: &str) -> Result<&Self, Fault> {
        self.get(name)
            .ok_or_else(|| Problem::Missing(format!("there is no \"{name}\"")).at(self.place))
    }

    pub(super) fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    pub(super) fn number(&self, name: &str) -> Result<f64, Fault> {
        let wrong = |text: &str| {
            Problem::NotANumber { name: name.to_owned(), text: text.chars().take(24).collect() }
                .at(self.place)
        };
        let text = self.text().ok_or_else(|| wrong("a list"))?.trim();
        let plain = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
        let value: f64 = match plain.as_str() {
            ".inf" | ".nan" => f64::NAN,
            _ => text.parse().map_err(|_| wrong(text))?,
        };
        let finite = value.is_finite().then_some(value);
        finite.ok_or_else(|| Problem::NotFinite(name.to_owned()).at(self.place))
    }

    /// A side of an image or matrix.
    pub(super) fn whole(&self, name: &str) -> Result<u16, Fault> {
        let value = self.number(name)?;
        let whole = value.fract() == 0.0 && (0.0..=f64::from(u16::MAX)).contains(&value);
        whole.then_some(value as u16).ok_or_else(|| {
            Problem::NotANumber {
                name: name.to_owned(),
                text: format!("{value}, not whole or too large"),
            }
            .at(self.place)
        })
    }

    /// Could this be a matrix: a list, or a map with data?
    pub(super) fn is_matrix(&self) -> bool {
        match &self.value {
            Value::Text(_) => false,
            Value::List(_) => true,
            Value::Map(_) => self.get("data").is_some(),
        }
    }

    /// `{ rows, cols, data }`, a list of rows, or a plain list.
    pub(super) fn matrix(&self, name: &str) -> Result<Matrix, Fault> {
        let (sides, nodes) = match &self.value {
            Value::Map(_) => {
                let side = |side: &str| {
                    self.require(side)?.whole(&format!("{side} of {name}")).map(usize::from)
                };
                let data = self.require("data")?;
                let nodes = match &data.value {
                    Value::List(nodes) => nodes.iter().collect(),
                    Value::Text(text) if text.trim().is_empty() => Vec::new(),
                    _ => vec![data],
                };
                (Some([side("rows")?, side("cols")?]), nodes)
            }
            Value::List(nodes) => rows_of(nodes),
            Value::Text(_) => (None, vec![self]),
        };
        let count = sides.map_or(nodes.len(), |[rows, cols]| rows * cols);
        let shape = |expected: String, found: String| Problem::Shape {
            name: name.to_owned(),
            expected,
            found,
        };
        if count > MAX_ELEMENTS {
            let found = format!("a matrix of {count} values");
            return Err(shape(format!("at most {MAX_ELEMENTS} values"), found).at(self.place));
        }
        if count != nodes.len() {
            let found = format!("a list of {} values", nodes.len());
            return Err(shape(format!("{count} values (rows times columns)"), found).at(self.place));
        }
        let data = nodes.iter().map(|node| node.number(name)).collect::<Result<_, _>>()?;
        Ok(Matrix { place: self.place, name: name.to_owned(), sides, data })
    }
}

/// Shape and values of a list: of rows of the same length, or of numbers.
fn rows_of(nodes: &[Node]) -> (Option<[usize; 2]>, Vec<&Node>) {
    let rows: Option<Vec<&Vec<Node>>> = nodes
        .iter()
        .map(|node| if let Value::List(row) = &node.value { Some(row) } else { None })
        .collect();
    match rows.as_deref() {
        Some(rows @ [first, ..]) if rows.iter().all(|row| row.len() == first.len()) => {
            (Some([rows.len(), first.len()]), rows.iter().copied().flatten().collect())
        }
        _ => (None, nodes.iter().collect()),
    }
}

impl Matrix {
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Its values by rows, if it has these sides.
    pub(super) fn shaped<const N: usize>(
        &self,
        rows: usize,
        cols: usize,
    ) -> Result<[f64; N], Fault> {
        let fits = self.sides.is_none_or(|sides| sides == [rows, cols]);
        let values =
            <[f64; N]>::try_from(self.data.as_slice()).ok().filter(|_| fits && rows * cols == N);
        values.ok_or_else(|| self.wrong(format!("{rows}x{cols}")))
    }

    /// Its values, if it is a row or a column.
    pub(super) fn vector(&self) -> Result<&[f64], Fault> {
        let fits = self.sides.is_none_or(|[rows, cols]| rows <= 1 || cols <= 1);
        fits.then_some(self.data.as_slice())
            .ok_or_else(|| self.wrong("a row or a column".to_owned()))
    }

    /// The same, with this many values.
    pub(super) fn vector_of<const N: usize>(&self) -> Result<[f64; N], Fault> {
        self.vector()?.try_into().map_err(|_| self.wrong(format!("a list of {N} values")))
    }

    /// By values, whatever the shape.
    pub(super) fn same_values(&self, other: &Self) -> bool {
        self.data == other.data
    }

    fn wrong(&self, expected: String) -> Fault {
        let found = match self.sides {
            Some([rows, cols]) => format!("{rows}x{cols}"),
            None => format!("a list of {} values", self.data.len()),
        };
        Problem::Shape { name: self.name.clone(), expected, found }.at(self.place)
    }
}

/// The first name of a map that stands twice.
pub(super) fn repeated(entries: &[(String, Node)]) -> Option<Fault> {
    let mut seen = HashSet::new();
    let (name, node) = entries.iter().find(|(name, _)| !seen.insert(name.as_str()))?;
    Some(Problem::Duplicate(name.chars().take(40).collect()).at(node.place))
}
