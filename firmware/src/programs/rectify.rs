//! Cost of rectifying a pair, and its bytes.
//!
//! In: a built-in rig, a size. Out: the cost of set-up, of both images, of the most expensive raw
//! row, and a digest of both rectified images.
//!
//! ```text
//! set-up:  rig -> common view -> two meshes                floating point, once
//! rows:    noise, row by row, as a camera would deliver it -> rectified rows
//! ```

use super::random::Random;
use crate::ports::Clock;
use core::fmt;
use linestereo::{Dims, unstable::Fnv};
use linestereo_rig::{Band, Calibration, Camera, CameraSide, Lens, Mesh, View, mesh_nodes};

/// The largest frames here.
pub const LARGEST: Dims = Dims { width: 320, height: 240 };
const BAND: usize = LARGEST.width as usize * 64;
const PIXELS: usize = LARGEST.width as usize * LARGEST.height as usize;

/// Inputs of rectification, but for the raw frames.
#[derive(Debug)]
pub struct RectifyMemory {
    meshes: [Mesh<{ mesh_nodes(LARGEST) }, { LARGEST.height as usize }>; 2],
    band: Band<BAND>,
    raw_row: [u8; LARGEST.width as usize],
    frame: [u8; PIXELS],
}

impl Default for RectifyMemory {
    fn default() -> Self {
        Self::new()
    }
}

impl RectifyMemory {
    /// Cleared memory.
    pub const fn new() -> Self {
        Self {
            meshes: [Mesh::new(), Mesh::new()],
            band: Band::new(),
            raw_row: [0; LARGEST.width as usize],
            frame: [0; PIXELS],
        }
    }
}

/// A built-in rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuiltIn {
    /// A lens with little distortion, cameras turned against each other by 1 degree: 75 degrees of
    /// view.
    Moderate,
    /// A strong barrel, cameras turned against each other by 2 degrees: 110 degrees of view.
    Strong,
}

impl BuiltIn {
    /// Every rig.
    pub const ALL: [Self; 2] = [Self::Moderate, Self::Strong];

    /// As it stands in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Moderate => "moderate",
            Self::Strong => "strong",
        }
    }

    /// The rig, for raw images of a size.
    #[must_use]
    pub fn calibration(self, dims: Dims) -> Option<Calibration> {
        let (width, height) = (f64::from(dims.width), f64::from(dims.height));
        // Rotations are normalised by the core; half angles in radians.
        let (focal, k, half_turn) = match self {
            Self::Moderate => (0.65, [-0.18, 0.04, 0.0], [0.003, -0.004, 0.007]),
            Self::Strong => (0.5, [-0.3, 0.09, -0.011], [0.006, -0.008, 0.014]),
        };
        let lens = Lens::BrownConrady { k, p: [0.0005, -0.0003] };
        let camera = |x: f64, y: f64| {
            Camera::new(dims, [focal * width; 2], [0.5 * width + x, 0.5 * height + y], 0.0, lens)
                .ok()
        };
        let [x, y, z] = half_turn;
        Calibration::new(
            camera(1.5, -2.0)?,
            camera(-2.0, 1.0)?,
            [1.0, x, y, z],
            [-0.06, 0.0005, 0.001],
        )
        .ok()
    }
}

/// Measurements, in the unit of the clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measured {
    /// From the rig to both meshes.
    pub set_up: u64,
    /// All rows of both images.
    pub rows: u64,
    /// The most expensive raw row.
    pub worst_row: u64,
    /// Bytes of raw rows held, of the camera that needs more.
    pub band_bytes: usize,
    /// Of both rectified images (FNV-1a).
    pub digest: u32,
}

/// Sets a rig up for frames of this size and rectifies a pair of noise; `None` where rig or memory
/// do not fit.
pub fn measure(
    workspace: &mut RectifyMemory,
    clock: &impl Clock,
    rig: BuiltIn,
    dims: Dims,
) -> Option<Measured> {
    let started = clock.now();
    let remap = rig.calibration(dims)?.rectify(dims, View::default()).ok()?.remap();
    for (mesh, eye) in workspace.meshes.iter_mut().zip(CameraSide::BOTH) {
        mesh.build(&remap, eye).ok()?;
    }
    let set_up = clock.elapsed(started, clock.now());
    let mut measured = Measured { set_up, rows: 0, worst_row: 0, band_bytes: 0, digest: 0 };
    let (mut noise, mut digest) = (Random(1), Fnv::EMPTY);
    for mesh in &workspace.meshes {
        workspace.band.restart();
        measured.band_bytes = measured.band_bytes.max(mesh.band_bytes());
        for _ in 0..dims.height {
            let raw_row = workspace.raw_row.get_mut(..dims.width.into()).unwrap_or_default();
            raw_row.fill_with(|| (noise.next() >> 24) as u8);
            let before = clock.now();
            let finished = workspace.band.push(mesh, raw_row, &mut workspace.frame).ok()?;
            let cost = clock.elapsed(before, clock.now());
            measured.rows += cost;
            measured.worst_row = measured.worst_row.max(cost);
            let [first, last] =
                [finished.start, finished.end].map(|y| usize::from(y) * usize::from(dims.width));
            digest.write(workspace.frame.get(first..last).unwrap_or(&[]));
        }
    }
    measured.digest = digest.value();
    Some(measured)
}

/// One line of the table that the PC reads, separated by tabs.
pub fn line(out: &mut impl fmt::Write, rig: BuiltIn, dims: Dims, measured: &Measured) {
    let Measured { set_up, rows, worst_row, band_bytes, digest } = measured;
    let name = rig.name();
    let _ = writeln!(
        out,
        "rectify\t{name}_{dims}\t{set_up}\t{rows}\t{worst_row}\t{band_bytes}\t{digest:08x}"
    );
}
