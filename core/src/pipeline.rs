//! One rectified pair -> matches and points: the stages of a run.

use crate::area::Area;
use crate::bars::{self, Repeating};
use crate::cores::{Cores, join, lend};
use crate::focus::SearchRegions;
use crate::ground::{self, GroundPlane, GroundSearch};
use crate::health::{Measured, OfPoints, rows};
use crate::image::Gray;
use crate::lines::{self, LineParams};
use crate::list::List;
use crate::matched::{Matched, Summary};
use crate::matching::row_offset::{self, RowOffset};
use crate::matching::{FullSearches, MatchContext, consistency, surroundings};
use crate::memory::{Buffers, Scratch};
use crate::observe::{Observer, StageEvent};
use crate::params::Parts;
use crate::plan::Plan;
use crate::report::Report;
use crate::result::{Match, Rejection};
use crate::segment_stage::{Part, SegmentStage};
use crate::support::{self, Grid, Noise};

/// Columns between two scans for the near-horizontal edges of the right image, not all of which are
/// needed.
const RIGHT_SCAN_STEP: i32 = 3 * lines::SCAN_STEP;

/// A run: the pair, and all that its stages read of the caller.
pub(crate) struct Run<'r, 'a> {
    pub(crate) plan: &'r Plan,
    pub(crate) images: [Gray<'a>; 2],
    /// Areas of the left image that are matched.
    pub(crate) regions: SearchRegions,
    /// Rows to add to a left row for the matching right one, 1/32 px, as a pair before it said.
    pub(crate) known_rows_q5: Option<i16>,
    /// They are estimated, and those known are for too few segments.
    pub(crate) estimates_rows: bool,
    /// Where the ground plane is looked for.
    pub(crate) ground: GroundSearch,
    /// Parts of the method, instead of those of the parameters.
    pub(crate) parts: Parts,
    /// Bars are found and placed.
    pub(crate) has_bars: bool,
}

impl<'a> Run<'_, 'a> {
    /// Runs every stage, in the buffers for these images. The candidates in areas are those of a
    /// run over the whole frame, given its row offset, but where bars repeat: whole frames alone
    /// have bars, and here nothing is left out. The confidence of matches and points also
    /// depends on neighbours, which are missing outside of the areas: near their borders it may
    /// differ. The observer is a trait object, so that this is compiled once, with this crate's
    /// settings. On two cores the pair is measured for its health as well, beside the report.
    ///
    /// # Cost
    /// About in proportion to the areas, each grown by some 20 px, and in the right image by the
    /// disparity range as well.
    pub(crate) fn stages(
        &self,
        mut cores: Option<&mut dyn Cores>,
        mut m: Buffers<'a>,
        observer: &mut dyn Observer,
    ) -> (Matched<'a>, Option<Measured>) {
        let is_whole = self.regions.areas().is_none();
        let mut summary = Summary { is_whole, ..Summary::default() };
        let mut repeating = Repeating::default();
        if self.parts == Parts::Support {
            summary.row_offset_q5 = self.known_rows();
        } else {
            repeating = self.find_segments(lend(&mut cores), &mut m, &mut summary, observer);
        }
        let Plan { params, dims, support_models, .. } = self.plan;
        if params.ground {
            let others = m.second.as_mut().map(|second| &mut *second.scratch.rows);
            summary.plane = ground::find(
                lend(&mut cores),
                others,
                self.images,
                summary.row_offset(),
                params.max_disparity,
                self.ground,
                m.scratch.rows,
            );
        }
        self.match_support(lend(&mut cores), &mut summary, &mut m, observer);
        repeating.clear(&mut m.support, Grid::new(params, *dims));
        if self.parts != Parts::Support {
            self.match_segments(lend(&mut cores), &repeating, &mut summary, &mut m, observer);
        }
        support::rate(
            lend(&mut cores),
            &mut m.support,
            Grid::new(params, *dims),
            summary.detail_q8,
            summary.plane,
            support_models.of_size(dims.is_large(), summary.plane.is_some()),
        );
        observer.on_event(StageEvent::Consistency(&m.candidates, &m.support));
        self.place_bars(&summary, &mut m, observer);

        let (mut report, matches) = Report::new(self.plan, self.images, &mut m, &summary);
        let measured = if let Some(cores) = cores {
            Some(self.report_on(cores, &mut report, matches, &mut summary))
        } else {
            report.run(matches, &mut summary.counts);
            None
        };
        observer.on_event(StageEvent::Report(matches));
        (Matched { plan: *self.plan, images: self.images, buffers: m, summary }, measured)
    }

