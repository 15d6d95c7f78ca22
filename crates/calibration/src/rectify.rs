//! Raw pairs -> rectified pairs, by the core's mesh and band as on a board.
//!
//! The nodes of a mesh depend on the memory there is for them. Images that boards hold get no more
//! here than there, so that both give the same bytes; larger ones as much as they can use.

use crate::interchange::{Options, load_rig_texts};
use core::fmt;
use linestereo::{Dims, image::Span};
use linestereo_boards::Board;
use linestereo_frames::{
    FrameError, GrayImage, LayoutFault, RectifiedPair, RigText, area_average, resampled_height,
};
use linestereo_rig::{
    Band, Calibration, CalibrationError, Camera, CameraError, CameraSide, Mesh, MeshError, Remap,
    RowError, View, fine_mesh_nodes, mesh_nodes,
};
use linestereo_wire::RigUpdate;

/// The largest images that a board rectifies.
const BOARD: Dims = Board::MPS2_AN500.largest;
const LARGEST: Dims = Dims { width: 1280, height: 1280 };
/// Bytes of raw rows: a whole image of 1280x1200.
const BAND: usize = 1280 * 1200;

type BoardMesh = Mesh<{ mesh_nodes(BOARD) }, { BOARD.height as usize }>;
type PcMesh = Mesh<{ fine_mesh_nodes(LARGEST) }, { LARGEST.height as usize }>;

/// Why a pair cannot be rectified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RectifierError {
    /// The mesh of one camera cannot be built.
    #[error("{0} camera: {1}")]
    Mesh(CameraSide, MeshError),
    /// The rows of a raw image are refused.
    #[error("{0} camera: {1}")]
    Row(CameraSide, RowError),
    /// A rectified row needs more of the raw image than there is memory for.
    #[error(
        "{eye} camera: a row of the rectified images needs {rows} rows of the raw ones, too many \
         for images of {raw}; reduce them with --raw-width {width}"
    )]
    Band {
        /// The camera.
        eye: CameraSide,
        /// Raw rows that are needed at once.
        rows: u16,
        /// Size of the raw images.
        raw: Dims,
        /// Width to which the images can be reduced so that there is memory for all of them, px.
        width: u16,
    },
    /// A raw image is not of the rig's size.
    #[error(
        "the rig is for raw images of {needed}, but these are {given}; give images of {needed}"
    )]
    Size {
        /// The rig's.
        needed: Dims,
        /// The image's.
        given: Dims,
    },
}

/// Both meshes of a rig, and memory for the raw rows of one camera at a time.
pub struct PairRectifier {
    meshes: Meshes,
    band: Box<Band<BAND>>,
}

/// Left and right.
enum Meshes {
    Board([Box<BoardMesh>; 2]),
    Pc([Box<PcMesh>; 2]),
}

/// Numbers of the mesh of one camera.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshFacts {
    /// Raw rows that are held at once.
    pub band_rows: u16,
    /// Their bytes.
    pub band_bytes: usize,
    /// Of each rectified row the pixels that have a source.
    pub spans: Vec<Span>,
    /// Of each row the pixels that may be used; empty when all may.
    pub usable: Vec<Span>,
}

impl PairRectifier {
    /// Builds the meshes.
    pub fn new(remap: &Remap) -> Result<Self, RectifierError> {
        let dims = remap.dims();
        let meshes = if dims.width <= BOARD.width && dims.height <= BOARD.height {
            Meshes::Board([built(remap, CameraSide::Left)?, built(remap, CameraSide::Right)?])
        } else {
            Meshes::Pc([built(remap, CameraSide::Left)?, built(remap, CameraSide::Right)?])
        };
        Ok(Self { meshes, band: Box::new(Band::new()) })
    }

    /// The numbers of a camera's mesh.
    pub fn facts(&self, eye: CameraSide) -> MeshFacts {
        match &self.meshes {
            Meshes::Board(meshes) => facts(&meshes[eye as usize]),
            Meshes::Pc(meshes) => facts(&meshes[eye as usize]),
        }
    }

