//! One rectified pair -> matches and points: the stages of a run.

use crate::area::Area;
use crate::bars;
use crate::focus::{Focus, SearchRegions};
use crate::ground::{self, GroundPlane};
use crate::image::Gray;
use crate::lines::{self, LineParams, LineScratch};
use crate::matched::{Matched, Summary};
use crate::matching::band::Band;
use crate::matching::consistency;
use crate::matching::{
    self, FullSearches, MatchContext, Search, SegmentCurves, Workspace, row_offset, surroundings,
};
use crate::memory::{Buffers, MemorySlice, RunError};
use crate::observe::{Observer, StageEvent};
use crate::params::Parts;
use crate::plan::Plan;
use crate::report::Report;
use crate::result::{Counts, Rejection};
use crate::support::{self, Grid, RangeCheck, Support};

/// Columns between two scans for the near-horizontal edges of the right image, not all of which are
/// needed.
const RIGHT_SCAN_STEP: i32 = 6 * lines::SCAN_STEP;

impl Plan {
    /// Matches one rectified pair, left and right, as a whole. Its health is not checked:
    /// [`Matcher`](crate::Matcher) does both.
    ///
    /// # Errors
    /// Images of another size than planned, and a memory that is too small for it (see
    /// [`Capacity`](crate::Capacity)).
    pub fn run<'a>(
        &self,
        images: [Gray<'a>; 2],
        memory: &'a mut MemorySlice,
    ) -> Result<Matched<'a>, RunError> {
        self.run_on(images, &Focus::WHOLE, memory, &mut ())
    }

    /// [`Plan::run`] in and just around some areas of the left image; calls `observer` at every
    /// step.
    ///
    /// The candidates there are those of a run over the whole frame, given its row offset. The
    /// confidence of matches and points also depends on neighbours, which are missing outside of
    /// the areas: near their borders it may differ.
    ///
    /// # Cost
    /// About in proportion to the areas, each grown by some 20 px, and in the right image by the
    /// disparity range as well.
    pub fn run_on<'a>(
        &self,
        images: [Gray<'a>; 2],
        focus: &Focus<'_>,
        memory: &'a mut MemorySlice,
        observer: &mut impl Observer,
    ) -> Result<Matched<'a>, RunError> {
        Ok(self.run_stages(
            images,
            (focus, self.params.parts),
            self.buffers(images, memory)?,
            observer,
        ))
    }

    /// Runs every stage, in [the buffers](Self::buffers) for these images. The observer
    /// is a trait object: compiled here, once, and not for each kind of observer in the package
    /// that has it, at that one's level of optimization. `parts` overrides those of the parameters.
    pub(crate) fn run_stages<'a>(
        &self,
        images: [Gray<'a>; 2],
        (focus, parts): (&Focus<'_>, Parts),
        mut m: Buffers<'a>,
        observer: &mut dyn Observer,
    ) -> Matched<'a> {
        m.clear();
        let regions = SearchRegions::new(focus, self.dims);
        let mut counts = Counts::default();
        let row_offset_q5 = if parts == Parts::Support {
            given_rows(focus)
        } else {
            self.find_segments(images, (focus, &regions), &mut m, &mut counts, observer)
        };
        let mut summary = Summary { counts, row_offset_q5, ..Summary::default() };
        let row_offset = summary.row_offset();
        if self.params.ground {
            let searched = (row_offset, self.params.max_disparity);
            summary.plane = ground::find(images, searched, focus.ground, m.rows);
        }
        (summary.detail_q8, summary.range) =
            self.match_support(images, (row_offset, &regions), summary.plane, &mut m, observer);
        if parts != Parts::Support {
            self.match_segments(
                images,
                (row_offset, summary.detail_q8, &regions, summary.plane),
                &mut m,
                &mut summary.counts,
                observer,
            );
        }
        support::rate(
            &mut m.support,
            Grid::new(&self.params, self.dims),
            (summary.detail_q8, summary.plane),
            self.support_models.of_size(self.dims.is_large(), summary.plane.is_some()),
        );
        observer.on_event(StageEvent::Consistency(&m.candidates, &m.support));
        self.place_bars(images, (row_offset, summary.detail_q8), &mut m, observer);

        let (mut report, matches) = Report::new(self, images, &mut m, summary.detail_q8);
        report.run(matches, &mut summary.counts);
        observer.on_event(StageEvent::Report(matches));
        m.keep();
        Matched { plan: *self, images, buffers: m, summary }
    }

    /// The matched pair of an earlier run with this plan, these images and this memory, unchanged
    /// since, from its [`Matched::summary`]: for callers that cannot keep a borrow of both, such as
    /// another language.
    ///
    /// # Errors
    /// As [`Plan::run`].
    pub fn resume<'a>(
        &self,
        summary: &Summary,
        images: [Gray<'a>; 2],
        memory: &'a mut MemorySlice,
    ) -> Result<Matched<'a>, RunError> {
        Ok(Matched {
            plan: *self,
            images,
            buffers: self.buffers(images, memory)?,
            summary: *summary,
        })
    }

    /// The buffers of a run, if the memory and the images have the planned sizes.
    pub(crate) fn buffers<'a>(
        &self,
        images: [Gray<'a>; 2],
        memory: &'a mut MemorySlice,
    ) -> Result<Buffers<'a>, RunError> {
        if let Some(image) = images.iter().find(|image| image.dims() != self.dims) {
            return Err(RunError::SizeMismatch { planned: self.dims, given: image.dims() });
        }
        memory.cut(self.dims, self.params.cell)
    }

    /// Detects the segments of both images and keeps the prominent ones of the left. Returns the
    /// row offset, 1/32 px, if it is known.
    #[inline(never)] // its variables are on the stack only while it runs
    fn find_segments(
        &self,
        [left, right]: [Gray<'_>; 2],
        (focus, regions): (&Focus<'_>, &SearchRegions),
        m: &mut Buffers<'_>,
        counts: &mut Counts,
        observer: &mut dyn Observer,
    ) -> Option<i16> {
        let lines = LineParams {
            anchor: self.params.anchor_gradient.into(),
            edge: self.params.edge_gradient.into(),
            min_extent: self.params.min_extent.into(),
            row_scan: Some(lines::SCAN_STEP),
            column_scan: Some(lines::SCAN_STEP),
        };
        // Of the right image only near-horizontal segments are needed, for the row offset.
        let right_lines =
            LineParams { row_scan: None, column_scan: Some(RIGHT_SCAN_STEP), ..lines };
        let scratch = LineScratch { marks: m.marks, chain: m.chain, strengths: m.strengths };
        let found = lines::detect(
            left,
            regions.left(self.params.cell).as_deref(),
            &lines,
            scratch,
            &mut m.left,
        );
        (counts.segments_left_dropped, counts.edges_cut) = (found.segments, found.edges);
        counts.edge_units = found.units;
        observer.on_event(StageEvent::LinesLeft(&m.left));
        if self.has_bars && regions.areas().is_none() {
            bars::find(left, &m.left, &mut m.bars);
        }
        let scratch = LineScratch { marks: m.marks, chain: m.chain, strengths: m.strengths };
        if focus.row_offset_q5.is_none() {
            let regions = regions.right(&m.left, &self.params);
            let found =
                lines::detect(right, regions.as_deref(), &right_lines, scratch, &mut m.right);
            counts.segments_right_dropped = found.segments;
            counts.edges_cut = counts.edges_cut.saturating_add(found.edges);
            counts.edge_units += found.units;
            lines::sort_by_top(&mut m.right);
        }
        observer.on_event(StageEvent::LinesRight(&m.right));
        counts.segments_right = u16::try_from(m.right.len()).unwrap_or(u16::MAX);
        let row_offset_q5 = given_rows(focus).or_else(|| {
            let (offset_q5, cut) = row_offset::estimate(
                &m.left,
                &m.right,
                self.disparities(),
                Area::of(self.dims).pixels(),
            );
            counts.comparisons_cut = cut;
            offset_q5
        });
        let lost = lines::keep_prominent(
            &mut m.left,
            (self.params.cell.into(), m.candidates.capacity()),
            self.dims.width.into(),
            m.marks,
        );
        m.left.retain(|segment| regions.contains(segment));
        lines::sort_by_top(&mut m.left);
        counts.segments_left = u16::try_from(m.left.len()).unwrap_or(u16::MAX).saturating_add(lost);
        counts.reject_many(Rejection::LessProminent, lost);
        observer.on_event(StageEvent::Selection(row_offset_q5.unwrap_or(0).into(), &m.left));
        row_offset_q5
    }

    /// Matches the support points. Returns the detail of the left image,
    /// [`SupportKind::Detail`](crate::diagnostics::SupportKind::Detail), Q8, and what was found
    /// beyond the range.
    #[inline(never)] // its variables are on the stack only while it runs
    fn match_support(
        &self,
        images: [Gray<'_>; 2],
        (row_offset, regions): (i32, &SearchRegions),
        plane: Option<GroundPlane>,
        m: &mut Buffers<'_>,
        observer: &mut dyn Observer,
    ) -> (i16, RangeCheck) {
        let grid = Grid::new(&self.params, self.dims);
        let grid = if plane.is_some() { grid.with_plane(m.rows.len()) } else { grid };
        let (half, noise) = (Grid::of_halves(&self.params, self.dims), support::Noise::of(images));
        let models = self.support_models;
        let wants_curves = observer.wants_curves();
        let matching = support::Matching {
            images,
            grid,
            half,
            row_offset,
            noise,
            plane,
            models,
            wants_curves,
        };
        let found =
            matching.run(regions.areas(), m.rows, &mut m.support, |index, seen| match seen {
                support::Seen::Curves(curves) => observer.support_curves(index, &curves),
                support::Seen::Evidence(evidence) => observer.support_point(index, evidence),
            });
        observer.on_event(StageEvent::Support(&m.support));
        found
    }

    /// Matches each left segment; then computes the evidence between segments and support points
    /// nearby.
    #[inline(never)] // its variables are on the stack only while it runs
    fn match_segments(
        &self,
        images: [Gray<'_>; 2],
        (row_offset, detail_q8, regions, plane): (i32, i16, &SearchRegions, Option<GroundPlane>),
        m: &mut Buffers<'_>,
        counts: &mut Counts,
        observer: &mut dyn Observer,
    ) {
        let support =
            Support::new(&self.params, self.dims, &m.support, detail_q8).with_plane(plane);
        let context = MatchContext::new(&self.params, self.models, self.dims, support);
        let extents = regions.extents(&m.left, self.disparities());
        let Some(mut band) = Band::new(images, row_offset, extents.as_deref(), m.rows) else {
            return;
        };
        let mut full = FullSearches::new(regions.areas(), self.dims, self.params.cell);
        // Both lists by their first rows, as the band goes down.
        let mut unmatched = m.bars.iter_mut().enumerate().peekable();
        let mut match_bars =
            |to: i32, band: &mut Band<'_>, work: &mut Workspace, observer: &mut dyn Observer| {
                while let Some((index, bar)) = unmatched.next_if(|(_, bar)| bar.edge().top() <= to)
                {
                    band.advance_for(&bar.edge(), |planes| observer.row(planes));
                    if let Some(evidence) = bars::match_bar(bar, &context, band, work) {
                        observer.bar_evidence(index, &evidence);
                    }
                }
            };
        for segment in m.left.iter() {
            match_bars(segment.top(), &mut band, m.work, observer);
            band.advance_for(segment, |planes| observer.row(planes));
            observer.on_event(StageEvent::Rows);
            if observer.wants_curves() {
                m.work.clear_curves();
            }
            let matched = matching::match_segment(segment, &context, &mut full, &band, m.work);
            if observer.wants_curves() {
                observer.segment_curves(&SegmentCurves::new(segment, m.work));
            }
            counts.searched_fully += u16::from(matched.search == Search::Full);
            counts.comparisons_cut =
                counts.comparisons_cut.saturating_add(u16::from(matched.search == Search::Cut));
            match matched.outcome {
                Ok(candidate) => {
                    let _ = m.candidates.push(candidate); // `keep_prominent` kept no more than its capacity
                    if let Some(candidate) = m.candidates.last() {
                        observer.on_event(StageEvent::Segment(Ok((candidate, &m.work.evidence))));
                    }
                }
                Err(reason) => {
                    observer.on_event(StageEvent::Segment(Err(reason)));
                    counts.reject(reason);
                }
            }
        }
        match_bars(i32::MAX, &mut band, m.work, observer);
        let cut = consistency::accumulate_support(&mut m.candidates, m.neighbours);
        counts.comparisons_cut = counts.comparisons_cut.saturating_add(cut);
        surroundings::evaluate_sides(
            &mut m.candidates,
            (Grid::new(&self.params, self.dims), plane),
            &mut m.support,
        );
    }

    /// Rates the bars by the support points around them, and grows those that are told. Support
    /// points on their pixels that lie behind them take their disparity.
    #[inline(never)] // its variables are on the stack only while it runs
    fn place_bars(
        &self,
        images: [Gray<'_>; 2],
        (row_offset, detail_q8): (i32, i16),
        m: &mut Buffers<'_>,
        observer: &mut dyn Observer,
    ) {
        let support = Support::new(&self.params, self.dims, &m.support, detail_q8);
        let least = self.params.min_confidence.max(bars::LEAST_BAR);
        bars::rate(&mut m.bars, support, least, |index, bar, nearby_q8| {
            observer.bar(index, bar, nearby_q8)
        });
        bars::grow(&mut m.bars, images, row_offset, least);
        bars::sort(&mut m.bars);
        bars::take_points(&mut m.support, Grid::new(&self.params, self.dims), &m.bars);
    }

    /// First disparity, and the one after the last, px.
    fn disparities(&self) -> (i32, i32) {
        (self.params.min_disparity.into(), self.params.max_disparity.into())
    }
}

/// The row offset of the caller, 1/32 px.
fn given_rows(focus: &Focus<'_>) -> Option<i16> {
    focus.row_offset_q5.map(|known| known.clamp(-row_offset::LIMIT_Q5, row_offset::LIMIT_Q5))
}
