//! `linestereo calibrate`: photos of a board to a calibrated rig.

use super::asked_for;
use super::board_options::{BoardOptions, BoardSize, parse_board};
use super::pairs::for_each_pair;
use crate::draw;
use crate::output::{OutputFiles, OutputPath, spare};
use anyhow::{Context, Result, anyhow, bail};
use core::fmt::Write;
use indicatif::ProgressBar;
use linestereo::Dims;
use linestereo_calibration::boards::{
    Board, BoardCorners, BoardFinder, BoardPair, Estimate, JunctionFinder, LEAST_CORNERS,
    LEAST_VIEWS, LensModel, NotFound, Options, Pattern, PhotoPair, ViewReport, assess, estimate,
    find_pairs, json, summary,
};
use linestereo_calibration::rig_file::{Quality, RigFile};
use linestereo_frames::{EXIF_REMEDY, GrayImage, UPRIGHT, exif_turn, load_gray};
use linestereo_rig::check_raw_dims;
use std::path::PathBuf;

/// Calibrate two cameras and the pose between them from photos of a chessboard, a ChArUco board or
/// an AprilGrid.
///
/// Photos are paired by number: left01.png with right01.png, or the same name in the folders left/
/// and right/ (cam0, cam1).
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/calibrate.txt"))]
pub struct Args {
    /// Folder of the photos: PNG, JPEG, PGM or PPM.
    folder: PathBuf,
    /// Inner corners along both sides of a chessboard: one less than squares; squares of a ChArUco
    /// board; tags of an AprilGrid.
    #[arg(long, value_name = "[KIND:]COLSxROWS", value_parser = parse_board)]
    board: BoardSize,
    #[command(flatten)]
    board_options: BoardOptions,
    /// Write the rig to this file.
    #[arg(long, value_name = "rig.toml")]
    out: Option<OutputPath>,
    /// Write all estimates as JSON; "-" is stdout.
    #[arg(long, value_name = "FILE")]
    json: Option<OutputPath>,
    /// Draw coverage, errors, views and a rectified pair as PNG.
    #[arg(long, value_name = "FILE.png")]
    report: Option<OutputPath>,
    /// Family of the lenses.
    #[arg(long, value_enum, default_value_t = LensName::BrownConrady)]
    lens: LensName,
    /// Hold k3 (of a fisheye k3 and k4) at 0.
    #[arg(long)]
    fix_k3: bool,
    /// Estimate the skew of the pixels too.
    #[arg(long)]
    skew: bool,
    /// Aspect of a pixel: estimated, or held at 1.
    #[arg(long, value_enum, default_value_t = Aspect::Free)]
    aspect: Aspect,
    /// Disparity range for which the nearest distance is stated.
    #[arg(long, value_name = "N", default_value_t = 64,
          value_parser = clap::value_parser!(u16).range(8..=256))]
    max_disparity: u16,
    /// Skip photos without a partner of the same number or name.
    #[arg(long)]
    skip_unpaired: bool,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum LensName {
    /// Radial and tangential: most lenses.
    BrownConrady,
    /// Equidistant: wide lenses, above 100 degrees or so.
    Fisheye,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Aspect {
    /// Focal lengths across and down are estimated apart.
    Free,
    /// Square pixels.
    #[value(name = "1")]
    One,
}

pub fn run(args: &Args) -> Result<()> {
    let board = args.board_options.board(args.board)?;
    let (pairs, alone) = find_pairs(&args.folder, args.skip_unpaired)?;
    let photos = pairs.iter().flat_map(|pair| &pair.files).map(PathBuf::as_path);
    spare(asked_for([&args.out, &args.json, &args.report]), photos)?;
    let turned = turned_by_exif(&pairs)?;
    let (dims, found) = find_boards(&board, &pairs)?;
    let (views, missing) = seen_by_both(&pairs, &found);
    if views.len() < LEAST_VIEWS {
        bail!("{}{turned}", too_few(&board, pairs.len(), views.len(), &found));
    }
    let options = Options {
        lens: match args.lens {
            LensName::BrownConrady => LensModel::BrownConrady,
            LensName::Fisheye => LensModel::Fisheye,
        },
        skew: args.skew,
        square_pixels: matches!(args.aspect, Aspect::One),
        fix_k3: args.fix_k3,
    };
    let spinner = ProgressBar::new_spinner().with_message("estimating");
    spinner.enable_steady_tick(core::time::Duration::from_millis(100));
    let estimate = estimate(&board, dims, &views, &options);
    spinner.finish_and_clear();
    let estimate = estimate.map_err(|error| anyhow!("{error}{turned}"))?;
    let assessment = assess(&estimate, args.max_disparity);

    let mut output = OutputFiles::new();
    if let Some(path) = &args.out {
        let used = estimate.views.iter().filter(|view| view.dropped.is_none()).count();
        let quality = Quality {
            source: format!("{used} pairs of photos of a {}", args.board_options.described(&board)),
            views: used as u32,
            stereo_rms_px: estimate.rms,
            vertical_residual_px: assessment.rectified.as_ref().map(|rectified| rectified.vertical),
            verdict: assessment.verdict.to_string(),
        };
        let file = RigFile { calibration: estimate.calibration, quality: Some(quality) };
        output.add(path, file.text().as_bytes())?;
    }
    output.add_json(args.json.as_ref(), &json(&estimate, &assessment))?;
    output.add_made(args.report.as_ref(), || {
        let photos = clearest_pair(&estimate, &pairs)?;
        Ok(draw::png(&draw::calibration(&estimate, &assessment, photos.as_ref()))?)
    })?;
    let (folder, seen, all) = (args.folder.display(), views.len(), pairs.len());
    let mut text = format!("{folder}: board found in {seen} of {all} pairs, {dims}\n");
    if !turned.is_empty() {
        let _ = writeln!(text, "  the rig is that of the turned images{turned}");
    }
    for path in alone {
        let _ = writeln!(text, "  {}: no partner, left out", path.display());
    }
    text.push_str(&missing);
    text.push_str(&summary(&estimate, &assessment, args.max_disparity));
    text.push_str(&super::written([&args.out, &args.json, &args.report]));
    output.commit_and_say(&text)
}

/// The photos of the view with the least error.
fn clearest_pair(estimate: &Estimate, pairs: &[PhotoPair]) -> Result<Option<[GrayImage; 2]>> {
    let used = estimate.views.iter().filter(|view| view.dropped.is_none());
    let error = |view: &ViewReport| view.rms[0] + view.rms[1];
    let clearest = used.min_by(|a, b| error(a).total_cmp(&error(b)));
    let Some(pair) = clearest.and_then(|view| pairs.iter().find(|pair| pair.name == view.name))
    else {
        return Ok(None);
    };
    let [left, right] = &pair.files;
    Ok(Some([load_gray(left)?, load_gray(right)?]))
}

/// Note for photos that are all turned by EXIF. Photos of which some are turned are refused:
/// cameras of a rig do not turn between photos.
fn turned_by_exif(pairs: &[PhotoPair]) -> Result<String> {
    let files: Vec<&PathBuf> = pairs.iter().flat_map(|pair| &pair.files).collect();
    let turns = files.iter().map(|file| exif_turn(file)).collect::<Result<Vec<_>, _>>()?;
    let mut turned = files.iter().zip(&turns).filter(|(_, turn)| **turn != UPRIGHT);
    let Some((file, turn)) = turned.next() else { return Ok(String::new()) };
    if turns.iter().any(|other| other != turn) {
        let (file, count, all) = (file.display(), 1 + turned.count(), files.len());
        bail!("EXIF turns {file} {turn}, and {count} of {all} photos in all; {EXIF_REMEDY}");
    }
    Ok(format!(
        "; EXIF turns all photos {turn}, and images without EXIF are not turned: {EXIF_REMEDY}"
    ))
}

/// Corners, or why there are none, of both photos of a pair.
type Found = [Result<BoardCorners, NotFound>; 2];

/// Looks for the board in all photos, on every core; checks that all have one size, which rigs
/// have.
fn find_boards(board: &Board, pairs: &[PhotoPair]) -> Result<(Dims, Vec<Found>)> {
    let find = |path: &PathBuf| -> Result<_> {
        let image = load_gray(path)?;
        check_raw_dims(image.dims).map_err(|error| {
            anyhow!(
                "{}: {error}; give all photos another size, and match images of that size",
                path.display()
            )
        })?;
        Ok((image.dims, JunctionFinder.find(&image, board)))
    };
    let seen = for_each_pair(
        pairs,
        None,
        |pair| pair.name.clone(),
        |pair| {
            let [left, right] = pair.files.each_ref().map(find);
            Ok([left?, right?])
        },
    )?;
    let files = pairs.iter().flat_map(|pair| &pair.files);
    let mut sizes = files.zip(seen.iter().flatten().map(|(dims, _)| *dims));
    let (first, dims) = sizes.next().context("there are no photos")?;
    if let Some((path, other)) = sizes.find(|(_, other)| *other != dims) {
        let (first, path) = (first.display(), path.display());
        bail!("{first} is {dims}, {path} is {other}; all photos of a calibration have one size");
    }
    Ok((dims, seen.into_iter().map(|pair| pair.map(|(_, found)| found)).collect()))
}

/// Pairs in which both photos show the board, and a line for each other one.
fn seen_by_both(pairs: &[PhotoPair], found: &[Found]) -> (Vec<BoardPair>, String) {
    let (mut views, mut missing) = (Vec::new(), String::new());
    for (pair, found) in pairs.iter().zip(found) {
        let enough = found.each_ref().map(|found| match found {
            Ok(corners) if corners.len() < LEAST_CORNERS => Err(NotFound::Part(corners.len())),
            other => other.clone(),
        });
        match enough {
            [Ok(left), Ok(right)] => views.push(BoardPair::new(pair.name.clone(), left, right)),
            found => {
                for (path, found) in pair.files.iter().zip(&found) {
                    if let Err(why) = found {
                        let _ = writeln!(missing, "  {}: {why}, pair left out", path.display());
                    }
                }
            }
        }
    }
    (views, missing)
}

/// Why there are too few views, by what was seen most.
fn too_few(board: &Board, pairs: usize, usable: usize, found: &[Found]) -> String {
    let failures = || found.iter().flatten().filter_map(|found| found.as_ref().err());
    let size = |why: &NotFound| match why {
        NotFound::OtherSize(cols, rows) => Some([*cols, *rows]),
        _ => None,
    };
    let sizes: Vec<[usize; 2]> = failures().filter_map(size).collect();
    let count = |size: &[usize; 2]| sizes.iter().filter(|other| *other == size).count();
    let most = sizes.iter().max_by_key(|size| count(size));
    if let Some(size) = most.filter(|size| 2 * count(size) > found.len()) {
        let ([cols, rows], seen) = (size, count(size));
        return format!(
            "the board is not {board}: {seen} of {} photos show {cols}x{rows} inner corners; \
             give --board {cols}x{rows}",
            2 * pairs
        );
    }
    let photos = |eye: usize| found.iter().filter(|found| found[eye].is_ok()).count();
    if board.pattern() != Pattern::Chessboard {
        return marked_too_few(board, pairs, usable, failures(), [photos(0), photos(1)]);
    }
    format!(
        "the {board} board is whole in both photos of {usable} pairs only ({} left, {} right photos of {pairs}), {LEAST_VIEWS} are \
         needed; check --board (inner corners, one less than squares) and take sharp photos of the whole board",
        photos(0),
        photos(1),
    )
}

fn marked_too_few<'a>(
    board: &Board,
    pairs: usize,
    usable: usize,
    failures: impl Iterator<Item = &'a NotFound> + Clone,
    [left, right]: [usize; 2],
) -> String {
    let count = |kind: fn(&NotFound) -> bool| failures.clone().filter(|why| kind(why)).count();
    let [unmarked, other] = [
        count(|why| matches!(why, NotFound::NoMarkers(_))),
        count(|why| matches!(why, NotFound::OtherLayout)),
    ];
    let advice = match board.pattern() {
        _ if other > unmarked => {
            format!(
                "{other} photos show markers in other places: check the size after --board, \
                 --legacy-pattern of an old ChArUco board"
            )
        }
        Pattern::Charuco { dictionary, .. } if unmarked > 0 => {
            let name = dictionary.name();
            format!(
                "{unmarked} photos show a chessboard without markers of {name}: check \
                 --dictionary and --marker-mm, turn mirroring off"
            )
        }
        _ if unmarked > 0 => {
            format!(
                "{unmarked} photos show corners, but no tags of 36h11: check the board, turn \
                 mirroring off"
            )
        }
        _ => "take sharp photos with the board larger in the image".to_owned(),
    };
    format!(
        "{LEAST_CORNERS} corners of the {board} board are in both photos of {usable} pairs only ({left} left, {right} right photos of \
         {pairs} show some), {LEAST_VIEWS} are needed; {advice}"
    )
}
