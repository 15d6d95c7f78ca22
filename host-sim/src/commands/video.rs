//! Videos and cameras as input of a sequence.

use super::arguments::both;
use crate::interruption;
use anyhow::{Result, bail};
use linestereo_recordings::{Camera, Footage, is_video};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "A stereo camera at this PC")]
pub(super) struct CameraArgs {
    /// Match the pairs of a camera that sends both views side by side, until Ctrl-C or the end of
    /// --frames; needs Linux and ffmpeg.
    #[arg(long, value_name = "/dev/video0")]
    camera: Option<PathBuf>,
    /// Size of its images, both views together [default: the camera's].
    #[arg(long, value_name = "WxH", requires = "camera", value_parser = size)]
    camera_size: Option<[u16; 2]>,
    /// Its frames a second [default: the camera's].
    #[arg(long, value_name = "N", requires = "camera", value_parser = clap::value_parser!(u16).range(1..=1000))]
    camera_fps: Option<u16>,
    /// Format of its images: mjpeg if raw images are too large for USB [default: ffmpeg's choice].
    #[arg(long, value_name = "NAME", requires = "camera", value_parser = name)]
    camera_format: Option<String>,
}

fn size(text: &str) -> Result<[u16; 2], &'static str> {
    let sides = text.split_once(['x', 'X']).and_then(both);
    sides
        .filter(|sides| !sides.contains(&0))
        .ok_or("give width and height of both views together, such as 2560x720")
}

fn name(text: &str) -> Result<String, &'static str> {
    let is_name =
        !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    is_name
        .then(|| text.to_owned())
        .ok_or("give a name that v4l2-ctl and ffmpeg know, such as mjpeg")
}

impl CameraArgs {
    /// Refuses what is said of a camera where there is none.
    pub(super) fn refuse_options(&self) -> Result<()> {
        if self.camera_size.is_some() || self.camera_fps.is_some() || self.camera_format.is_some() {
            bail!(
                "--camera-size, --camera-fps and --camera-format are for --camera; leave them out"
            );
        }
        Ok(())
    }

    /// Starts the camera.
    pub(super) fn open(&self) -> Result<Footage> {
        let Some(device) = self.camera.clone() else {
            bail!("give a folder, an .mcap file, a video or --camera")
        };
        let (size, rate, format) = (self.camera_size, self.camera_fps, self.camera_format.clone());
        Ok(Footage::camera(&Camera { device, size, rate, format }, interruption::requested)?)
    }
}

/// Pairs of a video with both views side by side, or of a left and a right one.
pub(super) fn find(left: &Path, right: Option<&Path>, side_by_side: bool) -> Result<Footage> {
    let Some(right) = right else { return Ok(Footage::video(&[left], interruption::requested)?) };
    if let Some(other) = [left, right].into_iter().find(|path| !is_video(path) || path.is_dir()) {
        bail!(
            "{} is no video; of two paths both are videos, a left and a right one: of images give the folder above both",
            other.display()
        );
    }
    if side_by_side {
        bail!(
            "--side-by-side is for one video with both views; leave it out, or give that one alone"
        );
    }
    Ok(Footage::video(&[left, right], interruption::requested)?)
}