    /// Rectifies one image, row by row.
    pub fn image(&mut self, eye: CameraSide, raw: &GrayImage) -> Result<GrayImage, RectifierError> {
        let Self { meshes, band } = self;
        match meshes {
            Meshes::Board(meshes) => rectified(&meshes[eye as usize], band, eye, raw),
            Meshes::Pc(meshes) => rectified(&meshes[eye as usize], band, eye, raw),
        }
    }

    /// Rectifies a pair.
    pub fn pair(
        &mut self,
        left: &GrayImage,
        right: &GrayImage,
    ) -> Result<(GrayImage, GrayImage), RectifierError> {
        Ok((self.image(CameraSide::Left, left)?, self.image(CameraSide::Right, right)?))
    }
}

fn built<const NODES: usize, const ROWS: usize>(
    remap: &Remap,
    eye: CameraSide,
) -> Result<Box<Mesh<NODES, ROWS>>, RectifierError> {
    let mut mesh = Box::new(Mesh::new());
    mesh.build(remap, eye).map_err(|error| RectifierError::Mesh(eye, error))?;
    if mesh.band_bytes() > BAND {
        let (rows, raw) = (mesh.band_rows(), mesh.raw_dims());
        // A row more, for what is read behind the last one.
        let fits = |&width: &u16| {
            usize::from(width) * (usize::from(resampled_height(raw, width)) + 1) <= BAND
        };
        let width = (1..raw.width).rev().find(fits).unwrap_or(1);
        return Err(RectifierError::Band { eye, rows, raw, width });
    }
    Ok(mesh)
}

fn facts<const NODES: usize, const ROWS: usize>(mesh: &Mesh<NODES, ROWS>) -> MeshFacts {
    let spans = mesh.spans().to_vec();
    let usable = mesh.valid(&mut spans.clone()).to_vec();
    MeshFacts { band_rows: mesh.band_rows(), band_bytes: mesh.band_bytes(), spans, usable }
}

fn rectified<const NODES: usize, const ROWS: usize>(
    mesh: &Mesh<NODES, ROWS>,
    band: &mut Band<BAND>,
    eye: CameraSide,
    raw: &GrayImage,
) -> Result<GrayImage, RectifierError> {
    if raw.dims != mesh.raw_dims() {
        return Err(RectifierError::Size { needed: mesh.raw_dims(), given: raw.dims });
    }
    let dims = mesh.dims();
    let mut pixels = vec![0; usize::from(dims.width) * usize::from(dims.height)];
    band.restart();
    for row in raw.pixels.chunks_exact(raw.dims.width.into()) {
        band.push(mesh, row, &mut pixels).map_err(|error| RectifierError::Row(eye, error))?;
    }
    Ok(GrayImage { dims, pixels })
}

/// Why a calibration cannot be that of smaller images.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ReducedError {
    /// A camera of this size is none.
    #[error("{0}")]
    Camera(CameraError),
    /// The cameras make no pair.
    #[error("{0}")]
    Pose(CalibrationError),
}

/// The same rig for raw images of another size that show the same: whole pixels are centres, so
/// borders are half a pixel outside.
pub fn reduced(calibration: &Calibration, dims: Dims) -> Result<Calibration, ReducedError> {
    let camera = |eye| {
        let camera = calibration.camera(eye);
        let [sx, sy] = [
            f64::from(dims.width) / f64::from(camera.dims().width),
            f64::from(dims.height) / f64::from(camera.dims().height),
        ];
        let ([fx, fy], [cx, cy]) = (camera.focal(), camera.centre());
        let centre = [(cx + 0.5) * sx - 0.5, (cy + 0.5) * sy - 0.5];
        Camera::new(dims, [fx * sx, fy * sy], centre, camera.skew() * sx, camera.lens())
            .map_err(ReducedError::Camera)
    };
    let (left, right) = (camera(CameraSide::Left)?, camera(CameraSide::Right)?);
    Calibration::new(left, right, calibration.rotation(), calibration.translation())
        .map_err(ReducedError::Pose)
}

