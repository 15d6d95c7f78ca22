//! `weigh.c` in Rust, on the core itself: a pair to its segments, points, health and the depth of a box, all added up.
#![no_std]

use core::cell::UnsafeCell;
use core::panic::PanicInfo;
use linestereo::{Area, Dims, Gray, Pair, Params, Region, Rig};

const QVGA: Dims = Dims { width: 320, height: 240 };
const PIXELS: usize = 320 * 240;
type BoardScratch = linestereo::scratch!(QVGA, 1024);

/// Memory of the one call.
struct Memory(UnsafeCell<BoardScratch>);

// SAFETY: the program has one thread, and calls `weigh` once.
unsafe impl Sync for Memory {}

static MEMORY: Memory = Memory(UnsafeCell::new(BoardScratch::new()));

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

/// Sum of all results of a QVGA pair; 0 where it is refused.
///
/// # Safety
/// Both point to an image; called once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn weigh(left: *const u8, right: *const u8, focal_px: f32, baseline_m: f32) -> u32 {
    // SAFETY: as this function's.
    let images = unsafe { [left, right].map(|image| core::slice::from_raw_parts(image, PIXELS)) };
    // SAFETY: as this function's.
    let scratch = unsafe { &mut *MEMORY.0.get() };
    sum(images, [focal_px, baseline_m], scratch).unwrap_or(0)
}

fn sum(images: [&[u8]; 2], [focal_px, baseline_m]: [f32; 2], scratch: &mut BoardScratch) -> Option<u32> {
    let rig = Rig::new(focal_px, baseline_m, 0.0).ok()?.centred(QVGA);
    // Known when it runs, as in C, and as on a board whose host sets them.
    let params = core::hint::black_box(Params { rig: Some(rig), ..Params::default() });
    let mut matcher = params.matcher(QVGA).ok()?;
    let [left, right] = images.map(|pixels| Gray::new(pixels, QVGA, QVGA.width.into()));
    let pair = Pair { left: left.ok()?, right: right.ok()?, times_us: None };
    let mut matched = matcher.run(pair, None, scratch.view(), &mut ()).ok()?;
    let health = matched.health().flags;
    let mut sum = health.bits();
    for found in matched.segments() {
        sum = sum.wrapping_add(u32::from(found.confidence.to_bits()));
        for (at, disparity) in found.ends.iter().zip(found.disparity) {
            let metres = found.depth.map_or(0, |[near, _]| near.to_bits());
            let disparity = i32::from(disparity.to_bits());
            sum = sum.wrapping_add((i32::from(at.x.to_bits()) + i32::from(at.y.to_bits()) + disparity + metres) as u32);
        }
    }
    matched.points(|point| sum = sum.wrapping_add((i32::from(point.disparity.to_bits()) + i32::from(point.x)) as u32));
    let area = Area { left: 80, top: 60, right: 240, bottom: 180 };
    if health.is_fit() {
        let region = Region::boxed(0, area, QVGA).ok()?;
        matched.objects(&[region], |object| {
            sum = sum.wrapping_add(object.disparity.map_or(0, |d| i32::from(d.to_bits())) as u32);
        });
    }
    Some(sum)
}
