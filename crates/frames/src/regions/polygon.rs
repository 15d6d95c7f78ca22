//! Outlines with corners -> runs: the pixels whose centre is inside (even-odd), in any of the
//! parts.

use super::Why;
use core::ops::Range;
use linestereo::{Dims, image::Span, objects::Run};

/// Checks of an outline that need no pixels.
pub(crate) fn check(parts: &[Vec<[f64; 2]>], dims: Dims) -> Result<(), Why> {
    let corners = || parts.iter().flatten();
    if corners().flatten().any(|value| !value.is_finite()) {
        return Err(Why::Unreadable);
    }
    if parts.iter().all(|part| part.len() < 3) {
        return Err(Why::Empty);
    }
    let is_beside = |axis: usize, side: u16| {
        corners().all(|corner| corner[axis] <= 0.0)
            || corners().all(|corner| corner[axis] >= f64::from(side))
    };
    if is_beside(0, dims.width) || is_beside(1, dims.height) { Err(Why::Outside) } else { Ok(()) }
}

/// Rows that the edges of an outline cross: the work that it takes to fill it.
pub(crate) fn crossings(parts: &[Vec<[f64; 2]>], dims: Dims) -> usize {
    parts.iter().flat_map(|part| edges(part)).map(|edge| rows(edge, dims).len()).sum()
}

/// Runs with label 1, by row, then by column. Positions are borders of pixels: the centre of the
/// first pixel is at 0.5.
pub(crate) fn runs(parts: &[Vec<[f64; 2]>], dims: Dims) -> Vec<Run> {
    // Of each row the parts and columns at which their edges cross it.
    let mut crossed: Vec<Vec<(usize, f64)>> = vec![Vec::new(); dims.height.into()];
    for (part, index) in parts.iter().zip(0..) {
        for [a, b] in edges(part) {
            for y in rows([a, b], dims) {
                crossed[y].push((index, a[0] + (middle(y) - a[1]) / (b[1] - a[1]) * (b[0] - a[0])));
            }
        }
    }
    // The first pixel whose centre is not left of the crossing.
    let column = |x: f64| (x - 0.5).ceil().clamp(0.0, f64::from(dims.width)) as u16;
    let mut runs: Vec<Run> = Vec::new();
    for (mut row, y) in crossed.into_iter().zip(0..) {
        row.sort_by(|a, b| (a.0.cmp(&b.0)).then(a.1.total_cmp(&b.1)));
        // A closed part crosses a row an even number of times.
        let spans = row
            .as_chunks()
            .0
            .iter()
            .map(|[from, to]| Span { start: column(from.1), end: column(to.1) });
        let mut spans: Vec<Span> = spans.filter(|span| span.start < span.end).collect();
        spans.sort_unstable_by_key(|span| (span.start, span.end));
        for span in spans {
            match runs.last_mut() {
                Some(last) if last.y == y && span.start <= last.span.end => {
                    last.span.end = last.span.end.max(span.end)
                }
                _ => runs.push(Run { label: 1, y, span }),
            }
        }
    }
    runs
}

/// The edges of a closed part.
fn edges(part: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> {
    part.iter().zip(part.iter().cycle().skip(1)).map(|(a, b)| [*a, *b])
}

/// Rows of the image whose middle an edge crosses: the upper end's belongs to it, the lower end's
/// does not.
fn rows([a, b]: [[f64; 2]; 2], dims: Dims) -> Range<usize> {
    let first = |y: f64| (y - 0.5).ceil().clamp(0.0, f64::from(dims.height)) as usize;
    first(a[1].min(b[1]))..first(a[1].max(b[1]))
}

fn middle(y: usize) -> f64 {
    y as f64 + 0.5
}