/// Raw images, reduced to this size, in the rectified view of the same size: as much of it as has a
/// source everywhere.
///
/// # Errors
/// The calibration in these files cannot be read, or is of images of another size.
pub fn rectify_raw(
    files: &[RigText],
    dims: Dims,
    [left, right]: [GrayImage; 2],
) -> Result<RectifiedPair, FrameError> {
    let failed = |what: &dyn fmt::Display| {
        FrameError::Layout(files[0].path.clone(), LayoutFault::RawRig(what.to_string()))
    };
    let options = Options { images: Some(left.dims), ..Options::default() };
    let calibration =
        load_rig_texts(files, &options).map_err(|error| failed(&error))?.rig.calibration;
    let raw = calibration.camera(CameraSide::Left).dims();
    if raw != left.dims {
        return Err(failed(&format!("it is of images of {raw}, these are {}", left.dims)));
    }
    let calibration = reduced(&calibration, dims).map_err(|error| failed(&error))?;
    let view = calibration.rectify(dims, View::Alpha(0.0)).map_err(|error| failed(&error))?;
    let mut rectifier = PairRectifier::new(&view.remap()).map_err(|error| failed(&error))?;
    let (left, right) = (area_average(&left, dims.width)?, area_average(&right, dims.width)?);
    let (left, right) = rectifier.pair(&left, &right).map_err(|error| failed(&error))?;
    let rig = view.rig().map_err(|error| FrameError::Rig(files[0].path.clone(), error))?;
    let numbers = RigUpdate { focal_px: view.focal(), baseline_m: view.baseline(), offset_px: 0.0 };
    Ok(([left, right], Some((numbers, rig))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo_rig::Lens;

    #[test]
    fn raw_images_with_too_many_rows_are_refused_with_a_width_that_is_taken() {
        let dims = Dims { width: 4000, height: 3000 };
        let lens = Lens::Fisheye { k: [0.0; 4] };
        let camera = Camera::new(dims, [1300.0; 2], [1999.5, 1499.5], 0.0, lens).unwrap();
        let turned = crate::rig_file::quaternion([0.0, 0.0, 0.1]);
        let pair = Calibration::new(camera, camera, turned, [-0.07, 0.0, 0.0]).unwrap();
        let rectifier = |pair: &Calibration| {
            let dims = Dims { width: 1280, height: 960 };
            let view = pair.rectify(dims, View::Alpha(0.0)).unwrap();
            PairRectifier::new(&view.remap()).map(|_| ())
        };
        let Err(error @ RectifierError::Band { raw, width, .. }) = rectifier(&pair) else {
            panic!("no memory holds so many rows")
        };
        assert_eq!(raw, dims);
        assert!(error.to_string().contains(&format!("--raw-width {width}")), "{error}");
        assert!(width > 1280, "{width}");
        let height = resampled_height(dims, width);
        assert_eq!(rectifier(&reduced(&pair, Dims { width, height }).unwrap()), Ok(()));
    }

    #[test]
    fn a_ray_stays_at_its_place_in_the_image() {
        let dims = Dims { width: 640, height: 480 };
        let lens = Lens::BrownConrady { k: [-0.3, 0.1, 0.0], p: [1e-3, 0.0] };
        let camera = Camera::new(dims, [500.0, 510.0], [300.0, 250.0], 2.0, lens).unwrap();
        let pair =
            Calibration::new(camera, camera, [1.0, 0.0, 0.0, 0.0], [-0.1, 0.0, 0.0]).unwrap();
        let small = reduced(&pair, Dims { width: 320, height: 160 }).unwrap();
        for ray in [[0.0, 0.0, 1.0], [0.3, -0.2, 1.0], [-0.25, 0.1, 1.0]] {
            let [[u, v], [x, y]] =
                [&pair, &small].map(|rig| rig.camera(CameraSide::Right).project(ray).unwrap());
            assert!(((u + 0.5) / 2.0 - (x + 0.5)).abs() < 1e-9);
            assert!(((v + 0.5) / 3.0 - (y + 0.5)).abs() < 1e-9);
        }
        assert_eq!(reduced(&pair, dims).unwrap(), pair);
    }
}
