//! Outlines with corners -> runs: the pixels whose centre is inside (even-odd), in any of the parts.

use super::Why;
use linestereo::objects::Run;
use linestereo::{Dims, Span};

/// Checks of an outline that need no pixels.
pub(super) fn check(parts: &[Vec<[f64; 2]>], dims: Dims) -> Result<(), Why> {
    let corners = || parts.iter().flatten();
    if corners().flatten().any(|value| !value.is_finite()) {
        return Err(Why::Unreadable);
    }
    if parts.iter().all(|part| part.len() < 3) {
        return Err(Why::Empty);
    }
    let (width, height) = (f64::from(dims.width), f64::from(dims.height));
    let all = |test: fn(&[f64; 2], f64, f64) -> bool| corners().all(|corner| test(corner, width, height));
    if all(|c, _, _| c[0] <= 0.0) || all(|c, _, _| c[1] <= 0.0) || all(|c, w, _| c[0] >= w) || all(|c, _, h| c[1] >= h)
    {
        return Err(Why::Outside);
    }
    Ok(())
}

/// Runs with label 1, by row, then by column. Positions are borders of pixels: the centre of the first pixel is at 0.5.
pub(super) fn runs(parts: &[Vec<[f64; 2]>], dims: Dims) -> Vec<Run> {
    let mut runs = Vec::new();
    for y in 0..dims.height {
        let middle = f64::from(y) + 0.5;
        let mut row: Vec<Span> = parts.iter().flat_map(|part| spans(part, middle, dims.width)).collect();
        row.sort_by_key(|span| (span.start, span.end));
        let mut joined: Vec<Span> = Vec::new();
        for span in row {
            match joined.last_mut() {
                Some(last) if span.start <= last.end => last.end = last.end.max(span.end),
                _ => joined.push(span),
            }
        }
        runs.extend(joined.into_iter().map(|span| Run { label: 1, y, span }));
    }
    runs
}

/// The columns of one row inside of one part.
fn spans(part: &[[f64; 2]], middle: f64, width: u16) -> Vec<Span> {
    let edges = part.iter().zip(part.iter().cycle().skip(1));
    let mut crossings: Vec<f64> = edges
        .filter(|(a, b)| (a[1] <= middle) != (b[1] <= middle))
        .map(|(a, b)| a[0] + (middle - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
        .collect();
    crossings.sort_by(f64::total_cmp);
    // The first pixel whose centre is not left of the crossing.
    let column = |x: f64| (x - 0.5).ceil().clamp(0.0, f64::from(width)) as u16;
    let pairs = crossings.chunks_exact(2).map(|pair| Span { start: column(pair[0]), end: column(pair[1]) });
    pairs.filter(|span| span.start < span.end).collect()
}
