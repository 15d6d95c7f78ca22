//! The task of `program.h` by the core itself, with memory in a static of a size that the compiler
//! knows: as Rust programs of boards have it.
#![no_std]

use core::cell::UnsafeCell;
use linestereo::image::ViewError;
use linestereo::{
    Area, Capacity, Confidence, Depth, Dims, Gray, Match, Matched, Matcher, NoDepth, ObjectDepth, Pair, Params, Point,
    Region, Rig, Source, Span,
};

const QVGA: Dims = Dims { width: 320, height: 240 };
const PIXELS: usize = 320 * 240;

type Memory = linestereo::Memory<{ Capacity::new(QVGA).words() }>;

/// Working memory, used by [`program`] alone.
struct Static(UnsafeCell<Memory>);

// SAFETY: there is one thread.
unsafe impl Sync for Static {}

static MEMORY: Static = Static(UnsafeCell::new(Memory::new()));

/// `Settings` of program.h.
#[repr(C)]
pub struct Settings {
    focal_px: f32,
    baseline_m: f32,
    disparity_offset_px: f32,
    principal_point_px: [f32; 2],
    min_disparity: i16,
    max_disparity: u16,
    min_confidence_q16: u16,
    dims: [u16; 2],
}

/// `Input` of program.h.
#[repr(C)]
pub struct Input {
    times_us: [u64; 2],
    area: Area,
    region: Area,
    valid: [[Span; 240]; 2],
    left: [u8; PIXELS],
    right: [u8; PIXELS],
}

unsafe extern "C" {
    safe fn next();
    safe fn tell(sum: u32);
}

/// A sum that wraps.
struct Sum(u32);

impl Sum {
    fn add(&mut self, value: impl Into<i32>) {
        self.0 = self.0.wrapping_add_signed(value.into());
    }

    fn add_depth(&mut self, depth: Option<Depth>) {
        self.add(depth.map_or(0, Depth::to_bits));
    }

    fn add_health(&mut self, matched: &Matched<'_>) {
        let (health, counts) = (matched.health(), matched.counts());
        self.add(health.flags.bits().cast_signed());
        self.add(health.now.bits().cast_signed());
        self.add(health.flags.is_fit());
        self.add(health.is_refused());
        for of in &health.cameras {
            self.add(of.level);
            [of.detail_q4, of.black_permille, of.white_permille, of.view_permille]
                .into_iter()
                .for_each(|value| self.add(value));
        }
        if let Some(rows) = health.rows {
            self.add(rows.offset_q8);
            self.add(rows.samples);
        }
        self.add(counts.segments_left);
        self.add(counts.matched);
        self.add(counts.is_cut());
        self.add(matched.bars().len() as u16);
    }

    fn add_segment(&mut self, segment: &Match) {
        self.add(segment.sigma.to_bits());
        self.add(segment.confidence.to_bits());
        self.add(segment.owner as i32);
        for end in segment.ends {
            self.add(end.x.to_bits());
            self.add(end.y.to_bits());
        }
        segment.disparity.into_iter().for_each(|disparity| self.add(disparity.to_bits()));
        for depths in [segment.depth, segment.depth_sigma].into_iter().flatten() {
            depths.into_iter().for_each(|depth| self.add(depth.to_bits()));
        }
    }

    fn add_point(&mut self, point: &Point) {
        self.add(point.x);
        self.add(point.y);
        self.add(point.disparity.to_bits());
        self.add(point.confidence.to_bits());
        self.add(match point.source {
            Source::Segment(index) => index.into(),
            Source::Side => -1,
            Source::Support => -2,
        });
    }

    fn add_object(&mut self, found: &ObjectDepth) {
        match found.disparity {
            Ok(disparity) => {
                self.add(disparity.to_bits());
                self.add(found.sigma.to_bits());
                self.add(found.confidence.to_bits());
                self.add(found.support);
                [found.depth, found.depth_sigma, found.nearest].into_iter().for_each(|depth| self.add_depth(depth));
            }
            Err(reason) => self.add(code(reason)),
        }
    }
}

/// Codes of the library for C.
fn code(reason: NoDepth) -> i32 {
    match reason {
        NoDepth::LittleSupport => 100,
        NoDepth::TwoSurfaces => 101,
        NoDepth::OnlyOutline => 102,
        NoDepth::UnhealthyPair => 103,
        NoDepth::NoParallax => 104,
    }
}

fn view<'a>(pixels: &'a [u8], valid: &'a [Span; 240], dims: Dims) -> Result<Gray<'a>, ViewError> {
    let image = Gray::new(pixels, dims, dims.width.into())?;
    image.with_valid(valid.get(..dims.height.into()).unwrap_or_default())
}

fn sum(mut matched: Matched<'_>, area: Area) -> u32 {
    let mut sum = Sum(0);
    sum.add_health(&matched);
    matched.segments().iter().for_each(|segment| sum.add_segment(segment));
    matched.points(|point| sum.add_point(&point));
    match Region::boxed(0, area, matched.dims()) {
        Ok(region) => matched.objects(&[region], |found| sum.add_object(&found)),
        Err(_) => sum.add(40),
    }
    sum.0
}

fn matcher(settings: &Settings) -> Option<Matcher> {
    let rig = Rig::new(settings.focal_px, settings.baseline_m, settings.disparity_offset_px).ok()?;
    let params = Params {
        rig: Some(rig.with_principal_point(settings.principal_point_px).ok()?),
        min_disparity: settings.min_disparity,
        max_disparity: settings.max_disparity,
        min_confidence: Confidence::from_bits(settings.min_confidence_q16),
        ..Params::DEFAULT
    };
    let [width, height] = settings.dims;
    params.matcher(Dims { width, height }).ok()
}

/// See program.h.
#[unsafe(no_mangle)]
pub extern "C" fn program(settings: &Settings, input: &'static UnsafeCell<Input>) {
    // SAFETY: this is called once.
    let memory = unsafe { &mut *MEMORY.0.get() };
    let Some(mut matcher) = matcher(settings) else { return tell(u32::MAX) };
    let mut is_whole = true;
    loop {
        next();
        // SAFETY: nobody writes before the call of `next` for another pair.
        let input = unsafe { &*input.get() };
        let ([left_valid, right_valid], dims) = (&input.valid, matcher.plan().dims());
        let (Ok(left), Ok(right)) = (view(&input.left, left_valid, dims), view(&input.right, right_valid, dims)) else {
            tell(0);
            continue;
        };
        let pair = Pair { left, right, times_us: Some(input.times_us) };
        let areas = [input.area];
        let matched = matcher.run_with(pair, memory, (!is_whole).then_some(&areas), &mut ());
        tell(matched.map_or(0, |matched| sum(matched, input.region)));
        is_whole = !is_whole;
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
