//! Options of the rectified view and the rig behind it, the same for every command that rectifies.

use super::scene::parse_size;
use crate::output::note_once;
use anyhow::{Result, anyhow, bail};
use linestereo::Dims;
use linestereo::image::MIN_SIDE;
use linestereo_calibration::interchange::{Options, load_rig_texts};
use linestereo_calibration::rectify::{RectifierError, reduced};
use linestereo_frames::{GrayImage, RigText, area_average, resampled_height};
use linestereo_rig::{CameraSide, RectifyError, RigImage, RigImageError, View};

/// Size and view of the rectified images.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Rectified view")]
pub(super) struct ViewArgs {
    /// Width and height of the rectified images [default: those of the raw ones].
    #[arg(long, value_name = "WxH", value_parser = parse_size, requires = "rig")]
    size: Option<Dims>,
    /// Share of the view to keep: 0 crops until no pixel is empty, 1 keeps the whole view
    /// [default: 0].
    #[arg(long, value_name = "A", allow_negative_numbers = true, requires = "rig")]
    alpha: Option<f64>,
    /// Raw images are reduced to this width first, by area averaging; the rig follows.
    #[arg(long, value_name = "PX", requires = "rig")]
    raw_width: Option<u16>,
}

impl ViewArgs {
    /// This rig, ready to rectify images of this size where they are at hand; a focal length that
    /// is asked for comes before alpha.
    pub(super) fn image(
        &self,
        rig: &[RigText],
        images: Option<Dims>,
        focal_px: Option<f64>,
        range: (i16, u16),
    ) -> Result<RigImage> {
        let imported = load_rig_texts(rig, &Options { images, ..Options::default() })?;
        imported.notes.iter().for_each(|note| note_once(note));
        let mut calibration = imported.rig.calibration;
        let needed = calibration.camera(CameraSide::Left).dims();
        if let Some(given) = images.filter(|&given| given != needed) {
            bail!(RectifierError::Size { needed, given });
        }
        if let Some(width) = self.raw_width {
            let all = needed.width;
            if !(MIN_SIDE..all).contains(&width) {
                bail!(
                    "--raw-width is {width}; give {MIN_SIDE} to less than the {all} of the raw images"
                );
            }
            let height = resampled_height(needed, width);
            calibration = reduced(&calibration, Dims { width, height })?;
        }
        let view = focal_px.map_or(View::Alpha(self.alpha.unwrap_or(0.0)), View::Focal);
        let dims = self.size.unwrap_or_else(|| calibration.camera(CameraSide::Left).dims());
        RigImage::new(calibration, dims, view, range)
            .map_err(|error| anyhow!("{error}; {}", remedy(&error)))
    }

    /// A raw image as the rig sees it.
    pub(super) fn raw(&self, image: GrayImage) -> Result<GrayImage> {
        Ok(match self.raw_width {
            Some(width) => area_average(&image, width)?,
            None => image,
        })
    }
}

fn remedy(error: &RigImageError) -> &'static str {
    match error {
        RigImageError::View(RectifyError::Dims(_)) => "give --size, or reduce with --raw-width",
        RigImageError::View(RectifyError::Alpha(_)) => "correct --alpha",
        RigImageError::View(RectifyError::Rig(_)) => "correct --focal-px, or give another --size",
        RigImageError::Range(_) => "correct --max-disparity, or give a larger --size",
        _ => "calibrate again",
    }
}