    /// Completes the report on one core; measures the pair for its health beside it.
    #[inline(never)] // its variables are on the stack only while it runs
    fn report_on(
        &self,
        cores: &mut dyn Cores,
        report: &mut Report<'_>,
        matches: &mut List<'_, Match>,
        summary: &mut Summary,
    ) -> Measured {
        let ([left, right], support, offset) = (self.images, report.support, summary.row_offset());
        let is_whole = summary.is_whole;
        let (mut of_points, mut by_edges) = (OfPoints::default(), None);
        cores.join(
            &mut || {
                report.run(matches, &mut summary.counts);
                by_edges = rows::measure(left, right, matches);
            },
            &mut || of_points = OfPoints::new([left, right], support, offset, is_whole),
        );
        Measured { of_points, by_edges }
    }

    /// Detects the segments of both images, finds the bars, and keeps the prominent segments of the
    /// left image. Sets the row offset, if it is known. Returns where bars repeat.
    #[inline(never)] // its variables are on the stack only while it runs
    fn find_segments(
        &self,
        mut cores: Option<&mut dyn Cores>,
        m: &mut Buffers<'_>,
        summary: &mut Summary,
        observer: &mut dyn Observer,
    ) -> Repeating {
        let counts = &mut summary.counts;
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
        let areas = regions.left(params.cell);
        let areas = areas.as_deref();
        let found = match (lend(&mut cores), &mut m.second) {
            (Some(cores), Some(second)) => lines::detect_on(
                cores,
                *left,
                areas,
                &lines,
                [m.scratch.lines(), second.scratch.lines()],
                [&mut m.left, &mut m.right],
            ),
            _ => lines::detect(*left, areas, &lines, m.scratch.lines(), &mut m.left),
        };
        (counts.segments_left_dropped, counts.edges_cut) = (found.segments, found.edges);
        counts.edge_units = found.units;
        observer.on_event(StageEvent::LinesLeft(&m.left));
        let (has_bars, has_right) = (self.has_bars, self.estimates_rows);
        let (has_two, known_q5) = (cores.is_some(), self.known_rows());
        let estimate = |left: &[_], right: &[_]| {
            if !has_right {
                return RowOffset { offset_q5: known_q5, cut: 0 };
            }
            let pixels = Area::of(*dims).pixels();
            let found = row_offset::estimate(left, right, self.plan.disparities(), pixels);
            RowOffset { offset_q5: found.offset_q5.or(known_q5), ..found }
        };
        let mut estimated = None;
        let Buffers { scratch, second, left: segments, right: others, bars, .. } = m;
        let segments = &**segments;
        others.clear();
        let find_right = || {
            if has_right {
                let areas = regions.right(segments, params);
                let scratch = scratch.lines();
                let found = lines::detect(*right, areas.as_deref(), &right_lines, scratch, others);
                counts.segments_right_dropped = found.segments;
                counts.edges_cut = counts.edges_cut.saturating_add(found.edges);
                counts.edge_units += found.units;
                lines::sort_by_top(others);
            }
            if has_two {
                estimated = Some(estimate(segments, others));
            }
        };
        let mut repeating = Repeating::default();
        match (cores, second) {
            (Some(cores), Some(second)) if has_bars => {
                repeating =
                    bars::find_on(cores, *left, segments, bars, &mut second.bars, find_right);
            }
            (cores, _) => {
                let find_bars = || {
                    if has_bars {
                        repeating = bars::find(*left, segments, bars);
                    }
                };
                join(cores, find_bars, find_right);
            }
        }
        observer.on_event(StageEvent::LinesRight(&m.right));
        counts.segments_right = u16::try_from(m.right.len()).unwrap_or(u16::MAX);
        let RowOffset { offset_q5, cut } = estimated.unwrap_or_else(|| estimate(&m.left, &m.right));
        counts.comparisons_cut = cut;
        let lost = lines::keep_prominent(
            &mut m.left,
            params.cell.into(),
            m.candidates.capacity(),
            dims.width.into(),
            m.scratch.marks,
        );
        m.left.retain(|segment| regions.contains(segment));
        lines::sort_by_top(&mut m.left);
        counts.segments_left = u16::try_from(m.left.len()).unwrap_or(u16::MAX).saturating_add(lost);
        counts.reject_many(Rejection::LessProminent, lost);
        observer.on_event(StageEvent::Selection(offset_q5.unwrap_or(0).into(), &m.left));
        summary.row_offset_q5 = offset_q5;
        repeating
    }

