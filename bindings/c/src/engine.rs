//! A matcher with its memory, as the functions of the header use it.

use crate::status::Status;
use crate::types::{Camera, Config, Depth, Health, Owner, Point, Segment};
use linestereo::image::{MAX_HEIGHT, MAX_WIDTH, MIN_SIDE};
use linestereo::scratch::{Capacity, Word};
use linestereo::{
    Area, Confidence, Dims, Disparity, Gray, HealthLimits, ImagePosition, Margin, Match, Matched, Matcher, Pair,
    Params, Parts, Position, Region, Rig, ScratchView, Source, Summary,
};

impl Config {
    /// The core's defaults for images of this size.
    pub const fn new(width: u16, height: u16) -> Self {
        let Params { min_disparity, max_disparity, anchor_gradient, edge_gradient, min_extent, cell, reach, .. } =
            Params::DEFAULT;
        let margin_q6 = match Params::DEFAULT.margin {
            Margin::Pixels(margin) => margin.to_bits(),
            Margin::Metres { .. } => 0,
        };
        Self {
            width,
            height,
            segments: 1024,
            min_disparity,
            max_disparity,
            anchor_gradient,
            edge_gradient,
            min_extent,
            cell,
            reach,
            min_confidence_q16: Params::DEFAULT.min_confidence.to_bits(),
            margin_q6,
            support_only: 0,
            has_principal_point: 0,
            focal_px: 0.0,
            baseline_m: 0.0,
            disparity_offset_px: 0.0,
            principal_point_px: [0.0; 2],
            skew_limit_us: HealthLimits::DEFAULT.skew_us,
        }
    }

    const fn dims(&self) -> Dims {
        Dims { width: self.width, height: self.height }
    }

    const fn capacity(&self) -> Capacity {
        Capacity { dims: self.dims(), segments: self.segments, cell: self.cell }
    }

    fn rig(&self) -> Result<Option<Rig>, Status> {
        if self.focal_px == 0.0 {
            return Ok(None);
        }
        let rig = Rig::new(self.focal_px, self.baseline_m, self.disparity_offset_px)?;
        let rig = if self.has_principal_point == 0 { rig } else { rig.with_principal_point(self.principal_point_px)? };
        Ok(Some(rig.centred(self.dims())))
    }

    fn matcher(&self) -> Result<Matcher, Status> {
        if !(MIN_SIDE..=MAX_WIDTH).contains(&self.width) || !(MIN_SIDE..=MAX_HEIGHT).contains(&self.height) {
            return Err(Status::ImageSize);
        }
        if !(1..=4096).contains(&self.segments) {
            return Err(Status::Segments);
        }
        let params = Params {
            min_disparity: self.min_disparity,
            max_disparity: self.max_disparity,
            rig: self.rig()?,
            anchor_gradient: self.anchor_gradient,
            edge_gradient: self.edge_gradient,
            min_extent: self.min_extent,
            cell: self.cell,
            margin: Margin::Pixels(Disparity::from_bits(self.margin_q6)),
            min_confidence: Confidence::from_bits(self.min_confidence_q16),
            reach: self.reach,
            parts: if self.support_only == 0 { Parts::Both } else { Parts::Support },
        };
        let mut matcher = params.matcher(self.dims())?;
        matcher.limits.skew_us = self.skew_limit_us;
        Ok(matcher)
    }

    /// Words of memory behind the matcher itself.
    pub fn words(&self) -> Result<usize, Status> {
        self.matcher().map(|_| self.capacity().words())
    }
}

