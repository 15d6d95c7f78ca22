//! Segments and bars -> candidates and matched bars, from the top of the pair down, on one core or
//! two.
//!
//! In: both lists by their first rows, support points. Out: a candidate for each segment that
//! passes the hard tests, in their order, and bars with their disparities.
//!
//! ```text
//! one core     the band of rows moves down the pair; each segment and bar is matched in it
//! two cores    search: where each segment is looked for, half of them on each
//!              whole searches are given to segments from the top down, as on one core
//!              the list is cut at a row by the cost of its parts: each has its band
//! ```
//!
//! # Cost
//! On two cores the rows that windows of both parts reach are computed twice: some 20 of the band.

use crate::bars::{self, Bar};
use crate::cores::Cores;
use crate::image::Gray;
use crate::lines::Segment;
use crate::list::List;
use crate::matching::band::{Band, WindowExtent};
use crate::matching::{
    self, Candidate, FullSearches, MatchContext, Search, SegmentCurves, Workspace,
};
use crate::memory::Second;
use crate::observe::{Observer, StageEvent};
use crate::result::Counts;
use core::slice::Iter;

/// All that is read of a pair.
pub(crate) struct SegmentStage<'s, 'a> {
    pub(crate) images: [Gray<'a>; 2],
    pub(crate) row_offset: i32,
    pub(crate) context: MatchContext<'s>,
    /// Pixels that windows reach; all without.
    pub(crate) extents: Option<&'s [WindowExtent]>,
}

/// Segments and bars of some rows, the memory of their band and of each segment.
pub(crate) struct Part<'p> {
    pub(crate) segments: &'p [Segment],
    pub(crate) bars: &'p mut [Bar],
    pub(crate) rows: &'p mut [u8],
    pub(crate) work: &'p mut Workspace,
}