    /// Matches the support points. Sets the detail of the left image, and what was found beyond the
    /// range.
    #[inline(never)] // its variables are on the stack only while it runs
    fn match_support(
        &self,
        mut cores: Option<&mut dyn Cores>,
        summary: &mut Summary,
        m: &mut Buffers<'_>,
        observer: &mut dyn Observer,
    ) {
        let Plan { params, dims, support_models: models, .. } = *self.plan;
        let (images, plane) = (self.images, summary.plane);
        let grid = Grid::new(&params, dims);
        let grid = if plane.is_some() { grid.with_plane(m.scratch.rows.len()) } else { grid };
        let half = Grid::of_halves(&params, dims);
        summary.noise = Noise::of(lend(&mut cores), images);
        let noise = Noise::larger(summary.noise);
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
        let overall = matching.run(
            self.regions.areas(),
            cores,
            m.scratch.rows,
            &mut m.support,
            |index, seen| match seen {
                support::Seen::Curves(curves) => observer.support_curves(index, &curves),
                support::Seen::Evidence(evidence) => observer.support_point(index, evidence),
            },
        );
        (summary.detail_q8, summary.range) = (overall.detail_q8, overall.range);
        observer.on_event(StageEvent::Support(&m.support));
    }

    /// Matches each left segment; then computes the evidence between segments and support points
    /// nearby.
    #[inline(never)] // its variables are on the stack only while it runs
    fn match_segments(
        &self,
        mut cores: Option<&mut dyn Cores>,
        repeating: &Repeating,
        summary: &mut Summary,
        m: &mut Buffers<'_>,
        observer: &mut dyn Observer,
    ) {
        let Plan { params, dims, models, .. } = self.plan;
        let (row_offset, plane) = (summary.row_offset(), summary.plane);
        let support = summary.support(self.plan, &m.support);
        let counts = &mut summary.counts;
        let context = MatchContext::new(params, models, *dims, support).outside(repeating.areas());
        let extents = self.regions.extents(&m.left, self.plan.disparities());
        let mut full = FullSearches::new(self.regions.areas(), *dims, params.cell);
        let stage =
            SegmentStage { images: self.images, row_offset, context, extents: extents.as_deref() };
        let Scratch { rows, work, .. } = &mut m.scratch;
        let all = Part { segments: &m.left, bars: &mut m.bars, rows, work };
        match (lend(&mut cores), &mut m.second) {
            (Some(cores), Some(second)) => {
                stage.run_on(cores, all, second, &mut full, &mut m.candidates, counts);
            }
            _ => {
                let search = |segment: &_| full.allow(segment, stage.context.search(segment));
                stage.run(all, search, &mut m.candidates, counts, observer);
            }
        }
        let cut = compare_nearby(cores, Grid::new(params, *dims), plane, m);
        counts.comparisons_cut = counts.comparisons_cut.saturating_add(cut);
    }

    /// Rates the bars by the support points around them, and grows those that are told. Support
    /// points on their pixels that lie behind them take their disparity.
    #[inline(never)] // its variables are on the stack only while it runs
    fn place_bars(&self, summary: &Summary, m: &mut Buffers<'_>, observer: &mut dyn Observer) {
        let Plan { params, dims, .. } = self.plan;
        let support = summary.support(self.plan, &m.support);
        let least = params.min_confidence.max(bars::LEAST_BAR);
        bars::rate(&mut m.bars, support, least, |index, bar, nearby_q8| {
            observer.bar(index, bar, nearby_q8)
        });
        bars::grow(&mut m.bars, self.images, summary.row_offset(), least);
        bars::sort(&mut m.bars);
        bars::take_points(&mut m.support, Grid::new(params, *dims), &m.bars);
    }

    /// The row offset of a pair before, 1/32 px.
    fn known_rows(&self) -> Option<i16> {
        self.known_rows_q5.map(|known| known.clamp(-row_offset::LIMIT_Q5, row_offset::LIMIT_Q5))
    }
}

/// Computes the evidence between segments, and between segments and support points; returns how
/// many comparisons were left out.
#[inline(never)] // its variables are on the stack only while it runs
fn compare_nearby(
    cores: Option<&mut dyn Cores>,
    grid: Grid,
    plane: Option<GroundPlane>,
    m: &mut Buffers<'_>,
) -> u16 {
    let Buffers { candidates, neighbours, support, .. } = m;
    let neighbours = consistency::neighbours(candidates, neighbours);
    let mut cut = 0;
    join(
        cores,
        || cut = consistency::accumulate_support(neighbours),
        || surroundings::evaluate_sides(candidates, grid, plane, support),
    );
    consistency::take_support(candidates, neighbours);
    cut
}
