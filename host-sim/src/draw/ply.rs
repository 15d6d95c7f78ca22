//! Points and segments in space as PLY, coloured by disparity: opens in MeshLab and CloudCompare.
//!
//! x right, y down, z forward, in metres, from the left camera. Vertices are the points, then both ends of every segment; edges are the
//! segments. The colour stands at the vertices, where every program looks for it. Text, because some programs read one byte order only.

use super::colour::{Range, colour};
use crate::engine::FrameResult;
use core::fmt::Write;
use linestereo::{Disparity, ImagePosition, Rig};

/// Points and segments as PLY, without those that are infinitely far.
#[must_use]
pub fn ply(result: &FrameResult, rig: &Rig, colours: &Range) -> String {
    let vertex = |at: ImagePosition, disparity: Disparity| {
        let [x, y, z] = rig.xyz(at, disparity)?.map(|metres| metres.to_num::<f64>());
        let [red, green, blue] = colour(colours, disparity.to_num());
        Some(format!("{x:.4} {y:.4} {z:.4} {red} {green} {blue}\n"))
    };
    let points = result.points.iter();
    let points: Vec<String> = points.filter_map(|p| vertex(p.position(), p.disparity)).collect();
    let ends = result.matches.iter().filter_map(|found| {
        let end = |i: usize| vertex(found.ends[i], found.disparity[i]);
        Some([end(0)?, end(1)?])
    });
    let ends: Vec<[String; 2]> = ends.collect();
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment linestereo: x right, y down, z forward, metres\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         element edge {}\nproperty int vertex1\nproperty int vertex2\nend_header\n",
        points.len() + 2 * ends.len(),
        ends.len(),
    );
    points.iter().for_each(|line| text.push_str(line));
    ends.iter().flatten().for_each(|line| text.push_str(line));
    for index in 0..ends.len() {
        let first = points.len() + 2 * index;
        let _ = writeln!(text, "{first} {}", first + 1);
    }
    text
}
