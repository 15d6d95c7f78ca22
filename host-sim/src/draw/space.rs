//! Points and segments in space, coloured by disparity: as PLY for MeshLab and CloudCompare, as PCD
//! for PCL, ROS and Open3D.
//!
//! x right, y down, z forward, in metres, from the left camera. Vertices are the points, then both
//! ends of every segment; edges, which PLY alone has, are the segments. The colour stands at the
//! vertices, where every program looks for it. Text, because some programs read one byte order
//! only.

use super::colour::{Range, colour};
use crate::engine::FrameResult;
use core::fmt::Write;
use linestereo::{Rig, results::ImagePosition, units::Disparity};

/// Vertices without those that are infinitely far, each by its position and its colour.
struct Vertices {
    points: Vec<Vertex>,
    ends: Vec<[Vertex; 2]>,
}

type Vertex = ([f64; 3], [u8; 3]);

impl Vertices {
    fn new(result: &FrameResult, rig: &Rig, colours: &Range) -> Self {
        let vertex = |at: ImagePosition, disparity: Disparity| {
            let position = rig.xyz(at, disparity)?.map(|metres| metres.to_num::<f64>());
            Some((position, colour(colours, disparity.to_num())))
        };
        let points = result.points.iter().filter_map(|p| vertex(p.position(), p.disparity));
        let ends = result.matches.iter().filter_map(|found| {
            let end = |i: usize| vertex(found.ends[i], found.disparity[i]);
            Some([end(0)?, end(1)?])
        });
        Self { points: points.collect(), ends: ends.collect() }
    }

    fn all(&self) -> impl Iterator<Item = &Vertex> {
        self.points.iter().chain(self.ends.iter().flatten())
    }
}

pub fn ply(result: &FrameResult, rig: &Rig, colours: &Range) -> String {
    let vertices = Vertices::new(result, rig, colours);
    let (points, ends) = (vertices.points.len(), vertices.ends.len());
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment linestereo: x right, y down, z forward, metres\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         element edge {ends}\nproperty int vertex1\nproperty int vertex2\nend_header\n",
        points + 2 * ends,
    );
    for ([x, y, z], [red, green, blue]) in vertices.all() {
        let _ = writeln!(text, "{x:.4} {y:.4} {z:.4} {red} {green} {blue}");
    }
    for index in 0..ends {
        let first = points + 2 * index;
        let _ = writeln!(text, "{first} {}", first + 1);
    }
    text
}

/// Points and ends of segments as PCD 0.7.
pub fn pcd(result: &FrameResult, rig: &Rig, colours: &Range) -> String {
    let vertices = Vertices::new(result, rig, colours);
    let count = vertices.points.len() + 2 * vertices.ends.len();
    let mut text = format!(
        "# .PCD v0.7 - linestereo: x right, y down, z forward, metres\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\n\
         TYPE F F F U\nCOUNT 1 1 1 1\nWIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA ascii\n"
    );
    for ([x, y, z], [red, green, blue]) in vertices.all() {
        let _ =
            writeln!(text, "{x:.4} {y:.4} {z:.4} {}", u32::from_be_bytes([0, *red, *green, *blue]));
    }
    text
}
