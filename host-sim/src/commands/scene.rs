//! `linestereo scene`: synthetic scenes with exact truth, as folders.

use super::arguments::{both, number_in};
use crate::output::{OutputFiles, print};
use crate::scene::{self, Kind, Sensor};
use crate::scene_folder;
use anyhow::Context;
use linestereo::Dims;
use linestereo::image::{MAX_HEIGHT, MAX_WIDTH, MIN_SIDE};
use std::path::{Path, PathBuf};

/// Render synthetic scenes with exact ground truth to folders that `run` and `sequence` read.
///
/// Every folder gets left.png, right.png, gt.png (16-bit, disparity * 256, 0 = unknown),
/// visible.png, objects.png and scene.json. The same options give the same bytes on every machine.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/scene.txt"))]
pub struct Args {
    /// List the built-in scenes and stop.
    #[arg(long)]
    list: bool,
    /// Scene to render: one of --list, or "all" for one folder each inside FOLDER.
    #[arg(long, value_name = "NAME", default_value = "demo")]
    kind: String,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "320x240", value_parser = parse_size)]
    size: Dims,
    /// Seed of textures, random places and noise.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Standard deviation of the noise in both images, in grey levels.
    #[arg(long, value_name = "SIGMA", default_value_t = 1.0, allow_negative_numbers = true,
          value_parser = number_in(0.0..=255.0, "give a number from 0 to 255"))]
    noise: f64,
    /// Folder to write to; created if missing.
    #[arg(value_name = "FOLDER", required_unless_present = "list")]
    folder: Option<PathBuf>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let Some(folder) = args.folder.as_deref().filter(|_| !args.list) else {
        let line = |kind: &Kind| format!("{:<11} {}\n", kind.name(), kind.summary());
        return print(&Kind::ALL.iter().map(line).collect::<String>());
    };
    if args.kind == "all" {
        for kind in Kind::ALL {
            render(args, kind, &folder.join(kind.name()))?;
        }
        return Ok(());
    }
    let kind = Kind::ALL.into_iter().find(|kind| kind.name() == args.kind);
    let kind = kind.with_context(|| format!("there is no scene \"{}\"; see --list", args.kind))?;
    render(args, kind, folder)
}

fn render(args: &Args, kind: Kind, folder: &Path) -> anyhow::Result<()> {
    let sensor = Sensor { noise: args.noise, seed: args.seed, ..Sensor::default() };
    let scene = scene::build(kind, args.size, args.seed);
    let rendering = scene::render(&scene, args.size, &sensor);
    let files = scene_folder::files(kind.name(), &scene.pair, &rendering)?;
    std::fs::create_dir_all(folder).with_context(|| {
        format!("cannot make the folder {}; choose one that can be written to", folder.display())
    })?;
    let mut output = OutputFiles::new();
    for (name, contents) in files {
        output.add(&folder.join(name), &contents)?;
    }
    output.commit_and_say(&format!("{}: {}\n", kind.name(), folder.display()))
}

/// Width and height of an image that the core takes.
pub(super) fn parse_size(text: &str) -> Result<Dims, String> {
    match text.split_once('x').and_then(both) {
        Some([width, height])
            if (MIN_SIDE..=MAX_WIDTH).contains(&width)
                && (MIN_SIDE..=MAX_HEIGHT).contains(&height) =>
        {
            Ok(Dims { width, height })
        }
        _ => Err(format!(
            "give a size from {MIN_SIDE}x{MIN_SIDE} to {MAX_WIDTH}x{MAX_HEIGHT}, for example \
             320x240"
        )),
    }
}
