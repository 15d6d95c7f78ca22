//! Depth in a drawn pair: a wall 1 m away, a detected object, a pixel. `cargo run --release -p
//! linestereo --example drawn_pair`
use linestereo::units::Depth;
use linestereo::{Area, Capacity, Dims, Gray, Matcher, Params, Region, Rig};

const DIMS: Dims = Dims { width: 160, height: 120 };
type Memory = linestereo::Memory<{ Capacity::new(DIMS).words() }>;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let mut memory = Memory::new(); // in a static on a board
    // 200 px * 0.06 m / 12 px = 1 m.
    let rig = Some(Rig::new(200.0, 0.06, 0.0)?);
    let params = Params { max_disparity: 32, rig, ..Params::default() };
    let mut matcher = Matcher::new(params, DIMS)?;

    // A wall with bars of many widths and a grain, as seen by two cameras.
    let grain =
        |x: usize, y: usize| ((x * 7919) ^ (y * 6271)).wrapping_mul(2_654_435_761) >> 20 & 15;
    let bar = |x: usize, y: usize| if (x * x / 1200 + y / 30).is_multiple_of(2) { 60 } else { 190 };
    let grey = |x: usize, y: usize| (bar(x, y) + grain(x, y)) as u8;
    let image = |disparity: usize| -> Vec<u8> {
        (0..160 * 120).map(|i| grey(i % 160 + disparity, i / 160)).collect()
    };
    let (left, right) = (image(0), image(12));
    let (left, right) = (Gray::new(&left, DIMS, 160)?, Gray::new(&right, DIMS, 160)?);

    let mut matched = matcher.run(&mut memory, left, right)?;
    assert!(matched.is_fit());
    let is_near_a_metre = |depth: Depth| (depth.to_num::<f64>() - 1.0).abs() < 0.03;
    assert!(matched.segments().len() > 10);
    assert!(
        matched.segments().iter().flat_map(|segment| segment.depth.unwrap()).all(is_near_a_metre)
    );

    // A detected object, and a pixel.
    let region = Region::boxed(1, Area { left: 60, top: 30, right: 120, bottom: 90 }, DIMS)?;
    assert!(matched.object(&region)?.metres.is_some_and(|metres| is_near_a_metre(metres.depth)));
    let pixel = matched.pixel((97, 61))?.depth;
    assert!(pixel.is_some_and(is_near_a_metre));

    // Every pixel with a depth, the most credible first.
    let points = matched.points().count();
    assert!(points > 1000);
    println!("{points} points; the pixel at 97,61 is {pixel:?} m away");
    Ok(())
}
