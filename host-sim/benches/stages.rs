//! Time per stage on one thread: median of many runs, in microseconds and ns per pixel of the left image. Prints; asserts nothing.
//!
//! Scenes are rendered; with captured frames (`LINESTEREO_FRAMES`, or `../shared/frames`), the QVGA ones as well.

use core::hint::black_box;
use core::time::Duration;
use linestereo::diagnostics::kernel::{
    LANES, STRIP, Strip, census_row, gradient_row, hamming_curve, portable, sad_curve,
};
use linestereo::diagnostics::lines::{LineParams, LineScratch, Segment, detect};
use linestereo::scratch::mark_words;
use linestereo::{Dims, Params};
use linestereo_frames::{GrayImage, find_scenes, load_scene};
use linestereo_sim::engine::Engine;
use linestereo_sim::scene::{self, Kind, Sensor};
use std::path::PathBuf;
use std::time::Instant;

/// Median time of `work` in microseconds.
fn time(mut work: impl FnMut()) -> f64 {
    let (begin, mut times) = (Instant::now(), Vec::new());
    while times.len() < 5 || (times.len() < 2000 && begin.elapsed() < Duration::from_millis(300)) {
        let start = Instant::now();
        work();
        times.push(start.elapsed());
    }
    times.sort();
    1e6 * times[times.len() / 2].as_secs_f64()
}

fn print(scene: &str, stage: &str, microseconds: f64, dims: Dims) {
    let pixels = f64::from(dims.width) * f64::from(dims.height);
    println!("{scene:12} {stage:32} {microseconds:10.1} us {:8.2} ns/px", 1e3 * microseconds / pixels);
}

fn stages(name: &str, left: &GrayImage, right: &GrayImage, max_disparity: u16) {
    let dims = left.dims;
    let (width, height) = (usize::from(dims.width), usize::from(dims.height));
    let rows: Vec<&[u8]> = left.pixels.chunks(width).collect();
    let mut out = vec![0; width];
    let gradient = time(|| {
        for three in rows.windows(3) {
            gradient_row(three[0], three[1], three[2], black_box(&mut out));
        }
    });
    print(name, "gradient, one image", gradient, dims);
    let census = time(|| {
        for five in rows.windows(5) {
            census_row([five[0], five[2], five[4]], black_box(&mut out));
        }
    });
    print(name, "census, one image", census, dims);
    let mut marks = vec![0; mark_words(dims)];
    let mut chain = vec![0; width.max(height)];
    let mut strengths = [0; 640];
    let mut segments = heapless::Vec::<Segment, 4096>::new();
    let params = LineParams { anchor: 40, edge: 24, min_extent: 6, row_scan: Some(6), column_scan: Some(6) };
    let lines = time(|| {
        let scratch = LineScratch { marks: &mut marks, chain: &mut chain, strengths: &mut strengths };
        black_box(detect(left.view().unwrap(), None, &params, scratch, &mut segments));
    });
    print(name, &format!("lines, one image: {} segments", segments.len()), lines, dims);
    let mut engine = Engine::new(&Params { max_disparity, ..Params::default() }, dims).unwrap();
    let mut matched = 0;
    let whole = time(|| {
        matched = engine.run_in_place(left.view().unwrap(), right.view().unwrap()).unwrap().segments().len();
    });
    print(name, &format!("whole pair: {matched} matches"), whole, dims);
}

/// Twelve strips over 64 disparities: one strip window of a typical segment.
fn kernels() {
    let other: Vec<u8> = (0..64 + STRIP as u32).map(|i| (i * 37 % 127) as u8).collect();
    let strips = [Strip { reference: [9, 8, 70, 60, 50, 40, 3, 2], other: &other }; 12];
    let mut curve = [0_u16; 4 * LANES];
    for (name, kernel) in
        [("portable", portable::sad_curve as fn(&[Strip<'_>], &mut [u16])), ("this machine's", sad_curve)]
    {
        let thousand = time(|| (0..1000).for_each(|_| kernel(black_box(&strips), black_box(&mut curve))));
        println!("window curve, {name}: {:.3} us", thousand / 1e3);
    }
    let points = [(77, &other[..]); 24];
    let thousand = time(|| (0..1000).for_each(|_| hamming_curve(black_box(&points), black_box(&mut curve))));
    println!("census curve: {:.3} us", thousand / 1e3);
}

fn main() {
    kernels();
    let dims = Dims { width: 320, height: 240 };
    for (name, kind) in [("demo", Kind::Demo), ("boxes", Kind::Boxes), ("repetition", Kind::Repetition)] {
        let sensor = Sensor { noise: 1.0, seed: 1, ..Sensor::default() };
        let rendering = scene::render(&scene::build(kind, dims, 1), dims, &sensor);
        stages(name, &rendering.left, &rendering.right, 64);
    }
    let frames = std::env::var_os("LINESTEREO_FRAMES")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/frames"), PathBuf::from);
    let Ok(folders) = find_scenes(&frames.join("qvga")) else {
        println!("no captured frames: set LINESTEREO_FRAMES to a folder that holds qvga/");
        return;
    };
    for folder in folders {
        let scene = load_scene(&folder, None).unwrap();
        stages(&scene.name, &scene.left, &scene.right, scene.max_disparity);
    }
}