/// A matcher, its memory, and its last pair.
pub struct Engine {
    matcher: Matcher,
    dims: Dims,
    rig: Option<Rig>,
    scratch: ScratchView<'static>,
    last: Option<(Summary, [Gray<'static>; 2])>,
}

impl Engine {
    pub fn new(config: &Config, memory: &'static mut [Word]) -> Result<Self, Status> {
        let matcher = config.matcher()?;
        let scratch = ScratchView::carve(memory, &config.capacity())?;
        Ok(Self { matcher, dims: config.dims(), rig: config.rig()?, scratch, last: None })
    }

    pub fn dims(&self) -> Dims {
        self.dims
    }

    pub fn run(
        &mut self,
        [left, right]: [Gray<'static>; 2],
        times_us: Option<[u64; 2]>,
        areas: Option<&[Area]>,
    ) -> Result<(), Status> {
        self.last = None;
        let pair = Pair { left, right, times_us };
        let summary = *self.matcher.run(pair, areas, self.scratch.reborrow(), &mut ())?.summary();
        self.last = Some((summary, [left, right]));
        Ok(())
    }

    fn matched(&mut self) -> Result<Matched<'_>, Status> {
        let (summary, images) = self.last.as_ref().ok_or(Status::NoPair)?;
        Ok(self.matcher.plan().resume(summary, *images, self.scratch.reborrow())?)
    }

    pub fn health(&self) -> Result<Health, Status> {
        let (summary, _) = self.last.as_ref().ok_or(Status::NoPair)?;
        let (health, counts) = (summary.health(), summary.counts());
        let camera = |camera: usize| {
            let of = health.cameras.get(camera).copied().unwrap_or_default();
            Camera {
                level: of.level.into(),
                detail_q4: of.detail_q4,
                black_permille: of.black_permille,
                white_permille: of.white_permille,
                view_permille: of.view_permille,
            }
        };
        Ok(Health {
            faults: health.flags.bits(),
            faults_now: health.now.bits(),
            is_fit: health.flags.is_fit().into(),
            is_refused: health.is_refused().into(),
            cameras: [camera(0), camera(1)],
            rows_q8: health.rows.map_or(0, |rows| rows.offset_q8),
            rows_samples: health.rows.map_or(0, |rows| rows.samples.into()),
            segments_found: counts.segments_left,
            segments_matched: counts.matched,
            is_cut: counts.is_cut().into(),
        })
    }

    pub fn segment(&mut self, index: usize) -> Result<Segment, Status> {
        self.matched()?.segments().get(index).map(Segment::new).ok_or(Status::NoSuchSegment)
    }

    pub fn points(&mut self, mut each: impl FnMut(Point)) -> Result<(), Status> {
        self.matched()?.points(|point| each(Point::new(&point)));
        Ok(())
    }

    /// The depth of one region. Its numbers are there in either case.
    pub fn object(&mut self, region: &Region<'_>) -> Result<(Depth, Status), Status> {
        let mut answer = (Depth::default(), Status::NoPair);
        self.matched()?.objects(core::slice::from_ref(region), |found| {
            let metres = |depth: Option<linestereo::Depth>| depth.map_or(0, linestereo::Depth::to_bits);
            let depth = Depth {
                disparity_q6: found.disparity.map_or(0, Disparity::to_bits),
                sigma_q6: found.sigma.to_bits(),
                confidence_q16: found.confidence.to_bits(),
                support: found.support,
                depth_q16: metres(found.depth),
                depth_sigma_q16: metres(found.depth_sigma),
                nearest_q16: metres(found.nearest),
            };
            answer = (depth, found.disparity.err().map_or(Status::Ok, Status::from));
        });
        Ok(answer)
    }

    pub fn pixel(&mut self, pixel: (u16, u16)) -> Result<Depth, Status> {
        let found = self.matched()?.pixel(pixel, None)?;
        Ok(Depth {
            disparity_q6: found.disparity.to_bits(),
            sigma_q6: found.sigma.to_bits(),
            confidence_q16: found.confidence.to_bits(),
            support: 0,
            depth_q16: found.depth.map_or(0, linestereo::Depth::to_bits),
            depth_sigma_q16: found.depth_sigma.map_or(0, linestereo::Depth::to_bits),
            nearest_q16: 0,
        })
    }

    /// Position in space, 1/65536 m.
    pub fn position(&self, x_q5: u16, y_q5: u16, disparity_q6: i16) -> Result<[i32; 3], Status> {
        let at = ImagePosition { x: Position::from_bits(x_q5), y: Position::from_bits(y_q5) };
        let rig = self.rig.as_ref().ok_or(Status::NoRig)?;
        let position = rig.xyz(at, Disparity::from_bits(disparity_q6)).ok_or(Status::Infinite)?;
        Ok(position.map(linestereo::Depth::to_bits))
    }
}

impl Segment {
    fn new(found: &Match) -> Self {
        let metres = |ends: Option<[linestereo::Depth; 2]>| ends.map_or([0; 2], |ends| ends.map(|end| end.to_bits()));
        Self {
            x_q5: found.ends.map(|end| end.x.to_bits()),
            y_q5: found.ends.map(|end| end.y.to_bits()),
            disparity_q6: found.disparity.map(Disparity::to_bits),
            sigma_q6: found.sigma.to_bits(),
            confidence_q16: found.confidence.to_bits(),
            owner: match found.owner {
                linestereo::Owner::Left => Owner::Left,
                linestereo::Owner::Right => Owner::Right,
                linestereo::Owner::Both => Owner::Both,
            },
            depth_q16: metres(found.depth),
            depth_sigma_q16: metres(found.depth_sigma),
        }
    }
}

impl Point {
    fn new(point: &linestereo::Point) -> Self {
        let segment = match point.source {
            Source::Segment(index) => index.into(),
            Source::Side => -1,
            Source::Support => -2,
        };
        let (disparity_q6, confidence_q16) = (point.disparity.to_bits(), point.confidence.to_bits());
        Self { x: point.x, y: point.y, disparity_q6, confidence_q16, segment }
    }
}
