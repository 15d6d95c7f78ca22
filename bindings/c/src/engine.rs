//! A matcher with its memory, as the functions of the header use it.

use crate::status::Status;
use crate::types::{Bar, Camera, CameraPose, Config, Depth, Ground, Health, Owner, Point, Segment};
use linestereo::ground::{CameraPose as CorePose, GroundPlane};
use linestereo::health::{CameraHealth, HealthLimits};
use linestereo::image::{MAX_HEIGHT, MAX_WIDTH, MIN_SIDE};
use linestereo::params::{Margin, Parts};
use linestereo::results::{ImagePosition, Match, Source};
use linestereo::units::{Confidence, Disparity, Position};
use linestereo::{
    Capacity, Dims, Gray, Matched, Matcher, MemorySlice, ObjectDepth, Options, Params, Region, Rig,
};

impl Config {
    /// The core's defaults for images of this size.
    pub const fn new(width: u16, height: u16) -> Self {
        let Params {
            min_disparity,
            max_disparity,
            anchor_gradient,
            edge_gradient,
            min_extent,
            cell,
            reach,
            ..
        } = Params::DEFAULT;
        let margin_q6 = match Params::DEFAULT.margin {
            Margin::Pixels(margin) => margin.to_bits(),
            Margin::Metres { .. } => 0,
        };
        Self {
            width,
            height,
            segments: 1024,
            min_disparity,
            max_disparity: if width >= MIN_SIDE && max_disparity >= width {
                width - 1
            } else {
                max_disparity
            },
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

    pub const fn capacity(&self) -> Capacity {
        Capacity { dims: self.dims(), segments: self.segments, cell: self.cell, two_cores: false }
    }

    fn rig(&self) -> Result<Option<Rig>, Status> {
        if self.focal_px == 0.0 {
            return Ok(None);
        }
        let rig = Rig::new(self.focal_px, self.baseline_m, self.disparity_offset_px)?;
        Ok(Some(if self.has_principal_point == 0 {
            rig
        } else {
            rig.with_principal_point(self.principal_point_px)?
        }))
    }

    /// True for sizes that are accepted.
    #[inline(never)] // what follows from the bounds would be worked into the code behind it: 200 bytes
    fn has_size(&self) -> bool {
        (MIN_SIDE..=MAX_WIDTH).contains(&self.width)
            && (MIN_SIDE..=MAX_HEIGHT).contains(&self.height)
    }

    /// A matcher with these parameters, all of them checked.
    pub fn matcher(&self) -> Result<Matcher, Status> {
        if !self.has_size() {
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
            ground: true,
        };
        let mut matcher = Matcher::new(params, self.dims())?;
        matcher.limits.skew_us = self.skew_limit_us;
        Ok(matcher)
    }

    /// Words of memory behind the matcher itself.
    pub fn words(&self) -> Result<usize, Status> {
        self.matcher().map(|_| self.capacity().words())
    }
}

/// A matcher with its memory, in which the last pair is.
pub struct Engine {
    matcher: Matcher,
    /// Lent to the last pair.
    memory: *mut MemorySlice,
    /// The last pair, or why there is none.
    last: Result<Matched<'static>, Status>,
}

impl Engine {
    pub fn new(matcher: Matcher, memory: &'static mut MemorySlice) -> Self {
        Self { matcher, memory, last: Err(Status::NoPair) }
    }

    pub fn dims(&self) -> Dims {
        self.matcher.dims()
    }

    pub fn params(&self) -> &Params {
        self.matcher.params()
    }

    /// From here on there is no last pair.
    pub fn forget(&mut self) {
        self.last = Err(Status::NoPair);
    }

    /// Matches a pair; where it cannot be matched there is no last one.
    pub fn run(
        &mut self,
        left: Gray<'static>,
        right: Gray<'static>,
        options: Options<'_>,
    ) -> Result<(), Status> {
        self.forget(); // it borrows the memory that is lent here
        #[allow(unsafe_code, reason = "the last pair borrows what is beside it")]
        // SAFETY: it was made from a reference, and the pair that it was lent to is gone.
        let memory = unsafe { &mut *self.memory };
        self.last = self.matcher.run_with(memory, left, right, options).map_err(Status::from);
        if self.matched()?.is_fit() { Ok(()) } else { Err(Status::PairUnfit) }
    }

    /// States the camera's pose for the pairs that follow, or that it is not known.
    pub fn expect_ground(&mut self, pose: Option<&CameraPose>) -> Result<(), Status> {
        let plane = match pose {
            Some(&CameraPose { height_m, pitch_deg, roll_deg }) => {
                let rig = self.params().rig.ok_or(Status::NoRig)?;
                let pose = CorePose { height_m, pitch_deg, roll_deg };
                Some(GroundPlane::of_pose(pose, &rig, self.dims())?)
            }
            None => None,
        };
        self.matcher.expect_ground(plane);
        Ok(())
    }

    /// The ground plane of the last pair.
    pub fn ground(&mut self) -> Result<Ground, Status> {
        let (rig, dims) = (self.params().rig, self.dims());
        let plane = self.matched()?.ground().ok_or(Status::NoGround)?;
        let none = CorePose { height_m: 0.0, pitch_deg: 0.0, roll_deg: 0.0 };
        let pose = rig.and_then(|rig| CorePose::of_plane(plane, &rig, dims)).unwrap_or(none);
        let CorePose { height_m, pitch_deg, roll_deg } = pose;
        let GroundPlane { down_q16, across_q16, origin_q16 } = plane;
        let camera = CameraPose { height_m, pitch_deg, roll_deg };
        Ok(Ground { down_q16, across_q16, origin_q16, camera })
    }

    /// The last pair.
    pub fn matched(&mut self) -> Result<&mut Matched<'static>, Status> {
        self.last.as_mut().map_err(|status| *status)
    }

    pub fn health(&mut self) -> Result<Health, Status> {
        let matched = self.matched()?;
        let (health, counts) = (matched.health(), matched.counts());
        let [left, right] = &health.cameras;
        Ok(Health {
            faults: health.flags.bits(),
            faults_now: health.now.bits(),
            is_fit: health.flags.is_fit().into(),
            is_refused: health.is_refused().into(),
            cameras: [Camera::new(left), Camera::new(right)],
            rows_q8: health.rows.map_or(0, |rows| rows.offset_q8),
            rows_samples: health.rows.map_or(0, |rows| rows.samples.into()),
            segments_found: counts.segments_left,
            segments_matched: matched.segments().len() as u16, // at most 4096
            is_cut: counts.is_cut().into(),
            bars: matched.bars().len() as u16, // at most 32
        })
    }

    pub fn segment(&mut self, index: usize) -> Result<Segment, Status> {
        self.matched()?.segments().get(index).map(Segment::new).ok_or(Status::NoSuchSegment)
    }

    pub fn bar(&mut self, index: usize) -> Result<Bar, Status> {
        let rig = self.matcher.params().rig;
        self.matched()?.bars().get(index).map(|found| Bar::new(found, rig)).ok_or(Status::NoSuchBar)
    }

    pub fn points(&mut self, mut each: impl FnMut(Point)) -> Result<(), Status> {
        self.matched()?.points().for_each(|point| each(Point::new(&point)));
        Ok(())
    }

    /// Writes the depth of one region; where it has none, what supports it.
    pub fn object(&mut self, region: &Region<'_>, depth: &mut Depth) -> Result<(), Status> {
        match self.matched()?.object(region) {
            Ok(found) => {
                *depth = Depth::of_object(&found);
                Ok(())
            }
            Err(why) => {
                depth.support = why.support;
                Err(why.reason.into())
            }
        }
    }

    /// Writes the depth of a pixel.
    pub fn pixel(&mut self, pixel: (u16, u16), depth: &mut Depth) -> Result<(), Status> {
        let found = self.matched()?.pixel(pixel)?;
        *depth = Depth {
            disparity_q6: found.disparity.to_bits(),
            sigma_q6: found.sigma.to_bits(),
            confidence_q16: found.confidence.to_bits(),
            support: 0,
            depth_q16: metres(found.depth),
            depth_sigma_q16: metres(found.depth_sigma),
            nearest_q16: 0,
        };
        Ok(())
    }

    /// Position in space, 1/65536 m.
    pub fn position(&self, x_q5: u16, y_q5: u16, disparity_q6: i16) -> Result<[i32; 3], Status> {
        let at = ImagePosition { x: Position::from_bits(x_q5), y: Position::from_bits(y_q5) };
        let rig = self.matcher.params().rig.ok_or(Status::NoRig)?.centred(self.dims());
        let position = rig.xyz(at, Disparity::from_bits(disparity_q6)).ok_or(Status::Infinite)?;
        Ok(position.map(linestereo::units::Depth::to_bits))
    }
}

fn metres(depth: Option<linestereo::units::Depth>) -> i32 {
    depth.map_or(0, linestereo::units::Depth::to_bits)
}

fn metres_of_ends(ends: Option<[linestereo::units::Depth; 2]>) -> [i32; 2] {
    // Not by `map` of arrays, which is a loop and a copy each.
    ends.map_or([0; 2], |[start, end]| [start.to_bits(), end.to_bits()])
}

impl Depth {
    pub const NONE: Self = Self {
        disparity_q6: 0,
        sigma_q6: 0,
        confidence_q16: 0,
        support: 0,
        depth_q16: 0,
        depth_sigma_q16: 0,
        nearest_q16: 0,
    };

