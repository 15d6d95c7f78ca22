//! OpenCV's XML -> tree.
//!
//! Children named `_` are a list, others a map, texts are lists of words where there are several.
//! Document types, and with them entities of one's own, are refused by the parser.

use super::error::{Fault, Place, Problem};
use super::node::{MAX_DEPTH, MAX_VALUES, Node, Value, repeated};
use core::ops::Range;
use roxmltree::{Document, ParsingOptions};

/// OpenCV's name of the outermost element.
const ROOT: &str = "opencv_storage";
/// Attributes of an element. OpenCV writes one.
const MAX_ATTRIBUTES: usize = 64;

/// The tree below the outermost element.
pub(super) fn parse(text: &str, file: usize) -> Result<Node, Fault> {
    let lines = Lines::new(text, file);
    refuse_squares(text, &lines)?;
    let options = ParsingOptions { nodes_limit: MAX_VALUES as u32, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let place = match error {
            roxmltree::Error::DtdDetected => lines.place(text.find("<!DOCTYPE").unwrap_or(0)),
            _ => Place { file, line: (error.pos().row as usize).max(1) },
        };
        Problem::Syntax(format!("no XML: {error}")).at(place)
    })?;
    let root = document.root_element();
    if root.tag_name().name() != ROOT {
        return Err(Problem::UnknownFormat.at(lines.place(root.range().start)));
    }
    let mut values = 0;
    let node = convert(root, &lines, 0, &mut values)?;
    match node.value {
        Value::Map(_) => Ok(node),
        _ => Err(Problem::UnknownFormat.at(node.place)),
    }
}

/// The parser's time grows with the square of an element's attributes and of nested name spaces:
/// minutes for 1 MiB. OpenCV has neither.
fn refuse_squares(text: &str, lines: &Lines) -> Result<(), Fault> {
    let refuse = |offset, what: &str| Err(Problem::Syntax(what.to_owned()).at(lines.place(offset)));
    if let Some(offset) = text.find("xmlns") {
        return refuse(offset, "OpenCV's files have no name spaces (xmlns)");
    }
    // Between two "<" there is at most one tag, and each of its attributes has a "=".
    let has_many =
        |part: &&str| !part.starts_with("!--") && part.matches('=').count() > MAX_ATTRIBUTES;
    match text.split('<').find(has_many) {
        Some(part) => refuse(
            part.as_ptr() as usize - text.as_ptr() as usize,
            "an element has more than 64 attributes",
        ),
        None => Ok(()),
    }
}

fn convert(
    element: roxmltree::Node<'_, '_>,
    lines: &Lines,
    depth: usize,
    values: &mut usize,
) -> Result<Node, Fault> {
    let place = lines.place(element.range().start);
    if depth >= MAX_DEPTH {
        return Err(Problem::TooDeep.at(place));
    }
    let mut entries = Vec::new();
    for child in element.children().filter(roxmltree::Node::is_element) {
        entries
            .push((child.tag_name().name().to_owned(), convert(child, lines, depth + 1, values)?));
    }
    let value = if entries.is_empty() {
        words(element, lines)
    } else if entries.iter().all(|(name, _)| name == "_") {
        Value::List(entries.into_iter().map(|(_, node)| node).collect())
    } else if let Some(fault) = repeated(&entries) {
        return Err(fault);
    } else {
        Value::Map(entries)
    };
    *values += 1 + if let Value::List(nodes) = &value { nodes.len() } else { 0 };
    if *values > MAX_VALUES {
        return Err(Problem::TooManyValues.at(place));
    }
    Ok(Node { place, value })
}

/// The text of an element: a word, or a list of words with their lines.
fn words(element: roxmltree::Node<'_, '_>, lines: &Lines) -> Value {
    let mut words = Vec::new();
    for child in element.children().filter(roxmltree::Node::is_text) {
        let (text, Range { start, .. }) = (child.text().unwrap_or(""), child.range());
        let mut place = lines.place(start);
        for (index, line) in text.split('\n').enumerate() {
            place.line += usize::from(index > 0);
            let node = |word: &str| Node { place, value: Value::Text(word.to_owned()) };
            words.extend(line.split_whitespace().map(node));
        }
    }
    if words.len() > 1 {
        return Value::List(words);
    }
    words.pop().map_or(Value::Text(String::new()), |word| word.value)
}

/// Where lines begin, so that finding one takes no walk through the text.
struct Lines {
    file: usize,
    starts: Vec<usize>,
}

impl Lines {
    fn new(text: &str, file: usize) -> Self {
        let starts = text
            .bytes()
            .enumerate()
            .filter(|(_, byte)| *byte == b'\n')
            .map(|(index, _)| index + 1)
            .collect();
        Self { file, starts }
    }

    fn place(&self, offset: usize) -> Place {
        Place { file: self.file, line: 1 + self.starts.partition_point(|&start| start <= offset) }
    }
}
