//! YAML text -> tree, with OpenCV's first line.
//!
//! OpenCV heads its files with `%YAML:1.0`, which is no YAML directive, with or without `---` after
//! it, and so do the sensor files of EuRoC; the line is skipped, and so is the correct `%YAML 1.0`.
//! It takes `data:[1, 2]`, which YAML reads as a text: a space is put in. Its numbers (`1.`, `.5`,
//! `1e-01`) are texts here, read by [`Node::number`]. Aliases are replaced by copies, every one
//! counted: a file that multiplies is refused.

use super::error::{Fault, Place, Problem};
use super::node::{MAX_DEPTH, MAX_VALUES, Node, Value, repeated};
use saphyr_parser::{Event, Parser};
use std::borrow::Cow;
use std::collections::HashMap;

/// The only document of a text. `---` with nothing behind it, with which `ros2 topic echo` ends,
/// begins none.
pub(super) fn parse(text: &str, file: usize) -> Result<Node, Fault> {
    let (body, skipped) = without_header(text);
    let body = spaced(body);
    let mut builder = Builder::default();
    let mut parser = Parser::new_from_str(&body);
    let mut last = Place { file, line: 1 };
    while let Some(event) = parser.next_event() {
        let (event, span) = event.map_err(|error| {
            let line = error.marker().line() + skipped;
            Problem::Syntax(format!("no YAML: {}", error.info()))
                .at(Place { file, line: line.max(1) })
        })?;
        last = Place { file, line: (span.start.line() + skipped).max(1) };
        builder.take(event, last)?;
    }
    builder.whole.ok_or_else(|| Problem::UnknownFormat.at(last))
}

/// The text behind a `%YAML` line, and the number of lines left out.
fn without_header(text: &str) -> (&str, usize) {
    if !text.starts_with("%YAML") {
        return (text, 0);
    }
    text.split_once('\n').map_or(("", 1), |(_, rest)| (rest, 1))
}

/// With a space between a name's colon and the list that touches it.
fn spaced(text: &str) -> Cow<'_, str> {
    let is_name = |name: &str| {
        !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "_.-".contains(c))
    };
    let mut spaced = String::new();
    for line in text.split_inclusive('\n') {
        match line.split_once(":[") {
            Some((name, list)) if is_name(name.trim_start()) => spaced.extend([name, ": [", list]),
            _ => spaced.push_str(line),
        }
    }
    if spaced.len() == text.len() { Cow::Borrowed(text) } else { Cow::Owned(spaced) }
}

#[derive(Default)]
struct Builder {
    open: Vec<Open>,
    whole: Option<Node>,
    anchors: HashMap<usize, Node>,
    values: usize,
    /// Where a second document begins.
    second: Option<Place>,
}

/// A list or map that is not complete.
struct Open {
    place: Place,
    anchor: usize,
    nodes: Nodes,
}

enum Nodes {
    List(Vec<Node>),
    /// With the name whose value comes next, and where it stands.
    Map(Vec<(String, Node)>, Option<(String, Place)>),
}

impl Builder {
    fn take(&mut self, event: Event<'_>, place: Place) -> Result<(), Fault> {
        if let Some(begin) = self.second {
            return match event {
                Event::Scalar(text, ..) if text.is_empty() || text == "~" => Ok(()),
                Event::DocumentStart(_)
                | Event::DocumentEnd
                | Event::StreamEnd
                | Event::Nothing => Ok(()),
                _ => Err(Problem::Syntax("a second document begins: keep one message".to_owned())
                    .at(begin)),
            };
        }
        match event {
            Event::Scalar(text, _, anchor, _) => {
                self.add(Node { place, value: Value::Text(text.into_owned()) }, anchor, 1)?;
            }
            Event::SequenceStart(anchor, _) => self.open(place, anchor, Nodes::List(Vec::new()))?,
            Event::MappingStart(anchor, _) => {
                self.open(place, anchor, Nodes::Map(Vec::new(), None))?
            }
            Event::SequenceEnd | Event::MappingEnd => self.close()?,
            Event::Alias(anchor) => {
                let copy = self.anchors.get(&anchor).cloned();
                let unknown =
                    || Problem::Syntax("an alias refers to what contains it".to_owned()).at(place);
                let copy = copy.ok_or_else(unknown)?;
                let values = copy.count();
                self.add(Node { place, ..copy }, 0, values)?;
            }
            Event::DocumentStart(_) if self.whole.is_some() => self.second = Some(place),
            Event::DocumentStart(_)
            | Event::DocumentEnd
            | Event::StreamStart
            | Event::StreamEnd
            | Event::Nothing => {}
        }
        Ok(())
    }

    fn open(&mut self, place: Place, anchor: usize, nodes: Nodes) -> Result<(), Fault> {
        if self.open.len() >= MAX_DEPTH {
            return Err(Problem::TooDeep.at(place));
        }
        self.open.push(Open { place, anchor, nodes });
        Ok(())
    }

    fn close(&mut self) -> Result<(), Fault> {
        let Some(Open { place, anchor, nodes }) = self.open.pop() else { return Ok(()) };
        let value = match nodes {
            Nodes::List(nodes) => Value::List(nodes),
            Nodes::Map(entries, _) => match repeated(&entries) {
                Some(fault) => return Err(fault),
                None => Value::Map(entries),
            },
        };
        self.add(Node { place, value }, anchor, 1)
    }

    /// A complete value into what holds it; `values` of it are new. A copy that is kept for aliases
    /// counts as well.
    fn add(&mut self, node: Node, anchor: usize, values: usize) -> Result<(), Fault> {
        self.values += values + if anchor == 0 { 0 } else { node.count() };
        if self.values > MAX_VALUES {
            return Err(Problem::TooManyValues.at(node.place));
        }
        if anchor != 0 {
            self.anchors.insert(anchor, node.clone());
        }
        match self.open.last_mut().map(|open| &mut open.nodes) {
            None => self.whole = Some(node),
            Some(Nodes::List(nodes)) => nodes.push(node),
            Some(Nodes::Map(entries, name)) => match (name.take(), node) {
                (Some((name, _)), node @ Node { value: Value::Text(_), .. }) => {
                    entries.push((name, node))
                }
                // A list or map begins, for people, where its name stands.
                (Some((name, place)), node) => entries.push((name, Node { place, ..node })),
                (None, Node { value: Value::Text(text), place }) => *name = Some((text, place)),
                (None, node) => {
                    return Err(Problem::Syntax(
                        "a list or map stands where a name belongs".to_owned(),
                    )
                    .at(node.place));
                }
            },
        }
        Ok(())
    }
}
