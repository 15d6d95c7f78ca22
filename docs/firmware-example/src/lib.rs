#![no_std]
use linestereo::{Area, Depth, Dims, Gray, Matcher, Pair, Params, Region, Rig, scratch};

pub const DIMS: Dims = Dims { width: 320, height: 240 };
pub type Memory = scratch!(DIMS, 640); // 103 KiB, in a static

pub fn matcher() -> Option<Matcher> {
    let rig = Rig::new(250.0, 0.06, 0.0).ok(); // focal length px, baseline m
    Params { rig, ..Params::default() }.matcher(DIMS).ok()
}

/// Depth of what a detector found in the left of two rectified frames, m; `None` where it is not credible.
pub fn depth(matcher: &mut Matcher, memory: &mut Memory, [left, right]: [&[u8]; 2], found: Area) -> Option<Depth> {
    let [left, right] = [Gray::new(left, DIMS, 320).ok()?, Gray::new(right, DIMS, 320).ok()?];
    let mut matched = matcher.run(Pair { left, right, times_us: None }, None, memory.view(), &mut ()).ok()?;
    let mut depth = None;
    matched.objects(&[Region::boxed(0, found, DIMS).ok()?], |object| depth = object.depth);
    depth
}
