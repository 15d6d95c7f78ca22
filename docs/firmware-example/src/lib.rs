#![no_std]
use linestereo::{Area, Capacity, Dims, Gray, Matcher, ObjectDepth, Params, Region, Rig};

pub const DIMS: Dims = Dims { width: 320, height: 240 };
pub type Memory = linestereo::Memory<{ Capacity::new(DIMS).words() }>; // in a static

pub fn matcher() -> Option<Matcher> {
    let rig = Rig::new(250.0, 0.06, 0.0).ok(); // focal length px, baseline m
    Matcher::new(Params { rig, ..Params::default() }, DIMS).ok()
}

/// Depth of an object that a detector found in the left image; `None` where it is not credible.
pub fn depth(
    matcher: &mut Matcher,
    memory: &mut Memory,
    [left, right]: [&[u8]; 2],
    object: Area,
) -> Option<ObjectDepth> {
    let [left, right] = [Gray::new(left, DIMS, 320).ok()?, Gray::new(right, DIMS, 320).ok()?];
    let mut result = matcher.run(memory, left, right).ok()?;
    result.object(&Region::boxed(0, object, DIMS).ok()?).ok()
}
