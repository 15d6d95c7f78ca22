//! Label rows as a segmentation streams them -> runs: no image-sized mask is stored.
//!
//! In: the labels of one row after the other, 0 = nothing. Out: the runs that
//! [`Region::masked`](super::Region::masked) takes, as many as fit.
//!
//! # Cost
//! Three instructions a pixel, 20 a run.

use super::region::Run;
use crate::image::{Dims, Span};
use heapless::vec::VecView;

/// Collects the runs of label rows, from the top row on.
///
/// ```
/// use linestereo::{Dims, Region};
/// use linestereo::objects::LabelRows;
/// let dims = Dims { width: 16, height: 16 };
/// let mut runs = heapless::Vec::<_, 8>::new();
/// let mut rows = LabelRows::new(dims, &mut runs);
/// rows.push(&[0, 0, 7, 7, 7, 0, 2, 2]);
/// rows.push(&[0, 7, 7]);
/// assert_eq!(rows.labels().collect::<Vec<_>>(), [2, 7]);
/// assert_eq!(Region::masked(7, rows.runs(), dims).unwrap().area().pixels(), 8);
/// ```
#[derive(Debug)]
pub struct LabelRows<'a> {
    dims: Dims,
    runs: &'a mut VecView<Run>,
    row: u16,
    dropped: u32,
}

impl<'a> LabelRows<'a> {
    /// A collector for an image of this size; clears `runs`.
    pub fn new(dims: Dims, runs: &'a mut VecView<Run>) -> Self {
        runs.clear();
        Self { dims, runs, row: 0, dropped: 0 }
    }

    /// Takes the next row. Labels beyond the image's width and rows below it are left out; pixels
    /// that a short row lacks have no label.
    pub fn push(&mut self, labels: &[u16]) {
        let y = self.row;
        self.row = self.row.saturating_add(1);
        if y >= self.dims.height {
            return;
        }
        let mut open = None::<Run>;
        for (&label, x) in labels.iter().zip(0..self.dims.width) {
            match &mut open {
                Some(run) if run.label == label => run.span.end = x + 1,
                _ => {
                    let next = (label != 0).then_some(Run {
                        label,
                        y,
                        span: Span { start: x, end: x + 1 },
                    });
                    self.keep(core::mem::replace(&mut open, next));
                }
            }
        }
        self.keep(open);
    }

    fn keep(&mut self, run: Option<Run>) {
        if let Some(run) = run
            && self.runs.push(run).is_err()
        {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// The runs so far, sorted by row and column.
    #[must_use]
    pub fn runs(&self) -> &[Run] {
        self.runs
    }

    /// Every label that has a run, smallest first. Each step scans all runs.
    pub fn labels(&self) -> impl Iterator<Item = u16> {
        let next =
            |after: u16| self.runs.iter().map(|run| run.label).filter(|&label| label > after).min();
        core::iter::successors(next(0), move |&label| next(label))
    }

    /// Number of runs that did not fit.
    #[must_use]
    pub fn dropped(&self) -> u32 {
        self.dropped
    }
}
