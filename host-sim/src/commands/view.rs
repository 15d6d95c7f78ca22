//! Options of the rectified view, the same for every command that rectifies.

use super::scene::parse_size;
use linestereo::{Calibration, Dims, Eye, View};

/// Size and view of the rectified images.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Rectified view")]
pub(super) struct ViewArgs {
    /// Width and height of the rectified images [default: those of the raw ones].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<Dims>,
    /// How much of the view to keep: 0 as much as fits without a pixel that has no source, 1 all of it [default: 0].
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    alpha: Option<f64>,
}

impl ViewArgs {
    /// The size for this pair.
    pub(super) fn dims(&self, calibration: &Calibration) -> Dims {
        self.size.unwrap_or_else(|| calibration.camera(Eye::Left).dims())
    }

    /// The view; a focal length that was asked for comes before alpha.
    pub(super) fn view(&self, focal_px: Option<f64>) -> View {
        focal_px.map_or(View::Alpha(self.alpha.unwrap_or(0.0)), View::Focal)
    }
}