impl SegmentStage<'_, '_> {
    /// Matches the segments and bars of a part; `search` says where each segment is looked for, and
    /// is called in their order. Adds to the candidates, and to the counts of searches and
    /// rejections.
    pub(crate) fn run(
        &self,
        part: Part<'_>,
        mut search: impl FnMut(&Segment) -> Search,
        candidates: &mut List<'_, Candidate>,
        counts: &mut Counts,
        observer: &mut dyn Observer,
    ) {
        let Part { segments, bars, rows, work } = part;
        let Some(mut band) = Band::new(self.images, self.row_offset, self.extents, rows) else {
            return;
        };
        // Both lists by their first rows, as the band goes down.
        let mut unmatched = bars.iter_mut().enumerate().peekable();
        let mut match_bars =
            |to: i32, band: &mut Band<'_>, work: &mut Workspace, observer: &mut dyn Observer| {
                while let Some((index, bar)) = unmatched.next_if(|(_, bar)| bar.edge().top() <= to)
                {
                    band.advance_for(&bar.edge(), &mut |planes| observer.row(planes));
                    if let Some(evidence) =
                        bars::match_bar(bar, &self.context, band, work, bars::LEAST_BAR)
                    {
                        observer.bar_evidence(index, &evidence);
                    }
                }
            };
        for segment in segments {
            match_bars(segment.top(), &mut band, work, observer);
            band.advance_for(segment, &mut |planes| observer.row(planes));
            observer.on_event(StageEvent::Rows);
            if observer.wants_curves() {
                work.clear_curves();
            }
            let search = search(segment);
            let outcome = matching::match_segment(segment, &self.context, search, &band, work);
            if observer.wants_curves() {
                observer.segment_curves(&SegmentCurves::new(segment, work));
            }
            counts.searched_fully += u16::from(search == Search::Full);
            counts.comparisons_cut =
                counts.comparisons_cut.saturating_add(u16::from(search == Search::Cut));
            match outcome {
                Ok(candidate) => {
                    let _ = candidates.push(candidate); // there is room for one of each segment
                    if let Some(candidate) = candidates.last() {
                        observer.on_event(StageEvent::Segment(Ok((candidate, &work.evidence))));
                    }
                }
                Err(reason) => {
                    observer.on_event(StageEvent::Segment(Err(reason)));
                    counts.reject(reason);
                }
            }
        }
        match_bars(i32::MAX, &mut band, work, observer);
    }

    /// Matches all segments and bars on two cores, `second` with memory of its own.
    pub(crate) fn run_on(
        &self,
        cores: &mut dyn Cores,
        all: Part<'_>,
        second: &mut Second<'_>,
        full: &mut FullSearches<'_>,
        candidates: &mut List<'_, Candidate>,
        counts: &mut Counts,
    ) {
        let Part { segments, bars, rows, work } = all;
        let Second { scratch, searches, .. } = second;
        self.find_searches(cores, segments, full, searches);
        let at = self.middle(segments, bars, searches);
        let (Some((above, below)), Some((above_searches, below_searches))) =
            (segments.split_at_checked(at), searches.split_at_checked(at))
        else {
            return;
        };
        let top = below.first().map_or(i32::MAX, Segment::top);
        let bars_above = bars.partition_point(|bar| bar.edge().top() < top);
        let Some((bars_above, bars_below)) = bars.split_at_mut_checked(bars_above) else { return };
        let mut others = Counts::default();
        candidates.fill_in_two(at, |first, second| {
            let next =
                |searches: &mut Iter<'_, Search>| searches.next().copied().unwrap_or(Search::Cut);
            cores.join(
                &mut || {
                    let part = Part { segments: above, bars: bars_above, rows, work };
                    let mut searches = above_searches.iter();
                    self.run(part, |_| next(&mut searches), first, counts, &mut ());
                },
                &mut || {
                    let (rows, work) = (&mut *scratch.rows, &mut *scratch.work);
                    let part = Part { segments: below, bars: bars_below, rows, work };
                    let mut searches = below_searches.iter();
                    self.run(part, |_| next(&mut searches), second, &mut others, &mut ());
                },
            );
        });
        counts.merge(&others);
    }

    /// Where each segment is looked for.
    fn find_searches(
        &self,
        cores: &mut dyn Cores,
        segments: &[Segment],
        full: &mut FullSearches<'_>,
        searches: &mut List<'_, Search>,
    ) {
        searches.clear();
        for _ in segments {
            let _ = searches.push(Search::Cut); // there is room for one of each segment
        }
        let at = segments.len() / 2;
        let (Some((above, below)), Some((first, second))) =
            (segments.split_at_checked(at), searches.split_at_mut_checked(at))
        else {
            return;
        };
        let find = |segments: &[Segment], searches: &mut [Search]| {
            for (segment, search) in segments.iter().zip(searches) {
                *search = self.context.search(segment);
            }
        };
        cores.join(&mut || find(above, first), &mut || find(below, second));
        for (segment, search) in segments.iter().zip(searches.iter_mut()) {
            *search = full.allow(segment, *search);
        }
    }

    /// The first segment of the second part, so that both cost about the same.
    fn middle(&self, segments: &[Segment], bars: &[Bar], searches: &[Search]) -> usize {
        let [left, _] = self.images;
        let cost = |search: &Search| match search {
            Search::Directed(..) => DIRECTED_COST,
            Search::Full => FULL_COST,
            Search::Cut | Search::Repeats => 0,
        };
        let all = bars.len() as i32 * BAR_COST
            + searches.iter().map(cost).sum::<i32>()
            + ROW_COST * (i32::from(left.dims().height) + OVERLAP);
        let (mut above, mut bars) = (ROW_COST * OVERLAP, bars.iter().peekable());
        for (index, (segment, search)) in segments.iter().zip(searches).enumerate() {
            while bars.next_if(|bar| bar.edge().top() < segment.top()).is_some() {
                above += BAR_COST;
            }
            if 2 * (above + ROW_COST * segment.top()) >= all {
                return index;
            }
            above += cost(search);
        }
        segments.len()
    }
}

/// Costs in units of some 2700 instructions: of a pixel row of the band, of a segment that is
/// searched around support points, of one that is searched everywhere, which most tests refuse, of
/// a bar; by least squares over captured pairs.
const ROW_COST: i32 = 2;
const DIRECTED_COST: i32 = 5;
const FULL_COST: i32 = 2;
const BAR_COST: i32 = 8;
/// Rows that the part above reaches below the first one of that below it, and a little more.
const OVERLAP: i32 = 36;