    fn of_object(found: &ObjectDepth) -> Self {
        Self {
            disparity_q6: found.disparity.to_bits(),
            sigma_q6: found.sigma.to_bits(),
            confidence_q16: found.confidence.to_bits(),
            support: found.support,
            depth_q16: metres(found.metres.map(|metres| metres.depth)),
            depth_sigma_q16: metres(found.metres.map(|metres| metres.sigma)),
            nearest_q16: metres(found.metres.map(|metres| metres.nearest)),
        }
    }
}

impl Camera {
    fn new(of: &CameraHealth) -> Self {
        Self {
            level: of.level.into(),
            detail_q4: of.detail_q4,
            black_permille: of.black_permille,
            white_permille: of.white_permille,
            view_permille: of.view_permille,
        }
    }
}

impl Segment {
    fn new(found: &Match) -> Self {
        let ([start, end], [disparity_start, disparity_end]) = (found.ends, found.disparity);
        Self {
            x_q5: [start.x.to_bits(), end.x.to_bits()],
            y_q5: [start.y.to_bits(), end.y.to_bits()],
            disparity_q6: [disparity_start.to_bits(), disparity_end.to_bits()],
            sigma_q6: found.sigma.to_bits(),
            confidence_q16: found.confidence.to_bits(),
            owner: match found.owner {
                linestereo::results::Owner::Left => Owner::Left,
                linestereo::results::Owner::Right => Owner::Right,
                linestereo::results::Owner::Both => Owner::Both,
            },
            depth_q16: metres_of_ends(found.depth),
            depth_sigma_q16: metres_of_ends(found.depth_sigma),
        }
    }
}

impl Bar {
    fn new(found: &linestereo::results::Bar, rig: Option<Rig>) -> Self {
        let ([top, bottom], [upper, lower]) = (found.ends(), found.disparity());
        let sigma = found.sigma();
        let depths = |rig: Rig| [rig.depth(upper), rig.depth(lower)];
        let sigmas = |rig: Rig| [rig.depth_sigma(upper, sigma), rig.depth_sigma(lower, sigma)];
        Self {
            x_q5: [top.x.to_bits(), bottom.x.to_bits()],
            y_q5: [top.y.to_bits(), bottom.y.to_bits()],
            width_q5: found.width().to_bits(),
            disparity_q6: [upper.to_bits(), lower.to_bits()],
            sigma_q6: sigma.to_bits(),
            confidence_q16: found.confidence().to_bits(),
            depth_q16: metres_of_ends(rig.map(depths)),
            depth_sigma_q16: metres_of_ends(rig.map(sigmas)),
        }
    }
}

impl Point {
    fn new(point: &linestereo::results::Point) -> Self {
        let segment = match point.source {
            Source::Segment(index) => index.into(),
            Source::Side => -1,
            _ => -2,
        };
        let (disparity_q6, confidence_q16) =
            (point.disparity.to_bits(), point.confidence.to_bits());
        Self { x: point.x, y: point.y, disparity_q6, confidence_q16, segment }
    }
}
