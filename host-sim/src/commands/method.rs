//! Options of the method itself, the same for every command that runs it.

use anyhow::{Result, bail};
use linestereo::params::{Margin, Parts};
use linestereo::units::{Confidence, Depth, Disparity};
use linestereo::{Params, Rig};

/// Parameters that a user may want to change; what is not given keeps the core's default.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Parameters of the method")]
pub struct MethodArgs {
    /// Least probability of being within 1 px, 0.1 to 0.99 [default: 0.9].
    #[arg(long, value_name = "P")]
    min_confidence: Option<f64>,
    /// First disparity searched, -32 to 0: for pairs whose disparity at infinity is negative
    /// [default: 0].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    min_disparity: Option<i16>,
    /// Largest difference between window and census, px [default: 1].
    #[arg(long, value_name = "PX", conflicts_with = "margin_m")]
    margin_px: Option<f64>,
    /// The same in depth: metres nearer and metres farther than the window's depth (Eq. 13); needs
    /// a rig.
    #[arg(long, num_args = 2, value_names = ["NEARER", "FARTHER"])]
    margin_m: Option<Vec<f64>>,
    /// Take one segment from each square of this side: larger is faster and sparser [default: 20].
    #[arg(long, value_name = "PX")]
    cell: Option<u16>,
    /// Least extent of a segment, 6 to 32, even [default: 6].
    #[arg(long, value_name = "PX")]
    min_extent: Option<u16>,
    /// Parts of the method that match a pair [default: both].
    #[arg(long, value_name = "PARTS", value_enum)]
    parts: Option<PartsArg>,
    /// Do not search for the ground plane.
    #[arg(long)]
    no_ground: bool,
}

/// [`Parts`] on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum PartsArg {
    /// Support points, and segments searched around them.
    Both,
    /// Support points alone.
    Support,
}

impl MethodArgs {
    /// The first disparity is asked for.
    pub(super) fn has_min_disparity(&self) -> bool {
        self.min_disparity.is_some()
    }

    /// The core's parameters; ranges are the core's to check.
    pub fn params(&self, max_disparity: u16, rig: Option<Rig>) -> Result<Params> {
        let mut params = Params { max_disparity, rig, ..Params::default() };
        if let Some(probability) = self.min_confidence {
            if !(0.1..=0.99).contains(&probability) {
                bail!("--min-confidence is {probability}; give 0.1 to 0.99");
            }
            params.min_confidence = Confidence::from_num(probability);
        }
        if let Some(pixels) = self.margin_px {
            if !(0.25..=16.0).contains(&pixels) {
                bail!("--margin-px is {pixels}; give 0.25 to 16");
            }
            params.margin = Margin::Pixels(Disparity::from_num(pixels));
        }
        if let Some([nearer, farther]) = self.margin_m.as_deref() {
            let metres = |value: f64| {
                if (0.001..=1000.0).contains(&value) {
                    Ok(Depth::from_num(value))
                } else {
                    bail!("--margin-m holds {value}; give 0.001 to 1000 metres")
                }
            };
            params.margin = Margin::Metres { nearer: metres(*nearer)?, farther: metres(*farther)? };
        }
        params.min_disparity = self.min_disparity.unwrap_or(params.min_disparity);
        params.cell = self.cell.unwrap_or(params.cell);
        if let Some(odd) = self.min_extent.filter(|extent| extent % 2 == 1) {
            bail!("--min-extent is {odd}; give an even number, 6 to 32");
        }
        params.min_extent = self.min_extent.unwrap_or(params.min_extent);
        params.parts = match self.parts {
            None => params.parts,
            Some(PartsArg::Both) => Parts::Both,
            Some(PartsArg::Support) => Parts::Support,
        };
        params.ground = !self.no_ground;
        Ok(params)
    }
}
