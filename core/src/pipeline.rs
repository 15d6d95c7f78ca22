//! One rectified pair -> matches and points: the stages of a run.

use crate::area::Area;
use crate::bars;
use crate::focus::SearchRegions;
use crate::ground::{self, GroundSearch};
use crate::image::Gray;
use crate::lines::{self, LineParams, LineScratch};
use crate::matched::{Matched, Summary};
use crate::matching::band::Band;
use crate::matching::consistency;
use crate::matching::{
    self, FullSearches, MatchContext, Search, SegmentCurves, Workspace, row_offset, surroundings,
};
use crate::memory::Buffers;
use crate::observe::{Observer, StageEvent};
use crate::params::Parts;
use crate::plan::Plan;
use crate::report::Report;
use crate::result::{Counts, Rejection};
use crate::support::{self, Grid, Support};

/// Columns between two scans for the near-horizontal edges of the right image, not all of which are
/// needed.
const RIGHT_SCAN_STEP: i32 = 3 * lines::SCAN_STEP;

/// A run: the pair, and all that its stages read of the caller.
pub(crate) struct Run<'r, 'a> {
    pub(crate) plan: &'r Plan,
    pub(crate) images: [Gray<'a>; 2],
    /// Areas of the left image that are matched.
    pub(crate) regions: SearchRegions,
    /// Rows to add to a left row for the matching right one, 1/32 px, as a run over the whole frame
    /// found it; `None` to estimate it in the areas, where segments may be too few.
    pub(crate) row_offset_q5: Option<i16>,
    /// Where the ground plane is looked for.
    pub(crate) ground: GroundSearch,
    /// Parts of the method, instead of those of the parameters.
    pub(crate) parts: Parts,
}

impl<'a> Run<'_, 'a> {
    /// Runs every stage, in the buffers for these images. The candidates in areas are those of a
    /// run over the whole frame, given its row offset. The confidence of matches and points also
    /// depends on neighbours, which are missing outside of the areas: near their borders it may
    /// differ. The observer is a trait object, so that this is compiled once, with this crate's
    /// settings.
    ///
    /// # Cost
    /// About in proportion to the areas, each grown by some 20 px, and in the right image by the
    /// disparity range as well.
    pub(crate) fn stages(&self, mut m: Buffers<'a>, observer: &mut dyn Observer) -> Matched<'a> {
        let mut summary = Summary::default();
        summary.row_offset_q5 = if self.parts == Parts::Support {
            self.given_rows()
        } else {
            self.find_segments(&mut m, &mut summary.counts, observer)
        };
        let Plan { params, dims, support_models, .. } = self.plan;
        if params.ground {
            let searched = (summary.row_offset(), params.max_disparity);
            summary.plane = ground::find(self.images, searched, self.ground, m.rows);
        }
        self.match_support(&mut summary, &mut m, observer);
        if self.parts != Parts::Support {
            self.match_segments(&mut summary, &mut m, observer);
        }
        support::rate(
            &mut m.support,
            Grid::new(params, *dims),
            (summary.detail_q8, summary.plane),
            support_models.of_size(dims.is_large(), summary.plane.is_some()),
        );
        observer.on_event(StageEvent::Consistency(&m.candidates, &m.support));
        self.place_bars(&summary, &mut m, observer);

        let (mut report, matches) = Report::new(self.plan, self.images, &mut m, summary.detail_q8);
        report.run(matches, &mut summary.counts);
        observer.on_event(StageEvent::Report(matches));
        Matched { plan: *self.plan, images: self.images, buffers: m, summary }
    }

    /// Detects the segments of both images and keeps the prominent ones of the left. Returns the
    /// row offset, 1/32 px, if it is known.
    #[inline(never)] // its variables are on the stack only while it runs
    fn find_segments(
        &self,
        m: &mut Buffers<'_>,
        counts: &mut Counts,
        observer: &mut dyn Observer,
    ) -> Option<i16> {
        let Self { plan: Plan { params, dims, .. }, images: [left, right], regions, .. } = self;
        let lines = LineParams {
            anchor: params.anchor_gradient.into(),
            edge: params.edge_gradient.into(),
            min_extent: params.min_extent.into(),
            row_scan: Some(lines::SCAN_STEP),
            column_scan: Some(lines::SCAN_STEP),
        };
        // Of the right image only near-horizontal segments are needed, for the row offset.
        let right_lines =
            LineParams { row_scan: None, column_scan: Some(RIGHT_SCAN_STEP), ..lines };
        let scratch = LineScratch { marks: m.marks, chain: m.chain, strengths: m.strengths };
        let found = lines::detect(
            *left,
            regions.left(params.cell).as_deref(),
            &lines,
            scratch,
            &mut m.left,
        );
        (counts.segments_left_dropped, counts.edges_cut) = (found.segments, found.edges);
        counts.edge_units = found.units;
        observer.on_event(StageEvent::LinesLeft(&m.left));
        if self.plan.has_bars && regions.areas().is_none() {
            bars::find(*left, &m.left, &mut m.bars);
        }
        let scratch = LineScratch { marks: m.marks, chain: m.chain, strengths: m.strengths };
        if self.row_offset_q5.is_none() {
            let regions = regions.right(&m.left, params);
            let found =
                lines::detect(*right, regions.as_deref(), &right_lines, scratch, &mut m.right);
            counts.segments_right_dropped = found.segments;
            counts.edges_cut = counts.edges_cut.saturating_add(found.edges);
            counts.edge_units += found.units;
            lines::sort_by_top(&mut m.right);
        }
        observer.on_event(StageEvent::LinesRight(&m.right));
        counts.segments_right = u16::try_from(m.right.len()).unwrap_or(u16::MAX);
        let row_offset_q5 = self.given_rows().or_else(|| {
            let (offset_q5, cut) = row_offset::estimate(
                &m.left,
                &m.right,
                self.plan.disparities(),
                Area::of(*dims).pixels(),
            );
            counts.comparisons_cut = cut;
            offset_q5
        });
        let lost = lines::keep_prominent(
            &mut m.left,
            (params.cell.into(), m.candidates.capacity()),
            dims.width.into(),
            m.marks,
        );
        m.left.retain(|segment| regions.contains(segment));
        lines::sort_by_top(&mut m.left);
        counts.segments_left = u16::try_from(m.left.len()).unwrap_or(u16::MAX).saturating_add(lost);
        counts.reject_many(Rejection::LessProminent, lost);
        observer.on_event(StageEvent::Selection(row_offset_q5.unwrap_or(0).into(), &m.left));
        row_offset_q5
    }

    /// Matches the support points. Sets the detail of the left image, and what was found beyond the
    /// range.
    #[inline(never)] // its variables are on the stack only while it runs
    fn match_support(
        &self,
        summary: &mut Summary,
        m: &mut Buffers<'_>,
        observer: &mut dyn Observer,
    ) {
        let Plan { params, dims, support_models: models, .. } = *self.plan;
        let (images, plane) = (self.images, summary.plane);
        let grid = Grid::new(&params, dims);
        let grid = if plane.is_some() { grid.with_plane(m.rows.len()) } else { grid };
        let (half, noise) = (Grid::of_halves(&params, dims), support::Noise::of(images));
        let (row_offset, wants_curves) = (summary.row_offset(), observer.wants_curves());
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
        (summary.detail_q8, summary.range) =
            matching.run(self.regions.areas(), m.rows, &mut m.support, |index, seen| match seen {
                support::Seen::Curves(curves) => observer.support_curves(index, &curves),
                support::Seen::Evidence(evidence) => observer.support_point(index, evidence),
            });
        observer.on_event(StageEvent::Support(&m.support));
    }

    /// Matches each left segment; then computes the evidence between segments and support points
    /// nearby.
    #[inline(never)] // its variables are on the stack only while it runs
    fn match_segments(
        &self,
        summary: &mut Summary,
        m: &mut Buffers<'_>,
        observer: &mut dyn Observer,
    ) {
        let Plan { params, dims, models, .. } = self.plan;
        let (row_offset, plane) = (summary.row_offset(), summary.plane);
        let counts = &mut summary.counts;
        let support = Support::new(params, *dims, &m.support, summary.detail_q8).with_plane(plane);
        let context = MatchContext::new(params, models, *dims, support);
        let extents = self.regions.extents(&m.left, self.plan.disparities());
        let Some(mut band) = Band::new(self.images, row_offset, extents.as_deref(), m.rows) else {
            return;
        };
        let mut full = FullSearches::new(self.regions.areas(), *dims, params.cell);
        // Both lists by their first rows, as the band goes down.
        let mut unmatched = m.bars.iter_mut().enumerate().peekable();
        let mut match_bars = |to: i32,
                              band: &mut Band<'_>,
                              work: &mut Workspace,
                              observer: &mut dyn Observer| {
            while let Some((index, bar)) = unmatched.next_if(|(_, bar)| bar.edge().top() <= to) {
                band.advance_for(&bar.edge(), |planes| observer.row(planes));
                if let Some(evidence) = bars::match_bar(bar, &context, band, work, bars::LEAST_BAR)
                {
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
            (Grid::new(params, *dims), plane),
            &mut m.support,
        );
    }

    /// Rates the bars by the support points around them, and grows those that are told. Support
    /// points on their pixels that lie behind them take their disparity.
    #[inline(never)] // its variables are on the stack only while it runs
    fn place_bars(&self, summary: &Summary, m: &mut Buffers<'_>, observer: &mut dyn Observer) {
        let Plan { params, dims, .. } = self.plan;
        let support = Support::new(params, *dims, &m.support, summary.detail_q8);
        let least = params.min_confidence.max(bars::LEAST_BAR);
        bars::rate(&mut m.bars, support, least, |index, bar, nearby_q8| {
            observer.bar(index, bar, nearby_q8)
        });
        bars::grow(&mut m.bars, self.images, summary.row_offset(), least);
        bars::sort(&mut m.bars);
        bars::take_points(&mut m.support, Grid::new(params, *dims), &m.bars);
    }

    /// The row offset of the caller, 1/32 px.
    fn given_rows(&self) -> Option<i16> {
        self.row_offset_q5.map(|known| known.clamp(-row_offset::LIMIT_Q5, row_offset::LIMIT_Q5))
    }
}
