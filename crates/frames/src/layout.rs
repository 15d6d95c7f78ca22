//! Which layouts of stereo pairs there are, by name: see [`datasets`](super::datasets) for what
//! each looks like.

use core::fmt;

/// Layouts that are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layout {
    /// A folder with `scene.json`.
    SceneJson,
    /// `im2.ppm`, `im6.ppm`, `disp2.pgm`; `tsukuba` and `map` have names of their own.
    Middlebury2001,
    /// `im2.png`, `im6.png`, `disp2.png` of cones and teddy.
    Middlebury2003,
    /// `view1.png`, `view5.png`, `disp1.png`, `dmin.txt`: 2005 and 2006.
    Middlebury2006,
    /// `im0.png`, `im1.png`, `disp0.pfm` or `disp0GT.pfm`, `calib.txt`: 2014, 2021 and version 3 of
    /// the benchmark.
    Middlebury2014,
    /// The same with COLMAP's `cameras.txt`.
    Eth3d,
    /// `image_0`, `image_1` or `colored_0`, `colored_1`, `disp_occ`, `calib`.
    Kitti2012,
    /// `image_2`, `image_3`, `disp_occ_0`, `calib_cam_to_cam`.
    Kitti2015,
    /// `mav0/cam0/data`, `mav0/cam1/data` with a `sensor.yaml` each.
    Euroc,
    /// A folder for each camera with the same names in both.
    CameraFolders,
    /// One folder, the side in each name.
    SidesInNames,
    /// A folder with `left` and `right`.
    PairFolder,
    /// One image for both views.
    SideBySide,
    /// Messages of ROS 2 in an MCAP file.
    Recording,
    /// Frames of a video.
    Video,
}

impl Layout {
    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SceneJson => "scene.json",
            Self::Middlebury2001 => "Middlebury 2001",
            Self::Middlebury2003 => "Middlebury 2003",
            Self::Middlebury2006 => "Middlebury 2005/2006",
            Self::Middlebury2014 => "Middlebury 2014-2021",
            Self::Eth3d => "ETH3D two-view",
            Self::Kitti2012 => "KITTI 2012",
            Self::Kitti2015 => "KITTI 2015",
            Self::Euroc => "EuRoC",
            Self::CameraFolders => "a folder for each camera",
            Self::SidesInNames => "the side in each name",
            Self::PairFolder => "a folder for each pair",
            Self::SideBySide => "side by side",
            Self::Recording => "MCAP recording",
            Self::Video => "video",
        }
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
